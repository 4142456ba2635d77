//! The travel: how far the mechanism can move from its start, and what holds it at the ends.
//!
//! In: the reduced model, its stops, the start. Out: the position of each end on the curve. It must not know time.
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::laws::stop::Stop;
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::motion::contact::{End, StopKind, Travel};
use crate::mechanism::reduced::Reduced;
use crate::numerics::bracket::bisect;
use crate::numerics::table::{Table, polynomial};

/// A start this close beyond a stop [rad or m, relative to 1 and the value] is at the stop.
const AT_STOP: f64 = 1e-10;

/// Ends of the travel for a start at `sigma` after `revolutions` whole revolutions.
///
/// # Errors
/// The start is beyond a stop; a stop's quantity is not smooth.
pub fn travel(reduced: &Reduced, sigma: f64, revolutions: f64) -> Result<Travel, ModelError> {
    let mut out = [None; 2];
    for (index, stop) in reduced.loading().stops.iter().enumerate().filter(|(_, s)| s.enabled) {
        let name = format!("{}.{}", stop.name, stop.quantity);
        let table = reduced.displacement(stop.load).map_err(|at| ModelError::table(reduced, &name, at, revolutions))?;
        let growth = reduced.load_growth(stop.load);
        let at = table.position(sigma);
        let (s, slope) = (table.value(at, 0) + revolutions * growth, table.value(at, 1));
        let beyond = stop.beyond(s);
        let near = AT_STOP * (1.0 + stop.value.abs());
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
                out[side] = Some(End { position, stop: index, kind: stop_kind(reduced.loading(), index) });
            }
        }
    }
    Ok(out)
}

/// What a stop does to a mechanism that comes to it.
pub fn stop_kind(loading: &Loading, stop: usize) -> StopKind {
    let Stop { rigid, restitution, .. } = loading.stops[stop];
    if rigid {
        return StopKind::Rigid { restitution };
    }
    // State loads number the bumpers among the enabled stops.
    StopKind::Bumper(loading.stops[..stop].iter().filter(|stop| stop.enabled && !stop.rigid).count())
}

/// Refuse a start at this displacement of a stop's load if it is beyond the stop.
pub fn beyond_stop(stop: &Stop, s: f64) -> Result<(), ModelError> {
    if stop.beyond(s) > AT_STOP * (1.0 + stop.value.abs()) {
        let name = format!("{}.{}", stop.name, stop.quantity);
        return Err(ModelError::BeyondStop { name, value: stop.value, start: s });
    }
    Ok(())
}

/// Refuse a lock whose point stands still where its stop is: no force there would hold the mechanism.
pub fn can_hold(reduced: &Reduced, travel: &Travel) -> Result<(), ModelError> {
    // Part of the mechanism's size below which the path of a point for a motion of one radian is rounding.
    const STILL: f64 = 1e-9;
    let loading = reduced.loading();
    for end in travel.iter().flatten() {
        let (sigma, revolutions) = reduced.unwound(end.position);
        for (index, lock) in loading.locks.iter().enumerate().filter(|(_, lock)| lock.stop == end.stop) {
            if reduced.lock_path(index, sigma).norm() * reduced.scale() < STILL * reduced.linkage().size {
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
    /// Growth of the displacement over a revolution.
    growth: f64,
    wanted: f64,
    /// Sign of the displacement beyond the stop.
    sign: f64,
}

impl Search<'_> {
    /// sigma, counted on over whole revolutions, where the stop is first passed in this direction.
    fn first(&self, sigma: f64, revolutions: f64, direction: f64) -> Option<f64> {
        const SAMPLES: usize = 16;
        let table = self.table;
        let period = self.reduced.period();
        let start = table.panel(sigma);
        let last = table.panels() - 1;
        let (first, last) = if direction > 0.0 { (0, last) } else { (last, 0) };
        let (mut panel, mut revolution) = (start, revolutions);
        let mut at_start = true;
        loop {
            let (a, b) = table.borders(panel);
            let beyond = |x: f64| {
                let s = polynomial(table.series(panel, 0), x) + revolution * self.growth;
                self.sign * (s - self.wanted)
            };
            let sigma_at = |x: f64| 0.5 * (a + b) + 0.5 * (b - a) * x + revolution * period.unwrap_or(0.0);
            let mut x0 = if at_start { (2.0 * sigma - a - b) / (b - a) } else { -direction };
            let step = (direction - x0) / SAMPLES as f64;
            let mut slack = at_start;
            for k in 1..=SAMPLES {
                let x1 = if k == SAMPLES { direction } else { x0 + step };
                if beyond(x1) > 0.0 {
                    // A start at the stop may seem beyond it by rounding: the passage is where it comes back.
                    if !(slack && beyond(x0) >= 0.0) {
                        let [a, b] = bisect(|x| beyond(x) > 0.0, x0, x1);
                        return Some(sigma_at(0.5 * (a + b)));
                    }
                } else {
                    slack = false;
                }
                x0 = x1;
            }
            at_start = false;
            if panel == last {
                period?;
                revolution += direction;
                panel = first;
            } else {
                panel = if direction > 0.0 { panel + 1 } else { panel - 1 };
            }
            // Once round; more often only if every revolution brings the stop nearer.
            if panel == start && !self.nears(revolution, direction) && (revolution - revolutions).abs() >= 1.0 {
                return None;
            }
        }
    }

    /// Whether one more revolution brings the stop nearer, so that it may be passed in a later one.
    fn nears(&self, revolution: f64, direction: f64) -> bool {
        let s = polynomial(self.table.series(0, 0), 0.0) + revolution * self.growth;
        self.growth * direction * self.sign > 0.0 && self.sign * (s - self.wanted) < self.growth.abs()
    }
}
