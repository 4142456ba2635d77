//! Random linkages: loops of four bodies and chains of six, any body as the ground, joints of both types. The bodies
//! are placed first and the joints afterwards in the plane, so that every loop closes.
use crate::support::oracle;
use crate::support::oracle::linkage::{
    Attachment, Body, Coordinate, Freedom, GROUND, Joint, Linkage, Loads, Mass, Rider,
};
use crate::support::{Vec2, turned};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// A chain: the pairs of joined bodies, and the number of prismatic joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    pub name: &'static str,
    bodies: usize,
    joints: &'static [(usize, usize)],
    slides: usize,
}

const LOOP: &[(usize, usize)] = &[(0, 1), (1, 2), (2, 3), (3, 0)];
/// Watt's chain: two loops of four bodies that share a joint between two ternary bodies.
const WATT: &[(usize, usize)] = &[(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (4, 5), (5, 1)];
/// Stephenson's chain: two ternary bodies joined by two single bodies and by a pair of bodies.
const STEPHENSON: &[(usize, usize)] = &[(0, 2), (2, 1), (0, 3), (3, 1), (0, 4), (4, 5), (5, 1)];

pub const CHAINS: [Chain; 7] = [
    Chain { name: "four-bar", bodies: 4, joints: LOOP, slides: 0 },
    Chain { name: "slider-crank", bodies: 4, joints: LOOP, slides: 1 },
    Chain { name: "double slider", bodies: 4, joints: LOOP, slides: 2 },
    Chain { name: "Watt", bodies: 6, joints: WATT, slides: 0 },
    Chain { name: "Watt with a slider", bodies: 6, joints: WATT, slides: 1 },
    Chain { name: "Stephenson", bodies: 6, joints: STEPHENSON, slides: 0 },
    Chain { name: "Stephenson with a slider", bodies: 6, joints: STEPHENSON, slides: 1 },
];

/// Smallest distance of two points of a body [m]. All points are in a square of side 2.
const SHORTEST: f64 = 0.1;
/// Linkages nearer to a crossing than this are discarded: difference of lengths of a four-bar [m], or second smallest
/// singular value of the constraint Jacobian at the start.
const CROSSING: f64 = 1e-3;
/// Number of random numbers that determine a linkage.
const NUMBERS: usize = 200;

/// Reason to discard a linkage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Discard {
    /// Two points of a body, or the two ends of the actuator, nearly coincide.
    Short,
    /// A crossing is near.
    Crossing,
}

/// Random numbers from which a linkage is built.
pub fn numbers() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.0..1.0f64, NUMBERS)
}

/// Random linkages of all chains. Four-bars, which need less time, occur twice as often.
pub fn linkages() -> impl Strategy<Value = Linkage> {
    let chain = prop::sample::select([&CHAINS[..], &CHAINS[..3]].concat());
    (chain, numbers()).prop_filter_map("nearly degenerate", |(chain, numbers)| build(chain, &numbers).ok())
}

/// Random numbers from 0 to 1, used one after the other.
struct Deck<'a>(std::slice::Iter<'a, f64>);

impl Deck<'_> {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.next().copied().unwrap_or(0.5)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }

    fn chance(&mut self) -> bool {
        self.between(0.0, 1.0) < 0.5
    }

    fn point(&mut self) -> Vec2 {
        Vec2::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    fn mass(&mut self) -> Mass {
        let (even, center) = (self.chance(), 0.5 * self.point());
        let center = if even { Vec2::zeros() } else { center };
        Mass { mass: self.between(0.1, 2.0), center, inertia: self.between(0.01, 0.3) }
    }
}

/// Build a linkage from numbers between 0 and 1, unless it is nearly degenerate.
pub fn build(chain: Chain, numbers: &[f64]) -> Result<Linkage, Discard> {
    let mut deck = Deck(numbers.iter());
    // Any body of the chain may be the ground, and any joint may be the first.
    let shift = deck.below(chain.bodies);
    let body = |b: usize| (b + shift) % chain.bodies;
    let mut edges: Vec<(usize, usize)> = chain.joints.iter().map(|&(a, b)| (body(a), body(b))).collect();
    for i in 0..edges.len() {
        let other = i + deck.below(edges.len() - i);
        edges.swap(i, other);
        if deck.chance() {
            edges[i] = (edges[i].1, edges[i].0);
        }
    }
    let first_slide = deck.below(edges.len());
    let slides = |j: usize| (j + edges.len() - first_slide) % edges.len() < chain.slides;
    // The two end points of each joint in the plane.
    let mut ends = Vec::new();
    let mut axes = Vec::new();
    for j in 0..edges.len() {
        let first = deck.point();
        let (axis, square, position) = (deck.between(-PI, PI), deck.chance(), deck.between(-1.0, 1.0));
        // Half of the axes are parallel to x or y. Some reaction components then vanish.
        let axis = if square { (axis / FRAC_PI_2).round() * FRAC_PI_2 } else { axis };
        ends.push((first, if slides(j) { first + turned(Vec2::new(position, 0.0), axis) } else { first }));
        axes.push((axis, position));
    }
    let mut bodies: Vec<Body> = Vec::new();
    for b in 0..chain.bodies {
        let ends = edges.iter().zip(&ends).flat_map(|(edge, ends)| [(edge.0, ends.0), (edge.1, ends.1)]);
        let own: Vec<Vec2> = ends.filter(|(body, _)| *body == b).map(|(_, end)| end).collect();
        if own.iter().enumerate().any(|(i, p)| own[..i].iter().any(|q| (p - q).norm() < SHORTEST)) {
            return Err(Discard::Short);
        }
        bodies.push(pose(b, &own, &mut deck));
    }
    let mut next = vec![0; chain.bodies];
    let mut attachment = |body: usize| {
        next[body] += 1;
        Attachment { body, point: next[body] - 1 }
    };
    let joints: Vec<Joint> = (0..edges.len())
        .map(|j| {
            let (first, second) = (attachment(edges[j].0), attachment(edges[j].1));
            let (axis, position) = axes[j];
            let [a, b] = [first, second].map(|p| bodies[p.body].angle);
            let freedom = if slides(j) {
                Freedom::Prismatic { axis: axis - a, angle: b - a, position }
            } else {
                Freedom::Revolute
            };
            Joint { name: format!("j{j}"), freedom, first, second }
        })
        .collect();
    let mut some = |deck: &mut Deck, body: usize| {
        let local = deck.point();
        let point = bodies[body].points.len();
        bodies[body].points.push((format!("q{point}"), local));
        Attachment { body, point }
    };
    let moving = chain.bodies - 1;
    let body = 1 + deck.below(moving);
    let other = (body + 1 + deck.below(moving)) % chain.bodies;
    let (a, b) = (some(&mut deck, body), some(&mut deck, other));
    let [at, to] = [(); 2].map(|()| {
        let body = 1 + deck.below(moving);
        some(&mut deck, body)
    });
    let at_start =
        |p: Attachment| bodies[p.body].position + turned(bodies[p.body].points[p.point].1, bodies[p.body].angle);
    if (at_start(a) - at_start(b)).norm() < SHORTEST {
        return Err(Discard::Short);
    }
    let loads = Loads {
        pushes: vec![(a, b, deck.between(-20.0, 20.0))],
        gravity: (9.81, if deck.chance() { FRAC_PI_2 } else { deck.between(-PI, PI) }, deck.between(0.0, 2.0)),
        forces: vec![(at, 10.0 * deck.point())],
        torques: vec![(1 + deck.below(moving), deck.between(-5.0, 5.0))],
    };
    let riders = vec![Rider { to, angle: deck.between(-PI, PI), mass: deck.mass() }];
    let start = (Coordinate::Angle(0), 0.0, 0.0);
    let mut linkage = Linkage { kind: chain.name, bodies, joints, riders, loads, start, astray: Vec::new() };
    if linkage.joints.len() == 4 && chain.slides == 0 && excess(&linkage).1 < CROSSING {
        return Err(Discard::Crossing);
    }
    let (rates, least) = oracle::free_motion(&linkage);
    if least < CROSSING {
        return Err(Discard::Crossing);
    }
    let coordinates = linkage.coordinates();
    linkage.astray = coordinates.iter().map(|_| deck.between(-5e-3, 5e-3)).collect();
    // The start is stated by a coordinate that is not near a toggle.
    let fastest = rates.iter().fold(0.0, |a: f64, r| a.max(r.abs()));
    let fit: Vec<usize> = (0..rates.len()).filter(|&i| rates[i].abs() > 0.4 * fastest).collect();
    let stated = fit[deck.below(fit.len())];
    let speed = deck.between(-5.0, 5.0) * rates[stated] / fastest;
    linkage.start = (coordinates[stated], linkage.value(coordinates[stated]), speed);
    Ok(linkage)
}

/// A body placed in the plane, whose first points are the positions of its joints: as a rod from `origin` to `end`, or
/// with any frame.
fn pose(b: usize, own: &[Vec2], deck: &mut Deck) -> Body {
    let (rod, somewhere, angle, mass) = (deck.chance(), deck.point(), deck.between(-PI, PI), deck.mass());
    let along = own[1] - own[0];
    let (position, angle) = if b == GROUND {
        (Vec2::zeros(), 0.0)
    } else if rod {
        (own[0], along.y.atan2(along.x))
    } else {
        (somewhere, angle)
    };
    let rod = rod && b != GROUND;
    let name = |i: usize| match i {
        0 if rod => "origin".into(),
        1 if rod => "end".into(),
        _ => format!("p{i}"),
    };
    let local = |i: usize, p: &Vec2| {
        if rod && i < 2 { Vec2::new(i as f64 * along.norm(), 0.0) } else { turned(p - position, -angle) }
    };
    Body {
        name: if b == GROUND { "ground".into() } else { format!("b{b}") },
        position,
        angle,
        mass,
        length: rod.then(|| along.norm()),
        points: own.iter().enumerate().map(|(i, p)| (name(i), local(i, p))).collect(),
    }
}

/// Grashof's excess of a four-bar, longest + shortest - the two others [m], and the distance from a flat position [m].
fn excess(linkage: &Linkage) -> (f64, f64) {
    let mut sides = sides(linkage);
    sides.sort_by(f64::total_cmp);
    let [s, p, q, l] = sides;
    let flat = [l + s - p - q, l + p - s - q, l + q - s - p, s + p + q - l];
    (flat[0], flat.iter().fold(f64::INFINITY, |a, f| a.min(f.abs())))
}

fn sides(linkage: &Linkage) -> [f64; 4] {
    std::array::from_fn(|b| (linkage.bodies[b].points[1].1 - linkage.bodies[b].points[0].1).norm())
}

/// Grashof's type of a four-bar, by its shortest body.
pub fn grashof(linkage: &Linkage) -> &'static str {
    let sides = sides(linkage);
    let shortest = (0..4).fold(0, |a, b| if sides[b] < sides[a] { b } else { a });
    let grounded = linkage.joints.iter().any(|j| {
        let ends = [j.first.body, j.second.body];
        ends.contains(&GROUND) && ends.contains(&shortest)
    });
    match (excess(linkage).0 > 0.0, shortest) {
        (true, _) => "triple rocker",
        (false, GROUND) => "double crank",
        (false, _) if grounded => "crank and rocker",
        (false, _) => "double rocker",
    }
}
