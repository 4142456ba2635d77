//! Bytes that are written field by field.
//!
//! In: fields, memory of bytes that were written before. Out: the bytes. Must not know: what the fields mean.

/// Bytes that were written, followed by memory for further bytes. A field costs a comparison and a copy; memory that
/// is used again is not cleared.
#[derive(Debug, Default)]
pub struct Writer {
    /// The written bytes up to `end`, then any bytes.
    memory: Vec<u8>,
    end: usize,
}

/// Least memory that is added [bytes]. Most saved states are smaller.
const LEAST: usize = 4096;

impl Writer {
    /// Nothing written yet, with the memory of these bytes.
    pub fn new(memory: Vec<u8>) -> Self {
        Self { memory, end: 0 }
    }

    /// Appends what `write` writes to these bytes.
    pub fn append_to<R>(bytes: &mut Vec<u8>, write: impl FnOnce(&mut Self) -> R) -> R {
        let memory = std::mem::take(bytes);
        let mut writer = Self { end: memory.len(), memory };
        let result = write(&mut writer);
        *bytes = writer.finish();
        result
    }

    /// Number of bytes that were written.
    pub fn written(&self) -> usize {
        self.end
    }

    /// The bytes.
    pub fn finish(mut self) -> Vec<u8> {
        self.memory.truncate(self.end);
        self.memory
    }

    /// Writes a few bytes.
    #[inline(always)]
    pub fn put<const N: usize>(&mut self, bytes: [u8; N]) {
        match self.memory.get_mut(self.end..).and_then(<[u8]>::first_chunk_mut) {
            Some(place) => {
                *place = bytes;
                self.end += N;
            }
            None => self.extend(&bytes),
        }
    }

    /// Writes these bytes.
    #[inline(never)]
    pub fn extend(&mut self, bytes: &[u8]) {
        self.next(bytes.len()).copy_from_slice(bytes);
    }

    /// Writes numbers as little-endian bytes.
    pub fn append(&mut self, values: &[f64]) {
        let (words, _) = self.next(size_of_val(values)).as_chunks_mut::<8>();
        words.iter_mut().zip(values).for_each(|(word, value)| *word = value.to_le_bytes());
    }

    /// The next bytes, to be overwritten.
    #[inline]
    fn next(&mut self, count: usize) -> &mut [u8] {
        let start = self.end;
        self.end += count;
        if self.end > self.memory.len() {
            self.grow();
        }
        &mut self.memory[start..self.end]
    }

    /// Makes room up to the end and for as many bytes again.
    #[cold]
    #[inline(never)]
    fn grow(&mut self) {
        let size = (2 * self.end).max(LEAST).max(self.memory.capacity());
        self.memory.resize(size, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Memory with other bytes, of any length, gives the same bytes as new memory.
    #[test]
    fn memory_that_is_used_again_does_not_show() {
        let numbers = [1.5, -2.0, f64::NAN, 0.0, 7.0];
        let written = |memory: Vec<u8>| {
            let mut writer = Writer::new(memory);
            writer.put([1, 2, 3]);
            writer.append(&numbers);
            writer.put([4]);
            writer.extend(&[5; 6000]);
            assert_eq!(writer.written(), 3 + 40 + 1 + 6000);
            writer.finish()
        };
        let first = written(Vec::new());
        assert_eq!(first[..4], [1, 2, 3, 0]);
        assert_eq!(first[43..45], [4, 5]);
        assert_eq!(first[35..43], 7.0_f64.to_le_bytes());
        for length in [1, 3, 20, 44, 6044, 9000] {
            assert_eq!(written(vec![9; length]), first, "{length}");
        }
    }

    #[test]
    fn bytes_are_appended_to_others() {
        let mut bytes = vec![1, 2];
        Writer::append_to(&mut bytes, |writer| writer.put([3]));
        Writer::append_to(&mut bytes, |writer| writer.extend(&[4]));
        assert_eq!(bytes, [1, 2, 3, 4]);
    }
}
