//! The definition of a sketch.
//!
//! In: a sketch, places of its points. Out: the text of a definition with a guess from them. It must not know the
//! engine.
use super::{Coordinate, Frame, Miss, Sketch, Slide};
use crate::attack::random::Random;
use crate::kinds::jet::{Jet, Vector};
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

    /// The text of its definition. The guess is off by `rough`, differently for each number.
    ///
    /// # Errors
    /// The closed form has no value at the start.
    pub fn definition(&self) -> Result<String, Miss> {
        let places = (self.places)(Jet::variable(self.start[0]))?;
        Ok(self.definition_at(&places))
    }

    /// The definition with a guess from these places.
    pub fn definition_at(&self, places: &[Vector]) -> String {
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
        for joint in self.joints() {
            let [first, second] = joint.ends.map(|end| self.point_name(end));
            let mut out = json!({ "type": "revolute", "first": first, "second": second });
            if let Some(slide) = joint.slide {
                let Slide { on, axis, block, .. } = self.slides[slide];
                let turned = poses[block].angle - on.map_or(Jet::default(), |body| poses[body].angle);
                (out["type"], out["axis_angle"], out["angle"]) =
                    (json!("prismatic"), json!(axis), json!(turned.value()));
                if !self.follows(slide) {
                    guess.insert(joint.name.clone(), near(self.position(slide, places, &poses).value(), self.size()));
                }
            }
            joints.insert(joint.name, out);
        }
        let value = self.value(places, &poses);
        let (at, key) = (value.value(), value.slope() * self.start[1]);
        let start = match self.coordinate {
            Coordinate::Angle(body) => json!({ "body": self.bodies[body].name, "angle": at, "speed": key }),
            Coordinate::Position(slide) => json!({ "joint": self.slides[slide].name, "position": at, "speed": key }),
        };
        let mut out = json!({
            "name": self.name, "bodies": bodies, "joints": joints, "guess": guess, "markers": markers, "start": start,
            "gravity": { "acceleration": self.loads.gravity[0], "up_angle": self.loads.gravity[1] },
            "solver": { "tolerance": self.tolerance },
        });
        self.add_loads(&mut out);
        out.to_string()
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
        for (name, value) in self.stops.iter().flat_map(|stops| ["lower", "upper"].into_iter().zip(stops.values)) {
            let mut stop = match self.coordinate {
                Coordinate::Angle(body) => json!({ "body": self.bodies[body].name, "angle": value }),
                Coordinate::Position(slide) => json!({ "joint": self.slides[slide].name, "position": value }),
            };
            (stop["limit"], stop["restitution"]) = (json!(name), json!(self.stops.map_or(0.0, |s| s.restitution)));
            out["stops"][format!("{name}_stop")] = stop;
        }
    }
}
