//! `cargo fmu demo` and `cargo fmu report`: Python programs that run packed FMUs through FMPy.
//!
//! In: the packed FMUs. Out: for the demo, figures on the terminal, and `retraction.csv` and `retraction.png`, or
//! `hydraulic.csv` and `hydraulic.png`, or `system.csv` and `system.png`. For the report, the recomputed figures and
//! statements of the two papers: `report.md`, `report.html` and `figures/`, in `validation/` by default.

use crate::workspace::{DEFAULT_FMU, Workspace};
use crate::{command, package, ssp, view};
use anyhow::{Context, Result};
pub use fmu_cli::{Demo, Report as Arguments};
use std::path;
use std::process::Command;

/// FMU of gear and hydraulic actuator as a single system.
const WHOLE: &str = "LandingGearRetractionHydraulic";
/// FMU of the hydraulic actuator.
const ACTUATOR: &str = "HydraulicActuator";
/// System of gear, door and hydraulics.
const SYSTEM: &str = "LandingGearSystem";
/// FMUs that the report runs.
const FMUS: [&str; 5] = [DEFAULT_FMU, "LandingGearExtension", "FourBarFamily", "SliderCrank", "Jib"];

/// Retract the landing gear: pack the default FMU, or this FMU and the hydraulic actuator, or the landing-gear system,
/// and run the demo.
///
/// # Errors
/// Packing, Python's environment or the run itself fails.
pub fn demo(workspace: &Workspace, arguments: &Demo) -> Result<()> {
    let ssp = arguments.system;
    let named = |names: &[&str]| names.iter().map(|name| workspace.descriptions().join(name)).collect();
    let (script, paths) = if arguments.hydraulic {
        ("demo_hydraulic.py", named(&[DEFAULT_FMU, ACTUATOR, WHOLE]))
    } else if ssp {
        ("demo_system.py", vec![ssp::example(workspace, SYSTEM)])
    } else {
        ("demo.py", named(&[DEFAULT_FMU]))
    };
    let mut fmus = package::run(workspace, &package::Arguments { paths, ssp, ..package::Arguments::of_fmi_2() })?;
    if ssp {
        // The package contains the FMUs.
        fmus.drain(..fmus.len().saturating_sub(1));
    }
    let out = arguments.out.clone().unwrap_or_else(|| workspace.output("demo"));
    let mut demo = Command::new(command::demo(&workspace.target(""), &workspace.python_scripts())?);
    demo.arg(workspace.python_scripts().join(script)).args(fmus).arg("--out").arg(out);
    command::run(&mut demo, script)
}

/// Pack the FMUs and write the report from them.
///
/// # Errors
/// Packing, Python's environment or a run fails.
pub fn report(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    let paths = FMUS.iter().map(|name| workspace.descriptions().join(name)).collect();
    package::run(workspace, &package::Arguments { paths, ..package::Arguments::of_fmi_2() })?;
    let out = arguments.out.clone().unwrap_or_else(|| workspace.validation());
    let out = path::absolute(&out).with_context(|| out.display().to_string())?;
    let motion = workspace.target("view").join(DEFAULT_FMU).with_extension("html");
    let gear = workspace.descriptions().join(DEFAULT_FMU);
    view::run(workspace, &view::Arguments { path: gear, out: Some(motion.clone()), ..Default::default() })?;
    let mut report = Command::new(command::Python::Fmpy.interpreter(workspace)?);
    report.args(["-m", "report"]).arg(workspace.fmu_folder()).arg("--motion").arg(motion).arg("--out").arg(out);
    report.current_dir(workspace.validation());
    command::run(&mut report, "report")
}
