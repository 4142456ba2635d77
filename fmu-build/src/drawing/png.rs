//! Pixels as PNG (ISO/IEC 15948).
//!
//! In: pixels of three or four bytes. Out: the file. Its bytes depend only on the pixels. The module must not know what
//! the pixels show.

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use std::io::{self, Write};

/// First bytes of every file.
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// A picture with `N` bytes per pixel, line by line: red, green, blue. A fourth byte is the opacity, by which the
/// colours are not multiplied.
///
/// # Errors
/// The number of pixels does not agree with the size, or is 0.
pub fn encode<const N: usize>(pixels: &[[u8; N]], [width, height]: [u32; 2]) -> io::Result<Vec<u8>> {
    const { assert!(N == 3 || N == 4) };
    if pixels.is_empty() || pixels.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(io::Error::other(format!("{} pixels do not fill a picture of {width} x {height}", pixels.len())));
    }
    let mut lines = ZlibEncoder::new(Vec::new(), Compression::default());
    for line in pixels.chunks_exact(width as usize) {
        // Each line starts with its filter. Without a filter even areas need the fewest bytes.
        lines.write_all(&[0])?;
        lines.write_all(line.as_flattened())?;
    }
    // Eight bits per channel; colour with or without opacity; the only methods; not interlaced.
    let kind = [8, if N == 4 { 6 } else { 2 }, 0, 0, 0];
    let mut file = SIGNATURE.to_vec();
    chunk(&mut file, b"IHDR", &[&width.to_be_bytes()[..], &height.to_be_bytes(), &kind].concat());
    chunk(&mut file, b"IDAT", &lines.finish()?);
    chunk(&mut file, b"IEND", &[]);
    Ok(file)
}

/// A part of the file: length, name, content, check sum of the last two.
fn chunk(file: &mut Vec<u8>, name: &[u8; 4], content: &[u8]) {
    let mut crc = Crc::new();
    crc.update(name);
    crc.update(content);
    for part in [&(content.len() as u32).to_be_bytes()[..], name, content, &crc.sum().to_be_bytes()] {
        file.extend_from_slice(part);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn lines_follow_the_head() {
        let file = encode(&[[1, 2, 3, 255], [4, 5, 6, 128]], [1, 2]).unwrap();
        assert_eq!(file[..8], *b"\x89PNG\r\n\x1a\n");
        assert_eq!(file[8..29], *b"\0\0\0\x0dIHDR\0\0\0\x01\0\0\0\x02\x08\x06\0\0\0");
        let length = u32::from_be_bytes(file[33..37].try_into().unwrap()) as usize;
        assert_eq!(file[37..41], *b"IDAT");
        let mut lines = Vec::new();
        ZlibDecoder::new(&file[41..41 + length]).read_to_end(&mut lines).unwrap();
        assert_eq!(lines, [0, 1, 2, 3, 255, 0, 4, 5, 6, 128]);
        // The last chunk is equal in all files.
        assert_eq!(file[45 + length..], *b"\0\0\0\0IEND\xae\x42\x60\x82");
        assert!(encode(&[[0; 3]; 5], [2, 3]).is_err());
    }
}
