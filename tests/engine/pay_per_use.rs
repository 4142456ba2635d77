//! A scene pays for what is in it: which tables are built, and how often each quantity is computed.

use linkage_fmu::mechanism::reduced::Built;
use linkage_fmu::mechanism::{Computed, Model, Statistics};

const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");

struct StateLoads {
    name: &'static str,
    flags: &'static [(&'static str, bool)],
    values: &'static [(&'static str, f64)],
    /// Read after each step.
    reads: &'static [&'static str],
}

const BARE: StateLoads = StateLoads { name: "bare", flags: &[], values: &[], reads: &[] };

fn gear(scene: &StateLoads) -> Model {
    let mut model = Model::from_json(GEAR).unwrap();
    for (name, value) in scene.flags {
        let reference = model.variables().find(name).unwrap();
        model.set_boolean(reference, *value).unwrap();
    }
    for (name, value) in scene.values {
        let reference = model.variables().find(name).unwrap();
        model.set_real(reference, *value).unwrap();
    }
    model.initialize().unwrap();
    model
}

/// What a retraction in ten steps builds and computes.
fn cost(scene: &StateLoads) -> (Built, Computed, Statistics) {
    let mut model = gear(scene);
    let reads: Vec<_> = scene.reads.iter().map(|name| model.variables().find(name).unwrap()).collect();
    for _ in 0..10 {
        model.step(0.013).unwrap();
        for reference in &reads {
            model.real(*reference).unwrap();
        }
    }
    let built = model.reduced().unwrap().built();
    println!("{}: {:?} {:?} {:?}", scene.name, built, model.computed(), model.statistics());
    (built, model.computed(), model.statistics())
}

/// Displacements of the six loads with energy, and of the two stops: the start needs them.
const NOTHING: Built =
    Built { displacements: 8, markers: false, reactions: false, state_reactions: false, scenes: [false; 2] };

#[test]
fn a_bare_scene_builds_and_computes_nothing_but_its_motion() {
    let (built, computed, work) = cost(&BARE);
    assert_eq!((built, computed), (NOTHING, Computed::default()));
    assert_eq!((work.jacobians, work.newton_iterations, work.implicit), (0, 0, 0));
    assert_eq!(work.accepted, work.nystroem + work.short, "no step by a method that is dearer");
    // Eight a step, the start's two, and four for each trial of a short step.
    assert!(work.evaluations <= 8 * (work.accepted + work.rejected) + 2 + 40, "{work:?}");
}

#[test]
fn coordinates_cost_no_evaluation_and_an_acceleration_one() {
    let angles = StateLoads { name: "angles", reads: &["crank.angle", "crank.speed", "follower.angle"], ..BARE };
    let (built, computed, work) = cost(&angles);
    assert_eq!((built, computed, work), (NOTHING, Computed::default(), cost(&BARE).2));
    let reads = &["crank.acceleration", "coupler.acceleration", "follower.acceleration"];
    let (built, computed, _) = cost(&StateLoads { name: "accelerations", reads, ..BARE });
    assert_eq!((built, computed), (NOTHING, Computed { effects: 10, reactions: 0 }));
}

#[test]
fn reactions_cost_one_computation_for_each_joint_that_is_read() {
    let reads = &["joint2.force_x", "joint2.force_y", "joint2.force", "joint3.force", "joint3.force"];
    let (built, computed, work) = cost(&StateLoads { name: "reactions", reads, ..BARE });
    assert_eq!(built, Built { reactions: true, ..NOTHING });
    assert_eq!(computed, Computed { effects: 10, reactions: 20 });
    assert_eq!(work, cost(&BARE).2, "the motion does not know");
}

#[test]
fn markers_cost_their_table() {
    let (built, computed, _) = cost(&StateLoads { name: "marker", reads: &["wheel.x", "wheel.y"], ..BARE });
    assert_eq!((built, computed), (Built { markers: true, ..NOTHING }, Computed::default()));
}

#[test]
fn friction_drag_and_bumpers_cost_their_scene_alone() {
    let friction = StateLoads { name: "friction", flags: &[("friction.enabled", true)], ..BARE };
    let (built, computed, work) = cost(&friction);
    assert_eq!((built, computed), (Built { scenes: [true, false], ..NOTHING }, Computed::default()));
    assert_eq!(work.nystroem, 0);
    assert!(work.jacobians <= 1, "only to see at the start whether it is stiff: {work:?}");
    let drag = StateLoads { name: "drag", values: &[("airspeed", 70.0)], ..BARE };
    let (built, computed, work) = cost(&drag);
    assert_eq!((built, computed), (Built { scenes: [false, true], ..NOTHING }, Computed::default()));
    assert!(work.jacobians <= 1 && work.nystroem == 0);
    let bumper = StateLoads { name: "bumper", flags: &[("upstop.rigid", false)], ..BARE };
    let (built, computed, _) = cost(&bumper);
    assert_eq!((built, computed), (Built { scenes: [true, false], ..NOTHING }, Computed::default()));
    // Drag that does not blow, and friction and locks that are there but off, cost nothing: the default gear has them.
}

/// Eight times on its way a pin of the gear comes to another stretch of its law. The step is ended there on the interpolant: three
/// evaluations for it, one to go on from there.
#[test]
fn a_change_of_stretch_costs_no_second_step() {
    let mut model = gear(&StateLoads { name: "friction", flags: &[("friction.enabled", true)], ..BARE });
    model.step(0.13).unwrap();
    let work = model.statistics();
    assert_eq!((work.short, work.fifth, work.implicit), (0, 0, 0), "steps of DOP853 alone");
    // The start, and interpolants over steps that come near to a border.
    let besides = 12;
    assert!(work.evaluations <= 12 * (work.accepted + work.rejected) + 4 * 8 + besides, "{work:?}");
}

#[test]
fn rest_costs_no_evaluation() {
    let mut model = gear(&BARE);
    model.step(0.2).unwrap();
    let before = model.statistics();
    for _ in 0..1000 {
        model.step(0.1).unwrap();
    }
    assert_eq!(model.statistics(), before);
}

#[test]
fn instances_of_one_model_share_its_tables() {
    let mut one = gear(&BARE);
    let mut other = one.clone();
    let force = one.variables().find("joint1.force").unwrap();
    one.real(force).unwrap();
    assert!(other.reduced().unwrap().built().reactions);
}
