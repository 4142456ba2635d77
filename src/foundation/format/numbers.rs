//! Numbers of a definition while it is read. Some are expressions, whose values are known after all names are read.
use std::cell::{Cell, RefCell};

/// Lowest bit pattern of placeholders for expressions: a quiet NaN, which no JSON text contains.
const PLACEHOLDER: u64 = 0x7ff8_4c46_0000_0000;
/// Mask of the index of an expression.
const INDEX: u64 = 0xffff_ffff;

/// Treatment of texts that replace numbers while a definition is read.
#[derive(Default)]
pub struct Numbers {
    /// Texts of the expressions in the order in which they are read. None if expressions are not allowed.
    texts: Option<RefCell<Vec<String>>>,
    /// Known values of the expressions by index, each a number or the reason why there is none.
    values: Vec<Option<Result<f64, String>>>,
    count: Cell<usize>,
}

impl Numbers {
    /// Allows expressions. The texts are stored, and a [`placeholder`](index_of) replaces each number.
    pub fn with_expressions() -> Self {
        Self { texts: Some(RefCell::default()), ..Self::default() }
    }

    /// As [`Self::with_expressions`], for a second reading of the same text with known values of some expressions.
    pub fn with_values(values: Vec<Option<Result<f64, String>>>) -> Self {
        Self { values, ..Self::with_expressions() }
    }

    /// The texts that were read.
    pub fn into_texts(self) -> Vec<String> {
        self.texts.map(RefCell::into_inner).unwrap_or_default()
    }

    /// Whether a text may replace a number.
    pub(super) fn allows_texts(&self) -> bool {
        self.texts.is_some()
    }

    /// The number for this text: a known value, or a placeholder.
    ///
    /// # Errors
    /// The reason why the expression has no value.
    pub(super) fn take(&self, text: &str) -> Result<f64, String> {
        let index = self.count.replace(self.count.get() + 1);
        if let Some(Some(known)) = self.values.get(index) {
            return known.clone();
        }
        self.texts.iter().for_each(|texts| texts.borrow_mut().push(text.to_owned()));
        Ok(f64::from_bits(PLACEHOLDER | index as u64 & INDEX))
    }
}

/// Index of the expression of a placeholder.
pub fn index_of(number: f64) -> Option<usize> {
    (number.to_bits() & !INDEX == PLACEHOLDER).then_some((number.to_bits() & INDEX) as usize)
}
