//! The definition of a system of FMUs.
//!
//! In: the text of `system.json`. Out: its sections, in which each key has a value of its type, or all faults. The
//! module must not know models: names of variables are only texts.

use crate::setting::Setting;
use linkage_fmu::format::{Element, Key, Named, Range, element, keys, line, number};
use linkage_fmu::variables::Unit;

/// Name of the file in the reference and of its schema.
pub const FILE: &str = "system.json";

keys! {
    /// The file system.json defines a system of FMUs that exchange forces, motions and signals. The program packs the
    /// system as an SSP package: one file with all FMUs, their connections and values. Paths are relative to the folder
    /// of the system file.
    pub struct Definition {
        /// Path of the JSON schema. A text editor uses the JSON schema to complete and check the keys. The program does
        /// not use the key `$schema`.
        schema as "$schema": Option<String>;
        /// Name of the system, and of the file `<name>.ssp`. The name consists of letters, digits and underscores, and
        /// must not start with a digit.
        name: String => element().required();
        /// Description of the system, one line of text.
        description: String => line();
        /// Stop time of the default experiment of the system [s], > 0. Default: the longest stop time of the FMUs.
        stop_time: Option<f64> => number(Unit::Second, Range::Positive);
        /// FMUs of the system by name. The name of an FMU consists of letters, digits and underscores, and must not
        /// start with a digit.
        fmus: Named<Fmu> => Key::PLAIN.required();
        /// Pairs of drives and actuators, such as `["gear.actuator", "hydraulics.actuator"]`. A pair connects all
        /// variables that exist in both terminals, in both directions. A terminal has the name of its drive or
        /// cylinder.
        terminals: Vec<Vec<String>>;
        /// Pairs of an output and an input, such as `["hydraulics.uplock.engaged", "gear.uplock.engage"]`. In each
        /// name, the word before the first dot is the name of the FMU.
        connections: Vec<Vec<String>>;
        /// Additional variables that simulation tools show as connectors, such as `gear.crank.angle`. Variables with a
        /// connection or a value are always connectors.
        connectors: Vec<String>;
    }

    /// The object `fmu` describes one FMU of a system. A text in place of the object `fmu` is the value of the key
    /// `definition`.
    pub struct Fmu or (linkage_fmu::format::Short::First) {
        /// Path of the definition file of a mechanism, an actuator or a network, or of a folder that contains a
        /// definition file.
        definition: String => Key::PLAIN.required();
        /// Path of a parameter set of SSP (SSV file) with values of parameters and inputs. The program converts each
        /// value from its unit in the file to the unit of the variable.
        parameters: Option<String>;
        /// Values of parameters and inputs, by the name of the variable. A value without a unit is in the SI unit of
        /// the variable. A text can contain a number with a unit, such as `"30 kN"`. A value in `values` replaces a
        /// value of the same variable in `parameters`.
        values: Named<Setting> => line();
    }
}

/// The elements of the file. The first element is the whole file.
pub const ELEMENTS: [Element; 2] = [Element::of::<Definition>(""), Element::of::<Fmu>("fmu")];
