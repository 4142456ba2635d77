//! Numerics: numbers, vectors, series and tables of functions. It must not know what they mean.
pub mod bits;
pub mod bracket;
pub mod bundle;
pub mod chebyshev;
pub mod decimal;
pub mod dual;
pub mod enclosure;
pub mod gapped;
pub mod gauss;
pub mod kronrod;
pub mod monotone;
pub mod passage;
pub mod plane;
pub mod processor;
pub mod table;
pub mod twofold;
