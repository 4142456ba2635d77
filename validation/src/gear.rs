//! The landing gear through the C functions: the calls of a scene, and the whole life of an instance.
//!
//! In: a description folder and the settings of a scene. Out: statuses as `Result`, times.

use crate::scene::{After, KNOWN, SPAN, Scene, force};
use linkage_fmu::fmi2::host::{Description, Host, State};
use linkage_fmu::fmi2::types::{Status, ValueReference};
use linkage_fmu::variables::Kind;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Outputs of the motion, each read by a separate call.
const MOTION: [&str; 3] = ["crank.angle", "crank.speed", "crank.acceleration"];
/// Magnitudes of the reactions.
const REACTIONS: [&str; 4] = ["joint1.force", "joint2.force", "joint3.force", "joint4.force"];
/// Unknowns of the directional derivative.
const UNKNOWNS: [&str; 4] = ["crank.speed", "crank.acceleration", "actuator.speed", "actuator.acceleration"];
/// Greater than the number of outputs of the gear.
const MOST_OUTPUTS: usize = 256;
/// Outputs read at the end of an instance's life.
pub const LAST: [&str; 3] = ["crank.angle", "crank.speed", "energy.drift"];

/// `Ok`, or the name of the call with its status.
fn done(call: &str, status: Status) -> Result<(), String> {
    if status == Status::Ok { Ok(()) } else { Err(format!("{call}: {status:?}")) }
}

/// All calls from `fmi2Instantiate` to `fmi2FreeInstance`, scene S1 in one doStep.
pub fn live(description: &Arc<Description>) -> Result<(), String> {
    let host = description.instantiate(None, false)?;
    let mut values = [0.0; LAST.len()];
    done("fmi2SetupExperiment", host.set_up(None, 0.0, Some(SPAN)))?;
    done("initialization", host.initialize())?;
    done("fmi2DoStep", host.step(0.0, SPAN))?;
    done("fmi2GetReal", host.reals(&LAST.map(|name| host.reference(name)), &mut values))?;
    done("fmi2Terminate", host.terminate())?;
    std::hint::black_box(values);
    Ok(())
}

/// Set a scene's values and initialise.
fn prepare(host: &Host, scene: &Scene, tolerance: f64) -> Result<(), String> {
    for &(name, value) in scene.reals {
        done(name, host.set(name, value))?;
    }
    for &(name, value) in scene.flags {
        done(name, host.set_boolean(name, value))?;
    }
    done("fmi2SetupExperiment", host.set_up(Some(tolerance), 0.0, None))?;
    done("initialization", host.initialize())
}

/// An initialised instance of the landing gear, with the state at the start of each run.
pub struct Gear {
    host: Host,
    start: State,
    motion: [ValueReference; 3],
    reactions: [ValueReference; 4],
    unknowns: [ValueReference; 4],
    known: ValueReference,
    outputs: Vec<ValueReference>,
}

impl Gear {
    /// An instance of the mechanism in `folder` with the scene's settings, initialised.
    pub fn new(folder: &Path, scene: &Scene, tolerance: f64) -> Result<Self, String> {
        let description = Description::read(folder)?;
        let host = description.instantiate(None, false)?;
        prepare(&host, scene, tolerance)?;
        let mut start = State::NONE;
        done("fmi2GetFMUstate", host.save_into(&mut start))?;
        let (motion, reactions) = (MOTION.map(|name| host.reference(name)), REACTIONS.map(|name| host.reference(name)));
        let (unknowns, known) = (UNKNOWNS.map(|name| host.reference(name)), host.reference(KNOWN));
        let all = description.interface().list().iter().zip(0..);
        let outputs =
            all.filter(|(v, _)| v.kind == Kind::Real && v.is_output()).map(|(_, reference)| reference).collect();
        Ok(Self { host, start, motion, reactions, unknowns, known, outputs })
    }

    /// `steps` doSteps of `h` from the start with the calls `after` each of them, timed in as many parts as `least` has
    /// elements; `least` keeps the least time [s] of each part.
    pub fn run(&mut self, steps: u32, h: f64, after: &[After], least: &mut [f64]) -> Result<(), String> {
        done("fmi2SetFMUstate", self.host.restore(&self.start))?;
        let mut state = State::NONE;
        let (mut part, length) = (0..steps, steps.div_ceil(least.len() as u32) as usize);
        for least in least {
            let began = Instant::now();
            for step in part.by_ref().take(length) {
                done("fmi2DoStep", self.host.step(f64::from(step) * h, h))?;
                for &what in after {
                    self.call(what, step + 1, &mut state)?;
                }
            }
            *least = least.min(began.elapsed().as_secs_f64());
        }
        done("fmi2FreeFMUstate", self.host.free(&mut state))
    }

    /// `fmi2Reset` and all calls up to the first doStep, with the values of a scene and its settings.
    pub fn restart(&self, scene: &Scene, tolerance: f64) -> Result<(), String> {
        done("fmi2Reset", self.host.reset())?;
        prepare(&self.host, scene, tolerance)
    }

    /// Set a parameter and initialise, after `fmi2Reset`.
    pub fn restart_with(&self, name: &str, value: f64) -> Result<(), String> {
        done("fmi2Reset", self.host.reset())?;
        done(name, self.host.set(name, value))?;
        done("fmi2SetupExperiment", self.host.set_up(None, 0.0, None))?;
        done("initialization", self.host.initialize())
    }

    /// One doStep from the start.
    pub fn step(&self, h: f64) -> Result<(), String> {
        done("fmi2DoStep", self.host.step(0.0, h))
    }

    /// Value of an output.
    pub fn get(&self, name: &str) -> Result<f64, String> {
        self.host.get(name).map_err(|status| format!("{name}: {status:?}"))
    }

    fn call(&self, what: After, steps: u32, state: &mut State) -> Result<(), String> {
        match what {
            After::Motion => self.motion.iter().try_for_each(|reference| self.read([*reference])),
            After::Reactions => self.read(self.reactions),
            After::Outputs => {
                let values = &mut [0.0; MOST_OUTPUTS][..self.outputs.len()];
                done("fmi2GetReal", self.host.reals(&self.outputs, std::hint::black_box(values)))
            }
            After::Serialised => {
                done("fmi2GetFMUstate", self.host.save_into(state))?;
                let bytes = self.host.serialize(state).map_err(|status| format!("serialize: {status:?}"))?;
                std::hint::black_box(&bytes);
                Ok(())
            }
            After::EachReaction => self.reactions.iter().try_for_each(|reference| self.read([*reference])),
            After::Derivatives => {
                let mut rates = [0.0; UNKNOWNS.len()];
                let status = self.host.derivatives(&self.unknowns, self.known, &mut rates);
                std::hint::black_box(&rates);
                done("fmi2GetDirectionalDerivative", status)
            }
            After::Force => done("fmi2SetReal", self.host.set_reals(&[self.known], &[force(steps)])),
            // The restored state was saved after the step, so that no step is repeated.
            After::State => {
                done("fmi2GetFMUstate", self.host.save_into(state))?;
                done("fmi2SetFMUstate", self.host.restore(state))
            }
        }
    }

    fn read<const N: usize>(&self, references: [ValueReference; N]) -> Result<(), String> {
        let mut values = [0.0; N];
        let status = self.host.reals(&references, &mut values);
        std::hint::black_box(&values);
        done("fmi2GetReal", status)
    }
}

impl Drop for Gear {
    fn drop(&mut self) {
        self.host.free(&mut self.start);
    }
}
