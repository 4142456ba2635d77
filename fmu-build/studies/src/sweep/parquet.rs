//! The results of a study as Apache Parquet: the number of the run, the columns, whether it failed, the remark.

use super::chunk::Remark;
use super::table::{Column, Content, Format, OWN};
use crate::parquet_file::{Table, VALUES, Values};
use anyhow::Result;
use std::fs::File;

/// Largest number of rows of a row group, because a remark may be long.
const MOST_ROWS: usize = 1 << 16;

/// The file.
pub struct Parquet {
    table: Table,
    contents: Vec<Content>,
    rows: usize,
    most_rows: usize,
}

impl Format for Parquet {
    fn begin(file: File, columns: &[Column], seed: Option<u64>) -> Result<Self> {
        let [run, failed, message] = OWN;
        let of = |content: &Content| match content {
            Content::Number => Values::Numbers(Vec::new()),
            Content::Truth => Values::Truths(Vec::new()),
            Content::Text(_) => Values::Texts(Vec::new()),
        };
        let own = columns.iter().map(|column| (column.name.as_str(), of(&column.content)));
        let all = std::iter::once((run, Values::Whole(Vec::new()))).chain(own);
        let all = all.chain([(failed, Values::Truths(Vec::new())), (message, Values::Texts(Vec::new()))]);
        let with_unit = columns.iter().filter(|column| !column.unit.is_empty());
        let units = with_unit.map(|column| (column.name.clone(), column.unit.clone().into())).collect();
        let table = Table::begin(file, all, units, seed)?;
        let contents = columns.iter().map(|column| column.content.clone()).collect();
        let most_rows = (VALUES / table.columns.len()).clamp(1, MOST_ROWS);
        Ok(Self { table, contents, rows: 0, most_rows })
    }

    fn add(&mut self, run: u64, values: &[f64], remark: Remark) -> Result<()> {
        let [first, own @ .., failed, message] = &mut self.table.columns[..] else { return Ok(()) };
        put(first, run as f64, "");
        for ((column, content), value) in own.iter_mut().zip(&self.contents).zip(values) {
            put(column, *value, if let Content::Text(texts) = content { &texts[*value as usize] } else { "" });
        }
        put(failed, f64::from(u8::from(remark.is_failure)), "");
        put(message, 0.0, remark.text);
        self.rows += 1;
        if self.rows == self.most_rows { self.write_group() } else { Ok(()) }
    }

    fn end(mut self) -> Result<()> {
        if self.rows > 0 {
            self.write_group()?;
        }
        self.table.end()
    }
}

/// Add a value to a column: the number, or the text with this index.
#[inline]
fn put(column: &mut Values, number: f64, text: &str) {
    match column {
        Values::Whole(runs) => runs.push(number as i64),
        Values::Numbers(numbers) => numbers.push(number),
        Values::Truths(truths) => truths.push(number != 0.0),
        // Most texts equal that of the previous row, and share its bytes.
        Values::Texts(all) => all.push(match all.last().filter(|last| last.data() == text.as_bytes()) {
            Some(last) => last.clone(),
            None => text.into(),
        }),
    }
}

impl Parquet {
    fn write_group(&mut self) -> Result<()> {
        self.rows = 0;
        self.table.write_group()
    }
}
