//! Random scenes: their definition, and the comparison of a run with the oracle.

use super::oracle::{CRANK, Held, Machine, Oracle, POST, Quantity, ROD, Stop};
use crate::support::Run;
use crate::support::definition::{self, With};
use proptest::prelude::*;
use serde_json::{Value, json};

/// A scene: a machine with its start, its stops, and a sequence of loads.
#[derive(Clone, Debug)]
pub struct Scene {
    pub machine: Machine,
    pub start: [f64; 2],
    pub stops: Vec<Stop>,
    /// Stop that has a lock.
    pub lock: Option<usize>,
    /// Load, whether the lock is engaged, duration [s], number of communication steps.
    pub phases: Vec<(f64, bool, f64, u32)>,
}

impl Scene {
    pub fn definition(&self) -> String {
        let stops = self.stops.iter().enumerate().map(|(k, stop)| {
            let mut out = match (self.machine, stop.quantity) {
                (_, Quantity::Slide) | (Machine::Block(_), Quantity::Angle) => {
                    json!({ "joint": self.slide(), "position": stop.value })
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
        let (machine, drive) = match self.machine {
            Machine::Block(mass) => (definition::block(mass).with(json!({ "guess": { "slide": y } })), "slide"),
            Machine::Crank(inertia, mass) => {
                let (crank, rod) = (json!({ "length": CRANK, "inertia": inertia }), json!({ "length": ROD }));
                (definition::slider_crank([crank, rod, json!({ "mass": mass })], y), "bearing")
            }
        };
        let start = if drive == "slide" { "position" } else { "angle" };
        let mut out = machine.with(json!({
            "bodies": { "ground": { "points": { "post": POST } } },
            "actuators": { "load": { "joint": drive } }, "start": { start: y, "speed": v },
        }));
        out["name"] = json!("Stops");
        out["stops"] = stops;
        if let Some(stop) = self.lock {
            out["locks"] = json!({ "latch": { "stop": format!("s{stop}"), "at": "block.origin" } });
        }
        out["solver"] = json!({ "tolerance": 1e-11 });
        out.to_string()
    }

    /// Name of the prismatic joint.
    fn slide(&self) -> &'static str {
        if matches!(self.machine, Machine::Block(_)) { "slide" } else { "guide" }
    }

    pub fn run(&self) -> Run {
        Run::new(self.definition()).started()
    }

    pub fn names(&self) -> [&'static str; 3] {
        match self.machine {
            Machine::Block(_) => ["slide.position", "slide.speed", "load.force"],
            Machine::Crank(..) => ["crank.angle", "crank.speed", "load.torque"],
        }
    }

    pub fn oracle(&self, h: f64, perturbation: f64) -> Oracle {
        let ([y, v], touching) = (self.start, vec![false; self.stops.len()]);
        let (machine, stops) = (self.machine, self.stops.clone());
        Oracle {
            machine,
            stops,
            y,
            v: v * (1.0 + perturbation),
            touching,
            held: None,
            lock: None,
            h,
            perturbation,
            grazed: false,
        }
    }

    /// Compare the run with two oracles. The difference of the oracles is a bound on their errors. Returns the number
    /// of phases that could be compared, and the largest number of stops that were reached at once.
    pub fn compare(&self) -> Result<(u32, usize), TestCaseError> {
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

/// A stop at a distance from the start value of its quantity.
pub fn stop() -> impl Strategy<Value = (u8, bool, f64, Option<f64>, f64, f64)> {
    let rigid = proptest::option::weighted(0.3, 0.0..=1.0f64);
    let damping = prop_oneof![Just(0.0), 0.1..60.0f64];
    (0..3u8, any::<bool>(), 0.02..0.35f64, rigid, 1.7..3.7f64, damping)
}

pub fn scene() -> impl Strategy<Value = Scene> {
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

pub fn bumper(quantity: Quantity, sign: f64, value: f64, stiffness: f64, damping: f64) -> Stop {
    Stop { quantity, sign, value, rigid: None, stiffness, damping }
}

pub fn rigid(quantity: Quantity, sign: f64, value: f64, restitution: f64) -> Stop {
    Stop { quantity, sign, value, rigid: Some(restitution), stiffness: 0.0, damping: 0.0 }
}

/// A block of 1 kg that starts from rest at 0.
pub fn block(stops: &[Stop]) -> Scene {
    Scene { machine: Machine::Block(1.0), start: [0.0; 2], stops: stops.to_vec(), lock: None, phases: Vec::new() }
}
