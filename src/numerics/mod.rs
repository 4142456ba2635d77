//! Numerics: numbers, series and tables of functions. It must not know what they mean.
pub mod bracket;
pub mod chebyshev;
pub mod decimal;
pub mod dual;
pub mod gauss;
pub mod table;
