//! Piston engines and locomotives.
use super::Kind;
use super::dyads::{arm, fixed, line, on};
use super::jet::Jet;
use super::sketch::Sketch;
use super::vary::Vary;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub const KINDS: &[Kind] = &[
    ("inline engine", inline_engine),
    ("V engine", vee_engine),
    ("radial engine", radial_engine),
    ("coupled cranks", coupled_cranks),
    ("locomotive", locomotive),
];

/// Four cylinders in a row: two throws of the crank point one way, two the other.
fn inline_engine(vary: &mut Vary) -> Sketch {
    let [r, l] = vary.lengths([0.05, 0.16]);
    let mut out = Sketch::new("InlineEngine", vary.angle(0.7, 3.0), move |t| {
        let o = fixed(0.0, 0.0);
        let throws = [arm(o, r, t), arm(o, -r, t)];
        let mut out = vec![o, throws[0], throws[1]];
        for k in 0..4 {
            out.push(line(throws[usize::from(k == 1 || k == 2)], l, o, FRAC_PI_2.into(), 1.0)?);
        }
        Ok(out)
    })
    .ground(&[(0, [0.0, 0.0])])
    .plate("crank", 0, 1, r, &[(2, [-r, 0.0])]);
    for k in 0..4 {
        let throw = 1 + usize::from(k == 1 || k == 2);
        out = out.rod(&format!("rod{k}"), throw, 3 + k, l).slider(&format!("piston{k}"), 3 + k, 0, FRAC_PI_2);
    }
    out
}

/// Two rods on one throw.
fn vee_engine(vary: &mut Vary) -> Sketch {
    let [r, l] = vary.lengths([0.05, 0.16]);
    let half = vary.angle(0.25 * PI, 0.2);
    let axes = [FRAC_PI_2 - half, FRAC_PI_2 + half];
    Sketch::new("VeeEngine", vary.angle(0.7, 3.0), move |t| {
        let o = fixed(0.0, 0.0);
        let throw = arm(o, r, t);
        let [a, b] = axes.map(|axis| line(throw, l, o, axis.into(), 1.0));
        Ok(vec![o, throw, a?, b?])
    })
    .ground(&[(0, [0.0, 0.0])])
    .rod("crank", 0, 1, r)
    .rod("right_rod", 1, 2, l)
    .rod("left_rod", 1, 3, l)
    .slider("right_piston", 2, 0, axes[0])
    .slider("left_piston", 3, 0, axes[1])
}

/// A master rod and rods on its knuckles.
fn radial_engine(vary: &mut Vary) -> Sketch {
    let [r, l, knuckle] = vary.lengths([0.06, 0.25, 0.04]);
    let count = vary.count(5, 3, 9);
    let axis = move |k: usize| TAU * k as f64 / count as f64;
    let local = move |k: usize| [knuckle * axis(k).cos(), knuckle * axis(k).sin()];
    let slave = l - knuckle;
    // Points: shaft, throw, master piston, then knuckle and piston of each other cylinder.
    let mut out = Sketch::new("RadialEngine", vary.angle(0.7, 3.0), move |t| {
        let o = fixed(0.0, 0.0);
        let throw = arm(o, r, t);
        let master = line(throw, l, o, Jet::default(), 1.0)?;
        let mut out = vec![o, throw, master];
        for k in 1..count {
            let knuckle = on(throw, master, l, local(k));
            out.extend([knuckle, line(knuckle, slave, o, axis(k).into(), 1.0)?]);
        }
        Ok(out)
    })
    .ground(&[(0, [0.0, 0.0])])
    .rod("crank", 0, 1, r);
    let knuckles: Vec<(usize, [f64; 2])> = (1..count).map(|k| (2 * k + 1, local(k))).collect();
    out = out.plate("master", 1, 2, l, &knuckles).slider("piston0", 2, 0, 0.0);
    for k in 1..count {
        let piston = format!("piston{k}");
        out = out.rod(&format!("rod{k}"), 2 * k + 1, 2 * k + 2, slave).slider(&piston, 2 * k + 2, 0, axis(k));
    }
    out
}

/// Wheels with one coupling rod: from the third on, each holds what is held already.
fn wheels(name: &'static str, count: usize, [d, r]: [f64; 2], start: f64) -> Sketch {
    let mut out = Sketch::new(name, start, move |t| {
        let axle = |k: usize| fixed(d * k as f64, 0.0);
        let pins = (0..count).map(|k| arm(axle(k), r, t));
        Ok((0..count).map(axle).chain(pins).collect())
    });
    for k in 0..count {
        out = out.ground(&[(k, [d * k as f64, 0.0])]).rod(&format!("wheel{k}"), k, count + k, r);
    }
    let between: Vec<(usize, [f64; 2])> = (1..count - 1).map(|k| (count + k, [d * k as f64, 0.0])).collect();
    out.plate("coupling", count, 2 * count - 1, d * (count - 1) as f64, &between)
}

fn coupled_cranks(vary: &mut Vary) -> Sketch {
    let count = vary.count(3, 3, 6);
    wheels("CoupledCranks", count, vary.lengths([1.5, 0.3]), vary.angle(0.6, 0.3))
}

/// Three coupled wheels, driven by a crosshead.
fn locomotive(vary: &mut Vary) -> Sketch {
    let [d, r, rod] = vary.lengths([1.5, 0.3, 2.2]);
    let mut out = wheels("Locomotive", 3, [d, r], vary.angle(0.6, 0.3));
    let wheels = std::mem::replace(&mut out.places, Box::new(|_| Ok(Vec::new())));
    out.places = Box::new(move |t| {
        let mut out = wheels(t)?;
        let crosshead = line(out[3], rod, fixed(0.0, 0.0), Jet::default(), -1.0)?;
        out.push(crosshead);
        Ok(out)
    });
    out.rod("main_rod", 6, 3, rod).slider("crosshead", 6, 0, 0.0)
}
