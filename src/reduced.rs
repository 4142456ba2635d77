//! The reduced model: the linkage as one element that moves along sigma, in tables.
//!
//! In: a definition. Out: the influence of every load, and on request the coordinates, displacements, markers and
//! reactions as tables of sigma. A table is built when something first asks for it; all are immutable and shared.
//! It must not know the present state, the inputs or FMI.
use crate::closure::{AssemblyError, Closure, guessed};
use crate::curve::{Configuration, Curve, CurveError, Ends};
use crate::definition::{DefinitionError, Mechanism};
use crate::linkage::{Linkage, Point};
use crate::loading::{Loading, markers};
use crate::loads::Load;
use crate::reactions::{Reaction, columns};
use crate::table::{Table, Unresolved};
use std::fmt;
use std::sync::{Arc, OnceLock};

/// Why a definition gives no reduced model.
#[derive(Clone, Debug, PartialEq)]
pub enum ReductionError {
    /// The definition contradicts itself.
    Definition(DefinitionError),
    /// The loops do not close, or there is not one degree of freedom.
    Assembly(AssemblyError),
    /// The curve cannot be traced.
    Curve(CurveError),
    /// The two ends of an actuator or a spring coincide somewhere, so that its force has no direction.
    EndsMeet {
        /// Its name.
        name: String,
        /// Where the linkage then is.
        position: String,
    },
    /// A function along the curve is not smooth.
    Table {
        /// What is tabulated.
        what: String,
        /// Where the linkage then is.
        position: String,
    },
    /// The stated start is not on the curve.
    Start {
        /// Variable that states it.
        name: String,
        /// Its value.
        value: f64,
        /// Least and largest value on the curve.
        range: (f64, f64),
    },
    /// The start speed cannot be had: the stated coordinate stands still at this position.
    StartSpeed {
        /// Variable that states it.
        name: String,
        /// Its value.
        value: f64,
    },
}

impl fmt::Display for ReductionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Definition(e) => e.fmt(f),
            Self::Assembly(e) => e.fmt(f),
            Self::Curve(e) => e.fmt(f),
            Self::EndsMeet { name, position } => write!(
                f,
                "{name}: its two ends coincide near {position}, where its force has no direction; move one of its attachments"
            ),
            Self::Table { what, position } => write!(
                f,
                "{what} is not smooth near {position}: almost nothing with mass moves there; give a mass or an inertia to a body that does"
            ),
            Self::Start { name, value, range: (low, high) } => {
                write!(f, "{name} = {value} cannot be reached: the linkage moves from {low} to {high}")
            }
            Self::StartSpeed { name, value } => write!(
                f,
                "{name} = {value} cannot be had: at this position it stands still whatever the speed (a toggle); \
                 state the start by another body"
            ),
        }
    }
}

impl std::error::Error for ReductionError {}

/// Components of the influence table beyond one for each sized load; each is there only if the mechanism needs it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Components {
    /// Number of sized loads.
    pub sized: usize,
    /// Springs at rest: less the sum of pull times S_sigma.
    pub springs: Option<usize>,
    /// Dampers: the sum of damping times S_sigma^2, a force for each unit of sigma_dot.
    pub damping: Option<usize>,
    /// What each whole turn adds to the springs, where a torsional spring winds up.
    pub winding: Option<usize>,
    /// Number of components.
    pub count: usize,
}

type Lazy = OnceLock<Result<Table, Unresolved>>;

/// A linkage reduced to one element on its curve, where the reduced inertia is 1.
#[derive(Debug)]
pub struct Reduced {
    curve: Curve,
    loading: Loading,
    components: Components,
    markers: Vec<Point>,
    grid: Vec<f64>,
    natural: Natural,
    influence: Table,
    coordinate_table: Lazy,
    displacement_tables: Vec<Lazy>,
    marker_tables: Vec<Lazy>,
    reaction_tables: Vec<Lazy>,
}

fn lazies(count: usize) -> Vec<Lazy> {
    (0..count).map(|_| OnceLock::new()).collect()
}

impl Reduced {
    /// Assemble, trace and reduce.
    ///
    /// # Errors
    /// [`ReductionError`].
    pub fn new(mechanism: &Mechanism) -> Result<Self, ReductionError> {
        let linkage = Linkage::new(mechanism).map_err(ReductionError::Definition)?;
        let loading = Loading::new(mechanism, &linkage).map_err(ReductionError::Definition)?;
        let markers = markers(mechanism, &linkage).map_err(ReductionError::Definition)?;
        let guess = guessed(&linkage, &mechanism.guess).map_err(ReductionError::Assembly)?;
        let (closure, q) = Closure::assemble(Arc::new(linkage), &guess).map_err(ReductionError::Assembly)?;
        let curve = Curve::trace(closure, &q).map_err(ReductionError::Curve)?;
        let grid = curve.grid();
        let components = Components::new(&loading, &curve);
        let natural = Natural::new(&curve);
        let influence = Table::build(&grid, &components.sizes(&loading, &curve, &natural), &mut |sigma, values| {
            let c = curve.configuration(sigma);
            components.fill(&loading, &curve, &c, values);
            c.amplification
        });
        let influence = influence.map_err(|e| Self::unresolved(&loading, &curve, &e))?;
        Ok(Self {
            coordinate_table: OnceLock::new(),
            displacement_tables: lazies(loading.loads.len()),
            marker_tables: lazies(markers.len()),
            reaction_tables: lazies(curve.linkage().joints.len()),
            natural,
            curve,
            loading,
            components,
            markers,
            grid,
            influence,
        })
    }

    /// The linkage.
    pub fn linkage(&self) -> &Linkage {
        self.curve.linkage()
    }

    /// The curve: the exact evaluator behind the tables.
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    /// The loads, with what makes them as large as they are.
    pub fn loading(&self) -> &Loading {
        &self.loading
    }

    /// Sizes of the sized loads under these inputs; inputs that size no load come after those that do.
    pub fn sizes(&self, inputs: &[f64]) -> Vec<f64> {
        let loads = self.loading.inputs.len();
        inputs[..loads].iter().chain(&self.loading.constants).copied().collect()
    }

    /// What the components of [`Self::influence`] are.
    pub fn components(&self) -> Components {
        self.components
    }

    /// Growth of a load's displacement over one turn of a closed curve; 0 for an open one.
    pub fn load_growth(&self, load: usize) -> f64 {
        self.loading.loads[load].growth(self.linkage(), &|turn| self.growth(turn))
    }

    /// Whether a drive has an efficiency.
    pub fn has_efficiency(&self) -> bool {
        self.loading.drives.iter().any(|d| d.efficiency.is_some())
    }

    /// Whether dampers or drives lose power.
    pub fn loses_power(&self) -> bool {
        self.components.damping.is_some() || self.has_efficiency()
    }

    /// S_sigma of every sized load, then what [`Components`] tells: the right-hand side is their sum, each times its size.
    pub fn influence(&self) -> &Table {
        &self.influence
    }

    /// Growth of a coordinate over one turn of a closed curve; 0 for an open one.
    pub fn growth(&self, coordinate: usize) -> f64 {
        match self.curve.ends() {
            Ends::Closed(growth) => growth[coordinate],
            Ends::Open => 0.0,
        }
    }

    /// Length of a closed curve.
    pub fn period(&self) -> Option<f64> {
        let (first, last) = self.curve.range();
        matches!(self.curve.ends(), Ends::Closed(_)).then_some(last - first)
    }

    /// Length along the curve that goes with a motion of the size of one radian.
    pub fn scale(&self) -> f64 {
        self.natural.scale
    }

    /// Every coordinate with its two derivatives along sigma: three components each.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn coordinates(&self) -> Result<&Table, &Unresolved> {
        let sizes = || {
            let linkage = self.linkage();
            let size = |i: usize| if i < linkage.turns { 1.0 } else { linkage.size };
            (0..linkage.coordinates.len()).flat_map(|i| self.natural.derivatives(size(i))).collect()
        };
        self.table(&self.coordinate_table, &sizes, &|c, v| {
            for (i, derivatives) in v.chunks_exact_mut(3).enumerate() {
                derivatives.copy_from_slice(&[c.q[i], c.q_sigma[i], c.q_second[i]]);
            }
        })
    }

    /// A load's displacement and its two derivatives along sigma.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn displacement(&self, load: usize) -> Result<&Table, &Unresolved> {
        let load_size = || self.natural.displacement(&self.loading.loads[load], self.linkage());
        let sizes = || self.natural.derivatives(load_size()).to_vec();
        self.table(&self.displacement_tables[load], &sizes, &|c, v| {
            v.copy_from_slice(&self.loading.loads[load].displacement(self.linkage(), c));
        })
    }

    /// A marker's x with its two derivatives along sigma, then y.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn marker(&self, i: usize) -> Result<&Table, &Unresolved> {
        let sizes = || self.natural.derivatives(self.linkage().size).repeat(2);
        self.table(&self.marker_tables[i], &sizes, &|c, v| {
            let (p, point) = (&c.positions, self.markers[i]);
            let (x, first) = (p.point(point), p.velocity(&c.rates, point));
            let second = p.acceleration(&c.rates, &c.second, point);
            v.copy_from_slice(&[x.x, first.x, second.x, x.y, first.y, second.y]);
        })
    }

    /// A joint's reaction: force x, force y, moment; each for sigma_ddot = 1, sigma_dot^2 = 1, then each load = 1.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn reaction(&self, joint: usize) -> Result<&Table, &Unresolved> {
        let terms = 2 + self.loading.loads.len();
        let sizes = || {
            let size = self.linkage().size;
            let mut forces = vec![self.natural.scale / size, 1.0 / size];
            forces.extend(self.loading.loads.iter().map(|l| self.natural.displacement(l, self.linkage()) / size));
            let moments: Vec<f64> = forces.iter().map(|f| f * size).collect();
            [&forces[..], &forces[..], &moments[..]].concat()
        };
        self.table(&self.reaction_tables[joint], &sizes, &|c, v| {
            for (k, column) in self.reaction_columns(c).iter().enumerate() {
                let Reaction { force, moment } = column[joint];
                (v[k], v[terms + k], v[2 * terms + k]) = (force.x, force.y, moment);
            }
        })
    }

    /// Components of [`Self::reaction`] at sigma from the exact evaluator: for a joint whose reaction grows without bound
    /// somewhere, so that no table holds it.
    pub fn exact_reaction(&self, joint: usize, sigma: f64) -> Vec<f64> {
        let columns = self.reaction_columns(&self.curve.configuration(sigma));
        let parts = |part: fn(&Reaction) -> f64| columns.iter().map(move |column| part(&column[joint]));
        parts(|r| r.force.x).chain(parts(|r| r.force.y)).chain(parts(|r| r.moment)).collect()
    }

    /// The exact columns behind [`Self::reaction`].
    pub fn reaction_columns(&self, c: &Configuration) -> Vec<Vec<Reaction>> {
        columns(self.curve.closure(), c, &self.loading.loads)
    }

    /// Why the influences are not smooth: two ends meet, or nothing with mass moves.
    fn unresolved(loading: &Loading, curve: &Curve, at: &Unresolved) -> ReductionError {
        let position = curve.describe(at.sigma);
        let c = curve.configuration(at.sigma);
        let meets = loading.loads.iter().position(|load| {
            matches!(load, Load::Pair { .. }) && load.displacement(curve.linkage(), &c)[0] < 1e-3 * curve.linkage().size
        });
        match meets {
            Some(load) => ReductionError::EndsMeet { name: loading.name(load), position },
            None => ReductionError::Table { what: loading.name(at.component.min(loading.loads.len() - 1)), position },
        }
    }

    fn table<'a>(
        &self,
        lazy: &'a Lazy,
        sizes: &dyn Fn() -> Vec<f64>,
        exact: &dyn Fn(&Configuration, &mut [f64]),
    ) -> Result<&'a Table, &'a Unresolved> {
        let build = || {
            Table::build(&self.grid, &sizes(), &mut |sigma, values| {
                let c = self.curve.configuration(sigma);
                exact(&c, values);
                c.amplification
            })
        };
        lazy.get_or_init(build).as_ref()
    }

    /// sigma where a coordinate has this value, and the number of turns of the curve before it: of several the one
    /// nearest to the guess, where sigma is 0.
    ///
    /// # Errors
    /// [`ReductionError::Start`] with the range of the coordinate.
    pub fn find(&self, coordinate: usize, value: f64, name: &str) -> Result<(f64, f64), ReductionError> {
        let table = self
            .coordinates()
            .map_err(|e| ReductionError::Table { what: name.into(), position: self.curve.describe(e.sigma) })?;
        const SAMPLES: usize = 16;
        let growth = self.growth(coordinate);
        let sample = |panel: usize, k: usize| {
            let x = OVERLAP * (-1.0 + 2.0 * k as f64 / SAMPLES as f64);
            (x, crate::table::polynomial(table.series(panel, 3 * coordinate), x))
        };
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for panel in 0..table.panels() {
            for k in 0..=SAMPLES {
                let (_, q) = sample(panel, k);
                (low, high) = (low.min(q), high.max(q));
            }
        }
        // On a curve that turns fully round the value may lie some turns away.
        let turns = if growth == 0.0 {
            vec![0.0]
        } else {
            let around = ((value - 0.5 * (low + high)) / growth).round();
            (-2..=2).map(|k| around + f64::from(k)).collect()
        };
        let mut best: Option<(f64, f64)> = None;
        let distance = |sigma: f64| match self.period() {
            Some(period) => sigma.abs().min((period - sigma).abs()),
            None => sigma.abs(),
        };
        for turn in turns {
            let wanted = value - turn * growth;
            for panel in 0..table.panels() {
                let (a, b) = table.borders(panel);
                let mut offer = |x: f64| {
                    let (sigma, turn) = self.within_a_turn(0.5 * (a + b) + 0.5 * (b - a) * x, turn);
                    if best.is_none_or(|(s, _)| distance(sigma) < distance(s)) {
                        best = Some((sigma, turn));
                    }
                };
                let miss = |x: f64| crate::table::polynomial(table.series(panel, 3 * coordinate), x) - wanted;
                let slope = |x: f64| crate::table::polynomial(table.series(panel, 3 * coordinate + 1), x);
                // At the border of panels rounding may hide the change of sign.
                for x in [-1.0, 1.0] {
                    if miss(x).abs() <= 8.0 * f64::EPSILON * (1.0 + value.abs()) {
                        offer(x);
                    }
                }
                for k in 0..SAMPLES {
                    let (x0, x1) = (sample(panel, k).0, sample(panel, k + 1).0);
                    if miss(x0) * miss(x1) <= 0.0 {
                        offer(bisect(&miss, x0, x1));
                    } else if slope(x0) * slope(x1) <= 0.0 {
                        // The coordinate turns back here: a start exactly at the toggle.
                        let x = bisect(&slope, x0, x1);
                        if miss(x) * miss(x0) <= 0.0 {
                            offer(bisect(&miss, x0, x));
                            offer(bisect(&miss, x, x1));
                        } else if miss(x).abs() < TOGGLE {
                            offer(x);
                        }
                    }
                }
            }
        }
        let (sigma, turn) = best.ok_or(ReductionError::Start { name: name.into(), value, range: (low, high) })?;
        if growth != 0.0 {
            return Ok((sigma, turn));
        }
        // Just behind the guess is the last turn's end: the other coordinates are then near their guesses, not a turn on.
        let behind = self.period().is_some_and(|period| period - sigma < sigma);
        Ok((sigma, if behind { -1.0 } else { 0.0 }))
    }

    /// sigma within the curve, and the number of turns before it, for a sigma just outside.
    fn within_a_turn(&self, sigma: f64, turns: f64) -> (f64, f64) {
        let (first, last) = self.curve.range();
        match self.period() {
            Some(period) if sigma < first => (sigma + period, turns - 1.0),
            Some(period) if sigma >= last => (sigma - period, turns + 1.0),
            Some(_) => (sigma, turns),
            None => (sigma.clamp(first, last), turns),
        }
    }
}

/// Panels are searched for the start this much beyond their ends: at a border rounding must not hide it from both.
const OVERLAP: f64 = 1.0 + 1e-9;
/// A stated start this close beyond a toggle is at the toggle [rad or m].
const TOGGLE: f64 = 1e-9;

/// Root of a function that changes sign: bisection to the last bit.
fn bisect(f: &dyn Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let rising = f(b) > 0.0 || f(a) < 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        let above = f(middle) > 0.0;
        if above == rising { b = middle } else { a = middle }
    }
    0.5 * (a + b)
}

/// Natural sizes, to which the accuracy of tables is related where the values themselves are small.
#[derive(Clone, Copy, Debug)]
struct Natural {
    /// Length along the curve that goes with a motion of the size of one radian.
    scale: f64,
}

impl Natural {
    fn new(curve: &Curve) -> Self {
        Self { scale: curve.scale() }
    }

    /// Of a function with this size, and of its two derivatives along sigma.
    fn derivatives(&self, size: f64) -> [f64; 3] {
        [size, size / self.scale, size / self.scale.powi(2)]
    }

    /// Of a load's displacement in a motion of the size of one radian.
    fn displacement(&self, load: &Load, linkage: &Linkage) -> f64 {
        match load {
            Load::Torque { .. } | Load::Couple { .. } => 1.0,
            Load::Force { .. } | Load::Pair { .. } | Load::Slide { .. } => linkage.size,
            Load::Gravity(acceleration) => {
                let mass: f64 = linkage.bodies.iter().map(|b| b.mass).sum();
                mass * acceleration.norm() * linkage.size
            }
        }
    }
}

impl Components {
    /// Natural size of each component.
    fn sizes(&self, loading: &Loading, curve: &Curve, natural: &Natural) -> Vec<f64> {
        let mut out = vec![0.0; self.count];
        let displacement = |load: usize| natural.displacement(&loading.loads[load], curve.linkage());
        for (load, size) in out[..self.sized].iter_mut().enumerate() {
            *size = displacement(load) / natural.scale;
        }
        for spring in &loading.springs {
            let s = displacement(spring.load);
            let mut add = |component: Option<usize>, value: f64| {
                if let Some(k) = component {
                    out[k] += value;
                }
            };
            add(self.springs, (spring.preload.abs() + spring.stiffness * s) * s / natural.scale);
            add(self.damping, spring.damping * (s / natural.scale).powi(2));
            add(self.winding, spring.stiffness * s * s / natural.scale);
        }
        out
    }

    fn new(loading: &Loading, curve: &Curve) -> Self {
        let mut count = loading.sized();
        let mut next = |there: bool| {
            count += usize::from(there);
            there.then(|| count - 1)
        };
        let springs = next(!loading.springs.is_empty());
        let damping = next(loading.springs.iter().any(|s| s.damping != 0.0));
        let winds = |s: &crate::loading::Spring| winding(loading, curve, s) != 0.0;
        let winding = next(loading.springs.iter().any(winds));
        Self { sized: loading.sized(), springs, damping, winding, count }
    }

    fn fill(&self, loading: &Loading, curve: &Curve, c: &Configuration, values: &mut [f64]) {
        let linkage = curve.linkage();
        values[self.sized..].fill(0.0);
        for (value, load) in values.iter_mut().zip(&loading.loads[..self.sized]) {
            *value = load.influence(linkage, c);
        }
        for spring in &loading.springs {
            let [s, s_sigma, _] = loading.loads[spring.load].displacement(linkage, c);
            let mut add = |component: Option<usize>, value: f64| {
                if let Some(k) = component {
                    values[k] += value;
                }
            };
            add(self.springs, -spring.pull(s) * s_sigma);
            add(self.damping, spring.damping * s_sigma * s_sigma);
            add(self.winding, -spring.stiffness * winding(loading, curve, spring) * s_sigma);
        }
    }
}

/// How far a spring winds up over one turn of a closed curve.
fn winding(loading: &Loading, curve: &Curve, spring: &crate::loading::Spring) -> f64 {
    match curve.ends() {
        Ends::Closed(growth) => loading.loads[spring.load].growth(curve.linkage(), &|turn| growth[turn]),
        Ends::Open => 0.0,
    }
}
