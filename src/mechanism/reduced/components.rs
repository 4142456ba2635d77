//! What the table of influences holds, and the natural sizes of everything that is tabulated.
use crate::mechanism::curve::{Configuration, Curve, Ends};
use crate::mechanism::linkage::Linkage;
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::loads::unit_load::Load;

/// Components of the influence table beyond one for each sized load; each is there only if the mechanism needs it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Components {
    /// Number of sized loads.
    pub sized: usize,
    /// Springs at rest: less the sum of pull times S_sigma.
    pub springs: Option<usize>,
    /// Dampers: the sum of damping times S_sigma^2, a force for each unit of sigma_dot.
    pub damping: Option<usize>,
    /// What each whole turn adds to the springs, where a torsional spring winds up.
    pub winding: Option<usize>,
    /// Number of components.
    pub count: usize,
}

/// Natural sizes, to which the accuracy of tables is related where the values themselves are small.
#[derive(Clone, Copy, Debug)]
pub(super) struct Natural {
    /// Length along the curve that goes with a motion of the size of one radian.
    pub(super) scale: f64,
}

impl Natural {
    pub(super) fn new(curve: &Curve) -> Self {
        Self { scale: curve.scale() }
    }

    /// Of a function with this size, and of its two derivatives along sigma.
    pub(super) fn derivatives(&self, size: f64) -> [f64; 3] {
        [size, size / self.scale, size / self.scale.powi(2)]
    }

    /// Of every coordinate and its two derivatives along sigma.
    pub(super) fn coordinates(&self, linkage: &Linkage) -> Vec<f64> {
        let size = |i: usize| if i < linkage.angles { 1.0 } else { linkage.size };
        (0..linkage.coordinates.len()).flat_map(|i| self.derivatives(size(i))).collect()
    }

    /// Of a load's displacement in a motion of the size of one radian.
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

/// Sizes of a spring's load in each of its components.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull {
    load: usize,
    at_rest: f64,
    /// For each unit of sigma_dot.
    damping: f64,
    /// For each whole turn.
    winding: f64,
}

impl Components {
    /// Natural size of each component.
    pub(super) fn sizes(&self, loading: &Loading, curve: &Curve, natural: &Natural) -> Vec<f64> {
        let mut out = vec![0.0; self.count];
        let displacement = |load: usize| natural.displacement(&loading.loads[load], curve.linkage());
        for (load, size) in out[..self.sized].iter_mut().enumerate() {
            *size = displacement(load) / natural.scale;
        }
        for spring in &loading.springs {
            let s = displacement(spring.load);
            let mut add = |component: Option<usize>, value: f64| {
                if let Some(k) = component {
                    out[k] += value;
                }
            };
            add(self.springs, (spring.preload.abs() + spring.stiffness * s) * s / natural.scale);
            add(self.damping, spring.damping * (s / natural.scale).powi(2));
            add(self.winding, spring.stiffness * s * s / natural.scale);
        }
        out
    }

    pub(super) fn new(loading: &Loading, curve: &Curve) -> Self {
        let mut count = loading.sized();
        let mut next = |there: bool| {
            count += usize::from(there);
            there.then(|| count - 1)
        };
        let springs = next(!loading.springs.is_empty());
        let damping = next(loading.springs.iter().any(|s| s.damping != 0.0));
        let winds = |s: &crate::mechanism::loads::resolved::Spring| winding(loading, curve, s) != 0.0;
        let winding = next(loading.springs.iter().any(winds));
        Self { sized: loading.sized(), springs, damping, winding, count }
    }

    /// What every spring does at a configuration.
    pub(super) fn pulls(&self, loading: &Loading, curve: &Curve, c: &Configuration, pulls: &mut Vec<Pull>) {
        pulls.clear();
        pulls.extend(loading.springs.iter().map(|spring| {
            let [s, s_sigma, _] = loading.loads[spring.load].displacement(curve.linkage(), c);
            Pull {
                load: spring.load,
                at_rest: -spring.force(s),
                damping: spring.damping * s_sigma,
                winding: self.winding.map_or(0.0, |_| -spring.stiffness * winding(loading, curve, spring)),
            }
        }));
    }

    /// The components of whatever each load of unit size has this `effect` on.
    pub(super) fn fill_effects(&self, pulls: &[Pull], effect: impl Fn(usize) -> f64, values: &mut [f64]) {
        values[self.sized..].fill(0.0);
        for (load, value) in values[..self.sized].iter_mut().enumerate() {
            *value = effect(load);
        }
        for pull in pulls {
            let of_pull = effect(pull.load);
            for (component, factor) in
                [(self.springs, pull.at_rest), (self.damping, pull.damping), (self.winding, pull.winding)]
            {
                if let Some(k) = component {
                    values[k] += factor * of_pull;
                }
            }
        }
    }
}

/// How far a spring winds up over one turn of a closed curve.
fn winding(loading: &Loading, curve: &Curve, spring: &crate::mechanism::loads::resolved::Spring) -> f64 {
    match curve.ends() {
        Ends::Closed(growth) => loading.loads[spring.load].growth(curve.linkage(), &|turn| growth[turn]),
        Ends::Open | Ends::Stopped { .. } => 0.0,
    }
}
