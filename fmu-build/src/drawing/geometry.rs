//! Convex hulls, round lengths, ranges.

use super::Point;

/// Corners of the convex hull, in order (Andrew 1979). Points with a distance below `least` count as one point.
pub fn hull(mut points: Vec<Point>, least: f64) -> Vec<Point> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup_by(|a, b| (a[0] - b[0]).hypot(a[1] - b[1]) < least);
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = &Point>| {
        let mut out: Vec<Point> = Vec::new();
        for &[x, y] in points {
            while let [.., o, a] = out.as_slice() {
                if (a[0] - o[0]) * (y - o[1]) - (a[1] - o[1]) * (x - o[0]) > 0.0 {
                    break;
                }
                out.pop();
            }
            out.push([x, y]);
        }
        out.pop();
        out
    };
    let mut corners = half(&mut points.iter());
    corners.extend(half(&mut points.iter().rev()));
    corners
}

/// Mean of points.
pub fn mean(points: &[Point]) -> Point {
    let count = points.len().max(1) as f64;
    points.iter().fold([0.0, 0.0], |[x, y], p| [x + p[0] / count, y + p[1] / count])
}

/// The largest of 1, 2 and 5 times a power of ten that is not larger than a length.
pub fn round_below(length: f64) -> f64 {
    let power = 10f64.powi(length.log10().floor() as i32);
    [5.0, 2.0, 1.0].into_iter().map(|k| k * power).find(|k| *k <= length).unwrap_or(power)
}

/// A length in km, m, mm or um.
pub fn with_prefix(length: f64) -> String {
    let prefixes = [(1e3, "km"), (1.0, "m"), (1e-3, "mm"), (1e-6, "\u{b5}m")];
    let (factor, unit) = prefixes.into_iter().find(|(factor, _)| length >= 0.1 * factor).unwrap_or(prefixes[3]);
    format!("{} {unit}", (1e6 * length / factor).round() / 1e6)
}

/// The smallest range of x and y that contains both ranges.
pub fn union(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_has_the_outer_points_only() {
        let square = vec![[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.0], [0.0, 0.0]];
        let corners = hull(square, 1e-6);
        assert_eq!(corners.len(), 4, "{corners:?}");
        assert!(!corners.contains(&[1.0, 1.0]) && !corners.contains(&[1.0, 0.0]));
        assert_eq!(hull(vec![[0.0, 0.0], [1.0, 1.0], [0.5, 0.5]], 1e-6).len(), 2);
        assert_eq!(hull(vec![[1.0, 1.0]; 3], 1e-6), [[1.0, 1.0]]);
    }

    #[test]
    fn scales_are_round() {
        for (length, below, words) in
            [(0.37, 0.2, "0.2 m"), (1.0, 1.0, "1 m"), (0.0093, 0.005, "5 mm"), (7200.0, 5000.0, "5 km")]
        {
            let round = round_below(length);
            assert!((round - below).abs() < 1e-12 * below, "{round}");
            assert_eq!(with_prefix(round), words);
        }
    }
}
