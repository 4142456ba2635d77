//! Memory allocations in FMI 3.0: steps, vectors, derivatives, event mode, intermediate updates.
use super::assert_allocates_nothing_again;
use super::host::FOLDER;
use linkage_fmu::fmi2::host::{Description, State};
use linkage_fmu::fmi3::host::{Host, Update, Wishes};
use linkage_fmu::fmi3::types::Status;
use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

/// References of the gear's variables. The references of vectors follow the reference of the time.
struct Gear {
    description: Arc<Description>,
}

impl Gear {
    fn new() -> Self {
        Self { description: Description::read(Path::new(FOLDER)).unwrap() }
    }

    fn scalars<const N: usize>(&self, names: [&str; N]) -> [u32; N] {
        names.map(|name| self.description.interface().find(name).unwrap())
    }

    fn vectors<const N: usize>(&self, names: [&str; N]) -> [u32; N] {
        let (all, first) = (self.description.vectors(), self.description.interface().list().len() as u32 + 1);
        names.map(|name| first + all.iter().position(|vector| vector.name == name).unwrap() as u32)
    }

    fn initialized(&self, wishes: Wishes) -> Host {
        let event_mode = wishes.event_mode;
        let host = Host::new(&self.description, wishes).unwrap();
        assert_eq!(host.enter(None, 0.0, None), Status::Ok);
        assert_eq!(host.exit(), Status::Ok);
        if event_mode {
            assert_eq!(host.enter_step_mode(), Status::Ok);
        }
        host
    }
}

#[test]
fn a_step_with_vectors_and_derivatives_allocates_nothing() {
    let gear = Gear::new();
    let host = gear.initialized(Wishes::default());
    let inputs = gear.scalars(["actuator.force", "load_factor"]);
    let vectors = gear.vectors(["joint2.reaction", "wheel.position", "wheel.acceleration"]);
    let time = gear.description.interface().list().len() as u32;
    let outputs = [&vectors[..], &[time], &gear.scalars(["crank.angle", "crank.acceleration"])].concat();
    let (unknowns, rates) = ([vectors[0], vectors[2]], gear.vectors(["wheel.position", "wheel.velocity"]));
    let (mut values, mut forward, mut back) = ([0.0; 9], [0.0; 4], [0.0; 2]);
    let exchange = |n: i32| {
        let h = 1e-4;
        assert_eq!(host.set_reals(&inputs, &[3e4 + f64::from(n), 3.0]), Status::Ok);
        let (status, stepped) = host.step(f64::from(n) * h, h);
        assert_eq!((status, stepped.early), (Status::Ok, false));
        assert_eq!(host.reals(&outputs, &mut values), Status::Ok);
        assert_eq!(host.derivative(false, &unknowns, &inputs, &[1.0, 0.1], &mut forward), Status::Ok);
        assert_eq!(host.derivative(true, &unknowns, &inputs, &[1.0, 0.1, 2.0, 0.2], &mut back), Status::Ok);
        assert_eq!(host.output_derivatives(&rates, &[1, 1], &mut forward), Status::Ok);
    };
    let mut start = State::NONE;
    assert_eq!(host.save_into(&mut start), Status::Ok);
    assert_allocates_nothing_again(|| assert_eq!(host.restore(&start), Status::Ok), exchange, "FMI 3.0");
    assert_eq!(host.free(&mut start), Status::Ok);
}

/// From a state shortly before the up stop: a step ends at the stop, event mode applies the impact, and the step is
/// completed.
#[test]
fn an_event_allocates_nothing() {
    const BEFORE: f64 = 0.13;
    let gear = Gear::new();
    let host = gear.initialized(Wishes { event_mode: true, early_return: true, ..Wishes::default() });
    let [speed, impacts] = gear.scalars(["crank.speed", "upstop.impact_count"]);
    let (status, stepped) = host.step(0.0, BEFORE);
    assert_eq!((status, stepped.event), (Status::Ok, false));
    let mut state = State::NONE;
    assert_eq!(host.save_into(&mut state), Status::Ok);
    let mut values = [0.0; 2];
    let exchange = |_| {
        assert_eq!(host.restore(&state), Status::Ok);
        let (status, stepped) = host.step(BEFORE, 0.01);
        assert_eq!((status, stepped.event, stepped.early), (Status::Ok, true, true));
        assert_eq!(host.reals(&[speed, impacts], &mut values), Status::Ok);
        assert!(values[0] < 0.0 && values[1] == 0.0, "{values:?}");
        assert_eq!(host.enter_event_mode(), Status::Ok);
        assert_eq!(host.update_discrete_states(), (Status::Ok, true));
        assert_eq!(host.reals(&[speed, impacts], &mut values), Status::Ok);
        assert_eq!(values[1], 1.0);
        assert_eq!(host.enter_step_mode(), Status::Ok);
        let (status, _) = host.step(stepped.last, 1e-4);
        assert_eq!(status, Status::Ok);
    };
    assert_allocates_nothing_again(|| {}, exchange, "event mode");
    assert_eq!(host.free(&mut state), Status::Ok);
}

#[test]
fn an_intermediate_update_allocates_nothing() {
    let gear = Gear::new();
    let updates = Rc::new(Cell::new(0));
    let (count, [position], [force]) =
        (Rc::clone(&updates), gear.vectors(["wheel.position"]), gear.scalars(["joint1.force"]));
    let update: Box<Update> = Box::new(move |calls, _| {
        let mut values = [0.0; 3];
        assert_eq!(calls.reals(&[position, force], &mut values), Status::Ok);
        count.set(count.get() + 1);
        None
    });
    let host = gear.initialized(Wishes { update: Some(update), ..Wishes::default() });
    let mut state = State::NONE;
    assert_eq!(host.save_into(&mut state), Status::Ok);
    let exchange = |_| {
        assert_eq!(host.restore(&state), Status::Ok);
        let (status, stepped) = host.step(0.0, 0.12);
        assert_eq!((status, stepped.last), (Status::Ok, 0.12));
    };
    assert_allocates_nothing_again(|| {}, exchange, "intermediate updates");
    assert!(updates.get() >= 400, "{}", updates.get());
    assert_eq!(host.free(&mut state), Status::Ok);
}
