//! A bridge: the curve across a position where branches cross, however many loops are singular there.
//!
//! In: a closed position short of a crossing. Out: the distance of the crossing, and the coordinates as polynomials on
//! both sides of it. It must not know how the curve is divided into panels.
//!
//! The curve is analytic through the crossing, but the loop equations amplify rounding by the inverse of a power of the
//! distance from it. The bridge's polynomials therefore go through closed positions on both sides that keep away from
//! the crossing and are found in twice the precision; between them they are the analytic continuation.
use super::base::Base;
use super::configuration;
use super::course::Course;
use super::extrapolation::Extrapolation;
use crate::mechanism::closure::Closure;
use crate::numerics::chebyshev::{Series, polynomial, slopes_of};
use crate::numerics::gapped::{GAP, Gapped};
use crate::numerics::twofold::Twofold;

/// Largest of the last coefficients of a series, relative to its size and to 1 rad: branches that miss each other by
/// 1e-13 of the size of the linkage count as crossing.
const LARGEST_TAIL: f64 = 1.5e-12;
/// Part of the half width on both sides of the crossing that is taken from the polynomials.
const INNER: f64 = 0.4;
/// Largest gap of a loop on the bridge, relative to the size of the linkage.
const OPEN: f64 = 1.5e-12;

/// Walk along the curve across planes with one normal, from a base.
struct Walk<'a> {
    closure: &'a Closure,
    base: &'a Base,
    normal: Vec<f64>,
    /// Present distance across the planes, coordinates, and their derivatives with respect to the distance.
    u: f64,
    q: Vec<f64>,
    slope: Vec<f64>,
    /// Logarithm of the determinant of the loop equations and the plane's.
    determinant: f64,
    /// Amplification of rounding in a gap.
    amplification: f64,
}

impl<'a> Walk<'a> {
    fn new(closure: &'a Closure, base: &'a Base, scratch: &mut configuration::Scratch) -> Option<Self> {
        let normal = closure.normal(&base.tangent);
        let (q, slope) = (base.q.clone(), base.tangent.clone());
        let mut walk = Self { closure, base, u: 0.0, q, slope, determinant: 0.0, amplification: 1.0, normal };
        walk.close(scratch, 0.0, f64::INFINITY)?;
        Some(walk)
    }

    /// Close the loops at the distance u by at most this first correction. None if that fails: nothing has changed.
    fn close(&mut self, scratch: &mut configuration::Scratch, u: f64, most: f64) -> Option<()> {
        let mut q: Vec<f64> = self.q.iter().zip(&self.slope).map(|(q, slope)| q + (u - self.u) * slope).collect();
        let loops = &mut scratch.loops;
        let closed = self.closure.on_plane(loops, &mut q, &self.base.q, &self.normal, u).filter(|c| c.first <= most)?;
        loops.factors.tangent(&self.normal, 1.0, &mut self.slope);
        (self.u, self.q, self.amplification) = (u, q, closed.amplification);
        self.determinant = loops.factors.log_determinant(&self.normal);
        Some(())
    }

    /// Close the loops at the distance u from an extrapolated position.
    fn jump(&mut self, scratch: &mut configuration::Scratch, u: f64, extrapolation: &Extrapolation) -> Option<()> {
        let (from, before) = (self.u, self.q.clone());
        extrapolation.extrapolate(u, &mut self.q);
        self.u = u;
        let closed = self.close(scratch, u, 0.2 * (u - from));
        if closed.is_none() {
            (self.u, self.q) = (from, before);
        }
        closed
    }

    /// The present position less one on the curve, in twice the precision.
    fn refined(&self, scratch: &mut configuration::Scratch, less: &[f64]) -> Option<Vec<f64>> {
        let loops = &mut scratch.loops;
        // The last correction may have moved the position since the loop equations were linearised.
        if !self.closure.linearise(&self.q, loops) {
            return None;
        }
        let q = self.closure.refine(loops, &self.q, &self.normal, self.amplification)?;
        Some(q.iter().zip(less).map(|(q, less)| (*q - Twofold::from(*less)).rounded()).collect())
    }

    /// Go to the distance u, in short steps.
    fn go(&mut self, scratch: &mut configuration::Scratch, u: f64) -> Option<()> {
        const STEP: f64 = 0.05;
        if u == self.u {
            return Some(());
        }
        let steps = ((u - self.u).abs() / STEP).ceil().max(1.0);
        let (from, step) = (self.u, (u - self.u) / steps);
        for k in 1..=steps as usize {
            self.close(scratch, from + k as f64 * step, 0.2 * step.abs())?;
        }
        Some(())
    }
}

/// Distance from `base` across planes normal to its tangent to the next crossing, up to a little beyond `width`.
///
/// Near a crossing at the distance c, where k loops are singular, the determinant of the loop equations falls like
/// (c - u)^k, so that the inverse of the slope of its logarithm is (u - c) / k, which rises linearly to 0.
pub(super) fn crossing_ahead(
    closure: &Closure,
    base: &Base,
    width: f64,
    scratch: &mut configuration::Scratch,
) -> Option<f64> {
    /// Distance between the two positions that give a slope, as a part of the way to the crossing or of a stride.
    const APART: f64 = 0.02;
    /// Largest part of the way to the crossing in one go.
    const PART: f64 = 0.5;
    /// First stride, longest and shortest one.
    const STRIDES: [f64; 3] = [0.02, 0.1, 1e-5];
    let mut walk = Walk::new(closure, base, scratch)?;
    let [mut stride, longest, shortest] = STRIDES;
    let (mut before, mut found): (Option<[f64; 2]>, Option<f64>) = (None, None);
    while walk.u < 1.5 * width && stride > shortest {
        let (u, high, apart) = (walk.u, walk.determinant, APART * stride);
        if walk.go(scratch, u + apart).is_none() {
            stride *= 0.5;
            continue;
        }
        let (at, inverse) = (u + 0.5 * apart, apart / (high - walk.determinant));
        let estimate = before.and_then(|[u, value]| {
            let c = at + inverse * (at - u) / (value - inverse);
            (inverse > 0.0 && value > inverse && c < 2.0 * width).then_some(c)
        });
        if let Some(c) = estimate {
            if c - at < 0.1 * c || found.is_some_and(|f| (f - c).abs() < 0.01 * c) {
                return Some(c);
            }
            stride = (2.0 * stride).min(longest).min(PART * (c - at));
        } else {
            stride = (2.0 * stride).min(longest);
            if before.is_none() && inverse > 0.0 {
                // As if one loop were singular ahead and nothing else changed the determinant.
                stride = stride.min(PART * inverse);
            }
        }
        (before, found) = (Some([at, inverse]), estimate);
        while stride > shortest && walk.go(scratch, at + stride).is_none() {
            stride *= 0.5;
        }
    }
    found
}

/// The curve across a crossing: coordinates at the distances u in [0, width] across planes with one normal.
#[derive(Clone, Debug)]
pub(super) struct Bridge {
    /// Normal of the planes.
    pub normal: Vec<f64>,
    /// Coordinates at u = 0.
    first: Vec<f64>,
    /// Largest u of the polynomials.
    width: f64,
    /// First and last u from which on derivatives are taken from the polynomials: towards their ends these amplify
    /// rounding by the fourth power of their order.
    pub range: [f64; 2],
    /// Polynomials of each coordinate in x = 2 u / width - 1, with the first and second derivative in u.
    series: Vec<[Series; 3]>,
    /// u at the crossing.
    pub crossing: f64,
    /// Largest of the last coefficients of a series, relative to its size and to 1 rad: truncation or rounding.
    pub tail: f64,
}

impl Bridge {
    /// The bridge over a crossing at the distance `distance` from `base`, `half` on both sides of it. None where
    /// positions on both sides are not those of one analytic curve.
    pub fn new(
        closure: &Closure,
        gapped: &Gapped,
        base: &Base,
        [distance, half]: [f64; 2],
        scratch: &mut configuration::Scratch,
    ) -> Option<Self> {
        let mut walk = Walk::new(closure, base, scratch)?;
        walk.go(scratch, distance - half)?;
        closure.normalise(&mut walk.slope);
        let first = Base { sigma: 0.0, q: walk.q, tangent: walk.slope };
        let mut walk = Walk::new(closure, &first, scratch)?;
        let mut samples = vec![[0.0; _]; base.q.len()];
        let mut extrapolation = Extrapolation::default();
        extrapolation.start(&walk.q, &walk.slope);
        for (j, x) in gapped.nodes.iter().enumerate() {
            let u = half * (1.0 + x);
            walk.jump(scratch, u, &extrapolation)?;
            extrapolation.add(u, &walk.q, &walk.slope, 1.0);
            let refined = walk.refined(scratch, &first.q)?;
            samples.iter_mut().zip(refined).for_each(|(s, value)| s[j] = value);
        }
        let (mut series, mut worst) = (Vec::new(), 0.0_f64);
        for ((values, q), w) in samples.iter().zip(&first.q).zip(&closure.weights) {
            let (mut c, tail) = gapped.fit(values);
            c[0] += q;
            let relative = tail / (1.0 / w + q.abs());
            if relative.is_nan() || relative > LARGEST_TAIL {
                return None;
            }
            worst = worst.max(relative);
            let slope = slopes_of(&c).map(|c| c / half);
            series.push([c, slope, slopes_of(&slope).map(|c| c / half)]);
        }
        let mut bridge = Self {
            normal: walk.normal,
            first: first.q,
            width: 2.0 * half,
            range: [1.0 - INNER, 1.0 + INNER].map(|part| part * half),
            series,
            crossing: half,
            tail: worst,
        };
        let open = |u: f64| {
            let gaps = closure.linkage.gaps(&closure.linkage.positions(&bridge.at(u)[0]));
            gaps.iter().any(|gap| gap.is_nan() || gap.abs() > OPEN * closure.linkage.size)
        };
        if [0.05, 0.25, 0.43, 0.5, 0.57, 0.75, 0.95].iter().any(|part| open(part * bridge.width)) {
            return None;
        }
        let coordinates = |u: f64| bridge.at(u)[0].clone();
        let course = Course { closure, normal: &bridge.normal, coordinates: &coordinates };
        let between = [1.0 - GAP, 1.0 + 0.1 * GAP, 1.0 + GAP].map(|part| half * part);
        bridge.crossing = course.least_margin(between, &mut scratch.loops);
        Some(bridge)
    }

    /// Half the width.
    pub fn half(&self) -> f64 {
        0.5 * self.width
    }

    /// u of the plane of a position.
    pub fn distance(&self, q: &[f64]) -> f64 {
        (0..q.len()).map(|i| self.normal[i] * (q[i] - self.first[i])).sum()
    }

    /// Coordinates with two derivatives in u.
    pub fn at(&self, u: f64) -> [Vec<f64>; 3] {
        let x = 2.0 * u / self.width - 1.0;
        std::array::from_fn(|k| self.series.iter().map(|s| polynomial(&s[k], x)).collect())
    }
}
