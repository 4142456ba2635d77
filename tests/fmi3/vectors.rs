//! Vectors: one variable for two scalars, in every function that takes Float64 variables.
use crate::Fmu;
use linkage_fmu::component::Component;
use linkage_fmu::fmi3::types::{Status, ValueReference};
use linkage_fmu::fmi3::*;

/// The gear in motion, under forces along both axes.
fn moving() -> Fmu {
    let gear = Fmu::stepping();
    assert_eq!(gear.set_reals(&gear.vrs(["wheel.force_x", "wheel.force_y"]), &[700.0, -300.0]), Status::Ok);
    gear.whole_step(0.0, 0.04);
    gear
}

const NAMES: [&str; 5] = ["joint2.reaction", "wheel.position", "time", "crank.angle", "wheel.velocity"];
/// The elements of the vectors as scalars.
const SCALARS: [&str; 8] = [
    "joint2.force_x",
    "joint2.force_y",
    "wheel.x",
    "wheel.y",
    "time",
    "crank.angle",
    "wheel.velocity_x",
    "wheel.velocity_y",
];

#[test]
fn elements_are_read_in_order_together_with_scalars() {
    let gear = moving();
    let whole = gear.vrs(NAMES);
    let mut values = [f64::NAN; 8];
    assert_eq!(gear.reals(&whole, &mut values), Status::Ok);
    assert_eq!(values.map(f64::to_bits), gear.get(SCALARS).map(f64::to_bits));
    assert!(values.iter().all(|value| *value != 0.0), "{values:?}");
    // Last case: as many values as variables, although one variable is a vector.
    let mut untouched = [7.0; 9];
    for (variables, wrong) in [(5, 0), (5, 5), (5, 7), (5, 9), (1, 1)] {
        assert_eq!(gear.reals(&whole[..variables], &mut untouched[..wrong]), Status::Error);
    }
    assert_eq!(untouched, [7.0; 9]);
}

#[test]
fn vectors_are_outputs_and_cannot_be_set() {
    let gear = moving();
    let [position, force] = gear.vrs(["wheel.position", "wheel.force_x"]);
    let before = gear.get(["wheel.force_x", "wheel.y"]);
    for values in 1..=4 {
        assert_eq!(gear.set_reals(&[force, position], &[1.0; 4][..values]), Status::Error, "{values}");
    }
    assert_eq!(gear.boolean(position, &mut 0), Status::Error);
    // SAFETY: the instance is valid, the arrays have one element.
    assert_eq!(unsafe { fmi3GetUInt64(gear.instance(), &position, 1, [0].as_mut_ptr(), 1) }, Status::Error);
    assert_eq!(gear.get(["wheel.force_x", "wheel.y"]), before);
}

#[test]
fn derivatives_of_vectors_are_those_of_their_elements() {
    let gear = moving();
    let whole = gear.vrs(["joint2.reaction", "crank.acceleration", "wheel.acceleration"]);
    let scalars =
        ["joint2.force_x", "joint2.force_y", "crank.acceleration", "wheel.acceleration_x", "wheel.acceleration_y"];
    let scalars = gear.vrs(scalars);
    let knowns = gear.vrs(["actuator.force", "wheel.force_y"]);
    let [position, velocity, time] = gear.vrs(["wheel.position", "wheel.velocity", "time"]);
    let (right, left) = ([3.0, -0.5], [0.1, -0.2, 0.3, 0.4, -0.5]);
    let (mut one, mut other) = ([0.0; 5], [0.0; 5]);
    assert_eq!(gear.derivative(false, &whole, &knowns, &right, &mut one), Status::Ok);
    assert_eq!(gear.derivative(false, &scalars, &knowns, &right, &mut other), Status::Ok);
    assert_eq!(one.map(f64::to_bits), other.map(f64::to_bits));
    assert!(one.iter().all(|value| *value != 0.0), "{one:?}");

    let (mut back, mut again) = ([0.0; 2], [0.0; 2]);
    assert_eq!(gear.derivative(true, &whole, &knowns, &left, &mut back), Status::Ok);
    assert_eq!(gear.derivative(true, &scalars, &knowns, &left, &mut again), Status::Ok);
    assert_eq!(back.map(f64::to_bits), again.map(f64::to_bits));

    // The rate of the position is the velocity.
    let mut rates = [0.0; 4];
    assert_eq!(gear.output_derivatives(&[position, velocity], &[1, 1], &mut rates), Status::Ok);
    let [vx, vy] = gear.get(["wheel.velocity_x", "wheel.velocity_y"]);
    assert!(
        (rates[0] - vx).abs() < 1e-12 * vx.abs() && (rates[1] - vy).abs() < 1e-12 * vy.abs(),
        "{rates:?} {vx} {vy}"
    );

    let before = one;
    for (seeds, sensitivities) in [(2, 3), (2, 4), (1, 5), (3, 5)] {
        let (seeds, values) = (&[1.0; 3][..seeds], &mut one[..sensitivities]);
        assert_eq!(gear.derivative(false, &whole, &knowns, seeds, values), Status::Error);
    }
    for unfit in [whole[0], time] {
        assert_eq!(gear.derivative(false, &scalars, &[unfit], &[1.0], &mut one), Status::Error);
    }
    // A seed that is NaN or infinite is rejected.
    for seed in [f64::NAN, f64::INFINITY] {
        let seeds = [1.0, 1.0, seed, -1.0, 1.0];
        assert_eq!(gear.derivative(true, &whole, &knowns, &seeds, &mut back), Status::Error, "{seed}");
    }
    for (reference, order, values) in [(time, 1, 1), (position, 1, 1), (position, 2, 2)] {
        assert_eq!(gear.output_derivatives(&[reference], &[order], &mut one[..values]), Status::Error);
    }
    assert_eq!(one, before);
}

/// Dependencies of a variable: index of the element, and reference of the known.
fn dependencies(gear: &Fmu, reference: ValueReference) -> Vec<(usize, ValueReference)> {
    let (c, mut count) = (gear.instance(), 0);
    // SAFETY: the instance is valid, and the arrays have the length that is passed.
    unsafe {
        assert_eq!(fmi3GetNumberOfVariableDependencies(c, reference, &mut count), Status::Ok);
        let (mut elements, mut knowns) = (vec![9; count], vec![9; count]);
        let (mut of_knowns, mut kinds) = (vec![9; count], vec![9; count]);
        let (e, k) = (elements.as_mut_ptr(), knowns.as_mut_ptr());
        let (o, d) = (of_knowns.as_mut_ptr(), kinds.as_mut_ptr());
        assert_eq!(fmi3GetVariableDependencies(c, reference, e, k, o, d, count), Status::Ok);
        assert_eq!(fmi3GetVariableDependencies(c, reference, e, k, o, d, count + 1), Status::Error);
        assert!(of_knowns.iter().all(|element| *element == 0) && kinds.iter().all(|kind| *kind == 5));
        elements.into_iter().zip(knowns).collect()
    }
}

#[test]
fn dependencies_are_given_for_each_element() {
    let gear = Fmu::gear(Default::default());
    let names = ["joint2.reaction", "crank.angle", "joint2.force", "actuator.force", "crank.start_angle"];
    let [reaction, angle, magnitude, force, start] = gear.vrs(names);
    let knowns_of = |all: &[(usize, ValueReference)], element: usize| -> Vec<ValueReference> {
        all.iter().filter(|(of, _)| *of == element).map(|(_, known)| *known).collect()
    };
    let assert_alike = || {
        let (vector, scalar) = (dependencies(&gear, reaction), knowns_of(&dependencies(&gear, magnitude), 0));
        assert!(!scalar.is_empty() && scalar.contains(&force));
        assert_eq!([knowns_of(&vector, 1), knowns_of(&vector, 2)], [scalar.clone(), scalar.clone()]);
        assert_eq!(vector.len(), 2 * scalar.len());
        scalar
    };
    assert!(assert_alike().contains(&start));
    assert!(dependencies(&gear, angle).contains(&(0, start)));
    gear.initialize(1e-9);
    assert!(!assert_alike().contains(&start));
    assert_eq!(dependencies(&gear, angle), []);
    for unfit in [force, start, reaction + 1000, gear.vr("time")] {
        assert_eq!(gear.dependencies(unfit), Status::Error);
    }
}

/// A marker may have the name of a prismatic joint, which has a variable `position` too.
#[test]
fn a_vector_with_the_name_of_a_scalar_is_omitted() {
    let text = include_str!("../../modelDescription/SliderCrank/resources/mechanism.json");
    let mut definition: serde_json::Value = serde_json::from_str(text).unwrap();
    definition["markers"]["cylinder"] = serde_json::json!({ "at": "piston.origin" });
    let component = Component::from_definition("mechanism.json", &definition.to_string()).unwrap();
    let mut names: Vec<String> = component.vectors().into_iter().map(|vector| vector.name).collect();
    let joints = ["bearing", "crankpin", "wristpin", "cylinder"].map(|joint| format!("{joint}.reaction"));
    let of_piston = ["position", "velocity", "acceleration"].map(|suffix| format!("piston.{suffix}"));
    // The joint has cylinder.position, cylinder.speed and cylinder.acceleration.
    let mut all = [&joints[..], &of_piston, &["cylinder.velocity".to_owned()]].concat();
    all.sort();
    names.sort();
    assert_eq!(names, all);
}
