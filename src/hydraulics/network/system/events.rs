//! Where a step of an integration comes to an event of the network.
//!
//! In: a step. Out: the step up to its first event. It must not know what the host does there.
use super::{Job, Motion};
use crate::events;
use crate::network::laws::{Drive, Rest, Surroundings};
use foundation::integrator::{Integrator, Step};

/// Distance from an end of the travel within which a limit is this end [m].
const ON_END: f64 = 1e-9;

impl Job<'_> {
    /// A step up to the first event in it. `met`: the cylinder that meets a limit at the end of the step.
    #[cold]
    pub(super) fn cut_at_event<const N: usize>(
        &mut self,
        memory: &mut Integrator<N>,
        step: Step<N>,
        met: &mut Option<(usize, f64)>,
    ) -> Step<N> {
        let (mut job, laws) = (*self, self.laws);
        let guard = |event: usize, t: f64, y: &[f64; N]| {
            let length = |cylinder: usize| match job.motions[cylinder] {
                Motion::Given([length, _]) => length.at(t),
                Motion::Own(Drive::Held(length) | Drive::End(Rest { end: length, .. })) => length,
                Motion::Own(_) => y[laws.layout.motion(cylinder)],
            };
            let reservoir = |index: usize| job.inputs.polynomial(index).quadratic_at(t);
            let locks = job.watched.unwrap_or(&[]);
            let surroundings = Surroundings { y, length: &length, reservoir: &reservoir, locks };
            laws.guard(event, &surroundings, job.tolerance)
        };
        let dense = || memory.dense(&mut { job }, &step);
        let found = events::first(laws.event_count(), &step, &guard, dense);
        let Some((event, part)) = found else {
            // A cylinder that meets an end of its travel.
            let is_end = |(cylinder, limit): &(usize, f64)| {
                let lengths @ [least, most] = laws.cylinders[*cylinder].laws.lengths();
                let way = (step.start[laws.layout.motion(*cylinder)] - limit).abs();
                lengths.iter().any(|end| (limit - end).abs() <= ON_END)
                    && way > events::nearness(job.tolerance) * (most - least)
            };
            let end = met.as_ref().filter(|met| is_end(met));
            self.event = end.map(|(cylinder, _)| laws.event_count() + cylinder);
            return step;
        };
        self.event = Some(event);
        if part < 1.0 {
            *met = None;
            return memory.retake(&mut job, &step, part * step.h);
        }
        step
    }
}
