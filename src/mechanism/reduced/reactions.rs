//! Tables of the joints' reactions, each on one panel of a grid, made when a reaction is first read there.
//!
//! In: the reduced model. Out: reactions to each load of unit size. They are the dearest tables: an end of a run needs
//! one panel, a motion those that it passes. A table depends on its panel alone, so that it does not count where a
//! reaction was read before. It must not know states or inputs.
use super::Reduced;
use super::stored::{self, Tabulated};
use crate::mechanism::reactions::{Columns, Reaction};
use crate::numerics::table::{Grid, Table, Unresolved};
use std::ops::Range;
use std::sync::OnceLock;

/// Tables of the reactions of all joints to some terms, panel by panel of a grid.
#[derive(Clone, Debug)]
pub(super) struct ReactionTables(Vec<OnceLock<Vec<Tabulated>>>);

impl ReactionTables {
    /// None made yet, on this grid.
    pub(super) fn on(grid: &Grid) -> Self {
        Self(grid.borders[1..].iter().map(|_| OnceLock::new()).collect())
    }

    /// None made yet, on as many panels.
    pub(super) fn unmade(&self) -> Self {
        Self(self.0.iter().map(|_| OnceLock::new()).collect())
    }

    /// Whether there is one.
    pub(super) fn any(&self) -> bool {
        self.0.iter().any(|tables| tables.get().is_some())
    }
}

/// A table on one panel of a grid.
#[derive(Clone, Copy, Debug)]
pub struct PanelTable<'a> {
    /// The table, which may have several panels itself.
    pub table: &'a Table,
    /// Whether its polynomials continue before it and after it, as nothing else does.
    pub continues: [bool; 2],
}

/// Terms of reactions, with their tables.
struct Terms<'a> {
    tables: &'a ReactionTables,
    grid: &'a Grid,
    /// Name of the section in which the tables of a panel may be kept.
    section: fn(usize) -> String,
    loads: Range<usize>,
    /// Number of terms left out of sigma_ddot = 1, sigma_dot^2 = 1, then each load = 1.
    skipped: usize,
    /// Whether the sum of springs is the last term.
    sums_springs: bool,
}

impl Reduced {
    /// Springs that cause reactions one by one, as their forces are no functions of the position.
    pub fn active_springs(&self) -> &[usize] {
        &self.source.active_springs
    }

    /// Springs whose reactions are summed up in a term, the last one of [`Self::reaction`], of size 1.
    pub fn passive_springs(&self) -> impl Iterator<Item = usize> + '_ {
        self.source.passive_springs()
    }

    /// Whether [`Self::reaction`] has the sum of springs as its last term.
    pub fn sums_springs(&self) -> bool {
        self.source.active_springs.len() < self.loading().springs.len()
    }

    /// Number of terms of [`Self::reaction`].
    pub fn reaction_terms(&self) -> usize {
        2 + self.loading().base() + usize::from(self.sums_springs())
    }

    /// A joint's reaction around sigma: force x, force y, moment; each for sigma_ddot, sigma_dot^2, each applied load,
    /// each spring = 1, then for all springs together whose force is a function of the position.
    ///
    /// # Errors
    /// [`Unresolved`] on this panel.
    #[inline]
    pub fn reaction(&self, joint: usize, sigma: f64) -> Result<PanelTable<'_>, &Unresolved> {
        self.around(&self.terms(), joint, sigma)
    }

    /// A joint's reaction around sigma to the loads sized by a state: force x, force y, moment; each for each of these
    /// loads = 1.
    ///
    /// # Errors
    /// [`Unresolved`] on this panel.
    pub fn state_reaction(&self, joint: usize, sigma: f64) -> Result<PanelTable<'_>, &Unresolved> {
        self.around(&self.state_terms(), joint, sigma)
    }

    /// The tables of the reactions of all joints, made if need be, with the names of their sections: those of
    /// [`Self::reaction`], then those of [`Self::state_reaction`], panel by panel.
    pub fn reaction_tables(&self) -> Vec<(String, &[Tabulated])> {
        let mut all = Vec::new();
        for terms in [self.terms(), self.state_terms()] {
            all.extend((0..terms.tables.0.len()).map(|panel| ((terms.section)(panel), self.on_panel(&terms, panel))));
        }
        all
    }

    /// First and last sigma of the panels on which a joint has no table.
    pub fn untabled(&self) -> Vec<[f64; 2]> {
        let mut all = Vec::new();
        for terms in [self.terms(), self.state_terms()] {
            let has_all = |panel: usize| self.on_panel(&terms, panel).iter().all(Result::is_ok);
            let panels = (0..terms.tables.0.len()).filter(|&panel| !has_all(panel));
            all.extend(panels.map(|panel| [terms.grid.borders[panel], terms.grid.borders[panel + 1]]));
        }
        all
    }

    fn terms(&self) -> Terms<'_> {
        let (tables, loads) = (&self.tables.reactions, 0..self.loading().base());
        Terms {
            tables,
            grid: &self.fine,
            section: stored::reactions,
            loads,
            skipped: 0,
            sums_springs: self.sums_springs(),
        }
    }

    fn state_terms(&self) -> Terms<'_> {
        let (tables, loads) = (&self.tables.state_reactions, self.loading().base()..self.loading().loads.len());
        Terms { tables, grid: &self.grid, section: stored::state_reactions, loads, skipped: 2, sums_springs: false }
    }

    #[inline]
    fn around<'a>(&'a self, terms: &Terms<'a>, joint: usize, sigma: f64) -> Result<PanelTable<'a>, &'a Unresolved> {
        let last = terms.tables.0.len() - 1;
        let panel = terms.grid.borders[1..=last].partition_point(|border| *border <= sigma);
        let continues = [panel == 0, panel == last].map(|is_end| is_end && !self.is_stretch());
        Ok(PanelTable { table: self.on_panel(terms, panel)[joint].as_ref()?, continues })
    }

    /// The tables of all joints on a panel of the grid.
    #[inline]
    fn on_panel<'a>(&'a self, terms: &Terms<'a>, panel: usize) -> &'a [Tabulated] {
        terms.tables.0[panel].get_or_init(|| self.tabulate_panel(terms, panel))
    }

    #[cold]
    fn tabulate_panel(&self, terms: &Terms, panel: usize) -> Vec<Tabulated> {
        let Terms { grid, section, loads, skipped, sums_springs, .. } = terms;
        let grid = Grid { borders: grid.borders[panel..panel + 2].to_vec(), ..Grid::clone(grid) };
        let joints = self.linkage().joints.len();
        let sizes = self.reaction_sizes(terms);
        let (count, loads) = (sizes.len() / 3, &self.loading().loads[loads.clone()]);
        let single = count - usize::from(*sums_springs);
        let passive: Vec<usize> = self.passive_springs().filter(|_| *sums_springs).collect();
        let (mut columns, mut springs) = (Columns::default(), Vec::new());
        let mut all = vec![sizes; joints];
        for coupling in &self.linkage().couplings {
            // The third component is a force, too.
            let sizes = &mut all[coupling.joint];
            sizes.copy_within(..count, 2 * count);
        }
        self.source.tabulate(Some(&section(panel)), &grid, &all, &mut |c, values| {
            let reactions = columns.fill(&self.curve().closure, c, loads, *skipped);
            if *sums_springs {
                self.source.spring_loads(c, &mut springs);
            }
            for (joint, v) in values.chunks_exact_mut((3 * count).max(1)).enumerate() {
                let mut set = |k: usize, Reaction { force, moment }: Reaction| {
                    (v[k], v[count + k], v[2 * count + k]) = (force.x, force.y, moment);
                };
                (0..single).for_each(|k| set(k, reactions[k * joints + joint]));
                if *sums_springs {
                    let mut sum = Reaction::default();
                    for spring in passive.iter().map(|&spring| &springs[spring]) {
                        let unit = reactions[(2 + spring.load) * joints + joint];
                        sum.force += spring.at_rest * unit.force;
                        sum.moment += spring.at_rest * unit.moment;
                    }
                    set(single, sum);
                }
            }
        })
    }

    /// Natural sizes of the components of a joint's reactions: force x, force y, moment; each for all terms.
    fn reaction_sizes(&self, terms: &Terms) -> Vec<f64> {
        let size = self.linkage().size;
        let of_motion = [self.scale() / size, 1.0 / size];
        let of_loads = terms.loads.clone().map(|load| self.source.displacement_size(load) / size);
        let of_spring = |spring: usize| {
            let spring = &self.loading().springs[spring];
            let s = self.source.displacement_size(spring.load);
            spring.force_scale(s) * s / size
        };
        let of_springs = terms.sums_springs.then(|| self.passive_springs().map(of_spring).sum());
        let of_motion = of_motion.into_iter().skip(terms.skipped);
        let forces: Vec<f64> = of_motion.chain(of_loads).chain(of_springs).collect();
        let moments: Vec<f64> = forces.iter().map(|f| f * size).collect();
        [&forces[..], &forces, &moments].concat()
    }
}
