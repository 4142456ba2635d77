//! What acts in a scene at one state: dampers, drives with an efficiency, drag, bumpers, friction.
//!
//! In: a scene, the sizes of the given loads, the state. Out: the acceleration along the curve, the power lost, the sizes of
//! the loads that the state decides. Written once for values and for values with derivatives.
use crate::mechanism::dynamics::panel_force::{Folded, Given};
use crate::mechanism::loads::laws::drag::Meeting;
use crate::mechanism::loads::laws::friction::{Balance, Band, Cubic, Locked, Loop};
use crate::mechanism::reduced::{Reduced, Scene};
use crate::numerics::dual::Number;
use crate::numerics::table::{Bundle, ROW, polynomial_at, side_by_side_at};

/// What is decided between steps, not within one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// Sign of sigma_dot for the drives with an efficiency; it holds until sigma_dot passes through 0. With 0 all that
    /// they are told arrives.
    pub direction: f64,
    /// Bumper, by its place in the scene, that is in contact at the low and at the high end of the travel.
    pub touching: [Option<usize>; 2],
}

/// Result of an evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect<T> {
    /// sigma_ddot.
    pub acceleration: T,
    /// Power that leaves the mechanism beyond the work of the given loads [W].
    pub lost: T,
}

/// Room for an evaluation, with what it found last.
#[derive(Clone, Debug)]
pub struct Acting<T> {
    /// What arrives of the drives with an efficiency, in the scene's order.
    pub arriving: Vec<T>,
    /// Sizes of the scene's loads.
    pub loads: Vec<T>,
    /// Reactions and friction.
    pub friction: Loop<T>,
    /// Stretch of its law in which each pin is taken to be; where none is stated, that of its slip speed.
    bands: Vec<Option<Band>>,
    /// Arm of each pin's friction on its stretch.
    arms: Vec<Cubic>,
    /// The scene's bundle.
    effects: Vec<[T; ROW]>,
    /// Effect of all but friction on the motion.
    motion: T,
    /// The same on the components of the pins' reactions.
    reactions: Vec<[T; ROW]>,
    /// What arrived, then the effects on the motion and on the reactions, of the evaluation that was kept.
    kept: Vec<T>,
    /// Room for the pins' reactions without friction, then those to sigma_ddot.
    room: Vec<T>,
}

impl<T: Number> Acting<T> {
    /// Room for a scene.
    pub fn new(scene: Option<&Scene>) -> Self {
        let zero = T::constant(0.0);
        let (lossy, loads, pins) = scene.map_or((0, 0, 0), |s| (s.lossy.len(), s.loads.len(), s.pins.len()));
        let groups = scene.and_then(|s| s.groups.iter().max()).map_or(0, |last| last + 1);
        let reactions = Bundle::rows(2 * pins);
        Self {
            arriving: vec![zero; lossy],
            loads: vec![zero; loads],
            friction: Loop::new(pins, groups),
            bands: vec![None; pins],
            arms: vec![Cubic::default(); pins],
            effects: vec![[zero; ROW]; scene.map_or(0, |s| Bundle::rows(s.bundled()))],
            motion: zero,
            reactions: vec![[zero; ROW]; reactions],
            kept: vec![zero; lossy + 1 + ROW * reactions],
            room: vec![zero; 4 * pins],
        }
    }

    /// Stretch of its law in which a pin is taken to be, if one is stated.
    pub fn band(&self, pin: usize) -> Option<Band> {
        self.bands[pin]
    }

    /// State the stretch of its law in which a pin is, until told otherwise; with none, its slip speed tells.
    pub fn set_band(&mut self, scene: &Scene, pin: usize, band: Option<Band>) {
        self.bands[pin] = band;
        if let Some(band) = band {
            self.arms[pin] = scene.pins[pin].arm(band);
        }
    }

    /// Evaluate at a time t of the step and a state; `folded` holds at sigma. Of the work of sizes that change with time, that
    /// of their excess over the sizes at t = 0 counts as gained: the energy balance has the potential of these alone.
    ///
    /// # Errors
    /// [`Locked`]: friction and reactions have no common solution.
    pub fn evaluate(
        &mut self,
        (reduced, scene): (&Reduced, &Scene),
        given: &Given,
        folded: &Folded,
        mode: &Mode,
        [t, sigma, sigma_dot]: [T; 3],
    ) -> Result<Effect<T>, Locked> {
        let x = folded.x(sigma);
        let at = |component: usize| polynomial_at(folded.series(&scene.table, component), x);
        let damping = reduced.components().damping;
        side_by_side_at(folded.bundle(&scene.bundle), x, &mut self.effects);
        side_by_side_at(&folded.reactions, x, &mut self.reactions);
        self.motion = folded.at(x, t);
        let (free, n) = (scene.free(), scene.pins.len());
        let mut lost = T::constant(0.0);
        // What the state decides, but for friction.
        for (k, &load) in scene.lossy.iter().enumerate() {
            let influence = at(scene.given(0, load));
            let size = given.size(load, t);
            let full = influence * size;
            let efficiency = reduced.loading().drives[load].efficiency.unwrap_or(1.0);
            let part = efficient(full.value(), mode.direction, efficiency);
            self.arriving[k] = size * T::constant(part);
            self.motion = self.motion + influence * self.arriving[k];
            lost = lost + (full * T::constant(1.0 - part) - influence * given.excess(load, t)) * sigma_dot;
        }
        self.blow(reduced, scene, given.air(t), sigma_dot);
        self.press(reduced, scene, folded, mode, sigma_dot);
        for (&effect, &size) in self.effects.as_flattened().iter().zip(&self.loads[..free]) {
            self.motion = self.motion + effect * size;
            lost = lost - effect * size * sigma_dot;
        }
        if let Some(k) = damping {
            let drag = at(scene.given(0, k)) * sigma_dot;
            self.motion = self.motion - drag;
            lost = lost + drag * sigma_dot;
        }
        if folded.changes() {
            lost = lost - folded.excess(0, x, t) * sigma_dot;
        }
        let mut acceleration = self.motion;
        if n > 0 {
            let effects = self.effects.as_flattened();
            let reactions = &mut self.reactions.as_flattened_mut()[..2 * n];
            let square = sigma_dot * sigma_dot;
            for (sum, effect) in reactions.iter_mut().zip(&effects[scene.square()]) {
                *sum = *sum + *effect * square;
            }
            for (load, &size) in self.loads[..free].iter().enumerate() {
                for (sum, effect) in reactions.iter_mut().zip(&effects[scene.caused(load)]) {
                    *sum = *sum + *effect * size;
                }
            }
            if damping.is_some() || !scene.lossy.is_empty() || folded.changes() {
                for (k, sum) in reactions.iter_mut().enumerate() {
                    *sum = *sum + folded.excess(k + 1, x, t);
                    if let Some(damping) = damping {
                        *sum = *sum - at(scene.given(k + 1, damping)) * sigma_dot;
                    }
                    for (&load, &size) in scene.lossy.iter().zip(&self.arriving) {
                        *sum = *sum + at(scene.given(k + 1, load)) * size;
                    }
                }
            }
            self.rub(scene, sigma_dot)?;
            let influences = self.effects.as_flattened()[..scene.loads.len()].iter();
            for (j, (load, &influence)) in self.loads.iter_mut().zip(influences).skip(free).enumerate() {
                *load = self.friction.friction(j);
                let share = influence * *load;
                acceleration = acceleration + share;
                lost = lost - share * sigma_dot;
            }
        }
        Ok(Effect { acceleration, lost })
    }

    /// Keep what was found last, to be mixed with what is found next.
    pub fn keep(&mut self) {
        let found = self.arriving.iter().chain([&self.motion]).chain(self.reactions.as_flattened());
        self.kept.iter_mut().zip(found).for_each(|(kept, found)| *kept = *found);
    }

    /// This share of what was found last, and the rest of what was kept: for drives that hold the mechanism at rest, where all
    /// is affine in what arrives of them.
    pub fn mix(&mut self, share: T) {
        let found = self.arriving.iter_mut().chain([&mut self.motion]).chain(self.reactions.as_flattened_mut());
        for (found, kept) in found.zip(&self.kept) {
            *found = share * *found + (T::constant(1.0) - share) * *kept;
        }
    }

    /// Force along the curve of a sized load, not subject to friction itself, with which sigma_ddot is `target` in the state
    /// of the last evaluation: inverse dynamics with friction as the loop of its own. `size` is the load's present size.
    /// With `breakaway`, every pin has its static friction against a motion in that direction.
    ///
    /// # Errors
    /// [`Locked`].
    pub fn required(
        &mut self,
        scene: &Scene,
        folded: &Folded,
        sigma: T,
        (load, size): (usize, T),
        target: T,
        breakaway: Option<f64>,
    ) -> Result<T, Locked> {
        let x = folded.x(sigma);
        let at = |component: usize| polynomial_at(folded.series(&scene.table, component), x);
        let influence = at(scene.given(0, load));
        // What the load must give along the curve without friction, and what this share of it is.
        let bare = target - (self.motion - influence * size);
        let (free, n) = (scene.free(), scene.pins.len());
        if n == 0 {
            return Ok(bare);
        }
        let effects = self.effects.as_flattened();
        if let Some(direction) = breakaway {
            for (j, pin) in scene.pins.iter().enumerate() {
                let slip = effects[free + j].value() * direction;
                let arm = pin.law.static_coefficient * pin.radius;
                self.friction.arm[j] = T::constant(if slip < 0.0 { -arm } else { arm });
            }
        }
        // With this load the motion stays what it is, whatever the friction: reactions to it take the place of inertia.
        let inverse = influence.chain(1.0 / influence.value(), -1.0 / influence.value().powi(2));
        let (reactions, inertial) = self.room.split_at_mut(2 * n);
        for (k, (effect, reaction)) in effects[scene.inertial()].iter().zip(self.reactions.as_flattened()).enumerate() {
            let of_load = at(scene.given(k + 1, load));
            inertial[k] = *effect - of_load * inverse;
            reactions[k] = *reaction + of_load * (bare * inverse - size);
        }
        let balance = balance(scene, effects, reactions, inertial);
        self.friction.solve(&balance)?;
        let mut force = bare;
        for j in 0..n {
            force = force - effects[free + j] * self.friction.friction(j);
        }
        Ok(force)
    }

    /// Drag of the air.
    fn blow(&mut self, reduced: &Reduced, scene: &Scene, airspeed: T, sigma_dot: T) {
        let Some(air) = reduced.loading().air.as_ref().filter(|_| scene.air) else { return };
        for (i, surface) in air.surfaces.iter().enumerate() {
            let effects = self.effects.as_flattened();
            let rate = |k: usize| effects[3 * i + k] * sigma_dot;
            let mut wind = [air.flow.x, air.flow.y].map(|f| T::constant(f) * airspeed);
            let mut omega = T::constant(0.0);
            if air.relative_wind {
                wind = [wind[0] - rate(0), wind[1] - rate(1)];
                omega = rate(2);
            }
            let line = [effects[scene.line(i)], effects[scene.line(i) + 1]];
            let drag = surface.drag(air.density, &Meeting { wind, omega, line });
            self.loads[3 * i..3 * i + 3].copy_from_slice(&drag);
        }
    }

    /// Bumpers in contact push back.
    fn press(&mut self, reduced: &Reduced, scene: &Scene, folded: &Folded, mode: &Mode, sigma_dot: T) {
        let effects = self.effects.as_flattened();
        let first = scene.free() - scene.bumpers.len();
        for (k, &stop) in scene.bumpers.iter().enumerate() {
            let touches = mode.touching.contains(&Some(k));
            self.loads[first + k] = if touches {
                let stop = &reduced.loading().stops[stop];
                let wound = folded.turns * reduced.load_growth(stop.load);
                let beyond = effects[scene.pressed(k)] + T::constant(wound - stop.value);
                let rate = effects[first + k] * sigma_dot;
                -(beyond * T::constant(stop.stiffness) + rate * T::constant(stop.damping))
            } else {
                T::constant(0.0)
            };
        }
    }

    /// Friction of all pins.
    fn rub(&mut self, scene: &Scene, sigma_dot: T) -> Result<(), Locked> {
        let effects = self.effects.as_flattened();
        let slips = &effects[scene.free()..scene.loads.len()];
        for (j, (pin, slip)) in scene.pins.iter().zip(slips).enumerate() {
            let v = *slip * sigma_dot * T::constant(pin.radius);
            if self.bands[j].is_none() {
                self.arms[j] = pin.arm(pin.law.band(v.value()));
            }
            self.friction.arm[j] = self.arms[j].at(v);
        }
        let reactions = self.reactions.as_flattened();
        self.friction.solve(&balance(scene, effects, reactions, &effects[scene.inertial()]))
    }
}

/// The pins' reactions without friction, and what friction and sigma_ddot do to them.
#[inline]
fn balance<'a, T>(scene: &'a Scene, effects: &'a [T], reactions: &'a [T], inertial: &'a [T]) -> Balance<'a, T> {
    let n = scene.pins.len();
    let passed = &effects[scene.passed()];
    let half = |both: &'a [T], n: usize| {
        let (x, y) = both.split_at(n);
        [x, y]
    };
    Balance {
        free: half(&reactions[..2 * n], n),
        inertial: half(inertial, n),
        influence: &effects[scene.free()..scene.loads.len()],
        passed: half(passed, passed.len() / 2),
        groups: &scene.groups,
    }
}

/// [CK16] eqs. (5), (29): what part of a drive's force `full` (times its influence) arrives when the motion has this
/// direction: eta where power flows in, 1/eta where it flows back; all of it without a direction, as no power flows.
fn efficient(full: f64, direction: f64, efficiency: f64) -> f64 {
    if direction == 0.0 {
        1.0
    } else if full * direction > 0.0 {
        efficiency
    } else {
        1.0 / efficiency
    }
}

#[cfg(test)]
mod tests;
