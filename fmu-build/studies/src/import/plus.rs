//! Files and links of PMKS+, the web program: sections between dots, numbers with the base 64.
//!
//! In: text. Out: the planar linkage with its masses and forces. Versions from 2023 on are supported. A later version
//! adds to the records of an earlier one.

use super::bars::{Bar, Builder, Pin};
use super::planar::{Linkage, identifier};
use super::pmks::unescaped;
use anyhow::{Context, Result, bail, ensure};
use serde_json::json;
use std::f64::consts::PI;

/// Digits of a number.
const DIGITS: &str = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-";
/// The last letter of a file depends on its length, modulo this number.
const CHECKS: usize = 62;
/// First letters of a bar that is no part of another bar, and of a part.
const ROOTS: &str = "YAMG0123";
const PARTS: &str = "Namg4567";

/// A unit as a factor and a divisor for the thousandths in a file.
#[derive(Clone, Copy)]
struct Unit(f64, f64);

impl Unit {
    fn of(self, thousandths: f64) -> f64 {
        thousandths * self.0 / self.1
    }
}

struct Units {
    length: Unit,
    mass: Unit,
    inertia: Unit,
    force: Unit,
    names: &'static str,
}

/// The mechanism in a file or a link, or the unchanged text.
fn payload(text: &str) -> Result<String> {
    let text = text.trim();
    match text.split_once("://").and_then(|(_, rest)| rest.split_once('?')) {
        Some((_, query)) => unescaped(query),
        None => Ok(text.to_owned()),
    }
}

/// Whether a text may be of PMKS+: four sections of settings in digits.
pub fn is_plus(text: &str) -> bool {
    let Ok(text) = payload(text) else { return false };
    let sections: Vec<&str> = text.splitn(5, '.').collect();
    let digits = |section: &str, others: &str| {
        !section.is_empty() && section.chars().all(|letter| DIGITS.contains(letter) || others.contains(letter))
    };
    let settings = |at: usize, others: &str| sections.get(at).is_some_and(|section| digits(section, others));
    sections.len() == 5 && settings(0, "") && settings(1, ",") && settings(2, ",") && settings(3, "")
}

/// A mechanism of PMKS+.
///
/// # Errors
/// The check letter is wrong, a record is incomplete, or a force turns with its bar.
pub fn of_plus(name: &str, text: &str) -> Result<Linkage> {
    let text = payload(text)?;
    let check = text.chars().last().context("the file is empty")?;
    let body = &text[..text.len() - check.len_utf8()];
    let length = body.encode_utf16().count();
    ensure!(
        DIGITS.chars().nth(length % CHECKS) == Some(check),
        "the last letter of a PMKS+ file checks its length, but \"{}\" does not fit {length} letters: the file or link \
         is incomplete, or older than 2023; open the file or link in PMKS+ and save the mechanism again",
        check.escape_debug()
    );
    let mut sections = body.split('.');
    let mut next = |what: &str| {
        sections.next().with_context(|| {
            format!(
                "the section of the {what} is missing: open \
        the file in PMKS+ and save it again"
            )
        })
    };
    let flags = number(next("switches")?, "switches")?;
    next("scale")?;
    let speed = number(next("speed")?.split(',').next().unwrap_or_default(), "the speed of the input")?;
    let units = units(next("units")?)?;
    let mut records = |what: &str| -> Vec<(String, &str)> {
        let all = sections.by_ref().take_while(|record| !record.is_empty());
        all.zip(1..).map(|(record, of)| (format!("{what} {of}: {}", record.escape_debug()), record)).collect()
    };
    let (pins, bars, forces) = (records("joint"), records("link"), records("force"));
    let pins = pins.into_iter().map(|(of, record)| pin(record, &units).context(of)).collect::<Result<Vec<Pin>>>()?;
    let bars = bars.into_iter().map(|(of, record)| bar(record, &units).context(of)).collect::<Result<Vec<Bar>>>()?;
    // The first flag makes the input turn clockwise.
    let speed = if (flags as u64) & 1 == 1 { -speed } else { speed } * PI / 30.0;
    let mut own = Builder::new(name, &pins, &bars, speed)?.linkage()?;
    for (of, record) in forces {
        force(&mut own, record, (&pins, &bars), &units).context(of)?;
    }
    own.notes.push(units.names.to_owned());
    own.notes.push(
        "the gravity setting is not read, because versions of PMKS+ store this setting differently: add the key \
         `gravity` to the definition if gravity acts"
            .into(),
    );
    Ok(own)
}

/// A number with the base 64. A 0 before its digits makes it negative.
fn number(word: &str, what: &str) -> Result<f64> {
    let (sign, digits) = word.strip_prefix('0').map_or((1.0, word), |rest| (-1.0, rest));
    ensure!(!word.is_empty() && digits.len() <= 9, "{what} = \"{}\" is not a number of PMKS+", word.escape_debug());
    let mut value = 0.0;
    for letter in digits.chars() {
        let digit =
            DIGITS.find(letter).with_context(|| format!("{what}: \"{}\" is not a digit", letter.escape_debug()))?;
        value = 64.0 * value + digit as f64;
    }
    Ok(if value == 0.0 { 0.0 } else { sign * value })
}

/// Units from the letters of the section. The length unit determines those of mass and inertia, as in PMKS+.
fn units(letters: &str) -> Result<Units> {
    const POUND: f64 = 0.453_592_37;
    const INCH: f64 = 0.0254;
    let mut letters = letters.chars();
    let length = letters.next();
    let mut units = match length {
        Some('0') => Units {
            length: Unit(INCH, 1e3),
            mass: Unit(POUND, 1e3),
            inertia: Unit(POUND * INCH * INCH, 1e3),
            force: Unit(POUND * 9.80665, 1e3),
            names: "the units of the file are in (length), lb (mass), lb in2 (moment of inertia) and lbf (force)",
        },
        Some('1') => Units {
            length: Unit(1.0, 1e5),
            mass: Unit(1.0, 1e6),
            inertia: Unit(1.0, 1e7),
            force: Unit(1.0, 1e3),
            names: "the units of the file are cm (length), g (mass), kg cm2 (moment of inertia) and N (force)",
        },
        Some('2') => Units {
            length: Unit(1.0, 1e3),
            mass: Unit(1.0, 1e3),
            inertia: Unit(1.0, 1e3),
            force: Unit(1.0, 1e3),
            names: "the units of the file are m (length), kg (mass), kg m2 (moment of inertia) and N (force)",
        },
        other => bail!("unit of length {other:?}: must be 0 (in), 1 (cm) or 2 (m)"),
    };
    // Letters of the angle and the force. Newton and pound-force follow the unit of length.
    if letters.nth(1).is_some_and(|letter| !matches!(letter, '0' | '1')) {
        units.force = Unit(f64::NAN, 1.0);
    }
    Ok(units)
}

/// Value of the letter with the flags of a record, and the rest of the record.
fn flags(record: &str) -> Result<(usize, &str)> {
    let mut letters = record.chars();
    let letter = letters.next().context("this record is empty: open the file in PMKS+ and save it again")?;
    let value = DIGITS.find(letter).with_context(|| format!("\"{}\" is not a digit", letter.escape_debug()))?;
    Ok((value, letters.as_str()))
}

fn pin(record: &str, units: &Units) -> Result<Pin> {
    let (flags, rest) = flags(record)?;
    let words: Vec<&str> = rest.split(',').collect();
    let [id, name, x, y, angle, more @ ..] = words.as_slice() else {
        bail!("a joint needs a name, a place and an angle: open the file in PMKS+ and save it again");
    };
    let slot = match more {
        [bar, a, b, ..] if ![bar, a, b].iter().all(|word| word.is_empty()) => {
            Some([bar, a, b].map(|word| (*word).into()))
        }
        [bar, ..] if !bar.is_empty() => bail!("a slot needs a link and two joints: correct the slot in PMKS+"),
        _ => None,
    };
    let angle = number(angle, "angle")? / 1e3;
    let degrees = angle.to_degrees().round().to_radians();
    Ok(Pin {
        id: (*id).to_owned(),
        name: (*name).to_owned(),
        place: [units.length.of(number(x, "x")?), units.length.of(number(y, "y")?)],
        slides: flags & 1 != 0,
        is_input: flags & 2 != 0,
        is_grounded: flags & 4 != 0,
        is_welded: flags & 8 != 0,
        // The file contains thousandths of a radian. An integer number of degrees with this rounding is used.
        angle: if (angle - degrees).abs() <= 5.001e-4 { degrees } else { angle },
        slot,
    })
}

fn bar(record: &str, units: &Units) -> Result<Bar> {
    let mut letters = record.chars();
    let is_part = match letters.next() {
        Some(letter) if ROOTS.contains(letter) => false,
        Some(letter) if PARTS.contains(letter) => true,
        other => bail!("a link has the unknown type {other:?}"),
    };
    let is_block = match letters.next() {
        Some('R') => false,
        Some('P') => true,
        other => bail!("the type of a link must be R or P, not {other:?}"),
    };
    let words: Vec<&str> = letters.as_str().split(',').collect();
    let [id, name, mass, inertia, x, y, _color, rest @ ..] = words.as_slice() else {
        bail!("a link needs a name, a mass, a moment of inertia and a centre of mass");
    };
    // An empty word ends the joints.
    let end = rest.iter().position(|word| word.is_empty()).unwrap_or(rest.len());
    let owned = |words: &[&str]| words.iter().filter(|word| !word.is_empty()).map(|word| (*word).to_owned()).collect();
    let (mass, inertia) = (units.mass.of(number(mass, "mass")?), units.inertia.of(number(inertia, "inertia")?));
    ensure!(mass >= 0.0 && inertia >= 0.0, "mass and moment of inertia must be at least 0: correct the values");
    Ok(Bar {
        id: (*id).to_owned(),
        name: (*name).to_owned(),
        is_part,
        is_block,
        mass,
        inertia,
        center: [units.length.of(number(x, "x of the centre")?), units.length.of(number(y, "y of the centre")?)],
        pins: owned(&rest[..end]),
        parts: owned(&rest[end..]),
    })
}

/// A force on the bar with its link, or with the bar of which its link is a part. Bodies are in the order of the bars.
fn force(own: &mut Linkage, record: &str, (pins, bars): (&[Pin], &[Bar]), units: &Units) -> Result<()> {
    let (flags, rest) = flags(record)?;
    let words: Vec<&str> = rest.split(',').collect();
    let [_id, link, name, ax, ay, bx, by, size, ..] = words.as_slice() else {
        bail!("a force needs a link, a name, two points and a size: open the file in PMKS+ and save it again");
    };
    if flags & 1 != 0 {
        bail!(
            "the force turns with its link, but forces of a definition keep their direction: make the force global in \
             PMKS+"
        );
    }
    let roots = bars.iter().filter(|bar| !bar.is_part);
    let holds = |bar: &Bar| bar.id == *link || bar.parts.iter().any(|part| part == link);
    let at = roots.clone().position(holds).with_context(|| format!("there is no link {}", link.escape_debug()))?;
    let point = |x: &str, y: &str| -> Result<[f64; 2]> {
        Ok([units.length.of(number(x, "x")?), units.length.of(number(y, "y")?)])
    };
    let (from, to) = (point(ax, ay)?, point(bx, by)?);
    let size = units.force.of(number(size, "size")?);
    ensure!(size.is_finite(), "the unit of forces must be N or lbf: choose N or lbf in PMKS+");
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    ensure!(length > 0.0, "the force has no direction: move one of the two points of the force in PMKS+");
    let taken: Vec<String> = own.names().chain(pins.iter().map(|pin| pin.name.clone())).collect();
    let name = identifier(name, "force", &taken.iter().map(String::as_str).collect::<Vec<_>>());
    let at = own.reference(at + 1, from);
    own.forces.push((name, json!({ "at": at, "force": along.map(|part| size * part / length) })));
    Ok(())
}
