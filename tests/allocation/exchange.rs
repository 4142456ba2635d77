//! Memory allocations in model exchange, in both FMI versions: derivatives, event indicators, trial states, completed
//! steps, events.
use super::assert_allocates_nothing_again;
use super::host::FOLDER;
use linkage_fmu::fmi2::host::Description;
use linkage_fmu::fmi2::types::Status as Status2;
use linkage_fmu::fmi3::host::Host;
use linkage_fmu::fmi3::types::Status;
use std::path::Path;

/// A run of Euler's method through the up stop. Returns the values that it read, and the number of events.
macro_rules! run {
    ($host:expr, $description:expr, $status:ident) => {{
        let (host, h) = (&$host, 2e-4);
        let force = $description.reference("actuator.force");
        let outputs = ["crank.angle", "joint2.force"].map(|name| $description.reference(name));
        let (mut y, mut f, mut nominals, mut values) = ([0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]);
        let mut z = vec![0.0; $description.indicator_count()];
        assert!(!z.is_empty());
        let mut events = 0;
        let mut start = linkage_fmu::fmi2::host::State::NONE;
        assert_eq!(host.update_discrete_states().0, $status::Ok);
        assert_eq!(host.enter_continuous_time_mode(), $status::Ok);
        assert_eq!(host.save_into(&mut start), $status::Ok);
        let step = |n: i32| {
            // Each round of ten long steps starts from the saved state and reaches the stop.
            if n % 10 == 0 {
                assert_eq!(host.restore(&start), $status::Ok);
            }
            for k in 0..100 {
                assert_eq!(host.set_time(f64::from(100 * (n % 10) + k) * h), $status::Ok);
                assert_eq!(host.set_reals(&[force], &[3e4 + f64::from(k)]), $status::Ok);
                assert_eq!(host.states(&mut y), $status::Ok);
                assert_eq!(host.rates(&mut f), $status::Ok);
                assert_eq!(host.nominals(&mut nominals), $status::Ok);
                assert_eq!(host.set_states(&[y[0] + h * f[0], y[1] + h * f[1]]), $status::Ok);
                assert_eq!(host.indicators(&mut z), $status::Ok);
                assert_eq!(host.reals(&outputs, &mut values), $status::Ok);
                let (status, enter) = host.complete_step();
                assert_eq!(status, $status::Ok);
                if enter || z.iter().any(|z| *z < 0.0) {
                    events += 1;
                    assert_eq!(host.enter_event_mode(), $status::Ok);
                    assert_eq!(host.update_discrete_states().0, $status::Ok);
                    assert_eq!(host.enter_continuous_time_mode(), $status::Ok);
                }
            }
        };
        assert_allocates_nothing_again(|| assert_eq!(host.restore(&start), $status::Ok), step, "model exchange");
        assert_eq!(host.free(&mut start), $status::Ok);
        assert!(events > 10, "{events}");
    }};
}

#[test]
fn model_exchange_of_fmi_2_allocates_nothing() {
    let description = Description::read(Path::new(FOLDER)).unwrap();
    let host = description.exchange(None, false).unwrap();
    assert_eq!(host.initialize(), Status2::Ok);
    run!(host, description, Status2);
}

#[test]
fn model_exchange_of_fmi_3_allocates_nothing() {
    let description = Description::read(Path::new(FOLDER)).unwrap();
    let host = Host::exchange(&description, false).unwrap();
    assert_eq!((host.enter(None, 0.0, None), host.exit()), (Status::Ok, Status::Ok));
    run!(host, description, Status);
}

/// A prescribed motion: each new time places the mechanism again.
#[test]
fn model_exchange_of_a_prescribed_motion_allocates_nothing() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/SmoothRetraction");
    let description = Description::read(Path::new(folder)).unwrap();
    let host = description.exchange(None, false).unwrap();
    assert_eq!(host.initialize(), Status2::Ok);
    let outputs = ["crank.angle", "joint2.force", "actuator.acting_force"].map(|name| description.reference(name));
    let (mut y, mut f, mut values) = ([0.0; 2], [0.0; 2], [0.0; 3]);
    assert_eq!((host.update(), host.enter_continuous_time_mode()), ((Status2::Ok, false, Some(1.0)), Status2::Ok));
    let step = |n: i32| {
        assert_eq!(host.set_time(f64::from(n) * 5e-3), Status2::Ok);
        assert_eq!((host.states(&mut y), host.rates(&mut f)), (Status2::Ok, Status2::Ok));
        assert_eq!((host.set_states(&f), host.reals(&outputs, &mut values)), (Status2::Ok, Status2::Ok));
        assert_eq!(host.complete_step(), (Status2::Ok, false));
        assert_eq!((host.enter_event_mode(), host.update().0), (Status2::Ok, Status2::Ok));
        assert_eq!(host.enter_continuous_time_mode(), Status2::Ok);
    };
    assert_allocates_nothing_again(|| (), step, "model exchange of a prescribed motion");
}
