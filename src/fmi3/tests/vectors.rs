//! Vectors: one variable for two scalars, in every function that takes Float64 variables.

use super::*;

/// The gear on its way, under forces along both axes.
fn moving() -> Instance {
    let c = initialized();
    let knowns = references(["wheel.force_x", "wheel.force_y"]);
    // SAFETY: the instance is valid, the arrays have 2 elements.
    assert_eq!(unsafe { fmi3SetFloat64(c, knowns.as_ptr(), 2, [700.0, -300.0].as_ptr(), 2) }, Status::Ok);
    assert_eq!(step(c, 0.0, 0.04), (Status::Ok, 0.04));
    c
}

const NAMES: [&str; 5] = ["joint2.reaction", "wheel.position", "time", "crank.angle", "wheel.velocity"];
/// The same, element after element.
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
fn elements_are_read_in_order_beside_scalars() {
    let (whole, scalars) = (references(NAMES), references(SCALARS));
    let c = moving();
    let mut values = [f64::NAN; 8];
    // SAFETY: the instance is valid until it is freed, the arrays have the lengths told.
    unsafe {
        assert_eq!(fmi3GetFloat64(c, whole.as_ptr(), 5, values.as_mut_ptr(), 8), Status::Ok);
        assert_eq!(values.map(f64::to_bits), get(c, &scalars).map(f64::to_bits));
        assert!(values.iter().all(|value| *value != 0.0), "{values:?}");
        let mut untouched = [7.0; 9];
        for wrong in [0, 5, 7, 9] {
            assert_eq!(fmi3GetFloat64(c, whole.as_ptr(), 5, untouched.as_mut_ptr(), wrong), Status::Error);
        }
        // As many values as variables, one of which is a vector.
        assert_eq!(fmi3GetFloat64(c, whole.as_ptr(), 1, untouched.as_mut_ptr(), 1), Status::Error);
        assert_eq!(untouched, [7.0; 9]);
        fmi3FreeInstance(c);
    }
}

#[test]
fn vectors_are_outputs_and_cannot_be_set() {
    let [position, force, y] = references(["wheel.position", "wheel.force_x", "wheel.y"]);
    let c = moving();
    let before = get(c, &[force, y]);
    // SAFETY: the instance is valid until it is freed, the arrays have the lengths told.
    unsafe {
        for values in [1, 2, 3, 4] {
            let status = fmi3SetFloat64(c, [force, position].as_ptr(), 2, [1.0; 4].as_ptr(), values);
            assert_eq!(status, Status::Error, "{values}");
        }
        assert_eq!(fmi3GetBoolean(c, &position, 1, [0].as_mut_ptr(), 1), Status::Error);
        assert_eq!(fmi3GetUInt64(c, &position, 1, [0].as_mut_ptr(), 1), Status::Error);
        assert_eq!(get(c, &[force, y]), before);
        fmi3FreeInstance(c);
    }
}

#[test]
fn derivatives_of_vectors_are_those_of_their_elements() {
    let whole = references(["joint2.reaction", "crank.acceleration", "wheel.acceleration"]);
    let scalars = references([
        "joint2.force_x",
        "joint2.force_y",
        "crank.acceleration",
        "wheel.acceleration_x",
        "wheel.acceleration_y",
    ]);
    let knowns = references(["actuator.force", "wheel.force_y"]);
    let [position, velocity] = references(["wheel.position", "wheel.velocity"]);
    let (right, left) = ([3.0, -0.5], [0.1, -0.2, 0.3, 0.4, -0.5]);
    let c = moving();
    // SAFETY: the instance is valid until it is freed, the arrays have the lengths told.
    unsafe {
        let (w, s, k) = (whole.as_ptr(), scalars.as_ptr(), knowns.as_ptr());
        let (mut one, mut other) = ([0.0; 5], [0.0; 5]);
        assert_eq!(fmi3GetDirectionalDerivative(c, w, 3, k, 2, right.as_ptr(), 2, one.as_mut_ptr(), 5), Status::Ok);
        assert_eq!(fmi3GetDirectionalDerivative(c, s, 5, k, 2, right.as_ptr(), 2, other.as_mut_ptr(), 5), Status::Ok);
        assert_eq!(one.map(f64::to_bits), other.map(f64::to_bits));
        assert!(one.iter().all(|value| *value != 0.0), "{one:?}");

        let (mut back, mut again) = ([0.0; 2], [0.0; 2]);
        assert_eq!(fmi3GetAdjointDerivative(c, w, 3, k, 2, left.as_ptr(), 5, back.as_mut_ptr(), 2), Status::Ok);
        assert_eq!(fmi3GetAdjointDerivative(c, s, 5, k, 2, left.as_ptr(), 5, again.as_mut_ptr(), 2), Status::Ok);
        assert_eq!(back.map(f64::to_bits), again.map(f64::to_bits));

        // The rate of the position is the velocity.
        let mut rates = [0.0; 4];
        let of = [position, velocity];
        assert_eq!(fmi3GetOutputDerivatives(c, of.as_ptr(), 2, [1, 1].as_ptr(), rates.as_mut_ptr(), 4), Status::Ok);
        let [x, y, ..] = rates;
        let [vx, vy] = get(c, &references(["wheel.velocity_x", "wheel.velocity_y"]));
        assert!((x - vx).abs() < 1e-12 * vx.abs() && (y - vy).abs() < 1e-12 * vy.abs(), "{rates:?} {vx} {vy}");

        let (before, time) = (one, references(["time"]));
        for (count, seeds, sensitivities) in [(2, 2, 3), (2, 2, 4), (2, 1, 5), (2, 3, 5)] {
            let status = fmi3GetDirectionalDerivative(
                c,
                w,
                3,
                k,
                count,
                [1.0; 3].as_ptr(),
                seeds,
                one.as_mut_ptr(),
                sensitivities,
            );
            assert_eq!(status, Status::Error);
        }
        for unfit in [&whole[0], &time[0]] {
            let status = fmi3GetDirectionalDerivative(c, s, 5, unfit, 1, [1.0; 2].as_ptr(), 1, one.as_mut_ptr(), 5);
            assert_eq!(status, Status::Error);
        }
        // A seed that is no number is refused.
        for seed in [f64::NAN, f64::INFINITY] {
            let seeds = [1.0, 1.0, seed, -1.0, 1.0];
            let status = fmi3GetAdjointDerivative(c, w, 3, k, 2, seeds.as_ptr(), 5, back.as_mut_ptr(), 2);
            assert_eq!(status, Status::Error, "{seed}");
        }
        let order = [1];
        assert_eq!(fmi3GetOutputDerivatives(c, time.as_ptr(), 1, order.as_ptr(), one.as_mut_ptr(), 1), Status::Error);
        assert_eq!(fmi3GetOutputDerivatives(c, &position, 1, order.as_ptr(), one.as_mut_ptr(), 1), Status::Error);
        assert_eq!(fmi3GetOutputDerivatives(c, &position, 1, [2].as_ptr(), one.as_mut_ptr(), 2), Status::Error);
        assert_eq!(one, before);
        fmi3FreeInstance(c);
    }
}

/// Dependencies of a variable: the element, and the known.
fn dependencies(c: Instance, reference: ValueReference) -> Vec<(usize, ValueReference)> {
    let mut count = 0;
    // SAFETY: the instance is valid, and the arrays have the length told.
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
fn dependencies_are_told_for_each_element() {
    let [reaction, angle, magnitude, force, start] =
        references(["joint2.reaction", "crank.angle", "joint2.force", "actuator.force", "crank.start_angle"]);
    let c = gear();
    let knowns_of = |all: &[(usize, ValueReference)], element: usize| -> Vec<ValueReference> {
        all.iter().filter(|(of, _)| *of == element).map(|(_, known)| *known).collect()
    };
    let assert_alike = |c| {
        let (vector, scalar) = (dependencies(c, reaction), knowns_of(&dependencies(c, magnitude), 0));
        assert!(!scalar.is_empty() && scalar.contains(&force));
        assert_eq!([knowns_of(&vector, 1), knowns_of(&vector, 2)], [scalar.clone(), scalar.clone()]);
        assert_eq!(vector.len(), 2 * scalar.len());
        scalar
    };
    let initial = assert_alike(c);
    assert!(initial.contains(&start));
    assert!(dependencies(c, angle).contains(&(0, start)));
    // SAFETY: the instance is valid until it is freed.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
        assert_eq!(fmi3ExitInitializationMode(c), Status::Ok);
        let present = assert_alike(c);
        assert!(!present.contains(&start));
        assert_eq!(dependencies(c, angle), []);
        let mut count = 77;
        for unfit in [force, start, reaction + 1000, references(["time"])[0]] {
            assert_eq!(fmi3GetNumberOfVariableDependencies(c, unfit, &mut count), Status::Error);
        }
        assert_eq!(count, 77);
        fmi3FreeInstance(c);
    }
}

/// A marker may be called as a prismatic joint, which has a position of its own.
#[test]
fn a_vector_whose_name_a_scalar_has_is_left_out() {
    let text = include_str!("../../../modelDescription/SliderCrank/resources/mechanism.json");
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
