//! A particle of 1 kg on a line: a force that changes with time, stops, a drive with losses, friction under a constant
//! normal force.
use super::{G, TOLERANCE};
use crate::integrator::{Integrator, System};
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::laws::friction::{Law, Regime};
use crate::mechanism::motion::advance::{Advance, Progress};
use crate::mechanism::motion::contact::{BumperPlaces, Contact, Ends, EngagedLocks, RigidEnd, Travel, outward};
use crate::mechanism::motion::dynamics::Dynamics;
use crate::mechanism::motion::step_ahead::Lookahead;
use crate::mechanism::motion::witness::Witness;
use crate::numerics::enclosure::Enclosure;
use crate::numerics::table::TablePosition;

/// A bumper of the particle.
#[derive(Clone, Copy)]
pub(super) struct Bumper {
    pub(super) side: usize,
    /// Stiffness [N/m], damping [N.s/m] and position [m].
    pub(super) law: [f64; 3],
}

/// A stop of the particle.
#[derive(Clone, Copy)]
pub(super) enum Stop {
    /// Side, position [m], restitution.
    Rigid(usize, f64, f64),
    Bumper(Bumper),
}

/// A particle of 1 kg under a force that changes with time.
#[derive(Default)]
pub(super) struct Particle {
    pub(super) t: f64,
    /// Force [N], and its rate [N/s].
    pub(super) force: [f64; 2],
    /// Second time derivative of the force [N/s2].
    pub(super) bend: f64,
    pub(super) bumpers: Vec<Bumper>,
    pub(super) touching: BumperSet,
    /// Force [N] and efficiency of a drive.
    pub(super) drive: Option<[f64; 2]>,
    pub(super) direction: f64,
    /// Law of friction, normal force [N].
    pub(super) friction: Option<(Law, f64)>,
    /// Regimes of friction, the present one last.
    pub(super) regimes: Vec<Regime>,
}

impl Particle {
    pub(super) fn drive_force(&self, direction: f64) -> f64 {
        self.drive.map_or(0.0, |[force, efficiency]| match direction * force {
            0.0 => force,
            power if power > 0.0 => force * efficiency,
            _ => force / efficiency,
        })
    }

    pub(super) fn friction_force(&self, v: f64, regime: Option<Regime>) -> f64 {
        self.friction.map_or(0.0, |(law, normal)| -normal * law.cubic(regime.unwrap_or(law.regime(v))).at(v))
    }

    pub(super) fn acceleration_at(&mut self, t: f64, x: f64, v: f64, regime: Option<Regime>) -> f64 {
        let pushing = (0..self.bumpers.len()).filter(|&k| self.touching.contains(k)).collect::<Vec<_>>();
        let push =
            pushing.iter().fold(0.0, |sum, &k| sum - outward(self.bumpers[k].side) * self.bumper_push(k, x, v).1);
        let [force, rate] = self.force;
        force
            + t * (rate + 0.5 * t * self.bend)
            + push
            + self.drive_force(self.direction)
            + self.friction_force(v, regime)
    }
}

impl System<3> for Particle {
    fn derivative(&mut self, t: f64, &[x, v, _]: &[f64; 3]) -> [f64; 3] {
        let regime = self.regimes.last().copied();
        [v, self.acceleration_at(t, x, v, regime), -self.friction_force(v, regime) * v]
    }

    fn scale(&mut self, y: &[f64; 3], f: &[f64; 3]) -> [f64; 3] {
        let speed = y[1].abs().max(f[1].abs().sqrt()).max(1e-12);
        [1.0, speed, speed * speed]
    }
}

impl Dynamics<3> for Particle {
    fn set_time(&mut self, t: f64) {
        self.t = t;
    }

    fn inputs_change(&self) -> bool {
        self.force[1] != 0.0 || self.bend != 0.0
    }

    fn free_acceleration(&mut self, x: f64, v: f64) -> Result<f64, Locked> {
        Ok(self.acceleration_at(self.t, x, v, None))
    }

    fn length(&self) -> f64 {
        1.0
    }

    fn set_touching(&mut self, touching: BumperSet) {
        self.touching = touching;
    }

    fn bumper_push(&mut self, bumper: usize, x: f64, v: f64) -> (f64, f64) {
        let Bumper { side, law: [stiffness, damping, position] } = self.bumpers[bumper];
        let beyond = (x - position) * outward(side);
        (beyond, stiffness * beyond + damping * v * outward(side))
    }

    fn bumper_bounds(&mut self, bumper: usize, x: Enclosure, v: Enclosure) -> [Enclosure; 2] {
        let Bumper { side, law: [stiffness, damping, position] } = self.bumpers[bumper];
        let beyond = (x + Enclosure::constant(-position)) * outward(side);
        [beyond, beyond * stiffness + v * (damping * outward(side))]
    }

    fn slip_bounds(&mut self, _joint: usize, [_, _, v]: [Enclosure; 3]) -> Enclosure {
        v
    }

    fn has_reversals(&self) -> bool {
        self.drive.is_some()
    }

    fn direction(&self) -> f64 {
        self.direction
    }

    fn find_direction(&mut self, x: f64, v: f64) -> Result<f64, Locked> {
        let sets_off = |way: &f64| self.acceleration_from_rest(x, *way).is_ok_and(|a| a * way > 0.0);
        self.direction = if v == 0.0 { [1.0, -1.0].into_iter().find(sets_off).unwrap_or(0.0) } else { v.signum() };
        Ok(self.direction)
    }

    fn acceleration_from_rest(&mut self, x: f64, direction: f64) -> Result<f64, Locked> {
        self.direction = direction;
        self.free_acceleration(x, 0.0)
    }

    fn friction_joints(&self) -> usize {
        usize::from(self.friction.is_some())
    }

    fn slip(&mut self, _joint: usize, _x: f64, v: f64) -> f64 {
        v
    }

    fn slip_rate(&self, _joint: usize, _at: (f64, TablePosition), [_, v, a]: [f64; 3]) -> [f64; 2] {
        [v, a]
    }

    fn slip_range(&self, _joint: usize) -> (f64, f64) {
        self.friction.unwrap().0.range(*self.regimes.last().unwrap())
    }

    fn set_regimes(&mut self, _x: f64, v: f64) {
        if let Some((law, _)) = self.friction
            && self.regimes.last() != Some(&law.regime(v))
        {
            self.regimes.push(law.regime(v));
        }
    }

    fn change_regime(&mut self, _joint: usize, _x: f64, v: f64) {
        self.regimes.push(self.friction.unwrap().0.next(*self.regimes.last().unwrap(), v));
    }
}

/// A motion of the particle, with the energy that it has lost.
#[derive(Default)]
pub(super) struct Run {
    pub(super) particle: Particle,
    pub(super) integrator: Integrator<3>,
    pub(super) lookahead: Lookahead<3>,
    pub(super) travel: Travel,
    pub(super) locked: EngagedLocks,
    pub(super) contact: Contact,
    pub(super) witness: Witness,
    pub(super) x: f64,
    pub(super) v: f64,
    pub(super) lost: f64,
}

impl Run {
    /// From (x, v), between these stops.
    pub(super) fn new(mut particle: Particle, [x, v]: [f64; 2], stops: &[Stop]) -> Self {
        let mut travel = Travel::default();
        for (index, stop) in stops.iter().enumerate() {
            match *stop {
                Stop::Rigid(side, position, restitution) => {
                    travel.rigid[side] = Some(RigidEnd { position, stop: index, restitution, slope: 1.0 });
                }
                Stop::Bumper(bumper) => {
                    let mut positions = [None; 2];
                    positions[bumper.side] = Some(bumper.law[2]);
                    travel.bumpers.push(BumperPlaces { stop: index, positions, slopes: [1.0; 2], engages: None });
                    particle.bumpers.push(bumper);
                }
            }
        }
        Self { particle, travel, x, v, ..Self::default() }
    }

    pub(super) fn step(&mut self, span: f64) {
        let (locked, mut z) = (self.locked, [self.x, self.v, 0.0]);
        let ends = Ends::new(&self.travel, 0.0, locked);
        self.contact.locks_set(&ends);
        if self.lookahead.begin(TOLERANCE, locked) {
            self.integrator.branch_off();
        }
        let advance = Advance {
            dynamics: &mut self.particle,
            integrator: &mut self.integrator,
            lookahead: &mut self.lookahead,
            ends,
            contact: &mut self.contact,
            witness: &mut self.witness,
            tolerance: TOLERANCE,
            progress: Progress::default(),
        };
        let lost = advance.run(&mut z, span).unwrap();
        self.lookahead.end();
        (self.x, self.v) = (z[0], z[1]);
        self.lost += lost + z[2];
    }

    /// Advance by `span` in so many communication steps.
    pub(super) fn steps(&mut self, span: f64, count: usize) {
        (0..count).for_each(|_| self.step(span / count as f64));
    }

    #[track_caller]
    pub(super) fn is_at(&self, x: f64, v: f64, accuracy: f64) {
        assert!((self.x - x).abs() < accuracy && (self.v - v).abs() < accuracy, "{} {}: {x} {v}", self.x, self.v);
    }
}

pub(super) fn rigid(side: usize, position: f64, restitution: f64) -> Stop {
    Stop::Rigid(side, position, restitution)
}

pub(super) fn bumper(side: usize, law: [f64; 3]) -> Stop {
    Stop::Bumper(Bumper { side, law })
}

/// Whether only these bumpers push.
pub(super) fn only(bumpers: &[usize]) -> BumperSet {
    bumpers.iter().fold(BumperSet::EMPTY, |set, &k| set.with(k))
}

pub(super) fn falling() -> Particle {
    Particle { force: [-G, 0.0], ..Particle::default() }
}
