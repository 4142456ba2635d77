//! Dependencies: what a variable follows from, and what each parameter acts on.
use crate::mechanism::definition::{DefinitionError, Mechanism, Role};
use crate::mechanism::linkage::{Body, Freedom, GROUND, Joint, Linkage, Point};
use crate::mechanism::loads::laws::spring::Spring;
use crate::mechanism::loads::laws::stop::Stop;
use crate::mechanism::loads::resolved::{Air, FrictionJoint, Loading, Surface, markers};
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::plane::Vec2;

/// What a variable's value follows from; a set of causes.
#[derive(Clone, Copy, Default)]
pub(super) struct Needs<'a> {
    /// The coordinates at the start: every joint.
    pub(super) closure: bool,
    /// One joint only, which places the body that states the start.
    pub(super) joint: Option<usize>,
    /// The stated start position.
    pub(super) position: bool,
    /// The stated start speed.
    pub(super) speed: bool,
    /// The kinetic energy of given rates.
    pub(super) inertia: bool,
    /// Every body's mass and centre of mass, one by one.
    pub(super) masses: bool,
    /// Sizes of these loads.
    pub(super) inputs: &'a [usize],
    /// Geometry or constants of these loads.
    pub(super) loads: &'a [usize],
    /// Whether what drives lose does not count.
    pub(super) lossless: bool,
    /// Place of this marker.
    pub(super) marker: Option<usize>,
    /// Static friction of the joints.
    pub(super) statics: bool,
    /// The stretch of bodies as rods, and whether they are rods.
    pub(super) elasticity: bool,
}

/// Depends on where every body is.
pub(super) const PLACED: Needs<'static> = Needs {
    closure: true,
    joint: None,
    position: true,
    speed: false,
    inertia: false,
    masses: false,
    inputs: &[],
    loads: &[],
    lossless: false,
    marker: None,
    statics: false,
    elasticity: false,
};

/// What a parameter acts on, found by changing it and comparing the resolved linkage.
pub(super) struct ParameterEffect {
    role: Role,
    joints: Vec<bool>,
    inertia: bool,
    masses: bool,
    loads: Vec<bool>,
    /// Whether it is an efficiency, which acts on nothing but what its drive loses.
    efficiency: bool,
    markers: Vec<bool>,
    statics: bool,
}

impl ParameterEffect {
    /// A number that acts on nothing here.
    fn none(role: Role, on: &Resolved) -> Self {
        Self {
            role,
            joints: vec![false; on.linkage.joints.len()],
            inertia: false,
            masses: false,
            loads: vec![false; on.loading.loads.len()],
            efficiency: false,
            markers: vec![false; on.markers.len()],
            statics: false,
        }
    }

    pub(super) fn meets(&self, needs: &Needs) -> bool {
        match self.role {
            Role::StartPosition => needs.position,
            Role::StartSpeed => needs.speed,
            Role::Elasticity => needs.elasticity,
            Role::Tolerance => false,
            Role::Geometry | Role::Inertia | Role::Load => {
                (needs.closure && self.joints.contains(&true))
                    || needs.joint.is_some_and(|j| self.joints[j])
                    || (needs.inertia && self.inertia)
                    || (needs.masses && self.masses)
                    || (!(needs.lossless && self.efficiency) && needs.loads.iter().any(|&l| self.loads[l]))
                    || needs.marker.is_some_and(|m| self.markers[m])
                    || (needs.statics && self.statics)
            }
        }
    }
}

/// Change every parameter a little and see what the resolved linkage does: numbers, flags, then the method if stated.
pub(super) fn effects(
    mechanism: &Mechanism,
    linkage: &Linkage,
    loading: &Loading,
    all_markers: &[Point],
) -> Result<Vec<ParameterEffect>, DefinitionError> {
    let before = Resolved::new(mechanism, loading, all_markers)?;
    let mut stated = mechanism.clone();
    let (mut roles, mut flags) = (Vec::new(), 0);
    stated.parameters(&mut |p, _| roles.push(p.role));
    stated.flags(&mut |_, _| flags += 1);
    let mut out = Vec::new();
    for (place, &role) in roles.iter().enumerate() {
        if matches!(role, Role::StartPosition | Role::StartSpeed | Role::Tolerance | Role::Elasticity) {
            out.push(ParameterEffect::none(role, &before));
            continue;
        }
        let mut changed = mechanism.clone();
        let mut places = 0..;
        changed.parameters(&mut |_, v| {
            if places.next() == Some(place) {
                *v = *v * 1.001 + 1e-4;
            }
        });
        // So that V_d stays above V_S, whichever changes.
        if let Some(friction) = &mut changed.friction {
            friction.kinetic_speed = friction.kinetic_speed.max(1.01 * friction.static_speed);
        }
        out.push(before.effect(role, &changed, linkage)?);
    }
    for place in 0..flags {
        let mut changed = mechanism.clone();
        let mut places = 0..;
        changed.flags(&mut |_, v| *v ^= places.next() == Some(place));
        out.push(before.effect(Role::Load, &changed, linkage)?);
    }
    if mechanism.solver.method.is_some() {
        out.push(ParameterEffect::none(Role::Elasticity, &before));
    }
    Ok(out)
}

/// What parameters may act on.
struct Resolved<'a> {
    linkage: Linkage,
    kinetic: Vec<[f64; 4]>,
    loading: &'a Loading,
    markers: &'a [Point],
}

impl<'a> Resolved<'a> {
    fn new(mechanism: &Mechanism, loading: &'a Loading, markers: &'a [Point]) -> Result<Self, DefinitionError> {
        let linkage = Linkage::loose(mechanism)?;
        Ok(Self { kinetic: kinetic_constants(&linkage.joints, &linkage.bodies), linkage, loading, markers })
    }

    /// How another mechanism differs, in a number with this role: masses place nothing, and what loads are does not change
    /// the linkage.
    fn effect(&self, role: Role, changed: &Mechanism, same: &Linkage) -> Result<ParameterEffect, DefinitionError> {
        let mut effect = ParameterEffect::none(role, self);
        match role {
            Role::Geometry => {
                let other = Linkage::loose(changed)?;
                // A prismatic joint's angle shows in its second body's.
                let offset = |l: &Linkage, j: usize| l.bodies[l.joints[j].second.body].offset;
                for (j, differs) in effect.joints.iter_mut().enumerate() {
                    let same = self.linkage.joints[j] == other.joints[j];
                    *differs = !same || offset(&self.linkage, j) != offset(&other, j);
                }
                self.compare_masses(&other.joints, &other.bodies, &mut effect);
                self.compare_loads(&Loading::new(changed, &other)?, &mut effect);
                effect.markers = self.markers.iter().zip(&markers(changed, &other)?).map(|(a, b)| a != b).collect();
            }
            Role::Inertia => {
                self.compare_masses(&self.linkage.joints, &Linkage::masses(changed)?, &mut effect);
                self.compare_loads(self.loading, &mut effect);
            }
            _ => self.compare_loads(&Loading::new(changed, same)?, &mut effect),
        }
        Ok(effect)
    }

    fn compare_masses(&self, joints: &[Joint], bodies: &[Body], effect: &mut ParameterEffect) {
        // Rounding of the same sum in other terms is no effect.
        let same = |(a, b): (&[f64; 4], &[f64; 4])| a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 1e-12 * x.abs());
        effect.inertia = !self.kinetic.iter().zip(&kinetic_constants(joints, bodies)).all(same);
        let mut pairs = self.linkage.bodies.iter().zip(bodies);
        effect.masses = pairs.any(|(a, b)| (a.mass, a.center, a.inertia) != (b.mass, b.center, b.inertia));
    }

    /// The masses must have been compared.
    fn compare_loads(&self, other: &Loading, effect: &mut ParameterEffect) {
        effect.statics = statics(self.loading) != statics(other);
        effect.efficiency = self.loading.drives != other.drives;
        for (l, differs) in effect.loads.iter_mut().enumerate() {
            let gravity = effect.masses && matches!(self.loading.loads[l], Load::Gravity(_));
            *differs = gravity || load_constants(self.loading, l) != load_constants(other, l);
        }
    }
}

/// What a load depends on: its unit load, and what sizes it.
#[derive(PartialEq)]
struct Constants<'a> {
    load: &'a Load,
    constant: Option<f64>,
    spring: Option<&'a Spring>,
    efficiency: Option<f64>,
    stop: Option<&'a Stop>,
    /// Density, flow and relative wind, and the surface.
    surface: Option<(f64, Vec2, bool, &'a Surface)>,
    /// Whether there is friction, and its pin.
    friction_joint: Option<(bool, &'a FrictionJoint)>,
}

fn load_constants(loading: &Loading, load: usize) -> Constants<'_> {
    let constant = load.checked_sub(loading.inputs.len()).and_then(|i| loading.constants.get(i));
    let surface = |air: &'_ Air| air.surfaces.iter().position(|s| (s.load..s.load + 3).contains(&load));
    let air = loading.air.as_ref().and_then(|air| surface(air).map(|i| (air, &air.surfaces[i])));
    let friction_joints = loading.friction.as_ref();
    Constants {
        load: &loading.loads[load],
        constant: constant.copied(),
        spring: load.checked_sub(loading.sized()).and_then(|i| loading.springs.get(i)),
        efficiency: loading.drives.get(load).and_then(|d| d.efficiency),
        stop: loading.stops.iter().find(|s| s.load == load),
        surface: air.map(|(air, surface)| (air.density, air.flow, air.relative_wind, surface)),
        friction_joint: friction_joints
            .and_then(|f| f.friction_joints.iter().find(|p| p.load == load).map(|p| (f.enabled, p))),
    }
}

/// What static friction depends on besides positions: whether there is any, pin radii and coefficients.
fn statics(loading: &Loading) -> Vec<(bool, f64, f64)> {
    let friction_joints = loading.friction.iter().flat_map(|f| f.friction_joints.iter().map(|p| (f.enabled, p)));
    friction_joints.map(|(enabled, p)| (enabled, p.radius, p.law.static_coefficient)).collect()
}

/// What every body's kinetic energy depends on: about its pivot alone if that is fixed, else mass, centre and inertia.
fn kinetic_constants(joints: &[Joint], bodies: &[Body]) -> Vec<[f64; 4]> {
    let mut pivots = vec![None; bodies.len()];
    for joint in joints.iter().filter(|j| j.freedom == Freedom::Revolute).rev() {
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
    bodies.iter().zip(&pivots).map(constants).collect()
}
