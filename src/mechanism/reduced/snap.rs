//! Snapping: lengths that almost let branches of motion cross are taken as letting them cross.
//!
//! In: a resolved definition. Out: the curve of its linkage, with the points of joints moved by so little that it
//! misses no crossing by less than `snap`; the misses that are larger. It must not know tables.
use super::error::ReductionError;
use super::resolved::{self, Resolved};
use crate::mechanism::closure::{Closure, guessed, straight};
use crate::mechanism::curve::{
    Candidate, Curve, CurveError, NEAR_CROSSING, Near, NearMiss, Place, REPORTED, Singular, is_same,
};
use crate::mechanism::definition::Mechanism;
use crate::mechanism::linkage::Linkage;
use crate::numerics::table::Unresolved;
use std::sync::Arc;

/// Part of the length of a loop by which it may be shorter than stretched flat where tracing gives up on it.
const FLAT: f64 = 1e-5;
/// Most times that the curve is traced again: each time it comes to a place that it has not met before.
const ROUNDS: usize = 12;

/// Assemble the linkage and trace its curve, the `whole` one if the guess is beyond a stop.
///
/// # Errors
/// [`ReductionError::Assembly`], [`ReductionError::Curve`].
pub(super) fn trace(resolved: &Resolved, mechanism: &Mechanism, whole: bool) -> Result<Curve, ReductionError> {
    snapped(resolved, mechanism, whole).map_err(|error| match error {
        // No branches cross where a loop is stretched flat.
        ReductionError::Curve(CurveError::NearCrossing { .. } | CurveError::Stuck { .. }) => {
            straight(&resolved.linkage, FLAT).map_or(error, ReductionError::Assembly)
        }
        _ => error,
    })
}

/// [`trace`] with errors of tracing as they are.
fn snapped(resolved: &Resolved, mechanism: &Mechanism, whole: bool) -> Result<Curve, ReductionError> {
    let guess = guessed(&resolved.linkage, &mechanism.guess).map_err(ReductionError::Assembly)?;
    let drawn = Arc::new(resolved.linkage.clone());
    let assemble = |linkage: &Arc<Linkage>| Closure::assemble(Arc::clone(linkage), &guess);
    let trace = |linkage: &Arc<Linkage>| {
        let (closure, q) = assemble(linkage).map_err(ReductionError::Assembly)?;
        Ok(resolved::trace(closure, &q, &resolved.loading, whole))
    };
    let mut linkage = Arc::clone(&drawn);
    let mut traced = trace(&linkage)?;
    let (mut places, mut near, mut as_drawn) = (Vec::new(), Near::default(), None);
    for _ in 0..ROUNDS {
        let candidates = candidates(&traced);
        if candidates.is_empty() {
            return finished(traced, near);
        }
        let closure = match &traced {
            Ok(curve) => curve.closure.clone(),
            Err(_) => assemble(&linkage).map_err(ReductionError::Assembly)?.0,
        };
        let found = search(&closure, &drawn, candidates, &places);
        let is_small = |found: &(Option<f64>, Place)| found.1.miss <= mechanism.snap();
        let (small, mut large): (Vec<_>, Vec<_>) = found.into_iter().partition(is_small);
        // Where the branches cross but for rounding, the motion goes straight on.
        let crosses = |sigma: &Option<f64>| {
            let crossings = traced.as_ref().map_or(&[][..], |curve| &curve.crossings);
            sigma.is_some_and(|sigma| crossings.contains(&sigma))
        };
        large.retain(|(sigma, place)| place.miss <= REPORTED && !crosses(sigma));
        let misses = |found: &[(Option<f64>, Place)]| {
            let miss = |(sigma, place): &(Option<f64>, Place)| {
                let position = closure.describe(&place.q);
                Some(NearMiss { sigma: (*sigma)?, position, miss: place.miss })
            };
            found.iter().filter_map(miss).collect::<Vec<_>>()
        };
        near.misses = misses(&large);
        if let (Err(CurveError::NearCrossing { miss, .. }), Some((None, place))) = (&mut traced, large.first()) {
            *miss = Some(place.miss);
        }
        if small.is_empty() {
            return match as_drawn {
                // The moves have made it worse.
                Some(as_drawn) if traced.is_err() => as_drawn,
                _ => finished(traced, near),
            };
        }
        if as_drawn.is_none() {
            let all = [near.misses.clone(), misses(&small)].concat();
            as_drawn = Some(finished(traced, Near { misses: all, ..Near::default() }));
        }
        for (_, place) in small {
            near.snapped.push((closure.describe(&place.q), place.miss));
            places.push(place);
        }
        let Some((moved, moves)) = Singular::new(&closure, &drawn).snapped(&places) else { break };
        linkage = Arc::new(moved);
        (near.drawn, near.moves) = (Some(Arc::clone(&drawn)), moves);
        match trace(&linkage) {
            Ok(again) => traced = again,
            Err(_) => break,
        }
    }
    as_drawn.unwrap_or_else(|| trace(&drawn)?.map_err(ReductionError::Curve))
}

/// The curve with its near misses.
fn finished(traced: Result<Curve, CurveError>, near: Near) -> Result<Curve, ReductionError> {
    traced.map(|curve| curve.with_near(near)).map_err(ReductionError::Curve)
}

/// Where to look for near misses: at crossings and sharp turns of a curve, or where its tracing gave up.
fn candidates(traced: &Result<Curve, CurveError>) -> Vec<Candidate> {
    match traced {
        Ok(curve) => curve.candidates(),
        Err(CurveError::NearCrossing { at, .. } | CurveError::Stuck { at, .. }) => vec![Candidate::stuck(at)],
        Err(_) => Vec::new(),
    }
}

/// New near misses at these candidates, each once.
fn search(
    closure: &Closure,
    drawn: &Linkage,
    candidates: Vec<Candidate>,
    known: &[Place],
) -> Vec<(Option<f64>, Place)> {
    let mut found: Vec<(Option<f64>, Place)> = Vec::new();
    for candidate in candidates.iter().filter(|candidate| !candidate.is_among(known, closure)) {
        let Some(place) = candidate.place(closure, drawn) else { continue };
        let is_new = |other: &Place| !is_same(other, &place.q, closure);
        if known.iter().all(is_new) && found.iter().all(|(_, other)| is_new(other)) {
            found.push((candidate.sigma, place));
        }
    }
    found
}

/// Error for a function that is not smooth along the curve: branches almost cross, or nothing with mass moves.
pub(super) fn not_smooth(curve: &Curve, what: String, at: &Unresolved) -> ReductionError {
    let position = curve.describe(at.sigma, 0.0);
    let crosses = curve.crossings.iter().any(|sigma| (sigma - at.sigma).abs() < curve.scale());
    if !crosses && curve.amplification(at.sigma) > NEAR_CROSSING {
        let (misses, near) =
            (curve.near.misses.iter(), |miss: &NearMiss| (miss.sigma - at.sigma).abs() < curve.scale());
        let miss = misses.filter(|miss| near(miss)).map(|miss| miss.miss).reduce(f64::min);
        // No branches cross where a loop is stretched flat.
        if let Some(flat) = straight(curve.drawn(), FLAT) {
            return ReductionError::Assembly(flat);
        }
        ReductionError::Curve(CurveError::NearCrossing { position, at: curve.configuration(at.sigma).q, miss })
    } else {
        ReductionError::Table { what, position }
    }
}
