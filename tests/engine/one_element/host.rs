//! A host that reads and writes a model's variables by name.
use linkage_fmu::mechanism::Model;

/// Rounding of the compared expressions and of the tables (1e-13 of each table's largest value), with up to three tables
/// multiplied and divided by one another.
pub const ACCURACY: f64 = 1e-12;

#[derive(Clone)]
pub struct Host(pub Model);

impl Host {
    pub fn new(json: &str) -> Self {
        Self(Model::from_json(json).unwrap_or_else(|e| panic!("{e}")))
    }

    /// The definition with one piece of text in place of another.
    pub fn changed(json: &str, changes: &[(&str, &str)]) -> Self {
        let mut text = json.to_string();
        for (from, to) in changes {
            assert!(text.contains(from), "no {from} in the definition");
            text = text.replace(from, to);
        }
        Self::new(&text)
    }

    pub fn get(&mut self, name: &str) -> f64 {
        let reference = self.0.variables().find(name).unwrap_or_else(|| panic!("no variable {name}"));
        self.0.real(reference).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub fn set(&mut self, name: &str, value: f64) {
        let reference = self.0.variables().find(name).unwrap_or_else(|| panic!("no variable {name}"));
        self.0.set_real(reference, value).unwrap_or_else(|e| panic!("{name}: {e}"));
    }

    pub fn set_all(&mut self, values: &[(&str, f64)]) {
        values.iter().for_each(|(name, value)| self.set(name, *value));
    }

    /// Put the stated body or joint at a position with a speed.
    pub fn place(&mut self, position: (&str, f64), speed: (&str, f64)) {
        self.set(position.0, position.1);
        self.set(speed.0, speed.1);
        self.0.initialize().unwrap_or_else(|e| panic!("{position:?}, {speed:?}: {e}"));
    }

    pub fn step(&mut self, h: f64) {
        self.0.step(h).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Largest difference seen, relative to the size of the compared quantity.
#[derive(Default)]
pub struct Worst(Vec<(&'static str, f64)>);

impl Worst {
    /// `size`: the largest of the terms that make up the quantity, where they may cancel.
    pub fn compare(&mut self, what: &'static str, actual: f64, expected: f64, size: f64) {
        let error = (actual - expected).abs() / size.abs().max(expected.abs());
        let error = if actual == expected { 0.0 } else { error };
        match self.0.iter_mut().find(|(name, _)| *name == what) {
            Some((_, worst)) => *worst = if error.is_nan() { f64::NAN } else { worst.max(error) },
            None => self.0.push((what, error)),
        }
    }

    pub fn print(&self) {
        self.0.iter().for_each(|(what, worst)| println!("{what}: {worst:.1e}"));
    }

    pub fn assert_within(&self, allowed: f64) {
        for (what, worst) in &self.0 {
            assert!(*worst <= allowed, "{what}: relative difference {worst:e}, allowed {allowed:e}");
        }
    }
}
