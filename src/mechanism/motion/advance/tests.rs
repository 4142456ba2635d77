//! The advance of a particle of 1 kg on a line, against closed forms: impacts, bumpers, locks, friction, drives,
//! release.
#![allow(clippy::unwrap_used)]
mod particle;

use crate::mechanism::loads::laws::friction::{Law, Regime};
use crate::mechanism::motion::contact::{Contact, EngagedLocks, Place};
use particle::{Particle, Run, bumper, falling, only, rigid};

const G: f64 = 9.81;
const TOLERANCE: f64 = 1e-10;

#[test]
fn a_falling_ball_rests_on_the_floor() {
    let (height, floor) = (2.0, 0.3);
    let impact = (2.0 * height / G).sqrt();
    for count in [1, 10, 1000] {
        let mut ball = Run::new(falling(), [floor + height, 0.0], &[rigid(0, floor, 0.0)]);
        ball.steps(impact - 1e-6, count);
        ball.is_at(floor + height - 0.5 * G * (impact - 1e-6).powi(2), -G * (impact - 1e-6), 1e-12);
        assert_eq!((ball.contact.at_rest(), ball.lost), (None, 0.0));
        ball.step(2e-6);
        assert_eq!((ball.contact.at_rest(), ball.x, ball.v), (Some(Place::rigid(0)), floor, 0.0));
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
        let mut ball = Run::new(falling(), [height, 0.0], &[rigid(0, 0.0, restitution)]);
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
        assert_eq!((ball.contact.at_rest(), ball.x, ball.v), (Some(Place::rigid(0)), 0.0, 0.0));
        assert!((ball.lost - G * height).abs() < 1e-11, "{}", ball.lost);
    }
}

/// Friction mu N beyond the speed V, c v with c = mu N / V below it.
#[test]
fn a_block_slides_up_a_slope_and_down_again() {
    let (slope, mu, band) = (0.6_f64, 0.3, 0.05);
    let (pull, normal, speed) = (G * slope.sin(), G * slope.cos(), 2.0);
    let law =
        Law { sticks: false, static_coefficient: mu, kinetic_coefficient: mu, static_speed: band, kinetic_speed: 0.5 };
    let damping = mu * normal / band;
    let terminal = pull / damping;
    let up = (speed - band) / (pull + mu * normal);
    let turn = ((terminal + band) / (terminal - band)).ln() / damping;
    let top = 0.5 * (speed + band) * up;
    let turned = top - terminal * turn + 2.0 * band / damping;
    for count in [1, 50] {
        let particle = Particle { force: [-pull, 0.0], friction: Some((law, normal)), ..Particle::default() };
        let mut block = Run::new(particle, [0.0, speed], &[]);
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
            let mut mass = Run::new(Particle::default(), [0.0, speed], &[bumper(1, [stiffness, damping, gap])]);
            mass.steps(gap / speed + 0.5 * contact, count);
            assert_eq!(mass.contact.touching(), only(&[0]));
            mass.steps(0.5 * contact * (1.0 + 1e-6), count);
            assert_eq!(mass.contact.touching(), only(&[]));
            mass.is_at(gap + depth + leaving * 0.5e-6 * contact, leaving, 1e-8);
            mass.step(0.1);
            mass.is_at(gap + depth + leaving * (0.1 + 0.5e-6 * contact), leaving, 1e-8);
        }
    }
}

#[test]
fn a_lock_catches_holds_and_lets_go() {
    let at_rigid = EngagedLocks { rigid: [false, true], ..EngagedLocks::default() };
    let at_bumper = EngagedLocks { bumpers: only(&[0]), ..EngagedLocks::default() };
    for (stop, locked) in [(rigid(1, 1.0, 0.9), at_rigid), (bumper(1, [1e4, 0.0, 1.0]), at_bumper)] {
        let particle = Particle { force: [2.0, 0.0], ..Particle::default() };
        let mut mass = Run::new(particle, [0.0, 1.0], &[stop]);
        mass.locked = locked;
        mass.step(5.0);
        assert_eq!((mass.x, mass.v, mass.contact.is_latched()), (1.0, 0.0, true));
        assert!((mass.lost - (0.5 + 2.0)).abs() < 1e-12, "{}", mass.lost);
        mass.particle.force[0] = -3.0;
        mass.step(5.0);
        assert_eq!((mass.x, mass.v, mass.contact.is_latched()), (1.0, 0.0, true));
        mass.locked = EngagedLocks::default();
        mass.step(0.2);
        mass.is_at(1.0 - 0.5 * 3.0 * 0.04, -3.0 * 0.2, 1e-12);
        assert_eq!(mass.contact, Contact::default());
    }
}

#[test]
fn a_force_that_grows_with_time_lifts_the_mass_off_its_stop() {
    let (force, rate, span) = (2.0, 5.0, 1.0);
    let mut mass =
        Run::new(Particle { force: [-force, rate], ..Particle::default() }, [0.7, 0.0], &[rigid(0, 0.7, 0.5)]);
    mass.contact = Contact::at_start(Some(Place::rigid(0)));
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
    let mut mass = Run::new(particle, [0.0, speed], &[]);
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

/// A bumper with a rigid stop behind it: energy at the rigid stop, and back through the bumper.
#[test]
fn a_rigid_stop_behind_a_bumper_acts() {
    let (force, stiffness, at, end, restitution) = (100.0, 3000.0, 0.5, 0.51, 0.6_f64);
    for count in [1, 9, 300] {
        let stops = [bumper(1, [stiffness, 0.0, at]), rigid(1, end, restitution)];
        let particle = Particle { force: [force, 0.0], ..Particle::default() };
        let mut mass = Run::new(particle, [0.0, 0.0], &stops);
        let square = 2.0 * (force * end - 0.5 * stiffness * (end - at) * (end - at));
        let omega = stiffness.sqrt();
        let (first, arrival) = ((2.0 * at / force).sqrt(), square.sqrt());
        // In the bumper: x = middle + amplitude sin(omega t + phase), about its balance.
        let balance = at + force / stiffness;
        let speed = (2.0 * force * at).sqrt();
        let angle = |x: f64, v: f64| (omega * (x - balance)).atan2(v);
        let within = (angle(end, arrival) - angle(at, speed)) / omega;
        mass.steps(first + within - 1e-6, count);
        assert!(mass.v > 0.0 && mass.lost == 0.0 && mass.contact.touching() == only(&[0]));
        mass.steps(2e-6, count);
        let after = restitution * arrival;
        assert!((mass.v + after).abs() < 1e-3 && mass.x < end, "{} {}", mass.x, mass.v);
        assert!((mass.lost - 0.5 * (square - after * after)).abs() < 1e-9, "{}", mass.lost);
        assert_eq!(mass.contact.touching(), only(&[0]));
        // Back at the place of the bumper, which lets go.
        let back = (after * after - 2.0 * force * (end - at) + stiffness * (end - at) * (end - at)).sqrt();
        let within = (angle(at, -back) - angle(end, -after)).rem_euclid(std::f64::consts::TAU) / omega;
        mass.steps(within - 1e-6 + 1e-9, count);
        mass.is_at(at - 1e-9 * back, -back, 1e-6);
        assert_eq!(mass.contact.touching(), only(&[]));
    }
}

/// At rest at a rigid stop with compressed bumpers before it: let go where the force equals their push.
#[test]
fn bumpers_push_a_resting_mass_off() {
    let stops = [bumper(1, [1000.0, 30.0, 0.98]), rigid(1, 1.0, 0.0), bumper(1, [500.0, 0.0, 0.99])];
    let push = 1000.0 * 0.02 + 500.0 * 0.01;
    let particle = Particle { force: [40.0, 0.0], ..Particle::default() };
    let mut mass = Run::new(particle, [0.0, 0.0], &stops);
    mass.step(2.0);
    assert_eq!((mass.contact.at_rest(), mass.contact.touching(), mass.x), (Some(Place::rigid(1)), only(&[0, 1]), 1.0));
    // It decreases by 10 N/s: (40 - 25) / 10 s.
    mass.particle.force[1] = -10.0;
    mass.integrator.refresh();
    let released = (40.0 - push) / 10.0;
    mass.step(released - 1e-9);
    assert_eq!((mass.contact.at_rest(), mass.x, mass.v), (Some(Place::rigid(1)), 1.0, 0.0));
    // The force of the particle counts from the start of a span.
    mass.particle.force[0] -= 10.0 * (released - 1e-9);
    mass.integrator.refresh();
    mass.step(1e-3);
    assert_eq!((mass.contact.at_rest(), mass.contact.touching()), (None, only(&[0, 1])));
    let expected = -10.0 * 1e-6 / 2.0;
    assert!((mass.v - expected).abs() < 0.05 * expected.abs(), "{} {expected}", mass.v);
}

/// A mass that bounces off a rigid stop faster than its damped bumper can follow is not pulled.
#[test]
fn a_bumper_that_would_pull_after_an_impact_lets_go() {
    let stops = [bumper(1, [10.0, 50.0, 0.9]), rigid(1, 0.95, 1.0)];
    let mut mass = Run::new(Particle::default(), [0.0, 10.0], &stops);
    mass.step(0.09);
    assert_eq!(mass.contact.touching(), only(&[]));
    mass.step(0.0075);
    let v = mass.v;
    assert!(v < -5.0 && mass.contact.touching() == only(&[]), "{v} {:?}", mass.contact);
    mass.step(0.1);
    assert_eq!(mass.v, v, "free flight");
}

/// 5 ms in which the force draws the mass off its stop, in one step of 0.52 s.
#[test]
fn a_short_release_within_a_long_step_is_met() {
    let (peak, bend, center, span) = (1e4_f64, 1.6e9, 0.5078, 0.52);
    let force = [peak - bend * center * center, 2.0 * bend * center];
    let particle = Particle { force, bend: -2.0 * bend, ..Particle::default() };
    let mut mass = Run::new(particle, [0.0, 0.0], &[rigid(0, 0.0, 0.0)]);
    mass.contact = Contact::at_start(Some(Place::rigid(0)));
    let half = (peak / bend).sqrt();
    // From the release on, at tau: acceleration bend (2 half tau - tau^2).
    let tau = span - (center - half);
    let x = |tau: f64| bend * (half * tau.powi(3) / 3.0 - tau.powi(4) / 12.0);
    let v = |tau: f64| bend * (half * tau.powi(2) - tau.powi(3) / 3.0);
    let mut twin =
        Run::new(Particle { force, bend: -2.0 * bend, ..Particle::default() }, [0.0, 0.0], &[rigid(0, 0.0, 0.0)]);
    twin.contact = mass.contact;
    let early = center - half + 0.8 * (4.0 * half).min(tau);
    twin.step(early);
    let after = early - (center - half);
    twin.is_at(x(after), v(after), 1e-7);
    // Back at the stop after 4 half widths, and held there.
    mass.step(span);
    assert!(4.0 * half < tau, "{half} {tau}");
    assert_eq!((mass.contact.at_rest(), mass.x), (Some(Place::rigid(0)), 0.0));
    assert!(mass.lost > 1.0, "{}", mass.lost);
}

/// A bumper with much damping lets go and is pressed again within one step, as the force turns the mass and turns it
/// back before it has left the bumper.
#[test]
fn a_bumper_lets_go_and_pushes_again_within_one_step() {
    for force in [-2.0, -1.8, -1.74] {
        let mut ends = Vec::new();
        for count in [1, 4, 64, 1024] {
            let particle = Particle { force: [force, 10.0], ..Particle::default() };
            let mut mass = Run::new(particle, [-1e-3, 0.2], &[bumper(1, [0.0, 5.0, 0.0])]);
            let h = 0.5 / f64::from(count);
            let mut changes = 0;
            for _ in 0..count {
                let before = mass.contact.touching();
                mass.integrator.refresh();
                mass.step(h);
                changes += u32::from(before != mass.contact.touching());
                // The force of the particle counts from the start of a span.
                mass.particle.force[0] += 10.0 * h;
            }
            ends.push((mass.x, mass.v, changes));
        }
        let (x, v, changes) = ends[3];
        assert_eq!(changes, 3, "it lets go and pushes again: {ends:?}");
        assert!(ends.iter().all(|e| (e.0 - x).abs() < 1e-9 && (e.1 - v).abs() < 1e-8), "{ends:?}");
    }
}

/// A slip speed that leaves the viscous regime and comes back within one step: a force that swings.
#[test]
fn a_regime_left_and_entered_again_within_one_step_is_met() {
    let law = Law {
        sticks: false,
        static_coefficient: 0.3,
        kinetic_coefficient: 0.2,
        static_speed: 0.05,
        kinetic_speed: 0.5,
    };
    // Viscous friction 60 v: the speed follows force / 60 late, to its largest value just above 0.05 m/s.
    for peak in [3.3, 3.2, 3.15] {
        let mut ends = Vec::new();
        for count in [1, 200] {
            let (rate, bend) = (4.0 * peak / 0.5, -8.0 * peak / 0.25);
            let particle = Particle { force: [0.0, rate], bend, friction: Some((law, 10.0)), ..Particle::default() };
            let mut mass = Run::new(particle, [0.0, 0.0], &[]);
            let h = 0.5 / f64::from(count);
            for _ in 0..count {
                mass.integrator.refresh();
                mass.step(h);
                let [f, r] = mass.particle.force;
                mass.particle.force = [f + r * h + 0.5 * bend * h * h, r + bend * h];
            }
            use Regime::{Transition, Viscous};
            assert_eq!(mass.particle.regimes, [Viscous, Transition(1.0), Viscous], "{peak} {count}");
            ends.push((mass.x, mass.v));
        }
        let [(x, v), (fine_x, fine_v)] = ends[..] else { panic!() };
        assert!((x - fine_x).abs() < 1e-9 && (v - fine_v).abs() < 1e-8, "{ends:?}");
    }
}
