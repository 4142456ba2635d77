//! The derivative of a step of a network along one direction.
//!
//! In: a job, a direction in which its start and its inputs change. Out: the state at the end of the step with its
//! derivative. A limit that a cylinder meets within the step has no derivative.
use super::{Job, Memory, Motion, SMALL, flow_inputs};
use crate::circuit::FREE;
use crate::network::definition::{MOST_COMPONENTS, MOST_CYLINDERS};
use crate::network::laws::Drive;
use foundation::integrator::{Integrator, System};
use foundation::numerics::dual::{Dual, Number};

/// A network and the derivative of its motion along one direction: the variational equations, by dual numbers. M is
/// twice the capacity N.
struct Tangent<'a, const N: usize> {
    job: Job<'a>,
    drives: [Drive<Dual<1>>; MOST_CYLINDERS],
    /// Change of the flow inputs along the direction.
    ports: [f64; N],
}

impl<const N: usize, const M: usize> System<M> for Tangent<'_, N> {
    fn derivative(&mut self, t: f64, y: &[f64; M]) -> [f64; M] {
        let duals: [Dual<1>; N] = std::array::from_fn(|k| Dual { value: y[k], slope: [y[N + k]] });
        let values = flow_inputs::<N>(self.job.laws, self.job.inputs, t);
        let u: [Dual<1>; N] = std::array::from_fn(|k| Dual { value: values[k], slope: [self.ports[k]] });
        let mut drives = self.drives;
        for (drive, motion) in drives.iter_mut().zip(&self.job.motions) {
            if let (Drive::Given([length, speed]), Motion::Given(motion)) = (drive, motion) {
                let changed = length.slope[0] + t * speed.slope[0];
                (length.value, speed.value) = (motion[0].at(t), motion[1].at(t));
                length.slope = [changed];
            }
        }
        let count = self.job.laws.layout.cylinders;
        let rates = self.job.laws.rates(&drives[..count], &u, Dual::constant(t), &duals);
        std::array::from_fn(|k| if k < N { rates[k].value } else { rates[k - N].slope[0] })
    }

    fn scale(&mut self, y: &[f64; M], f: &[f64; M]) -> [f64; M] {
        let values: [f64; N] = std::array::from_fn(|k| y[k]);
        let scale = self.job.scale(&values, &std::array::from_fn(|k| f[k]));
        // The derivative is as exact as the motion, which the control of its errors sees to.
        std::array::from_fn(|k| if k < N { scale[k] * (N as f64 / M as f64).sqrt() } else { FREE })
    }

    fn admits(&mut self, y: &[f64; M]) -> bool {
        self.job.laws.has_pressures(y)
    }
}

impl Job<'_> {
    /// The state y at the end of a step of size h, with its derivative along a direction: of the state at the start, of
    /// the flow inputs, and of what moves the cylinders, with lengths and speeds at the start. None if no motion is
    /// found.
    pub fn advance_change(
        &self,
        y: &[f64],
        (change, ports): (&[f64], &[f64]),
        drives: [Drive<Dual<1>>; MOST_CYLINDERS],
        h: f64,
    ) -> Option<Vec<Dual<1>>> {
        match Memory::new(&self.laws.layout) {
            Memory::Small(_) => self.change_in::<SMALL, { 2 * SMALL }>(y, (change, ports), drives, h),
            Memory::Large(_) => {
                self.change_in::<MOST_COMPONENTS, { 2 * MOST_COMPONENTS }>(y, (change, ports), drives, h)
            }
        }
    }

    fn change_in<const N: usize, const M: usize>(
        &self,
        y: &[f64],
        (change, ports): (&[f64], &[f64]),
        drives: [Drive<Dual<1>>; MOST_CYLINDERS],
        h: f64,
    ) -> Option<Vec<Dual<1>>> {
        let mut all = [0.0; M];
        all[..y.len()].copy_from_slice(y);
        all[N..N + change.len()].copy_from_slice(change);
        let mut own = [0.0; N];
        own[..ports.len()].copy_from_slice(ports);
        let mut system = Tangent::<N> { job: *self, drives, ports: own };
        let mut memory = Integrator::<M>::default();
        let (mut t, most) = (0.0, self.max_steps as u64);
        let (instants, count) = self.instants(h);
        for &end in &instants[..count] {
            if memory.advance_from(&mut system, &mut t, &mut all, end, self.tolerance, most) != Ok(true) {
                return None;
            }
            t = end;
            memory.refresh();
        }
        Some((0..y.len()).map(|k| Dual { value: all[k], slope: [all[N + k]] }).collect())
    }
}
