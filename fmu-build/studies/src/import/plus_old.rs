//! Links of PMKS+ before 2023: `?j=...&l=...&f=...&s=...`, with a line for each joint, bar and force.
//!
//! In: a link. Out: the planar linkage with its masses.

use super::bars::{Bar, Builder, Pin};
use super::planar::Linkage;
use super::pmks::unescaped;
use super::table::number;
use anyhow::{Context, Result, bail, ensure};
use std::f64::consts::PI;

/// Whether a text is such a link.
pub fn is_old_plus(text: &str) -> bool {
    text.split_once('?').is_some_and(|(_, query)| query.starts_with("j=") && query.contains("&l="))
}

/// The mechanism of a link.
///
/// # Errors
/// A record is incomplete, or a slide has an angle, whose unit these links do not state.
pub fn of_old_plus(name: &str, link: &str) -> Result<Linkage> {
    let (_, query) = link.trim().split_once('?').context("the link has no question mark: copy the link again")?;
    let query = unescaped(query)?;
    let section = |key: &str| -> String {
        let own = query.split('&').find_map(|part| part.strip_prefix(key)?.strip_prefix('='));
        own.unwrap_or_default().to_owned()
    };
    let settings = section("s");
    let settings: Vec<&str> = settings.split(',').map(str::trim).collect();
    let (scale, unit) = match settings.get(3).copied().unwrap_or("cm") {
        "m" => (1.0, "m"),
        "cm" | "" => (0.01, "cm"),
        "in" => (0.0254, "in"),
        other => bail!("s: the unit of length \"{}\" is unknown: m, cm and in are known", other.escape_debug()),
    };
    let of = |key: &str, record: &str| format!("{key}: {}", record.escape_debug());
    let lines = |text: &str| -> Vec<String> {
        text.lines().map(str::trim).filter(|line| !line.is_empty()).map(str::to_owned).collect()
    };
    let pins = lines(&section("j")).into_iter().map(|record| pin(&record, scale).with_context(|| of("j", &record)));
    let pins: Vec<Pin> = pins.collect::<Result<_>>()?;
    let bars = lines(&section("l")).into_iter().map(|record| bar(&record, scale).with_context(|| of("l", &record)));
    let bars: Vec<Bar> = bars.collect::<Result<_>>()?;
    let rpm = settings.first().filter(|word| !word.is_empty());
    let rpm = rpm.map(|word| number(Some(word), "s: the speed")).transpose()?.unwrap_or(0.0);
    let turn = if settings.get(1) == Some(&"true") { -1.0 } else { 1.0 };
    let mut own = Builder::new(name, &pins, &bars, turn * rpm * PI / 30.0)?.linkage()?;
    own.notes.push(format!("lengths are read in {unit}, masses in kg, moments of inertia in kg m2, the speed in rpm"));
    if let Some(force) = lines(&section("f")).first() {
        own.notes.push(format!(
            "the forces are left out, such as {}, because their direction differs between versions of PMKS+: add \
             them under the key `forces`",
            force.escape_debug()
        ));
    }
    if settings.get(2) == Some(&"true") {
        own.notes.push("gravity acts in PMKS+: add the key `gravity` to the definition".to_owned());
    }
    Ok(own)
}

/// A joint: name, x, y, bars, kind, whether it is on the ground; then angle, friction and whether it is the input. Some
/// versions omit angle and friction.
fn pin(record: &str, scale: f64) -> Result<Pin> {
    let words: Vec<&str> = record.split(',').map(str::trim).collect();
    let [id, x, y, _bars, kind, ground, rest @ ..] = words.as_slice() else {
        bail!("a joint needs a name, a place, bars, a kind and a ground: copy the link again");
    };
    let slides = match *kind {
        "R" => false,
        "P" => true,
        other => bail!("the kind of a joint must be R or P, not \"{}\"", other.escape_debug()),
    };
    let input = rest.iter().rev().find(|word| matches!(**word, "t" | "f"));
    let angle = rest.first().and_then(|word| word.parse::<f64>().ok()).unwrap_or(0.0);
    ensure!(
        !slides || angle == 0.0,
        "the unit of the angle {angle} of this slide is unknown: write the joints as a table (--form table)"
    );
    Ok(Pin {
        id: (*id).to_owned(),
        name: (*id).to_owned(),
        place: [scale * number(Some(x), "x")?, scale * number(Some(y), "y")?],
        slides,
        is_input: input.is_some_and(|word| *word == "t"),
        is_grounded: *ground == "t",
        is_welded: false,
        angle,
        slot: None,
    })
}

/// A bar: name, mass, moment of inertia, centre, joints, forces, then its shape.
fn bar(record: &str, scale: f64) -> Result<Bar> {
    let words: Vec<&str> = record.split(',').map(str::trim).collect();
    let [id, mass, inertia, x, y, pins, ..] = words.as_slice() else {
        bail!("a link needs a name, a mass, a moment of inertia, a centre and joints: copy the link again");
    };
    let (mass, inertia) = (number(Some(mass), "mass")?, number(Some(inertia), "moment of inertia")?);
    ensure!(mass >= 0.0 && inertia >= 0.0, "mass and moment of inertia must be at least 0: correct the values");
    Ok(Bar {
        id: (*id).to_owned(),
        name: (*id).to_owned(),
        is_part: false,
        is_block: false,
        mass,
        inertia,
        center: [scale * number(Some(x), "x of the centre")?, scale * number(Some(y), "y of the centre")?],
        pins: pins.split('|').filter(|pin| !pin.is_empty()).map(str::to_owned).collect(),
        parts: Vec::new(),
    })
}
