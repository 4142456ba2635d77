//! Lengths that almost let branches cross: corrected if the miss is below `snap`, reported as a warning if it is above.

use crate::support::definition::{self, With, pin, rod, slider_crank};
use crate::support::{Run, assert_says, refusal};
use linkage_fmu::inspection::Inspection;
use linkage_fmu::mechanism::inspection::inspect;
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// A four-bar of rods of 1 kg/m: lengths of ground, crank, coupler and rocker; speed of the crank; guess, which is also
/// the start.
fn four_bar(lengths: [f64; 4], speed: f64, guess: [f64; 3], further: Value) -> String {
    let moving = json!({ "start": { "speed": speed }, "solver": { "tolerance": 1e-12 } });
    definition::four_bar(lengths, guess).with(moving).with(further).to_string()
}

fn parallelogram(change: f64, further: Value) -> String {
    four_bar([2.0, 1.0 + change, 2.0, 1.0], 3.0, [0.4, 0.0, 0.4], further)
}

fn texts(inspection: &Inspection, topic: &str) -> Vec<String> {
    inspection.facts.iter().filter(|fact| fact.topic == topic).map(|fact| fact.text.clone()).collect()
}

/// The crank rotates over many turns, and the rocker with it.
fn assert_rotates(text: &str, close: f64) {
    let mut run = Run::new(text).started();
    let speed = run.get("crank.speed");
    for _ in 0..500 {
        run.step(0.05);
        let (crank, rocker) = (run.get("crank.angle"), run.get("rocker.angle"));
        assert!((crank - rocker).abs() < close, "{crank} {rocker}");
        assert!((run.get("crank.speed") / speed - 1.0).abs() < close);
    }
    assert!(run.get("crank.angle").abs() > 10.0 * TAU);
}

#[test]
fn a_parallelogram_with_one_crank_longer_by_less_than_snap_goes_straight_on() {
    for power in 6..=13 {
        for sign in [1.0, -1.0] {
            let change = sign * 10f64.powi(-power);
            let text = parallelogram(change, json!({}));
            assert_rotates(&text, 1e-12 + change.abs());
            let run = Run::new(&text);
            let remarks = run.0.model().remarks();
            assert_eq!(remarks.len(), 3, "two flat positions, and the moves: {remarks:?}");
            assert_says(&remarks[0], &["less than snap = 1e-6", "crank = "]);
            assert_says(&remarks[2], &["moves points of joints by", "of crank by"]);
            assert!(run.warnings().is_empty());
            let inspection = inspect(&text);
            assert!(inspection.findings.is_empty(), "{:?}", inspection.findings);
            assert_eq!(texts(&inspection, "Snapped lengths"), remarks);
            assert_eq!(texts(&inspection, "Crossings").len(), 2);
            assert!(texts(&inspection, "Near misses").is_empty());
            // The parameters keep the user's values.
            let mut run = run;
            assert_eq!(run.get("crank.length"), 1.0 + change);
        }
    }
    let exact = Run::new(parallelogram(0.0, json!({})));
    assert!(exact.0.model().remarks().is_empty() && exact.clone().reduced().unwrap().curve().near.drawn.is_none());
}

#[test]
fn larger_misses_give_a_warning_with_the_required_snap() {
    for change in [3e-6, -3e-6, 1e-4, 1e-3] {
        let text = parallelogram(change, json!({}));
        let run = Run::new(&text);
        let warnings = run.warnings();
        assert_eq!(warnings.len(), 2, "{change}: {warnings:?}");
        let inspection = inspect(&text);
        assert_eq!(inspection.findings.len(), 2);
        assert_eq!(texts(&inspection, "Near misses").len(), 2);
        let mut cure = 0.0_f64;
        for (line, finding) in warnings.iter().zip(&inspection.findings) {
            assert_says(
                line,
                &["almost cross at ", "the lengths miss a crossing by", "turns sharply at this position"],
            );
            let snap = finding.remedy.split("\"snap\": ").nth(1).unwrap().split(' ').next().unwrap();
            cure = cure.max(snap.parse().unwrap());
        }
        // In the flat position the gap is the change of the crank's length, relative to the size 2 of the loop.
        let miss = 0.5 * change.abs();
        assert!(cure >= miss && cure < 2.1 * miss, "{change}: {cure}");
        let reduced = std::sync::Arc::clone(run.clone().reduced().unwrap());
        let near = &reduced.curve().near;
        near.misses.iter().for_each(|m| assert!((m.miss / miss - 1.0).abs() < 2.0 * change.abs() + 1e-6, "{m:?}"));
        assert_rotates(&parallelogram(change, json!({ "snap": cure })), 1e-12 + change.abs());
        // Without a larger `snap` the linkage changes to the antiparallelogram.
        let mut run = run.started();
        let mut apart = 0.0_f64;
        for _ in 0..200 {
            run.step(0.05);
            apart = apart.max((run.get("crank.angle") - run.get("rocker.angle")).abs());
        }
        assert!(apart > 1.0);
    }
}

#[test]
fn without_snap_misses_are_rejected_with_their_size() {
    for change in [1e-8, 1e-10] {
        let error = refusal(parallelogram(change, json!({ "snap": 0 })));
        assert_says(error, &["almost cross", "miss a crossing by 5.0e-", "write \"snap\": "]);
    }
    for (value, shown) in [("-1e-6", "-"), ("0.5", "0.5"), ("1e3", "1000")] {
        let text = parallelogram(0.0, json!({ "snap": value.parse::<f64>().unwrap() }));
        assert_says(refusal(text), &["snap", shown, "from 0 to 0.01"]);
    }
}

#[test]
fn a_miss_outside_the_travel_gives_no_warning() {
    let stops = |rigid: bool| {
        let stop = |limit: &str, angle: f64| match rigid {
            true => json!({ "body": "crank", "limit": limit, "angle": angle }),
            false => json!({ "body": "crank", "limit": limit, "angle": angle, "rigid": false, "stiffness": 1e5 }),
        };
        let low = stop("lower", 0.2);
        json!({ "stops": { "low": low, "high": json!({ "body": "crank", "limit": "upper", "angle": 2.9 }) } })
    };
    let inspection = inspect(&parallelogram(1e-4, stops(true)));
    assert!(inspection.findings.is_empty(), "{:?}", inspection.findings);
    assert!(texts(&inspection, "Near misses").is_empty());
    let inspection = inspect(&parallelogram(1e-4, json!({})));
    assert_eq!(inspection.findings.len(), 2);
}

/// Other linkages with a length changed by less than `snap`: the motion differs from that of the exact linkage by less
/// than the change.
#[test]
fn other_linkages_follow_their_exact_shapes() {
    let coupled = |lengths: [f64; 5]| {
        let [first, other, last, rod_a, rod_b] = lengths;
        json!({
            "name": "Coupled",
            "bodies": {
                "ground": { "points": { "middle": [2, 0], "right": [3.5, 0] } },
                "crank": rod(first, first), "second": rod(other, other), "third": rod(last, last),
                "rod_a": rod(rod_a, rod_a), "rod_b": rod(rod_b, rod_b)
            },
            "joints": {
                "a": pin("ground.origin", "crank.origin"), "b": pin("ground.middle", "second.origin"),
                "c": pin("ground.right", "third.origin"), "d": pin("crank.end", "rod_a.origin"),
                "e": pin("second.end", "rod_a.end"), "f": pin("second.end", "rod_b.origin"),
                "g": pin("third.end", "rod_b.end")
            },
            "start": { "body": "crank", "angle": 0.4, "speed": 3 },
            "guess": { "crank": 0.4, "second": 0.4, "third": 0.4, "rod_a": 0, "rod_b": 0 },
            "solver": { "tolerance": 1e-12 }
        })
        .to_string()
    };
    let slider = |crank: f64, length: f64| {
        let bodies = [rod(crank, crank), rod(length, length), json!({ "mass": 0.5 })];
        let more = json!({ "start": { "speed": 3 }, "solver": { "tolerance": 1e-12 },
            "guess": { "rod": -0.4, "guide": 1.8 } });
        slider_crank(bodies, 0.4).with(more).to_string()
    };
    let kite = |lengths: [f64; 4]| {
        let [ground, crank, coupler, rocker] = lengths;
        // Diagonal from the end of the crank to the pivot of the rocker at the crank angle 0.8 rad.
        let q = 0.8_f64;
        let (x, y) = (ground - crank * q.cos(), -crank * q.sin());
        let d = x.hypot(y);
        let line = y.atan2(x);
        let bend = ((d * d + coupler * coupler - rocker * rocker) / (2.0 * d * coupler)).acos();
        let coupler_angle = line + bend;
        let (cx, cy) =
            (crank * q.cos() + coupler * coupler_angle.cos(), crank * q.sin() + coupler * coupler_angle.sin());
        four_bar(lengths, 3.0, [q, coupler_angle, cy.atan2(cx - ground)], json!({}))
    };
    type Build<'a> = Box<dyn Fn(f64) -> String + 'a>;
    let cases: Vec<(&str, Build)> = vec![
        ("first crank", Box::new(|e| coupled([1.0 + e, 1.0, 1.0, 2.0, 1.5]))),
        ("middle crank", Box::new(|e| coupled([1.0, 1.0 + e, 1.0, 2.0, 1.5]))),
        ("rods", Box::new(|e| coupled([1.0, 1.0, 1.0, 2.0 + e, 1.5 - 0.3 * e]))),
        ("rhombus", Box::new(|e| four_bar([1.0, 1.0 + e, 1.0, 1.0], 3.0, [0.4, 0.0, 0.4], json!({})))),
        ("kite", Box::new(|e| kite([2.0, 2.0 + e, 1.0, 1.0]))),
        ("galloway", Box::new(|e| kite([1.0, 1.0 + e, 2.0, 2.0]))),
        ("crank of the slider", Box::new(|e| slider(1.0 + e, 1.0))),
        ("rod of the slider", Box::new(|e| slider(1.0, 1.0 - e))),
    ];
    for (name, build) in &cases {
        let exact = Run::new(build(0.0));
        let coordinates = exact.clone().reduced().unwrap().linkage().coordinates.clone();
        for change in [1e-13, -1e-11, 1e-9, -1e-7, 3e-7] {
            let text = build(change);
            let mut run = Run::new(text).started();
            assert!(!run.0.model().remarks().is_empty(), "{name} {change:e}");
            assert!(run.warnings().is_empty(), "{name} {change:e}: {:?}", run.warnings());
            let mut other = exact.clone().started();
            for _ in 0..100 {
                run.step(0.05);
                other.step(0.05);
                for coordinate in &coordinates {
                    let output =
                        if coordinate == "guide" { "guide.position".into() } else { format!("{coordinate}.angle") };
                    let apart = (run.get(&output) - other.get(&output)).abs();
                    assert!(apart < 1e-9 + 100.0 * change.abs(), "{name} {change:e}: {output} differs by {apart:e}");
                }
            }
        }
    }
}
