//! The travel without time: poses and coordinates from one end to the other.

use crate::view::series::Series;
use linkage_fmu::mechanism::inspection::{Pose, SweptStop};
use linkage_fmu::mechanism::{Model, ModelError};
use serde::Serialize;

/// Parts of the travel.
const PARTS: usize = 240;

/// The travel without time.
#[derive(Clone, Debug, Serialize)]
pub struct Travel {
    /// Number of positions.
    count: usize,
    /// Angle, x and y of each body of the linkage.
    poses: Vec<[Series; 3]>,
    /// Coordinates, then displacements of the drives.
    values: Vec<Position>,
    /// Position of the start, from 0 at the low end to 1 at the high end.
    start: f64,
    is_closed: bool,
    goes_on: [bool; 2],
    stops: Vec<Met>,
}

/// A quantity that depends on the position alone.
#[derive(Clone, Debug, Serialize)]
struct Position {
    name: String,
    is_angle: bool,
    values: Series,
}

/// A stop that is met.
#[derive(Clone, Debug, Serialize)]
struct Met {
    stop: usize,
    /// From 0 at the low end to 1 at the high end.
    at: f64,
    poses: Vec<Pose>,
}

impl Travel {
    /// The travel of a model under its present parameters.
    ///
    /// # Errors
    /// There is no model, or no start.
    pub fn new(model: &mut Model) -> Result<Self, ModelError> {
        let sweep = model.sweep(PARTS)?;
        let [low, high] = [sweep.sigma[0], sweep.sigma[PARTS]];
        let part = |sigma: f64| if high > low { (sigma - low) / (high - low) } else { 0.0 };
        let bodies = sweep.poses.first().map_or(0, Vec::len);
        let pose = |body: usize| {
            [0, 1, 2].map(|i| Series::new(&sweep.poses.iter().map(|poses| poses[body][i]).collect::<Vec<_>>()))
        };
        let (angles, positions) = sweep.coordinates.split_at(sweep.angles);
        let coordinate = |is_angle: bool, quantity: &'static str| {
            move |(name, values): &(String, Vec<f64>)| Position {
                name: format!("{name}.{quantity}"),
                is_angle,
                values: Series::new(values),
            }
        };
        let angles = angles.iter().map(coordinate(true, "angle"));
        let positions = positions.iter().map(coordinate(false, "position"));
        let drives = sweep.drives.iter().map(|(name, is_rotary, values)| Position {
            name: name.clone(),
            is_angle: *is_rotary,
            values: Series::new(values),
        });
        let met =
            |SweptStop { stop, sigma, poses }: &SweptStop| Met { stop: *stop, at: part(*sigma), poses: poses.clone() };
        Ok(Self {
            count: sweep.sigma.len(),
            poses: (0..bodies).map(pose).collect(),
            values: angles.chain(positions).chain(drives).collect(),
            start: part(sweep.start),
            is_closed: sweep.is_closed,
            goes_on: sweep.goes_on,
            stops: sweep.stops.iter().map(met).filter(|met| (0.0..=1.0).contains(&met.at)).collect(),
        })
    }
}
