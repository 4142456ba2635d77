//! The rigid-link finite element method of [HF08] section 3: a second formulation, independent of the reduced model.
//!
//! In: a linkage of binary links with revolute joints, its loads, and an axial stiffness of each body. Out: the motion of
//! the nodes by Newmark's method, with the bodies' angles, the joints' forces and energies. It must not know the curve, the
//! reduced model or FMI.
//!
//! The unknowns are the positions x of the joints' points. Each body is one element ([`element`]): its exact inertia in its
//! two nodes' terms, and a rod whose stiffness E A / L keeps the length. The equations of motion are
//!
//! ```text
//! M(x) a + c(x, v) + f(x) = Q(x, v)
//! ```
//!
//! with the mass matrix of eq. (19), the rods' forces f of eq. (18), both turned by the present angle (eqs. (22)-(25)), and
//! the loads Q by virtual work. They come from one Lagrangian, so the energy is conserved whatever E A is. As E A grows the
//! motion tends to that of rigid links, with a difference proportional to 1 / (E A): the elastic limit.
pub mod element;
mod error;
mod lu;
mod mesh;
mod newmark;
mod nodal_load;
mod outputs;
mod start;

pub use error::RigidFemError;
pub use newmark::Workspace;

use crate::codec::record::{Damaged, Record};
use crate::mechanism::linkage::{Linkage, Vec2};
use crate::mechanism::loads::resolved::{Loading, Spring};
use element::Span;
use mesh::Mesh;
use nodal_load::{NodalForces, NodalLoad, Present};

/// A linkage as rigid-link finite elements; immutable, to be shared.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidFem {
    mesh: Mesh,
    /// In the order of the loading: the sized ones, then one for each spring.
    loads: Vec<NodalLoad>,
    springs: Vec<Spring>,
    /// Names of the elements' bodies.
    names: Vec<String>,
    /// Largest distance of two named points of one body [m].
    size: f64,
}

/// The state of motion: plain data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Positions of the moving nodes [m].
    pub positions: Vec<Vec2>,
    /// Their velocities [m/s].
    pub velocities: Vec<Vec2>,
    /// Their accelerations, of which Newmark's method keeps the last [m/s2].
    pub accelerations: Vec<Vec2>,
    /// Angle of each element, from its first to its second node, counted on over whole turns [rad].
    pub angles: Vec<f64>,
}

impl State {
    /// Take over another state of the same linkage, without allocation.
    pub fn copy_from(&mut self, other: &Self) {
        self.positions.clone_from(&other.positions);
        self.velocities.clone_from(&other.velocities);
        self.accelerations.clone_from(&other.accelerations);
        self.angles.clone_from(&other.angles);
    }

    /// All fields, written or read into a state of the same linkage.
    ///
    /// # Errors
    /// A field is read that no state has.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let Self { positions, velocities, accelerations, angles } = self;
        for (name, vectors) in [("position", positions), ("velocity", velocities), ("acceleration", accelerations)] {
            record.length("nodes", vectors.len())?;
            vectors.iter_mut().try_for_each(|v| record.all_finite(name, v.as_mut_slice()))?;
        }
        record.length("elements", angles.len())?;
        record.all_finite("angle", angles)
    }

    fn present(&self) -> Present<'_> {
        Present { x: &self.positions, v: &self.velocities, angles: &self.angles }
    }
}

impl RigidFem {
    /// From a linkage and its loads. `axial_stiffness` gives E A [N], > 0, of each body by its place in
    /// [`Linkage::bodies`]; it is asked for moving bodies only.
    ///
    /// # Errors
    /// A prismatic joint, a body that joints do not hold at exactly two points, an E A out of range, a drive whose
    /// efficiency is not 1.
    pub fn new(
        linkage: &Linkage,
        loading: &Loading,
        axial_stiffness: &dyn Fn(usize) -> f64,
    ) -> Result<Self, RigidFemError> {
        let mesh = Mesh::new(linkage, axial_stiffness)?;
        for drive in &loading.drives {
            if let Some(value) = drive.efficiency.filter(|eta| *eta != 1.0) {
                return Err(RigidFemError::Efficiency { drive: drive.name.clone(), value });
            }
        }
        let loads = loading.loads.iter().filter_map(|load| NodalLoad::new(load, linkage, &mesh)).collect();
        let names = linkage.bodies[1..].iter().map(|b| b.name.clone()).collect();
        Ok(Self { mesh, loads, springs: loading.springs.clone(), names, size: linkage.size })
    }

    /// A state with every number 0, to be read into.
    pub fn blank(&self) -> State {
        let zero = vec![Vec2::zeros(); self.mesh.moving];
        State {
            positions: zero.clone(),
            velocities: zero.clone(),
            accelerations: zero,
            angles: vec![0.0; self.mesh.elements.len()],
        }
    }

    /// Number of unknowns: two for each moving node.
    pub fn unknowns(&self) -> usize {
        self.mesh.unknowns()
    }

    /// Add the forces of all loads of these sizes, and of the springs, to the nodes of every element [N].
    fn push_loads(&self, at: &Present, sizes: &[f64], forces: &mut NodalForces) {
        for (load, size) in self.loads.iter().zip(sizes) {
            if *size != 0.0 {
                load.push(&self.mesh, at, *size, forces);
            }
        }
        for spring in &self.springs {
            let load = &self.loads[spring.load];
            let mut pull = spring.force(load.displacement(&self.mesh, at));
            if spring.damping != 0.0 {
                pull += spring.damping * load.rate(&self.mesh, at);
            }
            load.push(&self.mesh, at, -pull, forces);
        }
    }

    /// What the joints must exert on every element at its nodes for the accelerations `a` [N]:
    /// its inertia and its rod's force, less the loads on it.
    fn pin_forces(&self, at: &Present, a: &[Vec2], sizes: &[f64], forces: &mut NodalForces) {
        forces.fill([Vec2::zeros(); 2]);
        self.push_loads(at, sizes, forces);
        for (i, (element, force)) in self.mesh.elements.iter().zip(forces).enumerate() {
            let demand = element.demand(&self.mesh.ends(i, at.x, at.v, a));
            *force = [demand[0] - force[0], demand[1] - force[1]];
        }
    }

    /// Sum over the elements at each moving node, with the opposite sign: what is out of balance there [N].
    fn assemble(&self, forces: &NodalForces, out: &mut [f64]) {
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
    fn angle_near(&self, element: usize, positions: &[Vec2], before: f64) -> f64 {
        let along = Span::new(self.mesh.place(element, positions)).along;
        let angle = along.y.atan2(along.x);
        angle + std::f64::consts::TAU * ((before - angle) / std::f64::consts::TAU).round()
    }
}
