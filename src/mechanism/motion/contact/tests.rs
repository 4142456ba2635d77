//! The transitions of contact: the tables at the head of `contact.rs`, one by one.
#![allow(clippy::unwrap_used)]
use super::*;
use crate::codec::writer::Writer;

/// A bumper before a rigid stop on the high side, a rigid stop on the low side.
fn travel() -> Travel {
    let rigid = |position: f64, stop: usize| Some(RigidEnd { position, stop, ..RigidEnd::default() });
    let bumpers = vec![BumperPlaces { stop: 2, positions: [None, Some(0.5)], ..BumperPlaces::default() }];
    Travel { rigid: [rigid(0.0, 0), rigid(1.0, 1)], bumpers, beside: vec![(1, 3)], ..Travel::default() }
}

const NONE: EngagedLocks = EngagedLocks {
    rigid: [false; 2],
    bumpers: BumperSet::EMPTY,
    waiting_rigid: [false; 2],
    waiting_bumpers: BumperSet::EMPTY,
};

fn ends(travel: &Travel, locked: EngagedLocks) -> Ends<'_> {
    Ends::new(travel, 0.0, locked)
}

/// Rest of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Is {
    Free,
    Resting(Place),
    Latched(Place),
}

fn rest(contact: &Contact) -> Is {
    match contact.at_rest() {
        None => Is::Free,
        Some(place) if contact.is_latched() => Is::Latched(place),
        Some(place) => Is::Resting(place),
    }
}

/// The first table. At every place, with every lock engaged or not.
#[test]
fn rest_changes_as_the_table_has_it() {
    let travel = travel();
    let places = [Place::rigid(0), Place::rigid(1), Place::of_bumper(1, 0)];
    for (n, &place) in places.iter().enumerate() {
        let only = |k: usize| EngagedLocks { rigid: [k == 0, k == 1], bumpers: BumperSet::of(1, |_| k == 2), ..NONE };
        let start = Contact::at_start(Some(place));
        assert_eq!((rest(&Contact::at_start(None)), rest(&start)), (Is::Free, Is::Resting(place)));
        for touching in [false, true] {
            let mut free = Contact::default();
            if touching {
                free.touched(0);
            }
            let then = |mut contact: Contact, change: &dyn Fn(&mut Contact)| {
                change(&mut contact);
                assert_eq!(contact.touching().contains(0), touching, "rest leaves the bumpers as they are");
                contact
            };
            let (resting, latched) = (then(free, &|c| c.rests(place, false)), then(free, &|c| c.rests(place, true)));
            assert_eq!((rest(&resting), rest(&latched)), (Is::Resting(place), Is::Latched(place)));
            for k in 0..3 {
                let set = |contact| then(contact, &|c: &mut Contact| c.locks_set(&ends(&travel, only(k))));
                let expected = if k == n { Is::Latched(place) } else { Is::Resting(place) };
                assert_eq!(
                    (rest(&set(free)), rest(&set(resting)), rest(&set(latched))),
                    (Is::Free, expected, expected)
                );
            }
            let released = then(resting, &Contact::released);
            assert_eq!(released, free);
            // Of two stops at one place the other holds.
            for (&other, locked) in places.iter().flat_map(|other| [(other, false), (other, true)]) {
                let held = then(released, &|c| c.rests(other, locked));
                assert_eq!(rest(&held), if locked { Is::Latched(other) } else { Is::Resting(other) });
            }
        }
    }
}

/// The second table. Each bumper for itself, at rest or not.
#[test]
fn bumpers_change_as_the_table_has_it() {
    for start in [Contact::default(), Contact::at_start(Some(Place::rigid(1)))] {
        let mut contact = start;
        contact.touched(3);
        contact.touched(7);
        assert_eq!(contact.touching(), BumperSet::default().with(3).with(7));
        contact.let_go(3);
        assert_eq!(contact.touching(), BumperSet::default().with(7));
        contact.set_touching(BumperSet::default().with(1));
        assert_eq!(contact.touching(), BumperSet::default().with(1));
        assert_eq!(rest(&contact), rest(&start));
        contact.let_go(1);
        assert_eq!(contact, start);
    }
}

#[test]
fn a_lock_carries_what_the_stop_cannot() {
    let travel = travel();
    let (free, locked) = (ends(&travel, NONE), ends(&travel, EngagedLocks { rigid: [true, false], ..NONE }));
    let (place, contact) = (Place::rigid(0), Contact::at_start(Some(Place::rigid(0))));
    assert_eq!(contact.holder(&free, -1.0), Some((place, Holder::Stop)));
    assert_eq!(contact.holder(&free, 1.0), None);
    assert_eq!(contact.holder(&locked, -1.0), Some((place, Holder::Stop)));
    assert_eq!(contact.holder(&locked, 1.0), Some((place, Holder::Lock)));
    assert_eq!(Contact::default().holder(&free, -1.0), None);
    // A bumper at its place holds nothing without a lock.
    let (place, engaged) = (Place::of_bumper(1, 0), EngagedLocks { bumpers: BumperSet::default().with(0), ..NONE });
    let contact = Contact::at_start(Some(place));
    assert_eq!(contact.holder(&free, 1.0), None);
    assert_eq!(contact.holder(&ends(&travel, engaged), 1.0), Some((place, Holder::Lock)));
}

#[test]
fn of_stops_at_one_place_each_holds() {
    let mut travel = travel();
    travel.rigid[1] = travel.rigid[0];
    let [low, high] = [0, 1].map(Place::rigid);
    let open = ends(&travel, NONE);
    for place in [low, high] {
        let contact = Contact::at_start(Some(place));
        assert_eq!(contact.holder(&open, -1.0), Some((low, Holder::Stop)));
        assert_eq!(contact.holder(&open, 1.0), Some((high, Holder::Stop)));
        assert_eq!(contact.holder(&open, 0.0), Some((place, Holder::Stop)));
    }
    // A lock at the place of a bumper on the other side.
    travel.rigid[1] = None;
    travel.bumpers[0].positions[1] = Some(0.0);
    let engaged = EngagedLocks { bumpers: BumperSet::default().with(0), ..NONE };
    let contact = Contact::at_start(Some(low));
    assert_eq!(contact.holder(&ends(&travel, engaged), 1.0), Some((Place::of_bumper(1, 0), Holder::Lock)));
    assert_eq!(contact.holder(&ends(&travel, engaged), -1.0), Some((low, Holder::Stop)));
    assert_eq!(contact.holder(&ends(&travel, NONE), 1.0), None);
}

#[test]
fn places_are_told_with_their_locks() {
    let travel = travel();
    let all: Vec<_> = travel.places().collect();
    assert_eq!(all, [(Place::rigid(0), 0.0), (Place::rigid(1), 1.0), (Place::of_bumper(1, 0), 0.5)]);
    assert!(travel.holds(Place::rigid(1), 1) && travel.holds(Place::rigid(1), 3));
    assert!(!travel.holds(Place::rigid(0), 3) && travel.holds(Place::of_bumper(1, 0), 2));
    let shifted = Ends::new(&travel, 0.5, NONE);
    assert_eq!(shifted.at(0.0).collect::<Vec<_>>(), [Place::of_bumper(1, 0)]);
}

#[test]
fn each_state_is_read_as_it_was_written() {
    for place in [Place::rigid(1), Place::of_bumper(0, 7)] {
        let mut contact = Contact::default();
        contact.touched(9);
        contact.rests(place, true);
        let mut writer = Writer::default();
        contact.record(&mut Record::Write(&mut writer)).unwrap();
        let mut read = Contact::default();
        read.record(&mut Record::Read(&writer.finish())).unwrap();
        assert_eq!(read, contact);
    }
}
