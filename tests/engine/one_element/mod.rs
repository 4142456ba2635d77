//! The one-element model against Cink and Kosucki (2016), [CK16]: closed forms with their errata, efficiency, damping.

mod by_body;
mod consistency;
mod damping;
mod efficiency;
mod four_bar;
mod jib;
pub mod slider;
mod slider_crank;
mod worst;
