//! Machines of the scenes: plain data of bodies, joints, loads and stops, and the definition that says the same.
//!
//! In: random numbers. Out: data for the independent integration, and a definition's text. It must not know an equation
//! of motion.
use super::super::random::Random;
use serde_json::{Map, Value, json};
use std::f64::consts::PI;

/// A vector of the plane.
pub type Vector = [f64; 2];

/// A rigid body other than the ground.
#[derive(Clone, Debug)]
pub struct Body {
    pub name: &'static str,
    /// Length from the origin to the end [m]; 0: no end.
    pub length: f64,
    /// Mass [kg].
    pub mass: f64,
    /// Moment of inertia about the centre of mass [kg.m2].
    pub inertia: f64,
    /// Centre of mass in the body's frame [m].
    pub center: Vector,
    /// Origin [m] and angle [rad] at the start.
    pub origin: Vector,
    pub angle: f64,
}

/// A point of a body, or of the ground, in its frame [m].
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub body: Option<usize>,
    pub at: Vector,
    pub name: &'static str,
}

/// What a joint lets free.
#[derive(Clone, Copy, Debug)]
pub enum Freedom {
    /// Turning, with a pin of this radius [m].
    Revolute { radius: f64 },
    /// Sliding of a body that does not turn on a line of the ground in this direction [rad].
    Prismatic { axis: f64 },
}

/// A joint of two points.
#[derive(Clone, Debug)]
pub struct Joint {
    pub name: &'static str,
    pub first: Point,
    pub second: Point,
    pub freedom: Freedom,
}

/// What a stop limits or a drive works on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// Angle of a body.
    Angle(usize),
    /// Position of a prismatic joint.
    Slide(usize),
    /// Distance of a place of the ground and a point of a body in its frame.
    Distance(Vector, usize, Vector),
}

#[derive(Clone, Debug)]
pub struct Stop {
    pub quantity: Quantity,
    /// 1 for an upper stop, -1 for a lower one.
    pub sign: f64,
    pub value: f64,
    /// Restitution of a rigid stop; None for a bumper.
    pub rigid: Option<f64>,
    pub stiffness: f64,
    pub damping: f64,
}

/// mu_S, mu_d, V_S, V_d.
pub type Law = [f64; 4];

/// A machine with all that acts on it but the size of its drive's force.
#[derive(Clone, Debug)]
pub struct Machine {
    pub bodies: Vec<Body>,
    pub joints: Vec<Joint>,
    /// Acceleration [m/s2] and upward direction [rad].
    pub gravity: [f64; 2],
    pub friction: Option<Law>,
    pub drive: Quantity,
    pub efficiency: f64,
    pub stops: Vec<Stop>,
    /// Stop with a lock.
    pub lock: Option<usize>,
    /// Coordinate that is compared, and its speed at the start [rad/s or m/s].
    pub coordinate: Quantity,
    pub speed: f64,
    /// Names of the coordinate, its speed, and the drive's input.
    pub names: [&'static str; 3],
    /// A force or torque that moves it.
    pub load: f64,
    pub tolerance: f64,
    /// Distance of the post, on the ground.
    post: Vector,
}

fn on(body: usize, at: Vector, name: &'static str) -> Point {
    Point { body: Some(body), at, name }
}

fn ground(at: Vector, name: &'static str) -> Point {
    Point { body: None, at, name }
}

/// A vector turned by an angle.
pub fn turned([x, y]: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

impl Machine {
    /// A random machine with random stops, none of which it is beyond.
    pub fn random(random: &mut Random) -> Self {
        let mut machine = match random.below(3) {
            0 => block(random),
            1 => slider_crank(random),
            _ => four_bar(random),
        };
        if random.chance(0.6) {
            let slow = random.decades(3e-3, 0.1);
            machine.friction =
                Some([random.within(0.0, 0.3), random.within(0.0, 0.2), slow, slow * random.decades(2.0, 50.0)]);
        }
        if random.chance(0.3) {
            machine.efficiency = random.within(0.4, 1.0);
        }
        machine.tolerance = random.decades(1e-9, 1e-5);
        machine
    }

    fn of(
        bodies: Vec<Body>,
        joints: Vec<Joint>,
        drive: Quantity,
        names: [&'static str; 3],
        random: &mut Random,
    ) -> Self {
        let gravity = [if random.chance(0.7) { 9.81 } else { 0.0 }, random.within(-PI, PI)];
        Self {
            bodies,
            joints,
            gravity,
            friction: None,
            drive,
            efficiency: 1.0,
            stops: Vec::new(),
            lock: None,
            coordinate: drive,
            speed: 0.0,
            names,
            load: 1.0,
            tolerance: 1e-9,
            post: [0.2, 0.7],
        }
    }

    /// Value of a quantity at the start.
    fn start_of(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Angle(body) => self.bodies[body].angle,
            Quantity::Slide(joint) => {
                let Joint { first, second, freedom, .. } = &self.joints[joint];
                let Freedom::Prismatic { axis } = freedom else { return 0.0 };
                let origin = second.body.map_or([0.0; 2], |body| self.bodies[body].origin);
                let unit = turned([1.0, 0.0], *axis);
                (origin[0] - first.at[0]) * unit[0] + (origin[1] - first.at[1]) * unit[1]
            }
            Quantity::Distance(place, body, at) => {
                let Body { origin, angle, .. } = &self.bodies[body];
                let arm = turned(at, *angle);
                (origin[0] + arm[0] - place[0]).hypot(origin[1] + arm[1] - place[1])
            }
        }
    }

    /// Up to six stops of these quantities with the sizes of a motion; a lock at one of the first `monotone`
    /// quantities.
    fn add_stops(&mut self, random: &mut Random, quantities: &[(Quantity, f64)], monotone: usize, stiffness: f64) {
        for _ in 0..random.below(7) {
            let n = random.below(quantities.len());
            let (quantity, size) = quantities[n];
            let sign = random.pick(&[-1.0, 1.0]);
            let value = self.start_of(quantity) + sign * size * random.decades(0.03, 1.0);
            if matches!(quantity, Quantity::Distance(..)) && value < 0.05 {
                continue;
            }
            let rigid = random.chance(0.4).then(|| if random.chance(0.3) { 0.0 } else { random.within(0.0, 0.95) });
            let stiffness = stiffness * random.decades(0.03, 10.0);
            let damping = if random.chance(0.3) { 0.0 } else { stiffness * random.decades(1e-4, 0.03) };
            if n < monotone && random.chance(0.3) {
                self.lock = Some(self.stops.len());
            }
            self.stops.push(Stop { quantity, sign, value, rigid, stiffness, damping });
        }
    }

    /// The definition's text.
    pub fn definition(&self) -> String {
        let mut grounds = Map::new();
        grounds.insert("post".into(), json!(self.post));
        let (mut bodies, mut joints, mut guess) = (Map::new(), Map::new(), Map::new());
        for body in &self.bodies {
            let mut out = json!({ "mass": body.mass, "inertia": body.inertia, "center": body.center });
            if body.length > 0.0 {
                out["length"] = json!(body.length);
                guess.insert(body.name.into(), json!(body.angle));
            }
            bodies.insert(body.name.into(), out);
        }
        let mut name = |point: &Point| match point.body {
            Some(body) => format!("{}.{}", self.bodies[body].name, point.name),
            None => {
                grounds.insert(point.name.into(), json!(point.at));
                format!("ground.{}", point.name)
            }
        };
        for (k, joint) in self.joints.iter().enumerate() {
            let mut out = json!({ "first": name(&joint.first), "second": name(&joint.second) });
            match joint.freedom {
                Freedom::Revolute { radius } => {
                    out["type"] = json!("revolute");
                    // Without friction a radius does nothing, and is refused.
                    if self.friction.is_some() {
                        out["pin_radius"] = json!(radius);
                    }
                }
                Freedom::Prismatic { axis } => {
                    out["type"] = json!("prismatic");
                    (out["axis_angle"], out["angle"]) = (json!(axis), json!(self.angle_of(joint.second.body)));
                    guess.insert(joint.name.into(), json!(self.start_of(Quantity::Slide(k))));
                }
            }
            joints.insert(joint.name.into(), out);
        }
        bodies.insert("ground".into(), json!({ "points": grounds }));
        let drive = match self.drive {
            Quantity::Slide(joint) => self.joints[joint].name,
            _ => self.joints[0].name,
        };
        let start = match self.coordinate {
            Quantity::Slide(joint) => {
                let position = self.start_of(self.coordinate);
                json!({ "joint": self.joints[joint].name, "position": position, "speed": self.speed })
            }
            _ => json!({ "body": self.bodies[0].name, "angle": self.bodies[0].angle, "speed": self.speed }),
        };
        let stops: Map<_, _> =
            self.stops.iter().enumerate().map(|(k, stop)| (format!("s{k}"), self.stop(stop))).collect();
        let mut out = json!({
            "name": "Scene", "bodies": bodies, "joints": joints, "stops": stops, "start": start, "guess": guess,
            "gravity": { "acceleration": self.gravity[0], "up_angle": self.gravity[1] },
            "actuators": { "load": { "joint": drive, "efficiency": self.efficiency } },
            "solver": { "tolerance": self.tolerance },
        });
        if let Some([static_coefficient, kinetic_coefficient, static_speed, kinetic_speed]) = self.friction {
            out["friction"] = json!({
                "enabled": true, "static_coefficient": static_coefficient, "kinetic_coefficient": kinetic_coefficient,
                "static_speed": static_speed, "kinetic_speed": kinetic_speed,
            });
        }
        if let Some(stop) = self.lock {
            let at = if self.bodies[0].length > 0.0 { "crank.end" } else { "block.origin" };
            out["locks"] = json!({ "latch": { "stop": format!("s{stop}"), "at": at } });
        }
        out.to_string()
    }

    fn angle_of(&self, body: Option<usize>) -> f64 {
        body.map_or(0.0, |body| self.bodies[body].angle)
    }

    fn stop(&self, stop: &Stop) -> Value {
        let mut out = match stop.quantity {
            Quantity::Angle(body) => json!({ "body": self.bodies[body].name, "angle": stop.value }),
            Quantity::Slide(joint) => json!({ "joint": self.joints[joint].name, "position": stop.value }),
            Quantity::Distance(_, body, [x, _]) => {
                let Body { name, .. } = self.bodies[body];
                let point = if x == 0.0 { "origin" } else { "end" };
                json!({ "first": "ground.post", "second": format!("{name}.{point}"), "length": stop.value })
            }
        };
        out["limit"] = json!(if stop.sign > 0.0 { "upper" } else { "lower" });
        match stop.rigid {
            Some(restitution) => out["restitution"] = json!(restitution),
            None => {
                out["rigid"] = json!(false);
                (out["stiffness"], out["damping"]) = (json!(stop.stiffness), json!(stop.damping));
            }
        }
        out
    }
}

fn speed(random: &mut Random, size: f64) -> f64 {
    if random.chance(0.3) { 0.0 } else { random.within(-size, size) }
}

fn block(random: &mut Random) -> Machine {
    let (mass, at, axis) = (random.decades(0.1, 20.0), random.within(-1.0, 1.0), random.within(-PI, PI));
    let origin = turned([at, 0.0], axis);
    let body = Body { name: "block", length: 0.0, mass, inertia: 1.0, center: [0.0; 2], origin, angle: axis };
    let slide = Joint {
        name: "slide",
        first: ground([0.0; 2], "start"),
        second: on(0, [0.0; 2], "origin"),
        freedom: Freedom::Prismatic { axis },
    };
    let names = ["slide.position", "slide.speed", "load.force"];
    let mut machine = Machine::of(vec![body], vec![slide], Quantity::Slide(0), names, random);
    (machine.speed, machine.load) = (speed(random, 4.0), 40.0 * mass);
    let post = machine.post;
    let quantities = [(Quantity::Slide(0), 0.6), (Quantity::Distance(post, 0, [0.0; 2]), 0.3)];
    machine.add_stops(random, &quantities, 1, 500.0 * mass);
    machine
}

/// A rod between two points of the plane.
fn rod(random: &mut Random, name: &'static str, [from, to]: [Vector; 2], mass: f64) -> Body {
    let (x, y) = (to[0] - from[0], to[1] - from[1]);
    let length = x.hypot(y);
    let center = [length * random.within(0.2, 0.8), length * random.within(-0.1, 0.1)];
    let inertia = mass * length * length * random.within(0.05, 0.15);
    Body { name, length, mass, inertia, center, origin: from, angle: y.atan2(x) }
}

fn revolute(random: &mut Random, name: &'static str, first: Point, second: Point, size: f64) -> Joint {
    let radius = if random.chance(0.2) { 0.0 } else { size * random.within(0.0, 0.1) };
    Joint { name, first, second, freedom: Freedom::Revolute { radius } }
}

fn slider_crank(random: &mut Random) -> Machine {
    let crank = random.within(0.1, 0.3);
    let length = crank * random.within(1.5, 4.0);
    let offset = (length - crank) * random.within(-0.5, 0.5);
    let (angle, axis) = (random.within(-PI, PI), random.within(-PI, PI));
    let end = turned([crank, 0.0], angle);
    // In the frame of the slide's line.
    let [x, y] = turned(end, -axis);
    let lift: f64 = y - offset;
    let wrist = turned([x + (length * length - lift * lift).sqrt(), offset], axis);
    let mass = random.decades(0.3, 10.0);
    let part = random.decades(0.2, 3.0);
    let slider = Body {
        name: "slider",
        length: 0.0,
        mass: mass * part,
        inertia: 1.0,
        center: [0.0; 2],
        origin: wrist,
        angle: axis,
    };
    let bodies =
        vec![rod(random, "crank", [[0.0; 2], end], mass), rod(random, "rod", [end, wrist], 0.6 * mass), slider];
    let guide = Joint {
        name: "guide",
        first: ground(turned([0.0, offset], axis), "guide"),
        second: on(2, [0.0; 2], "origin"),
        freedom: Freedom::Prismatic { axis },
    };
    let joints = vec![
        revolute(random, "bearing", ground([0.0; 2], "bearing"), on(0, [0.0; 2], "origin"), crank),
        revolute(random, "pin", on(0, [crank, 0.0], "end"), on(1, [0.0; 2], "origin"), crank),
        revolute(random, "wrist", on(1, [length, 0.0], "end"), on(2, [0.0; 2], "origin"), crank),
        guide,
    ];
    let names = ["crank.angle", "crank.speed", "load.torque"];
    let mut machine = Machine::of(bodies, joints, Quantity::Angle(0), names, random);
    (machine.speed, machine.load) = (speed(random, 6.0), 30.0 * mass * crank);
    let mut quantities = vec![
        (Quantity::Angle(0), 5.0),
        (Quantity::Slide(3), crank),
        (Quantity::Distance(machine.post, 0, [crank, 0.0]), crank),
    ];
    let mut monotone = 1;
    if random.chance(0.3) {
        // Drives its slider: at the dead centres its force has no effect.
        (machine.drive, machine.names[2]) = (Quantity::Slide(3), "load.force");
        machine.load /= crank;
        (quantities, monotone) = (vec![quantities[0], quantities[1]], 1);
    }
    machine.add_stops(random, &quantities, monotone, 30.0 * mass * crank);
    machine
}

fn four_bar(random: &mut Random) -> Machine {
    let base: f64 = random.within(0.2, 0.6);
    let (crank, angle) = (random.within(0.1, 0.4), random.within(-PI, PI));
    let end = turned([crank, 0.0], angle);
    let far = [random.within(0.0, 0.8), random.within(0.15, 0.7) * random.pick(&[-1.0, 1.0])];
    let foot = [base, 0.0];
    let mass = random.decades(0.3, 10.0);
    let bodies = vec![
        rod(random, "crank", [[0.0; 2], end], mass),
        rod(random, "coupler", [end, far], 0.5 * mass),
        rod(random, "follower", [foot, far], 2.0 * mass),
    ];
    let [coupler, follower] = [1, 2].map(|k: usize| bodies[k].length);
    let joints = vec![
        revolute(random, "a", ground([0.0; 2], "a"), on(0, [0.0; 2], "origin"), crank),
        revolute(random, "b", on(0, [crank, 0.0], "end"), on(1, [0.0; 2], "origin"), crank),
        revolute(random, "c", on(1, [coupler, 0.0], "end"), on(2, [follower, 0.0], "end"), crank),
        revolute(random, "d", ground(foot, "d"), on(2, [0.0; 2], "origin"), crank),
    ];
    let names = ["crank.angle", "crank.speed", "load.torque"];
    let mut machine = Machine::of(bodies, joints, Quantity::Angle(0), names, random);
    (machine.speed, machine.load) = (speed(random, 4.0), 30.0 * mass * crank);
    let quantities = [
        (Quantity::Angle(0), 2.0),
        (Quantity::Angle(2), 0.7),
        (Quantity::Distance(machine.post, 0, [crank, 0.0]), crank),
    ];
    machine.add_stops(random, &quantities, 0, 30.0 * mass);
    machine
}
