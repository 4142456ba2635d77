//! A linkage as rigid-link finite elements, and its state.
//!
//! In: a linkage, its loads, axial stiffnesses. Out: forces at the nodes. It must not know time steps.
use super::error::RigidFemError;
use super::mesh::{Mesh, Present};
use super::nodal_load::{NodalForces, NodalLoad};
use crate::codec::record::{Damaged, Record};
use crate::mechanism::linkage::Linkage;
use crate::mechanism::loads::laws::spring::Spring;
use crate::mechanism::loads::resolved::Loading;
use crate::numerics::plane::Vec2;

/// A linkage as rigid-link finite elements; immutable.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidFem {
    pub(super) mesh: Mesh,
    /// Loads in the order of the loading.
    pub(super) loads: Vec<NodalLoad>,
    pub(super) springs: Vec<Spring>,
    /// Names of the elements' bodies.
    pub(super) names: Vec<String>,
    /// Size of the linkage: largest distance of two named points of one body [m].
    pub(super) size: f64,
}

/// State of motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Positions of the moving nodes [m].
    pub positions: Vec<Vec2>,
    /// Velocities of the moving nodes [m/s].
    pub velocities: Vec<Vec2>,
    /// Accelerations of the moving nodes at the end of the last step [m/s2].
    pub accelerations: Vec<Vec2>,
    /// Angle of each element, from its first to its second node, with all revolutions counted [rad].
    pub angles: Vec<f64>,
}

impl State {
    /// Copy another state of the same linkage, without allocation.
    pub fn copy_from(&mut self, other: &Self) {
        self.positions.clone_from(&other.positions);
        self.velocities.clone_from(&other.velocities);
        self.accelerations.clone_from(&other.accelerations);
        self.angles.clone_from(&other.angles);
    }

    /// Write all fields to a record, or read them into a state of the same linkage.
    ///
    /// # Errors
    /// A field that is read is invalid.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let Self { positions, velocities, accelerations, angles } = self;
        for (name, vectors) in [("position", positions), ("velocity", velocities), ("acceleration", accelerations)] {
            record.length("nodes", vectors.len())?;
            vectors.iter_mut().try_for_each(|v| record.all_finite(name, v.as_mut_slice()))?;
        }
        record.length("elements", angles.len())?;
        record.all_finite("angle", angles)
    }

    pub(super) fn present(&self) -> Present<'_> {
        let Self { positions, velocities, accelerations, angles } = self;
        Present { x: positions, v: velocities, a: accelerations, angles }
    }
}

impl RigidFem {
    /// Finite elements for a linkage and its loads. `axial_stiffness` gives E A [N], > 0, of each moving body by its
    /// index.
    ///
    /// # Errors
    /// A prismatic joint, a body with joints not at two points, an E A out of range, a drive with an efficiency not 1.
    pub fn new(
        linkage: &Linkage,
        loading: &Loading,
        axial_stiffness: &dyn Fn(usize) -> f64,
    ) -> Result<Self, RigidFemError> {
        let mesh = Mesh::new(linkage, axial_stiffness)?;
        for drive in &loading.drives {
            let eta = drive.efficiency.map(|eta| eta.forward.min(eta.backward));
            if let Some(value) = eta.filter(|eta| *eta != 1.0) {
                return Err(RigidFemError::Efficiency { drive: drive.name.clone(), value });
            }
        }
        let loads = loading.loads.iter().filter_map(|load| NodalLoad::new(load, linkage, &mesh)).collect();
        let names = linkage.bodies[1..].iter().map(|b| b.name.clone()).collect();
        Ok(Self { mesh, loads, springs: loading.springs.clone(), names, size: linkage.size })
    }

    /// A state of zeros.
    pub fn blank(&self) -> State {
        let zero = vec![Vec2::zeros(); self.mesh.moving];
        State {
            positions: zero.clone(),
            velocities: zero.clone(),
            accelerations: zero,
            angles: vec![0.0; self.mesh.elements.len()],
        }
    }

    /// Add the forces of all loads of these sizes, and of the springs, to the forces at the nodes of every element [N].
    fn push_loads(&self, at: &Present, sizes: &[f64], forces: &mut NodalForces) {
        for (load, size) in self.loads.iter().zip(sizes) {
            if *size != 0.0 {
                load.push(&self.mesh, at, *size, forces);
            }
        }
        for spring in &self.springs {
            let load = &self.loads[spring.load];
            let mut force = spring.force(load.displacement(&self.mesh, at, 0));
            if spring.is_damped() {
                force += spring.damping_force(load.displacement(&self.mesh, at, 1));
            }
            load.push(&self.mesh, at, -force, forces);
        }
    }

    /// Forces of the joints on every element at its nodes [N]: inertia, rod's force, less loads.
    pub(super) fn pin_forces(&self, at: &Present, sizes: &[f64], forces: &mut NodalForces) {
        forces.fill([Vec2::zeros(); 2]);
        self.push_loads(at, sizes, forces);
        for (i, (element, force)) in self.mesh.elements.iter().zip(forces).enumerate() {
            let demand = element.demand(&self.mesh.ends(i, at));
            *force = [demand[0] - force[0], demand[1] - force[1]];
        }
    }

    /// Residual of the equations of motion at each moving node [N]: minus the sum over the node's elements.
    pub(super) fn assemble(&self, forces: &NodalForces, out: &mut [f64]) {
        out.fill(0.0);
        for (nodes, force) in self.mesh.nodes.iter().zip(forces) {
            for (node, f) in nodes.iter().zip(force) {
                if *node < self.mesh.moving {
                    out[2 * node] -= f.x;
                    out[2 * node + 1] -= f.y;
                }
            }
        }
    }

    /// The angle of an element nearest to `before` [rad].
    pub(super) fn angle_near(&self, element: usize, positions: &[Vec2], before: f64) -> f64 {
        let along = self.mesh.span(element, positions).along;
        let angle = along.y.atan2(along.x);
        angle + std::f64::consts::TAU * ((before - angle) / std::f64::consts::TAU).round()
    }
}
