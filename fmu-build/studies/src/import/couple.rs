//! Couplings between the coordinates of joints, as gears and racks.
//!
//! In: joints of a planar linkage, ratios of their coordinates. Out: couplings, and wheels without mass if gears need
//! them. The module must not know file formats.

use super::planar::{Body, Joint, Linkage};
use anyhow::{Result, bail, ensure};
use serde_json::{Value, json};

/// A coupling of two joints: coordinate of the first = ratio x coordinate of the second + offset.
#[derive(Clone, Debug)]
pub struct Ratio {
    pub first: usize,
    pub second: usize,
    pub ratio: f64,
    pub offset: f64,
}

/// The coordinate of a joint of the linkage: angle or position of the joint, times a sign.
#[derive(Clone, Copy, Debug)]
pub struct Coordinate {
    pub joint: usize,
    pub sign: f64,
}

/// A coordinate as ratio x coordinate of the first joint of its group + offset.
#[derive(Clone, Copy)]
struct Follower {
    hinge: usize,
    ratio: f64,
    offset: f64,
}

/// Add the couplings of joints. The order of the coordinates is that of the indices of the ratios.
///
/// # Errors
/// Two joints share no body, so that no gear can connect them; a ratio is 0.
pub fn add(own: &mut Linkage, ratios: &[Ratio], joints: &[Option<Coordinate>]) -> Result<()> {
    let mut left: Vec<&Ratio> = ratios.iter().collect();
    while let Some(first) = left.first() {
        // All joints that follow one joint. The pairs for couplings within a group can be chosen.
        let mut group = vec![Follower { hinge: first.second, ratio: 1.0, offset: 0.0 }];
        let mut loops = Vec::new();
        while let Some(at) =
            left.iter().position(|ratio| group.iter().any(|one| one.hinge == ratio.second || one.hinge == ratio.first))
        {
            let ratio = left.remove(at);
            ensure!(
                ratio.ratio != 0.0,
                "the ratio of a coupling is 0, so the coupled joint does not move: fix this \
                joint instead"
            );
            let of = |hinge: usize| group.iter().find(|one| one.hinge == hinge).copied();
            match (of(ratio.first), of(ratio.second)) {
                (None, Some(Follower { ratio: r, offset, .. })) => group.push(Follower {
                    hinge: ratio.first,
                    ratio: ratio.ratio * r,
                    offset: ratio.ratio * offset + ratio.offset,
                }),
                (Some(Follower { ratio: r, offset, .. }), None) => group.push(Follower {
                    hinge: ratio.second,
                    ratio: r / ratio.ratio,
                    offset: (offset - ratio.offset) / ratio.ratio,
                }),
                _ => loops.push(ratio),
            }
        }
        ensure!(loops.is_empty(), "couplings form a loop: remove one of the couplings of the joints");
        let mut done = vec![group.remove(0)];
        while !group.is_empty() {
            let pair = group.iter().enumerate().find_map(|(at, one)| {
                let other = done.iter().find(|other| shared(own, joints, one.hinge, other.hinge).is_some())?;
                Some((at, *other))
            });
            let Some((at, other)) = pair else {
                let name =
                    |one: &Follower| joints[one.hinge].map(|of| own.joints[of.joint].name.clone()).unwrap_or_default();
                bail!(
                    "the coupling of the joints {} and {} cannot be a gear, because the joints share no body: couple \
                     joints that share a body",
                    name(&group[0]),
                    name(&done[0])
                );
            };
            let one = group.remove(at);
            let ratio = one.ratio / other.ratio;
            let carrier = shared(own, joints, one.hinge, other.hinge).unwrap_or_default();
            let ends = [one.hinge, other.hinge].map(|hinge| joints[hinge]);
            if let [Some(one_end), Some(other_end)] = ends {
                couple(own, carrier, [one_end, other_end], [ratio, one.offset - ratio * other.offset]);
            }
            done.push(one);
        }
    }
    Ok(())
}

/// The common body of two joints.
fn shared(own: &Linkage, joints: &[Option<Coordinate>], one: usize, other: usize) -> Option<usize> {
    let [one, other] = [one, other].map(|hinge| joints[hinge].map(|of| &own.joints[of.joint]));
    let (one, other) = (one?, other?);
    [one.first, one.second].into_iter().find(|body| [other.first, other.second].contains(body))
}

/// Couple the coordinate of one joint with that of another: one = ratio other + offset.
fn couple(own: &mut Linkage, carrier: usize, [one, other]: [Coordinate; 2], [ratio, offset]: [f64; 2]) {
    let [joint, driving] = [one, other].map(|of| own.joints[of.joint].clone());
    // A coupling measures both motions relative to the carrier.
    let sign = |of: Coordinate, joint: &Joint| if joint.second == carrier { -of.sign } else { of.sign };
    let (s, t) = (sign(one, &joint), sign(other, &driving));
    let (ratio, offset) = (s * t * ratio, s * offset);
    let name = format!("{}_coupling", joint.name);
    match (joint.axis.is_some(), driving.axis.is_some()) {
        (false, false) => gears(own, carrier, [&driving, &joint], ratio, offset, &name),
        (true, false) => rack(own, carrier, &driving, &joint, ratio, offset, &name),
        (false, true) => rack(own, carrier, &joint, &driving, 1.0 / ratio, -offset / ratio, &name),
        (true, true) => {
            let wheel = wheel(own, carrier, joint.place, &name);
            rack(own, carrier, &wheel, &driving, 1.0, 0.0, &name);
            rack(own, carrier, &wheel, &joint, ratio, offset, &name);
        }
    }
}

/// The body of a joint that is not the carrier.
fn moving(joint: &Joint, carrier: usize) -> usize {
    if joint.first == carrier { joint.second } else { joint.first }
}

/// A wheel without mass, hinged on the carrier.
fn wheel(own: &mut Linkage, carrier: usize, place: [f64; 2], name: &str) -> Joint {
    let name = own.free_name(&format!("{name}_wheel"));
    own.bodies.push(Body { name: name.clone(), points: vec![place], is_block: true, ..Body::default() });
    let name = own.free_name(&format!("{name}_bearing"));
    let joint = Joint { name, first: carrier, second: own.bodies.len() - 1, place, ..Joint::default() };
    own.joints.push(joint.clone());
    joint
}

/// The second wheel turns by ratio times the angle of the first wheel.
fn gears(own: &mut Linkage, carrier: usize, [first, second]: [&Joint; 2], ratio: f64, offset: f64, name: &str) {
    let between = [second.place[0] - first.place[0], second.place[1] - first.place[1]];
    let distance = between[0].hypot(between[1]);
    if ratio < 0.0 && distance > 1e-9 {
        let teeth = json!({ "first_teeth": -ratio, "second_teeth": 1.0 });
        return mesh(own, carrier, [first, second], teeth, offset, name);
    }
    // The wheel between the two wheels reverses the direction. It is next to their line, at equal distances.
    let aside = if distance > 1e-9 { [0.5 * distance, distance] } else { [0.0, 1.0] };
    let along = if distance > 1e-9 { between.map(|part| part / distance) } else { [1.0, 0.0] };
    let place = [
        first.place[0] + aside[0] * along[0] - aside[1] * along[1],
        first.place[1] + aside[0] * along[1] + aside[1] * along[0],
    ];
    let idler = wheel(own, carrier, place, name);
    let same = json!({ "first_teeth": 1.0, "second_teeth": 1.0 });
    mesh(own, carrier, [first, &idler], same, 0.0, name);
    let size = ratio.abs();
    if ratio > 0.0 {
        let teeth = json!({ "first_teeth": size, "second_teeth": 1.0 });
        mesh(own, carrier, [&idler, second], teeth, offset, name);
    } else {
        // Two wheels with one centre that turn in opposite directions have two wheels between them.
        let place = [place[0] + 1.0, place[1]];
        let next = wheel(own, carrier, place, name);
        let same = json!({ "first_teeth": 1.0, "second_teeth": 1.0 });
        mesh(own, carrier, [&idler, &next], same, 0.0, name);
        let teeth = json!({ "first_teeth": size, "second_teeth": 1.0 });
        mesh(own, carrier, [&next, second], teeth, offset, name);
    }
}

fn mesh(own: &mut Linkage, carrier: usize, pair: [&Joint; 2], teeth: Value, offset: f64, name: &str) {
    let [first, second] = pair.map(|joint| center(own, joint, carrier));
    let mut value = json!({ "type": "gears", "first": first, "second": second });
    teeth.as_object().into_iter().flatten().for_each(|(key, number)| value[key.as_str()] = number.clone());
    finish(own, carrier, value, offset, name);
}

/// The slide moves by ratio times the angle of the wheel.
fn rack(own: &mut Linkage, carrier: usize, hinge: &Joint, slide: &Joint, ratio: f64, offset: f64, name: &str) {
    let first = center(own, hinge, carrier);
    let side = if ratio < 0.0 { "left" } else { "right" };
    let value = json!({ "type": "rack", "first": first, "joint": slide.name, "radius": ratio.abs(), "side": side });
    finish(own, carrier, value, offset, name);
}

/// Centre of rotation on the body that turns on the carrier, as `body.point`.
fn center(own: &mut Linkage, joint: &Joint, carrier: usize) -> String {
    let place = if joint.first == carrier { joint.other.unwrap_or(joint.place) } else { joint.place };
    own.reference(moving(joint, carrier), place)
}

fn finish(own: &mut Linkage, carrier: usize, mut value: Value, offset: f64, name: &str) {
    value["pressure_angle"] = json!(0.0);
    if value["type"] == "gears" && carrier != 0 {
        value["carrier"] = json!(own.bodies[carrier].name);
    }
    if offset != 0.0 {
        value["phase"] = json!(offset);
    }
    let name = own.free_name(name);
    own.couplings.push((name, value));
}
