//! Factor by which a step could have been larger: an inverse root of its error.
use std::f64::consts::LN_2;

/// Binary digits of the mantissa, and the offset of the stored exponent.
const DIGITS: u32 = 52;
const BIAS: f64 = 1023.0;
const MANTISSA: u64 = (1 << DIGITS) - 1;

/// x^(-1/n) with a relative error below 1/200, for n >= 4 and normal x > 0. For smaller x and 0: a finite number larger
/// than for any normal x.
///
/// This accuracy is sufficient for step sizes, and every step needs the computation. The result is 2^(-log2(x) / n).
/// With x = 2^e (1 + m), 0 <= m < 1, log2(1 + m) is m + 0.3463 m (1 - m) within 0.007. 2^m, |m| <= 1/2, is its series
/// up to m^3 within 0.0008. Unlike the power of a mathematical library, the result is identical on every platform.
#[inline]
pub fn inverse_root(x: f64, n: f64) -> f64 {
    const LOGARITHM: f64 = 0.3463;
    const POWER: [f64; 3] = [LN_2, LN_2 * LN_2 / 2.0, LN_2 * LN_2 * LN_2 / 6.0];
    /// Adding this number rounds a sum to an integer, which is then in the last digits of the mantissa.
    const TO_INTEGER: f64 = 1.5 * (1u64 << DIGITS) as f64;
    let m = f64::from_bits(x.to_bits() & MANTISSA | 1f64.to_bits()) - 1.0;
    let exponent = (x.to_bits() >> DIGITS) as i32;
    let logarithm = f64::from(exponent) - BIAS + m * (1.0 + LOGARITHM * (1.0 - m));
    // The exponent as stored, from 1 on.
    let stored = BIAS - logarithm * (1.0 / n);
    let whole = stored + TO_INTEGER;
    let m = stored - (whole - TO_INTEGER);
    f64::from_bits(whole.to_bits() << DIGITS) * (1.0 + m * (POWER[0] + m * (POWER[1] + m * POWER[2])))
}

#[cfg(test)]
mod tests {
    use super::inverse_root;

    #[test]
    fn it_is_the_power_within_a_part_in_200() {
        for n in [4.0, 8.0, 126.0] {
            for k in -60_000..=60_000 {
                let x = 10f64.powf(f64::from(k) * 0.005);
                let ratio = inverse_root(x, n) / x.powf(-1.0 / n);
                assert!((ratio - 1.0).abs() < 5e-3, "{x}^(-1/{n}): ratio {ratio}");
            }
            assert_eq!(inverse_root(1.0, n), 1.0);
            assert!(inverse_root(0.0, n) > inverse_root(f64::MIN_POSITIVE, n) && inverse_root(0.0, n).is_finite());
            assert!(inverse_root(f64::MAX, n) > 0.0);
        }
    }
}
