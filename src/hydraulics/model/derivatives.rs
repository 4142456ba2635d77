//! Derivatives of outputs by inputs and in time.
//!
//! In: outputs, a direction of the inputs. Out: derivatives by the outputs' laws with dual numbers. It must not know
//! any law.
use super::{Model, OneActuator, Parameters, point};
use crate::circuit::{CIRCUIT, ENERGY, Equations, Point};
use crate::common::Differentiable;
use crate::error::HydraulicsError;
use crate::inputs::{INPUTS, Input, Inputs};
use crate::outputs::{Output, Present};
use crate::state::{Preview, State, dynamic};
use foundation::numerics::dual::{Dual, Number};

/// A direction in which state and inputs change.
struct Direction {
    circuit: [f64; CIRCUIT],
    inputs: [f64; INPUTS],
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

impl Differentiable for OneActuator {
    type Along = [f64; INPUTS];

    fn order(_laws: &Equations, input: usize) -> usize {
        Input::ALL[input].order()
    }

    fn rate_set(model: &mut Model, input: usize) {
        if matches!(Input::ALL[input], Input::Command | Input::Supply | Input::Tank) {
            model.cache.forget_foresight();
        }
    }

    fn along(_laws: &Equations) -> Self::Along {
        [0.0; INPUTS]
    }

    fn is_instant(output: Output) -> bool {
        matches!(output, Output::PreviewStartAcceleration | Output::PreviewAcceleration)
    }

    fn derivatives(
        model: &mut Model,
        along: &[f64; INPUTS],
        outputs: &mut dyn Iterator<Item = (usize, Output)>,
        report: &mut dyn FnMut(usize, f64),
    ) -> Result<(), HydraulicsError> {
        let direction = Direction { circuit: [0.0; CIRCUIT], inputs: *along };
        let Model { parameters, inputs, state: Some(state), .. } = model else {
            return Err(HydraulicsError::NotInitialised);
        };
        let laws = &parameters.laws;
        let (mut now, mut ahead) = (None, None);
        for (index, output) in outputs {
            let derivative = if output.is_foreseen() {
                let preview = ahead.get_or_insert_with(|| preview(parameters, inputs, state, &direction));
                output.foreseen(preview)
            } else {
                let present = now.get_or_insert_with(|| present(parameters, inputs, state, &direction));
                present.output(laws, output)
            };
            report(index, derivative.map_or(f64::NAN, |dual| dual.slope[0]));
        }
        Ok(())
    }

    fn rate(model: &mut Model, output: Output) -> Result<f64, HydraulicsError> {
        match output {
            Output::PreviewForce => return model.output(Output::PreviewForceRate),
            Output::PreviewForceMean | Output::PreviewForceRate => return Ok(0.0),
            Output::PreviewLength => return model.output(Output::PreviewSpeed),
            Output::PreviewSpeed => return model.output(Output::PreviewAcceleration),
            Output::PreviewStartAcceleration | Output::PreviewAcceleration => return Ok(f64::NAN),
            _ => {}
        }
        let Model { parameters, inputs, state: Some(state), .. } = model else {
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
}
