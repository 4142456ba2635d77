use super::*;
use crate::closure::{Closure, guessed};
use crate::definition::Mechanism;
use crate::linkage::Linkage;

const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");

fn with_curve(text: &str, check: impl Fn(&Curve)) {
    let mechanism = Mechanism::from_json(text).unwrap();
    let linkage = Linkage::new(&mechanism).unwrap();
    let guess = guessed(&linkage, &mechanism.guess).unwrap();
    let (closure, q) = Closure::assemble(std::sync::Arc::new(linkage), &guess).unwrap();
    check(&Curve::trace(closure, &q).unwrap());
}

#[test]
fn the_gear_runs_round_a_closed_curve_through_both_toggles() {
    with_curve(GEAR, |curve| {
        let Ends::Closed(growth) = curve.ends() else { panic!("open") };
        assert!(growth.iter().all(|g| *g == 0.0), "a rocker does not turn fully: {growth:?}");
        assert!(curve.crossings().is_empty());
        let (first, last) = curve.range();
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
        let (first, last) = curve.range();
        let h = 1e-4;
        for i in 0..200 {
            let sigma = first + (last - first) * (f64::from(i) + 0.5) / 200.0;
            let (a, c, b) =
                (curve.configuration(sigma - h), curve.configuration(sigma), curve.configuration(sigma + h));
            let linkage = &*curve.closure().linkage;
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

use super::panel::twice_kinetic;

#[test]
fn a_flat_parallelogram_is_crossed_straight_on() {
    let text = r#"{ "name": "Parallelogram",
      "bodies": { "ground": { "length": 2 }, "a": { "length": 1, "mass": 1, "shape": "uniform_rod" },
        "b": { "length": 2, "mass": 1, "shape": "uniform_rod" }, "c": { "length": 1, "mass": 1, "shape": "uniform_rod" } },
      "joints": { "1": { "type": "revolute", "first": "ground.origin", "second": "a.origin" },
        "2": { "type": "revolute", "first": "a.end", "second": "b.origin" },
        "3": { "type": "revolute", "first": "b.end", "second": "c.end" },
        "4": { "type": "revolute", "first": "ground.end", "second": "c.origin" } },
      "start": { "body": "a", "angle": 1 }, "guess": { "a": 1, "b": 0, "c": 1 } }"#
        .replace("\"1\"", "\"p\"")
        .replace("\"2\"", "\"q\"")
        .replace("\"3\"", "\"r\"")
        .replace("\"4\"", "\"s\"");
    with_curve(&text, |curve| {
        let Ends::Closed(growth) = curve.ends() else { panic!("open") };
        assert!((growth[0].abs() - std::f64::consts::TAU).abs() < 1e-9 && growth[1] == 0.0, "{growth:?}");
        assert_eq!(curve.crossings().len(), 2);
        let (first, last) = curve.range();
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
