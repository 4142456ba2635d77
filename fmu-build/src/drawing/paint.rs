//! Drawings as pixels.
//!
//! In: the shapes of a drawing. Out: PNG with a transparent background. The bytes depend only on the drawing.

use super::{Drawing, Form, Ink, Shape, png};
use anyhow::{Context, Result};
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

/// Paint the drawing.
///
/// # Errors
/// The drawing has no size, or the picture cannot be encoded.
pub fn to_png(drawing: &Drawing) -> Result<Vec<u8>> {
    let [width, height] = drawing.size.map(|side| side.ceil() as u32);
    let mut picture = Pixmap::new(width, height).context("the picture has the size 0")?;
    for shape in &drawing.shapes {
        // A shape without extent is not painted.
        let Some(path) = path(shape) else { continue };
        if let Some(ink) = shape.fill {
            picture.fill_path(&path, &colour(ink), FillRule::Winding, Transform::identity(), None);
        }
        if let Some((ink, width)) = shape.stroke {
            let dashes: Vec<f32> = shape.dashes.iter().map(|length| *length as f32).collect();
            let stroke = Stroke {
                width: width as f32,
                line_cap: LineCap::Round,
                line_join: LineJoin::Round,
                dash: StrokeDash::new(dashes, 0.0),
                ..Stroke::default()
            };
            picture.stroke_path(&path, &colour(ink), &stroke, Transform::identity(), None);
        }
    }
    let straight = picture.pixels().iter().map(|pixel| {
        let colour = pixel.demultiply();
        [colour.red(), colour.green(), colour.blue(), colour.alpha()]
    });
    png::encode(&straight.collect::<Vec<_>>(), [width, height]).context("the picture cannot be encoded")
}

fn colour(ink: Ink) -> Paint<'static> {
    let [r, g, b] = ink.light();
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(Color::from_rgba8(r, g, b, u8::MAX));
    paint
}

fn path(shape: &Shape) -> Option<Path> {
    match &shape.form {
        Form::Circle { center: [x, y], radius } => PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32),
        Form::Lines { points, is_closed } => {
            let mut builder = PathBuilder::new();
            for (k, [x, y]) in points.iter().enumerate() {
                match k {
                    0 => builder.move_to(*x as f32, *y as f32),
                    _ => builder.line_to(*x as f32, *y as f32),
                }
            }
            if *is_closed {
                builder.close();
            }
            builder.finish()
        }
    }
}
