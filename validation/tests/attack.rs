//! The randomised tests in short: a fixed set of cases of each part.

use validation::attack::{Asked, all};

/// Number of cases of each part.
const CASES: [(&str, u64); 12] = [
    ("histories", 1000),
    ("coupled", 100),
    ("calls", 200),
    ("calls3", 250),
    ("exchange", 1500),
    ("states", 600),
    ("definitions", 500),
    ("scenes", 120),
    ("kinds", 15),
    ("metamorphic", 150),
    ("package", 20),
    ("threads", 12),
];

#[test]
fn some_cases_of_each_part_hold() {
    for (part, count) in CASES {
        let asked = Asked { only: vec![part.into()], count: Some(count), threads: 2, ..Asked::default() };
        let outcomes = all(&asked);
        assert_eq!(outcomes.len(), 1);
        let tally = &outcomes[0].tally;
        assert!(tally.failures.is_empty(), "{part}: {:?}", tally.failures);
        assert_eq!(tally.cases, count, "{part}");
        assert!(!tally.counts.is_empty(), "{part} did nothing");
    }
}

#[test]
fn unknown_arguments_are_rejected() {
    for words in [
        &["--minutes"][..],
        &["--minutes", "0"],
        &["--minutes", "NaN"],
        &["--seed", "-1"],
        &["--only", "nothing"],
        &["--only", "states", "--only", "calls", "--write"],
        &["histories"],
    ] {
        assert!(Asked::read(words).is_err(), "{words:?}");
    }
    let asked = Asked::read(&["--seed", "7", "--only", "states", "--count", "3", "--minutes", "0.5"]).unwrap();
    assert_eq!(
        (asked.seed, asked.count, asked.minutes, asked.only),
        (7, Some(3), Some(0.5), vec!["states".to_owned()])
    );
}
