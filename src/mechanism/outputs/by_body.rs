//! The part of one body in the mechanism reduced to a drive. Source: [CK16] eqs. (1), (2), (11), (12), (22), (23),
//! (32), (33) and conclusion 3.
//!
//! In: the reduced model in one state. Out: reduced mass, load and ratios of one body. It must not know the drive's
//! kind.
use crate::mechanism::loads::resolved::DriveLaw;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError, spring_force};
use crate::mechanism::outputs::view::{Reading, View};
use crate::mechanism::quantity::BodyPart;

impl<N: Reading> View<'_, N> {
    /// A part of a body. With S the drive's displacement, C the centre of mass and theta the angle of the body, dC/dS =
    /// C_sigma / S_sigma and dtheta/dS = theta_sigma / S_sigma.
    pub fn of_body(&mut self, drive: usize, body: usize, part: BodyPart) -> Result<N, OutputError> {
        let slope = self.slopes_of(drive)?[0];
        let (reduced, zero) = (self.reduced, N::constant(0.0));
        let bodies = reduced.bodies();
        let (table, position) = bodies.table(self.state.sigma, self.cache.panel)?;
        let [x, y, angle] = bodies.motion(body).map(|component| self.component(table, position, component));
        let (mass, inertia) = (reduced.linkage().bodies[body].mass, reduced.linkage().bodies[body].inertia);
        Ok(match part {
            BodyPart::ReducedMass => ((x * x + y * y) * mass + angle * angle * inertia) / (slope * slope),
            BodyPart::CenterByDrive => x.hypot(y) / slope.hypot(zero),
            BodyPart::DriveByCenter => slope.hypot(zero) / x.hypot(y),
            BodyPart::DriveByAngle => slope / angle,
            BodyPart::StaticLoad => {
                // The acceleration decides the sizes of some loads.
                self.forces()?;
                let loading = reduced.loading();
                let mut work = zero;
                if let Some(gravity) = loading.gravity
                    && let Load::Gravity(acceleration) = loading.loads[gravity]
                {
                    work = (x * acceleration.x + y * acceleration.y) * mass * self.size(gravity);
                }
                let own = loading.drives[drive].law.as_ref().map_or(0..0, DriveLaw::commands);
                for (index, &[load, on]) in bodies.pairs.iter().enumerate() {
                    if on == body && load != drive && !own.contains(&load) {
                        work = work + self.present_size(load)? * self.component(table, position, bodies.work(index));
                    }
                }
                zero - work / slope
            }
        })
    }

    /// Size of a load in this state, after the loss of its drive if it has one. The whole force of a spring counts at
    /// its first load.
    fn present_size(&mut self, load: usize) -> Result<N, OutputError> {
        let loading = self.reduced.loading();
        match load.checked_sub(loading.sized()) {
            None => Ok(self.delivered(load)),
            Some(spring) if spring < loading.springs.len() => Ok(-spring_force(self, loading, spring)?),
            _ if loading.springs.iter().any(|spring| spring.state_load == Some(load)) => Ok(N::constant(0.0)),
            _ => self.state_load(load),
        }
    }
}
