//! A canvas for one picture: lines, polygons, dots and words in pixels, with soft edges.
//!
//! In: shapes. Out: pixels. The module must not know what they show.

use anyhow::{Context, Result};
use tiny_skia::{Color, FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};
use ttf_parser::{Face, OutlineBuilder};

/// A point [px], or [m] in the mechanism frame.
pub type Point = [f64; 2];
/// Red, green and blue.
pub type Colour = [u8; 3];
/// The background.
pub const WHITE: Colour = [255; 3];

/// Size of a picture [px].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Width.
    pub width: u16,
    /// Height.
    pub height: u16,
}

/// Ubuntu Light without hints and tables that films do not use, with the derived name that its licence requires: the
/// output of `pyftsubset` with the options `--unicodes='*' --no-hinting --layout-features=''` and
/// `--drop-tables+=kern,GPOS,GSUB,GDEF,DSIG,gasp,VDMX,LTSH`.
const FONT: &[u8] = include_bytes!("font/ubuntu-light.ttf");

/// The font of all texts, because a machine may have no font.
pub struct Font(Face<'static>);

impl Font {
    /// The font.
    ///
    /// # Errors
    /// The font cannot be read.
    pub fn new() -> Result<Self> {
        Face::parse(FONT, 0).map(Self).context("the font of the film cannot be read")
    }

    /// Pixels per unit of the font for letters of the height `size` [px].
    fn scale(&self, size: f64) -> f64 {
        size / f64::from(self.0.height())
    }

    /// Width of a text [px].
    pub fn width(&self, text: &str, size: f64) -> f64 {
        let advance = |letter| self.0.glyph_hor_advance(self.0.glyph_index(letter).unwrap_or_default());
        self.scale(size) * text.chars().filter_map(advance).map(f64::from).sum::<f64>()
    }
}

/// Outline of a letter at its position.
struct Letter {
    path: PathBuilder,
    left: f32,
    foot: f32,
    scale: f32,
}

impl Letter {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.left + self.scale * x, self.foot - self.scale * y)
    }
}

impl OutlineBuilder for Letter {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

/// A picture in progress.
pub struct Canvas<'a> {
    picture: Pixmap,
    font: &'a Font,
}

impl<'a> Canvas<'a> {
    /// A white picture.
    ///
    /// # Errors
    /// The picture has no size.
    pub fn new(size: Size, font: &'a Font) -> Result<Self> {
        let mut picture = Pixmap::new(size.width.into(), size.height.into()).context("the picture has the size 0")?;
        picture.fill(Color::WHITE);
        Ok(Self { picture, font })
    }

    /// The pixels, line by line.
    pub fn pixels(&self) -> Vec<Colour> {
        self.picture.pixels().iter().map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect()
    }

    /// Width of a text [px].
    pub fn width(&self, text: &str, size: f64) -> f64 {
        self.font.width(text, size)
    }

    /// A line with hatching on its right-hand side, seen from its first end with y downward.
    pub fn hatch(&mut self, a: Point, b: Point, colour: Colour) {
        self.line(a, b, 1.4, colour);
        let length = distance(a, b);
        let [x, y] = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
        let count = (length / 5.0).round().max(1.0);
        for k in 0..=count as u32 {
            let [u, v] = between(a, b, f64::from(k) / count);
            self.line([u, v], [u - 4.0 * x - 5.0 * y, v - 4.0 * y + 5.0 * x], 1.0, colour);
        }
    }

    /// A text that starts at a point, or ends there if `is_right`. The point is at its upper edge. `size` is in px.
    pub fn text(&mut self, text: &str, [x, y]: Point, size: f64, colour: Colour, is_right: bool) {
        let Font(face) = self.font;
        let scale = self.font.scale(size);
        let mut left = if is_right { x - self.font.width(text, size) } else { x };
        let foot = y + scale * f64::from(face.ascender());
        for index in text.chars().map(|letter| face.glyph_index(letter).unwrap_or_default()) {
            let path = PathBuilder::new();
            let mut letter = Letter { path, left: left as f32, foot: foot as f32, scale: scale as f32 };
            face.outline_glyph(index, &mut letter);
            self.fill(letter.path.finish(), colour);
            left += scale * f64::from(face.glyph_hor_advance(index).unwrap_or_default());
        }
    }

    /// A line of this width [px].
    pub fn line(&mut self, a: Point, b: Point, width: f64, colour: Colour) {
        self.polyline(&[a, b], width, colour);
    }

    /// Lines from point to point.
    pub fn polyline(&mut self, points: &[Point], width: f64, colour: Colour) {
        let stroke = Stroke { width: width as f32, line_join: LineJoin::Round, ..Stroke::default() };
        // A shape without extent is not painted.
        if let Some(path) = path(points).finish() {
            self.picture.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
        }
    }

    /// A filled polygon.
    pub fn polygon(&mut self, corners: &[Point], colour: Colour) {
        let mut path = path(corners);
        path.close();
        self.fill(path.finish(), colour);
    }

    /// A filled circle.
    pub fn dot(&mut self, [x, y]: Point, radius: f64, colour: Colour) {
        self.fill(PathBuilder::from_circle(x as f32, y as f32, radius as f32), colour);
    }

    fn fill(&mut self, path: Option<Path>, colour: Colour) {
        if let Some(path) = path {
            self.picture.fill_path(&path, &paint(colour), FillRule::Winding, Transform::identity(), None);
        }
    }
}

fn paint([r, g, b]: Colour) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(Color::from_rgba8(r, g, b, u8::MAX));
    paint
}

fn path(points: &[Point]) -> PathBuilder {
    let mut path = PathBuilder::new();
    for (k, [x, y]) in points.iter().enumerate() {
        match k {
            0 => path.move_to(*x as f32, *y as f32),
            _ => path.line_to(*x as f32, *y as f32),
        }
    }
    path
}

/// The point at this part of the distance from the first point to the second.
pub fn between([x1, y1]: Point, [x2, y2]: Point, part: f64) -> Point {
    [x1 + (x2 - x1) * part, y1 + (y2 - y1) * part]
}

/// Distance of two points.
pub fn distance([x1, y1]: Point, [x2, y2]: Point) -> f64 {
    (x2 - x1).hypot(y2 - y1)
}
