//! How the motion is found.
use serde::{Deserialize, Serialize};

/// Integration settings.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// Relative tolerance of the integration [1].
    pub tolerance: f64,
    /// Formulation of the motion; the reduced model, not to be changed in a run, where absent.
    #[serde(default)]
    pub method: Option<Method>,
    /// Largest step of Newmark's method [s], > 0; 1e-5 where absent. There only with `method`.
    #[serde(default)]
    pub fem_step: Option<f64>,
    /// Whether the right-hand side is read from tables; else each evaluation closes the loops anew, some hundred times as dear.
    #[serde(default = "super::yes")]
    pub tables: bool,
}

impl Default for Solver {
    fn default() -> Self {
        Self { tolerance: 1e-9, method: None, fem_step: None, tables: true }
    }
}

impl Solver {
    /// Largest step of Newmark's method where none is stated [s].
    pub const FEM_STEP: f64 = 1e-5;
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
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Reduced, Self::RigidFem];

    /// Its word in the file and in the variable `solver.method`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Reduced => "reduced",
            Self::RigidFem => "rigid_fem",
        }
    }

    /// The method of this word.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.word() == word)
    }
}
