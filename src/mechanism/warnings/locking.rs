//! Warnings about gears that are to lock themselves and do not.
//!
//! In: a definition and its reduced model. Out: warnings. It must not know states.
use crate::inspection::Finding;
use crate::mechanism::definition::Mechanism;
use crate::mechanism::loads::resolved::FrictionKind;
use crate::mechanism::reactions::columns;
use crate::mechanism::reduced::Reduced;

/// Least part of a torque on the second body that the inertia of the first body's side takes.
const LEAST: f64 = 1e-6;

/// Warn of couplings that lock themselves without an inertia at their first bodies: they transmit no force to what a
/// load on the second body does, so that no loss holds the load.
pub(super) fn warn_of_locking(mechanism: &Mechanism, reduced: &Reduced, all: &mut Vec<Finding>) {
    let (linkage, loading) = (reduced.linkage(), reduced.loading());
    let losses = loading.friction.iter().flat_map(|friction| &friction.friction_joints);
    for loss in losses.filter(|loss| loss.kind == FrictionKind::Coupling) {
        let name = &linkage.joints[loss.joint].name;
        let defined = mechanism.couplings.get(name);
        if defined.is_none_or(|coupling| coupling.backward_efficiency != Some(0.0)) {
            continue;
        }
        let (c, load) = (reduced.curve().configuration(0.0), &loading.loads[loss.load]);
        let terms = columns(&reduced.curve().closure, &c, std::slice::from_ref(load));
        let transmitted = terms[2][loss.joint].moment + terms[0][loss.joint].moment * load.influence(linkage, &c);
        if -transmitted * loss.radius < LEAST {
            let message = "neither the first body of this coupling nor a body that turns with the first body has a \
                           moment of inertia, so this coupling transmits no force and does not hold a load on the \
                           second body";
            let remedy = "give the first body of the coupling an inertia";
            all.push(Finding::warning(format_args!("couplings.{name}.backward_efficiency"), message, remedy));
        }
    }
}
