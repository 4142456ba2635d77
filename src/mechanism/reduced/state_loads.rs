//! State loads: loads sized by the state, and their effects in one table that the integration reads.
//!
//! In: the curve and the loads. Out: effects of all loads on the motion and on the reactions of the joints with
//! friction. Without dampers, efficiencies, curves of drives, a hydraulic circuit, bumpers, springs that the state
//! sizes, friction and moving air there is no such table. It must not know states.
mod kinks;
mod layout;

pub use kinks::{Argument, Facings, Kink};

use super::source::{Source, SpringLoad};
use crate::codec::checksum::fnv1a;
use crate::mechanism::curve::Configuration;
use crate::mechanism::linkage::Freedom;
use crate::mechanism::loads::laws::spring::Spring;
use crate::mechanism::loads::resolved::{FrictionJoint, FrictionKind, Loading};
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::reactions::{Columns, Groups, Reaction};
use crate::numerics::bundle::Bundle;
use crate::numerics::plane::perp;
use crate::numerics::table::{Grid, Table, Unresolved};
use std::sync::Arc;

/// Loads sized by the state.
///
/// Two components of the reaction of each joint with friction matter: x and y in a revolute joint; in a prismatic one
/// the component normal to the axis, and 0; of a coupling the transmitted force, and 0. Those of n joints are stored as
/// all x, then all y. The joints of a group have equal reactions to friction up to their sign, or normal forces that
/// are an affine function of their levers. The sign of a reaction has no effect on friction, so all joints of a group
/// get the sign of the first.
#[derive(Clone, Debug)]
pub struct StateLoads {
    /// Drives whose delivered force the state decides, by their loads: those with an efficiency, then the one with a
    /// hydraulic circuit, then the loads of the laws of drives, then those of the speeds of surfaces, which deliver 0.
    pub drives: Vec<usize>,
    /// How many of them have an efficiency.
    pub efficient: usize,
    /// How many of them are speeds of surfaces.
    pub surfaces: usize,
    /// Laws of drives.
    pub laws: Vec<LawLoad>,
    /// Drives with a position gain, by their indices in `laws`.
    pub positioned: Vec<usize>,
    /// Number of states of controllers.
    pub controllers: usize,
    /// Limits of controlled drives: index in `laws`, index in the limits of the control.
    pub limits: Vec<(usize, usize)>,
    /// Whether friction holds at rest, on surfaces that are not driven.
    pub sticks: bool,
    /// The friction joint whose driven surface can hold its body, so that both move at one speed.
    pub clings: Option<usize>,
    /// Whether a coupling has losses.
    pub loses: bool,
    /// Whether the right-hand side jumps where sigma_dot changes its sign.
    pub reverses: bool,
    /// Whether drag acts.
    pub air: bool,
    /// Bumpers, by their stops.
    pub bumpers: Vec<usize>,
    /// Springs that the state sizes in part.
    pub springs: Vec<usize>,
    /// Kinks of the laws by which the state sizes loads. A step ends there.
    pub kinks: Vec<Kink>,
    /// How many of them, the first ones, are surfaces that the air flows along.
    pub edges: usize,
    /// On each panel of the table, which way all surfaces face the air; none without kinks of drag.
    facings: Vec<Facings>,
    /// Joints with friction.
    pub friction_joints: Vec<FrictionJoint>,
    /// The prismatic ones among them and the couplings, by their indices there: their normal or transmitted forces have
    /// signs.
    pub prismatic: Vec<usize>,
    /// Groups of the joints with friction.
    pub groups: Groups,
    /// Loads sized by the state, in the order of their influences: of surfaces, bumpers, friction.
    pub loads: Vec<usize>,
    /// Components of [`Self::bundle`], then effects of applied loads.
    pub table: Arc<Table>,
    /// Influences of `loads`; reactions of the joints with friction to sigma_dot^2, to sigma_ddot, to friction without
    /// motion, to each of the other `loads`; directions of surfaces; displacements of bumpers.
    pub bundle: Arc<Bundle>,
    /// Effects of each applied load on all components of the reactions of the joints with friction.
    pub caused_by_applied: Arc<[Bundle]>,
    /// Number of components of the influence table: effects on the motion or on one component of a reaction.
    given: usize,
    /// Name of the section in which the table may be kept: it tells all on which the table depends besides curve, loads
    /// and springs.
    pub(super) section: String,
}

/// The load that the law of a drive sizes.
#[derive(Clone, Copy, Debug)]
pub struct LawLoad {
    /// Index of the drive.
    pub drive: usize,
    /// Index of the load in [`StateLoads::drives`].
    pub at: usize,
    /// Index in [`StateLoads::positioned`]; none without a position gain.
    pub position: Option<usize>,
    /// Index of the first limit of the force in [`StateLoads::limits`].
    pub limit: usize,
}

/// Mark of a load that does not act.
const ABSENT: usize = usize::MAX;

/// Scratch for filling the table.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    columns: Columns,
    /// Loads that act, and for each load of the mechanism its index among them.
    loads: Vec<Load>,
    indices: Vec<usize>,
    influence: Vec<f64>,
    springs: Vec<SpringLoad>,
    /// Components of the reactions of the joints with friction, term by term.
    parts: Vec<f64>,
}

impl StateLoads {
    /// Tabulate the state loads on a grid; None if there are none. Those of a model with the same curve, loads and
    /// springs have the same tables if they have the same section.
    pub(super) fn build(
        source: &Source,
        grid: &Grid,
        air: bool,
        known: Option<&Self>,
    ) -> Result<Option<Self>, Unresolved> {
        let (loading, linkage) = (&source.loading, source.linkage());
        let drives = loading.drives.iter().enumerate();
        let mut drives: Vec<usize> = drives.filter(|(_, d)| d.efficiency.is_some()).map(|(i, _)| i).collect();
        let efficient = drives.len();
        drives.extend(loading.hydraulic_loads());
        let (mut laws, mut positioned, mut limits) = (Vec::new(), Vec::new(), Vec::new());
        for (drive, law) in loading.drives.iter().enumerate().filter_map(|(k, drive)| Some((k, drive.law.as_ref()?))) {
            let is_positioned = law.control().is_some_and(|control| control.position_gain.is_some());
            let (position, limit) = (is_positioned.then_some(positioned.len()), limits.len());
            positioned.extend(position.map(|_| laws.len()));
            let stated = law.control().map_or([None; 4], |control| control.limits);
            limits.extend((0..4).filter(|&side| stated[side].is_some()).map(|side| (laws.len(), side)));
            laws.push(LawLoad { drive, at: drives.len(), position, limit });
            drives.extend(law.commands());
        }
        drives.extend(loading.surfaces.clone());
        let stops = loading.stops.iter().enumerate();
        let bumpers: Vec<usize> = stops.filter(|(_, s)| s.enabled && !s.rigid).map(|(i, _)| i).collect();
        let friction_joints = match &loading.friction {
            Some(friction) => friction.acting().copied().collect(),
            None => Vec::new(),
        };
        let loses = friction_joints.iter().any(FrictionJoint::is_loss);
        let sticks = friction_joints.iter().any(|joint| joint.law.sticks && joint.surface.is_none());
        let clings = friction_joints.iter().position(FrictionJoint::clings);
        let surfaces = loading.air.as_ref().filter(|_| air).map_or(&[][..], |air| &air.surfaces);
        let by_state = |(index, spring): (usize, &Spring)| {
            let load = spring.state_load.filter(|_| spring.damper.is_some() || source.winds(spring))?;
            Some((index, load))
        };
        let (springs, of_springs): (Vec<usize>, Vec<usize>) =
            loading.springs.iter().enumerate().filter_map(by_state).unzip();
        let mut loads: Vec<usize> = surfaces.iter().flat_map(|s| s.load..s.load + 3).collect();
        loads.extend(bumpers.iter().map(|&b| loading.stops[b].load));
        loads.extend(of_springs);
        let damped = source.components.damping.is_some();
        if drives.is_empty() && loads.is_empty() && friction_joints.is_empty() && !damped {
            return Ok(None);
        }
        loads.extend(friction_joints.iter().map(|p| p.load));
        let by_reaction = |joint: &FrictionJoint| !matches!(joint.kind, FrictionKind::Constant(_));
        let groups =
            Groups::new(linkage, friction_joints.iter().map(|joint| Some(joint.joint).filter(|_| by_reaction(joint))));
        let prismatic = (0..friction_joints.len()).filter(|&j| friction_joints[j].has_normal_force(linkage)).collect();
        let air = !surfaces.is_empty();
        let mut state_loads = Self {
            drives,
            efficient,
            surfaces: loading.surfaces.len(),
            laws,
            positioned,
            controllers: loading.control_states().count(),
            limits,
            sticks,
            clings,
            loses,
            reverses: sticks || efficient > 0,
            air,
            bumpers,
            springs,
            kinks: Vec::new(),
            edges: 0,
            facings: Vec::new(),
            friction_joints,
            prismatic,
            groups,
            loads,
            table: Arc::default(),
            bundle: Arc::default(),
            caused_by_applied: Arc::default(),
            given: source.components.count,
            section: String::new(),
        };
        state_loads.find_kinks(source);
        state_loads.section = state_loads.section_of(source);
        if let Some(Self { table, bundle, caused_by_applied, .. }) =
            known.filter(|known| known.section == state_loads.section)
        {
            let (table, bundle, caused_by_applied) = (table.clone(), bundle.clone(), caused_by_applied.clone());
            let found = Self { table, bundle, caused_by_applied, ..state_loads };
            return Ok(Some(found.with_facings(source)));
        }
        let sizes = state_loads.sizes(source);
        let mut scratch = state_loads.scratch(loading);
        let mut fill = |c: &Configuration, values: &mut [f64]| state_loads.fill(source, c, &mut scratch, values);
        let name = Some(&*state_loads.section);
        let smooth = source.tabulate(name, grid, std::slice::from_ref(&sizes), &mut fill).swap_remove(0);
        // Where branches cross, reactions may be unbounded, and friction with them.
        state_loads.table = Arc::new(smooth.or_else(|_| source.tabulate_with_gaps(grid, sizes, &mut fill))?);
        state_loads.bundle = Arc::new(Bundle::new(&state_loads.table, 0..state_loads.bundled()));
        let own = &state_loads;
        let of_applied = |k: usize| Bundle::new(&own.table, (1..own.rows()).map(move |row| own.given(row, k)));
        state_loads.caused_by_applied = (0..state_loads.given).map(of_applied).collect();
        Ok(Some(state_loads.with_facings(source)))
    }

    fn section_of(&self, source: &Source) -> String {
        let surfaces = source.loading.air.iter().filter(|_| self.air).flat_map(|air| &air.surfaces);
        let lines = surfaces.flat_map(|surface| surface.line.map_or([0; 2], |line| [line.x, line.y].map(f64::to_bits)));
        // Whether friction is constant shows in the bits above those of an index.
        let joints = self.friction_joints.iter().map(|joint| match joint.kind {
            FrictionKind::Constant(_) => 1 << 32 | joint.joint as u64,
            _ => joint.joint as u64,
        });
        let positioned = self.positioned.iter().map(|&law| law as u64);
        let bytes: Vec<u8> = lines.chain(joints).chain(positioned).flat_map(u64::to_le_bytes).collect();
        format!("state loads {:?} {:?} {:016x}", self.drives, self.loads, fnv1a(&bytes))
    }

    /// Natural sizes of all components.
    fn sizes(&self, source: &Source) -> Vec<f64> {
        let loading = &source.loading;
        let size = source.linkage().size;
        // A generalised force Q along sigma causes forces in the joints of the natural size Q scale / size.
        let factor = source.length / size;
        let influences: Vec<f64> = self.loads.iter().map(|&l| source.displacement_size(l) / source.length).collect();
        let mut sizes = vec![0.0; self.bundled()];
        sizes[..influences.len()].copy_from_slice(&influences);
        sizes[self.square()].fill(1.0 / size);
        sizes[self.inertial()].fill(factor);
        for (k, passed) in sizes[self.passed()].iter_mut().enumerate() {
            *passed = source.displacement_size(self.friction_joints[k % self.friction_joints.len()].load) / size;
        }
        for load in 0..self.free() {
            sizes[self.caused(load)].fill(influences[load] * factor);
        }
        sizes[self.line(0)..self.pressed(0)].fill(1.0);
        for (k, &b) in self.bumpers.iter().enumerate() {
            sizes[self.pressed(k)] = source.displacement_size(loading.stops[b].load);
        }
        for (k, &spring) in self.springs.iter().enumerate() {
            sizes[self.stretched(k)] = source.displacement_size(loading.springs[spring].load);
        }
        for (k, &law) in self.positioned.iter().enumerate() {
            sizes[self.driven(k)] = source.displacement_size(self.laws[law].drive);
        }
        let given = source.influence_sizes();
        for row in 0..self.rows() {
            sizes.extend(given.iter().map(|s| if row == 0 { *s } else { s * factor }));
        }
        sizes
    }

    /// Scratch for filling the table at one configuration after another.
    pub(super) fn scratch(&self, loading: &Loading) -> Scratch {
        let base = loading.base();
        let mut indices: Vec<usize> = (0..loading.loads.len()).map(|l| if l < base { l } else { ABSENT }).collect();
        for (k, &load) in self.loads.iter().enumerate() {
            indices[load] = base + k;
        }
        let own = self.loads.iter().map(|&load| &loading.loads[load]);
        let loads = loading.loads[..base].iter().chain(own).cloned().collect();
        Scratch { loads, indices, ..Scratch::default() }
    }

    /// All components at a configuration.
    pub(super) fn fill(&self, source: &Source, c: &Configuration, scratch: &mut Scratch, values: &mut [f64]) {
        let Source { curve, loading, components, .. } = source;
        let (linkage, n) = (source.linkage(), self.friction_joints.len());
        let Scratch { columns, loads, indices, springs, influence, parts } = scratch;
        influence.clear();
        let acts = |(load, index): (&Load, &usize)| if *index == ABSENT { 0.0 } else { load.influence(linkage, c) };
        influence.extend(loading.loads.iter().zip(&*indices).map(acts));
        source.spring_loads(c, springs);
        // Reactions of the joints with friction to sigma_ddot = 1, sigma_dot^2 = 1, each load = 1 without motion.
        parts.clear();
        parts.resize(2 * n * (2 + loads.len()), 0.0);
        if n > 0 {
            self.copy_reactions(source, c, columns.fill(&curve.closure, c, loads, 0), parts);
            self.add_losses(indices, parts);
            self.add_screws(source, c, indices, parts);
        }
        let of_load = |load: usize| 2 * n * (2 + indices[load])..2 * n * (3 + indices[load]);
        for (value, &load) in values.iter_mut().zip(&self.loads) {
            *value = influence[load];
        }
        values[self.square()].copy_from_slice(&parts[2 * n..4 * n]);
        values[self.inertial()].copy_from_slice(&parts[..2 * n]);
        let passed = &mut values[self.passed()];
        for (j, friction_joint) in self.friction_joints.iter().enumerate() {
            let part = &parts[of_load(friction_joint.load)];
            for (group, [first, second]) in self.groups.forces(part).enumerate() {
                passed[group * n + j] = first;
                passed[(self.groups.count() + group) * n + j] = second;
            }
        }
        // Add the reactions to the motion that each load causes.
        let (inertial, at_rest) = parts.split_at_mut(4 * n);
        for (load, &index) in indices.iter().enumerate().filter(|(_, index)| **index != ABSENT) {
            for (part, inertial) in at_rest[2 * n * index..2 * n * (index + 1)].iter_mut().zip(&inertial[..2 * n]) {
                *part += inertial * influence[load];
            }
        }
        for (k, &load) in self.loads[..self.free()].iter().enumerate() {
            values[self.caused(k)].copy_from_slice(&parts[of_load(load)]);
        }
        for row in 0..self.rows() {
            let effect = |load: usize| if row == 0 { influence[load] } else { parts[of_load(load)][row - 1] };
            let given = &mut values[self.given(row, 0)..self.given(row + 1, 0)];
            components.fill(springs, effect, given);
        }
        if let (true, Some(air)) = (self.air, &loading.air) {
            for (k, surface) in air.surfaces.iter().enumerate() {
                let line = surface.line.map(|l| c.positions.vector(surface.start.body, l)).unwrap_or_default();
                let first = self.line(k);
                (values[first], values[first + 1]) = (line.x, line.y);
            }
        }
        for (k, &stop) in self.bumpers.iter().enumerate() {
            values[self.pressed(k)] = loading.loads[loading.stops[stop].load].displacement(linkage, c)[0];
        }
        for (k, &spring) in self.springs.iter().enumerate() {
            values[self.stretched(k)] = loading.loads[loading.springs[spring].load].displacement(linkage, c)[0];
        }
        for (k, &law) in self.positioned.iter().enumerate() {
            values[self.driven(k)] = loading.loads[self.laws[law].drive].displacement(linkage, c)[0];
        }
    }

    /// The force that causes the loss of a coupling is that on the second body, the transmitted force less the loss.
    fn add_losses(&self, indices: &[usize], parts: &mut [f64]) {
        let n = self.friction_joints.len();
        let all = self.friction_joints.iter().zip(&self.groups.signs).enumerate();
        for (i, (joint, sign)) in all.filter(|(_, (joint, _))| joint.kind == FrictionKind::Coupling) {
            parts[2 * n * (2 + indices[joint.load]) + i] += sign / joint.radius;
        }
    }

    /// The force of a screw on its nut is that of the motor and of the commands of its law, less what turns the screw,
    /// less the loss.
    fn add_screws(&self, source: &Source, c: &Configuration, indices: &[usize], parts: &mut [f64]) {
        let (n, linkage, loading) = (self.friction_joints.len(), source.linkage(), &source.loading);
        for (i, joint) in self.friction_joints.iter().enumerate() {
            let FrictionKind::Screw { drive, rotor } = joint.kind else { continue };
            let (rotor, Load::Screw { ratio, .. }) = (&linkage.rotors[rotor], &loading.loads[drive]) else { continue };
            let mut set = |term: usize, value: f64| parts[2 * n * term + i] = value;
            set(0, -rotor.mass * linkage.stroke_rate(rotor.stroke, &c.positions, &c.rates));
            set(1, -rotor.mass * linkage.stroke_second_rate(rotor.stroke, &c.positions, &c.rates, &c.second));
            set(2 + indices[joint.load], 1.0);
            let commands = loading.drives[drive].law.iter().flat_map(|law| law.commands());
            commands.chain([drive]).for_each(|load| set(2 + indices[load], *ratio));
        }
    }

    /// Copy the components of the reactions of the joints with friction from all columns.
    fn copy_reactions(&self, source: &Source, c: &Configuration, columns: &[Reaction], parts: &mut [f64]) {
        let (joints, n) = (&source.linkage().joints, self.friction_joints.len());
        for (i, (friction_joint, &sign)) in self.friction_joints.iter().zip(&self.groups.signs).enumerate() {
            let Some(joint) = joints.get(friction_joint.joint) else { continue };
            let normal = match joint.freedom {
                Freedom::Revolute | Freedom::Coupling(_) => None,
                Freedom::Slot(index) => Some(perp(c.positions.slots[index].axis)),
                Freedom::Prismatic(line) => Some(perp(c.positions.vector(joint.first.body, line))),
            };
            if let FrictionKind::Constant(_) = friction_joint.kind {
                continue;
            }
            if let Freedom::Coupling(_) = joint.freedom {
                for (column, parts) in columns.chunks_exact(joints.len()).zip(parts.chunks_exact_mut(2 * n)) {
                    parts[i] = sign * column[friction_joint.joint].moment;
                }
                continue;
            }
            for (column, parts) in columns.chunks_exact(joints.len()).zip(parts.chunks_exact_mut(2 * n)) {
                let force = sign * column[friction_joint.joint].force;
                match normal {
                    None => (parts[i], parts[n + i]) = (force.x, force.y),
                    Some(normal) => parts[i] = force.dot(&normal),
                }
            }
        }
    }
}
