//! Variables of drives: of their motion, and of the mechanism as one element.
use super::Builder;
use super::needs::{Needs, PLACED};
use crate::mechanism::loads::resolved::Drive;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::quantity::{OneElement, Output};
use crate::variables::Unit;

impl Builder<'_> {
    pub(super) fn add_drives(&mut self) {
        let (inputs, loads) = self.everything();
        for (place, drive) in self.loading.drives.clone().into_iter().enumerate() {
            let Drive { name: n, is_rotary, efficiency } = drive;
            let slides = !is_rotary && matches!(self.loading.loads[place], Load::Slide { .. });
            let (units, what) = if is_rotary {
                ([Unit::Radian, Unit::RadianPerSecond, Unit::RadianPerSecondSquared], "angle")
            } else {
                (
                    [Unit::Metre, Unit::MetrePerSecond, Unit::MetrePerSecondSquared],
                    if slides { "position" } else { "length" },
                )
            };
            let own = [place];
            let at = Needs { loads: &own, ..self.placing_load(place) };
            let all = Needs { speed: true, inertia: true, inputs: &inputs, loads: &loads, ..PLACED };
            let needs = [at, Needs { speed: true, ..at }, all];
            let words = ["Present", "First derivative of the", "Second derivative of the"];
            for (order, suffix) in [what, "speed", "acceleration"].into_iter().enumerate() {
                let text = [words[order], " ", what, " of ", &n].concat();
                let output = Output::Displacement { load: place, order };
                self.output([&n, ".", suffix].concat(), text, units[order], output, needs[order]);
            }
            self.add_one_element(&n, place, is_rotary, efficiency.is_some());
        }
    }

    /// The terms of the mechanism reduced to a drive.
    fn add_one_element(&mut self, n: &str, drive: usize, is_rotary: bool, lossy: bool) {
        let (inputs, loads) = self.everything();
        let own = [drive];
        let locks = self.locks();
        // What is held by a lock or not makes no difference to what a drive would have to do.
        let free: Vec<usize> = inputs.iter().copied().filter(|i| !locks.contains(i)).collect();
        let others: Vec<usize> = free.iter().copied().filter(|i| *i != drive).collect();
        let with = |inputs: &[usize], more: Option<usize>| -> Vec<usize> {
            let mut all: Vec<usize> = inputs.iter().copied().chain(more).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let demanded = with(&others, Some(self.loading.inputs.len() + drive));
        // With an efficiency the sign of the drive's power counts: its own force and the speed. Friction depends on all; what
        // arrives of a drive with losses depends on where the motion goes, and if it holds, on what there is to hold.
        let rubs = self.rubs();
        let loses = self.loading.drives.iter().any(|d| d.efficiency.is_some());
        let (none, others_too) = (with(&[], lossy.then_some(drive)), with(&others, (loses || rubs).then_some(drive)));
        let friction_joints: Vec<usize> =
            self.loading.friction.iter().flat_map(|f| &f.friction_joints).map(|p| p.load).collect();
        let frictionless: Vec<usize> = loads.iter().copied().filter(|l| !friction_joints.contains(l)).collect();
        let relative = self.loading.air.is_some();
        let mass = Needs { inertia: true, speed: lossy, inputs: &none, loads: &own, ..PLACED };
        let load = Needs {
            speed: loses || rubs || relative || self.damped(),
            inertia: rubs,
            masses: rubs,
            inputs: &others_too,
            loads: &loads,
            ..PLACED
        };
        let additional = Needs { speed: true, inertia: true, inputs: &none, loads: &own, ..PLACED };
        let required = Needs { speed: true, inertia: true, masses: rubs, inputs: &demanded, loads: &loads, ..PLACED };
        let holding = Needs { inputs: &others, loads: &frictionless, lossless: true, ..PLACED };
        let breakaway = Needs { statics: true, lossless: false, ..holding };
        let (mass_unit, change_unit, unit) = if is_rotary {
            (Unit::KilogramSquareMetre, Unit::KilogramSquareMetrePerRadian, Unit::NewtonMetre)
        } else {
            (Unit::Kilogram, Unit::KilogramPerMetre, Unit::Newton)
        };
        let (inertia, force) = if is_rotary { ("inertia", "torque") } else { ("mass", "force") };
        use OneElement::{
            AdditionalForce, BreakawayBackward, BreakawayForward, HoldingForce, ReducedMass, ReducedMassDerivative,
            RequiredForce, StaticLoad,
        };
        for (suffix, text, unit, term, needs) in [
            (format!("reduced_{inertia}"), "Reduced inertia: of the mechanism, at", mass_unit, ReducedMass, mass),
            (
                format!("reduced_{inertia}_derivative"),
                "Derivative of the reduced inertia along",
                change_unit,
                ReducedMassDerivative,
                mass,
            ),
            ("static_load".into(), "Present loads reduced to", unit, StaticLoad, load),
            (
                format!("additional_{force}"),
                "-1/2 speed^2 times the derivative of the reduced inertia of",
                unit,
                AdditionalForce,
                additional,
            ),
            (
                "required_force".into(),
                "Force or torque that the demanded acceleration takes of",
                unit,
                RequiredForce,
                required,
            ),
            (
                format!("holding_{force}"),
                "What holds the mechanism still here, under the present loads, of",
                unit,
                HoldingForce,
                holding,
            ),
        ] {
            let output = Output::OneElement { drive, term };
            self.output([n, ".", &suffix].concat(), [text, " ", n].concat(), unit, output, needs);
        }
        if rubs {
            for (suffix, text, term) in [
                (
                    "forward",
                    "What begins to move the mechanism forward from rest against static friction, of",
                    BreakawayForward,
                ),
                ("backward", "What begins to move it backward, of", BreakawayBackward),
            ] {
                let output = Output::OneElement { drive, term };
                self.output(format!("{n}.breakaway_{force}_{suffix}"), format!("{text} {n}"), unit, output, breakaway);
            }
        }
    }
}
