//! Errors of assembly.
use crate::numerics::decimal::Decimal;
use std::cmp::Ordering;
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
    /// A loop that no position closes, or a single one, in which it is stretched flat.
    TooLong {
        /// Name of the joint that would close it.
        joint: String,
        /// The body between whose joints the distance is too large, or the prismatic joint across whose axis it is.
        side: String,
        /// Whether the side is a prismatic joint.
        is_slide: bool,
        /// This distance [m].
        length: f64,
        /// The other bodies of the loop, each with the distance of its two joints [m].
        others: Vec<(String, f64)>,
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
                "the loops do not close: the two points of {joint} stay {gap:.3e} m apart, because the lengths \
                 contradict other joints between the same bodies; correct the lengths by this distance and write all \
                 digits, or remove a redundant joint (the key `snap` has no effect in this case)"
            ),
            Self::Open { joint, gap, .. } => write!(
                f,
                "the loops do not close from the guess: the two points of {joint} stay {gap:.3e} m apart; check the \
                 lengths, or correct the values in `guess`"
            ),
            Self::TooLong { joint, side, is_slide, length, others } => {
                let told = Decimal::rounded;
                let (length, reach) = (told(*length), told(others.iter().map(|(_, length)| length).sum()));
                let listed: Vec<String> =
                    others.iter().map(|(name, length)| format!("{name} {} m", told(*length))).collect();
                let (what, only) = match length.0.total_cmp(&reach.0) {
                    Ordering::Greater => ("cannot close", " only"),
                    Ordering::Equal => ("fits only when stretched flat, and cannot move", " exactly"),
                    Ordering::Less => ("is stretched almost flat, and can hardly move", ""),
                };
                let (between, remedy) = match is_slide {
                    true => (
                        format!("across the slide {side} the joints of the loop"),
                        format!("move the axis of {side} nearer to these joints"),
                    ),
                    false => (format!("the joints of the loop on {side}"), format!("shorten {side}")),
                };
                write!(
                    f,
                    "the loop of {joint} {what}: {between} are {length} m apart, and the other bodies together reach \
                     over{only} {reach} m ({}); {remedy}, or lengthen another body of the loop",
                    listed.join(", ")
                )
            }
            Self::Freedom { count } => write!(
                f,
                "the linkage has {count} degrees of freedom, but it must have 1: {}",
                if *count == 0 {
                    "remove a joint or a coupling, or add a body"
                } else {
                    "add a joint or a coupling, or remove a body"
                }
            ),
            Self::Crossing => write!(
                f,
                "two branches of motion cross at the guess, so two motions are possible: state in `guess` a position \
                    of the intended motion, away from the crossing; the run may still start at the crossing, if \
                    `start` contains this position"
            ),
        }
    }
}

impl std::error::Error for AssemblyError {}
