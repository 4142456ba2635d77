//! Animated GIF of the moving mechanism.
//!
//! In: a mechanism at the communication points of a run. Out: the GIF, which repeats without end. Its bytes depend only
//! on the poses. Frames after the first contain only the changed part.

mod canvas;
mod drawing;

use anyhow::{Context, Result, bail};
use canvas::{Font, Size};
use drawing::Drawing;
use fmu_build::files;
use fmu_build::run::thinned::Thinned;
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use linkage_fmu::component::Component;
use linkage_fmu::mechanism::inspection::{Pose, Scene};
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::Path;

/// Largest number of frames.
const FRAMES: usize = 120;
/// Shortest and longest duration of a film [s]. A shorter motion is slowed down, a longer one is accelerated.
const PLAYED: [f64; 2] = [3.0, 8.0];
/// Shortest duration of a frame in hundredths of a second: browsers show shorter frames for longer.
const SHORTEST: f64 = 3.0;
/// Duration of the last frame of a motion that does not return to its start, in hundredths of a second.
const PAUSE: u16 = 100;
/// Angle [rad] and part of the size below which a pose counts as returned.
const RETURNED: f64 = 0.02;
/// Number of colours from white to each colour of the drawing.
const SHADES: u16 = 5;

/// The bodies at a time.
pub struct Still {
    /// Time [s].
    pub time: f64,
    /// Poses of all bodies of the linkage.
    pub poses: Vec<Pose>,
}

/// Recorded poses.
pub struct Film {
    stills: Thinned<Still>,
}

/// Check the name of a film.
///
/// # Errors
/// The name does not end in .gif.
pub fn check(path: &Path) -> Result<()> {
    match path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gif")) {
        true => Ok(()),
        false => bail!("--gif: the name {} must end in .gif", path.display()),
    }
}

impl Film {
    /// A film of a mechanism, without frames.
    ///
    /// # Errors
    /// The model has no linkage.
    pub fn new(model: &Component) -> Result<Self> {
        match model {
            Component::Mechanism(_) => Ok(Self { stills: Thinned::new(FRAMES) }),
            Component::Hydraulic(_) => {
                bail!("--gif: {} has no mechanism that can be drawn", model.name())
            }
        }
    }

    /// Add the present pose.
    pub fn record(&mut self, model: &Component, time: f64) {
        if self.stills.wants_next()
            && let Component::Mechanism(model) = model
            && let Some(poses) = model.poses()
        {
            self.stills.keep(Still { time, poses });
        }
    }

    /// Write the film. `time` is the time of the model's present pose.
    ///
    /// # Errors
    /// The model cannot be drawn, or the file cannot be written.
    pub fn write(self, path: &Path, model: &mut Component, time: f64) -> Result<()> {
        let name = model.name().to_owned();
        let Component::Mechanism(model) = model else { return Ok(()) };
        let scene = model.scene().context("--gif")?;
        let mut stills = self.stills.into_items();
        if let (Some(last), Some(poses)) = (stills.last(), model.poses())
            && last.time < time
        {
            stills.push(Still { time, poses });
        }
        if stills.is_empty() {
            return Ok(());
        }
        let film = encode(&name, &scene, &stills).with_context(|| format!("--gif: {}", path.display()))?;
        files::replace(path, &film)
    }
}

/// Speed of the film.
struct Pace {
    /// Number of frames that are shown.
    frames: usize,
    /// Hundredths of a second for each.
    delay: u16,
    /// Hundredths of a second for the last one.
    last_delay: u16,
    /// Text about the speed. Empty in real time.
    words: String,
}

impl Pace {
    fn new(scene: &Scene, stills: &[Still]) -> Self {
        let duration = stills[stills.len() - 1].time - stills[0].time;
        let returns = stills.len() > 2 && is_same(scene, &stills[0], &stills[stills.len() - 1]);
        let frames = stills.len() - usize::from(returns);
        let asked = 100.0 * duration.clamp(PLAYED[0], PLAYED[1]) / frames as f64;
        let delay = asked.clamp(SHORTEST, f64::from(PAUSE)).round() as u16;
        let speed = duration / (f64::from(delay) * 0.01 * frames as f64);
        let words = match speed {
            s if s < 0.9 && duration > 0.0 => format!("slowed down {} times", rounded(1.0 / s)),
            s if s > 1.1 => format!("sped up {} times", rounded(s)),
            _ => String::new(),
        };
        Self { frames, delay, last_delay: if returns { delay } else { PAUSE }, words }
    }
}

/// Round to two digits.
fn rounded(value: f64) -> String {
    format!("{value:.1e}").parse::<f64>().unwrap_or(value).to_string()
}

/// Whether the bodies have their previous positions, up to whole turns.
fn is_same(scene: &Scene, a: &Still, b: &Still) -> bool {
    a.poses.iter().zip(&b.poses).all(|(a, b)| {
        let turn = (a[0] - b[0]).rem_euclid(TAU);
        turn.min(TAU - turn) < RETURNED && (a[1] - b[1]).hypot(a[2] - b[2]) < RETURNED * scene.size
    })
}

/// Bytes of the file.
fn encode(name: &str, scene: &Scene, stills: &[Still]) -> Result<Vec<u8>> {
    let font = Font::new()?;
    let pace = Pace::new(scene, stills);
    let drawing = Drawing::new(name, &pace.words, scene, stills);
    let size @ Size { width, height } = drawing.size();
    let mut palette = Palette::new(drawing.colours());
    let mut encoder = Encoder::new(Vec::new(), width, height, &palette.bytes())?;
    encoder.set_repeat(Repeat::Infinite)?;
    let mut before: Vec<u8> = Vec::new();
    for (k, still) in stills[..pace.frames].iter().enumerate() {
        let pixels = drawing.picture(still, &font)?;
        let now: Vec<u8> = pixels.iter().map(|colour| palette.index(*colour)).collect();
        let mut frame = changed(size, &before, &now, palette.transparent());
        frame.delay = if k + 1 == pace.frames { pace.last_delay } else { pace.delay };
        encoder.write_frame(&frame)?;
        before = now;
    }
    Ok(encoder.into_inner()?)
}

/// The part of a picture that differs from the previous picture. The rest of it is transparent.
fn changed(Size { width, height }: Size, before: &[u8], now: &[u8], transparent: u8) -> Frame<'static> {
    let is_new = |x: u16, y: u16| {
        let at = usize::from(y) * usize::from(width) + usize::from(x);
        before.get(at) != Some(&now[at])
    };
    let mut part = [width, height, 0, 0];
    for y in 0..height {
        for x in (0..width).filter(|x| is_new(*x, y)) {
            part = [part[0].min(x), part[1].min(y), part[2].max(x + 1), part[3].max(y + 1)];
        }
    }
    // A frame has at least one pixel, also without changes.
    let [left, top, right, bottom] = if part[2] == 0 { [0, 0, 1, 1] } else { part };
    let mut pixels = Vec::with_capacity(usize::from(right - left) * usize::from(bottom - top));
    for y in top..bottom {
        for x in left..right {
            let at = usize::from(y) * usize::from(width) + usize::from(x);
            pixels.push(if is_new(x, y) { now[at] } else { transparent });
        }
    }
    let mut frame = Frame::from_indexed_pixels(right - left, bottom - top, pixels, Some(transparent));
    (frame.left, frame.top, frame.dispose) = (left, top, DisposalMethod::Keep);
    frame
}

/// The colours of a film: white, and shades from white to each colour of the drawing. Index 0 is transparent.
struct Palette {
    colours: Vec<[u8; 3]>,
    /// Indices of colours that were found before.
    found: HashMap<[u8; 3], u8>,
}

impl Palette {
    fn new(of_drawing: Vec<[u8; 3]>) -> Self {
        let mut colours = vec![[0; 3], [255; 3]];
        for colour in of_drawing {
            let shade = |k: u16| colour.map(|c| (255 - (255 - u16::from(c)) * k / SHADES) as u8);
            colours.extend((1..=SHADES).map(shade));
        }
        colours.truncate(256);
        Self { colours, found: HashMap::new() }
    }

    fn bytes(&self) -> Vec<u8> {
        self.colours.concat()
    }

    fn transparent(&self) -> u8 {
        0
    }

    /// Index of the nearest colour.
    fn index(&mut self, colour: [u8; 3]) -> u8 {
        let colours = &self.colours;
        *self.found.entry(colour).or_insert_with(|| {
            let distance = |other: &[u8; 3]| -> i32 {
                colour.iter().zip(other).map(|(a, b)| (i32::from(*a) - i32::from(*b)).pow(2)).sum()
            };
            let nearest = (1_u8..).zip(&colours[1..]).min_by_key(|(_, other)| distance(other));
            nearest.map_or(1, |(index, _)| index)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_contains_the_changed_pixels() {
        let size = Size { width: 4, height: 3 };
        let before = vec![1; 12];
        let mut now = before.clone();
        (now[5], now[10]) = (7, 8);
        let frame = changed(size, &before, &now, 0);
        assert_eq!((frame.left, frame.top, frame.width, frame.height), (1, 1, 2, 2));
        assert_eq!(frame.buffer[..], [7, 0, 0, 8]);
        let frame = changed(size, &before, &before, 0);
        assert_eq!((frame.width, frame.height, &frame.buffer[..]), (1, 1, &[0][..]));
        assert_eq!(changed(size, &[], &now, 0).buffer[..], now);
    }

    #[test]
    fn colours_are_the_nearest_of_the_palette() {
        let mut palette = Palette::new(vec![[200, 0, 0]]);
        let index = palette.index([255, 255, 255]);
        assert_eq!(palette.colours[usize::from(index)], [255; 3]);
        let index = palette.index([201, 2, 1]);
        assert_eq!(palette.colours[usize::from(index)], [200, 0, 0]);
    }
}
