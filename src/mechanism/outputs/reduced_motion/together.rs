//! Outputs of one state, read one after the other.
//!
//! In: a view of the state. Out: values, NaN where an output has none. It must not know references.
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError, evaluate, part_of};
use crate::mechanism::outputs::tabulated::function_of;
use crate::mechanism::outputs::view::View;
use crate::mechanism::quantity::{OneElement, Output, ReactionPart};
use crate::mechanism::reduced::Reduced;

/// Outputs that are read together. Those of the most frequent kinds are read in a loop for each kind.
#[derive(Clone, Debug, Default)]
pub struct Together {
    pub outputs: Vec<Output>,
    /// The functions of which outputs are time derivatives.
    functions: Vec<usize>,
    rates: Vec<Rate>,
    /// Whether one of the rates is of order 2.
    accelerates: bool,
    reactions: Vec<JointParts>,
    /// The terms of drives: index of the output, drive, term.
    terms: Vec<(usize, usize, OneElement)>,
    /// The other outputs, each with its index.
    others: Vec<(usize, Output)>,
}

/// An output that is the first or second time derivative of a function.
#[derive(Clone, Copy, Debug)]
struct Rate {
    /// Index of the output.
    index: usize,
    function: usize,
    order: usize,
}

/// Parts of the reaction of a joint.
#[derive(Clone, Copy, Debug)]
struct JointParts {
    joint: usize,
    /// Index of the output that is each of [`PARTS`]; [`NONE`] where none is.
    indices: [usize; PARTS.len()],
}

/// All parts, in the order of their numbers.
const PARTS: [ReactionPart; 4] = [ReactionPart::X, ReactionPart::Y, ReactionPart::Magnitude, ReactionPart::Moment];
/// Index of no output.
const NONE: usize = usize::MAX;

impl Together {
    /// Make room for so many outputs in all.
    pub fn reserve(&mut self, count: usize) {
        if count <= self.capacity() {
            return;
        }
        self.outputs.reserve_exact(count.saturating_sub(self.outputs.len()));
        self.functions.reserve_exact(count.saturating_sub(self.functions.len()));
        self.rates.reserve_exact(count.saturating_sub(self.rates.len()));
        self.reactions.reserve_exact(count.saturating_sub(self.reactions.len()));
        self.terms.reserve_exact(count.saturating_sub(self.terms.len()));
        self.others.reserve_exact(count.saturating_sub(self.others.len()));
    }

    /// Number of outputs for which there is room.
    pub fn capacity(&self) -> usize {
        self.outputs.capacity()
    }

    /// These outputs instead of the present ones.
    pub fn replace(&mut self, outputs: impl Iterator<Item = Output>, reduced: &Reduced) {
        let Self { functions, rates, accelerates, reactions, terms, others, .. } = self;
        functions.clear();
        rates.clear();
        reactions.clear();
        terms.clear();
        others.clear();
        *accelerates = false;
        self.outputs.clear();
        self.outputs.extend(outputs);
        for (index, output) in self.outputs.iter().enumerate() {
            let function = function_of(reduced, output);
            if let Some(function) = function.filter(|function| !functions.contains(function)) {
                functions.push(function);
            }
            match (*output, function) {
                (
                    Output::Angle { order, .. } | Output::JointPosition { order, .. } | Output::Marker { order, .. },
                    Some(function),
                ) if order > 0 => {
                    rates.push(Rate { index, function, order });
                    *accelerates |= order == 2;
                }
                (Output::Reaction { joint, part }, _) => {
                    let part = part as usize;
                    match reactions.iter_mut().find(|own| own.joint == joint && own.indices[part] == NONE) {
                        Some(own) => own.indices[part] = index,
                        None => {
                            let mut indices = [NONE; PARTS.len()];
                            indices[part] = index;
                            reactions.push(JointParts { joint, indices });
                        }
                    }
                }
                (Output::OneElement { drive, term }, _) => terms.push((index, drive, term)),
                _ => others.push((index, *output)),
            }
        }
    }
}

/// Outputs of one state.
pub struct Outputs<'a> {
    view: View<'a, f64>,
    loading: &'a Loading,
}

impl<'a> Outputs<'a> {
    #[inline]
    pub(super) fn new(view: View<'a, f64>, loading: &'a Loading) -> Self {
        Self { view, loading }
    }

    /// Value of an output; NaN where it has none.
    #[inline]
    pub fn value(&mut self, output: &Output) -> f64 {
        if self.is_misplaced() { f64::NAN } else { number(value_of(&mut self.view, self.loading, output)) }
    }

    /// Replace these values by [`Self::value`] of as many outputs that are read together; whether each of them has one.
    // Not inlined, so that the loops have the registers for themselves.
    #[inline(never)]
    pub fn fill(&mut self, together: &Together, values: &mut [f64]) -> bool {
        let Self { view, loading } = self;
        if view.loads.undriven.is_some() || view.find_functions(&together.functions).is_err() {
            return self.fill_each(&together.outputs, values);
        }
        let speed = view.sigma_dot();
        let acceleration = match together.accelerates {
            true => view.forces().map_or_else(without_value, |forces| forces.acceleration),
            false => 0.0,
        };
        // The place of a value is found before the value, which takes fewer instructions.
        for &Rate { index, function, order } in &together.rates {
            let Some(value) = values.get_mut(index) else { continue };
            let [_, slope, curvature] = view.cache.functions[function].values;
            let second = slope * acceleration + curvature * speed * speed;
            *value = if order == 1 { slope * speed } else { second };
        }
        for &JointParts { joint, indices } in &together.reactions {
            let reaction = view.reaction(joint).unwrap_or_else(|reason| [without_value(reason); 3]);
            for (index, part) in indices.into_iter().zip(PARTS) {
                if let Some(value) = values.get_mut(index) {
                    *value = part_of(reaction, part);
                }
            }
        }
        for &(index, drive, ref term) in &together.terms {
            let Some(value) = values.get_mut(index) else { continue };
            *value = view.drive_term(drive, term).unwrap_or_else(without_value);
        }
        for (index, output) in &together.others {
            let Some(value) = values.get_mut(*index) else { continue };
            *value = evaluate(view, loading, output).unwrap_or_else(without_value);
        }
        are_finite(values) || self.fill_each(&together.outputs, values)
    }

    /// [`Self::fill`] one by one: an output has no value, or an infinite one.
    #[cold]
    #[inline(never)]
    fn fill_each(&mut self, outputs: &[Output], values: &mut [f64]) -> bool {
        for (value, output) in values.iter_mut().zip(outputs) {
            *value = self.value(output);
        }
        are_finite(values)
    }

    /// [`Self::value`] of several outputs.
    #[inline]
    pub fn values(&mut self, outputs: &[Output], mut give: impl FnMut(f64)) {
        if self.is_misplaced() {
            return outputs.iter().for_each(|_| give(f64::NAN));
        }
        for output in outputs {
            give(number(value_of(&mut self.view, self.loading, output)));
        }
    }

    /// Whether the mechanism is not where its motion is prescribed to be.
    #[inline]
    fn is_misplaced(&self) -> bool {
        self.view.loads.undriven.is_some() && self.view.check_placed().is_err()
    }
}

/// The value of an output; NaN where it has none.
#[inline(always)]
fn number(value: Result<f64, OutputError>) -> f64 {
    match value {
        Ok(value) if value.is_finite() => value,
        Ok(_) => f64::NAN,
        Err(error) => without_value(error),
    }
}

/// NaN for an output without a value. The reason is dropped here, so that the other outputs need no code for it.
#[cold]
fn without_value(_reason: OutputError) -> f64 {
    f64::NAN
}

/// Whether all numbers are finite: 0 times such a number is 0, else NaN. Pairs are summed at once.
#[inline]
fn are_finite(numbers: &[f64]) -> bool {
    let (pairs, rest) = numbers.as_chunks::<2>();
    let mut sums = [0.0; 2];
    for pair in pairs {
        sums = [sums[0] + 0.0 * pair[0], sums[1] + 0.0 * pair[1]];
    }
    rest.iter().fold(sums[0] + sums[1], |sum, number| sum + 0.0 * number) == 0.0
}

/// [`evaluate`] as a function of its own, for one output.
#[inline(never)]
pub(super) fn value_of(view: &mut View<f64>, loading: &Loading, output: &Output) -> Result<f64, OutputError> {
    evaluate(view, loading, output)
}
