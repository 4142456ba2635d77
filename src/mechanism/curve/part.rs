//! A part of a curve.
//!
//! In: a traced curve, two values of sigma. Out: the curve between them. It must not know why it ends there.
use super::evaluate::{Curve, Ends};
use super::panel::Panel;

impl Curve {
    /// First and last sigma of each panel within the range.
    pub fn intervals(&self) -> impl Iterator<Item = [f64; 2]> {
        let (first, last) = self.range;
        let within = self.panels.iter().filter(move |panel| panel.start < last && panel.end() > first);
        within.map(move |panel| [panel.start.max(first), panel.end().min(last)])
    }

    /// The curve between two values of sigma within its range; on a closed curve within one revolution on each side of
    /// the guess. It ends where it is cut.
    pub fn between(&self, range: (f64, f64)) -> Self {
        let (first, last) = range;
        let ends = match self.ends {
            Ends::Closed(_) => Ends::Stopped { low: true, high: true },
            _ => Ends::Stopped {
                low: first > self.range.0 || !self.is_open(0),
                high: last < self.range.1 || !self.is_open(1),
            },
        };
        let mut panels = self.panels.clone();
        let mut crossings = self.crossings.clone();
        if let Ends::Closed(growth) = &self.ends {
            let period = self.range.1 - self.range.0;
            let back: Vec<f64> = growth.iter().map(|growth| -growth).collect();
            let before = |panel: &Panel| {
                let mut panel = panel.clone();
                panel.start -= period;
                panel.shift(&back);
                panel
            };
            panels = self.panels.iter().map(before).chain(panels).collect();
            crossings = self.crossings.iter().map(|sigma| sigma - period).chain(crossings).collect();
        }
        panels.retain(|panel| panel.start < last && panel.end() > first);
        crossings.retain(|sigma| first < *sigma && *sigma < last);
        Self { panels, crossings, range, ends, ..self.clone() }
    }
}
