//! The kinetic metric: twice the kinetic energy, as an inner product of rates.
//!
//! In: positions and rates of the bodies. Out: sums over the masses. It must not know the curve.
use crate::mechanism::linkage::{Linkage, Point, Positions, Rates};

/// Twice the kinetic energy at these rates: sum of m v^2 + I omega^2, and of m s_dot^2 of rotors.
pub(super) fn twice_kinetic(linkage: &Linkage, p: &Positions, r: &Rates) -> f64 {
    let mut sum = 0.0;
    for (i, body) in linkage.bodies.iter().enumerate().skip(1) {
        if body.mass > 0.0 {
            sum += body.mass * p.velocity(r, Point { body: i, local: body.center }).norm_squared();
        }
        sum += body.inertia * r.angle[i].powi(2);
    }
    for rotor in &linkage.rotors {
        sum += rotor.mass * linkage.stroke_rate(rotor.stroke, p, r).powi(2);
    }
    sum
}

/// Inner product of rates and accelerations: sum of m v . a + I omega alpha, and of m s_dot s_ddot of rotors.
pub(super) fn kinetic_product(linkage: &Linkage, p: &Positions, r: &Rates, a: &Rates) -> f64 {
    let mut sum = 0.0;
    for (i, body) in linkage.bodies.iter().enumerate().skip(1) {
        let [_, v, acceleration] = p.motion(r, a, Point { body: i, local: body.center });
        sum += body.mass * v.dot(&acceleration) + body.inertia * r.angle[i] * a.angle[i];
    }
    for rotor in &linkage.rotors {
        let rates = [linkage.stroke_rate(rotor.stroke, p, r), linkage.stroke_second_rate(rotor.stroke, p, r, a)];
        sum += rotor.mass * rates[0] * rates[1];
    }
    sum
}
