//! Contact of the piston with the rigid ends of its cylinder. The gear has no stop at these positions.
use super::*;

/// The retraction in a cylinder whose stroke ends before the gear is fully up.
fn extension() -> Scene {
    let mut scene = retraction();
    scene.start.push(Set::Switch("upstop.enabled", false));
    scene.start.push(Set::Circuit("cylinder.stroke", 0.31));
    scene
}

/// The actuator moves the gear from between its stops to the retracted end of the cylinder.
fn contraction() -> Scene {
    let start = vec![
        Set::Switch("downstop.enabled", false),
        Set::Gear("crank.start_angle", 0.5),
        Set::Circuit("cylinder.closed_length", 0.43),
        Set::Circuit("command.ramp_amplitude", -0.65),
        Set::Circuit("command.ramp_time", 0.1),
    ];
    Scene { start, ..retraction() }
}

/// At rest at an end of the cylinder, oil force, end force and angle agree with the single system for every step size.
#[test]
fn a_load_at_rest_on_an_end_is_that_of_one_system() {
    for (scene, sign) in [(extension(), -1.0), (contraction(), 1.0)] {
        let scene = Scene { end: 6.0, sample: 6.0, ..scene };
        let [[_, angle, force, _, end]] = one_system(&scene)[..] else { panic!("one row") };
        assert!(sign * end > 1e4, "{force} {end}");
        for (host, h) in HOSTS.into_iter().flat_map(|host| [2e-3, 1e-2, 5e-2].map(|h| (host, h))) {
            let rows = pair(&scene, host, &|_| h, true);
            let [[_, own_angle, own_force, _, own_end]] = rows[..] else { panic!("one row") };
            assert!((own_angle - angle).abs() < 1e-13, "{host:?} {h}: {own_angle} rad is not {angle} rad");
            assert!((own_force / force - 1.0).abs() < 1e-9, "{host:?} {h}: {own_force} N is not {force} N");
            assert!((own_end / end - 1.0).abs() < 1e-9, "{host:?} {h}: {own_end} N is not {end} N");
        }
    }
}

/// The piston reaches the end and leaves it when the command reverses. The error is as small as in a free motion, with
/// and without a cushion, and after a rebound.
#[test]
fn an_end_is_reached_and_left_as_in_one_system() {
    for (cushion, restitution) in [(0.03, 0.0), (0.0, 0.0), (0.0, 0.5)] {
        let mut scene = extension();
        scene.start.push(Set::Circuit("cushion_b.length", cushion));
        scene.start.push(Set::Circuit("cylinder.restitution", restitution));
        let later = vec![(4.6, Set::Circuit("valve.command", -1.3))];
        let scene = Scene { later, end: 5.2, sample: 0.1, ..scene };
        assert_near_one(
            &format!("end {cushion} {restitution}"),
            &scene,
            &[
                (Host::Held, &[(1e-3, 1e-5), (2e-2, 4e-3)]),
                (Host::Line, &[(1e-3, 1e-7), (2e-2, 3e-5)]),
                (Host::TwoPasses, &[(1e-3, 1e-8), (2e-2, 2e-5)]),
                (Host::Late, &[(1e-3, 1e-5), (5e-3, 3e-4)]),
            ],
        );
    }
}

/// Step sizes that change without an announced horizon (`preview.horizon` = 0) do not change the rest at the end.
#[test]
fn steps_may_change_at_an_end() {
    let scene = Scene { end: 6.0, sample: 6.0, ..extension() };
    let [[_, angle, _, _, end]] = one_system(&scene)[..] else { panic!("one row") };
    for host in [Host::Held, Host::Line, Host::Late] {
        let rows = pair(&scene, host, &|k| [1e-3, 2e-2, 2.5e-4, 5e-3][k % 4], false);
        let [[_, own_angle, _, _, own_end]] = rows[..] else { panic!("one row") };
        println!("changing steps at an end {host:?}: {:.1e} rad", own_angle - angle);
        assert!((own_angle - angle).abs() < 1e-9, "{host:?}: {own_angle} rad is not {angle} rad");
        assert!((own_end / end - 1.0).abs() < 1e-6, "{host:?}: {own_end} N is not {end} N");
    }
}

/// A mean force that is held stops the mechanism one step late. The mechanism then overruns the end by less than its
/// motion in this step, wherever in the step the piston reaches the end.
#[test]
fn a_fast_mechanism_may_be_past_an_end_by_its_way_in_a_step() {
    for k in (0..20).step_by(3) {
        let mut scene = extension();
        scene.start.push(Set::Circuit("cylinder.stroke", 0.3 + 1e-4 * f64::from(k)));
        scene.start.push(Set::Circuit("cushion_b.length", 0.0));
        scene.start.push(Set::Circuit("restrictor_a.rated_flow", 0.0));
        scene.start.push(Set::Circuit("restrictor_b.rated_flow", 0.0));
        scene.start.push(Set::Circuit("valve.rated_flow", 3e-4));
        pair(&Scene { end: 4.0, sample: 4.0, ..scene }, Host::Held, &|_| 2e-2, true);
    }
}
