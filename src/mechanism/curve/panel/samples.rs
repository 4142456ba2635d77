//! Sampling: closed positions at the nodes of a panel, and the polynomials through them.
//!
//! In: a panel's base and width, or a bridge. Out: the sampled panel, or the reason why its width is rejected. It must
//! not know how the curve is divided into panels.
use super::{Base, DIVERGED, HARMLESS, Panel, Rejection, near_crossing};
use crate::mechanism::closure::Closure;
use crate::mechanism::curve::bridge::Bridge;
use crate::mechanism::curve::configuration::{self, Configuration};
use crate::mechanism::curve::extrapolation::Extrapolation;
use crate::mechanism::linkage::Positions;
use crate::numerics::chebyshev::{NODES, Series, Transform, chopped, monomials, polynomial, tail};

/// Relative amplification at a node above which the series are chopped to the level of rounding.
const CROSSING: f64 = 5.0;
/// Allowed ratio of rounding to its estimate, away from crossings.
const NOISE: f64 = 10.0;
/// Rounding of coordinates before amplification, relative to their size and to 1 rad.
const ROUNDING: f64 = 1e-15;
/// Order of the coefficients that must be of the size of rounding.
const ORDER: f64 = (NODES - 2) as f64;

/// Scratch for one panel after another.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Scratch for configurations.
    pub evaluation: configuration::Scratch,
    c: Configuration,
    pub(super) samples: Samples,
    extrapolation: Extrapolation,
}

/// Values at the nodes of a panel.
#[derive(Debug, Default)]
pub(super) struct Samples {
    /// Coordinates and their first and second derivatives along sigma.
    coordinates: Vec<[f64; NODES]>,
    firsts: Vec<[f64; NODES]>,
    seconds: Vec<[f64; NODES]>,
    /// d sigma / d u.
    speeds: [f64; NODES],
    pub(super) amplifications: [f64; NODES],
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a: f64, v| a.max(v.abs()))
}

pub(super) fn least(values: &[f64]) -> f64 {
    values.iter().fold(f64::INFINITY, |a: f64, v| a.min(*v))
}

impl Scratch {
    /// Sample a panel: close the loops at every node. `visit` receives the index of each node and its positions.
    pub(super) fn sample(
        &mut self,
        closure: &Closure,
        nodes: &[f64; NODES],
        base: &Base,
        normal: &[f64],
        width: f64,
        visit: &mut dyn FnMut(usize, &Positions),
    ) -> Result<(), Rejection> {
        let (n, w) = (base.q.len(), &closure.weights);
        let Self { evaluation, c, samples, extrapolation } = self;
        samples.clear(n);
        let (mut last, mut least, mut largest) = (0.0, f64::INFINITY, 1.0_f64);
        extrapolation.start(&base.q, &base.tangent);
        for (j, x) in nodes.iter().enumerate() {
            let u = 0.5 * width * (1.0 + x);
            extrapolation.extrapolate(u, &mut c.q);
            let converged = closure
                .on_plane(&mut evaluation.loops, &mut c.q, &base.q, normal, u)
                .filter(|l| l.first <= 0.2 * (u - last) + 1e-12)
                .ok_or(Rejection::TooWide(DIVERGED))?;
            samples.amplifications[j] = converged.amplification;
            (least, largest) = (least.min(converged.amplification), largest.max(converged.amplification));
            if near_crossing(largest, least) {
                return Err(Rejection::NearCrossing);
            }
            std::mem::swap(&mut c.positions, &mut evaluation.loops.positions);
            visit(j, &c.positions);
            let speed = c.derive(closure, normal, evaluation);
            if speed == 0.0 || speed.is_nan() {
                return Err(Rejection::Massless);
            }
            let steepness = (0..n).map(|i| (c.q_sigma[i] * w[i]).powi(2)).sum::<f64>().sqrt() * speed;
            if steepness > 1.5 || steepness.is_nan() {
                return Err(Rejection::TooWide(DIVERGED));
            }
            extrapolation.add(u, &c.q, &c.q_sigma, speed);
            samples.keep(j, c, speed);
            last = u;
        }
        Ok(())
    }
}

impl Scratch {
    /// Sample a panel on a bridge.
    pub(super) fn sample_bridge(
        &mut self,
        closure: &Closure,
        nodes: &[f64; NODES],
        bridge: &Bridge,
        (from, width): (f64, f64),
        visit: &mut dyn FnMut(usize, &Positions),
    ) -> Result<(), Rejection> {
        let Self { c, samples, .. } = self;
        let linkage = &*closure.linkage;
        samples.clear(closure.weights.len());
        for (j, x) in nodes.iter().enumerate() {
            [c.q, c.q_sigma, c.q_second] = bridge.at(from + 0.5 * width * (1.0 + x));
            linkage.update_positions(&c.q, &mut c.positions);
            visit(j, &c.positions);
            let speed = c.scale_rates(linkage);
            if speed == 0.0 || speed.is_nan() {
                return Err(Rejection::Massless);
            }
            c.q_second.iter_mut().for_each(|v| *v /= speed * speed);
            c.project_curvature(linkage);
            samples.keep(j, c, speed);
        }
        Ok(())
    }
}

impl Scratch {
    /// The sampled panel with these polynomials of the coordinates and of d sigma / d x. `derivatives`: whether it
    /// keeps polynomials of derivatives too.
    pub(super) fn panel(
        &self,
        transform: &Transform,
        base: &Base,
        normal: Vec<f64>,
        width: f64,
        (coordinates, speed): (Vec<Series>, Series),
        derivatives: bool,
    ) -> Panel {
        let samples = &self.samples;
        let fit = |samples: &[f64; NODES]| monomials(&chopped(&transform.fit(samples)));
        let pairs = samples.firsts.iter().zip(&samples.seconds).filter(|_| derivatives);
        let derivatives = pairs.map(|(first, second)| [fit(first), fit(second)]).collect();
        let curvatures = samples.seconds.iter().map(|s| [tail(&transform.fit(s)), largest(s)]).collect();
        Panel {
            start: base.sigma,
            base: base.q.clone(),
            normal,
            width,
            tip: coordinates.iter().map(|s| polynomial(s, 1.0)).collect(),
            coordinates,
            half: 0.0,
            length: [0.0; NODES],
            span: 0.0,
            speed,
            end_speeds: [0.0; 2],
            amplification: 1.0,
            amplifications: samples.amplifications,
            derivatives,
            curvatures,
            bridged: false,
            crossing: None,
        }
        .integrated()
    }
}

impl Samples {
    /// Make room for this number of coordinates.
    fn clear(&mut self, n: usize) {
        for values in [&mut self.coordinates, &mut self.firsts, &mut self.seconds] {
            values.clear();
            values.resize(n, [0.0; NODES]);
        }
        self.amplifications = [1.0; NODES];
    }

    /// Keep the values at the node j.
    fn keep(&mut self, j: usize, c: &Configuration, speed: f64) {
        self.speeds[j] = speed;
        for i in 0..c.q.len() {
            (self.coordinates[i][j], self.firsts[i][j]) = (c.q[i], c.q_sigma[i]);
            self.seconds[i][j] = c.q_second[i];
        }
    }

    /// Polynomials of the coordinates and of d sigma / d x, and the factor by which the panel might have been wider.
    /// `far`: rounding of positions relative to that near the origin.
    pub(super) fn resolve(
        &self,
        transform: &Transform,
        weights: &[f64],
        width: f64,
        [amplification, least_amplification, far]: [f64; 3],
    ) -> Result<(Vec<Series>, Series, f64), Rejection> {
        let rounding = ROUNDING * amplification.max(2.0) * far;
        let noise = if amplification > HARMLESS { 1.0 } else { NOISE };
        let mut wider = f64::INFINITY;
        let mut coordinates: Vec<Series> = self.coordinates.iter().map(|samples| transform.fit(samples)).collect();
        for (series, w) in coordinates.iter().zip(weights) {
            let size = (1.0 + series[0].abs() * w) / w;
            wider = wider.min(resolved(series, rounding * size, noise)?);
        }
        let fastest = largest(&self.speeds);
        if least(&self.speeds) < 1e-7 * fastest {
            return Err(Rejection::Massless);
        }
        let mut speed = transform.fit(&self.speeds.map(|s| 0.5 * width * s));
        // Differentiation amplifies the rounding of a series by about its number of terms.
        let mut slope = 20.0;
        if amplification > HARMLESS {
            // Rounding of a position turns the tangent by the curvature, which is large where branches almost meet.
            let seconds = self.seconds.iter().zip(weights);
            let curvature = seconds.flat_map(|(s, w)| s.map(|v| (v * w).abs())).fold(0.0, f64::max);
            slope += curvature * fastest * fastest;
        }
        wider = wider.min(resolved(&speed, slope * rounding * 0.5 * width * fastest, noise)?);
        if amplification > HARMLESS.max(CROSSING * least_amplification) {
            coordinates.iter_mut().chain([&mut speed]).for_each(|s| *s = chopped(s));
        }
        coordinates.iter_mut().chain([&mut speed]).for_each(|s| *s = monomials(s));
        Ok((coordinates, speed, wider))
    }
}

/// Factor by which a panel with this series might be wider, if the coefficient of order [`ORDER`] may be as large as
/// `rounding`, or `noise` times that where the coefficients no longer decay. Rejected if the factor would be below 1.
///
/// Coefficients decay like rho^-k, where rho, while it is large, is inversely proportional to the width.
fn resolved(series: &Series, mut rounding: f64, noise: f64) -> Result<f64, Rejection> {
    let tail = tail(series);
    if tail > rounding || tail.is_nan() {
        let middle = largest(&series[NODES / 2..]);
        if tail > noise * rounding || tail.is_nan() || middle > 2.0 * tail {
            let shorter = (rounding / tail).powf(1.0 / ORDER);
            let factor = if shorter.is_finite() { (0.93 * shorter).clamp(0.3, 0.93) } else { DIVERGED };
            return Err(Rejection::TooWide(factor));
        }
        // Rounding: a shorter panel would have the same tail.
        rounding = middle;
    }
    let last = series.iter().rposition(|c| c.abs() > rounding).unwrap_or(0);
    let largest = largest(&series[1..]);
    if last < 2 || largest <= rounding {
        return Ok(f64::INFINITY);
    }
    // Fractional order at which the coefficients fall below rounding, one more than that of the last large one at most.
    let decay = (largest / rounding).ln();
    let order = last as f64 + ((series[last].abs() / rounding).ln() * last as f64 / decay).min(1.0);
    Ok((decay / order - decay / (ORDER - 1.0)).exp())
}
