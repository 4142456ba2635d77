//! The start, settings of the integration, and the choice of the formulation.
use super::{Role, Visit};
use crate::format::{Flag, Owner, Parameter, Range};
use crate::variables::Unit;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Word of a start at the stable equilibrium nearest to the guess.
const EQUILIBRIUM: &str = "equilibrium";

/// Position and speed of a turning body or a prismatic joint at the start.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Turning body that states the start.
    pub body: Option<String>,
    /// Angle of the body [rad].
    pub angle: Option<f64>,
    /// Prismatic joint that states the start.
    pub joint: Option<String>,
    /// Position of the joint [m].
    pub position: Option<f64>,
    /// Speed of the body or joint [rad/s or m/s].
    #[serde(default)]
    pub speed: f64,
    /// Whether the mechanism starts at the stable equilibrium that is nearest to the stated position.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub equilibrium: bool,
}

impl Start {
    /// Read the start: an object, or the word "equilibrium" for the one nearest to the guess.
    pub(super) fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ObjectOrWord;
        impl<'de> Visitor<'de> for ObjectOrWord {
            type Value = Start;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                write!(f, "an object or the word \"{EQUILIBRIUM}\"")
            }

            fn visit_str<E: Error>(self, word: &str) -> Result<Start, E> {
                match word {
                    EQUILIBRIUM => Ok(Start { equilibrium: true, ..Start::default() }),
                    _ => Err(E::invalid_value(Unexpected::Str(word), &self)),
                }
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Start, A::Error> {
                Start::deserialize(MapAccessDeserializer::new(map))
            }
        }
        deserializer.deserialize_any(ObjectOrWord)
    }

    /// Whether the guess stands for the stated position, as in the short form.
    pub fn is_at_guess(&self) -> bool {
        self.equilibrium && self.body.is_none() && self.joint.is_none()
    }

    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        use Unit::{Metre, MetrePerSecond, Radian, RadianPerSecond};
        let (of, value, quantity, unit, speed_unit, range) =
            match (&self.body, &mut self.angle, &self.joint, &mut self.position) {
                (Some(body), Some(angle), ..) => (body, angle, "angle", Radian, RadianPerSecond, Range::Turn),
                (.., Some(joint), Some(position)) => {
                    (joint, position, "position", Metre, MetrePerSecond, Range::Finite)
                }
                _ => return,
            };
        let mut add = |quantity, kind, value| {
            let word = match (self.equilibrium, quantity) {
                (true, "angle" | "position") => "At the start the stable equilibrium nearest to it is sought: ",
                _ => "Start ",
            };
            let description = [word, quantity, " of ", of];
            visit(Parameter::new([of, ".start_", quantity], ["start.", quantity], description, kind), value);
        };
        add(quantity, (unit, range, Role::StartPosition), value);
        add("speed", (speed_unit, Range::Finite, Role::StartSpeed), &mut self.speed);
    }
}

/// Integration settings.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// Relative tolerance of the integration [1].
    pub tolerance: f64,
    /// Least speed to which errors are relative, as a part of that which the present force along the curve would give
    /// over the length of 1 rad [1], > 0 and <= 1.
    #[serde(default = "speed_floor")]
    pub speed_floor: f64,
    /// Most steps of the integration in one communication step [1].
    #[serde(default = "max_steps")]
    pub max_steps: f64,
    /// Formulation of the motion, a parameter; the reduced model, without a parameter, where absent.
    pub method: Option<Method>,
    /// Only with `method`: largest step of Newmark's method [s], >= 1e-9; 1e-5 where absent.
    pub fem_step: Option<f64>,
    /// Whether the right-hand side is read from tables; else each evaluation closes the loops, at some hundred times
    /// the cost.
    #[serde(default = "tables")]
    pub tables: bool,
}

fn speed_floor() -> f64 {
    1.0
}

fn max_steps() -> f64 {
    Solver::MAX_STEPS
}

fn tables() -> bool {
    true
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            tolerance: 1e-9,
            speed_floor: speed_floor(),
            max_steps: Self::MAX_STEPS,
            method: None,
            fem_step: None,
            tables: true,
        }
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
        let mut list = Owner::new(None, "solver", Role::Tolerance, visit);
        list.add(
            "tolerance",
            "Relative tolerance of the integration",
            Unit::One,
            Range::Tolerance,
            &mut self.tolerance,
        );
        list.role = Role::Scale;
        let words =
            "Least speed to which errors are relative, as a part of that gained over 1 rad under the present loads";
        list.add("speed_floor", words, Unit::One, Range::Fraction, &mut self.speed_floor);
        list.role = Role::Tolerance;
        let words = "Most steps of the integration in one communication step";
        list.add("max_steps", words, Unit::One, Range::Count, &mut self.max_steps);
        if self.method.is_some() {
            list.role = Role::Step;
            let words = "Largest step of the rigid finite elements";
            list.add("fem_step", words, Unit::Second, Range::Substep, &mut self.fem_step);
        }
    }

    pub(super) fn flags(&mut self, visit: &mut dyn FnMut(Flag, &mut bool)) {
        let text = "Whether the right-hand side is read from tables; else it is computed anew each time";
        visit(Flag::new("solver", "tables", [text]), &mut self.tables);
    }
}

/// Formulation of the motion.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Rigid bodies as one element along the curve.
    #[default]
    Reduced,
    /// Rods with axial stiffness, by Newmark's method ([HF08] section 3).
    RigidFem,
}

impl Method {
    /// All formulations.
    pub const ALL: [Self; 2] = [Self::Reduced, Self::RigidFem];
    /// Their words, in the same order.
    pub const WORDS: [&'static str; 2] = ["reduced", "rigid_fem"];

    /// Word of the formulation in the file and in the variable `solver.method`.
    pub fn word(self) -> &'static str {
        Self::WORDS[self as usize]
    }

    /// The formulation with this word.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.word() == word)
    }
}
