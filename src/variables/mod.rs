//! The table of variables: what a host can see and set.
//!
//! In: the definition's names, quantities and start values. Out: one list that drives get and set, the generated
//! `modelDescription.xml`, its units and its ModelStructure. A variable's value reference is its place in the list.
//! This room knows nothing of the FMI functions; the words causality, variability and initial are the standard's own.

mod interface;
mod needs;
mod unit;

pub use unit::{BaseUnit, DisplayUnit, Unit};

/// Place of a variable in the table; the FMI value reference.
pub type Reference = u32;

/// Type of a variable's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// 64-bit floating-point number.
    Real,
    /// 32-bit signed integer.
    Integer,
    /// Truth value.
    Boolean,
    /// Text.
    String,
}

/// FMI 2.0.5, 2.2.7: who determines the value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Causality {
    /// Fixed by the host before the simulation; `initial` is exact.
    Parameter,
    /// Set by the host between steps; carries no `initial`.
    Input,
    /// Computed here; `initial` is calculated.
    Output,
}

/// FMI 2.0.5, 2.2.7: when the value may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variability {
    /// Constant once initialised.
    Fixed,
    /// Changes at communication points only.
    Discrete,
    /// Changes with time.
    Continuous,
}

/// A start value, of the variable's kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Value of a Real.
    Real(f64),
    /// Value of an Integer.
    Integer(i32),
    /// Value of a Boolean.
    Boolean(bool),
    /// Value of a String.
    String(String),
}

/// One variable of the interface.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Structured name, such as `crank.angle`.
    pub name: String,
    /// One line of text.
    pub description: String,
    /// Type of its value.
    pub kind: Kind,
    /// Who determines it.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Unit; only a Real has one.
    pub unit: Option<Unit>,
    /// Start value: of every parameter and input, of no output.
    pub start: Option<Value>,
    /// Outputs only: the inputs on which its present value depends, ascending.
    pub dependencies: Vec<Reference>,
}

/// What the model looks up or computes for a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// A number of the definition, by its place among the parameters.
    Parameter(usize),
    /// A Real that the host sets between steps, by its place.
    Input(usize),
    /// A Boolean of the definition, by its place among those.
    Flag(usize),
    /// The formulation of the motion, by its word.
    Method,
    /// Whether a lock is engaged.
    Lock(usize),
    /// Whether the mechanism is at a stop.
    AtStop(usize),
    /// Computed from the state.
    Output(Output),
}

/// A computed quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// Angle of a body, or its first or second time derivative.
    Turn {
        /// Place of the body in the linkage.
        body: usize,
        /// 0, 1 or 2.
        order: usize,
    },
    /// Position of a prismatic joint, or its first or second time derivative.
    Slide {
        /// Coordinate of the linkage.
        coordinate: usize,
        /// 0, 1 or 2.
        order: usize,
    },
    /// Reaction in a joint.
    Reaction {
        /// Place of the joint.
        joint: usize,
        /// Which part of it.
        part: ReactionPart,
    },
    /// Displacement of a drive's or a spring's load - length, angle or position - or its first or second time derivative.
    Displacement {
        /// Place of the load.
        load: usize,
        /// 0, 1 or 2.
        order: usize,
    },
    /// A term of the mechanism reduced to a drive.
    OneElement {
        /// Place of the drive, and of its load.
        drive: usize,
        /// Which term.
        term: OneElement,
    },
    /// Pull of a spring and damper.
    Pull {
        /// Place of the spring.
        spring: usize,
    },
    /// Position of a marker, or its first or second time derivative.
    Marker {
        /// Its place.
        marker: usize,
        /// 0 for x, 1 for y.
        axis: usize,
        /// 0, 1 or 2.
        order: usize,
    },
    /// Friction in a joint: on the second-named body.
    Friction {
        /// Place among the joints with friction.
        pin: usize,
    },
    /// Drag on a surface, along the flow.
    Drag {
        /// Place of the surface.
        surface: usize,
    },
    /// Force or torque of a stop.
    Stop {
        /// Place of the stop.
        stop: usize,
    },
    /// Force of a lock.
    Lock {
        /// Place of the lock.
        lock: usize,
    },
    /// Kinetic energy.
    Kinetic,
    /// Potential energy under the present load factor.
    Potential,
    /// Energy now less energy at the start less work done.
    Drift,
}

/// A term of the one-element model of [CK16]: F_S = F_Su + m_zS a_S - Delta F_S, eqs. (16), (37).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OneElement {
    /// m_zS or I_zS, eqs. (12), (33).
    ReducedMass,
    /// Its derivative along the drive.
    ReducedMassDerivative,
    /// F_Su or T_Su, eqs. (11), (32), under all present loads but the drive's own.
    StaticLoad,
    /// Delta F_S or Delta T_S, eqs. (15), (36).
    AdditionalForce,
    /// F_S or T_S for the demanded acceleration, eqs. (16), (37): inverse dynamics. The other drives lose what the direction
    /// of the motion says, at rest that in which it sets off; without a demand at rest they lose nothing.
    RequiredForce,
    /// What holds the mechanism still here under the present loads, without friction and without the losses of any drive: it
    /// lies between what sets off backward and forward.
    HoldingForce,
    /// What begins to move the mechanism here from rest, forward along the drive, against static friction and against the
    /// losses of all drives in a motion that way.
    BreakawayForward,
    /// The same backward.
    BreakawayBackward,
}

/// Part of a joint's reaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReactionPart {
    /// x component of the force.
    X,
    /// y component of the force.
    Y,
    /// Magnitude of the force.
    Magnitude,
    /// Moment about the second body's point.
    Moment,
}

/// The table of variables of one mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Variables {
    list: Vec<Variable>,
    quantities: Vec<Quantity>,
    guid: String,
}

impl Variables {
    /// All variables; the index is the value reference.
    pub fn list(&self) -> &[Variable] {
        &self.list
    }

    /// The variable with this reference, if there is one.
    pub fn get(&self, reference: Reference) -> Option<&Variable> {
        self.list.get(reference as usize)
    }

    /// What the model looks up or computes for it.
    pub fn quantity(&self, reference: Reference) -> Option<Quantity> {
        self.quantities.get(reference as usize).copied()
    }

    /// Reference of the variable with this name.
    pub fn find(&self, name: &str) -> Option<Reference> {
        self.list.iter().position(|v| v.name == name).map(|i| i as Reference)
    }

    /// GUID of the interface: a hash over names, kinds, causalities, variabilities and units, not over start values.
    pub fn guid(&self) -> &str {
        &self.guid
    }
}
