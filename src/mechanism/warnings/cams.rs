//! Warnings about cams: profiles that no follower can follow, and steep ones.
//!
//! In: the couplings of a linkage. Out: warnings. It must not know the curve of positions: they hold for whole
//! revolutions.
use crate::inspection::Finding;
use crate::mechanism::linkage::{Cam, Coupling, Guide, Kind, Linkage};
use crate::numerics::decimal::Decimal;
use std::f64::consts::{PI, TAU};

/// Number of samples between two knots of the law.
const SAMPLES: usize = 200;
/// Usual largest pressure angle of a follower that slides and of one that turns [rad].
const STEEPEST: [f64; 2] = [PI / 6.0, PI / 4.0];

/// Warnings about the cams of a linkage.
pub(super) fn warn_of_cams(linkage: &Linkage, all: &mut Vec<Finding>) {
    for coupling in &linkage.couplings {
        if let Kind::Cam(cam) = &coupling.kind {
            warn_of_cam(&linkage.joints[coupling.joint].name, coupling, cam, all);
        }
    }
}

/// An extreme along the profile and the u1 at which it is.
#[derive(Clone, Copy)]
struct Extreme {
    value: f64,
    u1: f64,
}

fn warn_of_cam(name: &str, coupling: &Coupling, cam: &Cam, all: &mut Vec<Finding>) {
    let none = Extreme { value: f64::INFINITY, u1: 0.0 };
    // The sharpest convex curvature under a roller, the least radius under a flat face, the steepest pressure angle.
    let (mut sharpest, mut steepest) = (none, Extreme { value: 0.0, ..none });
    for u1 in samples(coupling) {
        let at = coupling.law.at(u1);
        let radius = cam.radius_of_curvature(at);
        if radius < sharpest.value && (cam.face.is_some() || radius > 0.0) {
            sharpest = Extreme { value: radius, u1 };
        }
        let angle = cam.pressure_angle(at)[0].abs();
        if angle > steepest.value {
            steepest = Extreme { value: angle, u1 };
        }
    }
    let told = Decimal::rounded;
    if sharpest.value < cam.roller || sharpest.value < 0.0 {
        let what = match cam.face {
            None => format!(
                "the pitch curve has a radius of curvature of {} m and the roller has a radius of {} m",
                told(sharpest.value),
                told(cam.roller)
            ),
            Some(_) => {
                format!("for a flat face the profile would have a radius of curvature of {} m", told(sharpest.value))
            }
        };
        let message = format_args!(
            "the cam is undercut at the cam angle {} rad: {what}, so no cam disc has this profile",
            told(sharpest.u1)
        );
        let remedy = "use a larger `base_radius`, a smaller or slower rise, or a smaller roller";
        all.push(Finding::warning(format_args!("couplings.{name}"), message, remedy));
    }
    let limit = STEEPEST[usize::from(matches!(cam.guide, Guide::Pivot { .. }))];
    if steepest.value > limit {
        let message = format_args!(
            "the pressure angle reaches {} rad ({} deg) at the cam angle {} rad, but at most {} deg are usual: the \
             cam pushes the follower strongly sideways",
            told(steepest.value),
            told(steepest.value * 180.0 / PI),
            told(steepest.u1),
            told(limit * 180.0 / PI)
        );
        let remedy = "use a larger `base_radius`, or a smaller or slower rise";
        all.push(Finding::warning(format_args!("couplings.{name}"), message, remedy));
    }
}

/// Values of u1 over one revolution, evenly between each two knots of the law.
fn samples(coupling: &Coupling) -> impl Iterator<Item = f64> {
    let mut borders = vec![0.0];
    while let Some(&last) = borders.last().filter(|last| **last < TAU) {
        borders.push((last + coupling.law.next_knot(last, true, 1e-9)).min(TAU));
    }
    (1..borders.len()).flat_map(move |k| {
        let [a, b] = [borders[k - 1], borders[k]];
        (0..=SAMPLES).map(move |i| a + (b - a) * i as f64 / SAMPLES as f64)
    })
}
