//! Published benchmark mechanisms against values that two independent formulations gave in 32 and more digits.

mod andrews;
mod chain;
mod slcrank;

use linkage_fmu::mechanism::Model;

/// A mechanism under test.
struct StateLoads(Model);

impl StateLoads {
    /// At its start, to be integrated with this tolerance.
    fn new(text: &str, tolerance: f64) -> Self {
        let mut model = Model::from_json(text).unwrap();
        model.set_tolerance(tolerance).unwrap();
        model.initialize().unwrap();
        Self(model)
    }

    fn get(&mut self, name: &str) -> f64 {
        let reference = self.0.variables().find(name).unwrap_or_else(|| panic!("no variable {name}"));
        self.0.real(reference).unwrap()
    }

    fn step(&mut self, h: f64) {
        self.0.step(h).unwrap();
    }

    /// Check a variable, to an absolute allowance.
    fn check(&mut self, name: &str, exact: f64, allowed: f64) {
        let value = self.get(name);
        close(name, value, exact, allowed);
    }
}

fn close(what: &str, value: f64, exact: f64, allowed: f64) {
    let error = (value - exact).abs();
    println!("{what}: {value:.15e}, error {error:.1e}, allowed {allowed:.1e}");
    assert!(error <= allowed, "{what} = {value:e}, not {exact:e}: error {error:.2e}, allowed {allowed:.2e}");
}
