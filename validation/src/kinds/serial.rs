//! Kinds with a random number of equal parts: scissor lift, radial engine, coupled cranks.
use super::dyads::{arm, line, on};
use super::jet::{Jet, Vector};
use super::sketch::Sketch;
use super::wild::Vary;
use std::f64::consts::TAU;

/// A kind by its name in `scenes/kinds.json`.
type Program = (&'static str, fn(&mut Vary) -> Sketch);

pub const PROGRAMS: [Program; 3] =
    [("scissor", scissor), ("radial_engine", radial_engine), ("coupled_cranks", coupled_cranks)];

/// Stages of two bars at the angles phi and pi - phi, pinned in their middles.
fn scissor(vary: &mut Vary) -> Sketch {
    let bar = vary.length(1.2);
    let stages = vary.count(4, 1, 12);
    let mut out = Sketch::new("ScissorLift", vary.angle(0.7, 0.3), move |phi| {
        let (x, y) = (bar * phi.cos(), bar * phi.sin());
        // Left and right end of the bars at each level, then their middles.
        let ends = (0..=stages).flat_map(|k| [Jet::default(), x].map(|x| Vector { x, y: k as f64 * y }));
        let middles = (0..stages).map(|k| Vector { x: 0.5 * x, y: (k as f64 + 0.5) * y });
        Ok(ends.chain(middles).collect())
    })
    .ground(&[(0, [0.0, 0.0])]);
    for k in 0..stages {
        let middle = [(2 * (stages + 1) + k, [0.5 * bar, 0.0])];
        out = out.plate(&format!("a{k}"), 2 * k, 2 * k + 3, bar, &middle);
        out = out.plate(&format!("b{k}"), 2 * k + 1, 2 * k + 2, bar, &middle);
    }
    out.slider("carriage", 1, None, 0, 0.0)
}

/// A master rod, and rods on its knuckle pins.
fn radial_engine(vary: &mut Vary) -> Sketch {
    let [r, l, knuckle] = [0.06, 0.25, 0.04].map(|usual| vary.length(usual));
    let count = vary.count(5, 3, 9);
    let axis = move |k: usize| TAU * k as f64 / count as f64;
    let local = move |k: usize| [knuckle * axis(k).cos(), knuckle * axis(k).sin()];
    let (slave, long) = (l - knuckle, Jet::from(l));
    // Points: shaft, crank pin, master piston, then knuckle pin and piston of each other cylinder.
    let mut out = Sketch::new("RadialEngine", vary.angle(0.7, 3.0), move |t| {
        let o = Vector::default();
        let throw = arm(o, r, t);
        let master = line(throw, long, o, Jet::default(), 1.0)?;
        let mut out = vec![o, throw, master];
        for k in 1..count {
            let knuckle = on(throw, master, l, Vector::fixed(local(k)));
            out.extend([knuckle, line(knuckle, slave.into(), o, axis(k).into(), 1.0)?]);
        }
        Ok(out)
    })
    .ground(&[(0, [0.0, 0.0])])
    .plate("crank", 0, 1, r, &[]);
    let knuckles: Vec<(usize, [f64; 2])> = (1..count).map(|k| (2 * k + 1, local(k))).collect();
    out = out.plate("master", 1, 2, l, &knuckles).slider("piston0", 2, None, 0, 0.0);
    for k in 1..count {
        let (rod, piston) = (format!("rod{k}"), format!("piston{k}"));
        out = out.plate(&rod, 2 * k + 1, 2 * k + 2, slave, &[]).slider(&piston, 2 * k + 2, None, 0, axis(k));
    }
    out
}

/// Cranks with one coupling rod: from the third on, each is redundant.
fn coupled_cranks(vary: &mut Vary) -> Sketch {
    let count = vary.count(3, 3, 6);
    let [d, r] = [1.5, 0.3].map(|usual| vary.length(usual));
    let axle = move |k: usize| [d * k as f64, 0.0];
    let mut out = Sketch::new("CoupledCranks", vary.angle(0.6, 0.3), move |t| {
        let axles = (0..count).map(|k| Vector::fixed(axle(k)));
        Ok(axles.clone().chain(axles.map(|axle| arm(axle, r, t))).collect())
    });
    for k in 0..count {
        out = out.ground(&[(k, axle(k))]).plate(&format!("wheel{k}"), k, count + k, r, &[]);
    }
    let between: Vec<(usize, [f64; 2])> = (1..count - 1).map(|k| (count + k, axle(k))).collect();
    out.plate("coupling", count, 2 * count - 1, d * (count - 1) as f64, &between)
}
