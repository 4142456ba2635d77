//! Pyslvs: expressions, and projects that contain one.
//!
//! In: text. Out: the table of joints, and notes about omitted parts of the project.

use super::table::{Kind, Row, Table, kind, number};
use anyhow::{Context, Result, bail};

/// An expression of Pyslvs, alone or in a project (YAML): `M[J[R, P[x, y], L[ground, a]], J[P, A[degrees], P[x, y],
/// L[a, b]], ...]`.
///
/// # Errors
/// The text has another form. The message states the part.
pub fn of_pyslvs(text: &str) -> Result<Table> {
    let (expression, rest) = match text.find("mechanism:") {
        Some(at) if !text.trim_start().starts_with("M[") => (expression(&text[at + "mechanism:".len()..])?, Some(text)),
        _ => (text.to_owned(), None),
    };
    let bare: String = expression.lines().map(|line| line.split('#').next().unwrap_or_default()).collect();
    let bare = bare.trim();
    let inner = bare.strip_prefix("M[").and_then(|rest| rest.strip_suffix(']'));
    let inner = inner.context("an expression of Pyslvs has the form M[J[...], J[...]]")?;
    let mut rows = Vec::new();
    for (part, of) in parts(inner)?.into_iter().zip(1..) {
        let row = || -> Result<Row> {
            let joint = inside(part, "J").context("a joint has the form J[kind, P[x, y], L[links]]")?;
            let fields = parts(joint)?;
            let kind = fields.first().and_then(|word| kind(word)).context("the type of a joint must be R, P or RP")?;
            let field = |name: &str| fields.iter().find_map(|field| inside(field, name));
            let mut place = field("P").context("a joint needs its coordinates as P[x, y]")?.split(',').map(str::trim);
            let place = [number(place.next(), "x")?, number(place.next(), "y")?];
            let axis = match field("A") {
                Some(angle) => number(Some(angle.trim()), "A")?.to_radians(),
                None if kind == Kind::Revolute => 0.0,
                None => bail!("a slide (P, RP) needs its angle as A[degrees]"),
            };
            let links = field("L").context("a joint needs its links as L[a, b]")?;
            let links = links.split(',').map(str::trim).filter(|link| !link.is_empty());
            Ok(Row { kind, place, axis, links: links.map(str::to_owned).collect(), is_driven: false })
        };
        rows.push(row().with_context(|| format!("joint {of}: {}", part.escape_debug()))?);
    }
    let mut table = Table { rows, ..Table::default() };
    rest.map(|project| settings(&mut table, project)).transpose()?;
    Ok(table)
}

/// The expression of a project. YAML may break it into lines and put it into quotation marks.
fn expression(value: &str) -> Result<String> {
    let start = value.find("M[").context("the value of mechanism has the form M[J[...], J[...]]")?;
    let mut depth = 0;
    for (at, letter) in value[start..].char_indices() {
        depth += match letter {
            '[' => 1,
            ']' => -1,
            _ => 0,
        };
        if depth == 0 && letter == ']' {
            let words: Vec<&str> = value[start..=start + at].split_whitespace().collect();
            return Ok(words.join(" "));
        }
    }
    bail!("the mechanism of the project has no closing bracket: save the project again")
}

/// Inputs of a project: pairs of a point and the point that turns about it. Other settings are no part of the
/// mechanism.
fn settings(table: &mut Table, project: &str) -> Result<()> {
    let value = |key: &str| -> Option<&str> {
        let is_key = |at: usize| project[..at].ends_with(['\n', '{', ' ']) || at == 0;
        let at = project.match_indices(&format!("{key}:")).map(|(at, _)| at).find(|&at| is_key(at))?;
        let rest = &project[at + key.len() + 1..];
        // Up to the next key: a line that starts with a letter, or a comma after the last bracket.
        let ends = rest.match_indices('\n').map(|(at, _)| at);
        let mut ends = ends.filter(|&at| rest[at + 1..].starts_with(|letter: char| letter.is_ascii_alphabetic()));
        let block = ends.next().unwrap_or(rest.len());
        let flow = rest.trim_start().starts_with('[').then(|| rest.find("]]").map(|at| at + 2)).flatten();
        Some(&rest[..flow.unwrap_or(block)])
    };
    if let Some(input) = value("input") {
        let words = input.split(|letter: char| !letter.is_ascii_digit()).filter(|word| !word.is_empty());
        let numbers: Vec<usize> =
            words.map(str::parse).collect::<Result<_, _>>().context("input: a number is too large")?;
        let count = table.rows.len();
        for pair in numbers.chunks(2) {
            let row = pair.first().and_then(|&at| table.rows.get_mut(at));
            row.with_context(|| format!("input: the project has {count} points, but names {pair:?}"))?.is_driven = true;
        }
    }
    for (key, what) in [
        ("storage", "other mechanisms that the project keeps"),
        ("path", "recorded paths"),
        ("slider_path", "recorded paths of slides"),
        ("algorithm", "results of the synthesis"),
    ] {
        if value(key).is_some_and(|own| !matches!(own.trim(), "{}" | "[]" | "")) {
            table.notes.push(format!("{key} is left out: {what}"));
        }
    }
    Ok(())
}

/// The text in the brackets of `name[...]`.
fn inside<'a>(part: &'a str, name: &str) -> Option<&'a str> {
    part.trim().strip_prefix(name)?.strip_prefix('[')?.strip_suffix(']')
}

/// The parts between commas outside of brackets.
fn parts(text: &str) -> Result<Vec<&str>> {
    let (mut all, mut depth, mut from) = (Vec::new(), 0i32, 0);
    for (at, letter) in text.char_indices() {
        match letter {
            '[' | '(' => depth += 1,
            ']' | ')' => depth -= 1,
            ',' if depth == 0 => {
                all.push(text[from..at].trim());
                from = at + 1;
            }
            _ => {}
        }
        if depth < 0 {
            bail!("there is a surplus closing bracket before \"{}\"", text[at..].escape_debug());
        }
    }
    if depth != 0 {
        bail!("a closing bracket is missing: add ] at the end");
    }
    all.push(text[from..].trim());
    all.retain(|part| !part.is_empty());
    Ok(all)
}
