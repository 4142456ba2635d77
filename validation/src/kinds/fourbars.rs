//! Four-bar linkages and what is made of them.
use super::Kind;
use super::dyads::{arm, circles, fixed, on};
use super::jet::Vector;
use super::sketch::Sketch;
use super::vary::Vary;
use std::f64::consts::{FRAC_PI_2, PI};

pub const KINDS: &[Kind] = &[
    ("crank-rocker", crank_rocker),
    ("drag link", drag_link),
    ("triple rocker", triple_rocker),
    ("parallelogram", parallelogram),
    ("antiparallelogram", antiparallelogram),
    ("rhombus", rhombus),
    ("kite of Galloway", kite),
    ("double parallelogram", double_parallelogram),
    ("windscreen wiper", windscreen_wiper),
    ("pump jack", pump_jack),
    ("treadle", treadle),
    ("pantograph", pantograph),
];

/// A four-bar linkage: ground d, crank a, coupler b with a point in its frame, follower c; on which side of the line
/// from the crank's end to the follower's bearing their pin is.
pub fn four_bar(name: &'static str, [d, a, b, c]: [f64; 4], point: [f64; 2], start: f64, side: f64) -> Sketch {
    Sketch::new(name, start, move |t| {
        let (o, far) = (fixed(0.0, 0.0), fixed(d, 0.0));
        let crank = arm(o, a, t);
        let pin = circles(crank, b, far, c, side)?;
        Ok(vec![o, far, crank, pin, on(crank, pin, b, point)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0])])
    .rod("crank", 0, 2, a)
    .plate("coupler", 2, 3, b, &[(4, point)])
    .rod("follower", 1, 3, c)
}

fn crank_rocker(vary: &mut Vary) -> Sketch {
    four_bar("CrankRocker", vary.lengths([0.4, 0.12, 0.35, 0.3]), [0.1, 0.05], vary.angle(0.7, 3.0), 1.0)
}

fn drag_link(vary: &mut Vary) -> Sketch {
    four_bar("DragLink", vary.lengths([0.1, 0.3, 0.25, 0.28]), [0.1, 0.05], vary.angle(0.7, 3.0), 1.0)
}

fn triple_rocker(vary: &mut Vary) -> Sketch {
    four_bar("TripleRocker", vary.lengths([0.5, 0.3, 0.2, 0.3]), [0.1, -0.05], vary.angle(1.1, 0.2), 1.0)
}

/// A parallelogram stays one: its follower turns as its crank does.
fn parallelogram(vary: &mut Vary) -> Sketch {
    let [d, a] = vary.lengths([0.4, 0.1]);
    parallel("Parallelogram", d, a, vary.angle(0.5, 0.4))
}

fn rhombus(vary: &mut Vary) -> Sketch {
    let a = vary.length(0.25);
    parallel("Rhombus", a, a, vary.angle(0.8, 0.5))
}

fn parallel(name: &'static str, d: f64, a: f64, start: f64) -> Sketch {
    Sketch::new(name, start, move |t| {
        let (o, far) = (fixed(0.0, 0.0), fixed(d, 0.0));
        Ok(vec![o, far, arm(o, a, t), arm(far, a, t)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0])])
    .rod("crank", 0, 2, a)
    .rod("coupler", 2, 3, d)
    .rod("follower", 1, 3, a)
}

/// tan(follower / 2) = (a + d) / (a - d) tan(crank / 2), through its flat positions too.
fn antiparallelogram(vary: &mut Vary) -> Sketch {
    let [d, a] = vary.lengths([0.4, 0.15]);
    Sketch::new("Antiparallelogram", vary.angle(0.5, 0.4), move |t| {
        let (o, far, half) = (fixed(0.0, 0.0), fixed(d, 0.0), 0.5 * t);
        let follower = 2.0 * ((a + d) * half.sin()).atan2((a - d) * half.cos());
        Ok(vec![o, far, arm(o, a, t), arm(far, a, follower)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0])])
    .rod("crank", 0, 2, a)
    .rod("coupler", 2, 3, d)
    .rod("follower", 1, 3, a)
}

/// Ground and crank are equal, coupler and follower too: their pin is on the crank's bisector, and the follower makes
/// one turn for two of the crank.
fn kite(vary: &mut Vary) -> Sketch {
    let [a, l] = vary.lengths([0.1, 0.25]);
    Sketch::new("Kite", vary.angle(1.0, 0.5), move |t| {
        let (o, half) = (fixed(0.0, 0.0), 0.5 * t);
        let along = a * half.cos() + (super::jet::Jet::from(l * l) - (a * half.sin()).squared()).sqrt();
        Ok(vec![o, fixed(a, 0.0), arm(o, a, t), along * Vector::unit(half)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [a, 0.0])])
    .rod("crank", 0, 2, a)
    .rod("coupler", 2, 3, l)
    .rod("follower", 1, 3, l)
}

/// Two parallelograms with a bell crank between them.
fn double_parallelogram(vary: &mut Vary) -> Sketch {
    let [d, a, b, h] = vary.lengths([0.4, 0.1, 0.15, 0.3]);
    Sketch::new("DoubleParallelogram", vary.angle(0.6, 0.3), move |t| {
        let (o, far, top) = (fixed(0.0, 0.0), fixed(d, 0.0), fixed(d, h));
        let up = t + FRAC_PI_2.into();
        Ok(vec![o, far, top, arm(o, a, t), arm(far, a, t), arm(far, b, up), arm(top, b, up)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0]), (2, [d, h])])
    .rod("crank", 0, 3, a)
    .rod("coupler", 3, 4, d)
    .plate("bell", 1, 4, a, &[(5, [0.0, b])])
    .rod("link", 5, 6, h)
    .rod("output", 2, 6, b)
}

/// A crank-rocker, and a second wiper by a link.
fn windscreen_wiper(vary: &mut Vary) -> Sketch {
    let [d, a, b, c, r, apart, link] = vary.lengths([0.3, 0.05, 0.3, 0.09, 0.08, 0.5, 0.5]);
    Sketch::new("WindscreenWiper", vary.angle(0.7, 3.0), move |t| {
        let (o, near, far) = (fixed(0.0, 0.0), fixed(d, 0.0), fixed(d + apart, 0.02));
        let crank = arm(o, a, t);
        let pin = circles(crank, b, near, c, 1.0)?;
        let second = on(near, pin, c, [0.0, -r]);
        Ok(vec![o, near, far, crank, pin, second, circles(second, link, far, r, 1.0)?])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0]), (2, [d + apart, 0.02])])
    .rod("crank", 0, 3, a)
    .rod("rod", 3, 4, b)
    .plate("wiper", 1, 4, c, &[(5, [0.0, -r])])
    .rod("link", 5, 6, link)
    .rod("other_wiper", 2, 6, r)
}

/// Crank, pitman, walking beam, and the rod in its well.
fn pump_jack(vary: &mut Vary) -> Sketch {
    let [a, b, c, head, rod] = vary.lengths([0.6, 2.4, 1.8, 2.0, 3.0]);
    let (samson, well) = ([1.6, 2.6], [3.6, 0.0]);
    Sketch::new("PumpJack", vary.angle(0.7, 3.0), move |t| {
        let (o, top) = (fixed(0.0, 0.0), Vector::fixed(samson));
        let crank = arm(o, a, t);
        let pin = circles(crank, b, top, c, 1.0)?;
        let end = on(top, pin, c, [-head, 0.0]);
        let polished = super::dyads::line(end, rod, Vector::fixed(well), FRAC_PI_2.into(), -1.0)?;
        Ok(vec![o, top, Vector::fixed(well), crank, pin, end, polished])
    })
    .ground(&[(0, [0.0, 0.0]), (1, samson), (2, well)])
    .rod("crank", 0, 3, a)
    .rod("pitman", 3, 4, b)
    .plate("beam", 1, 4, c, &[(5, [-head, 0.0])])
    .rod("hanger", 5, 6, rod)
    .slider("polished", 6, 2, FRAC_PI_2)
}

/// A pedal that drives a flywheel's crank.
fn treadle(vary: &mut Vary) -> Sketch {
    let [a, b, c] = vary.lengths([0.05, 0.62, 0.3]);
    let pivot = [-0.25, -0.6];
    Sketch::new("Treadle", vary.angle(2.0, 3.0), move |t| {
        let (o, hinge) = (fixed(0.0, 0.0), Vector::fixed(pivot));
        let crank = arm(o, a, t);
        let pin = circles(crank, b, hinge, c, 1.0)?;
        Ok(vec![o, hinge, crank, pin, on(hinge, pin, c, [0.1, 0.02])])
    })
    .ground(&[(0, [0.0, 0.0]), (1, pivot)])
    .rod("flywheel", 0, 2, a)
    .rod("pitman", 2, 3, b)
    .plate("pedal", 1, 3, c, &[(4, [0.1, 0.02])])
}

/// The tracer P on a crank, its pen k times as far from the fixed point.
fn pantograph(vary: &mut Vary) -> Sketch {
    let [a, b, r, x] = vary.lengths([0.2, 0.18, 0.06, 0.25]);
    let k = 2.5;
    let center = [x, 0.05];
    Sketch::new("Pantograph", vary.angle(0.4, PI), move |t| {
        let o = fixed(0.0, 0.0);
        let tracer = arm(Vector::fixed(center), r, t);
        let middle = circles(o, a, tracer, b, 1.0)?;
        let elbow = k * middle;
        Ok(vec![o, Vector::fixed(center), tracer, middle, elbow, elbow + tracer - middle, k * tracer])
    })
    .ground(&[(0, [0.0, 0.0]), (1, center)])
    .rod("crank", 1, 2, r)
    .plate("upper", 0, 4, k * a, &[(3, [a, 0.0])])
    .plate("lower", 4, 6, k * b, &[(5, [b, 0.0])])
    .rod("near", 3, 2, b)
    .rod("far", 5, 2, (k - 1.0) * a)
}
