//! The ports of a hydraulic circuit or network during one step: its laws, the tables of the lengths of its cylinders,
//! and its inputs as functions of time.
//!
//! In: drives, tables and inputs of a step. Out: the inputs that act at a time, and the instants at which an input has
//! a kink. It must not know states or steps.
use crate::hydraulics::circuit::Equations;
use crate::hydraulics::inputs::{CommandSignal, Polynomial, Surroundings};
use crate::hydraulics::network::definition::{CAPACITY, MOST_CYLINDERS};
use crate::hydraulics::network::inputs::limits;
use crate::hydraulics::network::laws::Laws;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::loads::resolved::{HydraulicDrive, NetworkDrives};
use crate::mechanism::reduced::Reduced;
use crate::numerics::order;
use crate::numerics::table::Table;

/// Most instants within a step at which its integration ends.
pub(super) const INSTANTS: usize = 16;
/// Time after an instant up to which it is taken to have come [s].
const JUST_NOW: f64 = 1e-15;
/// Time [s] up to which instants are looked for in a step that may go on beyond the end of the span.
const BEYOND: f64 = 1e12;

/// The circuit during one step: laws, ports, command.
#[derive(Clone, Debug)]
pub struct Ports<'a> {
    pub(super) laws: &'a Equations,
    /// Index of the drive's load.
    pub(super) load: usize,
    /// Displacement of the drive's load: the length of the actuator over sigma, with two derivatives, on the stretch of
    /// the curve with the guess.
    pub(super) length: &'a Table,
    pub(super) surroundings: Surroundings,
    /// Instants at which the command has a kink [s], ascending; the last ones infinite.
    pub(super) kinks: [f64; INSTANTS],
}

/// An input over a step.
#[inline]
fn polynomial(inputs: &Inputs, input: usize) -> Polynomial {
    let rates = if inputs.signal.ahead { [inputs.signal.first[input], inputs.signal.second[input]] } else { [0.0; 2] };
    Polynomial([inputs.reals[input], rates[0], 0.5 * rates[1], 0.0, 0.0, 0.0])
}

/// Command of the valve over a step that begins `time` [s] after the start.
#[inline]
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
        order::sort(&mut kinks[..count]);
        let [supply, tank] = [1, 2].map(|port| polynomial(inputs, drive.first_input + port));
        let surroundings = Surroundings { supply, tank, command };
        Self { laws: &drive.laws, load: drive.load, length, surroundings, kinks }
    }

    /// The next instant after t [s] at which the command has a kink; infinite if there is none.
    #[inline]
    pub fn next_kink(&self, t: f64) -> f64 {
        next_instant(&self.kinks, t)
    }
}

/// The first of some instants that comes after t [s]; infinite if there is none.
#[inline]
pub(super) fn next_instant(instants: &[f64], t: f64) -> f64 {
    let next = instants.iter().find(|instant| **instant > t + JUST_NOW + 4.0 * f64::EPSILON * t);
    next.copied().unwrap_or(f64::INFINITY)
}

/// The network during one step: laws, inputs, lengths of the cylinders.
#[derive(Clone, Debug)]
pub struct NetworkPorts<'a> {
    pub(super) drives: &'a NetworkDrives,
    /// Displacement of the load of each cylinder over sigma, on the stretch of the curve with the guess.
    pub(super) lengths: [Option<&'a Table>; MOST_CYLINDERS],
    pub(super) inputs: &'a Inputs,
    /// Instants at which an input is clipped [s], ascending; the last ones infinite.
    pub(super) kinks: [f64; INSTANTS],
}

/// The value of an input of the network that acts, by its index among those and the value that the host states.
#[inline]
pub fn acting(laws: &Laws, index: usize, value: f64) -> f64 {
    let [least, most] = limits(laws.layout.input(index));
    value.clamp(least, most)
}

impl<'a> NetworkPorts<'a> {
    /// The network over a step of `h` [s]; None if a length is not smooth along the motion.
    pub fn new(drives: &'a NetworkDrives, reduced: &'a Reduced, inputs: &'a Inputs, h: f64) -> Option<Self> {
        let mut lengths = [None; MOST_CYLINDERS];
        for (length, load) in lengths.iter_mut().zip(&drives.loads) {
            *length = Some(reduced.displacement(*load).ok()?);
        }
        let (mut kinks, mut count) = ([f64::INFINITY; INSTANTS], 0);
        if inputs.signal.ahead {
            let layout = &drives.laws.layout;
            for index in 0..layout.flow_inputs() {
                for limit in limits(layout.input(index)).into_iter().filter(|limit| limit.is_finite()) {
                    polynomial(inputs, drives.first_input + index).passages(limit, h, &mut |t| {
                        if count < INSTANTS {
                            (kinks[count], count) = (t, count + 1);
                        }
                    });
                }
            }
            order::sort(&mut kinks[..count]);
        }
        Some(Self { drives, lengths, inputs, kinks })
    }

    /// The next instant after t [s] at which an input is clipped; infinite if there is none.
    #[inline]
    pub fn next_kink(&self, t: f64) -> f64 {
        next_instant(&self.kinks, t)
    }

    /// Number of places at which the laws are not smooth.
    #[inline]
    pub fn borders(&self) -> usize {
        self.drives.laws.borders()
    }

    /// Inputs that act at the time t [s].
    #[inline]
    pub(super) fn acting_at(&self, t: f64) -> [f64; CAPACITY] {
        let (laws, first, signal) = (&self.drives.laws, self.drives.first_input, &self.inputs.signal);
        let mut u = [0.0; CAPACITY];
        for (index, u) in u.iter_mut().enumerate().take(laws.layout.flow_inputs()) {
            *u = acting(laws, index, signal.at(first + index, self.inputs.reals[first + index], t));
        }
        u
    }
}
