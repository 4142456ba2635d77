//! Tests of the reader of JSON against serde_json, and of its messages.
#![allow(clippy::unwrap_used)]
use super::*;
use proptest::prelude::*;
use serde_json::Value;

/// Whether the values are those of serde_json, with numbers as doubles.
fn same(node: &Node, value: &Value, text: &str) -> bool {
    match (&node.json, value) {
        (Json::Null, Value::Null) => true,
        (Json::Flag(a), Value::Bool(b)) => a == b,
        (Json::Number(a), b) => b.as_f64() == Some(*a),
        (Json::Text(a), Value::String(b)) => a == b && text[node.span.clone()].starts_with('"'),
        (Json::List(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b, text)),
        (Json::Object(a), Value::Object(b)) => {
            // serde_json keeps the last of several members with the same name.
            b.iter().all(|(key, b)| a.iter().rev().find(|a| a.key == *key).is_some_and(|a| same(&a.value, b, text)))
                && a.iter().all(|a| b.contains_key(&a.key))
        }
        _ => false,
    }
}

fn agrees(text: &str) {
    match (parse("test", text), serde_json::from_str::<Value>(text)) {
        (Ok(node), Ok(value)) => assert!(same(&node, &value, text), "{text}: {node:?} where {value} was expected"),
        (Err(_), Err(_)) => {}
        // A number that is too large for a double is accepted here, with its key.
        (Ok(_), Err(error)) => assert!(error.to_string().contains("out of range"), "{text}: {error}"),
        (Err(error), Ok(_)) => panic!("{text}: {error}"),
    }
}

#[test]
fn texts_are_read_like_serde_json() {
    for text in [
        "",
        " ",
        "{",
        "}",
        "[1,]",
        "[,1]",
        "{\"a\":1,}",
        "{,}",
        "01",
        "-",
        "-0",
        "1.",
        ".5",
        "1e",
        "1e+",
        "1e5",
        "1E-400",
        "1e999",
        "+1",
        "0x1",
        "nul",
        "nulls",
        "true false",
        "\"\\ud834\\udd1e\"",
        "\"\\ud834\"",
        "\"\\udd1e\"",
        "\"\\ud834\\u0041\"",
        "\"\\u00e9\"",
        "\"\\u00g9\"",
        "\"\\x\"",
        "\"\n\"",
        "\"\\/\\b\\f\\n\\r\\t\\\\\\\"\"",
        "{\"a\" 1}",
        "{1:2}",
        "{\"a\":1 \"b\":2}",
        "[[[]]]",
        "{\"a\":{\"a\":[]},\"a\":2}",
        "\"é\u{7f}\"",
        "9007199254740993",
        "123456789012345678901234567890",
        "1 //",
        "5e-324",
        "2.2250738585072011e-308",
        "0.1e1",
        "[0.0,-0.0]",
    ] {
        agrees(text);
    }
    [1, 127, 200_000].into_iter().for_each(|deep| agrees(&("[".repeat(deep) + &"]".repeat(deep))));
}

proptest! {
    #[test]
    fn any_text_is_read_like_serde_json(
        text in "([\\[\\]{},:\"\\\\eE0-9.+ \n-]|true|null|\"a\"|\"a\":|\\\\u[0-9a-f]{3,4}|é){0,24}",
    ) {
        agrees(&text);
    }

    #[test]
    fn any_number_is_the_nearest_double(number in "-?(0|[1-9][0-9]{0,24})(\\.[0-9]{1,24})?([eE][+-]?[0-9]{1,3})?") {
        agrees(&number);
    }
}

#[test]
fn invalid_json_gives_an_error_with_path_and_place() {
    for (text, said, place) in [
        ("", "not a valid test: the file is empty", [1, 1]),
        (" \n", "not a valid test: the file is empty", [2, 1]),
        ("{ \"a\": 1", "not a valid test: the text ends before its last closing bracket", [1, 9]),
        ("{ // none\n}", "not a valid test: JSON has no comments", [1, 3]),
        ("{ \"a\": 1 # none\n}", "not a valid test: JSON has no comments", [1, 10]),
        ("{ \"a\": NaN }", "a: JSON has no NaN", [1, 8]),
        ("{ \"a\": [1, -Infinity] }", "a[1]: ", [1, 13]),
        ("{ \"a\": 0,5 }", "not a valid test: write decimals with a point", [1, 10]),
        ("{ \"a\": { \"b\": [1,] } }", "a.b[1]: a comma stands before the closing bracket", [1, 18]),
        ("{} }", "surplus closing bracket", [1, 4]),
        ("{ a: 1 }", "a key in double quotes", [1, 3]),
    ] {
        let fault = parse("test", text).unwrap_err();
        let message = fault.to_string();
        let [line, column] = place;
        assert!(message.contains(said), "{text}: {message}");
        assert!(message.ends_with(&format!("(line {line}, column {column})")), "{text}: {message}");
    }
}
