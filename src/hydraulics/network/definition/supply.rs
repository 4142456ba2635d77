//! What feeds the consumers of a network.
//!
//! In: a definition whose connections are in order. Out: warnings about valves and locks that no pressure reaches. It
//! must not know laws.
use super::{HydraulicSystem, Ports};
use foundation::inspection::Finding;

/// Remedy for a port without a supply.
const REMEDY: &str = "connect a pump, an accumulator, or a reservoir for the supply pressure";

impl HydraulicSystem {
    /// Warnings about a network without a supply, and about valves and locks that no supply reaches.
    pub(super) fn supply_warnings(&self) -> Vec<Finding> {
        let (ports, links, mut all) = (Ports::new(self), self.links(), Vec::new());
        let is_tank = |name: &str| {
            links.iter().any(|link| {
                link.port == name
                    && matches!((link.group, link.key), ("pumps", "from") | ("reliefs", "to") | ("valves", "return"))
            })
        };
        let outlets = links.iter().filter(|link| matches!(link.group, "pumps" | "accumulators") && link.key != "from");
        let fed = self.reservoirs.names().into_iter().filter(|name| !is_tank(name));
        let sources: Vec<&str> = outlets.map(|link| link.port).chain(fed).collect();
        if sources.is_empty() && !self.valves.is_empty() {
            let message = "nothing raises the pressure: the network has no pump, no accumulator and no reservoir other \
                           than those that take the return oil";
            all.push(Finding::warning("pumps", message, "add a pump, or a reservoir for the supply pressure"));
            return all;
        }
        // A load raises the pressure of a chamber.
        let mut reached = vec![false; ports.names().len()];
        reached[ports.nodes..ports.volumes].fill(true);
        self.spread(&ports, sources, &mut reached);
        for link in &links {
            let (is_lock, at) = (link.group == "pressure_locks", ports.find(link.port));
            let consumes =
                matches!((link.group, link.key), ("valves", "supply") | ("sequences" | "priorities", "from"));
            let Some(at) = at.filter(|at| (consumes || is_lock) && !reached[*at]) else { continue };
            let message = format!(
                "no pump, accumulator or reservoir for the supply pressure feeds \"{}\"{}",
                link.port,
                if is_lock { ": the lock never releases" } else { "" }
            );
            all.push(Finding::warning(link.path(), message, REMEDY));
            // What follows is fed by this port: one fault, one warning.
            reached[at] = true;
            self.spread(&ports, Vec::new(), &mut reached);
        }
        all
    }

    /// Mark the ports that oil from `sources` and from marked ports reaches. Oil in a reservoir has lost its pressure.
    fn spread(&self, ports: &Ports, sources: Vec<&str>, reached: &mut [bool]) {
        for at in sources.into_iter().filter_map(|name| ports.find(name)) {
            reached[at] = true;
        }
        let links = self.links();
        let sources: Vec<bool> = reached.to_vec();
        loop {
            let mut grows = false;
            for start in &links {
                let has_pressure = |at: usize| reached[at] && (at < ports.volumes || sources[at]);
                if !ports.find(start.port).is_some_and(has_pressure) {
                    continue;
                }
                for end in links.iter().filter(|end| (end.group, end.name) == (start.group, start.name)) {
                    let passes = match (start.group, start.key, end.key) {
                        ("valves", "supply", "a" | "b") | ("valves", "a" | "b", "return") => true,
                        ("valves" | "pumps" | "accumulators" | "pressure_locks", ..) => false,
                        (_, "pilot", _) | (_, _, "pilot") => false,
                        ("checks" | "reliefs" | "priorities" | "sequences", key, _) => key == "from",
                        _ => true,
                    };
                    if let (true, Some(to)) = (passes, ports.find(end.port)) {
                        grows |= !std::mem::replace(&mut reached[to], true);
                    }
                }
            }
            if !grows {
                return;
            }
        }
    }
}
