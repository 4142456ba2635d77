//! Rest within an advance: how long a stop, a lock or the drives hold the mechanism.
//!
//! In: a mechanism at rest, inputs that may change with time. Out: the time at which it sets off. It must not know what
//! moves.
use super::{Advance, Instant};
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::motion::contact::Place;
use crate::mechanism::motion::dynamics::Dynamics;
use crate::numerics::passage::first_rise_of_quartic;

impl<D: Dynamics<N>, const N: usize> Advance<'_, D, N> {
    /// At rest at a place: held by a lock, or by a rigid stop until the loads no longer press the mechanism against it.
    #[inline(always)]
    pub(super) fn rest(&mut self, place: Place, sigma: f64, span: f64) -> Result<Instant, Locked> {
        if self.contact.is_latched() {
            return Ok(Instant::Held);
        }
        if self.is_pressed(place, sigma)? {
            let inward = -place.outward();
            if !self.wait_until(sigma, span, [inward; 2])? {
                return Ok(Instant::Held);
            }
        }
        self.contact.released();
        self.jumped();
        // Of two stops at one place, what one lets go the other may hold.
        for other in self.ends.at(sigma).filter(|other| *other != place) {
            if self.ends.is_locked(other) || self.is_pressed(other, sigma)? {
                self.contact.rests(other, self.ends.is_locked(other));
                break;
            }
        }
        Ok(Instant::Changed)
    }

    /// Held at rest by drives with an efficiency, until the loads overcome them in one direction.
    #[inline(always)]
    pub(super) fn wait_for_drives(&mut self, sigma: f64, span: f64) -> Result<Instant, Locked> {
        if !self.wait_until(sigma, span, [1.0, -1.0])? {
            return Ok(Instant::Held);
        }
        self.jumped();
        Ok(Instant::Changed)
    }

    /// Go on in time, at rest, to where the mechanism sets off in one of these directions under inputs that change with
    /// time; false if it does not before the end of the span.
    ///
    /// At rest there is no friction, and the acceleration is a parabola in time for either direction of the drives, or
    /// a quartic in air of changing speed, as long as no drive's force and no airspeed changes its sign. So it is
    /// searched piece by piece, and none is too short to be found.
    #[inline(always)]
    fn wait_until(&mut self, sigma: f64, span: f64, directions: [f64; 2]) -> Result<bool, Locked> {
        const CLOSE: f64 = 1e-15;
        if !self.dynamics.inputs_change() {
            return Ok(false);
        }
        let from = self.progress.t;
        let mut a = from;
        while a < span {
            let b = self.next_switch(a, span);
            let mut first = None;
            for direction in if directions[0] == directions[1] { &directions[..1] } else { &directions[..] } {
                let dynamics = &mut *self.dynamics;
                let excess = |t: f64| {
                    dynamics.set_time(t);
                    Ok(dynamics.acceleration_from_rest(sigma, *direction)? * direction)
                };
                let rise = first_rise_of_quartic(excess, [a, b], CLOSE * (span - from))?;
                first = [first, rise].into_iter().flatten().reduce(f64::min);
            }
            if let Some(t) = first {
                self.progress.t = t;
                self.dynamics.set_time(t);
                return Ok(t < span);
            }
            a = b;
        }
        Ok(false)
    }

    /// The first time after `t`, at most `span`, at which an input passes 0 whose sign decides a law at rest.
    #[inline(always)]
    fn next_switch(&self, t: f64, span: f64) -> f64 {
        let mut next = span;
        let mut index = 0;
        while let Some(input) = self.dynamics.switching_input(index) {
            // Rounding of a root must not bring it back.
            let is_next = |root: &f64| *root > t + 1e-12 * span && *root < next;
            if let Some(root) = roots_of_input(input).into_iter().filter(is_next).reduce(f64::min) {
                next = root;
            }
            index += 1;
        }
        next
    }

    /// Whether the loads press a mechanism at rest at a place against a rigid stop.
    #[inline(always)]
    fn is_pressed(&mut self, place: Place, sigma: f64) -> Result<bool, Locked> {
        Ok(place.bumper.is_none() && self.ends.is_pressed(place, self.dynamics.free_acceleration(sigma, 0.0)?))
    }
}

/// Times at which an input u_0 + u_1 t + u_2 t^2 / 2 is 0; NaN where it is not. The one of larger size first, the other
/// from their product, so that neither loses digits.
fn roots_of_input([u0, u1, u2]: [f64; 3]) -> [f64; 2] {
    let sum = u1 + u1.signum() * (u1 * u1 - 2.0 * u0 * u2).sqrt();
    [-sum / u2, -2.0 * u0 / sum]
}
