//! Lists of numbers compared bit by bit.

/// Whether two lists agree in every bit. The comparison has no branch, because lists usually agree.
#[inline]
pub fn same_bits(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |differ, (a, b)| differ | (a.to_bits() ^ b.to_bits())) == 0
}

/// Copies `other` to `own`, of the same length, if they differ, and returns whether they differ. Comparing is cheaper
/// than copying.
#[inline]
pub fn become_same(own: &mut [f64], other: &[f64]) -> bool {
    let differ = !same_bits(own, other);
    if differ {
        own.copy_from_slice(other);
    }
    differ
}
