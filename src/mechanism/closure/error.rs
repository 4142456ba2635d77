//! Errors of assembly.
use crate::numerics::decimal::Decimal;
use std::fmt;

/// Error of assembly.
#[derive(Clone, Debug, PartialEq)]
pub enum AssemblyError {
    /// A coordinate without a guess, or a guess without a coordinate.
    Guess {
        /// Name in the guess.
        name: String,
        /// Remedy.
        message: String,
    },
    /// No closed position near the guess.
    Open {
        /// Name of the joint with the largest gap.
        joint: String,
        /// Largest gap [m].
        gap: f64,
        /// Whether joints hold some bodies more than once, and the gap is small beside the linkage.
        contradicts: bool,
    },
    /// A loop of revolute joints that no position closes, or a single one.
    TooLong {
        /// Name of the joint that would close it.
        joint: String,
        /// The body between whose joints the distance is too large.
        body: String,
        /// This distance, and the sum of those on the other bodies of the loop [m].
        lengths: [f64; 2],
    },
    /// The number of degrees of freedom is not one.
    Freedom {
        /// Number of degrees of freedom.
        count: usize,
    },
    /// Two branches cross at the guess.
    Crossing,
}

impl fmt::Display for AssemblyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Guess { name, message } => write!(f, "guess.{name}: {message}"),
            Self::Open { joint, gap, contradicts: true } => write!(
                f,
                "the loops do not close: {joint} stays open by {gap:.3e} m, as other joints hold its bodies too and the lengths \
                 contradict each other; correct the lengths by as much, to the last digit (snap does not help here), or leave \
                 out a joint that the others make needless"
            ),
            Self::Open { joint, gap, .. } => write!(
                f,
                "the loops do not close from the guess: {joint} stays open by {gap:.3e} m; check the lengths, or guess closer"
            ),
            Self::TooLong { joint, body, lengths: [length, others] } => write!(
                f,
                "the loop of {joint} cannot {}: its joints on {body} are {} m apart, and the other bodies reach over {} m \
                 only; shorten {body}, or lengthen the other bodies of the loop",
                if Decimal::rounded(*length).0 > Decimal::rounded(*others).0 { "close" } else { "move" },
                Decimal::rounded(*length),
                Decimal::rounded(*others)
            ),
            Self::Freedom { count } => write!(
                f,
                "the linkage has {count} degrees of freedom where it must have 1: {}",
                if *count == 0 {
                    "remove a joint or a coupling, or add a body"
                } else {
                    "add a joint or a coupling, or remove a body"
                }
            ),
            Self::Crossing => write!(
                f,
                "two branches of motion cross at the guess: guess a position off the crossing, on the branch that is meant \
                 (start may still state the crossing itself)"
            ),
        }
    }
}

impl std::error::Error for AssemblyError {}
