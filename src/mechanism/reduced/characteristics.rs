//! Where nonlinear springs bind a reduced model: borders of panels at the points of their curves, and what they refuse.
//!
//! In: a curve, the laws of the springs. Out: the grid of the tables, or why a spring has no force somewhere. It must
//! not know states or inputs.
use super::error::ReductionError;
use crate::mechanism::curve::{Configuration, Curve, Scratch};
use crate::mechanism::loads::laws::spring::{Characteristic, Spring};
use crate::mechanism::loads::resolved::Loading;
use crate::numerics::bracket::{bisect, false_position};
use crate::numerics::enclosure::{Interval, polynomial_bounds};
use crate::numerics::order;
use crate::numerics::table::{ACCURACY, Table};

/// Parts of a panel of the grid in which a displacement is searched for the points of a spring's curve.
const PARTS: usize = 4;
/// Distance to which the position of such a point is found, in panels of the grid.
const CLOSE: f64 = 1e-12;
/// Least width of a panel beside it, in panels of the grid or, where that is less, in distances to the next point.
const NARROW: f64 = 0.05;
/// Least distance to the next point that counts there, in panels of the grid.
const LEAST: f64 = 1e-9;
/// Parts of a panel in which the place is searched where a gas has no volume left.
const SAMPLES: usize = 64;

/// Borders of the panels of tables: the curve's, and the places where a spring passes a point of its curve, where its
/// third derivative jumps. A place that is missed costs narrower panels and no accuracy, unless all of a characteristic
/// lies between two nodes of a panel: far from the guess panels are wide beside it.
/// The characteristic of a spring that winds up over each revolution is in no table: it is another one in each.
pub(super) fn grid(curve: &Curve, loading: &Loading) -> Vec<f64> {
    let mut borders = curve.grid(ACCURACY);
    let mut passed = Vec::new();
    for spring in &loading.springs {
        if !spring.knots().is_empty() && loading.loads[spring.load].growth(curve) == 0.0 {
            passages(curve, loading, spring, &borders, &mut passed);
        }
    }
    for Passage { at, gap } in passed {
        let next = borders.partition_point(|border| *border < at);
        if next == 0 || next == borders.len() {
            continue;
        }
        let (low, high) = (borders[next - 1], borders[next]);
        // A crossing stays the middle of its panel.
        if curve.crossings.iter().any(|crossing| low < *crossing && *crossing < high) {
            continue;
        }
        let margin = NARROW * (high - low).min(gap.max(LEAST * (high - low)));
        if at - low >= margin && high - at >= margin {
            borders.insert(next, at);
        } else if next - 1 > 0 && at - low < margin && at != low {
            borders[next - 1] = at;
        } else if next + 1 < borders.len() && high - at < margin {
            borders[next] = at;
        }
    }
    borders
}

/// A value of sigma at which the displacement of a spring passes a point of its curve.
struct Passage {
    at: f64,
    /// Distance to the nearest other one of the spring.
    gap: f64,
}

/// All of them, in their order.
fn passages(curve: &Curve, loading: &Loading, spring: &Spring, borders: &[f64], out: &mut Vec<Passage>) {
    let (mut scratch, mut c) = (Scratch::default(), Configuration::default());
    let load = &loading.loads[spring.load];
    let mut displacement = |sigma: f64| {
        curve.configure(sigma, &mut scratch, &mut c);
        load.displacement(curve.linkage(), &c)[0]
    };
    let mut found_at = Vec::new();
    let mut before = (borders[0], displacement(borders[0]));
    for panel in borders.windows(2) {
        let width = panel[1] - panel[0];
        for part in 1..=PARTS {
            let sigma = panel[0] + width * part as f64 / PARTS as f64;
            let after = (sigma, displacement(sigma));
            let [low, high] = [before.1.min(after.1), before.1.max(after.1)];
            for knot in spring.knots().iter().filter(|knot| low < **knot && **knot < high) {
                let sign = (after.1 - before.1).signum();
                let from_knot = |s: f64| sign * (s - knot);
                let ends = [before, after].map(|(sigma, s)| (sigma, from_knot(s)));
                let found = false_position(|sigma| from_knot(displacement(sigma)), ends[0], ends[1], CLOSE * width);
                found_at.push(found);
            }
            before = after;
        }
    }
    order::sort(&mut found_at);
    out.extend(found_at.iter().enumerate().map(|(k, &at)| {
        let before = k.checked_sub(1).map_or(f64::INFINITY, |before| at - found_at[before]);
        let after = found_at.get(k + 1).map_or(f64::INFINITY, |after| after - at);
        Passage { at, gap: before.min(after) }
    }));
}

/// Refuse a gas spring that has no volume somewhere on the curve; `displacement`: the table of the displacement of a
/// load.
///
/// # Errors
/// A gas has no volume, so that its force is infinite.
pub(super) fn check_volumes<'t>(
    curve: &Curve,
    loading: &Loading,
    displacement: impl Fn(usize) -> Option<&'t Table>,
) -> Result<(), ReductionError> {
    for spring in &loading.springs {
        let Some(Characteristic::Gas(gas)) = &spring.characteristic else { continue };
        let (Some(table), least) = (displacement(spring.load), spring.free - gas.volume / gas.area) else { continue };
        let whole = Interval { low: -1.0, high: 1.0 };
        let is_empty = |panel: &usize| polynomial_bounds(table.series(*panel, 0), whole)[0].low <= least;
        if let Some(panel) = (0..table.panels()).find(is_empty) {
            let position = curve.describe(first_at_most(table, panel, least), 0.0);
            return Err(ReductionError::NoVolume { name: spring.name.clone(), least, position });
        }
    }
    Ok(())
}

/// Where in this panel a table comes down to `least` first; where it is least if it is above everywhere.
fn first_at_most(table: &Table, panel: usize, least: f64) -> f64 {
    let (a, b) = table.borders(panel);
    let value = |sigma: f64| table.value(table.position_near(sigma, panel), 0);
    let all: Vec<f64> = (0..=SAMPLES).map(|k| a + (b - a) * k as f64 / SAMPLES as f64).collect();
    match all.iter().position(|sigma| value(*sigma) <= least) {
        Some(0) => a,
        Some(k) => bisect(|sigma| value(sigma) <= least, all[k - 1], all[k])[1],
        None => all.iter().copied().min_by(|one, other| value(*one).total_cmp(&value(*other))).unwrap_or(a),
    }
}
