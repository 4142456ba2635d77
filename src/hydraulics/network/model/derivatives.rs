//! Derivatives of outputs by inputs and in time.
//!
//! In: outputs, a direction of the inputs. Out: derivatives by the outputs' laws with dual numbers. It must not know
//! any law.
use super::{Model, Network, motion};
use crate::common::Differentiable;
use crate::error::HydraulicsError;
use crate::network::definition::{MOST_COMPONENTS, MOST_CYLINDERS};
use crate::network::inputs::order;
use crate::network::laws::{Drive, Laws};
use crate::network::layout::Part;
use crate::network::outputs::{Ahead, Output, Present, ahead, blind};
use foundation::numerics::dual::{Dual, Number};

/// A direction in which state and inputs change.
struct Direction {
    y: Vec<f64>,
    inputs: Vec<f64>,
}

/// The foreseen motion with its change along a direction; none where none is foreseen.
type Changed = Option<(Vec<Dual<1>>, [Drive<Dual<1>>; MOST_CYLINDERS])>;

impl Model {
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
        let h = self.next_step();
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
        let h = self.next_step();
        match changed {
            Some((end, drives)) => {
                let h = Dual { value: h, slope: [direction.inputs[layout.horizon()]] };
                ahead(laws, (cylinder, &drives[cylinder]), (force, motion, given), end, h, what)
            }
            None => blind(what, force, motion, given, h),
        }
    }
}

impl Differentiable for Network {
    type Along = Vec<f64>;

    fn order(laws: &Laws, input: usize) -> usize {
        order(laws.layout.input(input))
    }

    fn rate_set(model: &mut Model, _input: usize) {
        model.cache.clear();
    }

    fn along(laws: &Laws) -> Vec<f64> {
        vec![0.0; laws.layout.inputs()]
    }

    fn is_instant(output: Output) -> bool {
        matches!(output, Output::Preview(_, Ahead::StartAcceleration | Ahead::Acceleration))
    }

    fn derivatives(
        model: &mut Model,
        along: &Vec<f64>,
        outputs: &mut dyn Iterator<Item = (usize, Output)>,
        report: &mut dyn FnMut(usize, f64),
    ) -> Result<(), HydraulicsError> {
        let layout = model.parameters.laws.layout;
        let direction = Direction { y: vec![0.0; layout.components()], inputs: along.clone() };
        let present = model.present(&direction);
        let mut changed = None;
        for (index, output) in outputs {
            let derivative = match output {
                Output::Preview(cylinder, what) => {
                    let changed = match &changed {
                        Some(changed) => changed,
                        None => changed.insert(model.foresee_change(&direction)),
                    };
                    Some(model.ahead(changed, &direction, cylinder, what))
                }
                _ => present.output(&model.parameters.laws, output, 0.0),
            };
            report(index, derivative.map_or(f64::NAN, |dual| dual.slope[0]));
        }
        Ok(())
    }

    fn rate(model: &mut Model, output: Output) -> Result<f64, HydraulicsError> {
        if let Output::Preview(cylinder, what) = output {
            let of = match what {
                Ahead::Force => Ahead::ForceRate,
                Ahead::ForceMean | Ahead::ForceRate => return Ok(0.0),
                Ahead::Length => Ahead::Speed,
                Ahead::Speed => Ahead::Acceleration,
                Ahead::StartAcceleration | Ahead::Acceleration => return Ok(f64::NAN),
            };
            return model.output(Output::Preview(cylinder, of));
        }
        let Model { parameters, inputs, state: Some(state), .. } = model else {
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
        let rate = model.present(&direction).output(&model.parameters.laws, output, 0.0);
        Ok(rate.map_or(f64::NAN, |dual| dual.slope[0]))
    }
}
