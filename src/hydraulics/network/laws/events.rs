//! The events of a network: where a valve opens or reaches its end, a cushion begins, a lock releases or engages.
//!
//! In: the laws, a state. Out: guards of the events, whose signs change there; their words. It must not know time.
use super::{Law, Laws, Pilot};
use crate::events::Guard;
use crate::network::definition::HydraulicSystem;
use foundation::numerics::decimal::Decimal;

/// Events of the spool of a valve, and of the cushions of a cylinder.
const SPOOL: usize = 4;
const CUSHIONS: usize = 2;

/// What guards depend on.
pub struct Surroundings<'a> {
    /// Components of the state.
    pub y: &'a [f64],
    /// Length of a cylinder [m].
    pub length: &'a dyn Fn(usize) -> f64,
    /// Pressure of a reservoir [Pa].
    pub reservoir: &'a dyn Fn(usize) -> f64,
    /// Whether each lock is engaged.
    pub locks: &'a [bool],
}

/// An event, by the index of its element.
enum Event {
    Spool(usize, usize),
    Cushion(usize, usize),
    Path(usize),
    Lock(usize),
}

impl Laws {
    /// Number of events.
    pub fn event_count(&self) -> usize {
        SPOOL * self.valves.len() + CUSHIONS * self.cylinders.len() + self.paths.len() + self.locks.len()
    }

    fn event(&self, index: usize) -> Event {
        let cushions = SPOOL * self.valves.len();
        let paths = cushions + CUSHIONS * self.cylinders.len();
        let locks = paths + self.paths.len();
        match index {
            _ if index < cushions => Event::Spool(index / SPOOL, index % SPOOL),
            _ if index < paths => Event::Cushion((index - cushions) / CUSHIONS, (index - cushions) % CUSHIONS),
            _ if index < locks => Event::Path(index - paths),
            _ => Event::Lock(index - locks),
        }
    }

    /// Whether a step can come to an event.
    pub fn has_events(&self) -> bool {
        let opens = |law: &Law| match law {
            Law::Relief { .. } => true,
            Law::Gated { pilot, .. } => *pilot != Pilot::None,
            _ => false,
        };
        !self.cylinders.is_empty()
            || !self.locks.is_empty()
            || self.valves.iter().any(|valve| valve.dynamics.is_some())
            || self.paths.iter().any(|path| opens(&path.law))
    }

    /// Guard of an event, for a tolerance of the integration.
    pub fn guard(&self, index: usize, at: &Surroundings<'_>, tolerance: f64) -> Guard {
        let volumes = self.layout.volumes();
        let pressure = |port: usize| if port < volumes { at.y[port] } else { (at.reservoir)(port - volumes) };
        let of_pressure = |p: f64, level: f64| Guard::of(p, level, level.abs() + self.ambient, tolerance);
        let guard = match self.event(index) {
            Event::Spool(valve, which) => {
                let valve = &self.valves[valve];
                let levels = [valve.overlap, -valve.overlap, 1.0, -1.0];
                let is_new = which != 1 || valve.overlap != 0.0;
                let dynamics = valve.dynamics.filter(|_| is_new);
                dynamics.map(|(.., spool)| Guard::of(at.y[self.layout.spool(spool)], levels[which], 1.0, tolerance))
            }
            Event::Cushion(cylinder, side) => {
                let ([least, most], borders) = {
                    let laws = &self.cylinders[cylinder].laws;
                    (laws.lengths(), laws.borders())
                };
                borders[side].map(|border| Guard::of((at.length)(cylinder), border, most - least, tolerance))
            }
            Event::Path(path) => match (self.paths[path].law, self.paths[path]) {
                (Law::Relief { pressure: level, .. }, path) => Some(of_pressure(pressure(path.from), level)),
                (Law::Gated { pilot, .. }, path) => match pilot {
                    Pilot::None => None,
                    Pilot::Above { port, pressure: level, .. } => Some(of_pressure(pressure(port), level)),
                    Pilot::Position { cylinder, length, .. } => {
                        Some(Guard::of((at.length)(cylinder), length, length, tolerance))
                    }
                    Pilot::Ratio { port, ratio, .. } => {
                        Some(of_pressure(pressure(port) - pressure(path.to) * ratio, 0.0))
                    }
                    Pilot::Sum { port, ratio, pressure: level, .. } => {
                        Some(of_pressure(pressure(path.to) + pressure(port) * ratio, level))
                    }
                },
                _ => None,
            },
            Event::Lock(lock) => {
                let (engaged, lock) = (at.locks[lock], &self.locks[lock]);
                let p = at.y[lock.at];
                let excess = if engaged { p - lock.release } else { lock.engage - p };
                Some(Guard::due(excess, lock.release, tolerance))
            }
        };
        guard.unwrap_or(Guard::NONE)
    }

    /// An event in words, with the names of the elements. An index beyond all events: a cylinder at an end of its
    /// travel.
    #[cold]
    pub fn event_words(&self, index: usize, system: &HydraulicSystem) -> String {
        let cylinder = |index: usize| system.cylinders.names()[index];
        if index >= self.event_count() {
            return format!("cylinder {} reaches an end of its travel", cylinder(index - self.event_count()));
        }
        match self.event(index) {
            Event::Spool(valve, which) => {
                let places = [
                    "the metering edge at the positive overlap",
                    "the metering edge at the negative overlap",
                    "the end of its travel, 1",
                    "the end of its travel, -1",
                ];
                format!("the spool of {} is at {}", system.valves.names()[valve], places[which])
            }
            Event::Cushion(index, side) => {
                let side = ["A", "B"][side];
                format!("the piston of cylinder {} enters or leaves the cushion of chamber {side}", cylinder(index))
            }
            Event::Path(path) => {
                let name = path_names(system).nth(path).unwrap_or("a valve");
                format!("{name} opens or closes")
            }
            Event::Lock(lock) => format!("lock {} releases or engages", system.pressure_locks.names()[lock]),
        }
    }
}

/// The warning about an accumulator that contains no oil, with its pressure and its precharge pressure [Pa].
#[cold]
pub fn empty_words(name: &str, charge: [f64; 2]) -> String {
    let [pressure, precharge] = charge.map(Decimal::rounded);
    format!(
        "the accumulator {name} contains no oil: the pressure of {pressure} Pa at the accumulator is below the \
         precharge pressure of {precharge} Pa, and below the precharge pressure the equations of the accumulator are \
         not valid; use a larger accumulator or a larger pump"
    )
}

/// Names of the flow paths in the order of [`Laws::new`], but for the edges of valves, which come last.
fn path_names(system: &HydraulicSystem) -> impl Iterator<Item = &str> {
    (system.resistances.names().into_iter())
        .chain(system.checks.names())
        .chain(system.reliefs.names())
        .chain(system.priorities.names())
        .chain(system.sequences.names())
        .chain(system.pilot_checks.names())
        .chain(system.counterbalances.names())
        .chain(system.position_valves.names())
        .chain(system.bypasses.names())
}
