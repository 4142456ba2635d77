//! The right-hand side on the panel that was used last: one polynomial, the sum of the loads' influences times their
//! sizes.
//!
//! In: tables of the reduced model and its state loads, sizes of loads. Out: the force along the curve and the
//! reactions of friction joints on one panel. It must not know the loads that the state decides.
use crate::mechanism::dynamics::inputs::Change;
use crate::mechanism::reduced::{ExactMotion, Reduced, StateLoads};
use crate::numerics::bundle::{Bundle, Row, add_side_by_side, side_by_side};
use crate::numerics::chebyshev::{NODES, Series, slopes_of};
use crate::numerics::dual::{Dual, Number};
use crate::numerics::enclosure::{Interval, polynomial_bounds};
use crate::numerics::table::{Table, TablePosition, polynomial_at};

/// Rounding of a panel's border that is counted on over whole revolutions, relative to the numbers that are added up.
const BORDER: f64 = 8.0 * f64::EPSILON;
/// Part of the width of a gap over which slopes are taken.
const DIFFERENCE: f64 = 1e-4;

/// Sizes of all that the state does not decide.
#[derive(Clone, Copy, Debug)]
pub struct AppliedLoads<'a> {
    /// Number of these sizes and their time derivatives: equal for the same ones. 0: none, so that nothing is kept.
    pub version: u64,
    /// Sizes of the sized loads.
    pub sizes: &'a [f64],
    /// Airspeed [m/s].
    pub airspeed: f64,
    /// Whole revolutions before sigma = 0.
    pub revolutions: f64,
    /// Time derivatives of the sizes and of the airspeed, unless all are 0.
    pub change: Option<Change<'a>>,
}

impl AppliedLoads<'_> {
    /// Size of a load at the time t [s] of the step.
    #[inline]
    pub fn size<T: Number>(&self, load: usize, t: T) -> T {
        T::constant(self.sizes[load]) + self.excess(load, t)
    }

    /// Size of a load at the time t [s] of the step, less that at t = 0.
    #[inline]
    pub fn excess<T: Number>(&self, load: usize, t: T) -> T {
        match &self.change {
            Some(change) if load < change.first.len() => parabola([change.first[load], change.second[load]], t),
            _ => T::constant(0.0),
        }
    }

    /// Size of a load at t = 0 with its two time derivatives.
    pub fn rates(&self, load: usize) -> [f64; 3] {
        let derivatives = self.change.as_ref().filter(|change| load < change.first.len());
        let [first, second] = derivatives.map_or([0.0; 2], |change| [change.first[load], change.second[load]]);
        [self.sizes[load], first, second]
    }

    /// Airspeed at the time t [s] of the step [m/s].
    #[inline]
    pub fn air<T: Number>(&self, t: T) -> T {
        let excess = self.change.map_or(T::constant(0.0), |change| parabola(change.airspeed, t));
        T::constant(self.airspeed) + excess
    }
}

/// u_1 t + u_2 t^2 / 2.
fn parabola<T: Number>([first, second]: [f64; 2], t: T) -> T {
    t * (T::constant(first) + t * T::constant(0.5 * second))
}

/// Forces of the applied loads and springs as polynomials on one panel: the force along the curve, and the reactions of
/// the friction joints.
#[derive(Clone, Debug, Default)]
pub struct PanelForce {
    /// It holds for low <= sigma < high; both counted on over whole revolutions.
    low: f64,
    high: f64,
    center: f64,
    /// 2 / width of the panel; 0 beyond an open end, where the force is constant.
    inverse: f64,
    /// x at the center.
    offset: f64,
    panel: usize,
    /// Version of the loads, the bits of the whole revolutions before sigma = 0, and the number of the stretch of the
    /// curve on which the panel is.
    of: (u64, u64, i32),
    /// Whole revolutions before this panel.
    pub revolutions: f64,
    /// Force along the curve.
    pub force: Series,
    /// Components of the friction joints' reactions, side by side.
    pub reactions: Vec<Row>,
    /// First and second time derivative of all rows, the force first; none under constant inputs.
    rates: Vec<[Series; 2]>,
    /// Without tables, or in a gap of the table: value and slope of all components at the one sigma for which it holds.
    exact: Vec<Series>,
    /// Scratch for these values.
    exact_motion: Option<Box<ExactMotion>>,
    /// Whether these slopes are 0 because nothing has asked for derivatives.
    lacks_slopes: bool,
    /// Without tables: the components that are read together, side by side.
    exact_bundle: Vec<Row>,
    /// Without tables: the effects of an applied load on the friction joints' reactions, side by side.
    exact_applied: Vec<Row>,
}

impl PanelForce {
    /// Holds for no sigma; with scratch for these state loads.
    pub fn new(state_loads: Option<&StateLoads>) -> Self {
        let rows = state_loads.map_or(0, |s| Bundle::rows(s.rows() - 1));
        Self { reactions: Vec::with_capacity(rows), ..Self::default() }
    }

    /// Allocate what inputs that change with time and gaps of the table need.
    pub fn prepare(&mut self, reduced: &Reduced, state_loads: Option<&StateLoads>) {
        self.rates.reserve(state_loads.map_or(1, StateLoads::rows));
        let Some(state_loads) = state_loads else { return };
        if let Some((first, last)) = state_loads.table.gaps().next() {
            self.exact.reserve(state_loads.table.components());
            self.exact_bundle.reserve(Bundle::rows(state_loads.bundled()));
            self.exact_applied.reserve(Bundle::rows(state_loads.rows() - 1));
            let exact = self.exact_motion.get_or_insert_default();
            // Some positions, as the exact evaluator exchanges memory with itself.
            for part in [-1.0, 0.0, 0.5, 1.0, 2.0] {
                reduced.exact_motion(Some(state_loads), first + part * (last - first), exact);
            }
        }
    }

    /// Hold for no sigma: sizes are others.
    pub fn invalidate(&mut self) {
        (self.low, self.high) = (f64::INFINITY, f64::NEG_INFINITY);
    }

    /// Hold for no sigma unless it is that of these loads, on this stretch of the curve.
    #[inline(always)]
    pub fn belong_to(&mut self, applied: &AppliedLoads, stretch: i32) {
        let of = (applied.version, applied.revolutions.to_bits(), stretch);
        if of != self.of || of.0 == 0 {
            self.of = of;
            self.invalidate();
        }
    }

    /// Where this one does not hold sigma, become the same as another one of the same loads that does: what was summed
    /// up for outputs is not summed up again for a step, nor the other way round.
    #[inline]
    pub fn share(&mut self, other: Option<&Self>, sigma: f64) {
        let is_known = |other: &&Self| other.of == self.of && other.holds(sigma);
        if !self.holds(sigma)
            && let Some(other) = other.filter(is_known)
        {
            self.copy_panel(other);
        }
    }

    /// Become the same as another one on a panel with a table, under inputs that do not change with time.
    fn copy_panel(&mut self, other: &Self) {
        if !(other.exact.is_empty() && other.rates.is_empty()) {
            return;
        }
        let Self { low, high, center, inverse, offset, panel, revolutions, force, .. } = *other;
        (self.low, self.high, self.center, self.inverse, self.offset) = (low, high, center, inverse, offset);
        (self.panel, self.revolutions, self.force) = (panel, revolutions, force);
        self.reactions.clone_from(&other.reactions);
        self.exact.clear();
        self.rates.clear();
        self.lacks_slopes = false;
    }

    /// Whether the present panel holds sigma.
    #[inline(always)]
    pub fn holds(&self, sigma: f64) -> bool {
        self.low <= sigma && sigma < self.high
    }

    /// The panel used last.
    #[inline(always)]
    pub fn panel(&self) -> usize {
        self.panel
    }

    /// x at sigma on the present panel, with derivatives if sigma has some.
    #[inline(always)]
    pub fn x<T: Number>(&self, sigma: T) -> T {
        sigma.chain(self.offset + (sigma.value() - self.center) * self.inverse, self.inverse)
    }

    /// Whether it changes with time.
    #[inline]
    pub fn changes(&self) -> bool {
        !self.rates.is_empty()
    }

    /// Monomial coefficients of one component of this table, on the panel.
    #[inline]
    pub fn series<'a>(&'a self, table: &'a Table, component: usize) -> &'a Series {
        if self.exact.is_empty() { table.series(self.panel, component) } else { &self.exact[component] }
    }

    /// Derivative along sigma of one component of this table, at x on the panel.
    pub fn slope<T: Number>(&self, table: &Table, component: usize, x: T) -> T {
        polynomial_at(&slopes_of(self.series(table, component)), x) * self.inverse
    }

    /// Derivative along sigma of the force along the curve. None if the force changes with time, or elsewhere.
    #[inline]
    pub fn slope_of_force<T: Number>(&self, sigma: T) -> Option<T> {
        let is_known = self.has_slopes(sigma.value()) && !self.changes();
        is_known.then(|| polynomial_at(&slopes_of(&self.force), self.x(sigma)) * self.inverse)
    }

    /// Coefficients of the components that are read together, on the panel.
    #[inline]
    pub fn bundle<'a>(&'a self, bundle: &'a Bundle) -> &'a [Row] {
        if self.exact.is_empty() { bundle.panel(self.panel) } else { &self.exact_bundle }
    }

    /// Force of all applied loads along the curve, at the time t [s].
    #[inline]
    pub fn at<T: Number>(&self, x: T, t: T) -> T {
        let sum = polynomial_at(&self.force, x);
        if self.rates.is_empty() { sum } else { sum + self.excess(0, x, t) }
    }

    /// Effect of all applied loads at the time t [s], less that at t = 0: row 0 is the force along the curve, the
    /// others are components of the friction joints' reactions.
    pub fn excess<T: Number>(&self, row: usize, x: T, t: T) -> T {
        self.rates.get(row).map_or(T::constant(0.0), |[first, second]| {
            t * (polynomial_at(first, x) + t * T::constant(0.5) * polynomial_at(second, x))
        })
    }

    /// Position of any sigma in the table, without leaving the present panel.
    pub fn position(&self, (reduced, table): (&Reduced, &Table), sigma: f64) -> TablePosition {
        let (shift, _) = around(reduced, sigma);
        let (first, last) = reduced.curve().range;
        table.position_near((sigma - shift).clamp(first, last), self.panel)
    }

    /// One component of the table at any sigma, without leaving the present panel.
    pub fn value(&self, (reduced, table): (&Reduced, &Table), component: usize, sigma: f64) -> f64 {
        table.value(self.position((reduced, table), sigma), component)
    }

    /// Bounds of one component of the table, and of its derivative along sigma, on an interval of sigma. `growth`: how
    /// much the component grows over a revolution.
    pub fn bounds(
        &self,
        (reduced, table): (&Reduced, &Table),
        component: usize,
        sigma: Interval,
        growth: f64,
    ) -> [Interval; 2] {
        /// Panels after which the bounds are not worth their cost.
        const MOST_PANELS: usize = 64;
        let (first, last) = reduced.curve().range;
        let (mut shift, mut revolutions) = around(reduced, sigma.low);
        let mut panel = table.panel_near((sigma.low - shift).clamp(first, last), self.panel);
        let mut all: Option<[Interval; 2]> = None;
        for _ in 0..MOST_PANELS {
            let (a, b) = table.borders(panel);
            let x = |sigma: f64| ((2.0 * (sigma - shift) - (a + b)) / (b - a)).clamp(-1.0, 1.0);
            let x = Interval { low: x(sigma.low), high: x(sigma.high) };
            let [value, slope] = polynomial_bounds(table.series(panel, component), x);
            let here = [value + Interval::point(revolutions * growth), slope * Interval::point(2.0 / (b - a))];
            let hull = all.map_or(here, |all| [all[0].hull(here[0]), all[1].hull(here[1])]);
            panel += 1;
            if panel == table.panels() {
                let Some(period) = reduced.period() else { return hull };
                (panel, shift, revolutions) = (0, shift + period, revolutions + 1.0);
            }
            if sigma.high <= table.borders(panel).0 + shift {
                return hull;
            }
            all = Some(hull);
        }
        [Interval::around(0.0, f64::MAX); 2]
    }

    /// Whether the present panel holds sigma, for values with derivatives.
    #[inline]
    pub fn has_slopes(&self, sigma: f64) -> bool {
        self.holds(sigma) && !self.lacks_slopes
    }

    /// Enter the panel at sigma, on this stretch of the curve. `varies`: for values with derivatives.
    pub fn enter(
        &mut self,
        (reduced, state_loads): (&Reduced, Option<&StateLoads>),
        applied: &AppliedLoads,
        sigma: f64,
        varies: bool,
    ) {
        self.of.2 = reduced.stretch;
        let table = state_loads.map_or(reduced.influence(), |s| &s.table);
        let (first, last) = reduced.curve().range;
        let (shift, revolutions) = around(reduced, sigma);
        self.panel = table.panel_near(sigma - shift, self.panel);
        self.revolutions = applied.revolutions + revolutions;
        let (a, b) = table.borders(self.panel);
        (self.low, self.high, self.center, self.inverse) = (a + shift, b + shift, 0.5 * (a + b) + shift, 2.0 / (b - a));
        if let Some(period) = reduced.period() {
            // Within rounding of a border, the panel depends on how whole revolutions are counted. There it is always
            // looked up, so that the result does not depend on the panel before.
            let margin = BORDER * (first.abs().max(last.abs()) + shift.abs() + period);
            (self.low, self.high) = (self.low + margin, self.high - margin);
        }
        self.offset = 0.0;
        if reduced.period().is_none() && !(first..last).contains(&sigma) {
            // Beyond an open end; a step that ends there is refused.
            (self.inverse, self.offset) = (0.0, if sigma < first { -1.0 } else { 1.0 });
            (self.low, self.high) = if sigma < first { (f64::NEG_INFINITY, first) } else { (last, f64::INFINITY) };
        }
        self.exact.clear();
        self.lacks_slopes = false;
        if (reduced.exact || table.is_gap(self.panel)) && self.inverse != 0.0 {
            self.enter_exactly((reduced, state_loads), table, [sigma, shift], varies);
        }
        let own = [(reduced.components().springs, 1.0), (reduced.components().winding, self.revolutions)];
        let own = own.into_iter().filter_map(|(k, size)| Some((k?, size)));
        let all = loads(state_loads, applied.sizes).chain(own);
        self.force = self.sum(state_loads, table, all.clone(), 0);
        if let Some(state_loads) = state_loads.filter(|s| !s.friction_joints.is_empty()) {
            self.reactions.clear();
            for (k, size) in all {
                self.add_reactions(state_loads, k, size);
            }
            self.reactions.resize(Bundle::rows(state_loads.rows() - 1), Row::ZERO);
        }
        self.rates.clear();
        if let Some(change) = &applied.change {
            for row in 0..state_loads.map_or(1, StateLoads::rows) {
                let rate = |sizes| self.sum(state_loads, table, loads(state_loads, sizes), row);
                let rates = [change.first, change.second].map(rate);
                self.rates.push(rates);
            }
        }
    }

    /// Add the effect of an applied load of this size on the friction joints' reactions.
    fn add_reactions(&mut self, state_loads: &StateLoads, k: usize, size: f64) {
        let effects = if self.exact.is_empty() {
            state_loads.caused_by_applied[k].panel(self.panel)
        } else {
            self.exact_applied.clear();
            let effects = (1..state_loads.rows()).map(|row| &self.exact[state_loads.given(row, k)]);
            side_by_side(effects, &mut self.exact_applied);
            &self.exact_applied
        };
        add_side_by_side(&mut self.reactions, size, effects);
    }

    /// Hold at sigma alone, with values from the exact evaluator. Slopes come from the table, and in a gap of it from
    /// differences of values, if they are asked for.
    fn enter_exactly(
        &mut self,
        (reduced, state_loads): (&Reduced, Option<&StateLoads>),
        table: &Table,
        [sigma, shift]: [f64; 2],
        varies: bool,
    ) {
        let x = Dual::<1>::variable(self.x(sigma), 0);
        let (a, b) = table.borders(self.panel);
        let is_gap = table.is_gap(self.panel);
        self.lacks_slopes = is_gap && !varies;
        let exact = self.exact_motion.get_or_insert_default();
        self.exact.resize(table.components(), [0.0; NODES]);
        if is_gap && varies {
            let h = DIFFERENCE * (b - a);
            // For each unit of x, which is half the width of the panel.
            for (h, factor) in [(h, (b - a) / (4.0 * h)), (-h, -(b - a) / (4.0 * h))] {
                reduced.exact_motion(state_loads, sigma - shift + h, exact);
                self.exact.iter_mut().zip(exact.values()).for_each(|(series, value)| series[1] += factor * value);
            }
        }
        reduced.exact_motion(state_loads, sigma - shift, exact);
        for (component, (series, &value)) in self.exact.iter_mut().zip(exact.values()).enumerate() {
            series[0] = value;
            if !is_gap {
                series[1] = polynomial_at(table.series(self.panel, component), x).slope[0];
            }
        }
        if let Some(state_loads) = state_loads {
            self.exact_bundle.clear();
            side_by_side(&self.exact[..state_loads.bundled()], &mut self.exact_bundle);
        }
        (self.low, self.high, self.center) = (sigma, sigma.next_up(), sigma);
    }

    /// Sum of the effects of applied loads, given with their sizes, in a row.
    fn sum(
        &self,
        state_loads: Option<&StateLoads>,
        table: &Table,
        loads: impl Iterator<Item = (usize, f64)>,
        row: usize,
    ) -> Series {
        let mut sum = [0.0; NODES];
        for (load, size) in loads {
            let series = self.series(table, state_loads.map_or(load, |s| s.given(row, load)));
            sum.iter_mut().zip(series).for_each(|(sum, c)| *sum += size * c);
        }
        sum
    }
}

/// The applied loads that act in full, with their sizes: drives whose force the state decides do not.
fn loads<'a>(state_loads: Option<&'a StateLoads>, sizes: &'a [f64]) -> impl Iterator<Item = (usize, f64)> + Clone {
    let sizes = sizes.iter().copied().enumerate();
    sizes.filter(move |(load, size)| *size != 0.0 && !state_loads.is_some_and(|s| s.drives.contains(load)))
}

/// Length of the whole revolutions before sigma, and their number.
#[inline]
fn around(reduced: &Reduced, sigma: f64) -> (f64, f64) {
    let first = reduced.curve().range.0;
    reduced.period().map_or((0.0, 0.0), |period| {
        let revolutions = ((sigma - first) / period).floor();
        (revolutions * period, revolutions)
    })
}
