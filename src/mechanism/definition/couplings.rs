//! Couplings: gears, racks, belts and cams between two bodies, with the checks that need no geometry.
use super::Mechanism;
use super::cams::{CamSegment, Follower, of_points, of_segments};
use super::interpolation::Interpolation;
use super::refusal::refused;
use crate::format::{
    DefinitionError, Described, Faults, Key, Keyed, Owner, Range, Role, Visit, curve, either, element, keys, number,
    point, words,
};
use crate::mechanism::definition::bodies::JointKind;
use crate::numerics::periodic::Periodic;
use crate::variables::Unit::{Metre, Newton, One, Radian};

/// Pressure angle of teeth where the file states none [rad]: 20 degrees (ISO 53).
const PRESSURE_ANGLE: f64 = 20.0 * std::f64::consts::PI / 180.0;

keys! {
    /// A coupling (gears, rack, belt or cam) makes the motion u2 of one body a function of the motion u1 of another
    /// body: u2 = F(u1). The motion u1 is the angle of the first wheel relative to the carrier. The motion u2 is the
    /// angle of the second wheel relative to the carrier, or the position of the rack. For gears, racks and belts the
    /// function is u2 = ratio * u1 + phase.
    pub struct Coupling {
        /// Kind of coupling. `gears`: two gear wheels. `rack`: a gear wheel and a rack. `belt`: a belt or chain around
        /// two pulleys. `elliptic_gears`: two equal elliptic gear wheels. `cam`: a disc cam and its follower. The type
        /// `screw` is always an error: define a screw by the key `screw` of an actuator.
        kind as "type": CouplingKind => Key::PLAIN.required();
        /// Centre (`body.point`) of the first wheel or of the cam. The definition must have a revolute joint between
        /// the point `first` and the carrier of the coupling.
        first: String => point().required();
        /// Centre (`body.point`) of the second wheel or of an oscillating follower. The definition must have a revolute
        /// joint between the point `second` and the carrier of the coupling.
        second: Option<String> => point();
        /// Body that carries both wheels of the coupling. Default: the ground.
        carrier: Option<String> => element().absent("\"ground\"");
        /// Prismatic joint in which the rack or the translating follower slides on the carrier of the coupling.
        joint: Option<String> => element();
        /// Elliptic gears: eccentricity of both pitch curves [1], from 0 to 0.9.
        eccentricity: Option<f64> =>
            number(One, Range::Eccentricity).parameter(Role::Geometry, "Eccentricity of the pitch curves");
        /// Elliptic gears: number of lobes of each wheel [1], a whole number. With 1 lobe the pitch curve of the wheel
        /// is an ellipse that turns about its focus.
        lobes: Option<f64> => number(One, Range::Count).parameter(Role::Geometry, "Number of lobes of each \
            wheel").absent("1");
        /// Elliptic gears: direction from the centre of rotation of the first wheel to the nearest vertex of its pitch
        /// curve, as an angle in the frame of the first wheel [rad].
        vertex_angle: Option<f64> =>
            number(Radian, Range::Turn).parameter(Role::Geometry, "Direction from the centre of the first wheel of @ \
                to the nearest vertex of the pitch curve, as an angle in the frame of the wheel").absent("0");
        /// Cam: shape of the follower.
        follower: Option<Follower>;
        /// Cam: point of the follower (`body.point`): the centre of the roller, or a point on the flat face.
        contact: Option<String> => point();
        /// Cam: radius of the base circle [m], > 0. At lift 0 the follower touches the base circle.
        base_radius: Option<f64> =>
            number(Metre, Range::Length).parameter(Role::Geometry, "Radius of the base circle");
        /// Cam: radius of the roller [m], > 0.
        roller_radius: Option<f64> => number(Metre, Range::Length).parameter(Role::Geometry, "Radius of the roller");
        /// Cam with a flat-faced follower: direction along the flat face, as an angle in the frame of the follower
        /// [rad]. Default: perpendicular to the direction of sliding for a translating follower, and along the x axis
        /// of the follower for an oscillating follower.
        face_angle: Option<f64> => number(Radian, Range::Turn).parameter(Role::Geometry, "Direction along the flat \
            face of the follower of @, as an angle in the frame of the follower");
        /// Cam: angle of the cam at which the first segment starts, or at which the list `points` has the angle 0
        /// [rad].
        start_angle: Option<f64> =>
            number(Radian, Range::Turn).parameter(Role::Geometry, "Angle of @ at which the \
                first segment or the table of the lift starts").absent("0");
        /// Cam: lift over one revolution, as a list of segments.
        segments: Option<Vec<CamSegment>>;
        /// Cam: lift over one revolution, as pairs of cam angle and lift [rad, m or rad] in the order of increasing
        /// angle. The lift is in m for a follower that slides, and in rad for a follower that turns. Use the key
        /// `points` in place of `segments`.
        points: Option<Vec<[f64; 2]>> => curve([Radian; 2], [Metre, Radian], Range::Finite);
        /// Cam: kind of the curve through `points`. `spline`: a smooth curve, which may overshoot the points.
        /// `monotone`: a curve that rises only where the points rise, and falls only where the points fall.
        interpolation: Option<Interpolation> => Key::PLAIN.absent("\"spline\"");
        /// Cam: true if a groove or a second cam holds the follower in both directions.
        grooved: Option<bool> => Key::PLAIN.absent("false");
        /// Cam: coefficient of static friction between cam and follower [1], >= 0. A cam without `static_coefficient`
        /// and `kinetic_coefficient` has no friction. If a cam has only one of `static_coefficient` and
        /// `kinetic_coefficient`, the key `friction` states the missing coefficient. For a roller, state the friction
        /// coefficient of the roller's pin, multiplied by the pin radius and divided by `roller_radius`.
        static_coefficient: Option<f64> => number(One, Range::NonNegative)
            .parameter(Role::Law, "Coefficient of static friction of the contact of @");
        /// Cam: coefficient of kinetic friction between cam and follower [1], >= 0.
        kinetic_coefficient: Option<f64> => number(One, Range::NonNegative)
            .parameter(Role::Law, "Coefficient of kinetic friction of the contact of @");
        /// Gears: number of teeth of the first wheel [1], > 0. Only the ratio of `first_teeth` to `second_teeth`
        /// matters.
        first_teeth: Option<f64> => number(One, Range::Positive).parameter(Role::Geometry, "Number of teeth of the \
            first wheel");
        /// Gears: number of teeth of the second wheel [1], > 0. Only the ratio of `first_teeth` to `second_teeth`
        /// matters.
        second_teeth: Option<f64> => number(One, Range::Positive)
            .parameter(Role::Geometry, "Number of teeth of the second wheel");
        /// Gears: true if the wheel with more teeth is an internal gear (ring gear).
        internal: Option<bool> => Key::PLAIN.absent("false");
        /// Belt: radius of the first pulley [m], > 0.
        first_radius: Option<f64> =>
            number(Metre, Range::Length).parameter(Role::Geometry, "Radius of the first pulley");
        /// Belt: radius of the second pulley [m], > 0.
        second_radius: Option<f64> =>
            number(Metre, Range::Length).parameter(Role::Geometry, "Radius of the second pulley");
        /// Belt: true if the two spans of the belt cross. The pulleys of a crossed belt turn in opposite directions.
        crossed: Option<bool> => Key::PLAIN.absent("false");
        /// Belt: tension of each span of the belt at rest without load [N], >= 0.
        pretension: Option<f64> =>
            number(Newton, Range::NonNegative)
                .parameter(Role::Load, "Tension of each span of @ at rest without load").absent("0");
        /// Rack: pitch radius of the wheel [m], > 0.
        radius: Option<f64> => number(Metre, Range::Length).parameter(Role::Geometry, "Pitch radius of the wheel");
        /// Rack: side of the wheel centre on which the rack lies, looking in the direction of the joint axis.
        side: Option<Side> => Key::PLAIN.absent("\"right\"");
        /// Gears, elliptic gears, rack: pressure angle of the teeth [rad], from 0 to 1.2 rad. Default: 20 degrees.
        pressure_angle: Option<f64> => number(Radian, Range::Pressure)
            .parameter(Role::Load, "Pressure angle of the teeth");
        /// Position of the rack, or angle of the second wheel, at the angle 0 of the first wheel [m or rad]. Default:
        /// the phase that follows from the positions in `guess`. The key `phase` is not allowed for a cam.
        phase: Option<f64> => either([Metre, Radian], Range::Coordinate).parameter(Role::Geometry, "");
        /// Gears, rack, belt: efficiency of the coupling (fraction of the power that is not lost) [1], > 0 and <= 1.
        /// Without the key `backward_efficiency`, the efficiency of the coupling is equal in both directions of the
        /// power flow. Without the key `efficiency` the coupling has no losses.
        efficiency: Option<f64> => number(One, Range::Fraction).parameter(Role::Load, "Efficiency");
        /// Gears, rack, belt: efficiency of the coupling for the power flow from the second body to the first body, 0
        /// to 1 [1]. With `backward_efficiency` = 0 the coupling is self-locking: the second body cannot drive the
        /// first body. The key `backward_efficiency` needs the key `efficiency`.
        backward_efficiency: Option<f64> => number(One, Range::Unit)
            .parameter(Role::Load, "Efficiency of @ for the power flow from the second body to the first body");
    }
}

words! {
    /// Kind of a coupling.
    pub enum CouplingKind {
        /// Two gear wheels in mesh.
        Gears = "gears",
        /// A gear wheel in mesh with a rack.
        Rack = "rack",
        /// A belt or a chain around two pulleys, without slip.
        Belt = "belt",
        /// Two equal elliptic gear wheels in mesh.
        EllipticGears = "elliptic_gears",
        /// A disc cam and its follower.
        Cam = "cam",
        /// A screw, which is refused: its axis lies in the plane.
        Screw = "screw",
    }

    /// Side of a wheel.
    pub enum Side {
        /// Left.
        Left = "left",
        /// Right.
        Right = "right",
    }
}

impl CouplingKind {
    /// Keys that a coupling of this kind must have, and the others that it may have, next to `type`, `first` and, but
    /// for a cam, `phase`.
    pub fn keys(self) -> (&'static [&'static str], &'static [&'static str]) {
        match self {
            Self::Gears => (
                &["second", "first_teeth", "second_teeth"],
                &["carrier", "internal", "pressure_angle", "efficiency", "backward_efficiency"],
            ),
            Self::Rack => (&["joint", "radius"], &["side", "pressure_angle", "efficiency", "backward_efficiency"]),
            Self::Belt => (
                &["second", "first_radius", "second_radius"],
                &["carrier", "crossed", "pretension", "efficiency", "backward_efficiency"],
            ),
            Self::EllipticGears => {
                (&["second", "eccentricity"], &["carrier", "lobes", "vertex_angle", "pressure_angle"])
            }
            Self::Cam => (
                &["follower", "contact", "base_radius"],
                &[
                    "joint",
                    "second",
                    "carrier",
                    "roller_radius",
                    "face_angle",
                    "start_angle",
                    "segments",
                    "points",
                    "interpolation",
                    "grooved",
                    "static_coefficient",
                    "kinetic_coefficient",
                ],
            ),
            Self::Screw => (&[], &[]),
        }
    }
}

impl Coupling {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let is_rotary = self.kind != CouplingKind::Rack;
        let kind = match self.kind {
            CouplingKind::Cam => "the cam ",
            CouplingKind::Belt => "the belt ",
            CouplingKind::Rack => "the rack ",
            _ => "the gears ",
        };
        // Wheels and what all couplings have; what makes their ratio vary; loads.
        for part in 0..3 {
            let refined = |key: Key| {
                let is_of = match key.name {
                    _ if matches!(key.role, Some(Role::Load | Role::Law)) => 2,
                    "first_teeth" | "second_teeth" | "first_radius" | "second_radius" | "radius" | "phase" => 0,
                    _ => 1,
                };
                let key = match (key.name, is_rotary) {
                    ("phase", false) => Key { words: "Position of @ at the angle 0 of the wheel", ..key },
                    ("phase", true) => Key {
                        words: "Angle of the second wheel of @ at the angle 0 of the first wheel",
                        range: Range::Turn,
                        ..key
                    },
                    _ => key,
                };
                (is_of == part).then_some(key)
            };
            Owner { group: Some("couplings"), kind, name, is_rotary }.parameters(self, &refined, visit);
        }
    }

    /// State what the file leaves out.
    fn complete(&mut self) {
        if matches!(self.kind, CouplingKind::Gears | CouplingKind::EllipticGears | CouplingKind::Rack) {
            self.pressure_angle.get_or_insert(PRESSURE_ANGLE);
        }
    }
}

impl Mechanism {
    /// Faults of the couplings, which are completed.
    pub(super) fn check_couplings(&mut self, faults: &mut Faults) {
        self.couplings.iter_mut().for_each(|(_, coupling)| coupling.complete());
        for (name, coupling) in self.couplings.iter() {
            faults.keep(self.check_coupling(name, coupling));
        }
    }

    fn check_coupling(&self, name: &str, coupling: &Coupling) -> Result<(), DefinitionError> {
        let key = |k: &str| format!("couplings.{name}.{k}");
        let refused = |k: &str, message: &str| Err(DefinitionError::key(key(k), message));
        if coupling.kind == CouplingKind::Screw {
            let message = "the axis of a screw lies in the plane, so the rotation of the screw is not a planar \
                           motion: use the key `screw` of an actuator, or write \"type\": \"rack\" for a wheel that \
                           turns in the plane";
            return refused("type", message);
        }
        if coupling.efficiency.is_some() && matches!(coupling.kind, CouplingKind::EllipticGears | CouplingKind::Cam) {
            let message = "a coupling with a variable ratio cannot have losses: remove the key `efficiency`, and use \
                           the efficiency of a drive or the friction of joints";
            return refused("efficiency", message);
        }
        if coupling.backward_efficiency.is_some() && coupling.efficiency.is_none() {
            let message = "this key needs the efficiency of the other direction: add the key `efficiency`";
            return refused("backward_efficiency", message);
        }
        let (needed, allowed) = coupling.kind.keys();
        let others =
            if coupling.kind == CouplingKind::Cam { &["type", "first"][..] } else { &["type", "first", "phase"] };
        let mut own = coupling.clone();
        for (index, Key { name: k, .. }) in Coupling::TABLE.keys.iter().enumerate() {
            let (is_given, is_needed) = (own.slot(index).is_given(), needed.contains(k));
            // A cam says more about a phase.
            if is_given && !is_needed && !allowed.contains(k) && !others.contains(k) && *k != "phase" {
                let keys = [&others[1..2], needed, allowed, &others[2..]].concat().join(", ");
                return refused(k, &format!("this type of coupling cannot have this key; its keys are {keys}"));
            }
            if !is_given && is_needed {
                return refused(k, "this type of coupling needs this key: add the key");
            }
        }
        self.point(key("first"), &coupling.first)?;
        if let Some(second) = &coupling.second {
            self.point(key("second"), second)?;
        }
        if let Some(carrier) = &coupling.carrier {
            self.named_body(&key("carrier"), carrier)?;
        }
        if let Some(joint) = &coupling.joint
            && self.named_joint(&key("joint"), joint)?.kind != JointKind::Prismatic
        {
            let what = if coupling.kind == CouplingKind::Cam { "follower" } else { "rack" };
            return refused(
                "joint",
                &format!("this joint is not prismatic: name the prismatic joint in which the {what} slides"),
            );
        }
        if let Some(contact) = &coupling.contact {
            self.point(key("contact"), contact)?;
        }
        let coefficients = [
            ("static_coefficient", coupling.static_coefficient),
            ("kinetic_coefficient", coupling.kinetic_coefficient),
        ];
        if let Some((k, _)) = coefficients.into_iter().find(|(_, value)| value.is_some()) {
            if self.friction.is_none() {
                return refused(
                    k,
                    "this key has no effect without friction: add the key `friction`, or remove this \
                    key",
                );
            }
            if coupling.grooved == Some(true) {
                let message = "the friction of a cam acts on the side of the cam only, but a groove has a second \
                               side: remove this key, or remove `grooved`";
                return refused(k, message);
            }
        }
        if coupling.kind == CouplingKind::Cam {
            coupling.check_cam(&format!("couplings.{name}"))?;
        }
        if coupling.internal == Some(true) && coupling.first_teeth == coupling.second_teeth {
            return refused(
                "internal",
                "a wheel cannot run inside a ring with the same number of teeth: change one of the numbers of teeth",
            );
        }
        Ok(())
    }
}

impl Coupling {
    /// The lift of a cam over one revolution. `key`: the key of the coupling.
    ///
    /// # Errors
    /// Segments that are no revolution or do not return; points of no function.
    pub fn lift(&self, key: &str) -> Result<Periodic, DefinitionError> {
        match (&self.segments, &self.points) {
            (Some(segments), None) => of_segments(segments, key, self.joint.is_none()),
            (None, Some(points)) => of_points(points, self.interpolation.unwrap_or_default(), key),
            (Some(_), Some(_)) => refused(
                format!("{key}.points"),
                "the key `segments` already defines the lift: remove the key `points` or the key `segments`",
            ),
            (None, None) => refused(
                key.to_owned(),
                "the cam has no lift: add the key `segments`, or the key \
                `points` with pairs [angle, lift]",
            ),
        }
    }

    /// Faults of the keys of a cam.
    pub(super) fn check_cam(&self, key: &str) -> Result<(), DefinitionError> {
        let at = |k: &str| format!("{key}.{k}");
        match (&self.joint, &self.second) {
            (Some(_), Some(_)) => {
                return refused(
                    at("second"),
                    "a follower has either the key `joint`, if it slides, or the key `second`, if it turns; remove one \
                     of the two keys",
                );
            }
            (None, None) => {
                let message = "the follower has no motion: add the key `joint` for a follower that slides, or the \
                               key `second` (the centre of rotation) for a follower that turns";
                return refused(key.to_owned(), message);
            }
            (Some(_), None) if self.carrier.is_some() => {
                return refused(
                    at("carrier"),
                    "the joint of the follower defines the carrier of the cam: remove the key `carrier`",
                );
            }
            _ => {}
        }
        if self.interpolation.is_some() && self.points.is_none() {
            let message = "only a lift that points define has an interpolation, but this cam has no points: remove \
                           the key `interpolation`, or add the key `points`";
            return refused(at("interpolation"), message);
        }
        if self.phase.is_some() {
            return refused(
                at("phase"),
                "the radius of the base circle defines the position of the follower at lift 0: remove the key \
                 `phase`",
            );
        }
        match (self.follower, self.roller_radius, self.face_angle) {
            (Some(Follower::Roller), None, _) => {
                return refused(at("roller_radius"), "a roller follower needs this key: add the key `roller_radius`");
            }
            (Some(Follower::Roller), _, Some(_)) => {
                return refused(
                    at("face_angle"),
                    "a roller follower has no flat face: remove `face_angle`, or write \"follower\": \"flat\"",
                );
            }
            (Some(Follower::Flat), Some(_), _) => {
                return refused(
                    at("roller_radius"),
                    "a flat follower has no roller: remove `roller_radius`, or write \"follower\": \"roller\"",
                );
            }
            _ => {}
        }
        self.lift(key).map(|_| ())
    }
}
