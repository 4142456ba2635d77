//! Saved states: the part of a state of motion that decides how it continues, with the memory of the integration.
//!
//! In: a state, or a record. Out: a state that continues bit for bit as the saved one would have. It must not know
//! outputs.
use super::acting::{blows, state_loads};
use super::memory::{CircuitState, Memory};
use crate::codec::record::{Damaged, Record};
use crate::mechanism::dynamics::hydraulic::border_of;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::contact::{BumperPlaces, Contact, EngagedLocks, Place, RigidEnd, Travel};
use crate::mechanism::motion::elapsed::Elapsed;
use crate::mechanism::motion::events::Event;
use crate::mechanism::motion::impacts::Impacts;
use crate::mechanism::motion::prescribed::PrescribedState;
use crate::mechanism::motion::travel::set_forces_of_locks;
use crate::mechanism::reduced::{Reduced, StateLoads};
use std::sync::Arc;

/// Part of a closed curve's length by which sigma may be beyond its ends by rounding.
const ROUNDING: f64 = 1e-12;
/// Most revolutions, so that one more of them still counts.
pub const MOST_REVOLUTIONS: f64 = 1e15;

/// The part of a state of motion that decides how it continues.
#[derive(Clone, Debug, Default)]
pub struct SavedState {
    /// Length along the curve; on a closed curve within its first revolution.
    pub sigma: f64,
    /// Its rate.
    pub sigma_dot: f64,
    /// Whole revolutions of a closed curve made so far.
    pub revolutions: f64,
    pub contact: Contact,
    /// Found at the start; all states of a run share it.
    pub travel: Arc<Travel>,
    pub applied: Applied,
    /// Energy at the start, plus the work of changing sizes, less the energy lost since.
    pub reference: f64,
    /// Time since the start, or that of the host; counted if there are stops.
    pub time: Elapsed,
    /// Impacts on each stop.
    pub impacts: Vec<Impacts>,
    pub memory: Memory,
    /// The prescribed motion of a drive; none where no drive has a motion.
    pub prescribed: Option<PrescribedState>,
}

/// The inputs as the last step has applied them, which the integration and the energy balance refer to.
#[derive(Clone, Debug, Default)]
pub struct Applied {
    /// [`Inputs::version`] of these inputs; 0 where they are to be applied anew: in a state that was read, after a step
    /// in which they changed with time, and after one that failed.
    pub version: u64,
    /// Sizes of the loads.
    pub sizes: Vec<f64>,
    /// Airspeed at the start of the step [m/s].
    pub airspeed: f64,
    /// Whether air has acted on the surfaces at any time of the step.
    pub air: bool,
    /// Places where a lock is engaged.
    pub locked: EngagedLocks,
}

impl Applied {
    /// Whether nothing of these inputs is to be applied.
    #[inline(always)]
    pub fn are_in_force(&self, inputs: &Inputs) -> bool {
        self.version == inputs.version()
    }

    /// Become the same as another one of this mechanism, without allocation.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        self.sizes.copy_from_slice(&other.sizes);
        (self.version, self.locked) = (other.version, other.locked);
        (self.airspeed, self.air) = (other.airspeed, other.air);
    }
}

impl SavedState {
    /// Become the same as another one of this mechanism, without allocation.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        self.applied.copy_from(&other.applied);
        (self.sigma, self.sigma_dot, self.revolutions) = (other.sigma, other.sigma_dot, other.revolutions);
        self.contact = other.contact;
        if !Arc::ptr_eq(&self.travel, &other.travel) {
            self.travel = Arc::clone(&other.travel);
        }
        (self.reference, self.time) = (other.reference, other.time);
        self.impacts.clone_from(&other.impacts);
        self.memory.copy_from(&other.memory);
        if other.prescribed.is_some() {
            self.prescribed = other.prescribed;
        }
    }

    /// The loads that the state decides, as in the last step.
    #[inline]
    pub fn state_loads<'a>(&self, reduced: &'a Reduced) -> Result<Option<&'a StateLoads>, ModelError> {
        state_loads(reduced.at(self.sigma), self.applied.air, self.revolutions)
    }

    /// Read one for this reduced model.
    ///
    /// # Errors
    /// A field is not what this mechanism can have.
    pub fn read(record: &mut Record, reduced: &Reduced) -> Result<Self, ModelError> {
        let stops = reduced.loading().stops.iter().enumerate();
        let bumpers = stops.filter(|(_, stop)| stop.enabled && !stop.rigid);
        let bumpers = bumpers.map(|(stop, _)| BumperPlaces { stop, ..BumperPlaces::default() }).collect();
        let travel = Arc::new(Travel { bumpers, ends_meet: reduced.ends_meet(), ..Travel::default() });
        let impacts = vec![Impacts::default(); reduced.loading().stops.len()];
        let applied = Applied { sizes: vec![0.0; reduced.components().sized], ..Applied::default() };
        let mut saved = Self { applied, travel, impacts, ..Self::default() };
        if reduced.loading().hydraulics.is_some() {
            saved.memory = Memory::with_circuit(CircuitState::default(), reduced.loading().ports())?;
        }
        if reduced.loading().network.is_some() {
            saved.memory = Memory::with_network(CircuitState::default(), reduced.loading().ports())?;
        }
        if reduced.loading().control_states().next().is_some() {
            saved.memory = Memory::with_control(CircuitState::default())?;
        }
        saved.prescribed = reduced.can_prescribe().then(PrescribedState::default);
        saved.record(record)?;
        saved.check(reduced)?;
        for end in Arc::make_mut(&mut saved.travel).rigid.iter_mut().flatten() {
            end.restitution = reduced.loading().stops[end.stop].restitution;
        }
        set_forces_of_locks(Arc::make_mut(&mut saved.travel), reduced)?;
        Ok(saved)
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.finite("sigma", &mut self.sigma)?;
        record.finite("sigma_dot", &mut self.sigma_dot)?;
        let allowed = |revolutions: f64| revolutions.fract() == 0.0 && revolutions.abs() <= MOST_REVOLUTIONS;
        record.number("turns", &mut self.revolutions, allowed, "a whole number")?;
        self.contact.record(record)?;
        match record.reads() {
            true => record_travel(Arc::make_mut(&mut self.travel), record)?,
            false => record_travel(&mut Travel::clone(&self.travel), record)?,
        }
        record.length("sizes", self.applied.sizes.len())?;
        record.all_finite("size", &mut self.applied.sizes)?;
        record.finite("airspeed", &mut self.applied.airspeed)?;
        record.flag("drag of the air", &mut self.applied.air)?;
        record.finite("energy", &mut self.reference)?;
        self.time.record(record)?;
        record.length("stops", self.impacts.len())?;
        self.impacts.iter_mut().try_for_each(|impacts| impacts.record(record))?;
        let mut with_dissipation = !matches!(self.memory, Memory::Conservative(..));
        record.flag("energy lost integrated", &mut with_dissipation)?;
        self.memory.set_dissipation(with_dissipation);
        self.prescribed.iter_mut().try_for_each(|prescribed| prescribed.record(record))?;
        match &mut self.memory {
            Memory::Conservative(integrator, lookahead) => {
                integrator.record(record)?;
                lookahead.record(record)
            }
            Memory::WithDissipation(integrator, lookahead) => {
                integrator.record(record)?;
                lookahead.record(record)
            }
            Memory::WithHydraulics(motion) => motion.record(record),
        }
    }

    /// Refuse what this mechanism cannot have.
    fn check(&self, reduced: &Reduced) -> Result<(), ModelError> {
        let refuse = |what: String| Err(Damaged::new(what).into());
        let (first, last) = reduced.curve().range;
        let slack = reduced.period().map_or(0.0, |period| ROUNDING * period);
        if reduced.is_open() {
            if let Err((stretch, _)) = reduced.reach(self.sigma) {
                let (first, last) = stretch.curve().range;
                return refuse(format!(
                    "position along the path (sigma) = {}: the program cannot compute the path up to this position; \
                     the last part of the path that can be computed is from sigma = {first} to sigma = {last}",
                    self.sigma
                ));
            }
        } else if !(first - slack..=last + slack).contains(&self.sigma) {
            return refuse(format!("position along the path (sigma) = {}: must be from {first} to {last}", self.sigma));
        }
        if reduced.period().is_none() && self.revolutions != 0.0 {
            return refuse(format!(
                "number of cycles (turns) = {}: must be 0, because the motion is not a cycle",
                self.revolutions
            ));
        }
        let (loading, Applied { sizes, air, airspeed, .. }) = (reduced.loading(), &self.applied);
        if (*air && loading.air.is_none()) || (!air && blows(reduced, *airspeed)) {
            return refuse(format!("drag of the air = {air}: this value does not agree with the airspeed {airspeed}"));
        }
        for (end, rigid) in self.travel.stops() {
            if loading.stops.get(end).is_none_or(|stop| !stop.enabled || rigid && !stop.rigid) {
                return refuse(format!("stop = {end}: the mechanism has no enabled stop of this type with this index"));
            }
        }
        let is_place = |place: Place| self.travel.position(place).is_some();
        if self.contact.at_rest().is_some_and(|place| !is_place(place)) {
            return refuse(
                "the saved mechanism is at rest at a stop, but there is no stop at the saved position".into(),
            );
        }
        if self.contact.arrival().is_some_and(|place| self.travel.stop(place).is_none() || !is_place(place)) {
            return refuse("the saved mechanism arrives at a stop, but there is no stop at the saved position".into());
        }
        let state_loads = self.state_loads(reduced)?;
        let (bumpers, touching) = (state_loads.map_or(0, |s| s.bumpers.len()), self.contact.touching());
        if !touching.is_below(bumpers) {
            return refuse(format!("index of a bumper in contact: must be below {bumpers}"));
        }
        let constants = &sizes[loading.inputs.len()..];
        if constants.iter().zip(&loading.constants).any(|(a, b)| a.to_bits() != b.to_bits()) {
            return refuse("the saved constant loads do not agree with the saved parameters".into());
        }
        if let Some(event) = self.memory.event_ahead() {
            let (exists, what) = match event {
                Event::Regime(joint) => (
                    joint < state_loads.map_or(0, |s| s.friction_joints.len()),
                    format!(
                        "index of the saved event = {joint}: the mechanism has no joint with friction that has \
                             this index"
                    ),
                ),
                Event::Bumper(bumper) | Event::Engages(bumper) => (
                    bumper < bumpers,
                    format!("index of the saved event = {bumper}: the mechanism has no bumper that has this index"),
                ),
                Event::Stop(place) => {
                    (is_place(place), "next event: there is no stop at the position of the event".into())
                }
                Event::Border(border) => {
                    let own = state_loads.map_or(0, StateLoads::borders);
                    let of_circuit = |border| {
                        let (drive, network) = (loading.hydraulics.as_ref(), loading.network.as_ref());
                        drive.is_some_and(|drive| border_of(&drive.laws, border).is_some())
                            || network.is_some_and(|network| network.laws.border(border).is_some())
                    };
                    let what =
                        "the mechanism has no friction table, curve, cushion, pump or valve edge with this index";
                    let is_one = border.checked_sub(own).is_none_or(of_circuit);
                    (is_one, format!("index of the saved event = {border}: {what}"))
                }
                Event::Knot(_) => (
                    reduced.has_knots(),
                    "next event: no curve of a coupling or a spring has a point at the position of the event".into(),
                ),
                Event::Switch(switch) => (
                    switch < state_loads.map_or(0, StateLoads::switches),
                    format!(
                        "index of the saved event = {switch}: the mechanism has no change of sign that has this \
                             index"
                    ),
                ),
                Event::Level(lock) => (
                    loading.network.as_ref().is_some_and(|network| lock < network.laws.locks.len()),
                    format!(
                        "index of the saved event = {lock}: the mechanism has no pressure lock that has this \
                             index"
                    ),
                ),
                Event::Reversal | Event::Undefined => (true, String::new()),
            };
            if !exists {
                return refuse(what);
            }
        }
        // The energy lost is integrated if there are state loads, and in steps with inputs that change.
        if state_loads.is_some() && matches!(self.memory, Memory::Conservative(..)) {
            return refuse("the saved integration method does not agree with the saved parameters".into());
        }
        Ok(())
    }
}

/// The places of the stops, written or read. Which bumpers there are, and all else of a stop, follows from the
/// parameters.
fn record_travel(travel: &mut Travel, record: &mut Record) -> Result<(), Damaged> {
    for end in &mut travel.rigid {
        record.option("end of the travel", end, RigidEnd::default, |record, end| {
            record.finite("end of the travel", &mut end.position)?;
            record.finite("slope at the end of the travel", &mut end.slope)?;
            record.place("stop", &mut end.stop, usize::MAX)
        })?;
    }
    record.length("bumpers", travel.bumpers.len())?;
    for bumper in &mut travel.bumpers {
        for position in &mut bumper.positions {
            record.option("place of a bumper", position, f64::default, |record, position| {
                record.finite("place of a bumper", position)
            })?;
        }
        record.all_finite("slope at a bumper", &mut bumper.slopes)?;
    }
    let mut count = travel.beside.len();
    record.place("stops next to a rigid stop", &mut count, usize::MAX)?;
    for k in 0..count {
        // The list grows entry by entry, so that a false count ends with the record.
        let (mut side, mut stop) = travel.beside.get(k).copied().unwrap_or_default();
        record.place("side of a stop", &mut side, 2)?;
        record.place("stop", &mut stop, usize::MAX)?;
        if record.reads() {
            travel.beside.push((side, stop));
        }
    }
    Ok(())
}
