//! A continuous function that is 0 at given points and changes its sign there, for a solver that searches for roots.
//!
//! In: the points, ascending. Out: the function, with the slope 1 or -1 at each point. Must not know: what the points
//! are.

/// (x - a) (b - x) / (b - a) between two neighbouring points a < b, with a sign that changes at each point. Outside the
/// points: the distance from the first or last point. Positive before the first point; 1 without points.
pub fn alternating(places: &[f64], x: f64) -> f64 {
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return 1.0 };
    let passed = places.partition_point(|place| *place <= x);
    let size = match passed {
        0 => first - x,
        n if n == places.len() => x - last,
        n => between([places[n - 1], places[n]], x),
    };
    signed(size, passed as f64)
}

/// [`alternating`] for points that repeat with `period`. The given points are within one period.
pub fn alternating_periodic(places: &[f64], x: f64, period: f64) -> f64 {
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return 1.0 };
    let periods = ((x - first) / period).floor();
    let within = (x - periods * period).max(*first);
    let passed = places.partition_point(|place| *place <= within);
    let ends = if passed == places.len() { [*last, first + period] } else { [places[passed - 1], places[passed]] };
    signed(between(ends, within), periods * places.len() as f64 + passed as f64)
}

fn between([a, b]: [f64; 2], x: f64) -> f64 {
    ((x - a) * (b - x) / (b - a)).max(0.0)
}

/// `size` with its sign after this number of sign changes.
fn signed(size: f64, changes: f64) -> f64 {
    if changes.rem_euclid(2.0) == 0.0 { size } else { -size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_changes_its_sign_at_each_place_and_nowhere_else() {
        let places = [-1.0, 0.5, 0.75, 4.0];
        for period in [None, Some(5.5), Some(7.0)] {
            let f = |x: f64| period.map_or(alternating(&places, x), |period| alternating_periodic(&places, x, period));
            let is_place = |x: f64| {
                let near = |place: &f64| {
                    let away = x - place;
                    (away - period.map_or(0.0, |period| period * (away / period).round())).abs() < 1e-9
                };
                places.iter().any(near)
            };
            let step = 1.0 / 64.0;
            for k in -2000..2000 {
                let x = f64::from(k) * step;
                let [before, at, after] = [x - 0.5 * step, x, x + 0.5 * step].map(f);
                assert!((after - before).abs() <= 1.01 * step, "{period:?} {x}: {before} {after}");
                if is_place(x) {
                    assert!(at.abs() < 1e-12 && before * after < 0.0, "{period:?} {x}: {before} {at} {after}");
                } else {
                    assert!(at != 0.0 && before * after > 0.0, "{period:?} {x}: {before} {at} {after}");
                }
            }
        }
        assert_eq!((alternating(&[], 3.0), alternating_periodic(&[], 3.0, 1.0)), (1.0, 1.0));
    }
}
