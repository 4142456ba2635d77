//! What a host cannot see: inputs that leave their ranges within a step, foresights that fail, steps told ahead.
use super::*;

/// Derivatives of inputs lead out of their ranges within a step: no state may hold a negative mass.
#[test]
fn an_input_that_leaves_its_range_within_a_step_is_refused_by_name() {
    for (mode, name, value, first) in [
        ("preview", "actuator.reduced_mass", 700.0, -1e6),
        ("follow", "actuator.reduced_mass", 700.0, -1e6),
        ("delayed", "preview.horizon", 1e-3, -2.0),
        ("preview", "supply.pressure", 1e6, -1e10),
    ] {
        let mut actuator = model(&format!(r#"{{ "name": "A", "coupling": {{ "mode": "{mode}" }} }}"#));
        set(&mut actuator, "actuator.reduced_mass", 700.0);
        actuator.initialize().unwrap();
        set(&mut actuator, name, value);
        rate(&mut actuator, name, 1, first);
        let error = actuator.step(1e-3).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("at the end of the step"), "{mode}: {error}");
        rate(&mut actuator, name, 1, 0.0);
        actuator.step(1e-3).unwrap();
        let mut bytes = Vec::new();
        actuator.snapshot().write(&mut bytes).unwrap();
        actuator.read_snapshot(&bytes).unwrap();
    }
}

/// An input may be out of its range where `solver.max_steps` ends a step, as only its value at the end of the step is
/// checked: that state is written, and read back.
#[test]
fn a_state_within_a_step_is_read_back_whatever_its_inputs() {
    let mut negative = 0;
    for most in 3..120 {
        let mut actuator = model(r#"{ "name": "A", "coupling": { "mode": "follow" } }"#);
        set(&mut actuator, "solver.max_steps", f64::from(most));
        set(&mut actuator, "actuator.reduced_mass", 700.0);
        actuator.initialize().unwrap();
        set(&mut actuator, "valve.command", 1.0);
        // 700 kg at both ends of the step, -300 kg in its middle.
        set(&mut actuator, "actuator.reduced_mass", 700.0);
        rate(&mut actuator, "actuator.reduced_mass", 1, -8e4);
        rate(&mut actuator, "actuator.reduced_mass", 2, 3.2e6);
        let ended = actuator.step(0.05);
        negative += u32::from(ended.is_err() && get(&mut actuator, "actuator.reduced_mass") < 0.0);
        let mut bytes = Vec::new();
        actuator.snapshot().write(&mut bytes).unwrap();
        actuator.read_snapshot(&bytes).unwrap();
    }
    assert!(negative > 0, "no step ended there");
}

/// A foresight over one step that fails, as oil without air cavitates, says nothing of a shorter one.
#[test]
fn a_foresight_that_fails_belongs_to_its_step() {
    let mut actuator = model(
        r#"{ "name": "A", "circuit": { "fluid": { "air_fraction": 0 }, "anticavitation": { "conductance": 0 } } }"#,
    );
    set(&mut actuator, "chamber_a.start_pressure", 1e5);
    set(&mut actuator, "chamber_b.start_pressure", 1e5);
    set(&mut actuator, "actuator.reduced_mass", 700.0);
    set(&mut actuator, "actuator.holding_force", -2e5);
    set(&mut actuator, "preview.horizon", 1e-5);
    actuator.initialize().unwrap();
    let mut twin = actuator.clone();
    assert!(actuator.step(0.05).unwrap_err().to_string().contains("absolute pressure"));
    assert_eq!(get(&mut actuator, "preview.force").to_bits(), get(&mut twin, "preview.force").to_bits());
}

/// In the mode delayed the outputs of the next step are told with the last one, whatever is set after it, and a state
/// holds them.
#[test]
fn what_was_told_in_the_mode_delayed_stays() {
    let mut actuator = model(r#"{ "name": "A", "coupling": { "mode": "delayed" } }"#);
    set(&mut actuator, "actuator.reduced_mass", 700.0);
    set(&mut actuator, "actuator.holding_force", 800.0);
    set(&mut actuator, "valve.command", 0.5);
    actuator.initialize().unwrap();
    actuator.step(1e-3).unwrap();
    let names = ["preview.force", "preview.force_rate", "preview.force_mean", "preview.length", "preview.speed"];
    let told = names.map(|name| get(&mut actuator, name).to_bits());
    set(&mut actuator, "actuator.holding_force", -500.0);
    set(&mut actuator, "actuator.speed", 0.1);
    set(&mut actuator, "valve.command", -0.5);
    assert_eq!(names.map(|name| get(&mut actuator, name).to_bits()), told);
    let mut other = model(r#"{ "name": "A", "coupling": { "mode": "delayed" } }"#);
    let mut bytes = Vec::new();
    actuator.snapshot().write(&mut bytes).unwrap();
    let snapshot = other.read_snapshot(&bytes).unwrap();
    other.restore(&snapshot).unwrap();
    assert_eq!(names.map(|name| get(&mut other, name).to_bits()), told);
    for model in [&mut actuator, &mut other] {
        model.step(1e-3).unwrap();
    }
    let ends = [&mut actuator, &mut other].map(|model| names.map(|name| get(model, name).to_bits()));
    assert_eq!(ends[0], ends[1]);
    assert_ne!(ends[0], told);
}
