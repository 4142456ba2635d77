//! Transitions: what follows at an instant, from the state before a step or from an event.
//!
//! In: a state, an event. Out: the state, the contact and the mode that follow. It must not know how a step is made.
use super::{Advance, Stopped};
use crate::integrator::System;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::MOTION;
use crate::mechanism::motion::contact::{Place, outward};
use crate::mechanism::motion::events::Event;
use crate::mechanism::motion::witness::What;

/// What follows from the state at one instant.
pub(super) enum Instant {
    /// The mechanism is held at rest to the end of the span.
    Held,
    /// A transition that took no time, or a release: what follows is to be found anew.
    Changed,
    /// The mechanism moves.
    Moves,
}

impl<'e, const N: usize> Advance<'_, 'e, N>
where
    EquationOfMotion<'e>: System<N>,
{
    /// What follows from the state before a step: rest, impacts, bumpers touched, the mode of friction and drives.
    #[inline(always)]
    pub(super) fn instant(&mut self, z: &mut [f64; N], span: f64) -> Result<Instant, Stopped> {
        self.dynamics.time = self.progress.t;
        self.dynamics.set_state(z);
        // Contact changes with a jump only, so a settled mechanism does not rest.
        if !self.progress.is_settled
            && let Some(place) = self.contact.at_rest()
        {
            self.dynamics.mode.touching = self.contact.touching();
            self.engage_pressed(z);
            return self.rest(place, z, span);
        }
        if let Some(side) = self.pushed_end(z) {
            self.impact(Place::rigid(side), z)?;
            self.jumped();
            return Ok(Instant::Changed);
        }
        let settles = !self.progress.is_settled;
        if settles {
            self.touch_bumpers(z)?;
            let leaves = |side: usize| z[1] * outward(side) < 0.0 && self.ends.is_at_rigid(side, z[0]);
            if let Some(side) = (0..2).find(|&side| leaves(side)) {
                self.progress.lost += self.end_bouncing(side, z)?;
                if self.contact.at_rest().is_some() {
                    return Ok(Instant::Changed);
                }
            }
            self.dynamics.mode.touching = self.contact.touching();
            self.progress.is_settled = true;
            self.engage_pressed(z);
        }
        if let Some(state_loads) = self.dynamics.deciding::<N>() {
            if settles {
                self.state_rates();
                self.dynamics.set_regimes(z[0], z[1]);
            }
            if state_loads.reverses && self.dynamics.find_direction(z[0], z[1])? == 0.0 {
                return self.wait_at_rest(z, span);
            }
            if settles {
                if self.clinging().is_some() {
                    self.settle_on_surface(z)?;
                }
                if state_loads.switches() > 0 {
                    self.dynamics.find_signs(self.progress.t, z)?;
                }
            }
        }
        Ok(Instant::Moves)
    }

    /// Side on which the mechanism is at a rigid stop and moves outward.
    #[inline(always)]
    fn pushed_end(&self, z: &[f64; N]) -> Option<usize> {
        (0..2).find(|&side| {
            let moves = z[1] * outward(side) > 0.0;
            moves && (z[0] - self.ends.limits[side]) * outward(side) >= 0.0
        })
    }

    /// The transition that an event at the state z causes. `at_once`: it came at the very start of its step. `after`:
    /// the state just after it on the interpolant.
    #[inline(never)]
    pub(super) fn apply_event(
        &mut self,
        event: Event,
        at_once: bool,
        z: &mut [f64; N],
        after: &[f64; N],
    ) -> Result<(), Stopped> {
        match event {
            Event::Undefined => self.integrator.refresh(),
            // The right-hand side is continuous there.
            Event::Border(_) | Event::Knot(_) => {}
            Event::Stop(place) if self.pauses() && self.ends.travel.stop(place).is_some() => {
                z[0] = self.ends.position(place).unwrap_or(z[0]);
                self.contact.arrives(place);
                return Err(Stopped::Event(self.progress));
            }
            Event::Stop(place) => {
                self.jumped();
                self.impact(place, z)?;
            }
            // A motion of two components has no other events.
            _ if N < MOTION => {}
            Event::Regime(joint) if self.clinging().is_some() && self.turn_on_surface(joint, z)? => {}
            Event::Regime(first) => {
                self.integrator.refresh();
                self.dynamics.time = self.progress.t;
                // Where some bodies come to rest together, the slip speeds of all their joints pass 0 at one time.
                let (count, clings) =
                    self.dynamics.state_loads.map_or((0, None), |own| (own.friction_joints.len(), own.clings));
                for joint in 0..count {
                    // A driven surface decides by its own event.
                    let follows = clings != Some(joint)
                        && self.dynamics.excess_of_slip(joint, [self.progress.t, after[0], after[1]]) > 0.0;
                    if joint == first || follows {
                        self.progress.work.regimes += 1;
                        self.dynamics.change_regime(joint, z[0], z[1]);
                        self.tell(What::Regime { joint, regime: self.dynamics.regime(joint) });
                    }
                }
                self.progress.held = at_once.then_some(event);
            }
            Event::Switch(switch) => {
                self.integrator.refresh();
                self.progress.work.signs += 1;
                self.dynamics.flip_sign(switch);
                self.progress.held = at_once.then_some(event);
            }
            Event::Reversal => {
                if self.clinging().is_some() {
                    self.turn_with_surface(z);
                }
                self.jumped();
                self.progress.work.reversals += 1;
                z[1] = 0.0;
                if !self.dynamics.sticks() {
                    self.tell(What::Reversal);
                } else if self.comes_to_stick(z)? && self.pauses() {
                    return Err(Stopped::Event(self.progress));
                }
            }
            Event::Bumper(bumper) => {
                self.jumped();
                self.progress.work.bumpers += 1;
                if self.contact.touching().contains(bumper) {
                    self.contact.let_go(bumper);
                    self.tell(What::Left { stop: self.ends.travel.bumpers[bumper].stop });
                } else {
                    self.touched(bumper);
                }
            }
            Event::Engages(bumper) => {
                self.engage(Place::of_bumper(0, bumper));
                if self.pauses() {
                    return Err(Stopped::Event(self.progress));
                }
            }
            Event::Level(level) => {
                if let Some(level) = self.dynamics.level_of_network(level, z) {
                    z[level.component] = level.value;
                }
                return Err(Stopped::Event(self.progress));
            }
        }
        Ok(())
    }

    /// Whether the advance pauses at an event now. At its very start it does not, so that each makes way.
    #[inline(always)]
    pub(super) fn pauses(&self) -> bool {
        self.witness.pauses.at_events && self.progress.t > 0.0
    }

    /// What follows at the start of an advance where the one before has paused: the impact at this place.
    #[cold]
    #[inline(never)]
    pub(super) fn meet(&mut self, place: Place, z: &mut [f64; N]) -> Result<(), Stopped> {
        self.dynamics.time = 0.0;
        self.dynamics.set_state(z);
        self.state_rates();
        self.dynamics.mode.touching = self.contact.touching();
        self.jumped();
        self.impact(place, z)
    }

    /// Something happens now.
    #[inline(always)]
    pub(super) fn tell(&mut self, what: What) {
        self.witness.tell(self.progress.t, what);
    }

    /// The state has jumped.
    #[inline(always)]
    pub(super) fn jumped(&mut self) {
        self.integrator.restart();
        self.progress.is_settled = false;
    }
}
