//! Drawings of a model as shapes in pixels.
//!
//! In: scene and poses of a mechanism, or the dimensions of a cylinder. Out: shapes, written as SVG or painted as PNG.
//! The module must not know where a drawing is shown.

mod cylinder;
mod geometry;
mod labels;
mod mechanism;
mod paint;
pub mod png;
mod svg;

pub use cylinder::{Cylinder, cylinder};
pub use geometry::hull;
pub use mechanism::{designs, mechanism, position, sides};
pub use paint::to_png;
pub use svg::{BODIES, Colours, to_svg};

/// A point of a drawing [px], y downward.
pub type Point = [f64; 2];

/// Colour of a line or a surface. The colours differ between light and dark mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// The background.
    Paper,
    /// Lines and letters.
    Line,
    /// Lines of fixed parts, hatching, secondary letters.
    Muted,
    /// Surface of metal: supports, barrels.
    Metal,
    /// Edge of metal.
    Steel,
    /// Edge of the body with this number.
    Edge(usize),
    /// Surface of the body with this number.
    Body(usize),
    /// Markers.
    Accent,
    /// Oil.
    Oil,
}

/// Form of a shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// Straight lines from point to point, with round joins.
    Lines {
        /// Corners.
        points: Vec<Point>,
        /// Whether the last point is joined to the first.
        is_closed: bool,
    },
    /// Circle.
    Circle {
        /// Centre.
        center: Point,
        /// Radius [px].
        radius: f64,
    },
}

/// Kind of the part of a model that a shape represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A body.
    Body,
    /// A joint.
    Joint,
    /// A drive.
    Drive,
    /// A spring or a damper.
    Spring,
    /// A marker.
    Marker,
}

/// A shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Form.
    pub form: Form,
    /// Colour of the surface.
    pub fill: Option<Ink>,
    /// Colour and width of the line [px].
    pub stroke: Option<(Ink, f64)>,
    /// Lengths of dashes and gaps [px]. Empty for a solid line.
    pub dashes: &'static [f64],
    /// The part that it represents, with its name.
    pub part: Option<(Part, String)>,
}

/// Weight of a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// Name of a body.
    Strong,
    /// Any other name.
    Plain,
}

/// A text.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Middle of the text [px].
    pub middle: Point,
    /// The text.
    pub text: String,
    /// Weight.
    pub weight: Weight,
    /// Colour.
    pub ink: Ink,
}

/// A drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width and height [px].
    pub size: [f64; 2],
    /// Name, for screen readers.
    pub title: String,
    /// Description of the picture, for screen readers.
    pub description: String,
    /// Shapes, from back to front.
    pub shapes: Vec<Shape>,
    /// Texts, in front of all shapes.
    pub labels: Vec<Label>,
}

impl Drawing {
    /// This drawing with another drawing to its right.
    fn next_to(mut self, mut other: Self) -> Self {
        let shift = |point: &mut Point| point[0] += self.size[0];
        for shape in &mut other.shapes {
            match &mut shape.form {
                Form::Lines { points, .. } => points.iter_mut().for_each(shift),
                Form::Circle { center, .. } => shift(center),
            }
        }
        other.labels.iter_mut().for_each(|label| shift(&mut label.middle));
        self.size = [self.size[0] + other.size[0], self.size[1].max(other.size[1])];
        self.title = format!("{}; {}", self.title, other.title);
        self.shapes.append(&mut other.shapes);
        self.labels.append(&mut other.labels);
        self
    }
}

/// Size and level of detail of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Format {
    /// For a page of this width [px], with names, axes and a scale.
    Page {
        /// Width [px].
        width: f64,
    },
    /// A square with sides of this length [px], without letters.
    Icon {
        /// Side [px].
        side: f64,
    },
}

impl Format {
    /// Factor of the sizes of symbols.
    fn symbols(self) -> f64 {
        match self {
            Self::Page { .. } => 1.0,
            Self::Icon { side } => side / 230.0,
        }
    }

    fn is_page(self) -> bool {
        matches!(self, Self::Page { .. })
    }
}

impl Shape {
    /// An open line.
    fn line(points: Vec<Point>, ink: Ink, width: f64) -> Self {
        let form = Form::Lines { points, is_closed: false };
        Self { form, fill: None, stroke: Some((ink, width)), dashes: &[], part: None }
    }

    /// A closed line with a surface.
    fn area(points: Vec<Point>, fill: Ink, stroke: (Ink, f64)) -> Self {
        let form = Form::Lines { points, is_closed: true };
        Self { form, fill: Some(fill), stroke: Some(stroke), dashes: &[], part: None }
    }

    fn circle(center: Point, radius: f64, fill: Ink, stroke: (Ink, f64)) -> Self {
        let form = Form::Circle { center, radius };
        Self { form, fill: Some(fill), stroke: Some(stroke), dashes: &[], part: None }
    }

    fn dashed(mut self, dashes: &'static [f64]) -> Self {
        self.dashes = dashes;
        self
    }

    fn of(mut self, part: Part, name: &str) -> Self {
        self.part = Some((part, name.to_owned()));
        self
    }
}

/// A position and a direction. The points of a long part, such as a cylinder, are given along and across this
/// direction.
#[derive(Clone, Copy, Debug)]
struct Along {
    origin: Point,
    /// Direction, of length 1.
    unit: Point,
}

impl Along {
    /// From one point to another, with their distance [px].
    fn between(a: Point, b: Point) -> (Self, f64) {
        let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        let length = dx.hypot(dy);
        let unit = if length > 0.0 { [dx / length, dy / length] } else { [1.0, 0.0] };
        (Self { origin: a, unit }, length)
    }

    /// The point `along` the direction and `aside` of it, to the right when looking along the direction [px].
    fn at(&self, along: f64, aside: f64) -> Point {
        let [x, y] = self.unit;
        [self.origin[0] + along * x - aside * y, self.origin[1] + along * y + aside * x]
    }

    fn rectangle(&self, [from, to]: [f64; 2], [left, right]: [f64; 2]) -> Vec<Point> {
        vec![self.at(from, left), self.at(to, left), self.at(to, right), self.at(from, right)]
    }
}

/// An arrow from one point to another, with a head of this length [px].
fn arrow(from: Point, to: Point, head: f64, ink: Ink, width: f64) -> [Shape; 2] {
    let (along, length) = Along::between(from, to);
    let tip = vec![along.at(length, 0.0), along.at(length - head, 0.4 * head), along.at(length - head, -0.4 * head)];
    [Shape::line(vec![from, along.at(length - 0.8 * head, 0.0)], ink, width), Shape::area(tip, ink, (ink, 0.5 * width))]
}
