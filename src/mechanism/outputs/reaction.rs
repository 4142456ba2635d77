//! The reaction of a joint in a state.
//!
//! In: its reaction to each load of unit size, the sizes of the loads. Out: force x, force y, moment. It must not know
//! how the sizes are found.
use crate::mechanism::linkage::Freedom;
use crate::mechanism::loads::resolved::Mesh;
use crate::mechanism::outputs::cache::{PanelReaction, PanelRows, PresentLoads};
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError, finite, spring_force};
use crate::mechanism::outputs::view::{Reading, View};
use crate::mechanism::reactions::Reaction;
use crate::mechanism::reduced::PanelTable;
use crate::numerics::bundle::{ROW, replace_first, side_by_side, side_by_side_at};
use crate::numerics::chebyshev::NODES;

/// Force x, force y, moment.
type Parts<N> = [N; 3];

impl<'a, N: Reading> View<'a, N> {
    /// Force x, force y [N] and moment [N.m] that a joint transmits; the third of a coupling is the force that it transmits
    /// along the motion [N].
    pub fn find_reaction(&mut self, joint: usize) -> Result<Parts<N>, OutputError> {
        let mut value = self.reaction_along(joint)?;
        for mesh in 0..self.reduced.loading().meshes.len() {
            self.add_separation(mesh, joint, &mut value)?;
        }
        let value = value.map(finite);
        self.cache.reactions[joint] = Some(value);
        self.cache.has_reactions = true;
        self.cache.computed.reactions += 1;
        Ok(value)
    }

    /// Add the reaction to the force |F_t| tan(alpha) that pushes the teeth of a mesh apart. It does no work, so that it
    /// changes neither the motion nor any tangential force F_t.
    #[cold]
    #[inline(never)]
    fn add_separation(&mut self, mesh: usize, joint: usize, value: &mut Parts<N>) -> Result<(), OutputError> {
        let Mesh { joint: own, loads, tangent } = self.reduced.loading().meshes[mesh];
        let transmitted = match self.cache.transmitted[mesh] {
            Some(transmitted) => transmitted,
            None => self.reaction_along(own)?[2],
        };
        self.cache.transmitted[mesh] = Some(transmitted);
        self.cache.has_reactions = true;
        let (size, load) = if transmitted.value() < 0.0 { (-transmitted, loads[0]) } else { (transmitted, loads[1]) };
        let parts = if self.reduced.linkage().joints[joint].freedom == Freedom::Revolute { 2 } else { 3 };
        self.add_column(joint, 2 + load, size * tangent, &mut value[..parts])
    }

    /// [`Self::find_reaction`] without the forces that push teeth apart.
    fn reaction_along(&mut self, joint: usize) -> Result<Parts<N>, OutputError> {
        self.find_shares()?;
        let (reduced, sigma) = (self.reduced, self.sigma());
        let parts = if reduced.linkage().joints[joint].freedom == Freedom::Revolute { 2 } else { 3 };
        let mut value = [N::constant(0.0); 3];
        let PanelReaction { given, has_applied, .. } = &self.loads.reactions[joint];
        let is_ready = *has_applied && given.holds(self.state.sigma);
        match if is_ready { Ok(None) } else { reduced.reaction(joint, self.state.sigma).map(Some) } {
            Ok(piece) => {
                self.add_given(piece, joint, &mut value[..parts])?;
                self.add_sized_by_state(joint, &mut value[..parts])?;
            }
            // The exact evaluator has no derivative along sigma.
            Err(at) if !sigma.is_constant() => return Err(at.into()),
            Err(_) => {
                let units = reduced.exact_reaction(joint, self.state.sigma);
                let applied = (0..reduced.components().sized).filter(|load| !self.decided().contains(load));
                let applied = applied.map(|load| (2 + load, self.size(load)));
                let given = self.given_columns().zip(self.cache.shares.given.iter().copied());
                let state = self.state_columns().zip(self.cache.shares.state.iter().copied());
                for (column, size) in applied.chain(given).chain(state) {
                    add(&units[column], size, &mut value[..parts]);
                }
            }
        }
        self.add_held(joint, &mut value[..parts])?;
        Ok(value)
    }

    /// The loads whose delivered force the state decides: drives with an efficiency or a circuit.
    fn decided(&self) -> &'a [usize] {
        self.state_loads().map_or(&[], |s| &s.drives)
    }

    /// Columns of a joint's reactions for [`Shares::given`](super::cache::Shares::given).
    fn given_columns(&self) -> impl Iterator<Item = usize> + Clone + use<'a, N> {
        let springs = self.reduced.loading().springs.iter().map(|spring| spring.load);
        [0, 1].into_iter().chain(self.decided().iter().copied().chain(springs).map(|load| 2 + load))
    }

    /// Columns of a joint's reactions for [`Shares::state`](super::cache::Shares::state).
    fn state_columns(&self) -> impl Iterator<Item = usize> + Clone + use<'a, N> {
        self.state_loads().map_or(&[][..], |s| &s.loads).iter().map(|load| 2 + load)
    }

    /// Sizes of what causes reactions, evaluated once for a state.
    fn find_shares(&mut self) -> Result<(), OutputError> {
        if self.cache.shares.are_known {
            return Ok(());
        }
        let (forces, sigma_dot) = (self.forces()?, self.sigma_dot());
        let mut given = std::mem::take(&mut self.cache.shares.given);
        given.clear();
        given.extend([forces.acceleration, sigma_dot * sigma_dot]);
        given.extend(self.decided().iter().map(|&load| self.delivered(load)));
        let loading = self.reduced.loading();
        for spring in 0..loading.springs.len() {
            given.push(-spring_force(self, loading, spring)?);
        }
        let shares = &mut self.cache.shares;
        (shares.given, shares.are_known) = (given, true);
        shares.state.clear();
        shares.state.extend_from_slice(&self.cache.scratch.evaluator.loads);
        if let Some(state_loads) = self.state_loads() {
            // Their whole force is among those of springs.
            let springs = state_loads.spring(0)..state_loads.free();
            self.cache.shares.state[springs].fill(N::constant(0.0));
        }
        Ok(())
    }

    /// Add the reaction to all but the loads that the state sizes. `piece`: its table at sigma; none if the polynomials in
    /// the cache are those of this panel and of the present sizes.
    fn add_given(&mut self, piece: Option<PanelTable>, joint: usize, value: &mut [N]) -> Result<(), OutputError> {
        let (reduced, sigma) = (self.reduced, self.sigma());
        let decided = self.decided();
        if let Some(piece) = piece {
            let (parts, columns, table) = (value.len(), 2 + reduced.loading().base(), piece.table);
            let others = self.given_columns();
            let PresentLoads { sizes, reactions, .. } = &mut *self.loads;
            let PanelReaction { given: panel, has_applied, .. } = &mut reactions[joint];
            if !panel.holds(self.state.sigma) {
                panel.enter(piece, self.state.sigma, |panel, rows| {
                    for part in 0..parts {
                        let others = others.clone().map(|column| table.series(panel, part * columns + column));
                        side_by_side([&[0.0; NODES]].into_iter().chain(others), rows);
                    }
                });
            }
            let rows = panel.rows.len() / parts;
            let sized = sizes[..reduced.components().sized].iter().enumerate();
            let acting = sized.filter(|(load, size)| **size != 0.0 && !decided.contains(load));
            for part in 0..parts {
                let mut applied = [0.0; NODES];
                for (load, size) in acting.clone() {
                    let series = table.series(panel.panel, part * columns + 2 + load);
                    applied.iter_mut().zip(series).for_each(|(sum, c)| *sum += size * c);
                }
                replace_first(&mut panel.rows[part * rows], &applied);
            }
            *has_applied = true;
        }
        let panel = &self.loads.reactions[joint].given;
        let cache = &mut *self.cache;
        add_rows(panel, sigma, &mut cache.values, value, |values| {
            let others = values[1..].iter().zip(&cache.shares.given);
            others.fold(values[0], |sum, (unit, size)| sum + *size * *unit)
        });
        if N::CARRIES {
            // The polynomials have the values of the inputs, without their derivatives.
            for load in (0..reduced.loading().inputs.len()).filter(|load| !decided.contains(load)) {
                let change = self.size(load) - N::constant(self.loads.sizes[load]);
                self.add_column(joint, 2 + load, change, value)?;
            }
        }
        Ok(())
    }

    /// Add the reaction to what belongs to one column, of this size.
    fn add_column(&self, joint: usize, column: usize, size: N, value: &mut [N]) -> Result<(), OutputError> {
        if size.value() == 0.0 && size.is_constant() {
            return Ok(());
        }
        let (reduced, given) = (self.reduced, 2 + self.reduced.loading().base());
        let at = self.state.sigma;
        let (piece, own, columns) = match column.checked_sub(given) {
            None => (reduced.reaction(joint, at), column, given),
            Some(own) => (reduced.state_reaction(joint, at), own, 2 + reduced.loading().loads.len() - given),
        };
        match piece {
            Ok(PanelTable { table, .. }) => {
                let position = table.position(self.state.sigma);
                for (part, sum) in value.iter_mut().enumerate() {
                    *sum = *sum + size * self.component(table, position, part * columns + own);
                }
            }
            Err(at) if !self.sigma().is_constant() => return Err(at.into()),
            Err(_) => add(&reduced.exact_reaction(joint, self.state.sigma)[column], size, value),
        }
        Ok(())
    }

    /// Add the reaction to the loads that the state sizes: their table, built when one of them acts, is one of its own.
    fn add_sized_by_state(&mut self, joint: usize, value: &mut [N]) -> Result<(), OutputError> {
        let (reduced, sigma, air) = (self.reduced, self.sigma(), self.cache.scratch.air);
        if self.cache.shares.state.iter().all(|size| size.value() == 0.0 && size.is_constant()) {
            return Ok(());
        }
        let PanelReaction { state: panel, air: panel_air, .. } = &self.loads.reactions[joint];
        if *panel_air != air || !panel.holds(self.state.sigma) {
            let piece = match reduced.state_reaction(joint, self.state.sigma) {
                Ok(piece) => piece,
                Err(at) if !sigma.is_constant() => return Err(at.into()),
                Err(_) => {
                    let units = reduced.exact_reaction(joint, self.state.sigma);
                    for (column, size) in self.state_columns().zip(&self.cache.shares.state) {
                        add(&units[column], *size, value);
                    }
                    return Ok(());
                }
            };
            let (columns, first) =
                (reduced.loading().loads.len() - reduced.loading().base(), 2 + reduced.loading().base());
            let own = self.state_columns();
            let panel = &mut self.loads.reactions[joint];
            panel.air = air;
            panel.state.enter(piece, self.state.sigma, |panel, rows| {
                for part in 0..value.len() {
                    let series = |column: usize| piece.table.series(panel, part * columns + column - first);
                    side_by_side(own.clone().map(series), rows);
                }
            });
        }
        let panel = &self.loads.reactions[joint].state;
        let cache = &mut *self.cache;
        add_rows(panel, sigma, &mut cache.values, value, |values| {
            let all = values.iter().zip(&cache.shares.state);
            all.fold(N::constant(0.0), |sum, (unit, size)| sum + *size * *unit)
        });
        Ok(())
    }

    /// Add the reaction to what holds the mechanism at rest: a rigid stop, or locks.
    fn add_held(&mut self, joint: usize, value: &mut [N]) -> Result<(), OutputError> {
        let (reduced, forces) = (self.reduced, self.forces()?);
        let Some(place) = forces.held else { return Ok(()) };
        let loading = reduced.loading();
        if let Some(end) = self.state.travel.rigid[place.side].filter(|_| forces.by_stop) {
            let force = self.stop_force(end.stop)?;
            self.add_column(joint, 2 + loading.stops[end.stop].load, force, value)?;
        }
        let outward = place.outward();
        for lock in 0..loading.locks.len() {
            let force = self.lock_force(lock)?;
            if force.value() != 0.0 || !force.is_constant() {
                add(&reduced.lock_reaction(lock, self.state.sigma, joint), force * N::constant(outward), value);
            }
        }
        Ok(())
    }
}

/// Add, for each part, a sum over the values of its polynomials on a panel; as many rows belong to each part.
#[inline]
fn add_rows<N: Reading>(
    panel: &PanelRows,
    sigma: N,
    values: &mut Vec<[N; ROW]>,
    parts: &mut [N],
    sum: impl Fn(&[N]) -> N,
) {
    values.resize(panel.rows.len(), [N::constant(0.0); ROW]);
    side_by_side_at(&panel.rows, panel.x(sigma), values);
    let rows = panel.rows.len() / parts.len();
    for (part, values) in parts.iter_mut().zip(values.chunks_exact(rows)) {
        *part = *part + sum(values.as_flattened());
    }
}

/// Add the reaction to a load of this size.
fn add<N: Reading>(unit: &Reaction, size: N, parts: &mut [N]) {
    for (part, unit) in parts.iter_mut().zip([unit.force.x, unit.force.y, unit.moment]) {
        *part = *part + size * N::constant(unit);
    }
}
