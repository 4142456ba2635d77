//! The definition of a sketch.
//!
//! In: a sketch, positions of its points. Out: the text of a definition with a guess from these positions. Must not
//! depend on the engine.
use super::jet::{Jet, Vector};
use super::sketch::{Body, Coordinate, Frame, Miss, Sketch, Slide, Stop};
use crate::attack::random::Random;
use serde_json::{Map, Value, json};

impl Sketch {
    fn point_name(&self, (body, point): (Option<usize>, usize)) -> String {
        let Some(body) = body.map(|body| &self.bodies[body]) else { return format!("ground.p{point}") };
        let local = match body.frame {
            _ if body.origin == point => "origin".into(),
            Frame::To(end, _) if end == point => "end".into(),
            _ => format!("p{point}"),
        };
        format!("{}.{local}", body.name)
    }

    /// The text of its definition. The errors of the guess are up to `rough`, different for each number.
    pub fn definition(&self) -> Result<String, Miss> {
        Ok(self.definition_at(&(self.places)(Jet::variable(self.start[0]))?))
    }

    /// The definition with a guess from these positions, and the speed that follows from the rate at the start.
    pub fn definition_at(&self, places: &[Vector]) -> String {
        let slope = self.value(self.coordinate, places, &self.poses(places)).slope();
        self.definition_with(places, slope * self.start[1])
    }

    /// The definition with a guess from these positions, and a speed of the coordinate.
    pub fn definition_with(&self, places: &[Vector], speed: f64) -> String {
        let poses = self.poses(places);
        let mut random = Random::new(self.bodies.len() as u64);
        let mut near = |value: f64, scale: f64| {
            let off = if self.rough > 0.0 { self.rough * scale * random.within(-1.0, 1.0) } else { 0.0 };
            json!(value + off)
        };
        let (mut bodies, mut joints, mut guess, mut markers) = (Map::new(), Map::new(), Map::new(), Map::new());
        let list = |points: &[(usize, [f64; 2])]| -> Value {
            points.iter().map(|(point, at)| (format!("p{point}"), json!(at))).collect::<Map<_, _>>().into()
        };
        bodies.insert("ground".into(), json!({ "points": list(&self.ground) }));
        for (k, body) in self.bodies.iter().enumerate() {
            let mut out = json!({ "mass": body.mass, "center": body.center, "inertia": body.inertia });
            out["points"] = list(&body.points);
            if let Frame::To(_, length) = body.frame {
                out["length"] = json!(length);
                guess.insert(body.name.clone(), near(poses[k].angle.value(), 1.0));
            }
            bodies.insert(body.name.clone(), out);
            let last = body.points.last().map_or(body.origin, |(point, _)| *point);
            markers.insert(format!("{}_mark", body.name), json!({ "at": self.point_name((Some(k), last)) }));
        }
        for (k, joint) in self.joints().into_iter().enumerate() {
            let [first, second] = joint.ends.map(|end| self.point_name(end));
            let mut out = json!({ "type": "revolute", "first": first, "second": second });
            // Without friction a radius has no effect and is rejected.
            if let (None, Some(radius), Some(_)) = (joint.slide, self.loads.radii.get(k), self.loads.friction) {
                out["pin_radius"] = json!(radius);
            }
            if let Some(slide) = joint.slide {
                let Slide { on, axis, block, .. } = self.slides[slide];
                let turned = poses[block].angle - on.map_or(Jet::default(), |body| poses[body].angle);
                (out["type"], out["axis_angle"], out["angle"]) =
                    (json!("prismatic"), json!(axis), json!(turned.value()));
                if !self.follows(slide) {
                    let position = self.value(Coordinate::Position(slide), places, &poses);
                    guess.insert(joint.name.clone(), near(position.value(), self.size()));
                }
            }
            joints.insert(joint.name, out);
        }
        let mut start = self.named(self.coordinate, self.value(self.coordinate, places, &poses).value());
        start["speed"] = json!(speed);
        let mut out = json!({
            "name": self.name, "bodies": bodies, "joints": joints, "guess": guess, "markers": markers, "start": start,
            "gravity": { "acceleration": self.loads.gravity[0], "up_angle": self.loads.gravity[1] },
            "solver": { "tolerance": self.tolerance },
        });
        self.add_loads(&mut out);
        self.add_stops(&mut out);
        out.to_string()
    }

    /// JSON of a coordinate with a value.
    fn named(&self, coordinate: Coordinate, value: f64) -> Value {
        match coordinate {
            Coordinate::Angle(body) => json!({ "body": self.bodies[body].name, "angle": value }),
            Coordinate::Position(slide) => json!({ "joint": self.slides[slide].name, "position": value }),
            Coordinate::Distance(_, point) => {
                let second = self.point_name((self.owner(point), point));
                json!({ "first": "ground.post", "second": second, "length": value })
            }
        }
    }

    fn add_loads(&self, out: &mut Value) {
        for (k, (body, torque)) in self.loads.torques.iter().enumerate() {
            out["torques"][format!("torque{k}")] =
                json!({ "on": self.bodies[*body].name, "torque": torque, "constant": true });
        }
        for (k, spring) in self.loads.springs.iter().enumerate() {
            out["bodies"]["ground"]["points"][format!("anchor{k}")] = json!(spring.anchor);
            out["springs"][format!("spring{k}")] = json!({
                "first": format!("ground.anchor{k}"), "second": self.point_name((self.owner(spring.end), spring.end)),
                "stiffness": spring.stiffness, "damping": spring.damping,
                "free_length": spring.free,
            });
        }
        if let Some([static_coefficient, kinetic_coefficient, static_speed, kinetic_speed]) = self.loads.friction {
            out["friction"] = json!({
                "enabled": true, "static_coefficient": static_coefficient, "kinetic_coefficient": kinetic_coefficient,
                "static_speed": static_speed, "kinetic_speed": kinetic_speed,
            });
        }
        if let Some((on, efficiency)) = self.loads.drive {
            // The joint of a slide, or the bearing of the first body.
            let joint = if let Coordinate::Position(slide) = on { self.slides[slide].name.as_str() } else { "pin0" };
            out["actuators"]["load"] = json!({ "joint": joint, "efficiency": efficiency });
        }
    }

    fn add_stops(&self, out: &mut Value) {
        for (k, Stop { on, sign, value, rigid, stiffness, damping }) in self.stops.iter().enumerate() {
            let mut stop = self.named(*on, *value);
            if let Coordinate::Distance(place, _) = on {
                out["bodies"]["ground"]["points"]["post"] = json!(place);
            }
            stop["limit"] = json!(if *sign > 0.0 { "upper" } else { "lower" });
            match rigid {
                Some(restitution) => stop["restitution"] = json!(restitution),
                None => {
                    stop["rigid"] = json!(false);
                    (stop["stiffness"], stop["damping"]) = (json!(stiffness), json!(damping));
                }
            }
            out["stops"][format!("s{k}")] = stop;
        }
        if let Some(stop) = self.lock {
            let Body { origin, frame, .. } = &self.bodies[0];
            let at = if let Frame::To(end, _) = frame { end } else { origin };
            out["locks"]["latch"] = json!({ "stop": format!("s{stop}"), "at": self.point_name((Some(0), *at)) });
        }
    }
}
