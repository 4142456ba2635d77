//! Outputs of a network: one law each, for values and for derivatives.
//!
//! In: the state, inputs, the foreseen motion. Out: values on demand. It must not know how a step is made.
use super::definition::{MOST_COMPONENTS, MOST_CYLINDERS, MOST_PATHS};
use super::laws::{Drive, Laws, Point};
use super::layout::Total;
use foundation::numerics::dual::Number;

/// A computed quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Pressure of a node or chamber.
    Pressure(usize),
    /// Flow into a reservoir.
    ReservoirFlow(usize),
    /// Flow of a path or a pump.
    Flow(usize),
    /// Flow of a valve from its supply (0), into its return (1), out of its ports a (2) and b (3).
    ValveFlow(usize, usize),
    /// Position of a spool.
    Spool(usize),
    /// Oil in an accumulator.
    OilVolume(usize),
    /// Force of a cylinder.
    Force(usize),
    /// Stiffness of the oil along a cylinder.
    Stiffness(usize),
    /// Derivative of the seal friction of a cylinder with respect to the speed.
    Damping(usize),
    /// Position of a piston from the closed length.
    Position(usize),
    /// Force of the ends of a cylinder on its piston.
    EndForce(usize),
    /// Flow into a chamber, by its cylinder and side.
    ChamberFlow(usize, usize),
    /// Of the foreseen motion of a cylinder.
    Preview(usize, Ahead),
    /// A total volume or energy.
    Total(Total),
    /// Oil from the reservoirs less what has leaked, is compressed or fills the chambers.
    VolumeBalance,
    /// Energy supplied less all other energies.
    EnergyBalance,
}

/// What the foreseen motion of a cylinder tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ahead {
    /// Value of the line with the impulse and the first moment of the force [N].
    Force,
    /// Rate of this line [N/s].
    ForceRate,
    /// Mean force [N].
    ForceMean,
    /// Length at the end [m].
    Length,
    /// Speed at the end [m/s].
    Speed,
    /// Acceleration under the force at the start [m/s2].
    StartAcceleration,
    /// Acceleration under the force at the end [m/s2].
    Acceleration,
}

/// The present state with all that follows from it.
#[derive(Clone, Debug)]
pub struct Present<T> {
    y: [T; MOST_COMPONENTS],
    u: [T; MOST_COMPONENTS],
    /// Length and speed of each cylinder, of the inputs.
    motion: [[T; 2]; MOST_CYLINDERS],
    net: [T; MOST_COMPONENTS],
    flows: [T; MOST_PATHS],
}

impl<T: Number> Present<T> {
    /// Room for a state.
    pub fn nothing() -> Self {
        let zero = T::constant(0.0);
        let nothing = [zero; MOST_COMPONENTS];
        Self { y: nothing, u: nothing, motion: [[zero; 2]; MOST_CYLINDERS], net: nothing, flows: [zero; MOST_PATHS] }
    }

    /// Evaluate the laws. `y`: components of the state; `u`: the inputs that act on flows.
    pub fn new(
        laws: &Laws,
        y: impl Iterator<Item = T>,
        u: impl Iterator<Item = T>,
        motion: [[T; 2]; MOST_CYLINDERS],
    ) -> Self {
        let mut all = Self { motion, ..Self::nothing() };
        all.y.iter_mut().zip(y).for_each(|(own, y)| *own = y);
        all.u.iter_mut().zip(u).for_each(|(own, u)| *own = u);
        let (y, u) = (all.y, all.u);
        let flows = &mut all.flows;
        laws.flows(&Point { y: &y, u: &u, motion: &motion }, &mut all.net, |index, flow| flows[index] = flow);
        all
    }

    /// Pressures of a cylinder.
    fn pressures(&self, laws: &Laws, cylinder: usize) -> [T; 2] {
        let chamber = laws.layout.chamber(cylinder);
        [self.y[chamber], self.y[chamber + 1]]
    }

    /// Value of an output that needs the present state only; `start_volume`: of all chambers.
    pub fn output(&self, laws: &Laws, output: Output, start_volume: f64) -> Option<T> {
        let layout = &laws.layout;
        let total = |total| self.y[layout.total(total)];
        Some(match output {
            Output::Pressure(index) => self.y[index],
            Output::ReservoirFlow(index) => self.net[layout.volumes() + index],
            Output::Flow(index) => self.flows[index],
            Output::ValveFlow(valve, port) => {
                let first = laws.path_count() - 4 * (layout.valves - valve);
                let edge = |index: usize| self.flows[first + index];
                match port {
                    0 => edge(0) + edge(1),
                    1 => edge(2) + edge(3),
                    2 => edge(0) - edge(2),
                    _ => edge(1) - edge(3),
                }
            }
            Output::Spool(valve) => laws.spool(valve, &self.y, &self.u),
            Output::OilVolume(accumulator) => laws.oil_volume(accumulator, &self.y),
            Output::Force(index) => {
                laws.cylinders[index].laws.force(self.pressures(laws, index), self.motion[index][1])
            }
            Output::Stiffness(index) => {
                laws.cylinders[index].laws.stiffness(self.pressures(laws, index), self.motion[index][0])
            }
            Output::Damping(index) => {
                laws.cylinders[index].laws.damping(self.pressures(laws, index), self.motion[index][1])
            }
            Output::Position(index) => self.motion[index][0] - T::constant(laws.cylinders[index].laws.lengths()[0]),
            Output::ChamberFlow(index, side) => self.net[layout.chamber(index) + side],
            Output::Total(one) => total(one),
            Output::VolumeBalance => {
                let volume = match layout.is_carried {
                    true => laws.volume_at(|cylinder| self.motion[cylinder][0]),
                    false => laws.chamber_volume(&self.y),
                };
                let filled = volume - T::constant(start_volume);
                total(Total::Reservoirs) - total(Total::Leaked) - total(Total::Compressed) - filled
            }
            Output::EnergyBalance => {
                total(Total::PumpWork) + total(Total::ReservoirWork)
                    - total(Total::PistonWork)
                    - total(Total::SealFriction)
                    - total(Total::Compression)
                    - total(Total::Throttling)
            }
            Output::Preview(..) | Output::EndForce(_) => return None,
        })
    }
}

/// What the foreseen motion of a cylinder tells: from what moves it, its force, motion and acceleration at the
/// beginning, the state at the end, and the step.
pub fn ahead<T: Number>(
    laws: &Laws,
    (cylinder, drive): (usize, &Drive<T>),
    (first, motion, given): (T, [T; 2], T),
    end: &[T],
    h: T,
    what: Ahead,
) -> T {
    let layout = &laws.layout;
    let (own, impulse, chamber) = (layout.motion(cylinder), layout.impulse(cylinder), layout.chamber(cylinder));
    let mean = end[impulse] / h;
    let rate = || (end[impulse + 1] / (h * h) * 2.0 - mean) * 6.0 / h;
    let acceleration = |force: T, motion: [T; 2], t: T| match drive {
        Drive::Element(element) => element.acceleration(force, motion, t),
        Drive::Given(_) => given,
        Drive::Held(_) | Drive::End(_) => T::constant(0.0),
    };
    match what {
        Ahead::Force => mean - rate() * h * 0.5,
        Ahead::ForceRate => rate(),
        Ahead::ForceMean => match drive {
            Drive::End(rest) => rest.mean_force(motion, h),
            _ => mean,
        },
        Ahead::Length => end[own],
        Ahead::Speed => end[own + 1],
        Ahead::StartAcceleration => acceleration(first, motion, T::constant(0.0)),
        Ahead::Acceleration => {
            let last = laws.cylinders[cylinder].laws.force([end[chamber], end[chamber + 1]], end[own + 1]);
            acceleration(last, [end[own], end[own + 1]], h)
        }
    }
}

/// What is told of a motion that was not found: the present force, and the motion of the inputs.
pub fn blind<T: Number>(what: Ahead, force: T, [length, speed]: [T; 2], acceleration: T, h: f64) -> T {
    match what {
        Ahead::Force | Ahead::ForceMean => force,
        Ahead::ForceRate => T::constant(0.0),
        Ahead::Length => length + speed * h,
        Ahead::Speed => speed,
        Ahead::StartAcceleration | Ahead::Acceleration => acceleration,
    }
}
