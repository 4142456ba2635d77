//! Functions of sigma, read from the tables of the reduced model.
//!
//! In: a view of a state, a table. Out: values with their derivatives along the direction. It must not know which
//! output asks.
use crate::mechanism::outputs::cache::Found;
use crate::mechanism::outputs::evaluator::OutputError;
use crate::mechanism::outputs::view::{Reading, View};
use crate::mechanism::quantity::Output;
use crate::mechanism::reduced::Reduced;
use crate::numerics::chebyshev::slopes_of;
use crate::numerics::processor::{self, Arithmetic, Task};
use crate::numerics::table::{Table, TablePosition, polynomial_at};

impl<'a, N: Reading> View<'a, N> {
    /// Position of sigma in a table: mostly on the panel on which it is in the table of the influences.
    #[inline]
    pub fn position(&self, table: &Table) -> TablePosition {
        table.position_near(self.state.sigma, self.cache.panel)
    }

    /// A component of a table; its derivative along sigma is that of the polynomial.
    #[inline]
    pub fn component(&self, table: &Table, position: TablePosition, component: usize) -> N {
        let sigma = self.sigma();
        if sigma.is_constant() {
            return N::constant(table.value(position, component));
        }
        let (a, b) = table.borders(position.panel);
        polynomial_at(table.series(position.panel, component), sigma.chain(position.x, 2.0 / (b - a)))
    }

    /// A component of a table whose derivative along sigma is the next component.
    #[inline]
    pub fn before_derivative(&self, table: &Table, position: TablePosition, component: usize) -> N {
        let sigma = self.sigma();
        let slope = if sigma.is_constant() { 0.0 } else { table.value(position, component + 1) };
        sigma.chain(table.value(position, component), slope)
    }

    /// A component of a table and the next one, which is its derivative along sigma.
    #[inline]
    pub fn with_derivative(&self, table: &Table, position: TablePosition, component: usize) -> [N; 2] {
        if self.sigma().is_constant() {
            return table.values(position, component).map(N::constant);
        }
        [self.before_derivative(table, position, component), self.component(table, position, component + 1)]
    }

    /// The table of a load's displacement, with the position of sigma in it.
    ///
    /// # Errors
    /// As [`Reduced::displacement_near`].
    #[inline(always)]
    pub fn displacement_table(&mut self, load: usize) -> Result<(&'a Table, TablePosition), OutputError> {
        let found = &mut self.cache.displacements[load];
        let (table, position) = self.reduced.displacement_near(load, self.state.sigma, found.panel)?;
        found.panel = position.panel;
        Ok((table, position))
    }

    /// Displacement of a load, counted on over whole revolutions; found once for a state.
    #[inline]
    pub fn displaced(&mut self, load: usize) -> f64 {
        let (found, version) = (&mut self.cache.displacements[load], self.cache.version);
        if found.version != version {
            found.values = self.state.displacement_near(self.reduced, load, &mut found.panel);
            found.version = version;
        }
        found.values
    }

    /// Displacement of a load by its table, or the time derivative of this order.
    ///
    /// # Errors
    /// [`OutputError`].
    #[inline(never)]
    pub fn tabulated_displacement(&mut self, load: usize, order: usize) -> Result<N, OutputError> {
        let (reduced, sigma) = (self.reduced, self.sigma());
        if order == 1 && load >= reduced.loading().drives.len() {
            let (table, position) = self.displacement_table(load)?;
            return Ok(self.before_derivative(table, position, 1) * self.sigma_dot());
        }
        if order > 0 {
            // The terms of a drive share its slopes.
            let ([slope, curvature], sigma_dot) = (self.slopes_of(load)?, self.sigma_dot());
            return Ok(match order {
                1 => slope * sigma_dot,
                _ => slope * self.forces()?.acceleration + curvature * sigma_dot * sigma_dot,
            });
        }
        let value = self.displaced(load);
        if sigma.is_constant() {
            return Ok(N::constant(value));
        }
        let slope = match reduced.displacement(load) {
            Ok(table) => table.value(self.position(table), 1),
            Err(_) => {
                let c = reduced.curve().configuration(self.state.sigma);
                reduced.loading().loads[load].influence(reduced.linkage(), &c)
            }
        };
        Ok(sigma.chain(value, slope))
    }

    /// S_sigma of a sized load.
    pub fn influence(&mut self, load: usize) -> N {
        let (table, position) = self.influence_table();
        self.component(table, position, load)
    }

    /// The table of the influences, with the position of sigma in it.
    #[inline]
    fn influence_table(&mut self) -> (&'a Table, TablePosition) {
        let table = self.reduced.influence();
        let position = self.position(table);
        self.cache.panel = position.panel;
        (table, position)
    }

    /// Time derivative of one of the functions of the cache: all its orders are evaluated when one is read.
    #[inline(always)]
    pub fn time_derivative(&mut self, function: usize, order: usize) -> Result<N, OutputError> {
        let Found { version, values, .. } = self.cache.functions[function];
        let [value, slope, curvature] =
            if version == self.cache.version { values } else { self.find_function(function)? };
        Ok(match order {
            0 => value,
            1 => slope * self.sigma_dot(),
            _ => slope * self.forces()?.acceleration + curvature * self.sigma_dot() * self.sigma_dot(),
        })
    }

    /// A function with its first two derivatives along sigma.
    #[inline(never)]
    fn find_function(&mut self, function: usize) -> Result<[N; 3], OutputError> {
        if self.sigma().is_constant() {
            return processor::run(Functions { view: self, functions: &[function] });
        }
        let (table, position, first) = self.function_table(function)?;
        let [slope, curvature] = self.with_derivative(table, position, first + 1);
        let values = [self.before_derivative(table, position, first), slope, curvature];
        self.cache.functions[function] = Found { version: self.cache.version, panel: position.panel, values };
        Ok(values)
    }

    /// The table of a function, the position of sigma in it, and the function's first component.
    #[inline(always)]
    fn function_table(&self, function: usize) -> Result<(&'a Table, TablePosition, usize), OutputError> {
        let coordinates = self.reduced.linkage().coordinates.len();
        let (table, first) = match function.checked_sub(coordinates) {
            None => (self.reduced.coordinates()?, 3 * function),
            Some(of_marker) => (self.reduced.marker(of_marker / 2)?, 3 * (of_marker % 2)),
        };
        Ok((table, table.position_near(self.state.sigma, self.cache.functions[function].panel), first))
    }

    /// Derivative along sigma of S_sigma of a sized load.
    pub fn influence_slope(&mut self, load: usize) -> N {
        let ((table, position), sigma) = (self.influence_table(), self.sigma());
        let (a, b) = table.borders(position.panel);
        let scale = 2.0 / (b - a);
        let slopes = slopes_of(table.series(position.panel, load));
        polynomial_at(&slopes, sigma.chain(position.x, scale)) * scale
    }
}

impl View<'_, f64> {
    /// Find functions that are read together.
    ///
    /// # Errors
    /// One has no table.
    pub fn find_functions(&mut self, functions: &[usize]) -> Result<(), OutputError> {
        processor::run(Functions { view: self, functions }).map(|_| ())
    }
}

/// Functions to evaluate where sigma carries no derivatives; the result is the last one.
struct Functions<'v, 'a, N: Reading> {
    view: &'v mut View<'a, N>,
    functions: &'v [usize],
}

impl<N: Reading> Task for Functions<'_, '_, N> {
    type Result = Result<[N; 3], OutputError>;

    #[inline(always)]
    fn run<A: Arithmetic>(self) -> Self::Result {
        let (mut values, version) = ([N::constant(0.0); 3], self.view.cache.version);
        for &function in self.functions {
            let (table, position, first) = self.view.function_table(function)?;
            // The value is evaluated as where a stop is sought, so that a mechanism at a stop has the stop's position.
            values = table.value_and_next::<A, 3>(position, first).map(N::constant);
            self.view.cache.functions[function] = Found { version, panel: position.panel, values };
        }
        Ok(values)
    }
}

/// The function of which an output is a time derivative, if it is one but for a constant.
pub fn function_of(reduced: &Reduced, output: &Output) -> Option<usize> {
    match *output {
        Output::Angle { body, .. } => reduced.linkage().bodies[body].angle_coordinate,
        Output::JointPosition { coordinate, .. } => Some(coordinate),
        Output::Marker { marker, axis, .. } => Some(reduced.marker_function(marker, axis)),
        _ => None,
    }
}
