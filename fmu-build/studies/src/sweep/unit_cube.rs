//! Samples in the unit cube: independent ones, a Latin hypercube, Sobol's sequence.
//!
//! In: a method, the number of samples and of dimensions, a seed. Out: any coordinate of any sample, in any order of
//! calls. The module must not know what a coordinate represents.

use super::definition::{Method, Sampling};
use super::joe_kuo::{DIMENSIONS, directions};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Number of bits of a coordinate.
const BITS: u32 = 53;
/// Number of rounds of the permutation of a Latin hypercube.
const ROUNDS: u64 = 6;

/// Largest number of factors of a method. In Saltelli's design each factor has two dimensions.
pub fn most_dimensions(method: Method) -> usize {
    match method {
        Method::Random | Method::LatinHypercube => usize::MAX,
        Method::Sobol => DIMENSIONS,
        Method::Saltelli => DIMENSIONS / 2,
    }
}

/// Number of samples per `count` for this number of factors: one, except for Saltelli's design.
pub fn each(method: Method, factors: usize) -> u64 {
    if method == Method::Saltelli { factors as u64 + 2 } else { 1 }
}

/// Samples in the unit cube.
#[derive(Clone, Debug)]
pub struct UnitCube {
    sampling: Sampling,
    /// For each dimension, its stream of random bits, and the sample whose bits are next in the stream.
    random: Vec<(ChaCha8Rng, u64)>,
    /// For each dimension, direction numbers of Sobol's sequence, and its shift.
    sobol: Vec<(Vec<u64>, u64)>,
}

impl UnitCube {
    /// Samples with at most [`most_dimensions`] coordinates.
    pub fn new(sampling: Sampling, dimensions: usize) -> Self {
        let dimensions = if sampling.method == Method::Saltelli { 2 * dimensions } else { dimensions };
        let stream = |dimension| {
            let mut random = ChaCha8Rng::seed_from_u64(sampling.seed);
            random.set_stream(dimension as u64);
            (random, 0)
        };
        let mut cube = Self { sampling, random: (0..dimensions).map(stream).collect(), sobol: Vec::new() };
        if matches!(sampling.method, Method::Sobol | Method::Saltelli) {
            let directions = directions(dimensions, BITS as usize);
            cube.sobol = directions.into_iter().zip(0..).map(|(d, of)| (d, cube.draw(0, of))).collect();
        }
        cube
    }

    /// Coordinate of a sample, in (0, 1).
    pub fn coordinate(&mut self, sample: u64, dimension: usize) -> f64 {
        match self.sampling.method {
            Method::Random => open(self.draw(sample, dimension)),
            Method::LatinHypercube => {
                let part = self.permuted(sample, dimension);
                let within = open(self.draw(sample, dimension));
                ((part as f64 + within) / self.sampling.count as f64).clamp(f64::EPSILON, 1.0 - f64::EPSILON)
            }
            Method::Sobol => self.sobol(sample, dimension),
            Method::Saltelli => {
                let factors = self.sobol.len() / 2;
                let each = factors as u64 + 2;
                let (base, member) = (sample / each, (sample % each) as usize);
                let is_second = member == factors + 1 || member == dimension + 1;
                self.sobol(base, if is_second { dimension + factors } else { dimension })
            }
        }
    }

    /// Coordinate of a point of Sobol's sequence, by the Gray code of its number.
    fn sobol(&self, point: u64, dimension: usize) -> f64 {
        let (directions, shift) = &self.sobol[dimension];
        let mut gray = point ^ (point >> 1);
        let mut bits = *shift;
        while gray != 0 {
            bits ^= directions[gray.trailing_zeros() as usize];
            gray &= gray - 1;
        }
        open(bits)
    }

    /// 64 random bits for a sample and a dimension: a position in the stream of the dimension.
    fn draw(&mut self, sample: u64, dimension: usize) -> u64 {
        let (random, next) = &mut self.random[dimension];
        // Setting the position computes a new block of the stream, also for an unchanged position.
        if *next != sample {
            random.set_word_pos(2 * u128::from(sample));
        }
        *next = sample + 1;
        random.next_u64()
    }

    /// The part of a factor's range that contains a sample of the Latin hypercube: a permutation of the samples. A
    /// Feistel network permutes the numbers with an even number of bits. It is repeated until the result is a sample.
    fn permuted(&self, sample: u64, dimension: usize) -> u64 {
        let count = self.sampling.count;
        let half = (64 - (count - 1).leading_zeros()).div_ceil(2).max(1);
        let mask = (1_u64 << half) - 1;
        let mut at = sample;
        loop {
            let (mut left, mut right) = (at >> half, at & mask);
            for round in 0..ROUNDS {
                let key = mixed(self.sampling.seed ^ mixed((dimension as u64) << 8 | round));
                (left, right) = (right, left ^ (mixed(right ^ key) & mask));
            }
            at = left << half | right;
            if at < count {
                return at;
            }
        }
    }
}

/// The middle of the interval of numbers that start with these 53 bits. It is never 0 or 1.
fn open(bits: u64) -> f64 {
    let middle = ((bits >> (64 - BITS)) as f64 + 0.5) * (0.5_f64).powi(BITS as i32);
    // The middle of the last interval would be rounded to 1.
    middle.min(1.0 - f64::EPSILON / 2.0)
}

/// SplitMix64, a bijection of the 64-bit numbers: Steele, Lea and Flood (2014).
fn mixed(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(method: Method, count: u64, seed: u64) -> UnitCube {
        UnitCube::new(Sampling { method, count, seed }, 3)
    }

    #[test]
    fn a_latin_hypercube_has_one_sample_in_each_part() {
        for count in [1, 2, 3, 16, 17, 1000] {
            let mut cube = cube(Method::LatinHypercube, count, 5);
            for dimension in 0..3 {
                let mut seen = vec![false; count as usize];
                for sample in 0..count {
                    let part = (cube.coordinate(sample, dimension) * count as f64) as usize;
                    assert!(!std::mem::replace(&mut seen[part], true), "{count} {dimension} {sample}");
                }
                assert!(seen.iter().all(|seen| *seen));
            }
        }
    }

    #[test]
    fn sobols_sequence_fills_every_elementary_interval_once() {
        // A (0, 6, 2)-net in base 2: the first two dimensions, and each division of the square into 64 congruent boxes.
        let mut cube = cube(Method::Sobol, 64, 7);
        for bits in 0..=6 {
            let (across, up) = (1_u64 << bits, 1_u64 << (6 - bits));
            let mut seen = [false; 64];
            for sample in 0..64 {
                let x = (cube.coordinate(sample, 0) * across as f64) as u64;
                let y = (cube.coordinate(sample, 1) * up as f64) as u64;
                assert!(!std::mem::replace(&mut seen[(x * up + y) as usize], true), "{bits}: {sample}");
            }
        }
    }

    #[test]
    fn a_coordinate_does_not_depend_on_those_before() {
        for method in [Method::Random, Method::LatinHypercube, Method::Sobol] {
            let mut forward = cube(method, 50, 1);
            let all: Vec<f64> =
                (0..50).flat_map(|s| [0, 1, 2].map(|d| (s, d))).map(|(s, d)| forward.coordinate(s, d)).collect();
            let (mut backward, mut other) = (cube(method, 50, 1), cube(method, 50, 2));
            let mut differ = 0;
            for sample in (0..50).rev() {
                for dimension in 0..3 {
                    let known = all[sample as usize * 3 + dimension];
                    assert_eq!(backward.coordinate(sample, dimension).to_bits(), known.to_bits());
                    assert!(known > 0.0 && known < 1.0);
                    differ += u32::from(other.coordinate(sample, dimension) != known);
                }
            }
            assert!(differ > 100, "{method:?}: another seed gives other samples");
        }
    }

    #[test]
    fn random_samples_are_uniform() {
        let mut cube = cube(Method::Random, 100_000, 3);
        let mean = (0..100_000).map(|sample| cube.coordinate(sample, 2)).sum::<f64>() / 1e5;
        // Standard deviation of the mean: 0.00091.
        assert!((mean - 0.5).abs() < 4e-3, "{mean}");
        assert_eq!([open(0), open(u64::MAX)].map(|x| x > 0.0 && x < 1.0), [true; 2]);
    }

    /// The order for SALib's analysis: the first point; for each factor the first point with the factor's value of the
    /// second point; the second point.
    #[test]
    fn saltellis_design_changes_one_factor_at_a_time() {
        let mut cube = UnitCube::new(Sampling { method: Method::Saltelli, count: 4, seed: 3 }, 3);
        let mut plain = UnitCube::new(Sampling { method: Method::Sobol, count: 4, seed: 3 }, 6);
        for base in 0..4 {
            let [first, second] = [0, 3].map(|of| [0, 1, 2].map(|dimension| plain.coordinate(base, of + dimension)));
            let mut row = |member: u64| [0, 1, 2].map(|dimension| cube.coordinate(5 * base + member, dimension));
            assert_eq!((row(0), row(4)), (first, second));
            for factor in 0..3 {
                let mut expected = first;
                expected[factor] = second[factor];
                assert_eq!(row(factor as u64 + 1), expected);
            }
        }
    }
}
