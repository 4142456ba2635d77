//! The table of hydraulic scenes.
use super::case::{Case, Drive};
use super::{Scene, gear};
use crate::stress::Row;

/// Every parameter that may be scaled by 1e-3 and 1e3, with its value; the spans of such rows are short, as a circuit
/// of a thousandth is a thousand times as fast.
const SCALED: [(&str, f64); 28] = [
    ("fluid.bulk_modulus", 1.4e9),
    ("fluid.air_fraction", 0.005),
    ("fluid.polytropic_exponent", 1.4),
    ("chamber_a.dead_volume", 6e-5),
    ("chamber_b.dead_volume", 6e-5),
    ("valve.rated_flow", 1e-4),
    ("valve.rated_pressure_drop", 3.5e6),
    ("valve.transition_pressure", 1e5),
    ("valve.clearance", 2e-3),
    ("valve.frequency", 60.0),
    ("valve.damping_ratio", 0.8),
    ("restrictor_a.rated_flow", 5e-5),
    ("restrictor_b.rated_flow", 5e-5),
    ("check.pressure", 5e4),
    ("cushion_a.rated_flow", 1.2e-5),
    ("cushion_b.rated_flow", 1.2e-5),
    ("relief.pressure", 28e6),
    ("relief.width", 1e5),
    ("relief.conductance", 1e-10),
    ("anticavitation.conductance", 1e-10),
    ("leakage.internal", 2e-13),
    ("leakage.external_b", 5e-14),
    ("seal.coulomb", 250.0),
    ("seal.stribeck_speed", 0.02),
    ("seal.transition_speed", 0.005),
    ("seal.viscous", 500.0),
    ("supply.pressure", 20.7e6),
    ("cylinder.stroke", 0.33),
];

/// The motion of scene H0 from 0.5 m on.
const MOTION: Drive = Drive::Motion([0.5, 0.1, -0.15]);
/// An element like the gear's.
const ELEMENT: Drive = Drive::Element([0.5, 0.05], [700.0, -300.0, 500.0, 2e4]);

fn case(drive: Drive) -> Case {
    Case { set: Vec::new(), start: [6e6, 8e6], drive, span: 0.2, steps: 20, commands: vec![0.4] }
}

/// All, group by group.
pub fn all() -> impl Iterator<Item = Row> {
    let mut rows: Vec<Scene> = Vec::new();
    for drive in [MOTION, ELEMENT] {
        parameters(drive, &mut rows);
        hard(drive, &mut rows);
    }
    rows.sort_by_key(|row| row.group);
    rows.into_iter().map(Row::from).chain(gears().into_iter().map(Row::from))
}

fn parameters(drive: Drive, rows: &mut Vec<Scene>) {
    for (name, value) in SCALED {
        for factor in [1e-3, 1e-1, 1e1, 1e3] {
            let mut case = case(drive);
            case.set.push((name, value * factor));
            // A stroke of a third of a millimetre has no such length.
            let short = name == "cylinder.stroke" && factor < 1.0;
            // With such an exponent the air has no pressure after the least growth of its volume.
            let stiff_air = name == "fluid.polytropic_exponent" && factor == 1e3 && matches!(drive, Drive::Motion(_));
            let refusal = if short {
                Some(&["length", "cylinder"][..])
            } else if stiff_air {
                Some(&["no integration step reaches", "chamber_a.pressure"][..])
            } else {
                None
            };
            // These drive the element to the end of the cylinder.
            let strong = matches!(
                (name, factor),
                ("valve.rated_flow" | "supply.pressure", 1e3) | ("valve.rated_pressure_drop", 1e-3)
            );
            if strong && matches!(drive, Drive::Element(..)) {
                case.span = 0.005;
            }
            let what = format!("{name} x {factor:e}");
            let tolerance = if factor == 1e3 { 1e-9 } else { 1e-7 };
            rows.push(Scene { group: "Hydraulics: parameters", what, case, tolerance, refusal });
        }
    }
    for tolerance in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        for steps in [1, 20, 2000] {
            let case = Case { steps, ..case(drive) };
            let what = format!("as it is, 0.2 s in {}", crate::stress::scenes::count(steps as u64));
            rows.push(Scene { group: "Hydraulics: tolerances", what, case, tolerance, refusal: None });
        }
    }
}

fn hard(drive: Drive, rows: &mut Vec<Scene>) {
    let mut add = |group: &'static str, what: String, case: Case, tolerance: f64| {
        rows.push(Scene { group, what, case, tolerance, refusal: None });
    };
    let out = |drive: Drive, to: f64| match drive {
        Drive::Motion(_) => Drive::Motion([to, 0.05, 0.0]),
        Drive::Element(_, element) => Drive::Element([to, 0.0], element),
    };
    for dead in [1e-6, 1e-8, 1e-10] {
        // At the bottom of chamber A: the volume is the dead one.
        for tolerance in [1e-6, 1e-9] {
            let set = vec![("chamber_a.dead_volume", dead)];
            let case = Case { set, drive: out(drive, 0.41201), span: 0.05, ..case(drive) };
            add(
                "Hydraulics: tiny dead volumes",
                format!("chamber_a.dead_volume = {dead:e} m3, 10 um from the end"),
                case,
                tolerance,
            );
        }
    }
    for conductance in [1e-11, 1e-10, 1e-9, 1e-8, 1e-6] {
        for (name, tolerance) in [("leakage.internal", 1e-6), ("leakage.internal", 1e-9), ("leakage.external_a", 1e-9)]
        {
            let case = Case { set: vec![(name, conductance)], ..case(drive) };
            add("Hydraulics: stiff leakage", format!("{name} = {conductance:e} m3/(s.Pa)"), case, tolerance);
        }
    }
    for air in [0.0, 1e-6, 0.3] {
        for tolerance in [1e-6, 1e-9] {
            let set = vec![("fluid.air_fraction", air)];
            // Slower than elsewhere, as oil without air must not come to absolute zero.
            let drive = if let Drive::Motion(_) = drive { Drive::Motion([0.5, 0.03, -0.05]) } else { drive };
            let case = Case { set, drive, ..case(drive) };
            add("Hydraulics: air", format!("fluid.air_fraction = {air:e}"), case, tolerance);
        }
    }
    // Chamber A is drawn out with the valve closed: it cavitates.
    for anticavitation in [1e-10, 1e-12, 0.0] {
        for tolerance in [1e-6, 1e-9] {
            let set = vec![("anticavitation.conductance", anticavitation), ("relief.conductance", 1e-10)];
            let fast = match drive {
                Drive::Motion(_) => Drive::Motion([0.45, 0.3, 0.0]),
                Drive::Element(_, element) => Drive::Element([0.45, 0.3], element),
            };
            let case = Case { set, drive: fast, commands: vec![0.0], start: [1e5, 1e5], ..case(drive) };
            let what = format!("cavitation, anticavitation.conductance = {anticavitation:e} m3/(s.Pa)");
            add("Hydraulics: air", what, case, tolerance);
        }
    }
    if let Drive::Motion(_) = drive {
        let set = vec![("fluid.air_fraction", 0.0), ("anticavitation.conductance", 0.0)];
        let case =
            Case { set, drive: Drive::Motion([0.45, 0.3, 0.0]), commands: vec![0.0], start: [1e5, 1e5], ..case(drive) };
        let refusal = Some(&["absolute pressure of chamber_a", "fluid.air_fraction"][..]);
        let what = "cavitation without air".to_owned();
        rows.push(Scene { group: "Hydraulics: air", what, case, tolerance: 1e-6, refusal });
    }
    let mut add = |group: &'static str, what: String, case: Case, tolerance: f64| {
        rows.push(Scene { group, what, case, tolerance, refusal: None });
    };
    for (steps, frequency) in [(20, 60.0), (200, 60.0), (20, 6e4), (200, 6e4)] {
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12] {
            let set = vec![("valve.frequency", frequency)];
            let case = Case { set, steps, commands: vec![1.0, -1.0, 0.0, 0.5, -0.2], ..case(drive) };
            let what = format!("a command that jumps in each of {steps} steps, valve.frequency = {frequency:e} Hz");
            add("Hydraulics: valve steps", what, case, tolerance);
        }
    }
}

fn gears() -> Vec<gear::Scene> {
    let mut rows = Vec::new();
    let base = Case {
        set: Vec::new(),
        start: [6e6, 11.15e6],
        drive: Drive::Motion([0.7, 0.0, 0.0]),
        span: 0.4,
        steps: 1600,
        commands: vec![0.4],
    };
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
        rows.push(gear::Scene { what: "as it is".into(), case: base.clone(), tolerance });
    }
    let scaled = [
        "fluid.bulk_modulus",
        "valve.rated_flow",
        "chamber_a.dead_volume",
        "chamber_b.dead_volume",
        "valve.frequency",
        "seal.coulomb",
        "seal.viscous",
        "relief.pressure",
        "cushion_a.rated_flow",
    ];
    let values = |name: &str| SCALED.iter().find(|(own, _)| *own == name).map_or(1.0, |(_, value)| *value);
    for name in scaled {
        for factor in [1e-3, 1e-1, 1e1, 1e3] {
            let case = Case { set: vec![(name, values(name) * factor)], ..base.clone() };
            // A valve of a thousand times the flow drives the gear to the end of the cylinder within the span.
            let wide = name == "valve.rated_flow" && factor == 1e3;
            let case = Case { span: if wide { 0.05 } else { case.span }, ..case };
            rows.push(gear::Scene { what: format!("{name} x {factor:e}"), case, tolerance: 1e-7 });
        }
    }
    for (what, set) in [
        ("oil without air", vec![("fluid.air_fraction", 0.0)]),
        ("leakage.internal = 1e-9 m3/(s.Pa)", vec![("leakage.internal", 1e-9)]),
        ("leakage.internal = 1e-7 m3/(s.Pa)", vec![("leakage.internal", 1e-7)]),
        ("dead volumes of 1e-8 m3", vec![("chamber_a.dead_volume", 1e-8), ("chamber_b.dead_volume", 1e-8)]),
    ] {
        let case = Case { set, ..base.clone() };
        rows.push(gear::Scene { what: what.into(), case, tolerance: 1e-8 });
    }
    let commands = [0.5, 0.0, -0.5, 0.2].iter().flat_map(|u| std::iter::repeat_n(*u, 100)).collect();
    let case = Case { commands, ..base };
    rows.push(gear::Scene { what: "a command that jumps every 25 ms".into(), case, tolerance: 1e-8 });
    rows
}
