//! The reduced model in one state, read in numbers N: values, or values with derivatives along a direction.
//!
//! In: the state, the inputs, the tables. Out: [`Kinematics`], forces and accelerations. It must not know which output
//! asks.
use crate::hydraulics::network::outputs as network;
use crate::mechanism::definition::ControlState;
use crate::mechanism::dynamics::equation::{EquationOfMotion, Scratch};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::panel_force::AppliedLoads;
use crate::mechanism::linkage::Kind;
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::motion::SavedState;
use crate::mechanism::motion::acting::{airspeed, state_loads_under};
use crate::mechanism::motion::contact::{Holder, Place};
use crate::mechanism::motion::impacts::Impacts;
use crate::mechanism::motion::state::{State, engages};
use crate::mechanism::outputs::cache::{Forces, OutputCache, PresentLoads};
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError, finite};
use crate::mechanism::quantity::{Hydraulic, OneElement};
use crate::mechanism::reduced::{Reduced, StateLoads};
use crate::numerics::dual::{Differentiable, Dual, Number};
use std::sync::OnceLock;

/// The reduced model in one state under the present inputs.
pub struct View<'a, N: Reading> {
    pub reduced: &'a Reduced,
    pub inputs: &'a Inputs,
    pub state: &'a State,
    pub loads: &'a mut PresentLoads,
    pub cache: &'a mut OutputCache<N>,
    /// Cache of the values, where N carries derivatives.
    pub values: N::Values<'a>,
}

/// Outputs of hydraulics in numbers N. A library that never allows hydraulics does not contain their code.
pub struct HydraulicOutputs<N: Reading> {
    pub circuit: fn(&mut View<N>, Hydraulic) -> Result<N, OutputError>,
    pub network: fn(&mut View<N>, network::Output) -> Result<N, OutputError>,
}

/// Numbers in which the reduced model is read.
pub trait Reading: Differentiable + 'static {
    /// Access to the values beside these numbers.
    type Values<'a>;

    /// Evaluate forces and acceleration.
    ///
    /// # Errors
    /// [`OutputError`].
    fn forces(view: &mut View<Self>) -> Result<Forces<Self>, OutputError>;

    /// Outputs of hydraulics, in a library that allows hydraulics.
    fn hydraulics() -> &'static OnceLock<HydraulicOutputs<Self>>;
}

impl Reading for f64 {
    type Values<'a> = ();

    fn hydraulics() -> &'static OnceLock<HydraulicOutputs<Self>> {
        static OUTPUTS: OnceLock<HydraulicOutputs<f64>> = OnceLock::new();
        &OUTPUTS
    }

    #[inline(always)]
    fn forces(view: &mut View<Self>) -> Result<Forces<Self>, OutputError> {
        let SavedState { sigma, sigma_dot, contact, .. } = **view.state;
        let (state, reduced, locks) = (view.state, view.reduced, &view.inputs.locks);
        let mut motion = view.equation()?;
        let free = motion.settle(sigma, sigma_dot)?;
        let direction = motion.mode.direction;
        let surface = motion.clinging().and_then(|(joint, _)| motion.scratch.evaluator.regimes[joint]);
        let forces = Forces { acceleration: free, free, direction, held: None, surface, by_stop: false };
        if contact.at_rest().is_none() {
            return Ok(forces);
        }
        match contact.holder(&state.ends(reduced, locks), free) {
            Some((place, holder)) => {
                let free = pressing(&mut motion, direction, sigma)?.unwrap_or(free);
                let by_stop = holder == Holder::Stop;
                Ok(Forces { acceleration: 0.0, free, held: Some(place), by_stop, ..forces })
            }
            None => Ok(forces),
        }
    }
}

/// A mechanism that is held stays held, and drives keep their direction, as decided by the values.
impl Reading for Dual<1> {
    type Values<'a> = &'a mut OutputCache<f64>;

    fn hydraulics() -> &'static OnceLock<HydraulicOutputs<Self>> {
        static OUTPUTS: OnceLock<HydraulicOutputs<Dual<1>>> = OnceLock::new();
        &OUTPUTS
    }

    fn forces(view: &mut View<Self>) -> Result<Forces<Self>, OutputError> {
        let View { reduced, inputs, state, .. } = *view;
        let (cache, loads) = (&mut *view.values, &mut *view.loads);
        let values = *View { reduced, inputs, state, loads, cache, values: () }.forces()?;
        let (sigma, sigma_dot) = (view.sigma(), view.sigma_dot());
        let mut motion = view.equation()?;
        let mut free = match values.surface {
            Some(regime) => motion.settle_on_surface(regime, values.direction, [sigma, sigma_dot])?,
            None => motion.settle_in(values.direction, sigma, sigma_dot)?,
        };
        let mut acceleration = free;
        if values.held.is_some() {
            acceleration = Self::constant(0.0);
            free = pressing(&mut motion, values.direction, sigma)?.unwrap_or(free);
        }
        let Forces { direction, held, surface, by_stop, .. } = values;
        Ok(Forces { acceleration, free, direction, held, surface, by_stop })
    }
}

/// Acceleration of a mechanism at rest without the stop or lock that holds it, if it would start in this direction
/// against friction that sticks: static friction carries its part of the loads. None without such friction,
/// and with a driven surface, which decides on its friction alone.
fn pressing<N: Differentiable>(
    motion: &mut EquationOfMotion<'_, N>,
    direction: f64,
    sigma: N,
) -> Result<Option<N>, OutputError> {
    if direction == 0.0 || !motion.sticks() || motion.clinging().is_some() {
        return Ok(None);
    }
    Ok(Some(motion.setting_off(sigma, direction)?))
}

impl<'a, N: Reading> View<'a, N> {
    /// sigma.
    #[inline]
    pub fn sigma(&self) -> N {
        self.cache.direction.s.chain(self.state.sigma, self.cache.direction.along[0])
    }

    /// sigma_dot.
    #[inline]
    pub fn sigma_dot(&self) -> N {
        self.cache.direction.s.chain(self.state.sigma_dot, self.cache.direction.along[1])
    }

    /// The equation of motion under the present inputs, for another evaluation than that of [`Self::forces`]. Where the
    /// state decides loads, the forces found before are forgotten, as delivered forces and state loads are those of the
    /// last evaluation.
    #[inline(always)]
    pub fn equation(&mut self) -> Result<EquationOfMotion<'_, N>, OutputError> {
        let (reduced, inputs, state) = (self.reduced, self.inputs, self.state);
        let state_loads = state_loads_under(reduced, inputs)?;
        if state_loads.is_some() {
            self.cache.knows_forces = false;
        }
        let controllers = self.controllers();
        let OutputCache { scratch, direction, version, .. } = &mut *self.cache;
        if state_loads.is_some_and(|s| s.air) != scratch.air {
            *scratch = Scratch::new(state_loads);
        }
        let applied = AppliedLoads {
            version: if N::CARRIES { *version } else { inputs.version() },
            sizes: &self.loads.sizes,
            airspeed: airspeed(reduced, inputs),
            revolutions: state.revolutions,
            change: direction.change(reduced.loading()),
        };
        if let Some(circuit) = state.memory.circuit() {
            let [a, b] = circuit.pressures();
            let pressures = [(a, direction.circuit[0]), (b, direction.circuit[1])];
            scratch.set_pressures(0, pressures.map(|(value, rate)| direction.s.chain(value, rate)));
        }
        if let (Some(drives), Some(network)) = (&reduced.loading().network, state.memory.network()) {
            for cylinder in 0..drives.loads.len() {
                let first = drives.laws.layout.chamber(cylinder);
                let of = |k: usize| direction.s.chain(network.values[k], direction.circuit[k]);
                scratch.set_pressures(cylinder, [of(first), of(first + 1)]);
            }
        }
        if controllers.is_some() {
            scratch.set_controllers(controllers);
        }
        if let Some(surface) = state_loads.and_then(|own| own.friction_joints[own.clings?].surface) {
            let rate = inputs.signal.first[surface];
            scratch.set_side(state.contact.surface().map(|[side, _]| side));
            scratch.set_surface([direction.s.chain(rate, direction.surface), N::constant(0.0)]);
        }
        let of_step = if N::CARRIES { None } else { state.panel_force(scratch.air) };
        let mut equation = EquationOfMotion::new(reduced, (reduced, state_loads), applied, scratch);
        equation.scratch.panel_force.share(of_step, state.sigma);
        (equation.time, equation.mode.touching) = (direction.s, state.contact.touching());
        Ok(equation)
    }

    /// Forces and acceleration; evaluated once for a state.
    #[inline]
    pub fn forces(&mut self) -> Result<&Forces<N>, OutputError> {
        if !self.cache.knows_forces {
            self.find_forces()?;
        }
        Ok(&self.cache.forces)
    }

    #[inline(never)]
    fn find_forces(&mut self) -> Result<(), OutputError> {
        self.loads.check_driven()?;
        self.cache.forces = N::forces(self)?;
        self.cache.knows_forces = true;
        self.cache.computed.effects += 1;
        Ok(())
    }

    /// Whether friction holds the mechanism at the speed of a driven surface or at rest: there the loads overcome it in
    /// neither direction, or friction has no solution in one.
    pub fn sticking(&mut self) -> bool {
        if self.reduced.loading().surface_that_holds().is_some()
            && let Ok(Forces { surface: Some(Regime::Sticking), .. }) = self.forces()
        {
            return true;
        }
        if self.state.sigma_dot != 0.0 {
            return false;
        }
        let sigma = self.sigma();
        let Ok(mut motion) = self.equation() else { return false };
        if !motion.sticks() {
            return false;
        }
        let direction = motion.start_direction(sigma, N::constant(0.0));
        direction == Ok(0.0)
    }

    /// State loads of the last evaluation.
    #[inline]
    pub fn state_loads(&self) -> Option<&'a StateLoads> {
        self.reduced.state_loads(self.cache.scratch.air).ok().flatten()
    }

    /// Value of a switching quantity, as last evaluated.
    pub fn switching(&self, switch: usize) -> f64 {
        self.cache.scratch.evaluator.switches.seen(switch)
    }

    /// Delivered force of a sized load, after the loss of its drive if it has one; as last evaluated.
    pub fn delivered(&self, load: usize) -> N {
        let index = self.state_loads().and_then(|s| s.drives.iter().position(|l| *l == load));
        index.map_or_else(|| self.size(load), |k| self.cache.scratch.evaluator.delivered[k])
    }

    /// Delivered force of a drive, with that of its law; as last evaluated.
    pub fn delivered_by(&self, drive: usize) -> N {
        match &self.reduced.loading().drives[drive].law {
            Some(law) => self.delivered(drive) + self.delivered(law.load),
            None => self.delivered(drive),
        }
    }
}

impl<N: Reading> Kinematics<N> for View<'_, N> {
    #[inline(always)]
    fn angle(&mut self, body: usize, order: usize) -> Result<N, OutputError> {
        let body = &self.reduced.linkage().bodies[body];
        let Some(coordinate) = body.angle_coordinate else {
            return Ok(N::constant(if order == 0 { body.offset } else { 0.0 }));
        };
        let value = self.joint_position(coordinate, order)?;
        Ok(if order == 0 { value + N::constant(body.offset) } else { value })
    }

    #[inline(always)]
    fn joint_position(&mut self, coordinate: usize, order: usize) -> Result<N, OutputError> {
        let value = self.time_derivative(coordinate, order)?;
        if order > 0 {
            return Ok(value);
        }
        let revolutions = self.state.revolutions;
        let growth = if revolutions == 0.0 { 0.0 } else { revolutions * self.reduced.curve().growth(coordinate) };
        Ok(value + N::constant(growth))
    }

    #[inline]
    fn displacement(&mut self, load: usize, order: usize) -> Result<N, OutputError> {
        let loading = self.reduced.loading();
        match loading.loads[load] {
            // The slip in a pin joint.
            Load::Couple { first, second, is_idle: false, .. } if order == 1 && load >= loading.drives.len() => {
                Ok(self.angle(second, 1)? - self.angle(first, 1)?)
            }
            _ => self.tabulated_displacement(load, order),
        }
    }

    #[inline(always)]
    fn marker(&mut self, marker: usize, axis: usize, order: usize) -> Result<N, OutputError> {
        self.time_derivative(self.reduced.marker_function(marker, axis), order)
    }

    fn origin(&mut self, body: usize, axis: usize) -> Result<N, OutputError> {
        let table = self.reduced.origin(body)?;
        Ok(self.before_derivative(table, self.position(table), 3 * axis))
    }

    #[inline(never)]
    fn pressure_angle(&mut self, coupling: usize) -> Result<N, OutputError> {
        let linkage = self.reduced.linkage();
        let coupling = &linkage.couplings[coupling];
        let Kind::Cam(cam) = &coupling.kind else { return Ok(N::constant(0.0)) };
        let turned = self.angle(linkage.joints[coupling.joint].first.body, 0)? - self.angle(coupling.carrier, 0)?;
        let [angle, slope] = cam.pressure_angle(coupling.law.at(turned.value() + coupling.shift));
        Ok(turned.chain(angle, slope))
    }

    #[inline(always)]
    fn reaction(&mut self, joint: usize) -> Result<[N; 3], OutputError> {
        if self.cache.reactions[joint].0 != self.cache.version {
            self.find_reaction(joint)?;
        }
        Ok(self.cache.reactions[joint].1)
    }

    #[inline]
    fn size(&self, load: usize) -> N {
        let size = self.loads.sizes[load];
        if load < self.reduced.loading().inputs.len() {
            self.cache.direction.input(load, size)
        } else {
            N::constant(size)
        }
    }

    fn acting_force(&mut self, drive: usize) -> Result<N, OutputError> {
        self.loads.check_driven()?;
        if self.reduced.loading().drives[drive].law.is_none() {
            return Ok(self.size(drive));
        }
        let speed = self.displacement(drive, 1)?;
        Ok(self.acting(drive, speed)?.force)
    }

    fn controller(&mut self, drive: usize, state: ControlState, order: usize) -> Result<N, OutputError> {
        self.controller_of(drive, state, order)
    }

    #[inline]
    fn has_state_loads(&self) -> bool {
        !self.cache.knows_forces || self.state_loads().is_some()
    }

    #[inline]
    fn state_load(&mut self, load: usize) -> Result<N, OutputError> {
        if !self.cache.knows_forces {
            self.find_forces()?;
        }
        let index = self.state_loads().and_then(|s| s.loads.iter().position(|l| *l == load));
        Ok(index.map_or(N::constant(0.0), |k| self.cache.scratch.evaluator.loads[k]))
    }

    fn stop_force(&mut self, stop: usize) -> Result<N, OutputError> {
        let Forces { free, held, by_stop, .. } = *self.forces()?;
        let end = held.filter(|_| by_stop).and_then(|place| self.state.travel.rigid[place.side]);
        if end.is_none_or(|end| end.stop != stop) {
            return Ok(N::constant(0.0));
        }
        let load = self.reduced.loading().stops[stop].load;
        let (table, position) = self.displacement_table(load)?;
        let slope = self.before_derivative(table, position, 1);
        Ok(finite(-free / slope))
    }

    #[inline]
    fn impacts(&self, stop: usize) -> Impacts {
        self.state.impacts[stop]
    }

    fn lock_force(&mut self, lock: usize) -> Result<N, OutputError> {
        let Forces { free, held, by_stop, .. } = *self.forces()?;
        let all = &self.reduced.loading().locks;
        let (reduced, inputs, state) = (self.reduced, self.inputs, self.state);
        let engages = |lock: usize| {
            engages(reduced, &inputs.locks, state.memory.network_values(), lock) && state.has_engaged(reduced, lock)
        };
        let stop = all[lock].stop;
        let travel = &*self.state.travel;
        let holds = |place: &Place| travel.holds(*place, stop);
        let Some(place) = held.filter(holds).filter(|_| !by_stop && engages(lock)) else {
            return Ok(N::constant(0.0));
        };
        // Several locks at one place share the load evenly along the curve.
        let engaged = all.iter().enumerate().filter(|(index, _)| engages(*index));
        let sharing = engaged.filter(|(_, lock)| travel.holds(place, lock.stop)).count();
        let path = self.reduced.lock_path(lock, self.state.sigma);
        Ok(finite(-free * place.outward() / N::constant(path.norm() * sharing as f64)))
    }

    fn small_motion(&mut self) -> Result<[N; 2], OutputError> {
        let direction = self.forces()?.direction;
        let (sigma, sigma_dot) = (self.sigma(), self.sigma_dot());
        let [_, by_sigma, by_speed] = self.equation()?.gradient(direction, sigma, sigma_dot)?;
        Ok([-by_sigma, -by_speed])
    }

    fn one_element(&mut self, drive: usize, term: OneElement) -> Result<N, OutputError> {
        self.drive_term(drive, &term)
    }

    #[inline]
    fn hydraulic(&mut self, output: Hydraulic) -> Result<N, OutputError> {
        N::hydraulics().get().map_or(Ok(N::constant(0.0)), |outputs| (outputs.circuit)(self, output))
    }

    #[inline]
    fn network(&mut self, output: network::Output) -> Result<N, OutputError> {
        N::hydraulics().get().map_or(Ok(N::constant(0.0)), |outputs| (outputs.network)(self, output))
    }

    fn kinetic(&self) -> N {
        self.sigma_dot() * self.sigma_dot() * 0.5
    }

    #[inline(never)]
    fn drift(&mut self) -> N {
        let (state, reduced) = (self.state, self.reduced);
        let potential = state.load_potential(reduced, |load| self.displaced(load));
        N::constant(state.kinetic() + potential - state.reference)
    }
}
