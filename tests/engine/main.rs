//! The engine without an FMI: one binary, one module a file. While working: `cargo test --test engine stops`.
#![allow(clippy::unwrap_used)]

mod bad_input;
mod benchmarks;
mod bounds;
mod cavitation;
mod characteristics;
mod creep;
mod derivatives;
mod designs;
mod drag;
mod drawn;
mod drives;
mod ends_meet;
mod exact;
mod frames;
mod friction;
mod friction_balance;
mod friction_crossings;
mod gear_retraction;
mod held_signs;
mod histories;
mod hydraulic_drive;
mod hydraulic_pair;
mod impacts;
mod input_derivatives;
mod interface;
mod look_ahead;
mod mechanism_fuzz;
mod near_misses;
mod newton_euler;
mod one_element;
mod pay_per_use;
mod random_linkages;
mod redundant;
mod rigid_fem;
mod several_stops;
mod singular;
mod singular_together;
mod solver_method;
mod start_at_guess;
mod stops;
#[path = "../support/mod.rs"]
mod support;
mod tables;
mod travel;
mod undefined;
