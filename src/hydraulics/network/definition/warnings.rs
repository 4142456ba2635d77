//! What is probably wrong with a network that runs.
//!
//! In: a definition whose numbers and connections are in order. Out: warnings. It must not know laws.
use super::{HydraulicSystem, Ports, PumpType};
use crate::plausibility::implausible;
use foundation::inspection::Finding;
use foundation::numerics::decimal::Decimal;
use std::fmt;

impl HydraulicSystem {
    /// The highest pressure that pumps and reservoirs give [Pa].
    fn highest(&self) -> f64 {
        let relief = self.reliefs.iter().fold(f64::INFINITY, |least, (_, relief)| relief.pressure.min(least));
        let of_pump = |pump: &super::Pump| match pump.r#type {
            PumpType::Compensated => pump.max_pressure,
            PumpType::Fixed => relief,
        };
        let pumps = self.pumps.iter().map(|(_, pump)| of_pump(pump));
        let given = self.reservoirs.iter().map(|(_, reservoir)| reservoir.pressure);
        let starts = self.nodes.iter().map(|(_, node)| node.start_pressure);
        pumps.chain(given).chain(starts).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Warnings about a network that is probably not the one that is meant.
    pub fn warnings(&self) -> Vec<Finding> {
        let (mut all, links, highest) = (self.supply_warnings(), self.links(), self.highest());
        let ports = Ports::new(self);
        let mut warn =
            |path: String, message: &dyn fmt::Display, remedy: &str| all.push(Finding::warning(path, message, remedy));
        let feeds = |port: &str, except: &str| {
            ports.find(port).is_some_and(|index| index >= ports.volumes)
                || links.iter().any(|link| {
                    link.port == port && link.name != except && (link.carries_flow() || link.group == "accumulators")
                })
        };
        for link in links.iter().filter(|link| link.group == "valves" && link.key == "return") {
            if !feeds(link.port, link.name) {
                let message = format_args!(
                    "nothing but this valve is connected to \"{}\", so the valve has no return line",
                    link.port
                );
                warn(link.path(), &message, "connect another element to this port, such as a reservoir");
            }
        }
        for name in &ports.names()[ports.nodes..ports.volumes] {
            if !feeds(name, "") {
                let (cylinder, side) = name.split_once('.').unwrap_or((name, ""));
                let message = format_args!(
                    "nothing is connected to chamber {side} of this cylinder, so the oil cannot leave the chamber"
                );
                warn(format!("cylinders.{cylinder}"), &message, "connect a valve or another element to this chamber");
            }
        }
        for (name, pump) in self.pumps.iter().filter(|(_, pump)| pump.r#type == PumpType::Fixed) {
            // The flow of a relief valve at a tenth above its pressure.
            let relief = |least: f64, (_, relief): (&str, &super::Relief)| {
                if relief.from == pump.to { least + 0.1 * relief.pressure * relief.conductance } else { least }
            };
            let flow = self.reliefs.iter().fold(0.0, relief);
            if flow < pump.max_flow {
                let message = format_args!(
                    "the largest flow of this pump is {} m3/s, but the relief valves at \"{}\" can discharge only {} \
                        m3/s at 10 % above their opening pressure",
                    Decimal(pump.max_flow),
                    pump.to,
                    Decimal::rounded(flow)
                );
                let remedy = "increase the conductance of a relief valve at the pump outlet, or use a compensated pump";
                warn(format!("pumps.{name}.max_flow"), &message, remedy);
            }
        }
        for (name, pump) in self.pumps.iter().filter(|(_, pump)| pump.r#type == PumpType::Compensated) {
            let below = self.reliefs.iter().find(|(_, one)| one.from == pump.to && one.pressure <= pump.full_pressure);
            if let Some((relief, one)) = below {
                let message = format_args!(
                    "the full pressure of this pump is {} Pa, above reliefs.{relief}.pressure = {} Pa: the relief \
                     valve opens before the flow of the pump falls",
                    Decimal(pump.full_pressure),
                    Decimal(one.pressure)
                );
                warn(
                    format!("pumps.{name}.full_pressure"),
                    &message,
                    "raise the pressure of the relief valve, or lower full_pressure",
                );
            }
        }
        for (name, accumulator) in self.accumulators.iter().filter(|(_, one)| one.precharge_pressure >= highest) {
            let message = format_args!(
                "the precharge pressure is {} Pa, but pumps, reservoirs and start pressures reach only {} Pa: the \
                    accumulator never takes oil",
                Decimal(accumulator.precharge_pressure),
                Decimal(highest)
            );
            warn(format!("accumulators.{name}.precharge_pressure"), &message, "lower the precharge pressure");
        }
        let lowest = self.reservoirs.iter().min_by(|(_, a), (_, b)| a.pressure.total_cmp(&b.pressure));
        for (name, accumulator) in self.accumulators.iter() {
            if let Some((tank, reservoir)) = lowest.filter(|(_, one)| accumulator.precharge_pressure <= one.pressure) {
                let message = format_args!(
                    "the precharge pressure is {} Pa, not above reservoirs.{tank}.pressure = {} Pa, the lowest \
                        pressure: the accumulator can never deliver all its oil",
                    Decimal(accumulator.precharge_pressure),
                    Decimal(reservoir.pressure)
                );
                warn(format!("accumulators.{name}.precharge_pressure"), &message, "raise the precharge pressure");
            }
        }
        for (name, valve) in self.position_valves.iter() {
            let Some(cylinder) = self.cylinders.get(&valve.cylinder) else { continue };
            let (lower, upper) = (cylinder.lower_limit, cylinder.upper_limit);
            let is_beyond = |low: f64, high: f64| (low, high) != (0.0, 0.0) && !(low..=high).contains(&valve.length);
            if is_beyond(lower, upper) {
                let message = format_args!(
                    "the valve switches at a cylinder length of {} m, but the limits of the cylinder {} are {} m and \
                        {} m: the cylinder never operates the valve",
                    Decimal(valve.length),
                    valve.cylinder,
                    Decimal(lower),
                    Decimal(upper)
                );
                let remedy = "state a length between lower_limit and upper_limit of the cylinder";
                warn(format!("position_valves.{name}.length"), &message, remedy);
            }
        }
        for (name, lock) in self.pressure_locks.iter().filter(|(_, one)| one.release_pressure >= highest) {
            let message = format_args!(
                "the release pressure is {} Pa, but pumps, reservoirs and start pressures reach only {} Pa: the lock \
                    never releases",
                Decimal(lock.release_pressure),
                Decimal(highest)
            );
            warn(format!("pressure_locks.{name}.release_pressure"), &message, "lower the release pressure");
        }
        self.clone().element_parameters(&mut |parameter, value| {
            let path = parameter.key.concat();
            if let Some((message, remedy)) = implausible(&path, *value) {
                warn(path, &message, remedy);
            }
        });
        let coarse = self.experiment.coarse();
        all.extend(coarse.map(|(key, message, remedy)| Finding::warning(key, message, remedy)));
        all
    }
}
