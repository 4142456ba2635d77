//! The variables of a version that are not variables of the component: the time, then the vectors. The elements of a
//! vector are outputs of the component.
//!
//! In: value references. Out: the corresponding scalars, in the order in which values are serialised. Must not know:
//! how a value is found.
use super::instance::Instance;
use super::refusal::Refusal;
use crate::variables::{Kind, Reference, Vector};
use std::mem::{MaybeUninit, take};

/// Dependencies of an unknown. First entry: the element of the unknown that depends on a known, from 1, or 0 for a
/// scalar. Second entry: the reference of the known.
pub type Dependencies = Vec<(usize, Reference)>;

impl Instance {
    /// Reference of the time, which follows those of the component.
    pub fn time_reference(&self) -> Reference {
        self.component.interface().list().len() as Reference
    }

    /// The vector with this reference, if there is one. References of vectors follow the reference of the time.
    fn vector(&self, reference: Reference) -> Option<&Vector> {
        let index = reference.checked_sub(self.time_reference())?.checked_sub(1)?;
        self.vectors.get(index as usize)
    }

    /// Name and kind of the variable with this reference, for messages.
    pub fn described(&self, reference: Reference) -> Option<(&str, Kind)> {
        if let Some(variable) = self.component.interface().get(reference) {
            return Some((&variable.name, variable.kind));
        }
        let is_time = self.version.has_vectors() && reference == self.time_reference();
        let name = if is_time { Some("time") } else { self.vector(reference).map(|vector| &*vector.name) };
        name.map(|name| (name, Kind::Real))
    }

    /// Does `work` with the scalars of these references, one for each value. The time is one scalar. `values` is the
    /// number of values that the host has passed.
    ///
    /// # Errors
    /// The numbers of values and scalars differ, or the work returns an error.
    #[inline(never)]
    pub fn serialised(
        &mut self,
        references: &[Reference],
        values: usize,
        work: impl FnOnce(&mut Self, &[Reference]) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        let time = self.time_reference();
        if references.len() == values && references.iter().all(|&reference| reference <= time) {
            return work(self, references);
        }
        let scalars = self.scalars_of(references);
        let answer = match scalars.len() == values {
            true => work(self, &scalars),
            false => Err(wrong_number(references.len(), scalars.len(), values)),
        };
        self.scalars = scalars;
        answer
    }

    /// The scalars of these variables, in the room of `scalars`.
    #[inline(never)]
    fn scalars_of(&mut self, references: &[Reference]) -> Vec<Reference> {
        let mut scalars = take(&mut self.scalars);
        scalars.clear();
        for reference in references {
            let elements = self.vector(*reference).map_or(std::slice::from_ref(reference), |vector| &vector.elements);
            scalars.extend_from_slice(elements);
        }
        scalars
    }

    /// Reads Reals, the time and vectors, like [`Instance::get_real`].
    #[inline]
    pub fn get_serialised(&mut self, references: &[Reference], values: &mut [MaybeUninit<f64>]) -> Result<(), Refusal> {
        let other = |i: &mut Self, references: &[Reference], values: &mut [MaybeUninit<f64>]| {
            i.serialised(references, values.len(), |i, scalars| i.get_real_or_time(scalars, values))
        };
        if references.len() == values.len() {
            self.get_real_or(references, values, other)
        } else {
            other(self, references, values)
        }
    }

    /// Reads Reals and the time, like [`Instance::get_real`].
    fn get_real_or_time(&mut self, references: &[Reference], values: &mut [MaybeUninit<f64>]) -> Result<(), Refusal> {
        let time = self.time_reference();
        if !references.contains(&time) {
            return self.get_real(references, values);
        }
        let now = self.clock.time;
        references.iter().zip(&mut *values).filter(|(reference, _)| **reference == time).for_each(|(_, value)| {
            value.write(now);
        });
        self.get_each_real(references, references.iter().zip(values).filter(|(reference, _)| **reference != time))
    }

    /// Sets Reals, like [`Instance::set_real`]. The time and vectors cannot be set.
    #[inline]
    pub fn set_serialised(&mut self, references: &[Reference], values: &[f64]) -> Result<(), Refusal> {
        if references.len() == values.len() && self.set_real(references, values).is_ok() {
            return Ok(());
        }
        // The call is rejected, and nothing has changed. The reason may be that of a vector.
        self.without_time(references, "the variable cannot be set")?;
        self.serialised(references, values.len(), |i, scalars| i.set_real(scalars, values))
    }

    /// Rejects the time in calls about variables of the component.
    ///
    /// # Errors
    /// One of these references is that of the time. `what` states the restriction.
    pub fn without_time(&self, references: &[Reference], what: &str) -> Result<(), Refusal> {
        match references.iter().find(|&&reference| reference == self.time_reference()) {
            Some(vr) => {
                Err(Refusal::error(format!("'time' (value reference {vr}) is the independent variable; {what}")))
            }
            None => Ok(()),
        }
    }

    /// Rejects vectors.
    ///
    /// # Errors
    /// One of these references is that of a vector. `what` states the reason.
    pub fn without_vectors(&self, references: &[Reference], what: &str) -> Result<(), Refusal> {
        match references.iter().find_map(|&reference| Some((reference, self.vector(reference)?))) {
            Some((vr, vector)) => Err(Refusal::error(format!("'{}' (value reference {vr}): {what}", vector.name))),
            None => Ok(()),
        }
    }

    /// [`Self::serialised`] with an order of derivatives for each variable, which holds for all elements of the
    /// variable.
    ///
    /// # Errors
    /// As [`Self::serialised`].
    pub fn serialised_orders(
        &mut self,
        references: &[Reference],
        orders: &[i32],
        values: usize,
        work: impl FnOnce(&mut Self, &[Reference], &[i32]) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        if references.iter().all(|&reference| self.vector(reference).is_none()) {
            return self.serialised(references, values, |i, scalars| work(i, scalars, orders));
        }
        let mut all = take(&mut self.orders);
        all.clear();
        for (reference, order) in references.iter().zip(orders) {
            let elements = self.vector(*reference).map_or(1, |vector| vector.elements.len());
            all.extend(std::iter::repeat_n(*order, elements));
        }
        let answer = self.serialised(references, values, |i, scalars| work(i, scalars, &all));
        self.orders = all;
        answer
    }

    /// The knowns on which an output depends, element by element. Before the end of initialization mode, the
    /// dependencies are those of the initial value.
    ///
    /// # Errors
    /// The variable is not an output, or no model can be built with the present parameters.
    pub fn dependencies(&mut self, reference: Reference) -> Result<Dependencies, Refusal> {
        let elements = self.vector(reference).map_or([Some(reference), None], |vector| vector.elements.map(Some));
        let is_vector = elements[1].is_some();
        let is_initial = self.phase.precedes_steps();
        if is_initial && self.initial_dependencies.is_none() {
            self.initial_dependencies = Some(self.component.initial_dependencies()?);
        }
        let list = self.component.interface().list();
        let mut all = Dependencies::new();
        for (element, scalar) in (1..).zip(elements.into_iter().flatten()) {
            let Some(output) = list.get(scalar as usize).filter(|variable| variable.is_output()) else {
                return Err(no_output(self, reference));
            };
            let initial = self.initial_dependencies.as_ref().filter(|_| is_initial);
            let knowns: Vec<Reference> = match initial {
                Some(Some(initial)) => initial[scalar as usize].clone(),
                // The model is too large to find the dependencies: all knowns are returned.
                Some(None) => (0..).zip(list).filter(|(_, v)| v.start.is_some()).map(|(known, _)| known).collect(),
                None => output.dependencies.clone(),
            };
            all.extend(knowns.into_iter().map(|known| (if is_vector { element } else { 0 }, known)));
        }
        Ok(all)
    }
}

/// The refusal of an array whose length does not fit the variables.
#[cold]
pub fn wrong_number(variables: usize, scalars: usize, values: usize) -> Refusal {
    let plural = if variables == 1 { "" } else { "s" };
    Refusal::error(format!(
        "{values} values were passed for {variables} variable{plural} with {scalars} elements in total; pass {scalars} \
         values"
    ))
}

/// The refusal of a variable without dependencies.
#[cold]
fn no_output(instance: &Instance, reference: Reference) -> Refusal {
    let what = match instance.described(reference) {
        Some((name, _)) => format!("'{name}' (value reference {reference}) is not an output"),
        None => format!("value reference {reference} does not exist"),
    };
    Refusal::error(format!("{what}; dependencies are available for outputs only"))
}
