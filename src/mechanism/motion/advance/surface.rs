//! Sticking on a driven surface within an advance: friction holds a body there, so that both move at one speed.
//!
//! In: a state, an event of the slip speed. Out: the state on the surface, the regime that follows. It must not know
//! what moves.
use super::{Advance, Stopped};
use crate::integrator::System;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::MOTION;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::motion::witness::What;

/// Part of the speed along the curve, and of the length of the curve in 1 s, by which the speed with the surface may
/// differ at the event of the slip speed.
const SAME: f64 = 1e-7;

impl<'e, const N: usize> Advance<'_, 'e, N>
where
    EquationOfMotion<'e>: System<N>,
{
    /// The friction joint whose driven surface can hold its body; none in a motion with other states, for which nothing
    /// of it is compiled.
    #[inline(always)]
    pub(super) fn clinging(&self) -> Option<usize> {
        if N == MOTION { self.dynamics.deciding::<N>()?.clings } else { None }
    }

    /// Whether a surface holds its body follows from the state. No step extends beyond the span: what its interpolant
    /// has there is not exactly on the surface.
    #[cold]
    pub(super) fn settle_on_surface(&mut self, z: &mut [f64; N]) -> Result<(), Locked> {
        self.progress.may_pass = false;
        if self.dynamics.cling(z[0], z[1])? {
            self.keep_on_surface(z);
        }
        Ok(())
    }

    /// The rates of the speed of a surface that can hold its body are those of this span.
    #[inline(always)]
    pub(super) fn state_rates(&mut self) {
        if self.clinging().is_some()
            && let Some(surface) = self.dynamics.clinging().and_then(|(_, joint)| joint.surface)
        {
            let [_, first, second] = self.dynamics.applied.rates(surface);
            self.dynamics.scratch.set_surface([first, second]);
        }
    }

    /// A body that its surface holds has exactly the speed of that.
    #[cold]
    pub(super) fn keep_on_surface(&mut self, z: &mut [f64; N]) {
        self.dynamics.time = self.progress.t;
        if self.clinging().is_some_and(|joint| self.dynamics.is_held(joint))
            && let Some([slip, speed]) = self.dynamics.along_surface(z[0])
        {
            z[1] = speed / slip;
        }
    }

    /// A body that its surface holds turns back with it: at the time at which the speed of the surface is 0 to
    /// rounding, so that the body is on the surface then too.
    #[cold]
    pub(super) fn turn_with_surface(&mut self, z: &[f64; N]) {
        let is_held = self.clinging().is_some_and(|joint| self.dynamics.is_held(joint));
        for _ in 0..2 {
            let t = self.progress.t;
            self.dynamics.time = t;
            let [first, second] = self.dynamics.scratch.evaluator.surface.rates;
            if let Some([_, speed]) = self.dynamics.along_surface(z[0]).filter(|_| is_held) {
                let later = t - speed / (first + second * t);
                self.progress.t = if later.is_finite() && later >= 0.0 { later } else { t };
            }
        }
        self.dynamics.time = self.progress.t;
    }

    /// Whether the slip speed of a joint passes 0 on a surface that can hold its body, or such a body starts to slip,
    /// and then what follows.
    #[cold]
    pub(super) fn turn_on_surface(&mut self, joint: usize, z: &mut [f64; N]) -> Result<bool, Stopped> {
        self.dynamics.time = self.progress.t;
        let Some((own, law)) = self.dynamics.clinging().map(|(own, joint)| (own, joint.law)) else { return Ok(false) };
        if own != joint {
            return Ok(false);
        }
        if self.dynamics.is_held(joint) {
            let [forward, back] = self.dynamics.beyond_hold(joint, [z[0], z[1]])?;
            let towards = if forward > back { -1.0 } else { 1.0 };
            self.dynamics.set_regime(joint, Some(law.regime_towards(0.0, towards)));
            self.tell(What::Slips { joint });
        } else {
            let regime = self.dynamics.regime(joint);
            let slip = self.dynamics.slip(joint, z[0], z[1]);
            let next = law.next(regime, slip);
            if next.sign() == regime.sign() {
                return Ok(false);
            }
            let at_speed = self.dynamics.along_surface(z[0]).map_or(z[1], |[slip, speed]| speed / slip);
            // At a dead centre of the slip, a mechanism that moves has no slip on a surface at rest.
            let near = SAME * (z[1].abs() + self.dynamics.reduced.scale());
            if (at_speed - z[1]).abs() <= near && self.dynamics.cling(z[0], at_speed)? {
                z[1] = at_speed;
                self.tell(What::Clings { joint });
            } else {
                self.dynamics.set_regime(joint, Some(next));
            }
        }
        self.progress.work.regimes += 1;
        self.integrator.restart();
        if self.dynamics.state_loads.is_some_and(|own| own.switches() > 0) {
            self.dynamics.find_signs(self.progress.t, z)?;
        }
        if self.pauses() { Err(Stopped::Event(self.progress)) } else { Ok(true) }
    }
}
