//! The six-bar linkages of Watt and Stephenson. A chain of Watt has two bodies of three pins that share one; in a chain
//! of Stephenson those two do not touch.
use super::Kind;
use super::dyads::{arm, circles, fixed, on};
use super::jet::Vector;
use super::sketch::{Coordinate, Sketch};
use super::vary::Vary;

pub const KINDS: &[Kind] = &[
    ("Watt I", watt_one),
    ("Watt II", watt_two),
    ("Stephenson I", stephenson_one),
    ("Stephenson II", stephenson_two),
    ("Stephenson III", stephenson_three),
];

/// Crank and coupler have three pins each; a dyad joins their third ones.
fn watt_one(vary: &mut Vary) -> Sketch {
    let [d, a, b, c, p, q] = vary.lengths([0.4, 0.12, 0.35, 0.3, 0.25, 0.2]);
    let (on_crank, on_coupler) = ([0.06, 0.12], [0.15, 0.18]);
    Sketch::new("WattOne", vary.angle(0.7, 3.0), move |t| {
        let (o, far) = (fixed(0.0, 0.0), fixed(d, 0.0));
        let crank = arm(o, a, t);
        let pin = circles(crank, b, far, c, 1.0)?;
        let [low, high] = [on(o, crank, a, on_crank), on(crank, pin, b, on_coupler)];
        Ok(vec![o, far, crank, pin, low, high, circles(low, p, high, q, 1.0)?])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0])])
    .plate("crank", 0, 2, a, &[(4, on_crank)])
    .plate("coupler", 2, 3, b, &[(5, on_coupler)])
    .rod("rocker", 1, 3, c)
    .rod("lower", 4, 6, p)
    .rod("upper", 5, 6, q)
}

/// Ground and rocker have three pins each: two four-bar linkages, one after the other.
fn watt_two(vary: &mut Vary) -> Sketch {
    let [d, a, b, c, p, q] = vary.lengths([0.4, 0.12, 0.35, 0.3, 0.4, 0.3]);
    let (on_rocker, far) = ([0.2, -0.15], [0.8, 0.05]);
    Sketch::new("WattTwo", vary.angle(0.7, 3.0), move |t| {
        let (o, middle, far) = (fixed(0.0, 0.0), fixed(d, 0.0), Vector::fixed(far));
        let crank = arm(o, a, t);
        let pin = circles(crank, b, middle, c, 1.0)?;
        let third = on(middle, pin, c, on_rocker);
        Ok(vec![o, middle, far, crank, pin, third, circles(third, p, far, q, 1.0)?])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0]), (2, far)])
    .rod("crank", 0, 3, a)
    .rod("coupler", 3, 4, b)
    .plate("rocker", 1, 4, c, &[(5, on_rocker)])
    .rod("link", 5, 6, p)
    .rod("output", 2, 6, q)
}

/// Crank and rocker have three pins each; a dyad joins their third ones.
fn stephenson_one(vary: &mut Vary) -> Sketch {
    let [d, a, b, c, p, q] = vary.lengths([0.4, 0.12, 0.35, 0.3, 0.3, 0.28]);
    let (on_crank, on_rocker) = ([0.05, 0.1], [0.2, 0.12]);
    Sketch::new("StephensonOne", vary.angle(0.7, 3.0), move |t| {
        let (o, far) = (fixed(0.0, 0.0), fixed(d, 0.0));
        let crank = arm(o, a, t);
        let pin = circles(crank, b, far, c, 1.0)?;
        let [low, high] = [on(o, crank, a, on_crank), on(far, pin, c, on_rocker)];
        Ok(vec![o, far, crank, pin, low, high, circles(low, p, high, q, 1.0)?])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0])])
    .plate("crank", 0, 2, a, &[(4, on_crank)])
    .rod("coupler", 2, 3, b)
    .plate("rocker", 1, 3, c, &[(5, on_rocker)])
    .rod("lower", 4, 6, p)
    .rod("upper", 5, 6, q)
}

/// Input and floating body have three pins each, and two rods between them: a four-bar linkage that moves as a whole.
/// The angle in it is the parameter: the distance of the third pins then gives how it stands.
fn stephenson_two(vary: &mut Vary) -> Sketch {
    let [e, a, b, c, g, rocker] = vary.lengths([0.3, 0.1, 0.28, 0.25, 0.45, 0.3]);
    let (foot, third) = ([0.1, -0.15], [0.15, 0.15]);
    Sketch::new("StephensonTwo", vary.angle(0.7, 3.0), move |psi| {
        // In the frame of the input, whose rods begin at its origin and its end, and whose bearing is `foot`.
        let (start, end) = (fixed(0.0, 0.0), fixed(e, 0.0));
        let first = arm(start, a, psi);
        let second = circles(first, b, end, c, 1.0)?;
        let free = on(first, second, b, third);
        let away = free - Vector::fixed(foot);
        let (o, far) = (fixed(0.0, 0.0), fixed(g, 0.0));
        let there = circles(o, away.norm(), far, rocker, 1.0)?;
        // Turn and move all so that `away` becomes `there`.
        let turn = there.angle() - away.angle();
        let place = |at: Vector| {
            let (unit, at) = (Vector::unit(turn), at - Vector::fixed(foot));
            at.x * unit + at.y * unit.left()
        };
        Ok(vec![o, far, place(start), place(end), place(first), place(second), there])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [g, 0.0])])
    .plate("input", 2, 3, e, &[(0, foot)])
    .rod("first", 2, 4, a)
    .plate("floating", 4, 5, b, &[(6, third)])
    .rod("second", 3, 5, c)
    .rod("rocker", 1, 6, rocker)
    .by(Coordinate::Angle(1))
}

/// Ground and coupler have three pins each; a dyad joins their third ones.
fn stephenson_three(vary: &mut Vary) -> Sketch {
    let [d, a, b, c, p, q] = vary.lengths([0.4, 0.12, 0.35, 0.3, 0.3, 0.3]);
    let (on_coupler, far) = ([0.15, 0.2], [0.5, 0.45]);
    Sketch::new("StephensonThree", vary.angle(0.7, 3.0), move |t| {
        let (o, middle, far) = (fixed(0.0, 0.0), fixed(d, 0.0), Vector::fixed(far));
        let crank = arm(o, a, t);
        let pin = circles(crank, b, middle, c, 1.0)?;
        let third = on(crank, pin, b, on_coupler);
        Ok(vec![o, middle, far, crank, pin, third, circles(third, p, far, q, 1.0)?])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0]), (2, far)])
    .rod("crank", 0, 3, a)
    .plate("coupler", 3, 4, b, &[(5, on_coupler)])
    .rod("rocker", 1, 4, c)
    .rod("link", 5, 6, p)
    .rod("output", 2, 6, q)
}
