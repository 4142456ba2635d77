//! `cargo fmu view --live`: the page of `view` from a server on this machine, with the definition next to the drawing.
//!
//! In: a watched definition file, texts and values from the page. Out: the page, and its data for each text. The file
//! is written only on request of the page.

mod engine;
mod file;
mod page;
mod server;

use anyhow::{Context, Result, bail};
use engine::{Asked, Engine};
use file::{File, Saved};
use fmu_build::command;
use fmu_build::fmu::is_fmu;
use fmu_build::source::Source;
use fmu_build::view::Wanted;
use fmu_build::workspace::{MECHANISM, Workspace};
use fmu_cli::View as Arguments;
use serde::Deserialize;
use serde_json::{Value, json};
use server::{Answer, Request, Site};
use std::io::{Write, stdout};
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Longest time that a page waits for a new version of the file in one request.
const PATIENCE: Duration = Duration::from_secs(20);

/// State of the server.
struct Live {
    file: Arc<File>,
    engine: Engine,
}

/// A text to save.
#[derive(Deserialize)]
struct Saving {
    text: String,
    /// Version of the file from which the text was edited.
    version: u64,
}

/// Serve the page until the program ends.
///
/// # Errors
/// The path contains no mechanism that can be written; the port is in use; no browser can be opened.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    if is_fmu(&arguments.path) {
        bail!("{}: --live edits a definition; give the path of a {MECHANISM}, not of an FMU", arguments.path.display());
    }
    let source = Source::find(workspace, &arguments.path)?;
    let (kind, shown) = (source.kind(), source.definition.display().to_string());
    if kind != MECHANISM {
        bail!("{shown}: a {kind} has no mechanism that can be drawn; give the path of a {MECHANISM}");
    }
    // An unreadable file is reported here, and not in a page.
    source.text()?;
    let wanted = Wanted::new(arguments.stop_time, &[])?;
    let port = arguments.port.unwrap_or(0);
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
        .with_context(|| format!("--port {port}: this port of 127.0.0.1 is not free; give another one"))?;
    let site = Site::new(listener.local_addr()?.port())?;
    let live = Arc::new(Live {
        file: File::watch(source.definition.clone()),
        engine: Engine::new(shown.clone(), source.definition, wanted),
    });
    let address = site.address();
    println!("{address} (shows {shown}; press Ctrl-C to end)");
    stdout().flush().ok();
    if arguments.open {
        command::show(&address)?;
    }
    // The motion is computed before the page opens.
    let first = Arc::clone(&live);
    thread::spawn(move || {
        let text = first.file.now().1.unwrap_or_default();
        first.engine.run(&Asked { text, values: Vec::new() }).ok();
    });
    server::serve(&listener, &Arc::new(site), move |request| live.answer(request));
    Ok(())
}

impl Live {
    /// The answer to a request of the page.
    fn answer(&self, request: &Request) -> Answer {
        let answered = match (request.method.as_str(), request.path.as_str()) {
            ("GET", "") => self.page().map(Answer::page),
            ("GET", "file") => Ok(self.news(&request.query)),
            ("POST", "run") => request.json().and_then(|asked| Ok(Answer::json(&*self.engine.run(&asked)?))),
            ("POST", "save") => request.json().and_then(|saving| self.save(&saving)),
            (_, "" | "file" | "run" | "save") => {
                return Answer::refused(
                    405,
                    "this HTTP method is not allowed at this \
                address",
                );
            }
            _ => return Answer::refused(404, "there is no page at this address"),
        };
        answered.unwrap_or_else(|error| Answer::refused(400, &format!("{error:#}")))
    }

    fn page(&self) -> Result<String> {
        let (version, text) = self.file.now();
        page::html(&self.engine, version, text)
    }

    /// The file when its version differs from that of the page, or nothing after some time.
    fn news(&self, known: &str) -> Answer {
        let known = known.strip_prefix("after=").and_then(|known| known.parse().ok()).unwrap_or(0);
        match self.file.after(known, PATIENCE) {
            Some((version, text)) => Answer::json(&of_file(version, &text)),
            None => Answer::json(&json!({ "version": known })),
        }
    }

    fn save(&self, saving: &Saving) -> Result<Answer> {
        Ok(match self.file.save(saving.version, &saving.text)? {
            Saved::As(version) => Answer::json(&json!({ "version": version })),
            Saved::Not(version, text) => Answer::json(&of_file(version, &text)),
        })
    }
}

/// A version of the file for the page: its text, or the reason why there is none.
fn of_file(version: u64, text: &Result<String, String>) -> Value {
    match text {
        Ok(text) => json!({ "version": version, "text": text }),
        Err(error) => json!({ "version": version, "error": error }),
    }
}
