//! The equation of motion with the hydraulic circuit of a drive, as one system.
//!
//! In: the equation of motion, the laws of the circuit, pressures of its ports and the command as functions of time. Out:
//! rates of (sigma, sigma_dot, energy lost, p_A, p_B, y, y_dot, six energies), their error weights, the places and times
//! at which a step ends. The force of the drive acts like an applied load whose size follows from the pressures and the
//! speed. It must not know steps.
use crate::hydraulics::circuit::{Equations, Point};
use crate::hydraulics::inputs::{CommandSignal, Polynomial};
use crate::integrator::System;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::state_loads::Evaluation;
use crate::mechanism::loads::resolved::HydraulicDrive;
use crate::numerics::table::Table;

/// Components of the state of a circuit: two pressures, position and speed of the spool, six energies.
pub const CIRCUIT: usize = 10;
/// Components of the state of a motion: sigma, sigma_dot, energy lost.
pub const MOTION: usize = 3;
/// Components of the state of a motion with a circuit.
pub const DRIVEN: usize = MOTION + CIRCUIT;
/// Components that the right-hand side depends on.
const DRIVING: [usize; 6] = [0, 1, 3, 4, 5, 6];

/// Most instants within a step at which its integration ends.
const INSTANTS: usize = 16;
/// Part of the error weight of the spool that holds where it is at rest; with it, openings near the edges are exact.
const SPOOL_FLOOR: f64 = 0.1;
/// Weight of components whose errors follow from those of the others.
const FREE: f64 = 1e300;
/// Part of the weight of the speed without a circuit that holds with one: oil lets a mechanism move much slower than it
/// would fall.
const SPEED_FLOOR: f64 = 0.02;
/// Distance from the border of a cushion up to which the actuator is on it [m].
const ON_BORDER: f64 = 1e-10;
/// Time after an instant up to which it is taken to have come [s].
const JUST_NOW: f64 = 1e-15;
/// Time [s] up to which instants are looked for in a step that may go on beyond the end of the span.
const BEYOND: f64 = 1e12;

/// The circuit during one step: laws, ports, command.
#[derive(Clone, Debug)]
pub struct Ports<'a> {
    laws: &'a Equations,
    /// Index of the drive's load.
    load: usize,
    /// Displacement of the drive's load: the length of the actuator over sigma, with two derivatives, on the stretch of the
    /// curve with the guess.
    length: &'a Table,
    supply: Polynomial,
    tank: Polynomial,
    command: CommandSignal,
    /// Instants at which the command has a kink [s], ascending; the last ones infinite.
    kinks: [f64; INSTANTS],
    /// Whether a stop, a lock or drives hold the mechanism at rest.
    pub held: bool,
}

/// An input over a step.
fn polynomial(inputs: &Inputs, input: usize) -> Polynomial {
    let rates = if inputs.signal.ahead { [inputs.signal.first[input], inputs.signal.second[input]] } else { [0.0; 2] };
    Polynomial([inputs.reals[input], rates[0], 0.5 * rates[1], 0.0, 0.0, 0.0])
}

/// Command of the valve over a step that begins `time` [s] after the start.
pub fn command(drive: &HydraulicDrive, inputs: &Inputs, time: f64) -> CommandSignal {
    CommandSignal::new(polynomial(inputs, drive.first_input), &drive.command, time)
}

impl<'a> Ports<'a> {
    /// The circuit over a step of `h` [s] that begins `time` [s] after the start; `length`: table of the length of the
    /// actuator.
    pub fn new(drive: &'a HydraulicDrive, length: &'a Table, inputs: &Inputs, time: f64, h: f64) -> Self {
        let command = command(drive, inputs, time);
        let (mut kinks, mut count) = ([f64::INFINITY; INSTANTS], 0);
        command.kinks(if inputs.signal.ahead { h } else { BEYOND }, &mut |t| {
            if count < INSTANTS {
                kinks[count] = t;
                count += 1;
            }
        });
        kinks.sort_unstable_by(f64::total_cmp);
        let [supply, tank] = [1, 2].map(|port| polynomial(inputs, drive.first_input + port));
        Self { laws: &drive.laws, load: drive.load, length, supply, tank, command, kinks, held: false }
    }

    /// The next instant after t [s] at which the command has a kink; infinite if there is none.
    #[inline]
    pub fn next_kink(&self, t: f64) -> f64 {
        self.kinks.into_iter().find(|kink| *kink > t + JUST_NOW + 4.0 * f64::EPSILON * t).unwrap_or(f64::INFINITY)
    }
}

/// Length of the actuator at sigma, and its derivative along sigma.
#[inline]
fn length_at(equation: &EquationOfMotion<'_>, ports: &Ports<'_>, sigma: f64) -> [f64; 2] {
    let (reduced, _) = equation.stretch_at(sigma);
    let of_stretch = (!std::ptr::eq(reduced, equation.whole)).then(|| reduced.displacement(ports.load));
    let (reduced, length) = match of_stretch {
        Some(Ok(length)) => (reduced, length),
        _ => (equation.whole, ports.length),
    };
    let value = |component| equation.scratch.panel_force.value((reduced, length), component, sigma);
    [value(0), value(1)]
}

impl EquationOfMotion<'_> {
    /// Length of the actuator at sigma [m]; none without a circuit.
    pub fn actuator_length(&self, sigma: f64) -> Option<f64> {
        self.ports.as_ref().map(|ports| length_at(self, ports, sigma)[0])
    }

    /// How far the actuator is beyond the border of a cushion [m], chamber A's or B's; 0 where it is on it; None where
    /// there is no cushion.
    pub fn beyond_cushion(&self, chamber: usize, sigma: f64) -> Option<f64> {
        let ports = self.ports.as_ref()?;
        let border = ports.laws.borders()[chamber]?;
        let beyond = length_at(self, ports, sigma)[0] - border;
        Some(if beyond.abs() < ON_BORDER { 0.0 } else { beyond })
    }

    /// State of the circuit and its surroundings at the time t of the step.
    #[inline]
    fn point(&self, ports: &Ports<'_>, t: f64, y: &[f64; DRIVEN]) -> Point<f64> {
        let [length, slope] = length_at(self, ports, y[0]);
        Point {
            pressures: [y[3], y[4]],
            spool: y[5],
            spool_speed: y[6],
            length,
            speed: slope * y[1],
            supply: ports.supply.at(t),
            tank: ports.tank.at(t),
            command: ports.command.at(t),
        }
    }
}

/// (sigma, sigma_dot, energy lost, p_A, p_B, y, y_dot, energies). The work of the drive counts as gained.
impl System<DRIVEN> for EquationOfMotion<'_> {
    const CAN_BE_STIFF: bool = true;

    fn derivative(&mut self, t: f64, y: &[f64; DRIVEN]) -> [f64; DRIVEN] {
        self.time = t;
        self.scratch.evaluator.pressures = [y[3], y[4]];
        let held = self.ports.as_ref().is_some_and(|ports| ports.held);
        let evaluation = if held { Ok(Evaluation { acceleration: 0.0, lost: 0.0 }) } else { self.effect(y[0], y[1]) };
        let Ok(Evaluation { acceleration, lost }) = evaluation else {
            self.locked = true;
            return [f64::NAN; DRIVEN];
        };
        let Some(ports) = &self.ports else { return [f64::NAN; DRIVEN] };
        let at = self.point(ports, t, y);
        let (flows, laws) = (ports.laws.flows(&at), ports.laws);
        let powers = laws.powers(&at, &flows);
        let [a, b] = flows.pressure_rates;
        [
            if held { 0.0 } else { y[1] },
            acceleration,
            lost,
            a,
            b,
            at.spool_speed,
            flows.spool_acceleration,
            powers.supply,
            powers.returned,
            powers.piston,
            powers.seal_friction,
            powers.compression,
            powers.throttling,
        ]
    }

    fn scale(&mut self, y: &[f64; DRIVEN], f: &[f64; DRIVEN]) -> [f64; DRIVEN] {
        let motion = System::<MOTION>::scale(self, &[y[0], y[1], y[2]], &[f[0], f[1], f[2]]);
        let mut scale = [FREE; DRIVEN];
        scale[..MOTION].copy_from_slice(&motion);
        scale[1] = y[1].abs().max(SPEED_FLOOR * motion[1]);
        let Some(ports) = &self.ports else { return scale };
        let ambient = ports.laws.ambient();
        let spool = SPOOL_FLOOR + y[5].abs();
        (scale[3], scale[4]) = ((y[3] + ambient).max(ambient), (y[4] + ambient).max(ambient));
        (scale[5], scale[6]) = (spool, ports.laws.spool_frequency() * spool);
        scale
    }

    /// By one-sided differences along the components that the right-hand side depends on.
    fn jacobian(&mut self, t: f64, y: &[f64; DRIVEN]) -> [[f64; DRIVEN]; DRIVEN] {
        let f = self.derivative(t, y);
        let scale = self.scale(y, &f);
        let mut rows = [[0.0; DRIVEN]; DRIVEN];
        for j in DRIVING {
            let mut beside = *y;
            beside[j] += f64::EPSILON.sqrt() * y[j].abs().max(scale[j]);
            let width = beside[j] - y[j];
            let g = self.derivative(t, &beside);
            for (row, (g, f)) in rows.iter_mut().zip(g.iter().zip(&f)) {
                row[j] = (g - f) / width;
            }
        }
        rows
    }
}
