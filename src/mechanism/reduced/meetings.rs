//! Positions where the two ends of a drive, a spring or a stop coincide, so that a force between them has no direction.
//!
//! In: a curve, the loads on it. Out: the arcs of the curve between such positions. It must not know tables.
use super::error::ReductionError;
use crate::mechanism::curve::{Configuration, Curve, Ends, Scratch};
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::bracket::bisect;
use crate::numerics::order::sorted;

/// Distance of two ends, in sizes of the linkage, below which they coincide.
pub(super) const MEET: f64 = 1e-3;
/// Number of samples in each panel of the curve: the square of a distance is smooth on it.
const SAMPLES: usize = 24;

/// Number of positions at which the distance of two ends is looked at.
const LOOKED: usize = 8;

/// The loads on a curve, those marked whose two ends never move relative to one another.
pub(super) fn with_idle(curve: &Curve, mut loading: std::sync::Arc<Loading>) -> std::sync::Arc<Loading> {
    let (first, last) = curve.range;
    // Parts of the curve that no symmetry of a motion repeats.
    let at = |k: usize| curve.configuration(first + (last - first) * (0.31 + 0.618_034 * k as f64).fract());
    let at: Vec<Configuration> = (0..LOOKED).map(at).collect();
    let marked = |load: &Load| {
        let mut load = load.clone();
        load.mark_idle(curve.linkage(), &at).then_some(load)
    };
    let idle: Vec<(usize, Load)> =
        loading.loads.iter().enumerate().filter_map(|(index, load)| Some((index, marked(load)?))).collect();
    for (index, load) in idle {
        std::sync::Arc::make_mut(&mut loading).loads[index] = load;
    }
    loading
}

/// A part of the curve with an end where two ends of a load coincide.
#[derive(Debug)]
pub(super) struct Arc {
    /// First and last sigma.
    pub(super) range: (f64, f64),
    /// Why it ends at the low and at the high side; none where the curve itself ends.
    pub(super) ends: [Option<ReductionError>; 2],
}

/// An interval of sigma in which two ends coincide.
struct Meeting {
    range: (f64, f64),
    /// sigma where they are closest.
    closest: f64,
    /// Name of the load.
    name: String,
}

impl Meeting {
    /// Why the motion ends there after so many whole revolutions.
    fn reason(&self, curve: &Curve, revolutions: f64) -> ReductionError {
        ReductionError::EndsMeet { name: self.name.clone(), position: curve.describe(self.closest, revolutions) }
    }
}

/// The arcs of a curve between positions where two ends of a load coincide, that nearest to the guess first. Empty if
/// ends coincide nowhere, or at the guess.
pub(super) fn arcs(curve: &Curve, loading: &Loading) -> Vec<Arc> {
    let loads = loading.loads.iter().enumerate().filter(|(_, load)| matches!(load.along(), Load::Pair { .. }));
    let met = loads.flat_map(|(index, _)| Pair::new(curve, loading, index).meetings()).collect();
    let met = sorted(met, |meeting: &Meeting| meeting.range.0);
    let (first, last) = curve.range;
    let period = matches!(curve.ends, Ends::Closed(_)).then_some(last - first);
    if met.is_empty() || met.iter().any(|meeting| meeting.range.0 <= 0.0 && meeting.range.1 >= 0.0) {
        return Vec::new();
    }
    let (mut from, mut reason) = (first, None);
    if let (Some(period), Some(latest)) = (period, met.last()) {
        // The arc through the guess begins behind the last meeting of the revolution before.
        (from, reason) = (latest.range.1 - period, Some(latest.reason(curve, -1.0)));
    }
    let mut arcs = Vec::new();
    for meeting in met {
        let here = meeting.reason(curve, 0.0);
        if meeting.range.0 > from {
            arcs.push(Arc { range: (from, meeting.range.0), ends: [reason, Some(here.clone())] });
        }
        (from, reason) = (from.max(meeting.range.1), Some(here));
    }
    if period.is_none() && from < last {
        arcs.push(Arc { range: (from, last), ends: [reason, None] });
    }
    sorted(arcs, |arc: &Arc| arc.range.0.max(-arc.range.1).max(0.0))
}

/// Two points along the curve.
struct Pair<'a> {
    curve: &'a Curve,
    loading: &'a Loading,
    load: usize,
    scratch: Scratch,
    c: Configuration,
}

impl<'a> Pair<'a> {
    fn new(curve: &'a Curve, loading: &'a Loading, load: usize) -> Self {
        Self { curve, loading, load, scratch: Scratch::default(), c: Configuration::default() }
    }

    /// How far the points are beyond coinciding, in sizes of the linkage, and half the slope of the distance's square.
    fn at(&mut self, sigma: f64) -> [f64; 2] {
        self.curve.configure(sigma, &mut self.scratch, &mut self.c);
        let linkage = self.curve.linkage();
        let [distance, slope, _] = self.loading.loads[self.load].along().displacement(linkage, &self.c);
        [distance / linkage.size - MEET, if distance > 0.0 { distance * slope } else { 0.0 }]
    }

    /// Samples with all minima among them.
    fn samples(&mut self) -> Vec<f64> {
        let mut samples: Vec<f64> = Vec::new();
        let mut before: Option<[f64; 2]> = None;
        for [start, end] in self.curve.intervals() {
            for k in 0..=SAMPLES {
                let sigma = start + (end - start) * k as f64 / SAMPLES as f64;
                let slope = self.at(sigma)[1];
                if let Some([last, before]) = before
                    && before < 0.0
                    && slope >= 0.0
                {
                    let [low, high] = bisect(|sigma| self.at(sigma)[1] >= 0.0, last, sigma);
                    samples.push(0.5 * (low + high));
                }
                samples.push(sigma);
                before = Some([sigma, slope]);
            }
        }
        samples
    }

    /// Intervals in which the points coincide.
    fn meetings(mut self) -> Vec<Meeting> {
        let samples = self.samples();
        let near: Vec<bool> = samples.iter().map(|&sigma| self.at(sigma)[0] < 0.0).collect();
        let mut all = Vec::new();
        let mut k = 0;
        while k < samples.len() {
            let run = near[k..].iter().take_while(|near| **near).count();
            if run == 0 {
                k += 1;
                continue;
            }
            let border = |pair: &mut Self, far: Option<&f64>, close: f64| {
                far.map_or(close, |&far| bisect(|sigma| pair.at(sigma)[0] >= 0.0, close, far)[1])
            };
            let low = border(&mut self, k.checked_sub(1).map(|k| &samples[k]), samples[k]);
            let high = border(&mut self, samples.get(k + run), samples[k + run - 1]);
            let closest = samples[k..k + run].iter().copied();
            let closest = closest.min_by(|a, b| self.at(*a)[0].total_cmp(&self.at(*b)[0])).unwrap_or(low);
            all.push(Meeting { range: (low, high), closest, name: self.loading.name(self.load) });
            k += run;
        }
        all
    }
}
