//! The two FMUs of the gear as the sides of a coupling, through the functions of FMI 2.0 alone.
use super::pair::{Actuator, Element, Mechanism, Motion, Preview, Refused};
use super::unpacked::Fmu;
use linkage_fmu::fmi2::importer::{Instance, State};
use linkage_fmu::fmi2::types::ValueReference;
use std::sync::Arc;

/// The FMU `LandingGearRetraction`.
#[derive(Debug)]
pub struct Gear {
    /// The instance, in step mode.
    pub instance: Instance,
    state: State,
    force: ValueReference,
    motion: [ValueReference; 3],
    element: [ValueReference; 4],
    energies: [ValueReference; 2],
    position: ValueReference,
}

impl Gear {
    /// An instance at its start: Reals and Booleans by name.
    ///
    /// # Errors
    /// The FMU has no such variable, or refuses a value.
    pub fn start(fmu: &Arc<Fmu>, reals: &[(&str, f64)], booleans: &[(&str, bool)]) -> Result<Self, String> {
        let instance = started(fmu, "gear", reals, booleans, &[])?;
        let of = "actuator";
        let name = |suffix: &str| fmu.find(&format!("{of}.{suffix}"));
        Ok(Self {
            instance,
            state: State::NONE,
            force: name("force")?,
            motion: [name("length")?, name("speed")?, name("acceleration")?],
            element: [
                name("reduced_mass")?,
                name("reduced_mass_derivative")?,
                name("holding_force")?,
                name("holding_force_derivative")?,
            ],
            energies: fmu.find_all(["energy.kinetic", "energy.potential"])?,
            position: fmu.find("crank.angle")?,
        })
    }
}

/// A new instance in step mode.
fn started(
    fmu: &Arc<Fmu>,
    name: &str,
    reals: &[(&str, f64)],
    booleans: &[(&str, bool)],
    numbers: &[(&str, i32)],
) -> Result<Instance, String> {
    let instance = fmu.instantiate(name)?;
    instance.set_up(0.0, None)?;
    for (name, value) in reals {
        instance.set_reals(&[fmu.find(name)?], &[*value])?;
    }
    for (name, value) in booleans {
        instance.set_boolean(fmu.find(name)?, *value)?;
    }
    for (name, value) in numbers {
        instance.set_integer(fmu.find(name)?, *value)?;
    }
    instance.initialize()?;
    Ok(instance)
}

impl Mechanism for Gear {
    fn motion(&mut self) -> Result<Motion, Refused> {
        let [length, speed, acceleration] = self.instance.reals(&self.motion)?;
        Ok(Motion { length, speed, acceleration })
    }

    fn jerk(&mut self) -> Result<[f64; 2], Refused> {
        let [.., acceleration] = self.motion;
        Ok([self.instance.rate(acceleration)?, self.instance.derivative(acceleration, self.force)?])
    }

    fn element(&mut self) -> Result<Element, Refused> {
        let [mass, mass_derivative, holding, holding_derivative] = self.instance.reals(&self.element)?;
        Ok(Element { mass, mass_derivative, holding, holding_derivative })
    }

    fn set_force(&mut self, [force, first, second]: [f64; 3]) -> Result<(), Refused> {
        self.instance.set_reals(&[self.force], &[force])?;
        self.instance.set_derivatives(self.force, &[first, second])
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), Refused> {
        self.instance.step(t, h)
    }

    fn save(&mut self) -> Result<(), Refused> {
        self.instance.save(&mut self.state)
    }

    fn restore(&mut self) -> Result<(), Refused> {
        self.instance.restore(&self.state)
    }

    fn energy(&mut self) -> Result<f64, Refused> {
        Ok(self.instance.reals(&self.energies)?.iter().sum())
    }

    fn position(&mut self) -> Result<f64, Refused> {
        Ok(self.instance.reals(&[self.position])?[0])
    }
}

impl Drop for Gear {
    fn drop(&mut self) {
        // What an FMU answers when it ends changes nothing that was measured.
        let _ = self.instance.free(&mut self.state);
    }
}

/// The FMU `HydraulicActuator`.
#[derive(Debug)]
pub struct Hydraulic {
    /// The instance, in step mode.
    pub instance: Instance,
    state: State,
    length: ValueReference,
    speed: ValueReference,
    acceleration: ValueReference,
    force: ValueReference,
    compliance: [ValueReference; 2],
    /// Inputs of the preview: the element's four terms, the horizon.
    asked: [ValueReference; 5],
    /// Its outputs: force, rate, mean, both accelerations.
    told: [ValueReference; 5],
    work: ValueReference,
    /// Whether a step keeps the foreseen motion: one pass.
    keeps: bool,
}

impl Hydraulic {
    /// An instance at its start: Reals by name, and `coupling.mode`.
    ///
    /// # Errors
    /// The FMU has no such variable, or refuses a value.
    pub fn start(fmu: &Arc<Fmu>, reals: &[(&str, f64)], mode: &str) -> Result<Self, String> {
        let find = |name: &str| fmu.find(name);
        let modes = linkage_fmu::hydraulics::definition::Mode::WORDS;
        let number =
            modes.iter().position(|word| *word == mode).ok_or_else(|| format!("{mode}: there is no such mode"))?;
        Ok(Self {
            instance: started(fmu, "hydraulics", reals, &[], &[("coupling.mode", number as i32 + 1)])?,
            state: State::NONE,
            length: find("actuator.length")?,
            speed: find("actuator.speed")?,
            acceleration: find("actuator.acceleration")?,
            force: find("actuator.force")?,
            compliance: fmu.find_all(["actuator.stiffness", "actuator.damping"])?,
            asked: fmu.find_all([
                "actuator.reduced_mass",
                "actuator.reduced_mass_derivative",
                "actuator.holding_force",
                "actuator.holding_force_derivative",
                "preview.horizon",
            ])?,
            told: fmu.find_all([
                "preview.force",
                "preview.force_rate",
                "preview.force_mean",
                "preview.start_acceleration",
                "preview.acceleration",
            ])?,
            work: find("energy.piston")?,
            keeps: mode != "follow",
        })
    }
}

impl Actuator for Hydraulic {
    fn set_motion(&mut self, length: f64, [speed, first, second, third, fourth]: [f64; 5]) -> Result<(), Refused> {
        self.instance.set_reals(&[self.length, self.speed], &[length, speed])?;
        self.instance.set_derivatives(self.speed, &[first, second, third, fourth])
    }

    fn force(&mut self) -> Result<f64, Refused> {
        Ok(self.instance.reals(&[self.force])?[0])
    }

    fn force_rate(&mut self, acceleration: f64) -> Result<f64, Refused> {
        self.instance.set_reals(&[self.acceleration], &[acceleration])?;
        self.instance.set_derivatives(self.speed, &[acceleration])?;
        self.instance.rate(self.force)
    }

    fn compliance(&mut self) -> Result<[f64; 2], Refused> {
        self.instance.reals(&self.compliance)
    }

    fn preview(&mut self, element: Element, h: f64, keeps: bool) -> Result<Preview, Refused> {
        if keeps != self.keeps {
            return Err("coupling.mode is not that of the scheme".into());
        }
        let Element { mass, mass_derivative, holding, holding_derivative } = element;
        self.instance.set_reals(&self.asked, &[mass, mass_derivative, holding, holding_derivative, h])?;
        let [force, rate, mean, from, to] = self.instance.reals(&self.told)?;
        Ok(Preview { line: [force, rate], mean, accelerations: [from, to] })
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), Refused> {
        self.instance.step(t, h)
    }

    fn save(&mut self) -> Result<(), Refused> {
        self.instance.save(&mut self.state)
    }

    fn restore(&mut self) -> Result<(), Refused> {
        self.instance.restore(&self.state)
    }

    fn work(&mut self) -> Result<f64, Refused> {
        Ok(self.instance.reals(&[self.work])?[0])
    }
}

impl Drop for Hydraulic {
    fn drop(&mut self) {
        // What an FMU answers when it ends changes nothing that was measured.
        let _ = self.instance.free(&mut self.state);
    }
}
