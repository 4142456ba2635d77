//! Damaged `mechanism.json` texts: each text gives a mechanism or a message, without a panic and in bounded time.
//!
//! The texts are the same in each run, unless LINKAGE_FMU_CASES sets the number of texts of each kind:
//! `LINKAGE_FMU_CASES=20000 cargo test --test engine mechanism_fuzz -- --nocapture`.

use crate::support::{CRANE, FOUR_BAR, GEAR, JIB, SLIDER_CRANK, cases, reals, replaced as changed, runner};
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::Causality;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use serde_json::Value;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// Texts of each kind by default.
const CASES: u32 = 150;
/// Time limit for one text, for a busy machine.
const PATIENCE: Duration = Duration::from_secs(20);

const MECHANISMS: [&str; 5] = [GEAR, SLIDER_CRANK, FOUR_BAR, JIB, CRANE];

/// Replacements of a number.
const NUMBERS: &str = "0 -0 -1 1 1e-6 1e-3 1e3 -1e3 1e6 1e999 NaN Infinity -Infinity 0x1 true \"1\" null";
/// Numbers that fit in 64 bits but are absurd in a mechanism.
const ABSURD: [&str; 10] =
    ["1e17", "-1e17", "1e150", "-1e155", "1e200", "1e308", "-1e308", "1e-160", "1e-308", "5e-324"];

/// A thread that reads texts and returns the outcome, or the message of a panic.
struct Worker {
    texts: Sender<String>,
    outcomes: Receiver<Result<bool, String>>,
}

impl Worker {
    fn new() -> Self {
        let (texts, inbox) = channel::<String>();
        let (outbox, outcomes) = channel();
        std::thread::spawn(move || {
            for text in inbox {
                let outcome = catch_unwind(AssertUnwindSafe(|| read(&text)));
                let _ = outbox.send(outcome.map_err(|payload| match payload.downcast::<String>() {
                    Ok(message) => *message,
                    Err(payload) => payload.downcast_ref::<&str>().copied().unwrap_or_default().to_owned(),
                }));
            }
        });
        Worker { texts, outcomes }
    }
}

/// Read a text and, if it is a mechanism, initialise it. Returns whether it is a mechanism.
fn read(text: &str) -> bool {
    let mut model = match Model::from_json(text) {
        Ok(model) => model,
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && !message.contains('\n'), "{message}");
            return false;
        }
    };
    model.initialize().unwrap();
    for reference in reals(&model, Causality::Output) {
        let name = &model.variables().list()[reference as usize].name;
        // Forces and moments would build the tables of the reactions.
        if name.contains("force") || name.contains("moment") {
            continue;
        }
        let value = model.real(reference).unwrap();
        assert!(value.is_finite() || value.is_nan() && model.undefined(reference).is_some(), "{value}");
    }
    true
}

/// Run texts of one kind.
fn run(kind: &str, texts: impl Strategy<Value = String>) {
    let cases = cases().unwrap_or(CASES);
    let worker = Worker::new();
    let (mechanisms, longest) = (Cell::new(0_u32), Cell::new(Duration::ZERO));
    let start = Instant::now();
    let mut runner = runner(CASES);
    let result = runner.run(&texts, |text| {
        let start = Instant::now();
        worker.texts.send(text.clone()).unwrap();
        // After a timeout the worker never answers. The text is printed without shrinking.
        let outcome = worker.outcomes.recv_timeout(PATIENCE).unwrap_or_else(|_| {
            eprintln!("{kind}: no answer within {PATIENCE:?} to\n{text}");
            std::process::exit(101);
        });
        longest.set(longest.get().max(start.elapsed()));
        match outcome {
            Ok(is_mechanism) => mechanisms.set(mechanisms.get() + u32::from(is_mechanism)),
            Err(message) => return Err(TestCaseError::fail(format!("panic: {message}"))),
        }
        Ok(())
    });
    println!(
        "{kind}: {cases} texts, {} of them mechanisms, {:.1} s, longest {:.2?}",
        mechanisms.get(),
        start.elapsed().as_secs_f64(),
        longest.get()
    );
    result.unwrap_or_else(|error| panic!("{kind}: {error}"));
}

fn mechanism() -> impl Strategy<Value = &'static str> {
    select(&MECHANISMS[..])
}

/// Ranges of bytes of all numbers outside of strings in a text.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let (mut found, mut quoted, mut start) = (Vec::new(), false, None);
    for (at, c) in text.char_indices() {
        quoted ^= c == '"';
        let part = !quoted && (c.is_ascii_digit() || "+-.eE".contains(c));
        match (part, start) {
            (true, None) if c.is_ascii_digit() || c == '-' => start = Some(at),
            (false, Some(first)) => {
                found.push((first, at));
                start = None;
            }
            _ => {}
        }
    }
    found
}

#[test]
fn bytes_are_changed() {
    let edit = (any::<Index>(), prop_oneof![any::<u8>(), select(&b"{}[]\",:0123456789-.eE \\u"[..])], 0..3);
    let text = (mechanism(), prop::collection::vec(edit, 1..6)).prop_map(|(text, edits)| {
        let mut bytes = text.as_bytes().to_vec();
        for (index, byte, kind) in edits {
            let at = index.index(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ => drop(bytes.remove(at)),
            }
        }
        String::from_utf8_lossy(&bytes).into_owned()
    });
    run("bytes", text);
}

/// Texts with some numbers replaced. `write` returns the replacement of a number.
fn edited<T: std::fmt::Debug>(
    edit: impl Strategy<Value = T>,
    write: impl Fn(&str, T) -> String,
) -> impl Strategy<Value = String> {
    (mechanism(), prop::collection::vec((any::<Index>(), edit), 1..4)).prop_map(move |(text, edits)| {
        edits.into_iter().fold(text.to_owned(), |text, (index, edit)| {
            let numbers = numbers(&text);
            let (first, last) = numbers[index.index(numbers.len())];
            format!("{}{}{}", &text[..first], write(&text[first..last], edit), &text[last..])
        })
    })
}

fn replaced(number: impl Strategy<Value = String>) -> impl Strategy<Value = String> {
    edited(number, |_, number| number)
}

#[test]
fn numbers_are_replaced() {
    let odd = select(NUMBERS.split(' ').collect::<Vec<_>>()).prop_map(str::to_owned);
    run("numbers", replaced(prop_oneof![odd, (-3.0..3.0).prop_map(|x: f64| x.to_string())]));
}

#[test]
fn numbers_are_scaled() {
    let scaled =
        |number: &str, exponent: f64| format!("{:e}", number.parse::<f64>().unwrap_or(1.0) * 10_f64.powf(exponent));
    run("scales", edited(-4.0..4.0, scaled));
}

#[test]
fn numbers_are_absurd() {
    let absurd = select(&ABSURD[..]).prop_map(str::to_owned);
    run("absurd", replaced(prop_oneof![absurd, any::<f64>().prop_map(|x| format!("{x:e}"))]));
}

#[test]
fn a_length_that_overflows_when_squared_and_lengths_of_very_different_size() {
    let ground = r#""ground": { "length": "#;
    run("overflow", Just(changed(FOUR_BAR, &[(&format!("{ground}0.3 }}"), &format!("{ground}1e308 }}"))])));
    let lengths = [(r#""length": 0.05"#, r#""length": 1e3"#), (r#""length": 0.2"#, r#""length": 1e308"#)];
    run("graded", Just(changed(SLIDER_CRANK, &lengths)));
}

/// JSON pointers of the members of all objects.
fn pointers(value: &Value, at: &str, found: &mut Vec<String>) {
    if let Value::Object(members) = value {
        for (key, member) in members {
            let pointer = format!("{at}/{key}");
            found.push(pointer.clone());
            pointers(member, &pointer, found);
        }
    }
}

/// The text with the member at `pointer` removed or duplicated.
fn with_member(mut value: Value, pointer: &str, copies: usize) -> String {
    let (object, key) = pointer.rsplit_once('/').unwrap();
    let object = value.pointer_mut(object).unwrap().as_object_mut().unwrap();
    let member = object.remove(key).unwrap();
    // An object holds each key once. The copies get temporary names, which are then replaced in the text.
    let names = ["first copy", "second copy"];
    names[..copies].iter().for_each(|name| drop(object.insert((*name).to_owned(), member.clone())));
    names.iter().fold(value.to_string(), |text, name| text.replace(name, key))
}

fn members(text: &str) -> (Value, Vec<String>) {
    let value: Value = serde_json::from_str(text).unwrap();
    let mut found = Vec::new();
    pointers(&value, "", &mut found);
    (value, found)
}

#[test]
fn members_are_removed_or_doubled() {
    let text = (mechanism(), any::<Index>(), select(&[0_usize, 0, 2][..])).prop_map(|(text, index, copies)| {
        let (value, found) = members(text);
        with_member(value, &found[index.index(found.len())], copies)
    });
    run("members", text);
}

#[test]
fn members_are_exchanged() {
    let text = (mechanism(), mechanism(), any::<Index>(), any::<Index>()).prop_map(|(text, other, index, source)| {
        let (mut value, found) = members(text);
        let (other, sources) = members(other);
        let member = other.pointer(&sources[source.index(sources.len())]).unwrap().clone();
        *value.pointer_mut(&found[index.index(found.len())]).unwrap() = member;
        value.to_string()
    });
    run("exchanges", text);
}

/// Exchanged names of bodies and points: joints between wrong bodies, circles, loose parts.
#[test]
fn names_are_exchanged() {
    let text =
        (mechanism(), prop::collection::vec((any::<Index>(), any::<Index>()), 1..4)).prop_map(|(text, edits)| {
            edits.into_iter().fold(text.to_owned(), |text, (index, source)| {
                let quotes: Vec<_> = text.match_indices('"').map(|(at, _)| at).collect();
                let strings: Vec<_> = quotes.chunks_exact(2).map(|pair| (pair[0], pair[1] + 1)).collect();
                let ((a, b), (c, d)) = (strings[index.index(strings.len())], strings[source.index(strings.len())]);
                format!("{}{}{}", &text[..a], &text[c..d], &text[b..])
            })
        });
    run("names", text);
}

#[test]
fn texts_are_cut_nested_or_made_up() {
    let nested = (select(&["[", "{\"a\":", "{\"bodies\":{\"ground\":"][..]), 1..100_000_usize)
        .prop_map(|(open, depth)| open.repeat(depth));
    let inside = (mechanism(), any::<Index>(), 1..10_000_usize).prop_map(|(text, index, depth)| {
        let numbers = numbers(text);
        let (first, last) = numbers[index.index(numbers.len())];
        format!("{}{}1{}{}", &text[..first], "[".repeat(depth), "]".repeat(depth), &text[last..])
    });
    let cut = (mechanism(), any::<Index>()).prop_map(|(text, index)| text[..index.index(text.len())].to_owned());
    run("cut or nested", prop_oneof![nested, inside, cut, "\\PC{0,200}", "[\\[\\]{}:,\"0-9a-z ]{0,80}"]);
}
