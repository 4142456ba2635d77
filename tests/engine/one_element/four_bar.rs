//! [CK16] figs. 3 and 10: four-bar linkages, against their closed-form kinematics and the superposition of the bodies
//! (conclusion 3 of the paper).
use super::worst::{ACCURACY, Worst, wave};
use crate::support::{CRANE, FOUR_BAR, Run, changed};
use nalgebra::Complex;
use serde_json::json;

const G: f64 = 9.81;

type C = Complex<f64>;

/// A function of the crank angle theta with its first two derivatives.
type Jet<T> = [T; 3];

fn at(angle: f64) -> C {
    C::from_polar(1.0, angle)
}

/// The complex number arm e^(i angle), with angle a function of theta.
fn turned(arm: C, [angle, first, second]: Jet<f64>) -> Jet<C> {
    let z = arm * at(angle);
    [z, C::i() * first * z, (C::i() * second - first * first) * z]
}

fn plus(a: Jet<C>, b: Jet<C>) -> Jet<C> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Lengths of a four-bar linkage: crank from 0, coupler, rocker from `pivot`. The joint of coupler and rocker is on
/// this side (1: left) of the diagonal from the end of the crank to the pivot.
struct FourBar {
    crank: f64,
    coupler: f64,
    rocker: f64,
    pivot: C,
    side: f64,
}

impl FourBar {
    /// Angles of the coupler (at the end of the crank) and the rocker (at the pivot): cosine rule, then the loop
    /// equation crank e^(i theta) + coupler e^(i phi) = pivot + rocker e^(i psi), differentiated twice.
    fn angles(&self, theta: f64) -> (Jet<f64>, Jet<f64>) {
        let end = self.crank * at(theta);
        let diagonal = self.pivot - end;
        let d = diagonal.norm();
        let cosine = (d * d + self.coupler.powi(2) - self.rocker.powi(2)) / (2.0 * d * self.coupler);
        let phi = diagonal.arg() + self.side * cosine.acos();
        let psi = (end + self.coupler * at(phi) - self.pivot).arg();
        // a phi' + b psi' = right: two real equations.
        let (a, b) = (C::i() * self.coupler * at(phi), -C::i() * self.rocker * at(psi));
        let solve = |right: C| {
            let cross = |u: C, v: C| u.re * v.im - u.im * v.re;
            (cross(right, b) / cross(a, b), cross(a, right) / cross(a, b))
        };
        let (phi1, psi1) = solve(-C::i() * end);
        let (phi2, psi2) = solve(end + self.coupler * at(phi) * phi1 * phi1 - self.rocker * at(psi) * psi1 * psi1);
        ([phi, phi1, phi2], [psi, psi1, psi2])
    }
}

/// One body: mass, moment of inertia, centre and angle as functions of theta, external force at the centre, torque.
struct Part {
    mass: f64,
    inertia: f64,
    center: Jet<C>,
    angle: Jet<f64>,
    force: C,
    torque: f64,
}

impl Part {
    /// R_z of eq. (1) and its derivative.
    fn radius(&self) -> (f64, f64) {
        let [_, v, a] = self.center;
        (v.norm(), (v.conj() * a).re / v.norm())
    }

    /// The body's part of I_zS and dI_zS/dalpha, eqs. (12), (14).
    fn inertia(&self) -> (f64, f64) {
        let (rz, drz) = self.radius();
        let [_, first, second] = self.angle;
        let mut sum = (self.inertia * first * first, 2.0 * self.inertia * first * second);
        if self.mass > 0.0 {
            sum = (sum.0 + self.mass * rz * rz, sum.1 + 2.0 * self.mass * rz * drz);
        }
        sum
    }

    /// The body's part of T_Su, eq. (11). F_C^v opposes the motion.
    fn load(&self) -> f64 {
        let force = self.force - C::i() * self.mass * G;
        -(force.conj() * self.center[1]).re - self.torque * self.angle[1]
    }
}

/// I_zS, dI_zS/dalpha, T_Su and the largest part of T_Su, as sums over the bodies.
fn superposed(parts: &[Part]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for p in parts {
        let ((inertia, change), load) = (p.inertia(), p.load());
        sum = [sum[0] + inertia, sum[1] + change, sum[2] + load, sum[3].max(load.abs())];
    }
    sum
}

/// Names of the outputs of a drive, and the expected one-element values.
struct Expected {
    drive: &'static str,
    revolutions: bool,
    inertia: f64,
    change: f64,
    load: f64,
    size: f64,
    speed: f64,
}

fn compare(worst: &mut Worst, run: &mut Run, e: &Expected, force: f64, demand: f64) {
    let (mass, force_name) = if e.revolutions { ("inertia", "torque") } else { ("mass", "force") };
    let name = |suffix: &str| format!("{}.{suffix}", e.drive);
    run.set(&name(force_name), force);
    run.set(&name("demanded_acceleration"), demand);
    let additional = -0.5 * e.speed * e.speed * e.change;
    let acceleration = (force - e.load + additional) / e.inertia;
    let part = e.inertia * e.speed * e.speed;
    let full = [force, e.load, additional, e.size, part].into_iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    worst.compare("speed", run.get(&name("speed")), e.speed, 0.0);
    worst.compare("reduced", run.get(&name(&format!("reduced_{mass}"))), e.inertia, 0.0);
    let change = run.get(&name(&format!("reduced_{mass}_derivative")));
    worst.compare("its derivative", change, e.change, e.inertia);
    worst.compare("static load", run.get(&name("static_load")), e.load, e.size);
    worst.compare("additional", run.get(&name(&format!("additional_{force_name}"))), additional, part);
    worst.compare("acceleration", run.get(&name("acceleration")), acceleration, full / e.inertia);
    let required = e.load + e.inertia * demand - additional;
    let size = full.max(e.inertia * demand.abs());
    worst.compare("required", run.get(&name("required_force")), required, size);
    worst.compare("T", run.get("energy.kinetic"), 0.5 * e.inertia * e.speed * e.speed, 0.0);
}

/// The four-bar linkage of fig. 3 with these masses of crank and rocker (uniform rods).
fn four_bar(run: &mut Run, crank_mass: f64, rocker_mass: f64) {
    let linkage = FourBar { crank: 0.1, coupler: 0.35, rocker: 0.25, pivot: C::new(0.3, 0.0), side: 1.0 };
    let mut worst = Worst::default();
    for k in 0..400 {
        let (theta, speed) = (0.0157 * f64::from(k) - 2.0, 40.0 * wave(k, 0.7));
        run.place(("crank.start_angle", theta), ("crank.start_speed", speed));
        let (force, torque) = (C::new(300.0 * wave(k, 1.1), 300.0 * wave(k, 1.3)), 20.0 * wave(k, 1.7));
        run.set_all(&[("C.force_x", force.re), ("C.force_y", force.im), ("coupler.torque", torque)]);
        let crank = [theta, 1.0, 0.0];
        let (phi, psi) = linkage.angles(theta);
        let center = plus(turned(C::new(0.1, 0.0), crank), turned(C::new(0.2, 0.05), phi));
        let rod = |mass: f64, length: f64, angle: Jet<f64>| Part {
            mass,
            inertia: mass * length * length / 12.0,
            center: turned(C::new(0.5 * length, 0.0), angle),
            angle,
            force: C::new(0.0, 0.0),
            torque: 0.0,
        };
        let parts = [
            Part { mass: 2.0, inertia: 0.03, center, angle: phi, force, torque },
            rod(crank_mass, 0.1, crank),
            rod(rocker_mass, 0.25, psi),
        ];
        let [inertia, change, load, size] = superposed(&parts);
        let size = size.max(300.0 * parts[0].radius().0);
        for (body, part) in ["coupler", "crank", "rocker"].into_iter().zip(&parts) {
            by_body(&mut worst, run, &format!("drive.{body}"), part, size);
        }
        let expected = Expected { drive: "drive", revolutions: true, inertia, change, load, size, speed };
        compare(&mut worst, run, &expected, 10.0 * wave(k, 1.9), 200.0 * wave(k, 2.3));
        // Eqs. (3), (4): tangential acceleration of the centre, and angular acceleration of the coupler, where they are
        // not almost 0.
        let epsilon = run.get("drive.acceleration");
        let (rz, drz) = parts[0].radius();
        let v = C::new(run.get("C.velocity_x"), run.get("C.velocity_y"));
        let a = C::new(run.get("C.acceleration_x"), run.get("C.acceleration_y"));
        let along = (v.conj() * a).re / v.norm() * speed.signum();
        let kinds = [(rz * epsilon).abs(), speed * speed * rz].into_iter().fold(0.0, f64::max);
        worst.compare("(1) v_C", v.norm(), (rz * speed).abs(), 0.0);
        worst.compare("(3) a_C", along, rz * epsilon + speed * speed * drz, kinds);
        let size = epsilon.abs() + speed * speed;
        worst.compare("(2) omega_C", run.get("coupler.speed"), phi[1] * speed, speed);
        let expected = phi[1] * epsilon + speed * speed * phi[2];
        worst.compare("(4) epsilon_C", run.get("coupler.acceleration"), expected, size);
    }
    worst.assert_within(ACCURACY);
}

/// The contribution of one body to the one-element outputs of the crank: eqs. (1), (2), (11), (12).
fn by_body(worst: &mut Worst, run: &mut Run, owner: &str, part: &Part, size: f64) {
    let mut get = |suffix: &str| run.get(&format!("{owner}.{suffix}"));
    worst.compare("I_zS of a body", get("reduced_inertia"), part.inertia().0, 0.0);
    worst.compare("T_Su of a body", get("static_load"), part.load(), size);
    if part.mass > 0.0 {
        worst.compare("R_z", get("effective_radius"), part.center[1].norm(), 0.1);
    }
    // 1 / i_m, because the coupler's speed is 0 at times.
    worst.compare("i_m", 1.0 / get("ratio"), part.angle[1], 1.0);
}

/// [`FOUR_BAR`] with the outputs of each body.
fn definition() -> String {
    changed(FOUR_BAR, |m| m["actuators"]["drive"]["by_body"] = json!(true))
}

#[test]
fn a_four_bar_linkage_with_a_heavy_coupler() {
    four_bar(&mut Run::new(definition()), 0.0, 0.0);
}

#[test]
fn the_bodies_of_a_four_bar_linkage_are_superposed() {
    let text = changed(definition(), |m| {
        m["bodies"]["crank"] = json!({ "length": 0.1, "mass": 0.7, "shape": "uniform_rod" });
        m["bodies"]["rocker"] = json!({ "length": 0.25, "mass": 1.3, "shape": "uniform_rod" });
    });
    four_bar(&mut Run::new(&text), 0.7, 1.3);
}

/// The crane of fig. 10, reduced to the angle of the jib, then to the length x of the cylinder.
#[test]
fn a_crane_jib_with_its_cylinder() {
    let mut run = Run::new(changed(CRANE, |m| m["actuators"]["cylinder"]["by_body"] = json!(true)));
    let linkage = FourBar { crank: 16.0, coupler: 3.0, rocker: 11.5, pivot: C::new(-2.5, 5.0), side: -1.0 };
    let mut worst = Worst::default();
    for k in 0..=200 {
        // Above the toggle at 0.909 rad, at which beak and connector are in line.
        let (theta, omega) = (1.0 + 0.0025 * f64::from(k), 0.3 * wave(k, 0.7));
        run.place(("jib.start_angle", theta), ("jib.start_speed", omega));
        let (hook, own) = (C::new(0.3, -1.0) * 3e4 * wave(k, 1.1), C::new(wave(k, 1.3), wave(k, 1.5)) * 1e4);
        let torque = 5e4 * wave(k, 1.7);
        run.set_all(&[("hook.force_x", hook.re), ("hook.force_y", hook.im)]);
        run.set_all(&[("C.force_x", own.re), ("C.force_y", own.im), ("beak.torque", torque)]);
        let jib = [theta, 1.0, 0.0];
        let (phi, _) = linkage.angles(theta);
        let beak = [phi[0] + std::f64::consts::PI, phi[1], phi[2]];
        let b = turned(C::new(16.0, 0.0), jib);
        let from_b = |x: f64, y: f64| plus(b, turned(C::new(x, y), beak));
        let (center, tip) = (from_b(1.5, 0.3), from_b(7.0, 0.0));
        let parts = [
            Part { mass: 2500.0, inertia: 18000.0, center, angle: beak, force: own, torque },
            Part { mass: 0.0, inertia: 0.0, center: tip, angle: beak, force: hook, torque: 0.0 },
        ];
        let [inertia, inertia_change, moment, moment_size] = superposed(&parts);
        let s = turned(C::new(6.0, -0.4), jib);
        let gap = s[0] - C::new(2.5, 1.0);
        let x = gap.norm();
        let x1 = (gap.conj() * s[1]).re / x;
        let x2 = (s[1].norm_sqr() + (gap.conj() * s[2]).re - x1 * x1) / x;
        let mass = inertia / (x1 * x1);
        let expected = Expected {
            drive: "cylinder",
            revolutions: false,
            inertia: mass,
            change: (inertia_change / (x1 * x1) - 2.0 * inertia * x2 / x1.powi(3)) / x1,
            load: moment / x1,
            size: moment_size / x1,
            speed: omega * x1,
        };
        worst.compare("x", run.get("cylinder.length"), x, 0.0);
        worst.compare("m_zS of the beak", run.get("cylinder.beak.reduced_mass"), mass, 0.0);
        worst.compare("F_Su of the beak", run.get("cylinder.beak.static_load"), moment / x1, moment_size / x1);
        // The error of a table is relative to its largest value, which occurs here near the toggle.
        let inverse = 1.0 / run.get("cylinder.beak.effective_radius");
        worst.compare("R_e", inverse, beak[1] / x1, linkage.angles(1.0).0[1] / x1);
        worst.compare("i_v", run.get("cylinder.beak.ratio"), x1 / parts[0].radius().0, 0.0);
        worst.compare("tip", run.get("tip.y"), tip[0].im, 0.0);
        compare(&mut worst, &mut run, &expected, 2e5 * wave(k, 1.9), 0.5 * wave(k, 2.3));
    }
    worst.assert_within(ACCURACY);
}
