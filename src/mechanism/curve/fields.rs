//! A traced curve as a record, to be taken instead of tracing it again.
//!
//! In: a curve; or a record and the loop equations of the same linkage. Out: the record; or the curve. It must not know
//! where records are kept.
use super::evaluate::{Curve, Ends};
use super::misses::Near;
use super::panel::Panel;
use crate::codec::record::{Damaged, Record};
use crate::codec::writer::Writer;
use crate::mechanism::closure::Closure;
use crate::numerics::chebyshev::Transform;

/// Kinds of ends in a record: closed, open, stopped at the high end, at the low end, at both.
const KINDS: usize = 5;

impl Curve {
    /// Write the curve, if a record can hold it: not one of which the points were moved, or the start decides the
    /// range, or with near misses, which are told in words.
    pub fn write(&self, out: &mut Writer) -> Result<(), Damaged> {
        if self.near != Near::default() || self.by_start {
            return Err(Damaged::new("branches almost cross on the curve, or its guess is beyond a stop"));
        }
        self.clone().fields(&mut Record::Write(out))
    }

    /// Read a curve of these loop equations.
    ///
    /// # Errors
    /// The record is not one of such a curve.
    pub fn read(closure: Closure, record: &mut Record) -> Result<Self, Damaged> {
        let mut curve = Self {
            guess: vec![0.0; closure.weights.len()],
            closure,
            transform: Transform::default(),
            panels: Vec::new(),
            farthest: 0.0,
            range: (0.0, 0.0),
            ends: Ends::Open,
            crossings: Vec::new(),
            near: Near::default(),
            by_start: false,
            closed: 0,
        };
        curve.fields(record)?;
        let follows = |pair: &[Panel]| pair[0].start < pair[1].start;
        match curve.range.0 < curve.range.1 && !curve.panels.is_empty() && curve.panels.windows(2).all(follows) {
            true => Ok(curve),
            false => Err(Damaged::new("the saved sections of the motion are not in order")),
        }
    }

    fn fields(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let n = self.guess.len();
        record.length("coordinates", n)?;
        record.all_finite("guess", &mut self.guess)?;
        let mut count = self.panels.len();
        record.size("panels", &mut count, size_of::<f64>())?;
        self.panels.resize_with(count, Panel::blank);
        self.panels.iter_mut().try_for_each(|panel| panel.fields(record, n))?;
        record.positive("farthest", &mut self.farthest)?;
        record.finite("first sigma", &mut self.range.0)?;
        record.finite("last sigma", &mut self.range.1)?;
        let (mut kind, mut growth) = match &self.ends {
            Ends::Closed(growth) => (0, growth.clone()),
            Ends::Open => (1, Vec::new()),
            Ends::Stopped { low, high } => (1 + u8::from(*high) + 2 * u8::from(*low), Vec::new()),
        };
        record.choice("ends", &mut kind, KINDS)?;
        if kind == 0 {
            growth.resize(n, 0.0);
            record.all_finite("growth", &mut growth)?;
        }
        self.ends = match kind {
            0 => Ends::Closed(growth),
            1 => Ends::Open,
            kind => Ends::Stopped { low: (kind - 1) & 2 != 0, high: (kind - 1) & 1 != 0 },
        };
        let mut crossings: Vec<[f64; 1]> = self.crossings.iter().map(|sigma| [*sigma]).collect();
        record.arrays("crossings", &mut crossings)?;
        self.crossings = crossings.into_flattened();
        let mut closed = self.closed as u64;
        record.count("positions closed", &mut closed)?;
        self.closed = closed as usize;
        Ok(())
    }
}
