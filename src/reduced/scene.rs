//! The scene: what acts besides loads of a given size, in one table that the integration reads.
//!
//! In: the reduced model. Out: for the motion and for every joint with friction one row of effects. A mechanism without
//! dampers, efficiencies, bumpers, friction and moving air has no scene and pays for none. It must not know the state.
use super::Reduced;
use crate::curve::Configuration;
use crate::linkage::{Freedom, quarter};
use crate::loading::Pin;
use crate::reactions::{Reaction, columns};
use crate::table::{Table, Unresolved};

/// What a load of unit size has an effect on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// sigma_ddot: the effect is the influence.
    Motion,
    /// A part of the reaction that causes a pin's friction, while the load moves the linkage.
    Reaction {
        /// Place among the pins.
        pin: usize,
        /// Component of the force.
        part: Part,
    },
}

/// Component of a reaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// x of a revolute joint.
    X,
    /// y of a revolute joint.
    Y,
    /// Normal to the axis of a prismatic joint.
    Normal,
}

impl Part {
    /// Place in a vector; a normal is the first.
    pub fn axis(self) -> usize {
        usize::from(self == Self::Y)
    }
}

/// What acts besides loads of a given size.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Drives with an efficiency, by their loads.
    pub lossy: Vec<usize>,
    /// Whether the drag of the air acts.
    pub air: bool,
    /// Bumpers, by their stops.
    pub bumpers: Vec<usize>,
    /// Joints with friction.
    pub pins: Vec<Pin>,
    /// Loads beyond the given ones, in the order of their columns: those of surfaces, bumpers, pins.
    pub loads: Vec<usize>,
    /// Rows: the motion first, then those of the pins, one after the other.
    pub rows: Vec<Row>,
    /// Effects, row by row as [`Self::column`] says; then what the laws need.
    pub table: Table,
    /// Components of each row: one for sigma_dot^2, one for each of `loads`, then those of [`super::Components`].
    width: usize,
}

impl Scene {
    /// Number of components that [`Self::states`] has of each row.
    pub fn stride(&self) -> usize {
        1 + self.loads.len()
    }

    /// Components of a row that the state sizes: the effect of sigma_dot^2 (0 in the row of the motion), then those of
    /// `loads`.
    pub fn states(&self, row: usize) -> std::ops::Range<usize> {
        row * self.width..row * self.width + self.stride()
    }

    /// Component of the effect of `loads[k]` in a row.
    pub fn column(&self, row: usize, k: usize) -> usize {
        row * self.width + 1 + k
    }

    /// Component of the effect of [`super::Components`] number `k` in a row.
    pub fn given(&self, row: usize, k: usize) -> usize {
        row * self.width + self.stride() + k
    }

    /// First of the two components with the direction of a surface in the mechanism frame.
    pub fn line(&self, surface: usize) -> usize {
        self.rows.len() * self.width + 2 * surface
    }

    /// Component with the displacement of the load of `bumpers[k]`.
    pub fn pressed(&self, k: usize) -> usize {
        self.table.components() - self.bumpers.len() + k
    }

    /// Build the scene, if anything is in it.
    pub(super) fn build(reduced: &Reduced, air: bool) -> Result<Option<Self>, Unresolved> {
        let loading = &reduced.loading;
        let drives = loading.drives.iter().enumerate();
        let lossy: Vec<usize> = drives.filter(|(_, d)| d.efficiency.is_some()).map(|(i, _)| i).collect();
        let stops = loading.stops.iter().enumerate();
        let bumpers: Vec<usize> = stops.filter(|(_, s)| s.enabled && !s.rigid).map(|(i, _)| i).collect();
        let pins = match &loading.friction {
            Some(friction) if friction.enabled => friction.pins.clone(),
            _ => Vec::new(),
        };
        let surfaces = loading.air.as_ref().filter(|_| air).map_or(&[][..], |air| &air.surfaces);
        let damped = reduced.components.damping.is_some();
        if lossy.is_empty() && bumpers.is_empty() && pins.is_empty() && surfaces.is_empty() && !damped {
            return Ok(None);
        }
        let mut loads: Vec<usize> = surfaces.iter().flat_map(|s| s.load..s.load + 3).collect();
        loads.extend(bumpers.iter().map(|&b| loading.stops[b].load));
        loads.extend(pins.iter().map(|p| p.load));
        let mut rows = vec![Row::Motion];
        for (pin, p) in pins.iter().enumerate() {
            let parts: &[Part] = match reduced.linkage().joints[p.joint].freedom {
                Freedom::Turn => &[Part::X, Part::Y],
                Freedom::Slide(_) => &[Part::Normal],
            };
            rows.extend(parts.iter().map(|&part| Row::Reaction { pin, part }));
        }
        let (air, given) = (!surfaces.is_empty(), reduced.components.count);
        let width = 1 + given + loads.len();
        let lines = surfaces.len();
        let mut sizes = Vec::new();
        for row in &rows {
            sizes.extend(row_sizes(reduced, *row, &loads));
        }
        sizes.extend(vec![1.0; 2 * lines]);
        let natural =
            |b: &usize| reduced.natural.displacement(&loading.loads[loading.stops[*b].load], reduced.linkage());
        sizes.extend(bumpers.iter().map(natural));
        let mut scene = Self { lossy, air, bumpers, pins, loads, rows, table: Table::empty(), width };
        scene.table = Table::build(&reduced.grid, &sizes, &mut |sigma, values| {
            let c = reduced.curve.configuration(sigma);
            scene.fill(reduced, &c, values);
            c.amplification
        })?;
        Ok(Some(scene))
    }

    pub(super) fn fill(&self, reduced: &Reduced, c: &Configuration, values: &mut [f64]) {
        let (loading, linkage) = (&reduced.loading, reduced.linkage());
        let influence: Vec<f64> = loading.loads.iter().map(|l| l.influence(linkage, c)).collect();
        let columns =
            if self.pins.is_empty() { Vec::new() } else { columns(reduced.curve.closure(), c, &loading.loads) };
        for (row, out) in self.rows.iter().zip(values.chunks_exact_mut(self.width)) {
            let part = |column: usize| match *row {
                Row::Motion => 0.0,
                Row::Reaction { pin, part } => self.part(reduced, c, pin, part, &columns[column]),
            };
            // A reaction to a load: what balances it at rest, and what the motion that it causes needs.
            let effect = |load: usize| match row {
                Row::Motion => influence[load],
                Row::Reaction { .. } => part(2 + load) + part(0) * influence[load],
            };
            out[0] = part(1);
            let (rest, given) = out[1..].split_at_mut(self.loads.len());
            reduced.components.fill_effects(loading, &reduced.curve, c, &effect, given);
            for (value, &load) in rest.iter_mut().zip(&self.loads) {
                *value = effect(load);
            }
        }
        if let (true, Some(air)) = (self.air, &loading.air) {
            for (k, surface) in air.surfaces.iter().enumerate() {
                let line = surface.line.map(|l| c.positions.vector(surface.start.body, l)).unwrap_or_default();
                let first = self.line(k);
                (values[first], values[first + 1]) = (line.x, line.y);
            }
        }
        let first = values.len() - self.bumpers.len();
        for (value, &stop) in values[first..].iter_mut().zip(&self.bumpers) {
            *value = loading.loads[loading.stops[stop].load].displacement(linkage, c)[0];
        }
    }

    fn part(&self, reduced: &Reduced, c: &Configuration, pin: usize, part: Part, column: &[Reaction]) -> f64 {
        let joint = self.pins[pin].joint;
        let force = column[joint].force;
        match part {
            Part::X => force.x,
            Part::Y => force.y,
            Part::Normal => match reduced.linkage().joints[joint].freedom {
                Freedom::Slide(axis) => {
                    let first = reduced.linkage().joints[joint].first.body;
                    force.dot(&quarter(c.positions.vector(first, axis)))
                }
                Freedom::Turn => 0.0,
            },
        }
    }
}

/// Natural sizes of the components of one row.
fn row_sizes(reduced: &Reduced, row: Row, loads: &[usize]) -> Vec<f64> {
    let (loading, linkage, natural) = (&reduced.loading, reduced.linkage(), &reduced.natural);
    // A generalised force Q along sigma goes with forces of the size Q scale / size in the joints.
    let factor = match row {
        Row::Motion => 1.0,
        Row::Reaction { .. } => natural.scale / linkage.size,
    };
    let mut out = vec![if row == Row::Motion { 0.0 } else { 1.0 / linkage.size }];
    let size = |l: &usize| natural.displacement(&loading.loads[*l], linkage) / natural.scale * factor;
    out.extend(loads.iter().map(size));
    let given = reduced.components.sizes(loading, &reduced.curve, natural);
    out.extend(given.iter().map(|s| s * factor));
    out
}
