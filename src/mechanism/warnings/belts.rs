//! Warnings about belts: pulleys that overlap, spans that are slack.
//!
//! In: the couplings of a linkage, the force that a belt transmits. Out: warnings. It must not know states.
use crate::inspection::Finding;
use crate::mechanism::linkage::{Kind, Linkage};
use crate::numerics::decimal::Decimal;

/// Part of the distance of the centres by which pulleys that touch may overlap by rounding.
const TOUCHING: f64 = 1e-9;

/// Warn of open belts whose pulleys overlap; those of a crossed belt are refused.
pub(super) fn warn_of_overlaps(linkage: &Linkage, all: &mut Vec<Finding>) {
    for coupling in &linkage.couplings {
        let Kind::Belt { radii: [first, second], crossed: false } = coupling.kind else { continue };
        let joint = &linkage.joints[coupling.joint];
        let distance = linkage.hinge_distance(coupling.carrier, joint);
        if first + second > distance * (1.0 + TOUCHING) {
            let message = format_args!(
                "the pulleys of this belt have radii of {} and {} m, but their centres are only {} m apart: the \
                 pulleys overlap",
                Decimal::rounded(first),
                Decimal::rounded(second),
                Decimal::rounded(distance)
            );
            let remedy = "reduce a radius or move a centre, unless the pulleys lie side by side";
            all.push(Finding::warning(format_args!("couplings.{}", joint.name), message, remedy));
        }
    }
}

/// The words about a belt that transmits a force for which its pretension is too small [N], at a time, and the remedy.
pub fn of_slack_belt(name: &str, transmitted: f64, pretension: f64, when: &str) -> [String; 2] {
    let half = Decimal::rounded(0.5 * transmitted.abs());
    let message = format!(
        "{name} transmits {} N{when}; half of the transmitted force, {half} N, exceeds the pretension of {} N: one \
            span of a belt would be slack, but in the computation this span has a compression of {} N, so the joint \
            forces are wrong",
        Decimal::rounded(transmitted),
        Decimal::rounded(pretension),
        Decimal::rounded(0.5 * transmitted.abs() - pretension)
    );
    let remedy = format!(
        "for a belt use a pretension of more than {half} N; for a chain, whose slack span has no tension, use exactly \
         {half} N"
    );
    [message, remedy]
}
