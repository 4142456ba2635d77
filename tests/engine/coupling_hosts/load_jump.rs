//! A jump of the load in hosts that pass every value one step late, against a bound that holds for every actuator FMU.
//!
//! The force of the first steps after the jump is computed before the actuator FMU knows of the jump. These are two
//! steps if the host reads the outputs of the gear before it sets the load, one step if it reads them afterwards. In
//! these steps the gear moves under the force of a run without the jump, as a free mass under the change of the load.
//! The bound follows from the change of the acceleration, and from two runs of the single system, with and without the
//! jump. No coupling is involved.
use super::*;

/// Deviation of a run of the single system with the jump from one without it at the end of a step: of the angle [rad],
/// and of the force [N]; and of the angle if the force has not reacted.
struct Deviation {
    angle: f64,
    force: f64,
    unanswered: f64,
}

const LEVER: &str = "wheel.force_x";

fn jump_of_load(sample: f64) -> Scene {
    Scene { later: vec![(1.0, Set::Gear(LEVER, 1000.0))], end: 1.5, sample, ..retraction() }
}

fn deviations(h: f64) -> Vec<Deviation> {
    let mut whole = one_at_start(&retraction());
    whole.0.step(1.0).unwrap();
    let before = whole.get("crank.acceleration");
    whole.set(LEVER, 1000.0);
    let acceleration = whole.get("crank.acceleration") - before;
    let calm = one_system(&Scene { later: Vec::new(), ..jump_of_load(h) });
    let rows = one_system(&jump_of_load(h)).into_iter().zip(calm);
    rows.map(|([time, angle, force, ..], [_, angle_before, force_before, ..])| Deviation {
        angle: angle - angle_before,
        force: force - force_before,
        unanswered: 0.5 * acceleration * (time - 1.0).max(0.0).powi(2),
    })
    .collect()
}

/// Angle and force have the least errors that an actuator FMU can have: until the force reacts, those of the bound. Two
/// steps later they are those of a host in order.
#[test]
fn a_jump_of_the_load_in_a_late_host_is_followed_as_well_as_any_actuator_can() {
    for h in [1e-3, 2e-3, 5e-3, 1e-2] {
        let scene = jump_of_load(h);
        let (of_one, deviations) = (one_system(&scene), deviations(h));
        let start = (1.0 / h).round() as usize - 1;
        let errors = |host: Host, from: usize, to: usize| {
            differences(&pair(&scene, host, &|_| h, true)[start + from..start + to], &of_one[start + from..start + to])
        };
        let last = of_one.len() - start;
        let [in_order, _] = errors(Host::Held, 0, last);
        let most_force = deviations.iter().fold(0.0_f64, |most, deviation| most.max(deviation.force.abs()));
        // 2 % in steps of 10 ms.
        let left = 2.0 * h * most_force;
        for (host, late) in [(Host::Late, 2), (Host::LateFed, 1)] {
            let unanswered = &deviations[start + late];
            let angle_bound = (unanswered.unanswered - unanswered.angle).abs();
            let force_bound = deviations[start + late - 1].force.abs();
            let [angle, force] = errors(host, 0, late + 2);
            let [angle_after, force_after] = errors(host, late + 2, last);
            println!(
                "{host:?} {h}: {angle:.2e} rad ({angle_bound:.2e}), {force:.1} N ({force_bound:.1}); \
                 then {angle_after:.2e} rad ({in_order:.2e}), {force_after:.2} N of {most_force:.0} N"
            );
            assert!(angle < 1.05 * angle_bound + in_order, "{host:?} {h}: {angle:e} rad, not {angle_bound:e} rad");
            assert!(force < 1.05 * force_bound + left, "{host:?} {h}: {force} N, not {force_bound} N");
            assert!(angle_after < 1.05 * in_order, "{host:?} {h}: {angle_after:e} rad, not {in_order:e} rad");
            assert!(force_after < left, "{host:?} {h}: {force_after} N of {most_force} N");
        }
    }
}
