//! The reduced model behind the laws of outputs.
use crate::mechanism::outputs::error::OutputError;
use crate::mechanism::outputs::evaluator::Kinematics;
use crate::mechanism::outputs::view::{Reading, View};
use crate::mechanism::quantity::OneElement;

impl<N: Reading> Kinematics<N> for View<'_, N> {
    #[inline]
    fn angle(&mut self, body: usize, order: usize) -> Result<N, OutputError> {
        let body = &self.reduced.linkage().bodies[body];
        let Some(coordinate) = body.angle_coordinate else { return Ok(N::constant(0.0)) };
        let value = self.coordinate(coordinate, order)?;
        Ok(if order == 0 { value + N::constant(body.offset) } else { value })
    }

    #[inline]
    fn joint_position(&mut self, coordinate: usize, order: usize) -> Result<N, OutputError> {
        self.coordinate(coordinate, order)
    }

    fn displacement(&mut self, load: usize, order: usize) -> Result<N, OutputError> {
        let (reduced, sigma) = (self.reduced, self.sigma());
        let table = reduced.displacement(load);
        if order > 0 {
            let table = table?;
            return self.time_derivative((table, table.spot(self.state.sigma)), 0, order);
        }
        let slope = match table {
            _ if sigma.is_constant() => 0.0,
            Ok(table) => table.value(table.spot(self.state.sigma), 1),
            Err(_) => {
                let c = reduced.curve().configuration(self.state.sigma);
                reduced.loading().loads[load].influence(reduced.linkage(), &c)
            }
        };
        Ok(sigma.chain(self.state.displacement(reduced, load), slope))
    }

    fn marker(&mut self, marker: usize, axis: usize, order: usize) -> Result<N, OutputError> {
        let table = self.reduced.marker(marker)?;
        self.time_derivative((table, table.spot(self.state.sigma)), 3 * axis, order)
    }

    #[inline]
    fn reaction(&mut self, joint: usize) -> Result<[N; 3], OutputError> {
        self.joint_reaction(joint)
    }

    fn size(&self, load: usize) -> N {
        self.load_size(load)
    }

    fn state_load(&mut self, load: usize) -> Result<N, OutputError> {
        self.forces()?;
        Ok(self.state_load_size(load))
    }

    fn stop_force(&mut self, stop: usize) -> Result<N, OutputError> {
        self.holding_stop(stop)
    }

    fn lock_force(&mut self, lock: usize) -> Result<N, OutputError> {
        self.holding_lock(lock)
    }

    fn one_element(&mut self, drive: usize, term: OneElement) -> Result<N, OutputError> {
        self.drive_term(drive, term)
    }

    fn kinetic(&self) -> N {
        self.sigma_dot() * self.sigma_dot() * 0.5
    }

    fn drift(&self) -> N {
        N::constant(self.state.kinetic() + self.state.load_potential(self.reduced) - self.state.reference)
    }
}
