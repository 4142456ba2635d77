//! The travel: how far the mechanism can move from its start, and what holds it at the ends.
//!
//! In: the reduced model, its stops, the start. Out: the place of each end on the curve. It must not know time.
use crate::mechanism::ModelError;
use crate::mechanism::loads::laws::stop::Stop;
use crate::mechanism::reduced::Reduced;
use crate::numerics::table::{Table, polynomial};

/// An end of the travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// sigma, counted on over whole turns.
    pub position: f64,
    /// Its stop.
    pub stop: usize,
}

/// The end at the low and the one at the high side of sigma, if there are such.
pub type Travel = [Option<End>; 2];

/// A start this close beyond a stop [rad or m, relative to 1 and the value] is at the stop.
const AT: f64 = 1e-10;

/// Ends of the travel for a start at `sigma` after `revolutions` whole turns.
///
/// # Errors
/// The start is beyond a stop; a stop's quantity is not smooth.
pub fn travel(reduced: &Reduced, sigma: f64, revolutions: f64) -> Result<Travel, ModelError> {
    let mut out = [None; 2];
    for (place, stop) in reduced.loading().stops.iter().enumerate().filter(|(_, s)| s.enabled) {
        let name = format!("{}.{}", stop.name, stop.quantity);
        let table = reduced.displacement(stop.load).map_err(|e| ModelError::Table {
            name: name.clone(),
            position: reduced.curve().describe(e.sigma, revolutions),
        })?;
        let growth = reduced.load_growth(stop.load);
        let spot = table.position(sigma);
        let (s, slope) = (table.value(spot, 0) + revolutions * growth, table.value(spot, 1));
        let beyond = stop.beyond(s);
        let near = AT * (1.0 + stop.value.abs());
        beyond_stop(stop, s)?;
        let sign = stop.beyond(1.0) - stop.beyond(0.0);
        for (side, direction) in [(0, -1.0), (1, 1.0)] {
            let here = sigma + revolutions * reduced.period().unwrap_or(0.0);
            let position = if beyond > -near && slope * sign * direction > 0.0 {
                Some(here)
            } else {
                let search = Search { reduced, table, growth, wanted: stop.value, sign };
                search.first(sigma, revolutions, direction)
            };
            let Some(position) = position else { continue };
            let nearer = |e: &End| (position - here).abs() < (e.position - here).abs();
            if out[side].as_ref().is_none_or(nearer) {
                out[side] = Some(End { position, stop: place });
            }
        }
    }
    Ok(out)
}

/// Refuse a start at this displacement of a stop's load if it is beyond the stop.
///
/// # Errors
/// [`ModelError::BeyondStop`].
pub fn beyond_stop(stop: &Stop, s: f64) -> Result<(), ModelError> {
    if stop.beyond(s) > AT * (1.0 + stop.value.abs()) {
        let name = format!("{}.{}", stop.name, stop.quantity);
        return Err(ModelError::BeyondStop { name, value: stop.value, start: s });
    }
    Ok(())
}

/// Refuse a lock whose point stands still where its stop is: no force there would hold the mechanism.
///
/// # Errors
/// [`ModelError::LockStill`].
pub fn can_hold(reduced: &Reduced, travel: &Travel) -> Result<(), ModelError> {
    // A part of what the mechanism's size would be for a motion of one radian: what is below it is rounding.
    const STILL: f64 = 1e-9;
    let loading = reduced.loading();
    for end in travel.iter().flatten() {
        let (sigma, revolutions) = reduced.unwound(end.position);
        for (place, lock) in loading.locks.iter().enumerate().filter(|(_, lock)| lock.stop == end.stop) {
            if reduced.lock_path(place, sigma).norm() * reduced.scale() < STILL * reduced.linkage().size {
                let (name, stop) = (lock.name.clone(), loading.stops[end.stop].name.clone());
                let position = reduced.curve().describe(sigma, revolutions);
                return Err(ModelError::LockStill { name, stop, position });
            }
        }
    }
    Ok(())
}

/// Search for the first passage of a stop along the curve.
struct Search<'a> {
    reduced: &'a Reduced,
    table: &'a Table,
    /// Growth of the displacement over a turn.
    growth: f64,
    wanted: f64,
    /// Sign of the displacement beyond the stop.
    sign: f64,
}

impl Search<'_> {
    /// sigma, counted on over whole turns, where the stop is first passed in this direction.
    fn first(&self, sigma: f64, revolutions: f64, direction: f64) -> Option<f64> {
        const SAMPLES: usize = 16;
        let table = self.table;
        let period = self.reduced.period();
        let start = table.panel(sigma);
        let (mut panel, mut turn) = (start, revolutions);
        let mut at_start = true;
        loop {
            let (a, b) = table.borders(panel);
            let beyond = |x: f64| {
                let s = polynomial(table.series(panel, 0), x) + turn * self.growth;
                self.sign * (s - self.wanted)
            };
            let sigma_at = |x: f64| 0.5 * (a + b) + 0.5 * (b - a) * x + turn * period.unwrap_or(0.0);
            let mut x0 = if at_start { (2.0 * sigma - a - b) / (b - a) } else { -direction };
            let step = (direction - x0) / SAMPLES as f64;
            let mut slack = at_start;
            for k in 1..=SAMPLES {
                let x1 = if k == SAMPLES { direction } else { x0 + step };
                if beyond(x1) > 0.0 {
                    // A start at the stop may seem beyond it by rounding: the passage is where it comes back.
                    if !(slack && beyond(x0) >= 0.0) {
                        return Some(sigma_at(bisect(&beyond, x0, x1)));
                    }
                } else {
                    slack = false;
                }
                x0 = x1;
            }
            at_start = false;
            let last = table.panels() - 1;
            let at_end = if direction > 0.0 { panel == last } else { panel == 0 };
            if at_end {
                period?;
                turn += direction;
                panel = if direction > 0.0 { 0 } else { last };
            } else {
                panel = if direction > 0.0 { panel + 1 } else { panel - 1 };
            }
            // Once round; more often only if every turn brings the stop nearer.
            if panel == start && !self.nears(turn, direction) && (turn - revolutions).abs() >= 1.0 {
                return None;
            }
        }
    }

    fn nears(&self, turn: f64, direction: f64) -> bool {
        let (_, s) = (0, polynomial(self.table.series(0, 0), 0.0) + turn * self.growth);
        self.growth * direction * self.sign > 0.0 && self.sign * (s - self.wanted) < self.growth.abs()
    }
}

/// Root of a function that is <= 0 at `a` and > 0 at `b`: bisection to the last bit.
fn bisect(f: &dyn Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if f(middle) > 0.0 { b = middle } else { a = middle }
    }
    0.5 * (a + b)
}
