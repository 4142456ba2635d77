//! Outputs on demand: each from its table, at the present state, under the present inputs.
use super::State;
use super::motion::{Folded, Motion, effective};
use crate::linkage::Freedom;
use crate::reduced::Reduced;
use crate::table::{Table, Unresolved};
use crate::variables::{OneElement, Output, ReactionPart};

/// What several outputs of one state share.
#[derive(Clone, Debug)]
pub struct Cache {
    acceleration: Option<f64>,
    /// Force x, force y and moment of each joint.
    reactions: Vec<Option<[f64; 3]>>,
    /// Whether a reaction has been computed in this state.
    used: bool,
    /// Sizes of the sized loads under the present inputs.
    sizes: Vec<f64>,
    /// Right-hand side for these sizes.
    folded: Folded,
}

impl Cache {
    pub fn new(reduced: &Reduced, inputs: &[f64]) -> Self {
        Self {
            acceleration: None,
            reactions: vec![None; reduced.linkage().joints.len()],
            used: false,
            sizes: reduced.sizes(inputs),
            folded: Folded::default(),
        }
    }

    /// The state has changed.
    pub fn forget(&mut self) {
        self.acceleration = None;
        if self.used {
            self.reactions.fill(None);
            self.used = false;
        }
    }

    /// An input has changed; those beyond the sized loads size nothing.
    pub fn set(&mut self, input: usize, loads: usize, value: f64) {
        if input < loads {
            self.sizes[input] = value;
            self.folded = Folded::default();
        }
        self.forget();
    }

    /// The way in which sigma is counted has changed.
    pub fn recount(&mut self) {
        self.folded = Folded::default();
    }
}

impl State {
    /// Value of an output under these inputs.
    ///
    /// # Errors
    /// [`Unresolved`]: its table cannot be built.
    pub fn output(&mut self, reduced: &Reduced, inputs: &[f64], output: Output) -> Result<f64, Unresolved> {
        match output {
            Output::Turn { body, order } => {
                let body = &reduced.linkage().bodies[body];
                let Some(turn) = body.turn else { return Ok(0.0) };
                let value = self.coordinate(reduced, turn, order)?;
                Ok(if order == 0 { value + body.offset } else { value })
            }
            Output::Slide { coordinate, order } => self.coordinate(reduced, coordinate, order),
            Output::Reaction { joint, part } => {
                let [x, y, moment] = self.reaction(reduced, joint)?;
                Ok(match part {
                    ReactionPart::X => x,
                    ReactionPart::Y => y,
                    ReactionPart::Magnitude => x.hypot(y),
                    ReactionPart::Moment => moment,
                })
            }
            Output::Displacement { load, order: 0 } => Ok(self.displacement(reduced, load)),
            Output::Displacement { load, order } => {
                let table = checked(reduced.displacement(load))?;
                Ok(self.derivative(table, 0, reduced, order))
            }
            Output::OneElement { drive, term } => {
                let demand = inputs.get(reduced.loading().inputs.len() + drive).copied().unwrap_or(0.0);
                self.one_element(reduced, drive, term, demand)
            }
            Output::Pull { spring } => {
                let spring = &reduced.loading().springs[spring];
                let pull = spring.pull(self.displacement(reduced, spring.load));
                if spring.damping == 0.0 {
                    return Ok(pull);
                }
                let table = checked(reduced.displacement(spring.load))?;
                Ok(pull + spring.damping * self.derivative(table, 0, reduced, 1))
            }
            Output::Marker { marker, axis, order } => {
                let table = checked(reduced.marker(marker))?;
                Ok(self.derivative(table, 3 * axis, reduced, order))
            }
            Output::Kinetic => Ok(self.kinetic()),
            Output::Potential => {
                let gravity = match reduced.loading().gravity {
                    Some(load) => -inputs[load] * self.displacement(reduced, load),
                    None => 0.0,
                };
                Ok(gravity + self.spring_energy(reduced))
            }
            Output::Drift => Ok(self.kinetic() + self.load_potential(reduced) - self.reference),
        }
    }

    /// T = sigma_dot^2 / 2 [J]: sigma is the length in the kinetic metric.
    pub fn kinetic(&self) -> f64 {
        0.5 * self.sigma_dot * self.sigma_dot
    }

    /// Potential of all loads at the applied sizes: less the sum of size times displacement, and the springs' energy [J].
    pub fn load_potential(&self, reduced: &Reduced) -> f64 {
        let mut sum = self.spring_energy(reduced);
        for (load, size) in self.applied.iter().enumerate() {
            if *size != 0.0 {
                sum -= size * self.displacement(reduced, load);
            }
        }
        sum
    }

    fn spring_energy(&self, reduced: &Reduced) -> f64 {
        let mut sum = 0.0;
        for spring in &reduced.loading().springs {
            sum += spring.energy(self.displacement(reduced, spring.load));
        }
        sum
    }

    /// Displacement of a load, counted on over whole turns.
    pub fn displacement(&self, reduced: &Reduced, load: usize) -> f64 {
        let growth = if self.turns == 0.0 { 0.0 } else { self.turns * reduced.load_growth(load) };
        reduced.displacement_at(load, self.sigma) + growth
    }

    fn influence(&self, reduced: &Reduced, load: usize) -> f64 {
        let table = reduced.influence();
        table.value(table.spot(self.sigma), load)
    }

    /// sigma_ddot under the present inputs.
    fn acceleration(&mut self, reduced: &Reduced) -> f64 {
        if let Some(value) = self.cache.acceleration {
            return value;
        }
        let Cache { sizes, folded, .. } = &mut self.cache;
        let mut motion = Motion { reduced, sizes, turns: self.turns, folded };
        let value = motion.acceleration(self.sigma, self.sigma_dot);
        self.cache.acceleration = Some(value);
        value
    }

    /// A coordinate (order 0) or its time derivative.
    fn coordinate(&mut self, reduced: &Reduced, coordinate: usize, order: usize) -> Result<f64, Unresolved> {
        let table = checked(reduced.coordinates())?;
        let value = self.derivative(table, 3 * coordinate, reduced, order);
        Ok(if order == 0 { value + self.turns * reduced.growth(coordinate) } else { value })
    }

    /// Time derivative of a function whose table has it and its two derivatives along sigma from component `first` on.
    fn derivative(&mut self, table: &Table, first: usize, reduced: &Reduced, order: usize) -> f64 {
        let spot = table.spot(self.sigma);
        match order {
            0 => table.value(spot, first),
            1 => table.value(spot, first + 1) * self.sigma_dot,
            _ => {
                let acceleration = self.acceleration(reduced);
                let bend = table.value(spot, first + 2);
                table.value(spot, first + 1) * acceleration + bend * self.sigma_dot * self.sigma_dot
            }
        }
    }

    /// How much of what arrives of a drive is as in forward motion ([`Motion::forward_share`]).
    fn forward_share(&mut self, reduced: &Reduced) -> f64 {
        let Cache { sizes, folded, .. } = &mut self.cache;
        Motion { reduced, sizes, turns: self.turns, folded }.forward_share(self.sigma, self.sigma_dot)
    }

    /// What arrives of a sized load, after the loss of its drive if it has one.
    fn arriving(&mut self, reduced: &Reduced, load: usize) -> f64 {
        let size = self.cache.sizes[load];
        match reduced.loading().drives.get(load).and_then(|d| d.efficiency) {
            Some(efficiency) => {
                let forward = self.influence(reduced, load).signum();
                let share = self.forward_share(reduced);
                share * effective(size, forward, efficiency) + (1.0 - share) * effective(size, -forward, efficiency)
            }
            None => size,
        }
    }

    /// Force along sigma of everything but one drive: at rest, or with the dampers at the present speed.
    fn others(&mut self, reduced: &Reduced, drive: usize, moving: bool) -> f64 {
        let table = reduced.influence();
        let spot = table.spot(self.sigma);
        let components = reduced.components();
        let mut sum = 0.0;
        for load in (0..components.sized).filter(|l| *l != drive) {
            sum += self.arriving(reduced, load) * table.value(spot, load);
        }
        sum += components.springs.map_or(0.0, |k| table.value(spot, k));
        sum += components.winding.map_or(0.0, |k| self.turns * table.value(spot, k));
        if moving { sum - components.damping.map_or(0.0, |k| self.sigma_dot * table.value(spot, k)) } else { sum }
    }

    /// A term of the mechanism reduced to a drive. With S the drive's displacement, m_zS = 1 / S_sigma^2, because the
    /// reduced inertia along sigma is 1.
    fn one_element(
        &mut self,
        reduced: &Reduced,
        drive: usize,
        term: OneElement,
        demand: f64,
    ) -> Result<f64, Unresolved> {
        let table = checked(reduced.displacement(drive))?;
        let spot = table.spot(self.sigma);
        let (slope, bend) = (table.value(spot, 1), table.value(spot, 2));
        let speed = slope * self.sigma_dot;
        let efficiency = reduced.loading().drives[drive].efficiency;
        // [CK16] 2.3: eta divides where power flows in and multiplies where it flows back; at rest it divides.
        let lossy = |power: f64, value: f64| match efficiency {
            Some(eta) if power < 0.0 => value * eta,
            Some(eta) => value / eta,
            None => value,
        };
        let present = self.cache.sizes[drive] * speed;
        let value = match term {
            OneElement::ReducedMass => lossy(present, 1.0 / (slope * slope)),
            OneElement::ReducedMassDerivative => lossy(present, -2.0 * bend / slope.powi(4)),
            OneElement::StaticLoad => lossy(present, -self.others(reduced, drive, true) / slope),
            OneElement::AdditionalForce => lossy(present, bend * (self.sigma_dot / slope).powi(2)),
            OneElement::RequiredForce => {
                let acceleration = (demand - bend * self.sigma_dot * self.sigma_dot) / slope;
                let force = (acceleration - self.others(reduced, drive, true)) / slope;
                let moving = if speed == 0.0 { demand } else { speed };
                lossy(force * moving, force)
            }
            OneElement::HoldingForce => {
                let others = self.others(reduced, drive, false);
                if others == 0.0 { 0.0 } else { -others / slope }
            }
        };
        Ok(finite(value))
    }

    fn reaction(&mut self, reduced: &Reduced, joint: usize) -> Result<[f64; 3], Unresolved> {
        if let Some(value) = self.cache.reactions[joint] {
            return Ok(value);
        }
        let terms = 2 + reduced.loading().loads.len();
        let exact;
        let component: &dyn Fn(usize) -> f64 = match reduced.reaction(joint) {
            Ok(table) => {
                let spot = table.spot(self.sigma);
                &move |k| table.value(spot, k)
            }
            Err(_) => {
                exact = reduced.exact_reaction(joint, self.sigma);
                &|k| exact[k]
            }
        };
        // A revolute joint transmits no moment.
        let parts = if reduced.linkage().joints[joint].freedom == Freedom::Turn { 2 } else { 3 };
        let mut value = [0.0; 3];
        let mut add = |term: usize, size: f64| {
            for (part, sum) in value.iter_mut().enumerate().take(parts) {
                *sum += size * component(part * terms + term);
            }
        };
        add(0, self.acceleration(reduced));
        add(1, self.sigma_dot * self.sigma_dot);
        for load in 0..reduced.components().sized {
            let size = self.arriving(reduced, load);
            add(2 + load, size);
        }
        for (place, spring) in reduced.loading().springs.iter().enumerate() {
            let pull = self.output(reduced, &[], Output::Pull { spring: place })?;
            add(2 + spring.load, -pull);
        }
        let value = value.map(finite);
        self.cache.reactions[joint] = Some(value);
        self.cache.used = true;
        Ok(value)
    }
}

fn checked<'a>(table: Result<&'a Table, &Unresolved>) -> Result<&'a Table, Unresolved> {
    table.map_err(Clone::clone)
}

/// At a dead centre of a drive no finite force or mass has the effect, and at some flat positions no finite reaction: the
/// largest finite number stands for it.
fn finite(value: f64) -> f64 {
    if value.is_nan() { f64::MAX } else { value.clamp(-f64::MAX, f64::MAX) }
}
