//! The results of a study as Apache Parquet: the number of the run as INT64, numbers as DOUBLE with all their bits, truth
//! values as BOOLEAN, texts as strings; row groups of constant size, plain and not compressed.

use super::chunk::Remark;
use super::results::{Column, Content, Format, OWN};
use anyhow::Result;
use parquet::basic::{Compression, LogicalType, Repetition, Type};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types;
use std::fs::File;
use std::sync::Arc;

/// Values of a row group.
const VALUES: usize = 1 << 20;
/// Most rows of a row group, as a remark may be long.
const MOST_ROWS: usize = 1 << 16;

/// Values of a column of the row group that is being filled.
enum Values {
    Runs(Vec<i64>),
    Numbers(Vec<f64>),
    Truths(Vec<bool>),
    Texts(Vec<ByteArray>),
}

/// The file.
pub struct Parquet {
    file: SerializedFileWriter<File>,
    contents: Vec<Content>,
    /// The run, the columns, whether the run failed, the remark.
    group: Vec<Values>,
    rows: usize,
    most_rows: usize,
}

impl Format for Parquet {
    fn begin(file: File, columns: &[Column]) -> Result<Self> {
        let [run, failed, message] = OWN;
        let own = columns.iter().map(|column| (column.name.as_str(), Values::of(&column.content)));
        let mut all = vec![(run, Values::Runs(Vec::new()))];
        all.extend(own);
        all.extend([(failed, Values::Truths(Vec::new())), (message, Values::Texts(Vec::new()))]);
        let fields = all.iter().map(|(name, values)| {
            let (of, logical) = match values {
                Values::Runs(_) => (Type::INT64, None),
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
            .build();
        let file = SerializedFileWriter::new(file, schema, Arc::new(properties))?;
        let contents = columns.iter().map(|column| column.content.clone()).collect();
        let most_rows = (VALUES / all.len()).clamp(1, MOST_ROWS);
        Ok(Self { file, contents, group: all.into_iter().map(|(_, values)| values).collect(), rows: 0, most_rows })
    }

    fn add(&mut self, run: u64, values: &[f64], remark: Remark) -> Result<()> {
        let texts = self.contents.iter().zip(values).map(|(content, value)| match content {
            Content::Text(texts) => texts[*value as usize].as_str(),
            _ => "",
        });
        let numbers = std::iter::once(run as f64).chain(values.iter().copied());
        let numbers = numbers.chain([f64::from(u8::from(remark.is_failure)), 0.0]);
        let texts = std::iter::once("").chain(texts).chain(["", remark.text]);
        for ((column, number), text) in self.group.iter_mut().zip(numbers).zip(texts) {
            match column {
                Values::Runs(runs) => runs.push(number as i64),
                Values::Numbers(numbers) => numbers.push(number),
                Values::Truths(truths) => truths.push(number != 0.0),
                Values::Texts(all) => all.push(text.into()),
            }
        }
        self.rows += 1;
        if self.rows == self.most_rows { self.write_group() } else { Ok(()) }
    }

    fn end(mut self) -> Result<()> {
        if self.rows > 0 {
            self.write_group()?;
        }
        self.file.close()?;
        Ok(())
    }
}

impl Values {
    fn of(content: &Content) -> Self {
        match content {
            Content::Number => Self::Numbers(Vec::new()),
            Content::Truth => Self::Truths(Vec::new()),
            Content::Text(_) => Self::Texts(Vec::new()),
        }
    }
}

impl Parquet {
    /// Write the row group and begin another.
    fn write_group(&mut self) -> Result<()> {
        let mut group = self.file.next_row_group()?;
        let mut columns = self.group.iter_mut();
        while let (Some(mut writer), Some(values)) = (group.next_column()?, columns.next()) {
            match values {
                Values::Runs(runs) => {
                    writer.typed::<Int64Type>().write_batch(runs, None, None)?;
                    runs.clear();
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
        self.rows = 0;
        Ok(())
    }
}
