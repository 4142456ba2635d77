//! What a random call of a C function may be answered with.
use super::probe::Probe;
use super::random::Random;
use crate::host::{DISCARD, ERROR, OK, WARNING};
use linkage_fmu::fmi2::host::Message;

/// What may be answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum May {
    /// OK, or a warning with a line.
    Succeed,
    /// An error.
    BeRefused,
    /// Either, and discarded: values decide.
    Either,
}

impl May {
    /// Whether a status and the messages that came with it are an answer that may be given; refusals are counted.
    pub fn allows(self, status: i32, log: &[Message], probe: &mut Probe) -> bool {
        match (self, status) {
            (May::Succeed | May::Either, OK) => true,
            (May::Succeed | May::Either, WARNING) => !log.is_empty(),
            (May::BeRefused | May::Either, ERROR) | (May::Either, DISCARD) => {
                probe.count("calls refused");
                log.iter().filter(|message| message.status >= DISCARD).count() == 1
            }
            _ => false,
        }
    }

    /// This if a condition holds; else the call is refused.
    pub fn when(self, condition: bool) -> Self {
        if condition { self } else { Self::BeRefused }
    }
}

/// A number that hosts seldom pass.
pub fn odd(random: &mut Random) -> f64 {
    random.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, 0.0, 1e300, -1e300, 5e-324])
}

/// Another value for a variable that has this one.
pub fn changed(value: f64, random: &mut Random) -> f64 {
    match random.below(12) {
        0 => odd(random),
        1 => random.within(-1.0, 1.0),
        _ => value * random.decades(0.5, 2.0),
    }
}
