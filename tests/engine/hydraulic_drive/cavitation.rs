//! Oil near absolute zero pressure at loose tolerances: with air in the oil pressures stay above 0, without air the run
//! ends with a message.
use super::*;

/// Random numbers from 0 to 1 (xorshift64*).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// A number between two positive numbers, uniform in its logarithm.
    fn ratio(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }
}

/// A gear with a random circuit that tends to cavitate: little suction, loads that pull.
fn random_gear(random: &mut Random) -> Run {
    let mut gear = Run::shared(HYDRAULIC_GEAR);
    let values = [
        ("command.ramp_amplitude", 0.0),
        ("solver.tolerance", random.ratio(1e-6, 0.02)),
        ("anticavitation.conductance", if random.next() < 0.7 { 0.0 } else { random.ratio(1e-13, 1e-9) }),
        ("fluid.air_fraction", random.ratio(1e-5, 0.05)),
        ("fluid.polytropic_exponent", random.between(1.0, 1.4)),
        ("leakage.internal", if random.next() < 0.5 { 0.0 } else { random.ratio(1e-14, 1e-11) }),
        ("chamber_a.dead_volume", random.ratio(1e-6, 1e-3)),
        ("chamber_b.dead_volume", random.ratio(1e-6, 1e-3)),
        ("chamber_a.start_pressure", random.ratio(1e4, 2e7)),
        ("chamber_b.start_pressure", random.ratio(1e4, 2e7)),
        ("valve.rated_flow", random.ratio(1e-6, 1e-3)),
        ("load_factor", random.between(-6.0, 9.0)),
        ("tank.pressure", random.between(-1e5, 1e6)),
        ("supply.pressure", random.ratio(1e5, 3e7)),
        ("upstop.restitution", random.between(0.0, 0.9)),
    ];
    values.iter().for_each(|(name, value)| gear.set(name, *value));
    gear.set("downstop.enabled", random.next() < 0.5);
    gear.set("upstop.enabled", true);
    gear.started()
}

/// At tolerances from 1e-6 to 0.02 every step ends with absolute pressures above 0, also if the piston reaches an end
/// of the cylinder.
#[test]
fn air_holds_pressures_above_absolute_zero_at_any_tolerance() {
    let (mut random, mut steps, mut lowest) = (Random(7), 0, f64::INFINITY);
    let (runs, mut at_end) = (cases().unwrap_or(150), 0);
    for run in 0..runs {
        let mut gear = random_gear(&mut random);
        let h = random.ratio(1e-3, 0.2);
        for _ in 0..(1.5 / h) as u32 + 1 {
            if random.next() < 0.1 {
                gear.set("valve.command", random.between(-1.0, 1.0));
            }
            gear.0.model_mut().step(h).unwrap_or_else(|error| panic!("run {run}: {error}"));
            steps += 1;
            at_end += u32::from(gear.get("cylinder.end_force") != 0.0);
            for name in ["chamber_a.pressure", "chamber_b.pressure"] {
                let absolute = gear.get(name) + 101_325.0;
                assert!(absolute > 0.0, "run {run}: {name} = {absolute} Pa absolute");
                lowest = lowest.min(absolute);
            }
            assert!(gear.get("crank.angle").is_finite());
        }
    }
    println!("{runs} runs, {steps} steps, lowest {lowest} Pa absolute, {at_end} steps at an end of the cylinder");
    assert!(at_end > 0);
    assert!(lowest < 5e3, "no run came near absolute zero: {lowest}");
}

/// A command beyond its range is clipped with one warning. After a rollback the repeated step gives the same warning.
#[test]
fn a_clipped_command_gives_one_warning() {
    let mut gear = retraction(1e-6);
    gear.step(0.01);
    assert_eq!(gear.take_warning(), None);
    gear.set("valve.command", 1.5);
    let before = gear.snapshot();
    gear.step(0.01);
    assert_says(gear.take_warning().unwrap(), &["valve.command", "1.6", "clipped", "-1 to 1"]);
    let after = gear.snapshot();
    for (state, expected) in [(&before, true), (&after, false), (&before, true)] {
        let mut bytes = Vec::new();
        state.clone().write(&mut bytes).unwrap();
        for state in [state, &gear.read_snapshot(&bytes).unwrap()] {
            gear.restore(state).unwrap();
            gear.step(0.01);
            assert_eq!(gear.take_warning().is_some(), expected);
        }
    }
    gear.initialize();
    gear.step(0.01);
    assert!(gear.take_warning().is_some());
}
