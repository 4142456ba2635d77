//! Positions along the travel, close enough together that a function of the tables turns at most once between two.
//!
//! In: a reduced model, the travel between its stops. Out: the ends of the travel, positions between them. It must not
//! know what is sampled.
use super::contact::Travel;
use crate::mechanism::curve::Ends;
use crate::mechanism::reduced::Reduced;
use crate::numerics::order;

/// Samples in each panel of the grid of tables.
const SAMPLES: usize = 8;
/// Most samples of a travel that goes round many times: whole revolutions between the ends change nothing but counts.
const REVOLUTIONS: f64 = 2.0;

/// Ends of the travel: at the first rigid stop on each side, else where two ends coincide, else of the curve, else one
/// revolution.
pub fn ends(reduced: &Reduced, travel: &Travel, here: f64) -> [f64; 2] {
    let (first, last) = reduced.curve().range;
    let [low, high] = [0, 1].map(|side| travel.end(side));
    match &reduced.curve().ends {
        Ends::Closed(_) => {
            let period = last - first;
            match (low, high) {
                (Some(low), Some(high)) => [low, high],
                (Some(low), None) => [low, low.max(here) + period],
                (None, Some(high)) => [high.min(here) - period, high],
                (None, None) => [first, last],
            }
        }
        _ => [low.unwrap_or(first), high.unwrap_or(last)],
    }
}

/// Positions to be sampled: those of the panels of the tables, in each revolution that the travel takes in, and on each
/// stretch of an open curve.
pub fn positions(reduced: &Reduced, [low, high]: [f64; 2]) -> Vec<f64> {
    let period = reduced.period();
    let turn = |sigma: f64| reduced.unwound(sigma).1;
    let (first, last) = (turn(low), turn(high));
    let revolutions: Vec<f64> = match period {
        Some(_) if last - first > REVOLUTIONS => vec![first, first + 1.0, last - 1.0, last],
        Some(_) => (0..=(last - first) as usize).map(|k| first + k as f64).collect(),
        None => vec![0.0],
    };
    let mut borders: Vec<(f64, f64)> = Vec::new();
    let mut stretch = reduced.at(low);
    loop {
        let table = stretch.influence();
        borders.extend((0..table.panels()).map(|panel| table.borders(panel)));
        match reduced.next(stretch, 1) {
            Ok(next) if stretch.curve().range.1 < high => stretch = next,
            _ => break,
        }
    }
    let mut all = vec![low, high];
    for revolution in revolutions {
        let shift = revolution * period.unwrap_or(0.0);
        for (a, b) in &borders {
            let inner = (0..=SAMPLES).map(|k| a + (b - a) * k as f64 / SAMPLES as f64 + shift);
            all.extend(inner.filter(|sigma| (low..=high).contains(sigma)));
        }
    }
    order::sort(&mut all);
    all.dedup();
    all
}
