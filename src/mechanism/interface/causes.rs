//! What a parameter acts on.
use super::needs::Needs;
use super::source::Source;
use crate::mechanism::definition::{FrictionLaw, Mechanism, Role};
use crate::mechanism::linkage::{Body, Freedom, GROUND, Linkage};
use crate::mechanism::loads::laws::friction::Law;
use crate::mechanism::loads::resolved::{FrictionJoint, FrictionKind, Loading};
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::order::sorted_by_pair;
use crate::numerics::plane::Vec2;

/// What a parameter acts on.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Cause {
    Joint(usize),
    Position,
    Speed,
    Inertia,
    Masses,
    Load(usize),
    /// Of the drive with this load.
    Efficiency(usize),
    Marker(usize),
    /// Of the friction joint with this load.
    Radius(usize),
    Statics,
    Elasticity,
    Circuit,
}

impl Needs<'_> {
    /// Whether the value follows from one of the causes, which are ascending. A parameter may act on all markers and
    /// all loads, so causes are looked up and not gone through.
    pub fn meet(&self, causes: &[Cause]) -> bool {
        let acts = |cause: Cause| causes.binary_search(&cause).is_ok();
        let any = |of: fn(usize) -> Cause| between(causes, of(0), of(usize::MAX));
        let on_loads = |of: fn(usize) -> Cause| {
            let acting = any(of);
            match acting.len() < self.loads.len() {
                true => acting.iter().any(|cause| self.loads.binary_search_by(|load| of(*load).cmp(cause)).is_ok()),
                false => self.loads.iter().any(|load| acting.binary_search(&of(*load)).is_ok()),
            }
        };
        (self.closure && !any(Cause::Joint).is_empty())
            || self.joint.is_some_and(|joint| acts(Cause::Joint(joint)))
            || (self.position && acts(Cause::Position))
            || (self.speed && acts(Cause::Speed))
            || (self.inertia && acts(Cause::Inertia))
            || (self.masses && acts(Cause::Masses))
            || on_loads(Cause::Load)
            || (!self.lossless && on_loads(Cause::Efficiency))
            || self.marker.is_some_and(|marker| acts(Cause::Marker(marker)))
            || self.radius.is_some_and(|load| acts(Cause::Radius(load)))
            || (self.statics && acts(Cause::Statics))
            || (self.elasticity && acts(Cause::Elasticity))
            || (self.circuit && acts(Cause::Circuit))
    }
}

/// Those of ascending causes that are not below `first` and not above `last`.
fn between(causes: &[Cause], first: Cause, last: Cause) -> &[Cause] {
    let from = causes.partition_point(|cause| *cause < first);
    let to = causes.partition_point(|cause| *cause <= last);
    &causes[from..to]
}

/// What each parameter acts on, ascending, found by a small change and a comparison: numbers, flags, then the method if
/// stated. A number that no small change leaves in range, as where two keys must agree, may act on everything.
pub(super) fn causes(source: &Source) -> Vec<Vec<Cause>> {
    let mechanism = source.mechanism;
    let (mut roles, mut flags) = (Vec::new(), 0);
    mechanism.clone().parameters(&mut |p, _| roles.push(p.role));
    mechanism.clone().flags(&mut |_, _| flags += 1);
    let changed = |change: &mut dyn FnMut(&mut Mechanism)| {
        let mut other = mechanism.clone();
        change(&mut other);
        Source::new(&other).ok().map(|other| differences(source, &other))
    };
    let by = |index: usize, sign: f64| {
        changed(&mut |other| {
            let mut indices = 0..;
            other.parameters(&mut |_, value| {
                if indices.next() == Some(index) {
                    *value += sign * (*value * 1e-3 + 1e-4);
                }
            });
            // V_d must stay above V_S, whichever of the two changes.
            if let Some(friction) = &mut other.friction {
                friction.kinetic_speed = friction.kinetic_speed.max(1.01 * friction.static_speed);
                // Of a law that sticks mu_S must not fall below mu_d.
                if friction.law == FrictionLaw::Stick {
                    raise_static_coefficients(other);
                }
            }
        })
    };
    let of_number = |(index, role): (usize, &Role)| match role {
        Role::StartPosition => vec![Cause::Position],
        Role::StartSpeed => vec![Cause::Speed],
        Role::Elasticity => vec![Cause::Elasticity],
        Role::Circuit | Role::CircuitStart => vec![Cause::Circuit],
        Role::Tolerance | Role::Step | Role::Scale | Role::Named => Vec::new(),
        Role::Geometry | Role::Inertia | Role::Load | Role::Law => {
            by(index, 1.0).or_else(|| by(index, -1.0)).unwrap_or_else(|| anything(source))
        }
    };
    let of_flag = |index: usize| {
        changed(&mut |other| {
            let mut indices = 0..;
            other.flags(&mut |_, value| *value ^= indices.next() == Some(index));
        })
        .unwrap_or_else(|| anything(source))
    };
    let method = mechanism.solver.method.map(|_| vec![Cause::Elasticity]);
    let mut causes: Vec<Vec<Cause>> =
        roles.iter().enumerate().map(of_number).chain((0..flags).map(of_flag)).chain(method).collect();
    pass_to_bases(mechanism, &mut causes);
    causes
}

/// All causes that a parameter of geometry, of loads or of laws may be.
fn anything(source: &Source) -> Vec<Cause> {
    let joints = (0..source.linkage.joints.len()).map(Cause::Joint);
    let loads = (0..source.loading.loads.len()).flat_map(|load| [Cause::Load(load), Cause::Radius(load)]);
    let drives = (0..source.loading.drives.len()).map(Cause::Efficiency);
    let markers = (0..source.markers.len()).map(Cause::Marker);
    let others = [Cause::Inertia, Cause::Masses, Cause::Statics];
    ascending(joints.chain(loads).chain(drives).chain(markers).chain(others).collect())
}

/// Causes in ascending order.
fn ascending(causes: Vec<Cause>) -> Vec<Cause> {
    sorted_by_pair(causes, |cause| match *cause {
        Cause::Joint(joint) => (0, joint),
        Cause::Position => (1, 0),
        Cause::Speed => (2, 0),
        Cause::Inertia => (3, 0),
        Cause::Masses => (4, 0),
        Cause::Load(load) => (5, load),
        Cause::Efficiency(drive) => (6, drive),
        Cause::Marker(marker) => (7, marker),
        Cause::Radius(load) => (8, load),
        Cause::Statics => (9, 0),
        Cause::Elasticity => (10, 0),
        Cause::Circuit => (11, 0),
    })
}

/// What a calculated parameter acts on, the parameters that decide it act on in its place.
fn pass_to_bases(mechanism: &Mechanism, causes: &mut [Vec<Cause>]) {
    for calculated in mechanism.expressions.iter() {
        let own = std::mem::take(&mut causes[calculated.index]);
        for &base in &calculated.bases {
            causes[base].extend(&own);
            causes[base] = ascending(std::mem::take(&mut causes[base]));
            causes[base].dedup();
        }
    }
}

/// Raise each coefficient of static friction to that of kinetic friction, if it is below that.
fn raise_static_coefficients(mechanism: &mut Mechanism) {
    let Some(friction) = &mut mechanism.friction else { return };
    friction.static_coefficient = friction.static_coefficient.max(friction.kinetic_coefficient);
    let joints = mechanism.joints.iter_mut().map(|(_, own)| (&mut own.static_coefficient, own.kinetic_coefficient));
    let cams = mechanism.couplings.iter_mut().map(|(_, own)| (&mut own.static_coefficient, own.kinetic_coefficient));
    let cams = cams.filter(|(at_rest, slipping)| at_rest.or(*slipping).is_some());
    for (at_rest, slipping) in joints.chain(cams) {
        let slipping = slipping.unwrap_or(friction.kinetic_coefficient);
        if at_rest.unwrap_or(friction.static_coefficient) < slipping {
            *at_rest = Some(slipping);
        }
    }
}

/// What differs between two mechanisms that are the same but for one parameter, ascending.
fn differences(one: &Source, other: &Source) -> Vec<Cause> {
    let mut causes = Vec::new();
    let mut add = |differs: bool, cause| causes.extend(differs.then_some(cause));
    for (j, (a, b)) in one.linkage.joints.iter().zip(&other.linkage.joints).enumerate() {
        // The angle of a prismatic joint is the offset of its second body.
        let offset = |linkage: &Linkage| linkage.bodies[a.second.body].offset;
        add(a != b || offset(&one.linkage) != offset(&other.linkage), Cause::Joint(j));
    }
    for (a, b) in one.linkage.slots.iter().zip(&other.linkage.slots) {
        add(a != b, Cause::Joint(a.joint));
    }
    for (a, b) in one.linkage.couplings.iter().zip(&other.linkage.couplings) {
        add(a != b, Cause::Joint(a.joint));
    }
    // A difference in the rounding of a sum is none.
    let same = |(x, y): (&f64, &f64)| (x - y).abs() <= 1e-12 * x.abs();
    let kinetic = [kinetic_constants(&one.linkage), kinetic_constants(&other.linkage)];
    add(!kinetic[0].iter().flatten().zip(kinetic[1].iter().flatten()).all(same), Cause::Inertia);
    let masses = |linkage: &Linkage| linkage.bodies.iter().map(|b| (b.mass, b.center, b.inertia)).collect::<Vec<_>>();
    let heavier = masses(&one.linkage) != masses(&other.linkage);
    let rotors = one.linkage.rotors != other.linkage.rotors;
    add(rotors, Cause::Inertia);
    add(heavier || rotors, Cause::Masses);
    for (l, load) in one.loading.loads.iter().enumerate() {
        let gravity = heavier && matches!(load, Load::Gravity(_));
        add(gravity || !same_load(&one.loading, &other.loading, l), Cause::Load(l));
    }
    if let Some(motion) = one.loading.motion.as_ref().filter(|motion| Some(*motion) != other.loading.motion.as_ref()) {
        add(true, Cause::Load(motion.load));
    }
    for (l, (a, b)) in one.loading.drives.iter().zip(&other.loading.drives).enumerate() {
        add(a.efficiency != b.efficiency, Cause::Efficiency(l));
    }
    for (m, (a, b)) in one.markers.iter().zip(other.markers.iter()).enumerate() {
        add(a != b, Cause::Marker(m));
    }
    let joints =
        |loading: &Loading| loading.friction.iter().flat_map(|f| f.friction_joints.clone()).collect::<Vec<_>>();
    for (a, b) in joints(&one.loading).into_iter().zip(joints(&other.loading)) {
        add(a.radius != b.radius, Cause::Radius(a.load));
    }
    add(statics(&one.loading) != statics(&other.loading), Cause::Statics);
    ascending(causes)
}

/// Whether a load and what sizes it are the same, apart from the efficiency of a drive.
fn same_load<'l>(one: &'l Loading, other: &'l Loading, load: usize) -> bool {
    let constant = |l: &'l Loading| load.checked_sub(l.inputs.len()).and_then(|i| l.constants.get(i));
    let spring = |l: &'l Loading| l.springs.iter().find(|s| s.load == load);
    let stop = |l: &'l Loading| l.defined_stops().find(|s| s.load == load);
    let lock = |l: &'l Loading| {
        let of_stop = l.locks.iter().filter(|lock| l.stops[lock.stop].load == load);
        of_stop.map(|lock| (lock.release, lock.engage)).collect::<Vec<_>>()
    };
    let drag = |l: &'l Loading| {
        let air = l.air.as_ref()?;
        let surface = air.surfaces.iter().find(|s| (s.load..s.load + 3).contains(&load))?;
        Some((air.density, air.flow, air.relative_wind, surface))
    };
    let friction = |l: &'l Loading| {
        let friction = l.friction.as_ref()?;
        Some((friction.enabled, friction.friction_joints.iter().find(|p| p.load == load)?))
    };
    let law = |l: &'l Loading| l.drives.iter().filter_map(|drive| drive.law.as_ref()).find(|law| law.load == load);
    let mesh = |l: &'l Loading| l.meshes.iter().find(|mesh| mesh.loads.contains(&load));
    one.loads.get(load) == other.loads.get(load)
        && mesh(one) == mesh(other)
        && law(one) == law(other)
        && constant(one) == constant(other)
        && spring(one) == spring(other)
        && stop(one) == stop(other)
        && lock(one) == lock(other)
        && drag(one) == drag(other)
        && friction(one) == friction(other)
}

/// What static friction depends on besides positions: whether friction is enabled, pin radii and coefficients; on a
/// driven surface the law.
fn statics(loading: &Loading) -> Vec<(bool, FrictionKind, f64, f64, Option<Law>)> {
    let joints = loading.friction.iter().flat_map(|f| f.friction_joints.iter().map(|p| (f.enabled, p)));
    let statics = |(enabled, p): (bool, &FrictionJoint)| {
        (enabled, p.kind, p.radius, p.law.static_coefficient, p.surface.map(|_| p.law))
    };
    joints.map(statics).collect()
}

/// What the kinetic energy of each body depends on: the moment of inertia about a fixed pivot, else mass, centre and
/// inertia.
fn kinetic_constants(linkage: &Linkage) -> Vec<[f64; 4]> {
    let mut pivots = vec![None; linkage.bodies.len()];
    for joint in linkage.joints.iter().filter(|j| j.freedom == Freedom::Revolute).rev() {
        for (on_ground, other) in [(joint.first, joint.second), (joint.second, joint.first)] {
            if on_ground.body == GROUND {
                pivots[other.body] = Some(other.local);
            }
        }
    }
    let constants = |(b, pivot): (&Body, &Option<Vec2>)| match pivot {
        Some(pivot) => [b.inertia + b.mass * (b.center - pivot).norm_squared(), 0.0, 0.0, 0.0],
        None => [b.mass, b.center.x, b.center.y, b.inertia],
    };
    linkage.bodies.iter().zip(&pivots).map(constants).collect()
}
