//! Recorded time series of a run.

/// Recorded values of variables over a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    pub(super) names: Vec<String>,
    pub(super) times: Vec<f64>,
    pub(super) columns: Vec<Vec<f64>>,
}

impl Trace {
    /// Names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Time of each row [s].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Values of the variable with this name, one for each time. None if the variable was not recorded.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let index = self.names.iter().position(|own| own == name)?;
        Some(&self.columns[index])
    }
}
