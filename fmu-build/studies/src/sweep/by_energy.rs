//! Studies with the time of a stop as the only result, by the energy integral.
//!
//! In: the common data of all runs, the design, a model. Out: the times of many runs. NaN stands for a run that must be
//! made step by step. The module must not know mechanics.

use super::design::Design;
use super::responses::Measure;
use super::run::{Runner, Task};
use anyhow::Result;
use linkage_fmu::component::Component;
use linkage_fmu::mechanism::TravelTime;
use linkage_fmu::variables::Kind;

/// Largest number of runs from whose times positions are selected.
const SAMPLES: u64 = 64;
/// The golden section. Any number of its multiples is distributed evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_8;
/// Largest ratio of a time to the stop time. Nearer to the stop time, rounding would decide whether the run reaches the
/// stop.
const BEFORE_STOP: f64 = 1.0 - 1e-9;

/// The time of the stop as a function of the factors.
pub struct ByEnergy {
    time: TravelTime,
    /// Latest time [s].
    latest: f64,
}

impl ByEnergy {
    /// The function, if a run is only the motion to the stop that ends it, and its factors are constant loads. None for
    /// any other study.
    ///
    /// # Errors
    /// The model rejects common values of all runs.
    pub fn new(task: &Task, design: &Design, model: Component) -> Result<Option<Self>> {
        let Task { factors, scenario, responses, .. } = task;
        let Some(stop) = scenario.stop_at else { return Ok(None) };
        let is_time = |measure: &Measure| matches!(measure, Measure::Event(event) if responses.events[*event] == stop);
        let is_served = responses.list.iter().all(|response| is_time(&response.measure))
            && scenario.steps.iter().all(|step| step.settings.is_empty())
            && factors.iter().all(|factor| factor.kind == Kind::Real);
        if !is_served {
            return Ok(None);
        }
        let Some(model) = Runner::new(task, model)?.started() else { return Ok(None) };
        let (mut samples, mut point, mut design, runs) = (Vec::new(), Vec::new(), design.clone(), design.runs());
        for sample in 0..SAMPLES.min(runs) {
            // Distributed over all runs, without the period of a grid.
            let spread = || ((sample as f64 * GOLDEN).fract() * runs as f64) as u64;
            design.point(if runs <= SAMPLES { sample } else { spread() }, &mut point);
            samples.extend_from_slice(&point);
        }
        let inputs: Vec<_> = factors.iter().map(|factor| factor.reference).collect();
        let time = model.travel_time(stop.flag, &inputs, &samples);
        Ok(time.map(|time| Self { time, latest: BEFORE_STOP * scenario.stop() }))
    }

    /// Times of runs with these values of the factors, one run after the other [s].
    pub fn times(&self, points: &[f64], times: &mut [f64]) {
        self.time.times(points, times);
        times.iter_mut().filter(|time| **time > self.latest).for_each(|time| *time = f64::NAN);
    }
}
