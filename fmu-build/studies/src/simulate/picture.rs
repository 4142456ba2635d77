//! What the pictures of a run share: the font, the colours.

use anyhow::{Result, anyhow};
use plotters::style::{FontStyle, RGBColor, register_font};

/// Name under which the font of the pictures is known.
pub const FONT: &str = "sans-serif";
/// Colours that are told apart by people who see fewer (Okabe and Ito 2008).
pub const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

/// Make the font known: a machine may have none.
///
/// # Errors
/// The font cannot be read.
pub fn register() -> Result<()> {
    register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| anyhow!("the font of the pictures cannot be read"))
}
