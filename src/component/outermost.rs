//! Keys of a definition file before its kind is known.

/// Keys of the outermost object of a text: words in quotation marks followed by a colon. The text may be invalid JSON.
pub fn outermost_keys(text: &str) -> Vec<&str> {
    let (mut keys, mut depth, mut rest) = (Vec::new(), 0, text);
    while let Some(at) = rest.find(['{', '}', '[', ']', '"']) {
        let (found, after) = (rest.as_bytes()[at], &rest[at + 1..]);
        rest = after;
        match found {
            b'{' | b'[' => depth += 1,
            b'}' | b']' => depth -= 1,
            _ => {
                let mut escaped = false;
                let end = after.find(|c: char| {
                    let ends = !escaped && (c == '"' || c == '\n');
                    escaped = !escaped && c == '\\';
                    ends
                });
                let Some(end) = end else { break };
                rest = &after[end + 1..];
                if depth == 1 && rest.trim_start().starts_with(':') {
                    keys.push(&after[..end]);
                }
            }
        }
    }
    keys
}
