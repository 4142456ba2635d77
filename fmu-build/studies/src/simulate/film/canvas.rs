//! A canvas for one picture: lines, polygons, dots and words in pixels, drawn three times as large and reduced, for
//! soft edges.
//!
//! In: shapes. Out: pixels. It must not know what they show.

use crate::simulate::picture::FONT;
use anyhow::Result;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// The picture is drawn so many times as large.
const FINE: u32 = 3;

/// A point [px], or [m] in the mechanism frame.
pub type Point = [f64; 2];

/// Size of a picture [px].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Width.
    pub width: u16,
    /// Height.
    pub height: u16,
}

/// A picture that is being drawn.
pub struct Canvas<'a> {
    area: DrawingArea<BitMapBackend<'a>, Shift>,
}

impl Canvas<'_> {
    /// The pixels, line by line, of what is drawn on white.
    ///
    /// # Errors
    /// Those of `draw`.
    pub fn drawn(size: Size, draw: impl FnOnce(&Canvas) -> Result<()>) -> Result<Vec<[u8; 3]>> {
        let [width, height] = [size.width, size.height].map(|side| FINE * u32::from(side));
        let mut fine = vec![0; 3 * (width * height) as usize];
        {
            let area = BitMapBackend::with_buffer(&mut fine, (width, height)).into_drawing_area();
            area.fill(&WHITE)?;
            let canvas = Canvas { area };
            draw(&canvas)?;
            canvas.area.present()?;
        }
        let sum = |row: u32, column: u32, part: u32| -> u32 {
            let cells = (0..FINE * FINE).map(|k| (row * FINE + k / FINE) * width + column * FINE + k % FINE);
            cells.map(|cell| u32::from(fine[(3 * cell + part) as usize])).sum()
        };
        let pixel = |row: u32, column: u32| [0, 1, 2].map(|part| (sum(row, column, part) / (FINE * FINE)) as u8);
        let rows = 0..u32::from(size.height);
        Ok(rows.flat_map(|row| (0..u32::from(size.width)).map(move |column| pixel(row, column))).collect())
    }

    /// Width of a text [px].
    ///
    /// # Errors
    /// The font is not known.
    pub fn width(&self, text: &str, size: f64) -> Result<f64> {
        let style = (FONT, size * f64::from(FINE)).into_text_style(&self.area);
        Ok(f64::from(self.area.estimate_text_size(text, &style)?.0) / f64::from(FINE))
    }

    /// A line with hatching on its right-hand side, seen from its first end with y downward.
    pub fn hatch(&self, a: Point, b: Point, colour: RGBColor) -> Result<()> {
        self.line(a, b, 1.4, colour)?;
        let length = distance(a, b);
        let [x, y] = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
        let count = (length / 5.0).round().max(1.0);
        for k in 0..=count as u32 {
            let [u, v] = between(a, b, f64::from(k) / count);
            self.line([u, v], [u - 4.0 * x - 5.0 * y, v - 4.0 * y + 5.0 * x], 1.0, colour)?;
        }
        Ok(())
    }

    /// A text whose upper corner on this side is at a point; `size` [px].
    pub fn text(&self, text: &str, at: Point, size: f64, colour: RGBColor, side: HPos) -> Result<()> {
        let style = (FONT, size * f64::from(FINE)).into_text_style(&self.area).color(&colour);
        let style = style.pos(Pos::new(side, VPos::Top));
        self.area.draw(&Text::new(text.to_owned(), fine(at), style))?;
        Ok(())
    }

    /// A line of this width [px].
    pub fn line(&self, a: Point, b: Point, width: f64, colour: RGBColor) -> Result<()> {
        let [(x1, y1), (x2, y2)] = [fine(a), fine(b)];
        if (x1, y1) == (x2, y2) {
            return Ok(());
        }
        // A polygon of its own: what plotters draws as a wide line has rounded widths.
        let length = distance(a, b);
        let [u, v] = [-(b[1] - a[1]) * 0.5 * width / length, (b[0] - a[0]) * 0.5 * width / length];
        self.polygon(&[[a[0] + u, a[1] + v], [b[0] + u, b[1] + v], [b[0] - u, b[1] - v], [a[0] - u, a[1] - v]], colour)
    }

    /// Lines from point to point.
    pub fn polyline(&self, points: &[Point], width: f64, colour: RGBColor) -> Result<()> {
        points.windows(2).try_for_each(|pair| self.line(pair[0], pair[1], width, colour))
    }

    /// A filled polygon.
    pub fn polygon(&self, corners: &[Point], colour: RGBColor) -> Result<()> {
        let corners: Vec<(i32, i32)> = corners.iter().map(|corner| fine(*corner)).collect();
        self.area.draw(&Polygon::new(corners, colour.filled()))?;
        Ok(())
    }

    /// A filled circle.
    pub fn dot(&self, center: Point, radius: f64, colour: RGBColor) -> Result<()> {
        self.area.draw(&Circle::new(fine(center), (radius * f64::from(FINE)).round() as i32, colour.filled()))?;
        Ok(())
    }
}

/// The point at this part of the way from the first point to the second.
pub fn between([x1, y1]: Point, [x2, y2]: Point, part: f64) -> Point {
    [x1 + (x2 - x1) * part, y1 + (y2 - y1) * part]
}

/// Distance of two points.
pub fn distance([x1, y1]: Point, [x2, y2]: Point) -> f64 {
    (x2 - x1).hypot(y2 - y1)
}

/// The nearest point of the large picture.
fn fine([x, y]: Point) -> (i32, i32) {
    let of = |part: f64| (part * f64::from(FINE)).round() as i32;
    (of(x), of(y))
}

/// Corners of the convex hull in order (Andrew 1979); two of points in a line, one of points at one place.
pub fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup_by(|a, b| distance(*a, *b) < 0.01);
    if points.len() < 3 {
        return points;
    }
    let is_left = |a: Point, b: Point, c: Point| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 1e-3 * distance(a, b) * distance(a, c)
    };
    let half = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for point in points {
            while chain.len() > 1 && !is_left(chain[chain.len() - 2], chain[chain.len() - 1], point) {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut corners = half(&mut points.iter().copied());
    corners.extend(half(&mut points.iter().rev().copied()));
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_is_what_a_rubber_band_holds() {
        let square = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0], [1.0, 0.0]];
        assert_eq!(hull(square), [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        assert_eq!(hull(vec![[0.0, 0.0], [4.0, 2.0], [2.0, 1.0]]), [[0.0, 0.0], [4.0, 2.0]]);
        assert_eq!(hull(vec![[1.0, 1.0]; 3]), [[1.0, 1.0]]);
    }
}
