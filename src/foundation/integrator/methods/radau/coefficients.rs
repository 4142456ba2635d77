//! Coefficients of Radau IIA with three stages.
//!
//! Source: Hairer, Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996): the method, table IV.5.6; the
//! transformation and the error estimate, IV.8. Numbers of T and T^-1 as in their RADAU5.

/// Number of stages.
pub const STAGES: usize = 3;

const ROOT_6: f64 = 2.449_489_742_783_178;

/// Nodes c_i: the roots of d^2/dx^2 (x^2 (x - 1)^3).
pub const C: [f64; STAGES] = [0.4 - 0.1 * ROOT_6, 0.4 + 0.1 * ROOT_6, 1.0];

/// Coefficients a_ij. The last row contains the weights b_j.
#[cfg(test)]
pub const A: [[f64; STAGES]; STAGES] = [
    [(88.0 - 7.0 * ROOT_6) / 360.0, (296.0 - 169.0 * ROOT_6) / 1800.0, (-2.0 + 3.0 * ROOT_6) / 225.0],
    [(296.0 + 169.0 * ROOT_6) / 1800.0, (88.0 + 7.0 * ROOT_6) / 360.0, (-2.0 - 3.0 * ROOT_6) / 225.0],
    [(16.0 - ROOT_6) / 36.0, (16.0 + ROOT_6) / 36.0, 1.0 / 9.0],
];

/// The eigenvalues of A^-1: `GAMMA` and `ALPHA` +- i `BETA`.
pub const GAMMA: f64 = 3.637_834_252_744_496;
pub const ALPHA: f64 = 2.681_082_873_627_752_3;
pub const BETA: f64 = 3.050_430_199_247_410_5;

/// T^-1 A^-1 T = [[GAMMA, 0, 0], [0, ALPHA, -BETA], [0, BETA, ALPHA]].
pub const T: [[f64; STAGES]; STAGES] = [
    [0.091_232_394_870_892_94, -0.141_255_295_020_954_2, -0.030_029_194_105_147_424],
    [0.241_717_932_707_107, 0.204_129_352_293_799_93, 0.382_942_112_757_261_9],
    [0.966_048_182_615_093, 1.0, 0.0],
];

/// Inverse of `T`.
pub const T_INVERSE: [[f64; STAGES]; STAGES] = [
    [4.325_579_890_063_155, 0.339_199_251_815_809_87, 0.541_770_539_935_874_9],
    [-4.178_718_591_551_905, -0.327_682_820_761_062_4, 0.476_623_554_500_550_45],
    [-0.502_872_634_945_786_9, 2.571_926_949_855_605, -0.596_039_204_828_224_9],
];

/// Error estimate: weights e_i of the increments z_i. With f at the start, the estimate is 0 for polynomials of degree
/// 3. IV.8, eq. (8.19), divided by gamma_0.
pub const E: [f64; STAGES] = [-(13.0 + 7.0 * ROOT_6) / 3.0, (-13.0 + 7.0 * ROOT_6) / 3.0, -1.0 / 3.0];
