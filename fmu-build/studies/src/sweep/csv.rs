//! The results of a study as CSV. Every number has the fewest digits from which it can be read back.

use super::chunk::Rows;
use super::table::{Column, Content, Format, OWN};
use anyhow::Result;
use fmu_build::run::csv::decimal;
use std::fs::File;
use std::io::BufWriter;

/// The file.
pub struct Csv {
    file: csv::Writer<BufWriter<File>>,
    contents: Vec<Content>,
}

impl Format for Csv {
    fn begin(file: File, columns: &[Column], _: Option<u64>) -> Result<Self> {
        let mut file = csv::Writer::from_writer(BufWriter::new(file));
        let [run, failed, message] = OWN;
        let names = columns.iter().map(|column| column.name.as_str());
        file.write_record(std::iter::once(run).chain(names).chain([failed, message]))?;
        Ok(Self { file, contents: columns.iter().map(|column| column.content.clone()).collect() })
    }

    fn add(&mut self, rows: &Rows) -> Result<()> {
        let mut digits = zmij::Buffer::new();
        let values = rows.values.chunks_exact(self.contents.len());
        for ((run, values), remark) in rows.runs.clone().zip(values).zip(rows.remark_of_each()) {
            self.file.write_field(run.to_string())?;
            for (value, content) in values.iter().zip(&self.contents) {
                match content {
                    Content::Number => self.file.write_field(decimal(&mut digits, *value))?,
                    Content::Truth => self.file.write_field(if *value == 0.0 { "0" } else { "1" })?,
                    Content::Text(texts) => self.file.write_field(&texts[*value as usize])?,
                }
            }
            self.file.write_record([if remark.is_failure { "1" } else { "0" }, remark.text])?;
        }
        Ok(())
    }

    fn end(mut self) -> Result<()> {
        Ok(self.file.flush()?)
    }
}
