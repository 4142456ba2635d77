//! Remedies for wrong command lines.
//!
//! In: the words of a command line, and clap's error. Out: the error with a remedy. The tip of clap to pass an unknown
//! option as a value helps in none of the tasks.

use crate::{Cli, words};
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, CommandFactory, Error, Parser};
use std::ffi::OsString;

/// The command line of this program. A wrong one ends the program with a message.
pub fn parsed() -> Cli {
    let words = words::given();
    Cli::try_parse_from(&words).unwrap_or_else(|error| with_tip(error, &words).exit())
}

/// The error with a remedy for these words.
fn with_tip(mut error: Error, words: &[OsString]) -> Error {
    let words: Vec<&str> = words.iter().filter_map(|word| word.to_str()).collect();
    let command = Cli::command();
    let task = words.get(1).and_then(|task| command.find_subcommand(task));
    let options: Vec<(&str, &Arg)> =
        task.into_iter().flat_map(|task| task.get_arguments()).filter_map(|arg| Some((arg.get_long()?, arg))).collect();
    let named = |name: &str| options.iter().find(|(option, _)| *option == name);
    let tip = match (error.kind(), error.get(ContextKind::InvalidArg)) {
        (ErrorKind::UnknownArgument, Some(ContextValue::String(wrong))) => {
            let single = words.iter().filter_map(|word| word.strip_prefix('-')).find(|name| named(name).is_some());
            let variable = wrong.strip_prefix("--").filter(|_| named("start-values").is_some());
            match (single, variable) {
                (Some(name), _) => Some(format!("write two hyphens: --{name}")),
                (None, Some(name)) => Some(format!("to set a variable, write --start-values {name} VALUE")),
                (None, None) => None,
            }
        }
        (ErrorKind::MissingRequiredArgument, _) => {
            let takes_all = |word: &&&str| {
                let option = word.strip_prefix("--").and_then(named);
                option.is_some_and(|(_, arg)| arg.get_num_args().is_some_and(|count| count.max_values() > 1))
            };
            let option = words.iter().find(takes_all);
            option.map(|option| format!("write the path before {option}, which takes all words that follow"))
        }
        _ => None,
    };
    if error.kind() == ErrorKind::UnknownArgument {
        error.remove(ContextKind::Suggested);
    }
    if let Some(tip) = tip {
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![StyledStr::from(tip)]));
    }
    error
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_command_line_has_its_remedy() {
        for (line, said) in [
            ("fmu simulate gear.json -start-values a 3", "tip: write two hyphens: --start-values"),
            (
                "fmu simulate gear.json --load_factor 3",
                "tip: to set a variable, write --start-values load_factor VALUE",
            ),
            ("fmu simulate --output-variables leg.angle gear.json", "tip: write the path before --output-variables"),
            ("fmu simulate gear.json --output-fil a.csv", "'--output-file'"),
        ] {
            let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            let error = with_tip(Cli::try_parse_from(&words).err().unwrap(), &words).to_string();
            assert!(error.contains(said) && !error.contains("as a value"), "{line}: {error}");
        }
    }
}
