//! The air and the surfaces on which it drags.
//!
//! In: a definition and its linkage. Out: surfaces with their loads. It must not know the state.
use super::Loading;
use crate::mechanism::definition::{DefinitionError, Mechanism};
use crate::mechanism::linkage::{Linkage, Point};
use crate::mechanism::loads::laws::drag::Drag;
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::plane::{Vec2, turned};

/// Air with the surfaces in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Air {
    /// Mass density [kg/m3].
    pub density: f64,
    /// Direction of the flow, a unit vector.
    pub flow: Vec2,
    /// Whether drag depends on the motion of the surfaces.
    pub relative_wind: bool,
    /// Surfaces.
    pub surfaces: Vec<Surface>,
}

/// A surface in the air, fixed to a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name.
    pub name: String,
    /// Start of the strip, or position of the area.
    pub start: Point,
    /// Unit vector along the strip or the flat area, in the body's frame; None for an area without direction.
    pub line: Option<Vec2>,
    /// Law of its drag.
    pub drag: Drag,
    /// Index of the first of its loads: forces along x and y at `start`, then a torque on the body.
    pub load: usize,
}

impl Loading {
    pub(super) fn add_air(&mut self, mechanism: &Mechanism, linkage: &Linkage) -> Result<(), DefinitionError> {
        let Some(air) = &mechanism.air else { return Ok(()) };
        let mut surfaces = Vec::new();
        for (name, s) in mechanism.surfaces.iter() {
            let locate = |key: &str, text: &Option<String>| {
                let text = text.as_deref().unwrap_or_default();
                linkage.locate(mechanism, format_args!("surfaces.{name}.{key}"), text)
            };
            let (start, line, length, breadth) = match &s.at {
                None => {
                    let (from, to) = (locate("from", &s.from)?, locate("to", &s.to)?);
                    let along = to.local - from.local;
                    (from, Some(along.normalize()), along.norm(), s.width.unwrap_or(0.0))
                }
                Some(text) => {
                    let line = s.surface_angle.map(|a| turned(Vec2::x(), a + linkage.angle_of(mechanism, text)));
                    (locate("at", &s.at)?, line, 0.0, s.area.unwrap_or(0.0))
                }
            };
            let drag = Drag { directed: line.is_some(), length, breadth, coefficient: s.drag_coefficient };
            surfaces.push(Surface { name: name.into(), start, line, drag, load: self.loads.len() });
            self.loads.push(Load::Force { at: start, direction: Vec2::x() });
            self.loads.push(Load::Force { at: start, direction: Vec2::y() });
            self.loads.push(Load::Torque { body: start.body, shift: 0.0 });
        }
        let flow = turned(Vec2::x(), air.flow_angle);
        self.air = Some(Air { density: air.density, flow, relative_wind: air.relative_wind, surfaces });
        Ok(())
    }
}
