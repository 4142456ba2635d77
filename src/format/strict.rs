//! JSON read to the letter: an object is an object, and every key has a value.
//!
//! serde's derived types also take an array for an object (values in the order of the fields), null for an optional
//! key, and an object for a word; in a definition all three are faults. A text in the place of a number is an expression
//! where [`Numbers`] take it. An error leaves the path of its key: each object and list that it leaves adds its part.
use super::numbers::Numbers;
use serde::de::value::StrDeserializer;
use serde::de::{Deserialize, DeserializeSeed, Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::forward_to_deserialize_any;
use std::borrow::Cow;
use std::cell::RefCell;
use std::fmt;

/// What is common to all that is read from one text.
pub struct Reading<'n> {
    /// Takes the texts in the place of numbers.
    numbers: &'n Numbers,
    /// Path of the key at fault, as far as the error has come: `.crank.points[1]`; empty while there is none.
    path: RefCell<String>,
}

impl<'n> Reading<'n> {
    /// Nothing is read yet.
    pub fn new(numbers: &'n Numbers) -> Self {
        Self { numbers, path: RefCell::default() }
    }

    /// Path of the key at fault, such as `bodies.crank.points.tip[1]`; empty at the top.
    pub fn into_path(self) -> String {
        let path = self.path.into_inner();
        path.strip_prefix('.').unwrap_or(&path).to_owned()
    }

    /// An error leaves this part of the text.
    #[cold]
    fn leave(&self, part: fmt::Arguments) {
        let mut path = self.path.borrow_mut();
        *path = format!("{part}{path}");
    }
}

/// Deserializer that reads to the letter, and so does all inside it.
pub struct Strict<'r, D> {
    inner: D,
    reading: &'r Reading<'r>,
}

impl<'r, D> Strict<'r, D> {
    /// Reads to the letter.
    pub fn new(inner: D, reading: &'r Reading<'r>) -> Self {
        Self { inner, reading }
    }
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Strict<'_, D> {
    type Error = D::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.inner.deserialize_any(Any { visitor, reading: self.reading })
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.inner.deserialize_any(Number(Any { visitor, reading: self.reading }))
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.inner.deserialize_map(Object(Any { visitor, reading: self.reading }))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        self.deserialize_map(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        visitor.visit_some(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        self.inner.deserialize_str(Word(visitor))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 char str string bytes byte_buf unit unit_struct newtype_struct
        seq tuple tuple_struct identifier ignored_any
    }
}

/// Visitor of any value; objects and lists are read to the letter.
struct Any<'n, V> {
    visitor: V,
    reading: &'n Reading<'n>,
}

/// The visits of JSON's values that are no text, passed on.
macro_rules! pass_on {
    ($($visit:ident($type:ty))*) => {
        $(fn $visit<E: Error>(self, value: $type) -> Result<V::Value, E> {
            self.any().visitor.$visit(value)
        })*

        fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
            self.any().visitor.visit_unit()
        }

        fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<V::Value, A::Error> {
            let any = self.any();
            any.visitor.visit_seq(List { inner: list, index: 0, reading: any.reading })
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<V::Value, A::Error> {
            let any = self.any();
            any.visitor.visit_map(Entries { inner: map, key: Cow::default(), reading: any.reading })
        }
    };
}

impl<'n, V> Any<'n, V> {
    fn any(self) -> Self {
        self
    }
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Any<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.visitor.expecting(f)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<V::Value, E> {
        self.visitor.visit_str(text)
    }

    fn visit_borrowed_str<E: Error>(self, text: &'de str) -> Result<V::Value, E> {
        self.visitor.visit_borrowed_str(text)
    }

    fn visit_string<E: Error>(self, text: String) -> Result<V::Value, E> {
        self.visitor.visit_string(text)
    }

    pass_on! { visit_bool(bool) visit_i64(i64) visit_u64(u64) visit_f64(f64) }
}

/// Visitor of a number, or of an expression in its place.
struct Number<'n, V>(Any<'n, V>);

impl<'n, V> Number<'n, V> {
    fn any(self) -> Any<'n, V> {
        self.0
    }
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Number<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.visitor.expecting(f)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<V::Value, E> {
        match self.0.reading.numbers.take(text) {
            Some(number) => self.0.visitor.visit_f64(number.map_err(E::custom)?),
            None => self.0.visitor.visit_str(text),
        }
    }

    pass_on! { visit_bool(bool) visit_i64(i64) visit_u64(u64) visit_f64(f64) }
}

/// Visitor of an object.
struct Object<'n, V>(Any<'n, V>);

impl<'de, V: Visitor<'de>> Visitor<'de> for Object<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(map)
    }
}

/// Entries of an object.
struct Entries<'r, 'de, A> {
    inner: A,
    /// The key that was read last.
    key: Cow<'de, str>,
    reading: &'r Reading<'r>,
}

impl<'de, A: MapAccess<'de>> Entries<'_, 'de, A> {
    /// Read the next key; whether there is one.
    #[inline(never)]
    fn read_key(&mut self) -> Result<bool, A::Error> {
        let next = self.inner.next_key()?.map(|Key(key)| self.key = key);
        Ok(next.is_some())
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Entries<'_, 'de, A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, A::Error> {
        if !self.read_key()? {
            return Ok(None);
        }
        let key: StrDeserializer<A::Error> = (&*self.key).into_deserializer();
        seed.deserialize(key).map(Some).inspect_err(|_| self.reading.leave(format_args!(".{}", self.key)))
    }

    // One copy for each type of a value, not for each key.
    #[inline(never)]
    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, A::Error> {
        self.inner.next_value_seed(Inside { seed, part: format_args!(".{}", self.key), reading: self.reading })
    }
}

/// Elements of a list.
struct List<'r, A> {
    inner: A,
    index: usize,
    reading: &'r Reading<'r>,
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for List<'_, A> {
    type Error = A::Error;

    #[inline(never)]
    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, A::Error> {
        let index = self.index;
        self.index += 1;
        self.inner.next_element_seed(Inside { seed, part: format_args!("[{index}]"), reading: self.reading })
    }

    fn size_hint(&self) -> Option<usize> {
        self.inner.size_hint()
    }
}

/// Seed of a value inside an object or a list.
struct Inside<'r, S> {
    seed: S,
    /// The value's part of a path.
    part: fmt::Arguments<'r>,
    reading: &'r Reading<'r>,
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Inside<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<S::Value, D::Error> {
        let read = self.seed.deserialize(Strict::new(deserializer, self.reading));
        read.inspect_err(|_| self.reading.leave(self.part))
    }
}

/// A key, a part of the text where it has no escapes.
struct Key<'de>(Cow<'de, str>);

impl<'de> Deserialize<'de> for Key<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Letters;
        impl<'de> Visitor<'de> for Letters {
            type Value = Key<'de>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a key")
            }

            fn visit_borrowed_str<E: Error>(self, text: &'de str) -> Result<Key<'de>, E> {
                Ok(Key(text.into()))
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Key<'de>, E> {
                Ok(Key(text.to_owned().into()))
            }
        }
        deserializer.deserialize_str(Letters)
    }
}

/// One of several words.
struct Word<V>(V);

impl<'de, V: Visitor<'de>> Visitor<'de> for Word<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a word")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<V::Value, E> {
        let word: StrDeserializer<E> = word.into_deserializer();
        self.0.visit_enum(word)
    }
}
