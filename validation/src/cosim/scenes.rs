//! The scenes of the coupling, their reference values, and one run of a scheme.
//!
//! In: a scene, a scheme, a communication step. Out: errors, energy at the interface, steps. Reference values: an
//! independent Taylor-series integration of mechanism and circuit as one system.
use super::circuit::Circuit;
use super::fmus::{Gear, Hydraulic};
use super::models::Integrated;
use super::pair::{Actuator, Mechanism, Pair};
use super::schemes;
use super::unpacked::Fmu;
use std::sync::Arc;

/// Settings of the gear in all scenes. The tolerance is that of the reference runs.
const GEAR: [(&str, f64); 1] = [("solver.tolerance", 1e-12)];
/// Settings of the hydraulics in scene H2; scene H1 has the defaults.
const SMOOTH: [(&str, f64); 11] = [
    ("fluid.air_fraction", 0.0),
    ("seal.coulomb", 0.0),
    ("seal.static", 0.0),
    ("seal.viscous", 0.0),
    ("cushion_a.length", 0.0),
    ("cushion_b.length", 0.0),
    ("chamber_a.start_pressure", 8e6),
    ("chamber_b.start_pressure", 10.08e6),
    ("command.sine_amplitude", 0.5),
    ("command.sine_frequency", 2.0),
    ("solver.tolerance", 1e-12),
];
/// Command of scene H1: a ramp.
const RAMP: [(&str, f64); 3] =
    [("command.ramp_amplitude", 0.65), ("command.ramp_time", 0.1), ("solver.tolerance", 1e-12)];

/// A scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scene {
    /// Retraction, with cushions, entrained air, seal friction.
    H1,
    /// A sinusoidal command; all laws are analytic.
    H2,
    /// H1 with friction in the joints and 70 m/s of air, which the element model does not have.
    Rough,
    /// H1 beyond the contact with the up stop, to rest there.
    Contact,
}

impl Scene {
    /// Name.
    pub fn name(self) -> &'static str {
        match self {
            Self::H1 => "H1",
            Self::H2 => "H2",
            Self::Rough => "H1 with joint friction and 70 m/s of air",
            Self::Contact => "H1 to rest at the up stop",
        }
    }

    /// Time [s], crank angle [rad] and force [N].
    pub fn reference(self) -> &'static [[f64; 3]] {
        match self {
            Self::Rough | Self::Contact => &[],
            Self::H1 => &[
                [0.05, 0.793138133418578, -1232.161703436],
                [0.1, 0.769550975553854, -1605.896803131],
                [0.2, 0.703967315179619, -2008.847879986],
                [0.5, 0.523620580328936, -921.6257163131],
                [1.0, 0.253250298772210, 471.0857748807],
                [2.0, -0.242429680769236, 2710.350675763],
                [3.0, -0.759970553164200, 5284.562808813],
                [3.5, -1.05718309261089, 6463.272957934],
                [3.8, -1.22821155571711, 5265.166473185],
                [4.0, -1.28835660508442, 3674.566628157],
            ],
            Self::H2 => &[
                [0.05, -0.00484058453060504, 2142.016604783],
                [0.1, -0.0194469102739466, 2062.295462696],
                [0.25, -0.0609683061521160, 1394.520832211],
                [0.5, -0.0162693739682587, 2185.452093646],
                [0.75, -0.0777416580266453, 1460.146297057],
                [1.0, -0.0328997584464874, 2250.657639348],
            ],
        }
    }

    /// End of the run [s]: in H1 the last round time before the stop.
    pub fn span(self) -> f64 {
        match self {
            Self::H1 => 4.0,
            Self::H2 => 1.0,
            Self::Rough => 2.0,
            Self::Contact => 4.5,
        }
    }

    /// The gear at the start of the scene.
    ///
    /// # Errors
    /// The FMU refuses.
    pub fn gear(self, fmu: &Arc<Fmu>) -> Result<Gear, String> {
        let start = if self == Self::H2 { 0.0 } else { 0.8 };
        let air = if self == Self::Rough { 70.0 } else { 0.0 };
        let reals = [&GEAR[..], &[("crank.start_angle", start), ("airspeed", air)]].concat();
        let (stop, friction) = (self != Self::H2, self == Self::Rough);
        let flags = [("downstop.enabled", false), ("upstop.enabled", stop), ("friction.enabled", friction)];
        Gear::start(fmu, &reals, &flags)
    }

    /// The hydraulics at the start of the scene.
    ///
    /// # Errors
    /// The FMU refuses.
    pub fn hydraulic(self, fmu: &Arc<Fmu>, mode: &str) -> Result<Hydraulic, String> {
        Hydraulic::start(fmu, if self == Self::H2 { &SMOOTH } else { &RAMP }, mode)
    }

    /// The circuit in plain numbers at the start of the scene.
    pub fn circuit(self) -> Integrated<Circuit> {
        let (laws, x) = if self == Self::H2 { Circuit::h2() } else { Circuit::h1() };
        // The figures to compare with have no correction of the load where the element model is exact.
        let mut actuator = Integrated::new(laws, x);
        actuator.corrects = matches!(self, Self::Rough | Self::Contact);
        actuator
    }
}

/// The FMUs of a pair; without that of the hydraulics, the circuit in plain numbers takes its place.
#[derive(Clone, Debug)]
pub struct Fmus {
    /// `LandingGearRetraction`.
    pub gear: Arc<Fmu>,
    /// `HydraulicActuator`.
    pub hydraulic: Option<Arc<Fmu>>,
}

/// What one run gives.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Crank angle [rad] and force [N] at every communication point, the start included.
    pub trace: Vec<[f64; 2]>,
    /// Largest difference of the mechanism's gain of energy from the actuator's work [J].
    pub interface: f64,
    /// Steps of mechanism and actuator for each communication step.
    pub steps: [f64; 2],
}

/// Run a scheme over a scene in steps of h [s].
///
/// # Errors
/// A side refuses a call: the coupling was unstable.
pub fn run(fmus: &Fmus, scene: Scene, scheme: &str, h: f64) -> Result<Run, String> {
    let mut gear = scene.gear(&fmus.gear)?;
    let mode = schemes::mode(scheme);
    match &fmus.hydraulic {
        Some(fmu) => couple(&mut gear, &mut scene.hydraulic(fmu, mode)?, scene, scheme, h),
        None => couple(&mut gear, &mut scene.circuit(), scene, scheme, h),
    }
}

/// Run a scheme with two sides.
///
/// # Errors
/// As [`run`].
pub fn couple(
    gear: &mut dyn Mechanism,
    actuator: &mut dyn Actuator,
    scene: Scene,
    scheme: &str,
    h: f64,
) -> Result<Run, String> {
    let mut scheme = schemes::by_name(scheme).ok_or_else(|| format!("no scheme is called {scheme}"))?;
    let start = gear.energy()? - actuator.work()?;
    let mut run = Run::default();
    let mut pair = Pair::new(gear, actuator);
    let steps = (scene.span() / h * (1.0 + 1e-12)).floor() as u64;
    let mut tell = |pair: &mut Pair| -> Result<(), String> {
        let motion = pair.mechanism.motion()?;
        pair.actuator.set_motion(motion.length, [motion.speed, 0.0, 0.0, 0.0, 0.0])?;
        run.trace.push([pair.mechanism.position()?, pair.actuator.force()?]);
        let gained = pair.mechanism.energy()? - start - pair.actuator.work()?;
        run.interface = run.interface.max(gained.abs());
        Ok(())
    };
    tell(&mut pair)?;
    for k in 0..steps {
        scheme.step(&mut pair, h * k as f64, h)?;
        tell(&mut pair)?;
    }
    run.steps = pair.steps.map(|count| count as f64 / steps as f64);
    Ok(run)
}
