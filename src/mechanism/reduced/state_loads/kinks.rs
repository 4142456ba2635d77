//! Kinks of the laws by which the state sizes loads: points of curves, surfaces that the air flows along.
//!
//! In: the loads of the state. Out: the values of quantities at which a step ends. It must not know states.
use super::StateLoads;
use crate::mechanism::loads::laws::spring::Characteristic;
use crate::mechanism::loads::resolved::{Air, DriveLaw};
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

/// Which way surfaces face the air on a panel of the table, for an airspeed > 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Facings {
    /// Ratio of sigma_dot to the airspeed below which that holds; 0 where it does not.
    pub speed: f64,
    /// Surfaces that face the air with their back, a bit for each.
    pub backs: u64,
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
        self.edges = self.kinks.len();
        let mut add = |of: Argument, curve: Option<&Piecewise>, first: usize| {
            let knots = curve.map_or(&[][..], Piecewise::knots);
            let near = AT_KINK * knots.iter().fold(0.0, |most: f64, knot| most.max(knot.abs()));
            self.kinks.extend(knots.iter().skip(first).map(|&value| Kink { of, value, near }));
        };
        for law in &self.laws {
            let curve = loading.drives[law.drive].law.as_ref().and_then(DriveLaw::curve);
            add(Argument::Drive(law.drive), curve, 0);
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

    /// Which way all surfaces face the air on a panel of the table.
    #[inline]
    pub fn facings(&self, panel: usize) -> Facings {
        self.facings.get(panel).copied().unwrap_or_default()
    }

    /// With [`Self::facings`] of all panels.
    pub(super) fn with_facings(mut self, source: &Source) -> Self {
        let air = source.loading.air.as_ref().filter(|air| self.edges > 0 && air.surfaces.len() <= u64::BITS as usize);
        let all = |air: &Air| (0..self.table.panels()).map(|panel| self.facings_in(air, panel)).collect();
        self.facings = air.map_or_else(Vec::new, all);
        self
    }

    /// The flow across a surface is the airspeed times a function of sigma, less sigma_dot times another one: it has
    /// the sign of the first while that is the larger one.
    fn facings_in(&self, air: &Air, panel: usize) -> Facings {
        if self.table.is_gap(panel) {
            return Facings::default();
        }
        let series = |component: usize| self.table.series(panel, component);
        let largest = |component: usize| series(component).iter().map(|c| c.abs()).sum::<f64>();
        let mut all = Facings { speed: f64::INFINITY, backs: 0 };
        for (k, surface) in air.surfaces.iter().enumerate().filter(|(_, surface)| surface.drag.directed) {
            let [x, y] = [0, 1].map(|axis| series(self.line(k) + axis));
            let mut across = x.iter().zip(y).map(|(x, y)| air.flow.y * x - air.flow.x * y);
            let middle = across.next().unwrap_or(0.0);
            let least = middle.abs() - across.map(f64::abs).sum::<f64>();
            if least <= 0.0 {
                return Facings::default();
            }
            all.backs |= u64::from(middle < 0.0) << k;
            if air.relative_wind {
                let [x, y, omega] = [0, 1, 2].map(|part| largest(3 * k + part));
                all.speed = all.speed.min(least / (x.hypot(y) + omega * surface.drag.length));
            }
        }
        all
    }
}
