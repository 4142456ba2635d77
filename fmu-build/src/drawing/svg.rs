//! Drawings as SVG.
//!
//! In: a drawing. Out: the text of one element, every text escaped.

use super::{Drawing, Form, Ink, Label, Part, Shape, Weight};
use crate::xml::common::{Attributes, Xml, element, empty};
use anyhow::Result;
use quick_xml::Writer;
use quick_xml::events::BytesText;
use std::io;

/// Colours of bodies, in the order of their numbers.
pub const BODIES: [[u8; 3]; 8] = [
    [0x3f, 0x7f, 0xc1],
    [0xd9, 0x83, 0x24],
    [0x3a, 0x9d, 0x6b],
    [0x8c, 0x62, 0xc0],
    [0xc9, 0x50, 0x6f],
    [0x25, 0x98, 0xa3],
    [0x94, 0x81, 0x2f],
    [0x6d, 0x7f, 0x95],
];
const WHITE: [u8; 3] = [0xff; 3];
const INK: [u8; 3] = [0x16, 0x20, 0x2b];
/// Part of a body's colour in its surface. The rest is the colour of the paper.
const SURFACE: f64 = 0.30;
/// Part of a body's colour in its edge. The rest is the colour of lines.
const EDGE: f64 = 0.78;

/// Source of the colours of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colours {
    /// CSS variables of the surrounding page, which has a light and a dark mode.
    OfThePage,
    /// The light colours, written into the drawing.
    Own,
}

impl Ink {
    /// The colour in light mode.
    pub fn light(self) -> [u8; 3] {
        let of = |body: usize| BODIES[body % BODIES.len()];
        match self {
            Self::Paper => WHITE,
            Self::Line => INK,
            Self::Muted => [0x5b, 0x68, 0x77],
            Self::Metal => [0xdf, 0xe5, 0xec],
            Self::Steel => [0x56, 0x65, 0x7a],
            Self::Edge(body) => mixed(of(body), EDGE, INK),
            Self::Body(body) => mixed(of(body), SURFACE, WHITE),
            Self::Accent => [0x0b, 0x62, 0xc4],
            Self::Oil => [0xf2, 0xc9, 0x9a],
        }
    }

    /// The colour as CSS, from the variables of the page.
    fn of_the_page(self) -> String {
        let part = |body: usize, part: f64, rest: &str| {
            format!("color-mix(in srgb,{} {}%,var(--{rest}))", hex(BODIES[body % BODIES.len()]), (100.0 * part).round())
        };
        match self {
            Self::Paper => "var(--panel)".to_owned(),
            Self::Line => "var(--ink)".to_owned(),
            Self::Muted => "var(--muted)".to_owned(),
            Self::Metal => "var(--metal)".to_owned(),
            Self::Steel => "var(--steel)".to_owned(),
            Self::Edge(body) => part(body, EDGE, "ink"),
            Self::Body(body) => part(body, SURFACE, "panel"),
            Self::Accent => "var(--accent)".to_owned(),
            Self::Oil => "var(--oil)".to_owned(),
        }
    }
}

fn mixed(one: [u8; 3], part: f64, other: [u8; 3]) -> [u8; 3] {
    std::array::from_fn(|i| (part * f64::from(one[i]) + (1.0 - part) * f64::from(other[i])).round() as u8)
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The `svg` element of a drawing, with its name and description. `id` is the prefix of its identifiers, so that one
/// page can contain several drawings.
///
/// # Errors
/// XML cannot be written.
pub fn to_svg(drawing: &Drawing, colours: Colours, id: &str) -> Result<String> {
    let mut xml = Writer::new(Vec::new());
    let [width, height] = drawing.size.map(pixels);
    let attributes = [
        ("xmlns", "http://www.w3.org/2000/svg".to_owned()),
        ("viewBox", format!("0 0 {width} {height}")),
        ("width", width),
        ("height", height),
        ("role", "img".to_owned()),
        ("aria-labelledby", format!("{id}-title {id}-description")),
    ];
    element(&mut xml, "svg", &attributes, |xml| {
        text(xml, "title", vec![("id", format!("{id}-title"))], &drawing.title)?;
        text(xml, "desc", vec![("id", format!("{id}-description"))], &drawing.description)?;
        drawing.shapes.iter().try_for_each(|shape| write_shape(xml, shape, colours))?;
        drawing.labels.iter().try_for_each(|label| write_label(xml, label, colours))
    })?;
    Ok(String::from_utf8(xml.into_inner())?)
}

/// A length with two digits after the point, without trailing zeros.
fn pixels(x: f64) -> String {
    let text = format!("{x:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

fn text(xml: &mut Xml, name: &str, attributes: Attributes, content: &str) -> io::Result<()> {
    element(xml, name, &attributes, |xml| {
        // XML cannot represent control characters. check_texts rejects them in every text of the FMU.
        let clean: String = content.chars().filter(|c| !c.is_control()).collect();
        xml.write_event(quick_xml::events::Event::Text(BytesText::new(&clean)))
    })
}

/// The colours as attributes. In a page they are a style, because only a style can use variables.
fn colouring(pairs: &[(&str, Option<Ink>)], colours: Colours) -> Attributes<'static> {
    let value = |ink: Option<Ink>| match (ink, colours) {
        (None, _) => "none".to_owned(),
        (Some(ink), Colours::Own) => hex(ink.light()),
        (Some(ink), Colours::OfThePage) => ink.of_the_page(),
    };
    match colours {
        Colours::Own => {
            pairs.iter().map(|(name, ink)| (if *name == "fill" { "fill" } else { "stroke" }, value(*ink))).collect()
        }
        Colours::OfThePage => {
            let style: Vec<String> = pairs.iter().map(|(name, ink)| format!("{name}:{}", value(*ink))).collect();
            vec![("style", style.join(";"))]
        }
    }
}

fn write_shape(xml: &mut Xml, shape: &Shape, colours: Colours) -> io::Result<()> {
    let mut attributes = colouring(&[("fill", shape.fill), ("stroke", shape.stroke.map(|(ink, _)| ink))], colours);
    if let Some((_, width)) = shape.stroke {
        attributes.push(("stroke-width", pixels(width)));
    }
    if !shape.dashes.is_empty() {
        let dashes: Vec<String> = shape.dashes.iter().map(|length| pixels(*length)).collect();
        attributes.push(("stroke-dasharray", dashes.join(" ")));
    }
    let name = match &shape.form {
        Form::Lines { points, is_closed } => {
            let corners: Vec<String> = points.iter().map(|[x, y]| format!("{} {}", pixels(*x), pixels(*y))).collect();
            let end = if *is_closed { "Z" } else { "" };
            attributes.push(("d", format!("M{}{end}", corners.join("L"))));
            attributes.push(("stroke-linejoin", "round".to_owned()));
            attributes.push(("stroke-linecap", "round".to_owned()));
            "path"
        }
        Form::Circle { center: [x, y], radius } => {
            attributes.extend([("cx", pixels(*x)), ("cy", pixels(*y)), ("r", pixels(*radius))]);
            "circle"
        }
    };
    let Some((part, of)) = &shape.part else { return empty(xml, name, &attributes) };
    attributes.push((
        match part {
            Part::Body => "data-body",
            Part::Joint => "data-joint",
            Part::Drive => "data-drive",
            Part::Spring => "data-spring",
            Part::Marker => "data-marker",
        },
        of.clone(),
    ));
    element(xml, name, &attributes, |xml| text(xml, "title", Vec::new(), of))
}

fn write_label(xml: &mut Xml, label: &Label, colours: Colours) -> io::Result<()> {
    let [x, y] = label.middle;
    let mut attributes = colouring(&[("fill", Some(label.ink)), ("stroke", Some(Ink::Paper))], colours);
    attributes.extend([
        ("x", pixels(x)),
        // The middle of a letter is above its baseline.
        ("y", pixels(y + 0.35 * size(label.weight))),
        ("text-anchor", "middle".to_owned()),
        ("font-family", "system-ui, sans-serif".to_owned()),
        ("font-size", pixels(size(label.weight))),
        ("font-weight", if label.weight == Weight::Strong { "600" } else { "400" }.to_owned()),
        ("paint-order", "stroke".to_owned()),
        ("stroke-width", "3.5".to_owned()),
        ("stroke-linejoin", "round".to_owned()),
    ]);
    text(xml, "text", attributes, &label.text)
}

/// Size of the letters [px].
pub(super) fn size(weight: Weight) -> f64 {
    match weight {
        Weight::Strong => 13.5,
        Weight::Plain => 12.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped_and_lengths_short() {
        let drawing = Drawing {
            size: [100.0, 50.5],
            title: "</title><script>\"'&".to_owned(),
            description: "a\nb".to_owned(),
            shapes: vec![
                Shape::circle([1.0 / 3.0, -0.001], 2.0, Ink::Paper, (Ink::Edge(9), 1.25)).of(Part::Joint, "\"><x>"),
            ],
            labels: vec![Label { middle: [1.0, 2.0], text: "<b>".to_owned(), weight: Weight::Plain, ink: Ink::Line }],
        };
        let own = to_svg(&drawing, Colours::Own, "a").unwrap();
        assert!(own.contains("<title id=\"a-title\">&lt;/title&gt;&lt;script&gt;"), "{own}");
        assert!(own.contains("data-joint=\"&quot;&gt;&lt;x&gt;\"") && own.contains("&lt;b&gt;</text>"), "{own}");
        assert!(own.contains("cx=\"0.33\" cy=\"0\" r=\"2\"") && own.contains("viewBox=\"0 0 100 50.5\""), "{own}");
        assert!(own.contains("fill=\"#ffffff\" stroke=\"#ae6d26\" stroke-width=\"1.25\""), "{own}");
        assert!(!own.contains("<script>") && !own.contains("<x>") && own.contains(">ab</desc>"), "{own}");
        let of_the_page = to_svg(&drawing, Colours::OfThePage, "a").unwrap();
        assert!(of_the_page.contains("style=\"fill:var(--panel);stroke:color-mix(in srgb,#d98324 78%,var(--ink))\""));
    }
}
