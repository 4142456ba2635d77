//! Errors of form, meaning and geometry, each at its place.

use crate::support::{checked, found, slider_crank, with};
use fmu_build::check;
use linkage_fmu::inspection::Severity;
use serde_json::json;

/// Comments, NaN, decimal and trailing commas, a misspelt key, a Boolean for a number: each is reported once, at its
/// place.
#[test]
fn every_fault_of_the_form_is_found_at_its_place() {
    let text = "{\n  // none\n  \"name\": \"M\",\n  \"gravity\": { \"acceleration\": 9,81, \"up_angle\": NaN },\n  \
                \"bodies\": { \"ground\": {}, \"a\": { \"lenght\": 1, \"mass\": true, } },\n  \"joints\": [],\n  \
                \"start\": {},\n  \"guess\": {}\n}";
    let all = checked(text);
    let places: Vec<_> = all.findings.iter().map(|l| (l.position, &text[l.span.clone()])).collect();
    let expected = [
        ([2, 3], "// none"),
        ([4, 33], ","),
        ([4, 50], "NaN"),
        ([5, 36], "\"lenght\""),
        ([5, 57], "true"),
        ([5, 61], ","),
        ([6, 13], "[]"),
    ];
    assert_eq!(places, expected, "{}", check::findings(&all));
    for (located, fragment) in all.findings.iter().zip([
        "JSON has no comments",
        "9,81 has a decimal comma; write a point: 9.81",
        "finite",
        "no key `lenght`",
        "must be a number",
        "comma stands before the closing bracket",
        "a list",
    ]) {
        assert!(located.finding.message.contains(fragment), "{}", located.finding.message);
    }
    assert!(!all.is_whole);
}

/// The similar key is at the start of the message, instead of a list of all keys.
#[test]
fn a_similar_key_is_suggested() {
    for (path, value, meant) in [
        ("/actuatros", json!({}), "no key `actuatros` here; did you mean `actuators`?"),
        ("/bodies/crank/weight", json!(1), "no key `weight` here; did you mean `mass`?"),
        ("/bodies/crank/moment_of_inertia", json!(1), "did you mean `inertia`?"),
        ("/joints/pin/kind", json!("revolute"), "the keys are"),
    ] {
        let all = found(&with(path, value), Severity::Error);
        assert!(all.len() == 1 && all[0].1.contains(meant), "{all:#?}");
        assert!(all[0].1.contains("the keys are") == meant.contains("the keys"), "{all:#?}");
    }
    // A body that turns with another body has no guess.
    let mut text = slider_crank();
    text["bodies"]["weight"] = json!({ "fixed_to": "crank.origin", "angle": 3.0, "length": 0.05, "mass": 1 });
    text["guess"]["weight"] = json!(3.5);
    let all = found(&text.to_string(), Severity::Error);
    assert!(all[0].0 == "guess.weight" && all[0].1.contains("(point crank.origin)"), "{all:#?}");
    for text in ["", " \n"] {
        let all = found(text, Severity::Error);
        assert!(all.len() == 1 && all[0].1.contains("the file is empty"), "{all:#?}");
    }
}

#[test]
fn every_fault_of_the_meaning_is_found() {
    let mut text = slider_crank();
    text["joints"]["pin"]["first"] = json!("crank.tip");
    text["joints"]["wrist"]["second"] = json!("slyder.origin");
    text["joints"]["bearing"]["pin_radius"] = json!(0.01);
    text["stops"] = json!({ "s": { "body": "crank", "limit": "upper", "angle": 1, "damping": 5 } });
    text["bodies"]["rod"]["mass"] = json!(-1);
    text["start"] = json!({ "body": "krank", "angle": 1 });
    text["extra"] = json!(1);
    let text = serde_json::to_string_pretty(&text).unwrap();
    let mut places: Vec<_> = found(&text, Severity::Error).into_iter().map(|(path, ..)| path).collect();
    places.sort();
    let expected = [
        "bodies.rod.mass",
        "extra",
        "joints.bearing.pin_radius",
        "joints.pin.first",
        "joints.wrist.second",
        "start.body",
        "stops.s.damping",
    ];
    assert_eq!(places, expected);
}

#[test]
fn errors_of_the_geometry_have_their_place() {
    for (path, value, key) in [
        ("/start/angle", json!(0.5), ""),
        ("/bodies/rod/length", json!(0.04), "start.angle"),
        ("/guess/extra", json!(1), "guess.extra"),
        ("/stops", json!({ "s": { "body": "crank", "limit": "upper", "angle": 0.2 } }), "stops.s.angle"),
        ("/start", json!({ "joint": "guide", "position": 3.0 }), "start.position"),
    ] {
        let found = found(&with(path, value), Severity::Error);
        let paths: Vec<&str> = found.iter().map(|(path, ..)| path.as_str()).collect();
        assert_eq!(paths, if key.is_empty() { vec![] } else { vec![key] }, "{found:#?}");
    }
}

/// Faults that only the parser rejects have a place and a remedy. The rest of the file is read.
#[test]
fn invalid_json_is_reported_with_place_and_remedy() {
    let good = serde_json::to_string_pretty(&slider_crank()).unwrap();
    for (from, to, shown, said) in [
        ("\"name\": \"M\"", "'name': 'M'", "'name'", "double quotes"),
        ("\"mass\": 1.0", "\"mass\": .5", ".5", "0.5"),
        ("\"mass\": 1.0", "\"mass\": 1/2", "1/2", "write the number 0.5"),
        ("\"mass\": 1.0", "\"mass\": pi/2", "pi/2", "1.570796327"),
        ("\"mass\": 1.0", "\"mass\": 1.2x", "1.2x", "write a number without a unit"),
        ("\"mass\": 1.0", "\"mass\": 1.2t", "1.2t", "write 1200 (in kg), without a unit"),
        ("\"mass\": 1.0", "\"mass\": 40 mm", "40 mm", "write 0.04 (in m), without a unit, or 40 if"),
        ("\"mass\": 1.0", "\"mass\": 1 234 567", "1 234 567", "write 1234567, without blanks"),
        ("\"mass\": 1.0", "\"mass\": 40,000", ",", "40,000 is ambiguous; write 40000, or 40 if"),
        ("\"mass\": 1.0", "\u{201c}mass\u{201c}: 1.0", "\u{201c}mass\u{201c}", "write \"mass\""),
        ("\"mass\": 1.0", "\"mass\" = 1.0", "=", "colon"),
        ("\"mass\": 1.0,", "\"mass\": 1.0", "\"shape\"", "comma is missing"),
        ("\"mass\": 1.0,", "\"mass\": 1.0, \"mass\": 2.0,", "\"mass\"", "remove or rename one"),
        ("\"name\": \"M\"", "\"name\": \"M", "\"M", "closing quote"),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let all = found(&text, Severity::Error);
        assert!(all[0].1.contains(said) && (all.len() == 1 || !said.contains("without")), "{to}: {all:#?}");
        assert!(all[0].2.starts_with(shown) && all[0].2.len() <= shown.len() + 1, "{to}: {all:#?}");
    }
    for (text, said) in [
        (format!("{good}}}"), "surplus or wrong closing bracket"),
        (format!("{good}\n{good}"), "ends before"),
        (good.trim_end().trim_end_matches('}').to_owned(), "has no closing bracket"),
        ("[]".into(), "one object"),
    ] {
        let all = checked(&text);
        let first = &all.findings[0];
        assert!(first.finding.message.contains(said) && !first.span.is_empty(), "{:#?}", all.findings);
        assert!(!first.finding.message.contains("decimals"), "{}", first.finding.message);
    }
}

#[test]
fn everything_missing_in_an_empty_definition_is_reported() {
    let messages: Vec<_> = checked("{}").findings.into_iter().map(|located| located.finding.message).collect();
    for key in ["name", "bodies", "joints", "start"] {
        assert!(messages.iter().any(|message| message.contains(&format!("`{key}`"))), "{key}: {messages:#?}");
    }
}

#[test]
fn values_in_messages_are_in_the_units_of_the_file() {
    let mut text = slider_crank();
    text["units"] = json!({ "length": "mm" });
    for (body, length) in [("crank", 100), ("rod", 300)] {
        text["bodies"][body]["length"] = json!(length);
    }
    (text["guess"]["guide"], text["start"]) = (json!(380), json!({ "joint": "guide", "position": 500 }));
    let all = found(&text.to_string(), Severity::Error);
    assert!(all[0].1.contains("= 500 mm") && all[0].1.contains("from 200 mm to 400 mm"), "{all:#?}");
    text["start"]["position"] = json!(390);
    text["stops"] = json!({ "s": { "joint": "guide", "limit": "upper", "position": 0.35 } });
    let all = found(&text.to_string(), Severity::Error);
    assert!(all[0].1.starts_with("stops.s.position = 0.35 mm: the start, at 390 mm") && all[0].2 == "0.35", "{all:#?}");
    // A remedy uses the units of the file too, and does not request units that the file has.
    text["units"]["angle"] = json!("deg");
    (text["stops"], text["gravity"]["up_angle"]) = (json!({}), json!(90));
    (text["guess"], text["start"]) =
        (json!({ "crank": 30, "rod": -10, "guide": 0.38 }), json!({ "body": "crank", "angle": 900 }));
    let all = found(&text.to_string(), Severity::Warning);
    let [(_, warning, _)] = &all[..] else { panic!("{all:#?}") };
    assert!(warning.contains("guess of 0.38 mm; if this assembly is correct, write 361.250755 mm"), "{warning}");
    (text["guess"], text["stops"]) = (
        json!({ "crank": 900, "rod": 30, "guide": -380 }),
        json!({ "s": { "body": "crank", "limit": "upper", "angle": 7 } }),
    );
    let all = [found(&text.to_string(), Severity::Error), found(&text.to_string(), Severity::Warning)].concat();
    assert!(all[0].1.contains("the start, at 900 deg, is beyond"), "{all:#?}");
    assert!(all.iter().all(|(_, text, _)| !text.contains("degrees") && !text.contains("\"units\"")), "{all:#?}");
    text["bodies"]["crank"]["length"] = json!(1e308);
    let all = [found(&text.to_string(), Severity::Error), found(&text.to_string(), Severity::Warning)].concat();
    assert!(all[0].1.contains("a length > 0, from 1e-97 mm to 1e103 mm"), "{all:#?}");
    assert!(all.iter().all(|(_, text, _)| !text.contains("\"units\"") && !text.contains("000000")), "{all:#?}");
}

#[test]
fn faulty_names_and_guesses_are_reported_together() {
    let mut text = slider_crank();
    text["guess"] = json!({ "crank": 0.5 });
    let all = found(&text.to_string(), Severity::Error);
    assert!(all[0].1.contains("of guide") && all[0].1.contains("rod"), "{all:#?}");
    text["guess"] = json!({ "crank": 0.5, "rod": -0.16, "gude": 0.38 });
    text["start"]["body"] = json!("krank");
    let paths: Vec<String> = found(&text.to_string(), Severity::Error).into_iter().map(|(path, ..)| path).collect();
    assert!(
        paths.iter().any(|path| path == "start.body") && paths.iter().any(|path| path == "guess.gude"),
        "{paths:?}"
    );
    let text = with("/guess/slider", json!(0));
    assert!(found(&text, Severity::Error)[0].1.contains("remove this key"));
    let mut text = slider_crank();
    text["joints"]["slider"] = text["joints"]["guide"].take();
    text["joints"].as_object_mut().unwrap().remove("guide");
    let all = found(&text.to_string(), Severity::Error);
    assert!(
        all.iter().any(|(.., message, _)| message.contains("`slider` is the name of a body and of a joint")),
        "{all:#?}"
    );
    let text = with("/name", json!("CON"));
    assert!(found(&text, Severity::Error)[0].1.contains("name of a device"));
}

#[test]
fn of_many_names_the_most_similar_are_suggested() {
    let mut text = slider_crank();
    let points: serde_json::Map<_, _> = (0..20_000).map(|k| (format!("p{k}"), json!([0.0, 0.1]))).collect();
    text["bodies"]["rod"]["points"] = points.into();
    text["markers"] = json!({ "m": { "at": "rod.p123456" } });
    let all = found(&text.to_string(), Severity::Error);
    assert!(all[0].1.len() < 300 && all[0].1.contains("20002 names") && all[0].1.contains("p12345"), "{all:#?}");
}
