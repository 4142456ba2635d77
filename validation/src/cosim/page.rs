//! The page of the coupling: error over communication step for every scheme and scene.
use super::scenes::{Fmus, Run, Scene, all, run};
use super::schemes;
use crate::measure::{Asked, Pages, asked, heading, page};
use serde_json::Value;
use std::collections::HashMap;
use std::fmt::{Display, Write};

/// Communication step of the reference run, of which all others are multiples [s].
const FINEST: f64 = 5e-5;
/// Communication steps of the table, in multiples of the finest.
const STEPS: [usize; 5] = [2, 10, 20, 100, 400];
/// Scheme of the reference run.
const REFERENCE: &str = "preview, two passes, with dW/ds";
/// Error limits of a usable run: crank angle [rad], force [N].
const USABLE: [f64; 2] = [1e-2, 1e3];
/// Force error above which a run counts as unstable [N].
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

impl Errors {
    /// A line of the CSV.
    fn write(&self, scene: &Scene, scheme: &str, every: usize, csv: &mut String) {
        let (Self { angle, force, interface, steps: [a, b] }, h) = (self, every as f64 * FINEST);
        let _ = writeln!(csv, "{},\"{scheme}\",{h:e},{angle:e},{force:e},{interface:e},{a},{b}", scene.name);
    }
}

/// The largest errors of a scheme over a scene in steps of `every` finest steps; None if the run was unstable.
fn errors(fmus: &Fmus, scene: &Scene, scheme: &str, every: usize, reference: &Run) -> Option<Errors> {
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
/// grid with ratio 9/8, then by bisection between the last two.
fn largest_usable(fmus: &Fmus, scene: &Scene, scheme: &str, reference: &Run) -> usize {
    let usable = |every: usize| {
        errors(fmus, scene, scheme, every, reference).is_some_and(|e| e.angle < USABLE[0] && e.force < USABLE[1])
    };
    let (mut good, mut tried) = (0, 2);
    while tried <= LONGEST && usable(tried) {
        good = tried;
        tried = (tried + 1).max(tried * 9 / 8);
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
fn against_values(scene: &Scene, reference: &Run) -> [f64; 2] {
    let mut worst = [0.0_f64; 2];
    for [t, angle, force] in &scene.reference {
        let at = reference.trace.get((t / FINEST).round() as usize).copied().unwrap_or([f64::NAN; 2]);
        worst = [worst[0].max((at[0] - angle).abs()), worst[1].max((at[1] - force).abs())];
    }
    worst
}

/// Whether the actuator has the mode that a scheme needs: the circuit in plain numbers has no mode `delayed`.
fn has_mode(fmus: &Fmus, scheme: &str) -> bool {
    fmus.hydraulic.is_some() || schemes::mode(scheme) != "delayed"
}

/// The page, and its numbers as CSV.
pub fn table(fmus: &Fmus) -> Result<Pages, String> {
    let side = match fmus.hydraulic {
        Some(_) => "the FMU `HydraulicActuator`",
        None => "the circuit in plain numbers",
    };
    let finest = format!("{FINEST:e}");
    let values: [(&str, &dyn Display); 4] =
        [("side", &side), ("reference", &REFERENCE), ("finest", &finest), ("unstable", &UNSTABLE)];
    let mut out = page("cosim", &values);
    let mut csv = String::from("scene,scheme,step,angle,force,interface,mechanism_steps,actuator_steps\n");
    let mut found = HashMap::new();
    let scenes = all()?;
    for scene in scenes.iter().filter(|scene| scene.is_exact()) {
        let reference = run(fmus, scene, REFERENCE, FINEST)?;
        let [angle, force] = against_values(scene, &reference);
        let _ = writeln!(
            out,
            "## Scene {}\n\nThe reference run differs from an independent integration of the whole as one system by \
             {angle:.1e} rad and {force:.1e} N. Small: figures of an earlier measurement, with another \
             implementation of both sides.\n",
            scene.name
        );
        let steps = STEPS.map(|every| format!("{} ms", every as f64 * FINEST * 1e3));
        let steps: Vec<&str> = steps.iter().map(String::as_str).collect();
        let more = ["force at 1 ms [N]", "energy at 1 ms [J]", "steps of each", "largest usable [ms]"];
        out += &heading(&[&["scheme"], &steps[..], &more].concat());
        for (name, _) in schemes::ALL.into_iter().filter(|(name, _)| has_mode(fmus, name)) {
            let row = Row::measure(fmus, scene, name, &reference, &mut csv);
            let _ = writeln!(out, "| {name} | {} |", row.cells(&scene.earlier[name]).join(" | "));
            found.insert((scene.name.as_str(), name), row);
        }
        out.push('\n');
    }
    out += &goals(&found);
    for scene in scenes.iter().filter(|scene| !scene.is_exact()) {
        out += &apart(fmus, scene, &mut csv)?;
    }
    Ok(Pages { page: out, csv })
}

/// A scheme over a scene: errors at each step size, the largest usable step [s].
#[derive(Clone, Debug)]
struct Row {
    errors: [Option<Errors>; STEPS.len()],
    usable: f64,
}

/// Indices of 1 ms and of 20 ms in the list of steps.
const MILLISECOND: usize = 2;
const LONG: usize = 4;

impl Row {
    fn measure(fmus: &Fmus, scene: &Scene, name: &str, reference: &Run, csv: &mut String) -> Self {
        let errors = STEPS.map(|every| {
            let found = errors(fmus, scene, name, every, reference).filter(|e| e.force < UNSTABLE)?;
            found.write(scene, name, every, csv);
            Some(found)
        });
        Self { errors, usable: largest_usable(fmus, scene, name, reference) as f64 * FINEST }
    }

    /// Cells of the table, each with the error of an earlier measurement.
    fn cells(&self, earlier: &Value) -> Vec<String> {
        let earlier_error = |k: usize| match earlier[k].as_str() {
            None | Some("") => String::new(),
            Some(figure) => format!(" <sub>{figure}</sub>"),
        };
        let angle =
            |(k, e): (usize, &Option<Errors>)| e.map_or("x".into(), |e| format!("{:.1e}", e.angle)) + &earlier_error(k);
        let mut cells: Vec<String> = self.errors.iter().enumerate().map(angle).collect();
        let at_1_ms = self.errors[MILLISECOND];
        let cell = |f: &dyn Fn(Errors) -> String| at_1_ms.map_or("x".into(), f);
        cells.push(cell(&|e| format!("{:.1e}", e.force)));
        cells.push(cell(&|e| format!("{:.1e}", e.interface)));
        cells.push(cell(&|e| format!("{:.1} + {:.1}", e.steps[0], e.steps[1])));
        cells.push(format!("{:.2}", self.usable * 1e3));
        cells
    }
}

/// The required values and those measured.
fn goals(found: &HashMap<(&str, &'static str), Row>) -> String {
    let of = |scene: &'static str, scheme: &'static str| found.get(&(scene, scheme));
    let error = |scene, scheme, step: usize, pick: &dyn Fn(Errors) -> f64| {
        of(scene, scheme).and_then(|row| row.errors[step]).map_or(f64::NAN, pick)
    };
    let angle = |e: Errors| e.angle;
    let usable = |scene| of(scene, REFERENCE).map_or(f64::NAN, |row| row.usable * 1e3);
    let (held, newton) = ("preview, one pass, held", "interface Jacobian, quadratic F");
    let most =
        |what: &str, scale: f64, value: f64, limit: f64, unit| Asked::at_most(what, value * scale, limit * scale, unit);
    let nano = |what: &str, value: f64, limit: f64| most(what, 1e9, value, limit, " nrad");
    let order = of("H2", REFERENCE).and_then(|row| {
        let [coarse, fine] = [row.errors[3]?.angle, row.errors[2]?.angle];
        Some((coarse / fine).log2() / 5f64.log2())
    });
    let figures = [
        nano("two passes, H1, 1 ms", error("H1", REFERENCE, MILLISECOND, &angle), 5e-9),
        nano("two passes, H2, 1 ms", error("H2", REFERENCE, MILLISECOND, &angle), 1e-10),
        Asked::at_least("two passes, H2: order between 1 and 5 ms", order.unwrap_or(f64::NAN), 3.0, ""),
        nano("one pass, held force, H1, 1 ms", error("H1", held, MILLISECOND, &angle), 1e-5),
        nano("one pass, held force, H2, 1 ms", error("H2", held, MILLISECOND, &angle), 1e-6),
        Asked::at_least("largest usable step, two passes, H1", usable("H1"), 20.0, " ms"),
        Asked::at_least("largest usable step, two passes, H2", usable("H2"), 20.0, " ms"),
        nano("two passes, H1, 20 ms", error("H1", REFERENCE, LONG, &angle), 2e-5),
        nano("two passes, H2, 20 ms", error("H2", REFERENCE, LONG, &angle), 2e-5),
        nano("interface Jacobian, H2, 1 ms", error("H2", newton, MILLISECOND, &angle), 1e-7),
        most("its steps of each", 1.0, error("H2", newton, MILLISECOND, &|e| e.steps[0]), 2.1, ""),
        most(
            "energy at the interface, two passes, H1, 1 ms",
            1e6,
            error("H1", REFERENCE, MILLISECOND, &|e| e.interface),
            2e-5,
            " uJ",
        ),
    ];
    String::from("## Goals\n\n") + &asked(&figures)
}

/// Preview with an inexact element model: errors relative to its own result in the finest steps.
fn apart(fmus: &Fmus, scene: &Scene, csv: &mut String) -> Result<String, String> {
    let reference = run(fmus, scene, REFERENCE, FINEST)?;
    let mut out = format!(
        "## {}\n\nErrors of the angle [rad] and of the force [N] from the start to {} s, against the run of \
         \"{REFERENCE}\" in steps of {FINEST:e} s. The load is corrected by what the element model missed in the last \
         step.\n\n",
        scene.name, scene.span
    );
    out += &heading(&["scheme", "0.1 ms", "0.5 ms", "1 ms", "5 ms", "20 ms"]);
    let shown = |name: &str| (name.starts_with("preview") || name == "Jacobi 0") && has_mode(fmus, name);
    for (name, _) in schemes::ALL.into_iter().filter(|(name, _)| shown(name)) {
        let mut cells = vec![name.to_owned()];
        for every in STEPS {
            let found = errors(fmus, scene, name, every, &reference);
            cells.push(found.map_or("x".into(), |e| format!("{:.1e}, {:.1e}", e.angle, e.force)));
            found.inspect(|errors| errors.write(scene, name, every, csv));
        }
        let _ = writeln!(out, "| {} |", cells.join(" | "));
    }
    out.push('\n');
    Ok(out)
}
