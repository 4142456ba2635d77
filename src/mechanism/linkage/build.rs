//! From the definition to the linkage: merged bodies, groups of one angle, spanning tree.
//!
//! In: a checked definition. Out: a linkage. It must not know positions.
use super::slot::Slot;
use super::structure::{Body, Branch, Frame, Freedom, GROUND, Joint, Line, Linkage, Point, Rotor, Stroke};
use crate::mechanism::definition::{self, Between, DefinitionError, JointKind, Mechanism, Shape};
use crate::numerics::plane::{Vec2, turned};
use std::fmt;

/// Smallest size of a linkage [m]: its square is no subnormal number. Points nearer to one another are one point.
const SMALLEST: f64 = 1e-100;

/// Mass [kg], first moment [kg.m] and moment of inertia about the frame's origin [kg.m2]: additive over merged bodies.
#[derive(Clone, Copy, Default)]
struct Moments {
    mass: f64,
    first: Vec2,
    second: f64,
}

impl Moments {
    /// Moments of one body of the definition with its frame at this origin and angle.
    fn of(body: &definition::Body, origin: Vec2, angle: f64) -> Self {
        let mass = body.mass.unwrap_or(0.0);
        let inertia = match (body.shape, body.length) {
            (Some(Shape::UniformRod), Some(length)) => mass * length * length / 12.0,
            _ => body.inertia.unwrap_or(0.0),
        };
        let at = origin + turned(body.center_of_mass().into(), angle);
        Self { mass, first: mass * at, second: inertia + mass * at.norm_squared() }
    }

    fn add(&mut self, other: Self) {
        self.mass += other.mass;
        self.first += other.first;
        self.second += other.second;
    }

    fn center(&self) -> Vec2 {
        if self.mass > 0.0 { self.first / self.mass } else { Vec2::zeros() }
    }

    /// Moment of inertia about the centre of mass, >= 0 in spite of rounding.
    fn inertia(&self) -> f64 {
        (self.second - self.mass * self.center().norm_squared()).max(0.0)
    }
}

/// Frame of each body of the definition in its carrier. Each is composed once with the frame of the body to which it is
/// fixed, so that a chain of n bodies takes n compositions.
fn frames_of(
    mechanism: &Mechanism,
    named: &[(&str, &definition::Body)],
    carriers: &[usize],
) -> Result<Vec<Frame>, DefinitionError> {
    let mut frames: Vec<Option<Frame>> = vec![None; named.len()];
    let mut outward = Vec::new();
    for i in 0..named.len() {
        // Inward along fixed_to to a body whose frame is known, then outward again.
        let mut at = i;
        let mut frame = loop {
            if let Some(known) = frames[at] {
                break known;
            }
            let (name, body) = named[at];
            let Some(to) = &body.fixed_to else {
                let own = Frame { body: carriers[at], origin: Vec2::zeros(), angle: 0.0 };
                frames[at] = Some(own);
                break own;
            };
            let (parent, [x, y]) = mechanism.point(format_args!("bodies.{name}.fixed_to"), to)?;
            outward.push((at, Vec2::new(x, y), body.angle.unwrap_or(0.0)));
            at = parent;
        };
        for (body, point, angle) in outward.drain(..).rev() {
            let origin = frame.origin + turned(point, frame.angle);
            frame = Frame { body: frame.body, origin, angle: frame.angle + angle };
            frames[body] = Some(frame);
        }
    }
    Ok(frames.into_iter().flatten().collect())
}

/// Number that stands for the part of a graph in which a node is: the node reached by `parts` from node to node.
fn part_of(parts: &mut [usize], mut node: usize) -> usize {
    while parts[node] != node {
        // Halving the path keeps later walks short.
        parts[node] = parts[parts[node]];
        node = parts[node];
    }
    node
}

impl Linkage {
    /// Resolve a definition.
    ///
    /// # Errors
    /// A joint within one body, a body without joints to the ground, prismatic joints that contradict one another.
    pub fn new(mechanism: &Mechanism) -> Result<Self, DefinitionError> {
        let mut linkage = Self::bodies_of(mechanism)?;
        linkage.add_joints(mechanism)?;
        let reached = linkage.grow_tree();
        if let Some(loose) = reached.iter().position(|r| !r) {
            let message = "this body is not connected to the ground by joints: add a joint, or the key `fixed_to`";
            return Err(DefinitionError::key(format_args!("bodies.{}", linkage.bodies[loose].name), message));
        }
        linkage.number_coordinates();
        linkage.add_couplings(mechanism)?;
        linkage.cuts.extend(linkage.couplings.iter().map(|coupling| coupling.joint));
        linkage.close_loops();
        linkage.add_rotors(mechanism)?;
        Ok(linkage)
    }

    /// Add the screws of drives and the rotors of joints, with or without a moment of inertia.
    fn add_rotors(&mut self, mechanism: &Mechanism) -> Result<(), DefinitionError> {
        for (name, drive) in mechanism.actuators.iter() {
            let Some(screw) = drive.screw else { continue };
            let line = match drive.between() {
                Some(Between::Points([first, second])) => {
                    let end =
                        |key: &str, text: &str| self.locate(mechanism, format_args!("actuators.{name}.{key}"), text);
                    Line::Between(end("first", first)?, end("second", second)?)
                }
                Some(Between::Joint(joint)) => match mechanism.joints.position(joint) {
                    Some(index) => Line::Joint(index),
                    None => continue,
                },
                Some(Between::Bodies(_)) | None => continue,
            };
            self.rotors.push(Rotor { stroke: Stroke::Along(line), mass: screw.reflected_mass() });
        }
        for (index, (_, joint)) in mechanism.joints.iter().enumerate() {
            let Some(mass) = joint.armature else { continue };
            let Joint { freedom, first, second, .. } = self.joints[index];
            let stroke = match freedom {
                Freedom::Revolute => Stroke::Angle(first.body, second.body),
                _ => Stroke::Along(Line::Joint(index)),
            };
            self.rotors.push(Rotor { stroke, mass });
        }
        Ok(())
    }

    /// A point of the definition in this linkage.
    ///
    /// # Errors
    /// [`Mechanism::point`]'s.
    pub fn locate(&self, mechanism: &Mechanism, key: fmt::Arguments, text: &str) -> Result<Point, DefinitionError> {
        let (named, [x, y]) = mechanism.point(key, text)?;
        let Frame { body, origin, angle } = self.frames[named];
        Ok(Point { body, local: origin + turned(Vec2::new(x, y), angle) })
    }

    /// Index of the body that carries a body of the definition, and the carried body's angle in the carrier's frame
    /// [rad].
    pub fn carrier(&self, mechanism: &Mechanism, name: &str) -> Option<(usize, f64)> {
        mechanism.bodies.position(name).map(|i| (self.frames[i].body, self.frames[i].angle))
    }

    /// Angle of the body that a point is named by, in the carrier's frame [rad].
    pub fn angle_of(&self, mechanism: &Mechanism, point: &str) -> f64 {
        let named = point.split('.').next().unwrap_or_default();
        self.carrier(mechanism, named).map_or(0.0, |(_, angle)| angle)
    }

    fn bodies_of(mechanism: &Mechanism) -> Result<Self, DefinitionError> {
        let named: Vec<(&str, &definition::Body)> = mechanism.bodies.iter().collect();
        let own = (0..named.len()).filter(|&i| named[i].1.fixed_to.is_none());
        let (mut order, others): (Vec<usize>, Vec<usize>) = own.partition(|&i| named[i].0 == definition::GROUND);
        order.extend(others);
        let mut carriers = vec![GROUND; named.len()];
        for (carrier, &i) in order.iter().enumerate() {
            carriers[i] = carrier;
        }
        let mut moments = vec![Moments::default(); order.len()];
        let frames = frames_of(mechanism, &named, &carriers)?;
        let mut size: f64 = 0.0;
        for (&(_, body), &Frame { body: carrier, origin, angle }) in named.iter().zip(&frames) {
            moments[carrier].add(Moments::of(body, origin, angle));
            size = size.max(origin.norm()).max(body.length.unwrap_or(0.0));
            size = body.points.iter().fold(size, |s, (_, [x, y])| s.max(x.hypot(*y)));
        }
        let bodies = order
            .iter()
            .zip(&moments)
            .map(|(&i, m)| Body {
                name: named[i].0.into(),
                angle_coordinate: None,
                offset: 0.0,
                mass: m.mass,
                center: m.center(),
                inertia: m.inertia(),
            })
            .collect();
        let mut linkage = Self { bodies, size: if size >= SMALLEST { size } else { 1.0 }, frames, ..Self::default() };
        if mechanism.is_massless() {
            linkage.give_nominal_masses();
        }
        Ok(linkage)
    }

    /// Give each body 1 kg at its origin and a radius of gyration of the size of the linkage, so that a motion of any
    /// body has a length along the curve. Nothing that depends on these masses is a variable.
    fn give_nominal_masses(&mut self) {
        self.is_massless = true;
        for body in self.bodies.iter_mut().skip(1) {
            (body.mass, body.center, body.inertia) = (1.0, Vec2::zeros(), self.size * self.size);
        }
    }

    fn add_joints(&mut self, mechanism: &Mechanism) -> Result<(), DefinitionError> {
        for (name, joint) in mechanism.joints.iter() {
            let first = self.locate(mechanism, format_args!("joints.{name}.first"), &joint.first)?;
            let second = self.locate(mechanism, format_args!("joints.{name}.second"), &joint.second)?;
            if first.body == second.body {
                let body = &self.bodies[first.body].name;
                let message = format!("this joint connects {body} to itself: give points of two bodies");
                return Err(DefinitionError::key(format_args!("joints.{name}"), message));
            }
            let freedom = match joint.kind {
                JointKind::Revolute => Freedom::Revolute,
                JointKind::Prismatic => {
                    // The axis is stated in the frame of the named body, whose angle in the carrier may differ from 0.
                    let angle = joint.axis_angle.unwrap_or(0.0) + self.angle_of(mechanism, &joint.first);
                    Freedom::Prismatic(turned(Vec2::x(), angle))
                }
                JointKind::Slot => {
                    let missing = || DefinitionError::key(format_args!("joints.{name}"), "the curve is missing");
                    let angle = self.angle_of(mechanism, &joint.first);
                    let (track, turn) = (joint.track().ok_or_else(missing)?, (angle.cos(), angle.sin()));
                    let (own, coordinate) = (self.joints.len(), 0);
                    self.slots.push(Slot { joint: own, coordinate, track, angle, turn });
                    Freedom::Slot(self.slots.len() - 1)
                }
            };
            self.joints.push(Joint { name: name.into(), freedom, first, second });
        }
        let mut groups: Vec<Vec<usize>> = (0..self.bodies.len()).map(|body| vec![body]).collect();
        for (i, (_, joint)) in mechanism.joints.iter().enumerate() {
            if joint.kind == JointKind::Prismatic {
                let angle = |point: &str| self.angle_of(mechanism, point);
                let relative = joint.angle.unwrap_or(0.0) + angle(&joint.first) - angle(&joint.second);
                self.join_angles(&mut groups, i, relative)?;
            }
        }
        Ok(())
    }

    /// Merge the groups of one angle of a prismatic joint's bodies: second angle = first angle + relative. `groups`:
    /// the bodies of each leading body's group.
    fn join_angles(&mut self, groups: &mut [Vec<usize>], joint: usize, relative: f64) -> Result<(), DefinitionError> {
        let (a, b) = (self.joints[joint].first.body, self.joints[joint].second.body);
        // Until the coordinates are numbered, `angle_coordinate` holds the index of the group's leading body.
        let leader = |bodies: &[Body], i: usize| bodies[i].angle_coordinate.unwrap_or(i);
        let (mut from, mut to) = (leader(&self.bodies, b), leader(&self.bodies, a));
        let mut shift = self.bodies[a].offset + relative - self.bodies[b].offset;
        if from == to {
            let excess = shift.rem_euclid(std::f64::consts::TAU);
            if excess.min(std::f64::consts::TAU - excess) > 1e-9 {
                let message = format!(
                    "other prismatic joints fix the angle between the two bodies at a value that differs from this \
                        angle by {shift} rad: correct one of the angles"
                );
                return Err(DefinitionError::key(format_args!("joints.{}.angle", self.joints[joint].name), message));
            }
            return Ok(());
        }
        // The smaller group joins the larger one: a body changes its group log2 n times at most.
        if groups[from].len() > groups[to].len() {
            (from, to, shift) = (to, from, -shift);
        }
        for body in std::mem::take(&mut groups[from]) {
            self.bodies[body].angle_coordinate = Some(to);
            self.bodies[body].offset += shift;
            groups[to].push(body);
        }
        Ok(())
    }

    /// Number the coordinates: the angles of groups without the ground, then the positions of the tree's prismatic
    /// joints, then those of the slots.
    fn number_coordinates(&mut self) {
        let leaders: Vec<usize> =
            (0..self.bodies.len()).map(|i| self.bodies[i].angle_coordinate.unwrap_or(i)).collect();
        // The angle of the ground's group is 0.
        let ground = (leaders[GROUND], self.bodies[GROUND].offset);
        // Coordinate and offset of each group's first body; the first body's offset from the coordinate is 0.
        let mut numbers: Vec<Option<(usize, f64)>> = vec![None; leaders.len()];
        for (i, leader) in leaders.iter().enumerate() {
            let body = &mut self.bodies[i];
            if *leader == ground.0 {
                body.angle_coordinate = None;
                body.offset -= ground.1;
                continue;
            }
            let (number, shift) = *numbers[*leader].get_or_insert_with(|| {
                self.coordinates.push(body.name.clone());
                (self.coordinates.len() - 1, body.offset)
            });
            body.angle_coordinate = Some(number);
            body.offset -= shift;
        }
        self.angles = self.coordinates.len();
        for branch in &mut self.tree {
            if matches!(self.joints[branch.joint].freedom, Freedom::Prismatic(_)) {
                branch.slide = Some(self.coordinates.len());
                self.coordinates.push(self.joints[branch.joint].name.clone());
            }
        }
        for slot in &mut self.slots {
            slot.coordinate = self.coordinates.len();
            self.coordinates.push(self.joints[slot.joint].name.clone());
            let own = self.tree.iter_mut().filter(|branch| branch.joint == slot.joint);
            own.for_each(|branch| branch.slide = Some(slot.coordinate));
        }
    }

    /// Grow the spanning tree, prismatic joints first and slots last; the other joints become cuts. Returns which
    /// bodies it reaches.
    fn grow_tree(&mut self) -> Vec<bool> {
        let n = self.bodies.len();
        // Kruskal's algorithm: a joint belongs to the tree if it connects two parts.
        let mut parts: Vec<usize> = (0..n).collect();
        let mut chosen = vec![false; self.joints.len()];
        let pass_of = |j: &Joint| match j.freedom {
            Freedom::Prismatic(_) => 0,
            Freedom::Slot(_) => 2,
            _ => 1,
        };
        for pass in 0..3 {
            for (i, joint) in self.joints.iter().enumerate().filter(|(_, j)| pass_of(j) == pass) {
                let (a, b) = (part_of(&mut parts, joint.first.body), part_of(&mut parts, joint.second.body));
                if a != b {
                    chosen[i] = true;
                    parts[b] = a;
                }
            }
        }
        self.cuts = (0..self.joints.len()).filter(|&i| !chosen[i]).collect();
        // The tree's joints at each body, in the order of the file.
        let mut joints_at: Vec<Vec<usize>> = vec![Vec::new(); n];
        for (i, joint) in self.joints.iter().enumerate().filter(|(i, _)| chosen[*i]) {
            joints_at[joint.first.body].push(i);
            joints_at[joint.second.body].push(i);
        }
        let mut reached = vec![false; n];
        reached[GROUND] = true;
        let mut front = vec![GROUND];
        while let Some(parent) = front.pop() {
            for &i in &joints_at[parent] {
                let joint = &self.joints[i];
                let (a, b) = (joint.first.body, joint.second.body);
                let child = if a == parent { b } else { a };
                if !reached[child] {
                    reached[child] = true;
                    let reversed = child == a;
                    let (on_parent, on_child) =
                        if reversed { (joint.second, joint.first) } else { (joint.first, joint.second) };
                    let (from, to) = (on_parent.local, on_child.local);
                    self.tree.push(Branch { child, parent, joint: i, slide: None, from, to, reversed });
                    front.push(child);
                }
            }
        }
        reached
    }
}
