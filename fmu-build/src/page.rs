//! The page `documentation/index.html` of an FMU: head and foot, which are the same for all.
//!
//! In: what a page says about one model. Out: a whole page.

/// Path of the page in an FMU.
pub const PATH: &str = "documentation/index.html";

const HEAD: &str = r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>NAME</title>
<style>
body { font-family: sans-serif; max-width: 52em; margin: 2em auto; padding: 0 1em; line-height: 1.4; }
table { border-collapse: collapse; }
th, td { border-bottom: 1px solid #ccc; padding: 0.25em 0.8em 0.25em 0; text-align: left; vertical-align: top; }
code { white-space: nowrap; }
</style>
</head>
<body>
<h1>NAME</h1>
"#;

const FOOT: &str = "
<h2>The numbers</h2>
<p>The numbers in <code>resources/FILE</code> may be edited in place: the file is read at every
instantiation. Parameters set through FMI win over the file.</p>
</body>
</html>
";

/// The page of the FMU `name`, a C identifier, with the definition file `file`, from the content of its body; a page
/// that is whole already stays as it is.
pub fn whole(name: &str, file: &str, content: Vec<u8>) -> Vec<u8> {
    let is_whole = content.windows(5).any(|tag| tag.eq_ignore_ascii_case(b"<html"));
    if is_whole {
        return content;
    }
    [HEAD.replace("NAME", name).into_bytes(), content, FOOT.replace("FILE", file).into_bytes()].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_becomes_a_page_and_a_page_stays() {
        let page = whole("Gear", "mechanism.json", b"<p>A gear.</p>\n".to_vec());
        let text = String::from_utf8(page.clone()).unwrap();
        assert!(text.starts_with("<!DOCTYPE html>") && text.contains("<h1>Gear</h1>\n<p>A gear.</p>"), "{text}");
        assert!(text.contains("<code>resources/mechanism.json</code>"), "{text}");
        assert_eq!(whole("Other", "other.json", page.clone()), page);
    }
}
