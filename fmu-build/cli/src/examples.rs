//! Examples at the end of each command's help.
//!
//! In: nothing. Out: texts. Each line that starts with the name of the program is a command line. The texts must not
//! name files of the source, because an installed program shows them too.

/// Examples of `package`.
pub const PACKAGE: &str = "\
Examples:
  Pack your mechanism for this machine, for FMI 2.0 and 3.0:
    cargo fmu package gear.json --out fmus
  Pack your mechanism for Linux and Windows, for FMI 2.0 only:
    cargo fmu package gear.json --fmi 2 --platforms x86_64-linux,x86_64-windows
  Pack a landing gear with its hydraulic actuator as an SSP package:
    cargo fmu package --ssp system.json --out fmus";

/// Examples of `check`.
pub const CHECK: &str = "\
Examples:
  Print errors, warnings, travel, drives and equilibria of a mechanism:
    cargo fmu check gear.json
  Check two mechanisms in a CI job: a warning is a failure too, and the result is JSON:
    cargo fmu check gear.json door.json --deny-warnings --json";

/// Examples of `info`.
pub const INFO: &str = "\
Examples:
  List the variables of an FMU with units and start values:
    cargo fmu info Gear.fmu
  Print the variables of the FMU of a definition as JSON:
    cargo fmu info gear.json --json";

/// Examples of `validate`.
pub const VALIDATE: &str = "\
Examples:
  Check one FMU before you send it to someone:
    cargo fmu validate Gear.fmu
  Check an FMU of FMI 3.0, and check the FMU of a definition:
    cargo fmu validate Gear.fmi3.fmu gear.json";

/// Examples of `view`.
pub const VIEW: &str = "\
Examples:
  Show the moving mechanism in the browser:
    cargo fmu view gear.json --open
  Write a page with 3 s of the motion at a load factor of 3:
    cargo fmu view gear.json --out gear.html --stop-time 3 --start-values load_factor 3
  Edit the mechanism in the browser, and see the motion of each change:
    cargo fmu view gear.json --live --open";

/// Examples of `simulate`.
pub const SIMULATE: &str = "\
Examples:
  Run the default experiment of a mechanism, and write all outputs and a plot:
    cargo fmu simulate gear.json --output-file run.csv --plot run.png
  Run a mechanism for 6 s with other start values, and record two variables:
    cargo fmu simulate gear.json --stop-time 6 --start-values load_factor 3 crank.start_angle 45deg \\
      --output-variables crank.angle jack.force --output-file run.parquet
  Run a mechanism with the values of an SSP parameter set:
    cargo fmu simulate gear.json --parameters heavy.ssv --output-file run.csv";

/// Examples of `import`.
pub const IMPORT: &str = "\
Examples:
  Convert a MuJoCo model to a definition:
    cargo fmu import arm.xml --out arm.json
  Convert a table of joints, and state the format of the file:
    cargo fmu import joints.csv --form table --out linkage.json";

/// Examples of `linearise`.
pub const LINEARISE: &str = "\
Examples:
  Plot the eigenfrequency along the travel while a drive holds the mechanism:
    cargo fmu linearise gear.json --held-by jack.force --plot frequency.png
  Write the state-space matrices at 50 positions:
    cargo fmu linearise gear.json --inputs jack.force --outputs crank.angle --count 50 --output-file matrices.csv";

/// Examples of `sweep`.
pub const SWEEP: &str = "\
Examples:
  Simulate all variants of a study, and draw the results:
    cargo fmu sweep study.json --page
  Continue a study that was stopped, with 4 threads:
    cargo fmu sweep study.json --out results --resume --threads 4";

/// Examples of `optimise`.
pub const OPTIMISE: &str = "\
Examples:
  Search for the best design of a study:
    cargo fmu optimise study.json --out best
  Write all evaluations of a study as CSV, and draw the evaluations:
    cargo fmu optimise study.json --csv --page";

/// Examples of `demo`.
pub const DEMO: &str = "\
Examples:
  Run the retraction of the landing gear with FMPy:
    cargo fmu demo
  Compare coupling schemes of landing gear and hydraulic actuator:
    cargo fmu demo --hydraulic --out results
  Retract and extend a landing gear with door, locks and one hydraulic system:
    cargo fmu demo --system --out results";

/// Examples of `docs`.
pub const DOCS: &str = "\
Examples:
  Build the website of the documentation:
    cargo fmu docs
  Build the website of the documentation, and open it in the browser:
    cargo fmu docs --open";

/// Examples of `chain`.
pub const CHAIN: &str = "\
Examples:
  Print the definition of a chain of 10 four-bar linkages:
    cargo fmu chain 10
  Write a chain of 40 four-bar linkages to a file:
    cargo fmu chain 40 --out chain.json";

/// Examples of `report`.
pub const REPORT: &str = "\
Examples:
  Recompute all results of the report:
    cargo fmu report
  Write the report to another folder:
    cargo fmu report --out results";

/// Examples of `dist`.
pub const DIST: &str = "\
Examples:
  Build a Python wheel for this machine, and test the wheel:
    cargo fmu dist --test
  Build a Python wheel for old Linux systems that packs FMUs for Linux and Windows:
    cargo fmu dist --platforms x86_64-linux,x86_64-windows --glibc 2.17";

/// Examples of `test`.
pub const TEST: &str = "\
Examples:
  Run all tests:
    cargo fmu test
  Test the libraries for other platforms with Wine and QEMU:
    cargo fmu test --platforms";

/// Examples of `bench`.
pub const BENCH: &str = "\
Examples:
  Measure the run times of the tables:
    cargo fmu bench
  Run the stress suite:
    cargo fmu bench stress

Benchmarks:
  (none)        run times of the tables
  importers     the landing gear in FMPy, libcosim, ECOS and fmi-sim
  studies       many runs with sweep, Dask, FMPy and MuJoCo
  module        runs and steps from Python, compared with FMPy, MuJoCo and EXUDYN; needs the wheel of `cargo fmu dist`
  peers         computing time and error, compared with other solvers and multibody programs
  realtime      the slowest step of each example; names of examples measure only these, without the page
  plots         figures from the CSV of the tables
  instructions  instruction counts of callgrind
  cosim         the packed FMUs, coupled by every scheme; options: --write (write the page of results), circuit
                (use a second, independent formulation of the circuit)
  stress        stress suite, and 600 random linkages of each property
  attack        tests with random histories, states and definitions; options: --minutes N, --seed S, --only PART,
                --count N, --threads N, --verbose, --write";

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use crate::{Cli, installed, words};
    use clap::{Command, CommandFactory};
    use std::ffi::OsString;

    /// The command lines in the examples of all commands.
    fn lines(command: &Command, program: &str) -> Vec<String> {
        let mut all = Vec::new();
        for task in command.get_subcommands().filter(|task| !task.is_hide_set()) {
            let text = task.get_after_help().unwrap().to_string().replace("\\\n", "");
            let own: Vec<String> =
                text.lines().map(str::trim).filter(|line| line.starts_with(program)).map(String::from).collect();
            assert!(own.len() >= 2, "{}", task.get_name());
            assert!(own.iter().all(|line| line.starts_with(&format!("{program} {}", task.get_name()))));
            all.extend(own);
        }
        all
    }

    #[test]
    fn every_example_is_a_command_that_is_accepted() {
        for (command, program) in [(Cli::command(), "cargo fmu"), (installed::command(), installed::PROGRAM)] {
            for line in lines(&command, program) {
                let given = line.strip_prefix(program).unwrap().split_whitespace();
                let given = words::joined(["program"].into_iter().chain(given).map(OsString::from));
                let read = command.clone().try_get_matches_from(given);
                assert!(read.is_ok(), "{line}: {}", read.unwrap_err());
            }
        }
    }
}
