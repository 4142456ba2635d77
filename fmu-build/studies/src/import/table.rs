//! Joints in a table, as in CSV, PMKS and Pyslvs: kind, position, direction and links of each joint.
//!
//! In: text of CSV. Out: rows, and the linkage of the rows. These formats have no masses.

use super::planar::{Body, GROUND, Joint, Linkage, identifier};
use anyhow::{Context, Result, bail};

/// Kind of a joint in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A pin.
    Revolute,
    /// A slide on the first link.
    Prismatic,
    /// A pin of the other links in a slot of the first.
    PinInSlot,
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub kind: Kind,
    pub place: [f64; 2],
    /// Direction of a slide or slot [rad].
    pub axis: f64,
    /// Names of the links. A joint of one link is a marker.
    pub links: Vec<String>,
    /// Whether a drive acts in the joint, if the file states this.
    pub is_driven: bool,
}

/// A mechanism as a table.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Name of the mechanism, if the file has one.
    pub name: Option<String>,
    pub rows: Vec<Row>,
    /// Notes about omitted parts of the file, one per line.
    pub notes: Vec<String>,
}

/// The kind of joint for a word.
pub fn kind(word: &str) -> Option<Kind> {
    match word.to_ascii_uppercase().as_str() {
        "R" => Some(Kind::Revolute),
        "P" => Some(Kind::Prismatic),
        "RP" => Some(Kind::PinInSlot),
        _ => None,
    }
}

/// A finite number, or the fault.
///
/// # Errors
/// There is no number, or it is not finite.
pub fn number(word: Option<&str>, what: &str) -> Result<f64> {
    let word = word.with_context(|| format!("{what} is missing"))?;
    let value: f64 =
        word.parse().ok().with_context(|| format!("{what} = \"{}\" is not a number", word.escape_debug()))?;
    if value.is_finite() { Ok(value) } else { bail!("{what} = {word} is not finite") }
}

/// A table as CSV with the columns `type`, `x`, `y`, `links` (separated by spaces), and optionally `angle` in degrees
/// and `driven`. Semicolons and tabs as separators, and decimal commas, are accepted too, because many spreadsheets
/// write them.
///
/// # Errors
/// A column is missing, or a row is invalid.
pub fn of_csv(text: &str) -> Result<Table> {
    let header = text.lines().next().unwrap_or_default();
    let separator = [b';', b'\t'].into_iter().find(|&letter| header.as_bytes().contains(&letter)).unwrap_or(b',');
    let mut reader = csv::ReaderBuilder::new();
    let reader = reader.trim(csv::Trim::All).flexible(true).delimiter(separator);
    let mut table = reader.from_reader(text.as_bytes());
    let number = |word: Option<&str>, what: &str| match word {
        Some(word) if separator != b',' => number(Some(&word.replace(',', ".")), what),
        word => number(word, what),
    };
    let names: Vec<String> = table.headers()?.iter().map(str::to_ascii_lowercase).collect();
    let column = |name: &str| names.iter().position(|other| other == name);
    let needed = |name: &str| {
        column(name).with_context(|| {
            format!("the table has no column \"{name}\"; the columns type, x, y and links are required")
        })
    };
    let (types, x, y, links) = (needed("type")?, needed("x")?, needed("y")?, needed("links")?);
    let (angle, driven) = (column("angle"), column("driven"));
    let mut rows = Vec::new();
    for (record, of) in table.records().zip(2..) {
        let record = record?;
        let row = || -> Result<Row> {
            let word = record.get(types).unwrap_or_default();
            let kind = kind(word).with_context(|| format!("type = \"{}\": must be R, P or RP", word.escape_debug()))?;
            let place = [number(record.get(x), "x")?, number(record.get(y), "y")?];
            let stated = angle.and_then(|angle| record.get(angle)).filter(|word| !word.is_empty());
            let axis = match (stated, kind) {
                (Some(word), _) => number(Some(word), "angle")?.to_radians(),
                (None, Kind::Revolute) => 0.0,
                (None, _) => bail!("a slide (type P or RP) needs an angle: fill the column angle"),
            };
            let links = record.get(links).unwrap_or_default().split_whitespace().map(str::to_owned).collect();
            let driven = driven.and_then(|driven| record.get(driven)).unwrap_or_default();
            let is_driven = match driven.to_ascii_lowercase().as_str() {
                "1" | "true" | "yes" => true,
                "" | "0" | "false" | "no" => false,
                _ => bail!("driven = \"{}\": must be 1 or 0", driven.escape_debug()),
            };
            Ok(Row { kind, place, axis, links, is_driven })
        };
        rows.push(row().with_context(|| format!("line {of}"))?);
    }
    Ok(Table { rows, ..Table::default() })
}

/// The linkage of a table.
///
/// # Errors
/// There is no ground, or a joint without links.
pub fn linkage(name: &str, table: &Table) -> Result<Linkage> {
    let name = identifier(table.name.as_deref().unwrap_or(name), "Mechanism", &[]);
    let mut own = Linkage { name, notes: table.notes.clone(), ..Linkage::default() };
    own.bodies.push(Body { name: GROUND.to_owned(), points: vec![[0.0; 2]], ..Body::default() });
    let mut known: Vec<(String, usize)> = vec![(GROUND.to_owned(), 0)];
    for (row, of) in table.rows.iter().zip(1..) {
        let mut bodies = Vec::new();
        for link in &row.links {
            let known_as = if link.eq_ignore_ascii_case(GROUND) { GROUND.to_owned() } else { link.clone() };
            let body = known.iter().find(|(name, _)| *name == known_as).map(|(_, body)| *body);
            let body = body.unwrap_or_else(|| {
                let taken: Vec<&str> = own.bodies.iter().map(|body| body.name.as_str()).collect();
                let name = identifier(link, "link", &taken);
                own.bodies.push(Body { name, ..Body::default() });
                known.push((known_as, own.bodies.len() - 1));
                own.bodies.len() - 1
            });
            own.point(body, row.place);
            bodies.push(body);
        }
        add_joints(&mut own, row, of, &bodies)?;
    }
    if own.joints.iter().all(|joint| joint.first != 0 && joint.second != 0) {
        bail!("no joint is on the link \"ground\": give the fixed link the name ground");
    }
    if own.drives.is_empty() {
        let is_input = |joint: &&Joint| {
            let other = if joint.first == 0 { joint.second } else { joint.first };
            joint.first.min(joint.second) == 0 && own.bodies[other].name.eq_ignore_ascii_case("input")
        };
        let driven = own.joints.iter().find(is_input).map(|joint| joint.name.clone());
        let first = || own.joints.iter().find(|joint| joint.first == 0 || joint.second == 0).map(|j| j.name.clone());
        let name = driven.or_else(first).unwrap_or_default();
        let index = own.joints.iter().position(|joint| joint.name == name).unwrap_or_default();
        own.drives.push(("drive".to_owned(), index));
        own.notes.push(format!("the file names no drive: the import adds a drive in the joint {name}"));
    }
    add_masses(&mut own);
    own.notes.push("the file states no units: lengths are read in m and angles in degrees".to_owned());
    Ok(own)
}

/// The joints of a row.
fn add_joints(own: &mut Linkage, row: &Row, of: usize, bodies: &[usize]) -> Result<()> {
    let (&first, others) = bodies
        .split_first()
        .with_context(|| format!("joint {of} names no links: name the links that the joint connects"))?;
    if others.is_empty() {
        let taken: Vec<&str> = own.bodies.iter().map(|body| body.name.as_str()).collect();
        let name = identifier(&format!("point_{of}"), "point", &taken);
        own.markers.push((name, first, row.place));
        return Ok(());
    }
    let name = |own: &Linkage, suffix: &str| {
        let bodies = own.bodies.iter().map(|body| body.name.as_str());
        let taken: Vec<&str> = bodies.chain(own.joints.iter().map(|joint| joint.name.as_str())).collect();
        identifier(&format!("joint_{of}{suffix}"), "joint", &taken)
    };
    let mut base = first;
    if row.kind == Kind::PinInSlot {
        let block = name(own, "_block");
        own.bodies.push(Body { name: block, points: vec![row.place], is_block: true, ..Body::default() });
        let (second, slot) = (own.bodies.len() - 1, name(own, "_slot"));
        own.joints.push(Joint {
            name: slot,
            first,
            second,
            place: row.place,
            axis: Some(row.axis),
            ..Joint::default()
        });
        base = second;
    }
    for &second in others {
        let axis = (row.kind == Kind::Prismatic).then_some(row.axis);
        let name = name(own, "");
        own.joints.push(Joint { name, first: base, second, place: row.place, axis, ..Joint::default() });
    }
    if row.is_driven {
        let drive = if own.drives.is_empty() { "drive".to_owned() } else { format!("drive_{of}") };
        own.drives.push((drive, own.joints.len() - others.len()));
    }
    Ok(())
}

/// Add 1 kg to each link, spread evenly over its points. Blocks have no mass.
fn add_masses(own: &mut Linkage) {
    for body in own.bodies.iter_mut().skip(1).filter(|body| !body.is_block) {
        let count = body.points.len() as f64;
        let center = [0, 1].map(|k| body.points.iter().map(|p| p[k]).sum::<f64>() / count);
        let square = |p: &[f64; 2]| (p[0] - center[0]).powi(2) + (p[1] - center[1]).powi(2);
        body.inertia = body.points.iter().map(square).sum::<f64>() / count;
        (body.mass, body.center) = (1.0, Some(center));
    }
    own.notes.push("the file states no masses: each link gets 1 kg, spread evenly over its points".to_owned());
}
