//! Samples as a short text: integer multiples of a decimal step, as second differences.
//!
//! In: samples. Out: a text from which the page reads them back to six digits of their range. The module must not know
//! what they mean.

use serde::Serialize;

/// Number of digits of the range that are kept.
const DIGITS: i32 = 6;
/// A larger value represents infinity.
const INFINITE: f64 = 1e300;

/// Samples of one quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Series {
    /// One value for all samples. None if there is no value.
    Constant(Option<f64>),
    /// Integer multiples of a step: second differences, the first two from 0. None where there is no value.
    Steps {
        /// The step.
        s: f64,
        /// Differences.
        d: Vec<Option<i64>>,
    },
    /// Single values, for a quantity with high peaks.
    Values {
        /// Values, to six digits each.
        v: Vec<Option<f64>>,
    },
}

impl Series {
    /// Samples. A value that is not finite, or represents infinity, is missing.
    pub fn new(samples: &[f64]) -> Self {
        let finite = || samples.iter().copied().filter(|x| x.abs() < INFINITE);
        let (least, most) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let (range, size) = (most - least, least.abs().max(most.abs()));
        if least > most {
            return Self::Constant(None);
        }
        let is_whole = samples.iter().all(|x| x.abs() < INFINITE);
        if range <= 1e-12 * size {
            if is_whole {
                return Self::Constant(Some(rounded(least, 12)));
            }
            return Self::Values { v: samples.iter().map(|x| value(*x)).collect() };
        }
        let mut sizes: Vec<f64> = finite().map(f64::abs).collect();
        let middle = sizes.len() / 2;
        let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
        if *median > 0.0 && *median < 1e-3 * size {
            return Self::Values { v: samples.iter().map(|x| value(*x)).collect() };
        }
        let exponent = (range.log10().floor() as i32 - DIGITS).max(size.log10().ceil() as i32 - 15);
        let (mut last, mut before) = (0, 0);
        let d = samples.iter().map(|&x| {
            let whole = (x.abs() < INFINITE).then(|| in_steps(x, exponent))?;
            let difference = whole - 2 * last + before;
            (before, last) = (last, whole);
            Some(difference)
        });
        Self::Steps { d: d.collect(), s: format!("1e{exponent}").parse().unwrap_or(1.0) }
    }

    /// The samples as the page reads them.
    #[cfg(test)]
    fn read(&self, count: usize) -> Vec<f64> {
        match self {
            Self::Constant(value) => vec![value.unwrap_or(f64::NAN); count],
            Self::Values { v } => v.iter().map(|v| v.unwrap_or(f64::NAN)).collect(),
            Self::Steps { s, d } => {
                let (mut last, mut before) = (0, 0);
                let next = d.iter().map(|d| {
                    let Some(d) = d else { return f64::NAN };
                    let whole = d + 2 * last - before;
                    (before, last) = (last, whole);
                    whole as f64 * s
                });
                next.collect()
            }
        }
    }
}

/// Nearest integer multiple of a power of ten.
fn in_steps(x: f64, exponent: i32) -> i64 {
    (x * 10f64.powi(-exponent)).round() as i64
}

fn value(x: f64) -> Option<f64> {
    (x.abs() < INFINITE).then(|| rounded(x, DIGITS as usize))
}

/// A value with this number of digits.
fn rounded(x: f64, digits: usize) -> f64 {
    format!("{x:.*e}", digits.saturating_sub(1)).parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(samples: &[f64]) -> f64 {
        let read = Series::new(samples).read(samples.len());
        samples.iter().zip(read).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn stored_samples_have_six_digits_of_their_range() {
        for (scale, offset) in [(1.0, 0.0), (3e4, 1e4), (2e-9, 1e-8), (7e12, -1.0), (1e-3, 1e3)] {
            let samples: Vec<f64> = (0..300).map(|k| offset + scale * (f64::from(k) / 40.0).sin()).collect();
            assert!(error(&samples) <= 1e-6 * 2.0 * scale, "{scale} {offset}: {}", error(&samples));
        }
    }

    #[test]
    fn a_constant_or_missing_series_is_one_value() {
        assert_eq!(Series::new(&[9.81; 5]), Series::Constant(Some(9.81)));
        assert_eq!(Series::new(&[0.0; 5]), Series::Constant(Some(0.0)));
        assert_eq!(Series::new(&[f64::NAN; 5]), Series::Constant(None));
        assert_eq!(serde_json::to_string(&Series::new(&[f64::NAN])).unwrap(), "null");
    }

    #[test]
    fn a_missing_value_is_a_gap_and_the_others_stay() {
        let read = Series::new(&[1.0, 2.0, f64::NAN, f64::MAX, 4.0, 8.0]).read(6);
        assert!(read[2].is_nan() && read[3].is_nan());
        assert_eq!([read[0], read[1], read[4], read[5]], [1.0, 2.0, 4.0, 8.0]);
    }

    #[test]
    fn a_peak_does_not_take_the_digits_of_the_rest() {
        let mut samples: Vec<f64> = (0..100).map(|k| 1.0 + f64::from(k) / 100.0).collect();
        samples[50] = 1e12;
        let read = Series::new(&samples).read(100);
        assert!(samples.iter().zip(read).all(|(a, b)| (a - b).abs() <= 1e-5 * a.abs()));
    }
}
