//! One panel of the curve: closed positions as polynomials in a plane's distance from the panel's base.
use super::configuration::{Configuration, Workspace};
use super::known::Known;
use super::travel::Travel;
use crate::mechanism::closure::Closure;
use crate::mechanism::linkage::{Linkage, Positions, Rates};
use crate::numerics::chebyshev::{NODES, Series, Transform, chopped, monomials, polynomial, slopes_of, tail};

/// A stretch of the curve that crosses every plane normal . (q - base) = u, 0 <= u <= width, once.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// sigma at its base.
    pub start: f64,
    /// Coordinates at its base.
    pub base: Vec<f64>,
    /// Normal of the planes.
    pub normal: Vec<f64>,
    /// Last u.
    pub width: f64,
    /// Each coordinate as a polynomial in x = 2 u / width - 1: its monomial coefficients.
    pub coordinates: Vec<Series>,
    /// sigma - start as a polynomial in x: at 0, its coefficients beyond that one, and its value at the tip.
    half: f64,
    length: Series,
    span: f64,
    /// d sigma / d x as a polynomial in x, and its values at both ends.
    speed: Series,
    rims: [f64; 2],
    /// Coordinates at its end.
    pub tip: Vec<f64>,
    /// How much rounding in a gap is amplified where least.
    pub amplification: f64,
    /// The same at the nodes.
    pub amplifications: [f64; NODES],
    /// Of each coordinate, if rounding is amplified much more at some nodes than at others: its first and second derivative
    /// along sigma as polynomials in x, through what the loop equations give at the nodes. In between, close to a crossing, these
    /// are far more accurate than either the loop equations or derivatives of `coordinates`.
    pub derivatives: Vec<[Series; 2]>,
    /// Of each coordinate's second derivative along sigma: tail of its series in x, and its largest value.
    pub bends: Vec<[f64; 2]>,
}

/// Where a panel starts, and what leads on from there.
#[derive(Clone, Debug)]
pub struct Base {
    /// sigma.
    pub sigma: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Unit tangent.
    pub tangent: Vec<f64>,
}

/// Room for one panel after another.
#[derive(Debug, Default)]
pub struct Room {
    /// For configurations.
    pub work: Workspace,
    c: Configuration,
    /// Coordinates and their derivatives along sigma at the nodes.
    nodes: Vec<[f64; NODES]>,
    firsts: Vec<[f64; NODES]>,
    seconds: Vec<[f64; NODES]>,
    known: Known,
    /// Positions closed so far.
    pub closed: usize,
}

/// Why a panel of some width was not accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// The series does not resolve it, or Newton's method went astray: one shorter by this factor may do.
    TooWide(f64),
    /// A node is too close to a position where branches cross: a slightly different one may do.
    NearCrossing,
    /// The kinetic energy vanishes at one of its positions.
    Massless,
}

/// Nodes may amplify rounding this many times as much as the panel's best one: 1 / 16 of a panel away from a crossing in
/// its middle. Amplification grows with the number of loops, so only its ratio tells of a crossing.
const NEAR: f64 = 60.0;
/// The tip, where the next panel starts, must keep farther away.
const TIP_NEAR: f64 = 8.0;
/// Where nodes amplify rounding more than this many times as much as the best one, the series ends in rounding.
const CROSSING: f64 = 5.0;
/// Where it differs more than this between nodes, derivatives are kept.
const UNEVEN: f64 = 2.0;
/// Below this amplification no position is too close to a crossing.
const HARMLESS: f64 = 30.0;
/// Away from crossings rounding may turn out this many times as large.
const NOISE: f64 = 10.0;
/// Rounding of coordinates, relative to their size and to 1 rad, before amplification.
const ROUNDING: f64 = 1e-15;
/// A panel on which Newton's method goes astray is shortened by this factor.
const ASTRAY: f64 = 0.7;
/// Order of the coefficients that must be of the size of rounding.
const ORDER: f64 = (NODES - 2) as f64;

/// Twice the kinetic energy at these rates: sum of m v^2 + I omega^2.
pub fn twice_kinetic(linkage: &Linkage, p: &Positions, r: &Rates) -> f64 {
    let mut sum = 0.0;
    for (i, body) in linkage.bodies.iter().enumerate().skip(1) {
        if body.mass > 0.0 {
            let point = crate::mechanism::linkage::Point { body: i, local: body.center };
            sum += body.mass * p.velocity(r, point).norm_squared();
        }
        sum += body.inertia * r.angle[i].powi(2);
    }
    sum
}

impl Panel {
    /// Last sigma.
    pub fn end(&self) -> f64 {
        self.start + self.span
    }

    /// Try to build the panel that starts at `base`; `travel` passes its nodes. Returns the unit tangent at its tip with it, and by what factor it might
    /// have been wider.
    ///
    /// # Errors
    /// A [`Refusal`].
    pub(super) fn build(
        closure: &Closure,
        transform: &Transform,
        base: &Base,
        width: f64,
        room: &mut Room,
        mut travel: Option<&mut Travel>,
    ) -> Result<(Self, Vec<f64>, f64), Refusal> {
        let n = base.q.len();
        let w = &closure.weights;
        let normal = closure.normal(&base.tangent);
        let Room { work, c, nodes, firsts, seconds, known, closed } = room;
        for samples in [&mut *nodes, &mut *firsts, &mut *seconds] {
            samples.clear();
            samples.resize(n, [0.0; NODES]);
        }
        let mut speeds = [0.0; NODES];
        let mut amplifications = [0.0; NODES];
        let mut last = 0.0;
        known.start(&base.q, &base.tangent);
        for (j, x) in transform.nodes.iter().enumerate() {
            let u = 0.5 * width * (1.0 + x);
            known.extrapolate(u, &mut c.q);
            *closed += 1;
            let landing = closure
                .on_plane(&mut work.loops, &mut c.q, &base.q, &normal, u)
                .filter(|l| l.first <= 0.2 * (u - last) + 1e-12)
                .ok_or(Refusal::TooWide(ASTRAY))?;
            amplifications[j] = landing.amplification;
            closure.place(landing, &c.q, &mut work.loops, &mut c.positions);
            if let Some(travel) = &mut travel {
                travel.pass(j, &c.positions);
            }
            speeds[j] = c.derive(closure, &normal, work);
            if speeds[j] == 0.0 || speeds[j].is_nan() {
                return Err(Refusal::Massless);
            }
            let steep = (0..n).map(|i| (c.q_sigma[i] * w[i]).powi(2)).sum::<f64>().sqrt() * speeds[j];
            if steep > 1.5 || steep.is_nan() {
                return Err(Refusal::TooWide(ASTRAY));
            }
            known.add(u, &c.q, &c.q_sigma, speeds[j]);
            for (i, ((sample, first), second)) in nodes.iter_mut().zip(&mut *firsts).zip(&mut *seconds).enumerate() {
                (sample[j], first[j], second[j]) = (c.q[i], c.q_sigma[i], c.q_second[i]);
            }
            last = u;
        }
        let amplification = amplifications.iter().fold(1.0, |a: f64, b| a.max(*b));
        let least = amplifications.iter().fold(f64::INFINITY, |a: f64, b| a.min(*b));
        if amplification > HARMLESS.max(NEAR * least) {
            return Err(Refusal::NearCrossing);
        }
        let rounding = ROUNDING * amplification.max(2.0);
        let noise = if amplification > HARMLESS { 1.0 } else { NOISE };
        let mut wider = f64::INFINITY;
        let mut coordinates: Vec<Series> = nodes.iter().map(|samples| transform.fit(samples)).collect();
        for (series, w) in coordinates.iter().zip(w) {
            let size = (1.0 + series[0].abs() * w) / w;
            wider = wider.min(resolved(series, rounding * size, noise)?);
        }
        let fastest = speeds.iter().fold(0.0, |a: f64, s| a.max(*s));
        let slowest = speeds.iter().fold(f64::INFINITY, |a: f64, s| a.min(*s));
        if slowest < 1e-7 * fastest {
            return Err(Refusal::Massless);
        }
        let mut speed = transform.fit(&speeds.map(|s| 0.5 * width * s));
        // The slope of a series is its length times less accurate than the series.
        let mut slope = 20.0;
        if amplification > HARMLESS {
            // A position that is off by rounding has the tangent of another one: branches that almost meet turn sharply.
            let bend = seconds.iter().zip(w).flat_map(|(s, w)| s.map(|v| (v * w).abs())).fold(0.0, f64::max);
            slope += bend * fastest * fastest;
        }
        wider = wider.min(resolved(&speed, slope * rounding * 0.5 * width * fastest, noise)?);
        if amplification > HARMLESS.max(CROSSING * least) {
            coordinates.iter_mut().chain([&mut speed]).for_each(|s| *s = chopped(s));
        }
        coordinates.iter_mut().chain([&mut speed]).for_each(|s| *s = monomials(s));
        let derivatives = if amplification > UNEVEN * least {
            let fit = |samples: &[f64; NODES]| monomials(&chopped(&transform.fit(samples)));
            firsts.iter().zip(&*seconds).map(|(first, second)| [fit(first), fit(second)]).collect()
        } else {
            Vec::new()
        };
        let bend = |s: &[f64; NODES]| [tail(&transform.fit(s)), s.iter().fold(0.0, |a: f64, v| a.max(v.abs()))];
        let bends = seconds.iter().map(bend).collect();
        let mut tip: Vec<f64> = coordinates.iter().map(|s| polynomial(s, 1.0)).collect();
        *closed += 1;
        let landing =
            closure.on_plane(&mut work.loops, &mut tip, &base.q, &normal, width).ok_or(Refusal::TooWide(ASTRAY))?;
        if landing.amplification > HARMLESS.max(TIP_NEAR * least) {
            return Err(Refusal::NearCrossing);
        }
        let mut ahead = Vec::new();
        work.loops.factors.tangent(&normal, 1.0, &mut ahead);
        closure.normalise(&mut ahead);
        let panel = Self {
            start: base.sigma,
            base: base.q.clone(),
            normal,
            width,
            coordinates,
            half: 0.0,
            length: [0.0; NODES],
            span: 0.0,
            speed,
            rims: [0.0; 2],
            tip,
            amplification: least,
            amplifications,
            derivatives,
            bends,
        };
        Ok((panel.measured(), ahead, wider))
    }

    /// With its length, which follows from the speed.
    fn measured(mut self) -> Self {
        self.length = std::array::from_fn(|k| self.speed[k] / (k + 1) as f64);
        self.half = polynomial(&self.length, -1.0);
        self.span = self.half + polynomial(&self.length, 1.0);
        self.rims = [-1.0, 1.0].map(|x| polynomial(&self.speed, x));
        self
    }

    /// The same stretch followed the other way, with its base, the present tip, at `start`: x becomes -x.
    pub fn mirrored(mut self, start: f64) -> Self {
        let odd = |series: &mut [f64]| series.iter_mut().skip(1).step_by(2).for_each(|c| *c = -*c);
        std::mem::swap(&mut self.base, &mut self.tip);
        self.start = start;
        self.normal.iter_mut().for_each(|n| *n = -*n);
        self.amplifications.reverse();
        self.coordinates.iter_mut().for_each(|series| odd(series));
        for [first, second] in &mut self.derivatives {
            odd(first);
            odd(second);
            // sigma grows the other way.
            first.iter_mut().for_each(|c| *c = -*c);
        }
        odd(&mut self.speed);
        self.measured()
    }

    /// Coordinates at x in [-1, 1], by the polynomials.
    pub fn series_at(&self, x: f64) -> Vec<f64> {
        let mut q = Vec::new();
        self.place(x, &mut q);
        q
    }

    /// As [`Self::series_at`], in place.
    pub fn place(&self, x: f64, q: &mut Vec<f64>) {
        q.clear();
        q.extend(self.coordinates.iter().map(|s| polynomial(s, x)));
    }

    /// Derivatives of the coordinates with respect to x.
    pub fn slopes_at(&self, x: f64) -> Vec<f64> {
        self.coordinates.iter().map(|s| polynomial(&slopes_of(s), x)).collect()
    }

    /// Second derivatives of the coordinates with respect to x.
    pub fn curvatures_at(&self, x: f64) -> Vec<f64> {
        self.coordinates.iter().map(|s| polynomial(&slopes_of(&slopes_of(s)), x)).collect()
    }

    /// sigma at x.
    pub fn sigma_at(&self, x: f64) -> f64 {
        self.start + self.half + x * polynomial(&self.length, x)
    }

    /// x at sigma: Newton's method on a monotonic polynomial.
    pub fn x_at(&self, sigma: f64) -> f64 {
        let start = self.start;
        // From the cubic that has the right slopes at both ends.
        let s = (sigma - start) / self.span;
        let [m0, m1] = self.rims.map(|rim| self.span / rim);
        let mut x = -1.0 + s * (m0 + s * ((6.0 - 2.0 * m0 - m1) + s * (m0 + m1 - 4.0)));
        x = if x.is_finite() { x.clamp(-1.0, 1.0) } else { 0.0 };
        for _ in 0..20 {
            let length = self.half + x * polynomial(&self.length, x);
            let step = (sigma - start - length) / polynomial(&self.speed, x);
            x = (x + step).clamp(-1.0, 1.0);
            // The next step would be of the size of the square of this one.
            if step.abs() < 1e-9 {
                break;
            }
        }
        x
    }

    /// u at x.
    pub fn u_at(&self, x: f64) -> f64 {
        0.5 * self.width * (1.0 + x)
    }
}

/// By what factor a panel might be wider whose function has this series, if a coefficient of order [`ORDER`] may have the
/// size `rounding`, and `noise` times that if coefficients have ceased to decay; refused if it may not be as wide as it is.
///
/// Coefficients decay like rho^-k, where rho, while it is large, is inversely proportional to the width.
fn resolved(series: &Series, mut rounding: f64, noise: f64) -> Result<f64, Refusal> {
    let tail = tail(series);
    if tail > rounding || tail.is_nan() {
        let middle = series[NODES / 2..].iter().fold(0.0, |a: f64, c| a.max(c.abs()));
        if tail > noise * rounding || tail.is_nan() || middle > 2.0 * tail {
            let shorter = (rounding / tail).powf(1.0 / ORDER);
            return Err(Refusal::TooWide(if shorter.is_finite() { (0.93 * shorter).clamp(0.3, 0.93) } else { ASTRAY }));
        }
        // No shorter panel has less of it.
        rounding = middle;
    }
    let last = series.iter().rposition(|c| c.abs() > rounding).unwrap_or(0);
    let largest = series[1..].iter().fold(0.0, |a: f64, c| a.max(c.abs()));
    if last < 2 || largest <= rounding {
        return Ok(f64::INFINITY);
    }
    // The order, a fraction, at which the coefficients fall below rounding; the next one at least has.
    let decay = (largest / rounding).ln();
    let order = last as f64 + ((series[last].abs() / rounding).ln() * last as f64 / decay).min(1.0);
    Ok((decay / order - decay / (ORDER - 1.0)).exp())
}
