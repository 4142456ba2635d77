//! JSON read to the letter: an object is an object, and every key has a value.
//!
//! serde's derived types also take an array for an object (values in the order of the fields), null for an optional
//! key, and an object for a word; in a definition all three are faults. A text in the place of a number is an expression
//! where [`Numbers`] take it.
use super::numbers::Numbers;
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::forward_to_deserialize_any;
use std::fmt;

/// Deserializer, access or seed that reads to the letter, and so does all inside it.
pub struct Strict<'n, T> {
    inner: T,
    numbers: &'n Numbers,
}

impl<'n, T> Strict<'n, T> {
    /// Reads to the letter; texts in the place of numbers go to `numbers`.
    pub fn new(inner: T, numbers: &'n Numbers) -> Self {
        Self { inner, numbers }
    }
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Strict<'_, D> {
    type Error = D::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.inner.deserialize_any(Any { visitor, numbers: self.numbers })
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.inner.deserialize_any(Number(Any { visitor, numbers: self.numbers }))
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.inner.deserialize_map(Object(Any { visitor, numbers: self.numbers }))
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
    numbers: &'n Numbers,
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
            any.visitor.visit_seq(Strict::new(list, any.numbers))
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<V::Value, A::Error> {
            let any = self.any();
            any.visitor.visit_map(Strict::new(map, any.numbers))
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
        match self.0.numbers.take(text) {
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

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Strict<'_, A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, A::Error> {
        self.inner.next_key_seed(seed)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, A::Error> {
        self.inner.next_value_seed(Strict::new(seed, self.numbers))
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Strict<'_, A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, A::Error> {
        self.inner.next_element_seed(Strict::new(seed, self.numbers))
    }

    fn size_hint(&self) -> Option<usize> {
        self.inner.size_hint()
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Strict<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<S::Value, D::Error> {
        self.inner.deserialize(Strict::new(deserializer, self.numbers))
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
