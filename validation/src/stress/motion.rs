//! One run of a scene: its results and its cost.
use super::case::{Case, find, get, set};
use super::plan::{Force, Plan};
use cpu_time::ThreadTime;
use linkage_fmu::mechanism::{Model, Statistics};

/// Number of points in a run at which energies are sampled.
const LOOKS: u64 = 64;

/// Result of a run.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Value of the output at the end.
    pub value: f64,
    /// Largest abs(energy.drift) [J].
    pub drift: f64,
    /// Largest reference energy: 2 T + force times length, both along sigma [J].
    pub energy: f64,
    /// Largest potential energy, which contributes to the rounding errors [J].
    pub potential: f64,
    /// Work of the integration.
    pub work: Statistics,
    /// CPU time of the steps alone [s].
    pub cpu: f64,
    /// Number of steps before each sample, with angle and speed of the body then.
    pub looks: Vec<(u64, f64, f64)>,
}

/// Run a model from its start through a plan, and read a variable at the end. The few calls between the steps are
/// included in the time.
pub fn run(case: &Case, model: &mut Model, plan: &Plan, reading: &str) -> Result<Run, String> {
    let mut found = Run::default();
    look(case, model, 0, &mut found)?;
    let steps = plan.steps();
    let stated = get(model, case.mechanism.input)?;
    let mut next = steps.div_ceil(LOOKS);
    let began = ThreadTime::now();
    for k in 0..steps {
        step(case, model, plan, k, stated)?;
        if k + 1 == next || k + 1 == steps {
            next += steps.div_ceil(LOOKS);
            look(case, model, k + 1, &mut found)?;
        }
    }
    found.cpu = began.elapsed().as_secs_f64();
    found.work = model.statistics();
    found.value = get(model, reading)?;
    Ok(found)
}

/// Step `k` of a plan.
pub fn step(case: &Case, model: &mut Model, plan: &Plan, k: u64, stated: f64) -> Result<(), String> {
    if plan.force != Force::Stated {
        set(model, case.mechanism.input, plan.input(k, stated))?;
    }
    model.step(plan.size(k)).map_err(|e| e.to_string())
}

fn look(case: &Case, model: &mut Model, steps: u64, found: &mut Run) -> Result<(), String> {
    let kinetic = get(model, "energy.kinetic")?;
    found.drift = found.drift.max(get(model, "energy.drift")?.abs());
    found.energy = found.energy.max(2.0 * kinetic + force(case, model, kinetic)? * scale(model)?);
    // The potential of the input's force is not an output: force times displacement, of several times the linkage's
    // size.
    let size = model.reduced().map_err(|e| e.to_string())?.linkage().size;
    let of_input = get(model, case.mechanism.input)?.abs() * size;
    found.potential = found.potential.max(get(model, "energy.potential")?.abs() + of_input);
    found.looks.push((steps, get(model, &case.own("angle"))?, get(model, &case.own("speed"))?));
    Ok(())
}

/// The larger of abs(sigma_ddot) and the resistance, both from powers divided by sigma_dot: the rate of T = sigma_dot^2
/// / 2, and the drive's power minus the rates of all energies. 0 at rest, where these are undefined.
fn force(case: &Case, model: &mut Model, kinetic: f64) -> Result<f64, String> {
    if kinetic == 0.0 {
        return Ok(0.0);
    }
    let mut rate = |name| -> Result<f64, String> {
        let reference = find(model, name)?;
        model.output_derivative(reference, 1).map_err(|e| e.to_string())
    };
    let (moved, raised) = (rate("energy.kinetic")?, rate("energy.potential")?);
    let drive = case.mechanism.input.split('.').next().unwrap_or_default();
    let lost = match get(model, &format!("{drive}.speed")) {
        Ok(speed) => get(model, case.mechanism.input)? * speed - moved - raised,
        // No drive, and no friction in such a scene.
        Err(_) => 0.0,
    };
    Ok(moved.abs().max(lost.abs()) / (2.0 * kinetic).sqrt())
}

/// The length L of sigma to which the tolerance refers: about that of a radian.
pub fn scale(model: &mut Model) -> Result<f64, String> {
    Ok(model.reduced().map_err(|e| e.to_string())?.scale())
}
