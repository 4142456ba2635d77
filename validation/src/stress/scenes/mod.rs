//! The table of scenes.
mod forces;
mod friction;
mod long;
mod sizes;
mod starts;
mod steps;
mod together;

use super::StateLoads;

/// All, group by group.
pub fn all() -> Vec<StateLoads> {
    let groups = [
        steps::tolerances(),
        steps::communication(),
        sizes::units(),
        sizes::mass_ratios(),
        starts::toggles(),
        starts::stops(),
        starts::crossings(),
        forces::changing(),
        forces::huge(),
        friction::slow_border(),
        friction::self_locking(),
        together::scenes(),
        long::slow(),
        long::toggles(),
        long::short_steps(),
    ];
    groups.into_iter().flatten().collect()
}

/// So many steps, in words.
fn count(steps: u64) -> String {
    if steps == 1 { "1 step".into() } else { format!("{steps} steps") }
}
