//! The table of scenes.
mod forces;
mod long;
mod sizes;
mod starts;
mod together;

use super::Row;

/// All rows, group by group.
pub fn all() -> Vec<Row> {
    let groups = [
        sizes::tolerances(),
        sizes::communication(),
        sizes::units(),
        sizes::mass_ratios(),
        starts::toggles(),
        starts::stops(),
        starts::crossings(),
        forces::changing(),
        forces::huge(),
        forces::slow_border(),
        forces::self_locking(),
        together::scenes(),
        long::slow(),
        long::toggles(),
        long::short_steps(),
    ];
    groups.into_iter().flatten().map(Row::from).collect()
}

/// A number of steps as text.
pub fn count(steps: u64) -> String {
    if steps == 1 { "1 step".into() } else { format!("{steps} steps") }
}
