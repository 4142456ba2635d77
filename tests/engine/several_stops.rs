//! Several stops on a side: bumpers with a rigid stop behind them, dead centres behind a bumper, locks at any of them.
//! Random scenes are held against an integration of their own: the equation of a block or a slider-crank in closed form,
//! Runge-Kutta's steps of one small size, events by halving such a step. It knows quantities and their stops only, no
//! places on a curve.

use crate::support::{Run, assert_says, changed};
use linkage_fmu::simulation::Simulation;
use proptest::prelude::*;
use serde_json::{Value, json};
use std::cell::Cell;

/// What a stop limits.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Quantity {
    /// Angle of the crank.
    Angle,
    /// Position of the slide.
    Slide,
    /// Distance of the block or the crank's end from a post.
    Distance,
}

/// A block of a mass [kg] on a slide; or a slider-crank with an inertia [kg.m2] of its crank and a mass [kg] of its
/// slider, whose rod has no mass.
#[derive(Clone, Copy, Debug)]
enum Machine {
    Block(f64),
    Crank(f64, f64),
}

const CRANK: f64 = 0.3;
const ROD: f64 = 0.8;
const POST: [f64; 2] = [0.2, 0.7];

#[derive(Clone, Copy, Debug)]
struct Stop {
    quantity: Quantity,
    /// 1 for an upper stop, -1 for a lower one.
    sign: f64,
    value: f64,
    /// Restitution of a rigid stop.
    rigid: Option<f64>,
    stiffness: f64,
    damping: f64,
}

impl Machine {
    /// Slider position of the crank with its first two derivatives along the angle.
    fn slide(theta: f64) -> [f64; 3] {
        let (sin, cos) = theta.sin_cos();
        let root = (ROD * ROD - CRANK * CRANK * sin * sin).sqrt();
        let (p, p1) = (CRANK * CRANK * sin * cos, CRANK * CRANK * (cos * cos - sin * sin));
        [CRANK * cos + root, -CRANK * sin - p / root, -CRANK * cos - p1 / root - p * p / root.powi(3)]
    }

    /// A quantity and its derivative along the coordinate.
    fn quantity(self, quantity: Quantity, y: f64) -> [f64; 2] {
        match (self, quantity) {
            (Self::Crank(..), Quantity::Slide) => {
                let [x, slope, _] = Self::slide(y);
                [x, slope]
            }
            (Self::Crank(..), Quantity::Distance) => {
                let (sin, cos) = y.sin_cos();
                let gap = [CRANK * cos - POST[0], CRANK * sin - POST[1]];
                let length = gap[0].hypot(gap[1]);
                [length, (gap[1] * cos - gap[0] * sin) * CRANK / length]
            }
            (Self::Block(_), Quantity::Distance) => {
                let length = (y - POST[0]).hypot(POST[1]);
                [length, (y - POST[0]) / length]
            }
            _ => [y, 1.0],
        }
    }

    /// Acceleration of the coordinate under a force of the ram or a torque of the servo and these generalised forces.
    fn acceleration(self, load: f64, pushes: f64, y: f64, v: f64) -> f64 {
        match self {
            Self::Block(mass) => (load + pushes) / mass,
            Self::Crank(inertia, mass) => {
                let [_, slope, curvature] = Self::slide(y);
                (load + pushes - mass * slope * curvature * v * v) / (inertia + mass * slope * slope)
            }
        }
    }
}

/// What holds the machine at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    Stop(usize),
    Lock,
}

/// The independent integration.
#[derive(Clone, Debug)]
struct Oracle {
    machine: Machine,
    stops: Vec<Stop>,
    y: f64,
    v: f64,
    touching: Vec<bool>,
    held: Option<Held>,
    /// Stop whose lock is engaged, and whether the machine was beyond it when that happened.
    lock: Option<(usize, bool)>,
    /// Size of its steps [s].
    h: f64,
    /// Part by which the speed is wrong at the start and after each event, for what a small error makes of a motion.
    nudge: f64,
    /// Whether it has turned so close to a rigid stop that rounding decides whether it met the stop.
    grazed: bool,
}

/// Depth at which a stop counts as met [m or rad]: rounding is less.
const DEPTH: f64 = 1e-12;
/// Speed of an impact below which the machine rests.
const SLOW: f64 = 1e-6;

impl Oracle {
    /// Distance beyond a stop, its rate, and the generalised force of a push of 1.
    fn beyond(&self, stop: &Stop, y: f64, v: f64) -> [f64; 3] {
        let [s, slope] = self.machine.quantity(stop.quantity, y);
        [stop.sign * (s - stop.value), stop.sign * slope * v, -stop.sign * slope]
    }

    fn push(&self, k: usize, y: f64, v: f64) -> [f64; 3] {
        let stop = &self.stops[k];
        let [beyond, rate, effect] = self.beyond(stop, y, v);
        [beyond, stop.stiffness * beyond + stop.damping * rate, effect]
    }

    fn acceleration(&self, load: f64, y: f64, v: f64) -> f64 {
        let pushes = (0..self.stops.len()).filter(|&k| self.touching[k]).map(|k| {
            let [_, push, effect] = self.push(k, y, v);
            push * effect
        });
        self.machine.acceleration(load, pushes.sum(), y, v)
    }

    /// A step of Runge and Kutta.
    fn step(&self, load: f64, h: f64) -> [f64; 2] {
        let f = |y: f64, v: f64| [v, self.acceleration(load, y, v)];
        let (y, v) = (self.y, self.v);
        let a = f(y, v);
        let b = f(y + 0.5 * h * a[0], v + 0.5 * h * a[1]);
        let c = f(y + 0.5 * h * b[0], v + 0.5 * h * b[1]);
        let d = f(y + h * c[0], v + h * c[1]);
        let sum = |n: usize| h / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]);
        [y + sum(0), v + sum(1)]
    }

    /// The bumpers push as they do in this state.
    fn press(&mut self) {
        for k in 0..self.stops.len() {
            let [beyond, push, _] = self.push(k, self.y, self.v);
            self.touching[k] = self.stops[k].rigid.is_none() && beyond > DEPTH && push > 0.0;
        }
    }

    /// The stop whose law changes before this state.
    fn event(&self, [y, v]: [f64; 2]) -> Option<usize> {
        (0..self.stops.len()).find(|&k| {
            let stop = &self.stops[k];
            let [beyond, push, _] = self.push(k, y, v);
            let rate = self.beyond(stop, y, v)[1];
            if let Some((_, was_beyond)) = self.lock.filter(|(lock, _)| *lock == k)
                && (if was_beyond { beyond < -DEPTH } else { beyond > DEPTH })
            {
                return true;
            }
            let small = DEPTH * (stop.stiffness + stop.damping);
            match stop.rigid {
                Some(_) => beyond > DEPTH && rate > 0.0,
                None if self.touching[k] => push < -small,
                None => beyond > DEPTH && push > small,
            }
        })
    }

    /// Whether the loads press the machine, at rest, against a rigid stop.
    fn is_pressed(&self, k: usize, load: f64) -> bool {
        let a = self.acceleration(load, self.y, 0.0);
        self.beyond(&self.stops[k], self.y, a)[1] >= 0.0
    }

    /// Whether a rigid stop that the machine came nearer to is very near at this coordinate.
    fn came_near_a_rigid_stop(&self, y: f64) -> bool {
        let is_near = |stop: &Stop| {
            let [beyond, rate, _] = self.beyond(stop, y, self.v);
            stop.rigid.is_some() && rate > 0.0 && beyond.abs() < 1e-6
        };
        self.stops.iter().any(is_near)
    }

    fn engage(&mut self, lock: Option<usize>) {
        if self.held == Some(Held::Lock) && lock.is_none() {
            let stop = self.lock.unwrap().0;
            self.held = self.stops[stop].rigid.map(|_| Held::Stop(stop));
        }
        if let Some(stop) = lock
            && self.held == Some(Held::Stop(stop))
        {
            self.held = Some(Held::Lock);
        }
        self.lock = lock.map(|stop| (stop, self.beyond(&self.stops[stop], self.y, 0.0)[0] > 0.0));
    }

    fn advance(&mut self, load: f64, span: f64) {
        let mut t = 0.0;
        while t < span {
            match self.held {
                Some(Held::Lock) => return,
                Some(Held::Stop(k)) if self.is_pressed(k, load) => return,
                _ => self.held = None,
            }
            let h = self.h.min(span - t);
            let end = self.step(load, h);
            if self.event(end).is_none() {
                self.grazed |= self.v * end[1] <= 0.0 && self.came_near_a_rigid_stop(end[0]);
                ([self.y, self.v], t) = (end, t + h);
                continue;
            }
            let (mut before, mut after) = (0.0, h);
            for _ in 0..60 {
                let middle = 0.5 * (before + after);
                *(if self.event(self.step(load, middle)).is_some() { &mut after } else { &mut before }) = middle;
            }
            let k = self.event(self.step(load, after)).unwrap();
            [self.y, self.v] = self.step(load, after);
            t += after;
            self.change(k, load);
        }
    }

    /// A stop is met, or a bumper begins or ceases to push.
    fn change(&mut self, k: usize, load: f64) {
        self.v *= 1.0 + self.nudge;
        let rate = self.beyond(&self.stops[k], self.y, self.v)[1];
        let caught = |(lock, was_beyond): (usize, bool)| {
            let beyond = self.beyond(&self.stops[k], self.y, self.v)[0];
            lock == k && if was_beyond { beyond < -DEPTH } else { beyond > DEPTH }
        };
        if self.lock.is_some_and(caught) {
            self.v = 0.0;
            self.held = Some(Held::Lock);
            self.press();
        } else if let Some(restitution) = self.stops[k].rigid {
            self.v *= -restitution;
            self.press();
            if restitution * rate < SLOW {
                let moving = std::mem::take(&mut self.v);
                self.press();
                if self.is_pressed(k, load) {
                    self.held = Some(Held::Stop(k));
                } else {
                    self.v = moving;
                    self.press();
                }
            }
        } else {
            self.touching[k] = !self.touching[k];
        }
    }
}

/// A scene: a machine at a start, stops, and loads one after the other.
#[derive(Clone, Debug)]
struct Scene {
    machine: Machine,
    start: [f64; 2],
    stops: Vec<Stop>,
    /// Stop with a lock.
    lock: Option<usize>,
    /// Load, whether the lock is engaged, duration [s], communication steps.
    phases: Vec<(f64, bool, f64, u32)>,
}

impl Scene {
    fn definition(&self) -> String {
        let stops = self.stops.iter().enumerate().map(|(k, stop)| {
            let mut out = match (self.machine, stop.quantity) {
                (_, Quantity::Slide) | (Machine::Block(_), Quantity::Angle) => {
                    json!({ "joint": "slide", "position": stop.value })
                }
                (_, Quantity::Angle) => json!({ "body": "crank", "angle": stop.value }),
                (Machine::Block(_), _) => {
                    json!({ "first": "ground.post", "second": "block.origin", "length": stop.value })
                }
                _ => json!({ "first": "ground.post", "second": "crank.end", "length": stop.value }),
            };
            out["limit"] = json!(if stop.sign > 0.0 { "upper" } else { "lower" });
            match stop.rigid {
                Some(restitution) => out["restitution"] = json!(restitution),
                None => {
                    out["rigid"] = json!(false);
                    out["stiffness"] = json!(stop.stiffness);
                    out["damping"] = json!(stop.damping);
                }
            }
            (format!("s{k}"), out)
        });
        let stops: Value = stops.collect::<serde_json::Map<_, _>>().into();
        let [y, v] = self.start;
        let ground = json!({ "points": { "post": POST } });
        let mut out = match self.machine {
            Machine::Block(mass) => json!({
                "bodies": { "ground": ground, "block": { "mass": mass } },
                "joints": { "slide": { "type": "prismatic", "first": "ground.origin", "second": "block.origin" } },
                "actuators": { "load": { "joint": "slide" } },
                "start": { "joint": "slide", "position": y, "speed": v },
                "guess": { "slide": y },
            }),
            Machine::Crank(inertia, mass) => json!({
                "bodies": {
                    "ground": ground,
                    "crank": { "length": CRANK, "inertia": inertia },
                    "rod": { "length": ROD },
                    "block": { "mass": mass },
                },
                "joints": {
                    "bearing": { "type": "revolute", "first": "ground.origin", "second": "crank.origin" },
                    "pin": { "type": "revolute", "first": "crank.end", "second": "rod.origin" },
                    "wrist": { "type": "revolute", "first": "rod.end", "second": "block.origin" },
                    "slide": { "type": "prismatic", "first": "ground.origin", "second": "block.origin" },
                },
                "actuators": { "load": { "joint": "bearing" } },
                "start": { "body": "crank", "angle": y, "speed": v },
                "guess": { "crank": y, "rod": -(CRANK * y.sin() / ROD).asin(), "slide": Machine::slide(y)[0] },
            }),
        };
        out["name"] = json!("Stops");
        out["stops"] = stops;
        if let Some(stop) = self.lock {
            out["locks"] = json!({ "latch": { "stop": format!("s{stop}"), "at": "block.origin" } });
        }
        out["solver"] = json!({ "tolerance": 1e-11 });
        out.to_string()
    }

    fn run(&self) -> Run {
        Run::new(&self.definition()).started()
    }

    fn names(&self) -> [&'static str; 3] {
        match self.machine {
            Machine::Block(_) => ["slide.position", "slide.speed", "load.force"],
            Machine::Crank(..) => ["crank.angle", "crank.speed", "load.torque"],
        }
    }

    fn oracle(&self, h: f64, nudge: f64) -> Oracle {
        let ([y, v], touching) = (self.start, vec![false; self.stops.len()]);
        let (machine, stops) = (self.machine, self.stops.clone());
        Oracle { machine, stops, y, v: v * (1.0 + nudge), touching, held: None, lock: None, h, nudge, grazed: false }
    }

    /// Go through the phases beside two oracles, whose difference tells how far one of them may err. Returns how many
    /// phases could be compared, and the most stops that were reached at once.
    fn compare(&self) -> Result<(u32, usize), TestCaseError> {
        let (mut run, mut one, mut other) = (self.run(), self.oracle(2e-5, 0.0), self.oracle(1.1e-5, 1e-10));
        let [position, speed, input] = self.names();
        let (mut compared, mut most) = (0, 0);
        for &(load, engaged, span, steps) in &self.phases {
            let lock = self.lock.filter(|_| engaged);
            run.set(input, load);
            if self.lock.is_some() {
                run.set("latch.engage", engaged);
            }
            let stepped = (0..steps).try_for_each(|_| run.0.step(span / f64::from(steps)));
            prop_assert!(stepped.is_ok(), "phase {compared}: {}", stepped.unwrap_err());
            for oracle in [&mut one, &mut other] {
                oracle.engage(lock);
                oracle.advance(load, span);
            }
            let doubt = (one.y - other.y).abs() + 0.01 * (one.v - other.v).abs();
            if doubt > 1e-6 || one.grazed {
                break;
            }
            compared += 1;
            let (y, v) = (run.get(position), run.get(speed));
            let off = (y - one.y).abs() + 0.01 * (v - one.v).abs();
            prop_assert!(
                off < 1e-7 + 30.0 * doubt,
                "phase {compared}: {y} {v}, but {} {} {:?}\n{}",
                one.y,
                one.v,
                one.held,
                self.definition()
            );
            let reached = (0..self.stops.len()).filter(|k| run.is(&format!("s{k}.reached"))).count();
            most = most.max(reached);
            for (k, stop) in self.stops.iter().enumerate() {
                let beyond = one.beyond(stop, one.y, one.v)[0];
                if beyond.abs() > 1e-6 || one.held == Some(Held::Stop(k)) {
                    let flag = run.is(&format!("s{k}.reached"));
                    prop_assert_eq!(flag, beyond > -1e-6, "flag of s{} at {}\n{}", k, beyond, self.definition());
                }
            }
            prop_assert!(run.get("energy.drift").abs() < 1e-5, "drift {}", run.get("energy.drift"));
        }
        Ok((compared, most))
    }
}

/// A stop at a distance from the start of its quantity.
fn stop() -> impl Strategy<Value = (u8, bool, f64, Option<f64>, f64, f64)> {
    let rigid = proptest::option::weighted(0.3, 0.0..=1.0f64);
    let damping = prop_oneof![Just(0.0), 0.1..60.0f64];
    (0..3u8, any::<bool>(), 0.02..0.35f64, rigid, 1.7..3.7f64, damping)
}

fn scene() -> impl Strategy<Value = Scene> {
    let phase = (-100.0..100.0f64, any::<bool>(), 0.02..0.3f64, 1..8u32);
    let phases = proptest::collection::vec(phase, 1..6);
    let start = (0.3..2.8f64, -4.0..4.0f64);
    let (stops, lock) = (proptest::collection::vec(stop(), 2..7), proptest::option::weighted(0.3, 0..6usize));
    (any::<bool>(), 0.3..4.0f64, start, stops, lock, phases).prop_map(|(block, mass, start, stops, lock, phases)| {
        let machine = if block { Machine::Block(mass) } else { Machine::Crank(0.4, mass) };
        let start = [if block { start.0 - 1.5 } else { start.0 }, start.1];
        let stops = stops.into_iter().map(|(kind, upper, gap, rigid, decades, damping)| {
            let quantity = match kind {
                0 if !block => Quantity::Angle,
                2 => Quantity::Distance,
                _ => Quantity::Slide,
            };
            let gap = if quantity == Quantity::Angle { 8.0 * gap } else { gap };
            let [at, _] = machine.quantity(quantity, start[0]);
            let sign = if upper { 1.0 } else { -1.0 };
            let value = match quantity {
                Quantity::Distance => at * (1.0 + sign * gap),
                _ => at + sign * gap,
            };
            Stop { quantity, sign, value, rigid, stiffness: 10f64.powf(decades), damping }
        });
        let stops: Vec<Stop> = stops.collect();
        let lock = lock.filter(|&k| block && k < stops.len() && stops[k].quantity == Quantity::Slide);
        Scene { machine, start, stops, lock, phases }
    })
}

#[test]
fn random_scenes_agree_with_an_independent_integration() {
    let cases = crate::support::cases().unwrap_or(300);
    let (compared, several) = (Cell::new(0), Cell::new(0));
    let result = crate::support::runner(cases).run(&scene(), |scene| {
        let (phases, met) = scene.compare()?;
        compared.set(compared.get() + phases);
        several.set(several.get() + u32::from(met > 1));
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    let (compared, several) = (compared.get(), several.get());
    assert!(
        compared > cases && several > cases / 10,
        "{compared} phases compared, {several} scenes with several stops"
    );
}

fn bumper(quantity: Quantity, sign: f64, value: f64, stiffness: f64, damping: f64) -> Stop {
    Stop { quantity, sign, value, rigid: None, stiffness, damping }
}

fn rigid(quantity: Quantity, sign: f64, value: f64, restitution: f64) -> Stop {
    Stop { quantity, sign, value, rigid: Some(restitution), stiffness: 0.0, damping: 0.0 }
}

/// A block of 1 kg from rest at 0.
fn block(stops: &[Stop]) -> Scene {
    Scene { machine: Machine::Block(1.0), start: [0.0; 2], stops: stops.to_vec(), lock: None, phases: Vec::new() }
}

/// A block passes the place of its bumper and comes to the rigid stop behind it; the flags on the way.
#[test]
fn a_rigid_stop_behind_a_bumper_ends_the_travel() {
    let stops = [bumper(Quantity::Slide, 1.0, 0.5, 3000.0, 0.0), rigid(Quantity::Slide, 1.0, 0.51, 0.0)];
    for order in [[0, 1], [1, 0]] {
        let mut run = block(&order.map(|k| stops[k])).run();
        run.set("load.force", 100.0);
        let [soft, hard] = [0, 1].map(|k| format!("s{}.reached", order.iter().position(|&o| o == k).unwrap()));
        let mut farthest: f64 = 0.0;
        for _ in 0..400 {
            run.step(1e-3);
            let x = run.get("slide.position");
            farthest = farthest.max(x);
            assert_eq!((run.is(&soft), run.is(&hard)), (x >= 0.5, x >= 0.51 - 1e-15), "{x}");
        }
        assert!((farthest - 0.51).abs() < 1e-15 && run.get("slide.speed") == 0.0, "{farthest}");
        // The bumper carries 30 N, the stop the rest.
        let [soft, hard] = [soft, hard].map(|name| name.replace("reached", "force"));
        assert!((run.get(&soft) + 30.0).abs() < 1e-9 && (run.get(&hard) + 70.0).abs() < 1e-9);
        assert!(run.get("energy.drift").abs() < 1e-9);
        // Less than 30 N do not hold it there.
        run.set("load.force", 20.0);
        run.step(1e-3);
        assert!(run.get("slide.speed") < 0.0 && !run.is(&hard.replace("force", "reached")));
    }
}

/// Over the bumper and the dead centre to the lower rigid stop; and back.
#[test]
fn a_crank_that_overruns_its_bumper_meets_the_stop_behind_the_dead_centre() {
    let stops = [bumper(Quantity::Slide, 1.0, 1.09, 300.0, 5.0), rigid(Quantity::Slide, -1.0, 0.7, 0.3)];
    let phases = vec![(5.0, false, 1.0, 7), (5.0, false, 1.0, 1), (-5.0, false, 1.0, 11), (-9.0, false, 2.0, 3)];
    let scene =
        Scene { machine: Machine::Crank(0.5, 1.0), start: [-1.2, 2.5], stops: stops.to_vec(), lock: None, phases };
    let mut run = scene.run();
    run.set("load.torque", 5.0);
    run.steps(200, 3.0);
    let (angle, slide) = (run.get("crank.angle"), run.get("slide.position"));
    assert!(angle > 0.0 && (slide - 0.7).abs() < 1e-9, "{angle} {slide}");
    assert!(run.is("s1.reached") && !run.is("s0.reached"), "within the bumper again");
    assert_eq!(scene.compare().unwrap().0, 4);
}

/// At one place the rigid stop acts and the bumper is never compressed; each flag is true, each lock holds.
#[test]
fn stops_at_one_place() {
    // At x = 0.9 the distance is hypot(0.7, 0.7).
    let length = 0.7_f64.hypot(0.7);
    for (n, others) in [
        [bumper(Quantity::Slide, 1.0, 0.9, 3000.0, 10.0), rigid(Quantity::Slide, 1.0, 0.9, 0.5)],
        [bumper(Quantity::Distance, 1.0, length, 3000.0, 10.0), rigid(Quantity::Slide, 1.0, 0.9, 0.5)],
        [rigid(Quantity::Distance, 1.0, length, 0.5), rigid(Quantity::Slide, 1.0, 0.9, 0.5)],
        [rigid(Quantity::Slide, 1.0, 0.9, 0.5), bumper(Quantity::Distance, 1.0, length, 3000.0, 10.0)],
    ]
    .iter()
    .enumerate()
    {
        let mut stops = others.to_vec();
        stops.push(bumper(Quantity::Slide, 1.0, 0.6, 200.0, 3.0));
        for lock in [None, Some(0), Some(1)] {
            let mut scene = block(&stops);
            scene.lock = lock;
            let mut run = scene.run();
            run.set("load.force", 200.0);
            if lock.is_some() {
                run.set("latch.engage", true);
            }
            run.step(2.0);
            let x = run.get("slide.position");
            assert!((x - 0.9).abs() < 1e-12 && run.get("slide.speed") == 0.0, "{n} {lock:?}: {x}");
            assert!((0..3).all(|k| run.is(&format!("s{k}.reached"))), "{n} {lock:?}");
            for k in (0..2).filter(|&k| stops[k].rigid.is_none()) {
                assert_eq!(run.get(&format!("s{k}.force")), 0.0, "not compressed");
            }
            run.set("load.force", -200.0);
            if lock.is_some() {
                assert!((run.get("latch.force") - 140.0).abs() > 1.0 && run.get("latch.force") > 0.0);
            }
            run.step(0.01);
            assert_eq!(run.get("slide.position") == x, lock.is_some(), "{n} {lock:?}");
        }
    }
    // Bumpers at one place push together.
    let two = [bumper(Quantity::Slide, 1.0, 0.5, 1000.0, 3.0), bumper(Quantity::Slide, 1.0, 0.5, 2000.0, 6.0)];
    let (mut pair, mut sum) = (block(&two).run(), block(&[bumper(Quantity::Slide, 1.0, 0.5, 3000.0, 9.0)]).run());
    for run in [&mut pair, &mut sum] {
        run.set("load.force", 50.0);
        run.steps(30, 0.6);
    }
    let [a, b] = [&mut pair, &mut sum].map(|run| run.get("slide.position"));
    assert!((a - b).abs() < 1e-9 && a > 0.4, "{a} {b}");
}

/// Places closer and closer to each other.
#[test]
fn a_gap_between_bumper_and_stop_may_be_any() {
    for decade in 1..16 {
        let gap = 10f64.powi(-decade);
        for steps in [1, 50] {
            let stops = [bumper(Quantity::Slide, 1.0, 0.5, 1e5, 20.0), rigid(Quantity::Slide, 1.0, 0.5 + gap, 0.4)];
            let mut run = block(&stops).run();
            run.set("load.force", 1e5);
            run.steps(steps, 1.0);
            let x = run.get("slide.position");
            assert!(x <= 0.5 + gap + 1e-15 && x > 0.5 - 1e-12 && run.get("slide.speed").abs() < 1e-6, "{gap} {x}");
            assert!(run.is("s0.reached"), "{gap}");
            assert!(run.get("energy.drift").abs() < 1e-4, "{}", run.get("energy.drift"));
        }
    }
}

/// A lock at a bumper before a rigid stop catches the block on its way out, and on its way back if engaged beyond.
#[test]
fn a_lock_at_a_bumper_before_a_rigid_stop() {
    for damping in [0.0, 20.0] {
        let stops = [bumper(Quantity::Slide, 1.0, 0.5, 3000.0, damping), rigid(Quantity::Slide, 1.0, 0.51, 0.5)];
        let mut scene = block(&stops);
        scene.lock = Some(0);
        let mut run = scene.run();
        run.set("load.force", 100.0);
        run.set("latch.engage", true);
        run.steps(7, 1.0);
        // At the place, which is the stop's value but for one rounding.
        assert!((run.get("slide.position") - 0.5).abs() <= 0.5 * f64::EPSILON && run.get("slide.speed") == 0.0);
        assert!((run.get("latch.force") + 100.0).abs() < 1e-9);
        run.set("latch.engage", false);
        run.step(1.0);
        assert!(run.get("slide.position") > 0.505 && run.is("s0.reached"));
        run.set("latch.engage", true);
        run.set("load.force", -10.0);
        run.steps(3, 1.0);
        assert_eq!((run.get("slide.position"), run.get("slide.speed")), (0.5, 0.0), "{damping}");
        assert!((run.get("latch.force") - 10.0).abs() < 1e-9);
        assert!(run.get("energy.drift").abs() < 1e-9);
    }
}

/// A state saved while several bumpers push, at rest or not, goes on to the bit.
#[test]
fn a_saved_state_goes_on_with_all_its_contacts() {
    let stops = [
        bumper(Quantity::Slide, 1.0, 0.3, 300.0, 2.0),
        bumper(Quantity::Distance, 1.0, 0.75, 500.0, 0.0),
        bumper(Quantity::Slide, 1.0, 0.4, 100.0, 40.0),
        rigid(Quantity::Slide, 1.0, 0.55, 0.6),
        bumper(Quantity::Slide, -1.0, -0.2, 800.0, 3.0),
    ];
    let mut run = block(&stops).run();
    run.set("load.force", 180.0);
    for n in 0..120 {
        let saved = run.snapshot();
        let mut twin = block(&stops).run();
        twin.restore(&saved).unwrap();
        if n == 60 {
            run.set("load.force", -150.0);
        }
        twin.set("load.force", if n < 60 { 180.0 } else { -150.0 });
        run.step(5e-3);
        twin.step(5e-3);
        for name in ["slide.position", "slide.speed", "s0.force", "s1.force", "s2.force", "s3.force", "energy.drift"] {
            assert_eq!(run.get(name).to_bits(), twin.get(name).to_bits(), "{n} {name}");
        }
    }
}

#[test]
fn too_many_bumpers_are_refused() {
    let at = |k: usize| 1.0 + 0.01 * k as f64;
    let mut stops: Vec<Stop> = (0..65).map(|k| bumper(Quantity::Slide, 1.0, at(k), 1e3, 1.0)).collect();
    let refusal = Simulation::open(&block(&stops).definition()).err().unwrap();
    assert_says(refusal, &["65 bumpers", "64", "enabled", "rigid"]);
    stops[64] = rigid(Quantity::Slide, 1.0, at(64), 0.0);
    let mut run = block(&stops).run();
    run.set("load.force", 1e6);
    run.step(2.0);
    assert!((0..65).all(|k| run.is(&format!("s{k}.reached"))), "{}", run.get("slide.position"));
}

/// 5 ms of release in one step of 0.52 s, and any other.
#[test]
fn a_release_is_met_however_short() {
    let stops = [rigid(Quantity::Slide, -1.0, 0.0, 0.0)];
    let scene = Scene { machine: Machine::Block(2.0), ..block(&stops) };
    for (peak, bend, center, span) in
        [(1e4, 1.6e9, 0.5078, 0.52), (1.0, 1e6, 0.01, 0.02), (1e-2, 1e7, 0.3, 1.0), (1e3, 1e8, 7.77, 10.0)]
    {
        let half = f64::sqrt(peak / bend);
        // The speed of the way back to the stop is that of all steps shorter than the release.
        let mut ends = Vec::new();
        for cuts in [vec![center + half, span - center - half], vec![center - half, half, half, span - center - half]] {
            let mut run = scene.run();
            let mut t = 0.0;
            for h in cuts {
                run.set("load.force", peak - bend * (t - center) * (t - center));
                run.set_derivative("load.force", 1, -2.0 * bend * (t - center));
                run.set_derivative("load.force", 2, -2.0 * bend);
                run.step(h);
                t += h;
                if (t - center - half).abs() < 0.1 * half {
                    ends.push((run.get("slide.position"), run.get("slide.speed")));
                }
            }
        }
        let speed = 4.0 / 3.0 * peak * half / 2.0;
        for (x, v) in &ends {
            assert!((v - speed).abs() < 1e-3 * speed && *x > 0.0, "{peak} {bend}: {x} {v} {speed}");
        }
        assert_eq!(ends.len(), 2);
    }
}

/// Within a step that goes from one revolution of a closed curve to the next, a crank comes to rest at a stop there.
#[test]
fn rest_in_another_revolution_is_rest_at_the_stop() {
    let start = 1.0398903345316985;
    for k in 0..40 {
        let length = 0.46868801572172875 + 1e-3 * f64::from(k);
        let machine = Machine::Crank(0.4, 1.3750900431962578);
        let stop = rigid(Quantity::Distance, 1.0, length, 0.0);
        let scene = Scene { machine, start: [start, 0.0], stops: vec![stop], lock: None, phases: vec![] };
        for parts in [1, 7] {
            let mut run = scene.run();
            // The curve begins at the start, so the first step ends in the revolution before.
            run.set("load.torque", -10.515086458192942);
            run.step(0.02);
            run.set("load.torque", 76.0);
            (0..parts).for_each(|_| run.step(0.5 / f64::from(parts)));
            let [distance, _] = machine.quantity(Quantity::Distance, run.get("crank.angle"));
            assert!((distance - length).abs() < 1e-12 && run.get("crank.speed") == 0.0, "{distance} {length}");
            assert!(run.is("s0.reached"), "at {length} in {parts} steps");
        }
    }
}

/// From rest at a stop under its weight, lifted by a drive with losses whose force changes its sign, or by a wind that
/// turns: the instant of release in closed form, in one long step.
#[test]
fn a_release_by_a_drive_with_losses_or_by_the_wind_is_met() {
    let (g, efficiency, area): (f64, f64, f64) = (9.81, 0.5, 0.3);
    let scene = Scene { machine: Machine::Block(1.0), ..block(&[rigid(Quantity::Slide, -1.0, 0.0, 0.0)]) };
    let definition = changed(&scene.definition(), |json| {
        json["gravity"] = json!({ "acceleration": g, "up_angle": 0 });
        json["actuators"]["load"]["efficiency"] = json!(efficiency);
        json["air"] = json!({ "density": 1.2, "flow_angle": 0 });
        json["surfaces"] = json!({ "sail": { "at": "block.origin", "area": area, "drag_coefficient": 1 } });
    });
    // By how much the input passes what lifts the block, how fast it bends, where it is largest, the whole step.
    for (surplus, bend, center, span) in [(0.5, 1e3, 0.3, 1.0), (1e-3, 1e4, 4.321, 5.0), (1e-5, 300.0, 0.01, 2.0)] {
        let half = f64::sqrt(surplus / bend);
        let speed = f64::sqrt(g / (0.5 * 1.2 * area));
        for (input, least) in [("load.force", g / efficiency), ("airspeed", speed)] {
            let peak = least + surplus;
            let set = |run: &mut Run, t: f64| {
                run.set(input, peak - bend * (t - center) * (t - center));
                run.set_derivative(input, 1, -2.0 * bend * (t - center));
                run.set_derivative(input, 2, -2.0 * bend);
            };
            let mut run = Run::new(&definition).started();
            set(&mut run, 0.0);
            run.step(center - half * (1.0 + 1e-6));
            assert!(
                run.get("slide.position").abs() < 1e-15 && run.get("slide.speed") == 0.0,
                "{input} {surplus}: held"
            );
            // From there on in one long step, and in short ones, to the middle of the release.
            let mut run = Run::new(&definition).started();
            set(&mut run, 0.0);
            run.step(center);
            // The surplus of force: a parabola that grows from 0 to its peak over `half`.
            let lift = if input == "airspeed" { 1.2 * area * speed * surplus } else { efficiency * surplus };
            let expected = lift * half * (2.0 / 3.0);
            let v = run.get("slide.speed");
            assert!(
                (v - expected).abs() < (0.2 * surplus + 1e-6) * expected + 1e-15,
                "{input} {surplus}: {v} {expected}"
            );
            // The whole step holds the block again at its end, after a flight.
            let mut run = Run::new(&definition).started();
            set(&mut run, 0.0);
            run.step(span);
            assert!(run.get("slide.position").abs() < 1e-15 && run.get("slide.speed") == 0.0, "{input} {surplus}");
            assert!(run.get("energy.drift").abs() < 1e-9 && run.is("s0.reached"));
        }
    }
}

/// A four-bar linkage goes back beyond the place from which its curve is counted, and comes to rest at a stop on the
/// other side: its position is that of the stop to the bit, so that the flag is true and a lock that is engaged holds.
#[test]
fn rest_at_a_stop_is_at_the_stop_in_whatever_revolution_it_is_counted() {
    let definition = json!({
        "name": "Scene",
        "bodies": {
            "ground": { "points": { "a": [0.0, 0.0], "d": [0.45679669370187065, 0.0], "post": [0.2, 0.7] } },
            "crank": {
                "length": 0.35515352391385724, "mass": 5.383184001376022, "inertia": 0.07403431620696398,
                "center": [0.22042932275433227, -0.021492749518821644],
            },
            "coupler": {
                "length": 0.5651921891635404, "mass": 2.691592000688011, "inertia": 0.10780625084651567,
                "center": [0.19205191309471836, -0.018472289916182206],
            },
            "follower": {
                "length": 0.5234039169052543, "mass": 10.766368002752044, "inertia": 0.20005039601392613,
                "center": [0.2957000887509702, 0.03671456618773459],
            },
        },
        "joints": {
            "a": { "type": "revolute", "first": "ground.a", "second": "crank.origin" },
            "b": { "type": "revolute", "first": "crank.end", "second": "coupler.origin" },
            "c": { "type": "revolute", "first": "coupler.end", "second": "follower.end" },
            "d": { "type": "revolute", "first": "ground.d", "second": "follower.origin" },
        },
        "actuators": { "load": { "joint": "a" } },
        "stops": {
            "s0": {
                "body": "crank", "limit": "lower", "angle": -3.1020440638990388, "rigid": false,
                "stiffness": 10.507332165627965,
            },
            "s1": { "body": "crank", "limit": "upper", "angle": -2.2771213335831813 },
        },
        "locks": { "latch": { "stop": "s1", "at": "crank.end" } },
        "start": { "body": "crank", "angle": -2.348081666313255, "speed": -2.9501375040218285 },
        "guess": { "coupler": -0.42684736584334504, "crank": -2.348081666313255, "follower": -1.9451670171654327 },
        "solver": { "tolerance": 2.3004947677142523e-8 },
    });
    let mut run = Run::new(&definition.to_string()).started();
    run.set("load.torque", 43.30438005112297);
    run.steps(7, 0.32297009838491525);
    assert!((run.get("crank.angle") + 2.2771213335831813).abs() < 1e-14 && run.is("s1.reached"));
    run.set("latch.engage", true);
    run.set("load.torque", -40.0);
    run.steps(3, 0.5);
    assert!((run.get("crank.angle") + 2.2771213335831813).abs() < 1e-14 && run.is("s1.reached"));
    assert!(run.get("latch.force") != 0.0);
    run.set("latch.engage", false);
    run.step(0.1);
    assert!(!run.is("s1.reached"));
}
