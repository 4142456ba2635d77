//! Directional derivatives of a component. Before the initialisation ends, parameters are knowns too.
//!
//! In: unknowns, knowns, seeds. Out: derivatives, which are exact along inputs, and computed from differences of whole
//! models along parameters. They are 0 for variables that cannot change continuously. Must not know: any law.
use super::{Component, Refused};
use crate::numerics::decimal::Decimal;
use crate::variables::{Causality, Kind, Reference, Unit, Variable};

/// Relative change h of a known for a difference. Differences at h and h / 2 are extrapolated, so that the error is of
/// order h^4 (fifth derivative), plus the rounding error divided by h.
const STEP: f64 = 1e-3;
/// How often the change is divided by 4 if a changed model has no start position.
const TRIALS: usize = 6;

/// The values of all unknowns at one distance along a direction.
type Values = Vec<f64>;

impl Component {
    /// For each unknown, the sum over the knowns of partial derivative times seed, at the present state. `report` is
    /// called once for each unknown, with its index and the value, or NaN if the derivative does not exist.
    /// `is_initial`: initialization mode has not ended, and parameters are knowns too.
    ///
    /// Booleans and Enumerations cannot change continuously: derivatives of them and along them are 0.
    ///
    /// # Errors
    /// An unknown that is not computed, a known that cannot be set in this phase, or a seed that is not finite. A model
    /// without derivatives, or no slightly changed model has a start position.
    pub fn directional_derivative(
        &mut self,
        is_initial: bool,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        report: &mut dyn FnMut(usize, f64),
    ) -> Result<(), Refused> {
        let of = |reference: &Reference| self.interface().get(*reference);
        let jumps = |v: &Variable| v.kind != Kind::Real;
        let is_known =
            |v: &Variable| v.causality == Causality::Input || is_initial && v.causality == Causality::Parameter;
        let unknown_jumps = |reference: &Reference| of(reference).is_some_and(|v| jumps(v) && v.is_output());
        let known_jumps = |reference: &Reference| of(reference).is_some_and(|v| jumps(v) && is_known(v));
        if unknowns.iter().any(unknown_jumps) || knowns.iter().any(known_jumps) {
            let smooth: Vec<usize> = (0..unknowns.len()).filter(|&i| !unknown_jumps(&unknowns[i])).collect();
            let jumping: Vec<usize> = (0..unknowns.len()).filter(|&i| unknown_jumps(&unknowns[i])).collect();
            let along = knowns.iter().zip(seeds).filter(|(known, _)| !known_jumps(known));
            let (knowns, seeds): (Vec<_>, Vec<_>) = along.map(|(known, seed)| (*known, *seed)).unzip();
            let unknowns: Vec<_> = smooth.iter().map(|&i| unknowns[i]).collect();
            jumping.into_iter().for_each(|i| report(i, 0.0));
            return self.directional_derivative(is_initial, &unknowns, &knowns, &seeds, &mut |i, value| {
                report(smooth[i], value);
            });
        }
        if is_initial && self.needs_differences(unknowns, knowns) {
            return self.difference(unknowns, knowns, seeds, report);
        }
        each!(self, model => Ok(model.directional_derivative(unknowns, knowns, seeds, report)?))
    }

    /// Whether the derivatives of initial values are computed from differences. This is so if a known is a parameter,
    /// if an unknown is a calculated parameter or a state, or if inputs determine the start.
    fn needs_differences(&self, unknowns: &[Reference], knowns: &[Reference]) -> bool {
        let of = |reference: &Reference| self.interface().get(*reference);
        let states = self.continuous_time().map_or_else(Vec::new, |all| [all.states, all.derivatives].concat());
        let is_computed = |v: &Variable, reference: &Reference| {
            v.is_output() || v.causality == Causality::CalculatedParameter || states.contains(reference)
        };
        let is_set = |v: &Variable| matches!(v.causality, Causality::Input | Causality::Parameter);
        let fits = unknowns.iter().all(|unknown| of(unknown).is_some_and(|v| is_computed(v, unknown)))
            && knowns.iter().all(|known| of(known).is_some_and(is_set));
        let is_parameter = |reference: &Reference| of(reference).is_some_and(|v| v.causality == Causality::Parameter);
        let is_other = |unknown: &Reference| of(unknown).is_some_and(|v| !v.is_output());
        fits && (self.starts_by_inputs() || knowns.iter().any(is_parameter) || unknowns.iter().any(is_other))
    }

    /// Whether inputs determine the start position.
    fn starts_by_inputs(&self) -> bool {
        match self {
            Self::Mechanism(model) => model.starts_by_inputs(),
            Self::Hydraulic(_) => false,
        }
    }

    /// Derivatives of initial values from differences between models that are changed along the seeds.
    fn difference(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        report: &mut dyn FnMut(usize, f64),
    ) -> Result<(), Refused> {
        let mut from = Vec::with_capacity(knowns.len());
        let mut largest = f64::INFINITY;
        for (&known, &seed) in knowns.iter().zip(seeds) {
            let value = self.real(known)?;
            let variable = self.interface().get(known);
            if !seed.is_finite() {
                let name = variable.map_or("", |variable| &variable.name);
                return Err(Refused(format!("seed of {name} = {}: must be finite", Decimal(seed))));
            }
            let is_angle = variable.is_some_and(|variable| variable.unit == Some(Unit::Radian));
            let scale = if is_angle || value == 0.0 { value.abs().max(1.0) } else { value.abs() };
            if seed != 0.0 {
                largest = largest.min(STEP * scale / seed.abs());
            }
            from.push(value);
        }
        if largest.is_infinite() {
            (0..unknowns.len()).for_each(|index| report(index, 0.0));
            return Ok(());
        }
        let mut h = largest;
        for _ in 0..TRIALS {
            let mut at = |distance: f64| self.initial_values(unknowns, knowns, seeds, &from, distance);
            let derivative = match (at(h), at(-h)) {
                (Ok(high), Ok(low)) => {
                    at(h / 2.0).and_then(|upper| Ok(extrapolated([&high, &low], [&upper, &at(-h / 2.0)?], h)))
                }
                (Ok(_), Err(_)) => one_sided(&mut at, h),
                (Err(_), Ok(_)) => one_sided(&mut at, -h),
                (Err(refused), Err(_)) => Err(refused),
            };
            if let Ok(derivative) = derivative {
                derivative.into_iter().enumerate().for_each(|(index, value)| report(index, value));
                return Ok(());
            }
            h /= 4.0;
        }
        let names: Vec<_> = knowns.iter().filter_map(|known| self.interface().get(*known)).map(|v| &*v.name).collect();
        Err(Refused(format!(
            "no derivative with respect to {}: after a small change of this variable the model has no start position",
            names.join(", ")
        )))
    }

    /// Values of the unknowns at the start of a model whose knowns are changed by `distance` times the seeds.
    fn initial_values(
        &self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        from: &[f64],
        distance: f64,
    ) -> Result<Values, Refused> {
        let mut changed = self.clone();
        let values: Vec<f64> = from.iter().zip(seeds).map(|(value, seed)| value + distance * seed).collect();
        for (&known, &value) in knowns.iter().zip(&values) {
            changed.check_real(known, value)?;
        }
        changed.check_together(knowns, &values)?;
        for (&known, &value) in knowns.iter().zip(&values) {
            changed.take_real(known, value)?;
        }
        unknowns.iter().map(|&unknown| changed.real(unknown)).collect()
    }
}

/// Derivative from central differences at h and h / 2, by Richardson's extrapolation to h = 0.
fn extrapolated(wide: [&Values; 2], narrow: [&Values; 2], h: f64) -> Values {
    let slope = |[high, low]: [&Values; 2], i: usize, h: f64| (high[i] - low[i]) / (2.0 * h);
    (0..wide[0].len()).map(|i| (4.0 * slope(narrow, i, h / 2.0) - slope(wide, i, h)) / 3.0).collect()
}

/// Derivative from the one-sided difference formula of third order with values at 0, h / 3, 2 h / 3 and h.
fn one_sided(at: &mut impl FnMut(f64) -> Result<Values, Refused>, h: f64) -> Result<Values, Refused> {
    let step = h / 3.0;
    let [a, b, c, d] = [at(0.0)?, at(step)?, at(2.0 * step)?, at(h)?];
    Ok((0..a.len()).map(|i| (18.0 * b[i] - 11.0 * a[i] - 9.0 * c[i] + 2.0 * d[i]) / (6.0 * step)).collect())
}
