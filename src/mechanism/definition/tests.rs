use super::*;
use crate::format::Kind;
use crate::hydraulics::definition::CIRCUIT;
use crate::mechanism::GEAR;
use crate::variables::Unit;

fn refused(from: &str, to: &str) -> String {
    assert!(GEAR.contains(from), "the gear has no {from}");
    Mechanism::from_json(&GEAR.replacen(from, to, 1)).expect_err(to).to_string()
}

#[test]
fn the_gear_is_read() {
    let mut gear = Mechanism::from_json(GEAR).unwrap();
    let mut names = Vec::new();
    gear.parameters(&mut |p, value| names.push((p.name.concat(), *value)));
    for expected in [("crank.length", 0.1755), ("leg.angle", -2.4), ("wheel.mass", 19.5), ("crank.start_angle", 0.8)] {
        assert!(names.contains(&(expected.0.to_string(), expected.1)), "{expected:?} in {names:?}");
    }
}

#[test]
fn errors_name_the_key_the_value_and_what_is_allowed() {
    for (from, to, fragments) in [
        ("\"mass\": 13.689", "\"mass\": -1", vec!["bodies.crank.mass", "-1", ">= 0"]),
        ("\"length\": 0.1755", "\"length\": 0", vec!["bodies.crank.length", "= 0", "> 0"]),
        ("\"length\": 0.1755", "\"length\": 1e999", vec!["= 1e999: larger than the largest number", "line"]),
        ("\"mass\": 13.689", "\"mas\": 13.689", vec!["no key `mas`", "did you mean `mass`", "line"]),
        ("\"mass\": 13.689", "\"mass\": true", vec!["must be a number", "not true", "line"]),
        ("\"mass\": 13.689", "\"mass\": \"13 kg\"", vec!["bodies.crank.mass", "13 kg"]),
        ("crank.end", "crunk.end", vec!["joints.joint2.first", "crunk.end", "crank, leg"]),
        ("crank.end", "crank.tip", vec!["joints.joint2.first", "crank.tip", "origin, end, actuator"]),
        ("revolute", "hinge", vec!["must be `revolute`, `prismatic` or `slot`, not `hinge`"]),
        ("\"leg.end\"", "\"wheel.origin\"", vec!["bodies.wheel.fixed_to", "circle"]),
        ("\"start\": { \"body\": \"crank\"", "\"start\": { \"body\": \"crunk\"", vec!["start.body", "crunk"]),
        ("\"tolerance\": 1e-9", "\"tolerance\": 1e-30", vec!["solver.tolerance", "1e-14"]),
        ("{", "[", vec!["line"]),
    ] {
        let text = refused(from, to);
        for fragment in fragments {
            assert!(text.contains(fragment), "`{text}` lacks `{fragment}`");
        }
    }
}

#[test]
fn a_name_may_stand_once_only() {
    let text = refused("\"joint2\":", "\"joint1\":");
    assert!(text.contains("`joint1` occurs twice"), "{text}");
}

#[test]
fn the_path_leads_to_the_fault() {
    for (text, path) in [
        (r#"{"name": 1}"#, "name"),
        (r#"{"description": "{[\"", "name": 1}"#, "name"),
        (r#"{"bodies": {"a": {}, "b": {"mass": true}}}"#, "bodies.b.mass"),
        (r#"{"bodies": {"b": {"center": [0, true]}}}"#, "bodies.b.center[1]"),
        (r#"{"bodies": {"b": {"points": {"tip": [0]}}}}"#, "bodies.b.points.tip"),
        (r#"{"bodies": {"b": {"lenght": 1}}}"#, "bodies.b.lenght"),
        (r#"{"joints": {"j": {"type": "hinge"}}}"#, "joints.j.type"),
        (
            r#"{"joints": {"i": {"type": "revolute", "first": "a", "second": "b"}, "j": {"type": "revolute"}}}"#,
            "joints.j",
        ),
        ("{\"start\":\n  {\"angle\":\n  true}}", "start.angle"),
        ("[", "not a valid mechanism"),
        ("{", "not a valid mechanism"),
    ] {
        let message = Mechanism::from_json(text).unwrap_err().to_string();
        let (found, _) = message.split_once(": ").unwrap();
        assert!(found == path, "{text}: {found} where {path} was expected");
    }
}

/// What the words about a number say of its unit and its limit is what its row says.
#[test]
fn words_agree_with_rows() {
    let own = crate::hydraulics::definition::ELEMENTS;
    for element in ELEMENTS.iter().chain(&own).chain(&CIRCUIT) {
        for (key, doc) in element.table.keys.iter().zip(element.docs) {
            let (mut kind, mut is_number) = (&key.kind, false);
            while let Kind::Group(of) | Kind::List(of) = kind {
                kind = of;
            }
            is_number |= matches!(kind, Kind::Number | Kind::Pair);
            // A named parameter has the unit that it states.
            if !is_number || key.name == "value" {
                continue;
            }
            let either = |[line, joint]: [Unit; 2]| match line == joint {
                true => line.name().to_owned(),
                false => format!("{} or {}", line.name(), joint.name()),
            };
            let second = key.second.map_or(String::new(), |second| format!(", {}", either(second)));
            let unit = format!("[{}{second}]", either(key.units));
            assert!(doc.contains(&unit), "{}.{}: `{doc}` lacks {unit}", element.name, key.name);
            let limit = match key.range {
                Range::Positive => "> 0",
                Range::NonNegative => ">= 0",
                _ => "",
            };
            assert!(doc.contains(limit), "{}.{}: `{doc}` lacks {limit}", element.name, key.name);
        }
    }
}
