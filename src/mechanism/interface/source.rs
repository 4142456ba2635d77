//! What the declarations of variables read: the definition, resolved.
use super::needs::{Needs, placed};
use crate::mechanism::definition::{ControlState, DefinitionError, Mechanism};
use crate::mechanism::linkage::{Freedom, GROUND, Linkage, Point};
use crate::mechanism::loads::resolved::{Loading, MOTION, markers};
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::quantity::{Output, Quantity};
use crate::numerics::order;
use std::borrow::Cow;
use std::ops::Range;

/// A definition with its linkage and loads.
pub(super) struct Source<'a> {
    pub mechanism: &'a Mechanism,
    pub linkage: Cow<'a, Linkage>,
    pub loading: Cow<'a, Loading>,
    pub markers: Cow<'a, [Point]>,
    /// Inputs that act on the motion, by index.
    pub inputs: Vec<usize>,
    /// All loads, by index.
    pub loads: Vec<usize>,
    /// The joint that holds the body that states the start to the ground, and this body; none if no joint does.
    held: Option<(usize, usize)>,
}

impl<'a> Source<'a> {
    /// # Errors
    /// The definition does not resolve.
    pub fn new(mechanism: &'a Mechanism) -> Result<Self, DefinitionError> {
        let linkage = Linkage::new(mechanism)?;
        let (loading, markers) = (Loading::new(mechanism, &linkage)?, markers(mechanism, &linkage)?);
        Ok(Self::resolved(mechanism, Cow::Owned(linkage), Cow::Owned(loading), Cow::Owned(markers)))
    }

    /// Of a mechanism with its linkage as drawn, its loads and its markers.
    pub fn of(mechanism: &'a Mechanism, (linkage, loading, markers): (&'a Linkage, &'a Loading, &'a [Point])) -> Self {
        Self::resolved(mechanism, Cow::Borrowed(linkage), Cow::Borrowed(loading), Cow::Borrowed(markers))
    }

    fn resolved(
        mechanism: &'a Mechanism,
        linkage: Cow<'a, Linkage>,
        loading: Cow<'a, Loading>,
        markers: Cow<'a, [Point]>,
    ) -> Self {
        let loads = (0..loading.loads.len()).collect();
        let held = held(mechanism, &linkage);
        let mut source = Self { mechanism, linkage, loading, markers, inputs: Vec::new(), loads, held };
        let sizes = (0..source.loading.inputs.len()).filter(|load| !source.is_hydraulic(*load));
        if !mechanism.is_massless() {
            source.inputs = sizes.chain(source.airspeed()).chain(source.locks()).collect();
        }
        source
    }

    /// Index of the airspeed among the inputs: after those that size loads and the demanded accelerations.
    pub fn airspeed(&self) -> Option<usize> {
        self.loading.air.as_ref().map(|_| self.loading.inputs.len() + self.loading.drives.len() + self.loading.ports())
    }

    /// Whether a load is that of a drive with a hydraulic circuit or a cylinder of a network.
    pub fn is_hydraulic(&self, load: usize) -> bool {
        self.loading.hydraulic_loads().contains(&load)
    }

    /// Indices of the locks among the inputs.
    pub fn locks(&self) -> Range<usize> {
        let first = self.loading.inputs.len()
            + self.loading.drives.len()
            + self.loading.ports()
            + usize::from(self.loading.air.is_some());
        first..first + self.loading.locks.len()
    }

    /// Inputs and loads that an output follows from, with those of a drive whose motion can be prescribed; none where
    /// no drive has a motion.
    pub fn moved(&self, (inputs, loads): (&[usize], &[usize]), is_moved: bool) -> Option<(Vec<usize>, Vec<usize>)> {
        let motion = self.loading.motion.as_ref().filter(|_| is_moved)?;
        let given = motion.first_input.map_or(0..0, |first| first..first + MOTION);
        let switch = (!self.mechanism.is_massless()).then_some(self.locks().end);
        let inputs = inputs.iter().copied().chain(given).chain(switch).collect();
        let loads = loads.iter().copied().chain([motion.load]).collect();
        Some((order::distinct(inputs), order::distinct(loads)))
    }

    /// Whether a variable needs masses. Without masses the motion is prescribed, so that accelerations follow from it;
    /// if no drive has a motion, there are none.
    pub fn needs_masses(&self, quantity: Quantity) -> bool {
        let Quantity::Output(output) = quantity else {
            use Quantity::{Contact, Indicator, Prescribed, SelfLocking, State, Sticking};
            return matches!(quantity, Contact | Indicator(_) | Prescribed | SelfLocking(_) | State(_) | Sticking);
        };
        match output {
            Output::Angle { order, .. }
            | Output::JointPosition { order, .. }
            | Output::Displacement { order, .. }
            | Output::Marker { order, .. } => order > 1 && self.loading.motion.is_none(),
            Output::PressureAngle { .. } | Output::SpringForce { .. } | Output::Frame { .. } => false,
            _ => true,
        }
    }

    /// Whether hydraulics or controllers have states with start values.
    pub fn has_states_at_start(&self) -> bool {
        self.mechanism.has_hydraulics() || self.mechanism.control_states().next().is_some()
    }

    /// Inputs that decide the forces of drives at the start, ascending: forces and commands of drives whose forces
    /// follow those of their controllers.
    pub fn followed(&self) -> Vec<usize> {
        let follows = |(drive, state): (usize, ControlState)| {
            let law = self.loading.drives[drive].law.as_ref()?;
            (state == ControlState::Force).then(|| [drive].into_iter().chain(law.commands()))
        };
        let all = self.loading.control_states().filter(|_| self.mechanism.has_forces_by_inputs());
        order::distinct(all.filter_map(follows).flatten().collect())
    }

    /// Whether joints have friction when `friction.enabled` is true.
    pub fn has_friction(&self) -> bool {
        self.loading.friction.as_ref().is_some_and(|f| !f.friction_joints.is_empty())
    }

    /// What the acceleration follows from.
    pub fn acceleration(&self) -> Needs<'_> {
        if self.mechanism.is_massless() {
            return Needs { speed: true, ..placed() };
        }
        let circuit = self.has_states_at_start();
        Needs { speed: true, inertia: true, inputs: &self.inputs, loads: &self.loads, circuit, ..placed() }
    }

    /// What the positions of bodies follow from: the stated start alone if one joint holds the body that states it to
    /// the ground and no other body is named, else everything.
    pub fn position(&self, bodies: &[usize]) -> Needs<'static> {
        let held = self.held.filter(|(_, held)| bodies.iter().all(|body| body == held || *body == GROUND));
        let joint = held.map(|(joint, _)| joint);
        if joint.is_some() { Needs { joint, position: true, ..Needs::default() } } else { placed() }
    }

    /// What the slip speed of the friction joint with this load follows from: the stated start speed and the pin radius
    /// if the joint holds the body that states the start to the ground, else the configuration too.
    pub fn slip_speed(&self, load: usize) -> Needs<'static> {
        let placed = if self.displacement(load).closure { placed() } else { Needs::default() };
        Needs { speed: true, radius: Some(load), ..placed }
    }

    /// What the displacement of a load follows from, apart from its own constants.
    pub fn displacement(&self, load: usize) -> Needs<'static> {
        match *self.loading.loads[load].along() {
            Load::Pair { first, second, .. } => self.position(&[first.body, second.body]),
            Load::Couple { first, second, .. } => self.position(&[first, second]),
            Load::Slide { joint, .. } => {
                let joint = &self.linkage.joints[joint];
                self.position(&[joint.first.body, joint.second.body])
            }
            _ => placed(),
        }
    }
}

/// The first joint that holds the body that states the start to the ground, and this body.
fn held(mechanism: &Mechanism, linkage: &Linkage) -> Option<(usize, usize)> {
    let start = &mechanism.start;
    let stated = start.body.as_ref().and_then(|name| linkage.carrier(mechanism, name)).map(|(body, _)| body);
    linkage.joints.iter().enumerate().find_map(|(index, joint)| {
        let ends = [joint.first.body, joint.second.body];
        let held = match (stated, &start.joint) {
            (Some(body), _) => (joint.freedom == Freedom::Revolute && ends.contains(&body)).then_some(body),
            // The pin of a slot turns freely, so its position places no body.
            (None, Some(name)) => {
                let places = joint.name == *name && !joint.freedom.turns();
                ends.into_iter().find(|b| *b != GROUND).filter(|_| places)
            }
            (None, None) => None,
        };
        held.filter(|_| ends.contains(&GROUND)).map(|body| (index, body))
    })
}
