//! Poses of the bodies: in the present state, over the whole travel, and at a guess that does not assemble.
//!
//! In: a model, or a definition that gives none. Out: angle and origin of every body of the linkage, as plain data. It
//! must not know what is drawn there.
use super::scene::Scene;
use crate::mechanism::closure::{Closure, guessed};
use crate::mechanism::curve::{Configuration, Ends, Scratch};
use crate::mechanism::definition::Mechanism;
use crate::mechanism::error::ModelError;
use crate::mechanism::linkage::{Freedom, Linkage, Positions};
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::model::Model;
use crate::mechanism::motion::contact::RigidEnd;
use crate::mechanism::motion::samples::ends;
use crate::mechanism::motion::state::State;
use crate::mechanism::reduced::Reduced;
use crate::numerics::bracket::{bisect, false_position};
use crate::numerics::plane::{Vec2, cross};
use serde::Serialize;
use std::sync::Arc;

/// Angle [rad] and origin [m, m] of a body's frame in the mechanism frame.
pub type Pose = [f64; 3];

/// Distance from the start, in sizes of the mechanism, up to which a travel without an end is shown.
const SHOWN: f64 = 2.0;
/// Part of its largest slope, and of the distance of two positions, to which a dead centre is found.
const STANDS: f64 = 1e-8;
/// Revolutions up to which a travel of many is shown whole.
const REVOLUTIONS: f64 = 8.0;

/// The whole travel: the motion without time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sweep {
    /// sigma, ascending in equal steps [kg^(1/2) m].
    pub sigma: Vec<f64>,
    /// Poses of all bodies of the linkage at each sigma.
    pub poses: Vec<Vec<Pose>>,
    /// Number of coordinates that are angles; they come first.
    pub angles: usize,
    /// Name and values of each coordinate [rad, then m]; of a body its own angle.
    pub coordinates: Vec<(String, Vec<f64>)>,
    /// Variable of each drive's displacement, such as `cylinder.length`, whether it is an angle, and its values [m or
    /// rad].
    pub drives: Vec<(String, bool, Vec<f64>)>,
    /// Derivative along sigma of each coordinate, then of each drive's displacement.
    pub slopes: Vec<Vec<f64>>,
    /// Dead centres: sigma, and the name of the coordinate or the drive that stands still there.
    pub dead_centres: Vec<(f64, String)>,
    /// sigma of the start.
    pub start: f64,
    /// Whether the motion returns to its beginning.
    pub is_closed: bool,
    /// Whether the travel goes on beyond its low and its high end.
    pub goes_on: [bool; 2],
    /// Stops that are met.
    pub stops: Vec<SweptStop>,
    /// Name of the stop at the low and the high end, also of a cylinder's end.
    pub ends: [Option<String>; 2],
}

/// A place at which a stop is met.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweptStop {
    /// Index of the stop.
    pub stop: usize,
    /// sigma [kg^(1/2) m].
    pub sigma: f64,
    /// Poses there.
    pub poses: Vec<Pose>,
}

/// A definition that gives no model, as far as it can be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// What there is to be drawn.
    pub scene: Scene,
    /// Poses at the guess, or assembled.
    pub poses: Vec<Pose>,
    /// Whether the loops close, so that these are the assembled poses.
    pub is_assembled: bool,
    /// Joints that are open at the guess.
    pub gaps: Vec<Gap>,
}

/// A joint that is open.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// Name of the joint.
    pub joint: String,
    /// Where the first body has the joint [m]; of a prismatic joint the foot on its axis.
    pub first: [f64; 2],
    /// Where the second body has the joint [m].
    pub second: [f64; 2],
    /// Distance [m].
    pub gap: f64,
}

/// Poses of all bodies of the linkage.
fn poses(positions: &Positions) -> Vec<Pose> {
    positions.angle.iter().zip(&positions.origin).map(|(angle, origin)| [*angle, origin.x, origin.y]).collect()
}

/// Poses at sigma after whole revolutions, by the exact evaluator; angles count on.
fn poses_at(reduced: &Reduced, sigma: f64, revolutions: f64) -> (Vec<Pose>, Vec<f64>) {
    unwound(reduced, &reduced.at(sigma).curve().configuration(sigma), revolutions)
}

/// Poses of all bodies and the coordinates in a configuration after whole revolutions.
fn unwound(reduced: &Reduced, c: &Configuration, revolutions: f64) -> (Vec<Pose>, Vec<f64>) {
    let growth = |i: usize| revolutions * reduced.curve().growth(i);
    let mut all = poses(&c.positions);
    for (pose, body) in all.iter_mut().zip(&reduced.linkage().bodies) {
        pose[0] += body.angle_coordinate.map_or(0.0, growth);
    }
    (all, c.q.iter().enumerate().map(|(i, q)| q + growth(i)).collect())
}

impl Model {
    /// Poses of all bodies of the linkage in the present state; None before the first initialisation. Of the finite
    /// elements the rigid bodies that fit best.
    pub fn poses(&self) -> Option<Vec<Pose>> {
        let (state, reduced) = (self.state.as_ref()?.along_curve(), self.reduced.as_ref()?);
        Some(poses_at(reduced, state.sigma, state.revolutions).0)
    }

    /// What there is to be drawn under the present parameters.
    ///
    /// # Errors
    /// The present parameters give no mechanism.
    pub fn scene(&mut self) -> Result<Scene, ModelError> {
        let reduced = Arc::clone(self.reduced()?);
        Ok(Scene::new(self.parameter_values.mechanism(), reduced.linkage())?)
    }

    /// The whole travel in `count` equal parts of sigma, under the present parameters; fewer if a whole revolution is
    /// shown only in part.
    ///
    /// # Errors
    /// The present parameters give no mechanism, or no start.
    pub fn sweep(&mut self, count: usize) -> Result<Sweep, ModelError> {
        let reduced = Arc::clone(self.reduced()?);
        let state = State::at_start(&reduced, self.parameter_values.mechanism(), &self.inputs)?;
        let here = state.sigma + state.revolutions * reduced.period().unwrap_or(0.0);
        let whole = ends(&reduced, &state.travel, here);
        let range = shown(&reduced, whole, here);
        let mut out = Sweep {
            start: here,
            is_closed: matches!(reduced.curve().ends, Ends::Closed(_)),
            goes_on: [0, 1].map(|side| range[side] != whole[side] || reduced.curve().is_open(side)),
            ..Sweep::default()
        };
        out.sigma = (0..=count).map(|k| range[0] + (range[1] - range[0]) * k as f64 / count as f64).collect();
        let linkage = reduced.linkage();
        out.angles = linkage.angles;
        out.coordinates = linkage.coordinates.iter().map(|name| (name.clone(), Vec::new())).collect();
        let drives = &reduced.loading().drives;
        let named = drives.iter().zip(&reduced.loading().loads).map(|(drive, load)| {
            let quantity = match load {
                Load::Couple { .. } | Load::Screw { .. } => "angle",
                Load::Slide { .. } => "position",
                _ => "length",
            };
            (format!("{}.{quantity}", drive.name), drive.is_rotary, Vec::new())
        });
        out.drives = named.collect();
        let offsets: Vec<f64> = linkage.coordinates.iter().map(|name| offset(linkage, name)).collect();
        let (mut scratch, mut c) = (Scratch::default(), Configuration::default());
        for &sigma in &out.sigma {
            let (on_curve, revolutions) = reduced.unwound(sigma);
            reduced.at(on_curve).curve().configure(on_curve, &mut scratch, &mut c);
            let (poses, q) = unwound(&reduced, &c, revolutions);
            for (((_, values), q), offset) in out.coordinates.iter_mut().zip(q).zip(&offsets) {
                values.push(q + offset);
            }
            for (load, (.., values)) in out.drives.iter_mut().enumerate() {
                let [s, ..] = reduced.loading().loads[load].displacement(linkage, &c);
                values.push(s + revolutions * reduced.load_growth(load));
            }
            let slopes = slopes(&reduced, &c);
            out.slopes.resize(slopes.len(), Vec::new());
            out.slopes.iter_mut().zip(slopes).for_each(|(column, slope)| column.push(slope));
            out.poses.push(poses);
        }
        out.find_dead_centres(&reduced);
        let rigid = state.travel.rigid.iter().flatten().map(|end| (end.stop, end.position));
        let bumpers = state.travel.bumpers.iter();
        let bumpers = bumpers.flat_map(|b| b.positions.iter().flatten().map(|position| (b.stop, *position)));
        let defined = |(stop, _): &(usize, f64)| !reduced.loading().stops[*stop].of_cylinder;
        let met = rigid.chain(bumpers).filter(defined).map(|(stop, sigma)| {
            let (on_curve, revolutions) = reduced.unwound(sigma);
            SweptStop { stop, sigma, poses: poses_at(&reduced, on_curve, revolutions).0 }
        });
        out.stops = met.collect();
        let name = |end: RigidEnd| reduced.loading().stops[end.stop].name.clone();
        out.ends = [0, 1].map(|side| state.travel.rigid[side].filter(|_| range[side] == whole[side]).map(name));
        Ok(out)
    }
}

/// Derivative along sigma of each coordinate, then of each drive's displacement.
fn slopes(reduced: &Reduced, c: &Configuration) -> Vec<f64> {
    let drives = reduced.loading().loads.iter().take(reduced.loading().drives.len());
    let drives = drives.map(|load| load.displacement(reduced.linkage(), c)[1]);
    c.q_sigma.iter().copied().chain(drives).collect()
}

impl Sweep {
    /// The places where a slope changes its sign between two positions, by more than rounding.
    fn find_dead_centres(&mut self, reduced: &Reduced) {
        let names = self.coordinates.iter().map(|(name, _)| name);
        let names = names.chain(reduced.loading().drives.iter().map(|drive| &drive.name));
        let at = |sigma: f64| {
            let (on_curve, _) = reduced.unwound(sigma);
            slopes(reduced, &reduced.at(on_curve).curve().configuration(on_curve))
        };
        // Coordinates often stand still together: the places that were found, with all slopes there.
        let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
        let largest = |column: &Vec<f64>| column.iter().fold(0.0, |most: f64, slope| most.max(slope.abs()));
        let are_angles = (0..self.coordinates.len()).map(|k| k < self.angles).chain(self.drives.iter().map(|d| d.1));
        // Largest slopes as of angles: what turns as little as rounding stands still everywhere.
        let unit = |is_angle: bool| if is_angle { 1.0 } else { reduced.linkage().size };
        let sizes: Vec<f64> = self.slopes.iter().zip(are_angles).map(|(all, is)| largest(all) / unit(is)).collect();
        let moves = STANDS * sizes.iter().copied().fold(0.0, f64::max);
        for (k, (name, column)) in names.zip(&self.slopes).enumerate().filter(|(k, _)| sizes[*k] > moves) {
            let largest = largest(column);
            for (pair, sigma) in column.windows(2).zip(self.sigma.windows(2)) {
                if pair[0] * pair[1] >= 0.0 || pair[0].abs().max(pair[1].abs()) <= 1e-9 * largest {
                    continue;
                }
                let is_here = |(at, slopes): &&(f64, Vec<f64>)| {
                    (sigma[0]..=sigma[1]).contains(at) && slopes[k].abs() <= STANDS * largest
                };
                let known = found.iter().find(is_here).map(|(place, _)| *place);
                let place = known.unwrap_or_else(|| {
                    let sign = pair[1].signum();
                    let (from, to) = ((sigma[0], pair[0] * sign), (sigma[1], pair[1] * sign));
                    let place = false_position(|sigma| at(sigma)[k] * sign, from, to, STANDS * (to.0 - from.0));
                    found.push((place, at(place)));
                    place
                });
                self.dead_centres.push((place, name.clone()));
            }
        }
    }
}

/// Angle of the body with a coordinate's name less the coordinate [rad]; 0 for a position.
fn offset(linkage: &Linkage, coordinate: &str) -> f64 {
    let angles = &linkage.coordinates[..linkage.angles];
    let is_angle = angles.iter().any(|name| name == coordinate);
    let body = linkage.bodies.iter().find(|body| is_angle && body.name == coordinate);
    body.map_or(0.0, |body| body.offset)
}

/// The part of the travel that is shown: of many revolutions some, and of a slide without an end what is near the
/// start.
fn shown(reduced: &Reduced, [low, high]: [f64; 2], here: f64) -> [f64; 2] {
    if let Some(period) = reduced.period() {
        let reach = 0.5 * REVOLUTIONS * period;
        return [low.max(here - reach), high.min(here + reach)];
    }
    let origins = |sigma: f64| reduced.at(sigma).curve().configuration(sigma).positions.origin;
    let (start, size) = (origins(here), reduced.linkage().size);
    let is_near = |sigma: f64| {
        let moved = origins(sigma).iter().zip(&start).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        moved <= SHOWN * size
    };
    [low, high].map(|end| {
        // A slide goes on; so what is near is one interval of the travel.
        match is_near(end) {
            true => end,
            false => bisect(|sigma| !is_near(sigma), here, end)[0],
        }
    })
}

/// A definition that gives no model, as far as it can be drawn; None if its bodies cannot be placed at all.
pub fn attempt(text: &str) -> Option<Attempt> {
    let mechanism = Mechanism::from_json(text).ok()?;
    let linkage = Arc::new(Linkage::new(&mechanism).ok()?);
    let guess = guessed(&linkage, &mechanism.guess).ok()?;
    let scene = Scene::new(&mechanism, &linkage).ok()?;
    let assembled = Closure::assemble(Arc::clone(&linkage), &guess).ok();
    let is_assembled = assembled.is_some();
    let positions = linkage.positions(&assembled.map_or(guess, |(_, q)| q));
    let gaps = if is_assembled { Vec::new() } else { gaps(&linkage, &positions) };
    Some(Attempt { scene, poses: poses(&positions), is_assembled, gaps })
}

/// Joints that are open, by more than rounding.
fn gaps(linkage: &Linkage, positions: &Positions) -> Vec<Gap> {
    let mut open = Vec::new();
    for joint in &linkage.joints[..linkage.joints.len() - linkage.couplings.len()] {
        let second = positions.point(joint.second);
        let mut first = positions.point(joint.first);
        if let Freedom::Slot(index) = joint.freedom {
            first += positions.slots[index].out;
        }
        if let Freedom::Prismatic(axis) = joint.freedom {
            let axis = positions.vector(joint.first.body, axis);
            let off = cross(axis, second - first);
            first = second - off * Vec2::new(-axis.y, axis.x);
        }
        let gap = (second - first).norm();
        if gap > 1e-9 * linkage.size {
            open.push(Gap { joint: joint.name.clone(), first: first.into(), second: second.into(), gap });
        }
    }
    open
}
