//! Converts a user's Markdown text to harmless HTML.
//!
//! In: CommonMark with tables. Out: HTML without scripts, pictures or foreign elements. Raw HTML is shown as text. Only
//! links to the web and to mail addresses remain links.

use pulldown_cmark::{Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};

/// Prefixes of addresses that work within an FMU.
const ADDRESSES: [&str; 3] = ["https://", "http://", "mailto:"];

/// The HTML of a text. Its headings start at the third level, below those of the page.
pub fn to_html(text: &str) -> String {
    // For each open link: whether it is kept.
    let mut links = Vec::new();
    let events = Parser::new_ext(text, Options::ENABLE_TABLES | Options::ENABLE_STRIKETHROUGH).filter_map(|event| {
        Some(match event {
            Event::Html(raw) | Event::InlineHtml(raw) => Event::Text(raw),
            Event::Start(Tag::HtmlBlock) => Event::Start(Tag::Paragraph),
            Event::End(TagEnd::HtmlBlock) => Event::End(TagEnd::Paragraph),
            Event::Start(Tag::Link { ref dest_url, .. }) => {
                let address = dest_url.to_ascii_lowercase();
                links.push(ADDRESSES.iter().any(|beginning| address.starts_with(beginning)));
                return links.last().copied().unwrap_or(false).then_some(event);
            }
            Event::End(TagEnd::Link) => return links.pop().unwrap_or(false).then_some(event),
            // The alternative text of a picture remains.
            Event::Start(Tag::Image { .. }) | Event::End(TagEnd::Image) => return None,
            Event::Start(Tag::Heading { level, .. }) => {
                let (id, classes, attrs) = (None, Vec::new(), Vec::new());
                Event::Start(Tag::Heading { level: lower(level), id, classes, attrs })
            }
            Event::End(TagEnd::Heading(level)) => Event::End(TagEnd::Heading(lower(level))),
            other => other,
        })
    });
    let mut out = String::with_capacity(2 * text.len());
    html::push_html(&mut out, events);
    // Every `<` of the text is escaped, so these are the heads of columns.
    out.replace("<th ", "<th scope=\"col\" ").replace("<th>", "<th scope=\"col\">")
}

/// The heading two levels below.
fn lower(level: HeadingLevel) -> HeadingLevel {
    match level {
        HeadingLevel::H1 => HeadingLevel::H3,
        HeadingLevel::H2 => HeadingLevel::H4,
        HeadingLevel::H3 => HeadingLevel::H5,
        _ => HeadingLevel::H6,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_becomes_html_and_html_stays_text() {
        let html = to_html("# Title\n\nAn *angle* of `a < b`.\n\n| x | y |\n|---|---|\n| 1 | 2 |\n");
        assert!(html.contains("<h3>Title</h3>") && html.contains("<em>angle</em>"), "{html}");
        assert!(html.contains("<code>a &lt; b</code>") && html.contains("<td>1</td>"), "{html}");
        assert!(html.contains("<th scope=\"col\">x</th>"), "{html}");
        let html = to_html("<script>alert(1)</script>\n\ntext <b onclick=x>bold</b> <!-- --> &lt;i&gt;\n\n<img src=x>");
        assert!(!html.contains("<script") && !html.contains("<b ") && !html.contains("<img"), "{html}");
        assert!(html.contains("&lt;script&gt;alert(1)&lt;/script&gt;"), "{html}");
    }

    #[test]
    fn only_links_that_lead_somewhere_are_links() {
        let html = to_html(
            "[a](https://x.org/?q=\"<) [b](javascript:alert(1)) [c](../secret) ![d](https://x/y.png) <JavaScript:x>",
        );
        assert_eq!(html.matches("<a ").count(), 1, "{html}");
        assert!(html.contains("<a href=\"https://x.org/") && !html.contains("\"<"), "{html}");
        assert!(html.contains(" b ") && html.contains(" c ") && html.contains(" d "), "{html}");
        assert!(!html.contains("href=\"javascript") && !html.contains("<img"), "{html}");
    }
}
