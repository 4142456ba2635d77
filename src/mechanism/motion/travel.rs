//! The travel: how far the mechanism can move from its start, and the stops that it meets on its way.
//!
//! In: the reduced model, its stops, the start. Out: the places on the curve where stops are first met, up to the first
//! rigid stop on each side. It must not know time.
use crate::mechanism::definition::DefinitionError;
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::error::ModelError;
use crate::mechanism::loads::laws::stop::Stop;
use crate::mechanism::motion::contact::{BumperPlaces, Place, RigidEnd, Travel, outward};
use crate::mechanism::reduced::Reduced;
use crate::numerics::bracket::bisect;
use crate::numerics::table::{Table, polynomial};

/// A position this close beyond a stop [rad or m, relative to 1 and the value] is at the stop.
pub const AT_STOP: f64 = 1e-10;
/// Distance along the curve within which two stops are at one place, relative to the scale and the value of sigma. The
/// tables from which positions come are accurate to 1e-13.
const ONE_PLACE: f64 = 1e-12;

/// Where an enabled stop is first passed on each side of the start.
struct Passages {
    /// Index of the stop.
    stop: usize,
    /// sigma, counted on over whole revolutions.
    positions: [Option<f64>; 2],
}

/// The places of all stops for a start at `sigma` after `revolutions` whole revolutions.
///
/// # Errors
/// The start is beyond a rigid stop; a stop's quantity is not smooth; there are more bumpers than may be enabled.
pub fn travel(reduced: &Reduced, sigma: f64, revolutions: f64) -> Result<Travel, ModelError> {
    let stops = &reduced.loading().stops;
    let bumpers = stops.iter().filter(|stop| stop.enabled && !stop.rigid).count();
    if bumpers > BumperSet::CAPACITY {
        return Err(ModelError::TooManyBumpers { count: bumpers, limit: BumperSet::CAPACITY });
    }
    let here = sigma + revolutions * reduced.period().unwrap_or(0.0);
    let met = passages(reduced, sigma, revolutions)?;
    let one_place = ONE_PLACE * (reduced.scale() + here.abs());
    let mut travel = Travel { ends_meet: reduced.ends_meet(), ..Travel::default() };
    for passages in met.iter().filter(|passages| !stops[passages.stop].rigid) {
        travel.bumpers.push(BumperPlaces { stop: passages.stop, ..BumperPlaces::default() });
    }
    for side in 0..2 {
        let all = || met.iter().filter_map(|m| Some((m.stop, m.positions[side]?)));
        let distance = |position: f64| (position - here).abs();
        // A bumper that is compressed at the start begins behind it.
        let ahead = |position: f64| (position - here) * outward(side);
        let rigid = || all().filter(|(stop, _)| stops[*stop].rigid);
        // Of rigid stops at one place the first of the definition acts.
        let nearest = rigid().map(|(_, position)| distance(position)).fold(f64::INFINITY, f64::min);
        let acting = rigid().find(|(_, position)| distance(*position) <= nearest + one_place);
        let end = acting.map_or(f64::INFINITY, |(_, position)| distance(position));
        travel.rigid[side] = acting.map(|(stop, position)| RigidEnd {
            position,
            stop,
            restitution: stops[stop].restitution,
            slope: 0.0,
        });
        let beside = all().filter(|(stop, position)| {
            (ahead(*position) - end).abs() <= one_place && acting.is_some_and(|(acting, _)| acting != *stop)
        });
        travel.beside.extend(beside.map(|(stop, _)| (side, stop)));
        place_bumpers(&mut travel.bumpers, side, all(), |position| ahead(position) < end - one_place, one_place);
    }
    add_slopes(&mut travel, reduced);
    set_forces_of_locks(&mut travel, reduced)?;
    Ok(travel)
}

/// State the forces at which locks release and engage.
///
/// # Errors
/// The stop of a lock with a release force is a bumper, or another lock is at the place of a lock with one of these
/// forces.
pub fn set_forces_of_locks(travel: &mut Travel, reduced: &Reduced) -> Result<(), ModelError> {
    travel.grips = grips(travel, reduced)?;
    travel.engages = [None; 2];
    travel.bumpers.iter_mut().for_each(|bumper| bumper.engages = None);
    let locks = &reduced.loading().locks;
    for lock in locks.iter().filter(|lock| lock.engage.is_some()) {
        let is_shared = |place: &Place| travel.holds(*place, lock.stop);
        let shared: Vec<Place> = [0, 1].map(Place::rigid).into_iter().filter(is_shared).collect();
        let meets = |stop: usize| stop == lock.stop || shared.iter().any(|place| travel.holds(*place, stop));
        if let Some(other) = locks.iter().find(|other| other.name != lock.name && meets(other.stop)) {
            let message = shared_stop(&other.name);
            return Err(DefinitionError::key(format_args!("locks.{}.engage_force", lock.name), message).into());
        }
        for side in 0..2 {
            if let Some(end) = travel.rigid[side].filter(|_| travel.holds(Place::rigid(side), lock.stop)) {
                travel.engages[side] = lock.engage.map(|force| force * end.slope.abs());
            }
        }
        travel.bumpers.iter_mut().filter(|own| own.stop == lock.stop).for_each(|own| own.engages = lock.engage);
    }
    Ok(())
}

/// Message for two locks at one stop of which one has a force.
fn shared_stop(other: &str) -> String {
    format!("the lock {other} is at the same stop: combine the two locks, or remove this key")
}

/// What the locks with a release force hold at the rigid stop of each side.
///
/// # Errors
/// The stop of such a lock is a bumper, or another lock is at the same place.
fn grips(travel: &Travel, reduced: &Reduced) -> Result<[Option<f64>; 2], ModelError> {
    let mut grips = [None; 2];
    let loading = reduced.loading();
    for (index, lock) in loading.locks.iter().enumerate() {
        let Some(force) = lock.release else { continue };
        let refused =
            |message: &str| Err(DefinitionError::key(format_args!("locks.{}.release_force", lock.name), message));
        let stop = &loading.stops[lock.stop];
        if stop.enabled && !stop.rigid {
            refused("the stop of this lock is a bumper: set `rigid` of the stop to true, or remove this key")?;
        }
        for (side, grip) in grips.iter_mut().enumerate() {
            let place = Place::rigid(side);
            let Some(end) = travel.rigid[side].filter(|_| travel.holds(place, lock.stop)) else { continue };
            let mut others = loading.locks.iter().filter(|other| other.name != lock.name);
            if let Some(other) = others.find(|other| travel.holds(place, other.stop)) {
                refused(&shared_stop(&other.name))?;
            }
            *grip = Some(force * reduced.lock_path(index, reduced.unwound(end.position).0).norm());
        }
    }
    Ok(grips)
}

/// The derivative along sigma of each stop's displacement at its places.
fn add_slopes(travel: &mut Travel, reduced: &Reduced) {
    let slope = |stop: usize, position: f64| {
        let (sigma, _) = reduced.unwound(position);
        let (load, stretch) = (reduced.loading().stops[stop].load, reduced.at(sigma));
        // Passages were found in these tables.
        stretch.displacement(load).map_or(0.0, |table| table.value(table.position(sigma), 1))
    };
    for end in travel.rigid.iter_mut().flatten() {
        end.slope = slope(end.stop, end.position);
    }
    for bumper in &mut travel.bumpers {
        bumper.slopes = bumper.positions.map(|position| position.map_or(0.0, |position| slope(bumper.stop, position)));
    }
}

/// Where each bumper is first met on a side, if it acts there; bumpers at one place have one position.
fn place_bumpers(
    bumpers: &mut [BumperPlaces],
    side: usize,
    met: impl Iterator<Item = (usize, f64)>,
    acts: impl Fn(f64) -> bool,
    one_place: f64,
) {
    for (stop, position) in met.filter(|(_, position)| acts(*position)) {
        let known = bumpers.iter().filter_map(|bumper| bumper.positions[side]);
        let position = known.clone().find(|known| (known - position).abs() <= one_place).unwrap_or(position);
        if let Some(bumper) = bumpers.iter_mut().find(|bumper| bumper.stop == stop) {
            bumper.positions[side] = Some(position);
        }
    }
}

/// Where each enabled stop is first passed on each side of the start. On an open curve they are looked for stretch by
/// stretch, as far as the first rigid one.
fn passages(reduced: &Reduced, sigma: f64, revolutions: f64) -> Result<Vec<Passages>, ModelError> {
    let stops = &reduced.loading().stops;
    let enabled = stops.iter().enumerate().filter(|(_, stop)| stop.enabled);
    let mut met: Vec<_> = enabled.map(|(stop, _)| Passages { stop, positions: [None; 2] }).collect();
    let at_start = reduced.at(sigma);
    let here = sigma + revolutions * reduced.period().unwrap_or(0.0);
    for Passages { stop, positions } in &mut met {
        let stop = &stops[*stop];
        let (table, growth) = (displacement(at_start, stop, revolutions)?, reduced.load_growth(stop.load));
        let at = table.position(sigma);
        let (s, slope) = (table.value(at, 0) + revolutions * growth, table.value(at, 1));
        if !stop.rigid
            && stop.beyond(s) > AT_STOP * (1.0 + stop.value.abs())
            && let Some((side, begins)) = behind(reduced, stop, (sigma, revolutions), slope)
        {
            positions[side] = Some(begins);
            continue;
        }
        beyond_stop(stop, s)?;
        let is_near = stop.beyond(s) > -AT_STOP * (1.0 + stop.value.abs());
        *positions = [-1.0, 1.0].map(|direction| (is_near && slope * stop.sign() * direction > 0.0).then_some(here));
    }
    for side in 0..2 {
        let (mut stretch, mut from) = (at_start, Some(sigma));
        loop {
            for Passages { stop, positions } in met.iter_mut().filter(|met| met.positions[side].is_none()) {
                let stop = &stops[*stop];
                let table = displacement(stretch, stop, revolutions)?;
                let search = Search {
                    reduced: stretch,
                    table,
                    growth: reduced.load_growth(stop.load),
                    wanted: stop.value,
                    sign: stop.sign(),
                };
                positions[side] = search.first(from, revolutions, outward(side));
            }
            let mut found = met.iter().filter(|met| met.positions[side].is_some());
            if found.clone().count() == met.len() || found.any(|met| stops[met.stop].rigid) {
                break;
            }
            let Ok(next) = reduced.next(stretch, side) else { break };
            (stretch, from) = (next, None);
        }
    }
    Ok(met)
}

/// The position nearest to sigma = 0 that no rigid stop excludes, counted on over whole revolutions.
///
/// # Errors
/// A stop's quantity is not smooth.
pub fn within_stops(reduced: &Reduced) -> Result<f64, ModelError> {
    let mut here = 0.0;
    for stop in reduced.loading().stops.iter().filter(|stop| stop.enabled && stop.rigid) {
        let (sigma, revolutions) = reduced.unwound(here);
        let table = displacement(reduced.at(sigma), stop, revolutions)?;
        let at = table.position(sigma);
        let s = table.value(at, 0) + revolutions * reduced.load_growth(stop.load);
        if stop.beyond(s) > AT_STOP * (1.0 + stop.value.abs()) {
            let found = behind(reduced, stop, (sigma, revolutions), table.value(at, 1));
            here = found.map_or(here, |(_, position)| position);
        }
    }
    Ok(here)
}

/// Where a stop is that is passed at a position, with the side on which it then is. `slope`: derivative of its
/// displacement along sigma. The direction in which the stop comes nearer is searched first.
fn behind(reduced: &Reduced, stop: &Stop, at: (f64, f64), slope: f64) -> Option<(usize, f64)> {
    let inward = [-slope * stop.sign(), slope * stop.sign()].map(|sign| if sign < 0.0 { -1.0 } else { 1.0 });
    inward
        .into_iter()
        .find_map(|direction| Some((usize::from(direction < 0.0), begins_behind(reduced, stop, at, direction)?)))
}

/// Where a stop is that is passed at a start, in a direction from there.
fn begins_behind(reduced: &Reduced, stop: &Stop, (sigma, revolutions): (f64, f64), direction: f64) -> Option<f64> {
    let (mut stretch, mut from) = (reduced.at(sigma), Some(sigma));
    loop {
        let table = displacement(stretch, stop, revolutions).ok()?;
        let growth = reduced.load_growth(stop.load);
        // The bumper is passed from beyond it.
        let search = Search { reduced: stretch, table, growth, wanted: stop.value, sign: -stop.sign() };
        if let Some(found) = search.first(from, revolutions, direction) {
            return Some(found);
        }
        (stretch, from) = (reduced.next(stretch, usize::from(direction > 0.0)).ok()?, None);
    }
}

/// The bumpers that push at a position, counted on over whole revolutions, and a speed: of those past whose places the
/// position is the ones that would not pull.
pub fn pressed_bumpers(reduced: &Reduced, travel: &Travel, position: f64, sigma_dot: f64) -> BumperSet {
    let (sigma, revolutions) = reduced.unwound(position);
    let stretch = reduced.at(sigma);
    BumperSet::of(travel.bumpers.len(), |bumper| {
        let BumperPlaces { stop, positions, .. } = travel.bumpers[bumper];
        let is_past = |side: usize| positions[side].is_some_and(|begins| (position - begins) * outward(side) > 0.0);
        let stop = &reduced.loading().stops[stop];
        let pushes = |table: &Table| {
            let at = table.position(sigma);
            let beyond = stop.beyond(table.value(at, 0) + revolutions * reduced.load_growth(stop.load));
            beyond > 0.0 && stop.push(beyond, stop.sign() * table.value(at, 1) * sigma_dot) > 0.0
        };
        (is_past(0) || is_past(1)) && stretch.displacement(stop.load).is_ok_and(pushes)
    })
}

/// Displacement of a stop's load on a stretch of the curve.
fn displacement<'a>(stretch: &'a Reduced, stop: &Stop, revolutions: f64) -> Result<&'a Table, ModelError> {
    let name = || format!("{}.{}", stop.name, stop.quantity);
    stretch.displacement(stop.load).map_err(|at| ModelError::table(stretch, &name(), at, revolutions))
}

/// Refuse a start at this displacement of a stop's load if it is beyond the stop.
pub fn beyond_stop(stop: &Stop, s: f64) -> Result<(), ModelError> {
    if stop.beyond(s) > AT_STOP * (1.0 + stop.value.abs()) {
        let name = format!("{}.{}", stop.name, stop.quantity);
        return Err(ModelError::BeyondStop { name, value: stop.value, start: s });
    }
    Ok(())
}

/// Refuse a lock whose point stands still where its stop is: no force there would hold the mechanism.
pub fn can_hold(reduced: &Reduced, travel: &Travel) -> Result<(), ModelError> {
    // Part of the mechanism's size below which the path of a point for a motion of one radian is rounding.
    const STILL: f64 = 1e-9;
    let loading = reduced.loading();
    if loading.locks.is_empty() {
        return Ok(());
    }
    for (place, position) in travel.places() {
        let (sigma, revolutions) = reduced.unwound(position);
        for (index, lock) in loading.locks.iter().enumerate().filter(|(_, lock)| travel.holds(place, lock.stop)) {
            if reduced.lock_path(index, sigma).norm() * reduced.scale() < STILL * reduced.linkage().size {
                let (name, stop) = (lock.name.clone(), loading.stops[lock.stop].name.clone());
                let position = reduced.describe(sigma, revolutions);
                return Err(ModelError::LockStill { name, stop, position });
            }
        }
    }
    Ok(())
}

/// Search for the first passage of a stop along the curve.
struct Search<'a> {
    reduced: &'a Reduced,
    table: &'a Table,
    /// Growth of the displacement over a revolution.
    growth: f64,
    wanted: f64,
    /// Sign of the displacement beyond the stop.
    sign: f64,
}

impl Search<'_> {
    /// sigma, counted on over whole revolutions, where the stop is first passed in this direction; on an open curve
    /// where it is on this stretch. `from`: where the search begins, else at the near end.
    fn first(&self, from: Option<f64>, revolutions: f64, direction: f64) -> Option<f64> {
        const SAMPLES: usize = 16;
        let table = self.table;
        let period = self.reduced.period();
        let last = table.panels() - 1;
        let start = from.map_or(if direction > 0.0 { 0 } else { last }, |sigma| table.panel(sigma));
        let (first, last) = if direction > 0.0 { (0, last) } else { (last, 0) };
        let (mut panel, mut revolution) = (start, revolutions);
        let mut at_start = from;
        loop {
            let (a, b) = table.borders(panel);
            let beyond = |x: f64| {
                let s = polynomial(table.series(panel, 0), x) + revolution * self.growth;
                self.sign * (s - self.wanted)
            };
            let sigma_at = |x: f64| 0.5 * (a + b) + 0.5 * (b - a) * x + revolution * period.unwrap_or(0.0);
            let mut x0 = at_start.map_or(-direction, |sigma| (2.0 * sigma - a - b) / (b - a));
            let step = (direction - x0) / SAMPLES as f64;
            let mut slack = at_start.is_some();
            for k in 1..=SAMPLES {
                let x1 = if k == SAMPLES { direction } else { x0 + step };
                if beyond(x1) > 0.0 {
                    // A start at the stop may seem beyond it by rounding: the passage is where it comes back.
                    if !(slack && beyond(x0) >= 0.0) {
                        let [a, b] = bisect(|x| beyond(x) > 0.0, x0, x1);
                        return Some(sigma_at(0.5 * (a + b)));
                    }
                } else {
                    slack = false;
                }
                x0 = x1;
            }
            at_start = None;
            if panel == last {
                period?;
                revolution += direction;
                revolution += direction * self.in_vain(revolution, direction);
                if revolution + direction == revolution {
                    // No number of revolutions gets there.
                    return None;
                }
                panel = first;
            } else {
                panel = if direction > 0.0 { panel + 1 } else { panel - 1 };
            }
            // Once round; more often only if every revolution brings the stop nearer.
            if panel == start && !self.nears(revolution, direction) && (revolution - revolutions).abs() >= 1.0 {
                return None;
            }
        }
    }

    /// Number of whole revolutions from here on in which the stop cannot be passed: the displacement in a revolution is
    /// at most the sum of the absolute coefficients of its series, and each revolution adds the growth. A search takes
    /// as long for a stop after 1e5 revolutions as for one after two.
    fn in_vain(&self, revolution: f64, direction: f64) -> f64 {
        let rate = self.growth * direction * self.sign;
        if rate <= 0.0 {
            return 0.0;
        }
        let largest = |panel: usize| {
            let coefficients = self.table.series(panel, 0);
            self.sign * coefficients[0] + coefficients[1..].iter().map(|c| c.abs()).sum::<f64>()
        };
        let most = (0..self.table.panels()).map(largest).fold(f64::NEG_INFINITY, f64::max);
        let lack = self.sign * (self.wanted - revolution * self.growth) - most;
        // One revolution less, for rounding.
        ((lack / rate).floor() - 1.0).max(0.0)
    }

    /// Whether one more revolution brings the stop nearer, so that it may be passed in a later one.
    fn nears(&self, revolution: f64, direction: f64) -> bool {
        let s = polynomial(self.table.series(0, 0), 0.0) + revolution * self.growth;
        self.growth * direction * self.sign > 0.0 && self.sign * (s - self.wanted) < self.growth.abs()
    }
}
