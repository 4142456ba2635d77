//! Drawing of a definition without a motion, as far as possible.

use linkage_fmu::mechanism::inspection::{Gap, Pose, Scene, attempt};
use serde::Serialize;

/// Poses without a motion.
#[derive(Clone, Debug, Serialize)]
pub struct Still {
    poses: Vec<Pose>,
    is_assembled: bool,
    gaps: Vec<Gap>,
}

impl Still {
    /// Scene and poses of a definition. None if its bodies cannot be placed.
    pub fn new(text: &str) -> Option<(Scene, Self)> {
        let attempt = attempt(text)?;
        let (poses, is_assembled, gaps) = (attempt.poses, attempt.is_assembled, attempt.gaps);
        Some((attempt.scene, Self { poses, is_assembled, gaps }))
    }

    /// Whether the loops close.
    pub fn is_assembled(&self) -> bool {
        self.is_assembled
    }
}
