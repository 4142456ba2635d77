//! Bodies, points on them whose motion is asked for, joints, and the friction in these.
use crate::format::{
    AXES, Flag, Key, Named, Owner, Parameter, Range, Role, Visit, curve, either, keys, number, point, words,
};
use crate::variables::Unit::{Kilogram, KilogramSquareMetre, Metre, MetrePerSecond, Newton, NewtonMetre, One, Radian};

keys! {
    /// The object `drawn` states coordinates of the body's points in the mechanism frame, from a drawing that shows the
    /// mechanism in one position. From the coordinates in `drawn`, the program computes lengths, points in the frame of
    /// the body, and the guess.
    pub struct Drawn {
        /// Coordinates of the body's point `origin` in the drawing [m].
        origin: [f64; 2] => number(Metre, Range::Coordinate).required();
        /// Coordinates of the body's point `end` in the drawing [m]. The x axis of the body points from `origin` to
        /// `end`. The distance between `origin` and `end` is the length of the body.
        end: Option<[f64; 2]> => number(Metre, Range::Coordinate);
        /// Angle in the drawing from the X axis of the mechanism frame to the x axis of the body [rad]. The key `angle`
        /// is not allowed together with `end`.
        angle: Option<f64> => number(Radian, Range::Finite).absent("0");
        /// Coordinates of additional points of the body in the drawing, by name [m].
        points: Named<[f64; 2]> => number(Metre, Range::Coordinate);
        /// Coordinates of the body's centre of mass in the drawing [m].
        center: Option<[f64; 2]> => number(Metre, Range::Coordinate);
    }
}

keys! {
    /// Each body is rigid and has its own coordinate system, the body frame. The point `origin` is the origin of the
    /// body frame. The x axis passes through the point `end`, at the distance `length` from the origin.
    pub struct Body {
        /// Point (`body.point`) of another body, to which the origin of the present body is rigidly fixed.
        fixed_to: Option<String> => point();
        /// Angle from the x axis of the body in `fixed_to` to the x axis of the present body [rad]. The key `angle` is
        /// allowed only together with `fixed_to`.
        angle: Option<f64> => number(Radian, Range::Finite).parameter(Role::Geometry, "Angle of the x axis of @, from \
            the x axis of the body to which it is fixed").absent("0");
        /// Distance from the point `origin` to the point `end`, along the body's x axis [m], from 1e-100 to 1e100.
        length: Option<f64> => number(Metre, Range::Length).parameter(Role::Geometry, "Length");
        /// Mass of the body [kg], >= 0. If no body has a mass or an inertia, the FMU computes only the motion, without
        /// forces.
        mass: Option<f64> => number(Kilogram, Range::NonNegative).parameter(Role::Inertia, "Mass").absent("0");
        /// Mass distribution of the body. With `uniform_rod` the mass is distributed evenly from the point `origin` to
        /// the point `end`. Without the key `shape`, the keys `center` and `inertia` state the mass distribution.
        shape: Option<Shape>;
        /// Centre of mass in the frame of the body [m]. The key `center` is not allowed together with `shape`.
        center: Option<[f64; 2]> =>
            number(Metre, Range::Coordinate).parameter(Role::Inertia, "Centre of mass").absent("[0, 0]");
        /// Moment of inertia about the centre of mass [kg.m2], >= 0. The key `inertia` is not allowed together with
        /// `shape`.
        inertia: Option<f64> => number(KilogramSquareMetre, Range::NonNegative)
            .parameter(Role::Inertia, "Moment of inertia about the centre of mass").absent("0");
        /// Axial stiffness E A of the body as an elastic rod between its two joints, used only by the method
        /// `rigid_fem` (key `solver.method`) [N], > 0. The key `axial_stiffness` is not allowed together with
        /// `fixed_to`.
        axial_stiffness: Option<f64> =>
            number(Newton, Range::Positive).parameter(Role::Elasticity, "Axial stiffness E A");
        /// Additional points of the body by name: coordinates [x, y] in the frame of the body [m].
        points: Named<[f64; 2]> => number(Metre, Range::Coordinate).parameter(Role::Geometry, "Point");
        /// Coordinates of the body's points in a drawing that shows the mechanism in one position. Use the key `drawn`
        /// in place of `length`, `points` and `center`.
        drawn: Option<Drawn> => Key::PLAIN.brief();
    }

    /// A marker is a point whose position, velocity and acceleration are outputs of the FMU.
    pub struct Marker {
        /// Point (`body.point`) whose motion is an output.
        at: String => point().required();
    }

    /// A joint connects a point of a first body with a point of a second body.
    pub struct Joint {
        /// Kind of joint. `revolute`: a pin joint, in which the two points coincide. `prismatic`: a sliding joint,
        /// whose second point moves along a line through its first point. The angle between the two bodies of a
        /// prismatic joint is constant. `slot`: a pin in a curved slot or track. The pin is at the second point of the
        /// joint. The slot is an arc or a smooth curve that is fixed to the first body of the joint.
        kind as "type": JointKind => Key::PLAIN.required();
        /// Point (`body.point`) of the first body. The reaction outputs of the joint are the force of the first body on
        /// the second body.
        first: String => point().required();
        /// Point (`body.point`) of the second body.
        second: String => point().required();
        /// Allowed only for a prismatic joint: direction of sliding, as an angle in the frame of the first body [rad].
        axis_angle: Option<f64> =>
            number(Radian, Range::Finite).parameter(Role::Geometry, "Direction of sliding in @, as an angle \
                in the frame of the first body").absent("0");
        /// Allowed only for a prismatic joint: angle from the x axis of the first body to the x axis of the second body
        /// [rad].
        angle: Option<f64> =>
            number(Radian, Range::Finite).parameter(Role::Geometry, "Angle from the x axis of the first body to the x \
                axis of the second body in @").absent("0");
        /// Allowed only for a slot: radius of an arc-shaped slot [m], > 0. The centre of the arc is the first point of
        /// the joint.
        radius: Option<f64> =>
            number(Metre, Range::Length).parameter(Role::Geometry, "Radius of @");
        /// Allowed only for a slot with `radius`: direction from the arc centre to the start of the slot, as an angle
        /// in the frame of the first body [rad]. The position of the joint is measured anticlockwise from the start of
        /// the slot.
        from_angle: Option<f64> => number(Radian, Range::Turn)
            .parameter(Role::Geometry, "Direction from the centre to the start of @").absent("0");
        /// Allowed only for a slot with `radius`: direction from the arc centre to the end of the slot, as an angle in
        /// the frame of the first body [rad]. `to_angle` must be larger than `from_angle`. Default: the slot extends
        /// over one full revolution.
        to_angle: Option<f64> => number(Radian, Range::Turn)
            .parameter(Role::Geometry, "Direction from the centre to the end of @");
        /// Allowed only for a slot: points [x, y] of a curved slot, relative to the first point of the joint, in the
        /// axes of the first body [m, m]. The slot is a smooth curve through the points of `path`. The position of the
        /// joint increases in the order of the points of `path`.
        path: Option<Vec<[f64; 2]>> => curve([Metre; 2], [Metre; 2], Range::Coordinate);
        /// Allowed only for a revolute joint: radius of the pin, for the friction torque [m], >= 0. Without the key
        /// `pin_radius` a revolute joint has no friction due to its reaction.
        pin_radius: Option<f64> =>
            number(Metre, Range::NonNegative).parameter(Role::Load, "Radius of the pin in @");
        /// Coefficient of static friction in the joint [1], >= 0. Default: the `static_coefficient` of the key
        /// `friction`.
        static_coefficient: Option<f64> =>
            number(One, Range::NonNegative).parameter(Role::Law, "Coefficient of static friction in @");
        /// Coefficient of kinetic friction in the joint [1], >= 0. Default: the `kinetic_coefficient` of the key
        /// `friction`.
        kinetic_coefficient: Option<f64> =>
            number(One, Range::NonNegative).parameter(Role::Law, "Coefficient of kinetic friction in @");
        /// Constant friction force of a prismatic joint or a slot, or constant friction torque of a revolute joint [N
        /// or N.m], >= 0. The constant friction `frictionloss` does not depend on the force in the joint, and can hold
        /// the joint at rest. The key `frictionloss` does not need the key `friction`.
        frictionloss: Option<f64> => either([Newton, NewtonMetre], Range::NonNegative)
            .parameter(Role::Law, "Constant friction force or torque in @").absent("0").brief();
        /// Conveyor: start value of the input `<name>.surface_speed`, the speed of the sliding surface of the first
        /// body [m/s]. A belt, a chain or a sleeve moves this surface along the axis of a prismatic joint, along a slot
        /// or around the pin of a revolute joint. The surface speed is positive in the direction in which the position
        /// or the angle of the joint increases. Friction in the joint acts against the slip speed, which is the speed
        /// of the second body relative to the surface. With the friction law `stick`, the second body can move along
        /// with the surface, without slip, and only one joint of the mechanism can have the key `surface_speed`.
        surface_speed: Option<f64> => number(MetrePerSecond, Range::Finite).brief();
        /// Moment of inertia of a rotor that turns with the angle of a revolute joint, or mass that moves with the
        /// position of a prismatic joint [kg or kg.m2], >= 0. The kinetic energy of the rotor is armature * rate^2 / 2,
        /// where rate is the relative speed of the two bodies of the joint. For a geared motor, `armature` is the
        /// inertia of the motor times the square of the gear ratio.
        armature: Option<f64> => either([Kilogram, KilogramSquareMetre], Range::NonNegative)
            .parameter(Role::Inertia, "Rotor inertia of @").absent("0").brief();
    }

    /// Friction acts in every revolute joint with a `pin_radius`, in every prismatic joint ([HF08] section 4), in every
    /// slot, and in every cam with a coefficient of friction. With the law `viscous`, the coefficient of friction is
    /// proportional to the slip speed up to `static_speed`, where the coefficient of friction is equal to the static
    /// coefficient. With the law `stick`, the coefficient of friction is the static coefficient up to `static_speed`,
    /// and friction can hold the mechanism at rest. Above `static_speed`, the coefficient of friction falls along a
    /// cubic curve to the kinetic coefficient at `kinetic_speed`.
    pub struct Friction: Copy {
        /// true: the joints have friction. false: the joints have no friction.
        enabled: Option<bool> =>
            Key::PLAIN.parameter(Role::Load, "true: the joints have friction; false: the joints have no friction")
            .absent("false");
        /// Friction law at slip speeds below `static_speed`. `viscous`: friction is proportional to the slip speed and
        /// cannot hold the mechanism at rest. `stick`: Coulomb friction, which can hold the mechanism at rest.
        law: FrictionLaw => Key::PLAIN.brief();
        /// Coefficient of static friction mu_S [1], >= 0. With the law `stick` the static coefficient must be at least
        /// as large as the kinetic coefficient.
        static_coefficient: f64 => number(One, Range::NonNegative)
            .parameter(Role::Law, "Coefficient of static friction of joints that state no other value").required();
        /// Coefficient of kinetic friction mu_d [1], >= 0.
        kinetic_coefficient: f64 => number(One, Range::NonNegative)
            .parameter(Role::Law, "Coefficient of kinetic friction of joints that state no other value").required();
        /// Slip speed V_S at which the coefficient of friction is the static coefficient [m/s], >= 0. With the law
        /// `viscous`, `static_speed` must be > 0.
        static_speed: f64 = 0.01 => number(MetrePerSecond, Range::NonNegative)
            .parameter(Role::Load, "Slip speed at which the coefficient of friction is the static coefficient");
        /// Slip speed V_d above which the coefficient of friction is the kinetic coefficient [m/s], >= 0.
        /// `kinetic_speed` must be larger than `static_speed`. With the law `stick`, `static_speed` and `kinetic_speed`
        /// may both be 0.
        kinetic_speed: f64 = 1.0 => number(MetrePerSecond, Range::NonNegative)
            .parameter(Role::Load, "Slip speed above which the coefficient of friction is the kinetic coefficient");
    }
}

words! {
    /// Distribution of a body's mass.
    pub enum Shape {
        /// Evenly between `origin` and `end`: centre of mass at half the length, moment of inertia m l^2 / 12.
        UniformRod = "uniform_rod",
    }

    /// Kind of a joint.
    pub enum JointKind {
        /// The two points coincide.
        Revolute = "revolute",
        /// The second point lies on a line through the first point. The line is fixed in the first body. The angle
        /// between the bodies is fixed.
        Prismatic = "prismatic",
        /// The second point lies on a curve that is fixed in the first body. Both bodies turn freely.
        Slot = "slot",
    }

    /// Law of friction at low slip speeds.
    pub enum FrictionLaw {
        /// Proportional to the slip speed up to V_S ([HF08] section 4). Friction does not hold a mechanism at rest.
        Viscous = "viscous",
        /// Coulomb's law: static friction up to V_S. At rest, friction holds the mechanism as long as static friction
        /// suffices.
        Stick = "stick",
    }
}

impl Body {
    /// Centre of mass in the body's frame [m]: half-way along a uniform rod, else as stated.
    pub fn center_of_mass(&self) -> [f64; 2] {
        match (self.shape, self.length) {
            (Some(Shape::UniformRod), Some(length)) => [0.5 * length, 0.0],
            _ => self.center.unwrap_or_default(),
        }
    }

    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        Owner { group: Some("bodies"), kind: "the body ", name, is_rotary: false }.parameters(self, &Some, visit);
        for (point, coordinates) in self.points.iter_mut() {
            for ((axis, index), value) in AXES.into_iter().zip(coordinates) {
                let key = ["bodies.", name, ".points.", point, index];
                let description = [axis, " coordinate of the point ", point, " in the frame of the body ", name];
                let kind = (Metre, Range::Coordinate, Role::Geometry);
                visit(Parameter::new([name, ".", point, "_", axis], key, description, kind), value);
            }
        }
    }
}

impl Joint {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let is_rotary = self.kind == JointKind::Revolute;
        let kind = if self.kind == JointKind::Slot { "the slot " } else { "the joint " };
        Owner { group: Some("joints"), kind, name, is_rotary }.parameters(self, &Some, visit);
    }
}

impl Friction {
    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        let is_stick = self.law == FrictionLaw::Stick;
        let refined = |key: Key| match key.unit(false) {
            MetrePerSecond if !is_stick => Some(Key { range: Range::Positive, ..key }),
            _ => Some(key),
        };
        Owner { group: None, kind: "", name: "friction", is_rotary: false }.parameters(self, &refined, visit);
    }

    pub(super) fn flags(&mut self, visit: &mut dyn FnMut(Flag, &mut bool)) {
        Owner { group: None, kind: "", name: "friction", is_rotary: false }.flags(self, visit);
    }
}
