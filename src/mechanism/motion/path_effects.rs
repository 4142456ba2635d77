//! Mean effects of constant loads between a start at rest and nodes along the path, for the energy integral.
//!
//! Without losses, and with loads whose sizes are constant, the kinetic energy sigma_dot^2 / 2 at sigma is the work
//! E(sigma) of the loads since the start. So t = integral of d sigma / sqrt(2 E). Its root at the start is removed by
//! sigma = first + L u^2, 0 <= u <= 1: the time is the integral over u of 1 / sqrt(g(u)), where g(u) is the sum of size
//! times the mean influence from the start to sigma, over 2 L. So g is linear in the sizes, and its coefficients at the
//! nodes of a quadrature are the same for all sizes.
//!
//! In: tables of influences, the ends of a path. Out: nodes in u, and g of each load there. It must not know times.
use crate::mechanism::reduced::Reduced;
use crate::numerics::chebyshev::NODES;
use crate::numerics::{legendre, order};

/// A path from a start at rest, with nodes of Gauss's rule on each of its panels.
#[derive(Clone, Debug)]
pub struct PathEffects {
    /// First u and last u of each panel, on which the influences are smooth.
    pub panels: Vec<[f64; 2]>,
    /// At u = 0, at [`NODES`] nodes on each panel, and at u = 1: g of the constant loads, then that of each varied load
    /// of the size 1.
    pub effects: Vec<Vec<f64>>,
}

impl PathEffects {
    /// From sigma = `first` to `last`, both counted on over the same whole revolutions. `sizes`: of all components of
    /// the influences; `varied`: those that differ from run to run. None where the influences have gaps, or nothing is
    /// to be varied.
    pub fn new(
        reduced: &Reduced,
        [first, last]: [f64; 2],
        (sizes, varied): (&[f64], &[usize]),
        rule: &[[f64; 2]],
    ) -> Option<Self> {
        let length = last - first;
        if reduced.exact || reduced.influence().gaps().len() > 0 || length == 0.0 || varied.is_empty() {
            return None;
        }
        let (borders, mut panels, mut from) = (borders(reduced, first, length), Vec::new(), 0.0);
        for to in borders.iter().map(|way| way.sqrt()).chain([1.0]) {
            panels.push([from, to]);
            from = to;
        }
        let node = |[from, to]: [f64; 2], x: f64| from + 0.5 * (to - from) * (1.0 + x);
        let points = panels.iter().flat_map(|panel| rule.iter().map(|[x, _]| node(*panel, *x)));
        let ways: Vec<f64> = points.chain([1.0]).map(|u| u * u).collect();
        let constant: Vec<usize> = (0..sizes.len()).filter(|k| sizes[*k] != 0.0 && !varied.contains(k)).collect();
        let acting = [&constant[..], varied].concat();
        let mut influences = Influences { reduced, components: &acting, panel: 0 };
        let at_start = influences.at(first).collect();
        let means = [at_start].into_iter().chain(means(&mut influences, [first, length], &borders, &ways));
        let effects = means.map(|means| {
            let (fixed, free) = means.split_at(constant.len());
            let fixed = fixed.iter().zip(&constant).map(|(mean, k)| sizes[*k] * mean).sum::<f64>();
            [fixed].iter().chain(free).map(|mean| mean / (2.0 * length)).collect()
        });
        Some(Self { effects: effects.collect(), panels })
    }
}

/// Some components of the influences, read from panel to panel.
struct Influences<'a> {
    reduced: &'a Reduced,
    components: &'a [usize],
    panel: usize,
}

impl Influences<'_> {
    /// Their values at sigma.
    fn at(&mut self, sigma: f64) -> impl Iterator<Item = f64> {
        let (table, (sigma, _)) = (self.reduced.influence(), self.reduced.unwound(sigma));
        let at = table.position_near(sigma, self.panel);
        self.panel = at.panel;
        self.components.iter().map(move |k| table.value(at, *k))
    }
}

/// Borders of panels between `first` and `first` + `length`, as parts of the way, ascending.
fn borders(reduced: &Reduced, first: f64, length: f64) -> Vec<f64> {
    let (table, period) = (reduced.influence(), reduced.period().unwrap_or(0.0));
    let all = (1..table.panels()).map(|panel| table.borders(panel).0).chain([reduced.curve().range.0]);
    let all = all.flat_map(|border| [-period, 0.0, period].map(|turn| (border + turn - first) / length));
    let mut borders: Vec<f64> = all.filter(|way| 0.0 < *way && *way < 1.0).collect();
    order::sort(&mut borders);
    borders.dedup();
    borders
}

/// Means of influences from `first` over these parts of the way of `length`, ascending, by a rule of Gauss on each
/// piece of a panel between two of them, which is exact.
fn means(influences: &mut Influences, [first, length]: [f64; 2], borders: &[f64], ways: &[f64]) -> Vec<Vec<f64>> {
    let rule = legendre::rule(NODES / 2);
    let mut borders = borders.iter().copied().peekable();
    let (mut from, mut sums, mut all) = (0.0, vec![0.0; influences.components.len()], Vec::new());
    for way in ways {
        while from < *way {
            let to = borders.next_if(|border| border <= way).unwrap_or(*way);
            let half = 0.5 * (to - from);
            for [x, weight] in &rule {
                let values = influences.at(first + length * (from + half * (1.0 + x)));
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += half * weight * value);
            }
            from = to;
        }
        all.push(sums.iter().map(|sum| sum / way).collect());
    }
    all
}
