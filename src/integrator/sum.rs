//! Compensated sums: the state as the sum of many increments, without the rounding of each.

/// y + increment + carry, and the part of that sum lost to rounding: Knuth's two-sum.
pub fn add_compensated<const N: usize>(y: &[f64; N], increment: &[f64; N], carry: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut end, mut lost) = ([0.0; N], [0.0; N]);
    for n in 0..N {
        let delta = increment[n] + carry[n];
        end[n] = y[n] + delta;
        let back = end[n] - y[n];
        lost[n] = (y[n] - (end[n] - back)) + (delta - back);
    }
    (end, lost)
}
