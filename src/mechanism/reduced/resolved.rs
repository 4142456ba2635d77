//! A definition resolved for reduction.
//!
//! In: a definition. Out: its linkage, loads and markers, and the curve of the linkage. It must not know tables.
use super::error::ReductionError;
use crate::mechanism::closure::Closure;
use crate::mechanism::curve::{Curve, CurveError};
use crate::mechanism::definition::Mechanism;
use crate::mechanism::linkage::{Linkage, Point, Positions};
use crate::mechanism::loads::laws::stop::Stop;
use crate::mechanism::loads::resolved::{Loading, markers};
use crate::mechanism::loads::unit_load::Load;
use std::sync::Arc;

/// Distance beyond a stop up to which the curve is traced, relative to the natural size of the stop's quantity.
const BEYOND: f64 = 0.02;

/// A definition with indices instead of names.
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
}

/// Properties of the stops on which the curve depends.
pub(super) fn limits(loading: &Loading) -> impl Iterator<Item = (bool, bool, f64, &Load)> {
    // No parameter changes a stop's limit.
    loading.defined_stops().map(|s| (s.enabled, s.rigid, s.value, &loading.loads[s.load]))
}

/// The curve: between the stops if all are rigid, else as a whole. Beyond a rigid stop only trial steps before an
/// impact evaluate the curve. A guess beyond a stop still identifies a branch: unless the `whole` curve is asked for,
/// the curve begins where this branch gets to the travel, if that is near. The start need not be on such a curve, which
/// is [`Curve::by_start`].
pub(super) fn trace(closure: Closure, q: &[f64], loading: &Loading, whole: bool) -> Result<Curve, CurveError> {
    let linkage = Arc::clone(&closure.linkage);
    let Some(margin) = margin(&linkage, loading) else { return Curve::trace(closure, q, None) };
    if margin(&linkage.positions(q)) > 0.0 {
        return Curve::trace(closure, q, Some(&mut |p| margin(p)));
    }
    let entry = if whole { None } else { Curve::entry(&closure, q, &mut |p| BEYOND - margin(p)) };
    let entered = entry.and_then(|q| Closure::assemble(Arc::clone(&linkage), &q).ok());
    let between = entered.and_then(|(closure, q)| Curve::trace(closure, &q, Some(&mut |p| margin(p))).ok());
    match between {
        Some(curve) => Ok(curve.decided_by_start()),
        None => Curve::trace(closure, q, None),
    }
}

/// The stretch of a curve beyond an open end: with the limits of travel that the curve has.
pub(super) fn trace_stretch(curve: &Curve, side: usize, loading: &Loading) -> Result<Curve, CurveError> {
    let linkage = Arc::clone(&curve.closure.linkage);
    match margin(&linkage, loading) {
        Some(margin) if margin(&linkage.positions(&curve.guess)) > 0.0 => curve.stretch(side, Some(&mut |p| margin(p))),
        _ => curve.stretch(side, None),
    }
}

/// How far positions are within all stops, if there are enabled ones and all are rigid.
fn margin<'a>(linkage: &'a Linkage, loading: &'a Loading) -> Option<impl Fn(&Positions) -> f64 + use<'a>> {
    let stops: Vec<_> = loading.defined_stops().filter(|s| s.enabled).collect();
    let is_limited = !stops.is_empty() && stops.iter().all(|s| s.rigid);
    is_limited.then_some(move |p: &Positions| {
        let of = |stop: &&Stop| {
            let size = if stop.quantity == "angle" { 1.0 } else { linkage.size };
            BEYOND - stop.beyond(loading.loads[stop.load].displacement_at(linkage, p)) / size
        };
        stops.iter().map(of).fold(f64::INFINITY, f64::min)
    })
}
