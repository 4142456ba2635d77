//! Expressions compared with the same arithmetic in Rust, and texts that are not expressions.
use super::*;
use proptest::prelude::*;

fn value(text: &str) -> f64 {
    let expression = Expression::new(text).unwrap_or_else(|why| panic!("{text}: {why}"));
    expression.evaluate(|index| [3.0, -0.25, 7.5][index])
}

#[test]
fn precedence_is_the_usual_one() {
    for (text, expected) in [
        ("-2^2", -4.0),
        ("-x^2", -9.0),
        ("2*-x^2", -18.0),
        ("2 - -3", 5.0),
        ("-(2)^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^(-1)", 0.5),
        ("8/4/2", 1.0),
        ("2-3-4", -5.0),
        ("x/2*3", 4.5),
        ("-2*3", -6.0),
        ("+4", 4.0),
        ("1e-3*2", 0.002),
        ("1.5E+2", 150.0),
        ("sqrt(4)^2", 4.0),
        ("-sqrt(4)^2", -4.0),
        ("2*atan2(0, 1)^2 + 1", 1.0),
        ("min(2, -3)", -3.0),
        ("max(x, 2) - hypot(3, 4)", -2.0),
        ("sqrt(min(atan2(0, 1), hypot(0, max(1, 2))))", 0.0),
        ("cos(pi)", -1.0),
        ("ln(e)", 1.0),
        ("rad(180) / pi", 1.0),
        ("a.b_c + 1", 4.0),
        ("x + y + x", 5.75),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
    // Sums from left to right: the two sums differ in the last bit.
    assert_eq!(value("0.1+0.2+0.3"), 0.1 + 0.2 + 0.3);
    assert_eq!(value("0.1+(0.2+0.3)"), 0.1 + (0.2 + 0.3));
    assert_eq!(value("0.1*3*x"), 0.1 * 3.0 * 3.0);
    assert!(value("0/0").is_nan() && value("1/0").is_infinite() && value("max(0/0, 1)").is_nan());
}

#[test]
fn texts_that_are_not_expressions_give_named_errors() {
    for (text, said) in [
        ("", "the text is empty"),
        (" ", "the text is empty"),
        ("2 x", "an operator is missing before `x`"),
        ("2(3)", "an operator is missing before `(`"),
        ("f(3)", "`f` is not a function: use one of the functions sqrt"),
        ("sin x", "write sin(...)"),
        ("sin", "write sin(...)"),
        ("sin()", "a value is missing before `)`"),
        ("sin(1, 2)", "with a point"),
        ("0,5", "with a point"),
        ("atan2(1)", "`atan2` needs 2 values"),
        ("min(1, 2, 3)", "`min` needs 2 values"),
        ("(1", "`)` is missing"),
        ("1)", "has no matching"),
        ("1 +", "the expression ends with an operator"),
        ("* 2", "a value is missing before `*`"),
        ("2^-1", "put the signed value in parentheses"),
        ("--2", "`-` follows another sign: write one sign, or"),
        ("2 * -+x", "`+` follows another sign: write one sign"),
        ("2^3^2", "two powers follow each other"),
        ("1.2.3", "`1.2.3` is not a finite number"),
        ("1e400", "not a finite number"),
        ("2 % 3", "`%` is not allowed in an expression"),
        ("2 * größe", "`ö` is not allowed in an expression"),
        ("{x}", "`{` is not allowed in an expression"),
        ("a\u{0}", "is not allowed in an expression"),
    ] {
        let why = Expression::new(text).unwrap_err();
        assert!(why.contains(said), "{text}: {why}");
    }
    let deep = "(".repeat(40) + "1" + &")".repeat(40);
    assert!(Expression::new(&deep).unwrap_err().contains("30 parentheses"));
    assert!(Expression::new(&"1+".repeat(600)).unwrap_err().contains("1000"));
    assert_eq!(value(&("1+".repeat(499) + "1")), 500.0);
    assert_eq!(value(&("sin(".repeat(30) + "0" + &")".repeat(30))), 0.0);
}

/// An expression as a tree, with its value and its text.
#[derive(Clone, Debug)]
enum Tree {
    Number(f64),
    Name(usize),
    Negative(Box<Tree>),
    Operation(char, Box<Tree>, Box<Tree>),
    Root(Box<Tree>),
    Angle(Box<Tree>, Box<Tree>),
}

impl Tree {
    fn value(&self, names: [f64; 3]) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Name(index) => names[*index],
            Self::Negative(of) => -of.value(names),
            Self::Root(of) => of.value(names).sqrt(),
            Self::Angle(y, x) => y.value(names).atan2(x.value(names)),
            Self::Operation(operator, a, b) => {
                let (a, b) = (a.value(names), b.value(names));
                match operator {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    _ => a / b,
                }
            }
        }
    }

    /// The text with the necessary parentheses. `binds` is the lowest precedence without parentheses.
    fn text(&self, binds: u8) -> String {
        let (strength, text) = match self {
            Self::Number(number) => (3, number.to_string()),
            Self::Name(index) => (3, ["a", "b.c", "d_1"][*index].to_owned()),
            Self::Negative(of) => (0, format!("-{}", of.text(2))),
            Self::Root(of) => (3, format!("sqrt({})", of.text(0))),
            Self::Angle(y, x) => (3, format!("atan2({},{})", y.text(0), x.text(0))),
            Self::Operation(operator @ ('+' | '-'), a, b) => (0, format!("{} {operator} {}", a.text(0), b.text(1))),
            Self::Operation(operator, a, b) => (1, format!("{}{operator}{}", a.text(1), b.text(2))),
        };
        if strength < binds { format!("({text})") } else { text }
    }
}

fn trees() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![(0.0..1e3).prop_map(Tree::Number), (0_usize..3).prop_map(Tree::Name)];
    leaf.prop_recursive(5, 24, 2, |inner| {
        let two = (inner.clone(), inner.clone());
        prop_oneof![
            (proptest::sample::select(vec!['+', '-', '*', '/']), two.clone())
                .prop_map(|(operator, (a, b))| Tree::Operation(operator, a.into(), b.into())),
            inner.clone().prop_map(|of| Tree::Negative(of.into())),
            inner.prop_map(|of| Tree::Root(of.into())),
            two.prop_map(|(y, x)| Tree::Angle(y.into(), x.into())),
        ]
    })
}

proptest! {
    #[test]
    fn a_value_is_that_of_the_arithmetic_written_out(tree in trees(), names in [-9.0..9.0, -9.0..9.0, -9.0..9.0]) {
        let text = tree.text(0);
        prop_assume!(text.len() <= LONGEST_EXPRESSION);
        let expression = Expression::new(&text).unwrap_or_else(|why| panic!("{text}: {why}"));
        let of = |index: usize| names[["a", "b.c",
            "d_1"].iter().position(|n| n == &expression.names()[index]).unwrap()];
        let (found, expected) = (expression.evaluate(of), tree.value(names));
        prop_assert!(found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan(), "{}: {} {}", text,
            found, expected);
    }

    #[test]
    fn any_text_is_read_without_a_panic(text in "[-+*/^(),.0-9a-z{}~ éE]{0,60}") {
        if let Ok(expression) = Expression::new(&text) {
            expression.evaluate(|_| 1.5);
        }
    }
}
