//! What causes the reactions of joints in a state, and the polynomials of their terms there.
//!
//! In: the reduced model, sigma, the sizes of the applied loads. Out: the terms of a group of joints on the present
//! panels. It must not know the numbers in which they are read.
use crate::mechanism::linkage::Freedom;
use crate::mechanism::outputs::cache::{GroupReactions, GroupRows, MOST_TERMS, PARTS, PresentLoads};
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
        let reduced = self.reduced;
        let springs = reduced.active_springs().iter().map(|&spring| reduced.loading().springs[spring].load);
        let sum = reduced.sums_springs().then(|| reduced.reaction_terms() - 1);
        [0, 1].into_iter().chain(self.decided().iter().copied().chain(springs).map(|load| 2 + load)).chain(sum)
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

    /// Find the applied loads that act under the present sizes, unless they are known.
    #[inline]
    pub fn find_acting(&self, loads: &mut PresentLoads) {
        let PresentLoads { sizes, acting, knows_acting, .. } = loads;
        if !std::mem::replace(knows_acting, true) {
            let acts = |load: &usize| sizes[*load] != 0.0 && !self.decided().contains(load);
            acting.clear();
            acting.extend((0..self.reduced.components().sized).filter(acts));
        }
    }

    /// Take the polynomials of a group of joints at sigma for all but the loads that the state sizes, under the present
    /// sizes of the applied loads.
    #[cold]
    #[inline(never)]
    pub fn enter_given(&self, loads: &mut PresentLoads, group: usize) {
        let PresentLoads { sizes, acting, reactions, .. } = loads;
        let reactions = &mut reactions[group];
        reactions.has_applied = true;
        if reactions.kept.is_empty() || reactions.kept != *acting || !reactions.given.holds(self.sigma) {
            self.enter_panel(reactions, (acting, sizes), group);
        }
    }

    /// [`Self::enter_given`] from the tables.
    fn enter_panel(&self, reactions: &mut GroupReactions, (acting, sizes): (&[usize], &[f64]), group: usize) {
        let Self { reduced, sigma, .. } = *self;
        let joints = joints_of(reduced, group);
        let tables = self.tables(group, |joint| reduced.reaction(joint, sigma));
        let most = joints.clone().map(|joint| parts_of(reduced, joint)).max().unwrap_or(1);
        let (lengths, columns) = (self.lengths(group), reduced.reaction_terms());
        let GroupReactions { parts, given, kept, .. } = reactions;
        *parts = most;
        if !given.holds(sigma) {
            given.enter(&tables[..joints.len()], sigma);
        }
        let GroupRows { panels, rows, .. } = given;
        let functions = |part: usize, column: usize| -> [&Series; ROW] {
            std::array::from_fn(|k| match tables[k] {
                Some(PanelTable { table, .. }) if part < lengths[k] => table.series(panels[k], part * columns + column),
                _ => ZERO,
            })
        };
        let (own, summed) = if acting.len() <= MOST_TERMS { (acting, &[][..]) } else { (&[][..], acting) };
        let (terms, most_own) = (self.given_columns(), MOST_TERMS.min(reduced.components().sized));
        let first = most * terms.clone().count();
        kept.clear();
        kept.reserve_exact(most_own);
        kept.extend_from_slice(own);
        rows.reserve_exact((first + most * most_own).saturating_sub(rows.len()));
        rows.resize(first + most * own.len(), Row::ZERO);
        let terms = terms.chain(own.iter().map(|load| 2 + load));
        for (column, rows) in terms.zip(rows.chunks_exact_mut(most)) {
            rows.iter_mut().enumerate().for_each(|(part, row)| row.set(functions(part, column)));
        }
        if !summed.is_empty() {
            rows.resize(first + most, Row::ZERO);
        }
        for load in summed {
            let sums = rows[first..].iter_mut().enumerate();
            sums.for_each(|(part, sum)| sum.add(sizes[*load], &Row::of(functions(part, 2 + load))));
        }
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
        state.rows.clear();
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
