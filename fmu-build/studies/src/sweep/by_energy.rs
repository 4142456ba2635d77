//! Studies whose runs are made by the energy integral: times of a stop, or states at the end or at a stop.
//!
//! In: the common data of all runs, the design, a model. Out: responses or states of many runs together. A run without
//! responses or a state must be made step by step. The module must not know mechanics.

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
    /// The time of the stop that ends a run, up to a latest one [s], where all responses are times of events: for each
    /// response, whether it is that time. On the way from rest to the stop no other event occurs.
    Times(TravelTime, f64, Vec<bool>),
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
        let is_end = |measure: &Measure| match measure {
            Measure::Event(event) => Some(scenario.stop_at == Some(responses.events[*event])),
            _ => None,
        };
        let is_served = scenario.steps.iter().all(|step| step.settings.is_empty())
            && factors.iter().all(|factor| factor.kind == Kind::Real);
        if !is_served {
            return Ok(None);
        }
        let inputs: Vec<_> = factors.iter().map(|factor| factor.reference).collect();
        let Some(model) = Runner::new(task, model)?.started() else { return Ok(None) };
        let ends = responses.list.iter().map(|response| is_end(&response.measure)).collect::<Option<Vec<_>>>();
        let Some((stop, ends)) = scenario.stop_at.zip(ends) else {
            // Between communication instants a few steps would do.
            let forward = model.fast_forward(&inputs).filter(|_| scenario.steps.len() == 1);
            return Ok(forward.map(|forward| Self::States(Box::new(forward), scenario.stop())));
        };
        let (mut samples, mut point, mut design, runs) =
            (Vec::new(), vec![0.0; factors.len()], design.clone(), design.runs());
        for sample in 0..SAMPLES.min(runs) {
            // Distributed over all runs, without the period of a grid.
            let spread = || ((sample as f64 * GOLDEN).fract() * runs as f64) as u64;
            design.point(if runs <= SAMPLES { sample } else { spread() }, &mut point);
            samples.extend_from_slice(&point);
        }
        let time = model.travel_time(stop.flag, &inputs, &samples);
        Ok(time.map(|time| Self::Times(time, BEFORE_STOP * scenario.stop(), ends)))
    }

    /// What is known of so many runs with these values of the factors, one run after the other.
    pub fn find(&self, points: &[f64], count: usize) -> Found<'_> {
        match self {
            Self::Times(of, latest, ends) => {
                let mut times = vec![f64::NAN; count];
                of.times(points, &mut times);
                times.iter_mut().filter(|time| **time > *latest).for_each(|time| *time = f64::NAN);
                Found::Times(times, ends)
            }
            Self::States(of, end) => {
                let mut states = vec![None; count];
                of.states(points, *end, &mut states);
                Found::States(states)
            }
        }
    }
}

/// What is known of some runs.
pub enum Found<'a> {
    /// Nothing.
    Nothing,
    /// The time at which each run ends [s], NaN for none, and whether each response is this time.
    Times(Vec<f64>, &'a [bool]),
    /// A state on the way of each run, or none.
    States(Vec<Option<Waypoint>>),
}

impl Found<'_> {
    /// The responses of a run, if they are known.
    #[inline]
    pub fn responses(&self, run: usize, values: &mut [f64]) -> bool {
        let Self::Times(times, ends) = self else { return false };
        let time = times[run];
        for (value, is_end) in values.iter_mut().zip(*ends) {
            *value = if *is_end { time } else { f64::NAN };
        }
        !time.is_nan()
    }

    /// A state on the way of a run, if there is one.
    pub fn state(&self, run: usize) -> Option<Waypoint> {
        if let Self::States(states) = self { states[run] } else { None }
    }
}
