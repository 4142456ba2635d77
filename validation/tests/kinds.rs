//! Each kind of mechanism with usual lengths: its closed form at each position, its motion by Lagrange's equation.

use validation::kinds::{self, Off, open, run, usual};

/// Allowed error of positions relative to the size [1, rad].
const POSITION: f64 = 1e-11;
/// Allowed error of speeds, accelerations and reactions relative to the largest.
const RATES: f64 = 1e-9;
/// Largest error of the motion over the tolerance.
const MOST: f64 = 100.0;

#[test]
fn every_kind_follows_its_closed_form() {
    let mut worst = Off::default();
    let mut faults = Vec::new();
    for (place, kind) in kinds::all().iter().enumerate() {
        let sketch = usual(place, kind);
        let Ok(text) = sketch.definition() else {
            faults.push(format!("{}: no start", kind.name));
            continue;
        };
        let off = open(&text).map_err(|e| e.to_string()).and_then(|mut model| {
            run(&sketch, &mut model, 8.0 / sketch.own_motion(), 160, &mut |model, h| model.step(h))
        });
        println!("{:28} {off:?}", kind.name);
        match off {
            Err(why) => faults.push(format!("{}: {why}", kind.name)),
            Ok(off) => {
                let good = off.position < POSITION && off.rates < RATES && off.balance < RATES && off.ratio < MOST;
                if !good || off.samples < 20 {
                    faults.push(format!("{}: {off:?}", kind.name));
                }
                worst.position = worst.position.max(off.position);
            }
        }
    }
    println!("{worst:?}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The closed forms fulfil lengths, guides and fixed points over the travel.
#[test]
fn closed_forms_close_their_joints() {
    let kinds = kinds::all();
    assert!(kinds.len() >= 40, "{} kinds", kinds.len());
    for (place, kind) in kinds.iter().enumerate() {
        let sketch = usual(place, kind);
        let places = (-40..=40).filter_map(|k| sketch.gap(sketch.start[0] + 0.05 * f64::from(k)));
        let gaps: Vec<f64> = places.collect();
        let worst = gaps.iter().fold(0.0_f64, |worst, gap| worst.max(*gap));
        assert!(gaps.len() > 5 && worst < 1e-13, "{}: {worst:e} at {} places", kind.name, gaps.len());
    }
}
