//! What a circuit allows: lengths that the cylinder has, absolute pressures above 0.
//!
//! In: pressures, length of the actuator. Out: whether the laws hold there. It must not know
//! steps.
use super::{DYNAMIC, Equations};
use crate::events::Guard;
use foundation::numerics::dual::Number;

/// Length beyond the ends of the cylinder's travel that rounding explains [m].
pub const SLACK: f64 = 1e-9;
/// Absolute pressure, as a part of the ambient pressure, below which oil without air is at absolute zero for an
/// integration that comes no further.
const NEAR_VACUUM: f64 = 1e-3;
/// Absolute pressure, as a part of the ambient pressure, below which a chamber cavitates.
const CAVITATES: f64 = 0.1;

/// Part of a length that is its rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Acceleration [m/s2] over a step of size h [s] that brings a mechanism to rest at the end of the cylinder on which
/// the piston rests, by a mean force that is held: in two steps if they are equal. Way x from the end and speed v
/// shrink as under poles at 1 - h/T of a time T = `settling`, at least h.
pub fn settling_acceleration<T: Number>([length, end]: [T; 2], speed: T, settling: f64, h: T) -> T {
    let mut way = length - end;
    if way.value().abs() <= ROUNDING * length.value() {
        way = way - T::constant(way.value());
    }
    let time = if settling > h.value() { T::constant(settling) } else { h };
    (way / time + speed * (T::constant(2.0) - h / time * 0.5)) / time
}

/// Farthest way [m] from an end of the cylinder, on which the piston has come to rest, that a mechanism has after a
/// step, with its way by its speed while it settles: a mean force that is held leaves at most this.
pub fn settling_reach([length, speed]: [f64; 2], end: f64, settling: f64) -> f64 {
    1.5 * (speed.abs() * settling + (length - end).abs()) + SLACK
}

/// Events of a circuit, by their index.
pub const EVENTS: [&str; 11] = [
    "the spool is at the metering edge at valve.overlap",
    "the spool is at the metering edge at -valve.overlap",
    "the spool is at the end of its travel, 1",
    "the spool is at the end of its travel, -1",
    "the piston enters or leaves cushion_a",
    "the piston enters or leaves cushion_b",
    "chamber_a.pressure passes relief.pressure",
    "chamber_b.pressure passes relief.pressure",
    "supply.pressure passes pump.full_pressure",
    "supply.pressure passes pump.max_pressure",
    "the lock valve opens or closes",
];

impl Equations {
    /// Guard of an event of [`EVENTS`], for a tolerance of the integration.
    pub fn guard(
        &self,
        event: usize,
        [p_a, p_b, spool, _, supply]: [f64; DYNAMIC],
        length: f64,
        tolerance: f64,
    ) -> Guard {
        let spool_at = |edge: f64| Guard::of(spool, edge, 1.0, tolerance);
        let pressure = |p: f64, level: f64| Guard::of(p, level, level + self.ambient, tolerance);
        let guard = match event {
            0 => Some(spool_at(self.overlap)),
            1 => (self.overlap != 0.0).then(|| spool_at(-self.overlap)),
            2 => Some(spool_at(1.0)),
            3 => Some(spool_at(-1.0)),
            4 | 5 => self.borders()[event - 4].map(|border| Guard::of(length, border, self.stroke, tolerance)),
            6 | 7 => (self.relief > 0.0).then(|| pressure([p_a, p_b][event - 6], self.relief_pressure)),
            8 | 9 => self.unit.as_ref().map(|unit| pressure(supply, unit.borders()[event - 8])),
            _ => (self.pilot_ratio > 0.0).then(|| pressure(p_b - p_a * self.pilot_ratio, 0.0)),
        };
        guard.unwrap_or(Guard::NONE)
    }

    /// Whether all absolute pressures are above 0, as those of oil with air always are: a step that ends elsewhere was
    /// too long. Oil without air comes to 0 where the laws end.
    #[inline]
    pub fn has_pressures(&self, [p_a, p_b, _, _, supply]: [f64; DYNAMIC]) -> bool {
        let vacuum = -self.ambient;
        p_a > vacuum && p_b > vacuum && (self.unit.is_none() || supply > vacuum)
    }

    /// Whether the cylinder has a length [m], but for rounding.
    #[inline]
    pub fn has_length(&self, length: f64) -> bool {
        let [least, most] = self.lengths();
        length >= least - SLACK && length <= most + SLACK
    }

    /// The end of the cylinder that is nearer to a length, and the sign of a speed towards it.
    pub fn nearer_end(&self, length: f64) -> (f64, f64) {
        let [least, most] = self.lengths();
        if length - least < most - length { (least, -1.0) } else { (most, 1.0) }
    }

    /// Speed of a mass after an impact on an end of the cylinder with a speed, under a force and a load that press on
    /// it with the sum `pressing` [N]. A flight that is lower than rounding is rest.
    pub fn after_impact(&self, mass: f64, speed: f64, pressing: f64) -> f64 {
        let after = -self.restitution() * speed;
        if mass * after * after <= 2.0 * SLACK * pressing { 0.0 } else { after }
    }

    /// Whether both chambers have at least half of their dead volumes at a length: a step of an integration passes the
    /// end of the travel before its impact is located.
    #[inline]
    pub fn has_room(&self, length: f64) -> bool {
        let volumes = self.volumes(length);
        (0..2).all(|side| volumes[side] >= 0.5 * self.dead_volumes[side])
    }

    /// The chamber, A or B, that keeps an integration from going on at these pressures: one of oil without air at
    /// absolute zero.
    pub fn at_vacuum(&self, pressures: [f64; 2]) -> Option<usize> {
        (0..2).find(|chamber| self.is_at_vacuum(pressures[*chamber]))
    }

    /// Whether a gauge pressure [Pa] is that of oil without air at absolute zero, from which no integration goes on.
    pub fn is_at_vacuum(&self, pressure: f64) -> bool {
        self.air == 0.0 && pressure + self.ambient < NEAR_VACUUM * self.ambient
    }

    /// The pressures at which an integration came no further, in words: those of a chamber that cavitates with the
    /// remedies, else both.
    pub fn describe_pressures(&self, pressures: [f64; 2]) -> String {
        use foundation::numerics::decimal::Decimal;
        let [a, b] = pressures.map(Decimal::rounded);
        let both = format!("chamber_a.pressure = {a} Pa and chamber_b.pressure = {b} Pa");
        let cavitates = |chamber: &usize| pressures[*chamber] + self.ambient < CAVITATES * self.ambient;
        match (0..2).find(cavitates) {
            Some(chamber) => format!(
                "{both}: {} cavitates with fluid.air_fraction = {}; use a larger fluid.air_fraction or \
                 anticavitation.conductance",
                ["chamber_a", "chamber_b"][chamber],
                Decimal(self.air)
            ),
            None => both,
        }
    }
}
