//! The table of scenes.
mod sizes;
mod steps;

use super::Scene;

/// All, group by group.
pub fn all() -> Vec<Scene> {
    [steps::tolerances(), steps::communication(), sizes::units(), sizes::mass_ratios()].into_iter().flatten().collect()
}
