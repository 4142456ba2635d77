//! Laws, settings and inputs of one step.
//!
//! In: what a model has at the beginning of a step. Out: the jobs of its integrations; lengths that are refused. It
//! must not know the state.
use crate::definition::Solver;
use crate::error::HydraulicsError;
use crate::network::definition::{Cylinder, MOST_CYLINDERS};
use crate::network::inputs::Inputs;
use crate::network::laws::{Drive, Laws};
use crate::network::layout::Part;
use crate::network::system::{Job, Motion};
use foundation::format::Named;

/// Limits of the length where none are known [m].
const NO_LIMITS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Laws, settings and inputs of one step.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    pub laws: &'a Laws,
    pub solver: &'a Solver,
    pub inputs: &'a Inputs,
    /// The cylinders by name.
    pub cylinders: &'a Named<Cylinder>,
}

impl Setting<'_> {
    /// Value of an input of a cylinder.
    #[inline]
    pub fn get(&self, cylinder: usize, part: Part) -> f64 {
        self.inputs.values[self.laws.layout.of_cylinder(cylinder, part)]
    }

    pub(super) fn job(&self, motions: [Motion; MOST_CYLINDERS]) -> Job<'_> {
        let Solver { tolerance, max_steps } = *self.solver;
        let layout = &self.laws.layout;
        let limits = std::array::from_fn(|index| match index < layout.cylinders {
            true => self.limits(index),
            false => NO_LIMITS,
        });
        let (met_ends, watched, event) = (0, None, None);
        Job { laws: self.laws, inputs: self.inputs, motions, limits, met_ends, tolerance, max_steps, watched, event }
    }

    /// Least and largest length that stops leave to a cylinder [m]; both inputs 0: none are known.
    pub(super) fn limits(&self, cylinder: usize) -> [f64; 2] {
        let limits = [Part::LowerLimit, Part::UpperLimit].map(|part| self.get(cylinder, part));
        if limits == [0.0; 2] { NO_LIMITS } else { limits }
    }

    /// The motion of all cylinders by the inputs.
    pub(super) fn given(&self) -> [Motion; MOST_CYLINDERS] {
        let layout = &self.laws.layout;
        std::array::from_fn(|index| match index < layout.cylinders {
            true => Motion::Given(self.inputs.motion(layout, index)),
            false => Motion::Own(Drive::Held(0.0)),
        })
    }

    /// Refuse lengths that the cylinders do not have at the beginning of a step of size h, and motions by the inputs
    /// that lead to such lengths within it. `h` is 0 for the beginning alone; `overrun`: how far beyond the ends each
    /// cylinder may be [m].
    pub fn check_lengths(
        &self,
        h: f64,
        motions: &[Motion],
        overrun: impl Fn(usize) -> f64,
    ) -> Result<(), HydraulicsError> {
        for (index, (cylinder, motion)) in self.laws.cylinders.iter().zip(motions).enumerate() {
            let [least, most] = cylinder.laws.lengths();
            let mut farthest = self.get(index, Part::Length);
            let beyond = |length: f64| (least - length).max(length - most);
            if let (true, Motion::Given([length, speed])) = (h > 0.0, motion)
                && length.spread(h) > 0.0
            {
                let mut add = |t: f64| {
                    let there = length.at(t);
                    farthest = if beyond(there) > beyond(farthest) { there } else { farthest };
                };
                add(h);
                speed.passages(0.0, h, &mut add);
            }
            if beyond(farthest) > 0.0 && beyond(farthest) > overrun(index) {
                let name = format!(
                    "{}.length{}",
                    self.cylinders.names()[index],
                    if h > 0.0 { " within the step" } else { "" }
                );
                let allowed = format!("from closed_length = {least} m to closed_length + stroke = {most} m");
                return Err(HydraulicsError::Value { name, value: farthest, allowed });
            }
        }
        Ok(())
    }
}
