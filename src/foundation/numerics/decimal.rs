//! Numbers in messages.
use std::fmt;

/// A number in a message: the shortest decimal that gives the same double, with an exponent instead of many zeros.
#[derive(Clone, Copy, Debug)]
pub struct Decimal(pub f64);

impl Decimal {
    /// The number rounded to ten digits, for values with that accuracy.
    pub fn rounded(value: f64) -> Self {
        Self(format!("{value:.9e}").parse().unwrap_or(value))
    }
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let value = self.0;
        if value == 0.0 || (1e-5..1e15).contains(&value.abs()) { write!(f, "{value}") } else { write!(f, "{value:e}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_and_large_numbers_have_an_exponent() {
        for (value, text) in [
            (0.0, "0"),
            (-1.0, "-1"),
            (0.1, "0.1"),
            (-1.3258449313980745, "-1.3258449313980745"),
            (1e-5, "0.00001"),
            (1e-20, "1e-20"),
            (1e300, "1e300"),
            (-1.5e15, "-1.5e15"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(Decimal(value).to_string(), text);
        }
        assert_eq!(Decimal::rounded(-1.3258449313980745).to_string(), "-1.325844931");
        assert_eq!(Decimal::rounded(0.7999999999999998).to_string(), "0.8");
        assert_eq!(Decimal::rounded(0.0).to_string(), "0");
    }
}
