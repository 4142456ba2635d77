//! Components of the table of influences, and natural sizes of all tabulated functions.
//!
//! In: the loads, a configuration. Out: the components' values and natural sizes. It must not know tables.
use crate::mechanism::curve::{Configuration, Curve, Ends};
use crate::mechanism::linkage::Linkage;
use crate::mechanism::loads::laws::spring::Spring;
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::loads::unit_load::Load;

/// Components of the influence table after those of the applied loads; each exists only if the mechanism needs it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Components {
    /// Number of applied loads.
    pub sized: usize,
    /// Springs at rest: minus the sum of spring force times S_sigma.
    pub springs: Option<usize>,
    /// Dampers: the sum of damping times S_sigma^2, a force for each unit of sigma_dot.
    pub damping: Option<usize>,
    /// Change of the springs' component for each revolution of a closed curve, with torsional springs that wind up.
    pub winding: Option<usize>,
    /// Number of components.
    pub count: usize,
}

/// Natural sizes of functions along the curve. The accuracy of a table is relative to them if all values are smaller.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Length along the curve for a motion of 1 rad.
    pub(super) length: f64,
}

impl Scale {
    /// Sizes of a function of this size and of its two derivatives along sigma.
    pub(super) fn derivatives(&self, size: f64) -> [f64; 3] {
        [size, size / self.length, size / self.length.powi(2)]
    }

    /// Sizes of all coordinates and their two derivatives along sigma.
    pub(super) fn coordinates(&self, linkage: &Linkage) -> Vec<f64> {
        let size = |i: usize| if i < linkage.angles { 1.0 } else { linkage.size };
        (0..linkage.coordinates.len()).flat_map(|i| self.derivatives(size(i))).collect()
    }

    /// Size of a load's displacement for a motion of 1 rad.
    pub(super) fn displacement(&self, load: &Load, linkage: &Linkage) -> f64 {
        match load {
            Load::Torque { .. } | Load::Couple { .. } => 1.0,
            Load::Force { .. } | Load::Pair { .. } | Load::Slide { .. } => linkage.size,
            Load::Gravity(acceleration) => {
                let mass: f64 = linkage.bodies.iter().map(|b| b.mass).sum();
                mass * acceleration.norm() * linkage.size
            }
        }
    }
}

/// Sizes of a spring's load in the components to which it contributes.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpringLoad {
    load: usize,
    at_rest: f64,
    /// Size for sigma_dot = 1.
    damping: f64,
    /// Size for one revolution.
    winding: f64,
}

impl Components {
    pub(super) fn new(loading: &Loading, curve: &Curve) -> Self {
        let mut count = loading.sized();
        let mut next = |exists: bool| {
            count += usize::from(exists);
            exists.then(|| count - 1)
        };
        let springs = next(!loading.springs.is_empty());
        let damping = next(loading.springs.iter().any(Spring::is_damped));
        let winding = next(loading.springs.iter().any(|s| winding(loading, curve, s) != 0.0));
        Self { sized: loading.sized(), springs, damping, winding, count }
    }

    /// Natural size of each component.
    pub(super) fn sizes(&self, loading: &Loading, curve: &Curve, scale: &Scale) -> Vec<f64> {
        let mut out = vec![0.0; self.count];
        let displacement = |load: usize| scale.displacement(&loading.loads[load], curve.linkage());
        for (load, size) in out[..self.sized].iter_mut().enumerate() {
            *size = displacement(load) / scale.length;
        }
        for spring in &loading.springs {
            let s = displacement(spring.load);
            let mut add = |component: Option<usize>, value: f64| {
                if let Some(k) = component {
                    out[k] += value;
                }
            };
            add(self.springs, spring.force_scale(s) * s / scale.length);
            add(self.damping, spring.lost_power(s / scale.length));
            add(self.winding, spring.force_change(s, 0.0) * s / scale.length);
        }
        out
    }

    /// Loads of all springs at a configuration.
    pub(super) fn spring_loads(&self, loading: &Loading, curve: &Curve, c: &Configuration, out: &mut Vec<SpringLoad>) {
        out.clear();
        out.extend(loading.springs.iter().map(|spring| {
            let [s, s_sigma, _] = loading.loads[spring.load].displacement(curve.linkage(), c);
            SpringLoad {
                load: spring.load,
                at_rest: -spring.force(s),
                damping: spring.damping_force(s_sigma),
                winding: self.winding.map_or(0.0, |_| -spring.force_change(winding(loading, curve, spring), 0.0)),
            }
        }));
    }

    /// Values of the components of a quantity, where `effect` is the quantity's value for each load of unit size.
    pub(super) fn fill(&self, springs: &[SpringLoad], effect: impl Fn(usize) -> f64, values: &mut [f64]) {
        values[self.sized..].fill(0.0);
        for (load, value) in values[..self.sized].iter_mut().enumerate() {
            *value = effect(load);
        }
        for spring in springs {
            let unit = effect(spring.load);
            for (component, size) in
                [(self.springs, spring.at_rest), (self.damping, spring.damping), (self.winding, spring.winding)]
            {
                if let Some(k) = component {
                    values[k] += size * unit;
                }
            }
        }
    }
}

/// Growth of a spring's displacement over one revolution of a closed curve; 0 for another curve.
fn winding(loading: &Loading, curve: &Curve, spring: &Spring) -> f64 {
    match &curve.ends {
        Ends::Closed(growth) => loading.loads[spring.load].growth(curve.linkage(), &|angle| growth[angle]),
        Ends::Open | Ends::Stopped { .. } => 0.0,
    }
}
