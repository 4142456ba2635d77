use super::kinetic::twice_kinetic;
use super::*;
use crate::mechanism::GEAR;
use crate::mechanism::closure::{Closure, guessed};
use crate::mechanism::definition::Mechanism;
use crate::mechanism::linkage::Linkage;

fn assembled(text: &str) -> (Closure, Vec<f64>) {
    let mechanism = Mechanism::from_json(text).unwrap();
    let linkage = Linkage::new(&mechanism).unwrap();
    let guess = guessed(&linkage, &mechanism.guess).unwrap();
    Closure::assemble(std::sync::Arc::new(linkage), &guess).unwrap()
}

fn with_curve(text: &str, check: impl Fn(&Curve)) {
    let (closure, q) = assembled(text);
    check(&Curve::trace(closure, &q, None).unwrap());
}

#[test]
fn the_gear_runs_round_a_closed_curve_through_both_toggles() {
    with_curve(GEAR, |curve| {
        let Ends::Closed(growth) = &curve.ends else { panic!("open") };
        assert!(growth.iter().all(|g| *g == 0.0), "a rocker does not turn fully: {growth:?}");
        assert!(curve.crossings.is_empty());
        let (first, last) = curve.range;
        let crank: Vec<f64> =
            (0..4000).map(|i| curve.configuration(first + (last - first) * f64::from(i) / 4000.0).q[0]).collect();
        let (low, high) = crank.iter().fold((0.0f64, 0.0f64), |(a, b), c| (a.min(*c), b.max(*c)));
        // Toggle: cos(theta2) = (l1^2 + l2^2 - (l3 + l4)^2) / (2 l1 l2).
        let cosine: f64 = (0.5729f64.powi(2) + 0.1755f64.powi(2) - 0.557f64.powi(2)) / (2.0 * 0.5729 * 0.1755);
        assert!((high - cosine.acos()).abs() < 1e-4 && (low + cosine.acos()).abs() < 1e-4, "{low} {high}");
        println!("{} panels, length {}", curve.panels.len(), last - first);
    });
}

#[test]
fn derivatives_along_the_curve_are_differences_and_loops_stay_closed() {
    with_curve(GEAR, |curve| {
        let (first, last) = curve.range;
        let h = 1e-4;
        for i in 0..200 {
            let sigma = first + (last - first) * (f64::from(i) + 0.5) / 200.0;
            let (a, c, b) =
                (curve.configuration(sigma - h), curve.configuration(sigma), curve.configuration(sigma + h));
            let linkage = &*curve.closure.linkage;
            assert!(linkage.gaps(&c.positions).iter().all(|g| g.abs() < 1e-15));
            assert!((twice_kinetic(linkage, &c.positions, &c.rates) - 1.0).abs() < 1e-14);
            for k in 0..3 {
                let scale = 1.0 + c.q_second[k].abs();
                // Truncation h^2 / 6 of the third derivative; round-off / h^2 = 1e-7 for the second difference.
                assert!(((b.q[k] - a.q[k]) / (2.0 * h) - c.q_sigma[k]).abs() < 1e-5 * scale, "{i} {k}");
                assert!(((b.q[k] - 2.0 * c.q[k] + a.q[k]) / (h * h) - c.q_second[k]).abs() < 1e-3 * scale, "{i} {k}");
            }
        }
    });
}

#[test]
fn a_flat_parallelogram_is_crossed_straight_on() {
    let text = r#"{ "name": "Parallelogram",
      "bodies": { "ground": { "length": 2 }, "a": { "length": 1, "mass": 1, "shape": "uniform_rod" },
        "b": { "length": 2, "mass": 1, "shape": "uniform_rod" }, "c": { "length": 1, "mass": 1,
            "shape": "uniform_rod" } },
      "joints": { "p": { "type": "revolute", "first": "ground.origin", "second": "a.origin" },
        "q": { "type": "revolute", "first": "a.end", "second": "b.origin" },
        "r": { "type": "revolute", "first": "b.end", "second": "c.end" },
        "s": { "type": "revolute", "first": "ground.end", "second": "c.origin" } },
      "start": { "body": "a", "angle": 1 }, "guess": { "a": 1, "b": 0, "c": 1 } }"#;
    with_curve(text, |curve| {
        let Ends::Closed(growth) = &curve.ends else { panic!("open") };
        assert!((growth[0].abs() - std::f64::consts::TAU).abs() < 1e-9 && growth[1] == 0.0, "{growth:?}");
        assert_eq!(curve.crossings.len(), 2);
        let (first, last) = curve.range;
        // Coupler translates: T = (1/2)(1/3 + 1 + 1/3) omega^2, so one turn has length 2 pi sqrt(5/3).
        assert!((last - first - std::f64::consts::TAU * (5.0f64 / 3.0).sqrt()).abs() < 1e-12, "{}", last - first);
        for i in 0..1000 {
            let c = curve.configuration(first + (last - first) * f64::from(i) / 1000.0);
            assert!(c.q[1].abs() < 1e-12 && (c.q[0] - c.q[2]).abs() < 1e-12, "{:?}", c.q);
        }
        let grid = curve.grid(1e-13);
        assert!(grid.windows(2).all(|w| w[1] > w[0]), "{grid:?}");
    });
}

/// The gear's curve through the crank's angle `start`, traced where `margin` of the crank's angle is positive.
fn within(start: f64, margin: &mut dyn FnMut(f64) -> f64) -> Result<Curve, CurveError> {
    let (closure, q) = assembled(GEAR);
    let whole = Curve::trace(closure.clone(), &q, None).unwrap();
    // On the branch of the guess the crank's angle grows or falls along sigma until its toggle: bisect.
    let (first, last) = whole.range;
    let step = (last - first) * 1e-3 * (whole.configuration(0.0).q_sigma[0] * (start - q[0])).signum();
    let at = |sigma: f64| whole.configuration((sigma - first).rem_euclid(last - first) + first);
    let (mut a, mut b) = (0.0, 0.0);
    while (at(b).q[0] - start) * (q[0] - start) > 0.0 {
        (a, b) = (b, b + step);
    }
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        *(if (at(middle).q[0] - start) * (q[0] - start) > 0.0 { &mut a } else { &mut b }) = middle;
    }
    let mut q = if start == q[0] { q } else { at(b).q };
    q[0] = start;
    Curve::trace(closure, &q, Some(&mut |p| margin(p.angle[1])))
}

#[test]
fn travel_ends_exactly_at_its_limits() {
    let (low, high) = (-1.3, 0.8);
    // From inside, from the one limit and from the other.
    for start in [0.3, low, high] {
        let curve = within(start, &mut |crank| (crank - low).min(high - crank)).unwrap();
        assert_eq!(curve.ends, Ends::Stopped { low: true, high: true });
        let (first, last) = curve.range;
        assert!(first <= 0.0 && last >= 0.0 && last > first + 1.0);
        let mut ends = [curve.configuration(first).q[0], curve.configuration(last).q[0]];
        ends.sort_by(f64::total_cmp);
        assert!((ends[0] - low).abs() < 4e-15 && (ends[1] - high).abs() < 4e-15, "{ends:?}");
        for i in 0..=100 {
            let crank = curve.configuration(first + (last - first) * f64::from(i) / 100.0).q[0];
            assert!(crank > low - 1e-14 && crank < high + 1e-14, "{crank}");
        }
        let grid = curve.grid(1e-13);
        assert!(grid[0] == first && grid[grid.len() - 1] == last && grid.windows(2).all(|w| w[1] > w[0]), "{grid:?}");
    }
}

#[test]
fn one_limit_is_met_from_both_sides_and_a_limit_out_of_reach_by_none() {
    // Over the toggle at 1.32 rad and back on the other branch.
    let curve = within(0.8, &mut |crank| crank + 0.4).unwrap();
    assert_eq!(curve.ends, Ends::Stopped { low: true, high: true });
    let (first, last) = curve.range;
    for sigma in [first, last] {
        assert!((curve.configuration(sigma).q[0] + 0.4).abs() < 1e-15);
    }
    let free = within(0.8, &mut |crank| crank + 1.4).unwrap();
    assert!(matches!(free.ends, Ends::Closed(_)));
    assert!(within(0.8, &mut |crank| 0.7 - crank).is_err_and(|e| e.to_string().contains("no motion")));
}

#[test]
fn travel_that_is_left_between_two_nodes_ends_there() {
    // The limit is just below the toggle: the crank is beyond it on a range far shorter than the distance of nodes.
    let cosine: f64 = (0.5729f64.powi(2) + 0.1755f64.powi(2) - 0.557f64.powi(2)) / (2.0 * 0.5729 * 0.1755);
    for hair in [1e-3, 1e-6, 1e-9] {
        let limit = cosine.acos() - hair;
        let curve = within(0.3, &mut |crank| limit - crank).unwrap();
        assert_eq!(curve.ends, Ends::Stopped { low: true, high: true }, "{hair}");
        let (first, last) = curve.range;
        for sigma in [first, last] {
            assert!((curve.configuration(sigma).q[0] - limit).abs() < 1e-14, "{hair}");
        }
    }
}

#[test]
fn an_open_curve_is_stopped_at_one_end() {
    let text = r#"{ "name": "Slide", "bodies": { "ground": {}, "block": { "mass": 2 } },
      "joints": { "x": { "type": "prismatic", "first": "ground.origin", "second": "block.origin" } },
      "start": { "joint": "x", "position": 0 }, "guess": { "x": 0 } }"#;
    let (closure, q) = assembled(text);
    let curve = Curve::trace(closure.clone(), &q, Some(&mut |p| 0.7 - p.origin[1].x)).unwrap();
    let Ends::Stopped { low, high } = curve.ends else { panic!("{:?}", curve.ends) };
    assert!(low != high);
    let (first, last) = curve.range;
    let end = if high { last } else { first };
    assert!((curve.configuration(end).q[0] - 0.7).abs() < 1e-15 && last - first > 100.0);
    let open = Curve::trace(closure, &q, Some(&mut |_| 1.0)).unwrap();
    assert_eq!(open.ends, Ends::Open);
}
