//! Direction numbers of Sobol's sequence (Joe and Kuo 2008, the criterion D(6)).
//!
//! In: a dimension. Out: for each bit of the number of a point, its effect on the coordinate. `joe_kuo/directions.txt`
//! contains the table of the authors, and its licence is next to it.

/// For each dimension from the second on: its number, the degree s and the inner coefficients a of a primitive
/// polynomial, and the first s direction numbers.
const TABLE: &str = include_str!("joe_kuo/directions.txt");
/// Number of bits of a direction.
const WORD: usize = u64::BITS as usize;

/// Largest number of dimensions.
pub const DIMENSIONS: usize = 100;

/// Directions of this number of dimensions for the first `bits` bits of the number of a point.
pub fn directions(dimensions: usize, bits: usize) -> Vec<Vec<u64>> {
    let first = (1..=bits).map(|bit| 1 << (WORD - bit)).collect();
    // The first line is a heading.
    let others = TABLE.lines().skip(1).map(|line| {
        let numbers: Vec<u64> = line.split(' ').filter_map(|number| number.parse().ok()).collect();
        of_polynomial(&numbers[3..], numbers[2], bits)
    });
    std::iter::once(first).chain(others).take(dimensions).collect()
}

/// v_i = a_1 v_(i-1) xor ... xor a_(s-1) v_(i-s+1) xor v_(i-s) xor (v_(i-s) >> s), eq. (2) of the authors' notes.
fn of_polynomial(starts: &[u64], inner: u64, bits: usize) -> Vec<u64> {
    let degree = starts.len();
    let mut all: Vec<u64> = starts.iter().zip(1..).map(|(start, bit)| start << (WORD - bit)).collect();
    for i in degree..bits {
        let oldest = all[i - degree];
        let of_inner = (1..degree).filter(|k| inner >> (degree - 1 - k) & 1 == 1).map(|k| all[i - k]);
        all.push(of_inner.fold(oldest ^ (oldest >> degree), |all, one| all ^ one));
    }
    all.truncate(bits);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first direction number of a dimension halves the unit interval, and all direction numbers are odd multiples
    /// of their bit. Therefore each of 2^n equal parts contains one of the first 2^n points.
    #[test]
    fn each_dimension_is_a_sequence_of_equal_parts() {
        let all = directions(DIMENSIONS, 53);
        assert_eq!(all.len(), DIMENSIONS);
        for directions in &all {
            assert!(directions.iter().zip(1..).all(|(v, bit)| v.trailing_zeros() == u64::BITS - bit), "{directions:?}");
        }
        // Table of the authors: dimension 3 has s = 2, a = 1, m = 1, 3; then 3, 9, 29, 23.
        let numbers: Vec<u64> = all[2].iter().zip(1..).map(|(v, bit)| v >> (64 - bit)).take(6).collect();
        assert_eq!(numbers, [1, 3, 3, 9, 29, 23]);
    }
}
