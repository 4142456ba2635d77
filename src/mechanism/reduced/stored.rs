//! Kept tables: the curve and the tables of a definition as sections of a file, taken instead of being made again.
//!
//! In: a reduced model; or the sections and the same definition. Out: the sections; or curve and tables, to the bit. A
//! section that is absent, or that is not of the definition's shape, is made anew. It must not know where files are.
use super::Reduced;
use super::resolved::Resolved;
use crate::codec::record::{Damaged, Record};
use crate::codec::sections::Sections;
use crate::codec::writer::Writer;
use crate::mechanism::closure::Closure;
use crate::mechanism::curve::Curve;
use crate::mechanism::definition::{Mechanism, Solver};
use crate::numerics::table::{Table, Unresolved};
use std::sync::Arc;

/// What a reduced model is of.
#[derive(Clone, Copy)]
pub(super) enum Origin<'a> {
    /// The curve through the guess.
    Guess(&'a Solver),
    /// The curve through the guess, with kept tables.
    Stored(&'a Solver, &'a Stored),
    /// A further stretch of the curve of a reduced model, with its number.
    Whole(&'a Reduced, i32),
}

/// Names of sections: the curve with the borders of the grid and the independent loop equations, the tables that every
/// start needs, those of points and of bodies. Those of single displacements have names with their indices, those of
/// reactions with the index of their panel, those of state loads with what they depend on.
const CURVE: &str = "curve";
pub(super) const START: &str = "start";
pub(super) const MARKERS: &str = "markers";
pub(super) const ORIGINS: &str = "origins";

/// Most bytes of all sections together. Sections beyond it are left out.
const MOST: usize = 16 << 20;

/// A table, or why there is none.
pub(super) type Tabulated = Result<Table, Unresolved>;

/// Name of the section with the tables of the reactions to applied loads on a panel.
pub(super) fn reactions(panel: usize) -> String {
    format!("reactions {panel}")
}

/// Name of the section with the tables of the reactions to loads sized by a state on a panel.
pub(super) fn state_reactions(panel: usize) -> String {
    format!("state reactions {panel}")
}

/// Name of the section with the table of a load's displacement.
pub(super) fn displacement(load: usize) -> String {
    format!("displacement {load}")
}

/// The tables of one definition in a file.
#[derive(Clone, Debug)]
pub(super) struct Stored {
    sections: Arc<Sections>,
    /// Borders of the grid of the tables that every start needs.
    pub(super) borders: Arc<[f64]>,
}

impl Stored {
    /// Tables of sets of functions with these natural sizes; None if there are none.
    pub(super) fn tables(&self, name: &str, sizes: &[Vec<f64>]) -> Option<Vec<Tabulated>> {
        let bytes = self.sections.read(name)?;
        let mut record = Record::Read(&bytes);
        record.length("tables", sizes.len()).ok()?;
        sizes.iter().map(|sizes| table(&mut record, sizes.len()).ok()).collect()
    }
}

/// Read a table of so many components, or why there is none.
fn table(record: &mut Record, components: usize) -> Result<Tabulated, Damaged> {
    let mut is_resolved = true;
    record.flag("resolved", &mut is_resolved)?;
    if !is_resolved {
        let mut at = Unresolved { sigma: 0.0, component: 0 };
        unresolved(record, &mut at, components)?;
        return Ok(Err(at));
    }
    let (mut borders, mut coefficients, mut gaps): (Vec<[f64; 1]>, _, Vec<usize>) = Default::default();
    record.arrays("borders", &mut borders)?;
    record.arrays("coefficients", &mut coefficients)?;
    let mut count = 0;
    record.size("gaps", &mut count, size_of::<u64>())?;
    gaps.resize(count, 0);
    gaps.iter_mut().try_for_each(|gap| record.place("gap", gap, borders.len()))?;
    let table = Table::of_parts(borders.into_flattened(), components, coefficients, gaps);
    table.map(Ok).ok_or_else(|| {
        Damaged::new(format!(
            "a saved table does not have {components} components, as this \
        mechanism needs"
        ))
    })
}

fn unresolved(record: &mut Record, at: &mut Unresolved, components: usize) -> Result<(), Damaged> {
    record.finite("sigma", &mut at.sigma)?;
    record.place("component", &mut at.component, components)
}

/// The bytes of a section with these tables.
fn section<'a>(tables: impl ExactSizeIterator<Item = Result<&'a Table, &'a Unresolved>>) -> Result<Vec<u8>, Damaged> {
    let mut writer = Writer::default();
    let mut record = Record::Write(&mut writer);
    record.length("tables", tables.len())?;
    for table in tables {
        record.flag("resolved", &mut table.is_ok())?;
        match table {
            Ok(table) => {
                let (borders, coefficients, gaps) = table.parts();
                record.arrays("borders", &mut borders.iter().map(|border| [*border]).collect())?;
                record.arrays("coefficients", &mut coefficients.to_vec())?;
                record.size("gaps", &mut gaps.len(), 1)?;
                gaps.iter().try_for_each(|gap| record.place("gap", &mut gap.clone(), borders.len()))?;
            }
            Err(at) => unresolved(&mut record, &mut at.clone(), usize::MAX)?,
        }
    }
    Ok(writer.finish())
}

impl Reduced {
    /// The reduced model with the curve and the tables in these sections, which were written for this definition: equal
    /// to [`Self::new`] to the bit. None if the sections have no such curve.
    pub fn stored(mechanism: &Mechanism, sections: &Arc<Sections>) -> Option<Self> {
        let Resolved { linkage, loading, markers } = Resolved::new(mechanism).ok()?;
        let bytes = sections.read(CURVE)?;
        let mut record = Record::Read(&bytes);
        let mut borders: Vec<[f64; 1]> = Vec::new();
        record.arrays("borders", &mut borders).ok()?;
        if borders.len() < 2 || borders.windows(2).any(|pair| pair[0] >= pair[1]) {
            return None;
        }
        let mut rows = vec![0; linkage.coordinates.len().checked_sub(1)?];
        rows.iter_mut().try_for_each(|row| record.place("loop equation", row, linkage.rows())).ok()?;
        let closure = Closure::of_rows(Arc::new(linkage), rows)?;
        let curve = Arc::new(Curve::read(closure, &mut record).ok()?);
        let stored = Stored { sections: Arc::clone(sections), borders: borders.into_flattened().into() };
        let of = Origin::Stored(&mechanism.solver, &stored);
        Self::tabulated(curve, Arc::new(loading), markers, of).ok()
    }

    /// Sections for [`Self::stored`], with every table, made if need be. None for a model of which the curve has no
    /// record, or only a part of the curve counts.
    pub fn sections(&self) -> Vec<(String, Vec<u8>)> {
        let mut all = Sink::default();
        let mut curve = Writer::default();
        let borders = super::characteristics::grid(self.curve(), self.loading());
        let mut record = Record::Write(&mut curve);
        let borders = record.arrays("borders", &mut borders.into_iter().map(|b| [b]).collect());
        let mut rows = self.curve().closure.rows().iter();
        let rows = rows.try_for_each(|row| record.place("loop equation", &mut row.clone(), usize::MAX));
        let written = borders.and(rows).and_then(|()| self.curve().write(&mut curve));
        if self.is_part() || self.stretch != 0 || written.is_err() {
            return Vec::new();
        }
        all.add(CURVE, Ok(curve.finish()));
        let own = &self.tables;
        let needed = self.needed();
        let displacements = needed.iter().map(|&load| self.displacement(load));
        let first = [Ok(&own.influence), own.coordinates.as_ref()];
        let weights = own.weights.iter().map(Result::as_ref);
        all.add(START, section(first.into_iter().chain(displacements).chain(weights).collect::<Vec<_>>().into_iter()));
        self.add_state_loads(&mut all);
        for (name, tables) in self.reaction_tables() {
            all.add(&name, section(tables.iter().map(Result::as_ref)));
        }
        let is_other = |load: &usize| !needed.contains(load) && self.loading().gravity != Some(*load);
        let others = (0..self.loading().loads.len()).filter(is_other);
        others.for_each(|load| all.add(&displacement(load), section([self.displacement(load)].into_iter())));
        all.add(MARKERS, section((0..self.markers.len()).map(|marker| self.marker(marker))));
        all.add(ORIGINS, section((0..self.linkage().bodies.len()).map(|body| self.origin(body))));
        all.sections
    }

    /// Sections of the state loads alone, for a model with the tables of another one.
    pub fn state_load_sections(&self) -> Vec<(String, Vec<u8>)> {
        let mut all = Sink::default();
        self.add_state_loads(&mut all);
        all.sections
    }

    fn add_state_loads(&self, all: &mut Sink) {
        for air in [false, true] {
            if let Ok(Some(loads)) = self.state_loads(air) {
                all.add(&loads.section, section([Ok(&*loads.table)].into_iter()));
            }
        }
    }
}

/// Sections within [`MOST`] bytes.
#[derive(Default)]
struct Sink {
    sections: Vec<(String, Vec<u8>)>,
    size: usize,
}

impl Sink {
    /// Keep a section, unless it has no record, or is there or too large.
    fn add(&mut self, name: &str, bytes: Result<Vec<u8>, Damaged>) {
        let Ok(bytes) = bytes else { return };
        if self.size + bytes.len() <= MOST && self.sections.iter().all(|(other, _)| other != name) {
            self.size += bytes.len();
            self.sections.push((name.to_owned(), bytes));
        }
    }
}
