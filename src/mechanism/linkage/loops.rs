//! The loop equations: what the joints outside the tree demand.
//!
//! A revolute joint gives two rows, the gap between its points [m]; a prismatic one gives one, the gap normal to its
//! axis (its bodies already turn together). A row depends on the coordinates round its loop only.
use super::{Freedom, Linkage, Positions, Rates, Vec2, perp};
use nalgebra::DMatrix;

/// How a joint outside the tree hangs on it: what its Jacobian is made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loop {
    /// The coordinates on which its gap depends, ascending.
    pub columns: Vec<usize>,
    /// Branches from its two bodies inward to where they meet; those of the second body add to the gap, the others
    /// take away from it.
    steps: Vec<Step>,
    /// Places of its bodies' angles among the columns.
    first: Option<usize>,
    second: Option<usize>,
}

/// A branch on the way round a loop.
#[derive(Clone, Debug, PartialEq)]
struct Step {
    branch: usize,
    sign: f64,
    /// Places among the loop's columns: the parent's angle, the child's, the joint's position.
    parent: Option<usize>,
    child: Option<usize>,
    slide: Option<usize>,
}

impl Linkage {
    /// Find the ways round the loops; the tree must stand and the coordinates be numbered.
    pub(super) fn close_loops(&mut self) {
        let mut inward = vec![None; self.bodies.len()];
        let mut depth = vec![0; self.bodies.len()];
        for (i, branch) in self.tree.iter().enumerate() {
            inward[branch.child] = Some(i);
            depth[branch.child] = depth[branch.parent] + 1;
        }
        let round = |&j: &usize| {
            let (first, second) = (self.joints[j].first.body, self.joints[j].second.body);
            let (mut plus, mut minus) = (second, first);
            let mut way = Vec::new();
            while plus != minus {
                let outer = depth[plus] >= depth[minus];
                let body = if outer { &mut plus } else { &mut minus };
                let Some(branch) = inward[*body] else { break };
                *body = self.tree[branch].parent;
                way.push((branch, if outer { 1.0 } else { -1.0 }));
            }
            let turn = |body: usize| self.bodies[body].angle_coordinate;
            let mut columns: Vec<usize> = [turn(first), turn(second)].into_iter().flatten().collect();
            for (branch, _) in &way {
                let b = &self.tree[*branch];
                columns.extend([turn(b.parent), turn(b.child), b.slide].into_iter().flatten());
            }
            columns.sort_unstable();
            columns.dedup();
            let place = |c: Option<usize>| c.and_then(|c| columns.binary_search(&c).ok());
            let step = |(branch, sign): (usize, f64)| {
                let b = &self.tree[branch];
                let (parent, child, slide) = (place(turn(b.parent)), place(turn(b.child)), place(b.slide));
                Step { branch, sign, parent, child, slide }
            };
            let steps = way.into_iter().map(step).collect();
            Loop { steps, first: place(turn(first)), second: place(turn(second)), columns }
        };
        self.loops = self.cuts.iter().map(round).collect();
    }

    /// Number of loop equations.
    pub fn rows(&self) -> usize {
        self.cuts.iter().map(|&j| if self.joints[j].freedom == Freedom::Revolute { 2 } else { 1 }).sum()
    }

    /// The joint behind each loop equation.
    pub fn row_joints(&self) -> Vec<usize> {
        let twice = |&j: &usize| vec![j; if self.joints[j].freedom == Freedom::Revolute { 2 } else { 1 }];
        self.cuts.iter().flat_map(twice).collect()
    }

    /// Residuals [m].
    pub fn gaps(&self, p: &Positions) -> Vec<f64> {
        let mut out = Vec::with_capacity(2 * self.cuts.len());
        self.measure(p, &mut out);
        out
    }

    /// As [`Self::gaps`], in place.
    pub fn measure(&self, p: &Positions, out: &mut Vec<f64>) {
        out.clear();
        for &j in &self.cuts {
            let joint = &self.joints[j];
            let gap = p.point(joint.second) - p.point(joint.first);
            match joint.freedom {
                Freedom::Revolute => out.extend([gap.x, gap.y]),
                Freedom::Prismatic(e) => out.push(perp(p.vector(joint.first.body, e)).dot(&gap)),
            }
        }
    }

    /// Second derivatives of the residuals, given the rates and second rates.
    pub fn gap_second_rates(&self, p: &Positions, r: &Rates, a: &Rates, out: &mut Vec<f64>) {
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
            }
        }
    }

    /// Derivatives of the residuals of the loop at a place among [`Self::cuts`], for its columns: of the gap in x and y
    /// for a revolute joint, of the gap normal to the axis in the first row for a prismatic one.
    pub fn partials(&self, p: &Positions, q: &[f64], place: usize, rows: &mut [Vec<f64>; 2]) {
        let (round, joint) = (&self.loops[place], &self.joints[self.cuts[place]]);
        let [x, y] = rows;
        for row in [&mut *x, &mut *y] {
            row.clear();
            row.resize(round.columns.len(), 0.0);
        }
        let mut add = |column: Option<usize>, change: Vec2| {
            if let Some(c) = column {
                x[c] += change.x;
                y[c] += change.y;
            }
        };
        add(round.second, perp(p.vector(joint.second.body, joint.second.local)));
        add(round.first, -perp(p.vector(joint.first.body, joint.first.local)));
        for step in &round.steps {
            let arms = &p.arms[step.branch];
            add(step.parent, step.sign * perp(arms.from));
            let mut out = arms.to;
            if let Some(s) = self.tree[step.branch].slide {
                out -= q[s] * arms.axis;
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
            if let Some(c) = round.first {
                x[c] -= axis.dot(&gap);
            }
        }
    }

    /// Jacobian of the residuals, rows by coordinates.
    pub fn jacobian(&self, p: &Positions, q: &[f64]) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.rows(), q.len());
        let mut rows = [Vec::new(), Vec::new()];
        let mut at = 0;
        for (place, &j) in self.cuts.iter().enumerate() {
            self.partials(p, q, place, &mut rows);
            let count = if self.joints[j].freedom == Freedom::Revolute { 2 } else { 1 };
            for row in &rows[..count] {
                for (&column, value) in self.loops[place].columns.iter().zip(row) {
                    out[(at, column)] = *value;
                }
                at += 1;
            }
        }
        out
    }
}
