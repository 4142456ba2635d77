//! Mechanisms that draw straight lines, exactly or nearly so, and lifts.
use super::Kind;
use super::dyads::{arm, circles, fixed, on};
use super::fourbars::four_bar;
use super::jet::{Jet, Vector};
use super::sketch::{Coordinate, Sketch};
use super::vary::Vary;
use std::f64::consts::PI;

pub const KINDS: &[Kind] = &[
    ("inversor of Peaucellier", peaucellier),
    ("inversor of Hart", hart),
    ("Scott-Russell", scott_russell),
    ("Chebyshev", chebyshev),
    ("Roberts", roberts),
    ("Hoecken", hoecken),
    ("Watt's straight line", watt),
    ("Evans", evans),
    ("scissor lift", scissor),
    ("level-luffing jib", jib),
];

/// Arms l and a rhombus s, of which O, P, A, Q are corners and ends: |OP| |OQ| = l^2 - s^2, so that Q moves on a
/// straight line if P does on a circle through O. The parameter is the angle of the rhombus, which passes both flat
/// positions.
fn peaucellier(vary: &mut Vary) -> Sketch {
    let [l, s, c] = vary.lengths([0.5, 0.2, 0.45]);
    Sketch::new("Peaucellier", vary.angle(0.9, 0.3), move |beta| {
        let o = fixed(0.0, 0.0);
        let (half, reach) = (s * beta.sin(), s * beta.cos());
        let middle = (Jet::from(l * l) - half.squared()).sqrt();
        // P is on the circle through O: |OP| = 2 c cos(ray)
        let cos = (0.5 / c) * (middle - reach);
        let ray = Vector { x: cos, y: (Jet::from(1.0) - cos.squared()).sqrt() };
        let [a, b] = [1.0, -1.0].map(|side: f64| middle * ray + (side * half) * ray.left());
        Ok(vec![o, fixed(c, 0.0), a, b, (middle - reach) * ray, (middle + reach) * ray])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [c, 0.0])])
    .rod("arm_a", 0, 2, l)
    .rod("arm_b", 0, 3, l)
    .rod("ap", 2, 4, s)
    .rod("aq", 2, 5, s)
    .rod("bp", 3, 4, s)
    .rod("bq", 3, 5, s)
    .rod("crank", 1, 4, c)
    .by(Coordinate::Angle(2))
}

/// An antiparallelogram A B C D, long sides AB and CD, with O, P, Q at one height: |OP| |OQ| is constant. The parameter
/// is the angle of its short sides.
fn hart(vary: &mut Vary) -> Sketch {
    let [m, n, e] = vary.lengths([0.5, 0.2, 0.25]);
    let part = 0.4;
    Sketch::new("Hart", vary.angle(0.9, 0.3), move |beta| {
        let o = fixed(0.0, 0.0);
        let (height, half) = (n * beta.sin(), n * beta.cos());
        let middle = (Jet::from(m * m) - height.squared()).sqrt();
        let (ac, bd) = (middle - half, middle + half);
        // The line of A and C runs against that from O to P.
        let cos = (0.5 * part / e) * bd;
        let unit = -Vector { x: cos, y: (Jet::from(1.0) - cos.squared()).sqrt() };
        let at = |x: Jet, y: Jet| x * unit + y * unit.left();
        let to_b = at(middle, -height);
        let a = -part * to_b;
        let [b, c, d] = [to_b, at(ac, Jet::default()), at(-half, -height)].map(|to| a + to);
        Ok(vec![o, fixed(e, 0.0), a, b, c, d, a + part * (d - a), c + part * (b - c)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [e, 0.0])])
    .plate("ab", 2, 3, m, &[(0, [part * m, 0.0])])
    .plate("ad", 2, 5, n, &[(6, [part * n, 0.0])])
    .plate("cb", 4, 3, n, &[(7, [part * n, 0.0])])
    .rod("cd", 4, 5, m)
    .rod("crank", 1, 6, e)
    .by(Coordinate::Angle(1))
}

/// The far end of the rod moves on the line across the slider's.
fn scott_russell(vary: &mut Vary) -> Sketch {
    let r = vary.length(0.2);
    Sketch::new("ScottRussell", vary.angle(0.6, 0.4), move |t| {
        let o = fixed(0.0, 0.0);
        let none = Jet::default();
        let (x, y) = (2.0 * r * t.cos(), 2.0 * r * t.sin());
        Ok(vec![o, arm(o, r, t), Vector { x, y: none }, Vector { x: none, y }])
    })
    .ground(&[(0, [0.0, 0.0])])
    .rod("crank", 0, 1, r)
    .plate("rod", 2, 3, 2.0 * r, &[(1, [r, 0.0])])
    .slider("slider", 2, 0, 0.0)
}

fn chebyshev(vary: &mut Vary) -> Sketch {
    let [d, a, b] = vary.lengths([0.4, 0.5, 0.2]);
    four_bar("Chebyshev", [d, a, b, a], [0.5 * b, 0.0], vary.angle(0.85, 0.1), -1.0)
}

fn roberts(vary: &mut Vary) -> Sketch {
    let [d, a] = vary.lengths([0.4, 0.24]);
    four_bar("Roberts", [d, a, 0.5 * d, a], [0.25 * d, -0.2], vary.angle(1.1, 0.1), 1.0)
}

fn hoecken(vary: &mut Vary) -> Sketch {
    let [d, a, b] = vary.lengths([0.2, 0.1, 0.25]);
    four_bar("Hoecken", [d, a, b, b], [2.0 * b, 0.0], vary.angle(0.7, 3.0), 1.0)
}

/// Levers of one length on both sides of a coupler, whose middle draws the line.
fn watt(vary: &mut Vary) -> Sketch {
    let [a, b] = vary.lengths([0.3, 0.12]);
    let far = [2.0 * a, b];
    Sketch::new("WattLine", vary.angle(0.05, 0.1), move |t| {
        let (o, far) = (fixed(0.0, 0.0), Vector::fixed(far));
        let end = arm(o, a, t);
        let other = circles(end, b, far, a, 1.0)?;
        Ok(vec![o, far, end, other, 0.5 * (end + other)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, far)])
    .rod("lever", 0, 2, a)
    .plate("coupler", 2, 3, b, &[(4, [0.5 * b, 0.0])])
    .rod("other_lever", 1, 3, a)
}

/// Evans's grasshopper: the beam's end on a long rocker, its middle on a radius bar.
fn evans(vary: &mut Vary) -> Sketch {
    let [beam, bar, rocker] = vary.lengths([0.6, 0.3, 0.8]);
    let foot = [0.6, -0.8];
    Sketch::new("Evans", vary.angle(0.35, 0.2), move |t| {
        let (o, foot) = (fixed(0.0, 0.0), Vector::fixed(foot));
        let middle = arm(o, bar, t);
        let end = circles(middle, 0.5 * beam, foot, rocker, -1.0)?;
        Ok(vec![o, foot, middle, end, on(end, middle, 0.5 * beam, [beam, 0.0])])
    })
    .ground(&[(0, [0.0, 0.0]), (1, foot)])
    .rod("radius", 0, 2, bar)
    .plate("beam", 3, 4, beam, &[(2, [0.5 * beam, 0.0])])
    .rod("rocker", 1, 3, rocker)
}

/// Bars at the angles phi and pi - phi, pinned in their middles, stage upon stage.
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
    out.slider("carriage", 1, 0, 0.0)
}

/// A crane whose hook stays at its height: the beak is the coupler.
fn jib(vary: &mut Vary) -> Sketch {
    let [a, b, c, beak] = vary.lengths([18.0, 5.0, 20.0, 12.0]);
    let back = [-6.0, 5.0];
    Sketch::new("LuffingJib", vary.angle(1.0, 0.1), move |t| {
        let (o, back) = (fixed(0.0, 0.0), Vector::fixed(back));
        let head = arm(o, a, t);
        let tie = circles(head, b, back, c, -1.0)?;
        Ok(vec![o, back, head, tie, on(head, tie, b, [-beak, 0.05 * PI])])
    })
    .ground(&[(0, [0.0, 0.0]), (1, back)])
    .rod("boom", 0, 2, a)
    .plate("beak", 2, 3, b, &[(4, [-beak, 0.05 * PI])])
    .rod("tie", 1, 3, c)
}
