//! Linearisation at rest along the travel: x' = A x + B u, y = C x + D u for small deviations.
//!
//! In: a coordinate, inputs, outputs, a number of positions. Out: the matrices at each position, exact by dual numbers
//! through the laws of the outputs, with eigenfrequency and damping ratio. It must not know any law.
use super::{Formulation, Model, ModelError};
use crate::mechanism::definition::{ControlState, MOST_STATES, Method};
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::motion::contact::{Contact, Place};
use crate::mechanism::motion::equilibrium::{AtRest, Equilibrium};
use crate::mechanism::motion::samples::ends;
use crate::mechanism::motion::travel::pressed_bumpers;
use crate::mechanism::outputs::{ReducedMotion, of_state};
use crate::mechanism::quantity::{OneElement, Output, Quantity};
use crate::mechanism::reduced::Reduced;
use crate::numerics::order;
use crate::variables::{Causality, Kind, Reference};
use nalgebra::DMatrix;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Part of the largest slope of a coordinate along the curve below which the coordinate stands still: at its toggle the
/// state of the mechanism does not follow from it.
const TOGGLE: f64 = 1e-9;

/// What is linearised.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearisation {
    /// The angle of a body or the position of a joint, an output; it, its rate and the states of controllers are the
    /// state x.
    pub coordinate: Reference,
    /// The inputs u: continuous inputs.
    pub inputs: Vec<Reference>,
    /// The outputs y: continuous outputs.
    pub outputs: Vec<Reference>,
    /// A force or torque of a drive, an input, that holds the mechanism at each position; with none it sets off from
    /// where the loads are not in balance, and the deviations are from that motion.
    pub held_by: Option<Reference>,
}

/// The linearised mechanism at rest at one position.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Linearised {
    /// Value of the coordinate [rad or m].
    pub coordinate: f64,
    /// Acceleration of the coordinate, 0 at an equilibrium [rad/s^2 or m/s^2].
    pub acceleration: f64,
    /// Value of the input that holds the mechanism, if one does [N or N.m].
    pub holding: Option<f64>,
    /// Angular eigenfrequency omega of the undamped motion; not a number where the motion is no oscillation [rad/s].
    pub omega: f64,
    /// Damping ratio zeta [1]; not a number where omega is none.
    pub damping_ratio: f64,
    /// Eigenvalues, each as real and imaginary part [1/s]: of sigma_ddot = -k sigma - d sigma_dot, with the states
    /// of controllers. They are those of `a` at an equilibrium, and the same whatever the coordinate elsewhere.
    pub eigenvalues: Vec<[f64; 2]>,
    /// A, row by row.
    pub a: Vec<Vec<f64>>,
    /// B: for each input a column.
    pub b: Vec<Vec<f64>>,
    /// C: for each output a row.
    pub c: Vec<Vec<f64>>,
    /// D: for each output a row with one number for each input.
    pub d: Vec<Vec<f64>>,
}

impl Linearised {
    /// Eigenfrequency omega / (2 pi) of the undamped motion; not a number where the motion is no oscillation [Hz].
    pub fn eigenfrequency(&self) -> f64 {
        self.omega / TAU
    }
}

/// Both roots of s^2 + d s + k = 0, as real and imaginary parts.
fn roots(k: f64, d: f64) -> [[f64; 2]; 2] {
    let square = 0.25 * d * d - k;
    if square < 0.0 {
        let imaginary = (-square).sqrt();
        return [[-0.5 * d, imaginary], [-0.5 * d, -imaginary]];
    }
    // The root of larger size first, and the other from the product, so that none is a difference of near numbers.
    let large = -(0.5 * d.abs() + square.sqrt()).copysign(d);
    let small = if large == 0.0 { 0.0 } else { k / large };
    [[large, 0.0], [small, 0.0]]
}

impl Model {
    /// All equilibria of the travel under the present inputs and parameters, ascending along the curve.
    ///
    /// # Errors
    /// The present parameters give no mechanism, or no start; a hydraulic circuit or the finite elements, whose states
    /// are more than position and speed.
    pub fn equilibria(&mut self) -> Result<Vec<Equilibrium>, ModelError> {
        self.has_two_states()?;
        if self.control_states().any(|(_, state)| state == ControlState::Integral) {
            return refused_equilibria();
        }
        let (motion, reduced) = self.motion_at_rest()?;
        let here = motion.state.sigma + motion.state.revolutions * reduced.period().unwrap_or(0.0);
        let range = ends(&reduced, &motion.state.travel, here);
        let mut at_rest = AtRest::new(&reduced, &motion.state.travel, &self.inputs, here)?;
        let mut all = at_rest.between(range);
        for (side, end) in motion.state.travel.rigid.iter().enumerate() {
            let place = Place::rigid(side);
            let pressed = end.and_then(|end| at_rest.pressed(place, end.position));
            all.extend(pressed);
        }
        Ok(order::sorted(all, |equilibrium| equilibrium.position))
    }

    /// Linearise at rest at `count` + 1 positions of the travel, in equal parts of the curve, under the present inputs
    /// and parameters. The state of the model stays what it is.
    ///
    /// # Errors
    /// As [`Self::linearise_here`].
    pub fn linearise(&mut self, what: &Linearisation, count: usize) -> Result<Vec<Linearised>, ModelError> {
        self.check(what)?;
        let (mut motion, reduced) = self.motion_at_rest()?;
        let here = motion.state.sigma + motion.state.revolutions * reduced.period().unwrap_or(0.0);
        let [low, high] = ends(&reduced, &motion.state.travel, here);
        let at = |k: usize| low + (high - low) * k as f64 / count.max(1) as f64;
        (0..=count).map(|k| self.linearised(what, (&mut motion, &reduced), at(k))).collect()
    }

    /// Linearise at rest at the start.
    ///
    /// # Errors
    /// The present parameters give no mechanism, or no start; a reference is none of the kind that is asked for; a
    /// hydraulic circuit or the finite elements, whose states are more than position and speed.
    pub fn linearise_here(&mut self, what: &Linearisation) -> Result<Linearised, ModelError> {
        self.check(what)?;
        let (mut motion, reduced) = self.motion_at_rest()?;
        let here = motion.state.sigma + motion.state.revolutions * reduced.period().unwrap_or(0.0);
        self.linearised(what, (&mut motion, &reduced), here)
    }

    /// Values of outputs at rest at these positions along the curve, under the present inputs and parameters: for each
    /// output one value a position, not a number where it has none. `held_by` is a force or torque of a drive, an
    /// input, that holds the mechanism at each position. With a hydraulic circuit, whose pressures stay as they are,
    /// only terms of one drive have values.
    ///
    /// # Errors
    /// As [`Self::equilibria`].
    pub fn at_rest(
        &mut self,
        positions: &[f64],
        outputs: &[Reference],
        held_by: Option<Reference>,
    ) -> Result<Vec<Vec<f64>>, ModelError> {
        let is_hydraulic = self.original.parameter_values.mechanism().has_hydraulics();
        if !is_hydraulic {
            self.has_two_states()?;
        }
        let is_term = |output: &Output| !is_hydraulic || matches!(output, Output::OneElement { .. });
        let (mut motion, reduced) = self.motion_at_rest()?;
        let mut columns = vec![Vec::with_capacity(positions.len()); outputs.len()];
        for &position in positions {
            let (inputs, _) = self.put_at_rest(held_by, (&mut motion, &reduced), position);
            for (column, output) in columns.iter_mut().zip(outputs) {
                let output = self.output_of(*output).filter(is_term);
                let value = output.and_then(|output| motion.output(&reduced, &inputs, output).ok());
                column.push(value.unwrap_or(f64::NAN));
            }
        }
        Ok(columns)
    }

    /// States of controllers, with the indices of their drives.
    fn control_states(&self) -> impl Iterator<Item = (usize, ControlState)> + '_ {
        self.original.reduced.loading().control_states()
    }

    /// Refuse what has more states than position, speed and those of controllers.
    fn has_two_states(&self) -> Result<(), ModelError> {
        let refused = |reason: &str| {
            let what = "the linearisation with respect to position and speed".to_owned();
            Err(ModelError::Derivative { what, reason: reason.to_owned() })
        };
        if self.parameter_values.method() == Method::RigidFem {
            return refused(
                "solver.method = \"rigid_fem\" has more states than position and speed; choose solver.method = \
                 \"reduced\"",
            );
        }
        if self.original.reduced.linkage().is_massless {
            return Err(ModelError::massless(self.original.reduced.linkage()));
        }
        if self.original.reduced.loading().motion.is_some() && self.inputs.prescribes() {
            return refused(
                "a drive has a prescribed motion, so the mechanism has no states; set `motion.enabled` to false",
            );
        }
        match self.original.parameter_values.mechanism().has_hydraulics() {
            true => refused(
                "a hydraulic circuit has more states than position and speed; remove `hydraulics` to linearise the \
                 mechanism alone",
            ),
            false => Ok(()),
        }
    }

    fn check(&self, what: &Linearisation) -> Result<(), ModelError> {
        self.has_two_states()?;
        let refuse = |reference: Reference, reason: &str| {
            let what = format!("{} (value reference {reference})", self.name_of(reference));
            Err(ModelError::Derivative { what, reason: reason.into() })
        };
        if self.output_of(what.coordinate).and_then(coordinate_of).is_none() {
            return refuse(
                what.coordinate,
                "the coordinate of the linearisation must be the angle of a body or the position of a joint",
            );
        }
        let is = |reference: Reference, causality: Causality| {
            let variable = self.original.variables.get(reference);
            variable.is_some_and(|v| v.causality == causality && v.kind == Kind::Real)
        };
        if let Some(&other) = what.inputs.iter().find(|input| !is(**input, Causality::Input)) {
            return refuse(other, "an input of the linearisation must be a continuous input");
        }
        if let Some(&other) = what.outputs.iter().find(|output| !is(**output, Causality::Output)) {
            return refuse(other, "an output of the linearisation must be a continuous output");
        }
        match what.held_by {
            Some(drive) if self.drive_of(drive).is_none() => {
                refuse(drive, "held_by must be the force or torque of a drive")
            }
            _ => Ok(()),
        }
    }

    /// The drive that an input sizes, by the index of its load.
    fn drive_of(&self, input: Reference) -> Option<usize> {
        match self.original.variables.quantity(input) {
            Some(Quantity::Input(index)) => {
                Some(index).filter(|index| *index < self.original.reduced.loading().drives.len())
            }
            _ => None,
        }
    }

    fn output_of(&self, reference: Reference) -> Option<Output> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Output(output)) => Some(output),
            _ => None,
        }
    }

    /// A motion of its own at the start, which nothing holds.
    fn motion_at_rest(&mut self) -> Result<(Box<ReducedMotion>, Arc<Reduced>), ModelError> {
        let state = self.state()?;
        let Formulation::Reduced(motion) = state else { return Err(ModelError::NotInitialised) };
        let mut motion = motion.clone();
        motion.state.contact = Contact::default();
        Ok((motion, Arc::clone(self.reduced()?)))
    }

    /// The linearised mechanism at rest at a position, counted on over whole revolutions.
    fn linearised(
        &self,
        what: &Linearisation,
        (motion, reduced): (&mut ReducedMotion, &Reduced),
        position: f64,
    ) -> Result<Linearised, ModelError> {
        let (inputs, holding) = self.put_at_rest(what.held_by, (motion, reduced), position);
        let mut out = Linearised { holding, ..Linearised::default() };
        let [k, d] = motion.small_motion(reduced, &inputs).unwrap_or([f64::NAN; 2]);
        out.omega = if k > 0.0 { k.sqrt() } else { f64::NAN };
        out.damping_ratio = 0.5 * d / out.omega;
        out.eigenvalues = self.eigenvalues([k, d], (motion, reduced, &inputs));
        self.add_matrices(what, (motion, reduced, &inputs), &mut out);
        Ok(out)
    }

    /// Put a motion at rest at a position, counted on over whole revolutions; the inputs there, with the value of the
    /// one that holds it, if one does.
    fn put_at_rest(
        &self,
        held_by: Option<Reference>,
        (motion, reduced): (&mut ReducedMotion, &Reduced),
        position: f64,
    ) -> (Inputs, Option<f64>) {
        let (sigma, revolutions) = reduced.unwound(position);
        let mut inputs = self.inputs.clone();
        inputs.signal.clear();
        motion.move_to(sigma, 0.0, revolutions);
        let touching = pressed_bumpers(reduced, &motion.state.travel, position, 0.0);
        motion.state.contact.set_touching(touching);
        // At rest a force that follows that of a controller is equal to it; without a displacement nothing has a value.
        _ = motion.follow(reduced, &inputs, |_| true);
        let held_by = held_by.and_then(|input| Some((input as usize, self.drive_of(input)?)));
        let Some((index, drive)) = held_by else { return (inputs, None) };
        let holding = Output::OneElement { drive, term: OneElement::HoldingForce };
        let held = motion.output(reduced, &inputs, holding).unwrap_or(f64::NAN);
        // What the drive's curve gives at rest is not asked of the input.
        let acting = motion.output(reduced, &inputs, Output::ActingForce { drive }).unwrap_or(f64::NAN);
        let force = held - (acting - inputs.reals[index]);
        if force.is_finite() {
            inputs.set(index, force);
            _ = motion.follow(reduced, &inputs, |_| true);
        }
        (inputs, Some(force))
    }

    /// Eigenvalues of small motions with this stiffness and damping; not a number where these are none.
    fn eigenvalues(
        &self,
        [k, d]: [f64; 2],
        (motion, reduced, inputs): (&mut ReducedMotion, &Reduced, &Inputs),
    ) -> Vec<[f64; 2]> {
        let controllers: Vec<(usize, ControlState)> = self.control_states().collect();
        let states = 2 + controllers.len();
        if k.is_nan() || d.is_nan() {
            return vec![[f64::NAN; 2]; states];
        }
        if controllers.is_empty() {
            return roots(k, d).to_vec();
        }
        let mut a = DMatrix::zeros(states, states);
        (a[(0, 1)], a[(1, 0)], a[(1, 1)]) = (1.0, -k, -d);
        for column in 0..states {
            motion.head_for(reduced, inputs, of_state(column, 1.0), &|_| 0.0);
            if column >= 2 {
                a[(1, column)] = motion.slope_of_small_motion(reduced, inputs).unwrap_or(f64::NAN);
            }
            for (row, &(drive, state)) in controllers.iter().enumerate() {
                let rate = Output::Controller { drive, state, order: 1 };
                a[(2 + row, column)] = motion.derivative(reduced, inputs, rate).unwrap_or(f64::NAN);
            }
        }
        if a.iter().any(|value| value.is_nan()) {
            return vec![[f64::NAN; 2]; states];
        }
        let mut all: Vec<[f64; 2]> = a.complex_eigenvalues().iter().map(|value| [value.re, value.im]).collect();
        all.sort_by(|one, other| one[0].total_cmp(&other[0]).then(other[1].total_cmp(&one[1])));
        all
    }

    /// The matrices and the values in the present state of a motion.
    fn add_matrices(
        &self,
        what: &Linearisation,
        (motion, reduced, inputs): (&mut ReducedMotion, &Reduced, &Inputs),
        out: &mut Linearised,
    ) {
        let Some(of) = self.output_of(what.coordinate).and_then(coordinate_of) else { return };
        let value = |motion: &mut ReducedMotion, output| motion.output(reduced, inputs, output).unwrap_or(f64::NAN);
        out.coordinate = value(motion, of(0));
        out.acceleration = value(motion, of(2));
        // At rest the speed of the coordinate changes with sigma_dot as the coordinate with sigma.
        motion.head_for(reduced, inputs, of_state(1, 1.0), &|_| 0.0);
        let slope = motion.derivative(reduced, inputs, of(1)).unwrap_or(f64::NAN);
        let scale = if slope.abs() * reduced.scale() > TOGGLE { 1.0 / slope } else { f64::NAN };
        let outputs: Vec<Output> = what.outputs.iter().filter_map(|output| self.output_of(*output)).collect();
        let along = |motion: &mut ReducedMotion, output| {
            let derivative = motion.derivative(reduced, inputs, output);
            derivative.unwrap_or(f64::NAN)
        };
        let rates = self.control_states().map(|(drive, state)| Output::Controller { drive, state, order: 1 });
        // The rates of the states but the first one, which is the second state.
        let rates: Vec<Output> = [of(2)].into_iter().chain(rates).collect();
        let states = 1 + rates.len();
        out.a = vec![vec![f64::NAN; states]; states];
        out.a[0].fill(0.0);
        out.a[0][1] = 1.0;
        out.c = vec![vec![f64::NAN; states]; outputs.len()];
        for state in 0..states {
            let change = if state < 2 { scale } else { 1.0 };
            if change.is_nan() {
                continue;
            }
            motion.head_for(reduced, inputs, of_state(state, change), &|_| 0.0);
            for (row, rate) in out.a[1..].iter_mut().zip(&rates) {
                row[state] = along(motion, *rate);
            }
            for (row, output) in out.c.iter_mut().zip(&outputs) {
                row[state] = along(motion, *output);
            }
        }
        out.d = vec![Vec::new(); outputs.len()];
        for &input in &what.inputs {
            motion.head_for(reduced, inputs, [0.0; MOST_STATES], &|index| f64::from(u8::from(index == input as usize)));
            let column = [0.0].into_iter().chain(rates.iter().map(|rate| along(motion, *rate)));
            out.b.push(column.collect());
            for (row, output) in out.d.iter_mut().zip(&outputs) {
                row.push(along(motion, *output));
            }
        }
    }
}

/// The error for equilibria of a mechanism with an integral part.
fn refused_equilibria<T>() -> Result<T, ModelError> {
    let reason = "the integral part of a controller is in balance only at the command; remove integral_gain".to_owned();
    Err(ModelError::Derivative { what: "the list of equilibria".to_owned(), reason })
}

/// The coordinate that an output is, as the output of its time derivative of an order.
fn coordinate_of(output: Output) -> Option<impl Fn(usize) -> Output> {
    match output {
        Output::Angle { body, order: 0 } => Some(Coordinate::Angle(body)),
        Output::JointPosition { coordinate, order: 0 } => Some(Coordinate::Position(coordinate)),
        _ => None,
    }
    .map(|of| {
        move |order| match of {
            Coordinate::Angle(body) => Output::Angle { body, order },
            Coordinate::Position(coordinate) => Output::JointPosition { coordinate, order },
        }
    })
}

/// A coordinate, by the index of its body or of its joint.
#[derive(Clone, Copy)]
enum Coordinate {
    Angle(usize),
    Position(usize),
}

#[cfg(test)]
mod tests {
    use super::roots;

    #[test]
    fn roots_are_those_of_the_closed_form() {
        assert_eq!(roots(25.0, 6.0), [[-3.0, 4.0], [-3.0, -4.0]]);
        assert_eq!(roots(2.0, 3.0), [[-2.0, 0.0], [-1.0, 0.0]]);
        assert_eq!(roots(-4.0, 0.0), [[-2.0, 0.0], [2.0, 0.0]]);
        assert_eq!(roots(0.0, 0.0), [[0.0, 0.0]; 2]);
        let [_, [slow, _]] = roots(1.0, 1e9);
        assert!((slow + 1e-9).abs() < 1e-24, "{slow}");
    }
}
