//! The equation of motion with the hydraulic circuit of a drive, as one system.
//!
//! In: the equation of motion, the laws of the circuit, pressures of its ports and the command as functions of time.
//! Out: rates of (sigma, sigma_dot, energy lost, components of the circuit), their error weights, the places and times
//! at which a step ends. The force of the drive acts like an applied load whose size follows from the pressures and the
//! speed. It must not know steps.
use crate::hydraulics::circuit::{CIRCUIT, DYNAMIC, Equations, FREE, SPOOL, SUPPLY};
use crate::integrator::{System, differences};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::ports::Ports;
use crate::mechanism::dynamics::state_loads::Evaluation;
use crate::numerics::table::Table;

/// Components of the state of a motion: sigma, sigma_dot, energy lost.
pub const MOTION: usize = 3;
/// Components of the state of a motion with a circuit.
pub const DRIVEN: usize = MOTION + CIRCUIT;
/// Components that the right-hand side depends on.
const DRIVING: [usize; 7] = [0, 1, 3, 4, 5, 6, 7];
/// Number of leading components, which these are but for the energy lost; the energies of the circuit follow.
const LEADING: usize = MOTION + DYNAMIC;

/// Number of borders of [`border_of`].
pub const BORDERS: usize = 6;
/// Part of the weight of the speed without a circuit that holds with one: oil lets a mechanism move much slower than it
/// would fall.
pub(super) const SPEED_FLOOR: f64 = 0.02;
/// Distance from the border of a cushion up to which the actuator is on it [m].
pub(super) const ON_BORDER: f64 = 1e-10;
/// Distance from a kink of the pump's flow up to which its pressure is on it, as a part of the pressure.
const ON_KINK: f64 = 1e-9;

/// Where the laws of a circuit are not smooth, or change within a hair's breadth: two lengths at which the cushions of
/// the chambers A and B begin [m], two pressures between which the pump reduces its flow [Pa], two positions of the
/// spool at which an edge opens. None where there is no such border.
#[inline]
pub fn border_of(laws: &Equations, border: usize) -> Option<f64> {
    match border {
        0 | 1 => laws.borders()[border],
        2 | 3 => laws.supply_unit().map(|unit| unit.borders()[border - 2]),
        4 | 5 => laws.edges().0[border - 4],
        _ => None,
    }
}

/// Length of an actuator at sigma, and its derivative along sigma, by its load and the table of the load's displacement
/// on the stretch of the curve with the guess.
#[inline]
pub(super) fn length_at(equation: &EquationOfMotion<'_>, (load, whole): (usize, &Table), sigma: f64) -> [f64; 2] {
    let (reduced, _) = equation.stretch_at(sigma);
    let of_stretch = (!std::ptr::eq(reduced, equation.whole)).then(|| reduced.displacement(load));
    let (reduced, length) = match of_stretch {
        Some(Ok(length)) => (reduced, length),
        _ => (equation.whole, whole),
    };
    let value = |component| equation.scratch.panel_force.value((reduced, length), component, sigma);
    [value(0), value(1)]
}

impl EquationOfMotion<'_> {
    /// The chamber, A or B, of oil without air at absolute zero that keeps a motion from going on from this state.
    pub fn at_vacuum(&self, y: &[f64; DRIVEN]) -> Option<usize> {
        let (ports, [_, _, _, a, b, ..]) = (self.ports.as_ref()?, *y);
        ports.laws.at_vacuum([a, b])
    }

    /// The pressures of a state in words, for messages.
    pub fn describe_circuit(&self, y: &[f64; DRIVEN]) -> String {
        let describe = |ports: &Ports<'_>| ports.laws.describe_pressures([y[MOTION], y[MOTION + 1]]);
        self.ports.as_ref().map_or_else(String::new, describe)
    }

    /// How far a state is beyond a border at which the laws are not smooth, 0 where it is on it; None where there is no
    /// such border.
    pub fn beyond_border_of_circuit(&self, border: usize, z: &[f64; DRIVEN]) -> Option<f64> {
        let ports = self.ports.as_ref()?;
        let level = border_of(ports.laws, border)?;
        let (value, near) = match border {
            0 | 1 => (length_at(self, (ports.load, ports.length), z[0])[0], ON_BORDER),
            2 | 3 => (z[MOTION + SUPPLY], ON_KINK * level.abs()),
            _ => (z[MOTION + SPOOL], ports.laws.edges().1),
        };
        let beyond = value - level;
        Some(if beyond.abs() < near { 0.0 } else { beyond })
    }
}

/// (sigma, sigma_dot, energy lost, components of the circuit). The work of the drive counts as gained.
impl System<DRIVEN> for EquationOfMotion<'_> {
    const CAN_BE_STIFF: bool = true;
    const LEADING: usize = LEADING;

    fn derivative(&mut self, t: f64, y: &[f64; DRIVEN]) -> [f64; DRIVEN] {
        self.time = t;
        self.scratch.evaluator.pressures[0] = [y[3], y[4]];
        let held = self.mode.held;
        let evaluation = if held { Ok(Evaluation { acceleration: 0.0, lost: 0.0 }) } else { self.effect(y[0], y[1]) };
        let Ok(Evaluation { acceleration, lost }) = evaluation else {
            self.locked = true;
            return [f64::NAN; DRIVEN];
        };
        self.scratch.evaluator.switches.record(t);
        let Some(ports) = &self.ports else { return [f64::NAN; DRIVEN] };
        let [sigma, sigma_dot, _, a, b, spool, rate, supply, ..] = *y;
        let [length, slope] = length_at(self, (ports.load, ports.length), sigma);
        let motion = [length, slope * sigma_dot];
        let at = ports.laws.point([a, b, spool, rate, supply], motion, ports.surroundings.at(t));
        let mut rates = [0.0; DRIVEN];
        rates[0] = if held { 0.0 } else { sigma_dot };
        (rates[1], rates[2]) = (acceleration, lost);
        rates[MOTION..].copy_from_slice(&ports.laws.rates(&at).state);
        rates
    }

    fn scale(&mut self, y: &[f64; DRIVEN], f: &[f64; DRIVEN]) -> [f64; DRIVEN] {
        let motion = System::<MOTION>::scale(self, &[y[0], y[1], y[2]], &[f[0], f[1], f[2]]);
        let [_, _, _, a, b, spool, rate, supply, ..] = *y;
        let mut scale = [FREE; DRIVEN];
        scale[..MOTION].copy_from_slice(&motion);
        scale[1] = y[1].abs().max(SPEED_FLOOR * motion[1]);
        if let Some(ports) = &self.ports {
            scale[MOTION..LEADING].copy_from_slice(&ports.laws.sizes([a, b, spool, rate, supply]));
        }
        scale
    }

    /// The pressures are above absolute zero, the chambers have a volume beyond the ends of the cylinder too, where an
    /// impact is located, and the energies are numbers: no error of a step counts them.
    #[inline]
    fn admits(&mut self, y: &[f64; DRIVEN]) -> bool {
        let Some(ports) = &self.ports else { return true };
        let [sigma, _, _, a, b, spool, rate, supply, ..] = *y;
        y[LEADING..].iter().sum::<f64>().is_finite()
            && ports.laws.has_pressures([a, b, spool, rate, supply])
            && ports.laws.has_room(length_at(self, (ports.load, ports.length), sigma)[0])
    }

    /// By one-sided differences along the components that the right-hand side depends on.
    fn jacobian(&mut self, t: f64, y: &[f64; DRIVEN]) -> [[f64; DRIVEN]; DRIVEN] {
        differences(self, t, y, DRIVING.into_iter())
    }
}
