//! Arcs of the travel in which friction locks a slow motion.
//!
//! In: a reduced model at its start. Out: for each direction the intervals of sigma in which friction and reactions
//! have no common solution, with the static coefficients and the loads at the start. It must not know laws: it uses the
//! equation of motion.
use crate::inspection::{Fact, Finding, Inspection};
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::motion::acting::{airspeed, state_loads_under};
use crate::mechanism::motion::state::State;
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::bracket::bisect;

/// Most arcs that are listed.
const ARCS: usize = 12;
/// Positions in each panel of the table.
const SAMPLES: usize = 4;
/// Work of the whole search, in positions times the cube of the number of joints with friction.
const MOST_WORK: usize = 2_000_000_000;

/// Add the arcs between these ends of the travel, counted on over whole revolutions.
pub fn add((reduced, state): (&Reduced, &State), inputs: &Inputs, [low, high]: [f64; 2], out: &mut Inspection) {
    let Ok(Some(state_loads)) = state_loads_under(reduced, inputs) else { return };
    if state_loads.friction_joints.is_empty() {
        return;
    }
    let shift = state.revolutions * reduced.period().unwrap_or(0.0);
    let positions = positions(state_loads, [low - shift, high - shift]);
    let mut slow = Slow { reduced, state_loads, inputs, scratch: Scratch::new(Some(state_loads)) };
    let mut count = 0;
    for (direction, word) in [(1.0, "forward"), (-1.0, "backward")] {
        for [from, to] in slow.arcs(&positions, direction) {
            count += 1;
            if count <= ARCS {
                let joint = reduced.locking_joint(0.5 * (from + to));
                let [from, to] = [from, to].map(|sigma| reduced.curve().describe(sigma, 0.0));
                let text = format!("friction locks slow {word} motion from {from} to {to}, mainly in this joint");
                out.facts.push(Fact::new("Friction", joint).saying(text));
            }
        }
    }
    if count == 0 {
        return;
    }
    if count > ARCS {
        out.facts.push(Fact::new("Friction", "").saying(format!("and {} more ranges", count - ARCS)));
    }
    let message = format!(
        "friction locks slow motion in {count} ranges of the travel under the loads at the start: a run that reaches \
         one of these ranges ends with an error"
    );
    let remedy = "reduce the coefficients of friction or the pin radii, or add stops before the ranges of this warning";
    out.findings.push(Finding::warning("friction", message, remedy));
}

/// Positions between these ends, closer where reactions vary faster.
fn positions(state_loads: &StateLoads, [low, high]: [f64; 2]) -> Vec<f64> {
    let table = &state_loads.table;
    let borders = (0..table.panels()).map(|panel| table.borders(panel));
    let all = borders.flat_map(|(a, b)| (0..SAMPLES).map(move |k| a + (b - a) * (k as f64 + 0.5) / SAMPLES as f64));
    let all: Vec<f64> = all.filter(|sigma| (low..=high).contains(sigma)).collect();
    let joints = state_loads.friction_joints.len();
    let most = (MOST_WORK / (joints * joints * joints)).max(2);
    let every = all.len().div_ceil(most).max(1);
    all.into_iter().step_by(every).collect()
}

/// A motion so slow that its speed has no effect but the direction of friction.
struct Slow<'a> {
    reduced: &'a Reduced,
    state_loads: &'a StateLoads,
    inputs: &'a Inputs,
    scratch: Scratch,
}

impl Slow<'_> {
    /// Whether friction locks the motion in this direction at sigma.
    fn locks(&mut self, sigma: f64, direction: f64) -> bool {
        let Self { reduced, state_loads, inputs, scratch } = self;
        let sizes = &reduced.sizes(&inputs.reals);
        let (version, airspeed) = (inputs.version(), airspeed(reduced, inputs));
        let applied = AppliedLoads { version, sizes, airspeed, revolutions: 0.0, change: None };
        let mut equation = EquationOfMotion::new(reduced, (reduced, Some(*state_loads)), applied, scratch);
        equation.mode.direction = direction;
        equation.locks_slowly(sigma, direction)
    }

    /// Intervals of sigma in which friction locks a motion in this direction.
    fn arcs(&mut self, positions: &[f64], direction: f64) -> Vec<[f64; 2]> {
        let mut arcs: Vec<[f64; 2]> = Vec::new();
        let mut before: Option<(f64, bool)> = None;
        for &sigma in positions {
            let locks = self.locks(sigma, direction);
            let edge = match before {
                Some((last, was)) if was != locks => {
                    let [a, b] = bisect(|sigma| self.locks(sigma, direction) == locks, last, sigma);
                    0.5 * (a + b)
                }
                _ => sigma,
            };
            match (before.is_some_and(|(_, was)| was), locks, arcs.last_mut()) {
                (false, true, _) => arcs.push([edge, sigma]),
                (true, true, Some(arc)) => arc[1] = sigma,
                (true, false, Some(arc)) => arc[1] = edge,
                _ => {}
            }
            before = Some((sigma, locks));
        }
        arcs
    }
}
