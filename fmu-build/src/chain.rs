//! `cargo fmu chain N`: writes the `mechanism.json` of a chain of N four-bars, from the IFToMM library of computational
//! benchmark problems, A02.
//!
//! 2 N + 1 uniform rods of 1 m and 1 kg: bars 0 to N stand on the ground 1 m apart, links 1 to N join their tips.
//! Gravity is 9.81 m/s2 downwards. At the start the bars are upright, and their tips move at 1 m/s to the right. Every
//! loop is a parallelogram, so the chain has one degree of freedom and 2 N loop equations. All of them are singular
//! whenever the bars lie flat.

use anyhow::{Context, Result};
pub use fmu_cli::Chain as Arguments;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;
use std::fs;

use crate::workspace::MECHANISM;

/// Write the mechanism.
///
/// # Errors
/// The file cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let text = text(arguments.count);
    let Some(out) = &arguments.out else {
        print!("{text}");
        return Ok(());
    };
    let is_file = out.extension().is_some_and(|extension| extension == "json");
    let path = if is_file { out.clone() } else { out.join("resources").join(MECHANISM) };
    let written = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&path, text));
    written.with_context(|| format!("{}: cannot be written", path.display()))?;
    println!("{}", path.display());
    Ok(())
}

/// The text of the file for `count` >= 1 four-bars. The pivots are the first joints, so that each loop closes through
/// the bars next to it.
pub fn text(count: u32) -> String {
    let name = if count == 2 { "FourBarChain".into() } else { format!("FourBarChain{count}") };
    let (bars, links) = (0..=count, 1..=count);
    let list = |entries: Vec<String>| entries.join(",\n    ");
    let pivots: Vec<String> = links.clone().map(|k| format!("\"pivot{k}\": [{k}, 0]")).collect();
    let rod =
        |name: &str, k: u32| format!("\"{name}{k}\": {{ \"length\": 1, \"mass\": 1, \"shape\": \"uniform_rod\" }}");
    let bodies = bars.clone().map(|k| rod("bar", k)).chain(links.clone().map(|k| rod("link", k))).collect();
    let revolute = |name: &str, k: u32, first: String, second: String| {
        format!("\"{name}{k}\": {{ \"type\": \"revolute\", \"first\": \"{first}\", \"second\": \"{second}\" }}")
    };
    let pivot = |k: u32| if k == 0 { "ground.origin".into() } else { format!("ground.pivot{k}") };
    let joints = (bars.clone().map(|k| revolute("pivot", k, pivot(k), format!("bar{k}.origin"))))
        .chain(links.clone().map(|k| revolute("left", k, format!("bar{}.end", k - 1), format!("link{k}.origin"))))
        .chain(links.clone().map(|k| revolute("right", k, format!("link{k}.end"), format!("bar{k}.end"))))
        .collect();
    let guess = (bars.map(|k| format!("\"bar{k}\": {FRAC_PI_2}")))
        .chain(links.map(|k| format!("\"link{k}\": 0")))
        .collect::<Vec<_>>()
        .join(", ");
    let mut out = String::from("{\n");
    let mut line = |text: String| {
        let _ = writeln!(out, "  {text}");
    };
    line(format!("\"name\": \"{name}\","));
    line(format!("\"description\": \"Chain of {count} four-bars, IFToMM benchmark A02\","));
    line(format!("\"gravity\": {{ \"acceleration\": 9.81, \"up_angle\": {FRAC_PI_2} }},"));
    line(format!("\"bodies\": {{\n    \"ground\": {{ \"points\": {{ {} }} }},", pivots.join(", ")));
    line(format!("  {}\n  }},", list(bodies)));
    line(format!("\"joints\": {{\n    {}\n  }},", list(joints)));
    line("\"markers\": {\n    \"tip\": { \"at\": \"bar0.end\" }\n  },".into());
    line(format!("\"start\": {{ \"body\": \"bar0\", \"angle\": {FRAC_PI_2}, \"speed\": -1 }},"));
    line(format!("\"guess\": {{ {guess} }},"));
    line("\"solver\": { \"tolerance\": 1e-9 },".into());
    line("\"experiment\": { \"stop_time\": 10, \"step_size\": 0.01 }".into());
    out.push_str("}\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::Workspace;
    use linkage_fmu::mechanism::Model;

    #[test]
    fn two_four_bars_are_the_committed_mechanism() {
        let path = Workspace::locate().descriptions().join("FourBarChain").join("resources").join(MECHANISM);
        let committed = fs::read_to_string(&path).unwrap();
        assert_eq!(committed, text(2), "run `cargo fmu chain 2 --out modelDescription/FourBarChain`");
    }

    #[test]
    fn a_chain_that_is_too_long_is_rejected_with_the_limit() {
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            arguments: Arguments,
        }
        let parse = |count: &str| <Line as clap::Parser>::try_parse_from(["chain", count]);
        assert_eq!(parse("80").unwrap().arguments.count, 80);
        for count in ["0", "81", "100000000"] {
            let message = parse(count).map(|_| ()).unwrap_err().to_string();
            assert!(message.contains(&format!("'{count}' for '<COUNT>'")) && message.contains("1..=80"), "{message}");
        }
    }

    #[test]
    fn one_four_bar_and_many_are_mechanisms() {
        for (count, name) in [(1, "FourBarChain1"), (2, "FourBarChain"), (5, "FourBarChain5"), (80, "FourBarChain80")] {
            let model = Model::from_json(&text(count)).unwrap();
            assert_eq!(model.name(), name);
            assert!(model.variables().find(&format!("bar{count}.angle")).is_some());
            assert!(model.variables().find(&format!("bar{}.angle", count + 1)).is_none());
        }
    }
}
