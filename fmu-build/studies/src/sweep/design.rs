//! The design of a study: the values of the factors in each run.
//!
//! In: factors, samples, points of a file. Out: the values of any run, in any order of calls. Every point of the file
//! is combined with every point of the grid, and these with every sample. The runs have this order. In the grid the
//! last stated factor changes first. The module must not know how a run is made.

use super::definition::{self, Definition, Normal};
use super::factor::{Factor, Source, coded, variable};
use super::points::Points;
use super::unit_cube::{UnitCube, each, most_dimensions};
use anyhow::{Context, Result, bail};
use linkage_fmu::component::{Component, Refused};
use linkage_fmu::format::DefinitionError;
use linkage_fmu::variables::{Causality, Kind, Reference};
use statrs::distribution::ContinuousCDF;
use statrs::statistics::Distribution;
use std::path::Path;

/// Largest number of runs of a study: their numbers are exact as doubles.
const MOST_RUNS: u64 = 1 << 53;

/// Factors of one type that one call sets.
#[derive(Clone, Debug)]
pub struct Call {
    /// Their kind.
    pub kind: Kind,
    /// Their indices among all factors.
    pub factors: Vec<usize>,
    references: Vec<Reference>,
}

impl Call {
    /// Set the values of these factors in a run. A Boolean is 1 for true, a text is given by its index.
    ///
    /// # Errors
    /// The model rejects one of the values, or a value that follows from them.
    pub fn apply(
        &self,
        model: &mut Component,
        factors: &[Factor],
        point: &[f64],
        scratch: &mut Vec<f64>,
    ) -> Result<(), Refused> {
        if self.kind == Kind::Real {
            scratch.clear();
            scratch.extend(self.factors.iter().map(|index| point[*index]));
            return model.set_reals(&self.references, scratch);
        }
        self.factors.iter().zip(&self.references).try_for_each(|(index, reference)| {
            let (factor, value) = (&factors[*index], point[*index]);
            match self.kind {
                // A value of a file that has changed since the check.
                _ if value.is_nan() => Err(Refused(format!("{} has no value", factor.name))),
                Kind::Boolean => model.set_boolean(*reference, value != 0.0),
                _ => model.set_text(*reference, &factor.texts[value as usize]),
            }
        })
    }
}

/// The calls that set these factors: Reals, then Booleans, then texts.
pub fn calls(model: &Component, factors: &[Factor]) -> Vec<Call> {
    let mut calls: Vec<Call> = Vec::new();
    for kind in [Kind::Real, Kind::Boolean, Kind::Enumeration] {
        let most = if kind == Kind::Real { model.most_together() } else { usize::MAX };
        for (index, factor) in (0..).zip(factors).filter(|(_, factor)| factor.kind == kind) {
            match calls.last_mut().filter(|call| call.kind == kind && call.factors.len() < most) {
                Some(call) => {
                    call.factors.push(index);
                    call.references.push(factor.reference);
                }
                None => calls.push(Call { kind, factors: vec![index], references: vec![factor.reference] }),
            }
        }
    }
    calls
}

/// The values of the factors in all runs.
#[derive(Clone, Debug)]
pub struct Design {
    factors: Vec<Factor>,
    points: Option<Points>,
    cube: Option<UnitCube>,
    /// Number of points of the file, of points of the grid, and of samples.
    counts: [u64; 3],
}

impl Design {
    /// The design of a study in `folder` for this model.
    ///
    /// # Errors
    /// A name is no parameter or input; a fault of a factor, of the samples, or of the file of points.
    pub fn new(study: &Definition, folder: &Path, model: &Component) -> Result<Self> {
        let (mut factors, mut dimensions) = (Vec::new(), 0);
        let mut counts = [1, 1, 1];
        let points = study.points.as_ref().map(|points| Points::read(&folder.join(points), model));
        let points = points.transpose().context("points")?;
        if let Some(points) = &points {
            counts[0] = points.lines();
            let column = |(factor, index): (&Factor, usize)| Factor { source: Source::Column(index), ..factor.clone() };
            factors.extend(points.factors().iter().zip(0..).map(column));
        }
        for (name, stated) in study.factors.iter() {
            let key = format!("factors.{name}");
            let factor = factor(&key, name, stated, model, &mut dimensions)?;
            if factors.iter().any(|other: &Factor| other.reference == factor.reference) {
                bail!(
                    "{key}: this factor is also a column of the CSV file that the key `points` names; remove the \
                     column or this factor"
                );
            }
            if let Source::List(values) = &factor.source {
                counts[1] = times(counts[1], values.len() as u64)?;
            } else if let Source::Range(_, _, count) = factor.source {
                counts[1] = times(counts[1], count)?;
            }
            factors.push(factor);
        }
        let cube = match (study.sampling, dimensions) {
            (Some(_), 0) => bail!(
                "sampling: no factor has a distribution; add a distribution to a factor, or remove \
                `sampling`"
            ),
            (None, 1..) => {
                bail!(
                    "sampling: this key is missing, but a factor has a distribution; add the key `sampling` with a \
                    method"
                )
            }
            (Some(sampling), _) if sampling.count == 0 => bail!("sampling.count = 0: must be at least 1"),
            (Some(sampling), _) if most_dimensions(sampling.method) < dimensions => bail!(
                "sampling.method: {dimensions} factors have a distribution, but this method supports at most {}",
                most_dimensions(sampling.method)
            ),
            (sampling, _) => sampling.map(|sampling| UnitCube::new(sampling, dimensions)),
        };
        if let Some(sampling) = study.sampling {
            counts[2] = times(sampling.count, each(sampling.method, dimensions))?;
        }
        times(times(counts[0], counts[1])?, counts[2])?;
        Ok(Self { factors, points, cube, counts })
    }

    /// The factors, in the order of their values.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// Number of runs.
    pub fn runs(&self) -> u64 {
        self.counts.iter().product()
    }

    /// A warning about a parameter whose mean in the study is far from its value in the definition. An example is a
    /// point of a body whose coordinates are given in the frame of a drawing.
    pub fn far_from_definition(&self, model: &mut Component) -> Option<String> {
        /// Ratio of mean and value above which one of them is probably wrong.
        const FAR: f64 = 10.0;
        let normal = self.factors.iter().filter_map(|factor| match &factor.source {
            Source::Normal(normal, _) => Some((factor, normal.mean()?)),
            _ => None,
        });
        let mut far = normal.filter_map(|(factor, mean)| {
            let is_parameter = model.interface().list()[factor.reference as usize].causality == Causality::Parameter;
            let value = model.real(factor.reference).ok().filter(|value| is_parameter && *value != 0.0)?;
            (mean.abs() > FAR * value.abs()).then(|| {
                format!(
                    "factors.{0}.normal.mean = {mean} is far from the value {value} of {0} in the definition: \
                     variables are in SI units, and points are in the frame of their body; `cargo fmu info` prints \
                     the values",
                    factor.name
                )
            })
        });
        far.next()
    }

    /// The values of the factors in a run.
    pub fn point(&mut self, run: u64, values: &mut [f64]) {
        let [_, grid, samples] = self.counts;
        let (sample, rest) = (run % samples, run / samples);
        let (mut of_grid, of_file) = (rest % grid, rest / grid);
        let line = self.points.as_mut().map_or(&[][..], |points| points.line(of_file));
        // In the grid the last factor changes first.
        for (factor, value) in self.factors.iter().zip(values.iter_mut()).rev() {
            let mut index_of = |count: u64| {
                let index = of_grid % count;
                of_grid /= count;
                index
            };
            let mut unit = |dimension| self.cube.as_mut().map_or(0.5, |cube| cube.coordinate(sample, dimension));
            *value = match &factor.source {
                Source::List(list) => list[index_of(list.len() as u64) as usize],
                Source::Range(first, last, count) => match index_of(*count) {
                    index if index + 1 == *count && *count > 1 => *last,
                    index => first + (last - first) * (index as f64 / (count - 1).max(1) as f64),
                },
                Source::Uniform([first, last], dimension) => first + (last - first) * unit(*dimension),
                Source::Normal(normal, dimension) => normal.inverse_cdf(unit(*dimension)),
                Source::Column(column) => line[*column],
            };
        }
    }
}

/// A product of numbers of runs.
fn times(a: u64, b: u64) -> Result<u64> {
    let product = a.checked_mul(b).filter(|product| *product <= MOST_RUNS);
    product.with_context(|| format!("factors: {a} x {b} runs, but at most {MOST_RUNS} are allowed; use fewer values"))
}

/// The factor that a study states under this key.
fn factor(
    key: &str,
    name: &str,
    stated: &definition::Factor,
    model: &Component,
    dimensions: &mut usize,
) -> Result<Factor> {
    let mut factor = variable(key, name, model)?;
    let real = |what: &str| match factor.kind {
        Kind::Real => Ok(()),
        _ => bail!("{key}.{what}: {name} is not a number, so it has no range; state its values in a list"),
    };
    let ends = |what: &str, [first, last]: [f64; 2]| {
        if !(last - first).is_finite() {
            bail!("{key}.{what} = [{first:?}, {last:?}]: the difference of the two numbers must be finite");
        }
        Ok([first, last])
    };
    let definition::Factor { values, range, steps, uniform, normal, bounds } = stated;
    if bounds.is_some() {
        bail!(
            "{key}.bounds: this key belongs to `optimise`; for a sweep, give one of the keys `values`, `range`, \
             `uniform` and `normal`"
        );
    }
    if steps.is_some() && range.is_none() {
        bail!("{key}.steps: this key is allowed only together with the key `range`; add `range`, or remove `steps`");
    }
    factor.source = match (values, range, uniform, normal) {
        (Some(values), None, None, None) => {
            if values.is_empty() {
                bail!("{key}.values: the list is empty; add at least one value");
            }
            let mut list = Vec::new();
            for (index, value) in values.iter().enumerate() {
                list.push(coded(value, &mut factor).with_context(|| format!("{key}.values[{index}]"))?);
            }
            Source::List(list)
        }
        (None, Some(range), None, None) => {
            real("range")?;
            let [first, last] = ends("range", *range)?;
            match steps {
                Some(count) if *count >= 1 => Source::Range(first, last, *count),
                Some(count) => bail!("{key}.steps = {count}: must be at least 1"),
                None => bail!(
                    "{key}.steps: this key is missing; add the key `steps`, the number of values of the \
                    range"
                ),
            }
        }
        (None, None, Some(uniform), None) => {
            real("uniform")?;
            let [first, last] = ends("uniform", *uniform)?;
            *dimensions += 1;
            Source::Uniform([first, last], *dimensions - 1)
        }
        (None, None, None, Some(Normal { mean, standard_deviation })) => {
            real("normal")?;
            let normal = statrs::distribution::Normal::new(*mean, *standard_deviation);
            let Some(normal) = normal.ok().filter(|_| standard_deviation.is_finite() && mean.is_finite()) else {
                let [value, mean] = [standard_deviation, mean];
                bail!(DefinitionError::value(
                    format!("{key}.normal.standard_deviation"),
                    value,
                    format!("finite and > 0, and the mean {mean} must be finite")
                ));
            };
            *dimensions += 1;
            Source::Normal(normal, *dimensions - 1)
        }
        _ => bail!("{key}: give exactly one of the keys `values`, `range`, `uniform` and `normal`"),
    };
    Ok(factor)
}

/// The factors that an optimisation varies, each with its bounds.
///
/// # Errors
/// There is no factor; a name is no number of the model; bounds are missing or not in order, or given together with
/// values.
pub fn bounded(study: &Definition, model: &Component) -> Result<Vec<(Factor, [f64; 2])>> {
    if study.points.is_some() || study.sampling.is_some() {
        bail!(
            "the keys `points` and `sampling` belong to `sweep`; remove these keys, and give each factor the key \
             `bounds`"
        );
    }
    let mut all: Vec<(Factor, [f64; 2])> = Vec::new();
    for (name, stated) in study.factors.iter() {
        let key = format!("factors.{name}");
        let factor = variable(&key, name, model)?;
        let definition::Factor { values, range, steps, uniform, normal, bounds } = stated;
        let is_other = values.is_some() || range.is_some() || steps.is_some() || uniform.is_some() || normal.is_some();
        let Some([least, largest]) = bounds.filter(|_| !is_other) else {
            bail!(
                "{key}: an optimisation varies a factor between two bounds; give only the key `bounds`, as [least, \
                largest]"
            );
        };
        if factor.kind != Kind::Real {
            bail!("{key}.bounds: {name} is not a number; set its value in `start_values`");
        }
        if !(largest > least && (largest - least).is_finite()) {
            bail!(
                "{key}.bounds = [{least:?}, {largest:?}]: the second bound must be larger than the first, and the \
                 difference must be finite"
            );
        }
        all.push((factor, [least, largest]));
    }
    if all.is_empty() {
        bail!("factors: an optimisation needs at least one factor with the key `bounds`");
    }
    Ok(all)
}
