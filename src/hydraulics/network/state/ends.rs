//! A piston at an end of its cylinder at the beginning of a step.
//!
//! In: the state, inputs. Out: whether the end holds the piston, and the impulse by which the force of the cylinder
//! brings what it moves there. It must not know how a step is made.
use super::{Last, Setting, State};
use crate::circuit::{SLACK, settling_reach};
use crate::error::HydraulicsError;
use crate::network::definition::MOST_CYLINDERS;
use crate::network::laws::{Drive, Element, Rest};
use crate::network::layout::Part;
use crate::network::system::Motion;
use foundation::codec::record::{Damaged, Record};
use foundation::numerics::dual::Number;

/// Length beyond an end of the cylinder that what it moves may have, besides the way of a step [m].
const OVERRUN: f64 = 1e-3;

/// A piston that has come to rest at an end of its cylinder in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rested {
    /// Length there [m].
    end: f64,
    /// Farthest way from there [m] that the mechanism may then have, with its way by its speed.
    reach: f64,
    /// Time [s] in which it comes there.
    settling: f64,
}

impl Rested {
    /// After a step of size h.
    pub fn of(setting: &Setting<'_>, cylinder: usize, rest: &Rest<f64>, h: f64) -> Self {
        let (end, settling) = (rest.end, rest.settling.max(h));
        let motion = [Part::Length, Part::Speed].map(|part| setting.get(cylinder, part));
        Self { end, reach: settling_reach(motion, end, settling), settling }
    }
}

/// What an end of a cylinder does at the beginning of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtEnd {
    /// Length there [m].
    pub end: f64,
    /// Whether the piston rests there.
    pub rests: bool,
    /// Time [s] in which what it moves comes there, of the last step.
    pub settling: f64,
    /// Speed after the beginning, as a part of that before.
    kept: f64,
}

impl AtEnd {
    /// Length, speed, impulse and moment at the beginning.
    pub fn begin<T: Number>(&self, mass: T, [length, speed]: [T; 2]) -> [T; 4] {
        let (end, after) = (T::constant(self.end), speed * self.kept);
        [end, after, mass * (after - speed), mass * (length - end)]
    }
}

impl State {
    /// What an end of a cylinder does with this element at the beginning of a step; none if the piston is between the
    /// ends.
    pub(super) fn at_end(&self, setting: &Setting<'_>, cylinder: usize, element: &Element<f64>) -> Option<AtEnd> {
        let [length, speed] = [Part::Length, Part::Speed].map(|part| setting.get(cylinder, part));
        let laws = &setting.laws.cylinders[cylinder].laws;
        let (end, outward) = laws.nearer_end(length);
        let is_near =
            |last: &Rested| last.end == end && speed.abs() * last.settling + (length - end).abs() <= last.reach;
        let rested = self.last[cylinder].rested.filter(is_near);
        let is_beyond = (length - end) * outward >= 0.0;
        if !is_beyond && rested.is_none() {
            return None;
        }
        let net = (self.force(setting.laws, cylinder, 0.0) - element.load_at(length, 0.0)) * outward;
        let settling = rested.map_or(0.0, |last| last.settling);
        let at_end = |rests, kept| Some(AtEnd { end, rests, settling, kept });
        if rested.is_some() && net >= 0.0 {
            return at_end(true, 0.0);
        }
        if !is_beyond {
            return None;
        }
        let after = if speed * outward > 0.0 { laws.after_impact(element.mass, speed, net) } else { speed };
        at_end(after == 0.0 && net >= 0.0, if speed == 0.0 { 0.0 } else { after / speed })
    }

    /// [`Self::at_end`] of a cylinder whose force moves what is along it, or holds it at its end.
    pub(super) fn moved_at_end(&self, setting: &Setting<'_>, cylinder: usize, motion: Motion) -> Option<AtEnd> {
        match motion {
            Motion::Own(Drive::Element(element) | Drive::End(Rest { element, .. })) => {
                self.at_end(setting, cylinder, &element)
            }
            _ => None,
        }
    }

    /// Pistons at the ends of their cylinders begin there, with the impulse and the moment of the force that brings
    /// there what they move. Returns the bit set of these cylinders.
    pub(super) fn begin_at_ends(
        &self,
        setting: &Setting<'_>,
        motions: &[Motion; MOST_CYLINDERS],
        y: &mut [f64],
    ) -> u16 {
        let layout = &setting.laws.layout;
        let mut met_ends = 0;
        for (cylinder, motion) in motions.iter().enumerate().take(layout.cylinders) {
            if let Some(at_end) = self.moved_at_end(setting, cylinder, *motion) {
                let [mass, length, speed] =
                    [Part::Mass, Part::Length, Part::Speed].map(|part| setting.get(cylinder, part));
                let begun = at_end.begin(mass, [length, speed]);
                let (own, impulse) = (layout.motion(cylinder), layout.impulse(cylinder));
                y[own..own + 2].copy_from_slice(&begun[..2]);
                y[impulse..impulse + 2].copy_from_slice(&begun[2..]);
                met_ends |= 1 << cylinder;
            }
        }
        met_ends
    }

    /// A jump of what a cylinder moves to the end at which the piston is moves no oil.
    pub(super) fn jump_to_ends(&mut self, setting: &Setting<'_>, motions: &[Motion; MOST_CYLINDERS]) {
        let (laws, length) = (setting.laws, |cylinder| self.y[setting.laws.layout.motion(cylinder)]);
        let begun = |cylinder| {
            let at_end = self.moved_at_end(setting, cylinder, motions[cylinder]);
            at_end.map_or_else(|| length(cylinder), |at_end| at_end.end)
        };
        self.start_volume += laws.volume_at(begun) - laws.volume_at(length);
    }

    /// Reject lengths that the cylinders do not have: [`Setting::check_lengths`].
    pub fn check_lengths(&self, setting: &Setting<'_>, h: f64, motions: &[Motion]) -> Result<(), HydraulicsError> {
        setting.check_lengths(h, motions, |cylinder| self.overrun(setting, cylinder))
    }

    /// How far beyond the ends of its travel a cylinder may be [m] whose force stops there what it moves: up to the way
    /// of the last step. A cylinder whose motion is given stops nothing.
    fn overrun(&self, setting: &Setting<'_>, cylinder: usize) -> f64 {
        if setting.get(cylinder, Part::Mass) > 0.0 { OVERRUN + self.last[cylinder].way } else { SLACK }
    }
}

impl Last {
    /// The fields about the ends, written or read.
    pub(super) fn record_end(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let is_size = |value: f64| value.is_finite() && value >= 0.0;
        record.number("distance moved in the last step", &mut self.way, is_size, ">= 0")?;
        record.option("rest at an end", &mut self.rested, Rested::default, |record, rested| {
            record.finite("length at the end", &mut rested.end)?;
            record.number("distance to the end", &mut rested.reach, is_size, ">= 0")?;
            record.number("time to the end", &mut rested.settling, is_size, ">= 0")
        })
    }
}
