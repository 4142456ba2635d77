//! The command line of an installed program: `linkage-fmu`, with the tasks of `cargo fmu` that need no source.
//!
//! In: the command line of `cargo fmu`. Out: the same command line with the other name, and with the folders in which
//! an installed program writes.
use crate::{Cli, Task, words};
use clap::{Command, CommandFactory, FromArgMatches};
use std::ffi::OsString;

/// Name of the program.
pub const PROGRAM: &str = "linkage-fmu";

/// Tasks that need the source.
const OF_THE_SOURCE: [&str; 5] = ["docs", "report", "dist", "test", "bench"];

/// Name of a task that needs the source. None for all other tasks.
pub fn needs_source(task: &Task) -> Option<&'static str> {
    match task {
        Task::Demo(demo) if demo.gallery => Some("demo --gallery"),
        Task::Docs(_) => Some("docs"),
        Task::Report(_) => Some("report"),
        Task::Dist(_) => Some("dist"),
        Task::Test(_) => Some("test"),
        Task::Bench(_) => Some("bench"),
        _ => None,
    }
}

/// The task in these words, of which the first is the name of the program. Help and wrong usage are answered and end
/// the program.
pub fn parse(words: Vec<OsString>) -> Cli {
    let matches = command().get_matches_from(words::joined(words));
    Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.format(&mut command()).exit())
}

/// The command line. Tasks that need the source are hidden. They are parsed, so that an error message can name them.
pub fn command() -> Command {
    let mut command = Cli::command().name(PROGRAM).bin_name(PROGRAM).about("Pack, check, run and draw mechanisms");
    for name in OF_THE_SOURCE {
        command = command.mut_subcommand(name, |task| task.hide(true));
    }
    command = command.mut_subcommands(|task| match task.get_after_help().map(ToString::to_string) {
        Some(examples) => task.after_help(examples.replace("cargo fmu", PROGRAM)),
        None => task,
    });
    let helps = [
        (
            "package",
            "paths",
            "Definition file (mechanism.json), or folder that contains a definition file [default: the landing gear of \
             the program]",
        ),
        (
            "package",
            "all",
            "Pack every example mechanism that the program contains, and the example system of landing gear and \
             hydraulic actuator",
        ),
        ("package", "out", "Folder for the FMUs [default: the current folder]"),
        (
            "package",
            "platforms",
            "Platforms on which the FMU must run, separated by commas; the program must contain their libraries \
             [default: this machine]",
        ),
        (
            "package",
            "available",
            "Pack the libraries of those platforms that the program contains, and list the missing platforms [default: \
             a missing platform is an error]",
        ),
        (
            "package",
            "glibc",
            "Oldest version of glibc (the C library of Linux) with which the libraries for Linux must load; a library \
             that needs a newer version is an error",
        ),
        ("demo", "out", "Folder for the results [default: the current folder]"),
        ("view", "out", "File for the page, or folder in which <Name>.html is written [default: the current folder]"),
        (
            "optimise",
            "out",
            "Folder for the results: best design, its picture and evaluations.parquet [default: a folder with the name \
             of the study, in the current folder]",
        ),
        (
            "sweep",
            "out",
            "Folder for the results, such as runs.parquet [default: a folder with the name of the study, in the \
             current folder]",
        ),
    ];
    for (task, argument, help) in helps {
        command = command.mut_subcommand(task, |task| task.mut_arg(argument, |argument| argument.help(help)));
    }
    // The mechanisms of the gallery are in the source.
    command = command.mut_subcommand("demo", |task| task.mut_arg("gallery", |argument| argument.hide(true)));
    // A static library is built from the source.
    command = command.mut_subcommand("package", |task| task.mut_arg("statics", |argument| argument.hide(true)));
    command
        .mut_subcommand("package", |task| task.about("Pack each mechanism as an FMU: <Name>.fmu and <Name>.fmi3.fmu"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn help_lists_the_commands_of_an_installation() {
        let mut command = command();
        command.build();
        let mut helps = vec![command.render_long_help().to_string()];
        helps.extend(
            command
                .get_subcommands_mut()
                .filter(|task| !task.is_hide_set())
                .map(|task| task.render_long_help().to_string()),
        );
        assert!(helps.len() > 8 && helps[0].contains("Usage: linkage-fmu <COMMAND>"), "{}", helps[0]);
        for help in helps {
            for word in ["cargo", "target/", "repository", "Rust", "zig"] {
                assert!(!help.contains(word), "{word} in: {help}");
            }
        }
    }

    #[test]
    fn tasks_of_the_source_are_hidden_and_known() {
        let command = command();
        let hidden: Vec<&str> =
            command.get_subcommands().filter(|task| task.is_hide_set()).map(Command::get_name).collect();
        assert_eq!(hidden.len(), OF_THE_SOURCE.len());
        for name in hidden {
            let cli = Cli::from_arg_matches(&command.clone().get_matches_from([PROGRAM, name])).unwrap();
            assert_eq!(needs_source(&cli.task), Some(name));
        }
        for (words, named) in
            [(&["package"][..], None), (&["demo"], None), (&["demo", "--gallery"], Some("demo --gallery"))]
        {
            let matches = command.clone().get_matches_from([&[PROGRAM], words].concat());
            assert_eq!(needs_source(&Cli::from_arg_matches(&matches).unwrap().task), named);
        }
    }
}
