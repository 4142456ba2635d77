//! The loop equations: the gaps of the joints outside the tree vanish.
//!
//! In: positions and rates of the bodies. Out: gaps [m], their second derivatives and their Jacobian. A revolute joint
//! gives two rows, the components of the gap between its points. A slot gives the two components of the gap between its
//! pin and the point of its curve. A prismatic joint gives one row, the gap normal to its axis (its bodies share one
//! angle), and a coupling gives one. A row depends on the coordinates round its loop only. It must not know Newton's
//! method.
use super::motion::{Positions, Rates};
use super::structure::{Branch, Freedom, Linkage, Loop, Point, Step};
use crate::numerics::order;
use crate::numerics::plane::{Vec2, cross, perp, turned};
use nalgebra::DMatrix;
use std::iter;

/// The side of a loop that is as long as all others together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// A body, between its two joints of the loop.
    Body(usize),
    /// The two bodies of a prismatic joint, between their other joints of the loop, across the axis.
    Slide(usize),
}

/// A loop that cannot close, or only stretched flat.
#[derive(Clone, Debug, PartialEq)]
pub struct Straight {
    /// The joint that closes it.
    pub joint: usize,
    /// Its longest side.
    pub side: Side,
    /// Length of this side [m].
    pub length: f64,
    /// The other bodies, each with the distance of its two joints of the loop [m].
    pub others: Vec<(usize, f64)>,
}

impl Linkage {
    /// Find the branches and columns of every loop, once the tree is complete and the coordinates are numbered.
    pub(super) fn close_loops(&mut self) {
        let mut inward = vec![None; self.bodies.len()];
        let mut depth = vec![0; self.bodies.len()];
        for (i, branch) in self.tree.iter().enumerate() {
            inward[branch.child] = Some(i);
            depth[branch.child] = depth[branch.parent] + 1;
        }
        let loop_of = |&j: &usize| {
            if let Freedom::Coupling(index) = self.joints[j].freedom {
                return Loop { columns: self.coupled_coordinates(&self.couplings[index]), ..Loop::default() };
            }
            let (first, second) = (self.joints[j].first.body, self.joints[j].second.body);
            let (mut plus, mut minus) = (second, first);
            let mut path = Vec::new();
            while plus != minus {
                let outer = depth[plus] >= depth[minus];
                let body = if outer { &mut plus } else { &mut minus };
                let Some(branch) = inward[*body] else { break };
                *body = self.tree[branch].parent;
                path.push((branch, if outer { 1.0 } else { -1.0 }));
            }
            let angle = |body: usize| self.bodies[body].angle_coordinate;
            let mut columns: Vec<usize> = [angle(first), angle(second)].into_iter().flatten().collect();
            for (branch, _) in &path {
                let b = &self.tree[*branch];
                columns.extend([angle(b.parent), angle(b.child), b.slide].into_iter().flatten());
            }
            let slide = match self.joints[j].freedom {
                Freedom::Slot(index) => Some(self.slots[index].coordinate),
                _ => None,
            };
            columns.extend(slide);
            let columns = order::distinct(columns);
            let column = |c: Option<usize>| c.and_then(|c| columns.binary_search(&c).ok());
            let step = |(branch, sign): (usize, f64)| {
                let b = &self.tree[branch];
                let (parent, child, slide) = (column(angle(b.parent)), column(angle(b.child)), column(b.slide));
                Step { branch, sign, parent, child, slide }
            };
            let steps = path.into_iter().map(step).collect();
            Loop { steps, first: column(angle(first)), second: column(angle(second)), slide: column(slide), columns }
        };
        self.loops = self.cuts.iter().map(loop_of).collect();
    }

    /// Number of loop equations.
    pub fn rows(&self) -> usize {
        self.cuts.iter().map(|&j| self.joints[j].freedom.rows()).sum()
    }

    /// Index of the joint that gives each loop equation.
    pub fn row_joints(&self) -> Vec<usize> {
        self.cuts.iter().flat_map(|&j| vec![j; self.joints[j].freedom.rows()]).collect()
    }

    /// A loop of revolute joints, and of one prismatic joint at most, one side of which is as long as all others
    /// together, or longer: it cannot close, or only stretched flat. `slack`: part of the length by which that side may
    /// be shorter.
    pub fn straight_loop(&self, slack: f64) -> Option<Straight> {
        self.cuts.iter().zip(&self.loops).find_map(|(&cut, round)| {
            let joints = || iter::once(cut).chain(round.steps.iter().map(|step| self.tree[step.branch].joint));
            // Each body of the loop has two points of its joints.
            let mut corners: Vec<(usize, Vec2)> = Vec::new();
            let mut sides: Vec<(f64, Side)> = Vec::new();
            let mut slides = Vec::new();
            for index in joints() {
                let joint = &self.joints[index];
                match joint.freedom {
                    Freedom::Coupling(_) | Freedom::Slot(_) => return None,
                    Freedom::Prismatic(axis) => slides.push((index, axis)),
                    Freedom::Revolute => {
                        for point in [joint.first, joint.second] {
                            match corners.iter().position(|(body, _)| *body == point.body) {
                                Some(at) => {
                                    let (body, other) = corners.swap_remove(at);
                                    sides.push(((point.local - other).norm(), Side::Body(body)));
                                }
                                None => corners.push((point.body, point.local)),
                            }
                        }
                    }
                }
            }
            let (side, length) = match slides[..] {
                [] => sides.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0)).map(|(length, side)| (side, length))?,
                // Its two bodies are one side, which can only become longer by sliding.
                [(index, axis)] => {
                    let joint = &self.joints[index];
                    let across = |end: Point| {
                        let turn = self.bodies[end.body].offset - self.bodies[joint.first.body].offset;
                        Some(cross(
                            axis,
                            turned(corners.iter().find(|(body, _)| *body == end.body)?.1 - end.local, turn),
                        ))
                    };
                    (Side::Slide(index), (across(joint.second)? - across(joint.first)?).abs())
                }
                _ => return None,
            };
            let others: Vec<(usize, f64)> = sides
                .iter()
                .filter_map(|&(length, other)| match other {
                    Side::Body(body) if other != side => Some((body, length)),
                    _ => None,
                })
                .collect();
            let others = order::sorted(others, |(body, _)| *body as f64);
            let reach: f64 = others.iter().map(|(_, length)| length).sum();
            // Two bodies with two joints are one, whatever the direction.
            let slack = if others.len() > 1 { -slack } else { slack };
            (reach > 0.0 && length >= reach * (1.0 + slack)).then_some(Straight { joint: cut, side, length, others })
        })
    }

    /// Residuals of the loop equations [m].
    pub fn gaps(&self, p: &Positions) -> Vec<f64> {
        let mut out = Vec::with_capacity(2 * self.cuts.len());
        self.gaps_into(p, &mut out);
        out
    }

    /// [`Self::gaps`], in place.
    pub fn gaps_into(&self, p: &Positions, out: &mut Vec<f64>) {
        out.clear();
        for &j in &self.cuts {
            let joint = &self.joints[j];
            let gap = p.point(joint.second) - p.point(joint.first);
            match joint.freedom {
                Freedom::Revolute => out.extend([gap.x, gap.y]),
                Freedom::Prismatic(e) => out.push(perp(p.vector(joint.first.body, e)).dot(&gap)),
                Freedom::Slot(index) => {
                    let gap = gap - p.slots[index].out;
                    out.extend([gap.x, gap.y]);
                }
                Freedom::Coupling(index) => out.push(self.coupling_gap(&self.couplings[index], p)),
            }
        }
    }

    /// Second derivatives of the residuals, given the rates and second rates of the bodies and of the coordinates.
    pub fn gap_second_rates(
        &self,
        p: &Positions,
        (r, a): (&Rates, &Rates),
        of_coordinates: [&[f64]; 2],
        out: &mut Vec<f64>,
    ) {
        out.clear();
        for &j in &self.cuts {
            let joint = &self.joints[j];
            let second = p.acceleration(r, a, joint.second) - p.acceleration(r, a, joint.first);
            match joint.freedom {
                Freedom::Revolute => out.extend([second.x, second.y]),
                Freedom::Prismatic(e) => {
                    let axis: Vec2 = p.vector(joint.first.body, e);
                    let gap = p.point(joint.second) - p.point(joint.first);
                    let rate = p.velocity(r, joint.second) - p.velocity(r, joint.first);
                    let (omega, alpha) = (r.angle[joint.first.body], a.angle[joint.first.body]);
                    let normal = perp(axis);
                    out.push(
                        normal.dot(&second)
                            - 2.0 * omega * axis.dot(&rate)
                            - alpha * axis.dot(&gap)
                            - omega * omega * normal.dot(&gap),
                    );
                }
                Freedom::Slot(index) => {
                    let second = second - self.slot_second_rate(index, p, (r, a), of_coordinates);
                    out.extend([second.x, second.y]);
                }
                Freedom::Coupling(index) => out.push(self.coupling_second_rate(&self.couplings[index], p, r, a)),
            }
        }
    }

    /// Derivatives of the residuals of the loop with index `index` in [`Self::cuts`], in the loop's columns. Rows of a
    /// revolute joint and a slot: the gap's x and y. First row of a prismatic joint: the gap normal to the axis; of a
    /// coupling: its residual.
    pub fn partials(&self, p: &Positions, q: &[f64], index: usize, rows: &mut [Vec<f64>; 2]) {
        let (of, joint) = (&self.loops[index], &self.joints[self.cuts[index]]);
        let [x, y] = rows;
        for row in [&mut *x, &mut *y] {
            row.clear();
            row.resize(of.columns.len(), 0.0);
        }
        if let Freedom::Coupling(index) = joint.freedom {
            return self.coupling_partials(&self.couplings[index], p, &mut |coordinate, change| {
                if let Some(column) = coordinate.and_then(|c| of.columns.binary_search(&c).ok()) {
                    x[column] += change;
                }
            });
        }
        let mut add = |column: Option<usize>, change: Vec2| {
            if let Some(c) = column {
                x[c] += change.x;
                y[c] += change.y;
            }
        };
        add(of.second, perp(p.vector(joint.second.body, joint.second.local)));
        match joint.freedom {
            Freedom::Slot(index) => {
                let along = &p.slots[index];
                add(of.first, -perp(p.vector(joint.first.body, joint.first.local) + along.out));
                add(of.slide, -along.axis);
            }
            _ => add(of.first, -perp(p.vector(joint.first.body, joint.first.local))),
        }
        for step in &of.steps {
            let arms = &p.arms[step.branch];
            add(step.parent, step.sign * perp(arms.from));
            let mut out = arms.to;
            if let Branch { slide: Some(s), joint, .. } = self.tree[step.branch] {
                if !matches!(self.joints[joint].freedom, Freedom::Slot(_)) {
                    out -= q[s] * arms.axis;
                }
                add(step.slide, step.sign * arms.axis);
            }
            add(step.child, -step.sign * perp(out));
        }
        if let Freedom::Prismatic(e) = joint.freedom {
            let axis = p.vector(joint.first.body, e);
            let (normal, gap) = (perp(axis), p.point(joint.second) - p.point(joint.first));
            for (x, y) in x.iter_mut().zip(y.iter()) {
                *x = normal.x * *x + normal.y * y;
            }
            if let Some(c) = of.first {
                x[c] -= axis.dot(&gap);
            }
        }
    }

    /// Jacobian of the residuals, rows by coordinates.
    pub fn jacobian(&self, p: &Positions, q: &[f64]) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.rows(), q.len());
        let mut rows = [Vec::new(), Vec::new()];
        let mut first = 0;
        for (index, &j) in self.cuts.iter().enumerate() {
            self.partials(p, q, index, &mut rows);
            for row in &rows[..self.joints[j].freedom.rows()] {
                for (&column, value) in self.loops[index].columns.iter().zip(row) {
                    out[(first, column)] = *value;
                }
                first += 1;
            }
        }
        out
    }
}
