//! Bars and joints in the form of PMKS+, and their linkage.
//!
//! In: joints and bars of a file. Out: the planar linkage. The module must not know the format of the file.

use super::planar::{Body, GROUND, Joint, Linkage, identifier};
use anyhow::{Context, Result, bail, ensure};

/// A joint of the file.
pub struct Pin {
    pub id: String,
    pub name: String,
    pub place: [f64; 2],
    pub slides: bool,
    pub is_input: bool,
    pub is_grounded: bool,
    pub is_welded: bool,
    pub angle: f64,
    /// For a slide in a bar: the bar, and two joints on the line of the slide.
    pub slot: Option<[String; 3]>,
}

/// A bar, or the block of a slide.
pub struct Bar {
    pub id: String,
    pub name: String,
    pub is_part: bool,
    pub is_block: bool,
    pub mass: f64,
    pub inertia: f64,
    pub center: [f64; 2],
    pub pins: Vec<String>,
    pub parts: Vec<String>,
}

/// The linkage during its construction.
pub struct Builder<'a> {
    own: Linkage,
    pins: &'a [Pin],
    bars: &'a [Bar],
    /// Bars that are no part of another bar. The index of its body is the index of the bar plus 1.
    roots: Vec<&'a Bar>,
}

impl<'a> Builder<'a> {
    /// Bodies of the bars. `speed` is the speed of the input [rad/s].
    ///
    /// # Errors
    /// A bar names a joint that does not exist.
    pub fn new(name: &str, pins: &'a [Pin], bars: &'a [Bar], speed: f64) -> Result<Self> {
        let mut own = Linkage { name: identifier(name, "Mechanism", &[]), ..Linkage::default() };
        own.start_speed = Some(speed).filter(|speed| *speed != 0.0);
        own.bodies.push(Body { name: GROUND.to_owned(), points: vec![[0.0; 2]], ..Body::default() });
        let roots: Vec<&Bar> = bars.iter().filter(|bar| !bar.is_part).collect();
        for bar in &roots {
            let taken: Vec<&str> = own.bodies.iter().map(|body| body.name.as_str()).collect();
            let name = identifier(&bar.name, "link", &taken);
            let mut points = Vec::new();
            for id in &bar.pins {
                let pin = pins.iter().find(|pin| pin.id == *id);
                let pin = pin.with_context(|| format!("link {}: there is no joint {}", bar.id, id.escape_debug()))?;
                if !points.contains(&pin.place) {
                    points.push(pin.place);
                }
            }
            let center = (!bar.is_block && bar.mass > 0.0).then_some(bar.center);
            own.bodies.push(Body { name, points, mass: bar.mass, center, inertia: bar.inertia, ..Body::default() });
        }
        Ok(Self { own, pins, bars, roots })
    }

    /// Bodies with a joint, without the ground.
    fn bodies_of(&self, pin: &Pin) -> Vec<usize> {
        let holds = |bar: &&Bar| bar.pins.contains(&pin.id);
        (0..self.roots.len()).filter(|&at| holds(&self.roots[at])).map(|at| at + 1).collect()
    }

    /// Bodies that a welded joint connects rigidly. If a bar consists of several parts that share the joint, these are
    /// the bar and blocks, as PMKS+ welds all existing bars into one and pins later bars. Otherwise all bodies.
    fn welded(&self, pin: &Pin, bodies: &[usize]) -> Vec<usize> {
        let has_pin = |part: &&Bar| part.is_part && part.pins.contains(&pin.id);
        let is_weld = |body: &usize| {
            let parts = &self.roots[body - 1].parts;
            self.bars.iter().filter(has_pin).filter(|part| parts.contains(&part.id)).count() > 1
        };
        let has_weld = bodies.iter().any(is_weld);
        let is_held = |body: &usize| !has_weld || is_weld(body) || self.roots[body - 1].is_block;
        bodies.iter().copied().filter(is_held).collect()
    }

    /// The slide whose block has this joint. Files before 2026 state both at one position.
    fn slide_of(&self, pin: &Pin) -> Option<&'a Pin> {
        let block = self.roots.iter().find(|bar| bar.is_block && bar.pins.contains(&pin.id))?;
        self.pins.iter().find(|other| other.slides && block.pins.contains(&other.id))
    }

    /// Build the linkage.
    ///
    /// # Errors
    /// A slot or the ground is missing.
    pub fn linkage(mut self) -> Result<Linkage> {
        for pin in self.pins {
            let named = || format!("joint {}", pin.name.escape_debug());
            if pin.slides { self.slide(pin) } else { self.revolute(pin) }.with_context(named)?;
        }
        if self.own.joints.iter().all(|joint| joint.first != 0 && joint.second != 0) {
            bail!("no joint is on the ground, so the mechanism has no fixed link: ground at least one joint in PMKS+");
        }
        match self.own.drives.first().map(|(_, joint)| &self.own.joints[*joint]) {
            None => self.own.notes.push(
                "no joint is an input, so the mechanism has no drive; add a drive to the \
                definition if the mechanism needs one"
                    .to_owned(),
            ),
            Some(joint) if joint.axis.is_some() || joint.first != 0 => self.own.start_speed = None,
            Some(_) if self.own.start_speed.is_some() && self.own.is_massless() => self.own.notes.push(
                "no link has a mass: the imported mechanism has positions, speeds and accelerations only, and the \
                    input turns at the constant speed that PMKS+ stores"
                    .to_owned(),
            ),
            Some(_) if self.own.start_speed.is_some() => self.own.notes.push(
                "PMKS+ stores the speed of the input: the imported mechanism starts with this speed and the drive has \
                    no torque; add \"motion\" to the drive to prescribe the speed"
                    .to_owned(),
            ),
            Some(_) => {}
        }
        Ok(self.own)
    }

    fn revolute(&mut self, pin: &Pin) -> Result<()> {
        let slide = self.slide_of(pin);
        let mut bodies = self.bodies_of(pin);
        let welded = if pin.is_welded { self.welded(pin, &bodies) } else { Vec::new() };
        if let Some((&first, others)) = welded.split_first() {
            others.iter().for_each(|&other| self.own.bodies[other].fixed_to = Some(first));
            bodies.retain(|body| !others.contains(body));
        }
        if pin.is_grounded && slide.is_none() {
            bodies.insert(0, 0);
        }
        let Some((&first, others)) = bodies.split_first() else { return Ok(()) };
        if others.is_empty() && first != 0 && welded.len() < 2 {
            let name = self.name(pin, "");
            self.own.markers.push((name, first, pin.place));
        }
        for (&second, of) in others.iter().zip(0..) {
            self.join(pin, if of == 0 { "" } else { "_and" }, (first, second), None);
            if of == 0 && pin.is_input && slide.is_none() {
                self.drive();
            }
        }
        Ok(())
    }

    fn slide(&mut self, pin: &Pin) -> Result<()> {
        let bodies = self.bodies_of(pin);
        let is_block = |body: &usize| self.roots[body - 1].is_block;
        let block = bodies.iter().copied().find(is_block);
        // Older files state the ground and the input at the joint of the block.
        let mut carried =
            self.pins.iter().filter(|other| !other.slides && self.slide_of(other).is_some_and(|s| s.id == pin.id));
        let (mut is_input, mut is_grounded) = (pin.is_input, pin.is_grounded);
        if let Some(other) = carried.next() {
            is_input |= other.is_input;
            is_grounded |= other.is_grounded && pin.slot.is_none();
        }
        let (base, axis) = match &pin.slot {
            Some([carrier, a, b]) => {
                let holds = |bar: &&Bar| bar.id == *carrier || bar.parts.contains(carrier);
                let base = self.roots.iter().position(holds);
                let base = base.with_context(|| format!("there is no link {}", carrier.escape_debug()))? + 1;
                let place = |id: &String| -> Result<[f64; 2]> {
                    let pin = self.pins.iter().find(|pin| pin.id == *id);
                    Ok(pin.with_context(|| format!("there is no joint {}", id.escape_debug()))?.place)
                };
                let (a, b) = (place(a)?, place(b)?);
                ensure!(a != b, "the two joints of the slot are at the same place: move one of them in PMKS+");
                (base, (b[1] - a[1]).atan2(b[0] - a[0]))
            }
            None if is_grounded => (0, pin.angle),
            None => bail!("the slot is neither on the ground nor in a link: correct the slot in PMKS+"),
        };
        // Without a block, the links are hinged on a body without mass. Links that do not turn slide themselves.
        let rider = match block {
            Some(block) => block,
            None if pin.is_welded => {
                *bodies.first().context("the slot contains no joint that slides: correct the slot in PMKS+")?
            }
            None => {
                let block =
                    Body { name: self.name(pin, "_block"), points: vec![pin.place], is_block: true, ..Body::default() };
                self.own.bodies.push(block);
                self.own.bodies.len() - 1
            }
        };
        self.join(pin, "", (base, rider), Some(axis));
        if is_input {
            self.drive();
        }
        for &body in bodies.iter().filter(|&&body| body != rider) {
            self.join(pin, "_pin", (rider, body), None);
        }
        Ok(())
    }

    /// Add a drive in the last joint.
    fn drive(&mut self) {
        let count = self.own.drives.len();
        let name = if count == 0 { "drive".to_owned() } else { format!("drive_{}", count + 1) };
        self.own.drives.push((name, self.own.joints.len() - 1));
    }

    fn join(&mut self, pin: &Pin, suffix: &str, (first, second): (usize, usize), axis: Option<f64>) {
        let name = self.name(pin, suffix);
        self.own.joints.push(Joint { name, first, second, place: pin.place, axis, ..Joint::default() });
    }

    /// A free name for the replacement of a joint.
    fn name(&self, pin: &Pin, suffix: &str) -> String {
        let taken: Vec<String> = self.own.names().collect();
        let taken: Vec<&str> = taken.iter().map(String::as_str).collect();
        identifier(&format!("{}{suffix}", pin.name), "joint", &taken)
    }
}
