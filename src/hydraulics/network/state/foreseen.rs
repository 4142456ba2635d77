//! The motion of a network that is foreseen over a step.
//!
//! In: the end of an integration. Out: its state, what moved the cylinders, what the step leaves to the next. It must
//! not know how it was found.
use super::ends::Rested;
use super::{Setting, Toggle};
use crate::error::HydraulicsError;
use crate::network::definition::{MOST_COMPONENTS, MOST_CYLINDERS};
use crate::network::laws::Drive;
use crate::network::layout::Layout;
use crate::network::system::{Memory, Motion};
use foundation::integrator::System;

/// The motion foreseen over a step.
#[derive(Clone, Debug)]
pub struct Foreseen {
    /// Size of the step [s]; NaN: none is foreseen.
    pub h: f64,
    /// State at its end, and the memory of the integration there.
    pub end: Vec<f64>,
    pub(super) memory: Memory,
    /// What moved the cylinders.
    pub motions: [Motion; MOST_CYLINDERS],
    /// What moves them at its end: a limit may hold a cylinder that moved before.
    pub end_motions: [Motion; MOST_CYLINDERS],
    pub(super) corrections: [f64; MOST_CYLINDERS],
    /// Bit set of the cylinders whose piston has been at an end of the travel.
    pub(super) met_ends: u16,
    /// Time reached [s].
    pub reached: f64,
    /// A cylinder whose mass changes too much within the step.
    pub toggle: Option<Toggle>,
    /// Why no motion was found.
    pub error: Option<HydraulicsError>,
}

impl Foreseen {
    /// Room for the largest network.
    #[cfg(test)]
    pub fn make_large(&mut self) {
        self.memory = Memory::large();
    }

    /// Nothing, with room for the motion of a network.
    pub fn nothing(layout: &Layout) -> Self {
        Self {
            h: f64::NAN,
            end: vec![0.0; layout.components()],
            memory: Memory::new(layout),
            motions: [Motion::Own(Drive::Held(0.0)); MOST_CYLINDERS],
            end_motions: [Motion::Own(Drive::Held(0.0)); MOST_CYLINDERS],
            corrections: [0.0; MOST_CYLINDERS],
            met_ends: 0,
            reached: 0.0,
            toggle: None,
            error: None,
        }
    }

    /// Rates of the state at the end.
    pub fn end_rates(&self, setting: &Setting<'_>) -> [f64; MOST_COMPONENTS] {
        let mut y = [0.0; MOST_COMPONENTS];
        y[..self.end.len()].copy_from_slice(&self.end);
        setting.job(self.end_motions).derivative(self.h, &y)
    }
}

/// What a step has foreseen of each cylinder: its speed at the end, and the correction of its load.
#[derive(Clone, Copy, Debug, Default)]
pub struct Predicted {
    pub(super) of: [Option<(f64, f64)>; MOST_CYLINDERS],
    pub(super) rested: [Option<Rested>; MOST_CYLINDERS],
}

impl Foreseen {
    /// What a step of this size h has foreseen, where a free cylinder was foreseen to its end. `is_known`: the
    /// mechanisms had the forces of this step. The impulse of an end of a cylinder is none of a load.
    pub fn predicted(&self, setting: &Setting<'_>, is_known: bool) -> Predicted {
        let mut all = Predicted::default();
        if self.reached != self.h {
            return all;
        }
        for cylinder in 0..setting.laws.layout.cylinders {
            let is_free = matches!(self.motions[cylinder], Motion::Own(Drive::Element(_)));
            if is_free && is_known && self.met_ends & 1 << cylinder == 0 {
                let own = setting.laws.layout.motion(cylinder);
                all.of[cylinder] = Some((self.end[own + 1], self.corrections[cylinder]));
            }
            if let Motion::Own(Drive::End(rest)) = self.end_motions[cylinder] {
                all.rested[cylinder] = Some(Rested::of(setting, cylinder, &rest, self.h));
            }
        }
        all
    }
}
