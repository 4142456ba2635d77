//! A table as Apache Parquet, which pandas, Polars, DuckDB and MATLAB read.
//!
//! In: rows. Out: row groups of constant size, so that memory stays constant: the column `time` and Reals as DOUBLE with
//! all their bits, Booleans as BOOLEAN. Plain and not compressed: numbers of a motion hold hardly a bit too much.

use super::file::Format;
use super::table::Column;
use anyhow::Result;
use parquet::basic::{Compression, Repetition, Type};
use parquet::data_type::{BoolType, DoubleType};
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types;
use std::fs::File;
use std::sync::Arc;

/// Values of a row group: 8 MiB.
const VALUES: usize = 1 << 20;

/// The file.
pub struct Parquet {
    file: SerializedFileWriter<File>,
    /// Of each column whether it is true or false; the time first.
    booleans: Vec<bool>,
    /// Columns of the row group that is being filled.
    columns: Vec<Vec<f64>>,
}

impl Format for Parquet {
    fn begin(file: File, columns: &[Column]) -> Result<Self> {
        let names = std::iter::once("time").chain(columns.iter().map(|column| &*column.name));
        let booleans: Vec<bool> =
            std::iter::once(false).chain(columns.iter().map(|column| column.is_boolean)).collect();
        let fields = names.zip(&booleans).map(|(name, is_boolean)| {
            let of = if *is_boolean { Type::BOOLEAN } else { Type::DOUBLE };
            let field = types::Type::primitive_type_builder(name, of).with_repetition(Repetition::REQUIRED);
            Ok(Arc::new(field.build()?))
        });
        let fields = fields.collect::<Result<Vec<_>>>()?;
        let schema = Arc::new(types::Type::group_type_builder("schema").with_fields(fields).build()?);
        let properties = WriterProperties::builder()
            .set_compression(Compression::UNCOMPRESSED)
            .set_dictionary_enabled(false)
            .set_statistics_enabled(EnabledStatistics::None)
            .build();
        let columns = vec![Vec::with_capacity(VALUES / booleans.len()); booleans.len()];
        Ok(Self { file: SerializedFileWriter::new(file, schema, Arc::new(properties))?, booleans, columns })
    }

    fn write(&mut self, rows: &[f64]) -> Result<()> {
        for row in rows.chunks_exact(self.columns.len()) {
            self.columns.iter_mut().zip(row).for_each(|(column, value)| column.push(*value));
        }
        if self.columns.len() * self.columns[0].len() >= VALUES { self.write_group() } else { Ok(()) }
    }

    fn end(mut self) -> Result<()> {
        if !self.columns[0].is_empty() {
            self.write_group()?;
        }
        self.file.close()?;
        Ok(())
    }
}

impl Parquet {
    /// Write the row group and begin another.
    fn write_group(&mut self) -> Result<()> {
        let mut group = self.file.next_row_group()?;
        let mut columns = self.columns.iter().zip(&self.booleans);
        while let (Some(mut writer), Some((values, is_boolean))) = (group.next_column()?, columns.next()) {
            match is_boolean {
                true => {
                    let values: Vec<bool> = values.iter().map(|value| *value != 0.0).collect();
                    writer.typed::<BoolType>().write_batch(&values, None, None)?;
                }
                false => {
                    writer.typed::<DoubleType>().write_batch(values, None, None)?;
                }
            }
            writer.close()?;
        }
        group.close()?;
        self.columns.iter_mut().for_each(Vec::clear);
        Ok(())
    }
}
