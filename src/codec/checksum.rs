//! Check sums and hashes of bytes.
//!
//! In: bytes or texts. Out: one number, the same on every machine. It must not know what the bytes mean.

/// CRC-32 of IEEE 802.3, as in zip and PNG. It detects every change within 32 consecutive bits.
pub fn crc32(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut i = 0;
        while i < 256 {
            let (mut crc, mut bit) = (i as u32, 0);
            while bit < 8 {
                crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
                bit += 1;
            }
            table[i] = crc;
            i += 1;
        }
        table
    };
    !bytes.iter().fold(!0, |crc: u32, byte| crc >> 8 ^ TABLE[usize::from(crc as u8 ^ byte)])
}

/// FNV-1a with 64 bits: <http://www.isthe.com/chongo/tech/comp/fnv/>.
pub fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01B3))
}

/// FNV-1a with 128 bits, of the texts as if they were one.
pub fn fnv1a_128<'a>(texts: impl IntoIterator<Item = &'a str>) -> u128 {
    texts.into_iter().flat_map(str::bytes).fold(0x6C62_272E_07BB_0142_62B8_2175_6295_C58D, |hash, byte| {
        (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013B)
    })
}

/// Sum of 64 bits of many bytes, some bytes in each clock cycle: FNV-1a over words of 64 bits in eight lanes, then over the
/// lanes and the number of bytes. A change within one word always changes it.
pub fn sum64(bytes: &[u8]) -> u64 {
    const PRIME: u64 = 0x0000_0100_0000_01B3;
    let add = |sum: u64, word: u64| (sum ^ word).wrapping_mul(PRIME);
    let (blocks, rest) = bytes.as_chunks::<64>();
    let mut lanes = [0xCBF2_9CE4_8422_2325_u64; 8];
    for block in blocks {
        let (words, _) = block.as_chunks::<8>();
        for (lane, word) in lanes.iter_mut().zip(words) {
            *lane = add(*lane, u64::from_le_bytes(*word));
        }
    }
    let rest = rest.chunks(8).map(|part| part.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte)));
    lanes.into_iter().chain(rest).chain([bytes.len() as u64]).fold(PRIME, add)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_of_words_sees_every_changed_byte() {
        let bytes: Vec<u8> = (0..219_u8).map(|i| i.wrapping_mul(37)).collect();
        let sum = sum64(&bytes);
        for i in 0..bytes.len() {
            let mut other = bytes.clone();
            other[i] ^= 1;
            assert_ne!(sum64(&other), sum, "byte {i}");
            assert_ne!(sum64(&bytes[..i]), sum, "{i} bytes");
        }
        assert_eq!(sum64(b""), sum64(&[]));
        assert_ne!(sum64(&[0]), sum64(&[0, 0]));
    }

    #[test]
    fn sums_are_those_of_their_definitions() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
        assert_eq!(crc32(b""), 0);
        assert_eq!(fnv1a(b""), 0xCBF2_9CE4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xAF63_DC4C_8601_EC8C);
        assert_eq!(fnv1a_128([]), 0x6C62_272E_07BB_0142_62B8_2175_6295_C58D);
        assert_eq!(fnv1a_128(["a"]), 0xD228_CB69_6F1A_8CAF_7891_2B70_4E4A_8964);
    }
}
