//! A hydraulic actuator or a gear with a circuit in the stress suite: the engine's run and the same circuit in plain
//! numbers.
//!
//! In: parameters by name, a motion or an element, valve commands by step. Out: the state at the end of both, and the
//! work of the piston.
use super::implicit::integrate;
use crate::cosim::circuit::Circuit;
use linkage_fmu::hydraulics::Model;
use linkage_fmu::integrator::{Method, Statistics};

const ACTUATOR: &str = include_str!("../../../../modelDescription/HydraulicActuator/resources/hydraulics.json");

/// Motion of the piston.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// A length s + v t + a t^2 / 2 [m].
    Motion([f64; 3]),
    /// One element that starts with the length s and the speed v: mass, its derivative, load, its derivative.
    Element([f64; 2], [f64; 4]),
}

impl Drive {
    /// Name in `scenes/hydraulics.json`.
    pub fn word(&self) -> &'static str {
        if let Self::Motion(_) = self { "motion" } else { "element" }
    }
}

/// One run.
#[derive(Clone, Debug)]
pub struct Case {
    /// Parameters of the FMU, by name.
    pub set: Vec<(&'static str, f64)>,
    /// Pressures at the start [Pa].
    pub start: [f64; 2],
    /// Motion of the piston.
    pub drive: Drive,
    /// Span [s] and communication steps.
    pub span: f64,
    /// Number of communication steps.
    pub steps: usize,
    /// Commands of the valve in turn, each for a communication step.
    pub commands: Vec<f64>,
}

/// Pressures, spool and its speed, length, speed, work of the piston.
pub type End = [f64; 7];

/// Result of the engine's run.
#[derive(Clone, Debug)]
pub struct Run {
    /// The state at the end.
    pub end: End,
    /// Work of the integration.
    pub work: Statistics,
    /// Accepted steps of the implicit method.
    pub implicit: u64,
    /// CPU time of the thread [s].
    pub cpu: f64,
}

impl Case {
    /// The circuit in plain numbers.
    pub fn circuit(&self) -> Circuit {
        let mut circuit = Circuit::standard();
        for (name, value) in &self.set {
            circuit.parameter(name).into_iter().for_each(|own| *own = *value);
        }
        circuit
    }

    /// Command in step `k`.
    fn command(&self, k: usize) -> f64 {
        self.commands[k % self.commands.len()]
    }

    /// The engine's run.
    pub fn run(&self, tolerance: f64) -> Result<Run, String> {
        let words = |e: linkage_fmu::hydraulics::HydraulicsError| e.to_string();
        let mut model = Model::from_json(ACTUATOR).map_err(words)?;
        let list: Vec<String> = model.variables().list().iter().map(|v| v.name.clone()).collect();
        let find = |name: &str| list.iter().position(|own| own == name).ok_or(format!("no variable {name}"));
        let set = |model: &mut Model, name: &str, value: f64| -> Result<(), String> {
            model.set_real(find(name)? as u32, value).map_err(words)
        };
        for (name, value) in &self.set {
            set(&mut model, name, *value)?;
        }
        set(&mut model, "chamber_a.start_pressure", self.start[0])?;
        set(&mut model, "chamber_b.start_pressure", self.start[1])?;
        let ([length, speed], mode) = match self.drive {
            Drive::Motion([s, v, _]) => ([s, v], "follow"),
            Drive::Element(at, _) => (at, "preview"),
        };
        model.set_text(find("coupling.mode")? as u32, mode).map_err(words)?;
        set(&mut model, "solver.tolerance", tolerance)?;
        set(&mut model, "actuator.length", length)?;
        set(&mut model, "actuator.speed", speed)?;
        model.initialize().map_err(words)?;
        let h = self.span / self.steps as f64;
        set(&mut model, "preview.horizon", h)?;
        let began = cpu_time::ThreadTime::now();
        for k in 0..self.steps {
            let t = h * k as f64;
            set(&mut model, "valve.command", self.command(k))?;
            match self.drive {
                Drive::Motion([s, v, a]) => {
                    set(&mut model, "actuator.length", s + t * (v + 0.5 * a * t))?;
                    set(&mut model, "actuator.speed", v + a * t)?;
                    model.set_input_derivative(find("actuator.speed")? as u32, 1, a).map_err(words)?;
                }
                Drive::Element([s, _], [mass, mass_slope, load, load_slope]) => {
                    let way = model.real(find("actuator.length")? as u32).map_err(words)? - s;
                    set(&mut model, "actuator.reduced_mass", mass + mass_slope * way)?;
                    set(&mut model, "actuator.reduced_mass_derivative", mass_slope)?;
                    set(&mut model, "actuator.holding_force", load + load_slope * way)?;
                    set(&mut model, "actuator.holding_force_derivative", load_slope)?;
                }
            }
            model.step(h).map_err(words)?;
        }
        let cpu = began.elapsed().as_secs_f64();
        let mut end = [0.0; 7];
        let names = [
            "chamber_a.pressure",
            "chamber_b.pressure",
            "valve.position",
            "valve.speed",
            "actuator.length",
            "actuator.speed",
            "energy.piston",
        ];
        for (value, name) in end.iter_mut().zip(names) {
            *value = model.real(find(name)? as u32).map_err(words)?;
        }
        let work = model.statistics();
        Ok(Run { end, implicit: work.accepted_by(Method::Radau), work, cpu })
    }

    /// Error weights of the state at the end, to which the engine's tolerance refers: absolute pressures, spool with a
    /// lower limit, stroke, speed with a lower limit.
    pub fn weights(&self, circuit: &Circuit, y: &End) -> End {
        let ambient = circuit.ambient_pressure;
        let pressure = |p: f64| (p + ambient).max(ambient);
        let spool = 0.1 + y[2].abs();
        let omega = std::f64::consts::TAU * circuit.frequency;
        [pressure(y[0]), pressure(y[1]), spool, omega * spool, circuit.stroke, y[5].abs().max(0.01), f64::INFINITY]
    }

    /// The state at the start in plain numbers.
    pub fn at_start(&self) -> End {
        let [s, v] = match self.drive {
            Drive::Motion([s, v, _]) => [s, v],
            Drive::Element(at, _) => at,
        };
        [self.start[0], self.start[1], 0.0, 0.0, s, v, 0.0]
    }

    /// The circuit in plain numbers from the state `y` before step `from` to the end, each step with a tolerance.
    /// `look` gets the state before each step.
    pub fn exact(
        &self,
        mut y: End,
        from: usize,
        tolerance: f64,
        mut look: impl FnMut(usize, &End),
    ) -> Result<End, String> {
        let mut circuit = self.circuit();
        let h = self.span / self.steps as f64;
        let mut k = from;
        while k < self.steps {
            look(k, &y);
            circuit.command = self.command(k);
            // One integration while the command is constant.
            let count = if self.commands.len() == 1 { (self.steps / 16).max(1).min(self.steps - k) } else { 1 };
            let mut f = |t: f64, y: &End| {
                let [s, v] = match self.drive {
                    Drive::Motion([s, v, a]) => [s + t * (v + 0.5 * a * t), v + a * t],
                    Drive::Element(..) => [y[4], y[5]],
                };
                let x = [y[0], y[1], y[2], y[3]];
                let rates = circuit.rates(t, s, v, &x);
                let force = circuit.force(v, &x);
                let acceleration = match self.drive {
                    Drive::Motion([_, _, a]) => a,
                    Drive::Element([at, _], [mass, mass_slope, load, load_slope]) => {
                        let way = s - at;
                        (force - load - load_slope * way - 0.5 * mass_slope * v * v) / (mass + mass_slope * way)
                    }
                };
                [rates[0], rates[1], rates[2], rates[3], v, acceleration, force * v]
            };
            let scale = |y: &End| self.weights(&self.circuit(), y);
            let (t, span) = (h * k as f64, h * count as f64);
            y = integrate(&mut f, &scale, 6, t, y, span, tolerance)?;
            k += count;
        }
        Ok(y)
    }
}
