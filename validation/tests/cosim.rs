//! The coupling schemes on pairs in closed form, and the circuit against reference values.
#![allow(clippy::unwrap_used)]

use validation::cosim::circuit::Circuit;
use validation::cosim::models::{Integrated, Mass, OilSpring};
use validation::cosim::pair::{Actuator, Motion, Pair, hermite};
use validation::cosim::schemes;
use validation::extrapolation::integrate;

/// A mass on an oil spring, from rest under a force.
const MASS: f64 = 700.0;
const SPRING: OilSpring = OilSpring { stiffness: 2e6, leak_time: 0.02 };
const START: f64 = 1000.0;
const SPAN: f64 = 0.1;

/// Speed and force of the coupled pair: v'' + v' / tau + omega^2 v = 0 with v = 0, v' = F0 / m at the start.
fn exact(t: f64) -> f64 {
    let (omega2, delta) = (SPRING.stiffness / MASS, 0.5 / SPRING.leak_time);
    let omega = (omega2 - delta * delta).sqrt();
    // The length is the integral of the speed F0 / (m omega) exp(-delta t) sin(omega t).
    let (sin, cos) = (omega * t).sin_cos();
    START / (MASS * omega) * (omega - (-delta * t).exp() * (delta * sin + omega * cos)) / omega2
}

/// Error of the length at the end of the span with this number of steps.
fn error(scheme: &str, steps: u32) -> f64 {
    let (mut mass, mut spring) = (Mass::new(MASS, 0.0, [0.5, 0.0]), Integrated::new(SPRING, [START, 0.0, 0.0, 0.0]));
    let mut pair = Pair::new(&mut mass, &mut spring);
    let mut scheme = schemes::by_name(scheme).unwrap();
    let h = SPAN / f64::from(steps);
    (0..steps).for_each(|k| scheme.step(&mut pair, h * f64::from(k), h).unwrap());
    mass.state[0] - 0.5 - exact(SPAN)
}

/// Each scheme has its order, at steps where the coupling is stable and the error exceeds rounding.
#[test]
fn each_scheme_has_its_order_on_a_mass_on_an_oil_spring() {
    for (scheme, order, steps) in [
        ("Jacobi 0", 1.0, 3200),
        ("NEPCE on it", 1.0, 3200),
        ("Jacobi 1", 2.0, 1600),
        // The first step holds the force, with an error of order h^2.
        ("Jacobi 2", 2.0, 800),
        ("Jacobi rates", 3.0, 400),
        ("Gauss-Seidel 0", 1.0, 1600),
        ("Gauss-Seidel 1", 2.0, 800),
        ("Gauss-Seidel rates", 3.0, 400),
        ("hydraulics first, rates", 3.0, 200),
        ("waveform, linear F", 2.0, 100),
        ("waveform, quadratic F", 3.0, 50),
        ("interface Jacobian, linear F", 2.0, 100),
        ("interface Jacobian, quadratic F", 3.0, 50),
    ] {
        let errors = [steps, 2 * steps].map(|n| error(scheme, n));
        let seen = (errors[0] / errors[1]).abs().log2();
        // On this pair the parabola's error of order 3 is small against the error of order 4.
        let most = if scheme.contains("quadratic") { 4.15 } else { order + 0.15 };
        assert!(seen > order - 0.15 && seen < most, "{scheme}: order {seen}, errors {errors:?}");
    }
}

/// The element model is exact for a constant mass and load: the prediction is exact for any step. With a held force the
/// speed at the end of the step is exact, the length is not.
#[test]
fn preview_is_exact_for_a_constant_mass() {
    let size = exact(SPAN).abs();
    for scheme in ["preview, one pass, linear", "preview, two passes, with dW/ds", "preview, two passes, by difference"]
    {
        for steps in [5, 20, 100] {
            let error = error(scheme, steps).abs();
            // In two passes the force of a step follows from a speed that is a polynomial of degree 4.
            let limit = if scheme.contains("two") { 2e-1 * f64::from(steps).powi(-4) } else { 1e-12 };
            // The length itself has the size 0.5 m.
            assert!(error < limit * size + 1e-15, "{scheme}, {steps}: {error:e} of {size:e}");
        }
    }
    let errors = [40, 80].map(|steps| error("preview, one pass, held", steps));
    assert!(((errors[0] / errors[1]).log2() - 2.0).abs() < 0.15, "{errors:?}");
}

/// Stability limit of the step for Jacobi coupling of the linearised pair at these crank angles: reduced mass [kg],
/// stiffness [N/m], damping ratio, 2 zeta / omega [s].
const FROZEN: [[f64; 4]; 7] = [
    [1137.0, 52.3e6, 0.175, 1.63e-3],
    [734.0, 25.3e6, 0.100, 1.08e-3],
    [646.0, 18.6e6, 0.084, 1.00e-3],
    [718.0, 17.1e6, 0.106, 1.38e-3],
    [1017.0, 19.0e6, 0.183, 2.73e-3],
    [734.0, 28.1e6, 0.094, 0.97e-3],
    [313.0, 31.7e6, 0.036, 0.23e-3],
];

/// Spectral radius of one step of a scheme with a mass m and an oil spring, from the growth over many steps.
fn growth(scheme: &str, mass: f64, spring: OilSpring, h: f64) -> f64 {
    let mut mass = Mass::new(mass, 0.0, [0.5, 0.0]);
    let mut oil = Integrated::new(spring, [1.0, 0.0, 0.0, 0.0]);
    let mut scheme = schemes::by_name(scheme).unwrap();
    let frequency = (spring.stiffness / mass.mass).sqrt();
    let mut pair = Pair::new(&mut mass, &mut oil);
    let mut energy = Vec::new();
    for k in 0..4000 {
        scheme.step(&mut pair, h * f64::from(k), h).unwrap();
        let (speed, force) = (pair.mechanism.motion().unwrap().speed, pair.actuator.force().unwrap());
        energy.push((speed * speed * frequency * frequency + (force / mass_of(&mut pair)).powi(2)).ln());
    }
    // Mean over the second half, in which only the slowest mode is left.
    ((energy[3999] - energy[1999]) / 4000.0).exp()
}

fn mass_of(pair: &mut Pair) -> f64 {
    pair.mechanism.element().unwrap().mass
}

/// Jacobi coupling with held inputs is stable for h < 2 zeta / omega.
#[test]
fn jacobi_is_stable_below_twice_the_damping_ratio_over_the_frequency() {
    for [mass, stiffness, zeta, step] in FROZEN {
        let omega = (stiffness / mass).sqrt();
        let spring = OilSpring { stiffness, leak_time: 0.5 / (zeta * omega) };
        assert!((2.0 * zeta / omega / step - 1.0).abs() < 0.02, "{step}");
        let (mut low, mut high) = (0.5 * step, 2.0 * step);
        assert!(growth("Jacobi 0", mass, spring, low) < 1.0 && growth("Jacobi 0", mass, spring, high) > 1.0);
        while high - low > 1e-3 * step {
            let middle = 0.5 * (low + high);
            *(if growth("Jacobi 0", mass, spring, middle) < 1.0 { &mut low } else { &mut high }) = middle;
        }
        assert!((low / step - 1.0).abs() < 0.05, "stable up to {low}, the law says {step}");
        assert!((low / (2.0 * zeta / omega) - 1.0).abs() < 0.01);
    }
}

/// A polynomial of degree 4 is reproduced.
#[test]
fn the_interpolated_speed_matches_both_ends() {
    let (v, h) = ([0.3, -1.2, 4.0, 50.0, -700.0], 0.07);
    let at = |t: f64| Motion {
        length: 0.5 + t * (v[0] + t / 2.0 * (v[1] + t / 3.0 * (v[2] + t / 4.0 * (v[3] + t / 5.0 * v[4])))),
        speed: v[0] + t * (v[1] + t / 2.0 * (v[2] + t / 3.0 * (v[3] + t / 4.0 * v[4]))),
        acceleration: v[1] + t * (v[2] + t / 2.0 * (v[3] + t / 3.0 * v[4])),
    };
    for (found, given) in hermite(at(0.0), at(h), h).into_iter().zip(v) {
        // Four conditions divided by up to h^4.
        assert!((found - given).abs() < 1e-9 * given.abs(), "{found} {given}");
    }
}

/// Gauss-Seidel is stable for twice the step of Jacobi coupling.
#[test]
fn gauss_seidel_is_stable_at_twice_the_step_of_jacobi() {
    let [mass, stiffness, zeta, _] = FROZEN[2];
    let omega = (stiffness / mass).sqrt();
    let spring = OilSpring { stiffness, leak_time: 0.5 / (zeta * omega) };
    let limit = 2.0 * zeta / omega;
    assert!(growth("Gauss-Seidel 0", mass, spring, 1.8 * limit) < 1.0);
    assert!(growth("Gauss-Seidel 0", mass, spring, 2.3 * limit) > 1.0);
}

/// Values of the circuit's laws at single points, to all given digits.
#[test]
fn the_circuit_has_the_reference_flows() {
    let circuit = Circuit::standard();
    let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 2e-13, "{value:e} {expected:e}");
    near(circuit.areas()[0], 0.001_590_431_280_879_832_6);
    near(circuit.areas()[1], 0.001_099_557_428_756_427_4);
    near(circuit.bulk(5e6), 1_321_595_325.333_9);
    near(circuit.bulk(0.35e6), 291_483_049.787_1);
    near(circuit.friction(0.01)[0], 358.624_710_158_78);
    for (x, state, a, b) in [
        (0.1, [5e6, 8e6, 0.5, 0.0], 1.065_393_971_030_2e-4, -7.489_738_586_845_6e-5),
        (0.315, [12e6, 16e6, 0.65, 0.0], 1.032_816_594_677_5e-4, -6.522_398_968_940_9e-5),
        (0.01, [5e6, 8e6, -0.5, 0.0], -2.091_656_050_676_9e-5, 9.426_283_492_468_1e-5),
    ] {
        let [flow_a, flow_b] = circuit.flows(circuit.closed_length + x, &state);
        near(flow_a, a);
        near(flow_b, b);
    }
    let (v, d) = (0.013, 1e-6);
    let slope = (circuit.friction(v + d)[0] - circuit.friction(v - d)[0]) / (2.0 * d);
    assert!((slope / circuit.friction(v)[1] - 1.0).abs() < 1e-7);
}

/// The circuit alone with a given motion, with cavitation, relief and reversal of the friction.
#[test]
fn the_circuit_alone_has_the_reference_pressures() {
    let circuit = Circuit { ramp: [0.0, 0.1], command: 0.4, ..Circuit::standard() };
    let mut oil = Integrated::new(circuit, [6e6, 8e6, 0.0, 0.0]);
    let (mut t, h) = (0.0, 1e-3);
    for (until, p_a, p_b, force) in [
        (0.01, 472_875.119_061, 10_911_388.851_1, -11_544.873_288),
        (0.05, -13_523.705_699, 15_140_206.366_84, -16_965.284_908_2),
        (0.1, -25_100.951_360, 16_924_908.076_86, -18_942.329_747_3),
        (0.3, 1_077_695.348_164, 10_525_627.852_58, -10_137.109_840_7),
        (0.6, 19_288_133.033_38, 1_180_703.038_019, 29_019.574_619_3),
        (0.7, 20_758_479.107_34, 407_524.025_005, 32_867.054_710_5),
        (1.0, 28_266_440.307_96, 40_292.352_995, 45_186.816_675_9),
    ] {
        while t < until - 0.5 * h {
            let at = |t: f64| (0.50 + 0.10 * t - 0.075 * t * t, 0.10 - 0.15 * t);
            let (length, speed) = at(t);
            oil.set_motion(length, [speed, -0.15, 0.0, 0.0, 0.0]).unwrap();
            oil.step(t, h).unwrap();
            t += h;
        }
        let state = oil.state();
        let near = |value: f64, expected: f64| {
            assert!((value - expected).abs() < 2e-10 * (expected.abs() + 101_325.0), "{until} {value} {expected}")
        };
        near(state[0], p_a);
        near(state[1], p_b);
        assert!((oil.force().unwrap() / force - 1.0).abs() < 1e-9);
    }
}

/// The integrator has order 12: the exact exponential, at a step where the error exceeds rounding.
#[test]
fn the_integrator_has_the_order_12() {
    let error = |n: f64| {
        let [y] = integrate(&mut |_, y: &[f64; 1]| [y[0]], 0.0, [1.0], 4.0, 4.0 / n);
        (y / 4.0_f64.exp() - 1.0).abs()
    };
    let order = (error(2.0) / error(4.0)).log2();
    assert!((order - 12.0).abs() < 1.5, "{order}");
}
