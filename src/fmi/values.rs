//! Values of an instance's variables, read and set.
//!
//! In: value references, checked slices. Out: values, or a refusal that leaves the instance unchanged. Must not know:
//! pointers to instances, how a value is found.

use super::access::{Way, may_get, may_get_all, may_set};
use super::array::zeroed;
use super::instance::Instance;
use super::phase::Phase;
use super::refusal::Refusal;
use super::undefined::Undefined;
use crate::component::{Component, Refused};
use crate::variables::{Kind, Reference};
use std::mem::MaybeUninit;

/// Reads Reals on another way than that of most calls.
type OtherRead = fn(&mut Instance, &[Reference], &mut [MaybeUninit<f64>]) -> Result<(), Refusal>;

/// Name of the item of an Enumeration with this number.
fn item(component: &Component, reference: Reference, number: i64) -> Result<&'static str, Refused> {
    let Some(variable) = component.interface().get(reference) else { return Ok("") };
    let items = variable.details.items;
    let item = usize::try_from(number).ok().and_then(|number| items.get(number.checked_sub(1)?));
    item.copied().ok_or_else(|| {
        let allowed: Vec<_> = items.iter().enumerate().map(|(index, name)| format!("{} ({name})", index + 1)).collect();
        Refused(format!("{} = {number}: must be {}", variable.name, allowed.join(" or ")))
    })
}

impl Instance {
    /// Reads Reals. An output that has no value in this state is NaN, and a warning states the reason. The other values
    /// are returned. After an error, the array may be partly filled.
    #[inline]
    pub fn get_real(&mut self, references: &[Reference], values: &mut [MaybeUninit<f64>]) -> Result<(), Refusal> {
        self.get_real_or(references, values, |i, references, _| {
            references.iter().try_for_each(|&reference| may_get(i, reference, Kind::Real))
        })
    }

    /// [`Self::get_real`]. `other` answers if one of the references is not that of a Real that can be read now.
    pub(super) fn get_real_or(
        &mut self,
        references: &[Reference],
        values: &mut [MaybeUninit<f64>],
        other: OtherRead,
    ) -> Result<(), Refusal> {
        // Outputs that were read before can be read from initialization mode on.
        if self.phase != Phase::Instantiated
            && let Some(have_all) = self.component.reread(references, || zeroed(values))
        {
            return if have_all { Ok(()) } else { self.warn(references, "value", Component::undefined) };
        }
        if !may_get_all(self, references, Kind::Real) {
            return other(self, references, values);
        }
        let (mut undefined, mut values) = (false, values.iter_mut());
        self.component.reals(references, |number| {
            undefined |= number.is_nan();
            values.next().into_iter().for_each(|value| _ = value.write(number));
        })?;
        if undefined { self.warn(references, "value", Component::undefined) } else { Ok(()) }
    }

    /// [`Self::get_real`] for some of the references of a call.
    #[inline]
    pub(super) fn get_each_real<'a>(
        &mut self,
        references: &[Reference],
        values: impl Iterator<Item = (&'a Reference, &'a mut MaybeUninit<f64>)>,
    ) -> Result<(), Refusal> {
        let mut undefined = false;
        for (&reference, value) in values {
            may_get(self, reference, Kind::Real)?;
            let number = self.component.real(reference)?;
            undefined |= number.is_nan();
            value.write(number);
        }
        if undefined { self.warn(references, "value", Component::undefined) } else { Ok(()) }
    }

    /// The warning that names the variables for which `why` returns a reason.
    #[cold]
    pub(super) fn warn(
        &mut self,
        references: &[Reference],
        what: &'static str,
        why: impl Fn(&mut Component, Reference) -> Option<String>,
    ) -> Result<(), Refusal> {
        let mut undefined = Undefined::new(what);
        for &reference in references {
            if let Some(reason) = why(&mut self.component, reference) {
                let name = self.component.interface().get(reference).map_or("", |variable| &variable.name);
                undefined.add(name, reason);
            }
        }
        undefined.warning().map_or(Ok(()), Err)
    }

    /// Reads Booleans, as 0 and 1 of the type `B`. After an error, the array may be partly filled.
    pub fn get_boolean<B: From<bool>>(
        &mut self,
        references: &[Reference],
        values: &mut [MaybeUninit<B>],
    ) -> Result<(), Refusal> {
        for (&reference, value) in references.iter().zip(values) {
            may_get(self, reference, Kind::Boolean)?;
            value.write(self.component.boolean(reference)?.into());
        }
        Ok(())
    }

    /// Reads Enumerations, as numbers of the type `N` from 1 on. After an error, the array may be partly filled.
    pub fn get_enumeration<N: From<i32>>(
        &mut self,
        references: &[Reference],
        values: &mut [MaybeUninit<N>],
    ) -> Result<(), Refusal> {
        for (&reference, value) in references.iter().zip(values) {
            may_get(self, reference, Kind::Enumeration)?;
            value.write((self.component.item(reference)? as i32 + 1).into());
        }
        Ok(())
    }

    /// Sets Reals. After an error, no value has changed.
    pub fn set_real(&mut self, references: &[Reference], values: &[f64]) -> Result<(), Refusal> {
        let mut tunes = false;
        for (&reference, &value) in references.iter().zip(values) {
            tunes |= may_set(self, reference, Kind::Real)? == Way::Tuned;
            self.component.check_real(reference, value)?;
        }
        self.component.check_together(references, values)?;
        if tunes {
            self.component.tune(references, values)?;
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.component.take_real(reference, value)?;
        }
        Ok(())
    }

    /// Sets Booleans. After an error, no value has changed.
    pub fn set_boolean(
        &mut self,
        references: &[Reference],
        values: impl Iterator<Item = bool> + Clone,
    ) -> Result<(), Refusal> {
        self.set(references, values, Kind::Boolean, Component::check_boolean, Component::set_boolean)
    }

    /// Sets Enumerations by the numbers of their items. After an error, no value has changed.
    pub fn set_enumeration(
        &mut self,
        references: &[Reference],
        values: impl Iterator<Item = i64> + Clone,
    ) -> Result<(), Refusal> {
        let check = |component: &Component, reference, number| {
            component.check_text(reference, item(component, reference, number)?)
        };
        let set = |component: &mut Component, reference, number| {
            component.set_text(reference, item(component, reference, number)?)
        };
        self.set(references, values, Kind::Enumeration, check, set)
    }

    /// Checks all values, then sets all.
    #[inline]
    fn set<V>(
        &mut self,
        references: &[Reference],
        values: impl Iterator<Item = V> + Clone,
        kind: Kind,
        check: impl Fn(&Component, Reference, V) -> Result<(), Refused>,
        set: impl Fn(&mut Component, Reference, V) -> Result<(), Refused>,
    ) -> Result<(), Refusal> {
        for (&reference, value) in references.iter().zip(values.clone()) {
            may_set(self, reference, kind)?;
            check(&self.component, reference, value)?;
        }
        for (&reference, value) in references.iter().zip(values) {
            set(&mut self.component, reference, value)?;
        }
        Ok(())
    }
}
