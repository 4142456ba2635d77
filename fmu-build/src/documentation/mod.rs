//! The documentation in an FMU: page, pictures, animation, scene file, reference results.
//!
//! In: a checked definition, its model, the user's own text. Out: files of the FMU. Their bytes depend only on the
//! definition. The module must not know how an FMU is packed.

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
/// Path of the icon of the FMU (FMI 2.0.5, 2.3).
pub const ICON: &str = "model.png";
/// The icon next to the terminals (FMI 3.0, 2.5.1.1), as PNG and as SVG.
pub const TERMINAL_ICONS: [&str; 2] = ["terminalsAndIcons/icon.png", "terminalsAndIcons/icon.svg"];
/// Width and height of the icon [px].
const ICON_SIDE: f64 = 256.0;

/// Optional files besides the page and the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// The animated page.
    pub animation: bool,
    /// The reference results.
    pub results: bool,
}

/// A model, and the user's description of it.
pub struct Subject<'a> {
    /// The checked definition.
    pub checked: &'a Checked,
    /// Its model.
    pub component: &'a Component,
    /// Text of the README next to the definition, if there is one.
    pub readme: Option<&'a str>,
}

/// The written files, and the omitted ones.
#[derive(Debug, Default)]
pub struct Made {
    /// Files of the FMU.
    pub entries: Vec<Entry>,
    /// Reasons for omitted files, one per line.
    pub left_out: Vec<String>,
}

impl Subject<'_> {
    /// Whether the model is a mechanism with a linkage to draw.
    fn is_mechanism(&self) -> bool {
        self.component.definition_file() == MECHANISM
    }

    /// Path of the definition in the FMU, which pages use for any original path.
    fn path(&self) -> String {
        format!("resources/{}", self.component.definition_file())
    }

    /// The documentation files of this model.
    ///
    /// # Errors
    /// The model has no position that can be drawn, or a template is invalid. A failed run is no error.
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

    /// The page with the animation of the default run.
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
