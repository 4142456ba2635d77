//! [CK16] 2: the slider-crank of fig. 5, equations (1)-(4), (11)-(21).
//!
//! In the paper only the piston has mass. Here the crank also has the inertia J and, in one variant, the rod has the
//! inertia I_C: I_zS = J + m_C R_z^2 + I_C / i_m^2. alpha starts at the inner dead centre, where the crank points down.
use super::worst::{ACCURACY, Worst, wave};
use crate::support::{Run, SLIDER_CRANK};
use std::f64::consts::{FRAC_PI_2, TAU};

const R: f64 = 0.05;
const ROD: f64 = 0.2;
const MASS: f64 = 0.8;
const CRANK_INERTIA: f64 = 0.004;
const ROD_INERTIA: f64 = 0.0023;

/// Eq. (18) with the factor of sin^2 under the root as an argument: l^2/r^2. The paper prints r^2/l^2.
fn radius(alpha: f64, ratio: f64) -> f64 {
    R * (alpha.sin() - 0.5 * (2.0 * alpha).sin() / (ratio - alpha.sin().powi(2)).sqrt())
}

/// Eq. (19). `factor` is 1. The paper prints 1/2.
fn radius_derivative(alpha: f64, ratio: f64, factor: f64) -> f64 {
    let (under, s2, c2) = (ratio - alpha.sin().powi(2), (2.0 * alpha).sin(), (2.0 * alpha).cos());
    R * (alpha.cos() - factor * (2.0 * c2 * under + 0.5 * s2 * s2) / (2.0 * under.powf(1.5)))
}

const RATIO: f64 = (ROD / R) * (ROD / R);

/// Ratio i_m of crank and rod, eq. (2), and its derivative.
fn ratio(alpha: f64) -> (f64, f64) {
    let root = (RATIO - alpha.sin().powi(2)).sqrt();
    (root / alpha.cos(), alpha.sin() * (RATIO - 1.0) / (root * alpha.cos().powi(2)))
}

fn place(run: &mut Run, alpha: f64, omega: f64) {
    run.place(("crank.start_angle", alpha - FRAC_PI_2), ("crank.start_speed", omega));
}

/// alpha, omega_S, T_S, piston force, demanded acceleration: angles of more than one turn, speeds of both signs.
fn states() -> impl Iterator<Item = [f64; 5]> {
    (0..400).map(|k| {
        [-3.0 + 0.031 * f64::from(k), 300.0 * wave(k, 0.7), 40.0 * wave(k, 1.1), 2e3 * wave(k, 1.9), 5e4 * wave(k, 2.3)]
    })
}

fn closed_forms(run: &mut Run, rod_inertia: f64) {
    let mut worst = Worst::default();
    for [alpha, omega, torque, force, demand] in states() {
        place(run, alpha, omega);
        let values = [("drive.torque", torque), ("piston.force_y", force), ("drive.demanded_acceleration", demand)];
        run.set_all(&values);
        let (rz, drz) = (radius(alpha, RATIO), radius_derivative(alpha, RATIO, 1.0));
        let (im, dim) = ratio(alpha);
        let inertia = CRANK_INERTIA + MASS * rz * rz + rod_inertia / (im * im);
        // Eqs. (14), (21): the two terms may cancel.
        let terms = [2.0 * MASS * rz * drz, -2.0 * rod_inertia * dim / im.powi(3)];
        let change = terms[0] + terms[1];
        // F_C^v of eq. (6) opposes the motion: weight minus upward force.
        let static_load = (MASS * 9.81 - force) * rz;
        let additional = -0.5 * omega * omega * change;
        let full = [static_load.abs(), additional.abs(), torque.abs()].into_iter().fold(0.0, f64::max);
        let acceleration = (torque - static_load + additional) / inertia;
        let part = R * R * MASS * omega * omega;
        worst.compare("angle", run.get("drive.angle"), alpha - FRAC_PI_2, 1.0);
        worst.compare("speed", run.get("drive.speed"), omega, 300.0);
        worst.compare("(1), (18) v_C", run.get("piston.velocity_y"), rz * omega, R * omega);
        worst.compare("(12), (20) I_zS", run.get("drive.reduced_inertia"), inertia, inertia);
        worst.compare("(21) dI_zS/dalpha", run.get("drive.reduced_inertia_derivative"), change, MASS * R * R);
        worst.compare("(11) T_Su", run.get("drive.static_load"), static_load, (MASS * 9.81 - force) * R);
        worst.compare("(15) Delta T_S", run.get("drive.additional_torque"), additional, part);
        let required = static_load + inertia * demand - additional;
        worst.compare("(16) T_S", run.get("drive.required_force"), required, full.max(inertia * demand).max(part));
        worst.compare("(17) epsilon_S", run.get("drive.acceleration"), acceleration, full.max(part) / inertia);
        let size = (R * acceleration).abs() + R * omega * omega;
        let a = rz * acceleration + omega * omega * drz;
        worst.compare("(3) a_C", run.get("piston.acceleration_y"), a, size);
        let epsilon = acceleration / im - (omega / im).powi(2) * dim;
        worst.compare("(2) omega_C", run.get("rod.speed"), omega / im, omega * R / ROD);
        worst.compare("(4) epsilon_C", run.get("rod.acceleration"), epsilon, size / ROD);
        worst.compare("T", 0.5 * inertia * omega * omega, run.get("energy.kinetic"), 0.0);
    }
    worst.assert_within(ACCURACY);
}

#[test]
fn the_mechanism_follows_the_closed_forms_and_with_an_inertia_of_the_rod_too() {
    closed_forms(&mut Run::new(SLIDER_CRANK), 0.0);
    let rod = format!("\"rod\": {{ \"length\": 0.2, \"inertia\": {ROD_INERTIA} }}");
    closed_forms(&mut Run::replaced(SLIDER_CRANK, &[("\"rod\": { \"length\": 0.2 }", &rod)]), ROD_INERTIA);
}

#[test]
fn the_formulas_in_print_disagree() {
    let mut run = Run::new(SLIDER_CRANK);
    let print = (R / ROD) * (R / ROD);
    let (mut imaginary, mut apart) = (0, 0);
    for k in 1..100 {
        let alpha = TAU * f64::from(k) / 100.0;
        place(&mut run, alpha, 7.0);
        let rz = run.get("piston.velocity_y") / 7.0;
        // Eqs. (18), (20) print r^2/l^2 instead of l^2/r^2.
        match radius(alpha, print) {
            printed if printed.is_nan() => imaginary += 1,
            printed => apart += i32::from((printed - rz).abs() > 0.1 * R),
        }
        // Eq. (19) prints an additional factor 1/2. Eq. (21), which contains (19), is correct.
        let drz = run.get("drive.reduced_inertia_derivative") / (2.0 * MASS * rz);
        let correction = (radius_derivative(alpha, RATIO, 1.0) - R * alpha.cos()).abs();
        if rz.abs() > 0.1 * R {
            assert!((radius_derivative(alpha, RATIO, 1.0) - drz).abs() < 1e-10 * R);
            let printed = (radius_derivative(alpha, RATIO, 0.5) - drz).abs();
            assert!((printed - 0.5 * correction).abs() < 1e-10 * R, "{alpha}");
        }
    }
    assert!(imaginary > 80 && imaginary + apart > 90);
}
