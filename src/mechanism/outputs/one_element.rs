//! The mechanism reduced to one of its drives. Source: [CK16] sections 2 and 3.
//!
//! In: the reduced model in one state. Out: reduced mass, loads and forces along the drive. It must not know the
//! drive's kind.
use crate::mechanism::dynamics::inverse::{Demand, NoForce, toward, with_efficiency};
use crate::mechanism::motion::contact::outward;
use crate::mechanism::outputs::cache::{DriveEnd, DriveTerms};
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError, finite};
use crate::mechanism::outputs::view::{Reading, View};
use crate::mechanism::quantity::{BodyPart, OneElement};

/// Limit of a drive's displacement in a sense in which no stop ends the travel [m] or [rad].
const NO_LIMIT: f64 = 1e30;

impl<N: Reading> View<'_, N> {
    /// A term of the mechanism reduced to a drive. With S the drive's displacement, m_zS = 1 / S_sigma^2, because the
    /// reduced inertia along sigma is 1. At a dead centre, S_sigma = 0, the largest number stands for an infinite term.
    pub fn drive_term(&mut self, drive: usize, term: &OneElement) -> Result<N, OutputError> {
        if let OneElement::LowerLimit | OneElement::UpperLimit = term {
            return self.limit(drive, *term == OneElement::UpperLimit).map(N::constant);
        }
        let loading = self.reduced.loading();
        let [slope, curvature] = self.slopes_of(drive)?;
        let (sigma_dot, efficiency) = (self.sigma_dot(), loading.drives[drive].efficiency);
        let speed = slope * sigma_dot;
        let with_efficiency = |power: f64, value: N| with_efficiency(efficiency, power, value);
        let power = match efficiency {
            Some(_) => self.acting(drive, speed)?.force.value() * speed.value(),
            None => 0.0,
        };
        let value = match *term {
            OneElement::OfBody(body, part) => {
                let value = self.of_body(drive, body, part)?;
                if let BodyPart::ReducedMass | BodyPart::StaticLoad = part {
                    with_efficiency(power, value)
                } else {
                    value
                }
            }
            OneElement::ReducedMass => with_efficiency(power, N::constant(1.0) / (slope * slope)),
            OneElement::ReducedMassDerivative => with_efficiency(power, curvature * -2.0 / slope.powi(4)),
            OneElement::StaticLoad => {
                let influence = self.influence_of(drive);
                let others = self.forces()?.free - self.delivered_by(drive) * influence;
                with_efficiency(power, -others / slope)
            }
            OneElement::AdditionalForce => with_efficiency(power, curvature * (sigma_dot / slope).powi(2)),
            OneElement::RequiredForce => {
                let input = loading.inputs.len() + drive;
                let demand = self.cache.direction.input(input, self.inputs.reals[input]);
                self.force_for(drive, demand)?
            }
            OneElement::HoldingForce => {
                let others = self.others_at_rest(drive)?;
                let zero = N::constant(0.0);
                if others.value() == 0.0 && slope.value() == 0.0 { zero } else { zero - others / slope }
            }
            OneElement::HoldingForceDerivative => {
                // W = -G / S_sigma, with G the force along sigma of the other loads: W_S = W_sigma / S_sigma.
                let (others, change) = (self.others_at_rest(drive)?, self.slope_of_others(drive)?);
                let zero = N::constant(0.0);
                let rises = -change + others * curvature / slope;
                let none = slope.value() == 0.0 && others.value() == 0.0 && change.value() == 0.0;
                if none { zero } else { rises / (slope * slope) }
            }
            OneElement::BreakawayForward | OneElement::BreakawayBackward => {
                let forward = if *term == OneElement::BreakawayForward { 1.0 } else { -1.0 };
                let direction = forward * slope.value().signum();
                let force = self.required(drive, N::constant(0.0), direction, Some(direction))? / slope;
                with_efficiency(force.value() * forward, force)
            }
            OneElement::LowerLimit | OneElement::UpperLimit => N::constant(0.0),
        };
        Ok(finite(value))
    }

    /// S_sigma and S_sigma_sigma of a drive; found once for a state.
    #[inline(always)]
    pub(super) fn slopes_of(&mut self, drive: usize) -> Result<[N; 2], OutputError> {
        match &self.cache.drive {
            Some(terms) if terms.drive == drive => Ok(terms.slopes),
            _ => self.find_slopes(drive),
        }
    }

    #[inline(never)]
    fn find_slopes(&mut self, drive: usize) -> Result<[N; 2], OutputError> {
        let (table, position) = self.displacement_table(drive)?;
        let slopes = self.with_derivative(table, position, 1);
        self.cache.drive = Some(DriveTerms { drive, slopes, influence: None });
        Ok(slopes)
    }

    /// S_sigma of a drive as the equation of motion has it; found once for a state.
    #[inline]
    fn influence_of(&mut self, drive: usize) -> N {
        match &self.cache.drive {
            Some(DriveTerms { drive: own, influence: Some(influence), .. }) if *own == drive => *influence,
            _ => self.find_influence(drive),
        }
    }

    #[inline(never)]
    fn find_influence(&mut self, drive: usize) -> N {
        let influence = self.influence(drive);
        if let Some(terms) = self.cache.drive.as_mut().filter(|terms| terms.drive == drive) {
            terms.influence = Some(influence);
        }
        influence
    }

    /// sigma_ddot, known before, where it depends on no speed and no direction: the state decides no load, so that each
    /// drive delivers the size of its load.
    #[inline]
    fn unconditional(&self) -> Option<N> {
        (self.cache.knows_forces && self.state_loads().is_none()).then_some(self.cache.forces.free)
    }

    /// Least or largest displacement of a drive that stops and locks leave [m] or [rad]: the present one while a rigid
    /// stop or a lock holds the mechanism, else that at the rigid stop that ends the travel in this sense.
    /// -[`NO_LIMIT`] or [`NO_LIMIT`] where none does, and where the drive is at a dead centre or passes one before.
    #[inline(never)]
    fn limit(&mut self, drive: usize, upper: bool) -> Result<f64, OutputError> {
        let state = self.state;
        let none = if upper { NO_LIMIT } else { -NO_LIMIT };
        let slope = self.slopes_of(drive)?[0].value();
        if slope == 0.0 {
            return Ok(none);
        }
        let side = usize::from((slope > 0.0) == upper);
        let here = self.displaced(drive);
        if let Some(place) = state.contact.at_rest() {
            let ends = state.ends(self.reduced, &self.inputs.locks);
            let holds = |place| ends.is_fast(place) || place.bumper().is_none() && place.side == side;
            if holds(place) || ends.at(state.sigma).any(holds) {
                return Ok(here);
            }
        }
        let Some(end) = state.travel.rigid[side] else { return Ok(none) };
        let [there, slope_there] = self.at_end(drive, side, end.position)?;
        // The displacement rises or falls on all the way.
        let ahead = (there - here) * slope * outward(side) >= 0.0 && slope_there * slope > 0.0;
        Ok(if ahead { there } else { none })
    }

    /// Displacement of a drive and S_sigma at the rigid stop at one end of the travel; found once.
    fn at_end(&mut self, drive: usize, side: usize, position: f64) -> Result<[f64; 2], OutputError> {
        let reduced = self.reduced;
        let stretch = reduced.stretch;
        let is_it = |end: &DriveEnd| (end.drive, end.position, end.stretch) == (drive, position, stretch);
        if let Some(end) = self.cache.ends[side].filter(is_it) {
            return Ok(end.values);
        }
        let (sigma, revolutions) = reduced.unwound(position);
        let (table, place) = reduced.at(sigma).displacement_around(drive, sigma)?;
        let there = reduced.displacement_at(drive, sigma, place.panel) + revolutions * reduced.load_growth(drive);
        let values = [there, table.value(place, 1)];
        self.cache.ends[side] = Some(DriveEnd { drive, position, stretch, values });
        Ok(values)
    }

    /// Whether friction locks the mechanism against a drive: the force for the demanded acceleration, or one of the two
    /// forces that begin to move the mechanism from rest, does not exist, because the drive's own reactions cause more
    /// friction than the drive overcomes.
    pub fn self_locking(&mut self, drive: usize) -> bool {
        [OneElement::RequiredForce, OneElement::BreakawayForward, OneElement::BreakawayBackward]
            .into_iter()
            .any(|term| matches!(self.drive_term(drive, &term), Err(OutputError::SelfLocking(_))))
    }

    /// Force along sigma of all loads but one drive, at rest, without friction and losses.
    fn others_at_rest(&mut self, drive: usize) -> Result<N, OutputError> {
        let (sigma, influence) = (self.sigma(), self.influence_of(drive));
        if let Some(at_rest) = self.unconditional() {
            return Ok(at_rest - self.size(drive) * influence);
        }
        let mut equation = self.equation()?;
        equation.mode.still = true;
        let at_rest = equation.heading(0.0, sigma, N::constant(0.0))?;
        Ok(at_rest - self.delivered_by(drive) * influence)
    }

    /// Derivative along sigma of [`Self::others_at_rest`].
    fn slope_of_others(&mut self, drive: usize) -> Result<N, OutputError> {
        let (sigma, influence_slope) = (self.sigma(), self.influence_slope(drive));
        if self.unconditional().is_some()
            && let Some(slope) = self.cache.scratch.panel_force.slope_of_force(sigma)
        {
            return Ok(slope - self.size(drive) * influence_slope);
        }
        // A drive with a circuit gives what its pressures do, one with a law what that has at rest, as evaluated there.
        let loading = self.reduced.loading();
        let has_circuit = loading.hydraulic_loads().contains(&drive);
        let is_own = has_circuit || loading.drives[drive].law.is_some();
        let size = if is_own { self.delivered_by(drive) } else { self.size(drive) };
        let influence = self.influence_of(drive);
        let mut equation = self.equation()?;
        equation.mode.still = true;
        let at_rest = equation.slope_at_rest(sigma)?;
        let rises = if is_own { equation.slope_of_delivered(drive) } else { N::constant(0.0) };
        Ok(at_rest - size * influence_slope - rises * influence)
    }

    /// Force of a drive for an acceleration of it: inverse dynamics, [CK16] eqs. (16), (37).
    #[inline]
    pub fn force_for(&mut self, drive: usize, acceleration: N) -> Result<N, OutputError> {
        let [slope, curvature] = self.slopes_of(drive)?;
        let (sigma_dot, efficiency) = (self.sigma_dot(), self.reduced.loading().drives[drive].efficiency);
        let speed = (slope * sigma_dot).value();
        let along = (acceleration - curvature * sigma_dot * sigma_dot) / slope;
        let direction = toward(sigma_dot.value(), along.value());
        let force = self.required(drive, along, direction, None)? / slope;
        let rate = if speed == 0.0 { acceleration.value() } else { speed };
        Ok(with_efficiency(efficiency, force.value() * rate, force))
    }

    /// Force along sigma that a drive must give, for an acceleration along the curve, or with `breakaway` to begin to
    /// move in this direction.
    ///
    /// # Errors
    /// [`OutputError::SelfLocking`]: no force of this drive does it.
    fn required(
        &mut self,
        drive: usize,
        acceleration: N,
        direction: f64,
        breakaway: Option<f64>,
    ) -> Result<N, OutputError> {
        let (sigma, sigma_dot, influence) = (self.sigma(), self.sigma_dot(), self.influence_of(drive));
        if let Some(free) = self.unconditional() {
            return Ok(acceleration - (free - self.size(drive) * influence));
        }
        let demand = Demand { drive: (drive, influence), acceleration, direction, breakaway };
        self.equation()?.required(sigma, sigma_dot, &demand).map_err(|none| match none {
            NoForce::Locked => OutputError::Locked,
            NoForce::SelfLocking => OutputError::SelfLocking(drive),
        })
    }
}
