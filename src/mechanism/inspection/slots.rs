//! Warnings about pins that leave their slots.
//!
//! In: the range of the position along a slot over the travel. Out: a warning. It must not know how the range is found.
use crate::inspection::{Finding, Inspection};
use crate::mechanism::linkage::Linkage;
use crate::numerics::decimal::Decimal;

/// Part of the length of a slot by which a pin may be beyond an end.
const BEYOND: f64 = 1e-9;

/// Warn of a slot whose pin is beyond its ends somewhere on the travel. `coordinate`: the position along the slot.
pub(super) fn warn(linkage: &Linkage, coordinate: usize, [least, most]: [f64; 2], out: &mut Inspection) {
    let Some(slot) = linkage.slots.iter().find(|slot| slot.coordinate == coordinate) else { return };
    let length = slot.track.length();
    if slot.track.is_ring() || (least >= -BEYOND * length && most <= (1.0 + BEYOND) * length) {
        return;
    }
    let name = &linkage.joints[slot.joint].name;
    let message = format!(
        "the slot is {} m long, but the pin moves from {} m to {} m: the pin leaves the slot",
        Decimal::rounded(length),
        Decimal::rounded(least),
        Decimal::rounded(most)
    );
    let remedy = "make the slot of this joint longer, or add stops with the key joint at the two ends of the slot";
    out.findings.push(Finding::warning(format_args!("joints.{name}"), message, remedy));
}
