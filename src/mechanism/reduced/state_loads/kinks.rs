//! Kinks of the laws by which the state sizes loads: points of curves, surfaces that the air flows along.
//!
//! In: the loads of the state. Out: the values of quantities at which a step ends. It must not know states.
use super::StateLoads;
use crate::mechanism::loads::laws::spring::Characteristic;
use crate::mechanism::reduced::source::Source;
use crate::numerics::piecewise::Piecewise;

/// A kink of a law that sizes a load of the state: a point of a curve, where the third derivative of the force jumps,
/// or a surface that the air flows along, where the first derivative of its drag jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kink {
    /// Quantity on which the law depends.
    pub of: Argument,
    /// Value of the quantity at the kink [m/s, rad/s, m, rad or 1].
    pub value: f64,
    /// Distance from the value up to which a quantity is at it.
    pub near: f64,
}

/// Quantity on which the law of a load of the state depends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Argument {
    /// Speed of the drive with this index.
    Drive(usize),
    /// Depth of a bumper by its index in [`StateLoads::bumpers`], while it pushes.
    Depth(usize),
    /// Rate of a spring by its index in [`StateLoads::springs`].
    Rate(usize),
    /// Angle of a spring by its index in [`StateLoads::springs`], over all revolutions.
    Angle(usize),
    /// Component of the flow across a surface, over its speed, at a place on it.
    Facing {
        /// Index of the surface.
        surface: usize,
        /// Distance of the place from the start of the surface [m].
        place: f64,
    },
}

/// Part of the largest value of a curve's points up to which a quantity is at one of them.
const AT_KINK: f64 = 1e-11;

impl StateLoads {
    /// Kinks of the laws of drives, bumpers, springs and drag.
    pub(super) fn find_kinks(&mut self, source: &Source) {
        let loading = &source.loading;
        if let Some(air) = loading.air.as_ref().filter(|_| self.air) {
            for (surface, s) in air.surfaces.iter().enumerate().filter(|(_, s)| s.drag.directed) {
                // Along a strip that moves, where the flow is along the line passes from one end to the other.
                let ends = if air.relative_wind && s.drag.length > 0.0 { 2 } else { 1 };
                let kink = |place: f64| Kink { of: Argument::Facing { surface, place }, value: 0.0, near: AT_KINK };
                self.kinks.extend([0.0, s.drag.length].into_iter().take(ends).map(kink));
            }
        }
        let mut add = |of: Argument, curve: Option<&Piecewise>, first: usize| {
            let knots = curve.map_or(&[][..], Piecewise::knots);
            let near = AT_KINK * knots.iter().fold(0.0, |most: f64, knot| most.max(knot.abs()));
            self.kinks.extend(knots.iter().skip(first).map(|&value| Kink { of, value, near }));
        };
        for &drive in &self.curves {
            add(Argument::Drive(drive), loading.drives[drive].curve.as_ref().map(|curve| &curve.force), 0);
        }
        for (k, &stop) in self.bumpers.iter().enumerate() {
            // The contact itself is an event.
            add(Argument::Depth(k), loading.stops[stop].curve.as_ref(), 1);
        }
        for (k, &spring) in self.springs.iter().enumerate() {
            let spring = &loading.springs[spring];
            add(Argument::Rate(k), spring.damper.as_ref(), 0);
            if let (true, Some(Characteristic::Points(points))) = (source.winds(spring), &spring.characteristic) {
                add(Argument::Angle(k), Some(points), 0);
            }
        }
    }
}
