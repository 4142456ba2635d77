//! The source of tables: functions of the configuration, evaluated along the curve.
//!
//! In: a curve, the loads on it. Out: tables of functions of the configuration. It must not know what is tabulated.
use super::components::{Components, Scale};
use crate::mechanism::curve::{Configuration, Curve, Scratch};
use crate::mechanism::linkage::Linkage;
use crate::mechanism::loads::resolved::Loading;
use crate::numerics::table::{Grid, Table, Unresolved};
use std::sync::Arc;

/// The curve and the loads from which all tables are built.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) curve: Arc<Curve>,
    pub(super) loading: Loading,
    pub(super) components: Components,
    pub(super) scale: Scale,
}

impl Source {
    pub(super) fn new(curve: Arc<Curve>, loading: Loading) -> Self {
        let components = Components::new(&loading, &curve);
        let scale = Scale { length: curve.scale() };
        Self { curve, loading, components, scale }
    }

    pub(super) fn linkage(&self) -> &Linkage {
        self.curve.linkage()
    }

    /// Natural size of a load's displacement.
    pub(super) fn displacement_size(&self, load: usize) -> f64 {
        self.scale.displacement(&self.loading.loads[load], self.linkage())
    }

    /// Tables of sets of functions of the configuration with common evaluations; `sizes`: natural sizes of each set.
    pub(super) fn tabulate(
        &self,
        grid: &Grid,
        sizes: &[Vec<f64>],
        exact: &mut dyn FnMut(&Configuration, &mut [f64]),
    ) -> Vec<Result<Table, Unresolved>> {
        let (mut scratch, mut c) = (Scratch::default(), Configuration::default());
        Table::build_all(grid, sizes, &mut |sigma, values| {
            self.curve.configure(sigma, &mut scratch, &mut c);
            exact(&c, values);
            c.amplification
        })
    }
}
