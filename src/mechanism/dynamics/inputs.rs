//! Inputs: what the host sets between steps, and how the Reals change within a step.
//!
//! In: values and derivatives from the host. Out: sizes of loads; for each Real input u(t) = u_0 + u_1 t + u_2 t^2 / 2,
//! with t [s] counted from the communication point; engaged locks. It must not know what they act on.
use crate::codec::record::{Damaged, Record};
use crate::mechanism::reduced::Reduced;
use crate::numerics::bits::become_same;
use std::ops::{Deref, DerefMut, Range};
use std::sync::atomic::{AtomicU64, Ordering};

/// The first number that is not reserved for a version of inputs.
static UNUSED: AtomicU64 = AtomicU64::new(1);
/// Numbers that are reserved at once, so that threads seldom access [`UNUSED`].
const RESERVED: u64 = 1 << 16;

/// Inputs of a mechanism, with a version that each access to change them renews. What was computed from inputs is valid
/// as long as they have the same version.
#[derive(Debug)]
pub struct Inputs {
    values: InputValues,
    version: u64,
    /// Numbers reserved for the next versions.
    unused: Range<u64>,
}

impl Inputs {
    /// Inputs with these values.
    pub fn new(values: InputValues) -> Self {
        let mut inputs = Self { values, version: 0, unused: 0..0 };
        inputs.renew();
        inputs
    }

    /// Number of these values, at least 1. Inputs of the same version have the same values, in all instances, but for
    /// those that [`Self::move_on`] changes.
    #[inline(always)]
    pub fn version(&self) -> u64 {
        self.version
    }

    fn renew(&mut self) {
        if self.unused.is_empty() {
            let first = UNUSED.fetch_add(RESERVED, Ordering::Relaxed);
            self.unused = first..first + RESERVED;
        }
        self.version = self.unused.start;
        self.unused.start += 1;
    }

    /// Set a Real; returns whether it had another value. Its derivatives become 0 unless they apply to the next step.
    pub fn set(&mut self, input: usize, value: f64) -> bool {
        if self.signal.any && !self.signal.ahead {
            let signal = &mut self.signal;
            (signal.first[input], signal.second[input]) = (0.0, 0.0);
        }
        let is_other = self.reals[input].to_bits() != value.to_bits();
        if is_other {
            self.reals[input] = value;
        }
        is_other
    }

    /// The values without a new version: for the motion that inputs prescribe, which the state follows.
    pub(super) fn followed(&mut self) -> &mut InputValues {
        &mut self.values
    }

    /// A step of `h` [s] is done: the inputs keep their values and rates at its end.
    #[inline]
    pub fn leave(&mut self, h: f64) {
        if self.signal.any {
            let InputValues { reals, signal, .. } = &mut **self;
            reals.iter_mut().enumerate().for_each(|(input, value)| *value = signal.at(input, *value, h));
            signal.end(h);
        }
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        if record.reads() {
            self.renew();
        }
        self.values.record(record)
    }

    /// Become the same as other inputs of the same mechanism, without allocation.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        self.values.copy_from(&other.values);
        self.version = other.version;
    }
}

impl Clone for Inputs {
    fn clone(&self) -> Self {
        Self { values: self.values.clone(), version: self.version, unused: 0..0 }
    }
}

impl Deref for Inputs {
    type Target = InputValues;

    #[inline(always)]
    fn deref(&self) -> &InputValues {
        &self.values
    }
}

impl DerefMut for Inputs {
    fn deref_mut(&mut self) -> &mut InputValues {
        self.renew();
        &mut self.values
    }
}

/// Values of the inputs of a mechanism.
#[derive(Clone, Debug)]
pub struct InputValues {
    /// Sizes of loads, then demanded accelerations of the drives, then inputs of a hydraulic circuit or of a prescribed
    /// motion, then the airspeed if there is air.
    pub reals: Vec<f64>,
    /// Whether each lock is engaged; then, where a drive has a motion, whether that is prescribed.
    pub locks: Vec<bool>,
    /// Time derivatives of the Reals.
    pub signal: InputPolynomial,
}

impl InputValues {
    /// Input derivatives for the next step; None if all inputs are constant.
    #[inline]
    pub fn change(&self, reduced: &Reduced) -> Option<Change<'_>> {
        let loading = reduced.loading();
        self.signal.change(loading.inputs.len(), loading.air.is_some())
    }

    /// Largest absolute value of an input at the start or at the end of a step of `h` [s].
    pub fn size_at(&self, input: usize, h: f64) -> f64 {
        let value = self.reals[input];
        value.abs().max(self.signal.at(input, value, h).abs())
    }

    /// The largest [`Self::size_at`] of all inputs.
    pub fn largest_at(&self, h: f64) -> f64 {
        (0..self.reals.len()).fold(0.0, |largest, input| self.size_at(input, h).max(largest))
    }

    fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.length("inputs", self.reals.len())?;
        record.all_finite("input", &mut self.reals)?;
        self.signal.record(record)?;
        record.length("locks", self.locks.len())?;
        self.locks.iter_mut().try_for_each(|lock| record.flag("lock", lock))
    }

    #[inline]
    fn copy_from(&mut self, other: &Self) {
        become_same(&mut self.reals, &other.reals);
        for (own, other) in self.locks.iter_mut().zip(&other.locks) {
            if own != other {
                *own = *other;
            }
        }
        self.signal.copy_from(&other.signal);
    }
}

/// Derivatives of the Real inputs.
///
/// FMI 2.0.5, 4.2.1: they are set with respect to the beginning of a communication step, and are 0 until set. The
/// standard does not say how long they hold. Here they hold for one step, at the end of which the input is u(h) and
/// stays so unless it is set. The rates at the end of the step are kept for the derivatives of outputs there, until an
/// input is set.
#[derive(Clone, Debug, PartialEq)]
pub struct InputPolynomial {
    /// u_1 [unit/s].
    pub first: Vec<f64>,
    /// u_2 [unit/s2].
    pub second: Vec<f64>,
    /// Whether they apply to the next step; else they are the rates at the end of the last one.
    pub ahead: bool,
    /// Whether any may be other than 0.
    any: bool,
}

/// Derivatives of the sizes of loads and of the airspeed, with respect to time or along one direction of the inputs.
#[derive(Clone, Copy, Debug)]
pub struct Change<'a> {
    /// u_1 of the applied loads.
    pub first: &'a [f64],
    /// u_2 of the applied loads.
    pub second: &'a [f64],
    /// u_1 and u_2 of the airspeed.
    pub airspeed: [f64; 2],
}

impl InputPolynomial {
    /// Constant inputs.
    pub fn new(count: usize) -> Self {
        Self { first: vec![0.0; count], second: vec![0.0; count], ahead: false, any: false }
    }

    /// Set the derivative of order 1 or 2 for the next step.
    pub fn set(&mut self, input: usize, order: usize, value: f64) {
        if !self.ahead {
            self.clear();
        }
        let derivatives = if order == 1 { &mut self.first } else { &mut self.second };
        derivatives[input] = value;
        self.ahead = self.first.iter().chain(&self.second).any(|u| *u != 0.0);
        self.any = self.ahead;
    }

    /// Constant inputs again.
    pub fn clear(&mut self) {
        self.first.fill(0.0);
        self.second.fill(0.0);
        (self.ahead, self.any) = (false, false);
    }

    /// Input derivatives for the next step; None if all inputs are constant. `loads`: number of inputs that scale
    /// loads, which come first; `air`: whether the last input is the airspeed.
    #[inline]
    pub fn change(&self, loads: usize, air: bool) -> Option<Change<'_>> {
        if !self.ahead {
            return None;
        }
        let last = self.first.len().wrapping_sub(1);
        let airspeed = if air { [self.first[last], self.second[last]] } else { [0.0; 2] };
        Some(Change { first: &self.first[..loads], second: &self.second[..loads], airspeed })
    }

    /// u(h) of an input that begins with u_0.
    pub fn at(&self, input: usize, value: f64, h: f64) -> f64 {
        if self.ahead { value + h * (self.first[input] + 0.5 * h * self.second[input]) } else { value }
    }

    fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.all_finite("derivative of an input", &mut self.first)?;
        record.all_finite("second time derivative of an input", &mut self.second)?;
        if record.reads() {
            self.any = self.first.iter().chain(&self.second).any(|u| *u != 0.0);
        }
        record.flag("time derivatives of the inputs in the next step", &mut self.ahead)
    }

    #[inline]
    fn copy_from(&mut self, other: &Self) {
        if self.any || other.any {
            self.first.copy_from_slice(&other.first);
            self.second.copy_from_slice(&other.second);
            self.any = other.any;
        }
        self.ahead = other.ahead;
    }

    /// A step of size h is done: the rates are those at its end, 0 where the inputs were constant.
    fn end(&mut self, h: f64) {
        if !self.ahead {
            self.clear();
            return;
        }
        for (first, second) in self.first.iter_mut().zip(&mut self.second) {
            *first += h * *second;
            *second = 0.0;
        }
        self.ahead = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inputs(count: usize) -> Inputs {
        Inputs::new(InputValues { reals: vec![2.0; count], locks: Vec::new(), signal: InputPolynomial::new(count) })
    }

    #[test]
    fn derivatives_hold_for_one_step() {
        let mut inputs = inputs(2);
        assert!(inputs.signal.change(1, false).is_none());
        inputs.signal.set(1, 1, 3.0);
        inputs.signal.set(1, 2, 4.0);
        assert!(!inputs.set(1, 2.0));
        let end = 2.0 + 3.0 * 0.5 + 0.5 * 4.0 * 0.25;
        assert_eq!(inputs.signal.at(1, 2.0, 0.5), end);
        assert_eq!(inputs.signal.change(1, true).unwrap().airspeed, [3.0, 4.0]);
        inputs.leave(0.5);
        assert!(inputs.signal.change(1, true).is_none());
        assert_eq!((&inputs.reals[..], inputs.signal.first[1]), (&[2.0, end][..], 5.0));
        // A step with constant inputs, or a value that is set: they change no longer.
        let mut constant = inputs.clone();
        constant.leave(0.5);
        assert_eq!(constant.signal, InputPolynomial::new(2));
        inputs.set(1, end);
        assert_eq!(inputs.signal.first[1], 0.0);
    }

    #[test]
    fn inputs_of_one_version_have_the_same_values() {
        let first = inputs(1);
        let mut all = vec![first.clone(), first.clone(), first];
        all[1].set(0, 3.0);
        all[2].set(0, 4.0);
        let kept = all[1].clone();
        all[1].set(0, 5.0);
        all[2].copy_from(&kept);
        assert_eq!((all[2].version(), all[2].reals[0]), (kept.version(), 3.0));
        all[2].set(0, 6.0);
        all.push(kept);
        let mut versions: Vec<u64> = all.iter().map(Inputs::version).collect();
        versions.sort_unstable();
        versions.dedup();
        assert_eq!(versions.len(), all.len());
        let version = all[0].version();
        all[0].set(0, 2.0);
        all[0].leave(1.0);
        assert_eq!(all[0].version(), version);
    }

    #[test]
    fn rates_at_the_end_of_a_step_become_0_when_one_input_gets_a_derivative() {
        let mut signal = InputPolynomial::new(2);
        signal.set(0, 2, 4.0);
        signal.end(1.0);
        signal.set(1, 1, 1.0);
        assert_eq!((signal.first.as_slice(), signal.second.as_slice()), (&[0.0, 1.0][..], &[0.0; 2][..]));
        signal.set(1, 1, 0.0);
        assert!(!signal.ahead);
    }
}
