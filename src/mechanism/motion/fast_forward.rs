//! States of many runs from one start at rest, at a time or at the stop before it, by the energy integral.
//!
//! The time to u is the integral of f = 1 / sqrt(g), with g as `path_effects.rs` has it. The nodes are those of the
//! path, the same for all runs, so a node costs a run one product for each load, a root and a quotient. On the panel
//! where a run is at the time asked for, the polynomial through f at the nodes is integrated and inverted. The last two
//! Legendre coefficients of f estimate its error: with a part e of f left out, the interpolant has the error e, and
//! Gauss's rule about e^2.
//!
//! In: effects of loads along the paths on both sides of the start, sizes of loads. Out: states, or none where a run
//! stays, turns back, or is almost at rest somewhere. It must not know steps.
use super::path_effects::PathEffects;
use crate::integrator::SHORTEST;
use crate::mechanism::reduced::Reduced;
use crate::numerics::chebyshev::NODES;
use crate::numerics::legendre;
use crate::numerics::processor::{self, Arithmetic, Task};

/// Largest relative error of a time or a speed, also under a larger tolerance of the integration.
const ACCURACY: f64 = 1e-11;
/// Part of the root of the accuracy that f may leave out on a panel that is passed.
const PASSED: f64 = 0.1;
/// Part of a time by which a stop must come before it or not at all: nearer to it, rounding would decide.
const MARGIN: f64 = 1e-9;
/// Most steps of Newton's method; from a straight line some four.
const ITERATIONS: usize = 12;
/// Runs side by side.
const LANES: usize = 8;

/// A state on the way of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// Time since the start [s].
    pub time: f64,
    /// sigma, counted on over the whole revolutions of the start.
    pub sigma: f64,
    /// Its rate; at a stop that before the impact.
    pub sigma_dot: f64,
    /// Whether a stop is there.
    pub is_stop: bool,
}

impl Waypoint {
    /// Whether a run of `h` [s] comes by: beyond a stop, or just to a state where there is none.
    pub fn is_within(&self, h: f64) -> bool {
        if self.is_stop { self.time < h } else { self.time == h }
    }
}

/// The path on one side of the start.
#[derive(Clone, Debug)]
struct Path {
    first: f64,
    last: f64,
    /// Whether a rigid stop ends it.
    has_stop: bool,
    panels: Vec<[f64; 2]>,
    /// [`PathEffects::effects`], one after the other.
    effects: Vec<f64>,
}

/// States of runs as functions of the sizes of some loads; the others are constant.
#[derive(Clone, Debug)]
pub struct FastForward {
    /// Number of loads whose sizes differ.
    sizes: usize,
    paths: Vec<Path>,
    accuracy: f64,
    /// At each node: weights of f in its mean and in its last two Legendre coefficients.
    weights: [[f64; 3]; NODES],
    /// At each node: its weights in all Legendre coefficients of f.
    coefficients: [[f64; NODES]; NODES],
}

impl FastForward {
    /// From sigma = `first`, at rest. `ends`: the last sigma of the path on each side, and whether a rigid stop is
    /// there. `sizes`: of all components of the influences; `varied`: those that differ. None without a path.
    pub fn new(
        reduced: &Reduced,
        first: f64,
        ends: [Option<(f64, bool)>; 2],
        (sizes, varied): (&[f64], &[usize]),
        tolerance: f64,
    ) -> Option<Self> {
        let rule = legendre::rule(NODES);
        let path = |(last, has_stop): (f64, bool)| {
            let PathEffects { panels, effects } = PathEffects::new(reduced, [first, last], (sizes, varied), &rule)?;
            Some(Path { first, last, has_stop, panels, effects: effects.concat() })
        };
        let paths: Vec<Path> = ends.into_iter().flatten().filter_map(path).collect();
        let (mut weights, mut coefficients) = ([[0.0; 3]; NODES], [[0.0; NODES]; NODES]);
        for ((own, row), [x, weight]) in weights.iter_mut().zip(&mut coefficients).zip(rule) {
            let values = legendre::polynomials(x, NODES);
            *row = std::array::from_fn(|k| (k as f64 + 0.5) * weight * values[k]);
            *own = [row[0], row[NODES - 2], row[NODES - 1]];
        }
        let accuracy = ACCURACY.min(tolerance);
        (!paths.is_empty()).then_some(Self { sizes: varied.len(), paths, accuracy, weights, coefficients })
    }

    /// Where each run is at the time `until` [s], or at the stop that it meets before. `sizes`: of the loads that
    /// differ, run by run. None where the integral does not give it. A state does not depend on the other runs.
    pub fn states(&self, sizes: &[f64], until: f64, states: &mut [Option<Waypoint>]) {
        processor::run(States { of: self, sizes, until, states });
    }

    /// States on one path of runs side by side.
    #[inline(always)]
    fn on_path<A: Arithmetic>(
        &self,
        path: &Path,
        sizes: &[[f64; LANES]],
        until: f64,
        states: &mut [Option<Waypoint>; LANES],
    ) {
        let width = 1 + self.sizes;
        let (start, effects) = path.effects.split_at(width);
        let mut is_under_way = effect::<A>(start, sizes).map(|g| g > 0.0);
        let mut times = [0.0; LANES];
        let mut nodes = effects.chunks_exact(NODES * width);
        for &[from, to] in &path.panels {
            let (Some(nodes), true) = (nodes.next(), is_under_way.contains(&true)) else { return };
            let (mut values, mut sums) = ([[0.0; LANES]; NODES], [[0.0; LANES]; 3]);
            for ((value, effects), weights) in values.iter_mut().zip(nodes.chunks_exact(width)).zip(self.weights) {
                // Not a number where g is negative, infinite where it is 0.
                *value = effect::<A>(effects, sizes).map(|g| 1.0 / g.sqrt());
                for (sum, weight) in sums.iter_mut().zip(weights) {
                    for (sum, value) in sum.iter_mut().zip(value.iter()) {
                        *sum = A::multiply_add(weight, *value, *sum);
                    }
                }
            }
            let [means, a, b] = sums;
            for lane in 0..LANES {
                if !is_under_way[lane] {
                    continue;
                }
                let (mean, left_out) = (means[lane], a[lane].abs().max(b[lane].abs()));
                let time = times[lane] + (to - from) * mean;
                let is_passed = time < until && left_out <= PASSED * self.accuracy.sqrt() * mean;
                if time >= until && left_out <= self.accuracy * mean {
                    let part = (until - times[lane]) / (time - times[lane]);
                    let found = self.inverse(&values.map(|value| value[lane]), part);
                    states[lane] = found.and_then(|(x, f)| {
                        let u = from + 0.5 * (to - from) * (1.0 + x);
                        path.at(u, f, until)
                    });
                }
                (times[lane], is_under_way[lane]) = (time, is_passed);
            }
        }
        let speeds = effect::<A>(&effects[effects.len() - width..], sizes).map(f64::sqrt);
        for lane in (0..LANES).filter(|lane| is_under_way[*lane] && path.has_stop) {
            let at_stop = path.at(1.0, 1.0 / speeds[lane], times[lane]);
            states[lane] = at_stop.filter(|state| state.time < until * (1.0 - MARGIN));
        }
    }

    /// x in [-1, 1] up to which the integral of the polynomial through these values has this part of the whole, and the
    /// value there.
    #[inline(always)]
    fn inverse(&self, values: &[f64; NODES], part: f64) -> Option<(f64, f64)> {
        let mut c = [0.0; NODES];
        for (row, value) in self.coefficients.iter().zip(values) {
            c.iter_mut().zip(row).for_each(|(c, weight)| *c += weight * value);
        }
        let whole = 2.0 * c[0] * part;
        let mut x = 2.0 * part - 1.0;
        for _ in 0..ITERATIONS {
            // The integral of P_k from -1 on is (P_(k+1) - P_(k-1)) / (2 k + 1).
            let (mut value, mut integral) = (c[0], c[0] * (1.0 + x));
            let (mut before, mut legendre) = (1.0, x);
            for (k, c) in (1..).zip(&c[1..]) {
                let next = ((2.0 * f64::from(k) + 1.0) * x * legendre - f64::from(k) * before) / (f64::from(k) + 1.0);
                value += c * legendre;
                integral += c * (next - before) / (2.0 * f64::from(k) + 1.0);
                (before, legendre) = (legendre, next);
            }
            let correction = (whole - integral) / value;
            x = (x + correction).clamp(-1.0, 1.0);
            if correction.abs() <= 4.0 * f64::EPSILON {
                return Some((x, value));
            }
        }
        None
    }
}

impl Path {
    /// The state at u, where f has this value, if its numbers are in range.
    #[inline(always)]
    fn at(&self, u: f64, f: f64, time: f64) -> Option<Waypoint> {
        let (length, is_stop) = (self.last - self.first, u == 1.0);
        let sigma = if is_stop { self.last } else { self.first + length * u * u };
        let sigma_dot = 2.0 * length * u / f;
        let is_found = time > SHORTEST && sigma_dot.is_finite() && sigma_dot != 0.0;
        is_found.then_some(Waypoint { time, sigma, sigma_dot, is_stop: is_stop && self.has_stop })
    }
}

/// g of runs side by side.
#[inline(always)]
fn effect<A: Arithmetic>(effects: &[f64], sizes: &[[f64; LANES]]) -> [f64; LANES] {
    let mut sum = [effects[0]; LANES];
    for (size, effect) in sizes.iter().zip(&effects[1..]) {
        for (sum, size) in sum.iter_mut().zip(size) {
            *sum = A::multiply_add(*effect, *size, *sum);
        }
    }
    sum
}

/// States of runs with these sizes.
struct States<'a> {
    of: &'a FastForward,
    sizes: &'a [f64],
    until: f64,
    states: &'a mut [Option<Waypoint>],
}

impl Task for States<'_> {
    type Result = ();

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        let Self { of, sizes, until, states } = self;
        let mut lanes = vec![[0.0; LANES]; of.sizes];
        for (states, sizes) in states.chunks_mut(LANES).zip(sizes.chunks(LANES * of.sizes)) {
            for (lane, sizes) in sizes.chunks_exact(of.sizes).enumerate() {
                lanes.iter_mut().zip(sizes).for_each(|(lanes, size)| lanes[lane] = *size);
            }
            let mut found = [None; LANES];
            for path in &of.paths {
                of.on_path::<A>(path, &lanes, until, &mut found);
            }
            states.copy_from_slice(&found[..states.len()]);
        }
    }
}
