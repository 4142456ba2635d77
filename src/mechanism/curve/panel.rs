//! One panel of the curve: closed positions as polynomials in the distance of a plane from the panel's base.
//!
//! In: a closed position with its tangent, a width. Out: a panel, or the reason why the width is rejected. It must not
//! know how far the curve is followed.
use super::base::Base;
use super::bridge::Bridge;
use crate::mechanism::closure::Closure;
use crate::mechanism::linkage::Positions;
use crate::numerics::chebyshev::{NODES, Series, Transform, composed, polynomial, slopes_of};
use samples::{largest, least};

pub(super) use samples::Scratch;

/// A part of the curve that crosses every plane normal . (q - base) = u, 0 <= u <= width, once. Polynomials are in
/// x = 2 u / width - 1, as monomial coefficients.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Panel {
    /// sigma at the base.
    pub start: f64,
    /// Coordinates at the base.
    pub base: Vec<f64>,
    /// Normal of the planes.
    pub normal: Vec<f64>,
    /// Last u.
    pub width: f64,
    /// Polynomial of each coordinate.
    pub coordinates: Vec<Series>,
    /// sigma - start = half + x length(x), and its value at the tip.
    half: f64,
    length: Series,
    span: f64,
    /// Polynomial of d sigma / d x, and its values at both ends.
    speed: Series,
    end_speeds: [f64; 2],
    /// Coordinates at the tip.
    pub tip: Vec<f64>,
    /// Least amplification of rounding in a gap at the nodes.
    pub amplification: f64,
    /// Amplification of rounding in a gap at each node.
    pub amplifications: [f64; NODES],
    /// Polynomials of each coordinate's first and second derivative along sigma, through the values that the loop
    /// equations give at the nodes. Present where the amplification is uneven: close to a crossing these are far more
    /// accurate than the loop equations or derivatives of `coordinates`.
    pub derivatives: Vec<[Series; 2]>,
    /// Tail of the series of each coordinate's second derivative along sigma, and the derivative's largest value.
    pub curvatures: Vec<[f64; 2]>,
    /// Whether the panel is a part of a bridge over a crossing: its series are more accurate than the loop equations.
    pub bridged: bool,
    /// x at which branches cross; sought on a bridge only.
    pub crossing: Option<f64>,
}

/// Reason why a panel was rejected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rejection {
    /// The series does not resolve the panel, or Newton's method diverges. A panel shorter by this factor may do.
    TooWide(f64),
    /// A node is too close to a crossing of branches. A slightly different width may do.
    NearCrossing,
    /// The kinetic energy vanishes at a node.
    Massless,
}

/// Largest amplification relative to the least of the panel. Amplification grows with the number of loops, so only the
/// ratio indicates a crossing.
const NEAR: f64 = 4.0;
/// Relative amplification at a node above which derivatives are kept.
const UNEVEN: f64 = 2.0;
/// Amplification of rounding in the derivatives of a bridge's polynomials.
const BRIDGED: f64 = 20.0;
/// Amplification below which no position is too close to a crossing.
const HARMLESS: f64 = 30.0;
/// Factor of width after Newton's method has diverged.
const DIVERGED: f64 = 0.7;

/// Whether the amplification says that a crossing is near, where the least one is known.
pub(super) fn near_crossing(amplification: f64, least: f64) -> bool {
    amplification > HARMLESS.max(NEAR * least)
}

impl Panel {
    /// Last sigma.
    pub fn end(&self) -> f64 {
        self.start + self.span
    }

    /// Build the panel of this width that starts at `base`. `visit` receives the index and positions of every node.
    /// Returns the panel, the unit tangent at its tip, and the factor by which it might have been wider.
    ///
    /// # Errors
    /// A [`Rejection`].
    pub fn build(
        closure: &Closure,
        transform: &Transform,
        base: &Base,
        width: f64,
        scratch: &mut Scratch,
        visit: &mut dyn FnMut(usize, &Positions),
    ) -> Result<(Self, Vec<f64>, f64), Rejection> {
        let normal = closure.normal(&base.tangent);
        scratch.sample(closure, &transform.nodes, base, &normal, width, visit)?;
        let samples = &scratch.samples;
        let amplifications = samples.amplifications;
        let (amplification, least) = (largest(&amplifications).max(1.0), least(&amplifications));
        let far = closure.rounding_at(&base.q);
        let (coordinates, speed, wider) =
            samples.resolve(transform, &closure.weights, width, [amplification, least, far])?;
        let mut tip: Vec<f64> = coordinates.iter().map(|s| polynomial(s, 1.0)).collect();
        let loops = &mut scratch.evaluation.loops;
        let converged =
            closure.on_plane(loops, &mut tip, &base.q, &normal, width).ok_or(Rejection::TooWide(DIVERGED))?;
        if near_crossing(converged.amplification, least) {
            return Err(Rejection::NearCrossing);
        }
        let mut tangent = Vec::new();
        loops.factors.tangent(&normal, 1.0, &mut tangent);
        closure.normalise(&mut tangent);
        let panel = scratch.panel(transform, base, normal, width, (coordinates, speed), amplification > UNEVEN * least);
        Ok((Self { tip, amplification: least, ..panel }, tangent, wider))
    }

    /// Build the panel of this width that starts at `base` on a bridge, at the bridge's distance `from`. `visit` and
    /// the result as for [`Self::build`].
    ///
    /// # Errors
    /// A [`Rejection`].
    pub fn on_bridge(
        closure: &Closure,
        transform: &Transform,
        bridge: &Bridge,
        base: &Base,
        (from, width): (f64, f64),
        scratch: &mut Scratch,
        visit: &mut dyn FnMut(usize, &Positions),
    ) -> Result<(Self, Vec<f64>, f64), Rejection> {
        scratch.sample_bridge(closure, &transform.nodes, bridge, (from, width), visit)?;
        let rounding = [BRIDGED, BRIDGED, closure.rounding_at(&base.q)];
        let (coordinates, speed, wider) = scratch.samples.resolve(transform, &closure.weights, width, rounding)?;
        let panel = scratch.panel(transform, base, bridge.normal.clone(), width, (coordinates, speed), true);
        let [_, mut tangent, _] = bridge.at(from + width);
        closure.normalise(&mut tangent);
        let crossing = Some(2.0 * (bridge.crossing - from) / width - 1.0).filter(|x| -1.0 <= *x && *x < 1.0);
        Ok((Self { bridged: true, crossing, ..panel }, tangent, wider))
    }

    /// The panel with its length, the integral of its speed.
    fn integrated(mut self) -> Self {
        self.length = std::array::from_fn(|k| self.speed[k] / (k + 1) as f64);
        self.half = polynomial(&self.length, -1.0);
        self.span = self.half + polynomial(&self.length, 1.0);
        self.end_speeds = [-1.0, 1.0].map(|x| polynomial(&self.speed, x));
        self
    }

    /// The part of this panel between two x, as a panel of its own.
    pub fn part(self, first: f64, last: f64) -> Self {
        let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
        let cut = |series: &Series| composed(series, middle, half);
        let coordinates: Vec<Series> = self.coordinates.iter().map(cut).collect();
        let [base, tip] = [-1.0, 1.0].map(|x| coordinates.iter().map(|s| polynomial(s, x)).collect());
        Self {
            start: self.sigma_at(first),
            base,
            tip,
            width: half * self.width,
            coordinates,
            speed: cut(&self.speed).map(|c| half * c),
            derivatives: self.derivatives.iter().map(|[f, s]| [cut(f), cut(s)]).collect(),
            crossing: self.crossing.map(|x| (x - middle) / half).filter(|x| x.abs() <= 1.0),
            ..self
        }
        .integrated()
    }

    /// The same part of the curve in the opposite direction, x -> -x, with its base, the present tip, at the sigma
    /// `start`.
    pub fn mirrored(mut self, start: f64) -> Self {
        let odd = |series: &mut [f64]| series.iter_mut().skip(1).step_by(2).for_each(|c| *c = -*c);
        std::mem::swap(&mut self.base, &mut self.tip);
        self.start = start;
        self.normal.iter_mut().for_each(|n| *n = -*n);
        self.amplifications.reverse();
        self.crossing = self.crossing.map(|x| -x);
        self.coordinates.iter_mut().for_each(|series| odd(series));
        for [first, second] in &mut self.derivatives {
            odd(first);
            odd(second);
            // First derivatives along sigma change sign.
            first.iter_mut().for_each(|c| *c = -*c);
        }
        odd(&mut self.speed);
        self.integrated()
    }

    /// Add `growth` to the coordinates: the same part of the curve after whole revolutions.
    pub fn shift(&mut self, growth: &[f64]) {
        for (i, growth) in growth.iter().enumerate() {
            self.base[i] += growth;
            self.tip[i] += growth;
            self.coordinates[i][0] += growth;
        }
    }

    /// Coordinates at x in [-1, 1], by the polynomials.
    pub fn coordinates_at(&self, x: f64) -> Vec<f64> {
        let mut q = Vec::new();
        self.coordinates_into(x, &mut q);
        q
    }

    /// [`Self::coordinates_at`], in place.
    pub fn coordinates_into(&self, x: f64, q: &mut Vec<f64>) {
        q.clear();
        q.extend(self.coordinates.iter().map(|s| polynomial(s, x)));
    }

    /// First and second derivatives of the coordinates with respect to x.
    pub fn derivatives_at(&self, x: f64) -> (Vec<f64>, Vec<f64>) {
        let slopes = self.coordinates.iter().map(slopes_of);
        slopes.map(|s| (polynomial(&s, x), polynomial(&slopes_of(&s), x))).unzip()
    }

    /// sigma at x.
    pub fn sigma_at(&self, x: f64) -> f64 {
        self.start + self.half + x * polynomial(&self.length, x)
    }

    /// x at sigma, by Newton's method on a monotonic polynomial.
    pub fn x_at(&self, sigma: f64) -> f64 {
        let start = self.start;
        // Initial guess: the cubic with the right slopes at both ends.
        let s = (sigma - start) / self.span;
        let [m0, m1] = self.end_speeds.map(|speed| self.span / speed);
        let mut x = -1.0 + s * (m0 + s * ((6.0 - 2.0 * m0 - m1) + s * (m0 + m1 - 4.0)));
        x = if x.is_finite() { x.clamp(-1.0, 1.0) } else { 0.0 };
        for _ in 0..20 {
            let length = self.half + x * polynomial(&self.length, x);
            let step = (sigma - start - length) / polynomial(&self.speed, x);
            x = (x + step).clamp(-1.0, 1.0);
            // Quadratic convergence: the next correction is of the size of the square of this one.
            if step.abs() < 1e-9 {
                break;
            }
        }
        x
    }
}

mod fields;
mod samples;
