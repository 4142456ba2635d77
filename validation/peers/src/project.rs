//! This project: the packed mechanism in the engine, without an FMU.
use crate::measure::{Point, fastest};
use linkage_fmu::mechanism::{Model, ModelError};
use std::time::Instant;

const TOOL: &str = "linkage-fmu";
const JOINTS: [&str; 4] = ["joint1.force", "joint2.force", "joint3.force", "joint4.force"];

/// A curve of this project: settings of the model, steps and outputs.
struct Curve {
    method: &'static str,
    /// Booleans set to false; the curve is omitted if the model has no such variable.
    off: &'static [&'static str],
    /// Number of equal steps, and the outputs read after each of them.
    steps: u32,
    read: &'static [&'static str],
}

const CURVES: [Curve; 4] = [
    Curve { method: "tables", off: &[], steps: 1, read: &[] },
    Curve { method: "tables; no stops", off: &["upstop.enabled", "downstop.enabled"], steps: 1, read: &[] },
    Curve { method: "exact evaluator", off: &["solver.tables"], steps: 1, read: &[] },
    Curve { method: "tables; 1 ms steps with joint forces", off: &[], steps: 130, read: &JOINTS },
];

/// A scene of a mechanism: text of the definition, end time, compared output, and its exact value at the end.
pub struct Scene {
    pub name: &'static str,
    pub text: String,
    pub span: f64,
    pub output: &'static str,
    pub exact: f64,
}

/// Curves of the landing gear.
pub fn landing_gear(scene: &Scene) -> Result<Vec<Point>, ModelError> {
    let mut points = Vec::new();
    for curve in &CURVES {
        points.extend(curve.points(scene)?);
    }
    points.extend(rigid_fem(scene)?);
    Ok(points)
}

/// Curves of Andrews' squeezer.
pub fn squeezer(scene: &Scene) -> Result<Vec<Point>, ModelError> {
    CURVES[0].points(scene)
}

impl Curve {
    fn points(&self, scene: &Scene) -> Result<Vec<Point>, ModelError> {
        let mut points = Vec::new();
        for half in 4..=26 {
            let tolerance = 10f64.powf(-f64::from(half) / 2.0);
            let began = Instant::now();
            let mut model = Model::from_json(&scene.text)?;
            if let Some(missing) = self.off.iter().find(|name| model.variables().find(name).is_none()) {
                println!("{TOOL}: no curve '{}': there is no variable {missing}", self.method);
                break;
            }
            for name in self.off {
                let reference = model.variables().find(name).unwrap_or_default();
                model.set_boolean(reference, false)?;
            }
            model.set_tolerance(tolerance)?;
            points.push(self.point(scene, model, format!("tolerance {tolerance:.1e}"), began)?);
        }
        Ok(points)
    }

    /// A run restores the initial state, makes the steps, and reads the angle.
    fn point(&self, scene: &Scene, mut model: Model, setting: String, began: Instant) -> Result<Point, ModelError> {
        let angle = model.variables().find(scene.output).unwrap_or_default();
        let read: Vec<_> = self.read.iter().map(|name| model.variables().find(name).unwrap_or_default()).collect();
        model.initialize()?;
        // The first reading of a force builds its table.
        for &reference in &read {
            model.real(reference)?;
        }
        let start = model.snapshot();
        let set_up = began.elapsed().as_secs_f64();
        let h = scene.span / f64::from(self.steps);
        let (theta, run) = fastest(|| {
            model.restore(&start)?;
            for _ in 0..self.steps {
                model.step(h)?;
                for &reference in &read {
                    std::hint::black_box(model.real(reference)?);
                }
            }
            model.real(angle)
        })?;
        let evaluations = usize::try_from(model.statistics().evaluations).ok().filter(|&n| n > 0);
        Ok(Point {
            scene: scene.name,
            tool: TOOL,
            method: self.method.into(),
            setting,
            error: (theta - scene.exact).abs(),
            run,
            set_up,
            evaluations,
        })
    }
}

/// Time of the first reading of a joint's force, which builds a table, compared with the run time. Each time is the
/// least over several new models; run and later readings are also repeated. The forces are read at the end of the run.
pub fn first_reaction(scene: &Scene) -> Result<Vec<Point>, ModelError> {
    const MODELS: u32 = 40;
    const AGAIN: u32 = 50;
    const TIMED: [&str; 4] = ["run", "joint1.force; first", "the other three forces; first", "all four forces; later"];
    let mut points = Vec::new();
    for exponent in [3, 6, 9, 12] {
        let tolerance = 10f64.powi(-exponent);
        let (mut best, mut set_up, mut error) = ([f64::INFINITY; TIMED.len()], f64::INFINITY, 0.0);
        for _ in 0..MODELS {
            let began = Instant::now();
            let mut model = Model::from_json(&scene.text)?;
            model.set_tolerance(tolerance)?;
            model.initialize()?;
            set_up = began.elapsed().as_secs_f64().min(set_up);
            let angle = model.variables().find(scene.output).unwrap_or_default();
            let joints = JOINTS.map(|name| model.variables().find(name).unwrap_or_default());
            let start = model.snapshot();
            let run = |model: &mut Model| {
                seconds(|| {
                    model.restore(&start)?;
                    model.step(scene.span)
                })
            };
            let read = |model: &mut Model, references: &[_]| {
                seconds(|| {
                    for &reference in references {
                        std::hint::black_box(model.real(reference)?);
                    }
                    Ok(())
                })
            };
            let mut times =
                [run(&mut model)?, read(&mut model, &joints[..1])?, read(&mut model, &joints[1..])?, f64::MAX];
            for _ in 0..AGAIN {
                times[0] = run(&mut model)?.min(times[0]);
                times[3] = read(&mut model, &joints)?.min(times[3]);
            }
            error = (model.real(angle)? - scene.exact).abs();
            best = std::array::from_fn(|k| best[k].min(times[k]));
        }
        points.extend(TIMED.iter().zip(best).map(|(&method, run)| Point {
            scene: "S1 first reaction",
            tool: TOOL,
            method: method.into(),
            setting: format!("tolerance {tolerance:.1e}"),
            error,
            run,
            set_up,
            evaluations: None,
        }));
    }
    Ok(points)
}

/// Time that some work takes [s].
fn seconds<T>(work: impl FnOnce() -> Result<T, ModelError>) -> Result<f64, ModelError> {
    let began = Instant::now();
    work()?;
    Ok(began.elapsed().as_secs_f64())
}

/// The second formulation: Newmark's method over rigid-link finite elements. Its limit differs by the stretch of the
/// rods.
fn rigid_fem(scene: &Scene) -> Result<Vec<Point>, ModelError> {
    let curve = Curve { method: "rigid_fem (Newmark)", off: &[], steps: 1, read: &[] };
    let mut points = Vec::new();
    for h in [1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5] {
        let began = Instant::now();
        let mut model = Model::from_json(&scene.text)?;
        let reference = |name: &str| model.variables().find(name).unwrap_or_default();
        let (method, step) = (reference("solver.method"), reference("solver.fem_step"));
        model.set_text(method, "rigid_fem")?;
        model.set_real(step, h)?;
        points.push(curve.point(scene, model, format!("h {h:.0e} s"), began)?);
    }
    Ok(points)
}
