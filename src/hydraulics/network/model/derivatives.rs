//! Derivatives as a host asks for them: of outputs by inputs, of outputs in time, and those of inputs that it sets.
//!
//! In: references, orders, seeds. Out: derivatives by the outputs' laws with dual numbers, or a refusal by name. It
//! must not know any law.
use super::{Model, motion};
use crate::hydraulics::error::HydraulicsError;
use crate::hydraulics::model::OUTPUT_ORDER;
use crate::hydraulics::network::definition::{MOST_COMPONENTS, MOST_CYLINDERS};
use crate::hydraulics::network::inputs::order;
use crate::hydraulics::network::interface::Quantity;
use crate::hydraulics::network::laws::Drive;
use crate::hydraulics::network::layout::Part;
use crate::hydraulics::network::outputs::{Ahead, Output, Present, ahead, blind};
use crate::numerics::dual::{Dual, Number};
use crate::variables::{Causality, Kind, Reference, Variability};

/// A direction in which state and inputs change.
struct Direction {
    y: Vec<f64>,
    inputs: Vec<f64>,
}

/// The foreseen motion with its change along a direction; none where none is foreseen.
type Changed = Option<(Vec<Dual<1>>, [Drive<Dual<1>>; MOST_CYLINDERS])>;

impl Model {
    /// Directional derivatives of outputs at the present state: for each unknown the sum over the knowns of dy / du
    /// times the seed. `report` is called once for each unknown, with its index; with NaN for one that has no
    /// derivative in this state.
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
        self.started()?;
        let layout = self.parameters.laws.layout;
        let mut direction = Direction { y: vec![0.0; layout.components()], inputs: vec![0.0; layout.inputs()] };
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
        let present = self.present(&direction);
        let mut changed = None;
        for (index, &unknown) in unknowns.iter().enumerate() {
            let Some(Quantity::Output(output)) = self.original.variables.quantity(unknown) else { continue };
            let derivative = match output {
                Output::Preview(cylinder, what) => {
                    let changed = match &changed {
                        Some(changed) => changed,
                        None => changed.insert(self.foresee_change(&direction)),
                    };
                    Some(self.ahead(changed, &direction, cylinder, what))
                }
                _ => present.output(&self.parameters.laws, output, 0.0),
            };
            let derivative = derivative.map_or(f64::NAN, |dual| dual.slope[0]);
            report(index, if derivative.is_finite() { derivative } else { f64::NAN });
        }
        Ok(())
    }

    /// The present state and its change along a direction.
    fn present(&self, direction: &Direction) -> Present<Dual<1>> {
        let (laws, inputs) = (&self.parameters.laws, &self.inputs);
        let y = self.state.iter().flat_map(|state| &state.y).zip(&direction.y);
        let dual = |(value, slope): (&f64, &f64)| Dual { value: *value, slope: [*slope] };
        let input = |index: usize| dual((&inputs.values[index], &direction.inputs[index]));
        let u = (0..laws.layout.flow_inputs()).map(input);
        Present::new(laws, y.map(dual), u, motion(&laws.layout, input, Dual::constant(0.0)))
    }

    /// The motion foreseen and its change along a direction.
    fn foresee_change(&mut self, direction: &Direction) -> Changed {
        let h = self.horizon();
        let Self { parameters, inputs, state: Some(state), cache, .. } = self else { return None };
        let setting = parameters.setting(inputs);
        let foreseen = cache.foresee(&setting, state, h);
        if foreseen.reached != h {
            return None;
        }
        let (mut end, drives) = state.foresee_change(&setting, foreseen, &direction.y, &direction.inputs)?;
        // A longer step ends later along the motion.
        let later = direction.inputs[parameters.laws.layout.horizon()];
        if later != 0.0 {
            let rates = foreseen.end_rates(&setting);
            end.iter_mut().zip(rates).for_each(|(end, rate)| end.slope[0] += later * rate);
        }
        Some((end, drives))
    }

    /// What the foreseen motion tells of a cylinder, and its change along a direction.
    fn ahead(&self, changed: &Changed, direction: &Direction, cylinder: usize, what: Ahead) -> Dual<1> {
        let (laws, layout) = (&self.parameters.laws, &self.parameters.laws.layout);
        let of = |part| {
            let index = layout.of_cylinder(cylinder, part);
            Dual { value: self.inputs.values[index], slope: [direction.inputs[index]] }
        };
        let chamber = layout.chamber(cylinder);
        let y = self.state.as_ref().map_or(&[][..], |state| &state.y);
        let pressures = [chamber, chamber + 1].map(|k| Dual { value: y[k], slope: [direction.y[k]] });
        let (motion, given) = ([of(Part::Length), of(Part::Speed)], of(Part::Acceleration));
        let force = laws.cylinders[cylinder].laws.force(pressures, motion[1]);
        let h = self.horizon();
        match changed {
            Some((end, drives)) => {
                let h = Dual { value: h, slope: [direction.inputs[layout.horizon()]] };
                ahead(laws, (cylinder, &drives[cylinder]), (force, motion, given), end, h, what)
            }
            None => blind(what, force, motion, given, h),
        }
    }

    /// Rate of a continuous output in time, under inputs that change at the rates set by
    /// [`Self::set_input_derivative`], and under the speed and the acceleration of the inputs; where the latter is 0
    /// and a reduced mass is told, under the acceleration of this mass. Outputs of the foreseen motion belong to the
    /// next step: the rate of `preview.force` is that of the line, `preview.force_mean` and `preview.force_rate` are
    /// constant, `preview.length` and `preview.speed` have the speed and the acceleration at the end of the step; the
    /// accelerations have no rate.
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
        if let Output::Preview(cylinder, what) = output {
            let of = match what {
                Ahead::Force => Ahead::ForceRate,
                Ahead::ForceMean | Ahead::ForceRate => return Ok(0.0),
                Ahead::Length => Ahead::Speed,
                Ahead::Speed => Ahead::Acceleration,
                Ahead::StartAcceleration | Ahead::Acceleration => return Ok(f64::NAN),
            };
            let value = self.output(Output::Preview(cylinder, of))?;
            return Ok(if value.is_finite() { value } else { f64::NAN });
        }
        let Self { parameters, inputs, state: Some(state), .. } = self else {
            return Err(HydraulicsError::NotInitialised);
        };
        let (laws, setting) = (&parameters.laws, parameters.setting(inputs));
        let layout = laws.layout;
        let mut rates: Vec<f64> = (0..layout.inputs()).map(|input| inputs.rate(&layout, input)).collect();
        let mut drives = [Drive::Held(0.0); MOST_CYLINDERS];
        for (cylinder, drive) in drives.iter_mut().enumerate().take(layout.cylinders) {
            let get = |part| setting.get(cylinder, part);
            let motion = [get(Part::Length), get(Part::Speed)];
            *drive = Drive::Given(motion);
            // A host that connects no acceleration may have told the mass.
            let rate = &mut rates[layout.of_cylinder(cylinder, Part::Speed)];
            if *rate == 0.0 && get(Part::Mass) > 0.0 {
                let chamber = layout.chamber(cylinder);
                let force = laws.cylinders[cylinder].laws.force([state.y[chamber], state.y[chamber + 1]], motion[1]);
                let own = state.element(&setting, cylinder, get).acceleration(force, motion, 0.0);
                *rate = if own.is_finite() { own } else { 0.0 };
            }
        }
        let mut y = [0.0; MOST_COMPONENTS];
        y[..state.y.len()].copy_from_slice(&state.y);
        let change = laws.rates(&drives[..layout.cylinders], &inputs.values, 0.0, &y);
        let mut direction = Direction { y: change[..state.y.len()].to_vec(), inputs: rates };
        for cylinder in 0..layout.cylinders {
            let own = layout.motion(cylinder);
            direction.y[own] = setting.get(cylinder, Part::Speed);
        }
        let rate = self.present(&direction).output(&self.parameters.laws, output, 0.0);
        Ok(rate.map_or(f64::NAN, |dual| if dual.slope[0].is_finite() { dual.slope[0] } else { f64::NAN }))
    }

    /// Why an output has no derivative where the last call gave NaN.
    #[cold]
    pub fn undefined_derivative(&mut self, reference: Reference) -> Option<String> {
        match self.original.variables.quantity(reference)? {
            Quantity::Output(Output::Preview(_, Ahead::StartAcceleration | Ahead::Acceleration)) => {
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
    pub fn check_input_derivative(&self, reference: Reference, own: i32, value: f64) -> Result<(), HydraulicsError> {
        self.continuous(reference, Causality::Input, "derivatives can be set for continuous inputs only")?;
        let most = order(self.parameters.laws.layout.input(reference as usize));
        if !(1..=most as i32).contains(&own) {
            let what = format!("time derivative of order {own} of {}", self.name_of(reference));
            let reason = format!("only the orders 1 to {most} can be set");
            return Err(HydraulicsError::Derivative { what, reason });
        }
        if !value.is_finite() {
            let name = format!("time derivative of order {own} of {}", self.name_of(reference));
            return Err(HydraulicsError::Value { name, value, allowed: "finite".into() });
        }
        Ok(())
    }

    /// Set a derivative of an input in time at the beginning of the next step; it holds for one step. Those of lengths
    /// are not used: within a step a length is its value at the beginning plus the integral of the speed.
    ///
    /// # Errors
    /// As [`Self::check_input_derivative`].
    pub fn set_input_derivative(&mut self, reference: Reference, own: i32, value: f64) -> Result<(), HydraulicsError> {
        self.check_input_derivative(reference, own, value)?;
        self.inputs.set_rate(reference as usize, own as usize, value);
        self.cache.clear();
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
