//! The reaction of a joint in a state.
//!
//! In: its reaction to each load of unit size, the sizes of the loads. Out: force x, force y, moment. It must not know
//! how the sizes are found.
use crate::mechanism::loads::resolved::Mesh;
use crate::mechanism::outputs::cache::{
    GroupReactions, GroupValues, MOST_TERMS, OutputCache, PARTS, PresentLoads, Shares,
};
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError, finite, spring_force};
use crate::mechanism::outputs::terms::{Causes, joints_of, parts_of};
use crate::mechanism::outputs::view::{Reading, View};
use crate::mechanism::reactions::Reaction;
use crate::mechanism::reduced::{PanelTable, Reduced};
use crate::numerics::bundle::{ROW, sum_at};

/// Force x, force y, moment.
type Parts<N> = [N; PARTS];

impl<'a, N: Reading> View<'a, N> {
    /// Find the force x, force y [N] and moment [N.m] that a joint transmits; the third of a coupling is the force that
    /// it transmits along the motion [N].
    #[inline(never)]
    pub fn find_reaction(&mut self, joint: usize) -> Result<(), OutputError> {
        self.find_sums(joint / ROW)?;
        let version = self.cache.version;
        if self.cache.reactions[joint].0 == version {
            return Ok(());
        }
        let mut value = self.reaction_along(joint)?;
        for mesh in 0..self.reduced.loading().meshes.len() {
            self.add_separation(mesh, joint, &mut value)?;
        }
        let value = value.map(finite);
        self.cache.reactions[joint] = (version, value);
        Ok(())
    }

    /// Add the reaction to the force |F_t| tan(alpha) that pushes the teeth of a mesh apart. It does no work, so that
    /// it changes neither the motion nor any tangential force F_t.
    #[cold]
    #[inline(never)]
    fn add_separation(&mut self, mesh: usize, joint: usize, value: &mut Parts<N>) -> Result<(), OutputError> {
        let Mesh { joint: own, loads, tangent } = self.reduced.loading().meshes[mesh];
        let version = self.cache.version;
        let transmitted = match self.cache.transmitted[mesh] {
            (known, transmitted) if known == version => transmitted,
            _ => self.reaction_along(own)?[2],
        };
        self.cache.transmitted[mesh] = (version, transmitted);
        let (size, load) = if transmitted.value() < 0.0 { (-transmitted, loads[0]) } else { (transmitted, loads[1]) };
        let parts = parts_of(self.reduced, joint);
        self.add_column(joint, 2 + load, size * tangent, &mut value[..parts])
    }

    /// [`Self::find_reaction`] without the forces that push teeth apart.
    fn reaction_along(&mut self, joint: usize) -> Result<Parts<N>, OutputError> {
        let (group, own) = (joint / ROW, joint % ROW);
        self.find_sums(group)?;
        let (reduced, sigma, at) = (self.reduced, self.sigma(), self.state.sigma);
        let GroupReactions { given, state, .. } = &self.loads.reactions[group];
        let is_sized = !self.cache.shares.acts || state.is_resolved[own];
        let (is_given, parts) = (given.is_resolved[own], parts_of(self.reduced, joint));
        let mut value = [N::constant(0.0); PARTS];
        match if is_given { Ok(()) } else { reduced.reaction(joint, at).map(|_| ()) } {
            Ok(()) => {
                let GroupValues { given, state, .. } = &self.cache.groups[group];
                let [given, state] =
                    [given, state].map(|sums| std::array::from_fn::<N, PARTS, _>(|part| sums[part][own]));
                value.iter_mut().zip(given).for_each(|(part, sum)| *part = *part + sum);
                self.add_changes(joint, &mut value[..parts])?;
                if is_sized {
                    value.iter_mut().zip(state).for_each(|(part, sum)| *part = *part + sum);
                } else {
                    self.add_sized_by_state(joint, &mut value[..parts])?;
                }
            }
            // The exact evaluator has no derivative along sigma.
            Err(at) if !sigma.is_constant() => return Err(at.into()),
            Err(_) => {
                reduced.exact_reactions(at, &mut self.cache.exact);
                self.add_exactly(joint, &mut value[..parts])?;
            }
        }
        self.add_held(joint, &mut value[..parts])?;
        Ok(value)
    }

    /// Add the reaction to all that causes it, of a joint that has no table at sigma.
    #[cold]
    fn add_exactly(&mut self, joint: usize, value: &mut [N]) -> Result<(), OutputError> {
        let reduced = self.reduced;
        let loading = reduced.loading();
        let mut passive = Vec::new();
        for spring in reduced.passive_springs() {
            passive.push((2 + loading.springs[spring].load, -spring_force(self, loading, spring)?));
        }
        let applied = (0..reduced.components().sized).filter(|load| !self.causes().decided().contains(load));
        let applied = applied.map(|load| (2 + load, self.size(load)));
        let given = self.causes().given_columns().zip(self.cache.shares.given.iter().copied());
        let given = given.filter(|(column, _)| *column < 2 + loading.base());
        let state = self.causes().state_columns().zip(self.cache.shares.state.iter().copied());
        let units = of_joint(self.cache.exact.reactions(), reduced, joint);
        for (column, size) in applied.chain(given).chain(passive).chain(state) {
            add(units(column), size, value);
        }
        Ok(())
    }

    /// What causes reactions in this state.
    #[inline]
    fn causes(&self) -> Causes<'a> {
        Causes { reduced: self.reduced, sigma: self.state.sigma, state_loads: self.state_loads() }
    }

    /// Sizes of what causes reactions, evaluated once for a state.
    fn find_shares(&mut self) -> Result<(), OutputError> {
        let version = self.cache.version;
        if self.cache.shares.version == version {
            return Ok(());
        }
        let (acceleration, sigma_dot) = (self.forces()?.acceleration, self.sigma_dot());
        let (causes, loading) = (self.causes(), self.reduced.loading());
        let given = &mut self.cache.shares.given;
        given.clear();
        given.push(acceleration);
        given.push(sigma_dot * sigma_dot);
        for &load in causes.decided() {
            let force = self.delivered(load);
            self.cache.shares.given.push(force);
        }
        for &spring in self.reduced.active_springs() {
            let force = spring_force(self, loading, spring)?;
            self.cache.shares.given.push(-force);
        }
        causes.find_acting(self.loads);
        let PresentLoads { sizes, acting, .. } = &*self.loads;
        let OutputCache { shares: Shares { given, state, acts, version: of }, scratch, .. } = &mut *self.cache;
        if self.reduced.sums_springs() {
            given.push(N::constant(1.0));
        }
        // The polynomials have the values of the inputs, without their derivatives.
        match acting.len() {
            0..=MOST_TERMS => acting.iter().for_each(|load| given.push(N::constant(sizes[*load]))),
            _ => given.push(N::constant(1.0)),
        }
        state.clear();
        state.extend_from_slice(&scratch.evaluator.loads);
        if let Some(state_loads) = causes.state_loads {
            // Their whole force is among those of springs.
            state[state_loads.spring(0)..state_loads.free()].fill(N::constant(0.0));
            // The forces that push teeth apart are those of the transmitted forces, which may be means at rest.
            for mesh in &loading.meshes {
                if let Some(teeth) = state_loads.loads.iter().position(|load| mesh.loads.contains(load)) {
                    state[teeth] = N::constant(0.0);
                }
            }
        }
        (*acts, *of) = (!state.iter().all(|size| size.value() == 0.0 && size.is_constant()), version);
        Ok(())
    }

    /// Find the sums of a group of joints for this state, and the reactions of these joints if they are no more than
    /// that.
    #[inline]
    fn find_sums(&mut self, group: usize) -> Result<(), OutputError> {
        if self.cache.groups[group].version == self.cache.version {
            return Ok(());
        }
        self.find_shares()?;
        self.find_group(group);
        self.cache.computed.reactions += 1;
        if !N::CARRIES && self.forces()?.held.is_none() && self.reduced.loading().meshes.is_empty() {
            self.finish(group);
        }
        Ok(())
    }

    /// The reactions of the joints of a group that have tables, where nothing but the sums makes them.
    fn finish(&mut self, group: usize) {
        let (joints, acts) = (joints_of(self.reduced, group), self.cache.shares.acts);
        let GroupReactions { given: with, state: with_state, .. } = &self.loads.reactions[group];
        let OutputCache { groups, reactions, version, .. } = &mut *self.cache;
        let GroupValues { given, state, .. } = &groups[group];
        let zero = N::constant(0.0);
        let mut totals = [[zero; ROW]; PARTS];
        for (part, total) in totals.iter_mut().enumerate() {
            *total = std::array::from_fn(|own| zero + given[part][own] + state[part][own]);
        }
        // One test for all, as a sum with an infinite term is not finite.
        if !totals.as_flattened().iter().fold(0.0, |sum, part| sum + part.value()).is_finite() {
            totals = totals.map(|total| total.map(finite));
        }
        for (own, reaction) in reactions[joints].iter_mut().enumerate() {
            if with.is_resolved[own] && (!acts || with_state.is_resolved[own]) {
                *reaction = (*version, totals.map(|total| total[own]));
            }
        }
    }

    /// Find the reactions of the joints of a group, of those that have tables at sigma, as sums over their terms.
    fn find_group(&mut self, group: usize) {
        let GroupReactions { given, has_applied, .. } = &self.loads.reactions[group];
        if !(*has_applied && given.holds(self.state.sigma)) {
            self.causes().enter_given(self.loads, group);
        }
        let acts = self.cache.shares.acts;
        let GroupReactions { state, air, .. } = &self.loads.reactions[group];
        if acts && !(*air == self.cache.scratch.air && state.holds(self.state.sigma)) {
            self.causes().enter_state(self.loads, group, self.cache.scratch.air);
        }
        let sigma = self.sigma();
        let GroupReactions { parts, given, state, .. } = &self.loads.reactions[group];
        let OutputCache { groups, shares, version, .. } = &mut *self.cache;
        let values = &mut groups[group];
        values.version = *version;
        values.given = sum_at((&given.rows, *parts), &shares.given, given.x(sigma));
        values.state = [[N::constant(0.0); ROW]; PARTS];
        if acts {
            values.state = sum_at((&state.rows, *parts), &shares.state, state.x(sigma));
        }
    }

    /// Add to a joint's reaction its change with the inputs along the direction, which the sizes of terms do not have.
    fn add_changes(&mut self, joint: usize, value: &mut [N]) -> Result<(), OutputError> {
        if N::CARRIES {
            let decided = self.causes().decided();
            for load in (0..self.reduced.loading().inputs.len()).filter(|load| !decided.contains(load)) {
                let change = self.size(load) - N::constant(self.loads.sizes[load]);
                self.add_column(joint, 2 + load, change, value)?;
            }
        }
        Ok(())
    }

    /// Add the reaction to what belongs to one column, of this size.
    fn add_column(&mut self, joint: usize, column: usize, size: N, value: &mut [N]) -> Result<(), OutputError> {
        if size.value() == 0.0 && size.is_constant() {
            return Ok(());
        }
        let (reduced, given) = (self.reduced, 2 + self.reduced.loading().base());
        let at = self.state.sigma;
        let (piece, own, columns) = match column.checked_sub(given) {
            None => (reduced.reaction(joint, at), column, reduced.reaction_terms()),
            Some(own) => (reduced.state_reaction(joint, at), own, 2 + reduced.loading().loads.len() - given),
        };
        match piece {
            Ok(PanelTable { table, .. }) => {
                let position = self.position(table);
                for (part, sum) in value.iter_mut().enumerate() {
                    *sum = *sum + size * self.component(table, position, part * columns + own);
                }
            }
            Err(at) if !self.sigma().is_constant() => return Err(at.into()),
            Err(_) => {
                let units = reduced.exact_reactions(self.state.sigma, &mut self.cache.exact);
                add(of_joint(units, reduced, joint)(column), size, value);
            }
        }
        Ok(())
    }

    /// Add the reaction to the loads that the state sizes, of a joint that has no table of it at sigma.
    #[cold]
    fn add_sized_by_state(&mut self, joint: usize, value: &mut [N]) -> Result<(), OutputError> {
        let (reduced, sigma) = (self.reduced, self.state.sigma);
        match reduced.state_reaction(joint, sigma) {
            Err(at) if !self.sigma().is_constant() => Err(at.into()),
            _ => {
                let columns = self.causes().state_columns();
                let OutputCache { exact, shares, .. } = &mut *self.cache;
                let units = of_joint(reduced.exact_reactions(sigma, exact), reduced, joint);
                columns.zip(&shares.state).for_each(|(column, size)| add(units(column), *size, value));
                Ok(())
            }
        }
    }

    /// Add the reaction to what holds the mechanism at rest: a rigid stop, or locks.
    fn add_held(&mut self, joint: usize, value: &mut [N]) -> Result<(), OutputError> {
        let (reduced, forces) = (self.reduced, *self.forces()?);
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

/// The reactions of one joint, by columns, among those of all.
fn of_joint<'a>(all: &'a [Reaction], reduced: &Reduced, joint: usize) -> impl Fn(usize) -> &'a Reaction {
    let joints = reduced.linkage().joints.len();
    move |column| &all[column * joints + joint]
}

/// Add the reaction to a load of this size.
fn add<N: Reading>(unit: &Reaction, size: N, parts: &mut [N]) {
    for (part, unit) in parts.iter_mut().zip([unit.force.x, unit.force.y, unit.moment]) {
        *part = *part + size * N::constant(unit);
    }
}
