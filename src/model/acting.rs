//! What acts in a scene at one state: dampers, drives with an efficiency, drag, bumpers, friction.
//!
//! In: a scene, the sizes of the given loads, the state. Out: the acceleration along the curve, the power lost, the sizes of
//! the loads that the state decides. Written once for values and for values with derivatives.
use super::panel::{Folded, Given};
use crate::drag::Meeting;
use crate::friction::{Band, Locked, Loop};
use crate::number::Number;
use crate::powers::Powers;
use crate::reduced::{Reduced, Row, Scene};

/// What is decided between steps, not within one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// Sign of sigma_dot for the drives with an efficiency; it holds until sigma_dot passes through 0.
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
    pub bands: Vec<Option<Band>>,
    /// Effects of sigma_dot^2 and of each of the scene's loads of unit size, row by row.
    effects: Vec<T>,
    /// Effects of all but friction, in each row.
    sums: Vec<T>,
    /// What arrived, then the sums, of the evaluation that was kept.
    kept: Vec<T>,
}

impl<T: Number> Acting<T> {
    /// Room for a scene.
    pub fn new(scene: Option<&Scene>) -> Self {
        let zero = T::constant(0.0);
        let (lossy, loads, pins, rows) =
            scene.map_or((0, 0, 0, 0), |s| (s.lossy.len(), s.loads.len(), s.pins.len(), s.rows.len()));
        Self {
            arriving: vec![zero; lossy],
            loads: vec![zero; loads],
            friction: Loop::new(pins),
            bands: vec![None; pins],
            effects: vec![zero; rows * (1 + loads)],
            sums: vec![zero; rows],
            kept: vec![zero; lossy + rows],
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
        let powers = Powers::new(folded.x(sigma));
        let at = |component: usize| powers.at(folded.series(&scene.table, component));
        let damping = reduced.components().damping;
        let stride = scene.stride();
        for (row, values) in self.effects.chunks_exact_mut(stride).enumerate() {
            powers.all(folded.block(&scene.table, scene.states(row)), values);
        }
        let mut lost = T::constant(0.0);
        // What the state decides, but for friction.
        for (k, &load) in scene.lossy.iter().enumerate() {
            let influence = at(scene.given(0, load));
            let size = given.size(load, t);
            let full = influence * size;
            let efficiency = reduced.loading().drives[load].efficiency.unwrap_or(1.0);
            let part = efficient(full.value(), mode.direction, efficiency);
            self.arriving[k] = size * T::constant(part);
            lost = lost + (full * T::constant(1.0 - part) - influence * given.excess(load, t)) * sigma_dot;
        }
        self.blow(reduced, scene, given.air(t), sigma_dot, &at);
        self.press(reduced, scene, folded, mode, sigma_dot, &at);
        let free = scene.loads.len() - scene.pins.len();
        let square = sigma_dot * sigma_dot;
        for row in 0..scene.rows.len() {
            let effects = &self.effects[row * stride..(row + 1) * stride];
            let mut sum = folded.at(row, &powers, t) + effects[0] * square;
            if let Some(k) = damping {
                let drag = at(scene.given(row, k)) * sigma_dot;
                sum = sum - drag;
                if row == 0 {
                    lost = lost + drag * sigma_dot;
                }
            }
            for (&load, &size) in scene.lossy.iter().zip(&self.arriving) {
                sum = sum + at(scene.given(row, load)) * size;
            }
            for (&effect, &size) in effects[1..].iter().zip(&self.loads[..free]) {
                sum = sum + effect * size;
                if row == 0 {
                    lost = lost - effect * size * sigma_dot;
                }
            }
            self.sums[row] = sum;
        }
        if folded.changes() {
            lost = lost - folded.excess(0, &powers, t) * sigma_dot;
        }
        let mut acceleration = self.sums[0];
        if !scene.pins.is_empty() {
            self.rub(scene, sigma_dot)?;
            for j in 0..scene.pins.len() {
                self.loads[free + j] = self.friction.friction(j);
                let share = self.effects[1 + free + j] * self.loads[free + j];
                acceleration = acceleration + share;
                lost = lost - share * sigma_dot;
            }
        }
        Ok(Effect { acceleration, lost })
    }

    /// Keep what was found last, to be mixed with what is found next.
    pub fn keep(&mut self) {
        let found = self.arriving.iter().chain(&self.sums);
        self.kept.iter_mut().zip(found).for_each(|(kept, found)| *kept = *found);
    }

    /// This share of what was found last, and the rest of what was kept: for drives that hold the mechanism at rest, where all
    /// is affine in what arrives of them.
    pub fn mix(&mut self, share: T) {
        let found = self.arriving.iter_mut().chain(&mut self.sums);
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
        let powers = Powers::new(folded.x(sigma));
        let at = |component: usize| powers.at(folded.series(&scene.table, component));
        let influence = at(scene.given(0, load));
        // What the load must give along the curve without friction, and what this share of it is.
        let bare = target - (self.sums[0] - influence * size);
        let n = scene.pins.len();
        let first = scene.loads.len() - n;
        if n == 0 {
            return Ok(bare);
        }
        if let Some(direction) = breakaway {
            for (j, pin) in scene.pins.iter().enumerate() {
                let slip = at(scene.column(0, first + j)).value() * direction;
                let arm = pin.law.static_coefficient * pin.radius;
                self.friction.arm[j] = T::constant(if slip < 0.0 { -arm } else { arm });
            }
        }
        let share = bare * influence.chain(1.0 / influence.value(), -1.0 / influence.value().powi(2));
        self.friction.clear();
        for (row, what) in scene.rows.iter().enumerate().skip(1) {
            let Row::Reaction { pin, part } = *what else { continue };
            let axis = part.axis();
            let of_load = at(scene.given(row, load));
            self.friction.free[pin][axis] = self.sums[row] + of_load * (share - size);
            let each = of_load * influence.chain(1.0 / influence.value(), -1.0 / influence.value().powi(2));
            for j in 0..n {
                let effect = at(scene.column(row, first + j)) - each * at(scene.column(0, first + j));
                self.friction.effect[pin * n + j][axis] = effect;
            }
        }
        self.friction.solve()?;
        let mut force = bare;
        for j in 0..n {
            force = force - at(scene.column(0, first + j)) * self.friction.friction(j);
        }
        Ok(force)
    }

    /// Drag of the air.
    fn blow(&mut self, reduced: &Reduced, scene: &Scene, airspeed: T, sigma_dot: T, at: &impl Fn(usize) -> T) {
        let Some(air) = reduced.loading().air.as_ref().filter(|_| scene.air) else { return };
        for (i, surface) in air.surfaces.iter().enumerate() {
            let rate = |k: usize| at(scene.column(0, 3 * i + k)) * sigma_dot;
            let mut wind = [air.flow.x, air.flow.y].map(|f| T::constant(f) * airspeed);
            let mut omega = T::constant(0.0);
            if air.relative_wind {
                wind = [wind[0] - rate(0), wind[1] - rate(1)];
                omega = rate(2);
            }
            let line = [at(scene.line(i)), at(scene.line(i) + 1)];
            let drag = surface.drag(air.density, &Meeting { wind, omega, line });
            self.loads[3 * i..3 * i + 3].copy_from_slice(&drag);
        }
    }

    /// Bumpers in contact push back.
    fn press(
        &mut self,
        reduced: &Reduced,
        scene: &Scene,
        folded: &Folded,
        mode: &Mode,
        sigma_dot: T,
        at: &impl Fn(usize) -> T,
    ) {
        let first = scene.loads.len() - scene.pins.len() - scene.bumpers.len();
        for (k, &stop) in scene.bumpers.iter().enumerate() {
            let touches = mode.touching.contains(&Some(k));
            self.loads[first + k] = if touches {
                let stop = &reduced.loading().stops[stop];
                let wound = folded.turns * reduced.load_growth(stop.load);
                let beyond = at(scene.pressed(k)) + T::constant(wound - stop.value);
                let rate = at(scene.column(0, first + k)) * sigma_dot;
                -(beyond * T::constant(stop.stiffness) + rate * T::constant(stop.damping))
            } else {
                T::constant(0.0)
            };
        }
    }

    /// Friction of all pins.
    fn rub(&mut self, scene: &Scene, sigma_dot: T) -> Result<(), Locked> {
        let (n, stride) = (scene.pins.len(), scene.stride());
        let first = stride - n;
        for (j, pin) in scene.pins.iter().enumerate() {
            let slip = self.effects[first + j] * sigma_dot * T::constant(pin.radius);
            let band = self.bands[j].unwrap_or_else(|| pin.law.band(slip.value()));
            self.friction.arm[j] = pin.law.signed(slip, band) * T::constant(pin.radius);
        }
        for (row, what) in scene.rows.iter().enumerate().skip(1) {
            let Row::Reaction { pin, part } = *what else { continue };
            let axis = part.axis();
            self.friction.free[pin][axis] = self.sums[row];
            let effects = &self.effects[row * stride + first..(row + 1) * stride];
            for (out, effect) in self.friction.effect[pin * n..(pin + 1) * n].iter_mut().zip(effects) {
                out[axis] = *effect;
            }
        }
        self.friction.solve()
    }
}

/// [CK16] eqs. (5), (29): what part of a drive's force `full` (times its influence) arrives when the motion has this
/// direction: eta where power flows in, 1/eta where it flows back.
fn efficient(full: f64, direction: f64, efficiency: f64) -> f64 {
    if full * direction > 0.0 { efficiency } else { 1.0 / efficiency }
}

#[cfg(test)]
mod tests;
