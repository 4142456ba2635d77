//! The time from a start at rest to a stop, as a function of the sizes of loads, by the energy integral.
//!
//! The time is the integral over u of 1 / sqrt(g(u)), with g as `path_effects.rs` has it. Times for some sets of sizes
//! select the few nodes that decide all such times; for other sizes only a sum at each of these is new.
//!
//! In: effects of loads along a path, sizes. Out: times, or NaN where the integral does not give it: the mechanism
//! stays, turns back, or moves unlike those by which the nodes were selected. It must not know steps.
use super::path_effects::PathEffects;
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
    /// From the first sigma of a path, at rest, to its last one, as [`PathEffects::new`]. `samples`: some sets of the
    /// sizes that differ. None where there are no effects, or the times for the samples do not select nodes.
    pub fn new(
        reduced: &Reduced,
        path: [f64; 2],
        (sizes, varied): (&[f64], &[usize]),
        samples: &[f64],
    ) -> Option<Self> {
        let rule = legendre::rule(NODES);
        let PathEffects { panels, effects } = PathEffects::new(reduced, path, (sizes, varied), &rule)?;
        let of_panels =
            panels.iter().flat_map(|[from, to]| rule.iter().map(move |[_, weight]| 0.5 * (to - from) * weight));
        let weights: Vec<f64> = [0.0].into_iter().chain(of_panels).chain([0.0]).collect();
        let (mut functions, mut lowest) = (Vec::new(), vec![0, weights.len() - 1]);
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
