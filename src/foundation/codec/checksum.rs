//! Check sums and hashes of bytes.
//!
//! In: bytes or texts. Out: one number, identical on every machine. Must not know: what the bytes mean.

/// FNV-1a with 64 bits: <http://www.isthe.com/chongo/tech/comp/fnv/>.
pub fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01B3))
}

/// FNV-1a with 128 bits of the concatenated texts.
pub fn fnv1a_128<'a>(texts: impl IntoIterator<Item = &'a str>) -> u128 {
    texts.into_iter().flat_map(str::bytes).fold(0x6C62_272E_07BB_0142_62B8_2175_6295_C58D, |hash, byte| {
        (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013B)
    })
}

/// XXH64 with the seed 0, <https://github.com/Cyan4973/xxHash/blob/v0.8.3/doc/xxhash_spec.md>. Several bytes are
/// processed in each clock cycle.
pub fn xxh64(bytes: &[u8]) -> u64 {
    const P: [u64; 5] = [
        0x9E37_79B1_85EB_CA87,
        0xC2B2_AE3D_27D4_EB4F,
        0x1656_67B1_9E37_79F9,
        0x85EB_CA77_C2B2_AE63,
        0x27D4_EB2F_1656_67C5,
    ];
    let round = |lane: u64, word: u64| lane.wrapping_add(word.wrapping_mul(P[1])).rotate_left(31).wrapping_mul(P[0]);
    let (stripes, rest) = bytes.as_chunks::<32>();
    let mut sum = P[4];
    if !stripes.is_empty() {
        let mut lanes = [P[0].wrapping_add(P[1]), P[1], 0, P[0].wrapping_neg()];
        for stripe in stripes {
            let (words, _) = stripe.as_chunks::<8>();
            for (lane, word) in lanes.iter_mut().zip(words) {
                *lane = round(*lane, u64::from_le_bytes(*word));
            }
        }
        let mixed = lanes.iter().zip([1, 7, 12, 18]).map(|(lane, bits)| lane.rotate_left(bits));
        sum = lanes.iter().fold(mixed.fold(0, u64::wrapping_add), |sum, lane| {
            (sum ^ round(0, *lane)).wrapping_mul(P[0]).wrapping_add(P[3])
        });
    }
    sum = sum.wrapping_add(bytes.len() as u64);
    let (words, rest) = rest.as_chunks::<8>();
    for word in words {
        sum = (sum ^ round(0, u64::from_le_bytes(*word))).rotate_left(27).wrapping_mul(P[0]).wrapping_add(P[3]);
    }
    let (words, rest) = rest.as_chunks::<4>();
    for word in words {
        let word = u64::from(u32::from_le_bytes(*word)).wrapping_mul(P[0]);
        sum = (sum ^ word).rotate_left(23).wrapping_mul(P[1]).wrapping_add(P[2]);
    }
    for byte in rest {
        sum = (sum ^ u64::from(*byte).wrapping_mul(P[4])).rotate_left(11).wrapping_mul(P[0]);
    }
    sum = (sum ^ sum >> 33).wrapping_mul(P[1]);
    sum = (sum ^ sum >> 29).wrapping_mul(P[2]);
    sum ^ sum >> 32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Similar numbers differ in their last byte, or in their signs.
    #[test]
    fn the_sum_of_words_sees_every_changed_byte_and_every_two_signs() {
        let bytes: Vec<u8> = (0..219_u8).map(|i| i.wrapping_mul(37)).collect();
        let sum = xxh64(&bytes);
        for i in 0..bytes.len() {
            let changed = |places: &[usize], bit: u8| {
                let mut other = bytes.clone();
                places.iter().for_each(|&place| other[place] ^= bit);
                xxh64(&other)
            };
            assert_ne!(changed(&[i], 1), sum, "byte {i}");
            assert!((0..i).all(|j| changed(&[i, j], 0x80) != sum), "byte {i}");
            assert_ne!(xxh64(&bytes[..i]), sum, "{i} bytes");
        }
    }

    #[test]
    fn sums_are_those_of_their_definitions() {
        assert_eq!(fnv1a(b""), 0xCBF2_9CE4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xAF63_DC4C_8601_EC8C);
        assert_eq!(fnv1a_128([]), 0x6C62_272E_07BB_0142_62B8_2175_6295_C58D);
        assert_eq!(xxh64(b""), 0xEF46_DB37_51D8_E999);
        assert_eq!(xxh64(b"abc"), 0x44BC_2CF5_AD77_0999);
        assert_eq!(xxh64(b"Nobody inspects the spammish repetition"), 0xFBCE_A83C_8A37_8BF1);
        assert_eq!(fnv1a_128(["a"]), 0xD228_CB69_6F1A_8CAF_7891_2B70_4E4A_8964);
    }
}
