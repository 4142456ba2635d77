//! Positions of the FMUs of a system and of their connectors in the diagram of an editor.
//!
//! In: numbers of connectors, and pairs of connected FMUs. Out: rectangles that do not overlap, with inputs on the
//! left, outputs on the right and parameters at the bottom. Editors scale the diagram, so that lengths have no unit.
//! The module must not know names.

use linkage_fmu::variables::{Causality, Variable};

/// Distance between two connectors on the left or right side of an FMU.
const PITCH: f64 = 10.0;
/// Width of an FMU.
const WIDTH: f64 = 160.0;
/// Distance between two columns of FMUs, and between two FMUs of one column.
const GAPS: [f64; 2] = [80.0, 30.0];
/// Distance from the FMUs to the edge of the diagram.
const MARGIN: f64 = 40.0;

/// A rectangle: x and y of its lower left corner, then of its upper right one. The y axis points up.
pub type Area = [f64; 4];

/// Side of a connector: inputs on the left, outputs on the right, all others at the bottom.
fn side(variable: &Variable) -> usize {
    match variable.causality {
        Causality::Input => 0,
        Causality::Output => 1,
        _ => 2,
    }
}

/// Number of connectors on each side of an FMU with these connectors.
fn counts(connectors: &[&Variable]) -> [usize; 3] {
    let mut counts = [0; 3];
    connectors.iter().for_each(|variable| counts[side(variable)] += 1);
    counts
}

/// Positions of the connectors of an FMU, relative to its width and height from its lower left corner. On each side,
/// the first connector is at the top or on the left.
pub fn places(connectors: &[&Variable]) -> Vec<[f64; 2]> {
    let counts = counts(connectors);
    let mut next = [0; 3];
    let mut place = |variable: &&Variable| {
        let side = side(variable);
        let part = (next[side] as f64 + 0.5) / counts[side] as f64;
        next[side] += 1;
        match side {
            0 => [0.0, 1.0 - part],
            1 => [1.0, 1.0 - part],
            _ => [part, 0.0],
        }
    };
    connectors.iter().map(&mut place).collect()
}

/// Areas of FMUs with these connectors, and of the whole diagram. Each FMU is one column to the right of the last
/// previous FMU with which it is connected. FMUs of one column are therefore not connected.
pub fn areas(parts: &[Vec<&Variable>], connected: &[[usize; 2]]) -> (Vec<Area>, Area) {
    let mut columns: Vec<usize> = Vec::new();
    for part in 0..parts.len() {
        let others = connected.iter().filter_map(|pair| {
            let [first, second] = [pair[0].min(pair[1]), pair[0].max(pair[1])];
            (second == part && first < part).then_some(first)
        });
        columns.push(others.map(|other| columns[other] + 1).max().unwrap_or(0));
    }
    let mut tops = vec![0.0; columns.iter().max().map_or(0, |last| last + 1)];
    let mut areas = Vec::new();
    for (connectors, column) in parts.iter().zip(columns) {
        let [inputs, outputs, _] = counts(connectors);
        let height = PITCH * (inputs.max(outputs) + 1) as f64;
        let left = (WIDTH + GAPS[0]) * column as f64;
        areas.push([left, tops[column] - height, left + WIDTH, tops[column]]);
        tops[column] -= height + GAPS[1];
    }
    let edge = |index: usize, of: fn(f64, f64) -> f64, sign: f64| {
        areas.iter().map(|area: &Area| area[index]).reduce(of).unwrap_or(0.0) + sign * MARGIN
    };
    let whole = [edge(0, f64::min, -1.0), edge(1, f64::min, -1.0), edge(2, f64::max, 1.0), edge(3, f64::max, 1.0)];
    (areas, whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use linkage_fmu::variables::{Details, Kind, Variability};

    fn variable(causality: Causality) -> Variable {
        Variable {
            name: String::new(),
            description: String::new(),
            kind: Kind::Real,
            causality,
            variability: Variability::Continuous,
            unit: None,
            start: None,
            dependencies: Vec::new(),
            details: Details::default(),
        }
    }

    #[test]
    fn areas_do_not_overlap_and_connected_fmus_are_in_different_columns() {
        let [input, output] = [Causality::Input, Causality::Output].map(variable);
        let parts = [vec![&input; 3], vec![&output; 12], vec![], vec![&input; 5], vec![&output; 1]];
        let connected = [[1, 0], [0, 3], [3, 4], [4, 4]];
        let (areas, [left, bottom, right, top]) = super::areas(&parts, &connected);
        for (i, a) in areas.iter().enumerate() {
            assert!(a[0] < a[2] && a[1] < a[3] && left < a[0] && bottom < a[1] && a[2] < right && a[3] < top, "{a:?}");
            for b in &areas[..i] {
                assert!(a[0] >= b[2] || b[0] >= a[2] || a[1] >= b[3] || b[1] >= a[3], "{a:?} and {b:?}");
            }
        }
        for [a, b] in connected.into_iter().filter(|[a, b]| a != b) {
            assert!(areas[a][0] != areas[b][0], "{a} and {b}");
        }
    }

    #[test]
    fn each_kind_of_connector_has_its_side() {
        let [input, output, parameter] = [Causality::Input, Causality::Output, Causality::Parameter].map(variable);
        let places = super::places(&[&input, &output, &input, &parameter]);
        assert_eq!(places, [[0.0, 0.75], [1.0, 0.5], [0.0, 0.25], [0.5, 0.0]]);
    }
}
