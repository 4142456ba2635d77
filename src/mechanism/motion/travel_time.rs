//! The time from a start at rest to a stop, as a function of the sizes of loads, by the energy integral.
//!
//! Without losses, and with loads whose sizes are constant, the kinetic energy sigma_dot^2 / 2 at sigma is the work
//! E(sigma) of the loads since the start. So t = integral of d sigma / sqrt(2 E). Its root at the start is removed by
//! sigma = first + L u^2, 0 <= u <= 1: the time is the integral over u of 1 / sqrt(g(u)), where g(u) is the sum of size
//! times the mean influence from the start to sigma, over 2 L. Times for some sets of sizes select the few nodes that
//! decide all such times; for other sizes only a sum at each of these is new.
//!
//! In: tables of influences, a start, a stop, sizes. Out: times, or NaN where the integral does not give it: the
//! mechanism stays, turns back, or moves unlike those by which the nodes were selected. It must not know steps.
use crate::mechanism::reduced::Reduced;
use crate::numerics::chebyshev::NODES;
use crate::numerics::legendre;
use crate::numerics::processor::{self, Arithmetic, Task};
use crate::numerics::selection::{CHECKS, select};

/// Largest error of 1 / sqrt(g) between the nodes, relative to its mean.
const ACCURACY: f64 = 1e-11;
/// Largest value of 1 / sqrt(g), relative to its mean, by which nodes are selected: with a larger one the mechanism is
/// almost at rest somewhere, and needs finer nodes.
const SLOWEST: f64 = 10.0;
/// Most positions, besides the ends, at which g is looked at because it is least there for some sizes.
const LOWEST: usize = 6;
/// Sets of sizes side by side.
const LANES: usize = 8;

/// The time of travel as a function of the sizes of some loads; the others are constant.
#[derive(Clone, Debug)]
pub struct TravelTime {
    /// Number of loads whose sizes differ.
    sizes: usize,
    nodes: Vec<Node>,
    /// At each node, for each of these loads: g for the size 1.
    effects: Vec<f64>,
}

/// A node.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Weight of 1 / sqrt(g) in the time, then in the errors by which the nodes are checked.
    weights: [f64; 1 + CHECKS],
    /// g of the loads whose sizes are constant.
    constant: f64,
}

impl TravelTime {
    /// From sigma = `first`, at rest, to `last`, both counted on over the same whole revolutions. `sizes`: of all
    /// components of the influences; `varied`: those that differ; `samples`: some sets of their sizes. None where the
    /// influences have gaps, or the times for the samples do not select nodes.
    pub fn new(
        reduced: &Reduced,
        [first, last]: [f64; 2],
        (sizes, varied): (&[f64], &[usize]),
        samples: &[f64],
    ) -> Option<Self> {
        let length = last - first;
        if reduced.exact || reduced.influence().gaps().len() > 0 || length == 0.0 || varied.is_empty() {
            return None;
        }
        let borders = borders(reduced, first, length);
        let (mut points, mut weights, mut from) = (vec![0.0], vec![0.0], 0.0);
        let rule = legendre::rule(NODES);
        for to in borders.iter().map(|way| way.sqrt()).chain([1.0]) {
            let half = 0.5 * (to - from);
            points.extend(rule.iter().map(|[x, _]| from + half * (1.0 + x)));
            weights.extend(rule.iter().map(|[_, weight]| half * weight));
            from = to;
        }
        points.push(1.0);
        weights.push(0.0);
        let ways: Vec<f64> = points[1..].iter().map(|u| u * u).collect();
        let means = [influences(reduced, first)].into_iter().chain(means(reduced, [first, length], &borders, &ways));
        // g of the constant loads, then that of each varied one of the size 1.
        let effects = means.map(|means| {
            let constant = (0..means.len()).filter(|k| !varied.contains(k)).map(|k| sizes[k] * means[k]).sum::<f64>();
            let all = [constant].into_iter().chain(varied.iter().map(|k| means[*k]));
            all.map(|mean| mean / (2.0 * length)).collect::<Vec<_>>()
        });
        let effects: Vec<Vec<f64>> = effects.collect();
        let (mut functions, mut lowest) = (Vec::new(), vec![0, points.len() - 1]);
        for sample in samples.chunks_exact(varied.len()) {
            let g = |all: &Vec<f64>| all[0] + all[1..].iter().zip(sample).map(|(one, size)| one * size).sum::<f64>();
            let values: Vec<f64> = effects.iter().map(g).collect();
            let least = (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b]))?;
            if lowest.len() < 2 + LOWEST && !lowest.contains(&least) {
                lowest.push(least);
            }
            let mut function: Vec<f64> = values.iter().map(|g| 1.0 / g.sqrt()).collect();
            let mean: f64 = function.iter().zip(&weights).map(|(value, weight)| value * weight).sum();
            function.iter_mut().for_each(|value| *value /= mean);
            if function.iter().all(|value| *value <= SLOWEST) {
                functions.push(function);
            }
        }
        let mut selected = select(functions, &weights)?;
        for node in lowest {
            if selected.iter().all(|(other, ..)| *other != node) {
                selected.push((node, 0.0, [0.0; CHECKS]));
            }
        }
        let nodes = selected
            .iter()
            .map(|(node, weight, [a, b])| Node { weights: [*weight, *a, *b], constant: effects[*node][0] });
        let nodes = nodes.collect();
        let effects = selected.iter().flat_map(|(node, ..)| effects[*node][1..].iter().copied()).collect();
        Some(Self { sizes: varied.len(), nodes, effects })
    }

    /// Times [s] for so many sets of sizes, one set after the other; NaN where the integral gives none. A time does not
    /// depend on the other sets.
    pub fn times(&self, sizes: &[f64], times: &mut [f64]) {
        processor::run(Times { of: self, sizes, times });
    }

    /// Times for sets of sizes side by side.
    #[inline(always)]
    fn side_by_side<A: Arithmetic>(&self, sizes: &[[f64; LANES]]) -> [f64; LANES] {
        let mut sums = [[0.0; LANES]; 1 + CHECKS];
        for (node, effects) in self.nodes.iter().zip(self.effects.chunks_exact(sizes.len())) {
            let mut values = [node.constant; LANES];
            for (size, effect) in sizes.iter().zip(effects) {
                for (value, size) in values.iter_mut().zip(size) {
                    *value = A::multiply_add(*effect, *size, *value);
                }
            }
            // Not a number where g is negative, infinite where it is 0.
            let values = values.map(|g| 1.0 / g.sqrt());
            for (sum, weight) in sums.iter_mut().zip(node.weights) {
                for (sum, value) in sum.iter_mut().zip(values) {
                    *sum = A::multiply_add(weight, value, *sum);
                }
            }
        }
        let [times, a, b] = sums;
        std::array::from_fn(|lane| {
            let (time, error) = (times[lane], a[lane].abs().max(b[lane].abs()));
            let is_found = time > 0.0 && time < f64::INFINITY && error <= ACCURACY * time;
            if is_found { time } else { f64::NAN }
        })
    }
}

/// Times for sets of sizes.
struct Times<'a> {
    of: &'a TravelTime,
    sizes: &'a [f64],
    times: &'a mut [f64],
}

impl Task for Times<'_> {
    type Result = ();

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        let Self { of, sizes, times } = self;
        let mut lanes = vec![[0.0; LANES]; of.sizes];
        for (times, sizes) in times.chunks_mut(LANES).zip(sizes.chunks(LANES * of.sizes)) {
            for (lane, sizes) in sizes.chunks_exact(of.sizes).enumerate() {
                lanes.iter_mut().zip(sizes).for_each(|(lanes, size)| lanes[lane] = *size);
            }
            times.copy_from_slice(&of.side_by_side::<A>(&lanes)[..times.len()]);
        }
    }
}

/// Influences at sigma, of which springs are part.
fn influences(reduced: &Reduced, sigma: f64) -> Vec<f64> {
    let (table, (sigma, _)) = (reduced.influence(), reduced.unwound(sigma));
    let at = table.position(sigma);
    (0..table.components()).map(|k| table.value(at, k)).collect()
}

/// Borders of panels between `first` and `first` + `length`, as parts of the way, ascending.
fn borders(reduced: &Reduced, first: f64, length: f64) -> Vec<f64> {
    let (table, period) = (reduced.influence(), reduced.period().unwrap_or(0.0));
    let all = (1..table.panels()).map(|panel| table.borders(panel).0).chain([reduced.curve().range.0]);
    let all = all.flat_map(|border| [-period, 0.0, period].map(|turn| (border + turn - first) / length));
    let mut borders: Vec<f64> = all.filter(|way| 0.0 < *way && *way < 1.0).collect();
    borders.sort_unstable_by(f64::total_cmp);
    borders.dedup();
    borders
}

/// Means of the influences from `first` over these parts of the way of `length`, ascending, by a rule of Gauss on each
/// piece of a panel between two of them, which is exact.
fn means(reduced: &Reduced, [first, length]: [f64; 2], borders: &[f64], ways: &[f64]) -> Vec<Vec<f64>> {
    let rule = legendre::rule(NODES / 2);
    let mut borders = borders.iter().copied().peekable();
    let (mut from, mut sums, mut all) = (0.0, vec![0.0; reduced.influence().components()], Vec::new());
    for way in ways {
        while from < *way {
            let to = borders.next_if(|border| border <= way).unwrap_or(*way);
            let half = 0.5 * (to - from);
            for [x, weight] in &rule {
                let values = influences(reduced, first + length * (from + half * (1.0 + x)));
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += half * weight * value);
            }
            from = to;
        }
        all.push(sums.iter().map(|sum| sum / way).collect());
    }
    all
}
