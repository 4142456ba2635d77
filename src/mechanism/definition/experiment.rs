//! The start, settings of the integration, and the choice of the formulation.
use crate::format::{Flag, Key, Owner, Parameter, Range, Role, Short, Visit, either, element, keys, number, words};
use crate::variables::Unit::{Metre, MetrePerSecond, One, Radian, RadianPerSecond, Second};

keys! {
    /// The object `start` states the position and the speed of a turning body or of a prismatic joint at the start of
    /// the run.
    pub struct Start or (Short::Word("equilibrium")) {
        /// Body whose angle determines the start position.
        body: Option<String> => element();
        /// Start angle of the body that the key `body` names [rad], from -1e6 rad to 1e6 rad.
        angle: Option<f64> => number(Radian, Range::Turn).parameter(Role::StartPosition, "");
        /// Prismatic joint or slot whose position determines the start position.
        joint: Option<String> => element();
        /// Start position of the prismatic joint or slot that the key `joint` names [m].
        position: Option<f64> => number(Metre, Range::Finite).parameter(Role::StartPosition, "");
        /// Start speed of the body in `body` or of the joint in `joint` [m/s or rad/s].
        speed: f64 => either([MetrePerSecond, RadianPerSecond], Range::Finite).parameter(Role::StartSpeed, "");
        /// true: the run starts at the stable equilibrium that is nearest to the stated position. The program computes
        /// the equilibrium with the loads at the start of the run.
        equilibrium: bool => Key::PLAIN.brief();
    }

    /// Settings of the time integration of the mechanism.
    pub struct Solver {
        /// Relative tolerance of the time integration of the mechanism [1], 1e-14 to 0.1.
        tolerance: f64 = 1e-9 => number(One, Range::Tolerance)
            .parameter(Role::Tolerance, "Relative tolerance of the time integration").required();
        /// Smallest speed to which the relative tolerance refers, as a fraction of a reference speed [1], > 0 and <= 1.
        /// The reference speed is the speed of the mechanism after the present loads have moved the mechanism from rest
        /// over 1 rad. With a small value of `speed_floor` slow creep is computed accurately.
        speed_floor: f64 = 1.0 => number(One, Range::Fraction).parameter(
            Role::Scale,
            "Smallest speed to which the relative tolerance refers, as a fraction of a reference speed: the speed of \
                the mechanism after the present loads have moved the mechanism from rest over 1 rad",
        );
        /// Largest number of integration steps in one communication step [1], a whole number. Rejected steps, substeps
        /// of the method `rigid_fem`, and events count as integration steps.
        max_steps: f64 = Self::MAX_STEPS => number(One, Range::Count)
            .parameter(Role::Tolerance, "Largest number of integration steps in one communication step");
        /// Model of the motion, and start value of the variable `solver.method`. `reduced`: rigid bodies. `rigid_fem`:
        /// links with `axial_stiffness` are elastic rods, integrated by Newmark's method. Without the key `method`, the
        /// FMU uses the method `reduced` and has no variable `solver.method`.
        method: Option<Method> => Key::PLAIN.parameter(Role::Step, "");
        /// Largest time step of Newmark's method, which the method `rigid_fem` uses [s], >= 1e-9. Default: 1e-5 s. The
        /// key `fem_step` is allowed only together with `method`.
        fem_step: Option<f64> => number(Second, Range::Substep)
            .parameter(Role::Step, "Largest step of Newmark's method, if solver.method is rigid_fem");
        /// Start value of the Boolean variable `solver.tables`. true: the FMU evaluates the equation of motion from
        /// tables. false: the FMU solves the loop equations in each evaluation, about a hundred times slower.
        tables: bool = true => Key::PLAIN.parameter(
            Role::Load,
            "true: the FMU evaluates the equation of motion from tables; false: the FMU solves the loop equations in \
                each evaluation, which is slower",
        );
        /// Start value of the Boolean variable `solver.prepare`. true: the FMU computes all tables in the
        /// initialisation, for simulation in real time. For a motion without end, the tables extend to 100 turns from
        /// the guess. false: the FMU computes a table when a step or an output first needs the table.
        prepare: bool = false => Key::PLAIN.parameter(
            Role::Load,
            "true: the FMU computes all tables in the initialisation; false: the FMU computes a table when a step or \
                an output first needs the table",
        );
    }
}

words! {
    /// Formulation of the motion.
    pub enum Method {
        /// Rigid bodies, reduced to one element.
        Reduced = "reduced",
        /// Rods with axial stiffness, by Newmark's method ([HF08] section 3).
        RigidFem = "rigid_fem",
    }
}

impl Start {
    /// Whether the guess stands for the stated position, as in the short form.
    pub fn is_at_guess(&self) -> bool {
        self.equilibrium && self.body.is_none() && self.joint.is_none()
    }

    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        let (of, value, quantity, unit, speed_unit, range) =
            match (&self.body, &mut self.angle, &self.joint, &mut self.position) {
                (Some(body), Some(angle), ..) => (body, angle, "angle", Radian, RadianPerSecond, Range::Turn),
                (.., Some(joint), Some(position)) => {
                    (joint, position, "position", Metre, MetrePerSecond, Range::Finite)
                }
                _ => return,
            };
        let owner = if self.body.is_some() { "the body " } else { "the joint " };
        let mut add = |quantity, kind, value| {
            let word = match (self.equilibrium, quantity) {
                (true, "angle" | "position") => {
                    "Position from which the program searches for the stable equilibrium at the start: "
                }
                _ => "Start ",
            };
            let description = [word, quantity, " of ", owner, of];
            visit(Parameter::new([of, ".start_", quantity], ["start.", quantity], description, kind), value);
        };
        add(quantity, (unit, range, Role::StartPosition), value);
        add("speed", (speed_unit, Range::Finite, Role::StartSpeed), &mut self.speed);
    }
}

impl Solver {
    /// Largest step of Newmark's method where none is stated [s].
    pub const FEM_STEP: f64 = 1e-5;
    /// Most steps of the integration in one communication step, where no number is stated.
    pub const MAX_STEPS: f64 = 5e4;

    /// Most steps of the integration in one communication step, as a whole number: by way of i64, which is one
    /// instruction of the processor.
    #[inline]
    pub fn most_steps(&self) -> u64 {
        self.max_steps as i64 as u64
    }

    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        Owner { group: None, kind: "", name: "solver", is_rotary: false }.parameters(self, &Some, visit);
    }

    pub(super) fn flags(&mut self, visit: &mut dyn FnMut(Flag, &mut bool)) {
        Owner { group: None, kind: "", name: "solver", is_rotary: false }.flags(self, visit);
    }
}
