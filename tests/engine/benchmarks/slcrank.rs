//! The slider-crank of SUNDIALS' example idaSlCrank_dns: spring, damper and force.
use super::check;
use crate::support::SL_CRANK;

/// Crank angle [rad] at times [s]; the references have 12 digits.
const CRANK: [(f64, f64); 6] = [
    (1.0, 1.315_420_570_882),
    (2.0, 0.579_038_812_049),
    (4.0, -1.206_431_647_703),
    (5.0, -1.429_996_967_647),
    (8.0, 0.644_225_539_481),
    (10.0, 1.275_675_848_650),
];
const SPEED: f64 = -0.239_914_997_196;
const SLIDER: f64 = 1.023_578_558_980;

#[test]
fn the_crank_follows_the_reference_in_one_step_and_in_many() {
    for steps_a_second in [1, 100, 1000] {
        let mut run = super::run(SL_CRANK, 1e-13);
        let mut done = 0.0;
        for (time, angle) in CRANK {
            let span: f64 = time - done;
            for _ in 0..(span * f64::from(steps_a_second)).round() as u32 {
                run.step(1.0 / f64::from(steps_a_second));
            }
            done = time;
            check(&mut run, "crank.angle", angle, 1e-11);
        }
        check(&mut run, "crank.speed", SPEED, 1e-11);
        check(&mut run, "slide.position", SLIDER, 1e-11);
        check(&mut run, "energy.drift", 0.0, 1e-11);
    }
}
