//! Studies whose runs are made by the energy integral: times of a stop, or states at the end or at a stop.
//!
//! In: the common data of all runs, the design, a model. Out: times and states of many runs together. A run without a
//! time or a state must be made step by step. The module must not know mechanics.

use super::design::Design;
use super::responses::Measure;
use super::run::{Runner, Task};
use anyhow::Result;
use linkage_fmu::component::{Component, FastForward, Waypoint};
use linkage_fmu::mechanism::TravelTime;
use linkage_fmu::variables::Kind;

/// Largest number of runs from whose times positions are selected.
const SAMPLES: u64 = 64;
/// The golden section. Any number of its multiples is distributed evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_8;
/// Largest ratio of a time to the stop time. Nearer to the stop time, rounding would decide whether the run reaches the
/// stop.
const BEFORE_STOP: f64 = 1.0 - 1e-9;

/// What the factors decide.
pub enum ByEnergy {
    /// The time of the stop, up to a latest one [s], where nothing else is a response.
    Times(TravelTime, f64),
    /// The state at the end of the one step of a run [s], or at a stop.
    States(Box<FastForward>, f64),
}

impl ByEnergy {
    /// The function, where the factors are constant loads and nothing changes with time. None for any other study.
    ///
    /// # Errors
    /// The model rejects common values of all runs.
    pub fn new(task: &Task, design: &Design, model: Component) -> Result<Option<Self>> {
        let Task { factors, scenario, responses, .. } = task;
        let is_time = |measure: &Measure| match measure {
            Measure::Event(event) => scenario.stop_at == Some(responses.events[*event]),
            _ => false,
        };
        let is_served = scenario.steps.iter().all(|step| step.settings.is_empty())
            && factors.iter().all(|factor| factor.kind == Kind::Real);
        if !is_served {
            return Ok(None);
        }
        let inputs: Vec<_> = factors.iter().map(|factor| factor.reference).collect();
        let Some(model) = Runner::new(task, model)?.started() else { return Ok(None) };
        let stop = scenario.stop_at.filter(|_| responses.list.iter().all(|response| is_time(&response.measure)));
        let Some(stop) = stop else {
            // Between communication instants a few steps would do.
            let forward = model.fast_forward(&inputs).filter(|_| scenario.steps.len() == 1);
            return Ok(forward.map(|forward| Self::States(Box::new(forward), scenario.stop())));
        };
        let (mut samples, mut point, mut design, runs) = (Vec::new(), Vec::new(), design.clone(), design.runs());
        for sample in 0..SAMPLES.min(runs) {
            // Distributed over all runs, without the period of a grid.
            let spread = || ((sample as f64 * GOLDEN).fract() * runs as f64) as u64;
            design.point(if runs <= SAMPLES { sample } else { spread() }, &mut point);
            samples.extend_from_slice(&point);
        }
        let time = model.travel_time(stop.flag, &inputs, &samples);
        Ok(time.map(|time| Self::Times(time, BEFORE_STOP * scenario.stop())))
    }

    /// Times [s], NaN for none, or states of runs with these values of the factors, one run after the other.
    pub fn find(&self, points: &[f64], times: &mut [f64], states: &mut [Option<Waypoint>]) {
        match self {
            Self::Times(of, latest) => {
                of.times(points, times);
                times.iter_mut().filter(|time| **time > *latest).for_each(|time| *time = f64::NAN);
            }
            Self::States(of, end) => of.states(points, *end, states),
        }
    }
}
