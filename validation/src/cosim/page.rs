//! The page of the coupling: error against communication step for every scheme and scene.
use super::scenes::{Fmus, Run, Scene, run};
use super::schemes;
use crate::measure::{Pages, heading, page};
use std::fmt::Write;

/// Communication step of the reference run, of which all others are multiples [s].
const FINEST: f64 = 5e-5;
/// Communication steps of the table, in multiples of the finest.
const STEPS: [usize; 5] = [2, 10, 20, 100, 400];
/// Scheme of the reference run.
const REFERENCE: &str = "preview, two passes, with dW/ds";
/// Largest errors of a usable run: crank angle [rad], force [N].
const USABLE: [f64; 2] = [1e-2, 1e3];
/// Force error beyond which a run counts as unstable [N].
const UNSTABLE: f64 = 3e3;
/// Longest step tried for the largest usable one, in multiples of the finest.
const LONGEST: usize = 4000;

/// Errors of a run: angle [rad], force [N], energy at the interface [J], steps of each side.
#[derive(Clone, Copy, Debug)]
struct Errors {
    angle: f64,
    force: f64,
    interface: f64,
    steps: [f64; 2],
}

/// The largest errors of a scheme over a scene in steps of so many finest ones; None if it was unstable.
fn errors(fmus: &Fmus, scene: Scene, scheme: &str, every: usize, reference: &Run) -> Option<Errors> {
    let run = run(fmus, scene, scheme, FINEST * every as f64).ok()?;
    let mut errors = Errors { angle: 0.0, force: 0.0, interface: run.interface, steps: run.steps };
    for (here, exact) in run.trace.iter().zip(reference.trace.iter().step_by(every)) {
        if !here[0].is_finite() || !here[1].is_finite() {
            return None;
        }
        errors.angle = errors.angle.max((here[0] - exact[0]).abs());
        errors.force = errors.force.max((here[1] - exact[1]).abs());
    }
    Some(errors)
}

/// Largest multiple of the finest step at which a scheme is usable: the last one before the first that is not, on a
/// grid that grows by a twelfth, then between its last two by bisection.
fn largest_usable(fmus: &Fmus, scene: Scene, scheme: &str, reference: &Run) -> usize {
    let usable = |every: usize| {
        errors(fmus, scene, scheme, every, reference).is_some_and(|e| e.angle < USABLE[0] && e.force < USABLE[1])
    };
    let (mut good, mut tried) = (0, 2);
    while tried <= LONGEST && usable(tried) {
        good = tried;
        tried = (tried + 1).max(tried * 13 / 12);
    }
    if tried > LONGEST {
        return LONGEST;
    }
    while tried - good > 1 {
        let middle = (good + tried) / 2;
        *(if usable(middle) { &mut good } else { &mut tried }) = middle;
    }
    good
}

/// Largest difference of the reference run from the reference values: angle [rad] and force [N].
fn against_values(scene: Scene, reference: &Run) -> [f64; 2] {
    let mut worst = [0.0_f64; 2];
    for [t, angle, force] in scene.reference() {
        let at = reference.trace.get((t / FINEST).round() as usize).copied().unwrap_or([f64::NAN; 2]);
        worst = [worst[0].max((at[0] - angle).abs()), worst[1].max((at[1] - force).abs())];
    }
    worst
}

/// The page, and its figures as CSV.
///
/// # Errors
/// The reference run is refused.
pub fn table(fmus: &Fmus) -> Result<Pages, String> {
    let side = match fmus.hydraulic {
        Some(_) => "the FMU `HydraulicActuator`",
        None => "the circuit in plain numbers",
    };
    let mut out = page(
        "Coupling of the gear and its hydraulic actuator",
        &format!(
            "The FMU `LandingGearRetraction` (tolerance 1e-12) and {side}, coupled through the functions of FMI 2.0 by \
             every scheme. Largest error of the crank angle [rad] over the run at communication points, against the run \
             of \"{REFERENCE}\" in steps of {FINEST:e} s; x: unstable, a force error of more than {UNSTABLE} N."
        ),
    );
    let mut csv = String::from("scene,scheme,step,angle,force,interface,mechanism_steps,actuator_steps\n");
    for scene in [Scene::H1, Scene::H2] {
        let reference = run(fmus, scene, REFERENCE, FINEST)?;
        let [angle, force] = against_values(scene, &reference);
        let _ = writeln!(
            out,
            "## Scene {}\n\nThe reference run differs from an independent integration of the whole as one system by \
             {angle:.1e} rad and {force:.1e} N.\n",
            scene.name()
        );
        let steps = STEPS.map(|every| format!("{} ms", every as f64 * FINEST * 1e3));
        let steps: Vec<&str> = steps.iter().map(String::as_str).collect();
        let more = ["force at 1 ms [N]", "energy at 1 ms [J]", "steps of each", "largest usable [ms]"];
        out += &heading(&[&["scheme"], &steps[..], &more].concat());
        for (name, _) in schemes::ALL {
            let mut cells = vec![name.to_owned()];
            let mut at_1_ms = None;
            for every in STEPS {
                let h = every as f64 * FINEST;
                let found = errors(fmus, scene, name, every, &reference).filter(|e| e.force < UNSTABLE);
                cells.push(found.map_or("x".into(), |e| format!("{:.1e}", e.angle)));
                if let Some(Errors { angle, force, interface, steps: [a, b] }) = found {
                    let _ = writeln!(csv, "{},{name},{h:e},{angle:e},{force:e},{interface:e},{a},{b}", scene.name());
                }
                if (h - 1e-3).abs() < 1e-9 {
                    at_1_ms = found;
                }
            }
            let cell = |f: &dyn Fn(Errors) -> String| at_1_ms.map_or("x".into(), f);
            cells.push(cell(&|e| format!("{:.1e}", e.force)));
            cells.push(cell(&|e| format!("{:.1e}", e.interface)));
            cells.push(cell(&|e| format!("{:.1} + {:.1}", e.steps[0], e.steps[1])));
            let usable = largest_usable(fmus, scene, name, &reference) as f64 * FINEST * 1e3;
            cells.push(format!("{usable:.2}"));
            let _ = writeln!(out, "| {} |", cells.join(" | "));
        }
        out.push('\n');
    }
    Ok(Pages { page: out, csv })
}
