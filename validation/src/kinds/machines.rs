//! Machines that cylinders move: a cylinder is a barrel and a rod in it.
use super::Kind;
use super::dyads::{arm, circles, fixed, on};
use super::jet::{Jet, Vector};
use super::sketch::{Coordinate, Sketch};
use super::vary::Vary;

pub const KINDS: &[Kind] = &[
    ("excavator bucket", excavator_bucket),
    ("backhoe", backhoe),
    ("cargo door", cargo_door),
    ("dump truck hoist", dump_truck),
    ("main gear with side brace", main_gear),
    ("drag brace", drag_brace),
    ("bicycle suspension", bicycle),
];

/// The end of a barrel that points from its foot to where its rod is pinned.
fn barrel(foot: Vector, to: Vector, length: f64) -> Vector {
    let apart = to - foot;
    foot + (Jet::from(length) / apart.norm()) * apart
}

/// With a cylinder: its barrel from the point `foot` to the point `end`, its rod at the point `at`. The position in it
/// is the coordinate.
fn cylinder(sketch: Sketch, [foot, end, at]: [usize; 3], length: f64) -> Sketch {
    let (barrel, slide) = (sketch.bodies.len(), sketch.slides.len());
    sketch.rod("barrel", foot, end, length).block("rod", at, barrel, foot, 0.0).by(Coordinate::Position(slide))
}

/// On the stick: tipping lever, link, bucket, and the cylinder on the lever.
fn excavator_bucket(vary: &mut Vary) -> Sketch {
    let [d, a, b, c] = vary.lengths([0.4, 0.5, 0.45, 0.4]);
    let (foot, tip, tube) = ([-1.6, 0.45], [0.5, -1.1], 0.9);
    let out = Sketch::new("ExcavatorBucket", vary.angle(1.5, 0.2), move |t| {
        let (o, hinge, foot) = (fixed(0.0, 0.0), fixed(d, 0.0), Vector::fixed(foot));
        let lever = arm(o, a, t);
        let pin = circles(lever, b, hinge, c, 1.0)?;
        Ok(vec![o, hinge, foot, lever, pin, on(hinge, pin, c, tip), barrel(foot, lever, tube)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, [d, 0.0]), (2, foot)])
    .rod("lever", 0, 3, a)
    .rod("link", 3, 4, b)
    .plate("bucket", 1, 4, c, &[(5, tip)]);
    cylinder(out, [2, 6, 3], tube)
}

/// The dipper on its boom, with the bucket linkage held by its cylinder's last link: lever, link and bucket follow.
fn backhoe(vary: &mut Vary) -> Sketch {
    let [dipper, d, a, b, c, tie] = vary.lengths([1.8, 0.35, 0.4, 0.42, 0.38, 1.3]);
    let (foot, horn, anchor, tube) = ([-1.2, 0.9], [-0.5, 0.1], [-0.1, -0.25], 0.8);
    let out = Sketch::new("Backhoe", vary.angle(-1.2, 0.2), move |t| {
        let (o, foot, anchor) = (fixed(0.0, 0.0), Vector::fixed(foot), Vector::fixed(anchor));
        let end = arm(o, dipper, t);
        let [horn, pivot] = [horn, [dipper - d, 0.0]].map(|local| on(o, end, dipper, local));
        // A rod from the boom holds the lever: the bucket keeps its attitude nearly.
        let lever = circles(anchor, tie, pivot, a, -1.0)?;
        let pin = circles(lever, b, end, c, -1.0)?;
        Ok(vec![o, foot, anchor, end, horn, pivot, lever, pin, on(end, pin, c, [0.2, 0.7]), barrel(foot, horn, tube)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, foot), (2, anchor)])
    .plate("dipper", 0, 3, dipper, &[(4, horn), (5, [dipper - d, 0.0])])
    .rod("tie", 2, 6, tie)
    .rod("lever", 5, 6, a)
    .rod("link", 6, 7, b)
    .plate("bucket", 3, 7, c, &[(8, [0.2, 0.7])]);
    cylinder(out, [1, 9, 4], tube)
}

/// A door on two hinge arms of different length, with its cylinder on the lower one.
fn cargo_door(vary: &mut Vary) -> Sketch {
    let [a, b, c] = vary.lengths([0.6, 0.5, 0.8]);
    let (upper, foot, edge, tube) = ([0.1, 0.55], [0.7, -0.6], [0.4, -1.4], 0.4);
    let out = Sketch::new("CargoDoor", vary.angle(0.3, 0.2), move |t| {
        let (o, upper, foot) = (fixed(0.0, 0.0), Vector::fixed(upper), Vector::fixed(foot));
        let lower = arm(o, a, t);
        let top = circles(lower, b, upper, c, 1.0)?;
        let lug = on(o, lower, a, [0.3, -0.05]);
        Ok(vec![o, upper, foot, lower, top, on(lower, top, b, edge), lug, barrel(foot, lug, tube)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, upper), (2, foot)])
    .plate("lower_arm", 0, 3, a, &[(6, [0.3, -0.05])])
    .plate("door", 3, 4, b, &[(5, edge)])
    .rod("upper_arm", 1, 4, c);
    cylinder(out, [2, 7, 6], tube)
}

/// A tipping body, a triangle on the chassis, a link between them, and the cylinder from the chassis to the triangle.
fn dump_truck(vary: &mut Vary) -> Sketch {
    let [bed, arm_length, link] = vary.lengths([4.0, 1.0, 1.3]);
    let (pivot, foot, corner, at, tube) = ([1.2, -0.1], [2.9, -0.35], [0.8, 0.5], [2.2, 0.0], 0.9);
    let out = Sketch::new("DumpTruck", vary.angle(0.35, 0.1), move |t| {
        let (o, pivot, foot) = (fixed(0.0, 0.0), Vector::fixed(pivot), Vector::fixed(foot));
        let end = arm(o, bed, t);
        let lug = on(o, end, bed, at);
        let tip = circles(pivot, arm_length, lug, link, -1.0)?;
        let horn = on(pivot, tip, arm_length, corner);
        Ok(vec![o, pivot, foot, end, lug, tip, horn, barrel(foot, horn, tube)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, pivot), (2, foot)])
    .plate("bed", 0, 3, bed, &[(4, at)])
    .plate("triangle", 1, 5, arm_length, &[(6, corner)])
    .rod("link", 4, 5, link);
    cylinder(out, [2, 7, 6], tube)
}

/// Leg, two parts of the side brace, and the retraction cylinder on the leg.
fn main_gear(vary: &mut Vary) -> Sketch {
    let [leg, upper, lower] = vary.lengths([2.4, 0.9, 0.95]);
    let (hinge, foot, lug, horn, tube) = ([1.3, -0.1], [0.9, 0.55], [1.1, 0.0], [-0.25, 0.3], 0.6);
    let out = Sketch::new("MainGear", vary.angle(-1.3, 0.15), move |t| {
        let (o, hinge, foot) = (fixed(0.0, 0.0), Vector::fixed(hinge), Vector::fixed(foot));
        let wheel = arm(o, leg, t);
        let lug = on(o, wheel, leg, lug);
        let knee = circles(lug, lower, hinge, upper, -1.0)?;
        let horn = on(o, wheel, leg, horn);
        Ok(vec![o, hinge, foot, wheel, lug, knee, horn, barrel(foot, horn, tube)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, hinge), (2, foot)])
    .plate("leg", 0, 3, leg, &[(4, lug), (6, horn)])
    .rod("upper_brace", 1, 5, upper)
    .rod("lower_brace", 4, 5, lower);
    cylinder(out, [2, 7, 6], tube)
}

/// A nose leg whose folding drag brace is unlocked by a jury link.
fn drag_brace(vary: &mut Vary) -> Sketch {
    let [leg, upper, lower, jury, lock] = vary.lengths([1.6, 0.75, 0.8, 0.35, 0.5]);
    let (hinge, anchor, foot, lug, tube) = ([1.1, 0.05], [0.45, 0.1], [-0.6, 0.2], [0.8, 0.0], 0.4);
    let out = Sketch::new("DragBrace", vary.angle(-1.25, 0.1), move |t| {
        let (o, hinge, anchor) = (fixed(0.0, 0.0), Vector::fixed(hinge), Vector::fixed(anchor));
        let wheel = arm(o, leg, t);
        let lug = on(o, wheel, leg, lug);
        let knee = circles(lug, lower, hinge, upper, -1.0)?;
        // The links that lock it: from the middle of the upper brace to the anchor.
        let middle = on(hinge, knee, upper, [0.6 * upper, 0.0]);
        let elbow = circles(middle, jury, anchor, lock, -1.0)?;
        let horn = on(o, wheel, leg, [-0.1, -0.25]);
        let foot = Vector::fixed(foot);
        Ok(vec![o, hinge, anchor, foot, wheel, lug, knee, middle, elbow, horn, barrel(foot, horn, tube)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, hinge), (2, anchor), (3, foot)])
    .plate("leg", 0, 4, leg, &[(5, lug), (9, [-0.1, -0.25])])
    .plate("upper_brace", 1, 6, upper, &[(7, [0.6 * upper, 0.0])])
    .rod("lower_brace", 5, 6, lower)
    .rod("jury", 7, 8, jury)
    .rod("lock", 2, 8, lock);
    cylinder(out, [3, 10, 9], tube)
}

/// Two links carry the swing arm; the damper stands on the upper one.
fn bicycle(vary: &mut Vary) -> Sketch {
    let [a, b, c] = vary.lengths([0.06, 0.12, 0.08]);
    let (upper, foot, axle, horn, tube) = ([0.03, 0.2], [0.32, 0.22], [-0.05, 0.42], [0.02, 0.06], 0.12);
    let out = Sketch::new("Bicycle", vary.angle(2.4, 0.2), move |t| {
        let (o, upper, foot) = (fixed(0.0, 0.0), Vector::fixed(upper), Vector::fixed(foot));
        let low = arm(o, a, t);
        let high = circles(low, b, upper, c, -1.0)?;
        let horn = on(upper, high, c, horn);
        Ok(vec![o, upper, foot, low, high, on(low, high, b, axle), horn, barrel(foot, horn, tube)])
    })
    .ground(&[(0, [0.0, 0.0]), (1, upper), (2, foot)])
    .rod("lower_link", 0, 3, a)
    .plate("swing_arm", 3, 4, b, &[(5, axle)])
    .plate("rocker", 1, 4, c, &[(6, horn)]);
    cylinder(out, [2, 7, 6], tube)
}
