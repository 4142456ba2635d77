//! Where in a JSON text a parser stopped, as the path of a key.
//!
//! serde's messages give line and column; in a list of like bodies the path says more, and it is what the checks after
//! parsing name too.

/// One level of nesting.
enum Level {
    /// In an object, after this key; before the first key none.
    Object(Option<String>),
    /// In an array, at this place.
    Array(usize),
}

/// Path, such as `bodies.crank.points.tip[1]`, of what stands at a line and column (both from 1, columns in bytes).
/// Empty at the top. Text that is not JSON is read as far as it makes sense.
pub fn key_at(text: &str, line: usize, column: usize) -> String {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let mut levels: Vec<Level> = Vec::new();
    // What stands last, the bracket that ends an object say, is still of its inside.
    let mut bytes = text.bytes().enumerate().take((start + column).saturating_sub(1)).peekable();
    // A string is a key if an object expects one: after its opening bracket or a comma.
    let mut expects_key = false;
    while let Some((at, byte)) = bytes.next() {
        match byte {
            b'{' => {
                levels.push(Level::Object(None));
                expects_key = true;
            }
            b'[' => {
                levels.push(Level::Array(0));
                expects_key = false;
            }
            b'}' | b']' => {
                levels.pop();
                expects_key = false;
            }
            b',' => match levels.last_mut() {
                Some(Level::Object(_)) => expects_key = true,
                Some(Level::Array(place)) => *place += 1,
                None => {}
            },
            b'"' => {
                let mut end = at + 1;
                while let Some((next, byte)) = bytes.next() {
                    end = next;
                    match byte {
                        b'\\' => drop(bytes.next()),
                        b'"' => break,
                        _ => end = next + 1,
                    }
                }
                if let (true, Some(Level::Object(key))) = (expects_key, levels.last_mut()) {
                    *key = text.get(at + 1..end).map(str::to_owned);
                    expects_key = false;
                }
            }
            _ => {}
        }
    }
    // At the end of an object or array it is the whole of it that is at fault: a key or a number is missing.
    match text.as_bytes().get((start + column).saturating_sub(1)) {
        Some(b'}') => {
            if let Some(Level::Object(key)) = levels.last_mut() {
                *key = None;
            }
        }
        Some(b']') => drop(levels.pop_if(|level| matches!(level, Level::Array(_)))),
        _ => {}
    }
    let mut path = String::new();
    for level in &levels {
        match level {
            Level::Object(Some(key)) => {
                if !path.is_empty() {
                    path.push('.');
                }
                path.push_str(key);
            }
            Level::Object(None) => {}
            Level::Array(place) => path.push_str(&format!("[{place}]")),
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Path where serde_json stops.
    fn stops_at(text: &str) -> String {
        let error = super::super::Mechanism::parse(text).unwrap_err();
        key_at(text, error.line(), error.column())
    }

    #[test]
    fn the_path_leads_to_the_fault() {
        for (text, path) in [
            (r#"{"name": 1}"#, "name"),
            (r#"{"description": "{[\"", "name": 1}"#, "name"),
            (r#"{"bodies": {"a": {}, "b": {"mass": true}}}"#, "bodies.b.mass"),
            (r#"{"bodies": {"b": {"center": [0, "y"]}}}"#, "bodies.b.center[1]"),
            (r#"{"bodies": {"b": {"points": {"tip": [0]}}}}"#, "bodies.b.points.tip"),
            (r#"{"bodies": {"b": {"lenght": 1}}}"#, "bodies.b.lenght"),
            (r#"{"joints": {"j": {"type": "hinge"}}}"#, "joints.j.type"),
            (
                r#"{"joints": {"i": {"type": "revolute", "first": "a", "second": "b"}, "j": {"type": "revolute"}}}"#,
                "joints.j",
            ),
            ("{\"start\":\n  {\"angle\":\n  \"a\"}}", "start.angle"),
            ("[", ""),
            ("{", ""),
        ] {
            let found = stops_at(text);
            assert!(found == path, "{text}: {found} where {path} was expected");
        }
    }
}
