//! [CK16] 3: the jib of fig. 12, equations (22)-(25), (32)-(42), over the range of x in the paper, 2.2 to 3.2 m.
//!
//! The mass m_C is at the end of the jib. In one variant the jib also has the inertia I_C.
use super::worst::{ACCURACY, Worst, wave};
use crate::support::{JIB, Run};

pub const E: f64 = 1.3;
const B: f64 = 2.2;
const L: f64 = 5.0;
const MASS: f64 = 1000.0;
const JIB_INERTIA: f64 = 4000.0;

/// Angle of the jib for the cylinder length x: cosine rule in the triangle A, S, B.
pub fn angle(x: f64) -> f64 {
    ((x * x - E * E - B * B) / (2.0 * E * B)).asin()
}

/// Sine of the angle between e and x.
fn sine(x: f64) -> f64 {
    (1.0 - ((x * x + E * E - B * B) / (2.0 * E * x)).powi(2)).sqrt()
}

/// Eq. (39).
pub fn ratio(x: f64) -> f64 {
    E / L * sine(x)
}

/// Eq. (40).
fn ratio_derivative(x: f64) -> f64 {
    -(E / L).powi(2) * (x.powi(4) - (E * E - B * B).powi(2)) / (4.0 * E * E * x.powi(3) * E / L * sine(x))
}

/// Eq. (41).
fn mass(x: f64) -> f64 {
    MASS * L * L * 4.0 * x * x / (4.0 * E * E * x * x - (x * x + E * E - B * B).powi(2))
}

/// Eq. (42).
fn mass_derivative(x: f64) -> f64 {
    0.5 * MASS * L * L / E.powi(4) * (x.powi(4) - (E * E - B * B).powi(2)) / (x.powi(3) * sine(x).powi(4))
}

/// Start at the length x with the speed v_S.
pub fn place(run: &mut Run, x: f64, speed: f64) {
    run.place(("jib.start_angle", angle(x)), ("jib.start_speed", speed / (E * sine(x))));
}

/// x, v_S, F_S, force at the end (x, y), demanded acceleration.
fn states() -> impl Iterator<Item = [f64; 6]> {
    (0..=200).map(|k| {
        [
            2.2 + 0.005 * f64::from(k),
            0.8 * wave(k, 0.7),
            6e4 * wave(k, 1.1),
            4e3 * wave(k, 1.9),
            6e3 * wave(k, 2.9),
            3.0 * wave(k, 2.3),
        ]
    })
}

fn closed_forms(run: &mut Run, inertia: f64) {
    let mut worst = Worst::default();
    for [x, speed, force, end_x, end_y, demand] in states() {
        place(run, x, speed);
        run.set_all(&[
            ("cylinder.force", force),
            ("tip.force_x", end_x),
            ("tip.force_y", end_y),
            ("cylinder.demanded_acceleration", demand),
        ]);
        let theta = angle(x);
        let (iv, div) = (ratio(x), ratio_derivative(x));
        // Eq. (22) for the jib: R_e = v_S / omega = l i_v.
        let (re, dre) = (L * iv, L * div);
        let reduced = mass(x) + inertia / (re * re);
        let change = mass_derivative(x) - 2.0 * inertia * dre / re.powi(3);
        let along = |x: f64, y: f64| y * theta.cos() - x * theta.sin();
        let static_load = -along(end_x, end_y - MASS * 9.81) / iv;
        let additional = -0.5 * speed * speed * change;
        let acceleration = (force - static_load + additional) / reduced;
        let full = force.abs().max(static_load.abs()).max(additional.abs());
        worst.compare("x", run.get("cylinder.length"), x, x);
        worst.compare("v_S", run.get("cylinder.speed"), speed, speed);
        let v = along(run.get("tip.velocity_x"), run.get("tip.velocity_y"));
        worst.compare("(23), (39) v_C", v, speed / iv, 0.0);
        worst.compare("(22) omega_C", run.get("jib.speed"), speed / re, 0.0);
        worst.compare("(33), (41) m_zS", run.get("cylinder.reduced_mass"), reduced, 0.0);
        worst.compare("(42) dm_zS/dx", run.get("cylinder.reduced_mass_derivative"), change, reduced);
        worst.compare("(32) F_Su", run.get("cylinder.static_load"), static_load, MASS * 9.81 / iv);
        worst.compare("(36) Delta F_S", run.get("cylinder.additional_force"), additional, speed * speed * reduced);
        let required = static_load + reduced * demand - additional;
        worst.compare("(37) F_S", run.get("cylinder.required_force"), required, full.max(MASS * 9.81 / iv));
        worst.compare("(38) a_S", run.get("cylinder.acceleration"), acceleration, full / reduced);
        let a = along(run.get("tip.acceleration_x"), run.get("tip.acceleration_y"));
        let size = full / reduced / iv;
        worst.compare("(24) a_C", a, acceleration / iv - (speed / iv).powi(2) * div, size);
        let epsilon = acceleration / re - (speed / re).powi(2) * dre;
        worst.compare("(25) epsilon_C", run.get("jib.acceleration"), epsilon, size / L);
        worst.compare("T", run.get("energy.kinetic"), 0.5 * reduced * speed * speed, 0.0);
        // At rest F_Su balances the same loads.
        worst.compare("holding", run.get("cylinder.holding_force"), static_load, MASS * 9.81 / iv);
        // dF_Su/dx: the loads turn with the jib (d theta / dx = 1 / R_e), and i_v changes.
        let radial = -(end_x * theta.cos() + (end_y - MASS * 9.81) * theta.sin());
        let slope = -(radial / re) / iv - static_load * div / iv;
        let size = (MASS * 9.81 + end_x.abs() + end_y.abs()) / iv * (1.0 / re + (div / iv).abs());
        worst.compare("dF_Su/dx", run.get("cylinder.holding_force_derivative"), slope, size);
    }
    worst.assert_within(ACCURACY);
}

#[test]
fn the_mechanism_follows_the_closed_forms_and_with_an_inertia_of_the_jib_too() {
    closed_forms(&mut Run::new(JIB), 0.0);
    let jib = format!("\"jib\": {{ \"length\": 5, \"inertia\": {JIB_INERTIA},");
    closed_forms(&mut Run::replaced(JIB, &[("\"jib\": { \"length\": 5,", &jib)]), JIB_INERTIA);
}

/// Eqs. (24), (31), (34) contain v_S^2 di_v/dx. The paper prints di_v/dt, which is v_S di_v/dx.
#[test]
fn the_formulas_in_print_disagree() {
    let mut run = Run::new(JIB);
    for k in 0..=20 {
        let (x, speed) = (2.2 + 0.05 * f64::from(k), 0.5);
        place(&mut run, x, speed);
        run.set("cylinder.demanded_acceleration", 0.0);
        let (iv, div, theta) = (ratio(x), ratio_derivative(x), angle(x));
        let a = run.get("tip.acceleration_y") * theta.cos() - run.get("tip.acceleration_x") * theta.sin();
        let own = run.get("cylinder.acceleration") / iv;
        let (right, printed) = (own - (speed / iv).powi(2) * div, own - (speed / iv).powi(2) * div * speed);
        let size = own.abs().max((speed / iv).powi(2) * div.abs());
        assert!((a - right).abs() < 1e-11 * size, "{x}");
        assert!((a - printed).abs() > 0.4 * (speed / iv).powi(2) * div.abs(), "{x}");
        let velocity_part = |rate: f64| -MASS * speed * speed / iv.powi(3) * rate;
        let part = run.get("cylinder.required_force") - run.get("cylinder.static_load");
        assert!((part - velocity_part(div)).abs() < 1e-10 * MASS * 9.81 / iv, "{x}");
        assert!((part - velocity_part(div * speed)).abs() > 0.4 * velocity_part(div).abs(), "{x}");
    }
}
