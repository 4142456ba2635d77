//! Pictures of variables: one panel for each unit, lines over time or over another quantity.
//!
//! In: rows of numbers. Out: a PNG or an SVG.

use super::picture::{self, COLOURS, FONT};
use anyhow::{Context, Result, bail};
use fmu_build::drawing::png;
use fmu_build::files;
use linkage_fmu::variables::Unit;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::path::Path;

/// Size of a panel in pixels, and its part for the names beside the lines.
const WIDTH: u32 = 1080;
const HEIGHT: u32 = 280;
const NAMES: u32 = 250;
/// Rows above which lines are thin.
const DENSE: usize = 2000;
/// Beyond this a value stands for an infinite one, such as a reduced mass at a dead centre.
const INFINITE: f64 = 1e300;
/// Most lines in one panel, and panels in one picture: more could not be told apart.
const LINES: usize = COLOURS.len();
const PANELS: usize = 8;

/// What is drawn: lines over an axis.
pub struct Picture<'a> {
    /// Name of the quantity on the axis.
    pub axis: &'a str,
    /// Its unit.
    pub unit: Unit,
    /// Name and unit of each line.
    pub lines: Vec<(&'a str, Option<Unit>)>,
    /// Rows, each the value on the axis and those of the lines.
    pub rows: &'a [Vec<f64>],
}

/// Lines of one unit.
struct Panel {
    unit: String,
    /// Factor from the unit of the variables.
    factor: f64,
    /// Indices of the columns.
    lines: Vec<usize>,
}

/// Whether a picture can have this name.
///
/// # Errors
/// It ends neither in .png nor in .svg.
pub fn check(path: &Path) -> Result<()> {
    match extension(path).as_str() {
        "png" | "svg" => Ok(()),
        _ => bail!("--plot: the name {} must end in .png or .svg", path.display()),
    }
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// Draw the courses of what was recorded.
///
/// # Errors
/// The file cannot be written, or has another ending than .png and .svg.
pub fn write(path: &Path, picture: &Picture) -> Result<()> {
    check(path)?;
    let (panels, left_out) = panels(picture);
    if left_out > 0 {
        eprintln!(
            "note: {left_out} variables are not drawn, because a picture has at most {PANELS} panels of {LINES} \
             lines; choose the variables with --output-variables"
        );
    }
    picture::register()?;
    let size = (WIDTH, HEIGHT * panels.len().max(1) as u32);
    let content = content(path, size, &panels, picture).with_context(|| format!("--plot: {}", path.display()))?;
    files::replace_named(path, "--plot", &content)
}

/// What the file holds.
fn content(path: &Path, size: (u32, u32), panels: &[Panel], picture: &Picture) -> Result<Vec<u8>> {
    if extension(path) == "svg" {
        let mut text = String::new();
        draw(&SVGBackend::with_string(&mut text, size).into_drawing_area(), panels, picture, true)?;
        return Ok(text.into_bytes());
    }
    let mut pixels = vec![0; 3 * (size.0 * size.1) as usize];
    draw(&BitMapBackend::with_buffer(&mut pixels, size).into_drawing_area(), panels, picture, false)?;
    let (pixels, _) = pixels.as_chunks::<3>();
    Ok(png::encode(pixels, [size.0, size.1])?)
}

/// The panels, and how many variables are in none.
fn panels(picture: &Picture) -> (Vec<Panel>, usize) {
    let (mut panels, mut left_out): (Vec<Panel>, usize) = (Vec::new(), 0);
    for (index, (_, unit)) in picture.lines.iter().enumerate() {
        let own = unit.map_or(("", 1.0), shown);
        let is_free = panels.len() < PANELS;
        match panels.iter_mut().find(|panel| panel.unit == own.0) {
            Some(panel) if panel.lines.len() < LINES => panel.lines.push(index),
            None if is_free => panels.push(Panel { unit: own.0.to_owned(), factor: own.1, lines: vec![index] }),
            _ => left_out += 1,
        }
    }
    (panels, left_out)
}

fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    panels: &[Panel],
    picture: &Picture,
    is_joined: bool,
) -> Result<()>
where
    B::ErrorType: 'static,
{
    area.fill(&WHITE)?;
    for (part, panel) in area.split_evenly((panels.len().max(1), 1)).iter().zip(panels) {
        draw_panel(part, panel, picture, is_joined)?;
    }
    Ok(area.present()?)
}

/// One panel. `is_joined`: each line is one path; else each of its segments is one, as the corners of wide lines stick
/// far out in bitmaps where a line turns back.
fn draw_panel<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    panel: &Panel,
    picture: &Picture,
    is_joined: bool,
) -> Result<()>
where
    B::ErrorType: 'static,
{
    let (axis, factor) = shown(picture.unit);
    let point = |row: &Vec<f64>, index: usize| (factor * row[0], panel.factor * row[index + 1]);
    let is_drawn = |row: &Vec<f64>, index: usize| row[index + 1].abs() < INFINITE;
    let of_panel = picture.rows.iter().flat_map(|row| panel.lines.iter().map(move |&index| (row, index)));
    let values = of_panel.filter(|(row, index)| is_drawn(row, *index)).map(|(row, index)| point(row, index).1);
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
    let margin = if high > low { 0.05 * (high - low) } else { low.abs().max(1.0) * 0.05 };
    let ends = picture.rows.iter().map(|row| factor * row[0]).filter(|x| x.is_finite());
    let (first, last) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let along = if first < last { first..last } else { 0.0..1.0 };
    let (left, names) = area.split_horizontally(WIDTH - NAMES);
    let mut chart = ChartBuilder::on(&left)
        .margin(12)
        .x_label_area_size(34)
        .y_label_area_size(78)
        .build_cartesian_2d(along, (low - margin)..(high + margin))?;
    let label = |value: &f64| plain(*value);
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc(format!("{} in {axis}", picture.axis))
        .y_desc(if matches!(&*panel.unit, "" | "1") { String::new() } else { format!("in {}", panel.unit) })
        .x_label_formatter(&label)
        .y_label_formatter(&label)
        .label_style((FONT, 14))
        .axis_desc_style((FONT, 15))
        .draw()?;
    for ((&index, colour), place) in panel.lines.iter().zip(COLOURS).zip(1..) {
        let style = colour.stroke_width(if picture.rows.len() > DENSE { 1 } else { 2 });
        // Where a value does not exist, the line has a gap.
        for part in picture.rows.split(|row| !is_drawn(row, index)) {
            let points = || part.iter().map(|row| point(row, index));
            if is_joined {
                chart.draw_series(LineSeries::new(points(), style))?;
            } else {
                let pairs = points().zip(points().skip(1));
                chart.draw_series(pairs.map(|(a, b)| PathElement::new([a, b], style)))?;
            }
        }
        let y = 24 * place;
        names.draw(&PathElement::new([(0, y + 7), (18, y + 7)], style))?;
        names.draw(&Text::new(picture.lines[index].0.to_owned(), (26, y), (FONT, 14)))?;
    }
    Ok(())
}

/// The unit in which a quantity is drawn, with the factor from its own.
fn shown(unit: Unit) -> (&'static str, f64) {
    unit.display().unwrap_or((unit.name(), 1.0))
}

/// A number for an axis: six digits at most.
fn plain(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let size = value.abs();
    if !(1e-3..1e6).contains(&size) {
        return format!("{:e}", format!("{value:.3e}").parse::<f64>().unwrap_or(value));
    }
    let digits = (5.0 - size.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn numbers_of_an_axis_are_short() {
        let shown = [0.0, 0.1 + 0.2, -45.0, 30_000.0, 1e6, 1.5e-7, 123.456_789].map(plain);
        assert_eq!(shown, ["0", "0.3", "-45", "30000", "1e6", "1.5e-7", "123.457"]);
    }
}
