//! The time of the set-up is proportional to the size of the definition: no search through all elements for each
//! element, and no repeated walk along a chain.
//!
//! Times are compared for n and 4 n elements. If the time is proportional to n, they differ by a factor of 4, for n^2
//! by 16, for n^3 by 64. Other work on the machine can lengthen one measurement, so the best of several measurements
//! counts.
#![allow(clippy::unwrap_used)]

use linkage_fmu::mechanism::Model;
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::interface;
use linkage_fmu::variables::{Causality, Value as Start};
use serde_json::{Value, json};
use std::time::Instant;

const SLIDER_CRANK: &str = include_str!("../../modelDescription/SliderCrank/resources/mechanism.json");
/// Between 4 for work in proportion to n and 16 for n^2.
const MOST: f64 = 9.0;
const ATTEMPTS: usize = 6;

/// The slider-crank with n additional elements of a group.
fn with(group: &str, n: usize, element: impl Fn(usize) -> Value) -> String {
    let mut definition: Value = serde_json::from_str(SLIDER_CRANK).unwrap();
    let elements = definition.as_object_mut().unwrap().entry(group).or_insert(json!({}));
    (0..n).for_each(|i| elements[format!("e{i}")] = element(i));
    definition.to_string()
}

/// A chain of bodies, each fixed to the end of the previous one, listed from its outer end if `reversed`.
fn chain(n: usize, reversed: bool) -> String {
    with("bodies", n, |i| {
        let first = if reversed { n - 1 } else { 0 };
        let before = if reversed { i + 1 } else { i.wrapping_sub(1) };
        let to = if i == first { "crank.end".into() } else { format!("e{before}.end") };
        json!({ "fixed_to": to, "angle": 1e-3, "length": 1e-5, "mass": 1e-6, "inertia": 0 })
    })
}

/// Points on the crank, each with a marker.
fn points(n: usize) -> String {
    let text = with("markers", n, |i| json!({ "at": format!("crank.p{i}") }));
    let mut definition: Value = serde_json::from_str(&text).unwrap();
    let points: serde_json::Map<_, _> = (0..n).map(|i| (format!("p{i}"), json!([0.1, 1e-6 * i as f64]))).collect();
    definition["bodies"]["crank"]["points"] = points.into();
    definition.to_string()
}

/// Blocks that slide on one another along the cylinder, and redundant joints that hold each block to the ground.
fn blocks(n: usize) -> String {
    let text = with("bodies", n, |_| json!({ "mass": 0.01 }));
    let mut definition: Value = serde_json::from_str(&text).unwrap();
    for i in 0..n {
        let before = if i == 0 { "piston.origin".into() } else { format!("e{}.origin", i - 1) };
        definition["joints"][format!("slide{i}")] = json!({
            "type": "prismatic", "first": before, "second": format!("e{i}.origin"), "axis_angle": 1.5
        });
    }
    definition.to_string()
}

fn spring(i: usize) -> Value {
    json!({ "first": "ground.origin", "second": "crank.end", "stiffness": 1e-3, "free_length": 1e-4 * (i + 1) as f64 })
}

fn rotary_spring(_: usize) -> Value {
    json!({ "joint": "bearing", "stiffness": 1e-4, "free_angle": 0 })
}

fn stop(i: usize) -> Value {
    json!({ "body": "crank", "limit": "upper", "angle": 100.0 + 1e-4 * i as f64 })
}

fn force(_: usize) -> Value {
    json!({ "at": "crank.end", "force": [0.01, 0] })
}

fn constant_force(_: usize) -> Value {
    json!({ "at": "crank.end", "force": [0.01, 0], "constant": true })
}

fn marker(_: usize) -> Value {
    json!({ "at": "rod.end" })
}

/// Time of a call in seconds.
fn time<T>(call: impl FnOnce() -> T) -> f64 {
    let before = Instant::now();
    let given = call();
    let time = before.elapsed().as_secs_f64();
    drop(given);
    time
}

/// Assert that the time of `task` is proportional to the number of elements, for n and 4 n elements.
fn in_proportion(what: &str, n: usize, definition: impl Fn(usize) -> String, task: impl Fn(&str)) {
    let texts = [definition(n), definition(4 * n)];
    let mut best = [f64::INFINITY; 2];
    for _ in 0..ATTEMPTS {
        for (best, text) in best.iter_mut().zip(&texts) {
            *best = best.min(time(|| task(text)));
        }
        if best[1] <= MOST * best[0] {
            return;
        }
    }
    panic!("{what}: {n} elements take {} s, {} take {} s", best[0], 4 * n, best[1]);
}

fn variables(text: &str) {
    let mechanism = Mechanism::from_json(text).unwrap();
    assert!(!interface::variables(&mechanism).unwrap().list().is_empty());
}

fn initial_dependencies(text: &str) {
    let mechanism = Mechanism::from_json(text).unwrap();
    // For many markers the list is found, but omitted as too long.
    interface::initial_dependencies(&mechanism).unwrap();
}

fn model(text: &str) {
    let mut model = Model::from_json(text).unwrap();
    model.initialize().unwrap();
    assert!(model.step(1e-3).is_ok());
}

#[test]
fn the_time_for_the_interface_is_proportional_to_the_definition() {
    in_proportion("a chain of fixed bodies", 2000, |n| chain(n, false), variables);
    in_proportion("a chain of fixed bodies, outermost first", 2000, |n| chain(n, true), variables);
    in_proportion("springs", 4000, |n| with("springs", n, spring), variables);
    in_proportion("springs in a joint", 4000, |n| with("springs", n, rotary_spring), variables);
    in_proportion("stops", 4000, |n| with("stops", n, stop), variables);
    in_proportion("forces", 4000, |n| with("forces", n, force), variables);
    in_proportion("constant forces", 4000, |n| with("forces", n, constant_force), variables);
    in_proportion("markers", 8000, |n| with("markers", n, marker), variables);
    in_proportion("points with markers", 50_000, points, variables);
    in_proportion("sliding blocks", 1000, blocks, variables);
}

#[test]
fn the_time_for_the_model_is_proportional_to_the_definition() {
    in_proportion("a chain of fixed bodies", 500, |n| chain(n, false), model);
    in_proportion("springs", 750, |n| with("springs", n, spring), model);
    in_proportion("stops", 250, |n| with("stops", n, stop), model);
    in_proportion("forces", 250, |n| with("forces", n, force), model);
    in_proportion("markers", 4000, |n| with("markers", n, marker), model);
}

/// The time to set each of n parameters is proportional to n, not n^2: the values are written into the definition
/// together.
#[test]
fn the_time_of_setting_parameters_is_proportional_to_their_number() {
    let set_all = |text: &str| {
        let mut model = Model::from_json(text).unwrap();
        let list = model.variables().list().iter().zip(0..);
        let stated: Vec<(u32, f64)> = list
            .filter(|(v, _)| v.causality == Causality::Parameter && v.name.starts_with('e'))
            .filter_map(|(v, reference)| match v.start {
                Some(Start::Real(start)) => Some((reference, start)),
                _ => None,
            })
            .collect();
        assert!(stated.len() > 1000);
        for &(reference, start) in &stated {
            model.set_real(reference, start * 1.25).unwrap();
        }
        model.initialize().unwrap();
        let (reference, start) = stated[0];
        assert_eq!(model.real(reference).unwrap(), start * 1.25);
    };
    in_proportion("parameters of forces", 1000, |n| with("springs", n, spring), set_all);
}

/// A text that is far too large is rejected by its length before it is read.
#[test]
fn a_text_of_300_megabytes_is_rejected_because_of_its_length() {
    let text =
        SLIDER_CRANK.replacen("\"description\": \"", &format!("\"description\": \"{}", "x".repeat(300_000_000)), 1);
    let mut said = String::new();
    let refused = time(|| said = Model::from_json(&text).err().unwrap().to_string());
    assert!(said.starts_with("not a valid mechanism: the file has 300") && said.contains("at most 16777216"), "{said}");
    // Reading one part in 30 of the text takes longer.
    let short =
        SLIDER_CRANK.replacen("\"description\": \"", &format!("\"description\": \"{}", "x".repeat(10_000_000)), 1);
    assert!(refused < time(|| Mechanism::from_json(&short).unwrap()), "{refused} s");
}

/// The set-up with a stop after 10 and after 1e5 revolutions takes equal time: the search for a stop does not turn the
/// mechanism.
#[test]
fn a_distant_stop_is_found_at_once() {
    let at = |angle: f64| with("stops", 50, move |_| json!({ "body": "crank", "limit": "upper", "angle": angle }));
    let mut best = [f64::INFINITY; 2];
    for _ in 0..ATTEMPTS {
        for (best, angle) in best.iter_mut().zip([60.0, 6e5]) {
            let text = at(angle);
            *best = best.min(time(|| Model::from_json(&text).unwrap()));
        }
    }
    assert!(best[1] < 3.0 * best[0] + 0.01, "{best:?} s");
}

/// The frame of the last body of a chain against the closed-form sum of its links.
#[test]
fn frames_along_a_chain_are_the_sum_of_its_links() {
    let (n, angle, length) = (300, 1e-3, 1e-5);
    for reversed in [false, true] {
        let text = chain(n, reversed);
        let mut definition: Value = serde_json::from_str(&text).unwrap();
        let outermost = if reversed { "e0.end".to_owned() } else { format!("e{}.end", n - 1) };
        definition["markers"]["end"] = json!({ "at": outermost });
        let mut model = Model::from_json(&definition.to_string()).unwrap();
        model.initialize().unwrap();
        let variables = model.variables();
        let references = ["crank.angle", "end.x", "end.y"].map(|name| variables.find(name).unwrap());
        let [crank, x, y] = references.map(|reference| model.real(reference).unwrap());
        let links = |f: fn(f64) -> f64| (1..=n).map(|k| length * f(crank + angle * k as f64)).sum::<f64>();
        assert!((x - (0.05 * crank.cos() + links(f64::cos))).abs() < 1e-13, "{x}");
        assert!((y - (0.05 * crank.sin() + links(f64::sin))).abs() < 1e-13, "{y}");
    }
}

/// Every acceleration depends on every drive. A table that is too large is rejected with its size before the memory is
/// exhausted.
#[test]
fn too_many_dependencies_are_rejected_with_limit_and_remedy() {
    let drive = |_| json!({ "first": "ground.origin", "second": "crank.end", "force": 0 });
    let mechanism = Mechanism::from_json(&with("actuators", 5000, drive)).unwrap();
    let message = interface::variables(&mechanism).err().unwrap().to_string();
    assert!(message.contains("at most 50000000 are allowed: use fewer drives"), "{message}");
}

/// The length of a body affects every marker on the body.
#[test]
fn the_time_for_initial_dependencies_is_proportional_to_the_definition() {
    in_proportion("markers", 4000, |n| with("markers", n, marker), initial_dependencies);
}

/// If the comparisons would take minutes, or the list would need 1 MB, the list of initial dependencies is omitted. A
/// small definition has the list.
#[test]
fn initial_dependencies_of_a_large_definition_are_omitted() {
    let of = |text: &str| interface::initial_dependencies(&Mechanism::from_json(text).unwrap()).unwrap();
    let is_listed = |text: &str| of(text).is_some_and(|all| all.iter().any(|one| !one.is_empty()));
    assert!(is_listed(&with("springs", 50, spring)) && is_listed(&with("markers", 50, marker)));
    assert_eq!(of(&with("springs", 20_000, spring)), None);
    assert_eq!(of(&with("markers", 20_000, marker)), None);
}

/// Of many stops after nine revolutions, forward or backward, the nearest one ends the travel.
#[test]
fn many_stops_end_the_travel_at_the_nearest() {
    for direction in [1.0, -1.0] {
        let limit = if direction > 0.0 { "upper" } else { "lower" };
        let stops = with(
            "stops",
            500,
            |i| json!({ "body": "crank", "limit": limit, "angle": direction * (60.0 + 1e-4 * i as f64) }),
        );
        let mut definition: Value = serde_json::from_str(&stops).unwrap();
        definition["start"]["speed"] = json!(100.0 * direction);
        definition["actuators"]["drive"]["torque"] = json!(3.0 * direction);
        let mut model = Model::from_json(&definition.to_string()).unwrap();
        model.initialize().unwrap();
        let angle = model.variables().find("crank.angle").unwrap();
        let farthest = (0..2000).fold(0.0, |most: f64, _| {
            model.step(1e-3).unwrap();
            most.max(direction * model.real(angle).unwrap())
        });
        // In one step the crank turns by about 0.1 rad.
        assert!((59.5..60.0 + 1e-9).contains(&farthest), "{farthest}");
    }
}
