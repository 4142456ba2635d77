//! Variables of bodies and of markers on them.
use super::builder::Builder;
use super::needs::Needs;
use crate::mechanism::quantity::Output;
use crate::variables::Unit::{
    Metre, MetrePerSecond, MetrePerSecondSquared, Radian, RadianPerSecond, RadianPerSecondSquared,
};

pub(super) fn add_motion(b: &mut Builder) {
    let bodies = b.source.linkage.bodies.iter().enumerate();
    for (body, name) in bodies.filter(|(_, b)| b.angle_coordinate.is_some()).map(|(i, b)| (i, &b.name)) {
        let derivatives = [
            ("angle", "Angle of the x axis of", Radian),
            ("speed", "Angular speed of", RadianPerSecond),
            ("acceleration", "Angular acceleration of", RadianPerSecondSquared),
        ];
        let stated = b.source.mechanism.start.body.as_ref() == Some(name);
        b.motion(name, derivatives, stated, |order| Output::Angle { body, order });
    }
}

pub(super) fn add_markers(b: &mut Builder) {
    let s = b.source;
    for (marker, n) in s.mechanism.markers.names().into_iter().enumerate() {
        let position = Needs { marker: Some(marker), ..s.position(&[s.markers[marker].body]) };
        let velocity = Needs { speed: true, ..position };
        let acceleration = Needs { marker: Some(marker), ..s.acceleration() };
        for (order, suffixes, word, unit, needs) in [
            (0, ["x", "y"], "Position of ", Metre, position),
            (1, ["velocity_x", "velocity_y"], "Velocity of ", MetrePerSecond, velocity),
            (2, ["acceleration_x", "acceleration_y"], "Acceleration of ", MetrePerSecondSquared, acceleration),
        ] {
            for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                let (text, output) =
                    ([word, n, ", ", letter, ", mechanism frame"], Output::Marker { marker, axis, order });
                b.output(n, suffixes[axis], &text, unit, output, needs);
            }
        }
    }
}
