//! Tables as Apache Parquet, which pandas, Polars, DuckDB and MATLAB read.
//!
//! In: columns that are filled row by row. Out: row groups, so that the memory use is constant: integers as INT64,
//! numbers as DOUBLE with all bits, Booleans as BOOLEAN, texts as strings. The data are not compressed, because numbers
//! of a motion contain almost no redundancy.

use anyhow::Result;
use parquet::basic::{Compression, LogicalType, Repetition, Type};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types;
use serde_json::{Map, Value};
use std::fs::File;
use std::sync::Arc;

/// Number of values of a row group: 8 MiB.
pub const VALUES: usize = 1 << 20;

/// Size of a page [bytes], so that its buffers are reused: the memory of large ones returns to the system each time.
const PAGE: usize = 1 << 16;

/// Values of a column of the present row group.
pub enum Values {
    /// Whole numbers.
    Whole(Vec<i64>),
    /// Numbers.
    Numbers(Vec<f64>),
    /// Truth values.
    Truths(Vec<bool>),
    /// Texts.
    Texts(Vec<ByteArray>),
}

/// A table.
pub struct Table {
    file: SerializedFileWriter<File>,
    /// The columns of the present row group.
    pub columns: Vec<Values>,
}

impl Table {
    /// Start the file with these empty columns. Its metadata contain the version of the program, the units of the
    /// columns as a JSON object, and the seed of the samples if there is one.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin<'a>(
        file: File,
        columns: impl Iterator<Item = (&'a str, Values)>,
        units: Map<String, Value>,
        seed: Option<u64>,
    ) -> Result<Self> {
        let stated = [
            Some(("linkage_fmu.version", env!("CARGO_PKG_VERSION").to_owned())),
            Some(("linkage_fmu.units", Value::Object(units).to_string())),
            seed.map(|seed| ("linkage_fmu.seed", seed.to_string())),
        ];
        let metadata = stated.into_iter().flatten().map(|(key, value)| KeyValue::new(key.to_owned(), value)).collect();
        let (names, columns): (Vec<_>, Vec<_>) = columns.unzip();
        let fields = names.into_iter().zip(&columns).map(|(name, values)| {
            let (of, logical) = match values {
                Values::Whole(_) => (Type::INT64, None),
                Values::Numbers(_) => (Type::DOUBLE, None),
                Values::Truths(_) => (Type::BOOLEAN, None),
                Values::Texts(_) => (Type::BYTE_ARRAY, Some(LogicalType::String)),
            };
            let field = types::Type::primitive_type_builder(name, of).with_repetition(Repetition::REQUIRED);
            Ok(Arc::new(field.with_logical_type(logical).build()?))
        });
        let fields = fields.collect::<Result<Vec<_>>>()?;
        let schema = Arc::new(types::Type::group_type_builder("schema").with_fields(fields).build()?);
        let properties = WriterProperties::builder()
            .set_compression(Compression::UNCOMPRESSED)
            .set_dictionary_enabled(false)
            .set_statistics_enabled(EnabledStatistics::None)
            .set_data_page_size_limit(PAGE)
            .set_key_value_metadata(Some(metadata))
            .build();
        Ok(Self { file: SerializedFileWriter::new(file, schema, Arc::new(properties))?, columns })
    }

    /// Write the row group, whose columns have equal lengths, and start another one.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_group(&mut self) -> Result<()> {
        let mut group = self.file.next_row_group()?;
        let mut columns = self.columns.iter_mut();
        while let (Some(mut writer), Some(values)) = (group.next_column()?, columns.next()) {
            match values {
                Values::Whole(numbers) => {
                    writer.typed::<Int64Type>().write_batch(numbers, None, None)?;
                    numbers.clear();
                }
                Values::Numbers(numbers) => {
                    writer.typed::<DoubleType>().write_batch(numbers, None, None)?;
                    numbers.clear();
                }
                Values::Truths(truths) => {
                    writer.typed::<BoolType>().write_batch(truths, None, None)?;
                    truths.clear();
                }
                Values::Texts(texts) => {
                    writer.typed::<ByteArrayType>().write_batch(texts, None, None)?;
                    texts.clear();
                }
            }
            writer.close()?;
        }
        group.close()?;
        Ok(())
    }

    /// End the file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn end(self) -> Result<()> {
        self.file.close()?;
        Ok(())
    }
}
