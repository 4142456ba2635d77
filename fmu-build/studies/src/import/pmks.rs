//! Text, links and JSON of PMKS: a row for each joint.
//!
//! In: text. Out: the table of joints, and notes about omitted parts.

use super::table::{Kind, Row, Table, kind, number};
use anyhow::{Context, Result, bail};
use serde_json::Value;

/// Names of the ground in PMKS, in addition to names that start with `ground`.
const GROUND_NAMES: [&str; 6] = ["0", "gnd", "grnd", "grond", "gound", "groud"];

/// A mechanism of PMKS: its text, a link that contains this text, or its JSON.
///
/// # Errors
/// A line has no kind, a gear, or no position; the JSON has no joints, or a slide without a reference for its angle.
pub fn of_pmks(text: &str) -> Result<Table> {
    if text.trim_start().starts_with('{') {
        return of_json(text);
    }
    let text = query(text)?;
    let mut table = Table::default();
    let mut driving = None;
    for (line, number_of) in text.split('\n').zip(1..) {
        for part in line.split('|') {
            let mut sentence = part.trim();
            if let Some((key, value)) = sentence.split_once('=') {
                match key.trim().to_ascii_lowercase().as_str() {
                    "mech" => sentence = value.trim(),
                    "name" => table.name = Some(value.trim().to_owned()).filter(|name| !name.is_empty()),
                    "d" => driving = value.trim().parse::<usize>().ok(),
                    // Speed and resolution of the animation, and display settings.
                    _ => {}
                }
                if sentence.contains('=') {
                    continue;
                }
            }
            let words: Vec<&str> = sentence.split([',', ' ', '\t']).filter(|word| !word.is_empty()).collect();
            if !words.is_empty() {
                let of = || format!("line {number_of}: {}", sentence.escape_debug());
                let row = row(&words, &mut table.notes).with_context(of)?;
                table.rows.push(row);
            }
        }
    }
    if let Some(row) = driving.and_then(|index| table.rows.get_mut(index)) {
        row.is_driven = true;
    }
    Ok(table)
}

/// The part of a link after the question mark, without escapes and with each key on a line. Any other text is
/// unchanged.
fn query(text: &str) -> Result<String> {
    match text.trim().split_once("://").and_then(|(_, rest)| rest.split_once('?')) {
        Some((_, query)) => Ok(unescaped(query)?.replace('&', "\n")),
        None => Ok(text.to_owned()),
    }
}

/// A part of a link without percent escapes.
///
/// # Errors
/// The escaped text is not UTF-8.
pub fn unescaped(text: &str) -> Result<String> {
    let (mut bytes, mut rest) = (Vec::with_capacity(text.len()), text.as_bytes());
    while let [first, tail @ ..] = rest {
        let digits = tail.get(..2).filter(|_| *first == b'%').and_then(|two| std::str::from_utf8(two).ok());
        let escaped = digits.and_then(|two| u8::from_str_radix(two, 16).ok());
        bytes.push(escaped.unwrap_or(*first));
        rest = if escaped.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(bytes).context("the link is not UTF-8 after decoding: copy the link again")
}

fn row(words: &[&str], notes: &mut Vec<String>) -> Result<Row> {
    if words.iter().any(|word| word.eq_ignore_ascii_case("G")) {
        bail!("gears (G) are not imported: add them as `couplings` of the definition");
    }
    // A link may have the name of a kind: the kind is the last such word before the numbers.
    let is_number = |word: &&str| word.parse::<f64>().is_ok();
    let at = (1..words.len()).rev().find(|&at| kind(words[at]).is_some() && words.get(at + 1).is_some_and(is_number));
    let at = at.context("the joint type (R, P or RP) is missing: write links, joint type, x and y in this order")?;
    let kind = kind(words[at]).context("the joint type must be R, P or RP")?;
    let mut rest = words[at + 1..].iter().copied();
    let place = [number(rest.next(), "x")?, number(rest.next(), "y")?];
    let mut rest: Vec<&str> = rest.collect();
    let mut axis = 0.0;
    if rest.first().is_some_and(is_number) {
        axis = number(Some(rest.remove(0)), "angle")?.to_radians();
    } else if kind != Kind::Revolute {
        notes.push(format!("{}: the angle of the slide is missing; the angle 0 is used, as in PMKS", words.join(" ")));
    }
    // Display flags for position, speed and acceleration. The fourth flag marks the drive.
    let is_driven = match rest.as_slice() {
        [flags] => flags.chars().nth(3).is_some_and(|flag| matches!(flag, 't' | '+')),
        [_, _, _, drive, ..] => drive.eq_ignore_ascii_case("true"),
        _ => false,
    };
    let links = words[..at].iter().map(|link| link_named(link)).collect();
    Ok(Row { kind, place, axis, links, is_driven })
}

/// The name of a link. All names of the ground become one name.
fn link_named(name: &str) -> String {
    let lower = name.to_ascii_lowercase();
    let is_ground = lower.starts_with("ground") || GROUND_NAMES.contains(&lower.as_str());
    if is_ground { "ground".to_owned() } else { name.to_owned() }
}

/// The JSON of PMKS. Its slides have an angle [rad] relative to their first link.
fn of_json(text: &str) -> Result<Table> {
    let file: Value = serde_json::from_str(text).context(
        "the file starts like JSON, but is not valid JSON: save the \
        mechanism in PMKS again",
    )?;
    let joints =
        file["Joints"].as_array().context("the key \"Joints\" is missing: save the mechanism in PMKS again")?;
    let mut table = Table { name: file["Name"].as_str().map(str::to_owned), ..Table::default() };
    for (joint, of) in joints.iter().zip(1..) {
        let row = json_row(joint, &file["Links"]).with_context(|| format!("joint {of}"))?;
        table.rows.push(row);
    }
    let driving = file["DrivingIndex"].as_u64().and_then(|index| usize::try_from(index).ok());
    if let Some(row) = driving.and_then(|index| table.rows.get_mut(index)) {
        row.is_driven = true;
    }
    Ok(table)
}

fn json_row(joint: &Value, links: &Value) -> Result<Row> {
    let word = joint["TypeOfJoint"].as_str().unwrap_or_default();
    if word == "G" {
        bail!("gears (G) are not imported: add them as `couplings` of the definition");
    }
    let kind = kind(word).with_context(|| format!("TypeOfJoint = \"{}\": must be R, P or RP", word.escape_debug()))?;
    let coordinate = |key: &str| joint[key].as_f64().with_context(|| format!("{key} must be a number"));
    let place = [coordinate("X")?, coordinate("Y")?];
    let names = joint["Links"].as_array().context("Links must be a list of names")?;
    let names: Option<Vec<&str>> = names.iter().map(Value::as_str).collect();
    let names: Vec<String> = names
        .context("Links must be a list of names, but one entry is not a text")?
        .into_iter()
        .map(link_named)
        .collect();
    let mut axis = 0.0;
    if kind != Kind::Revolute {
        let first = names.first().map(String::as_str).unwrap_or_default();
        let stated = links.as_array().into_iter().flatten().find(|link| link["Name"].as_str() == Some(first));
        let reference = match stated.and_then(|link| link["AngleInitial"].as_f64()) {
            Some(angle) => angle,
            None if first == "ground" => 0.0,
            None => bail!("the angle of the slide refers to the link {first}, whose AngleInitial is missing"),
        };
        axis = reference + coordinate("Angle")?;
    }
    Ok(Row { kind, place, axis, links: names, is_driven: false })
}
