//! The same mechanism written in another way: joints duplicated or with their sides exchanged, bodies fixed to a
//! massless body, other units and names, the whole mechanism displaced, mirrored or rescaled.
//!
//! In: a definition in SI units without expressions. Out: another definition, and the relation between its outputs and
//! those of the first. Must not depend on how a mechanism is solved.
use super::relation::{Relation, factor};
use linkage_fmu::format::written;
use linkage_fmu::mechanism::definition::{Mechanism, Role};
use linkage_fmu::variables::Unit;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Another definition of a mechanism.
pub struct Rewritten {
    pub definition: Value,
    pub relation: Relation,
}

/// A definition with all its numbers in SI units and without expressions.
pub fn plain(text: &str) -> Result<Value, String> {
    with_parameters(text, &mut |_, _, _, _| {})
}

/// [`plain`], with each parameter changed: its key, unit and role.
fn with_parameters(text: &str, change: &mut dyn FnMut(&str, Unit, Role, &mut f64)) -> Result<Value, String> {
    let mut mechanism = Mechanism::from_json(text).map_err(|e| e.to_string())?;
    mechanism.parameters(&mut |parameter, value| {
        change(&parameter.key.concat(), parameter.unit, parameter.role, value);
    });
    let mut all = serde_json::from_str(&written(&mut mechanism)).map_err(|e| e.to_string())?;
    prune(&mut all);
    if let Some(all) = all.as_object_mut() {
        all.remove("expressions");
    }
    Ok(all)
}

/// Remove keys without a value.
fn prune(value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.retain(|_, member| !member.is_null());
            members.values_mut().for_each(prune);
        }
        Value::Array(elements) => elements.iter_mut().for_each(prune),
        _ => {}
    }
}

fn members<'v>(definition: &'v mut Value, group: &str) -> impl Iterator<Item = (&'v String, &'v mut Value)> {
    definition.get_mut(group).and_then(Value::as_object_mut).into_iter().flatten()
}

fn names(definition: &Value, group: &str) -> Vec<String> {
    definition[group].as_object().into_iter().flatten().map(|(name, _)| name.clone()).collect()
}

fn change(value: &mut Value, of: impl FnOnce(f64) -> f64) {
    if let Some(number) = value.as_f64() {
        *value = json!(of(number));
    }
}

/// Whether a drive, a spring or a stop is rotary.
fn is_rotary(joints: &Value, element: &Value) -> bool {
    let joint = element["joint"].as_str();
    joint.is_some_and(|joint| joints[joint]["type"] == "revolute") || element.get("screw").is_some()
}

/// Call `visit` with each number that is no parameter, and its unit.
fn others(definition: &mut Value, visit: &mut dyn FnMut(Unit, &mut Value)) {
    use Unit::{Metre, MetrePerSecond, Newton, NewtonMetre, Radian, RadianPerSecond, Second};
    let (joints, bodies) = (definition["joints"].clone(), definition["bodies"].clone());
    let units = |rotary: bool| {
        if rotary { (Radian, RadianPerSecond, NewtonMetre) } else { (Metre, MetrePerSecond, Newton) }
    };
    let mut pairs = |list: Option<&mut Value>, of: [Unit; 2]| {
        for pair in list.and_then(Value::as_array_mut).into_iter().flatten() {
            of.iter().enumerate().for_each(|(k, unit)| visit(*unit, &mut pair[k]));
        }
    };
    for (_, spring) in members(definition, "springs") {
        let (way, rate, force) = units(is_rotary(&joints, spring));
        pairs(spring.get_mut("points"), [way, force]);
        pairs(spring.get_mut("damping_points"), [rate, force]);
    }
    for (_, drive) in members(definition, "actuators") {
        let (way, rate, force) = units(is_rotary(&joints, drive));
        pairs(drive.get_mut("points"), [rate, force]);
        pairs(drive.get_mut("motion").and_then(|motion| motion.get_mut("points")), [Second, way]);
    }
    for (_, stop) in members(definition, "stops") {
        let (way, _, force) = units(stop.get("angle").is_some());
        pairs(stop.get_mut("points"), [way, force]);
    }
    for (_, coupling) in members(definition, "couplings") {
        let rise = if coupling.get("joint").is_some() { Metre } else { Radian };
        pairs(coupling.get_mut("points"), [Radian, rise]);
    }
    let mut one = |value: Option<&mut Value>, unit: Unit| value.into_iter().for_each(|value| visit(unit, value));
    for (name, value) in members(definition, "guess") {
        one(Some(value), if bodies.get(name).is_some() { Radian } else { Metre });
    }
    for (_, drive) in members(definition, "actuators") {
        let (way, ..) = units(is_rotary(&joints, drive));
        one(drive.get_mut("force"), Newton);
        one(drive.get_mut("torque"), NewtonMetre);
        one(drive.get_mut("motion").and_then(|motion| motion.get_mut("position")), way);
    }
    for (_, coupling) in members(definition, "couplings") {
        let rise = if coupling.get("joint").is_some() { Metre } else { Radian };
        for segment in coupling.get_mut("segments").and_then(Value::as_array_mut).into_iter().flatten() {
            one(segment.get_mut("angle"), Radian);
            one(segment.get_mut("rise"), rise);
        }
    }
    for (_, force) in members(definition, "forces").filter(|(_, force)| force["constant"] != true) {
        (0..2).for_each(|k| one(force.get_mut("force").and_then(|force| force.get_mut(k)), Newton));
    }
    for (_, torque) in members(definition, "torques").filter(|(_, torque)| torque["constant"] != true) {
        one(torque.get_mut("torque"), NewtonMetre);
    }
    one(definition.get_mut("air").and_then(|air| air.get_mut("airspeed")), MetrePerSecond);
    for key in ["stop_time", "step_size"] {
        one(definition.get_mut("experiment").and_then(|experiment| experiment.get_mut(key)), Second);
    }
}

/// Call `f` with each text that may name an element or a point, and its key.
fn texts(value: &mut Value, key: &str, f: &mut dyn FnMut(&str, &mut String)) {
    match value {
        Value::String(text) => f(key, text),
        Value::Object(members) => members.iter_mut().for_each(|(key, member)| texts(member, key, f)),
        Value::Array(elements) => elements.iter_mut().for_each(|element| texts(element, key, f)),
        _ => {}
    }
}

fn local(definition: &Value, point: &str) -> [f64; 2] {
    let (body, name) = point.split_once('.').unwrap_or_default();
    let body = &definition["bodies"][body];
    match name {
        "origin" => [0.0; 2],
        "end" => [body["length"].as_f64().unwrap_or(0.0), 0.0],
        _ => [0, 1].map(|k| body["points"][name][k].as_f64().unwrap_or(0.0)),
    }
}

/// Whether an element other than its two bodies refers to a joint.
fn is_used(definition: &Value, joint: &str) -> bool {
    ["springs", "actuators", "stops", "couplings"]
        .iter()
        .any(|group| definition[group].as_object().into_iter().flatten().any(|(_, element)| element["joint"] == joint))
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or(0.0)
}

/// A duplicated joint; the duplicate of a prismatic joint is shifted along its axis. Reactions are not checked, as both
/// joints share them; friction would depend on them.
pub fn cloned(definition: &Value, joint: &str, shift: f64) -> Option<Rewritten> {
    if definition["friction"]["enabled"] == true || definition["solver"].get("method").is_some() {
        return None;
    }
    let mut other = definition.clone();
    let mut clone = definition["joints"][joint].clone();
    if clone["type"] == "prismatic" {
        let first = clone["first"].as_str()?.to_owned();
        let body = first.split('.').next()?;
        let ([x, y], axis) = (local(definition, &first), number(&clone, "axis_angle"));
        if !other["bodies"][body]["points"].is_object() {
            other["bodies"][body]["points"] = json!({});
        }
        other["bodies"][body]["points"]["shifted"] = json!([x + shift * axis.cos(), y + shift * axis.sin()]);
        clone["first"] = json!(format!("{body}.shifted"));
    }
    other["joints"]["zz_clone"] = clone;
    let reactions = names(definition, "joints")
        .into_iter()
        .flat_map(|joint| ["force", "torque"].map(|quantity| format!("{joint}.{quantity}")));
    Some(Rewritten { definition: other, relation: Relation::Same(reactions.collect()) })
}

/// A joint with its sides exchanged. The position of a prismatic joint is unchanged, as its axis is reversed.
pub fn exchanged(definition: &Value, joint: &str) -> Option<Rewritten> {
    let own = &definition["joints"][joint];
    let is_revolute = own["type"] == "revolute";
    if is_revolute && is_used(definition, joint) {
        return None;
    }
    let mut other = definition.clone();
    let changed = &mut other["joints"][joint];
    (changed["first"], changed["second"]) = (own["second"].clone(), own["first"].clone());
    if !is_revolute {
        let (axis, angle) = (number(own, "axis_angle"), number(own, "angle"));
        changed["axis_angle"] = json!(axis - angle + PI);
        changed["angle"] = json!(-angle);
        for (_, rack) in members(&mut other, "couplings").filter(|(_, c)| c["type"] == "rack" && c["joint"] == joint) {
            rack["side"] = json!(if rack["side"] == "left" { "right" } else { "left" });
        }
    }
    Some(Rewritten { definition: other, relation: Relation::Exchanged { joint: joint.to_owned(), is_revolute } })
}

/// A body fixed, at an angle, to a massless body that replaces it.
pub fn chained(definition: &Value, body: &str, angle: f64) -> Option<Rewritten> {
    let own = &definition["bodies"][body];
    if body == "ground" || own.get("fixed_to").is_some() || definition["solver"].get("method").is_some() {
        return None;
    }
    let (mut other, base) = (definition.clone(), format!("{body}_base"));
    other["bodies"][&base] = json!({});
    if let Some(stiffness) = other["bodies"][body].as_object_mut()?.remove("axial_stiffness") {
        other["bodies"][&base]["axial_stiffness"] = stiffness;
    }
    other["bodies"][body]["fixed_to"] = json!(format!("{base}.origin"));
    other["bodies"][body]["angle"] = json!(angle);
    if let Some(guess) = other["guess"].as_object_mut()?.remove(body) {
        other["guess"][&base] = json!(guess.as_f64()? - angle);
    }
    Some(Rewritten { definition: other, relation: Relation::Chained { body: body.to_owned(), base, angle } })
}

/// The definition in millimetres and degrees.
pub fn in_other_units(definition: &Value) -> Option<Rewritten> {
    let of = |unit: Unit, value: f64| match unit {
        Unit::Metre => 1000.0 * value,
        Unit::Radian => value.to_degrees(),
        _ => value,
    };
    let circuit = [Role::Circuit, Role::CircuitStart, Role::Named];
    let mut other = with_parameters(&definition.to_string(), &mut |_, unit, role, value| {
        if !circuit.contains(&role) && (unit != Unit::Metre || *value < 1e90) {
            *value = of(unit, *value);
        }
    })
    .ok()?;
    others(&mut other, &mut |unit, value| change(value, |value| of(unit, value)));
    other["units"] = json!({ "length": "mm", "angle": "deg" });
    Some(Rewritten { definition: other, relation: Relation::Same(Vec::new()) })
}

/// The mechanism rotated and displaced: elements of the ground are on a body that is fixed to the ground.
pub fn moved(definition: &Value, angle: f64, by: [f64; 2]) -> Option<Rewritten> {
    let mut other = definition.clone();
    texts(&mut other, "", &mut |_, text| {
        if let Some(point) = text.strip_prefix("ground.") {
            *text = format!("frame.{point}");
        }
    });
    let mut frame = other["bodies"]["ground"].clone();
    (frame["fixed_to"], frame["angle"]) = (json!("ground.place"), json!(angle));
    other["bodies"]["frame"] = frame;
    other["bodies"]["ground"] = json!({ "points": { "place": by } });
    let turn = |value: Option<&mut Value>| value.into_iter().for_each(|value| change(value, |old| old + angle));
    turn(other.get_mut("gravity").and_then(|gravity| gravity.get_mut("up_angle")));
    turn(other.get_mut("air").and_then(|air| air.get_mut("flow_angle")));
    turn(other["start"].get_mut("angle"));
    let bodies: Vec<String> = names(definition, "bodies");
    members(&mut other, "guess").filter(|(name, _)| bodies.contains(name)).for_each(|(_, value)| turn(Some(value)));
    members(&mut other, "stops").filter(|(_, stop)| stop.get("body").is_some()).for_each(|(_, stop)| {
        turn(stop.get_mut("angle"));
    });
    let (sin, cos) = angle.sin_cos();
    for (_, force) in members(&mut other, "forces") {
        let [x, y] = [0, 1].map(|k| force["force"][k].as_f64().unwrap_or(0.0));
        force["force"] = json!([x * cos - y * sin, x * sin + y * cos]);
    }
    for (_, coupling) in members(&mut other, "couplings") {
        if coupling.get("second").is_some() && coupling.get("carrier").is_none() {
            coupling["carrier"] = json!("frame");
        }
    }
    Some(Rewritten { definition: other, relation: Relation::Moved { angle, by, bodies } })
}

/// The mirror image: Y becomes -Y.
pub fn mirrored(definition: &Value) -> Option<Rewritten> {
    if definition["couplings"].as_object().into_iter().flatten().any(|(_, c)| c.get("points").is_some()) {
        return None;
    }
    let mut other = with_parameters(&definition.to_string(), &mut |key, unit, _, value| {
        let is_angle = unit == Unit::Radian && !key.ends_with("pressure_angle");
        let is_y = key.ends_with("[1]");
        let turns = key == "start.speed" && unit == Unit::RadianPerSecond
            || unit == Unit::NewtonMetre && (key.ends_with("preload") || key.starts_with("torques."));
        if is_angle || is_y || turns {
            *value = -*value;
        }
    })
    .ok()?;
    let (joints, bodies) = (other["joints"].clone(), names(definition, "bodies"));
    let turned_over = |list: Option<&mut Value>| {
        let Some(list) = list.and_then(Value::as_array_mut) else { return };
        list.reverse();
        list.iter_mut().for_each(|pair| (0..2).for_each(|k| change(&mut pair[k], |old| -old)));
    };
    let negate = |value: Option<&mut Value>| value.into_iter().for_each(|value| change(value, |old| -old));
    for (_, spring) in members(&mut other, "springs").filter(|(_, spring)| is_rotary(&joints, spring)) {
        turned_over(spring.get_mut("points"));
        turned_over(spring.get_mut("damping_points"));
    }
    for (_, drive) in members(&mut other, "actuators") {
        if is_rotary(&joints, drive) && drive.get("screw").is_none() {
            turned_over(drive.get_mut("points"));
            negate(drive.get_mut("torque"));
            negate(drive.get_mut("motion").and_then(|motion| motion.get_mut("position")));
            let table = drive.get_mut("motion").and_then(|motion| motion.get_mut("points"));
            table.and_then(Value::as_array_mut).into_iter().flatten().for_each(|pair| negate(pair.get_mut(1)));
        }
    }
    for (_, stop) in members(&mut other, "stops").filter(|(_, stop)| stop.get("angle").is_some()) {
        stop["limit"] = json!(if stop["limit"] == "lower" { "upper" } else { "lower" });
    }
    members(&mut other, "guess").filter(|(name, _)| bodies.contains(name)).for_each(|(_, value)| negate(Some(value)));
    let inputs = |element: &Value| element["constant"] != true;
    for (_, force) in members(&mut other, "forces").filter(|(_, force)| inputs(force)) {
        negate(force.get_mut("force").and_then(|force| force.get_mut(1)));
    }
    members(&mut other, "torques").filter(|(_, torque)| inputs(torque)).for_each(|(_, torque)| {
        negate(torque.get_mut("torque"));
    });
    members(&mut other, "couplings").for_each(|(_, coupling)| mirror_coupling(coupling));
    Some(Rewritten { definition: other, relation: Relation::Mirrored })
}

/// The mirror image of a rack or a cam; the lift of a cam is traversed backwards.
fn mirror_coupling(coupling: &mut Value) {
    if coupling["type"] == "rack" {
        coupling["side"] = json!(if coupling["side"] == "left" { "right" } else { "left" });
    }
    if let Some(segments) = coupling.get_mut("segments").and_then(Value::as_array_mut) {
        let [mut angle, mut lift] = [0.0; 2];
        for segment in segments.iter_mut() {
            let is_dwell = segment["law"] == "dwell";
            let own = segment["angle"].as_f64().unwrap_or(TAU - angle);
            let rise = segment["rise"].as_f64().unwrap_or(if is_dwell { 0.0 } else { -lift });
            (angle, lift) = (angle + own, lift + rise);
            segment["angle"] = json!(own);
            if !is_dwell {
                segment["rise"] = json!(-rise);
            }
        }
        segments.reverse();
    }
}

/// The mechanism in other units of mass, length and time, which the definition does not mention.
pub fn rescaled(definition: &Value, units: [f64; 3]) -> Option<Rewritten> {
    let mut given = definition.clone();
    if definition["actuators"].as_object().into_iter().flatten().any(|(_, drive)| drive.get("hydraulics").is_some()) {
        return None;
    }
    for (_, spring) in members(&mut given, "springs") {
        if spring.get("gas").is_some_and(|gas| gas.get("ambient").is_none()) {
            spring["gas"]["ambient"] = json!(101_325.0);
        }
    }
    let scaled = |_: &str, unit: Unit, _: Role, value: &mut f64| *value *= factor(unit, units);
    let mut other = with_parameters(&given.to_string(), &mut { scaled }).ok()?;
    others(&mut other, &mut |unit, value| change(value, |value| value * factor(unit, units)));
    Some(Rewritten { definition: other, relation: Relation::Scaled(units) })
}

/// The same definition with a loose tolerance.
pub fn loose(definition: &Value, tolerance: f64) -> Rewritten {
    let mut other = definition.clone();
    other["solver"]["tolerance"] = json!(tolerance);
    Rewritten { definition: other, relation: Relation::Loose(tolerance) }
}

/// Bodies and joints with other names, in another order.
pub fn renamed(definition: &Value, prefix: &mut dyn FnMut() -> char) -> Option<Rewritten> {
    const WORDS: [&str; 12] = [
        "name",
        "description",
        "type",
        "limit",
        "flag",
        "law",
        "shape",
        "method",
        "profile",
        "follower",
        "side",
        "interpolation",
    ];
    let all = ["bodies", "joints"].into_iter().flat_map(|group| names(definition, group));
    let new: BTreeMap<String, String> =
        all.filter(|name| name != "ground").map(|name| (name.clone(), format!("{}_{name}", prefix()))).collect();
    let mut other = definition.clone();
    texts(&mut other, "", &mut |key, text| {
        let (owner, rest) = text.split_at(text.find('.').unwrap_or(text.len()));
        if let (Some(name), false) = (new.get(owner), WORDS.contains(&key)) {
            *text = format!("{name}{rest}");
        }
    });
    for group in ["bodies", "joints", "guess"] {
        let Some(members) = other[group].as_object() else { continue };
        let members = members.iter().map(|(name, member)| (new.get(name).unwrap_or(name).clone(), member.clone()));
        other[group] = Value::Object(members.collect::<Map<_, _>>());
    }
    Some(Rewritten { definition: other, relation: Relation::Renamed(new) })
}
