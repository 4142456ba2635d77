//! What causes the reactions of joints in a state, and the polynomials of their terms there.
//!
//! In: the reduced model, sigma, the sizes of the applied loads. Out: the terms of a group of joints on the present
//! panels. It must not know the numbers in which they are read.
use crate::mechanism::linkage::Freedom;
use crate::mechanism::outputs::cache::{GroupReactions, PARTS, PresentLoads};
use crate::mechanism::reduced::{PanelTable, Reduced, StateLoads};
use crate::numerics::bundle::{ROW, Row};
use crate::numerics::chebyshev::{NODES, Series};
use crate::numerics::table::Unresolved;
use std::ops::Range;

/// A function that vanishes.
const ZERO: &Series = &[0.0; NODES];

/// Number of parts of a joint's reaction that may be other than 0.
pub fn parts_of(reduced: &Reduced, joint: usize) -> usize {
    if reduced.linkage().joints[joint].freedom == Freedom::Revolute { PARTS - 1 } else { PARTS }
}

/// The joints of a group.
pub fn joints_of(reduced: &Reduced, group: usize) -> Range<usize> {
    ROW * group..reduced.linkage().joints.len().min(ROW * (group + 1))
}

/// What causes reactions in a state.
pub struct Causes<'a> {
    pub reduced: &'a Reduced,
    pub sigma: f64,
    /// The loads that the state sizes.
    pub state_loads: Option<&'a StateLoads>,
}

impl<'a> Causes<'a> {
    /// The loads whose delivered force the state decides: drives with an efficiency or a circuit.
    pub fn decided(&self) -> &'a [usize] {
        self.state_loads.map_or(&[], |s| &s.drives)
    }

    /// Columns of a joint's reactions for [`Shares::given`](super::cache::Shares::given).
    pub fn given_columns(&self) -> impl Iterator<Item = usize> + Clone + use<'a> {
        let springs = self.reduced.loading().springs.iter().map(|spring| spring.load);
        [0, 1].into_iter().chain(self.decided().iter().copied().chain(springs).map(|load| 2 + load))
    }

    /// Columns of a joint's reactions for [`Shares::state`](super::cache::Shares::state).
    pub fn state_columns(&self) -> impl Iterator<Item = usize> + Clone + use<'a> {
        self.state_loads.map_or(&[][..], |s| &s.loads).iter().map(|load| 2 + load)
    }

    /// The tables at sigma of the joints of a group, as `of` a joint gives them.
    fn tables(
        &self,
        group: usize,
        of: impl Fn(usize) -> Result<PanelTable<'a>, &'a Unresolved>,
    ) -> [Option<PanelTable<'a>>; ROW] {
        let joints = joints_of(self.reduced, group);
        std::array::from_fn(|k| joints.clone().nth(k).and_then(|joint| of(joint).ok()))
    }

    /// Number of parts of the reaction of each joint of a group.
    fn lengths(&self, group: usize) -> [usize; ROW] {
        let joints = joints_of(self.reduced, group);
        std::array::from_fn(|k| joints.clone().nth(k).map_or(0, |joint| parts_of(self.reduced, joint)))
    }

    /// Take the polynomials of a group of joints at sigma for all but the loads that the state sizes, under the present
    /// sizes of the applied loads.
    #[cold]
    #[inline(never)]
    pub fn enter_given(&self, loads: &mut PresentLoads, group: usize) {
        let Self { reduced, sigma, .. } = *self;
        let joints = joints_of(reduced, group);
        let tables = self.tables(group, |joint| reduced.reaction(joint, sigma));
        let most = joints.clone().map(|joint| parts_of(reduced, joint)).max().unwrap_or(0);
        let lengths = self.lengths(group);
        let (decided, others, columns) = (self.decided(), self.given_columns(), 2 + reduced.loading().base());
        let PresentLoads { sizes, reactions, .. } = loads;
        let GroupReactions { parts, given, has_applied, .. } = &mut reactions[group];
        let series = |panels: &[usize; ROW], k: usize, part: usize, column: usize| match tables[k] {
            Some(PanelTable { table, .. }) if part < lengths[k] => table.series(panels[k], part * columns + column),
            _ => ZERO,
        };
        *parts = most;
        if !given.holds(sigma) {
            given.enter(&tables[..joints.len()], sigma);
            given.rows.resize(most, Row::ZERO);
            for column in others {
                let row = |part| Row::of(std::array::from_fn(|k| series(&given.panels, k, part, column)));
                given.rows.extend((0..most).map(row));
            }
        }
        let sized = sizes[..reduced.components().sized].iter().enumerate();
        let acting = sized.filter(|(load, size)| **size != 0.0 && !decided.contains(load));
        let (rows, panels) = (&mut given.rows, &given.panels);
        for (part, row) in rows[..most].iter_mut().enumerate() {
            let mut applied = [[0.0; NODES]; ROW];
            for (load, size) in acting.clone() {
                for (k, sums) in applied.iter_mut().enumerate() {
                    let series = series(panels, k, part, 2 + load);
                    sums.iter_mut().zip(series).for_each(|(sum, c)| *sum += size * c);
                }
            }
            *row = Row::of(applied.each_ref());
        }
        *has_applied = true;
    }

    /// Take the polynomials of a group of joints at sigma for the loads that the state sizes: their tables, made when
    /// one of these loads acts, are tables of their own.
    #[cold]
    #[inline(never)]
    pub fn enter_state(&self, loads: &mut PresentLoads, group: usize, air: bool) {
        let Self { reduced, sigma, .. } = *self;
        let joints = joints_of(reduced, group);
        let tables = self.tables(group, |joint| reduced.state_reaction(joint, sigma));
        let lengths = self.lengths(group);
        let (base, own) = (reduced.loading().base(), self.state_columns());
        let (columns, first) = (reduced.loading().loads.len() - base, 2 + base);
        let GroupReactions { parts, state, air: of_air, .. } = &mut loads.reactions[group];
        state.enter(&tables[..joints.len()], sigma);
        for column in own {
            for part in 0..*parts {
                let series = |k: usize| match tables[k] {
                    Some(PanelTable { table, .. }) if part < lengths[k] => {
                        table.series(state.panels[k], part * columns + column - first)
                    }
                    _ => ZERO,
                };
                state.rows.push(Row::of(std::array::from_fn(series)));
            }
        }
        *of_air = air;
    }
}
