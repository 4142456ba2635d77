//! The results of a study as Apache Parquet: the number of the run, the columns, whether it failed, the remark.

use super::chunk::Rows;
use super::table::{Column, Content, Format, OWN};
use crate::parquet_file::{Table, VALUES, Values};
use anyhow::Result;
use parquet::data_type::ByteArray;
use std::fs::File;

/// Number of rows after which a row group is written, because a remark may be long.
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

    fn add(&mut self, rows: &Rows) -> Result<()> {
        let [run, own @ .., failed, message] = &mut self.table.columns[..] else { return Ok(()) };
        if let (Values::Whole(runs), Values::Truths(failures), Values::Texts(messages)) = (run, failed, message) {
            runs.extend(rows.runs.clone().map(|run| run as i64));
            failures.extend(rows.remark_of_each().map(|remark| remark.is_failure));
            rows.remark_of_each().for_each(|remark| put(messages, remark.text));
        }
        for ((column, content), k) in own.iter_mut().zip(&self.contents).zip(0..) {
            let numbers = rows.values.chunks_exact(self.contents.len()).map(|row| row[k]);
            match (column, content) {
                (Values::Numbers(all), _) => all.extend(numbers),
                (Values::Truths(all), _) => all.extend(numbers.map(|number| number != 0.0)),
                (Values::Texts(all), Content::Text(texts)) => {
                    numbers.for_each(|index| put(all, &texts[index as usize]));
                }
                _ => {}
            }
        }
        self.rows += (rows.runs.end - rows.runs.start) as usize;
        if self.rows >= self.most_rows { self.write_group() } else { Ok(()) }
    }

    fn end(mut self) -> Result<()> {
        if self.rows > 0 {
            self.write_group()?;
        }
        self.table.end()
    }
}

/// Add a text to a column. Most texts equal that of the previous row, and share its bytes.
#[inline]
fn put(texts: &mut Vec<ByteArray>, text: &str) {
    // Two empty texts are not compared by their addresses: with AVX-512, reading no bytes there needs 0.1 us.
    let is_equal = |last: &&ByteArray| (last.is_empty() && text.is_empty()) || last.data() == text.as_bytes();
    texts.push(match texts.last().filter(is_equal) {
        Some(last) => last.clone(),
        None => text.into(),
    });
}

impl Parquet {
    fn write_group(&mut self) -> Result<()> {
        self.rows = 0;
        self.table.write_group()
    }
}
