//! Radau steps that share a Jacobian.
use super::*;
use crate::codec::record::Record;
use crate::codec::writer::Writer;

/// y' = -L (y^3 - cos^3 t) - sin t with the solution cos t. Stiff where y is not near 0.
struct Stiff;

impl System<1> for Stiff {
    const CAN_BE_STIFF: bool = true;

    fn derivative(&mut self, t: f64, y: &[f64; 1]) -> [f64; 1] {
        [-1e5 * (y[0].powi(3) - t.cos().powi(3)) - t.sin()]
    }

    fn scale(&mut self, _y: &[f64; 1], _f: &[f64; 1]) -> [f64; 1] {
        [1.0]
    }
}

/// From instant `from` to instant `to` in spans of 10 ms, whose sizes differ by rounding errors of times.
fn advance(integrator: &mut Integrator<1>, y: &mut [f64; 1], from: u32, to: u32) {
    let mut t = f64::from(from) * 0.01;
    for k in from + 1..=to {
        let end = f64::from(k) * 0.01;
        while t < end {
            let step = integrator.step(&mut Stiff, t, y, end, 1e-6).unwrap();
            (*y, t) = (step.end, if step.reached { end } else { t + step.h });
        }
    }
}

/// Error and number of Jacobians from 0 to 1 s.
fn run(mut integrator: Integrator<1>) -> (f64, u64) {
    let mut y = [1.0];
    advance(&mut integrator, &mut y, 0, 100);
    ((y[0] - 1_f64.cos()).abs(), integrator.statistics().jacobians)
}

#[test]
fn a_kept_jacobian_is_used_for_many_steps_with_the_same_accuracy() {
    let ((error, each), (error_kept, kept)) = (run(Integrator::default()), run(Integrator::keeping()));
    println!("{error:e} with {each}, {error_kept:e} with {kept}");
    assert!(error < 1e-6 && error_kept < 1e-6, "{error:e} {error_kept:e}");
    assert!(each > 90 && kept * 3 < each, "{each} {kept}");
}

/// A copied memory, or one that was written and read, continues identically with the same Jacobian and factors.
#[test]
fn a_memory_that_is_read_continues_identically() {
    let (mut integrator, mut y) = (Integrator::keeping(), [1.0]);
    advance(&mut integrator, &mut y, 0, 53);
    let (mut writer, start, jacobians) = (Writer::default(), y, integrator.statistics().jacobians);
    integrator.record(&mut Record::Write(&mut writer)).unwrap();
    let bytes = writer.finish();
    let (mut read, mut copy) = (Integrator::keeping(), Integrator::keeping());
    read.record(&mut Record::Read(&bytes)).unwrap();
    copy.copy_from(&integrator);
    advance(&mut integrator, &mut y, 53, 63);
    assert!(integrator.statistics().jacobians <= jacobians + 5);
    for mut other in [read, copy] {
        let mut z = start;
        advance(&mut other, &mut z, 53, 63);
        assert_eq!((&other, z), (&integrator, y));
    }
    assert!((0..bytes.len()).all(|end| Integrator::<1>::keeping().record(&mut Record::Read(&bytes[..end])).is_err()));
}
