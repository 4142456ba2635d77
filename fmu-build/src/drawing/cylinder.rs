//! The drawing of a hydraulic cylinder with its valve.
//!
//! In: the cylinder's dimensions and the position of its piston. Out: barrel, piston and rod to scale along the axis,
//! lines to a valve, supply and tank.

use super::{Along, Drawing, Format, Ink, Label, Part, Point, Shape, Weight, arrow};

/// A cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Diameter of the piston [m].
    pub bore: f64,
    /// Diameter of the rod [m].
    pub rod: f64,
    /// Stroke [m].
    pub stroke: f64,
    /// Distance of the ends of the cylinder with the piston at its inner end [m].
    pub closed_length: f64,
    /// Present distance of the ends of the cylinder [m].
    pub length: f64,
}

/// The drawing of a hydraulic actuator of this name.
pub fn cylinder(name: &str, cylinder: &Cylinder, format: Format) -> Drawing {
    let Cylinder { bore, rod, stroke, closed_length, length } = *cylinder;
    let (size, margin) = match format {
        Format::Page { width } => ([width, 0.46 * width], 60.0),
        Format::Icon { side } => ([side; 2], 0.12 * side),
    };
    let u = format.symbols();
    // An icon shows the piston near the middle and half a rod, so that the parts can be distinguished.
    let part = if format.is_page() { ((length - closed_length) / stroke).clamp(0.0, 1.0) } else { 0.4 };
    let reach = closed_length + stroke;
    let scale = (size[0] - 2.0 * margin) / reach;
    let [wide, high] = size;
    let middle = if format.is_page() { 0.30 * high } else { 0.36 * high };
    let axis = Along { origin: [margin, middle], unit: [1.0, 0.0] };
    let half = match format {
        Format::Page { .. } => (0.5 * bore * scale).clamp(22.0, 46.0),
        Format::Icon { .. } => 0.16 * high,
    };
    let rod_half = if format.is_page() { (half * rod / bore).max(2.0) } else { 0.35 * half };
    // The barrel with its heads is as long as the stroke. The rest belongs to the eye and the rod.
    let (from, inner) = (0.35 * (closed_length - stroke).max(0.1 * reach) * scale, stroke * scale);
    let (head, piston) = (6.0 * u, 9.0 * u);
    let to = from + inner + piston + 2.0 * head;
    let face = from + head + part * inner;
    let eye = if format.is_page() { (closed_length + part * stroke) * scale } else { wide - 2.0 * margin };
    let edge = (Ink::Steel, 1.6 * u);
    let mut shapes = vec![
        Shape::area(axis.rectangle([0.0, from], [-rod_half, rod_half]), Ink::Metal, edge),
        Shape::area(axis.rectangle([from, to], [-half, half]), Ink::Paper, edge),
    ];
    let inside = half - 2.0 * u;
    let chamber = |ends: [f64; 2]| Shape::area(axis.rectangle(ends, [-inside, inside]), Ink::Oil, (Ink::Oil, 0.5 * u));
    shapes.push(chamber([from + head, face]));
    shapes.push(chamber([face + piston, to - head]));
    shapes.push(Shape::area(axis.rectangle([face + piston, eye], [-rod_half, rod_half]), Ink::Metal, edge));
    let disc = axis.rectangle([face, face + piston], [-inside, inside]);
    shapes.push(Shape::area(disc, Ink::Steel, (Ink::Steel, u)).of(Part::Body, "piston"));
    let eyes = [0.0, eye];
    for end in eyes {
        shapes.push(Shape::circle(axis.at(end, 0.0), rod_half + 5.0 * u, Ink::Paper, (Ink::Line, 1.7 * u)));
    }
    let mut labels = Vec::new();
    let foot = circuit(&mut shapes, axis, [from + head + 8.0 * u, to - head - 8.0 * u], half, size, u);
    if format.is_page() {
        let mut label = |middle: Point, text: &str, ink: Ink| {
            labels.push(Label { middle, text: text.to_owned(), weight: Weight::Plain, ink });
        };
        label(axis.at(0.5 * (from + to), -half - 14.0), "cylinder", Ink::Line);
        let [a, b] = [(from + head + 8.0, "A"), (to - head - 8.0, "B")];
        for (at, letter) in [a, b] {
            label(
                axis.at(at + 44.0 * if letter == "A" { -1.0 } else { 1.0 }, half + 30.0),
                &format!("chamber {letter}"),
                Ink::Line,
            );
        }
        label([foot.valve[0], foot.valve[1]], "valve", Ink::Line);
        label([foot.supply[0] - 46.0, foot.supply[1]], "supply", Ink::Line);
        label([foot.tank[0] + 38.0, foot.tank[1]], "tank", Ink::Line);
        let below = -half - 34.0;
        shapes.extend(arrow(axis.at(0.5 * eye, below), axis.at(0.0, below), 8.0, Ink::Muted, 1.3));
        shapes.extend(arrow(axis.at(0.5 * eye, below), axis.at(eye, below), 8.0, Ink::Muted, 1.3));
        label(axis.at(0.5 * eye, below - 12.0), &format!("length {length:.4} m"), Ink::Muted);
        // End at the largest length.
        let end = reach * scale;
        shapes.push(Shape::line(vec![axis.at(eye, 0.0), axis.at(end, 0.0)], Ink::Muted, 1.0).dashed(&[4.0, 4.0]));
        shapes.push(Shape::line(vec![axis.at(end, -9.0), axis.at(end, 9.0)], Ink::Muted, 1.3));
        label(axis.at(end - 30.0, -22.0), &format!("at most {reach:.4} m"), Ink::Muted);
    }
    Drawing {
        size,
        title: format!("{name} at its start"),
        description: format!(
            "A cylinder with a piston of {bore} m, a rod of {rod} m and a stroke of {stroke} m; the ends are \
             {length} m apart. A valve connects chamber A (piston side) and chamber B (rod side) with supply and \
             tank."
        ),
        shapes,
        labels,
    }
}

/// Positions at the lower edge of the drawing.
struct Foot {
    valve: Point,
    supply: Point,
    tank: Point,
}

/// Lines from the ports through the valve to supply and tank.
fn circuit(shapes: &mut Vec<Shape>, axis: Along, ports: [f64; 2], half: f64, [_, high]: [f64; 2], u: f64) -> Foot {
    let [a, b] = ports.map(|port| axis.at(port, half));
    let x = 0.5 * (a[0] + b[0]);
    let top = 0.5 * (a[1] + high) - 4.0 * u;
    let (w, h) = (34.0 * u, 17.0 * u);
    let line = |points: Vec<Point>| Shape::line(points, Ink::Steel, 2.0 * u);
    let (left, right) = (x - 0.45 * w, x + 0.45 * w);
    let turn = 0.5 * (a[1] + top - h);
    shapes.push(line(vec![a, [a[0], turn], [left, turn], [left, top - h]]));
    shapes.push(line(vec![b, [b[0], turn], [right, turn], [right, top - h]]));
    let foot = high - 26.0 * u;
    let [supply, tank] = [[left, foot], [right, foot]];
    shapes.push(line(vec![[left, top + h], supply]));
    shapes.push(line(vec![[right, top + h], tank]));
    shapes.push(Shape::area(
        vec![[x - w, top - h], [x + w, top - h], [x + w, top + h], [x - w, top + h]],
        Ink::Metal,
        (Ink::Steel, 1.6 * u),
    ));
    shapes.push(Shape::circle(supply, 9.0 * u, Ink::Paper, (Ink::Steel, 1.8 * u)));
    let triangle =
        vec![[supply[0], supply[1] - 8.0 * u], [supply[0] - 5.0 * u, supply[1]], [supply[0] + 5.0 * u, supply[1]]];
    shapes.push(Shape::area(triangle, Ink::Steel, (Ink::Steel, 0.5 * u)));
    let [tx, ty] = tank;
    let cup = vec![
        [tx - 13.0 * u, ty - 4.0 * u],
        [tx - 13.0 * u, ty + 8.0 * u],
        [tx + 13.0 * u, ty + 8.0 * u],
        [tx + 13.0 * u, ty - 4.0 * u],
    ];
    shapes.push(line(cup));
    Foot { valve: [x, top], supply, tank }
}
