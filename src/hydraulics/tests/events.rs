//! Events of an actuator: steps end there, at the times of closed forms.
use super::*;

/// Runs to a time in steps of size h; the events on the way, with their times.
fn run(actuator: &mut Model, end: f64, h: f64) -> Vec<(f64, String)> {
    let (mut time, mut events) = (0.0, Vec::new());
    while time < end - 1e-9 {
        let step = h.min(end - time);
        let reached = actuator.step_to_event(step).unwrap().unwrap_or(step);
        if let Some((within, words)) = actuator.take_event() {
            assert_eq!(within, reached);
            events.push((time + within, words));
            actuator.handle_event();
        }
        time += reached;
    }
    events
}

fn started(values: &[(&str, f64)]) -> Model {
    let mut actuator = model(ACTUATOR);
    set(&mut actuator, "solver.tolerance", 1e-12);
    values.iter().for_each(|(name, value)| set(&mut actuator, name, *value));
    actuator.initialize().unwrap();
    actuator
}

/// A given motion of constant speed passes the border of the cushion; the spool, critically damped, passes its edge.
#[test]
fn steps_end_at_a_cushion_and_at_an_edge() {
    for h in [1e-3, 0.02, 1.0] {
        let mut actuator = started(&[
            ("actuator.length", 0.43),
            ("actuator.speed", 0.05),
            ("valve.damping_ratio", 1.0),
            ("valve.overlap", 0.1),
            ("valve.command", 0.4),
        ]);
        let events = run(&mut actuator, 1.0, h);
        let named = |part: &str| events.iter().filter(|(_, words)| words.contains(part)).collect::<Vec<_>>();
        // y = u (1 - (1 + w t) exp(-w t)).
        let (omega, mut low, mut high) = (std::f64::consts::TAU * 60.0, 0.0, 0.1);
        for _ in 0..100 {
            let t = 0.5 * (low + high);
            let y: f64 = 0.4 * (1.0 - (1.0 + omega * t) * (-omega * t).exp());
            if y < 0.1 { low = t } else { high = t }
        }
        let edge = named("at valve.overlap");
        assert!(edge.len() == 1 && (edge[0].0 - low).abs() < 1e-10, "{h}: {edge:?} {low}");
        let cushion = named("cushion_a");
        assert!(cushion.len() == 1 && (cushion[0].0 - 0.012 / 0.05).abs() < 1e-12, "{h}: {cushion:?}");
    }
}

/// The pressure is that of the relief where the step ends, and the events are the same whatever the steps.
#[test]
fn steps_end_where_a_relief_opens() {
    let times = [1e-3, 0.05].map(|h| {
        let mut actuator = started(&[("actuator.length", 0.6), ("actuator.speed", -0.1), ("valve.command", 0.02)]);
        let mut time = 0.0;
        loop {
            let reached = actuator.step_to_event(h).unwrap().unwrap_or(h);
            time += reached;
            if actuator.take_event().is_some_and(|(_, words)| words.contains("chamber_a.pressure")) {
                break;
            }
            assert!(time < 1.0);
        }
        let p = get(&mut actuator, "chamber_a.pressure");
        assert!((p - 28e6).abs() < 1e-2, "{h}: {p}");
        time
    });
    assert!((times[0] - times[1]).abs() < 1e-10, "{times:?}");
}

/// A mass that the actuator moves reaches the end of the cylinder, and one with event mode moves as one without.
#[test]
fn steps_end_at_the_end_of_the_travel() {
    let values = [
        ("actuator.length", 0.738),
        ("valve.command", 0.7),
        ("actuator.reduced_mass", 700.0),
        ("actuator.holding_force", 1500.0),
        ("cushion_b.length", 0.0),
    ];
    let times = [1e-3, 5e-3, 0.2].map(|h| {
        let events = run(&mut started(&values), 0.2, h);
        let ends: Vec<_> = events.iter().filter(|(_, words)| words.contains("end of its travel")).collect();
        assert_eq!(ends.len(), 1, "{h}: {events:?}");
        ends[0].0
    });
    // Own steps move the same mass.
    assert!(times.iter().all(|time| (time - times[2]).abs() < 1e-9), "{times:?}");
    let lengths = [true, false].map(|watches| {
        let mut actuator = started(&values);
        if watches {
            run(&mut actuator, 0.1, 5e-3);
        } else {
            (0..20).for_each(|_| actuator.step(5e-3).unwrap());
        }
        get(&mut actuator, "actuator.length")
    });
    assert!((lengths[0] - lengths[1]).abs() < 1e-12, "{lengths:?}");
}
