//! The equation of motion with the hydraulic network of the mechanism, as one system.
//!
//! In: the equation of motion, the laws of the network, its inputs as functions of time. Out: rates of (sigma,
//! sigma_dot, energy lost, components of the network), their error weights, the places and times at which a step ends.
//! It must not know steps.
use crate::hydraulics::circuit::FREE;
use crate::hydraulics::network::definition::MOST_CYLINDERS;
use crate::hydraulics::network::laws::{Border, Drive, Laws, Lock};
use crate::integrator::{System, differences};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{MOTION, ON_BORDER, SPEED_FLOOR, length_at};
use crate::mechanism::dynamics::ports::NetworkPorts;
use crate::mechanism::dynamics::state_loads::Evaluation;

pub use crate::hydraulics::network::definition::CAPACITY;

/// Components of the state of a motion with a network.
pub const NETWORKED: usize = MOTION + CAPACITY;

/// A level of a component of the state at which a lock changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Index of the component.
    pub component: usize,
    pub value: f64,
    /// Sign of the change of the component beyond the level.
    pub sign: f64,
}

impl Level {
    /// How far a state is beyond the level.
    #[inline]
    pub fn excess(&self, z: &[f64]) -> f64 {
        (z[self.component] - self.value) * self.sign
    }
}

/// The places of the pressure locks in the state of a network, with what each is: 1 if it is engaged, else 0.
fn pressure_locks(laws: &Laws) -> impl Iterator<Item = (usize, &Lock)> {
    (laws.layout.components() + 1..).zip(&laws.locks)
}

/// Whether a pressure lock of a network in this state is engaged.
pub fn is_engaged(laws: &Laws, state: &[f64], lock: usize) -> bool {
    state[laws.layout.components() + 1 + lock] != 0.0
}

/// The state of the pressure locks before the first step follows from their pressures.
pub fn engage_locks(laws: &Laws, state: &mut [f64]) {
    for (place, lock) in pressure_locks(laws) {
        state[place] = f64::from(lock.holds(true, state[lock.at]));
    }
}

/// Release and engage the pressure locks of a network that are due in this state. Calls `changed` with each of them, by
/// its index, and with whether it is engaged.
pub fn switch_locks(laws: &Laws, state: &mut [f64], changed: &mut impl FnMut(usize, bool)) {
    for (index, (place, lock)) in pressure_locks(laws).enumerate() {
        let was_engaged = state[place] != 0.0;
        let engaged = lock.holds(was_engaged, state[lock.at]);
        if engaged != was_engaged {
            state[place] = f64::from(engaged);
            changed(index, engaged);
        }
    }
}

/// Length of a cylinder at sigma, and its derivative along sigma.
#[inline]
fn length_of(equation: &EquationOfMotion<'_>, ports: &NetworkPorts<'_>, cylinder: usize, sigma: f64) -> [f64; 2] {
    ports.lengths[cylinder]
        .map_or([f64::NAN; 2], |table| length_at(equation, (ports.drives.loads[cylinder], table), sigma))
}

impl EquationOfMotion<'_> {
    /// State the pressures in the cylinders of the network in a state (sigma, sigma_dot, energy lost, components).
    #[inline]
    pub fn set_pressures_of_network(&mut self, z: &[f64]) {
        let Some(ports) = &self.network else { return };
        let layout = &ports.drives.laws.layout;
        for (cylinder, own) in self.scratch.evaluator.pressures.iter_mut().enumerate().take(layout.cylinders) {
            let chamber = MOTION + layout.chamber(cylinder);
            *own = [z[chamber], z[chamber + 1]];
        }
    }

    /// The lowest pressure of a state in words, for messages.
    pub fn describe_network(&self, z: &[f64]) -> String {
        self.network.as_ref().map_or_else(String::new, |ports| ports.drives.laws.lowest_pressure(&z[MOTION..]))
    }

    /// Number of pressure locks of the network.
    #[inline]
    pub fn pressure_locks(&self) -> usize {
        self.network.as_ref().map_or(0, |ports| ports.drives.laws.locks.len())
    }

    /// The level at which a pressure lock changes next from a state.
    #[inline]
    pub fn level_of_network(&self, lock: usize, z: &[f64]) -> Option<Level> {
        let laws = &self.network.as_ref()?.drives.laws;
        let own = laws.locks.get(lock)?;
        let (value, sign) = own.next_change(is_engaged(laws, &z[MOTION..], lock));
        Some(Level { component: MOTION + own.at, value, sign })
    }

    /// How far a state is beyond a border at which the laws are not smooth, 0 where it is on it; None where there is no
    /// such border.
    pub fn beyond_border_of_network(&self, border: usize, z: &[f64]) -> Option<f64> {
        let ports = self.network.as_ref()?;
        let (beyond, near) = match ports.drives.laws.border(border)? {
            Border::Length { cylinder, level } => (length_of(self, ports, cylinder, z[0])[0] - level, ON_BORDER),
            Border::Spool { component, level, near } => (z[MOTION + component] - level, near),
        };
        Some(if beyond.abs() < near { 0.0 } else { beyond })
    }
}

/// (sigma, sigma_dot, energy lost, components of the network). The work of the cylinders counts as gained.
impl System<NETWORKED> for EquationOfMotion<'_> {
    const CAN_BE_STIFF: bool = true;

    fn leading_components(&self) -> usize {
        MOTION + self.network.as_ref().map_or(0, |ports| ports.drives.laws.layout.leading())
    }

    fn derivative(&mut self, t: f64, y: &[f64; NETWORKED]) -> [f64; NETWORKED] {
        self.time = t;
        self.set_pressures_of_network(y);
        let held = self.mode.held;
        let evaluation = if held { Ok(Evaluation { acceleration: 0.0, lost: 0.0 }) } else { self.effect(y[0], y[1]) };
        let Ok(Evaluation { acceleration, lost }) = evaluation else {
            self.locked = true;
            return [f64::NAN; NETWORKED];
        };
        self.scratch.evaluator.switches.record(t);
        let (Some(ports), Some(own)) = (&self.network, y[MOTION..].first_chunk::<CAPACITY>()) else {
            return [f64::NAN; NETWORKED];
        };
        let laws = &ports.drives.laws;
        let mut drives = [Drive::Held(0.0); MOST_CYLINDERS];
        let drives = &mut drives[..laws.layout.cylinders];
        for (cylinder, drive) in drives.iter_mut().enumerate() {
            let [length, slope] = length_of(self, ports, cylinder, y[0]);
            *drive = Drive::Given([length, slope * y[1]]);
        }
        let mut rates = [0.0; NETWORKED];
        rates[0] = if held { 0.0 } else { y[1] };
        (rates[1], rates[2]) = (acceleration, lost);
        rates[MOTION..].copy_from_slice(&laws.rates(drives, &ports.acting_at(t), t, own));
        rates
    }

    /// The norm of an error is over the components that there are, whatever the capacity.
    fn scale(&mut self, y: &[f64; NETWORKED], f: &[f64; NETWORKED]) -> [f64; NETWORKED] {
        let motion = System::<MOTION>::scale(self, &[y[0], y[1], y[2]], &[f[0], f[1], f[2]]);
        let mut scale = [FREE; NETWORKED];
        let Some(ports) = &self.network else { return scale };
        let laws = &ports.drives.laws;
        let share = ((MOTION + laws.layout.leading()) as f64 / NETWORKED as f64).sqrt();
        (scale[0], scale[2]) = (share * motion[0], share * motion[2]);
        scale[1] = share * y[1].abs().max(SPEED_FLOOR * motion[1]);
        laws.sizes(&y[MOTION..], share, &mut scale[MOTION..]);
        scale
    }

    /// The pressures are above absolute zero, the chambers have a volume beyond the ends of the cylinders too, where an
    /// impact is located, and the totals are numbers: no error of a step counts them.
    #[inline]
    fn admits(&mut self, y: &[f64; NETWORKED]) -> bool {
        let Some(ports) = &self.network else { return true };
        let laws = &ports.drives.laws;
        let has_room =
            |cylinder: usize| laws.cylinders[cylinder].laws.has_room(length_of(self, ports, cylinder, y[0])[0]);
        y[MOTION + laws.layout.leading()..].iter().sum::<f64>().is_finite()
            && laws.has_pressures(&y[MOTION..])
            && (0..laws.layout.cylinders).all(has_room)
    }

    /// By one-sided differences along the components that the right-hand side depends on.
    fn jacobian(&mut self, t: f64, y: &[f64; NETWORKED]) -> [[f64; NETWORKED]; NETWORKED] {
        let leading = self.network.as_ref().map_or(0, |ports| ports.drives.laws.layout.leading());
        differences(self, t, y, [0, 1].into_iter().chain(MOTION..MOTION + leading))
    }
}
