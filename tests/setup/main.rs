//! Cost of the set-up of the gear, as counts that are equal on every machine: closed positions, panels of the tables,
//! allocations. Also the parts of the reduced model that stay unchanged when a parameter changes.
#![allow(clippy::unwrap_used)]

#[path = "../support/counting.rs"]
mod counting;
mod size;

use linkage_fmu::mechanism::Model;
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::interface;
use linkage_fmu::mechanism::reduced::Reduced;
use linkage_fmu::numerics::chebyshev::NODES;

const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");
const CHAIN: &str = include_str!("../../modelDescription/FourBarChain/resources/mechanism.json");
const CRANE: &str = include_str!("../../modelDescription/CraneJib/resources/mechanism.json");

/// Result and number of allocations of a call.
fn allocations<T>(call: impl FnOnce() -> T) -> (T, usize) {
    let before = counting::allocations();
    let given = call();
    (given, counting::allocations() - before)
}

#[test]
fn the_curve_closes_few_positions() {
    let curve = Reduced::trace(&Mechanism::from_json(GEAR).unwrap()).unwrap();
    // 14 panels, including rejected ones, each with its nodes and its end.
    assert!(curve.closed <= 14 * (NODES + 1), "{} positions", curve.closed);
}

/// Two crossings with one bridge each: the panels next to the bridges are as long as others.
#[test]
fn the_curve_over_crossings_closes_few_positions() {
    let curve = Reduced::trace(&Mechanism::from_json(CHAIN).unwrap()).unwrap();
    assert_eq!(curve.crossings.len(), 2);
    // 10 panels besides the bridges, 2 rejected panels, the nodes of 2 bridges, and as many positions before each
    // bridge.
    assert!(curve.closed <= 12 * (NODES + 1) + 2 * 2 * NODES + 50, "{} positions", curve.closed);
}

#[test]
fn the_tables_have_few_panels() {
    let reduced = Reduced::new(&Mechanism::from_json(GEAR).unwrap()).unwrap();
    for table in [reduced.influence(), reduced.coordinates().unwrap()] {
        assert!(table.panels() <= 22, "{} panels", table.panels());
    }
}

/// Names and descriptions are built once, for the table of variables: two texts per variable, and few others.
#[test]
fn texts_are_created_once() {
    let mechanism = Mechanism::from_json(GEAR).unwrap();
    let (variables, count) = allocations(|| interface::variables(&mechanism).unwrap());
    let most = 10 * variables.list().len();
    assert!(count <= most, "{count} allocations, more than {most}");
}

#[test]
fn instantiation_allocates_little() {
    let (_, count) = allocations(|| {
        let mut gear = Model::from_json(GEAR).unwrap();
        gear.initialize().unwrap();
        gear
    });
    assert!(count <= 2600, "{count} allocations");
}

/// Whether all tables are identical.
fn same_tables(a: &Reduced, b: &Reduced) -> bool {
    let loading = a.loading();
    a.influence() == b.influence()
        && a.coordinates() == b.coordinates()
        && a.curve().range == b.curve().range
        && (0..loading.loads.len()).all(|load| a.displacement(load) == b.displacement(load))
        && a.reaction_tables() == b.reaction_tables()
}

/// For each parameter: the renewed reduced model equals a model built from the changed definition.
fn check_renewal(text: &str) {
    let stated = Mechanism::from_json(text).unwrap();
    let reduced = Reduced::new(&stated).unwrap();
    let (mut parameters, mut flags) = (Vec::new(), 0);
    stated.clone().parameters(&mut |p, _| parameters.push(p.name.concat()));
    stated.clone().flags(&mut |_, _| flags += 1);
    let compare =
        |name: &str, changed: &Mechanism| match (Reduced::renewed(&[&reduced], changed), Reduced::new(changed)) {
            (Ok(renewed), Ok(new)) => {
                assert!(same_tables(&renewed, &new), "{name}");
                assert_eq!(renewed.loading(), new.loading(), "{name}");
                assert_eq!(renewed.components(), new.components(), "{name}");
            }
            (renewed, new) => assert_eq!(renewed.err(), new.err(), "{name}"),
        };
    for name in &parameters {
        let mut changed = stated.clone();
        changed.parameters(&mut |p, value| {
            if p.name.concat() == *name {
                *value = *value * 0.999 + 1e-4;
            }
        });
        compare(name, &changed);
    }
    for index in 0..flags {
        let mut changed = stated.clone();
        let mut indexes = 0..;
        changed.flags(&mut |_, value| *value ^= indexes.next() == Some(index));
        compare(&format!("Boolean parameter {index}"), &changed);
    }
}

#[test]
fn a_reset_model_is_bit_identical_to_a_new_one() {
    check_renewal(GEAR);
    check_renewal(CRANE);
}

/// Parameters of the friction law change neither the curve nor the tables.
#[test]
fn a_changed_law_does_not_rebuild_curve_and_tables() {
    let mut mechanism = Mechanism::from_json(GEAR).unwrap();
    let reduced = Reduced::new(&mechanism).unwrap();
    mechanism.flags(&mut |flag, value| *value |= flag.name.concat() == "friction.enabled");
    let (renewed, count) = allocations(|| Reduced::renewed(&[&reduced], &mechanism).unwrap());
    assert!(std::ptr::eq(reduced.curve(), renewed.curve()));
    assert!(std::ptr::eq(reduced.influence(), renewed.influence()));
    assert!(count <= 100, "{count} allocations");
}

/// Nor do they change the table of the state loads: pins and coefficients only scale its values.
#[test]
fn a_changed_law_does_not_rebuild_the_table_of_friction() {
    let mut mechanism = Mechanism::from_json(GEAR).unwrap();
    mechanism.flags(&mut |flag, value| *value |= flag.name.concat() == "friction.enabled");
    let reduced = Reduced::new(&mechanism).unwrap();
    let table = &reduced.state_loads(false).unwrap().unwrap().table;
    let mut changed = mechanism.clone();
    changed.parameters(&mut |p, value| {
        if ["friction.static_coefficient", "joint1.pin_radius"].contains(&&*p.name.concat()) {
            *value *= 1.1;
        }
    });
    let renewed = Reduced::renewed(&[&reduced], &changed).unwrap();
    // A renewed model in between, whose table has not been read.
    let again = Reduced::renewed(&[&renewed], &mechanism).unwrap();
    let new = Reduced::new(&changed).unwrap();
    let [renewed, again, new] = [&renewed, &again, &new].map(|reduced| reduced.state_loads(false).unwrap().unwrap());
    assert!(std::ptr::eq(&**table, &*renewed.table) && std::ptr::eq(&**table, &*again.table));
    assert_eq!(*renewed.table, *new.table);
    assert_eq!(renewed.friction_joints, new.friction_joints);
    assert_ne!(renewed.friction_joints, again.friction_joints);
    // A joint without a pin has no friction.
    let mut more = mechanism.clone();
    more.parameters(&mut |p, value| *value *= f64::from(p.name.concat() != "joint1.pin_radius"));
    let (kept, built) = (Reduced::renewed(&[&reduced], &more).unwrap(), Reduced::new(&more).unwrap());
    let [kept, built] = [&kept, &built].map(|reduced| reduced.state_loads(false).unwrap().unwrap());
    assert_eq!((&*kept.table, &kept.friction_joints), (&*built.table, &built.friction_joints));
}

/// Another gravity changes only the sum of existing tables.
#[test]
fn changed_gravity_rebuilds_neither_curve_nor_most_tables() {
    let mut mechanism = Mechanism::from_json(GEAR).unwrap();
    let reduced = Reduced::new(&mechanism).unwrap();
    mechanism.gravity.as_mut().unwrap().acceleration *= 0.5;
    let (renewed, count) = allocations(|| Reduced::renewed(&[&reduced], &mechanism).unwrap());
    assert!(std::ptr::eq(reduced.curve(), renewed.curve()));
    assert_ne!(reduced.influence(), renewed.influence());
    assert!(count <= 151, "{count} allocations");
}

/// An initialisation with other inputs, also with friction, reuses the memory of the state and is bit-identical to a
/// new model.
#[test]
fn another_initialisation_allocates_nothing() {
    for friction in [false, true] {
        let mut gear = Model::from_json(GEAR).unwrap();
        let [enabled, force, factor, angle, drift, bearing] =
            ["friction.enabled", "actuator.force", "load_factor", "crank.angle", "energy.drift", "joint1.force"]
                .map(|name| gear.variables().find(name).unwrap());
        gear.set_boolean(enabled, friction).unwrap();
        let run = |gear: &mut Model, case: u32| {
            gear.set_real(force, 3e4 + 1e3 * f64::from(case)).unwrap();
            gear.set_real(factor, 3.0 - 0.5 * f64::from(case)).unwrap();
            let (_, count) = allocations(|| gear.initialize().unwrap());
            let mut values = vec![gear.statistics().evaluations];
            for h in [0.01, 0.02, 0.2, 1e-3, 1e-3, 1e-3, 1e-3] {
                gear.step(h).unwrap();
                values.extend([angle, drift, bearing].map(|reference| gear.real(reference).unwrap().to_bits()));
            }
            values.push(gear.statistics().evaluations);
            (values, count)
        };
        let mut fresh = gear.clone();
        run(&mut gear, 0);
        for case in 1..4 {
            let (values, count) = run(&mut gear, case);
            assert_eq!(count, 0, "friction {friction}, case {case}");
            assert_eq!(values, run(&mut fresh.clone(), case).0, "friction {friction}, case {case}");
        }
        // A failed run leaves no trace.
        assert!(gear.step(f64::NAN).is_err());
        gear.set_real(force, 1e300).unwrap();
        assert!(gear.initialize().is_err() || gear.step(1.0).is_err());
        assert_eq!(run(&mut gear, 2).0, run(&mut fresh, 2).0, "friction {friction}");
    }
}

/// After a reset nothing that follows from the parameters is computed again: no start, no travel, no warnings. The same
/// holds for parameters that the model had before, for any number of tables.
#[test]
fn a_reset_allocates_the_state_alone() {
    let mut gear = Model::from_json(GEAR).unwrap();
    let [gravity, tolerance, friction] = ["gravity.acceleration", "solver.tolerance", "friction.enabled"]
        .map(|name| gear.variables().find(name).unwrap());
    // The vectors of a state and of the cache of its outputs, then the values of changed parameters. With friction also
    // those of the friction loops.
    type Change<'a> = &'a dyn Fn(&mut Model);
    let set_ups: [(Change, usize); 4] = [
        (&|_| {}, 36),
        (&|gear| gear.set_real(gravity, 9.8).unwrap(), 40),
        (&|gear| gear.set_real(tolerance, 1e-8).unwrap(), 40),
        (&|gear| gear.set_boolean(friction, true).unwrap(), 95),
    ];
    for (which, (set_up, most)) in set_ups.into_iter().enumerate() {
        let mut count = 0;
        for _ in 0..2 {
            (_, count) = allocations(|| {
                gear.reset();
                set_up(&mut gear);
                gear.initialize().unwrap();
            });
        }
        assert!(count <= most, "set-up {which}: {count} allocations");
    }
}
