//! Mechanisms with slides: cranks and sliders, slots, couplings, wedges.
use super::Kind;
use super::dyads::{arm, circles, fixed, line, on};
use super::jet::{Jet, Vector};
use super::sketch::{Coordinate, Sketch};
use super::vary::Vary;
use std::f64::consts::FRAC_PI_2;

pub const KINDS: &[Kind] = &[
    ("slider-crank", slider_crank),
    ("offset slider-crank", offset),
    ("isosceles slider-crank", isosceles),
    ("Scotch yoke", scotch_yoke),
    ("elliptic trammel", trammel),
    ("Oldham coupling", oldham),
    ("wedge", wedge),
    ("quick return", quick_return),
    ("crank shaper", shaper),
    ("Whitworth", whitworth),
    ("oscillating cylinder", oscillating_cylinder),
    ("toggle press", toggle_press),
    ("umbrella", umbrella),
    ("gripper", gripper),
];

fn crank_and_slider(name: &'static str, [r, l]: [f64; 2], offset: f64, start: f64) -> Sketch {
    Sketch::new(name, start, move |t| {
        let (o, rail) = (fixed(0.0, 0.0), fixed(0.0, offset));
        let crank = arm(o, r, t);
        Ok(vec![o, rail, crank, line(crank, l, rail, Jet::default(), 1.0)?])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [0.0, offset])])
    .rod("crank", 0, 2, r)
    .rod("rod", 2, 3, l)
    .slider("slider", 3, 1, 0.0)
}

fn slider_crank(vary: &mut Vary) -> Sketch {
    crank_and_slider("SliderCrank", vary.lengths([0.1, 0.3]), 0.0, vary.angle(0.7, 3.0))
}

fn offset(vary: &mut Vary) -> Sketch {
    let lift = vary.length(0.08);
    crank_and_slider("OffsetSliderCrank", vary.lengths([0.1, 0.3]), lift, vary.angle(0.7, 3.0))
}

/// Crank and rod are equal: the slider passes the crank's bearing.
fn isosceles(vary: &mut Vary) -> Sketch {
    let r = vary.length(0.2);
    Sketch::new("IsoscelesSliderCrank", vary.angle(0.6, 0.4), move |t| {
        let o = fixed(0.0, 0.0);
        Ok(vec![o, arm(o, r, t), Vector { x: 2.0 * r * t.cos(), y: Jet::default() }])
    })
    .ground(&[(0, [0.0, 0.0])])
    .rod("crank", 0, 1, r)
    .rod("rod", 1, 2, r)
    .slider("slider", 2, 0, 0.0)
}

fn scotch_yoke(vary: &mut Vary) -> Sketch {
    let r = vary.length(0.1);
    let slope = vary.angle(FRAC_PI_2, 0.3);
    Sketch::new("ScotchYoke", vary.angle(0.7, 3.0), move |t| {
        let o = fixed(0.0, 0.0);
        let pin = arm(o, r, t);
        let yoke = Vector { x: pin.x - (1.0 / slope.tan()) * pin.y, y: Jet::default() };
        Ok(vec![o, pin, yoke])
    })
    .ground(&[(0, [0.0, 0.0])])
    .rod("crank", 0, 1, r)
    .slider("yoke", 2, 0, 0.0)
    .block("block", 1, 1, 2, slope)
}

fn trammel(vary: &mut Vary) -> Sketch {
    let l = vary.length(0.3);
    let pen = [1.4 * l, 0.02];
    Sketch::new("Trammel", vary.angle(0.7, 3.0), move |t| {
        let o = fixed(0.0, 0.0);
        let (across, up) = (arm(o, l, t), Jet::default());
        let [x, y] = [Vector { x: -across.x, y: up }, Vector { x: up, y: across.y }];
        Ok(vec![o, x, y, on(x, y, l, pen)])
    })
    .ground(&[(0, [0.0, 0.0])])
    .plate("rod", 1, 2, l, &[(3, pen)])
    .slider("across", 1, 0, 0.0)
    .slider("up", 2, 0, FRAC_PI_2)
}

/// The middle disc's centre goes round on a circle through both shafts.
fn oldham(vary: &mut Vary) -> Sketch {
    let [e, r] = vary.lengths([0.03, 0.2]);
    Sketch::new("Oldham", vary.angle(0.7, 3.0), move |t| {
        let (o, far) = (fixed(0.0, 0.0), fixed(e, 0.0));
        let unit = Vector::unit(t);
        Ok(vec![o, far, arm(o, r, t), far + r * unit.left(), (e * t.cos()) * unit])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [e, 0.0])])
    .rod("drive", 0, 2, r)
    .rod("driven", 1, 3, r)
    .block("disc", 4, 0, 0, 0.0)
    .guided("groove", Some(1), 1, 0.0, 2)
}

/// A wedge on the ground lifts a follower: three slides, of which one holds an angle that the others hold too.
fn wedge(vary: &mut Vary) -> Sketch {
    let slope = vary.angle(0.4, 0.25);
    Sketch::new("Wedge", vary.angle(0.2, 0.1), move |s| {
        let none = Jet::default();
        let rail = fixed(0.5, 0.0);
        Ok(vec![fixed(0.0, 0.0), rail, Vector { x: s, y: none }, Vector { x: rail.x, y: slope.tan() * (rail.x - s) }])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [0.5, 0.0])])
    .slider("wedge", 2, 0, 0.0)
    .slider("follower", 3, 1, FRAC_PI_2)
    .guided("face", Some(0), 2, slope, 1)
    .by(Coordinate::Position(0))
}

/// A crank's block in the slot of a lever about `pivot`: places of pivot, crank's end, lever's end.
fn slotted(r: f64, length: f64, pivot: [f64; 2], t: Jet) -> [Vector; 3] {
    let (o, pivot) = (fixed(0.0, 0.0), Vector::fixed(pivot));
    let pin = arm(o, r, t);
    let apart = pin - pivot;
    [pivot, pin, pivot + (Jet::from(length) / apart.norm()) * apart]
}

fn quick_return(vary: &mut Vary) -> Sketch {
    let [r, length, d] = vary.lengths([0.1, 0.4, 0.25]);
    Sketch::new("QuickReturn", vary.angle(1.0, 3.0), move |t| {
        let [pivot, pin, end] = slotted(r, length, [d, 0.0], t);
        Ok(vec![fixed(0.0, 0.0), pivot, pin, end])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0])])
    .rod("crank", 0, 2, r)
    .rod("lever", 1, 3, length)
    .block("block", 2, 1, 1, 0.0)
}

/// The quick return with its ram.
pub fn shaper(vary: &mut Vary) -> Sketch {
    let [r, length, d, link, high] = vary.lengths([0.1, 0.55, 0.25, 0.2, 0.25]);
    ram("Shaper", r, length, [0.0, -d], link, high, vary.angle(0.5, 3.0))
}

/// The lever's pivot is within the crank's circle: it goes round.
fn whitworth(vary: &mut Vary) -> Sketch {
    let [r, length, d, link] = vary.lengths([0.2, 0.1, 0.06, 0.4]);
    ram("Whitworth", r, length, [0.0, -d], link, -d, vary.angle(0.5, 3.0))
}

/// Crank, slotted lever, link, and a ram at this height.
fn ram(name: &'static str, r: f64, length: f64, pivot: [f64; 2], link: f64, high: f64, start: f64) -> Sketch {
    Sketch::new(name, start, move |t| {
        let [pivot, pin, end] = slotted(r, length, pivot, t);
        let rail = fixed(0.0, high);
        Ok(vec![fixed(0.0, 0.0), pivot, rail, pin, end, line(end, link, rail, Jet::default(), 1.0)?])
    })
    .ground(&[(0, [0.0, 0.0]), (1, pivot), (2, [0.0, high])])
    .rod("crank", 0, 3, r)
    .rod("lever", 1, 4, length)
    .block("block", 3, 1, 1, 0.0)
    .rod("link", 4, 5, link)
    .slider("ram", 5, 2, 0.0)
}

/// A steam engine whose cylinder swings on trunnions, with its piston's rod on the crank.
fn oscillating_cylinder(vary: &mut Vary) -> Sketch {
    let [r, d, length] = vary.lengths([0.05, 0.2, 0.12]);
    Sketch::new("OscillatingCylinder", vary.angle(1.0, 3.0), move |t| {
        let [pivot, pin, end] = slotted(r, length, [d, 0.03], t);
        Ok(vec![fixed(0.0, 0.0), pivot, pin, end])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.03])])
    .rod("crank", 0, 2, r)
    .rod("cylinder", 1, 3, length)
    .block("piston", 2, 1, 1, 0.0)
}

/// A crank's rod bends the knee between frame and ram.
fn toggle_press(vary: &mut Vary) -> Sketch {
    let [r, rod, upper, lower] = vary.lengths([0.06, 0.42, 0.3, 0.3]);
    let bearing = [-0.45, -0.25];
    Sketch::new("TogglePress", vary.angle(0.7, 3.0), move |t| {
        let (o, bearing) = (fixed(0.0, 0.0), Vector::fixed(bearing));
        let crank = arm(bearing, r, t);
        let knee = circles(crank, rod, o, upper, -1.0)?;
        Ok(vec![bearing, o, crank, knee, line(knee, lower, o, Jet::from(FRAC_PI_2), -1.0)?])
    })
    .ground(&[(0, bearing), (1, [0.0, 0.0])])
    .rod("crank", 0, 2, r)
    .rod("rod", 2, 3, rod)
    .rod("upper", 1, 3, upper)
    .rod("lower", 3, 4, lower)
    .slider("ram", 4, 1, FRAC_PI_2)
}

/// Two ribs at the top of the stick, with struts from a runner on it.
fn umbrella(vary: &mut Vary) -> Sketch {
    let [rib, at, strut] = vary.lengths([0.55, 0.22, 0.25]);
    Sketch::new("Umbrella", vary.angle(-0.7, 0.2), move |t| {
        let o = fixed(0.0, 0.0);
        let right = Vector::unit(t);
        let left = Vector { x: -right.x, y: right.y };
        let [a, b] = [at * right, at * left];
        let runner = line(a, strut, o, Jet::from(FRAC_PI_2), -1.0)?;
        Ok(vec![o, a, b, rib * right, rib * left, runner])
    })
    .ground(&[(0, [0.0, 0.0])])
    .plate("right", 0, 3, rib, &[(1, [at, 0.0])])
    .plate("left", 0, 4, rib, &[(2, [at, 0.0])])
    .rod("right_strut", 1, 5, strut)
    .rod("left_strut", 2, 5, strut)
    .slider("runner", 5, 0, FRAC_PI_2)
}

/// A rod pulls two fingers, mirrored, each of which moves along itself on a parallelogram.
fn gripper(vary: &mut Vary) -> Sketch {
    let [arm_length, high, apart, link, lever] = vary.lengths([0.1, 0.03, 0.04, 0.05, 0.04]);
    let feet = [[0.0, high], [apart, high], [0.0, -high], [apart, -high]];
    // Each driven arm is bent: its short lever points back to the rod.
    let back = [0.0, -lever];
    Sketch::new("Gripper", vary.angle(0.9, 0.15), move |t| {
        let points = feet.map(Vector::fixed);
        let up = [t, -t];
        let ends: Vec<Vector> = (0..4).map(|k| arm(points[k], arm_length, up[k / 2])).collect();
        let [upper, lower] = [(0, 1.0), (2, -1.0)]
            .map(|(k, side): (usize, f64)| points[k] + Vector::unit(up[k / 2]).frame([back[0], side * back[1]]));
        let rod = line(upper, link, fixed(0.0, 0.0), Jet::default(), -1.0)?;
        let mut out = points.to_vec();
        out.extend(ends);
        out.extend([upper, lower, rod, fixed(0.0, 0.0)]);
        Ok(out)
    })
    .ground(&[(0, feet[0]), (1, feet[1]), (2, feet[2]), (3, feet[3]), (11, [0.0, 0.0])])
    .plate("upper", 0, 4, arm_length, &[(8, back)])
    .rod("upper_guide", 1, 5, arm_length)
    .rod("upper_finger", 4, 5, apart)
    .plate("lower", 2, 6, arm_length, &[(9, [back[0], -back[1]])])
    .rod("lower_guide", 3, 7, arm_length)
    .rod("lower_finger", 6, 7, apart)
    .rod("upper_link", 8, 10, link)
    .rod("lower_link", 9, 10, link)
    .slider("rod", 10, 11, 0.0)
}
