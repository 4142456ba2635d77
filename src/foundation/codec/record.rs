//! Records: sequences of numbers as little-endian bytes. Writing and reading use the same list of fields.
//!
//! In: fields in a fixed order. Out: bytes; or the fields, each checked against its range. The bytes do not depend on
//! the machine. Must not know: what the fields mean.

use super::writer::Writer;

/// Largest small count in a record. It is half of the type's range, so that later increments do not overflow.
const LARGEST: u32 = u32::MAX / 2;

/// Reason why a record cannot be read: it is too short, or a field is outside its range.
#[derive(Clone, Debug, PartialEq)]
pub struct Damaged(pub Box<str>);

impl Damaged {
    /// A record with this fault.
    pub fn new(reason: impl Into<Box<str>>) -> Self {
        Self(reason.into())
    }

    /// Accepts a field if `allowed` is true.
    fn unless(allowed: bool, reason: impl FnOnce() -> String) -> Result<(), Self> {
        if allowed { Ok(()) } else { Err(Self(reason().into())) }
    }
}

/// A record that is written or read. Writing checks only counters and choices. Reading checks a field and replaces its
/// value. Every method returns an error at the end of a record that is read, and for a field out of range.
#[derive(Debug)]
pub enum Record<'a> {
    /// Fields are appended to the bytes of this writer.
    Write(&'a mut Writer),
    /// The bytes that remain to be read.
    Read(&'a [u8]),
}

impl Record<'_> {
    /// Whether the record is read.
    pub fn reads(&self) -> bool {
        matches!(self, Self::Read(_))
    }

    /// Writes these bytes or reads as many. Inlined, because most records are written.
    #[inline(always)]
    fn bytes<const N: usize>(&mut self, value: [u8; N]) -> Result<[u8; N], Damaged> {
        if let Self::Write(out) = self {
            out.put(value);
            return Ok(value);
        }
        self.read()
    }

    /// Reads the next bytes.
    #[inline(never)]
    fn read<const N: usize>(&mut self) -> Result<[u8; N], Damaged> {
        let Self::Read(rest) = self else { return Err(ended()) };
        let (first, after) = rest.split_first_chunk().ok_or_else(ended)?;
        *rest = after;
        Ok(*first)
    }

    /// Any whole number of 64 bits.
    #[inline]
    pub fn word(&mut self, value: &mut u64) -> Result<(), Damaged> {
        *value = u64::from_le_bytes(self.bytes(value.to_le_bytes())?);
        Ok(())
    }

    /// A work counter, 64 bits.
    #[inline]
    pub fn count(&mut self, name: &str, value: &mut u64) -> Result<(), Damaged> {
        let limit = u64::MAX / 2;
        self.word(value)?;
        if *value <= limit { Ok(()) } else { Err(beyond(name, *value, limit)) }
    }

    /// A small count, 32 bits.
    #[inline]
    pub fn small(&mut self, name: &str, value: &mut u32) -> Result<(), Damaged> {
        *value = u32::from_le_bytes(self.bytes(value.to_le_bytes())?);
        if *value <= LARGEST { Ok(()) } else { Err(beyond(name, u64::from(*value), u64::from(LARGEST))) }
    }

    /// Index of one of `choices` alternatives, as one byte.
    #[inline]
    pub fn choice(&mut self, name: &str, value: &mut u8, choices: usize) -> Result<(), Damaged> {
        [*value] = self.bytes([*value])?;
        if usize::from(*value) < choices { Ok(()) } else { Err(not_below(name, u64::from(*value), choices)) }
    }

    /// A truth value: a byte, 0 or 1.
    #[inline]
    pub fn flag(&mut self, name: &str, value: &mut bool) -> Result<(), Damaged> {
        if let Self::Write(out) = self {
            out.put([u8::from(*value)]);
            return Ok(());
        }
        self.read_flag(name, value)
    }

    #[cold]
    #[inline(never)]
    fn read_flag(&mut self, name: &str, value: &mut bool) -> Result<(), Damaged> {
        let mut byte = 0;
        self.choice(name, &mut byte, 2)?;
        *value = byte == 1;
        Ok(())
    }

    /// An index below `count`, as 64 bits.
    #[inline]
    pub fn place(&mut self, name: &str, value: &mut usize, count: usize) -> Result<(), Damaged> {
        let mut word = *value as u64;
        self.word(&mut word)?;
        *value = word as usize;
        if word < count as u64 || !self.reads() { Ok(()) } else { Err(not_below(name, word, count)) }
    }

    /// Length of a list that the reader knows in advance.
    #[inline]
    pub fn length(&mut self, name: &str, known: usize) -> Result<(), Damaged> {
        if let Self::Write(out) = self {
            out.put((known as u64).to_le_bytes());
            return Ok(());
        }
        self.read_length(name, known)
    }

    #[cold]
    #[inline(never)]
    fn read_length(&mut self, name: &str, known: usize) -> Result<(), Damaged> {
        let length = u64::from_le_bytes(self.read()?);
        Damaged::unless(length == known as u64, || {
            format!("the saved list '{name}' has {length} entries, but this model needs {known} entries")
        })
    }

    /// Length of a list that the reader does not know in advance. Each item has at least `each` bytes.
    pub fn size(&mut self, name: &str, size: &mut usize, each: usize) -> Result<(), Damaged> {
        let mut word = *size as u64;
        self.word(&mut word)?;
        if let Self::Read(rest) = self {
            let most = (rest.len() / each.max(1)) as u64;
            Damaged::unless(word <= most, || {
                format!(
                    "the saved list '{name}' states {word} entries, but the remaining bytes contain at most {most} \
                     entries"
                )
            })?;
        }
        *size = word as usize;
        Ok(())
    }

    /// A list of arrays of finite numbers, with its length.
    pub fn arrays<const N: usize>(&mut self, name: &str, arrays: &mut Vec<[f64; N]>) -> Result<(), Damaged> {
        let mut size = arrays.len();
        self.size(name, &mut size, size_of::<[f64; N]>())?;
        match self {
            Self::Write(out) => out.append(arrays.as_flattened()),
            Self::Read(rest) => {
                let (own, after) = rest.split_at(size * size_of::<[f64; N]>());
                *rest = after;
                let (words, _) = own.as_chunks::<8>();
                Damaged::unless(are_finite(words), || {
                    format!(
                        "the saved list '{name}' contains a number that is not \
                    finite"
                    )
                })?;
                *arrays = vec![[0.0; N]; size];
                fill(arrays.as_flattened_mut(), words);
            }
        }
        Ok(())
    }

    /// A number for which `allowed` is true. `text` states the condition for the message.
    #[inline(always)]
    pub fn number(
        &mut self,
        name: &str,
        value: &mut f64,
        allowed: impl Fn(f64) -> bool,
        text: &str,
    ) -> Result<(), Damaged> {
        if let Self::Write(out) = self {
            out.put(value.to_le_bytes());
            return Ok(());
        }
        self.read_number(name, value, &allowed, text)
    }

    /// [`Self::number`] of a record that is read: one function for all conditions.
    #[cold]
    #[inline(never)]
    fn read_number(
        &mut self,
        name: &str,
        value: &mut f64,
        allowed: &dyn Fn(f64) -> bool,
        text: &str,
    ) -> Result<(), Damaged> {
        let read = f64::from_le_bytes(self.read()?);
        Damaged::unless(allowed(read), || format!("the saved value '{name}' is {read}, but must be {text}"))?;
        *value = read;
        Ok(())
    }

    /// A finite number.
    #[inline(never)]
    pub fn finite(&mut self, name: &str, value: &mut f64) -> Result<(), Damaged> {
        self.number(name, value, f64::is_finite, "a finite number")
    }

    /// A finite number > 0.
    #[inline(never)]
    pub fn positive(&mut self, name: &str, value: &mut f64) -> Result<(), Damaged> {
        self.number(name, value, |v| v > 0.0 && v.is_finite(), "a finite number > 0")
    }

    /// The finite numbers of a slice, without its length.
    pub fn all_finite(&mut self, name: &str, values: &mut [f64]) -> Result<(), Damaged> {
        let rest = match self {
            Self::Read(rest) => rest,
            Self::Write(out) => {
                out.append(values);
                return Ok(());
            }
        };
        let (own, after) = rest.split_at_checked(size_of_val(values)).ok_or_else(ended)?;
        let (words, _) = own.as_chunks::<8>();
        if !are_finite(words) {
            let mut all = words.iter().map(|word| f64::from_le_bytes(*word));
            let first = all.find(|value| !value.is_finite()).unwrap_or(f64::NAN);
            return Err(Damaged::new(format!("the saved value '{name}' is {first}, but must be a finite number")));
        }
        fill(values, words);
        *rest = after;
        Ok(())
    }

    /// Any numbers, preceded by their count, which the reader knows in advance.
    pub fn numbers(&mut self, name: &str, values: &mut [f64]) -> Result<(), Damaged> {
        match self {
            Self::Write(out) => write_numbers(out, values),
            Self::Read(_) => {
                self.length(name, values.len())?;
                let Self::Read(rest) = self else { return Ok(()) };
                let (own, after) = rest.split_at_checked(size_of_val(values)).ok_or_else(ended)?;
                fill(values, own.as_chunks().0);
                *rest = after;
            }
        }
        Ok(())
    }

    /// An optional value: a flag, then the `fields` of the value if it exists. Reading fills the fields of `blank()`.
    #[inline]
    pub fn option<T>(
        &mut self,
        name: &str,
        value: &mut Option<T>,
        blank: impl FnOnce() -> T,
        fields: impl FnOnce(&mut Self, &mut T) -> Result<(), Damaged>,
    ) -> Result<(), Damaged> {
        let mut present = value.is_some();
        self.flag(name, &mut present)?;
        if self.reads() {
            *value = present.then(blank);
        }
        match value {
            Some(value) => fields(self, value),
            None => Ok(()),
        }
    }
}

/// The error at the end of a record.
#[cold]
fn ended() -> Damaged {
    Damaged::new("the saved data is incomplete")
}

/// The error for a count above its limit.
#[cold]
fn beyond(name: &str, value: u64, limit: u64) -> Damaged {
    Damaged::new(format!("the saved value '{name}' is {value}, but must be at most {limit}"))
}

/// The error for an index above its limit.
#[cold]
fn not_below(name: &str, value: u64, count: usize) -> Damaged {
    Damaged::new(format!("the saved value '{name}' is {value}, but must be below {count}"))
}

/// Writes numbers for [`Record::numbers`].
pub fn write_numbers(out: &mut Writer, values: &[f64]) {
    out.put((values.len() as u64).to_le_bytes());
    out.append(values);
}

/// Whether numbers in little-endian bytes are all finite.
fn are_finite(words: &[[u8; 8]]) -> bool {
    /// Mask of the exponent, whose bits are all set only in infinities and NaN.
    const EXPONENT: u64 = 0x7FF0_0000_0000_0000;
    let has_end = |word: &[u8; 8]| u64::from_le_bytes(*word) & EXPONENT == EXPONENT;
    !words.iter().fold(false, |any, word| any | has_end(word))
}

/// Sets numbers from little-endian bytes.
fn fill(values: &mut [f64], words: &[[u8; 8]]) {
    for (value, word) in values.iter_mut().zip(words) {
        *value = f64::from_le_bytes(*word);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bytes that `write` writes.
    fn written(write: impl FnOnce(&mut Record)) -> Vec<u8> {
        let mut writer = Writer::default();
        write(&mut Record::Write(&mut writer));
        writer.finish()
    }

    fn list(record: &mut Record, x: &mut f64, n: &mut u64, some: &mut Option<f64>) -> Result<(), Damaged> {
        record.finite("x", x)?;
        record.length("things", 3)?;
        record.count("n", n)?;
        record.option("some", some, || 0.0, |record, some| record.positive("some", some))
    }

    #[test]
    fn a_written_record_is_read_again_from_fixed_bytes() {
        let (mut x, mut n, mut some) = (-1.5, 258, Some(0.1));
        let bytes = written(|record| list(record, &mut x, &mut n, &mut some).unwrap());
        assert_eq!(bytes.len(), 8 + 8 + 8 + 1 + 8);
        assert_eq!(bytes[..10], [0, 0, 0, 0, 0, 0, 0xF8, 0xBF, 3, 0]);
        assert_eq!(bytes[16..18], [2, 1]);
        let (mut y, mut m, mut other) = (0.0, 0, None);
        list(&mut Record::Read(&bytes), &mut y, &mut m, &mut other).unwrap();
        assert_eq!((y, m, other), (x, n, some));
        for end in 0..bytes.len() {
            assert!(list(&mut Record::Read(&bytes[..end]), &mut y, &mut m, &mut other).is_err());
        }
    }

    #[test]
    fn lists_of_arrays_are_restored_and_limited_by_the_bytes() {
        let arrays = vec![[1.0, -2.5, 0.0], [f64::MAX, 1e-300, -0.0]];
        let bytes = written(|record| record.arrays("a", &mut arrays.clone()).unwrap());
        let read = |bytes: &[u8]| {
            let mut read: Vec<[f64; 3]> = Vec::new();
            Record::Read(bytes).arrays("a", &mut read).map(|()| read)
        };
        assert_eq!(read(&bytes), Ok(arrays));
        for end in 0..bytes.len() {
            assert!(read(&bytes[..end]).is_err());
        }
        assert!(read(&[255; 64]).unwrap_err().0.contains("contain at most 2"));
        for bad in [f64::NAN, f64::INFINITY] {
            let bytes = written(|record| record.arrays("a", &mut vec![[0.0, bad, 0.0]]).unwrap());
            assert!(read(&bytes).unwrap_err().0.contains("finite"));
        }
    }

    #[test]
    fn a_value_out_of_range_gives_an_error_with_its_name() {
        let bytes = written(|record| {
            for value in [f64::NAN, f64::INFINITY, -1.0] {
                record.finite("", &mut { value }).unwrap();
            }
        });
        assert!(Record::Read(&bytes).finite("speed", &mut 0.0).unwrap_err().0.contains("'speed' is NaN"));
        assert!(Record::Read(&bytes[16..]).positive("h", &mut 0.0).unwrap_err().0.contains("'h' is -1"));
        assert!(Record::Read(&[2]).flag("on", &mut false).unwrap_err().0.contains("'on' is 2"));
        assert!(Record::Read(&[255; 8]).place("stop", &mut 0, 3).unwrap_err().0.contains("below 3"));
        assert!(Record::Read(&[255; 8]).length("stops", 3).is_err());
    }
}
