//! A scene: a case, its course, and the expected result.
use super::case::{Case, Scaling, get};
use super::motion::{Run, run, scale, step};
use super::plan::Plan;
use super::reference::{Reference, TABLE, amplification, energy_bound};
use super::{Outcome, Row, Verdict};

/// Bound of an angle above which the motion is not predictable at the tolerance: kappa holds for small errors, and an
/// error of a radian is as large as the motion itself [rad].
const PREDICTABLE: f64 = 1.0;

/// Expected result of a scene.
pub enum Expected {
    /// The angle at the end: the exact value if the mechanism has one, otherwise the engine's at a thousandth of the
    /// tolerance; for a scaled case that of the unscaled one. The bound is that of [`Reference`].
    Angle,
    /// A value in closed form, with its bound and the reason for it.
    Closed {
        /// Name of the output at the end.
        reading: String,
        /// Its value.
        value: f64,
        /// Its allowed error
        within: f64,
        /// plus this error per step of the integration.
        each: f64,
        /// Reason for the bound.
        why: String,
    },
    /// The angle at the end of the same motion with another definition of the start.
    Same {
        /// The other definition.
        case: Box<Case>,
        /// Body whose start defines it.
        body: &'static str,
        /// Allowed difference of the two starts [rad of that body].
        apart: f64,
    },
    /// The energy balance alone: the drift is bounded by the reference energies of the run itself.
    Energy,
    /// An error whose message contains these fragments.
    Refusal(Vec<String>),
}

impl Expected {
    /// This value of a variable at the end, with a bound and its reason.
    pub fn closed(reading: &str, value: f64, within: f64, each: f64, why: impl Into<String>) -> Self {
        Self::Closed { reading: reading.into(), value, within, each, why: why.into() }
    }

    /// An error whose message contains these fragments.
    pub fn refusal(fragments: &[&str]) -> Self {
        Self::Refusal(fragments.iter().map(|&f| f.into()).collect())
    }
}

/// One row.
pub struct Scene {
    /// Heading of its group.
    pub group: &'static str,
    /// What is changed in the mechanism.
    pub what: String,
    /// The mechanism with its changes.
    pub case: Case,
    /// Its course; for a scaled case in scaled time.
    pub plan: Plan,
    /// Relative tolerance.
    pub tolerance: f64,
    /// The expected result.
    pub expected: Expected,
}

impl From<Scene> for Row {
    fn from(scene: Scene) -> Self {
        let refusal = if let Expected::Refusal(words) = &scene.expected { Some(words.clone()) } else { None };
        let Scene { group, tolerance, .. } = scene;
        let (model, what, steps) = (scene.case.mechanism.name, scene.what.clone(), scene.plan.steps());
        Self { group, model, what, tolerance, steps, refusal, run: Box::new(move || scene.run()) }
    }
}

impl Scene {
    fn run(&self) -> Result<Outcome, String> {
        let mut model = self.case.model(self.tolerance)?;
        let reading = match &self.expected {
            Expected::Closed { reading, .. } => reading.clone(),
            _ => self.case.own("angle"),
        };
        if let Expected::Refusal(_) = self.expected {
            let stated = get(&mut model, self.case.mechanism.input)?;
            for k in 0..self.plan.steps() {
                step(&self.case, &mut model, &self.plan, k, stated)?;
            }
        }
        let found = run(&self.case, &mut model, &self.plan, &reading)?;
        let made = found.work.accepted + self.plan.steps();
        let own_energy = |found: &Run| -> Result<f64, String> {
            let lengths = self.plan.span * found.energy.sqrt() / scale(&mut model.clone())?;
            Ok(energy_bound(found.energy, lengths, self.tolerance, found.work.accepted, made))
        };
        match &self.expected {
            Expected::Angle => {
                let (case, mut plan) = (self.case.clone().scaled(Scaling::ONE), self.plan.clone());
                plan.span /= self.case.scaling.time;
                let reference = Reference::of(&case, &plan, self.tolerance)?;
                let steps = reference.steps.unwrap_or(found.work.accepted);
                let bound = reference.bound(self.tolerance, steps, made);
                let drift = reference.energy_bound(self.tolerance, steps, made) * self.case.scaling.energy();
                let why = format!(
                    "N = {steps}, kappa = {:.1e}, V^2 = {:.1e} J",
                    reference.kappa,
                    reference.energy * self.case.scaling.energy()
                );
                Ok(found.judged(Some(((found.value - reference.value).abs(), bound)), drift, why))
            }
            Expected::Closed { value, within, each, why, .. } => {
                let drift = own_energy(&found)?;
                let within = within + each * found.work.accepted as f64;
                Ok(found.judged(Some(((found.value - value).abs(), within)), drift, why.clone()))
            }
            Expected::Same { case, body, apart } => {
                let other = run(case, &mut case.model(self.tolerance)?, &self.plan, &reading)?;
                let gain = amplification(case, body, &self.plan, self.tolerance, found.energy)?;
                let steps = (found.work.accepted + other.work.accepted) as f64;
                let lengths = self.plan.span * found.energy.sqrt() / scale(&mut model.clone())?;
                let bound = gain * (apart + 2f64.sqrt() * self.tolerance * steps + TABLE * (1.0 + lengths)) + TABLE;
                let why =
                    format!("the starts may be {apart:.1e} rad of the {body} apart, gain {gain:.1e}, N = {steps}");
                let drift = own_energy(&found)?;
                Ok(found.judged(Some(((found.value - other.value).abs(), bound)), drift, why))
            }
            Expected::Energy | Expected::Refusal(_) => {
                let drift = own_energy(&found)?;
                let why = format!("N = {}, V^2 = {:.1e} J", found.work.accepted, found.energy);
                Ok(found.judged(None, drift, why))
            }
        }
    }
}

impl Run {
    fn judged(&self, error: Option<(f64, f64)>, drift_bound: f64, mut why: String) -> Outcome {
        // Each of the summed energies has a rounding error.
        let drift = (self.drift, drift_bound + 8.0 * f64::EPSILON * self.potential);
        let holds = |(value, bound): (f64, f64)| value <= bound;
        let predictable = error.is_none_or(|(_, bound)| bound <= PREDICTABLE);
        if !predictable {
            why += "; beyond foretelling, judged by the energy";
        }
        let verdict =
            if (!predictable || error.is_none_or(holds)) && holds(drift) { Verdict::Holds } else { Verdict::Fails };
        Outcome { error, drift: Some(drift), work: self.work, cpu: self.cpu, why, verdict }
    }
}
