//! Where a linkage is not analytic: at the knots of the laws of couplings, and of the curves of slots.
//!
//! In: coordinates. Out: the argument of a law or a curve, and its distance from the next knot. It must not know the
//! curve of positions.
use super::structure::Linkage;

/// What may have knots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Knotted {
    /// The law of a coupling over u1 [rad], by its index.
    Coupling(usize),
    /// The curve of a slot over the position along it, in sizes of the linkage, by its index.
    Slot(usize),
}

impl Linkage {
    /// What may have knots.
    pub fn knotted(&self) -> impl Iterator<Item = Knotted> + use<> {
        let couplings = (0..self.couplings.len()).map(Knotted::Coupling);
        couplings.chain((0..self.slots.len()).map(Knotted::Slot))
    }

    /// Whether there are knots.
    pub fn has_knots(&self) -> bool {
        self.couplings.iter().any(|coupling| coupling.law.has_knots())
            || self.slots.iter().any(|slot| !slot.track.knots().is_empty())
    }

    /// The argument at the coordinates q, and its change for this change of the coordinates.
    pub fn argument(&self, of: Knotted, q: &[f64], change: &[f64]) -> [f64; 2] {
        match of {
            Knotted::Coupling(index) => self.first_motion(&self.couplings[index], q, change),
            Knotted::Slot(index) => {
                let own = self.slots[index].coordinate;
                [q[own] / self.size, change[own] / self.size]
            }
        }
    }

    /// Distance from an argument to the next knot beyond `close`, in the direction of growing arguments or against it;
    /// infinite if there is none.
    pub fn next_knot(&self, of: Knotted, argument: f64, ascending: bool, close: f64) -> f64 {
        match of {
            Knotted::Coupling(index) => self.couplings[index].law.next_knot(argument, ascending, close),
            Knotted::Slot(index) => {
                let (size, track) = (self.size, &self.slots[index].track);
                track.next_knot(argument * size, ascending, close * size) / size
            }
        }
    }
}
