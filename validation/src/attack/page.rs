//! The page of the randomised tests: arguments, number of cases, results.
use super::{Asked, LONGEST, Outcome};
use crate::measure;
use std::fmt::{Display, Write};

/// One line for the terminal.
pub fn line(outcome: &Outcome) -> String {
    let Outcome { part, tally, seconds } = outcome;
    format!(
        "{}: {} cases in {seconds:.0} s, {} fail; longest call {:.3} s ({}, seed {})",
        part.name,
        tally.cases,
        tally.failures.len(),
        tally.longest.value,
        tally.longest.what,
        tally.longest.seed
    )
}

/// The page.
pub fn page(asked: &Asked, outcomes: &[Outcome]) -> String {
    let time = asked.minutes.map_or("a fixed number of cases".into(), |minutes| format!("{minutes} minutes"));
    let only: String = asked.only.iter().map(|part| format!(" --only {part}")).collect();
    let values: [(&str, &dyn Display); 5] =
        [("only", &only), ("time", &time), ("threads", &asked.threads), ("seed", &asked.seed), ("longest", &LONGEST)];
    let mut page = measure::page("attack", &values);
    page += &measure::heading(&["part", "claim", "cases", "fail", "longest call [s]", "in", "its seed", "[s]"]);
    for Outcome { part, tally, seconds } in outcomes {
        let longest = &tally.longest;
        let _ = writeln!(
            page,
            "| {} | {} | {} | {} | {:.3} | {} | {} | {seconds:.0} |",
            part.name,
            part.claim(),
            tally.cases,
            tally.failures.len(),
            longest.value,
            longest.what,
            longest.seed
        );
    }
    for Outcome { part, tally, .. } in outcomes {
        let counts: Vec<String> = tally.counts.iter().map(|(what, count)| format!("{count} {what}")).collect();
        let _ = writeln!(page, "\n**{}:** {}.", part.name, counts.join(", "));
        if tally.ratio.value > 0.0 {
            let ratio = &tally.ratio;
            let _ = writeln!(page, "Worst ratio {:.3} ({}), seed {}.", ratio.value, ratio.what, ratio.seed);
        }
        for (seed, why) in &tally.failures {
            let _ = writeln!(page, "- seed {seed}: {why}");
        }
    }
    page
}
