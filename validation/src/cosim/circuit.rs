//! The hydraulic circuit in plain numbers, implemented from its laws: a second formulation, independent of the engine.
//!
//! In: pressures, spool, length and speed. Out: their rates, flows and force. Sources: Merritt, Hydraulic Control
//! Systems; Jelali and Kroll, Hydraulic Servo-systems; Modelica.Fluid.Utilities.regRoot.
use std::f64::consts::PI;

/// The numbers of a circuit: field, name in the FMU, value in scenes H0 and H1.
macro_rules! numbers {
    ({ $($one:ident $name:literal $value:literal;)* } { $($two:ident $a:literal $b:literal $values:expr;)* }) => {
        /// Numbers of a circuit with a 4/3 valve and a differential cylinder, all in SI units; pressures are gauge.
        #[derive(Clone, Debug)]
        #[expect(missing_docs, reason = "the names are those of the FMU's parameters")]
        pub struct Circuit {
            $(pub $one: f64,)*
            $(pub $two: [f64; 2],)*
            /// Command before ramp and sine are added.
            pub command: f64,
        }

        impl Circuit {
            /// Circuit of scenes H0 and H1, with the valve closed.
            pub fn standard() -> Self {
                Self { $($one: $value,)* $($two: $values,)* command: 0.0 }
            }

            /// A parameter by its name.
            pub fn parameter(&mut self, name: &str) -> Option<&mut f64> {
                match name {
                    $($name => Some(&mut self.$one),)*
                    $($a => Some(&mut self.$two[0]), $b => Some(&mut self.$two[1]),)*
                    _ => None,
                }
            }
        }
    };
}

numbers! {{
    supply_pressure "supply.pressure" 20.7e6;
    tank_pressure "tank.pressure" 0.35e6;
    ambient_pressure "fluid.ambient_pressure" 101_325.0;
    bulk_modulus "fluid.bulk_modulus" 1.4e9;
    air_fraction "fluid.air_fraction" 0.005;
    polytropic_exponent "fluid.polytropic_exponent" 1.4;
    bore "cylinder.bore" 0.045;
    rod "cylinder.rod" 0.025;
    stroke "cylinder.stroke" 0.330;
    closed_length "cylinder.closed_length" 0.412;
    rated_flow "valve.rated_flow" 1e-4;
    rated_pressure_drop "valve.rated_pressure_drop" 3.5e6;
    transition_pressure "valve.transition_pressure" 1e5;
    clearance "valve.clearance" 2e-3;
    overlap "valve.overlap" 0.0;
    frequency "valve.frequency" 60.0;
    damping_ratio "valve.damping_ratio" 0.8;
    check_pressure "check.pressure" 5e4;
    relief_pressure "relief.pressure" 28e6;
    relief_width "relief.width" 1e5;
    relief_conductance "relief.conductance" 1e-10;
    anticavitation_conductance "anticavitation.conductance" 1e-10;
    leakage_internal "leakage.internal" 2e-13;
    coulomb "seal.coulomb" 250.0;
    static_friction "seal.static" 400.0;
    stribeck_speed "seal.stribeck_speed" 0.02;
    transition_speed "seal.transition_speed" 0.005;
    viscous "seal.viscous" 500.0;
} {
    dead_volumes "chamber_a.dead_volume" "chamber_b.dead_volume" [6e-5; 2];
    restrictors "restrictor_a.rated_flow" "restrictor_b.rated_flow" [5e-5, 0.0];
    cushion_lengths "cushion_a.length" "cushion_b.length" [0.030; 2];
    cushions "cushion_a.rated_flow" "cushion_b.rated_flow" [1.2e-5; 2];
    leakage_external "leakage.external_a" "leakage.external_b" [0.0, 5e-14];
    ramp "command.ramp_amplitude" "command.ramp_time" [0.0; 2];
    sine "command.sine_amplitude" "command.sine_frequency" [0.0; 2];
}}

/// Pressures of chambers A and B [Pa], spool position [1] and speed [1/s].
pub type State = [f64; 4];

fn soft(x: f64, w: f64) -> f64 {
    0.5 * (x + x.hypot(w))
}

fn gate(x: f64, w: f64) -> f64 {
    0.5 * (1.0 + x / x.hypot(w))
}

impl Circuit {
    /// Areas of the piston and rod side [m2].
    pub fn areas(&self) -> [f64; 2] {
        let piston = 0.25 * PI * self.bore * self.bore;
        [piston, piston - 0.25 * PI * self.rod * self.rod]
    }

    /// Effective bulk modulus at a pressure [Pa].
    pub fn bulk(&self, p: f64) -> f64 {
        let (absolute, n) = (p + self.ambient_pressure, self.polytropic_exponent);
        let r = self.air_fraction * (self.ambient_pressure / absolute).powf(1.0 / n);
        self.bulk_modulus * (1.0 + r) / (1.0 + r * self.bulk_modulus / (n * absolute))
    }

    /// Command at the time t [s].
    fn command(&self, t: f64) -> f64 {
        let [amplitude, time] = self.ramp;
        let ramp = amplitude * if time > 0.0 { (t / time).clamp(0.0, 1.0) } else { 1.0 };
        (self.command + ramp + self.sine[0] * (2.0 * PI * self.sine[1] * t).sin()).clamp(-1.0, 1.0)
    }

    /// Flow into a chamber at the pressure p from a port, through an orifice of this opening and a resistance to
    /// outflow.
    fn path(&self, port: f64, p: f64, opening: f64, resistance: f64) -> f64 {
        let d = port - p;
        let root = d / (d * d + self.transition_pressure.powi(2)).powf(0.25);
        let k = self.rated_flow / self.rated_pressure_drop.sqrt() * opening;
        root / (1.0 / (k * k) + resistance * gate(-d, self.check_pressure)).sqrt()
    }

    /// Flows into the chambers at the length s [m3/s].
    pub fn flows(&self, s: f64, [p_a, p_b, y, _]: &State) -> [f64; 2] {
        let (p_a, p_b) = (*p_a, *p_b);
        let x = s - self.closed_length;
        let plus = soft(y - self.overlap, self.clearance);
        let minus = soft(-y - self.overlap, self.clearance);
        let square = |flow: f64| if flow > 0.0 { self.rated_pressure_drop / (flow * flow) } else { 0.0 };
        let resistance = |chamber: usize, e: f64| {
            let length = self.cushion_lengths[chamber];
            let share = if length > 0.0 { (1.0 - e / length).max(0.0).powi(3) } else { 0.0 };
            square(self.restrictors[chamber]) + square(self.cushions[chamber]) * share
        };
        let [r_a, r_b] = [resistance(0, x), resistance(1, self.stroke - x)];
        let (supply, tank) = (self.supply_pressure, self.tank_pressure);
        let valve = [
            self.path(supply, p_a, plus, r_a) + self.path(tank, p_a, minus, r_a),
            self.path(supply, p_b, minus, r_b) + self.path(tank, p_b, plus, r_b),
        ];
        let leak = self.leakage_internal * (p_a - p_b);
        let ports = |p: f64, external: f64| {
            self.anticavitation_conductance * soft(tank - p, self.relief_width)
                - self.relief_conductance * soft(p - self.relief_pressure, self.relief_width)
                - external * p
        };
        [valve[0] + ports(p_a, self.leakage_external[0]) - leak, valve[1] + ports(p_b, self.leakage_external[1]) + leak]
    }

    /// Volumes of the chambers at the length s [m3].
    fn volumes(&self, s: f64) -> [f64; 2] {
        let ([a, b], x) = (self.areas(), s - self.closed_length);
        [self.dead_volumes[0] + a * x, self.dead_volumes[1] + b * (self.stroke - x)]
    }

    /// Rates of the state at the time t [s], with the length s [m] and the speed v [m/s].
    pub fn rates(&self, t: f64, s: f64, v: f64, state: &State) -> State {
        let [p_a, p_b, y, w] = *state;
        let ([a, b], [q_a, q_b], [v_a, v_b]) = (self.areas(), self.flows(s, state), self.volumes(s));
        let omega = 2.0 * PI * self.frequency;
        [
            self.bulk(p_a) / v_a * (q_a - a * v),
            self.bulk(p_b) / v_b * (q_b + b * v),
            w,
            omega * (omega * (self.command(t) - y) - 2.0 * self.damping_ratio * w),
        ]
    }

    /// Friction of the seals at the speed v [N], and its derivative [N.s/m].
    pub fn friction(&self, v: f64) -> [f64; 2] {
        let bell = (-(v / self.stribeck_speed).powi(2)).exp() * (self.static_friction - self.coulomb);
        let (size, th) = (self.coulomb + bell, (v / self.transition_speed).tanh());
        let slope = -2.0 * v / self.stribeck_speed.powi(2) * bell * th + size * (1.0 - th * th) / self.transition_speed;
        [size * th + self.viscous * v, slope + self.viscous]
    }

    /// Force on the ends of the cylinder [N].
    pub fn force(&self, v: f64, [p_a, p_b, ..]: &State) -> f64 {
        let [a, b] = self.areas();
        a * p_a - b * p_b - self.friction(v)[0]
    }

    /// Instantaneous stiffness -dF/ds [N/m].
    pub fn stiffness(&self, s: f64, [p_a, p_b, ..]: &State) -> f64 {
        let ([a, b], [v_a, v_b]) = (self.areas(), self.volumes(s));
        self.bulk(*p_a) * a * a / v_a + self.bulk(*p_b) * b * b / v_b
    }
}
