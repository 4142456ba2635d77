//! The advance of a particle of 1 kg on a line, against closed forms: impacts, bumpers, locks, friction, drives,
//! release.
#![allow(clippy::unwrap_used)]
use super::*;
use crate::integrator::System;
use crate::mechanism::loads::laws::friction::{Law, Regime};
use crate::mechanism::motion::contact::{End, StopKind};

const G: f64 = 9.81;
const TOLERANCE: f64 = 1e-10;

/// A particle of 1 kg under a force that grows with time; each end of its travel may have a bumper with the index of
/// its side.
#[derive(Default)]
struct Particle {
    t: f64,
    /// Force [N], and its rate [N/s].
    force: [f64; 2],
    /// Stiffness [N/m], damping [N.s/m] and position [m] of the bumper at each end.
    bumpers: [[f64; 3]; 2],
    touching: [Option<usize>; 2],
    /// Force [N] and efficiency of a drive.
    drive: Option<[f64; 2]>,
    direction: f64,
    /// Law of friction, normal force [N].
    friction: Option<(Law, f64)>,
    /// Regimes of friction, the present one last.
    regimes: Vec<Regime>,
}

impl Particle {
    fn drive_force(&self, direction: f64) -> f64 {
        self.drive.map_or(0.0, |[force, efficiency]| match direction * force {
            0.0 => force,
            power if power > 0.0 => force * efficiency,
            _ => force / efficiency,
        })
    }

    fn friction_force(&self, v: f64, regime: Option<Regime>) -> f64 {
        self.friction.map_or(0.0, |(law, normal)| -normal * law.cubic(regime.unwrap_or(law.regime(v))).at(v))
    }

    fn acceleration_at(&mut self, t: f64, x: f64, v: f64, regime: Option<Regime>) -> f64 {
        let touching = self.touching;
        let push = touching.iter().flatten().fold(0.0, |sum, &k| sum - outward(k) * self.bumper_push(k, x, v).1);
        let [force, rate] = self.force;
        force + rate * t + push + self.drive_force(self.direction) + self.friction_force(v, regime)
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
        self.force[1] != 0.0
    }

    fn free_acceleration(&mut self, x: f64, v: f64) -> Result<f64, Locked> {
        Ok(self.acceleration_at(self.t, x, v, None))
    }

    fn length(&self) -> f64 {
        1.0
    }

    fn set_touching(&mut self, touching: [Option<usize>; 2]) {
        self.touching = touching;
    }

    fn bumper_push(&mut self, side: usize, x: f64, v: f64) -> (f64, f64) {
        let [stiffness, damping, position] = self.bumpers[side];
        let beyond = (x - position) * outward(side);
        (beyond, stiffness * beyond + damping * v * outward(side))
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

    fn slip_rate(&mut self, _joint: usize, [_, v, a]: [f64; 3]) -> [f64; 2] {
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
struct Run {
    particle: Particle,
    integrator: Integrator<3>,
    lookahead: Lookahead<3>,
    ends: Ends,
    contact: Contact,
    x: f64,
    v: f64,
    lost: f64,
}

impl Run {
    /// From (x, v), between ends that each have a position and a stop of this kind.
    fn new(particle: Particle, [x, v]: [f64; 2], ends: [Option<(f64, StopKind)>; 2]) -> Self {
        let travel = ends.map(|end| end.map(|(position, kind)| End { position, stop: 0, kind }));
        Self { particle, ends: Ends { travel, locked: [false; 2] }, x, v, ..Self::default() }
    }

    fn step(&mut self, span: f64) {
        let (ends, mut z) = (&self.ends, [self.x, self.v, 0.0]);
        self.contact.locks_set(ends.locked);
        if self.lookahead.begin(TOLERANCE, ends.locked) {
            self.integrator.branch_off();
        }
        let advance = Advance {
            dynamics: &mut self.particle,
            integrator: &mut self.integrator,
            lookahead: &mut self.lookahead,
            ends,
            contact: &mut self.contact,
            tolerance: TOLERANCE,
            progress: Progress::default(),
        };
        let lost = advance.run(&mut z, span).unwrap();
        self.lookahead.end();
        (self.x, self.v) = (z[0], z[1]);
        self.lost += lost + z[2];
    }

    /// Advance by `span` in so many communication steps.
    fn steps(&mut self, span: f64, count: usize) {
        (0..count).for_each(|_| self.step(span / count as f64));
    }

    #[track_caller]
    fn is_at(&self, x: f64, v: f64, accuracy: f64) {
        assert!((self.x - x).abs() < accuracy && (self.v - v).abs() < accuracy, "{} {}: {x} {v}", self.x, self.v);
    }
}

fn rigid(position: f64, restitution: f64) -> Option<(f64, StopKind)> {
    Some((position, StopKind::Rigid { restitution }))
}

fn falling() -> Particle {
    Particle { force: [-G, 0.0], ..Particle::default() }
}

#[test]
fn a_falling_ball_rests_on_the_floor() {
    let (height, floor) = (2.0, 0.3);
    let impact = (2.0 * height / G).sqrt();
    for count in [1, 10, 1000] {
        let mut ball = Run::new(falling(), [floor + height, 0.0], [rigid(floor, 0.0), None]);
        ball.steps(impact - 1e-6, count);
        ball.is_at(floor + height - 0.5 * G * (impact - 1e-6).powi(2), -G * (impact - 1e-6), 1e-12);
        assert_eq!((ball.contact.at_rest(), ball.lost), (None, 0.0));
        ball.step(2e-6);
        assert_eq!((ball.contact.at_rest(), ball.x, ball.v), (Some(0), floor, 0.0));
        assert!((ball.lost - G * height).abs() < 1e-11, "{}", ball.lost - G * height);
        ball.steps(1.0, count);
        assert_eq!((ball.x, ball.v), (floor, 0.0));
    }
}

/// The n-th impact is at t_n = v_0/g (1 + 2 (e + ... + e^(n-1))). Rest is at the limit of t_n, v_0/g (1 + e)/(1 - e)
/// (Zeno).
#[test]
fn a_bouncing_ball_makes_zenos_series_of_impacts() {
    let height = 1.0;
    let speed = (2.0 * G * height).sqrt();
    for (restitution, count) in [(0.5, 1), (0.8, 1), (0.8, 7)] {
        let mut ball = Run::new(falling(), [height, 0.0], [rigid(0.0, restitution), None]);
        let (mut t, mut rebound) = (speed / G, speed);
        ball.steps(t - 1e-9, count);
        ball.step(1e-9);
        for n in 1..20 {
            // To the top of the flight after the n-th impact.
            rebound *= restitution;
            ball.steps(rebound / G, count);
            t += 2.0 * rebound / G;
            ball.is_at(0.5 * rebound * rebound / G, 0.0, 1e-11);
            let lost = 0.5 * speed * speed * (1.0 - restitution.powi(2 * n));
            assert!((ball.lost - lost).abs() < 1e-11, "{n}: {} {lost}", ball.lost);
            ball.steps(rebound / G, count);
        }
        let rest = speed / G * (1.0 + restitution) / (1.0 - restitution);
        ball.step((rest - 1e-7) - t);
        assert_eq!(ball.contact.at_rest(), None);
        ball.step(2e-7);
        assert_eq!((ball.contact.at_rest(), ball.x, ball.v), (Some(0), 0.0, 0.0));
        assert!((ball.lost - G * height).abs() < 1e-11, "{}", ball.lost);
    }
}

/// Friction mu N beyond the speed V, c v with c = mu N / V below it.
#[test]
fn a_block_slides_up_a_slope_and_down_again() {
    let (slope, mu, band) = (0.6_f64, 0.3, 0.05);
    let (pull, normal, speed) = (G * slope.sin(), G * slope.cos(), 2.0);
    let law = Law { static_coefficient: mu, kinetic_coefficient: mu, static_speed: band, kinetic_speed: 0.5 };
    let damping = mu * normal / band;
    let terminal = pull / damping;
    let up = (speed - band) / (pull + mu * normal);
    let turn = ((terminal + band) / (terminal - band)).ln() / damping;
    let top = 0.5 * (speed + band) * up;
    let turned = top - terminal * turn + 2.0 * band / damping;
    for count in [1, 50] {
        let particle = Particle { force: [-pull, 0.0], friction: Some((law, normal)), ..Particle::default() };
        let mut block = Run::new(particle, [0.0, speed], [None; 2]);
        block.steps(up, count);
        block.is_at(top, band, 1e-9);
        block.steps(turn, count);
        block.is_at(turned, -band, 1e-9);
        block.steps(1.0, count);
        let down = pull - mu * normal;
        block.is_at(turned - band - 0.5 * down, -band - down, 1e-9);
        let energy = |x: f64, v: f64| 0.5 * v * v + pull * x;
        assert!((block.lost - (energy(0.0, speed) - energy(block.x, block.v))).abs() < 1e-9);
        use Regime::{Kinetic, Transition, Viscous};
        let regimes = [Kinetic(1.0), Transition(1.0), Viscous, Transition(-1.0), Kinetic(-1.0)];
        assert_eq!(block.particle.regimes, regimes);
    }
}

/// Contact of a mass with a spring and a damper: half a period, if there is no damper.
#[test]
fn a_bumper_pushes_for_half_a_period() {
    let (speed, stiffness, gap) = (3.0, 4e4_f64, 0.5);
    for damping in [0.0, 120.0] {
        let decay = 0.5 * damping;
        let omega = (stiffness - decay * decay).sqrt();
        // Until the push would be a pull.
        let phase = std::f64::consts::PI - (2.0 * decay * omega / (stiffness - 2.0 * decay * decay)).atan();
        let contact = phase / omega;
        let away = (-decay * contact).exp();
        let (depth, leaving) =
            (speed / omega * away * phase.sin(), speed * away * (phase.cos() - decay / omega * phase.sin()));
        if damping == 0.0 {
            assert!((contact - std::f64::consts::PI / stiffness.sqrt()).abs() < 1e-15);
        }
        for count in [1, 40] {
            let bumpers = [[0.0; 3], [stiffness, damping, gap]];
            let particle = Particle { bumpers, ..Particle::default() };
            let mut mass = Run::new(particle, [0.0, speed], [None, Some((gap, StopKind::Bumper(1)))]);
            mass.steps(gap / speed + 0.5 * contact, count);
            assert_eq!(mass.contact.touching(), [None, Some(1)]);
            mass.steps(0.5 * contact * (1.0 + 1e-6), count);
            assert_eq!(mass.contact.touching(), [None; 2]);
            mass.is_at(gap + depth + leaving * 0.5e-6 * contact, leaving, 1e-8);
            mass.step(0.1);
            mass.is_at(gap + depth + leaving * (0.1 + 0.5e-6 * contact), leaving, 1e-8);
        }
    }
}

#[test]
fn a_lock_catches_holds_and_lets_go() {
    for kind in [StopKind::Rigid { restitution: 0.9 }, StopKind::Bumper(1)] {
        let bumpers = [[0.0; 3], [1e4, 0.0, 1.0]];
        let particle = Particle { force: [2.0, 0.0], bumpers, ..Particle::default() };
        let mut mass = Run::new(particle, [0.0, 1.0], [None, Some((1.0, kind))]);
        mass.ends.locked[1] = true;
        mass.step(5.0);
        assert_eq!((mass.x, mass.v, mass.contact.is_latched(1)), (1.0, 0.0, true));
        assert!((mass.lost - (0.5 + 2.0)).abs() < 1e-12, "{}", mass.lost);
        mass.particle.force[0] = -3.0;
        mass.step(5.0);
        assert_eq!((mass.x, mass.v, mass.contact.is_latched(1)), (1.0, 0.0, true));
        mass.ends.locked[1] = false;
        mass.step(0.2);
        mass.is_at(1.0 - 0.5 * 3.0 * 0.04, -3.0 * 0.2, 1e-12);
        assert_eq!(mass.contact, Contact::default());
    }
}

#[test]
fn a_force_that_grows_with_time_lifts_the_mass_off_its_stop() {
    let (force, rate, span) = (2.0, 5.0, 1.0);
    let mut mass =
        Run::new(Particle { force: [-force, rate], ..Particle::default() }, [0.7, 0.0], [rigid(0.7, 0.5), None]);
    mass.contact = Contact::at_start(Some(0));
    mass.step(span);
    let after = span - force / rate;
    mass.is_at(0.7 + rate * after.powi(3) / 6.0, 0.5 * rate * after.powi(2), 1e-13);
    assert_eq!((mass.contact.at_rest(), mass.lost), (None, 0.0));
}

/// Driven forward, a drive gives eta F; driven back, it holds up to F / eta.
#[test]
fn a_drive_with_losses_holds_the_mass_that_it_cannot_drive() {
    let (efficiency, load, speed) = (0.6, -9.0, 1.5);
    let decelerating = load + efficiency * 10.0;
    let particle = Particle { force: [load, 0.0], drive: Some([10.0, efficiency]), ..Particle::default() };
    let mut mass = Run::new(particle, [0.0, speed], [None; 2]);
    mass.step(2.0);
    let held = -0.5 * speed * speed / decelerating;
    mass.is_at(held, 0.0, 1e-12);
    // The load decreases: from -decelerating / rate on, the drive moves the mass.
    let (rate, span) = (10.0, 0.5);
    mass.particle.force[1] = rate;
    mass.integrator.refresh();
    mass.step(span);
    let after = span + decelerating / rate;
    mass.is_at(held + rate * after.powi(3) / 6.0, 0.5 * rate * after.powi(2), 1e-12);
}
