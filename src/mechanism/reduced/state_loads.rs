//! The scene: what acts besides loads of a given size, in one table that the integration reads.
//!
//! In: the reduced model. Out: the effects of all that acts on the motion, and on the reactions of the joints with friction. A
//! mechanism without dampers, efficiencies, bumpers, friction and moving air has no scene and pays for none. It must not
//! know the state.
use super::Reduced;
use super::components::Pull;
use crate::mechanism::curve::Configuration;
use crate::mechanism::linkage::{Freedom, perp};
use crate::mechanism::loads::resolved::FrictionJoint;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::reactions::{Columns, Reaction, groups};
use crate::numerics::table::{Bundle, Table, Unresolved};
use std::ops::Range;

/// What acts besides loads of a given size.
///
/// Of the reaction of each joint with friction, a pin, two components count: x and y of a revolute joint, of a prismatic one
/// that normal to its axis and 0. The components of n pins are told with all x first, then all y. The pins of a group
/// transmit the same force under friction, but for its sign; as signs don't matter, they are told with that of the first.
#[derive(Clone, Debug)]
pub struct StateLoads {
    /// Drives with an efficiency, by their loads.
    pub drives_with_efficiency: Vec<usize>,
    /// Whether the drag of the air acts.
    pub air: bool,
    /// Bumpers, by their stops.
    pub bumpers: Vec<usize>,
    /// Joints with friction.
    pub friction_joints: Vec<FrictionJoint>,
    /// Group of each pin, numbered from 0.
    pub groups: Vec<usize>,
    /// First pin of each group.
    leaders: Vec<usize>,
    /// Sign of each pin's reaction, compared with the first pin of its group.
    signs: Vec<f64>,
    /// Loads beyond the given ones, in the order of their influences: those of surfaces, bumpers, pins.
    pub loads: Vec<usize>,
    /// First what is always read together, [`Self::bundle`]; then effects of given loads.
    pub table: Table,
    /// Influences of `loads`; then of the pins' reactions: to sigma_dot^2, to sigma_ddot, to friction without motion, to each
    /// of the other `loads`; then directions of surfaces and displacements of bumpers.
    pub bundle: Bundle,
    /// Effects of each given load on all components of the pins' reactions.
    pub caused_by_applied: Vec<Bundle>,
    /// Components of the table for the effects of given loads on the motion or on one component of a pin's reaction.
    given: usize,
}

/// Place of a load that does not act.
const NOWHERE: usize = usize::MAX;

/// Room to fill the table.
#[derive(Debug, Default)]
pub(super) struct Room {
    columns: Columns,
    /// The loads that act, and the place among them of each load of all.
    loads: Vec<Load>,
    places: Vec<usize>,
    influence: Vec<f64>,
    pulls: Vec<Pull>,
    /// Components of the pins' reactions, term after term.
    parts: Vec<f64>,
}

impl StateLoads {
    /// Rows of effects: the motion, then the components of the pins' reactions.
    pub fn rows(&self) -> usize {
        1 + 2 * self.friction_joints.len()
    }

    /// Number of `loads` that are not friction.
    pub fn free(&self) -> usize {
        self.loads.len() - self.friction_joints.len()
    }

    /// In the bundle: reactions to sigma_dot^2 = 1.
    pub fn square(&self) -> Range<usize> {
        let (first, n) = (self.loads.len(), self.friction_joints.len());
        first..first + 2 * n
    }

    /// In the bundle: reactions to sigma_ddot = 1.
    pub fn inertial(&self) -> Range<usize> {
        let (first, n) = (self.square().end, self.friction_joints.len());
        first..first + 2 * n
    }

    /// In the bundle: what each group transmits for the friction = 1 of each pin without motion, as x and then y: group by
    /// group, for all pins.
    pub fn passed(&self) -> Range<usize> {
        let first = self.inertial().end;
        first..first + 2 * self.leaders.len() * self.friction_joints.len()
    }

    /// In the bundle: reactions to one of the `loads` that are not friction, with the motion that it causes.
    pub fn caused(&self, load: usize) -> Range<usize> {
        let (first, n) = (self.passed().end, self.friction_joints.len());
        first + 2 * n * load..first + 2 * n * (load + 1)
    }

    /// In the bundle: first of the two components with the direction of a surface in the mechanism frame.
    pub fn line(&self, surface: usize) -> usize {
        self.caused(self.free()).start + 2 * surface
    }

    /// In the bundle: the displacement of the load of `bumpers[k]`.
    pub fn pressed(&self, k: usize) -> usize {
        // Each surface has three loads.
        self.line((self.free() - self.bumpers.len()) / 3) + k
    }

    /// Number of components of the bundle.
    pub fn bundled(&self) -> usize {
        self.pressed(self.bumpers.len())
    }

    /// Component of the effect of [`super::Components`] number `k` in a row.
    pub fn given(&self, row: usize, k: usize) -> usize {
        self.bundled() + row * self.given + k
    }

    /// Build the scene, if anything is in it.
    pub(super) fn build(reduced: &Reduced, air: bool) -> Result<Option<Self>, Unresolved> {
        let (loading, linkage) = (&reduced.loading, reduced.linkage());
        let drives = loading.drives.iter().enumerate();
        let drives_with_efficiency: Vec<usize> =
            drives.filter(|(_, d)| d.efficiency.is_some()).map(|(i, _)| i).collect();
        let stops = loading.stops.iter().enumerate();
        let bumpers: Vec<usize> = stops.filter(|(_, s)| s.enabled && !s.rigid).map(|(i, _)| i).collect();
        let friction_joints = match &loading.friction {
            Some(friction) if friction.enabled => friction.friction_joints.clone(),
            _ => Vec::new(),
        };
        let surfaces = loading.air.as_ref().filter(|_| air).map_or(&[][..], |air| &air.surfaces);
        let damped = reduced.components.damping.is_some();
        if drives_with_efficiency.is_empty()
            && bumpers.is_empty()
            && friction_joints.is_empty()
            && surfaces.is_empty()
            && !damped
        {
            return Ok(None);
        }
        let mut loads: Vec<usize> = surfaces.iter().flat_map(|s| s.load..s.load + 3).collect();
        loads.extend(bumpers.iter().map(|&b| loading.stops[b].load));
        loads.extend(friction_joints.iter().map(|p| p.load));
        let of_joints = groups(linkage);
        let mut leaders: Vec<usize> = Vec::new();
        let (mut of_pins, mut signs) = (Vec::new(), Vec::new());
        for (i, friction_joint) in friction_joints.iter().enumerate() {
            let (own, sign) = of_joints[friction_joint.joint];
            let found = leaders.iter().position(|&leader| of_joints[friction_joints[leader].joint].0 == own);
            let group = found.unwrap_or(leaders.len());
            if found.is_none() {
                leaders.push(i);
            }
            of_pins.push(group);
            signs.push(sign * of_joints[friction_joints[leaders[group]].joint].1);
        }
        let air = !surfaces.is_empty();
        let mut state_loads = Self {
            drives_with_efficiency,
            air,
            bumpers,
            friction_joints,
            groups: of_pins,
            leaders,
            signs,
            loads,
            table: Table::empty(),
            bundle: Bundle::default(),
            caused_by_applied: Vec::new(),
            given: reduced.components.count,
        };
        let sizes = state_loads.sizes(reduced);
        let mut room = state_loads.room(reduced);
        let mut fill = |c: &Configuration, values: &mut [f64]| state_loads.fill(reduced, c, &mut room, values);
        state_loads.table = reduced.tabulate(&reduced.fine, &[sizes], &mut fill).swap_remove(0)?;
        state_loads.bundle = state_loads.table.bundle(0..state_loads.bundled());
        let own = &state_loads;
        let of_applied = |k: usize| own.table.bundle((1..own.rows()).map(move |row| own.given(row, k)));
        state_loads.caused_by_applied = (0..state_loads.given).map(of_applied).collect();
        Ok(Some(state_loads))
    }

    /// Natural sizes of all components.
    fn sizes(&self, reduced: &Reduced) -> Vec<f64> {
        let (loading, linkage, natural) = (&reduced.loading, reduced.linkage(), &reduced.natural);
        let displacement = |load: usize| natural.displacement(&loading.loads[load], linkage);
        // A generalised force Q along sigma goes with forces of the size Q scale / size in the joints.
        let factor = natural.scale / linkage.size;
        let influences: Vec<f64> = self.loads.iter().map(|&l| displacement(l) / natural.scale).collect();
        let mut sizes = vec![0.0; self.bundled()];
        sizes[..influences.len()].copy_from_slice(&influences);
        sizes[self.square()].fill(1.0 / linkage.size);
        sizes[self.inertial()].fill(factor);
        for (k, size) in sizes[self.passed()].iter_mut().enumerate() {
            *size = displacement(self.friction_joints[k % self.friction_joints.len()].load) / linkage.size;
        }
        for load in 0..self.free() {
            sizes[self.caused(load)].fill(influences[load] * factor);
        }
        sizes[self.line(0)..self.pressed(0)].fill(1.0);
        for (k, &b) in self.bumpers.iter().enumerate() {
            sizes[self.pressed(k)] = displacement(loading.stops[b].load);
        }
        let given = reduced.components.sizes(loading, &reduced.curve, natural);
        for row in 0..self.rows() {
            sizes.extend(given.iter().map(|s| if row == 0 { *s } else { s * factor }));
        }
        sizes
    }

    /// Room to fill the table at one configuration after another.
    pub(super) fn room(&self, reduced: &Reduced) -> Room {
        let loading = &reduced.loading;
        let base = loading.base();
        let mut places: Vec<usize> = (0..loading.loads.len()).map(|l| if l < base { l } else { NOWHERE }).collect();
        for (k, &load) in self.loads.iter().enumerate() {
            places[load] = base + k;
        }
        let own = self.loads.iter().map(|&load| &loading.loads[load]);
        let loads = loading.loads[..base].iter().chain(own).cloned().collect();
        Room { loads, places, ..Room::default() }
    }

    /// All components at a configuration.
    pub(super) fn fill(&self, reduced: &Reduced, c: &Configuration, room: &mut Room, values: &mut [f64]) {
        let (loading, linkage, n) = (&reduced.loading, reduced.linkage(), self.friction_joints.len());
        let Room { columns, loads, places, pulls, influence, parts } = room;
        influence.clear();
        let acts = |(load, place): (&Load, &usize)| if *place == NOWHERE { 0.0 } else { load.influence(linkage, c) };
        influence.extend(loading.loads.iter().zip(&*places).map(acts));
        reduced.components.pulls(loading, &reduced.curve, c, pulls);
        // All components of the pins' reactions to sigma_ddot = 1, to sigma_dot^2 = 1, then to each load = 1 at rest.
        parts.clear();
        parts.resize(2 * n * (2 + loads.len()), 0.0);
        if n > 0 {
            self.part(reduced, c, columns.fill(reduced.curve.closure(), c, loads, 0), parts);
        }
        let of_load = |load: usize| 2 * n * (2 + places[load])..2 * n * (3 + places[load]);
        for (value, &load) in values.iter_mut().zip(&self.loads) {
            *value = influence[load];
        }
        values[self.square()].copy_from_slice(&parts[2 * n..4 * n]);
        values[self.inertial()].copy_from_slice(&parts[..2 * n]);
        let passed = &mut values[self.passed()];
        for (friction_joint, of_pin) in self.friction_joints.iter().enumerate() {
            let part = &parts[of_load(of_pin.load)];
            for (group, &leader) in self.leaders.iter().enumerate() {
                for axis in 0..2 {
                    passed[(axis * self.leaders.len() + group) * n + friction_joint] = part[axis * n + leader];
                }
            }
        }
        // A reaction to a load: what balances it at rest, and what the motion that it causes needs.
        let (inertial, at_rest) = parts.split_at_mut(4 * n);
        for (load, &place) in places.iter().enumerate().filter(|(_, place)| **place != NOWHERE) {
            for (part, inertial) in at_rest[2 * n * place..2 * n * (place + 1)].iter_mut().zip(&inertial[..2 * n]) {
                *part += inertial * influence[load];
            }
        }
        for (load, &number) in self.loads[..self.free()].iter().enumerate() {
            values[self.caused(load)].copy_from_slice(&parts[of_load(number)]);
        }
        for row in 0..self.rows() {
            let effect = |load: usize| if row == 0 { influence[load] } else { parts[of_load(load)][row - 1] };
            let given = &mut values[self.given(row, 0)..self.given(row + 1, 0)];
            reduced.components.fill_effects(pulls, effect, given);
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
    }

    /// The components of the pins' reactions in all columns.
    fn part(&self, reduced: &Reduced, c: &Configuration, columns: &[Reaction], parts: &mut [f64]) {
        let (joints, n) = (&reduced.linkage().joints, self.friction_joints.len());
        for (i, (friction_joint, &sign)) in self.friction_joints.iter().zip(&self.signs).enumerate() {
            let joint = &joints[friction_joint.joint];
            let normal = match joint.freedom {
                Freedom::Revolute => None,
                Freedom::Prismatic(line) => Some(perp(c.positions.vector(joint.first.body, line))),
            };
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
