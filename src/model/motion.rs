//! The motion along the curve: the right-hand side of the reduced model under constant inputs.
//!
//! sigma_ddot = sum of sizes times influences, because the reduced inertia is 1 and its derivative 0. On one panel this
//! is one polynomial: the sizes are folded into its coefficients when the panel is entered. What a state decides - friction,
//! drag, bumpers, dampers, efficiencies - is in the scene; a mechanism without them does not pay for them.
use super::acting::{Acting, Effect, Mode};
use super::panel::{Folded, Given, series_at};
use crate::friction::Locked;
use crate::integrator::System;
use crate::number::{Dual, Number};
use crate::reduced::{Reduced, Scene};
use crate::table::polynomial;

/// Room for the evaluation of one motion, with what it found last.
#[derive(Clone, Debug)]
pub struct Work {
    /// Right-hand side where it was used last.
    pub folded: Folded,
    /// What acts.
    pub acting: Acting<f64>,
    /// What acts, with derivatives along sigma and sigma_dot.
    tangent: Acting<Dual<2>>,
}

impl Work {
    /// For a scene, or none.
    pub fn new(scene: Option<&Scene>) -> Self {
        Self { folded: Folded::new(scene), acting: Acting::new(scene), tangent: Acting::new(scene) }
    }
}

/// The motion for one span of constant inputs.
pub struct Motion<'a> {
    /// Tables.
    pub reduced: &'a Reduced,
    /// What acts besides the loads of given sizes.
    pub scene: Option<&'a Scene>,
    /// Their sizes.
    pub given: Given<'a>,
    /// What is decided between steps.
    pub mode: Mode,
    /// Room.
    pub work: &'a mut Work,
    /// Whether friction had no solution somewhere.
    pub locked: bool,
}

impl Motion<'_> {
    fn place(&mut self, sigma: f64) -> f64 {
        self.work.folded.place(self.reduced, self.scene, &self.given, sigma)
    }

    /// Acceleration and power lost, for a motion in the mode's direction.
    ///
    /// # Errors
    /// [`Locked`].
    pub fn effect(&mut self, sigma: f64, sigma_dot: f64) -> Result<Effect<f64>, Locked> {
        let x = self.place(sigma);
        let Work { folded, acting, .. } = &mut *self.work;
        match self.scene {
            None => Ok(Effect { acceleration: polynomial(&folded.force, x), lost: 0.0 }),
            Some(scene) => acting.evaluate((self.reduced, scene), &self.given, folded, &self.mode, [sigma, sigma_dot]),
        }
    }

    /// [`Self::effect`] with its derivatives along sigma and sigma_dot.
    ///
    /// # Errors
    /// [`Locked`].
    pub fn tangent(&mut self, sigma: f64, sigma_dot: f64) -> Result<Effect<Dual<2>>, Locked> {
        self.place(sigma);
        let y = [Dual::variable(sigma, 0), Dual::variable(sigma_dot, 1)];
        let Work { folded, tangent, .. } = &mut *self.work;
        match self.scene {
            None => Ok(Effect { acceleration: series_at(&folded.force, folded.x(y[0])), lost: Dual::constant(0.0) }),
            Some(scene) => tangent.evaluate((self.reduced, scene), &self.given, folded, &self.mode, y),
        }
    }

    /// Whether a drive has an efficiency, so that the right-hand side jumps where sigma_dot changes its sign.
    pub fn reverses(&self) -> bool {
        self.scene.is_some_and(|s| !s.lossy.is_empty())
    }

    /// Direction in which a mechanism at rest sets off: 0 if its drives hold it ([CK16] 2.3: driven forward they give
    /// less, driven back they hold more). Of a mechanism that moves, its direction.
    ///
    /// # Errors
    /// [`Locked`].
    pub fn direction(&mut self, sigma: f64, sigma_dot: f64) -> Result<f64, Locked> {
        if sigma_dot != 0.0 {
            return Ok(sigma_dot.signum());
        }
        for direction in [1.0, -1.0] {
            self.mode.direction = direction;
            if self.effect(sigma, 0.0)?.acceleration * direction > 0.0 {
                return Ok(direction);
            }
        }
        Ok(0.0)
    }

    /// Acceleration at any state, with what arrives of every load. Where drives hold the mechanism at rest, each lets arrive
    /// something between its forward and its backward value: the common share at which all is in balance.
    ///
    /// # Errors
    /// [`Locked`].
    pub fn settle(&mut self, sigma: f64, sigma_dot: f64) -> Result<f64, Locked> {
        if !self.reverses() {
            return Ok(self.effect(sigma, sigma_dot)?.acceleration);
        }
        self.mode.direction = self.direction(sigma, sigma_dot)?;
        if self.mode.direction != 0.0 {
            return Ok(self.effect(sigma, sigma_dot)?.acceleration);
        }
        self.mode.direction = -1.0;
        let back = self.effect(sigma, 0.0)?.acceleration;
        let held = self.work.acting.arriving.clone();
        self.mode.direction = 1.0;
        let forward = self.effect(sigma, 0.0)?.acceleration;
        let share = if back > forward { back / (back - forward) } else { 1.0 };
        for (arriving, back) in self.work.acting.arriving.iter_mut().zip(held) {
            *arriving = share * *arriving + (1.0 - share) * back;
        }
        Ok(0.0)
    }

    /// How far the load of a bumper is beyond its stop, and the push of the bumper if it is in contact.
    pub fn pressure(&mut self, bumper: usize, sigma: f64, sigma_dot: f64) -> (f64, f64) {
        let x = self.place(sigma);
        let Some(scene) = self.scene else { return (0.0, 0.0) };
        let (folded, loading) = (&self.work.folded, self.reduced.loading());
        let at = |component: usize| polynomial(scene.table.series(folded.panel, component), x);
        let stop = &loading.stops[scene.bumpers[bumper]];
        let s = at(scene.pressed(bumper)) + folded.turns * self.reduced.load_growth(stop.load);
        let first = scene.loads.len() - scene.pins.len() - scene.bumpers.len();
        let rate = at(scene.column(0, first + bumper)) * sigma_dot;
        let beyond = stop.beyond(s);
        let outward = if stop.beyond(1.0) > stop.beyond(0.0) { rate } else { -rate };
        (beyond, stop.stiffness * beyond + stop.damping * outward)
    }

    /// sigma to its length; sigma_dot to itself, or to the speed that the present force gives over that length.
    fn scales(&self, sigma_dot: f64, acceleration: f64) -> (f64, f64) {
        let length = self.reduced.scale();
        let fallen = (acceleration.abs() * length).sqrt();
        (length, sigma_dot.abs().max(fallen).max(1e-12 * length))
    }
}

/// No loss of power: (sigma, sigma_dot).
impl System<2> for Motion<'_> {
    fn derivative(&mut self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        let x = self.place(y[0]);
        [y[1], polynomial(&self.work.folded.force, x)]
    }

    fn scale(&self, y: &[f64; 2], f: &[f64; 2]) -> [f64; 2] {
        let (length, speed) = self.scales(y[1], f[1]);
        [length, speed]
    }
}

/// With a scene: (sigma, sigma_dot, energy lost).
impl System<3> for Motion<'_> {
    fn derivative(&mut self, _t: f64, y: &[f64; 3]) -> [f64; 3] {
        match self.effect(y[0], y[1]) {
            Ok(effect) => [y[1], effect.acceleration, effect.lost],
            // The step is refused and tried again shorter; if none is short enough, this is told as the reason.
            Err(Locked) => {
                self.locked = true;
                [f64::NAN; 3]
            }
        }
    }

    fn scale(&self, y: &[f64; 3], f: &[f64; 3]) -> [f64; 3] {
        let (length, speed) = self.scales(y[1], f[1]);
        [length, speed, speed * speed]
    }
}
