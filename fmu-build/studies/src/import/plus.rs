//! Files and links of PMKS+, the web program: sections between dots, numbers with the base 64.
//!
//! In: text. Out: the planar linkage with its masses and forces. Versions from 2023 on are read; a later version adds
//! to the records of an earlier one.

use super::planar::{Body, GROUND, Joint, Linkage, identifier};
use super::pmks::unescaped;
use anyhow::{Context, Result, bail, ensure};
use serde_json::json;
use std::f64::consts::PI;

/// Digits of a number.
const DIGITS: &str = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-";
/// The last letter of a file is that of these digits which its length tells.
const CHECKS: usize = 62;
/// First letters of a bar that is not a part of another one, and of a part.
const ROOTS: &str = "YAMG0123";
const PARTS: &str = "Namg4567";

/// A unit as a factor and a divisor of the thousandths that a file counts.
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

/// A joint of the file.
struct Pin {
    id: String,
    name: String,
    place: [f64; 2],
    slides: bool,
    is_input: bool,
    is_grounded: bool,
    is_welded: bool,
    angle: f64,
    /// Of a slide in a bar the bar and two joints on the line of the slide.
    slot: Option<[String; 3]>,
}

/// A bar, or the block of a slide.
struct Bar {
    id: String,
    name: String,
    is_part: bool,
    is_block: bool,
    mass: f64,
    inertia: f64,
    center: [f64; 2],
    pins: Vec<String>,
    parts: Vec<String>,
}

/// What a file or a link holds of the mechanism, or the text as it is.
fn payload(text: &str) -> Result<String> {
    let text = text.trim();
    match text.split_once("://").and_then(|(_, rest)| rest.split_once('?')) {
        Some((_, query)) => unescaped(query),
        None => Ok(text.to_owned()),
    }
}

/// Whether a text looks like one of PMKS+: four sections of settings in digits.
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
/// The check letter does not fit, a record is incomplete, a force turns with its bar.
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
    let mut next = |what: &str| sections.next().with_context(|| format!("the section of the {what} is missing"));
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
    // The first switch turns the input clockwise.
    let speed = if (flags as u64) & 1 == 1 { -speed } else { speed } * PI / 30.0;
    let mut own = Builder::new(name, &pins, &bars, speed)?.linkage()?;
    for (of, record) in forces {
        force(&mut own, record, (&pins, &bars), &units).context(of)?;
    }
    own.notes.push(units.names.to_owned());
    own.notes.push(
        "the gravity setting is not read, because versions of PMKS+ store this setting differently: add the key \
         gravity to the definition if gravity acts"
            .into(),
    );
    Ok(own)
}

/// A number with the base 64, negative with a 0 before its digits.
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

/// Units by the letters of the section: the length tells those of mass and inertia, as in the program.
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

/// Value of the letter that packs the switches of a record, and what follows it.
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
        // The file holds thousandths of a radian: a whole number of degrees that rounds to them is meant.
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
    ensure!(mass >= 0.0 && inertia >= 0.0, "mass and moment of inertia must be at least 0");
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

/// A force on the bar that has its link, or of which its link is a part; bodies stand in the order of the bars.
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
    ensure!(size.is_finite(), "the unit of forces must be N or lbf: choose one of these in PMKS+");
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    ensure!(length > 0.0, "the force has no direction: move one of its points in PMKS+");
    let taken: Vec<String> = own.names().chain(pins.iter().map(|pin| pin.name.clone())).collect();
    let name = identifier(name, "force", &taken.iter().map(String::as_str).collect::<Vec<_>>());
    let at = own.reference(at + 1, from);
    own.forces.push((name, json!({ "at": at, "force": along.map(|part| size * part / length) })));
    Ok(())
}

/// The linkage as it grows, from the records.
struct Builder<'a> {
    own: Linkage,
    pins: &'a [Pin],
    bars: &'a [Bar],
    /// Bars that are no part of another one; the body of each has its index and 1.
    roots: Vec<&'a Bar>,
}

impl<'a> Builder<'a> {
    fn new(name: &str, pins: &'a [Pin], bars: &'a [Bar], speed: f64) -> Result<Self> {
        let mut own = Linkage { name: identifier(name, "Mechanism", &[]), ..Linkage::default() };
        own.start_speed = Some(speed).filter(|speed| *speed != 0.0);
        own.bodies.push(Body { name: GROUND.to_owned(), points: vec![[0.0; 2]], ..Body::default() });
        let roots: Vec<&Bar> = bars.iter().filter(|bar| !bar.is_part).collect();
        for bar in &roots {
            let taken: Vec<&str> = own.bodies.iter().map(|body| body.name.as_str()).collect();
            let name = identifier(&bar.name, "link", &taken);
            let mut points = Vec::new();
            for id in &bar.pins {
                let pin = pins.iter().find(|pin| pin.id == *id);
                let pin = pin.with_context(|| format!("link {}: there is no joint {}", bar.id, id.escape_debug()))?;
                if !points.contains(&pin.place) {
                    points.push(pin.place);
                }
            }
            let center = (!bar.is_block && bar.mass > 0.0).then_some(bar.center);
            own.bodies.push(Body { name, points, mass: bar.mass, center, inertia: bar.inertia, ..Body::default() });
        }
        Ok(Self { own, pins, bars, roots })
    }

    /// Bodies that hold a joint, without the ground.
    fn bodies_of(&self, pin: &Pin) -> Vec<usize> {
        let holds = |bar: &&Bar| bar.pins.contains(&pin.id);
        (0..self.roots.len()).filter(|&at| holds(&self.roots[at])).map(|at| at + 1).collect()
    }

    /// Bodies that a welded joint holds together: a bar of parts that meet there with blocks, as PMKS+ welds all bars
    /// that are there into one, and pins those that come later. Without such a bar, all that are there.
    fn welded(&self, pin: &Pin, bodies: &[usize]) -> Vec<usize> {
        let meets = |part: &&Bar| part.is_part && part.pins.contains(&pin.id);
        let is_weld = |body: &usize| {
            let parts = &self.roots[body - 1].parts;
            self.bars.iter().filter(meets).filter(|part| parts.contains(&part.id)).count() > 1
        };
        let has_weld = bodies.iter().any(is_weld);
        let is_held = |body: &usize| !has_weld || is_weld(body) || self.roots[body - 1].is_block;
        bodies.iter().copied().filter(is_held).collect()
    }

    /// The slide whose block a joint carries, as files before 2026 write it: the two stand at one place.
    fn slide_of(&self, pin: &Pin) -> Option<&'a Pin> {
        let block = self.roots.iter().find(|bar| bar.is_block && bar.pins.contains(&pin.id))?;
        self.pins.iter().find(|other| other.slides && block.pins.contains(&other.id))
    }

    fn linkage(mut self) -> Result<Linkage> {
        for pin in self.pins {
            let named = || format!("joint {}", pin.name.escape_debug());
            if pin.slides { self.slide(pin) } else { self.revolute(pin) }.with_context(named)?;
        }
        if self.own.joints.iter().all(|joint| joint.first != 0 && joint.second != 0) {
            bail!("no joint is on the ground: ground at least one joint in PMKS+");
        }
        match self.own.drives.first().map(|(_, joint)| &self.own.joints[*joint]) {
            None => self.own.notes.push("no joint is an input, so the mechanism has no drive".to_owned()),
            Some(joint) if joint.axis.is_some() || joint.first != 0 => self.own.start_speed = None,
            Some(_) if self.own.start_speed.is_some() => self.own.notes.push(
                "PMKS+ stores the speed of the input: the imported mechanism starts with this speed and its drive \
                 has no torque; add \"motion\" to the drive to prescribe the speed"
                    .to_owned(),
            ),
            Some(_) => {}
        }
        Ok(self.own)
    }

    fn revolute(&mut self, pin: &Pin) -> Result<()> {
        let slide = self.slide_of(pin);
        let mut bodies = self.bodies_of(pin);
        let welded = if pin.is_welded { self.welded(pin, &bodies) } else { Vec::new() };
        if let Some((&first, others)) = welded.split_first() {
            others.iter().for_each(|&other| self.own.bodies[other].fixed_to = Some(first));
            bodies.retain(|body| !others.contains(body));
        }
        if pin.is_grounded && slide.is_none() {
            bodies.insert(0, 0);
        }
        let Some((&first, others)) = bodies.split_first() else { return Ok(()) };
        if others.is_empty() && first != 0 && welded.len() < 2 {
            let name = self.name(pin, "");
            self.own.markers.push((name, first, pin.place));
        }
        for (&second, of) in others.iter().zip(0..) {
            self.join(pin, if of == 0 { "" } else { "_and" }, (first, second), None);
            if of == 0 && pin.is_input && slide.is_none() {
                self.drive();
            }
        }
        Ok(())
    }

    fn slide(&mut self, pin: &Pin) -> Result<()> {
        let bodies = self.bodies_of(pin);
        let is_block = |body: &usize| self.roots[body - 1].is_block;
        let block = bodies.iter().copied().find(is_block);
        // Older files state the ground and the input at the block's joint.
        let mut carried =
            self.pins.iter().filter(|other| !other.slides && self.slide_of(other).is_some_and(|s| s.id == pin.id));
        let (mut is_input, mut is_grounded) = (pin.is_input, pin.is_grounded);
        if let Some(other) = carried.next() {
            is_input |= other.is_input;
            is_grounded |= other.is_grounded && pin.slot.is_none();
        }
        let (base, axis) = match &pin.slot {
            Some([carrier, a, b]) => {
                let holds = |bar: &&Bar| bar.id == *carrier || bar.parts.contains(carrier);
                let base = self.roots.iter().position(holds);
                let base = base.with_context(|| format!("there is no link {}", carrier.escape_debug()))? + 1;
                let place = |id: &String| -> Result<[f64; 2]> {
                    let pin = self.pins.iter().find(|pin| pin.id == *id);
                    Ok(pin.with_context(|| format!("there is no joint {}", id.escape_debug()))?.place)
                };
                let (a, b) = (place(a)?, place(b)?);
                ensure!(a != b, "the two joints of the slot are at the same place: move one of them in PMKS+");
                (base, (b[1] - a[1]).atan2(b[0] - a[0]))
            }
            None if is_grounded => (0, pin.angle),
            None => bail!("the slot is neither on the ground nor in a link: correct the slot in PMKS+"),
        };
        // Without a block of its own the links are hinged on one without mass, or slide themselves where they do not
        // turn.
        let rider = match block {
            Some(block) => block,
            None if pin.is_welded => {
                *bodies.first().context("the slot contains no joint that slides: correct the slot in PMKS+")?
            }
            None => {
                let block =
                    Body { name: self.name(pin, "_block"), points: vec![pin.place], is_block: true, ..Body::default() };
                self.own.bodies.push(block);
                self.own.bodies.len() - 1
            }
        };
        self.join(pin, "", (base, rider), Some(axis));
        if is_input {
            self.drive();
        }
        for &body in bodies.iter().filter(|&&body| body != rider) {
            self.join(pin, "_pin", (rider, body), None);
        }
        Ok(())
    }

    /// A drive in the last joint.
    fn drive(&mut self) {
        let count = self.own.drives.len();
        let name = if count == 0 { "drive".to_owned() } else { format!("drive_{}", count + 1) };
        self.own.drives.push((name, self.own.joints.len() - 1));
    }

    fn join(&mut self, pin: &Pin, suffix: &str, (first, second): (usize, usize), axis: Option<f64>) {
        let name = self.name(pin, suffix);
        self.own.joints.push(Joint { name, first, second, place: pin.place, other: None, axis });
    }

    /// A free name for what stands for a joint.
    fn name(&self, pin: &Pin, suffix: &str) -> String {
        let taken: Vec<String> = self.own.names().collect();
        let taken: Vec<&str> = taken.iter().map(String::as_str).collect();
        identifier(&format!("{}{suffix}", pin.name), "joint", &taken)
    }
}
