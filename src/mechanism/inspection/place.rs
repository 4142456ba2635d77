//! Positions of a travel in words: coordinates, and the joints that are in line.
//!
//! In: a reduced model, values of sigma. Out: text. It must not know what is told about the positions.
use super::bends::{in_line, in_line_with_ends};
use crate::mechanism::reduced::Reduced;

/// The words for the positions of a travel.
#[derive(Clone, Copy)]
pub struct Places<'a> {
    reduced: &'a Reduced,
    /// The coordinate whose value alone names a position, if there is one.
    pub steady: Option<usize>,
}

impl<'a> Places<'a> {
    /// The words, with a coordinate that stands still nowhere in the travel.
    pub fn new(reduced: &'a Reduced, steady: Option<usize>) -> Self {
        Self { reduced, steady }
    }

    /// Position at sigma by name and in words: one coordinate that stands still nowhere, or several.
    pub fn describe(&self, sigma: f64) -> String {
        let (on_curve, revolutions) = self.reduced.unwound(sigma);
        let curve = self.reduced.at(on_curve).curve();
        let all = curve.describe(on_curve, revolutions);
        let steady = self.steady.and_then(|steady| all.split(", ").nth(steady).map(str::to_owned));
        steady.unwrap_or(all)
    }

    /// Which joints are in line at sigma: of two links, or with the ends of a drive; none if there are none.
    pub fn in_line(&self, sigma: f64, drive: Option<usize>) -> Option<String> {
        let (on_curve, _) = self.reduced.unwound(sigma);
        let (linkage, c) = (self.reduced.linkage(), self.reduced.at(on_curve).curve().configuration(on_curve));
        let drives = &self.reduced.loading().drives;
        let of_drive = drive.and_then(|drive| {
            let joint = in_line_with_ends(linkage, &self.reduced.loading().loads[drive], &c.positions)?;
            Some(format!("{joint} and both ends of {}", drives[drive].name))
        });
        of_drive.or_else(|| in_line(linkage, &c.positions))
    }
}
