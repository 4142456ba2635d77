//! The start on the curve: sigma at which a coordinate has a stated value.
//!
//! In: a coordinate and its value. Out: sigma and revolutions. It must not know speeds or time.
use super::Reduced;
use super::error::ReductionError;
use super::snap::not_smooth;
use crate::mechanism::definition::Mechanism;
use crate::mechanism::linkage::Linkage;
use crate::mechanism::loads::laws::stop::Stop;
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::bracket::bisect;
use crate::numerics::chebyshev::Series;
use crate::numerics::table::{Table, polynomial};
use std::f64::consts::TAU;

/// The quantity by which a definition states the start.
pub struct Stated<'a> {
    /// Index of the coordinate; none if the quantity gives none.
    pub coordinate: Option<usize>,
    /// Value of the coordinate.
    pub value: f64,
    /// Name of the body or the joint.
    pub name: &'a str,
    /// `angle` or `position`.
    pub quantity: &'static str,
}

impl<'a> Stated<'a> {
    /// The start of a definition.
    pub fn new(mechanism: &'a Mechanism, linkage: &Linkage) -> Self {
        let start = &mechanism.start;
        if let Some(body) = &start.body {
            let (carrier, own) = linkage.carrier(mechanism, body).unwrap_or((0, 0.0));
            let coordinate = linkage.bodies[carrier].angle_coordinate;
            let value = start.angle.unwrap_or(0.0) - own - linkage.bodies[carrier].offset;
            return Self { coordinate, value, name: body, quantity: "angle" };
        }
        let Some(joint) = &start.joint else {
            return Self { coordinate: None, value: 0.0, name: &mechanism.name, quantity: "angle" };
        };
        let index = linkage.coordinates[linkage.angles..].iter().position(|c| c == joint);
        let (coordinate, value) = (index.map(|i| i + linkage.angles), start.position.unwrap_or(0.0));
        Self { coordinate, value, name: joint, quantity: "position" }
    }
}

impl Reduced {
    /// Whether the start that a definition states is on the curve, or is beyond a stop of its own body, which no search
    /// needs to find out.
    pub(super) fn has_start(&self, mechanism: &Mechanism) -> bool {
        let Stated { coordinate, value, name, .. } = Stated::new(mechanism, self.linkage());
        let is_beyond = |(stop, angle): (&Stop, f64)| stop.beyond(angle) > SURELY_BEYOND * (1.0 + stop.value.abs());
        mechanism.start.is_at_guess()
            || self.own_stops(mechanism).any(is_beyond)
            || coordinate.is_some_and(|coordinate| self.find(coordinate, value, name).is_ok())
    }

    /// The rigid stops of the body whose angle states the start, each with this angle as the stop measures it [rad].
    pub fn own_stops(&self, mechanism: &Mechanism) -> impl Iterator<Item = (&Stop, f64)> {
        let start = &mechanism.start;
        let carrier = start.body.as_ref().and_then(|body| self.linkage().carrier(mechanism, body));
        let rigid = self.loading().stops.iter().filter(|stop| stop.enabled && stop.rigid);
        carrier.zip(start.angle).into_iter().flat_map(move |((body, own), angle)| {
            rigid.clone().filter_map(move |stop| match self.loading().loads[stop.load] {
                Load::Torque { body: of, shift } if of == body => Some((stop, angle - own + shift)),
                _ => None,
            })
        })
    }

    /// sigma at which a coordinate has this value, and the number of revolutions of the curve before it. Of several
    /// positions the nearest to the guess, where sigma is 0; an open curve is searched stretch by stretch, going out
    /// from the guess on both sides.
    ///
    /// # Errors
    /// [`ReductionError::Start`] with the range of the coordinate.
    pub fn find(&self, coordinate: usize, value: f64, name: &str) -> Result<(f64, f64), ReductionError> {
        let mut best = self.find_here(coordinate, value, name)?;
        let mut stretches = [Some(self); 2];
        while best.is_none() && stretches.iter().any(Option::is_some) {
            for (side, stretch) in stretches.iter_mut().enumerate() {
                *stretch = stretch.and_then(|stretch| self.next(stretch, side).ok());
                // The motion does not get to where coordinates are not smooth.
                let found = stretch.and_then(|stretch| stretch.find_here(coordinate, value, name).ok()?);
                let nearest = |best: (f64, f64)| found.is_none_or(|found| best.0.abs() <= found.0.abs());
                best = best.filter(|best| nearest(*best)).or(found);
            }
        }
        best.ok_or_else(|| {
            let (low, high) = self.range_of(coordinate);
            if !(low.is_finite() && high.is_finite()) {
                // Numbers so far apart that no position has a value.
                return ReductionError::Table { what: name.into(), position: "the guess".into() };
            }
            if high - low <= RIGID * (1.0 + low.abs()) {
                let moves = |i: &usize| {
                    let (low, high) = self.range_of(*i);
                    high - low > RIGID * (1.0 + low.abs())
                };
                let coordinates = &self.linkage().coordinates;
                let moving = (0..coordinates.len()).filter(moves).map(|i| coordinates[i].clone()).collect();
                let held = 0.5 * (low + high);
                // What is 0 but for rounding is 0.
                let held = if held.abs() < RIGID { 0.0 } else { held };
                return ReductionError::Rigid { name: name.into(), value, held, moving };
            }
            let same = value + TAU * ((0.5 * (low + high) - value) / TAU).round();
            let turned = (coordinate < self.linkage().angles && (low..=high).contains(&same)).then_some(same);
            ReductionError::Start { name: name.into(), value, range: (low, high), turned }
        })
    }

    /// [`Self::find`] on this stretch of the curve; none if it is not there.
    ///
    /// # Errors
    /// The coordinates are not smooth.
    fn find_here(&self, coordinate: usize, value: f64, name: &str) -> Result<Option<(f64, f64)>, ReductionError> {
        let table = self.coordinates().map_err(|e| not_smooth(self.curve(), name.into(), e))?;
        let growth = self.curve().growth(coordinate);
        let x: [f64; SAMPLES + 1] = std::array::from_fn(|k| OVERLAP * (-1.0 + 2.0 * k as f64 / SAMPLES as f64));
        let sampled =
            |panel: usize, order: usize| x.map(|x| polynomial(table.series(panel, 3 * coordinate + order), x));
        let samples_on = |panel: usize| [0, 1].map(|order| sampled(panel, order));
        // On a curve with growth the value may lie some revolutions away.
        let mut samples = Vec::new();
        let revolutions = if growth == 0.0 {
            vec![0.0]
        } else {
            samples = (0..table.panels()).map(samples_on).collect();
            let all = || samples.iter().flat_map(|[values, _]| values.iter().copied());
            let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
            let around = ((value - 0.5 * (low + high)) / growth).round();
            (-2..=2).map(|k| around + f64::from(k)).collect()
        };
        let mut best: Option<(f64, f64)> = None;
        let distance = |sigma: f64| match self.period() {
            Some(period) => sigma.abs().min((period - sigma).abs()),
            None => sigma.abs(),
        };
        for revolution in revolutions {
            let wanted = value - revolution * growth;
            for panel in 0..table.panels() {
                if !may_reach(table.series(panel, 3 * coordinate), wanted, value) {
                    continue;
                }
                let [values, slopes] = samples.get(panel).copied().unwrap_or_else(|| samples_on(panel));
                let (a, b) = table.borders(panel);
                let mut offer = |x: f64| {
                    let (sigma, revolution) = self.wrapped(0.5 * (a + b) + 0.5 * (b - a) * x, revolution);
                    if best.is_none_or(|(s, _)| distance(sigma) < distance(s)) {
                        best = Some((sigma, revolution));
                    }
                };
                let miss = |x: f64| polynomial(table.series(panel, 3 * coordinate), x) - wanted;
                let slope = |x: f64| polynomial(table.series(panel, 3 * coordinate + 1), x);
                // At a border of panels rounding may hide the change of sign.
                for x in [-1.0, 1.0] {
                    if miss(x).abs() <= 8.0 * f64::EPSILON * (1.0 + value.abs()) {
                        offer(x);
                    }
                }
                for k in 0..SAMPLES {
                    let (x0, x1) = (x[k], x[k + 1]);
                    if (values[k] - wanted) * (values[k + 1] - wanted) <= 0.0 {
                        offer(root(&miss, x0, x1));
                    } else if slopes[k] * slopes[k + 1] <= 0.0 {
                        // The coordinate has an extremum here, a toggle.
                        let x = root(&slope, x0, x1);
                        if miss(x) * miss(x0) <= 0.0 {
                            offer(root(&miss, x0, x));
                            offer(root(&miss, x, x1));
                        } else if miss(x).abs() < TOGGLE {
                            offer(x);
                        }
                    }
                }
            }
        }
        let Some((sigma, revolution)) = best else { return Ok(None) };
        if growth != 0.0 {
            return Ok(Some((sigma, revolution)));
        }
        // The end of the last revolution is just behind the guess: there the other coordinates are near their guesses.
        let behind = self.period().is_some_and(|period| period - sigma < sigma);
        Ok(Some((sigma, if behind { -1.0 } else { 0.0 })))
    }

    /// Least and largest value of a coordinate along the curve between the stops.
    fn range_of(&self, coordinate: usize) -> (f64, f64) {
        let all = std::iter::once(self).chain(self.stretches()).map(|stretch| stretch.range_here(coordinate));
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// [`Self::range_of`] on this stretch of the curve.
    fn range_here(&self, coordinate: usize) -> (f64, f64) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let Ok(table) = self.coordinates() else { return (low, high) };
        // A stop whose quantity grows with each revolution ends the travel in one revolution only.
        let ends = |s: &&Stop| s.enabled && self.load_growth(s.load) == 0.0;
        let stops: Vec<(&Stop, &Table)> = self
            .loading()
            .stops
            .iter()
            .filter(ends)
            .filter_map(|s| Some((s, self.displacement(s.load).ok()?)))
            .collect();
        let beyond = |sigma: f64| {
            let all = stops.iter().map(|(stop, s)| stop.beyond(s.value(s.position(sigma), 0)));
            all.fold(f64::NEG_INFINITY, f64::max)
        };
        let q = |sigma: f64, order: usize| table.value(table.position(sigma), 3 * coordinate + order);
        let (first, last) = self.curve().range;
        for panel in 0..table.panels() {
            let (a, b) = table.borders(panel);
            let sigma = |k: usize| (a + (b - a) * k as f64 / SAMPLES as f64).clamp(first, last);
            for k in 0..SAMPLES {
                let (mut s0, mut s1) = (sigma(k), sigma(k + 1));
                match (beyond(s0) > 0.0, beyond(s1) > 0.0) {
                    (true, true) => continue,
                    (true, false) => s0 = root(&beyond, s0, s1),
                    (false, true) => s1 = root(&beyond, s0, s1),
                    (false, false) => {}
                }
                let extremum = (q(s0, 1) * q(s1, 1) < 0.0).then(|| root(&|s| q(s, 1), s0, s1));
                for s in [s0, s1].into_iter().chain(extremum) {
                    (low, high) = (low.min(q(s, 0)), high.max(q(s, 0)));
                }
            }
        }
        (low, high)
    }

    /// sigma on the curve and the number of revolutions before it, for a sigma that counts all revolutions.
    pub fn unwound(&self, sigma: f64) -> (f64, f64) {
        let revolutions = self.period().map_or(0.0, |period| ((sigma - self.curve().range.0) / period).floor());
        (sigma - revolutions * self.period().unwrap_or(0.0), revolutions)
    }

    /// sigma on the curve and the number of revolutions before it, for a sigma at most one revolution outside.
    fn wrapped(&self, sigma: f64, revolutions: f64) -> (f64, f64) {
        let (first, last) = self.curve().range;
        match self.period() {
            Some(period) if sigma < first => (sigma + period, revolutions - 1.0),
            Some(period) if sigma >= last => (sigma - period, revolutions + 1.0),
            Some(_) => (sigma, revolutions),
            None => (sigma.clamp(first, last), revolutions),
        }
    }
}

/// Number of intervals of a panel; a coordinate has at most one extremum in each.
const SAMPLES: usize = 16;
/// Range of x in which a panel is searched, so that rounding at a border hides the start from one panel at most.
const OVERLAP: f64 = 1.0 + 1e-9;
/// Range of a coordinate that is rounding [rad or m, relative to 1 and the value].
const RIGID: f64 = 1e-9;
/// Distance beyond a stop from which on a start is refused [rad, relative to 1 and the value].
const SURELY_BEYOND: f64 = 1e-9;
/// Distance beyond a toggle within which a stated start is at the toggle [rad or m].
const TOGGLE: f64 = 1e-9;

/// Whether a polynomial with these monomial coefficients may have the value `wanted` on its panel, or come as near to
/// it as counts as that; `value` is the one to which rounding is relative.
fn may_reach(series: &Series, wanted: f64, value: f64) -> bool {
    /// More than what the range beyond the panel, a toggle and rounding add, relative to the terms and to the value.
    const SLACK: f64 = 1e-6;
    let terms: f64 = series[1..].iter().map(|c| c.abs()).sum();
    (series[0] - wanted).abs() <= terms * (1.0 + SLACK) + SLACK * (1.0 + value.abs())
}

/// Root of a function that changes sign, within rounding.
fn root(f: &dyn Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let rising = f(b) > 0.0 || f(a) < 0.0;
    let [a, b] = bisect(|x| (f(x) > 0.0) == rising, a, b);
    0.5 * (a + b)
}
