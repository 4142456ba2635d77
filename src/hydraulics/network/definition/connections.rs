//! What the elements of a network must be to each other.
//!
//! In: a definition whose numbers are in range. Out: faults of names and connections. It must not know
//! laws.
use super::{
    CAPACITY, HydraulicSystem, MOST_COMPONENTS, MOST_CYLINDERS, MOST_PATHS, MOST_VALVES, Ports, PumpType, TOTALS,
};
use crate::definition::check_pressure;
use foundation::format::{DefinitionError, Faults, Range};
use foundation::numerics::decimal::Decimal;
use foundation::variables::nearest;

/// Least part of the travel over which a position valve opens [m]: less is no more than rounding of a length.
const LEAST_WIDTH: f64 = 1e-9;

/// A port that an element names.
pub struct Link<'a> {
    pub group: &'static str,
    pub name: &'a str,
    pub key: &'static str,
    pub port: &'a str,
}

impl Link<'_> {
    pub fn path(&self) -> String {
        format!("{}.{}.{}", self.group, self.name, self.key)
    }

    /// Whether oil passes; a pilot, a lock and an accumulator only feel the pressure.
    pub fn carries_flow(&self) -> bool {
        !matches!(self.key, "pilot" | "at")
    }
}

impl HydraulicSystem {
    /// The ports that all elements name, in the order of the file.
    pub fn links(&self) -> Vec<Link<'_>> {
        let mut all = Vec::new();
        macro_rules! links {
            ($($group:ident: $($key:ident)*;)*) => {$(
                for (name, element) in self.$group.iter() {
                    let group = stringify!($group);
                    $({
                        let key = stringify!($key).trim_start_matches("r#");
                        all.push(Link { group, name, key, port: &element.$key });
                    })*
                }
            )*};
        }
        links! {
            pumps: from to;
            accumulators: at;
            resistances: from to;
            checks: from to;
            reliefs: from to;
            priorities: from to;
            sequences: from to pilot;
            pilot_checks: from to pilot;
            counterbalances: from to pilot;
            position_valves: from to;
            bypasses: from to;
            valves: supply r#return a b;
            pressure_locks: at;
        }
        all
    }

    /// Faults of names, sizes and connections.
    pub(super) fn find_connection_faults(&self, faults: &mut Faults) {
        let (ports, links) = (Ports::new(self), self.links());
        self.find_name_faults(faults);
        for link in &links {
            match ports.find(link.port) {
                None => faults.push(unknown(&ports, link)),
                Some(port)
                    if port >= ports.volumes && matches!((link.group, link.key), ("pumps", "to") | (_, "at")) =>
                {
                    let allowed = "a node, or a chamber such as cylinder.a, but not a reservoir, because the pressure \
                        of a reservoir is an input";
                    faults.push(DefinitionError::value(link.path(), format!("\"{}\"", link.port), allowed));
                }
                Some(_) => {}
            }
        }
        for (index, link) in links.iter().enumerate().filter(|(_, link)| link.carries_flow()) {
            let of_same = |other: &&Link<'_>| {
                other.group == link.group && other.name == link.name && other.port == link.port && other.carries_flow()
            };
            if let Some(other) = links[..index].iter().find(of_same) {
                let message = format_args!(
                    "\"{}\" is also connected to port {} of this element; connect each port of an element to a \
                     different reservoir, node or chamber",
                    link.port, other.key
                );
                faults.refuse(link.path(), message);
            }
            // A node may serve several valves; a chamber has one.
            let is_working =
                |one: &Link<'_>| one.group == "valves" && matches!(one.key, "a" | "b") && one.port.contains('.');
            let of_other = |other: &&Link<'_>| is_working(other) && other.name != link.name && other.port == link.port;
            if let (true, Some(other)) = (is_working(link), links[..index].iter().find(of_other)) {
                let message = format_args!(
                    "\"{}\" is already connected to {}; connect only one valve to a chamber, or connect both valves to \
                        a node",
                    link.port,
                    other.path()
                );
                faults.refuse(link.path(), message);
            }
        }
        self.find_size_faults(&ports, faults);
        self.find_number_faults(faults);
    }

    fn find_name_faults(&self, faults: &mut Faults) {
        let mut names: Vec<(&'static str, String)> = Vec::new();
        self.elements(&mut |group, name| {
            let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
            if !name.starts_with(|c: char| c.is_ascii_alphabetic()) || !name.chars().all(is_word) {
                let allowed = "a word: ASCII letters, digits and underscores, starting with a letter";
                faults.push(DefinitionError::value(format_args!("{group}.{name}"), format!("\"{name}\""), allowed));
            }
            if let Some((other, _)) = names.iter().find(|(_, known)| known == name) {
                let message = format_args!(
                    "the element {other}.{name} already has this name; give each element a different name"
                );
                faults.refuse(format_args!("{group}.{name}"), message);
            }
            names.push((group, name.to_owned()));
        });
    }

    /// Refuse a network that is too large to be integrated with a mechanism as one system.
    ///
    /// # Errors
    /// The number of components and the limit.
    pub fn check_size_in_mechanism(&self) -> Result<(), DefinitionError> {
        let ports = Ports::new(self);
        for (what, count) in [
            ("components of the state", ports.volumes + 2 * self.spools() + TOTALS + 1 + self.pressure_locks.len()),
            ("inputs", self.inputs_of_flows()),
            ("ports", ports.names().len()),
        ] {
            if count > CAPACITY {
                let message = format_args!(
                    "the network has {count} {what}, but at most {CAPACITY} are allowed in a mechanism: simplify the \
                     network, or package mechanism and network as two FMUs"
                );
                return Err(DefinitionError::key("hydraulics", message));
            }
        }
        Ok(())
    }

    /// Number of inputs that act on flows.
    fn inputs_of_flows(&self) -> usize {
        self.reservoirs.len() + self.pumps.len() + self.valves.len() + self.bypasses.len()
    }

    /// Number of valves with dynamics.
    fn spools(&self) -> usize {
        self.valves.iter().filter(|(_, valve)| valve.frequency.is_some()).count()
    }

    fn find_size_faults(&self, ports: &Ports, faults: &mut Faults) {
        let paths = self.path_count() + self.pumps.len();
        let components = ports.volumes + 2 * self.spools() + 4 * self.cylinders.len() + TOTALS;
        for (key, what, count, most) in [
            ("cylinders", "cylinders", self.cylinders.len(), MOST_CYLINDERS),
            ("valves", "valves", self.valves.len(), MOST_VALVES),
            ("nodes", "state variables", components, MOST_COMPONENTS),
            ("nodes", "ports", ports.names().len(), MOST_COMPONENTS),
            ("valves", "inputs of reservoirs, pumps, valves and by-passes", self.inputs_of_flows(), MOST_COMPONENTS),
            ("resistances", "flow paths (four in each valve)", paths, MOST_PATHS),
        ] {
            if count > most {
                let message = format_args!(
                    "the network has {count} {what}, but at most {most} are allowed: split the network into two FMUs"
                );
                faults.refuse(key, message);
            }
        }
        if self.nodes.is_empty() && self.cylinders.is_empty() {
            faults.refuse("nodes", "the network has neither a node nor a cylinder: add a node or a cylinder");
        }
    }

    /// Number of flow paths without pumps.
    pub fn path_count(&self) -> usize {
        self.resistances.len()
            + self.checks.len()
            + self.reliefs.len()
            + self.priorities.len()
            + self.sequences.len()
            + self.pilot_checks.len()
            + self.counterbalances.len()
            + self.position_valves.len()
            + self.bypasses.len()
            + 4 * self.valves.len()
    }

    fn find_number_faults(&self, faults: &mut Faults) {
        let ambient = self.fluid.ambient_pressure;
        let mut pressure = |path: String, value: f64| faults.keep(check_pressure(&path, value, ambient));
        for (name, reservoir) in self.reservoirs.iter() {
            pressure(format!("reservoirs.{name}.pressure"), reservoir.pressure);
        }
        for (name, node) in self.nodes.iter() {
            pressure(format!("nodes.{name}.start_pressure"), node.start_pressure);
        }
        for (name, cylinder) in self.cylinders.iter() {
            for (side, chamber) in [("a", &cylinder.chamber_a), ("b", &cylinder.chamber_b)] {
                pressure(format!("cylinders.{name}.chamber_{side}.start_pressure"), chamber.start_pressure);
            }
        }
        for (name, accumulator) in self.accumulators.iter() {
            pressure(format!("accumulators.{name}.precharge_pressure"), accumulator.precharge_pressure);
        }
        for (name, node) in self.nodes.iter() {
            let path = |key: &str| format!("nodes.{name}.{key}");
            if node.volume == 0.0 {
                let allowed = "> 0 m3, because the pressure of a node without a volume cannot be integrated; write the \
                               volume of the lines at this node";
                faults.push(DefinitionError::value(path("volume"), 0, allowed));
            } else if node.hose_volume > node.volume {
                let allowed = format_args!(
                    "at most {} m3, the volume of the node, because the hose volume is part of the node volume",
                    Decimal(node.volume)
                );
                faults.push(DefinitionError::value(path("hose_volume"), Decimal(node.hose_volume), allowed));
            }
        }
        for (name, pump) in self.pumps.iter() {
            if pump.r#type == PumpType::Compensated && pump.max_pressure <= pump.full_pressure {
                let allowed = format_args!("above full_pressure = {} Pa", Decimal(pump.full_pressure));
                let path = format!("pumps.{name}.max_pressure");
                faults.push(DefinitionError::value(path, Decimal(pump.max_pressure), allowed));
            }
        }
        for (name, valve) in self.valves.iter() {
            if !(-1.0..=1.0).contains(&valve.command) {
                let path = format!("valves.{name}.command");
                faults.push(DefinitionError::value(path, Decimal(valve.command), "a number from -1 to 1"));
            }
        }
        for (name, bypass) in self.bypasses.iter() {
            faults.keep(Range::Unit.check(format_args!("bypasses.{name}.open"), bypass.open));
        }
        for (name, cylinder) in self.cylinders.iter() {
            let path = |key: &str| format!("cylinders.{name}.{key}");
            if cylinder.rod >= cylinder.bore {
                let allowed =
                    format_args!("below bore = {} m; otherwise chamber B has no area", Decimal(cylinder.bore));
                faults.push(DefinitionError::value(path("rod"), Decimal(cylinder.rod), allowed));
            }
            for (side, chamber) in [("a", &cylinder.chamber_a), ("b", &cylinder.chamber_b)] {
                if chamber.hose_volume > chamber.dead_volume {
                    let allowed = format_args!(
                        "at most dead_volume = {} m3, because the hose volume is part of the dead volume",
                        Decimal(chamber.dead_volume)
                    );
                    let path = path(&format!("chamber_{side}.hose_volume"));
                    faults.push(DefinitionError::value(path, Decimal(chamber.hose_volume), allowed));
                }
            }
            let [least, most] = cylinder.lengths();
            if let Some(length) = cylinder.length.filter(|length| !(least..=most).contains(length)) {
                let allowed = format_args!(
                    "from closed_length = {} m to closed_length + stroke = {} m",
                    Decimal(least),
                    Decimal::rounded(most)
                );
                faults.push(DefinitionError::value(path("length"), Decimal(length), allowed));
            }
        }
        for (name, valve) in self.position_valves.iter() {
            let path = |key: &str| format!("position_valves.{name}.{key}");
            match self.cylinders.iter().find(|(cylinder, _)| *cylinder == valve.cylinder) {
                None => {
                    let near = nearest(self.cylinders.names().into_iter(), &valve.cylinder);
                    let allowed = match near.is_empty() {
                        true => "add a cylinder of this name under `cylinders`".to_owned(),
                        false => format!("write the name of a cylinder of this file, such as {}", near.join(" or ")),
                    };
                    faults.push(DefinitionError::unknown(path("cylinder"), &valve.cylinder, allowed));
                }
                Some((_, cylinder)) => {
                    let [least, most] = cylinder.lengths();
                    if !(least..=most).contains(&valve.length) {
                        let allowed = format_args!(
                            "within the travel of the cylinder, from {} m to {} m",
                            Decimal(least),
                            Decimal::rounded(most)
                        );
                        faults.push(DefinitionError::value(path("length"), Decimal(valve.length), allowed));
                    }
                    if !(LEAST_WIDTH..=cylinder.stroke).contains(&valve.width) {
                        let allowed = format_args!(
                            "from {LEAST_WIDTH:e} m to {} m, the stroke of {}: the valve opens over this part of the \
                             travel",
                            Decimal(cylinder.stroke),
                            valve.cylinder
                        );
                        faults.push(DefinitionError::value(path("width"), Decimal(valve.width), allowed));
                    }
                }
            }
        }
        for (name, cylinder) in self.cylinders.iter() {
            let inputs = [
                ("speed", Range::Finite, cylinder.speed),
                ("reduced_mass", Range::NonNegative, cylinder.reduced_mass),
                ("holding_force", Range::Finite, cylinder.holding_force),
                ("lower_limit", Range::NonNegative, cylinder.lower_limit),
                ("upper_limit", Range::NonNegative, cylinder.upper_limit),
            ];
            for (key, range, value) in inputs {
                faults.keep(range.check(format_args!("cylinders.{name}.{key}"), value));
            }
        }
        for (name, lock) in self.pressure_locks.iter() {
            if lock.hysteresis > lock.release_pressure {
                let allowed = format_args!("at most release_pressure = {} Pa", Decimal(lock.release_pressure));
                let path = format!("pressure_locks.{name}.hysteresis");
                faults.push(DefinitionError::value(path, Decimal(lock.hysteresis), allowed));
            }
        }
    }
}

impl super::Cylinder {
    /// Least and largest length [m].
    pub fn lengths(&self) -> [f64; 2] {
        [self.closed_length, self.closed_length + self.stroke]
    }
}

/// A port that nothing has.
fn unknown(ports: &Ports, link: &Link<'_>) -> DefinitionError {
    let near = nearest(ports.names().iter().map(String::as_str), link.port);
    let allowed = match near.is_empty() {
        true => "declare this port under nodes with a volume, or under reservoirs".to_owned(),
        false => format!(
            "the most similar names are {}; declare a node with a volume, or write the name of a port",
            near.join(", ")
        ),
    };
    DefinitionError::unknown(link.path(), link.port, allowed)
}
