//! The forces of couplings that do no work: those that push teeth apart, and the pretension of belts.
//!
//! In: a definition and its linkage. Out: loads with what sizes them. It must not know the state.
use super::Loading;
use crate::mechanism::definition::{DefinitionError, Mechanism};
use crate::mechanism::linkage::{Kind, Law, Linkage};
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::decimal::Decimal;

/// Teeth in mesh. They touch along the line of pressure, so that a tangential force F_t comes with the force
/// |F_t| tan(alpha) that pushes the wheels apart, whichever of the flanks bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mesh {
    /// Index of the joint of the coupling.
    pub joint: usize,
    /// Indices of the loads that push the wheels apart for F_t < 0 and for F_t > 0; one load for a constant ratio.
    pub loads: [usize; 2],
    /// tan(alpha), with the pressure angle alpha.
    pub tangent: f64,
}

/// The load of a belt's pretension with its size: both spans pull the pulleys together.
pub(super) fn pretension(linkage: &Linkage, coupling: usize, tension: f64) -> (f64, Load) {
    let of = &linkage.couplings[coupling];
    let joint = &linkage.joints[of.joint];
    let cosine = match of.kind {
        Kind::Belt { radii: [first, second], crossed } => {
            let distance = linkage.hinge_distance(of.carrier, joint);
            (if crossed { first + second } else { first - second }) / distance
        }
        _ => 1.0,
    };
    (-2.0 * tension * (1.0 - cosine * cosine).sqrt(), Load::Separation { coupling, lean: 0.0 })
}

/// The couplings with teeth whose pressure angle is not 0: index, name, angle [rad].
pub(super) fn pressure_angles(mechanism: &Mechanism) -> impl Iterator<Item = (usize, (&str, f64))> {
    let angles = mechanism.couplings.iter().map(|(name, own)| (name, own.pressure_angle.unwrap_or(0.0)));
    angles.enumerate().filter(|(_, (_, angle))| *angle > 0.0)
}

impl Loading {
    /// Add the teeth of a mechanism whose joints have no friction. With friction these are added with it.
    pub(super) fn add_meshes(&mut self, mechanism: &Mechanism, linkage: &Linkage) -> Result<(), DefinitionError> {
        let joints = mechanism.joints.len();
        for (coupling, (name, angle)) in pressure_angles(mechanism).filter(|_| mechanism.friction.is_none()) {
            let (first, tangent) = (self.loads.len(), angle.tan());
            let leans: &[f64] = match &linkage.couplings[coupling].law {
                Law::Elliptic { eccentricity: e, lobes, .. } => {
                    let steepest = lobes * e / (1.0 - e * e).sqrt();
                    if steepest * tangent >= 1.0 {
                        let message = format!(
                            "the pitch curves are inclined by up to {} rad, too steep for teeth with this pressure \
                             angle: the sum of both angles must be less than pi/2; use a smaller `pressure_angle` or \
                             a smaller `eccentricity`",
                            Decimal::rounded(steepest.atan())
                        );
                        return Err(DefinitionError::key(format_args!("couplings.{name}.pressure_angle"), message));
                    }
                    &[-tangent, tangent]
                }
                _ => &[0.0],
            };
            let loads = [first, first + leans.len() - 1];
            self.meshes.push(Mesh { joint: joints + coupling, loads, tangent });
            self.loads.extend(leans.iter().map(|&lean| Load::Separation { coupling, lean }));
        }
        Ok(())
    }
}
