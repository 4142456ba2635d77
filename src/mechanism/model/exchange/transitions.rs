//! Event indicators, and the transitions that a state makes due.
//!
//! In: the states at the last event and now. Out: values of indicators, the next transition. It must not know how a
//! transition is made.
use crate::mechanism::dynamics::is_still;
use crate::mechanism::loads::laws::friction::Regime;
use crate::mechanism::loads::resolved::DriveLaw;
use crate::mechanism::motion::contact::{Ends, Place, outward};
use crate::mechanism::motion::state::State;
use crate::mechanism::outputs::{Kinematics, OutputError, View};
use crate::mechanism::quantity::{Curve, Indicator};
use crate::mechanism::reduced::StateLoads;
use crate::numerics::alternating::alternating;
use crate::numerics::piecewise::Piecewise;

/// Part of the mechanism's length [1] by which an indicator of a place is shifted, so that it is not 0 after its event.
const PLACE_SHIFT: f64 = 1e-12;
/// Shift of an indicator of a press [m/s2 of a mass of 1 kg] or of the push of a bumper [N or N.m].
const PRESS_SHIFT: f64 = 1e-9;

/// Value of an indicator of what is absent.
pub const ABSENT: f64 = 1.0;

/// A transition that is due.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transition {
    /// The motion has come to the place of a stop or of a lock.
    Arrive(Place),
    /// Nothing holds the mechanism at its place any longer.
    Release(Place),
    /// The stop of a place pushes so hard that the lock there engages.
    Engage(Place),
    /// A bumper begins to push.
    Touch(usize),
    /// A bumper would pull.
    LetGo(usize),
    /// On a driven surface of this speed [m/s], the slip has this sign from now on, 0 where the surface holds its body,
    /// which has this speed along the curve.
    Surface { side: f64, surface: f64, speed: f64 },
    /// The speed passes 0, and the drives or sticking friction hold the mechanism there.
    Halt,
}

/// How far a state is beyond the place of a stop.
fn beyond(x: f64, position: f64, side: usize) -> f64 {
    (x - position) * outward(side)
}

/// How far a bumper would push that does not, or the push of one that does, at a state; none for one that is not in the
/// travel.
fn bumper(view: &mut View<f64>, bumper: usize) -> Result<f64, OutputError> {
    let (state, mut equation) = (view.state, view.equation()?);
    let (beyond, push) = equation.bumper_push(bumper, state.sigma, state.sigma_dot);
    Ok(if state.contact.touching().contains(bumper) { push } else { -beyond.min(push) })
}

/// How far the force of the stop at a place is beyond that at which a lock that waits there engages; none without such
/// a lock or without contact.
fn press(view: &mut View<f64>, ends: &Ends, place: Place) -> Result<Option<f64>, OutputError> {
    let (least, contact) = (ends.engages_at(place), view.state.contact);
    Ok(match place.bumper() {
        _ if !least.is_finite() => None,
        Some(k) if contact.touching().contains(k) => Some(bumper(view, k)? - least),
        None if contact.at_rest() == Some(place) => Some(view.forces()?.free * place.outward() - least),
        _ => None,
    })
}

/// Slip speed on a driven surface that can hold its body at a speed along the curve, the speed of the surface, and the
/// speed along the curve without slip; none without such a surface.
fn slip(view: &mut View<f64>, v: f64) -> Result<Option<[f64; 3]>, OutputError> {
    if view.reduced.loading().surface_that_holds().is_none() {
        return Ok(None);
    }
    let (sigma, mut equation) = (view.state.sigma, view.equation()?);
    Ok(equation.along_surface(sigma).map(|[slip, speed]| [slip * v - speed, speed, speed / slip]))
}

/// How far the friction that holds a body on its driven surface is beyond its limit, forward and backward [N or N.m].
fn beyond_hold(view: &mut View<f64>) -> Result<[f64; 2], OutputError> {
    let direction = view.forces()?.direction;
    let (state, mut equation) = ([view.state.sigma, view.state.sigma_dot], view.equation()?);
    equation.mode.direction = direction;
    let joint = equation.clinging().map(|(joint, _)| joint);
    Ok(joint.map_or(Ok([f64::NEG_INFINITY; 2]), |joint| equation.beyond_hold(joint, state))?)
}

/// Sign of the slip that follows on a driven surface without slip, at this speed along the curve; 0 where the surface
/// holds its body.
fn side_from(view: &mut View<f64>, speed: f64) -> Result<f64, OutputError> {
    let (sigma, mut equation) = (view.state.sigma, view.equation()?);
    equation.scratch.set_side(None);
    equation.mode.direction = match speed {
        0.0 if equation.reverses() => equation.start_direction(sigma, 0.0)?,
        0.0 => 0.0,
        speed => speed.signum(),
    };
    equation.cling(sigma, speed)?;
    let joint = equation.clinging().map(|(joint, _)| joint);
    Ok(joint.and_then(|joint| equation.scratch.evaluator.regimes[joint]).map_or(0.0, Regime::sign))
}

/// Whether a driven surface starts or ceases to hold its body at a speed v, or the slip changes its sign.
fn on_surface(view: &mut View<f64>, last: f64, v: f64) -> Result<Option<Transition>, OutputError> {
    let Some([slip, surface, speed]) = slip(view, v)? else { return Ok(None) };
    let shift = PLACE_SHIFT * view.reduced.scale();
    let known = view.state.contact.surface().filter(|[_, known]| *known == surface).map(|[side, _]| side);
    let (side, speed) = match known {
        Some(0.0) => {
            let [forward, back] = beyond_hold(view)?;
            if forward <= 0.0 && back <= 0.0 {
                return Ok(None);
            }
            (if forward > back { -1.0 } else { 1.0 }, speed)
        }
        Some(side) if slip * side + shift >= 0.0 => return Ok(None),
        // At a dead centre of the slip, a mechanism that moves has no slip on a surface at rest.
        Some(side) if surface == 0.0 && last * v > 0.0 => (-side, v),
        // The slip speed has passed 0.
        Some(side) => match side_from(view, speed)? {
            0.0 => (0.0, speed),
            _ => (-side, v),
        },
        None if is_still(slip, surface) => (side_from(view, speed)?, speed),
        None => (slip.signum(), v),
    };
    Ok(Some(Transition::Surface { side, surface, speed }))
}

/// The first place at which a lock that waits for the force of the stop is to engage.
fn pressed(view: &mut View<f64>, locks: &[bool]) -> Result<Option<Place>, OutputError> {
    let state = view.state;
    let ends = state.ends(view.reduced, locks);
    for (place, _) in state.travel.places().filter(|(place, _)| ends.locked.waiting().contains(*place)) {
        if press(view, &ends, place)?.is_some_and(|excess| excess > 0.0) {
            return Ok(Some(place));
        }
    }
    Ok(None)
}

/// Place of the bumper at which a lock catches the mechanism, the nearer one of the two.
fn place_of_lock(state: &State, stop: usize, x: f64) -> Option<(Place, f64)> {
    let bumper = state.travel.bumpers.iter().position(|bumper| bumper.stop == stop)?;
    let places = [0, 1].map(|side| Place::of_bumper(side, bumper)).into_iter();
    let found = places.filter_map(|place| Some((place, state.travel.position(place)?)));
    found.min_by(|(_, a), (_, b)| (x - a).abs().total_cmp(&(x - b).abs()))
}

/// Value of an event indicator at the states x and v.
pub fn value_of(
    view: &mut View<f64>,
    locks: &[bool],
    indicator: Indicator,
    [x, v]: [f64; 2],
) -> Result<f64, OutputError> {
    let (state, loading, shift) = (view.state, view.reduced.loading(), PLACE_SHIFT * view.reduced.scale());
    let rest = state.contact.at_rest();
    Ok(match indicator {
        _ if state.contact.is_latched() => ABSENT,
        Indicator::End(side) => match (rest, state.travel.end(side)) {
            // Between two rigid stops at one place nothing releases the mechanism.
            (Some(place), end) if place == Place::rigid(side) && end != state.travel.end(1 - side) => {
                let grip = state.ends(view.reduced, locks).grip(place);
                view.forces()?.free * outward(side) + grip + PRESS_SHIFT
            }
            (_, Some(position)) => shift - beyond(x, position, side),
            (_, None) => ABSENT,
        },
        Indicator::Bumper(stop) => match state.travel.bumpers.iter().position(|bumper| bumper.stop == stop) {
            Some(k) => bumper(view, k)? + PRESS_SHIFT.min(shift),
            None => ABSENT,
        },
        Indicator::Lock(lock) => {
            let stop = loading.locks[lock].stop;
            if !state.has_engaged(view.reduced, lock) {
                let ends = state.ends(view.reduced, locks);
                for (place, _) in state.travel.places().filter(|(place, _)| state.travel.holds(*place, stop)) {
                    if let Some(excess) = press(view, &ends, place)? {
                        return Ok(PRESS_SHIFT - excess);
                    }
                }
                return Ok(ABSENT);
            }
            let place = place_of_lock(state, stop, x).filter(|_| locks[lock]);
            place.map_or(ABSENT, |(place, position)| shift - beyond(x, position, place.side))
        }
        Indicator::Reversal => {
            let (sigma, mut equation) = (state.sigma, view.equation()?);
            match v {
                _ if !equation.reverses() => ABSENT,
                // From rest in the direction of setting off.
                0.0 if equation.start_direction(sigma, 0.0)? < 0.0 => -shift,
                0.0 => shift,
                _ => v,
            }
        }
        Indicator::Breakaway => {
            let (sigma, mut equation) = (state.sigma, view.equation()?);
            match v == 0.0 && equation.reverses() {
                true => equation.setting_off(sigma, 1.0)?.max(-equation.setting_off(sigma, -1.0)?),
                false => ABSENT,
            }
        }
        Indicator::Turn(index) => match &loading.friction {
            Some(friction) if friction.acts(index) => {
                let (table, position) =
                    view.reduced.displacement_around(friction.friction_joints[index].load, state.sigma)?;
                // A joint that does not turn has an influence of rounding size.
                table.value(position, 1) + PLACE_SHIFT / view.reduced.scale()
            }
            _ => ABSENT,
        },
        Indicator::Slip { joint, kinetic } => match &loading.friction {
            Some(friction) if friction.enabled => {
                let joint = &friction.friction_joints[joint];
                let border = if kinetic { joint.law.kinetic_speed } else { joint.law.static_speed };
                let (table, position) = view.reduced.displacement_around(joint.load, state.sigma)?;
                let surface = joint.surface.map_or(0.0, |surface| view.size(surface));
                (table.value(position, 1) * v * joint.radius - surface).abs() - border
            }
            _ => ABSENT,
        },
        Indicator::Surface(_) => match state.contact.surface() {
            _ if rest.is_some() => ABSENT,
            Some([0.0, _]) => {
                let [forward, back] = beyond_hold(view)?;
                PRESS_SHIFT - forward.max(back)
            }
            known => {
                let side = known.map_or(0.0, |[side, _]| side);
                slip(view, v)?.map_or(ABSENT, |[slip, ..]| slip + side * shift)
            }
        },
        Indicator::DriveSign(load) => {
            let switch = |s: &StateLoads| s.drives[..s.efficient].iter().position(|drive| *drive == load);
            switching(view, switch)?.unwrap_or(ABSENT)
        }
        Indicator::NormalForce(joint) => {
            let own = loading.friction.as_ref().map(|friction| friction.friction_joints[joint].joint);
            let is_own = |s: &StateLoads, other: usize| Some(s.friction_joints[other].joint) == own;
            let switch = |s: &StateLoads| Some(s.efficient + s.prismatic.iter().position(|other| is_own(s, *other))?);
            switching(view, switch)?.unwrap_or(ABSENT)
        }
        Indicator::Limit { drive, side } => {
            let is_own = |s: &StateLoads, (law, own): (usize, usize)| (s.laws[law].drive, own) == (drive, side);
            let switch = |s: &StateLoads| Some(s.limit_switch(s.limits.iter().position(|own| is_own(s, *own))?));
            switching(view, switch)?.unwrap_or(ABSENT)
        }
        Indicator::Points(curve) => points(view, curve)?,
    })
}

/// Value of a switching quantity at a state; none where the loads that the state decides do not have it.
fn switching(view: &mut View<f64>, switch: impl Fn(&StateLoads) -> Option<usize>) -> Result<Option<f64>, OutputError> {
    view.forces()?;
    Ok(view.state_loads().and_then(switch).map(|switch| view.switching(switch)))
}

/// A function of the state that changes its sign at the points of a curve.
fn points(view: &mut View<f64>, curve: Curve) -> Result<f64, OutputError> {
    let loading = view.reduced.loading();
    fn knots(curve: Option<&Piecewise>) -> &[f64] {
        curve.map_or(&[], Piecewise::knots)
    }
    Ok(match curve {
        Curve::Drive(load) => {
            let curve = loading.drives[load].law.as_ref().and_then(DriveLaw::curve);
            alternating(knots(curve), view.displacement(load, 1)?)
        }
        Curve::Damper(k) => {
            let spring = &loading.springs[k];
            alternating(knots(spring.damper.as_ref()), view.displacement(spring.load, 1)?)
        }
        Curve::Spring(k) => {
            let spring = &loading.springs[k];
            alternating(spring.knots(), view.displacement(spring.load, 0)?)
        }
        Curve::Bumper(k) => {
            // The contact itself has an indicator of its own.
            let (stop, all) = (&loading.stops[k], knots(loading.stops[k].curve.as_ref()));
            alternating(all.get(1..).unwrap_or_default(), stop.beyond(view.displacement(stop.load, 0)?))
        }
        Curve::Slot(k) => {
            let slot = &view.reduced.linkage().slots[k];
            alternating(slot.track.knots(), view.joint_position(slot.coordinate, 0)?)
        }
        Curve::Cam(k) => {
            let linkage = view.reduced.linkage();
            let coupling = &linkage.couplings[k];
            let first = view.angle(linkage.joints[coupling.joint].first.body, 0)?;
            coupling.law.alternating(first - view.angle(coupling.carrier, 0)? + coupling.shift)
        }
    })
}

/// The next transition that is due between the states `last` and `now`. `locks`: which are engaged, if any is.
pub fn transition(
    view: &mut View<f64>,
    locks: Option<&[bool]>,
    last: [f64; 2],
    [x, v]: [f64; 2],
) -> Result<Option<Transition>, OutputError> {
    let state = view.state;
    if state.contact.is_latched() {
        return Ok(None);
    }
    if let Some(place) = pressed(view, locks.unwrap_or_default())? {
        return Ok(Some(Transition::Engage(place)));
    }
    if let Some(place) = state.contact.at_rest() {
        let forces = view.forces()?;
        if forces.held.is_none() {
            return Ok(Some(Transition::Release(place)));
        }
    } else {
        for side in 0..2 {
            let Some(gap) = state.travel.end(side).map(|position| beyond(x, position, side)) else { continue };
            let outward_speed = v * outward(side);
            if gap >= 0.0 && outward_speed > 0.0 || gap > 0.0 && outward_speed == 0.0 {
                return Ok(Some(Transition::Arrive(Place::rigid(side))));
            }
        }
        let engaged = locks.unwrap_or_default();
        let reduced = view.reduced;
        let locks = reduced.loading().locks.iter().zip(engaged).enumerate();
        for (_, (lock, _)) in locks.filter(|(index, (_, is_on))| **is_on && state.has_engaged(reduced, *index)) {
            if let Some((place, position)) = place_of_lock(state, lock.stop, x)
                && last[0] != position
                && (last[0] - position) * (x - position) <= 0.0
            {
                return Ok(Some(Transition::Arrive(place)));
            }
        }
    }
    for k in 0..state.travel.bumpers.len() {
        let value = bumper(view, k)?;
        if value < 0.0 {
            if state.contact.touching().contains(k) {
                return Ok(Some(Transition::LetGo(k)));
            }
            let met = [0, 1].into_iter().find(|&side| {
                let position = state.travel.position(Place::of_bumper(side, k));
                let is_met = |p: f64| beyond(last[0], p, side) < 0.0 && beyond(x, p, side) >= 0.0;
                v * outward(side) > 0.0 && position.is_some_and(is_met)
            });
            return Ok(Some(met.map_or(Transition::Touch(k), |side| Transition::Arrive(Place::of_bumper(side, k)))));
        }
    }
    if state.contact.at_rest().is_none()
        && let Some(transition) = on_surface(view, last[1], v)?
    {
        return Ok(Some(transition));
    }
    if last[1] * v < 0.0 {
        let sigma = state.sigma;
        let mut equation = view.equation()?;
        if equation.reverses() && equation.start_direction(sigma, 0.0)? == 0.0 {
            return Ok(Some(Transition::Halt));
        }
    }
    Ok(None)
}
