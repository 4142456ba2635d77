//! The source of tables: functions of the configuration with their natural sizes, evaluated along the curve.
//!
//! In: a curve, the loads on it. Out: components of the table of influences, tables of functions of the configuration.
//! The accuracy of a table is relative to the natural sizes if all values are smaller. It must not know states or
//! inputs.
use super::stored::Stored;
use crate::mechanism::curve::{Configuration, Curve, Scratch};
use crate::mechanism::linkage::Linkage;
use crate::mechanism::loads::laws::spring::Spring;
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::table::{Grid, Table, Unresolved};
use std::sync::Arc;

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

/// The curve and the loads from which all tables are built.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub(super) curve: Arc<Curve>,
    pub(super) loading: Arc<Loading>,
    pub(super) components: Components,
    /// Springs whose force is no function of the position: damped ones, and those that wind up.
    pub(super) active_springs: Arc<[usize]>,
    /// Length along the curve for a motion of 1 rad.
    pub(super) length: f64,
    /// Tables that were kept, if there are any.
    pub(super) stored: Option<Stored>,
}

/// Sizes of a spring's load in the components to which it contributes.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpringLoad {
    pub(super) load: usize,
    pub(super) at_rest: f64,
    /// Size for sigma_dot = 1.
    damping: f64,
    /// Size for one revolution.
    winding: f64,
}

impl Source {
    /// The loads on a curve, or on a stretch of one with this `length`.
    pub(super) fn new(curve: Arc<Curve>, loading: Arc<Loading>, length: Option<f64>) -> Self {
        let sized = loading.sized();
        let mut count = sized;
        let mut next = |exists: bool| {
            count += usize::from(exists);
            exists.then(|| count - 1)
        };
        let winds = |s: &Spring| loading.loads[s.load].growth(&curve) != 0.0;
        let springs = next(!loading.springs.is_empty());
        let damping = next(loading.springs.iter().any(|s| s.damping != 0.0));
        let winding = next(loading.springs.iter().any(winds));
        let components = Components { sized, springs, damping, winding, count };
        let is_active = |(_, spring): &(usize, &Spring)| spring.is_damped() || winds(spring);
        let active = loading.springs.iter().enumerate().filter(is_active).map(|(index, _)| index);
        let active_springs = active.collect();
        let length = length.unwrap_or_else(|| curve.scale());
        Self { curve, loading, components, active_springs, length, stored: None }
    }

    pub(super) fn linkage(&self) -> &Linkage {
        self.curve.linkage()
    }

    /// Springs whose force is a function of the position.
    pub(super) fn passive_springs(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.loading.springs.len()).filter(|index| !self.active_springs.contains(index))
    }

    /// Whether the characteristic of a spring is none of the position on the curve, as S grows over each revolution.
    pub(super) fn winds(&self, spring: &Spring) -> bool {
        spring.characteristic.is_some() && self.loading.loads[spring.load].growth(&self.curve) != 0.0
    }

    /// Natural sizes of a function of this size and of its two derivatives along sigma.
    pub(super) fn derivative_sizes(&self, size: f64) -> [f64; 3] {
        [size, size / self.length, size / self.length.powi(2)]
    }

    /// Natural sizes of all coordinates and their two derivatives along sigma.
    pub(super) fn coordinate_sizes(&self) -> Vec<f64> {
        let linkage = self.linkage();
        let size = |i: usize| if i < linkage.angles { 1.0 } else { linkage.size };
        (0..linkage.coordinates.len()).flat_map(|i| self.derivative_sizes(size(i))).collect()
    }

    /// Natural size of a load's displacement: for a motion of 1 rad.
    pub(super) fn displacement_size(&self, load: usize) -> f64 {
        self.size_of(&self.loading.loads[load])
    }

    /// [`Self::displacement_size`] of a load that the mechanism need not have.
    pub(super) fn size_of(&self, load: &Load) -> f64 {
        let linkage = self.linkage();
        match load {
            Load::Torque { .. } | Load::Couple { .. } => 1.0,
            Load::Force { .. }
            | Load::Pair { .. }
            | Load::Slide { .. }
            | Load::Separation { .. }
            | Load::Rub { .. } => linkage.size,
            Load::Screw { along, ratio } => ratio * self.size_of(along),
            Load::Gravity(acceleration) => {
                let mass: f64 = linkage.bodies.iter().map(|b| b.mass).sum();
                mass * acceleration.norm() * linkage.size
            }
        }
    }

    /// Natural size of each of the [`Components`].
    pub(super) fn influence_sizes(&self) -> Vec<f64> {
        let Self { components, length, .. } = self;
        let mut out: Vec<f64> = (0..components.sized).map(|load| self.displacement_size(load) / length).collect();
        out.resize(components.count, 0.0);
        for spring in &self.loading.springs {
            let s = self.displacement_size(spring.load);
            for (component, size) in [
                (components.springs, spring.force_scale(s) * s / length),
                (components.damping, spring.linear_power(s / length)),
                (components.winding, spring.winding_force(s) * s / length),
            ] {
                if let Some(k) = component {
                    out[k] += size;
                }
            }
        }
        out
    }

    /// Loads of all springs at a configuration.
    pub(super) fn spring_loads(&self, c: &Configuration, out: &mut Vec<SpringLoad>) {
        let Self { curve, loading, components, .. } = self;
        out.clear();
        out.extend(loading.springs.iter().map(|spring| {
            let load = &loading.loads[spring.load];
            let [s, s_sigma, _] = load.displacement(curve.linkage(), c);
            SpringLoad {
                load: spring.load,
                at_rest: if self.winds(spring) { -spring.linear_force(s) } else { -spring.force(s) },
                damping: spring.linear_damping(s_sigma),
                winding: components.winding.map_or(0.0, |_| -spring.winding_force(load.growth(curve))),
            }
        }));
    }

    /// Table of functions of the configuration of which some may be unbounded: exact if all are smooth, else with gaps.
    pub(super) fn tabulate_with_gaps(
        &self,
        grid: &Grid,
        sizes: Vec<f64>,
        exact: &mut dyn FnMut(&Configuration, &mut [f64]),
    ) -> Result<Table, Unresolved> {
        let (mut scratch, mut c) = (Scratch::default(), Configuration::default());
        Table::build_with_gaps(grid, sizes, &mut |sigma, values| {
            self.curve.configure(sigma, &mut scratch, &mut c);
            exact(&c, values);
            c.amplification
        })
    }

    /// Tables of sets of functions of the configuration with common evaluations; `sizes`: natural sizes of each set;
    /// `name`: of the section in which they may be kept, if they may.
    pub(super) fn tabulate(
        &self,
        name: Option<&str>,
        grid: &Grid,
        sizes: &[Vec<f64>],
        exact: &mut dyn FnMut(&Configuration, &mut [f64]),
    ) -> Vec<Result<Table, Unresolved>> {
        if let Some(tables) = self.stored.as_ref().zip(name).and_then(|(stored, name)| stored.tables(name, sizes)) {
            return tables;
        }
        let (mut scratch, mut c) = (Scratch::default(), Configuration::default());
        Table::build_all(grid, sizes, &mut |sigma, values| {
            self.curve.configure(sigma, &mut scratch, &mut c);
            exact(&c, values);
            c.amplification
        })
    }
}

impl Components {
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
