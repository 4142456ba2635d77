//! A definition resolved for reduction: linkage, loading and markers, and the curve that follows from them.
use super::ReductionError;
use crate::mechanism::closure::{Closure, guessed};
use crate::mechanism::curve::{Curve, CurveError};
use crate::mechanism::definition::Mechanism;
use crate::mechanism::linkage::{Linkage, Point, Positions};
use crate::mechanism::loads::resolved::{Loading, Stop, markers};
use crate::mechanism::loads::unit_load::Load;
use std::sync::Arc;

/// Part of the natural size of a stop's quantity by which the curve is traced beyond the stop.
const BEYOND: f64 = 0.02;

/// What a definition says, by places in place of names.
pub(super) struct Resolved {
    pub(super) linkage: Linkage,
    pub(super) loading: Loading,
    pub(super) markers: Vec<Point>,
}

impl Resolved {
    pub(super) fn new(mechanism: &Mechanism) -> Result<Self, ReductionError> {
        let linkage = Linkage::new(mechanism).map_err(ReductionError::Definition)?;
        let loading = Loading::new(mechanism, &linkage).map_err(ReductionError::Definition)?;
        let markers = markers(mechanism, &linkage).map_err(ReductionError::Definition)?;
        Ok(Self { linkage, loading, markers })
    }

    /// Assemble the linkage and trace its curve.
    pub(super) fn trace(&self, mechanism: &Mechanism) -> Result<Curve, ReductionError> {
        let guess = guessed(&self.linkage, &mechanism.guess).map_err(ReductionError::Assembly)?;
        let linkage = Arc::new(self.linkage.clone());
        let (closure, q) = Closure::assemble(linkage, &guess).map_err(ReductionError::Assembly)?;
        trace(closure, &q, &self.loading).map_err(ReductionError::Curve)
    }

    /// Whether this is traced like another state of the same mechanism: the same linkage between the same stops.
    pub(super) fn moves_as(&self, linkage: &Linkage, loading: &Loading) -> bool {
        self.linkage == *linkage && limits(&self.loading).eq(limits(loading))
    }
}

/// What the curve depends on in the stops.
fn limits(loading: &Loading) -> impl Iterator<Item = (bool, bool, f64, &Load)> {
    // Which end of the travel a stop is, no parameter changes.
    loading.stops.iter().map(|s| (s.enabled, s.rigid, s.value, &loading.loads[s.load]))
}

/// The curve, between rigid stops if there are such: nothing lies beyond them but what a step tries before it finds the
/// impact. A guess that is itself beyond a stop names a branch all the same, which is then traced as a whole.
fn trace(closure: Closure, q: &[f64], loading: &Loading) -> Result<Curve, CurveError> {
    let stops: Vec<_> = loading.stops.iter().filter(|s| s.enabled).collect();
    if stops.is_empty() || stops.iter().any(|s| !s.rigid) {
        return Curve::trace(closure, q);
    }
    let linkage = Arc::clone(&closure.linkage);
    let mut inside = |p: &Positions| {
        let room = |stop: &&Stop| {
            let size = if stop.quantity == "angle" { 1.0 } else { linkage.size };
            BEYOND - stop.beyond(loading.loads[stop.load].place(&linkage, p)) / size
        };
        stops.iter().map(room).fold(f64::INFINITY, f64::min)
    };
    let at_guess = inside(&linkage.positions(q));
    if at_guess <= 0.0 {
        return Curve::trace(closure, q);
    }
    Curve::trace_within(closure, q, &mut inside)
}
