//! Tracing: panel after panel, until the curve returns, leaves the permitted travel, or runs out.
use super::panel::{Base, Panel, Refusal, Room, twice_kinetic};
use super::travel::Travel;
use super::{Curve, CurveError, Ends};
use crate::mechanism::closure::Closure;
use crate::mechanism::linkage::Positions;
use crate::numerics::chebyshev::Transform;
use std::f64::consts::TAU;

/// Widths of panels in the weighted norm: the first tried, the largest, and the one below which tracing gives up.
const FIRST: f64 = 0.25;
const LARGEST: f64 = 1.5;
const SMALLEST: f64 = 1e-6;
/// Panels after which tracing gives up.
const PANELS: usize = 20_000;
/// Prismatic joints are followed this many sizes of the linkage far.
const REACH: f64 = 100.0;

/// Where rounding in a gap is amplified more than this, branches almost cross.
pub const NEAR_CROSSING: f64 = 300.0;

/// Why the curve was followed no farther.
enum Stop {
    /// It returned; the coordinates have grown by these amounts.
    Returned(Vec<f64>),
    /// The permitted travel ends at this sigma.
    Left(f64),
    /// Prismatic joints have gone far enough.
    Far,
}

impl Curve {
    /// Trace the whole curve through the closed position `q`, where sigma is 0.
    ///
    /// # Errors
    /// [`CurveError`].
    pub fn trace(closure: Closure, q: &[f64]) -> Result<Self, CurveError> {
        Self::follow_both(closure, q, None)
    }

    /// Trace the curve through the closed position `q`, where sigma is 0, as far as travel is permitted: in each direction
    /// up to the first point where `inside` turns from positive to negative. It is a continuous function of the
    /// positions, not negative at `q` but for rounding. The range of sigma ends exactly there; the panel it is in is
    /// traced to its end. If travel is limited nowhere, this is [`Self::trace`].
    ///
    /// # Errors
    /// [`CurveError`].
    pub fn trace_within(
        closure: Closure,
        q: &[f64],
        inside: &mut dyn FnMut(&Positions) -> f64,
    ) -> Result<Self, CurveError> {
        Self::follow_both(closure, q, Some(inside))
    }

    fn follow_both(
        closure: Closure,
        q: &[f64],
        inside: Option<&mut dyn FnMut(&Positions) -> f64>,
    ) -> Result<Self, CurveError> {
        let tangent = closure.tangent(q);
        let mut travel = inside.map(|inside| Travel::new(&closure.linkage, inside));
        let transform = Transform::new();
        let mut room = Room::default();
        let (mut panels, stop) = follow(&closure, &transform, q, &tangent, travel.as_mut(), &mut room)?;
        let end = |panels: &[Panel]| panels.last().map_or(0.0, Panel::end);
        let (mut first, mut last) = (0.0, end(&panels));
        let ends = match stop {
            Stop::Returned(growth) => Ends::Closed(growth),
            Stop::Left(_) | Stop::Far => {
                let high = matches!(stop, Stop::Left(_));
                if let Stop::Left(sigma) = stop {
                    last = sigma;
                }
                let back: Vec<f64> = tangent.iter().map(|t| -t).collect();
                let (other, stop) = follow(&closure, &transform, q, &back, travel.as_mut(), &mut room)?;
                let low = !matches!(stop, Stop::Far);
                first = match stop {
                    Stop::Left(sigma) => -sigma,
                    Stop::Far => -end(&other),
                    // The limit met forward just touches the curve and was not seen from behind.
                    Stop::Returned(_) => last - end(&other),
                };
                let mirrored = |p: Panel| {
                    let start = -p.end();
                    p.mirrored(start)
                };
                panels = other.into_iter().rev().map(mirrored).chain(panels).collect();
                if low || high { Ends::Stopped { low, high } } else { Ends::Open }
            }
        };
        if last <= first {
            return Err(CurveError::Outside { position: describe(&closure, q) });
        }
        let (range, crossings, closed) = ((first, last), Vec::new(), room.closed);
        let mut curve = Self { closure, transform, panels, range, ends, crossings, closed };
        curve.crossings = curve.find_crossings();
        curve.check_redundant()?;
        Ok(curve)
    }

    /// The loop equations that follow from others must hold everywhere.
    fn check_redundant(&self) -> Result<(), CurveError> {
        if !self.closure.redundant() {
            return Ok(());
        }
        let linkage = &*self.closure.linkage;
        let joints = linkage.row_joints();
        for panel in &self.panels {
            for x in self.transform.nodes {
                let q = panel.series_at(x);
                for (row, gap) in linkage.gaps(&linkage.positions(&q)).iter().enumerate() {
                    if gap.abs() > 1e-9 * linkage.size {
                        let joint = linkage.joints[joints[row]].name.clone();
                        let position = describe(&self.closure, &q);
                        return Err(CurveError::Inconsistent { joint, gap: gap.abs(), position });
                    }
                }
            }
        }
        Ok(())
    }
}

/// Coordinates by name, in words.
pub(super) fn describe(closure: &Closure, q: &[f64]) -> String {
    let names = &closure.linkage.coordinates;
    let unit = |i: usize| if i < closure.linkage.angles { "rad" } else { "m" };
    // A long chain is told by its first few coordinates.
    let parts: Vec<String> = (0..q.len().min(6)).map(|i| format!("{} = {:.6} {}", names[i], q[i], unit(i))).collect();
    parts.join(", ")
}

/// Follow the curve from `q` along `tangent`.
fn follow(
    closure: &Closure,
    transform: &Transform,
    q: &[f64],
    tangent: &[f64],
    mut travel: Option<&mut Travel>,
    room: &mut Room,
) -> Result<(Vec<Panel>, Stop), CurveError> {
    /// The next panel is tried narrower than it is expected to resolve by this factor, and wider than the last by at most
    /// the other.
    const CAUTION: f64 = 0.84;
    const GROWTH: f64 = 2.0;
    let linkage = &*closure.linkage;
    let mut panels: Vec<Panel> = Vec::new();
    let mut base = Base { sigma: 0.0, q: q.to_vec(), tangent: tangent.to_vec() };
    let (mut width, mut widest_before) = (FIRST, None);
    if let Some(travel) = &mut travel {
        travel.start(q);
    }
    loop {
        let (panel, ahead, wider) = next_panel(closure, transform, &base, &mut width, room, travel.as_deref_mut())?;
        let returns = returned(closure, transform, q, tangent, &panel, panels.is_empty(), room);
        let left = travel.as_mut().and_then(|t| t.left(&panel, &transform.nodes));
        if let Some((growth, cut)) = returns {
            // The travel may end on the way back to the start.
            let end = cut.as_ref().map_or(panel.start, Panel::end);
            if left.is_none_or(|sigma| sigma >= end) {
                panels.extend(cut);
                return Ok((panels, Stop::Returned(growth)));
            }
        }
        base = Base { sigma: panel.end(), q: panel.tip.clone(), tangent: ahead };
        let far = base.q[linkage.angles..].iter().any(|s| s.abs() > REACH * linkage.size);
        // How wide it might have been, and how that changes from panel to panel.
        let widest = panel.width * wider.min(GROWTH);
        let trend = widest_before.map_or(1.0, |before: f64| (widest / before).clamp(0.5, GROWTH));
        width = (CAUTION * widest * trend).min(GROWTH * panel.width).min(LARGEST);
        widest_before = Some(widest);
        panels.push(panel);
        if let Some(sigma) = left {
            return Ok((panels, Stop::Left(sigma)));
        }
        if far {
            return Ok((panels, Stop::Far));
        }
        if panels.len() >= PANELS {
            return Err(CurveError::TooLong { panels: PANELS });
        }
    }
}

/// The widest panel that resolves, from the proposed width downwards; the tangent at its tip, and by what factor it might
/// have been wider.
fn next_panel(
    closure: &Closure,
    transform: &Transform,
    base: &Base,
    width: &mut f64,
    room: &mut Room,
    mut travel: Option<&mut Travel>,
) -> Result<(Panel, Vec<f64>, f64), CurveError> {
    let mut massless = false;
    while *width > SMALLEST {
        match Panel::build(closure, transform, base, *width, room, travel.as_deref_mut()) {
            Ok(built) => return Ok(built),
            Err(refusal) => {
                massless = refusal == Refusal::Massless;
                *width *= match refusal {
                    Refusal::TooWide(shorter) => shorter,
                    Refusal::NearCrossing => 0.93,
                    Refusal::Massless => 0.7,
                };
            }
        }
    }
    let position = describe(closure, &base.q);
    // Next to a position where nothing with mass moves, panels end before they meet it.
    massless |= twice_kinetic_part(closure, &base.q, &base.tangent) < 1e-6;
    Err(if massless {
        CurveError::Massless { position }
    } else if closure.linearise(&base.q, &mut room.work.loops)
        && closure.amplification(&closure.normal(&base.tangent), &mut room.work.loops) > NEAR_CROSSING
    {
        CurveError::NearCrossing { position }
    } else {
        CurveError::Stuck { position }
    })
}

/// Twice the kinetic energy of a motion along the tangent, as a part of what the masses would have at unit rates.
fn twice_kinetic_part(closure: &Closure, q: &[f64], tangent: &[f64]) -> f64 {
    let linkage = &*closure.linkage;
    let p = linkage.positions(q);
    let whole: f64 = linkage.bodies.iter().map(|b| b.mass * linkage.size.powi(2) + b.inertia).sum();
    if whole > 0.0 { twice_kinetic(linkage, &p, &linkage.rates(&p, q, tangent)) / whole } else { 0.0 }
}

/// If the panel passes through the start again: the growth of the coordinates, and the panel cut there.
fn returned(
    closure: &Closure,
    transform: &Transform,
    start: &[f64],
    tangent: &[f64],
    panel: &Panel,
    first: bool,
    room: &mut Room,
) -> Option<(Vec<f64>, Option<Panel>)> {
    let (n, w) = (start.len(), &closure.weights);
    let turns = closure.linkage.angles;
    // The start as seen from here: whole turns added.
    let target: Vec<f64> = (0..n)
        .map(|i| {
            let middle = 0.5 * (panel.base[i] + panel.tip[i]);
            if i < turns { start[i] + TAU * ((middle - start[i]) / TAU).round() } else { start[i] }
        })
        .collect();
    let u: f64 = (0..n).map(|i| panel.normal[i] * (target[i] - panel.base[i])).sum();
    let slack = 1e-9;
    if first && u < slack || u < -slack || u > panel.width + slack {
        return None;
    }
    let q = panel.series_at(2.0 * u.clamp(0.0, panel.width) / panel.width - 1.0);
    let off = (0..n).fold(0.0, |a: f64, i| a.max(((q[i] - target[i]) * w[i]).abs()));
    let along: f64 = (0..n).map(|i| panel.normal[i] * tangent[i]).sum();
    if off > 1e-7 || along <= 0.0 {
        return None;
    }
    let growth = (0..n).map(|i| target[i] - start[i]).collect();
    if u < slack {
        return Some((growth, None));
    }
    let direction: Vec<f64> = (0..n).map(|i| panel.normal[i] / (w[i] * w[i])).collect();
    let base = Base { sigma: panel.start, q: panel.base.clone(), tangent: direction };
    let (cut, ..) = Panel::build(closure, transform, &base, u, room, None).ok()?;
    Some((growth, Some(cut)))
}
