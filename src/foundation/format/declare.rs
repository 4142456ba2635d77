//! Macros that declare the keys and words of a definition.
//!
//! In: a struct with a row for each key, an enum with a word for each choice. Out: the types with their tables. Must
//! not know: what a key means.

/// Declares structs of a definition. Each key has its description, type, default and row.
///
/// `field as "name": Type = default => row;` where the name in the file, the default and the row are optional. `pub
/// struct Name: Copy` makes the struct `Copy`. `pub struct Name or (Short)` states which short form may replace the
/// object.
#[macro_export]
macro_rules! keys {
    ($($(#[doc = $about:literal])* pub struct $name:ident $(: $copy:ident)? $(or ($short:expr))? {
        $($(#[doc = $doc:literal])* $field:ident $(as $key:literal)?: $type:ty $(= $value:expr)? $(=> $row:expr)?;)*
    })*) => {$(
        $(#[doc = $about])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name {
            $($(#[doc = $doc])* pub $field: $type,)*
        }

        $(impl $copy for $name {})?

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $crate::format::keys!(@value $($value)?),)* }
            }
        }

        impl $crate::format::Described for $name {
            const TABLE: &'static $crate::format::Table = {
                static TABLE: $crate::format::Table = $crate::format::Table {
                    keys: &[$($crate::format::Key {
                        name: $crate::format::keys!(@name $field $($key)?),
                        kind: <$type as $crate::format::Field>::KIND,
                        ..$crate::format::keys!(@row $($row)?)
                    }),*],
                    short: $crate::format::keys!(@short $($short)?),
                };
                &TABLE
            };
            const ABOUT: &'static str = concat!($($about),*);
            const DOCS: &'static [&'static str] = &[$(concat!($($doc),*)),*];
        }

        impl $crate::format::Keyed for $name {
            fn table(&self) -> &'static $crate::format::Table {
                <Self as $crate::format::Described>::TABLE
            }

            fn slot(&mut self, index: usize) -> $crate::format::Slot<'_> {
                #[allow(non_camel_case_types)]
                enum At { $($field),* }
                $(if index == At::$field as usize {
                    return $crate::format::Field::slot(&mut self.$field);
                })*
                unreachable!("a key has the index of its row")
            }
        }

        impl $crate::format::Field for $name {
            const KIND: $crate::format::Kind =
                $crate::format::Kind::Object(<Self as $crate::format::Described>::TABLE);

            fn slot(&mut self) -> $crate::format::Slot<'_> {
                $crate::format::Slot::Object(self)
            }
        }
    )*};
    (@value) => { Default::default() };
    (@value $value:expr) => { $value };
    (@name $field:ident) => { stringify!($field) };
    (@name $field:ident $key:literal) => { $key };
    (@row) => { $crate::format::Key::PLAIN };
    (@row $row:expr) => { $row };
    (@short) => { $crate::format::Short::None };
    (@short $short:expr) => { $short };
}

/// Declares an enum of a definition. Each variant has a word, and the first variant is the default.
#[macro_export]
macro_rules! words {
    ($($(#[doc = $about:literal])* pub enum $name:ident {
        $(#[doc = $first_doc:literal])* $first:ident = $first_word:literal
        $(, $(#[doc = $doc:literal])* $variant:ident = $word:literal)* $(,)?
    })*) => {$(
        $(#[doc = $about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum $name {
            $(#[doc = $first_doc])*
            #[default]
            $first,
            $($(#[doc = $doc])* $variant,)*
        }

        impl $name {
            /// All choices.
            pub const ALL: [Self; Self::WORDS.len()] = [Self::$first $(, Self::$variant)*];
            /// Words of all choices, in the same order.
            pub const WORDS: [&'static str; [$first_word $(, $word)*].len()] = [$first_word $(, $word)*];

            /// Word of the choice in the file.
            pub fn word(self) -> &'static str {
                Self::WORDS[self as usize]
            }

            /// The choice with this word.
            pub fn of_word(word: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|choice| choice.word() == word)
            }
        }

        impl $crate::format::Word for $name {
            fn index(&self) -> usize {
                *self as usize
            }

            fn choose(&mut self, index: usize) {
                *self = Self::ALL[index];
            }
        }

        impl $crate::format::Field for $name {
            const KIND: $crate::format::Kind = $crate::format::Kind::Word(&Self::WORDS);

            fn slot(&mut self) -> $crate::format::Slot<'_> {
                $crate::format::Slot::Word(self)
            }
        }
    )*};
}

pub use {keys, words};
