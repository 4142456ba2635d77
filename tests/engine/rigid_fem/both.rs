//! A mechanism in both formulations.
use crate::support::Run;
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::linkage::Linkage;
use linkage_fmu::mechanism::reactions::Reaction;
use linkage_fmu::mechanism::rigid_fem::{RigidFem, RigidFemError, Scratch, State};

/// E A of the bodies [N]. Gear: E = 2.1e11 Pa and A of PHYSICS. Other mechanisms: 1e9 N.
fn stiffness(linkage: &Linkage, body: usize) -> f64 {
    let area = match linkage.bodies[body].name.as_str() {
        "crank" => 1e-2,
        "coupler" => 4.256e-4,
        "follower" => 1.452e-3,
        _ => return 1e9,
    };
    2.1e11 * area
}

/// Present sizes of all loads.
fn sizes(run: &mut Run) -> Vec<f64> {
    let reduced = run.reduced().unwrap().clone();
    let inputs: Vec<f64> = reduced.loading().inputs.iter().map(|name| run.get(name)).collect();
    reduced.sizes(&inputs)
}

/// A mechanism in both formulations.
pub struct Both {
    run: Run,
    linkage: Linkage,
    pub fem: RigidFem,
    pub state: State,
    pub scratch: Scratch,
    pub sizes: Vec<f64>,
    h_fem: f64,
    pub lost: f64,
}

impl Both {
    /// E A is multiplied by `factor`. The start has the static strain if `stretched`, else no strain.
    pub fn started(text: &str, factor: f64, h_fem: f64, stretched: bool) -> Self {
        let mechanism = Mechanism::from_json(text).unwrap();
        let mut run = Run::new(text).with(&[("solver.tolerance", 1e-13)]).started();
        let reduced = run.reduced().unwrap().clone();
        let linkage = reduced.linkage().clone();
        let fem = RigidFem::new(&linkage, reduced.loading(), &|body| factor * stiffness(&linkage, body)).unwrap();
        let start = &mechanism.start;
        let body = start.body.as_deref().unwrap();
        let coordinate = linkage.bodies[linkage.carrier(&mechanism, body).unwrap().0].angle_coordinate.unwrap();
        let (sigma, revolutions) = reduced.find(coordinate, start.angle.unwrap(), body).unwrap();
        let c = reduced.curve().configuration(sigma);
        let q: Vec<f64> = c.q.iter().enumerate().map(|(i, q)| q + revolutions * reduced.curve().growth(i)).collect();
        let q_dot: Vec<f64> = c.q_sigma.iter().map(|slope| slope * start.speed / c.q_sigma[coordinate]).collect();
        let (mut scratch, sizes) = (fem.scratch(), sizes(&mut run));
        let state = if stretched {
            fem.start(&linkage, &q, &q_dot, &sizes).unwrap()
        } else {
            let mut state = fem.unstretched(&linkage, &q, &q_dot);
            fem.rebalance(&mut state, &mut scratch, &sizes, 1e-8).unwrap();
            state
        };
        Self { run, linkage, fem, state, scratch, sizes, h_fem, lost: 0.0 }
    }

    pub fn new(text: &str, factor: f64, h_fem: f64) -> Self {
        Self::started(text, factor, h_fem, true)
    }

    /// A communication step of the finite elements only.
    pub fn fem_step(&mut self, h: f64) -> Result<(), RigidFemError> {
        self.lost += self.fem.advance(&mut self.state, &mut self.scratch, &self.sizes, h, self.h_fem)?;
        Ok(())
    }

    /// A communication step of both formulations.
    pub fn step(&mut self, h: f64) {
        self.fem_step(h).unwrap();
        self.run.step(h);
    }

    pub fn get(&mut self, name: &str) -> f64 {
        self.run.get(name)
    }

    pub fn steps(&mut self, count: u32, h: f64) {
        (0..count).for_each(|_| self.step(h));
    }

    /// Set inputs of both formulations.
    pub fn set(&mut self, values: &[(&str, f64)]) {
        self.run.set_all(values);
        self.sizes = sizes(&mut self.run);
        self.fem.rebalance(&mut self.state, &mut self.scratch, &self.sizes, self.h_fem).unwrap();
    }

    pub fn body(&self, name: &str) -> usize {
        self.linkage.bodies.iter().position(|b| b.name == name).unwrap()
    }

    pub fn crank(&self) -> f64 {
        self.fem.angle(&self.state, self.body("crank"), 0)
    }

    pub fn energy(&self) -> f64 {
        self.fem.energy(&self.state, &self.sizes)
    }

    fn reactions(&mut self) -> Vec<Reaction> {
        let mut out = vec![Reaction::default(); self.linkage.joints.len()];
        self.fem.reactions(&self.state, &self.state, &mut self.scratch, &self.sizes, 0.0, &mut out);
        out
    }

    /// Largest difference of forces over these steps, relative to the largest force.
    pub fn largest_share(&mut self, count: u32, h: f64) -> f64 {
        (0..count).fold(0.0, |worst: f64, _| {
            self.step(h);
            let largest = self.reactions().iter().map(|r| r.force.norm()).fold(0.0, f64::max);
            worst.max(self.differences()[3] / largest)
        })
    }

    /// Largest difference of angle [rad], speed [rad/s] and acceleration [rad/s2] over all bodies, and of forces [N].
    pub fn differences(&mut self) -> [f64; 4] {
        let mut worst = [0.0f64; 4];
        for body in 1..self.linkage.bodies.len() {
            let (fem, state, name) = (&self.fem, &self.state, self.linkage.bodies[body].name.clone());
            let own = [0, 1, 2].map(|order| fem.angle(state, body, order));
            for (k, quantity) in ["angle", "speed", "acceleration"].into_iter().enumerate() {
                worst[k] = worst[k].max((own[k] - self.get(&format!("{name}.{quantity}"))).abs());
            }
        }
        for (joint, reaction) in self.reactions().iter().enumerate() {
            let name = self.linkage.joints[joint].name.clone();
            let (x, y) = (self.get(&format!("{name}.force_x")), self.get(&format!("{name}.force_y")));
            worst[3] = worst[3].max((reaction.force.x - x).hypot(reaction.force.y - y));
        }
        worst
    }
}
