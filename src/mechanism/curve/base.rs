//! Where a panel or a bridge of the curve starts.

/// Start of a panel.
#[derive(Clone, Debug)]
pub(super) struct Base {
    /// sigma.
    pub sigma: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Unit tangent.
    pub tangent: Vec<f64>,
}
