//! `cargo fmu chain N`: writes the mechanism.json of a chain of N four-bars, the benchmark that grows.

pub mod mechanism;

use anyhow::{Context, Result};
use clap::Args;
use std::fs;
use std::path::PathBuf;

use crate::workspace::MECHANISM;

/// Most four-bars.
const LONGEST: i64 = 80;

/// What the command line says.
#[derive(Args)]
pub struct Arguments {
    /// Number of four-bars, at most 80: packed in 2 s; longer chains are not all accepted where their bars lie flat
    #[arg(value_parser = clap::value_parser!(u32).range(1..=LONGEST))]
    pub count: u32,
    /// A file that ends in .json, or a folder, written as resources/mechanism.json in it [default: standard output]
    #[arg(long, value_name = "PATH")]
    pub out: Option<PathBuf>,
}

/// Write the mechanism.
///
/// # Errors
/// The file cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let text = mechanism::text(arguments.count);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::Workspace;
    use linkage_fmu::mechanism::Model;

    #[test]
    fn two_four_bars_are_the_committed_mechanism() {
        let path = Workspace::locate().descriptions().join("FourBarChain").join("resources").join(MECHANISM);
        let committed = fs::read_to_string(&path).unwrap();
        assert_eq!(committed, mechanism::text(2), "run `cargo fmu chain 2 --out modelDescription/FourBarChain`");
    }

    #[test]
    fn a_chain_too_long_is_refused_with_the_limit() {
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
            let model = Model::from_json(&mechanism::text(count)).unwrap();
            assert_eq!(model.name(), name);
            assert!(model.variables().find(&format!("bar{count}.angle")).is_some());
            assert!(model.variables().find(&format!("bar{}.angle", count + 1)).is_none());
        }
    }
}
