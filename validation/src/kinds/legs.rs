//! Legs that walk.
use super::Kind;
use super::dyads::{arm, circles, fixed, on};
use super::jet::Vector;
use super::sketch::Sketch;
use super::vary::Vary;

pub const KINDS: &[Kind] = &[("leg of Jansen", jansen), ("leg of Klann", klann)];

/// A corner of a triangle over a side, on its left (1) or right (-1), from the lengths of its sides from both ends.
fn corner(side: f64, from: f64, to: f64, left: f64) -> [f64; 2] {
    let x = 0.5 * (side * side + from * from - to * to) / side;
    [x, left * (from * from - x * x).sqrt()]
}

/// Jansen's lengths, in centimetres.
fn jansen(vary: &mut Vary) -> Sketch {
    let [m, j, k, b, c, d, e, f, g, h, i] =
        vary.lengths([0.15, 0.5, 0.619, 0.415, 0.393, 0.401, 0.558, 0.394, 0.367, 0.657, 0.49]);
    let hip = [-0.38, -0.078];
    let (back, foot) = (corner(b, d, e, 1.0), corner(g, i, h, 1.0));
    Sketch::new("Jansen", vary.angle(0.7, 3.0), move |t| {
        let (o, hip) = (fixed(0.0, 0.0), Vector::fixed(hip));
        let crank = arm(o, m, t);
        let top = circles(crank, j, hip, b, -1.0)?;
        let behind = on(hip, top, b, back);
        let low = circles(crank, k, hip, c, 1.0)?;
        let ankle = circles(behind, f, low, g, -1.0)?;
        Ok(vec![o, hip, crank, top, behind, low, ankle, on(low, ankle, g, foot)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, hip)])
    .rod("crank", 0, 2, m)
    .rod("upper", 2, 3, j)
    .plate("shoulder", 1, 3, b, &[(4, back)])
    .rod("lower", 2, 5, k)
    .rod("hanger", 1, 5, c)
    .rod("shank", 4, 6, f)
    .plate("foot", 5, 6, g, &[(7, foot)])
}

/// Klann's leg: crank, connecting body, two rockers, leg.
fn klann(vary: &mut Vary) -> Sketch {
    let [m, l, lower, reach, leg, upper] = vary.lengths([0.26, 0.66, 0.32, 1.2, 0.7, 0.55]);
    let (low, high) = ([-0.6, -0.25], [-0.6, 0.4]);
    let far = [reach, 0.12];
    let foot = [-0.9, 0.1];
    Sketch::new("Klann", vary.angle(0.7, 3.0), move |t| {
        let (o, low, high) = (fixed(0.0, 0.0), Vector::fixed(low), Vector::fixed(high));
        let crank = arm(o, m, t);
        let knee = circles(crank, l, low, lower, -1.0)?;
        let hip = on(crank, knee, l, far);
        let top = circles(hip, leg, high, upper, -1.0)?;
        Ok(vec![o, low, high, crank, knee, hip, top, on(hip, top, leg, foot)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, low), (2, high)])
    .rod("crank", 0, 3, m)
    .plate("connecting", 3, 4, l, &[(5, far)])
    .rod("lower_rocker", 1, 4, lower)
    .plate("leg", 5, 6, leg, &[(7, foot)])
    .rod("upper_rocker", 2, 6, upper)
}
