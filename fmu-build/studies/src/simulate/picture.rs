//! What the pictures of a run share: the font, the colours, PNG.

use anyhow::{Context, Result, anyhow};
use plotters::style::{FontStyle, RGBColor, register_font};
use tiny_skia::{IntSize, Pixmap};

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

/// Pixels of three bytes, line by line, as PNG.
///
/// # Errors
/// There are not as many pixels as the size says, or they cannot be encoded.
pub fn to_png(pixels: &[u8], (width, height): (u32, u32)) -> Result<Vec<u8>> {
    let opaque = pixels.chunks_exact(3).flat_map(|pixel| [pixel[0], pixel[1], pixel[2], u8::MAX]).collect();
    let size = IntSize::from_wh(width, height).context("the picture has no size")?;
    let picture = Pixmap::from_vec(opaque, size).context("the picture has another number of pixels")?;
    picture.encode_png().context("the picture cannot be encoded")
}
