//! From the definition to the linkage: fixed bodies merged, turning groups, spanning tree.
use super::{Body, Branch, Freedom, GROUND, Joint, Linkage, Point, Vec2, turned};
use crate::mechanism::definition::{self, DefinitionError, JointKind, Mechanism, Shape};
use std::fmt;

/// Mass, first moment and moment of inertia about the frame's origin: the sums that composing bodies needs.
#[derive(Clone, Copy, Default)]
struct Moments {
    mass: f64,
    first: Vec2,
    second: f64,
}

impl Moments {
    /// Of one body of the definition, with its origin at `place`, turned by `angle`.
    fn of(body: &definition::Body, place: Vec2, angle: f64) -> Self {
        let mass = body.mass.unwrap_or(0.0);
        let (center, inertia) = match (body.shape, body.length) {
            (Some(Shape::UniformRod), Some(length)) => (Vec2::new(0.5 * length, 0.0), mass * length * length / 12.0),
            _ => (body.center.map_or(Vec2::zeros(), |[x, y]| Vec2::new(x, y)), body.inertia.unwrap_or(0.0)),
        };
        let at = place + turned(center, angle);
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

    /// About the centre of mass; rounding must not make it negative.
    fn inertia(&self) -> f64 {
        (self.second - self.mass * self.center().norm_squared()).max(0.0)
    }
}

impl Linkage {
    /// Resolve a definition.
    ///
    /// # Errors
    /// A joint within one body, a body that no joint connects to the ground, prismatic joints that contradict one another.
    pub fn new(mechanism: &Mechanism) -> Result<Self, DefinitionError> {
        let mut linkage = Self::bodies_of(mechanism)?;
        linkage.add_joints(mechanism)?;
        let reached = linkage.grow_tree();
        if let Some(lost) = reached.iter().position(|r| !r) {
            return Err(DefinitionError::Key {
                key: format!("bodies.{}", linkage.bodies[lost].name),
                message: "no chain of joints leads from it to the ground: add a joint or fixed_to".into(),
            });
        }
        linkage.group_turns();
        linkage.close_loops();
        Ok(linkage)
    }

    /// Place of a point of the definition in this linkage.
    ///
    /// # Errors
    /// As [`Mechanism::point`].
    pub fn locate(&self, mechanism: &Mechanism, key: fmt::Arguments, text: &str) -> Result<Point, DefinitionError> {
        let (named, [x, y]) = mechanism.point(key, text)?;
        let (body, place, angle) = self.placed[named];
        Ok(Point { body, local: place + turned(Vec2::new(x, y), angle) })
    }

    /// The body that carries the definition's body, and the angle of the latter's x axis in the former's frame [rad].
    pub fn carrier(&self, mechanism: &Mechanism, name: &str) -> Option<(usize, f64)> {
        mechanism.bodies.position(name).map(|i| (self.placed[i].0, self.placed[i].2))
    }

    fn bodies_of(mechanism: &Mechanism) -> Result<Self, DefinitionError> {
        let named: Vec<(&str, &definition::Body)> = mechanism.bodies.iter().collect();
        let mut order: Vec<usize> = (0..named.len()).filter(|&i| named[i].1.fixed_to.is_none()).collect();
        order.sort_by_key(|&i| named[i].0 != definition::GROUND);
        let mut carriers = vec![GROUND; named.len()];
        for (carrier, &i) in order.iter().enumerate() {
            carriers[i] = carrier;
        }
        let mut moments = vec![Moments::default(); order.len()];
        let mut placed = Vec::new();
        let mut size: f64 = 0.0;
        for (i, &(name, body)) in named.iter().enumerate() {
            // Follow fixed_to to the carrier, composing places and angles.
            let (mut place, mut angle, mut at) = (Vec2::zeros(), 0.0, i);
            let mut current = body;
            while let Some(to) = &current.fixed_to {
                let (parent, [x, y]) = mechanism.point(format_args!("bodies.{name}.fixed_to"), to)?;
                let own = current.angle.unwrap_or(0.0);
                place = Vec2::new(x, y) + turned(place, own);
                angle += own;
                at = parent;
                current = named[parent].1;
            }
            let carrier = carriers[at];
            moments[carrier].add(Moments::of(body, place, angle));
            placed.push((carrier, place, angle));
            size = size.max(place.norm()).max(body.length.unwrap_or(0.0));
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
        Ok(Self {
            bodies,
            joints: Vec::new(),
            tree: Vec::new(),
            cuts: Vec::new(),
            loops: Vec::new(),
            coordinates: Vec::new(),
            angles: 0,
            size: if size > 0.0 { size } else { 1.0 },
            placed,
        })
    }

    fn add_joints(&mut self, mechanism: &Mechanism) -> Result<(), DefinitionError> {
        for (name, joint) in mechanism.joints.iter() {
            let first = self.locate(mechanism, format_args!("joints.{name}.first"), &joint.first)?;
            let second = self.locate(mechanism, format_args!("joints.{name}.second"), &joint.second)?;
            if first.body == second.body {
                return Err(DefinitionError::Key {
                    key: format!("joints.{name}"),
                    message: format!("connects {} to itself: name points of two bodies", self.bodies[first.body].name),
                });
            }
            let freedom = match joint.kind {
                JointKind::Revolute => Freedom::Revolute,
                JointKind::Prismatic => {
                    // The axis is stated in the frame of the named body, which may be fixed to its carrier at an angle.
                    let named = joint.first.split('.').next().unwrap_or_default();
                    let angle = self.carrier(mechanism, named).map_or(0.0, |(_, angle)| angle);
                    Freedom::Prismatic(turned(Vec2::x(), joint.axis_angle.unwrap_or(0.0) + angle))
                }
            };
            self.joints.push(Joint { name: name.into(), freedom, first, second });
        }
        // Relative angles of prismatic joints are kept for the grouping.
        for (i, (_, joint)) in mechanism.joints.iter().enumerate() {
            if joint.kind == JointKind::Prismatic {
                let angle = |text: &str| {
                    let named = text.split('.').next().unwrap_or_default();
                    self.carrier(mechanism, named).map_or(0.0, |(_, angle)| angle)
                };
                let relative = joint.angle.unwrap_or(0.0) + angle(&joint.first) - angle(&joint.second);
                self.slides_turn(i, relative)?;
            }
        }
        Ok(())
    }

    /// Join the turning groups of a prismatic joint's bodies: second angle = first angle + relative.
    fn slides_turn(&mut self, joint: usize, relative: f64) -> Result<(), DefinitionError> {
        let (a, b) = (self.joints[joint].first.body, self.joints[joint].second.body);
        // `turn` holds the group's leader until the coordinates are numbered.
        let leader = |bodies: &[Body], i: usize| bodies[i].angle_coordinate.unwrap_or(i);
        let (from, to) = (leader(&self.bodies, b), leader(&self.bodies, a));
        let shift = self.bodies[a].offset + relative - self.bodies[b].offset;
        if from == to {
            let wound = shift.rem_euclid(std::f64::consts::TAU);
            if wound.min(std::f64::consts::TAU - wound) > 1e-9 {
                return Err(DefinitionError::Key {
                    key: format!("joints.{}.angle", self.joints[joint].name),
                    message: format!("other prismatic joints already hold these bodies {shift} rad away from it"),
                });
            }
            return Ok(());
        }
        for i in 0..self.bodies.len() {
            if leader(&self.bodies, i) == from {
                self.bodies[i].angle_coordinate = Some(to);
                self.bodies[i].offset += shift;
            }
        }
        Ok(())
    }

    /// Number the coordinates: one angle for each group that can turn, one position for each prismatic joint of the tree.
    fn group_turns(&mut self) {
        let leaders: Vec<usize> =
            (0..self.bodies.len()).map(|i| self.bodies[i].angle_coordinate.unwrap_or(i)).collect();
        // Where the ground is in a group, its angle is 0.
        let ground = (leaders[GROUND], self.bodies[GROUND].offset);
        // The number of each leader's group; the body that names a coordinate has no offset from it.
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
    }

    /// Grow the spanning tree from the ground, prismatic joints first; what is left over closes loops.
    fn grow_tree(&mut self) -> Vec<bool> {
        let n = self.bodies.len();
        // Kruskal: a joint belongs to the tree if it connects two parts that are not yet connected.
        let mut part: Vec<usize> = (0..n).collect();
        let mut chosen = vec![false; self.joints.len()];
        let slides = |j: &Joint| matches!(j.freedom, Freedom::Prismatic(_));
        for pass in [true, false] {
            for (i, joint) in self.joints.iter().enumerate().filter(|(_, j)| slides(j) == pass) {
                let (a, b) = (part[joint.first.body], part[joint.second.body]);
                if a != b {
                    chosen[i] = true;
                    part.iter_mut().filter(|p| **p == b).for_each(|p| *p = a);
                }
            }
        }
        self.cuts = (0..self.joints.len()).filter(|&i| !chosen[i]).collect();
        let mut reached = vec![false; n];
        reached[GROUND] = true;
        let mut front = vec![GROUND];
        while let Some(parent) = front.pop() {
            for (i, joint) in self.joints.iter().enumerate() {
                let (a, b) = (joint.first.body, joint.second.body);
                let child = if a == parent { b } else { a };
                if chosen[i] && (a == parent || b == parent) && !reached[child] {
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
