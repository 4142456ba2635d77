//! Tracing: panel after panel, until the curve returns or runs out.
use super::panel::{Panel, Refusal, twice_kinetic};
use super::{Curve, CurveError, Ends};
use crate::chebyshev::Transform;
use crate::closure::Closure;
use std::f64::consts::TAU;

/// Widths of panels in the weighted norm: the first tried, the largest, and the one below which tracing gives up.
const FIRST: f64 = 0.25;
const LARGEST: f64 = 1.5;
const SMALLEST: f64 = 1e-6;
/// Panels after which tracing gives up.
const PANELS: usize = 20_000;
/// Prismatic joints are followed this many sizes of the linkage far.
const REACH: f64 = 100.0;

impl Curve {
    /// Trace the whole curve through the closed position `q`, where sigma is 0.
    ///
    /// # Errors
    /// [`CurveError`].
    pub fn trace(closure: Closure, q: &[f64]) -> Result<Self, CurveError> {
        let tangent = closure.tangent(q);
        let transform = Transform::new();
        let (mut panels, closed) = follow(&closure, &transform, q, &tangent)?;
        let ends = match closed {
            Some(growth) => Ends::Closed(growth),
            None => {
                let back: Vec<f64> = tangent.iter().map(|t| -t).collect();
                let (other, _) = follow(&closure, &transform, q, &back)?;
                panels = other.iter().rev().map(|p| p.mirrored(-p.end())).chain(panels).collect();
                Ends::Open
            }
        };
        let mut curve = Self { closure, transform, panels, ends, crossings: Vec::new() };
        curve.crossings = curve.find_crossings();
        curve.check_redundant()?;
        Ok(curve)
    }

    /// Positions where the loop equations lose rank: there other branches cross.
    fn find_crossings(&self) -> Vec<f64> {
        let mut found = Vec::new();
        for panel in &self.panels {
            // The smallest singular value falls linearly to 0 on both sides of a crossing.
            let least = |x: f64| self.least_singular(panel, x);
            const SAMPLES: usize = 24;
            let x_of = |i: usize| -1.0 + 2.0 * i as f64 / SAMPLES as f64;
            let samples: Vec<f64> = (0..=SAMPLES).map(|i| least(x_of(i))).collect();
            let most = samples.iter().fold(0.0, |a: f64, s| a.max(*s));
            for i in 0..=SAMPLES {
                // At a border the minimum may be in the neighbour, which then finds it.
                let (below, above) = (i.saturating_sub(1), (i + 1).min(SAMPLES));
                if samples[i] <= samples[below] && samples[i] <= samples[above] && samples[i] < 0.3 * most {
                    let x = minimise(&least, x_of(below), x_of(above));
                    let sigma = panel.sigma_at(x);
                    if least(x) < 1e-6 * most && found.last().is_none_or(|last| sigma - last > 1e-6 * self.scale()) {
                        found.push(sigma);
                    }
                }
            }
        }
        found
    }

    fn least_singular(&self, panel: &Panel, x: f64) -> f64 {
        let q = panel.series_at(x);
        let p = self.closure.linkage.positions(&q);
        let mut m = self.closure.matrix(&p, &q, &panel.normal);
        let n = q.len();
        for r in 0..n {
            for c in 0..n {
                m[(r, c)] /= self.closure.weights[c] * if r + 1 < n { self.closure.linkage.size } else { 1.0 };
            }
        }
        m.singular_values().min()
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

/// Golden-section search.
fn minimise(f: &impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let (mut c, mut d) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    while b - a > 1e-9 {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - GOLDEN * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + GOLDEN * (b - a);
            fd = f(d);
        }
    }
    0.5 * (a + b)
}

/// Coordinates by name, in words.
pub(super) fn describe(closure: &Closure, q: &[f64]) -> String {
    let names = &closure.linkage.coordinates;
    let unit = |i: usize| if i < closure.linkage.turns { "rad" } else { "m" };
    // A long chain is told by its first few coordinates.
    let parts: Vec<String> = (0..q.len().min(6)).map(|i| format!("{} = {:.6} {}", names[i], q[i], unit(i))).collect();
    parts.join(", ")
}

/// Follow the curve from `q` along `tangent`; the growth of the coordinates if it returns.
fn follow(
    closure: &Closure,
    transform: &Transform,
    q: &[f64],
    tangent: &[f64],
) -> Result<(Vec<Panel>, Option<Vec<f64>>), CurveError> {
    let linkage = &*closure.linkage;
    let mut panels: Vec<Panel> = Vec::new();
    let (mut base, mut direction) = (q.to_vec(), tangent.to_vec());
    let (mut sigma, mut width) = (0.0, FIRST);
    loop {
        let panel = next_panel(closure, transform, sigma, &base, &direction, &mut width)?;
        if let Some((growth, last)) = returned(closure, transform, q, tangent, &panel, panels.is_empty()) {
            panels.extend(last);
            return Ok((panels, Some(growth)));
        }
        let mut ahead = closure.tangent(&panel.tip);
        let along: f64 = ahead.iter().zip(&panel.normal).map(|(t, n)| t * n).sum();
        if along < 0.0 {
            ahead.iter_mut().for_each(|t| *t = -*t);
        }
        sigma = panel.end();
        base.clone_from(&panel.tip);
        direction = ahead;
        let far = base[linkage.turns..].iter().any(|s| s.abs() > REACH * linkage.size);
        panels.push(panel);
        if far {
            return Ok((panels, None));
        }
        if panels.len() >= PANELS {
            return Err(CurveError::TooLong { panels: PANELS });
        }
        width = (1.4 * width).min(LARGEST);
    }
}

/// The widest panel that resolves, from the proposed width downwards.
fn next_panel(
    closure: &Closure,
    transform: &Transform,
    sigma: f64,
    base: &[f64],
    tangent: &[f64],
    width: &mut f64,
) -> Result<Panel, CurveError> {
    let mut massless = false;
    while *width > SMALLEST {
        match Panel::build(closure, transform, sigma, base, tangent, *width) {
            Ok(panel) => return Ok(panel),
            Err(refusal) => {
                massless = refusal == Refusal::Massless;
                *width *= if refusal == Refusal::NearCrossing { 0.93 } else { 0.7 };
            }
        }
    }
    let position = describe(closure, base);
    // Next to a position where nothing with mass moves, panels end before they meet it.
    massless |= twice_kinetic_part(closure, base, tangent) < 1e-6;
    Err(if massless { CurveError::Massless { position } } else { CurveError::Stuck { position } })
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
) -> Option<(Vec<f64>, Option<Panel>)> {
    let (n, w) = (start.len(), &closure.weights);
    let turns = closure.linkage.turns;
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
    let cut = Panel::build(closure, transform, panel.start, &panel.base, &direction, u).ok()?;
    Some((growth, Some(cut)))
}
