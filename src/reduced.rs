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
    scale: f64,
    influence: Table,
    coordinate_tables: Vec<Lazy>,
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
        let influence = Table::build(&grid, &vec![0.0; components.count], &mut |sigma, values| {
            components.fill(&loading, &curve, &curve.configuration(sigma), values);
        });
        let influence = influence.map_err(|e| Self::unresolved(&loading, &curve, &e))?;
        Ok(Self {
            coordinate_tables: lazies(curve.linkage().coordinates.len()),
            displacement_tables: lazies(loading.loads.len()),
            marker_tables: lazies(markers.len()),
            reaction_tables: lazies(curve.linkage().joints.len()),
            scale: curve.scale(),
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
        self.scale
    }

    /// A coordinate and its two derivatives along sigma.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn coordinate(&self, i: usize) -> Result<&Table, &Unresolved> {
        let size = if i < self.linkage().turns { 1.0 } else { self.linkage().size };
        self.table(&self.coordinate_tables[i], &self.sizes_along(size), &|c, v| {
            v.copy_from_slice(&[c.q[i], c.q_sigma[i], c.q_second[i]])
        })
    }

    /// A load's displacement and its two derivatives along sigma.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn displacement(&self, load: usize) -> Result<&Table, &Unresolved> {
        self.table(&self.displacement_tables[load], &[0.0; 3], &|c, v| {
            v.copy_from_slice(&self.loading.loads[load].displacement(self.linkage(), c));
        })
    }

    /// A marker's x with its two derivatives along sigma, then y.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn marker(&self, i: usize) -> Result<&Table, &Unresolved> {
        let sizes = self.sizes_along(self.linkage().size).repeat(2);
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
        self.table(&self.reaction_tables[joint], &vec![0.0; 3 * terms], &|c, v| {
            for (k, column) in self.reaction_columns(c).iter().enumerate() {
                let Reaction { force, moment } = column[joint];
                (v[k], v[terms + k], v[2 * terms + k]) = (force.x, force.y, moment);
            }
        })
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

    /// Sizes of a quantity of this size and of its two derivatives along sigma.
    fn sizes_along(&self, size: f64) -> [f64; 3] {
        [size, size / self.scale, size / (self.scale * self.scale)]
    }

    fn table<'a>(
        &self,
        lazy: &'a Lazy,
        sizes: &[f64],
        exact: &dyn Fn(&Configuration, &mut [f64]),
    ) -> Result<&'a Table, &'a Unresolved> {
        let build = || {
            Table::build(&self.grid, sizes, &mut |sigma, values| {
                exact(&self.curve.configuration(sigma), values);
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
            .coordinate(coordinate)
            .map_err(|e| ReductionError::Table { what: name.into(), position: self.curve.describe(e.sigma) })?;
        const SAMPLES: usize = 16;
        let growth = self.growth(coordinate);
        let sample = |panel: usize, k: usize| {
            let x = -1.0 + 2.0 * k as f64 / SAMPLES as f64;
            (x, crate::table::polynomial(table.series(panel, 0), x))
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
                    let sigma = 0.5 * (a + b) + 0.5 * (b - a) * x;
                    if best.is_none_or(|(s, _)| distance(sigma) < distance(s)) {
                        best = Some((sigma, turn));
                    }
                };
                let miss = |x: f64| crate::table::polynomial(table.series(panel, 0), x) - wanted;
                let slope = |x: f64| crate::table::polynomial(table.series(panel, 1), x);
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
        // Where a closed curve meets its start, rounding may leave a gap between the two ends of the table.
        if best.is_none() && self.period().is_some() {
            let start = crate::table::polynomial(table.series(0, 0), -1.0);
            let turn = if growth == 0.0 { 0.0 } else { ((value - start) / growth).round() };
            if (value - start - turn * growth).abs() < TOGGLE {
                best = Some((table.borders(0).0, turn));
            }
        }
        best.ok_or(ReductionError::Start { name: name.into(), value, range: (low, high) })
    }
}

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

impl Components {
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
