//! The page: a template filled with style, script, plots and data.
//!
//! In: data. Out: one HTML document that loads no other files. The module must not know mechanics.

use super::data::Data;
use anyhow::{Context, Result};
use minijinja::value::Value;
use minijinja::{Environment, context};

const TEMPLATE: &str = include_str!("page/template.html");
const STYLE: &str = include_str!("page/view.css");
/// Parts of the script, in order.
const SCRIPTS: [&str; 14] = [
    include_str!("page/samples.js"),
    include_str!("page/shapes.js"),
    include_str!("page/labels.js"),
    include_str!("page/connections.js"),
    include_str!("page/drawing.js"),
    include_str!("page/arrows.js"),
    include_str!("page/compared.js"),
    include_str!("page/plots.js"),
    include_str!("page/results.js"),
    include_str!("page/table.js"),
    include_str!("page/clock.js"),
    include_str!("page/zoom.js"),
    include_str!("page/save.js"),
    include_str!("page/view.js"),
];
/// uPlot 1.6.32: script, and style.
const PLOTS: [&str; 2] = [include_str!("page/uplot/uPlot.iife.min.js"), include_str!("page/uplot/uPlot.min.css")];
/// Its licence, which each page contains as a comment of the script.
const LICENCE: &str = include_str!("page/uplot/LICENSE");

/// JSON for a script element. Text that could end the element or a line is escaped. The marks that change the direction
/// of text are escaped too, because they would show the source in a wrong order.
pub fn as_script(json: &str) -> String {
    let mut out = String::with_capacity(json.len() + json.len() / 16);
    for c in json.chars() {
        match c {
            '<'
            | '>'
            | '&'
            | '\u{2028}'
            | '\u{2029}'
            | '\u{200e}'
            | '\u{200f}'
            | '\u{061c}'
            | '\u{202a}'..='\u{202e}'
            | '\u{2066}'..='\u{2069}' => out.push_str(&format!("\\u{:04x}", c as u32)),
            _ => out.push(c),
        }
    }
    out
}

/// Lines of a script or a style without indentation and without comment lines.
fn slim(text: &str) -> String {
    let lines = text.lines().map(str::trim);
    let is_comment = |line: &str| line.starts_with("//") || line.starts_with("/**") && line.ends_with("*/");
    lines.filter(|line| !line.is_empty() && !is_comment(line)).flat_map(|line| [line, "\n"]).collect()
}

/// Additional parts of a page with a server.
#[derive(Clone, Copy, Debug)]
pub struct Live<'a> {
    /// Style, after the style of the page.
    pub style: &'a str,
    /// Elements before those of the page.
    pub body: &'a str,
    /// A library in a separate script element.
    pub library: &'a str,
    /// Script, in the scope of the page's script after it.
    pub script: &'a str,
    /// JSON in elements with these names.
    pub data: &'a [(&'a str, &'a str)],
}

/// The whole page, which loads no other files.
///
/// # Errors
/// The template is invalid.
pub fn html(data: &Data) -> Result<String> {
    page(data, None)
}

/// The page with a server.
///
/// # Errors
/// The template is invalid.
pub fn live(data: &Data, live: &Live) -> Result<String> {
    page(data, Some(live))
}

/// A name, and JSON for a script element.
fn in_script((name, json): &(&str, &str)) -> (String, Value) {
    ((*name).to_owned(), Value::from_safe_string(as_script(json)))
}

fn page(data: &Data, live: Option<&Live>) -> Result<String> {
    let mut environment = Environment::new();
    environment.add_template("page.html", TEMPLATE).context("template of the page")?;
    let template = environment.get_template("page.html").context("template of the page")?;
    let json = serde_json::to_string(data).context("data of the page")?;
    let page = template.render(context! {
        name => data.title(),
        description => &data.description,
        error => &data.error,
        style => Value::from_safe_string(slim(STYLE) + live.map_or("", |live| live.style)),
        plot_style => Value::from_safe_string(PLOTS[1].into()),
        plot_script => Value::from_safe_string(format!("/*! uPlot\n{LICENCE}*/\n{}", PLOTS[0])),
        script => Value::from_safe_string(slim(&SCRIPTS.concat()) + live.map_or("", |live| live.script)),
        live => live.map(|live| context! {
            body => Value::from_safe_string(live.body.into()),
            library => Value::from_safe_string(live.library.into()),
            data => live.data.iter().map(in_script).collect::<Vec<_>>(),
        }),
        data => Value::from_safe_string(as_script(&json)),
    });
    page.context("template of the page")
}
