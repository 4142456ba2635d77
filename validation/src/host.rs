//! A host as a C program would be: one instance, driven through the FMI functions of the library.
//!
//! In: a description folder and the settings of a scene. Out: statuses as `Result`, values, times. The only part of the
//! package that calls the C functions of a scene.
#![allow(unsafe_code)]

use crate::life::{Life, done};
use crate::scene::{After, KNOWN, StateLoads, force};
use linkage_fmu::fmi2::types::{Boolean, Component, FALSE, FmuState, TRUE, ValueReference};
use linkage_fmu::fmi2::{
    fmi2DoStep, fmi2EnterInitializationMode, fmi2ExitInitializationMode, fmi2FreeFMUstate, fmi2FreeInstance,
    fmi2GetDirectionalDerivative, fmi2GetFMUstate, fmi2GetReal, fmi2SetBoolean, fmi2SetFMUstate, fmi2SetReal,
    fmi2SetupExperiment,
};
use linkage_fmu::mechanism::Model;
use std::path::Path;
use std::ptr::null_mut;
use std::time::Instant;

/// Outputs of the motion, each read by a call of its own.
const MOTION: [&str; 3] = ["crank.angle", "crank.speed", "crank.acceleration"];
/// Sizes of the reactions.
const REACTIONS: [&str; 4] = ["joint1.force", "joint2.force", "joint3.force", "joint4.force"];
/// Unknowns of the directional derivative.
const UNKNOWNS: [&str; 4] = ["crank.speed", "crank.acceleration", "actuator.speed", "actuator.acceleration"];

/// An initialised instance of the landing gear, with the state that each run begins with.
pub struct Host {
    component: Component,
    start: FmuState,
    motion: [ValueReference; 3],
    reactions: [ValueReference; 4],
    unknowns: [ValueReference; 4],
    known: ValueReference,
}

fn references<const N: usize>(model: &Model, names: [&str; N]) -> Result<[ValueReference; N], String> {
    let mut found = [0; N];
    for (reference, name) in found.iter_mut().zip(names) {
        *reference = model.variables().find(name).ok_or_else(|| format!("there is no {name}"))?;
    }
    Ok(found)
}

impl Host {
    /// An instance of the mechanism in `folder` with the scene's settings, initialised.
    ///
    /// # Errors
    /// The file cannot be read or has not the gear's variables; a call is refused.
    pub fn new(folder: &Path, scene: &StateLoads, tolerance: f64) -> Result<Self, String> {
        let model = Model::from_json(&crate::measure::mechanism(folder)?).map_err(|e| e.to_string())?;
        let [known] = references(&model, [KNOWN])?;
        let mut host = Self {
            start: null_mut(),
            motion: references(&model, MOTION)?,
            reactions: references(&model, REACTIONS)?,
            unknowns: references(&model, UNKNOWNS)?,
            known,
            component: Life::new(folder)?.instantiate()?.0,
        };
        host.initialize(&model, scene, tolerance)?;
        Ok(host)
    }

    fn initialize(&mut self, model: &Model, scene: &StateLoads, tolerance: f64) -> Result<(), String> {
        let c = self.component;
        for &(name, value) in scene.reals {
            let [reference] = references(model, [name])?;
            // SAFETY: the component is valid; one reference, one value (2.1.7).
            done("fmi2SetReal", unsafe { fmi2SetReal(c, &reference, 1, &value) })?;
        }
        for &(name, value) in scene.flags {
            let [reference] = references(model, [name])?;
            // SAFETY: the component is valid; one reference, one value (2.1.7).
            done("fmi2SetBoolean", unsafe { fmi2SetBoolean(c, &reference, 1, &Boolean::from(value)) })?;
        }
        // SAFETY: the component is valid; the state's pointer is this host's own, and NULL (2.1.8).
        unsafe {
            done("fmi2SetupExperiment", fmi2SetupExperiment(c, TRUE, tolerance, 0.0, FALSE, 0.0))?;
            done("fmi2EnterInitializationMode", fmi2EnterInitializationMode(c))?;
            done("fmi2ExitInitializationMode", fmi2ExitInitializationMode(c))?;
            done("fmi2GetFMUstate", fmi2GetFMUstate(c, &mut self.start))
        }
    }

    /// `steps` doSteps of `h` from the start, with what is called after each of them, in as many parts as `least` is long;
    /// `least` keeps the least time [s] of each part.
    ///
    /// # Errors
    /// A call is refused.
    pub fn run(&mut self, steps: u32, h: f64, after: &[After], least: &mut [f64]) -> Result<(), String> {
        // SAFETY: the state was made by this component (2.1.8).
        done("fmi2SetFMUstate", unsafe { fmi2SetFMUstate(self.component, self.start) })?;
        let (mut part, length) = (0..steps, steps.div_ceil(least.len() as u32) as usize);
        for least in least {
            let began = Instant::now();
            for step in part.by_ref().take(length) {
                // SAFETY: the component is valid (4.2.2).
                done("fmi2DoStep", unsafe { fmi2DoStep(self.component, f64::from(step) * h, h, FALSE) })?;
                for &what in after {
                    self.call(what, step + 1)?;
                }
            }
            *least = least.min(began.elapsed().as_secs_f64());
        }
        Ok(())
    }

    fn call(&self, what: After, steps: u32) -> Result<(), String> {
        match what {
            After::Motion => self.motion.iter().try_for_each(|reference| self.read([*reference])),
            After::Reactions => self.read(self.reactions),
            After::EachReaction => self.reactions.iter().try_for_each(|reference| self.read([*reference])),
            After::Derivatives => {
                let mut rates = [0.0; UNKNOWNS.len()];
                let (unknowns, count) = (self.unknowns.as_ptr(), rates.len());
                // SAFETY: the component is valid; two arrays have `count` elements, two have one (2.1.9).
                let status = unsafe {
                    let (c, known, rates) = (self.component, &self.known, rates.as_mut_ptr());
                    fmi2GetDirectionalDerivative(c, unknowns, count, known, 1, &1.0, rates)
                };
                std::hint::black_box(&rates);
                done("fmi2GetDirectionalDerivative", status)
            }
            After::Force => {
                // SAFETY: the component is valid; one reference, one value (2.1.7).
                done("fmi2SetReal", unsafe { fmi2SetReal(self.component, &self.known, 1, &force(steps)) })
            }
        }
    }

    fn read<const N: usize>(&self, references: [ValueReference; N]) -> Result<(), String> {
        let mut values = [0.0; N];
        // SAFETY: the component is valid; both arrays have N elements (2.1.7).
        let status = unsafe { fmi2GetReal(self.component, references.as_ptr(), N, values.as_mut_ptr()) };
        std::hint::black_box(&values);
        done("fmi2GetReal", status)
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // SAFETY: the state is this component's, or NULL; neither is used again (2.1.5, 2.1.8).
        unsafe {
            fmi2FreeFMUstate(self.component, &mut self.start);
            fmi2FreeInstance(self.component);
        }
    }
}
