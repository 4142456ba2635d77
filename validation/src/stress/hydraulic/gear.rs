//! The landing gear with a circuit: its motion drives the circuit in plain numbers, whose pressures must equal those of
//! the engine; and the mechanism's gain of energy must equal the work of the force, by a separate quadrature. A
//! mechanism of one degree of freedom for which this holds at every time fulfils its equation of motion.
use super::EACH;
use super::case::{Case, Drive};
use crate::cosim::circuit::State;
use crate::stress::hydraulic::implicit::integrate;
use crate::stress::{Outcome, Row, Verdict};
use linkage_fmu::integrator::Method;
use linkage_fmu::mechanism::Model;

const GEAR: &str = example!("LandingGearRetractionHydraulic");
/// Tolerance of the second integration.
const TIGHT: f64 = 1e-10;
/// The travel of the actuator [m]; force times travel is the reference energy.
const TRAVEL: f64 = 0.33;

/// One row.
#[derive(Clone, Debug)]
pub struct Scene {
    pub what: String,
    /// Parameters of the circuit, span, number of communication steps (a multiple of 4), commands.
    pub case: Case,
    pub tolerance: f64,
}

impl From<Scene> for Row {
    fn from(scene: Scene) -> Self {
        let (what, steps, tolerance) = (scene.what.clone(), scene.case.steps as u64, scene.tolerance);
        let (group, model) = ("Hydraulics: gear with a circuit", "LandingGearRetractionHydraulic");
        Self { group, model, what, tolerance, steps, refusal: None, run: Box::new(move || scene.judged()) }
    }
}

/// Outputs read at each communication point.
const READ: [&str; 9] = [
    "actuator.length",
    "actuator.speed",
    "actuator.acceleration",
    "chamber_a.pressure",
    "chamber_b.pressure",
    "valve.position",
    "actuator.force",
    "energy.kinetic",
    "energy.potential",
];
type Point = [f64; READ.len()];

/// The motion between two points: the polynomial of degree 5 with length, speed and acceleration at both ends, and its
/// rate, t [s] after the first.
fn between(from: &Point, to: &Point, h: f64, t: f64) -> [f64; 2] {
    let (a, b, c) = (from[0], from[1] * h, 0.5 * from[2] * h * h);
    let (p, q, r) = (to[0] - a - b - c, to[1] * h - b - 2.0 * c, 0.5 * to[2] * h * h - c);
    let (d, e, f) = (10.0 * p - 4.0 * q + r, -15.0 * p + 7.0 * q - 2.0 * r, 6.0 * p - 3.0 * q + r);
    let x = t / h;
    let s = a + x * (b + x * (c + x * (d + x * (e + x * f))));
    let v = (b + x * (2.0 * c + x * (3.0 * d + x * (4.0 * e + x * 5.0 * f)))) / h;
    [s, v]
}

impl Scene {
    fn judged(&self) -> Result<Outcome, String> {
        let case = &self.case;
        let (trace, model, cpu) = self.run()?;
        let h = case.span / case.steps as f64;
        let circuit = case.circuit();
        let weights = |y: &State| {
            let pressure = |p: f64| (p + circuit.ambient_pressure).max(circuit.ambient_pressure);
            let spool = 0.1 + y[2].abs();
            [pressure(y[0]), pressure(y[1]), spool, std::f64::consts::TAU * circuit.frequency * spool]
        };
        // The pressures with the gear's motion between all points, or between every second point.
        let driven = |every: usize, mut y: State, first: usize| -> Result<Vec<State>, String> {
            let mut all = vec![y];
            for k in (first..case.steps).step_by(every) {
                let mut circuit = circuit.clone();
                circuit.command = case.commands[k % case.commands.len()];
                let (from, to, span) = (&trace[k], &trace[k + every], h * every as f64);
                let mut f = |t: f64, y: &State| {
                    let [s, v] = between(from, to, span, t);
                    circuit.rates(t, s, v, y)
                };
                y = integrate(&mut f, &weights, 4, 0.0, y, span, TIGHT)?;
                all.push(y);
            }
            Ok(all)
        };
        let start = [case.start[0], case.start[1], 0.0, 0.0];
        let exact = driven(1, start, 0)?;
        let steady = case.commands.len() == 1;
        let apart = |a: &State, b: &State| {
            let own = weights(b);
            (0..3).map(|i| ((a[i] - b[i]) / own[i]).abs()).fold(0.0, |worst: f64, e| worst.max(e))
        };
        let coarse = if steady { driven(2, start, 0)? } else { exact.iter().copied().step_by(2).collect() };
        let within = coarse.iter().zip(exact.iter().step_by(2)).fold(0.0, |w: f64, (a, b)| w.max(apart(a, b)));
        let mut kappa: f64 = 1.0;
        for place in [0, case.steps / 2] {
            let mut sum = 0.0;
            for i in 0..4 {
                let mut aside = exact[place];
                aside[i] += 1e-5 * weights(&exact[place])[i];
                let run = driven(1, aside, place)?;
                sum += run.iter().zip(&exact[place..]).fold(0.0, |w: f64, (a, b)| w.max(apart(a, b))) / 1e-5;
            }
            kappa = kappa.max(sum);
        }
        let work = model.statistics();
        let steps = (work.accepted + case.steps as u64) as f64;
        let bound = within + kappa * steps * (EACH * self.tolerance + f64::EPSILON) + 1e-10;
        let error = trace
            .iter()
            .zip(&exact)
            .fold(0.0, |worst: f64, (point, exact)| worst.max(apart(&[point[3], point[4], point[5], exact[3]], exact)));
        let (drift, quadrature, energy) = self.energy(&trace, h);
        let drift_bound = quadrature + energy * steps * (EACH * self.tolerance + f64::EPSILON) + 1e-12 * energy;
        let implicit = work.accepted_by(Method::Radau);
        let why = format!(
            "N = {}, of these {implicit} by Radau, kappa = {kappa:.1e}, V^2 = {energy:.1e} J, quadrature within \
             {quadrature:.1e} J",
            work.accepted
        );
        let verdict = if error <= bound && drift <= drift_bound { Verdict::Holds } else { Verdict::Fails };
        let (error, drift) = (Some((error, bound)), Some((drift, drift_bound)));
        Ok(Outcome { error, drift, work, cpu, why, verdict })
    }

    /// The engine's run: outputs at each communication point.
    fn run(&self) -> Result<(Vec<Point>, Model, f64), String> {
        let words = |e: linkage_fmu::mechanism::ModelError| e.to_string();
        let case = &self.case;
        let mut model = Model::from_json(GEAR).map_err(words)?;
        let find = |model: &Model, name: &str| model.variables().find(name).ok_or(format!("no variable {name}"));
        for stop in ["upstop.enabled", "downstop.enabled"] {
            let stop = find(&model, stop)?;
            model.set_boolean(stop, false).map_err(words)?;
        }
        let start = [("chamber_a.start_pressure", case.start[0]), ("chamber_b.start_pressure", case.start[1])];
        let angle = if let Drive::Motion([angle, ..]) = case.drive { angle } else { 0.0 };
        let own = [("crank.start_angle", angle), ("solver.tolerance", self.tolerance), ("command.ramp_amplitude", 0.0)];
        for (name, value) in case.set.iter().chain(&start).chain(&own) {
            let reference = find(&model, name)?;
            model.set_real(reference, *value).map_err(words)?;
        }
        model.initialize().map_err(words)?;
        let command = find(&model, "valve.command")?;
        let mut references = [0; READ.len()];
        for (reference, name) in references.iter_mut().zip(READ) {
            *reference = find(&model, name)?;
        }
        let read = |model: &mut Model| -> Result<Point, String> {
            let mut point = [0.0; READ.len()];
            for (value, reference) in point.iter_mut().zip(references) {
                *value = model.real(reference).map_err(words)?;
            }
            Ok(point)
        };
        let mut trace = vec![read(&mut model)?];
        let h = case.span / case.steps as f64;
        let began = cpu_time::ThreadTime::now();
        for k in 0..case.steps {
            model.set_real(command, case.commands[k % case.commands.len()]).map_err(words)?;
            model.step(h).map_err(words)?;
            trace.push(read(&mut model)?);
        }
        Ok((trace, model, began.elapsed().as_secs_f64()))
    }

    /// Largest difference between the gain of energy and the work of the force, the error of the quadrature, and the
    /// reference energy [J]; by Boole's rule, with Simpson's rule for its error.
    fn energy(&self, trace: &[Point], h: f64) -> (f64, f64, f64) {
        let power: Vec<f64> = trace.iter().map(|point| point[6] * point[1]).collect();
        let (mut boole, mut simpson, mut drift, mut own) = (0.0, 0.0, 0.0_f64, 0.0_f64);
        let gained = |k: usize| trace[k][7] + trace[k][8] - trace[0][7] - trace[0][8];
        for k in (0..self.case.steps).step_by(4) {
            let p = &power[k..=k + 4];
            boole += h * (14.0 * (p[0] + p[4]) + 64.0 * (p[1] + p[3]) + 24.0 * p[2]) / 45.0;
            simpson += h * (p[0] + p[4] + 4.0 * (p[1] + p[3]) + 2.0 * p[2]) / 3.0;
            drift = drift.max((gained(k + 4) - boole).abs());
            own = own.max((boole - simpson).abs());
        }
        let play = |point: &Point| 2.0 * point[7] + point[6].abs() * TRAVEL;
        (drift, own, trace.iter().map(play).fold(0.0, f64::max))
    }
}
