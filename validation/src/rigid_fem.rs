//! Scene S1 by rigid-link finite elements: order of the method, elastic limit, energy and run time.
use crate::measure::{self, Pages, heading, timed};
use crate::scene::SPAN;
use linkage_fmu::mechanism::{Model, ModelError};
use std::fmt::Write;
use std::path::Path;

/// Number of runs; the fastest counts.
const RUNS: usize = 3;
/// Steps from which the exact motion of the elastic gear is extrapolated [s].
const FINEST: [f64; 2] = [2e-6, 1e-6];

/// Results with one step size at the end of the span.
struct Point {
    theta: f64,
    drift: f64,
    milliseconds: f64,
}

/// The table as Markdown.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    let text = measure::mechanism(&descriptions.join("LandingGearRetraction"))?;
    let report = Model::from_json(&text).and_then(|mut model| report(&mut model));
    report.map(|page| Pages { page, csv: String::new() }).map_err(|e| e.to_string())
}

fn report(model: &mut Model) -> Result<String, ModelError> {
    model.set_tolerance(1e-13)?;
    let rigid = run(model)?;
    let limit = |model: &mut Model, factor: f64| -> Result<f64, ModelError> {
        let [coarse, fine] = [elastic(model, factor, FINEST[0])?, elastic(model, factor, FINEST[1])?];
        Ok(fine.theta + (fine.theta - coarse.theta) / 3.0)
    };
    let own = limit(model, 1.0)?;
    let [milliseconds, stretch, stiffer] = [
        format!("{:.2}", rigid.milliseconds),
        format!("{:.4e}", own - rigid.theta),
        format!("{:.4e}", limit(model, 10.0)? - rigid.theta),
    ];
    let mut out = measure::page(
        "rigid_fem",
        &[("milliseconds", &milliseconds), ("stretch", &stretch), ("stiffer", &stiffer), ("runs", &RUNS)],
    );
    let columns = ["to the reduced model [rad]", "to the own limit [rad]", "order", "drift [J]", "time [ms]"];
    out += &heading(&[&["solver.fem_step h [s]"], &columns[..]].concat());
    let mut above: Option<(f64, f64)> = None;
    for h in [2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6] {
        let Point { theta, drift, milliseconds } = elastic(model, 1.0, h)?;
        let error = theta - own;
        let order = above
            .map_or(String::new(), |(before, last)| format!("{:.3}", (last / error).abs().ln() / f64::ln(before / h)));
        let _ = writeln!(
            out,
            "| {h:.0e} | {:.4e} | {error:.3e} | {order} | {drift:.1e} | {milliseconds:.2} |",
            theta - rigid.theta
        );
        above = Some((h, error));
    }
    Ok(out)
}

/// Result by finite elements with E A times `factor`.
fn elastic(model: &mut Model, factor: f64, fem_step: f64) -> Result<Point, ModelError> {
    model.reset();
    measure::set(model, "solver.fem_step", fem_step)?;
    // More substeps than a host would accept in one step.
    measure::set(model, "solver.max_steps", 1e9)?;
    for name in ["crank.axial_stiffness", "coupler.axial_stiffness", "follower.axial_stiffness"] {
        let stated = measure::output(model, name)?;
        measure::set(model, name, factor * stated)?;
    }
    measure::set(model, "solver.method", "rigid_fem")?;
    run(model)
}

fn run(model: &mut Model) -> Result<Point, ModelError> {
    let mut seconds = f64::INFINITY;
    for _ in 0..RUNS {
        model.initialize()?;
        timed(&mut seconds, || model.step(SPAN))?;
    }
    let theta = measure::output(model, "crank.angle")?;
    Ok(Point { theta, drift: measure::output(model, "energy.drift")?, milliseconds: seconds * 1e3 })
}
