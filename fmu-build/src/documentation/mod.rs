//! What an FMU tells of itself: the page, the pictures, the animation, the scene file, the reference results.
//!
//! In: a checked definition, its model, the user's own text. Out: files of the FMU, the same bytes for the same
//! definition. It must not know how an FMU is packed.

mod markdown;
mod page;
mod parts;
mod picture;
mod results;
mod scene;
mod variables;

use crate::archive::Entry;
use crate::check::Checked;
use crate::drawing::{Colours, to_png, to_svg};
use crate::view::{self, Data, Wanted};
use crate::workspace::{MECHANISM, Workspace};
use anyhow::{Context, Result};
use linkage_fmu::component::Component;
pub use markdown::to_html;
pub use picture::Picture;
pub use results::{FOLDER as RESULTS, MANIFEST, Results};
pub use scene::path as scene_path;

/// Path of the page in an FMU.
pub const PAGE: &str = "documentation/index.html";
/// Path of the animated page in an FMU.
pub const ANIMATION: &str = "documentation/animation.html";
/// Path of the picture that stands for the FMU (FMI 2.0.5, 2.3).
pub const ICON: &str = "model.png";
/// The picture beside the terminals (FMI 3.0, 2.5.1.1), as pixels and as lines.
pub const TERMINAL_ICONS: [&str; 2] = ["terminalsAndIcons/icon.png", "terminalsAndIcons/icon.svg"];
/// Width and height of the picture [px].
const ICON_SIDE: f64 = 256.0;

/// What is wanted in an FMU beside the page and the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// The animated page.
    pub animation: bool,
    /// The reference results.
    pub results: bool,
}

/// A model, and what its user says of it.
pub struct Subject<'a> {
    /// The checked definition.
    pub checked: &'a Checked,
    /// Its model.
    pub component: &'a Component,
    /// Text of the README beside the definition, if there is one.
    pub readme: Option<&'a str>,
}

/// What was made, and what was not.
#[derive(Debug, Default)]
pub struct Made {
    /// Files of the FMU.
    pub entries: Vec<Entry>,
    /// Why a file was left out, one line each.
    pub left_out: Vec<String>,
}

impl Subject<'_> {
    /// Whether the model is a mechanism, with a linkage to be drawn.
    fn is_mechanism(&self) -> bool {
        self.component.definition_file() == MECHANISM
    }

    /// Path of the definition in the FMU, by which pages name it: the same wherever the definition was.
    fn path(&self) -> String {
        format!("resources/{}", self.component.definition_file())
    }

    /// The files that tell of this model.
    ///
    /// # Errors
    /// The model has no position to be drawn, or a template is wrong. A run that cannot be made is no error.
    pub fn files(&self, workspace: &Workspace, extent: Extent) -> Result<Made> {
        let mut made = Made::default();
        let mut add = |name: &str, content: Vec<u8>| made.entries.push(Entry { name: name.to_owned(), content });
        let picture = Picture::new(self.component, &self.checked.text)?;
        let icon = picture.icon(ICON_SIDE);
        let pixels = to_png(&icon).context("the icon")?;
        add(TERMINAL_ICONS[1], to_svg(&icon, Colours::Own, "icon")?.into_bytes());
        add(TERMINAL_ICONS[0], pixels.clone());
        add(ICON, pixels);
        match scene::xml(self.component, &picture)? {
            Some(text) => add(&scene::path(self.component.name()), text.into_bytes()),
            None if self.is_mechanism() => {
                made.left_out.push("no scene file was written, because the mechanism has too many parts".into())
            }
            None => {}
        }
        let animated = extent.animation && self.is_mechanism();
        if animated {
            add(ANIMATION, self.animation()?.into_bytes());
        }
        let results = match extent.results.then(|| Results::new(workspace, self.component)) {
            None => None,
            Some(Ok(results)) => Some(results),
            Some(Err(error)) => {
                made.left_out.push(format!("no reference results were written: {error:#}"));
                None
            }
        };
        let page = page::html(self, &picture, animated, results.as_ref())?;
        made.entries.push(Entry { name: PAGE.to_owned(), content: page.into_bytes() });
        if let Some(results) = results {
            made.entries.extend(results.entries(&self.path(), animated)?);
        }
        Ok(made)
    }

    /// The page that plays the default run.
    fn animation(&self) -> Result<String> {
        let checked = Checked {
            shown: self.path(),
            text: self.checked.text.clone(),
            findings: self.checked.findings.clone(),
            is_whole: self.checked.is_whole,
            units: self.checked.units.clone(),
            inspection: self.checked.inspection.clone(),
        };
        view::html(&Data::collect(&checked, &Wanted::default())?)
    }

    /// The page alone, for tests.
    ///
    /// # Errors
    /// As for [`Subject::files`].
    pub fn page(&self) -> Result<String> {
        page::html(self, &Picture::new(self.component, &self.checked.text)?, false, None)
    }
}
