//! Positions of names: near the named points, clear of lines and of other names if there is room.
//!
//! In: shapes, names with the points that they name. Out: labels inside the drawing.

use super::svg::size;
use super::{Form, Ink, Label, Point, Shape, Weight};

/// A name that needs a position.
#[derive(Clone, Debug)]
pub struct Wish {
    /// The named point [px].
    pub at: Point,
    /// Distance to keep from this point [px].
    pub away: f64,
    pub text: String,
    pub weight: Weight,
    pub ink: Ink,
}

/// Width of a letter relative to its size: the mean of common fonts, rounded up.
const LETTER: f64 = 0.6;
/// Distance between two points of a line that a label avoids [px].
const GRAIN: f64 = 3.0;
/// Largest number of such points.
const MOST_GRAINS: usize = 20_000;
/// Number of directions in which positions are tried, the upper right first.
const DIRECTIONS: usize = 16;
/// Distances at which positions are tried [px], in addition to the distance to keep.
const DISTANCES: [f64; 4] = [3.0, 9.0, 18.0, 32.0];
/// Cost of a point of a line below a label, the unit of all costs [1].
const LINE: f64 = 1.0;
/// Cost of another label below the label.
const LABEL: f64 = 60.0;
/// Free height between two labels [px].
const GAP: f64 = 3.0;
/// Cost of a position beyond the edge.
const OUTSIDE: f64 = 300.0;
/// Cost per pixel of distance.
const PIXEL: f64 = 0.22;

/// Smallest and largest x and y [px].
type Box = [f64; 4];

/// Labels for these wishes, placed one after the other. Existing labels keep their positions.
pub fn place(wishes: Vec<Wish>, mut labels: Vec<Label>, shapes: &[Shape], [width, height]: [f64; 2]) -> Vec<Label> {
    let mut grains: Vec<Point> = shapes.iter().flat_map(grains).collect();
    let stride = grains.len().div_ceil(MOST_GRAINS).max(1);
    grains = grains.into_iter().step_by(stride).collect();
    let half = |text: &str, weight: Weight| {
        [0.5 * LETTER * size(weight) * text.chars().count() as f64 + 1.0, 0.55 * size(weight)]
    };
    let mut taken: Vec<Box> =
        labels.iter().map(|label| around(label.middle, half(&label.text, label.weight))).collect();
    for wish in wishes {
        let half = half(&wish.text, wish.weight);
        let cost = |middle: Point, distance: f64| {
            let own = around(middle, half);
            let on_lines = grains.iter().filter(|[x, y]| own[0] < *x && *x < own[2] && own[1] < *y && *y < own[3]);
            let on_labels = taken.iter().filter(|other| {
                own[0] < other[2] && other[0] < own[2] && own[1] < other[3] + GAP && other[1] < own[3] + GAP
            });
            let is_outside = own[0] < 2.0 || own[1] < 2.0 || own[2] > width - 2.0 || own[3] > height - 2.0;
            LINE * on_lines.count() as f64
                + LABEL * on_labels.count() as f64
                + if is_outside { OUTSIDE } else { 0.0 }
                + PIXEL * distance
        };
        let best = places(&wish, half).min_by(|a, b| cost(a.0, a.1).total_cmp(&cost(b.0, b.1)));
        let middle = best.map_or(wish.at, |(middle, _)| middle);
        taken.push(around(middle, half));
        labels.push(Label { middle, text: wish.text, weight: wish.weight, ink: wish.ink });
    }
    labels
}

fn around([x, y]: Point, [w, h]: [f64; 2]) -> Box {
    [x - w, y - h, x + w, y + h]
}

/// Positions around a point. The distance is that of the edge of the label.
fn places(wish: &Wish, [w, h]: [f64; 2]) -> impl Iterator<Item = (Point, f64)> {
    let ([x, y], away) = (wish.at, wish.away);
    DISTANCES.into_iter().flat_map(move |distance| {
        (0..DIRECTIONS).map(move |k| {
            let angle = std::f64::consts::TAU * (k as f64 / DIRECTIONS as f64 - 0.125);
            let [c, s] = [angle.cos(), angle.sin()];
            // Distance from the edge of a box to its centre in this direction.
            let inside = (w / c.abs().max(1e-9)).min(h / s.abs().max(1e-9)).min(w);
            let r = away + distance + inside;
            ([x + r * c, y + r * s], distance)
        })
    })
}

/// Points along the lines of a shape.
fn grains(shape: &Shape) -> Vec<Point> {
    match &shape.form {
        Form::Circle { center: [x, y], radius } => {
            let count = (radius / GRAIN * 6.0).ceil().max(6.0) as usize;
            let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
            (0..count).map(|k| [x + radius * angle(k).cos(), y + radius * angle(k).sin()]).chain([[*x, *y]]).collect()
        }
        Form::Lines { points, is_closed } => {
            let ends = points.iter().skip(1).chain(points.first().filter(|_| *is_closed));
            let between = |([ax, ay], [bx, by]): (&Point, &Point)| {
                let count = ((bx - ax).hypot(by - ay) / GRAIN).ceil().max(1.0) as usize;
                let (ax, ay, dx, dy) = (*ax, *ay, bx - ax, by - ay);
                (0..=count).map(move |k| k as f64 / count as f64).map(move |t| [ax + t * dx, ay + t * dy])
            };
            let middle = points.iter().zip(ends).flat_map(between);
            // The edges of a wide line are avoided too.
            let half = shape.stroke.map_or(0.0, |(_, width)| 0.5 * width);
            let sides: &[Point] = if half > GRAIN {
                &[[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
            } else {
                &[[0.0, 0.0]]
            };
            middle.flat_map(|[x, y]| sides.iter().map(move |[u, v]| [x + half * u, y + half * v])).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish(at: Point) -> Wish {
        Wish { at, away: 5.0, text: "joint".to_owned(), weight: Weight::Plain, ink: Ink::Line }
    }

    #[test]
    fn labels_of_one_point_stand_apart_and_inside() {
        let size = [200.0, 200.0];
        let labels = place(vec![wish([100.0, 100.0]), wish([100.0, 100.0]), wish([195.0, 5.0])], Vec::new(), &[], size);
        let [a, b, c] = [0, 1, 2].map(|k| labels[k].middle);
        assert!((a[0] - b[0]).abs() > 30.0 || (a[1] - b[1]).abs() > 12.0, "{a:?} {b:?}");
        assert!(c[0] < 180.0 && c[1] > 5.0, "{c:?}");
    }

    #[test]
    fn labels_avoid_lines() {
        // A line through the preferred position.
        let line = Shape::line(vec![[100.0, 100.0], [200.0, 0.0]], Ink::Line, 2.0);
        let labels = place(vec![wish([100.0, 100.0])], Vec::new(), std::slice::from_ref(&line), [200.0, 200.0]);
        let own = around(labels[0].middle, [18.0, 6.6]);
        assert!(grains(&line).iter().all(|[x, y]| *x < own[0] || *x > own[2] || *y < own[1] || *y > own[3]));
    }
}
