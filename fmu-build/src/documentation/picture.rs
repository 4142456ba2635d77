//! The drawing of a model: a mechanism at its start, or a cylinder.
//!
//! In: a model. Out: its drawings for a page and for an icon.

use crate::drawing::{Cylinder, Drawing, Format, cylinder, mechanism};
use anyhow::{Context, Result};
use linkage_fmu::component::Component;
use linkage_fmu::mechanism::inspection::{Pose, Scene, SweptStop, attempt};

/// Widths of the drawings for a wide and for a narrow page [px].
const WIDTHS: [f64; 2] = [880.0, 380.0];
/// Ratio of height to width below which a mechanism is too flat for an icon.
const FLAT: f64 = 0.2;
/// Number of positions of the travel from which the icon of a flat mechanism is chosen.
const POSITIONS: usize = 24;

/// A model to be drawn.
#[derive(Clone, Debug)]
pub enum Picture {
    /// A mechanism.
    Mechanism {
        /// Name.
        name: String,
        /// The parts to draw.
        scene: Box<Scene>,
        /// Poses at the start.
        start: Vec<Pose>,
        /// Poses in an icon.
        typical: Vec<Pose>,
        /// Stops that the travel reaches.
        stops: Vec<SweptStop>,
    },
    /// A hydraulic actuator.
    Cylinder {
        /// Name.
        name: String,
        /// Its cylinder.
        cylinder: Cylinder,
    },
}

/// The cylinder that represents a network without cylinders.
const PLAIN: Cylinder = Cylinder { bore: 0.05, rod: 0.03, stroke: 0.3, closed_length: 0.4, length: 0.55 };

/// Prefixes of the parameters and of the length of the first cylinder of a hydraulic model. None without cylinders.
fn first_cylinder(component: &Component) -> Option<[String; 2]> {
    let position = component.interface().list().iter().find(|v| v.name.ends_with(".stroke_position"))?;
    let owner = position.name.strip_suffix(".stroke_position")?.to_owned();
    let actuator = component.interface().find("actuator.length").map(|_| "actuator".to_owned());
    let length = actuator.unwrap_or_else(|| owner.clone());
    Some([owner, length])
}

impl Picture {
    /// The picture of this model, whose definition has this text.
    ///
    /// # Errors
    /// The bodies have no position, or the actuator has no cylinder.
    pub fn new(component: &Component, text: &str) -> Result<Self> {
        let name = component.name().to_owned();
        match component {
            Component::Mechanism(model) => {
                let mut model = model.clone();
                let at_start = model.initialize().ok().and_then(|()| Some((model.scene().ok()?, model.poses()?)));
                // If the start is rejected, the assembled position is drawn.
                let assembled = || attempt(text).map(|attempt| (attempt.scene, attempt.poses));
                let (scene, start) =
                    at_start.or_else(assembled).context("the bodies have no position for the picture")?;
                let mut typical = start.clone();
                if flatness(&scene, &start) < FLAT
                    && let Ok(sweep) = model.sweep(POSITIONS)
                {
                    let best = sweep.poses.into_iter();
                    let best = best.max_by(|a, b| flatness(&scene, a).total_cmp(&flatness(&scene, b)));
                    typical = best.unwrap_or(typical);
                }
                let stops = model.sweep(1).map_or_else(|_| Vec::new(), |sweep| sweep.stops);
                Ok(Self::Mechanism { name, scene: Box::new(scene), start, typical, stops })
            }
            Component::Hydraulic(_) => {
                let Some([cylinder, actuator]) = first_cylinder(component) else {
                    return Ok(Self::Cylinder { name, cylinder: PLAIN });
                };
                let mut model = component.clone();
                let mut value = |name: &str| -> Result<f64> {
                    let reference =
                        model.interface().find(name).with_context(|| format!("there is no variable {name}"))?;
                    Ok(model.real(reference)?)
                };
                let cylinder = Cylinder {
                    bore: value(&format!("{cylinder}.bore"))?,
                    rod: value(&format!("{cylinder}.rod"))?,
                    stroke: value(&format!("{cylinder}.stroke"))?,
                    closed_length: value(&format!("{cylinder}.closed_length"))?,
                    length: value(&format!("{actuator}.length"))?,
                };
                Ok(Self::Cylinder { name, cylinder })
            }
        }
    }

    /// The scene of a mechanism.
    pub fn scene(&self) -> Option<&Scene> {
        match self {
            Self::Mechanism { scene, .. } => Some(scene),
            Self::Cylinder { .. } => None,
        }
    }

    /// Whether stops are drawn.
    pub fn has_stops(&self) -> bool {
        matches!(self, Self::Mechanism { stops, .. } if !stops.is_empty())
    }

    /// The drawings for a wide and for a narrow page.
    pub fn of_the_page(&self) -> [Drawing; 2] {
        WIDTHS.map(|width| self.drawing(Format::Page { width }))
    }

    /// The drawing for an icon with sides of this length [px].
    pub fn icon(&self, side: f64) -> Drawing {
        self.drawing(Format::Icon { side })
    }

    fn drawing(&self, format: Format) -> Drawing {
        match self {
            Self::Mechanism { name, scene, start, typical, stops } => match format {
                Format::Icon { .. } => mechanism(name, scene, typical, &[], format),
                Format::Page { .. } => mechanism(name, scene, start, stops, format),
            },
            Self::Cylinder { name, cylinder: of } => cylinder(name, of, format),
        }
    }
}

/// Ratio of the smaller to the larger side of the box around the joints: 0 on a line.
fn flatness(scene: &Scene, poses: &[Pose]) -> f64 {
    let sides = crate::drawing::sides(scene, poses);
    let [least, most] = [sides[0].min(sides[1]), sides[0].max(sides[1])];
    if most > 0.0 { least / most } else { 1.0 }
}
