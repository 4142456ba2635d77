//! Outputs of a hydraulic actuator: one law each, for values and for derivatives.
//!
//! In: the state, inputs, the predicted motion. Out: values on demand; the longest stable step with held inputs.
//! It must not know how a step is made.
use super::circuit::{ENERGIES, Equations, Flows, Point, Powers};
use super::state::Preview;
use foundation::numerics::dual::{Dual, Number};

/// A computed quantity; a side is 0 for chamber A and 1 for chamber B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the interface describes each")]
pub enum Output {
    Force,
    Stiffness,
    Damping,
    PreviewForce,
    PreviewForceRate,
    PreviewForceMean,
    PreviewLength,
    PreviewSpeed,
    PreviewStartAcceleration,
    PreviewAcceleration,
    Pressure(usize),
    Flow(usize),
    Volume(usize),
    BulkModulus(usize),
    SpoolPosition,
    SpoolSpeed,
    SupplyFlow,
    SupplyPressure,
    TankFlow,
    StrokePosition,
    EndForce,
    Power(usize),
    Energy(usize),
    Balance,
    StableStep,
}

impl Output {
    /// Whether the output needs the foreseen motion.
    pub fn is_foreseen(self) -> bool {
        use Output::{
            PreviewAcceleration, PreviewForce, PreviewForceMean, PreviewForceRate, PreviewLength, PreviewSpeed,
            PreviewStartAcceleration,
        };
        matches!(
            self,
            PreviewForce
                | PreviewForceRate
                | PreviewForceMean
                | PreviewLength
                | PreviewSpeed
                | PreviewStartAcceleration
                | PreviewAcceleration
        )
    }

    /// Value from the foreseen motion; none if the output needs the present state only.
    pub fn foreseen<T: Number>(self, preview: &Preview<T>) -> Option<T> {
        Some(match self {
            Self::PreviewForce => preview.force,
            Self::PreviewForceRate => preview.force_rate,
            Self::PreviewForceMean => preview.force_mean,
            Self::PreviewLength => preview.length,
            Self::PreviewSpeed => preview.speed,
            Self::PreviewStartAcceleration => preview.start_acceleration,
            Self::PreviewAcceleration => preview.acceleration,
            _ => return None,
        })
    }
}

/// The present state with all that follows from it alone.
#[derive(Clone, Copy, Debug)]
pub struct Present<T> {
    at: Point<T>,
    flows: Flows<T>,
    powers: Powers<T>,
    energies: [T; ENERGIES],
    end_force: T,
}

impl<T: Number> Present<T> {
    /// Evaluate the laws at a point. `energies`: those of the state; `end_force`: of the end of the cylinder at which
    /// the piston rests, from the force of the oil at rest.
    pub fn new(laws: &Equations, at: Point<T>, energies: [T; ENERGIES], end_force: impl Fn(T) -> T) -> Self {
        let flows = laws.flows(&at);
        let powers = laws.powers(&at, &flows);
        let end_force = end_force(laws.force(at.pressures, T::constant(0.0)));
        Self { at, flows, powers, energies, end_force }
    }

    /// Value of an output that needs the present state only; none if it needs the foreseen motion, or derivatives.
    pub fn output(&self, laws: &Equations, output: Output) -> Option<T> {
        let Self { at, flows, .. } = self;
        Some(match output {
            Output::Force => self.powers.force,
            Output::Stiffness => laws.stiffness(at.pressures, at.length),
            Output::Damping => laws.damping(at.pressures, at.speed),
            Output::Pressure(side) => at.pressures[side],
            Output::Flow(side) => flows.chambers[side],
            Output::Volume(side) => flows.volumes[side],
            Output::BulkModulus(side) => flows.bulk_moduli[side],
            Output::SpoolPosition => at.spool,
            Output::SpoolSpeed => at.spool_speed,
            Output::SupplyFlow => flows.supply,
            Output::SupplyPressure => at.supply,
            Output::TankFlow => flows.tank,
            Output::StrokePosition => at.length - T::constant(laws.lengths()[0]),
            Output::EndForce => self.end_force,
            Output::Power(index) => self.powers.in_order()[index],
            Output::Energy(index) => self.energies[index],
            Output::Balance => {
                let [supplied, spent @ ..] = self.energies;
                spent.into_iter().fold(supplied, |balance, spent| balance - spent)
            }
            _ => return None,
        })
    }
}

/// Largest step [s] of a coupling that exchanges force and motion with held inputs: with the eigenvalue lambda = -zeta
/// omega +- i omega sqrt(1 - zeta^2) of (s, v, p_A, p_B) for a mass m, explicit Euler's |1 + h lambda| <= 1 for h <= 2
/// zeta / omega. 0: no mass, or a motion that grows at any step. Where nothing oscillates, the step that the fastest
/// decay allows.
pub fn stable_step(laws: &Equations, at: &Point<f64>, mass: f64) -> f64 {
    if mass <= 0.0 {
        return 0.0;
    }
    let [p_a, p_b] = at.pressures;
    let dual = |value, k| Dual::<4>::variable(value, k);
    let constant = Dual::<4>::constant;
    let pressures = [dual(p_a, 2), dual(p_b, 3)];
    let (length, speed) = (dual(at.length, 0), dual(at.speed, 1));
    let flows = laws.flows(&Point {
        pressures,
        spool: constant(at.spool),
        spool_speed: constant(at.spool_speed),
        length,
        speed,
        supply: constant(at.supply),
        tank: constant(at.tank),
        command: constant(at.command),
    });
    let acceleration = laws.force(pressures, speed) * (1.0 / mass);
    let rows = [[0.0, 1.0, 0.0, 0.0], acceleration.slope, flows.pressure_rates[0].slope, flows.pressure_rates[1].slope];
    // Pressures in units in which the oil spring couples them with the speed as strongly as back.
    let size: f64 = rows[2][1].abs().max(rows[3][1].abs()) * (rows[1][2].abs().max(rows[1][3].abs()));
    let unit = (rows[2][1].abs().max(rows[3][1].abs()) / size.sqrt()).max(f64::MIN_POSITIVE);
    let units = [1.0, 1.0, unit, unit];
    let matrix = std::array::from_fn(|i| std::array::from_fn(|j| rows[i][j] * units[j] / units[i]));
    let mut step = f64::INFINITY;
    let mut oscillation = 0.0;
    let roots = eigenvalues(&matrix);
    for [re, im] in roots {
        let square = re * re + im * im;
        if im > 0.0 && square > oscillation {
            (oscillation, step) = (square, -2.0 * re / square);
        }
    }
    if oscillation == 0.0 {
        let fastest = roots.iter().fold(0.0_f64, |fastest, [re, _]| fastest.min(*re));
        step = -2.0 / fastest;
    }
    if step.is_finite() { step.max(0.0) } else { 0.0 }
}

/// Eigenvalues of a matrix of order 4 as real and imaginary parts: roots of its characteristic polynomial, by the
/// method of Durand and Kerner. The polynomial is made by that of Faddeev and Le Verrier.
pub fn eigenvalues(matrix: &[[f64; 4]; 4]) -> [[f64; 2]; 4] {
    // Scaled to size 1.
    let size = matrix.iter().flatten().fold(0.0_f64, |size, entry| size.max(entry.abs()));
    if size == 0.0 || !size.is_finite() {
        return [[0.0; 2]; 4];
    }
    let a = matrix.map(|row| row.map(|entry| entry / size));
    let product = |a: &[[f64; 4]; 4], b: &[[f64; 4]; 4]| -> [[f64; 4]; 4] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
    };
    // lambda^4 + c[3] lambda^3 + ... + c[0].
    let mut c = [0.0; 4];
    let mut m = [[0.0; 4]; 4];
    (0..4).for_each(|i| m[i][i] = 1.0);
    for k in 1..=4 {
        let am = product(&a, &m);
        let trace: f64 = (0..4).map(|i| am[i][i]).sum();
        c[4 - k] = -trace / k as f64;
        m = am;
        (0..4).for_each(|i| m[i][i] += c[4 - k]);
    }
    let times = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
    let mut z = [[1.0, 0.0], [0.4, 0.9], [-0.65, 0.72], [-0.908, -0.297]];
    for _ in 0..200 {
        let mut change: f64 = 0.0;
        for i in 0..4 {
            let value = c.iter().rev().fold([1.0, 0.0], |sum, c| {
                let [re, im] = times(sum, z[i]);
                [re + c, im]
            });
            let mut others = [1.0, 0.0];
            for j in (0..4).filter(|j| *j != i) {
                others = times(others, [z[i][0] - z[j][0], z[i][1] - z[j][1]]);
            }
            let square = others[0] * others[0] + others[1] * others[1];
            if square == 0.0 {
                continue;
            }
            let [re, im] = times(value, [others[0] / square, -others[1] / square]);
            (z[i][0], z[i][1]) = (z[i][0] - re, z[i][1] - im);
            change = change.max(re.abs() + im.abs());
        }
        if change < 1e-15 {
            break;
        }
    }
    // Rounding leaves real roots a small imaginary part.
    z.map(|[re, im]| if im.abs() < 1e-9 { [re * size, 0.0] } else { [re * size, im * size] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::Circuit;

    #[test]
    fn eigenvalues_of_a_known_matrix() {
        // Blocks [[-1, 3], [-3, -1]] and diag(-5, 2), mixed by a shear.
        let shear = |row: [f64; 4]| [row[0], row[1], row[2] + 0.5 * row[0], row[3] - row[1]];
        let mut a =
            [[-1.0, 3.0, 0.0, 0.0], [-3.0, -1.0, 0.0, 0.0], [0.0, 0.0, -5.0, 0.0], [0.0, 0.0, 0.0, 2.0]].map(shear);
        let [_, _, third, fourth] = a;
        (0..4).for_each(|j| a[0][j] -= 0.5 * third[j]);
        (0..4).for_each(|j| a[1][j] += fourth[j]);
        let mut roots = eigenvalues(&a);
        roots.sort_by(|a, b| (a[0], a[1]).partial_cmp(&(b[0], b[1])).unwrap());
        for (root, expected) in roots.iter().zip([[-5.0, 0.0], [-1.0, -3.0], [-1.0, 3.0], [2.0, 0.0]]) {
            assert!((root[0] - expected[0]).abs() < 1e-12 && (root[1] - expected[1]).abs() < 1e-12, "{roots:?}");
        }
    }

    /// The table of stiffness and damping against angles, in which masses and stiffnesses stand to 3 digits.
    #[test]
    fn the_stable_step_is_that_of_the_oil_spring() {
        let laws = Equations::new(&Circuit::default());
        // At 0.253 rad: the state of the retraction at 1 s; mass there from the neighbouring angles of the table.
        let at = Point {
            pressures: [5_650_165.237, 7_478_162.767],
            spool: 0.65,
            spool_speed: 0.0,
            length: 0.500_463,
            speed: 0.084_888_7,
            supply: 20.7e6,
            tank: 0.35e6,
            command: 0.65,
        };
        let step = stable_step(&laws, &at, 690.0);
        assert!((1.00e-3..1.08e-3).contains(&step), "{step}");
        assert_eq!(stable_step(&laws, &at, 0.0), 0.0);
        assert!(stable_step(&laws, &at, 1e-3) >= 0.0);
    }
}
