//! The reduced model: the linkage as one element that moves along sigma, in tables.
//!
//! In: a definition. Out: the influence of every load, and on request the coordinates, displacements, markers and
//! reactions as tables of sigma. A table is built when something first asks for it; all are immutable and shared.
//! It must not know the present state, the inputs or FMI.
use crate::closure::{AssemblyError, Closure, guessed};
use crate::curve::{Configuration, Curve, CurveError, Ends};
use crate::definition::{DefinitionError, Mechanism};
use crate::linkage::{Linkage, Point, Vec2};
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
            Self::Table { what, position } => write!(
                f,
                "{what} is not smooth near {position}: its two ends coincide there; move one of its attachments"
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

type Lazy = OnceLock<Result<Table, Unresolved>>;

/// A linkage reduced to one element on its curve, where the reduced inertia is 1.
#[derive(Debug)]
pub struct Reduced {
    curve: Curve,
    loads: Vec<Load>,
    markers: Vec<Point>,
    grid: Vec<f64>,
    scale: f64,
    influence: Table,
    coordinate_tables: Vec<Lazy>,
    displacement_tables: Vec<Lazy>,
    marker_tables: Vec<Lazy>,
    reaction_tables: Vec<Lazy>,
}

/// Loads of a definition in the order of its inputs: actuators, gravity, forces (x, then y), torques.
///
/// # Errors
/// A point that does not exist.
pub fn loads(mechanism: &Mechanism, linkage: &Linkage) -> Result<Vec<Load>, DefinitionError> {
    let mut out = Vec::new();
    for (name, a) in mechanism.actuators.iter() {
        let end = |key: &str, text: &str| linkage.locate(mechanism, &format!("actuators.{name}.{key}"), text);
        out.push(Load::Pair { first: end("first", &a.first)?, second: end("second", &a.second)? });
    }
    if let Some(g) = &mechanism.gravity {
        out.push(Load::Gravity(-g.acceleration * Vec2::new(g.up_angle.cos(), g.up_angle.sin())));
    }
    for (name, force) in mechanism.forces.iter() {
        let at = linkage.locate(mechanism, &format!("forces.{name}.at"), &force.at)?;
        out.extend([Vec2::x(), Vec2::y()].map(|direction| Load::Force { at, direction }));
    }
    for (_, torque) in mechanism.torques.iter() {
        let body = linkage.carrier(mechanism, &torque.on).map_or(0, |(body, _)| body);
        out.push(Load::Torque { body });
    }
    Ok(out)
}

/// Markers of a definition, in its order.
///
/// # Errors
/// A point that does not exist.
pub fn markers(mechanism: &Mechanism, linkage: &Linkage) -> Result<Vec<Point>, DefinitionError> {
    let named = mechanism.markers.iter();
    named.map(|(name, m)| linkage.locate(mechanism, &format!("markers.{name}.at"), &m.at)).collect()
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
        let loads = loads(mechanism, &linkage).map_err(ReductionError::Definition)?;
        let markers = markers(mechanism, &linkage).map_err(ReductionError::Definition)?;
        let guess = guessed(&linkage, &mechanism.guess).map_err(ReductionError::Assembly)?;
        let (closure, q) = Closure::assemble(Arc::new(linkage), &guess).map_err(ReductionError::Assembly)?;
        let curve = Curve::trace(closure, &q).map_err(ReductionError::Curve)?;
        let grid = curve.grid();
        let influence = Table::build(&grid, loads.len(), &mut |sigma, values| {
            let c = curve.configuration(sigma);
            for (value, load) in values.iter_mut().zip(&loads) {
                *value = load.influence(curve.linkage(), &c);
            }
        });
        let influence = influence.map_err(|e| ReductionError::Table {
            what: input_names(mechanism).swap_remove(e.component),
            position: curve.describe(e.sigma),
        })?;
        Ok(Self {
            coordinate_tables: lazies(curve.linkage().coordinates.len()),
            displacement_tables: lazies(loads.len()),
            marker_tables: lazies(markers.len()),
            reaction_tables: lazies(curve.linkage().joints.len()),
            scale: curve.scale(),
            curve,
            loads,
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

    /// Loads, in the order of the components of [`Self::influence`].
    pub fn loads(&self) -> &[Load] {
        &self.loads
    }

    /// S_sigma of every load: the right-hand side is their sum, each times the load's present size.
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
        self.table(&self.coordinate_tables[i], 3, &|c, v| v.copy_from_slice(&[c.q[i], c.q_sigma[i], c.q_second[i]]))
    }

    /// A load's displacement and its two derivatives along sigma.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn displacement(&self, load: usize) -> Result<&Table, &Unresolved> {
        self.table(&self.displacement_tables[load], 3, &|c, v| {
            v.copy_from_slice(&self.loads[load].displacement(self.linkage(), c));
        })
    }

    /// A marker's x and y.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn marker(&self, i: usize) -> Result<&Table, &Unresolved> {
        self.table(&self.marker_tables[i], 2, &|c, v| {
            v.copy_from_slice(c.positions.point(self.markers[i]).as_slice());
        })
    }

    /// A joint's reaction: force x, force y, moment; each for sigma_ddot = 1, sigma_dot^2 = 1, then each load = 1.
    ///
    /// # Errors
    /// [`Unresolved`].
    pub fn reaction(&self, joint: usize) -> Result<&Table, &Unresolved> {
        let terms = 2 + self.loads.len();
        self.table(&self.reaction_tables[joint], 3 * terms, &|c, v| {
            for (k, column) in self.reaction_columns(c).iter().enumerate() {
                let Reaction { force, moment } = column[joint];
                (v[k], v[terms + k], v[2 * terms + k]) = (force.x, force.y, moment);
            }
        })
    }

    /// The exact columns behind [`Self::reaction`].
    pub fn reaction_columns(&self, c: &Configuration) -> Vec<Vec<Reaction>> {
        columns(self.curve.closure(), c, &self.loads)
    }

    fn table<'a>(
        &self,
        lazy: &'a Lazy,
        components: usize,
        exact: &dyn Fn(&Configuration, &mut [f64]),
    ) -> Result<&'a Table, &'a Unresolved> {
        let build = || {
            Table::build(&self.grid, components, &mut |sigma, values| {
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

/// Names of the inputs, in the order of the loads.
pub fn input_names(mechanism: &Mechanism) -> Vec<String> {
    let mut names: Vec<String> = mechanism.actuators.names().iter().map(|n| format!("{n}.force")).collect();
    names.extend(mechanism.gravity.as_ref().map(|_| "load_factor".to_string()));
    names.extend(mechanism.forces.names().iter().flat_map(|n| [format!("{n}.force_x"), format!("{n}.force_y")]));
    names.extend(mechanism.torques.names().iter().map(|n| format!("{n}.torque")));
    names
}
