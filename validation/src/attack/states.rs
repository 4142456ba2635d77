//! Corrupted states: some bytes of a state are changed, and its checksum is recomputed. The state is rejected, or the
//! instance continues from it: each output is finite or undefined for a reason, and each call ends.
use super::histories::{length, outputs, prepared, set, written};
use super::prepared::Prepared;
use super::probe::Probe;
use super::random::Random;
use crate::host::model;
use linkage_fmu::codec::checksum::xxh64;
use linkage_fmu::component::Stepped;
use linkage_fmu::fmi2::host::{Host, State, logger};
use linkage_fmu::fmi2::types::Status;

/// Steps before a state is serialised, and after a corrupted one is restored.
const STEPS: usize = 4;
/// Length of the header of a serialised state with format, length and mechanism, and of the checksum [bytes].
const HEAD: usize = 36;
const CHECK: usize = 8;

/// The case of this part: the state of a model, or of an instance through the C functions.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    if probe.seed % 4 == 3 {
        return instance(probe);
    }
    let prepared = prepared(probe);
    let result = of_model(probe, &prepared.1);
    probe.prepared = Some(prepared);
    result
}

/// Numbers that a valid state never or hardly ever contains.
fn odd(random: &mut Random) -> f64 {
    let any = f64::from_bits(random.word());
    let small = random.within(-2.0, 2.0);
    let numbers = [0.0, -0.0, 1.0, -1.0, 1e308, -1e308, 5e-324, 1e-300, 1e17, 1e6, f64::NAN, f64::INFINITY, any, small];
    random.pick(&numbers)
}

/// Change some bytes of a state's body.
fn corrupt(random: &mut Random, bytes: &mut [u8]) {
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        match random.below(5) {
            0 => bytes[at] = random.word() as u8,
            1 => bytes[at] ^= 1 << random.below(8),
            2 => bytes[at] = random.below(3) as u8,
            3 => {
                let value = bytes.get(at..at + 8).and_then(|b| b.try_into().ok()).map_or(1.0, f64::from_le_bytes);
                let scaled = (value * random.decades(1e-9, 1e9)).to_le_bytes();
                bytes.iter_mut().skip(at).zip(scaled).for_each(|(byte, new)| *byte = new);
            }
            _ => {
                let number = odd(random).to_le_bytes();
                bytes.iter_mut().skip(at).zip(number).for_each(|(byte, new)| *byte = new);
            }
        }
    }
}

fn of_model(probe: &mut Probe, prepared: &Prepared) -> Result<(), String> {
    let mut random = probe.random.clone();
    let mut model = prepared.start.clone();
    for _ in 0..random.below(STEPS) {
        let h = length(&mut random, prepared);
        set(&mut random, prepared, h, [&mut model], false);
        let _ = probe.timed("step", || model.step(h));
    }
    let mut bytes = written(&model)?;
    corrupt(&mut random, &mut bytes);
    let Ok(snapshot) = probe.timed("state read", || model.read_snapshot(&bytes)) else {
        probe.count("states refused");
        return Ok(());
    };
    if let Err(error) = probe.timed("restore", || model.restore(&snapshot)) {
        probe.count("states refused");
        return if error.to_string().is_empty() { Err("a refusal without words".into()) } else { Ok(()) };
    }
    probe.count("states taken");
    for n in 0..STEPS {
        probe.timed("outputs", || outputs(&mut model, prepared)).map_err(|e| format!("before step {n}: {e}"))?;
        let h = length(&mut random, prepared);
        set(&mut random, prepared, h, [&mut model], false);
        if probe.verbose {
            println!("step {n} of {h:e} s");
        }
        match probe.timed("step from a spoiled state", || model.step(h)) {
            Ok(Stepped::Whole) => probe.count("steps after"),
            Ok(_) | Err(_) => probe.count("steps after that ended with an error"),
        }
        let bytes = written(&model)?;
        model.read_snapshot(&bytes).map_err(|e| format!("the state that it wrote after step {n} is refused: {e}"))?;
    }
    outputs(&mut model, prepared).map(drop)
}

/// The FMUs whose states are corrupted.
const MODELS: [&str; 7] = [
    "LandingGearRetraction",
    "SliderCrank",
    "FourBar",
    "Jib",
    "CraneJib",
    "HydraulicActuator",
    "LandingGearRetractionHydraulic",
];

/// Read every output of an instance; the status must be OK, or a warning with a message.
fn read(host: &Host, outputs: &[u32]) -> Result<(), String> {
    let mut values = vec![0.0; outputs.len()];
    let status = host.reals(outputs, &mut values);
    let log = host.log.take();
    match status {
        Status::Ok if values.iter().all(|value| value.is_finite()) => Ok(()),
        Status::Warning if !log.is_empty() => Ok(()),
        // The restored phase may be one in which outputs cannot be read.
        Status::Error if log.iter().any(|message| message.text.contains("from initialization mode on")) => Ok(()),
        status => Err(format!("fmi2GetReal answers {status:?}: {values:?} {log:?}")),
    }
}

/// An error for any status but OK.
fn fine(call: &str, status: Status) -> Result<(), String> {
    if status == Status::Ok { Ok(()) } else { Err(format!("{call} answers {status:?}")) }
}

fn instance(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let description = &model(random.pick(&MODELS))?.description;
    let host = probe.timed("fmi2Instantiate", || description.instantiate(Some(logger()), false))?;
    fine("fmi2SetupExperiment", host.set_up(None, 0.0, None))?;
    fine("initialisation", host.initialize())?;
    let list = description.interface().list();
    let of = |kind| (0..).zip(list).filter(|(_, v)| v.kind == kind).map(|(r, _)| r).collect::<Vec<u32>>();
    let reals = of(linkage_fmu::variables::Kind::Real);
    let mut time = 0.0;
    for _ in 0..random.below(STEPS) {
        let h = random.decades(1e-5, 0.1);
        if host.step(time, h) != Status::Ok {
            break;
        }
        time += h;
    }
    host.log.take();
    let mut state = State::NONE;
    fine("fmi2GetFMUstate", host.save_into(&mut state))?;
    let mut bytes = host.serialize(&state).map_err(|s| format!("fmi2SerializeFMUstate: {s:?}"))?;
    host.free(&mut state);
    let end = bytes.len() - CHECK;
    corrupt(&mut random, &mut bytes[HEAD..end]);
    let sum = xxh64(&bytes[..end]).to_le_bytes();
    bytes[end..].copy_from_slice(&sum);
    let Ok(mut state) = probe.timed("fmi2DeSerializeFMUstate", || host.deserialize(&bytes)) else {
        probe.count("states refused");
        return if host.log.take().is_empty() { Err("a state is refused without a word".into()) } else { Ok(()) };
    };
    let status = probe.timed("fmi2SetFMUstate", || host.restore(&state));
    host.free(&mut state);
    host.log.take();
    if status != Status::Ok {
        probe.count("states refused");
        return Ok(());
    }
    probe.count("states taken");
    for _ in 0..STEPS {
        read(&host, &reals)?;
        let h = random.decades(1e-5, 0.1);
        let status = probe.timed("fmi2DoStep from a spoiled state", || host.step(time, h));
        let log = host.log.take();
        if matches!(status, Status::Ok | Status::Warning) {
            time += h;
            probe.count("steps after");
        } else if log.is_empty() {
            return Err(format!("fmi2DoStep answers {status:?} without a word"));
        } else {
            // Usually the time differs from that of the corrupted clock.
            probe.count("steps after that ended with an error");
            break;
        }
    }
    Ok(())
}
