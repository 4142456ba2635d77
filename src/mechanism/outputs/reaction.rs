//! What a joint transmits in a state.
//!
//! In: the tables of its reaction to each load, the sizes of the loads. Out: force x, force y, moment. The loads of given
//! sizes are folded into one polynomial for each part when a panel of the table is entered, as in the right-hand side.
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::linkage::Freedom;
use crate::mechanism::motion::state::State;
use crate::mechanism::outputs::{OutputError, finite};
use crate::mechanism::reactions::Reaction;
use crate::mechanism::reduced::Reduced;
use crate::numerics::chebyshev::{NODES, Series};
use crate::numerics::table::{Table, polynomial};

/// A joint's reaction in the present state, and the polynomials of its panel.
#[derive(Clone, Debug)]
pub struct JointReaction {
    /// Force x, force y [N] and moment [N.m], once computed in this state.
    pub value: Option<[f64; 3]>,
    /// First sigma for which the polynomials hold, and the first for which they no longer do.
    low: f64,
    high: f64,
    center: f64,
    /// 2 / width of the panel.
    inverse: f64,
    panel: usize,
    /// Reaction to the loads of given sizes.
    given: [Series; 3],
}

impl JointReaction {
    /// Nothing yet.
    pub fn new() -> Self {
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { value: None, low, high, center: 0.0, inverse: 0.0, panel: 0, given: [[0.0; NODES]; 3] }
    }

    /// The sizes have changed.
    pub fn forget(&mut self) {
        (self.value, self.low, self.high) = (None, f64::INFINITY, f64::NEG_INFINITY);
    }

    /// Take up the panel at sigma, with loads of these sizes; the table has `terms` columns for each part.
    #[cold]
    fn enter(&mut self, table: &Table, sigma: f64, (parts, terms): (usize, usize), sizes: impl Fn(usize) -> f64) {
        self.panel = table.panel_near(sigma, self.panel);
        let (a, b) = table.borders(self.panel);
        (self.low, self.high, self.center, self.inverse) = (a, b, 0.5 * (a + b), 2.0 / (b - a));
        // Outside the table its first and its last panel go on.
        if self.panel == 0 {
            self.low = f64::NEG_INFINITY;
        }
        if self.panel + 1 == table.panels() {
            self.high = f64::INFINITY;
        }
        for (part, sum) in self.given.iter_mut().enumerate().take(parts) {
            *sum = [0.0; NODES];
            for load in 0..terms - 2 {
                let size = sizes(load);
                if size != 0.0 {
                    let series = table.series(self.panel, part * terms + 2 + load);
                    sum.iter_mut().zip(series).for_each(|(sum, c)| *sum += size * c);
                }
            }
        }
    }

    /// The first `parts` of the reaction to the given loads, an acceleration and a square of the speed along the curve.
    #[inline]
    fn of_applied(&self, table: &Table, sigma: f64, (parts, terms): (usize, usize), motion: [f64; 2]) -> [f64; 3] {
        let x = (sigma - self.center) * self.inverse;
        let mut value = [0.0; 3];
        for (part, value) in value.iter_mut().enumerate().take(parts) {
            let series = |term: usize| polynomial(table.series(self.panel, part * terms + term), x);
            *value = polynomial(&self.given[part], x) + motion[0] * series(0) + motion[1] * series(1);
        }
        value
    }
}

impl State {
    /// Force x, force y [N] and moment [N.m] that a joint transmits.
    ///
    /// # Errors
    /// [`OutputError`].
    pub(super) fn reaction(
        &mut self,
        reduced: &Reduced,
        inputs: &Inputs,
        joint: usize,
    ) -> Result<[f64; 3], OutputError> {
        if let Some(value) = self.cache.reactions[joint].value {
            return Ok(value);
        }
        let effect = self.effect(reduced, inputs)?;
        let loading = reduced.loading();
        let state_loads = reduced.state_loads(self.cache.scratch.air).ok().flatten();
        let with_efficiency = state_loads.map_or(&[][..], |s| &s.drives_with_efficiency);
        // A revolute joint transmits no moment.
        let parts = if reduced.linkage().joints[joint].freedom == Freedom::Revolute { 2 } else { 3 };
        let terms = 2 + loading.base();
        let motion = [effect.acceleration, self.sigma_dot * self.sigma_dot];
        let table = reduced.reaction(joint);
        let exact = if table.is_err() { reduced.exact_reaction(joint, self.sigma) } else { Vec::new() };
        // What arrives of a drive with an efficiency is decided by the state.
        let given = |sizes: &[f64], load: usize| if with_efficiency.contains(&load) { 0.0 } else { sizes[load] };
        let sized = reduced.components().sized;
        let mut value = [0.0; 3];
        match table {
            Ok(table) => {
                let (sizes, sigma) = (&self.cache.sizes, self.sigma);
                let reactions = &mut self.cache.reactions[joint];
                if !(reactions.low <= sigma && sigma < reactions.high) {
                    reactions.enter(
                        table,
                        sigma,
                        (parts, terms),
                        |load| {
                            if load < sized { given(sizes, load) } else { 0.0 }
                        },
                    );
                }
                value = reactions.of_applied(table, sigma, (parts, terms), motion);
            }
            Err(_) => {
                for (part, sum) in value.iter_mut().enumerate().take(parts) {
                    let of_loads: f64 =
                        (0..sized).map(|load| given(&self.cache.sizes, load) * part_of(&exact[2 + load], part)).sum();
                    *sum = of_loads + motion[0] * part_of(&exact[0], part) + motion[1] * part_of(&exact[1], part);
                }
            }
        }
        let mut add = |load: usize, size: f64| {
            for (part, sum) in value.iter_mut().enumerate().take(parts) {
                *sum += size
                    * match &table {
                        Ok(table) => table.value(table.position(self.sigma), part * terms + 2 + load),
                        Err(_) => part_of(&exact[2 + load], part),
                    };
            }
        };
        for &load in with_efficiency {
            add(load, self.delivered(reduced, load));
        }
        for (place, spring) in loading.springs.iter().enumerate() {
            add(spring.load, -self.spring_force(reduced, place)?);
        }
        let by_scene = state_loads.map_or(&[][..], |s| &s.loads);
        let states = loading.loads.len() - loading.base();
        let mut add_state = |load: usize, size: f64| -> Result<(), OutputError> {
            if size == 0.0 {
                return Ok(());
            }
            let table = reduced.state_reaction(joint);
            for (part, sum) in value.iter_mut().enumerate().take(parts) {
                *sum += size
                    * match (&table, exact.get(2 + load)) {
                        (Ok(table), _) => {
                            table.value(table.position(self.sigma), part * states + load - loading.base())
                        }
                        (Err(_), Some(exact)) => part_of(exact, part),
                        (Err(at), None) => return Err(OutputError::Table((*at).clone())),
                    };
            }
            Ok(())
        };
        for (k, &load) in by_scene.iter().enumerate() {
            add_state(load, self.cache.scratch.evaluator.loads[k])?;
        }
        if let Some(side) = effect.held {
            if let Some(end) = self.travel[side].filter(|_| effect.by_stop) {
                add_state(loading.stops[end.stop].load, self.of_stop(reduced, end.stop))?;
            }
            for lock in 0..loading.locks.len() {
                let force = self.of_lock(reduced, inputs, lock);
                if force != 0.0 {
                    let outward = if side == 0 { -1.0 } else { 1.0 };
                    let held = reduced.lock_reaction(lock, self.sigma, joint);
                    for (part, sum) in value.iter_mut().enumerate().take(parts) {
                        *sum += outward * force * part_of(&held, part);
                    }
                }
            }
        }
        let value = value.map(finite);
        self.cache.reactions[joint].value = Some(value);
        self.cache.used = true;
        self.cache.computed.reactions += 1;
        Ok(value)
    }
}

/// Force x, force y or moment.
pub(super) fn part_of(reaction: &Reaction, part: usize) -> f64 {
    [reaction.force.x, reaction.force.y, reaction.moment][part]
}
