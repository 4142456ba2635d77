//! A panel across a position where branches cross, however many loops are singular there.
//!
//! In: a closed position short of a crossing. Out: the distance of the crossing, a panel with the crossing in its
//! middle. It must not know how far the curve is followed.
//!
//! The curve is analytic through the crossing, but close to it the loop equations amplify rounding without bound, by
//! the inverse of a power of the distance. The panel's polynomials go through closed positions on both sides that keep
//! away from the crossing ([`Gapped`]); in between they are the analytic continuation.
use super::configuration;
use super::panel::{Base, Panel, Rejection, Scratch, least, largest};
use crate::mechanism::closure::Closure;
use crate::numerics::chebyshev::NODES;
use crate::numerics::gapped::Gapped;

/// Allowed ratio of the last coefficients of a series to the rounding of its values.
const NOISE: f64 = 10.0;
/// Rounding of coordinates before amplification, relative to their size and to 1 rad.
const ROUNDING: f64 = 1e-15;
/// Largest gap of a loop on the panel, relative to the size of the linkage.
const OPEN: f64 = 1e-11;

/// Walk along the curve across planes with one normal, from a base.
struct Walk<'a> {
    closure: &'a Closure,
    base: &'a Base,
    normal: Vec<f64>,
    /// Present distance across the planes, coordinates, and their derivatives with respect to the distance.
    u: f64,
    q: Vec<f64>,
    slope: Vec<f64>,
    amplification: f64,
}

impl<'a> Walk<'a> {
    fn new(closure: &'a Closure, base: &'a Base, scratch: &mut configuration::Scratch) -> Option<Self> {
        let normal = closure.normal(&base.tangent);
        let mut walk = Self {
            closure,
            base,
            u: 0.0,
            q: base.q.clone(),
            slope: base.tangent.clone(),
            amplification: 0.0,
            normal,
        };
        walk.close(scratch, 0.0, f64::INFINITY)?;
        Some(walk)
    }

    /// Close the loops at the distance u by at most this first correction. None if that fails: nothing has changed.
    fn close(&mut self, scratch: &mut configuration::Scratch, u: f64, most: f64) -> Option<()> {
        let mut q: Vec<f64> = self.q.iter().zip(&self.slope).map(|(q, slope)| q + (u - self.u) * slope).collect();
        let loops = &mut scratch.loops;
        let converged =
            self.closure.on_plane(loops, &mut q, &self.base.q, &self.normal, u).filter(|c| c.first <= most)?;
        loops.factors.tangent(&self.normal, 1.0, &mut self.slope);
        (self.u, self.q, self.amplification) = (u, q, converged.amplification);
        Some(())
    }

    /// Go to the distance u, in short steps.
    fn go(&mut self, scratch: &mut configuration::Scratch, u: f64) -> Option<()> {
        const STEP: f64 = 0.05;
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
/// Near a crossing at the distance c the amplification grows like (c - u)^-k, so that the inverse of the slope of its
/// logarithm is (c - u) / k, which falls linearly to 0.
pub(super) fn crossing_ahead(
    closure: &Closure,
    base: &Base,
    width: f64,
    scratch: &mut configuration::Scratch,
) -> Option<f64> {
    /// Distance between the two positions that give a slope, and largest part of the way to the crossing in one go.
    const APART: f64 = 0.02;
    const PART: f64 = 0.5;
    /// Longest way in one go.
    const STRIDE: f64 = 0.1;
    let mut walk = Walk::new(closure, base, scratch)?;
    let mut apart = APART * STRIDE;
    let (mut before, mut found): (Option<[f64; 2]>, Option<f64>) = (None, None);
    for _ in 0..60 {
        let (u, low) = (walk.u, walk.amplification.ln());
        if u > 1.5 * width {
            return None;
        }
        walk.go(scratch, u + apart)?;
        let slope = (walk.amplification.ln() - low) / apart;
        let (at, inverse) = (u + 0.5 * apart, 1.0 / slope);
        let mut stride = STRIDE;
        let estimate = before.and_then(|[u, value]| {
            let c = at + inverse * (at - u) / (value - inverse);
            (slope > 0.0 && value > inverse && c > at && c < at + 2.0 * width.max(STRIDE)).then_some(c)
        });
        if let Some(c) = estimate {
            let close = c - at < 0.1 * c.max(0.3) || found.is_some_and(|f| (f - c).abs() < 0.003 * c.max(0.1));
            if close {
                return Some(c);
            }
            stride = stride.min(PART * (c - at));
            apart = APART * (c - at);
        }
        found = estimate;
        before = Some([at, inverse]);
        if walk.go(scratch, u + stride.max(2.0 * apart)).is_none() {
            return found;
        }
    }
    found
}

impl Panel {
    /// The panel from `base` to `half` beyond the crossing at this distance, which is at most `half`: the first part of
    /// the panel that would begin at `half` before the crossing is left out. Returns the panel and the unit tangent at
    /// its tip.
    ///
    /// # Errors
    /// A [`Rejection`].
    pub fn across(
        closure: &Closure,
        gapped: &Gapped,
        base: &Base,
        distance: f64,
        half: f64,
        scratch: &mut Scratch,
    ) -> Result<(Self, Vec<f64>), Rejection> {
        const UNRESOLVED: Rejection = Rejection::TooWide(0.7);
        // The panel may begin before the base; it is cut there in the end.
        let mut walk = Walk::new(closure, base, &mut scratch.evaluation).ok_or(UNRESOLVED)?;
        walk.go(&mut scratch.evaluation, distance - half).ok_or(UNRESOLVED)?;
        closure.normalise(&mut walk.slope);
        let start = Base { sigma: 0.0, q: walk.q, tangent: walk.slope };
        let normal = closure.normal(&start.tangent);
        let u: f64 = (0..normal.len()).map(|i| normal[i] * (base.q[i] - start.q[i])).sum();
        let width = 2.0 * half;
        scratch.sample(closure, &gapped.nodes, &start, &normal, width, &mut |_, _| {})?;
        let samples = &scratch.samples;
        let amplifications = samples.amplifications;
        let (amplification, least) = (largest(&amplifications).max(2.0), least(&amplifications));
        let rounding = NOISE * ROUNDING * amplification;
        let mut coordinates = Vec::new();
        for (values, w) in samples.coordinates.iter().zip(&closure.weights) {
            let (series, tail) = gapped.fit(values, true);
            if !(tail <= rounding * (1.0 / w + series[0].abs())) {
                return Err(UNRESOLVED);
            }
            coordinates.push(series);
        }
        let fastest = largest(&samples.speeds);
        if samples.speeds.iter().any(|s| *s < 1e-7 * fastest) {
            return Err(Rejection::Massless);
        }
        // The speed has the rounding of derivatives of the coordinates, amplified twice.
        let (speed, tail) = gapped.fit(&samples.speeds.map(|s| half * s), true);
        if !(tail <= 20.0 * rounding * amplification * half * fastest) {
            return Err(UNRESOLVED);
        }
        let derivatives = samples.firsts.iter().zip(&samples.seconds);
        let derivatives =
            derivatives.map(|(first, second)| [gapped.fit(first, true).0, gapped.fit(second, true).0]).collect();
        let curvatures = samples.seconds.iter().map(|s| [gapped.fit(s, false).1, largest(s)]).collect();
        let mut panel = Self {
            start: 0.0,
            base: start.q.clone(),
            normal,
            width,
            coordinates,
            half: 0.0,
            length: [0.0; NODES],
            span: 0.0,
            speed,
            end_speeds: [0.0; 2],
            tip: Vec::new(),
            amplification: least,
            amplifications,
            derivatives,
            curvatures,
            crossing: Some(0.0),
        };
        let size = closure.linkage.size;
        for x in [-0.9, -0.5, -0.15, 0.0, 0.15, 0.5, 0.9] {
            let gaps = closure.linkage.gaps(&closure.linkage.positions(&panel.coordinates_at(x)));
            if gaps.iter().any(|gap| !(gap.abs() <= OPEN * size)) {
                return Err(UNRESOLVED);
            }
        }
        let loops = &mut scratch.evaluation.loops;
        let mut tip = panel.coordinates_at(1.0);
        closure.on_plane(loops, &mut tip, &panel.base, &panel.normal, width).ok_or(UNRESOLVED)?;
        let mut tangent = Vec::new();
        loops.factors.tangent(&panel.normal, 1.0, &mut tangent);
        closure.normalise(&mut tangent);
        panel.tip = tip;
        let mut panel = panel.part(2.0 * u / width - 1.0, 1.0);
        panel.start = base.sigma;
        panel.base.clone_from(&base.q);
        Ok((panel, tangent))
    }
}
