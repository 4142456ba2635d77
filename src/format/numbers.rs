//! Numbers of a definition as they are read: some are expressions, whose values follow when all names are known.
use std::cell::{Cell, RefCell};

/// Least bits of the numbers that stand for expressions: quiet NaN, which no JSON text gives.
const PLACEHOLDER: u64 = 0x7ff8_4c46_0000_0000;
/// Bits that hold the index of an expression.
const INDEX: u64 = 0xffff_ffff;

/// What becomes of a text in the place of a number while a definition is read.
#[derive(Default)]
pub struct Numbers {
    /// Texts of the expressions in the order in which they are read; None where a number must be a number.
    texts: Option<RefCell<Vec<String>>>,
    /// Values of those that are known, by index, each a number or why there is none.
    values: Vec<Option<Result<f64, String>>>,
    count: Cell<usize>,
}

impl Numbers {
    /// Texts are kept, and a [`placeholder`](index_of) stands for each.
    pub fn with_expressions() -> Self {
        Self { texts: Some(RefCell::default()), ..Self::default() }
    }

    /// As [`Self::with_expressions`], for the same text once more, with values of some of its expressions.
    pub fn with_values(values: Vec<Option<Result<f64, String>>>) -> Self {
        Self { values, ..Self::with_expressions() }
    }

    /// The texts that were read.
    pub fn into_texts(self) -> Vec<String> {
        self.texts.map(RefCell::into_inner).unwrap_or_default()
    }

    /// Whether a text may stand in the place of a number.
    pub(super) fn takes_texts(&self) -> bool {
        self.texts.is_some()
    }

    /// The number in the place of which this text stands.
    ///
    /// # Errors
    /// Its expression has no value, with the reason.
    pub(super) fn take(&self, text: &str) -> Result<f64, String> {
        let index = self.count.replace(self.count.get() + 1);
        if let Some(Some(known)) = self.values.get(index) {
            return known.clone();
        }
        self.texts.iter().for_each(|texts| texts.borrow_mut().push(text.to_owned()));
        Ok(f64::from_bits(PLACEHOLDER | index as u64 & INDEX))
    }
}

/// Index of the expression for which a number stands.
pub fn index_of(number: f64) -> Option<usize> {
    (number.to_bits() & !INDEX == PLACEHOLDER).then_some((number.to_bits() & INDEX) as usize)
}
