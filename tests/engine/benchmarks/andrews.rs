//! Andrews' squeezing mechanism: seven bodies, three loops (Hairer and Wanner, Solving ODEs II, VII.7).
use super::{check, close};
use crate::support::{ANDREWS, Run};

/// Time [s], beta [rad], its rate [rad/s].
const CRANK: [(f64, f64, f64); 4] = [
    (0.01, 2.160_113_131_531_526_5, 711.923_152_831_104),
    (0.02, 8.184_905_889_661_676, 726.558_342_609_127_7),
    (0.03, 15.810_771_195_153_797, 1_139.920_302_259_106),
    (0.05, 33.825_867_766_954_52, 1_144.535_502_653_847_5),
];
/// At 0.03 s: force at E on a body [N].
const REACTIONS: [(&str, f64, f64); 3] = [
    ("E3", 199.175_348_104_538, -29.755_309_974_971_8),
    ("E4", 23.066_543_611_622_2, 31.452_725_275_771_1),
    ("E6", 22.642_494_786_394_4, 11.617_392_352_611_3),
];
const TORQUE: f64 = 0.033;

fn squeezer() -> Run {
    super::run(ANDREWS, 1e-13)
}

#[test]
fn the_crank_follows_the_reference_in_one_step_and_in_many() {
    for steps_of in [0.01, 1e-4, 1e-5] {
        let mut run = squeezer();
        let mut done = 0.0;
        for (time, beta, speed) in CRANK {
            let count = ((time - done) / steps_of).round() as u32;
            for _ in 0..count {
                run.step((time - done) / f64::from(count));
            }
            done = time;
            check(&mut run, "K1.angle", beta, 1e-10 * beta);
            check(&mut run, "K1.speed", speed, 1e-9 * speed);
        }
    }
}

#[test]
fn it_starts_with_the_published_angles_and_acceleration() {
    let mut run = squeezer();
    let start = [
        ("K1.angle", -0.061_713_890_014_276_45),
        ("K2.angle", -0.061_713_890_014_276_45),
        ("K3.angle", 0.455_279_819_163_070_4),
        ("K4.angle", 0.487_364_979_543_842_55 + 0.222_668_390_165_885_88),
        ("K5.angle", 0.487_364_979_543_842_55),
        ("K6.angle", 1.230_547_444_549_821_2 - 0.222_668_390_165_885_88),
        ("K7.angle", 1.230_547_444_549_821_2),
    ];
    for (name, angle) in start {
        check(&mut run, name, angle, 1e-13);
    }
    check(&mut run, "K1.acceleration", 14_222.443_919_954_114, 1e-10 * 14_222.0);
}

#[test]
fn at_the_end_every_angle_and_the_reactions_are_right() {
    let mut run = squeezer();
    run.step(0.03);
    let beta = run.get("K1.angle");
    let (k4, k5, k6, k7) = (run.get("K4.angle"), run.get("K5.angle"), run.get("K6.angle"), run.get("K7.angle"));
    close("Theta", run.get("K2.angle") - beta, -15.756_371_058_411_84, 1e-10 * 15.8);
    check(&mut run, "K3.angle", 0.040_822_240_119_645_8, 1e-10);
    close("phi", k4 - k5, -0.534_730_116_342_079_6, 1e-10);
    close("delta", k5, 0.524_409_965_879_954, 1e-10);
    close("Omega", k6 - k7, 0.534_730_116_342_079_6, 1e-10);
    close("epsilon", k7, 1.048_080_741_041_938, 1e-10);
    check(&mut run, "K1.acceleration", -24_631.763_122_874_635, 1e-8 * 24_632.0);
    for (joint, x, y) in REACTIONS {
        let allowed = 1e-7 * x.hypot(y);
        check(&mut run, &format!("{joint}.force_x"), x, allowed);
        check(&mut run, &format!("{joint}.force_y"), y, allowed);
    }
}

#[test]
fn the_energy_invariant_is_fulfilled() {
    const INVARIANT: f64 = 1.437_832_957_531;
    let mut run = squeezer();
    for _ in 0..=500 {
        let stretch = run.get("spring.length") - 0.077_85;
        let invariant = run.get("energy.kinetic") + 0.5 * 4530.0 * stretch * stretch - TORQUE * run.get("K1.angle");
        assert!((invariant - INVARIANT).abs() < 1e-10, "{invariant:.15} {:e}", invariant - INVARIANT);
        run.step(1e-4);
    }
    assert!(run.get("energy.drift").abs() < 1e-10);
}
