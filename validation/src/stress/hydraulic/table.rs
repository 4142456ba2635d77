//! The table of hydraulic scenes, from `scenes/hydraulics.json`: names by values by steps by tolerances.
//!
//! A name is set to each of `values`, or to its default times each of `factors`; without names, all parameters are
//! varied. A scene inherits all other settings from the base. `except` states different settings for some names and
//! values: a stroke of a third of a millimetre has no such length, with such an exponent the air has no pressure after
//! the least growth of its volume, and a strong valve or supply drives the element or the gear to the end of the
//! cylinder.
use super::case::{Case, Drive};
use super::{Scene, gear};
use crate::stress::Row;
use crate::stress::scenes::count;
use serde_json::Value;
use std::sync::LazyLock;

static FILE: LazyLock<Value> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../../../scenes/hydraulics.json")).unwrap_or_else(|why| {
        eprintln!("scenes/hydraulics.json: {why}");
        Value::Null
    })
});

/// The gear in the crank angle of its start [rad].
const GEAR: Drive = Drive::Motion([0.7, 0.0, 0.0]);

/// All rows, group by group.
pub fn all() -> impl Iterator<Item = Row> {
    // The motion of scene H0 from 0.5 m on, and an element like the gear's.
    let drives = [Drive::Motion([0.5, 0.1, -0.15]), Drive::Element([0.5, 0.05], [700.0, -300.0, 500.0, 2e4])];
    let base = |drive| Case { set: Vec::new(), start: [6e6, 8e6], drive, span: 0.2, steps: 20, commands: vec![0.4] };
    let gear = Case { start: [6e6, 11.15e6], span: 0.4, steps: 1600, ..base(GEAR) };
    let of = |list: &'static str, base: Case| elements(&FILE[list]).flat_map(move |spec| scenes(spec, &base));
    let mut rows: Vec<Scene> = drives.into_iter().flat_map(|drive| of("actuator", base(drive))).collect();
    rows.sort_by_key(|row| row.group);
    let gears = of("gear", gear).map(|Scene { what, case, tolerance, .. }| gear::Scene { what, case, tolerance });
    rows.into_iter().map(Row::from).chain(gears.map(Row::from))
}

fn elements(list: &'static Value) -> impl Iterator<Item = &'static Value> {
    list.as_array().into_iter().flatten()
}

/// The numbers in a list.
fn numbers(list: &'static Value) -> Vec<f64> {
    elements(list).filter_map(Value::as_f64).collect()
}

fn words(list: &'static Value) -> Vec<&'static str> {
    elements(list).filter_map(Value::as_str).collect()
}

/// All rows of a scene of the file.
fn scenes(spec: &'static Value, base: &Case) -> Vec<Scene> {
    let word = if base.drive == GEAR { "gear" } else { base.drive.word() };
    let mut out = Vec::new();
    if spec["drive"].as_str().is_some_and(|drive| drive != word) {
        return out;
    }
    let stated = FILE["stated"].as_object().into_iter().flatten();
    let mut names = words(&spec["names"]);
    let factors = numbers(&spec["factors"]);
    let values = if factors.is_empty() { numbers(&spec["values"]) } else { factors.clone() };
    if names.is_empty() {
        names = if values.is_empty() { vec![""] } else { stated.map(|(name, _)| name.as_str()).collect() };
    }
    let values = if values.is_empty() { vec![f64::NAN] } else { values };
    let steps: Vec<usize> = numbers(&spec["steps"]).into_iter().map(|steps| steps as usize).collect();
    let steps = if steps.is_empty() { vec![base.steps] } else { steps };
    for name in names {
        for &value in &values {
            let is_other = |other: &&'static Value| {
                let (names, values) = (words(&other["names"]), numbers(&other["values"]));
                let drive = other["drive"].as_str().is_none_or(|drive| drive == word);
                drive && (names.is_empty() || names.contains(&name)) && values.contains(&value)
            };
            // The last exception that has a key determines its value.
            let others: Vec<&'static Value> = elements(&spec["except"]).filter(is_other).collect();
            let of = |key: &str| others.iter().rev().map(|other| &other[key]).find(|own| !own.is_null());
            let of = |key: &str| of(key).unwrap_or(&spec[key]);
            for &steps in &steps {
                let mut case = Case { steps, ..base.clone() };
                case.read(&of);
                let factor = if factors.is_empty() { 1.0 } else { FILE["stated"][name].as_f64().unwrap_or(1.0) };
                if !name.is_empty() {
                    case.set.push((name, factor * value));
                }
                let refusal = Some(words(of("refusal"))).filter(|words| !words.is_empty());
                let what = spec["what"].as_str().unwrap_or_default().replace("{name}", name);
                let what = what.replace("{value}", &format!("{value:e}")).replace("{steps}", &count(steps as u64));
                let group = spec["group"].as_str().unwrap_or_default();
                for tolerance in numbers(of("tolerances")) {
                    let (what, case, refusal) = (what.clone(), case.clone(), refusal.clone());
                    out.push(Scene { group, what, case, tolerance, refusal });
                }
            }
        }
    }
    out
}

impl Case {
    /// Read a scene's settings of a run.
    fn read(&mut self, of: &dyn Fn(&str) -> &'static Value) {
        self.set =
            of("set").as_object().into_iter().flatten().map(|(k, v)| (&**k, v.as_f64().unwrap_or(0.0))).collect();
        self.span = of("span").as_f64().unwrap_or(self.span);
        match (&mut self.drive, &numbers(of("motion"))[..], &numbers(of("element"))[..]) {
            (Drive::Motion(motion), &[s, v, a], _) => *motion = [s, v, a],
            (Drive::Element(at, _), _, &[s, v]) => *at = [s, v],
            _ => {}
        }
        if let [a, b] = numbers(of("start"))[..] {
            self.start = [a, b];
        }
        let (commands, each) = (numbers(of("commands")), of("each_command").as_u64().unwrap_or(1));
        if !commands.is_empty() {
            self.commands = commands.into_iter().flat_map(|u| std::iter::repeat_n(u, each as usize)).collect();
        }
    }
}
