//! The points of a study in a file: a column for each factor, a line for each point.
//!
//! In: a CSV file. Out: the values of any line. The file is read once and checked. Later, blocks of lines are read when
//! needed, so that the memory use is constant. If the file changes meanwhile, a line that cannot be read again gives
//! NaN, which every model rejects.

use super::definition::Setting;
use super::factor::{Factor, coded, variable};
use anyhow::{Context, Result, bail};
use fmu_build::csv_file;
use fmu_build::start_values::truth;
use linkage_fmu::component::Component;
use linkage_fmu::variables::Kind;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of lines of a block.
const LINES: u64 = 1024;

/// The file with its properties.
#[derive(Debug)]
pub struct Points {
    path: PathBuf,
    /// The factors, in the order of the columns.
    factors: Arc<Vec<Factor>>,
    /// Start of each block.
    blocks: Arc<Vec<csv::Position>>,
    lines: u64,
    /// The file, after it was opened again.
    reader: Option<csv::Reader<File>>,
    /// The last block that was read, and its values line by line.
    block: Option<u64>,
    values: Vec<f64>,
}

impl Clone for Points {
    fn clone(&self) -> Self {
        let (path, factors, blocks) = (self.path.clone(), Arc::clone(&self.factors), Arc::clone(&self.blocks));
        Self { path, factors, blocks, lines: self.lines, reader: None, block: None, values: Vec::new() }
    }
}

impl Points {
    /// The points of a file for this model.
    ///
    /// # Errors
    /// The file cannot be read; a column is no factor, or duplicate; a value is invalid; there is no line.
    pub fn read(path: &Path, model: &Component) -> Result<Self> {
        let shown = path.display();
        let (mut reader, names) = csv_file::open(path)?;
        let mut factors: Vec<Factor> = Vec::new();
        for name in &names {
            let factor = variable(&format!("{shown}"), name, model)?;
            if factors.iter().any(|other| other.reference == factor.reference) {
                bail!("{shown}: {name} occurs twice; remove one column");
            }
            factors.push(factor);
        }
        let (mut blocks, mut lines, mut record) = (Vec::new(), 0, csv::StringRecord::new());
        loop {
            let position = reader.position().clone();
            if !reader.read_record(&mut record).with_context(|| format!("{shown}"))? {
                break;
            }
            if lines % LINES == 0 {
                blocks.push(position);
            }
            for (text, factor) in record.iter().zip(&mut factors) {
                value(text, factor).with_context(|| format!("{shown}, line {}, {}", lines + 2, factor.name))?;
            }
            lines += 1;
        }
        if lines == 0 {
            bail!("{shown}: the file contains no line of values");
        }
        let (factors, blocks) = (Arc::new(factors), Arc::new(blocks));
        Ok(Self { path: path.to_path_buf(), factors, blocks, lines, reader: None, block: None, values: Vec::new() })
    }

    /// The factors, in the order of the columns.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// Number of points.
    pub fn lines(&self) -> u64 {
        self.lines
    }

    /// The values of a line, from 0.
    pub fn line(&mut self, line: u64) -> &[f64] {
        let (width, block) = (self.factors.len(), line / LINES);
        if self.block != Some(block) {
            let wanted = LINES.min(self.lines - block * LINES) as usize * width;
            let read = self.read_block(block, wanted);
            if read.is_err() || self.values.len() != wanted {
                self.values.clear();
                self.values.resize(wanted, f64::NAN);
            }
            self.block = Some(block);
        }
        &self.values[(line % LINES) as usize * width..][..width]
    }

    fn read_block(&mut self, block: u64, wanted: usize) -> Result<()> {
        self.values.clear();
        let reader = match &mut self.reader {
            Some(reader) => reader,
            none => none.insert(csv_file::open(&self.path)?.0),
        };
        reader.seek(self.blocks[block as usize].clone())?;
        let mut record = csv::StringRecord::new();
        // All texts are known at this point.
        let mut factors = self.factors.as_ref().clone();
        while self.values.len() < wanted && reader.read_record(&mut record)? {
            for (text, factor) in record.iter().zip(&mut factors) {
                let known = factor.texts.len();
                let value = value(text, factor)?;
                self.values.push(if factor.texts.len() == known { value } else { f64::NAN });
            }
        }
        Ok(())
    }
}

/// A cell as a number.
fn value(text: &str, factor: &mut Factor) -> Result<f64> {
    let setting = match factor.kind {
        Kind::Real => {
            let number = text.parse().ok();
            let number = number
                .with_context(|| format!("\"{}\" is not a number; write decimals with a point", text.escape_debug()))?;
            return Ok(number);
        }
        Kind::Boolean => Setting::Boolean(truth(text)?),
        Kind::Enumeration => Setting::Text(text.to_owned()),
    };
    coded(&setting, factor)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use std::fs;

    const GEAR: &str = include_str!("../../../../modelDescription/LandingGearRetraction/resources/mechanism.json");

    #[test]
    fn any_line_is_found_in_any_order() {
        let path = std::env::temp_dir().join(format!("fmu-build-points-{}.csv", std::process::id()));
        let methods = ["reduced", "rigid_fem", "\"a, b\""];
        let lines = (0..5000_u32).map(|k| format!("{k}.25,{}, {}\r\n", methods[k as usize % 3], k % 2 == 1));
        let text = "\u{feff}crank.mass,solver.method,friction.enabled\r\n".to_owned() + &lines.collect::<String>();
        fs::write(&path, text).unwrap();
        let gear = Component::from_definition("mechanism.json", GEAR).unwrap();
        let mut points = Points::read(&path, &gear).unwrap();
        assert_eq!((points.lines(), &*points.factors()[1].texts[2]), (5000, "a, b"));
        let mut other = points.clone();
        for k in 0..5000_u64 {
            let line = k * 1237 % 5000;
            let expected = [line as f64 + 0.25, (line % 3) as f64, (line % 2) as f64];
            assert_eq!(points.line(line), expected);
            assert_eq!(other.line(4999 - k)[0], (4999 - k) as f64 + 0.25);
        }
        // A changed file gives no value that a model accepts.
        fs::write(&path, "crank.mass,solver.method,friction.enabled\n1,reduced,false\n").unwrap();
        assert!(points.clone().line(3000)[0].is_nan());
        fs::remove_file(&path).unwrap();
    }
}
