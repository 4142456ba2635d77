//! A scene: a case, its course, and what is expected of it.
use super::case::{Case, Scaling};
use super::motion::{Run, run, scale};
use super::plan::Plan;
use super::reference::{Reference, energy_bound};
use linkage_fmu::model::Statistics;

/// What a scene's outcome is held against.
pub enum Expected {
    /// The angle at the end: the exact value where the mechanism has one, else the engine's at a thousandth of the
    /// tolerance. Of a scaled case, that of the unscaled one. Bound from [`Reference`].
    Angle,
    /// A value in closed form, with its bound and why.
    Closed {
        /// What is read at the end.
        reading: String,
        /// Its value.
        value: f64,
        /// By how much it may be off.
        within: f64,
        /// Why.
        why: String,
    },
    /// The energy balance alone: what it may drift by in the energies at play that the run itself shows.
    Energy,
    /// A refusal whose message holds these fragments.
    Refusal(Vec<String>),
}

/// One row.
pub struct Scene {
    /// Heading under which it stands.
    pub group: &'static str,
    /// What is done to the mechanism.
    pub what: String,
    /// The mechanism with its changes.
    pub case: Case,
    /// Its course; of a scaled case, in its own time.
    pub plan: Plan,
    /// Relative tolerance.
    pub tolerance: f64,
    /// What must come out.
    pub expected: Expected,
}

/// Whether a row is as it must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within its bounds.
    Holds,
    /// Refused with the message that it must be refused with.
    Refused,
    /// Neither.
    Fails,
}

impl Verdict {
    /// As it is written.
    pub fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Refused => "refused as expected",
            Self::Fails => "FAILS",
        }
    }
}

/// What came out.
pub struct Outcome {
    /// Error of what is read, and its bound.
    pub error: Option<(f64, f64)>,
    /// Largest energy.drift and its bound [J].
    pub drift: Option<(f64, f64)>,
    /// Work of the integration.
    pub work: Statistics,
    /// Time of the steps on a processor [s].
    pub cpu: f64,
    /// Why the bounds are what they are, or the message.
    pub why: String,
    /// Whether it is as it must be.
    pub verdict: Verdict,
}

impl Scene {
    /// Run it and judge it.
    pub fn judge(&self) -> Outcome {
        match (self.expected(), &self.expected) {
            (Ok(outcome), _) => outcome,
            (Err(message), Expected::Refusal(fragments)) if fragments.iter().all(|f| message.contains(f.as_str())) => {
                Outcome::told(message, Verdict::Refused)
            }
            (Err(message), _) => Outcome::told(message, Verdict::Fails),
        }
    }

    fn expected(&self) -> Result<Outcome, String> {
        let mut model = self.case.model(self.tolerance)?;
        let reading = match &self.expected {
            Expected::Closed { reading, .. } => reading.clone(),
            _ => self.case.own("angle"),
        };
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
            Expected::Closed { value, within, why, .. } => {
                let drift = own_energy(&found)?;
                Ok(found.judged(Some(((found.value - value).abs(), *within)), drift, why.clone()))
            }
            Expected::Energy => {
                let drift = own_energy(&found)?;
                let why = format!("N = {}, V^2 = {:.1e} J", found.work.accepted, found.energy);
                Ok(found.judged(None, drift, why))
            }
            Expected::Refusal(_) => {
                let mut outcome = found.judged(None, f64::INFINITY, "it must be refused".into());
                outcome.verdict = Verdict::Fails;
                Ok(outcome)
            }
        }
    }
}

impl Run {
    fn judged(&self, error: Option<(f64, f64)>, drift_bound: f64, why: String) -> Outcome {
        let drift = (self.drift, drift_bound);
        let holds = |(value, bound): (f64, f64)| value <= bound;
        let verdict = if error.is_none_or(holds) && holds(drift) { Verdict::Holds } else { Verdict::Fails };
        Outcome { error, drift: Some(drift), work: self.work, cpu: self.cpu, why, verdict }
    }
}

impl Outcome {
    fn told(message: String, verdict: Verdict) -> Self {
        Self { error: None, drift: None, work: Statistics::default(), cpu: 0.0, why: message, verdict }
    }
}
