//! A run needs work only for the quantities that it uses: which tables are built, and how often each quantity is
//! computed.

use crate::support::{GEAR, Run};
use linkage_fmu::integrator::Method;
use linkage_fmu::mechanism::reduced::Built;
use linkage_fmu::mechanism::{Computed, Statistics};

const FRICTION: [(&str, bool); 1] = [("friction.enabled", true)];

/// The gear at its start. The definition is read again, because instances share their tables.
fn gear(flags: &[(&str, bool)], values: &[(&str, f64)]) -> Run {
    Run::new(GEAR).with(flags).with(values).started()
}

/// Tables built and quantities computed in a retraction of ten steps, with these outputs read after each step.
fn cost(flags: &[(&str, bool)], values: &[(&str, f64)], reads: &[&str]) -> (Built, Computed, Statistics) {
    let mut gear = gear(flags, values);
    for _ in 0..10 {
        gear.step(0.013);
        for name in reads {
            gear.get(name);
        }
    }
    let built = gear.reduced().unwrap().built();
    (built, gear.computed(), gear.statistics())
}

/// Displacements of the six loads with energy, and of the two stops: the start needs these tables.
const NOTHING: Built = Built {
    displacements: 8,
    markers: false,
    origins: false,
    reactions: false,
    state_reactions: false,
    state_loads: [false; 2],
};

#[test]
fn a_bare_gear_builds_and_computes_nothing_but_its_motion() {
    let (built, computed, work) = cost(&[], &[], &[]);
    assert_eq!((built, computed), (NOTHING, Computed::default()));
    assert_eq!((work.jacobians, work.newton_iterations, work.accepted_by(Method::Radau)), (0, 0, 0));
    assert_eq!(
        work.accepted,
        work.accepted_by(Method::Rkn86) + work.accepted_by(Method::Rk4),
        "no step by a method that is dearer"
    );
    // Eight evaluations per step, two at the start, and four per trial of a short step.
    assert!(work.evaluations <= 8 * (work.accepted + work.rejected) + 2 + 40, "{work:?}");
}

#[test]
fn coordinates_cost_no_evaluation_and_an_acceleration_one() {
    let (built, computed, work) = cost(&[], &[], &["crank.angle", "crank.speed", "follower.angle"]);
    assert_eq!((built, computed, work), (NOTHING, Computed::default(), cost(&[], &[], &[]).2));
    let reads = &["crank.acceleration", "coupler.acceleration", "follower.acceleration"];
    let (built, computed, _) = cost(&[], &[], reads);
    assert_eq!((built, computed), (NOTHING, Computed { effects: 10, reactions: 0 }));
}

#[test]
fn a_frame_builds_a_table_for_its_origin_only() {
    let (built, computed, work) = cost(&[], &[], &["crank.frame.cos", "crank.frame.sin", "coupler.frame.minus_sin"]);
    assert_eq!((built, computed, work), (NOTHING, Computed::default(), cost(&[], &[], &[]).2));
    let (built, computed, work) = cost(&[], &[], &["crank.frame.x", "coupler.frame.y"]);
    assert_eq!((built, computed), (Built { origins: true, ..NOTHING }, Computed::default()));
    assert_eq!(work, cost(&[], &[], &[]).2);
}

#[test]
fn reactions_of_four_joints_cost_one_computation() {
    let reads = &["joint2.force_x", "joint2.force_y", "joint2.force", "joint3.force", "joint3.force"];
    let (built, computed, work) = cost(&[], &[], reads);
    assert_eq!(built, Built { reactions: true, ..NOTHING });
    assert_eq!(computed, Computed { effects: 10, reactions: 10 });
    assert_eq!(work, cost(&[], &[], &[]).2, "the motion does not know");
}

#[test]
fn markers_cost_their_table() {
    let (built, computed, _) = cost(&[], &[], &["wheel.x", "wheel.y"]);
    assert_eq!((built, computed), (Built { markers: true, ..NOTHING }, Computed::default()));
}

#[test]
fn friction_drag_and_bumpers_cost_their_loads_alone() {
    let (built, computed, work) = cost(&FRICTION, &[], &[]);
    assert_eq!((built, computed), (Built { state_loads: [true, false], ..NOTHING }, Computed::default()));
    assert_eq!(work.accepted_by(Method::Rkn86), 0);
    assert!(work.jacobians <= 1, "only to see at the start whether it is stiff: {work:?}");
    let (built, computed, work) = cost(&[], &[("airspeed", 70.0)], &[]);
    assert_eq!((built, computed), (Built { state_loads: [false, true], ..NOTHING }, Computed::default()));
    assert!(work.jacobians <= 1 && work.accepted_by(Method::Rkn86) == 0);
    let (built, computed, _) = cost(&[("upstop.rigid", false)], &[], &[]);
    assert_eq!((built, computed), (Built { state_loads: [true, false], ..NOTHING }, Computed::default()));
    // The default gear contains friction, locks and drag, but switched off: they need no work.
}

/// During the retraction a pin of the gear changes the regime of its law eight times. The step ends there on its
/// interpolant: three evaluations for the interpolant, and one to continue.
#[test]
fn a_change_of_regime_costs_no_second_step() {
    let mut model = gear(&FRICTION, &[]);
    model.step(0.13);
    let work = model.statistics();
    // A step that ends just beyond a change may be short enough for DOPRI5, whose interpolant is as accurate as its
    // step.
    let [cheaper, others] = [Method::Dopri5, Method::Dop853].map(|method| work.accepted_by(method));
    assert!(cheaper <= 1 && cheaper + others == work.accepted, "steps of other methods: {work:?}");
    // The start, and interpolants of steps that come near a border.
    let constant = 12;
    assert!(work.evaluations <= 12 * (work.accepted + work.rejected) + 4 * 8 + constant, "{work:?}");
}

#[test]
fn rest_costs_no_evaluation() {
    let mut model = gear(&[], &[]);
    model.step(0.2);
    let before = model.statistics();
    for _ in 0..1000 {
        model.step(0.1);
    }
    assert_eq!(model.statistics(), before);
}

#[test]
fn instances_of_one_model_share_its_tables() {
    let mut one = gear(&[], &[]);
    let mut other = one.clone();
    one.get("joint1.force");
    assert!(other.reduced().unwrap().built().reactions);
}
