//! The jump at the start of a run whose prescribed motion starts at another position than the mechanism.
//!
//! In: the reduced model, the definition, inputs at the start. Out: the position of the drive and the start of its
//! motion.
use super::State;
use crate::mechanism::definition::Mechanism;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::prescribed::Prescribed;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::reduced::Reduced;

/// Part of the size of the mechanism, or of 1 rad, by which the two may differ.
const SAME: f64 = 1e-6;

impl State {
    /// Displacement of the drive whose motion is prescribed [m or rad]: at the stated start, and where the motion
    /// begins. None if they do not differ, or no motion is prescribed at the start.
    pub fn jump_at_start(reduced: &Reduced, mechanism: &Mechanism, inputs: &Inputs) -> Option<[f64; 2]> {
        let drive = reduced.loading().motion.as_ref().filter(|_| inputs.prescribes())?;
        let mut free = inputs.clone();
        *free.locks.last_mut()? = false;
        let state = Self::at_start(reduced, mechanism, &free).ok()?;
        let here = state.displacement(reduced, drive.load);
        let [there, ..] = Prescribed::new(drive, inputs, here, [0.0; 2])?.at(0.0);
        let size = match &reduced.loading().loads[drive.load] {
            Load::Couple { .. } => 1.0,
            _ => reduced.linkage().size,
        };
        ((there - here).abs() > SAME * size.max(here.abs())).then_some([here, there])
    }
}
