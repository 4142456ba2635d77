//! Recorded variables without a value: rows and reasons.
//!
//! In: rows in the order of time, and the reason for each missing value. Out: a line for each reason, which names each
//! variable once. The module must not know what the values mean.

/// Rows in which one variable had no value.
#[derive(Clone, Debug, PartialEq)]
struct Gap {
    /// Time of the first such row [s].
    since: f64,
    /// Index of the first such row.
    first: u64,
    /// Number of such rows.
    count: u64,
    /// Reason for the missing value in the first such row.
    reason: String,
}

/// The gaps of all variables until now.
pub struct Missing {
    gaps: Vec<Option<Gap>>,
    /// Number of rows.
    rows: u64,
    /// Time of the last row [s].
    time: f64,
}

impl Missing {
    /// No row yet, for this number of variables.
    pub fn new(variables: usize) -> Self {
        Self { gaps: vec![None; variables], rows: 0, time: f64::NAN }
    }

    /// Add a row, whose first number is the time. A row that is read again counts once. `why` returns the reason why
    /// the variable of an index has no value. It is called for the first such row only.
    #[inline]
    pub fn see(&mut self, row: &[f64], mut why: impl FnMut(usize) -> Option<String>) {
        if row[0] == self.time {
            return;
        }
        self.time = row[0];
        for (index, _) in row[1..].iter().enumerate().filter(|(_, value)| value.is_nan()) {
            let gap = self.gaps[index].get_or_insert_with(|| {
                let reason = why(index).unwrap_or_else(|| "unknown reason".to_owned());
                Gap { since: row[0], first: self.rows, count: 0, reason }
            });
            gap.count += 1;
        }
        self.rows += 1;
    }

    /// The lines in the order of the variables. Variables with the same gap share a line.
    pub fn lines(&self, names: &[&str]) -> Vec<String> {
        let mut groups: Vec<(&Gap, Vec<&str>)> = Vec::new();
        for (gap, name) in self.gaps.iter().zip(names).filter_map(|(gap, name)| Some((gap.as_ref()?, name))) {
            match groups.iter_mut().find(|(other, _)| *other == gap) {
                Some((_, names)) => names.push(name),
                None => groups.push((gap, vec![name])),
            }
        }
        groups.iter().map(|(gap, names)| self.line(gap, &names.join(", "))).collect()
    }

    fn line(&self, gap: &Gap, names: &str) -> String {
        let Gap { since, first, count, reason } = gap;
        let rows = self.rows;
        match *count {
            1 if rows == 1 => format!("no value of {names} at {since:?} s: {reason}"),
            count if count == rows - first => {
                format!("no value of {names} from {since:?} s on (nan in {count} of {rows} rows): {reason}")
            }
            count => format!("no value of {names} in {count} of {rows} rows (first at {since:?} s): {reason}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Missing;

    #[test]
    fn a_variable_is_named_once_with_its_first_row_and_its_reason() {
        let nan = f64::NAN;
        let mut missing = Missing::new(4);
        let mut asked = Vec::new();
        for row in [[0.0, 1.0, 1.0, 1.0, 1.0], [0.5, nan, 1.0, nan, nan], [1.0, nan, 1.0, 1.0, nan], [1.0; 5]] {
            missing.see(&row, |index| {
                asked.push(index);
                Some(format!("at {} s", row[0]))
            });
        }
        assert_eq!(asked, [0, 2, 3]);
        assert_eq!(
            missing.lines(&["a", "b", "c", "d"]),
            [
                "no value of a, d from 0.5 s on (nan in 2 of 3 rows): at 0.5 s",
                "no value of c in 1 of 3 rows (first at 0.5 s): at 0.5 s",
            ]
        );
    }
}
