//! Losses of couplings: friction that the forces on their second bodies cause, with another coefficient where power
//! flows back.
//!
//! In: the friction loop with its arms, the state loads, the balance. Out: the solution with the flow of power that
//! belongs to it. It must not know laws.
use crate::mechanism::loads::friction_loop::{Balance, FrictionLoop, Locked};
use crate::mechanism::loads::resolved::FrictionJoint;
use crate::mechanism::reduced::StateLoads;
use crate::numerics::dual::Number;

/// Solve the friction loop at a time t [s] of a step, with arms that are those of power that flows forward in
/// couplings.
#[inline(always)]
pub(super) fn solve<T: Number>(
    friction: &mut FrictionLoop<T>,
    state_loads: &StateLoads,
    t: f64,
    balance: &Balance<T>,
) -> Result<(), Locked> {
    if state_loads.loses { solve_with_losses(friction, state_loads, balance) } else { friction.solve_at(t, balance) }
}

/// Make the arms those of power that flows forward again, after a solution.
pub(super) fn turn_forward<T: Number>(friction: &mut FrictionLoop<T>, state_loads: &StateLoads) {
    for (j, joint) in state_loads.friction_joints.iter().enumerate() {
        if std::mem::take(&mut friction.flows_back[j]) {
            friction.arm[j] = friction.arm[j] * T::constant(1.0 / joint.back);
        }
    }
}

/// Solve the friction loop where couplings have losses. In each of them power flows forward or back by the sign of the
/// force on its second body, held or that of the solution: it is taken as without losses first, and where the solution
/// has the other sign the flow is turned round.
#[cold]
#[inline(never)]
fn solve_with_losses<T: Number>(
    friction: &mut FrictionLoop<T>,
    state_loads: &StateLoads,
    balance: &Balance<T>,
) -> Result<(), Locked> {
    let couplings = || state_loads.friction_joints.iter().enumerate().filter(|(_, joint)| joint.is_loss());
    for (j, joint) in couplings() {
        let held = friction.sign[j];
        let force = if held == 0.0 { balance.free[0][j].value() } else { held };
        friction.flows_back[j] = force * friction.arm[j].value() < 0.0;
        if friction.flows_back[j] {
            friction.arm[j] = friction.arm[j] * T::constant(joint.back);
        }
    }
    for _ in 0..=2 * state_loads.friction_joints.len() {
        friction.solve(balance)?;
        let is_wrong = |(j, _): &(usize, &FrictionJoint)| {
            let flows_back = friction.normal_force(*j) * friction.arm[*j].value() < 0.0;
            let has_sign = friction.sign[*j] == 0.0 && friction.size[*j].value() != 0.0;
            has_sign && flows_back != friction.flows_back[*j]
        };
        let Some((j, joint)) = couplings().find(is_wrong) else { return Ok(()) };
        let factor = if friction.flows_back[j] { 1.0 / joint.back } else { joint.back };
        friction.arm[j] = friction.arm[j] * T::constant(factor);
        friction.flows_back[j] = !friction.flows_back[j];
    }
    Err(Locked)
}
