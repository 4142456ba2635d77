//! Derivatives as a host asks for them: of outputs by inputs, of outputs in time, and those of inputs that it sets.
//!
//! In: references, orders, seeds. Out: derivatives by the outputs' laws with dual numbers, or a refusal by name. It
//! must not know any law.
use super::{INPUT_COUNT, Model, Parameters, point};
use crate::hydraulics::circuit::{CIRCUIT, ENERGY, Point};
use crate::hydraulics::error::HydraulicsError;
use crate::hydraulics::inputs::{Input, Inputs};
use crate::hydraulics::interface::Quantity;
use crate::hydraulics::outputs::{Output, Present};
use crate::hydraulics::state::{Preview, State, dynamic};
use crate::numerics::dual::{Dual, Number};
use crate::variables::{Causality, Kind, Reference, Variability};

/// Order of the derivatives of outputs in time.
pub const OUTPUT_ORDER: i32 = 1;
/// Largest order of the derivatives of inputs in time: that of the speed; 2 of the others.
pub const INPUT_ORDER: i32 = 4;

/// A direction in which state and inputs change.
struct Direction {
    circuit: [f64; CIRCUIT],
    inputs: [f64; INPUT_COUNT],
}

/// The present state and its change along a direction.
fn present(parameters: &Parameters, inputs: &Inputs, state: &State, direction: &Direction) -> Present<Dual<1>> {
    let input = |input: Input| Dual { value: inputs.get(input), slope: [direction.inputs[input as usize]] };
    let component = |k: usize| Dual { value: state.circuit[k], slope: [direction.circuit[k]] };
    let motion = [Input::Length, Input::Speed].map(input);
    let ports = [input(Input::Supply), input(Input::Tank), Dual::constant(0.0)];
    let at = parameters.laws.point(std::array::from_fn(component), motion, ports);
    let end_force = |force| state.end_force(&parameters.setting(inputs), input(Input::Load), force);
    Present::new(&parameters.laws, at, std::array::from_fn(|k| component(ENERGY + k)), end_force)
}

/// What the foreseen motion tells, and its change along a direction of the inputs.
fn preview(parameters: &Parameters, inputs: &Inputs, state: &State, direction: &Direction) -> Preview<Dual<1>> {
    if let Some(told) = &state.told {
        // Told before these inputs.
        return told.preview.constant();
    }
    let dual = |input: Input| Dual { value: inputs.get(input), slope: [direction.inputs[input as usize]] };
    let (laws, speed, mut h) = (&parameters.laws, dual(Input::Speed), dual(Input::Horizon));
    if h.value == 0.0 {
        h = Dual::constant(parameters.horizon(inputs, state));
    }
    let pressures = state.pressures();
    let pressures = std::array::from_fn(|side| Dual { value: pressures[side], slope: [direction.circuit[side]] });
    let follows = inputs.get(Input::Horizon) == 0.0;
    let change = |input: Input| if follows && input == Input::Horizon { 0.0 } else { direction.inputs[input as usize] };
    match state.foresee_change(&parameters.setting(inputs), h.value, &direction.circuit, &change) {
        Some((end, element, course)) => {
            let motion = [dual(Input::Length), speed];
            Preview::new(laws, &element, (laws.force(pressures, speed), motion), (&end, course), h)
        }
        None => {
            let motion = [Input::Length, Input::Speed, Input::Acceleration].map(dual);
            let force = laws.force(pressures, speed);
            let start = state.start_acceleration(&parameters.setting(inputs), dual, force).unwrap_or(motion[2]);
            Preview::blind(force, motion, start, h)
        }
    }
}

impl Model {
    /// Directional derivatives of outputs at the present state: for each unknown the sum over the knowns of dy / du
    /// times the seed. `report` is called once for each unknown, with its index; with NaN for one that has no
    /// derivative in this state, of which [`Self::undefined_derivative`] tells why.
    ///
    /// # Errors
    /// An unknown that is no continuous output, a known that is no continuous input, a seed that is not finite.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        report: &mut dyn FnMut(usize, f64),
    ) -> Result<(), HydraulicsError> {
        for &known in knowns {
            self.continuous(
                known,
                Causality::Input,
                "a known (the variable to differentiate by) must be a continuous input",
            )?;
        }
        for &unknown in unknowns {
            self.continuous(
                unknown,
                Causality::Output,
                "an unknown (the variable to differentiate) must be a continuous output",
            )?;
        }
        let mut direction = Direction { circuit: [0.0; CIRCUIT], inputs: [0.0; INPUT_COUNT] };
        for (known, seed) in knowns.iter().zip(seeds) {
            if !seed.is_finite() {
                let name = self.name_of(*known);
                return Err(HydraulicsError::Value {
                    name,
                    value: *seed,
                    allowed: "finite, because this value is the seed of a directional derivative".into(),
                });
            }
            // Inputs come first: the reference of an input is its index.
            direction.inputs[*known as usize] += seed;
        }
        self.started()?;
        let Self { parameters, inputs, state: Some(state), .. } = self else {
            return Err(HydraulicsError::NotInitialised);
        };
        let laws = &parameters.laws;
        let (mut now, mut ahead) = (None, None);
        for (index, &unknown) in unknowns.iter().enumerate() {
            let Some(Quantity::Output(output)) = self.original.variables.quantity(unknown) else { continue };
            let derivative = if output.is_foreseen() {
                let preview = ahead.get_or_insert_with(|| preview(parameters, inputs, state, &direction));
                output.foreseen(preview)
            } else {
                let present = now.get_or_insert_with(|| present(parameters, inputs, state, &direction));
                present.output(laws, output)
            };
            let derivative = derivative.map_or(f64::NAN, |dual| dual.slope[0]);
            report(index, if derivative.is_finite() { derivative } else { f64::NAN });
        }
        Ok(())
    }

    /// Rate of a continuous output in time, under inputs that change at the rates set by
    /// [`Self::set_input_derivative`], and under the speed and the acceleration of the inputs; where that is 0 and a
    /// reduced mass is told, under the acceleration of this mass. Outputs of the foreseen
    /// motion belong to the next step: the rate of `preview.force` is that of the line, `preview.force_mean` and
    /// `preview.force_rate` are constant, `preview.length` and `preview.speed` have the speed and the acceleration at
    /// the end of the step; the accelerations have no rate.
    ///
    /// # Errors
    /// No continuous output has this reference, or another order than 1.
    pub fn output_derivative(&mut self, reference: Reference, order: i32) -> Result<f64, HydraulicsError> {
        self.continuous(reference, Causality::Output, "derivatives are available for continuous outputs only")?;
        if order != OUTPUT_ORDER {
            let what = format!("time derivative of order {order} of {}", self.name_of(reference));
            let reason = "only order 1 is available (maxOutputDerivativeOrder is 1)".into();
            return Err(HydraulicsError::Derivative { what, reason });
        }
        self.started()?;
        let Some(Quantity::Output(output)) = self.original.variables.quantity(reference) else {
            return Ok(f64::NAN);
        };
        match output {
            Output::PreviewForce => return self.real_output(Output::PreviewForceRate),
            Output::PreviewForceMean | Output::PreviewForceRate => return Ok(0.0),
            Output::PreviewLength => return self.real_output(Output::PreviewSpeed),
            Output::PreviewSpeed => return self.real_output(Output::PreviewAcceleration),
            Output::PreviewStartAcceleration | Output::PreviewAcceleration => return Ok(f64::NAN),
            _ => {}
        }
        let Self { parameters, inputs, state: Some(state), .. } = self else {
            return Err(HydraulicsError::NotInitialised);
        };
        let laws = &parameters.laws;
        let at = point(parameters, dynamic(&state.circuit), inputs);
        let at = Point { command: parameters.setting(inputs).command(state.time()).at(0.0), ..at };
        let circuit = laws.rates(&at).state;
        let mut direction = Direction { circuit, inputs: Input::ALL.map(|input| inputs.rate(input)) };
        // A host that connects no acceleration may have told the mass.
        let speed_rate = &mut direction.inputs[Input::Speed as usize];
        if *speed_rate == 0.0 {
            let force = laws.force(at.pressures, at.speed);
            let own = state.start_acceleration(&parameters.setting(inputs), |input| inputs.get(input), force);
            *speed_rate = own.unwrap_or(0.0);
        }
        let rate = present(parameters, inputs, state, &direction).output(laws, output);
        Ok(rate.map_or(f64::NAN, |dual| dual.slope[0]))
    }

    fn real_output(&mut self, output: Output) -> Result<f64, HydraulicsError> {
        self.output(output).map(|value| if value.is_finite() { value } else { f64::NAN })
    }

    /// Why an output has no derivative where the last call gave NaN.
    #[cold]
    pub fn undefined_derivative(&mut self, reference: Reference) -> Option<String> {
        match self.original.variables.quantity(reference)? {
            Quantity::Output(Output::PreviewStartAcceleration | Output::PreviewAcceleration) => {
                Some("the acceleration at one instant of the next step has no time derivative".to_owned())
            }
            Quantity::Output(_) => Some(
                "the derivative exceeds the largest number, 1.8e308: check the inputs and the parameters".to_owned(),
            ),
            _ => None,
        }
    }

    /// Whether [`Self::set_input_derivative`] would accept this; changes nothing.
    ///
    /// # Errors
    /// No continuous input has this reference, the order is not one of those that count, the value is not finite.
    pub fn check_input_derivative(&self, reference: Reference, order: i32, value: f64) -> Result<(), HydraulicsError> {
        self.continuous(reference, Causality::Input, "derivatives can be set for continuous inputs only")?;
        let most = Input::ALL[reference as usize].order();
        if !(1..=most as i32).contains(&order) {
            let what = format!("time derivative of order {order} of {}", self.name_of(reference));
            let reason = format!("only the orders 1 to {most} can be set");
            return Err(HydraulicsError::Derivative { what, reason });
        }
        if !value.is_finite() {
            let name = format!("time derivative of order {order} of {}", self.name_of(reference));
            return Err(HydraulicsError::Value { name, value, allowed: "finite".into() });
        }
        Ok(())
    }

    /// Set a derivative of an input in time at the beginning of the next step; it holds for one step. Those of the
    /// length are not used: within a step the length is its value at the beginning plus the integral of the speed.
    ///
    /// # Errors
    /// As [`Self::check_input_derivative`].
    pub fn set_input_derivative(
        &mut self,
        reference: Reference,
        order: i32,
        value: f64,
    ) -> Result<(), HydraulicsError> {
        self.check_input_derivative(reference, order, value)?;
        self.inputs.set_rate(reference as usize, order as usize, value);
        if matches!(Input::ALL[reference as usize], Input::Command | Input::Supply | Input::Tank) {
            self.cache.forget_foresight();
        }
        Ok(())
    }

    /// Refuse a variable that is not a continuous Real of this causality.
    fn continuous(&self, reference: Reference, causality: Causality, rule: &str) -> Result<(), HydraulicsError> {
        match self.original.variables.get(reference) {
            Some(v) if v.causality == causality && v.kind == Kind::Real && v.variability == Variability::Continuous => {
                Ok(())
            }
            Some(v) => {
                let what = format!("{} (value reference {reference})", v.name);
                Err(HydraulicsError::Derivative { what, reason: rule.into() })
            }
            None => Err(self.no_such(reference, "Real")),
        }
    }
}
