//! Static equilibria: positions on the travel where all loads that act at rest balance each other.
//!
//! In: a reduced model, inputs, the travel between its stops. Out: the equilibria, stable or not, with stiffness and
//! damping of small motions about them. Friction and the losses of drives hold a mechanism beside an equilibrium too;
//! they move none. It must not know how a definition states the start.
use super::acting::{airspeed, blows_under, state_loads};
use super::contact::{Place, Travel};
use super::samples::positions;
use super::travel::pressed_bumpers;
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::dynamics::state_loads::Evaluation;
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::resolved::DriveLaw;
use crate::mechanism::reduced::Reduced;
use crate::numerics::bracket::bisect;
use crate::numerics::order;

/// Most whole revolutions on each side of the start in which a mechanism with a wound spring is searched.
const REVOLUTIONS: usize = 64;
/// Most stretches of an open curve on each side of the start that are searched, each eight times as long as the one
/// before.
const STRETCHES: usize = 4;

/// A position in which the mechanism stays at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium {
    /// sigma, counted on over whole revolutions [kg^(1/2) m].
    pub position: f64,
    /// Rigid stop against which the loads press the mechanism; none where they are in balance.
    pub place: Option<Place>,
    /// Whether the mechanism comes back after a small push.
    pub is_stable: bool,
    /// -d sigma_ddot / d sigma, the square of the angular eigenfrequency [1/s^2].
    pub stiffness: f64,
    /// -d sigma_ddot / d sigma_dot [1/s].
    pub damping: f64,
}

/// Why no stable equilibrium was found.
#[derive(Clone, Debug, PartialEq)]
pub enum NoEquilibrium {
    /// No load acts anywhere on the travel.
    Neutral,
    /// The loads move the mechanism on wherever it is.
    None,
}

/// The loads at rest, bumpers among them, without friction and losses of drives, as a function of sigma counted on over
/// whole revolutions.
pub struct AtRest<'a> {
    reduced: &'a Reduced,
    travel: &'a Travel,
    /// Version of the inputs with these sizes and airspeed.
    version: u64,
    sizes: Vec<f64>,
    airspeed: f64,
    air: bool,
    scratch: Scratch,
}

/// Whether the force of a spring or of a controlled drive changes with each revolution of a closed curve.
fn winds(reduced: &Reduced) -> bool {
    let mut drives = reduced.loading().drives.iter().enumerate().filter(|(_, drive)| {
        let control = drive.law.as_ref().and_then(DriveLaw::control);
        control.is_some_and(|control| control.position_gain.is_some())
    });
    reduced.components().winding.is_some() || drives.any(|(load, _)| reduced.load_growth(load) != 0.0)
}

impl<'a> AtRest<'a> {
    /// Under these inputs, from a position on, with the bumpers of this travel.
    ///
    /// # Errors
    /// [`ModelError::Table`]: a reaction that causes friction is not smooth.
    pub fn new(reduced: &'a Reduced, travel: &'a Travel, inputs: &Inputs, position: f64) -> Result<Self, ModelError> {
        let (sigma, revolutions) = reduced.unwound(position);
        let air = blows_under(reduced, inputs);
        let scratch = Scratch::new(state_loads(reduced.at(sigma), air, revolutions)?);
        let (sizes, airspeed) = (reduced.sizes(&inputs.reals), airspeed(reduced, inputs));
        Ok(Self { reduced, travel, version: inputs.version(), sizes, airspeed, air, scratch })
    }

    /// sigma_ddot and its derivatives along sigma and sigma_dot; not a number where friction has no solution.
    pub fn gradient(&mut self, position: f64) -> [f64; 3] {
        let (sigma, revolutions) = self.reduced.unwound(position);
        let (whole, reduced) = (self.reduced, self.reduced.at(sigma));
        let Ok(state_loads) = reduced.state_loads(self.air) else { return [f64::NAN; 3] };
        let (version, sizes, airspeed) = (self.version, &self.sizes, self.airspeed);
        let applied = AppliedLoads { version, sizes, airspeed, revolutions, change: None };
        let mut equation = EquationOfMotion::new(whole, (reduced, state_loads), applied, &mut self.scratch);
        equation.mode.touching = pressed_bumpers(whole, self.travel, position, 0.0);
        match equation.tangent(sigma, 0.0) {
            Ok([Evaluation { acceleration: a, .. }, by_speed]) => [a.value, a.slope[0], by_speed.acceleration.slope[0]],
            Err(_) => [f64::NAN; 3],
        }
    }

    /// Equilibria between two positions, ascending. Those at the ends are left to [`Self::pressed`].
    pub fn between(&mut self, ends: [f64; 2]) -> Vec<Equilibrium> {
        let mut samples: Vec<(f64, f64)> = Vec::new();
        let mut last: Option<(f64, [f64; 3])> = None;
        let mut all = positions(self.reduced, ends);
        // The force of a bumper begins with a kink.
        let begins = self.travel.bumpers.iter().flat_map(|bumper| bumper.positions).flatten();
        all.extend(begins.filter(|at| (ends[0]..=ends[1]).contains(at)));
        order::sort(&mut all);
        for position in all {
            let here = self.gradient(position);
            if let Some((before, [a, slope, _])) = last {
                // Where the acceleration turns between two samples, it may pass through 0 twice.
                let turns = slope * here[1] < 0.0 && a * here[0] > 0.0 && a * slope < 0.0;
                if turns {
                    let falls = slope < 0.0;
                    let [low, high] = bisect(|at| (self.gradient(at)[1] > 0.0) == falls, before, position);
                    let turn = 0.5 * (low + high);
                    samples.push((turn, self.gradient(turn)[0]));
                }
            }
            samples.push((position, here[0]));
            last = Some((position, here));
        }
        self.zeros(&samples)
    }

    /// Equilibria between samples of the acceleration whose signs differ; samples of exactly 0 between them tell where.
    fn zeros(&mut self, samples: &[(f64, f64)]) -> Vec<Equilibrium> {
        let mut found = Vec::new();
        let mut signed = samples.iter().enumerate().filter(|(_, (_, a))| *a != 0.0);
        let Some(mut before) = signed.next() else { return found };
        for next in signed {
            let ((i, &(low, a)), (k, &(high, b))) = (before, next);
            before = next;
            if a.is_nan() || b.is_nan() || a * b > 0.0 {
                continue;
            }
            let position = if k > i + 1 {
                samples[usize::midpoint(i, k)].0
            } else {
                let [low, high] = bisect(|at| (self.gradient(at)[0] < 0.0) == (b < 0.0), low, high);
                0.5 * (low + high)
            };
            let [_, slope, by_speed] = self.gradient(position);
            let is_stable = a > 0.0;
            found.push(Equilibrium { position, place: None, is_stable, stiffness: -slope, damping: -by_speed });
        }
        found
    }

    /// The equilibrium at a rigid stop, if the loads press the mechanism against it.
    pub fn pressed(&mut self, place: Place, position: f64) -> Option<Equilibrium> {
        let [a, slope, by_speed] = self.gradient(position);
        let stable =
            Equilibrium { position, place: Some(place), is_stable: true, stiffness: -slope, damping: -by_speed };
        (a * place.outward() > 0.0).then_some(stable)
    }

    /// The stable equilibrium nearest to a position on the travel.
    ///
    /// # Errors
    /// Why there is none.
    pub fn nearest(&mut self, here: f64) -> Result<Equilibrium, NoEquilibrium> {
        let reduced = self.reduced;
        let limits = [0, 1].map(|side| self.travel.end(side));
        let winds = winds(reduced);
        let most = match reduced.period() {
            Some(_) if winds => REVOLUTIONS,
            Some(_) => 1,
            None => STRETCHES,
        };
        let mut is_neutral = true;
        for ring in 0..most {
            let windows = [0, 1].map(|side| window(reduced, here, side, ring, limits[side]));
            let mut all: Vec<Equilibrium> = match windows {
                // Around the start in one piece, so that it may be the equilibrium.
                [Some([low, _]), Some([_, high])] if ring == 0 => self.between([low, high]),
                _ => windows.into_iter().flatten().flat_map(|ends| self.between(ends)).collect(),
            };
            all.retain(|found| found.is_stable);
            for (side, at) in limits.into_iter().enumerate().filter_map(|(side, limit)| Some((side, limit?))) {
                if windows[side].is_none_or(|ends| ends[side] == at) {
                    all.extend(self.pressed(Place::rigid(side), at));
                }
            }
            let distance = |found: &Equilibrium| (found.position - here).abs();
            if let Some(found) = all.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))) {
                return Ok(found);
            }
            is_neutral &= windows.iter().flatten().flatten().all(|at| self.gradient(*at)[0] == 0.0);
        }
        Err(if is_neutral { NoEquilibrium::Neutral } else { NoEquilibrium::None })
    }
}

/// The part of the travel on a side of a position that is searched in the ring with this number: a revolution of a
/// closed curve, a stretch of an open one, up to the limit.
fn window(reduced: &Reduced, here: f64, side: usize, ring: usize, limit: Option<f64>) -> Option<[f64; 2]> {
    let [mut low, mut high] = match reduced.period() {
        Some(period) => {
            let [near, far] = [ring, ring + 1].map(|count| count as f64 * period);
            if side == 0 { [here - far, here - near] } else { [here + near, here + far] }
        }
        None => {
            let mut stretch = reduced.at(here);
            for _ in 0..ring {
                stretch = reduced.next(stretch, side).ok()?;
            }
            let (first, last) = stretch.curve().range;
            match (ring, side) {
                (0, 0) => [first, here],
                (0, _) => [here, last],
                _ => [first, last],
            }
        }
    };
    match (side, limit) {
        (0, Some(limit)) => low = low.max(limit),
        (_, Some(limit)) => high = high.min(limit),
        _ => {}
    }
    (low < high).then_some([low, high])
}
