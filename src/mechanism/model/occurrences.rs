//! What has happened in a step, in words for the log.
//!
//! In: occurrences of a step, names of the definition. Out: lines of text, for the log of events or for that of
//! debugging. Successive impacts on one stop, each slower than the one before, are a series: the log reports the first
//! ones, a remark that further ones are only counted, and the end of the series. It must not change the state.
use super::{Formulation, Model};
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::motion::witness::{Listens, Occurrence, What};
use crate::mechanism::reduced::Reduced;
use crate::numerics::decimal::Decimal;

/// Impacts of a series that are told one by one.
const TOLD: u64 = 5;
/// Speed over that of the impact before from which on an impact begins a series: no losses but rounding.
const LOSSLESS: f64 = 1.0 - 1e-6;
/// Most lines of one step.
const MOST_LINES: usize = 100;

/// A line for the log.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Whether it is told for debugging only.
    pub is_detail: bool,
    /// The words, on one line.
    pub text: String,
}

/// Impacts on one stop, each slower than the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Series {
    stop: usize,
    count: u64,
    /// Magnitude of the speed of the last one [rad/s or m/s].
    speed: f64,
}

/// Whether occurrences are told, and the series of impacts that goes on.
#[derive(Clone, Debug, Default)]
pub struct Told {
    pub listens: Listens,
    series: Option<Series>,
}

impl Told {
    /// The state has jumped to another one: no series goes on.
    #[inline]
    pub fn restart(&mut self) {
        self.series = None;
    }

    /// Lines about what happened in a step that began at the time `point` [s].
    fn lines(&mut self, occurrences: &[Occurrence], reduced: &Reduced, point: f64) -> Vec<Line> {
        let mut lines: Vec<Line> = Vec::new();
        let mut more = 0_u64;
        for Occurrence { t, what } in occurrences {
            let Some((is_detail, text)) = self.words(*what, reduced.loading(), reduced) else { continue };
            if lines.len() < MOST_LINES {
                lines.push(Line { is_detail, text: format!("at t = {} s {text}", Decimal::rounded(point + t)) });
            } else {
                more += 1;
            }
        }
        if more > 0 {
            lines.push(Line { is_detail: false, text: format!("{more} more events up to the end of this step") });
        }
        lines
    }

    /// What happened, and whether it is a detail; None for an impact that is told with the end of its series.
    fn words(&mut self, what: What, loading: &Loading, reduced: &Reduced) -> Option<(bool, String)> {
        let name = |stop: usize| loading.stops[stop].name.as_str();
        let event = |text: String| Some((false, text));
        match what {
            What::Impact { stop, speed, impulse, is_rigid } => {
                let count = self.count(stop, speed.abs());
                if count > TOLD {
                    return None;
                }
                let (per, impulse_unit) = units(loading, stop);
                let (name, speed) = (name(stop), Decimal::rounded(speed));
                let more = if count == TOLD {
                    "; slower impacts that follow are counted and reported at the end of the series"
                } else {
                    ""
                };
                event(if is_rigid {
                    let impulse = Decimal::rounded(impulse);
                    format!("impact on the stop {name} at {speed} {per}, impulse {impulse} {impulse_unit}{more}")
                } else {
                    format!("the mechanism reaches the bumper {name} at {speed} {per}{more}")
                })
            }
            What::Rests { stop } => {
                let series = self.series.take().filter(|series| series.stop == stop && series.count > 1);
                let after = series.map_or(String::new(), |series| format!(" after {} impacts", series.count));
                event(format!("the mechanism stops at the stop {}{after}", name(stop)))
            }
            What::Gripped { change, impulse } => {
                let drive = loading.drives.get(loading.motion.as_ref()?.load)?;
                let (per, unit) = if drive.is_rotary { ("rad/s", "kg.m2/s") } else { ("m/s", "N.s") };
                let [change, impulse] = [change, impulse].map(Decimal::rounded);
                let name = &drive.name;
                event(format!(
                    "the motion of the drive {name} is prescribed from this time on: the speed of the drive jumps by \
                     {change} {per}, for which the drive needs an impulse of {impulse} {unit}"
                ))
            }
            What::Touched { stop } => event(format!("the bumper {} starts to push the mechanism", name(stop))),
            What::Left { stop } => event(format!("the bumper {} no longer pushes the mechanism", name(stop))),
            What::Engages { stop } => event(format!("the stop {} pushes so hard that its lock engages", name(stop))),
            What::Caught { stop } => {
                self.series = None;
                event(format!("a lock holds the mechanism at the stop {}", name(stop)))
            }
            What::LetGo { stop } => event(format!("the lock at the stop {} releases the mechanism", name(stop))),
            What::Switched { lock, engaged } => {
                let name = &loading.network.as_ref()?.pressure_locks[lock];
                event(format!("lock {name} {}", if engaged { "engages" } else { "releases" }))
            }
            What::Reversal => {
                event("the motion stops or reverses, and the losses of the drives change their direction".to_owned())
            }
            What::Sticks => event("friction holds the mechanism at rest".to_owned()),
            What::BreaksAway => event("the mechanism breaks away from static friction".to_owned()),
            What::Clings { joint } => {
                event(format!("the surface of the joint {} carries the body along", friction_name(reduced, joint)?))
            }
            What::Slips { joint } => {
                event(format!("the body starts to slip on the surface of the joint {}", friction_name(reduced, joint)?))
            }
            What::Regime { joint, regime } => {
                let joint = friction_name(reduced, joint)?;
                Some((true, format!("friction in the joint {joint} becomes {}", word(regime))))
            }
        }
    }

    /// Number of this impact in its series.
    fn count(&mut self, stop: usize, speed: f64) -> u64 {
        let goes_on = self.series.filter(|series| series.stop == stop && speed < LOSSLESS * series.speed);
        let count = goes_on.map_or(1, |series| series.count + 1);
        self.series = Some(Series { stop, count, speed });
        count
    }
}

/// Units of the speed and of the impulse of an impact on a stop.
fn units(loading: &Loading, stop: usize) -> (&'static str, &'static str) {
    if loading.stops[stop].quantity == "angle" { ("rad/s", "kg.m2/s") } else { ("m/s", "N.s") }
}

/// Name of a friction joint, by its index among those whose friction acts.
fn friction_name(reduced: &Reduced, joint: usize) -> Option<&str> {
    let loading = reduced.loading();
    Some(loading.friction_name(reduced.linkage(), loading.friction.as_ref()?.acting().nth(joint)?))
}

fn word(regime: Regime) -> &'static str {
    match regime {
        Regime::Viscous => "viscous",
        Regime::Static(_) => "static",
        Regime::Transition(_) => "transitional (between static and kinetic)",
        Regime::Kinetic(_) => "kinetic",
        Regime::Sticking => "static without slip",
    }
}

impl Model {
    /// The state jumps to another one: no series of impacts goes on.
    #[inline]
    pub(crate) fn restart_told(&mut self) {
        self.told.restart();
    }

    /// Keep events in steps, or details, for [`Self::take_occurrences`], or do not.
    #[inline]
    pub fn listen(&mut self, events: bool, details: bool) {
        self.told.listens = Listens { events, details };
    }

    /// What happened in the last step, which began at the time `point` [s], in words.
    #[inline]
    pub fn take_occurrences(&mut self, point: f64) -> Vec<Line> {
        match (&mut self.state, &self.reduced) {
            (Some(Formulation::Reduced(motion)), Some(reduced)) if motion.state.witness.has_occurrences() => {
                let left_out = motion.state.witness.left_out;
                let mut lines = self.told.lines(&motion.state.witness.take(), reduced, point);
                if left_out > 0 {
                    let text = format!("{left_out} more events at the end of this step are not reported");
                    lines.push(Line { is_detail: false, text });
                }
                lines
            }
            _ => Vec::new(),
        }
    }
}
