//! Run time of one doStep through the C functions, by step size, tolerance and outputs read after it.

use crate::gear::Gear;
use crate::measure::{self, Asked, Pages, digits, heading};
use crate::scene::{After, BARE, DEFAULT, SPAN, Scene};
use std::path::Path;

/// Steps of a retraction, by the size of one [us].
const SIZES: [u32; 4] = [10, 100, 1000, 10_000];
/// Exponents of the tolerances.
const TOLERANCES: [i32; 3] = [6, 9, 12];
/// Calls after a step, in the order of the columns.
const READS: [&[After]; 5] = [&[], &[After::Motion], &[After::Reactions], &[After::EachReaction], &[After::State]];
/// Least number of runs, of which the fastest counts, and least total number of steps.
const RUNS: u32 = 60;
const STEPS: u32 = 200_000;

/// Steps in a part of a run. The fastest of each part counts, so that an interruption affects one part only.
const PART: u32 = 130;

/// Times of one step [ns], in the order of `READS`, and evaluations in it.
struct Row {
    micros: u32,
    tolerance: i32,
    times: [f64; READS.len()],
    evaluations: f64,
}

/// The table as Markdown and CSV.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    let folder = &descriptions.join("LandingGearRetraction");
    let text = measure::mechanism(folder)?;
    let mut tables = String::new();
    let mut csv =
        String::from("scene,step_us,tolerance,step_ns,motion_ns,reactions_ns,each_reaction_ns,state_ns,evaluations\n");
    let mut figures = Vec::new();
    for (scene, stops) in [(&DEFAULT, "with stops, the default"), (&BARE, "without stops")] {
        let reads = ["+ 3 reads", "+ 4 reactions, 1 call", "+ 4 reactions, 4 calls", "+ state"];
        let columns = heading(&[&["step", "tolerance", "doStep"], &reads[..], &["evaluations"]].concat());
        tables += &format!("## {}{}\n\n{columns}", stops[..1].to_uppercase(), &stops[1..]);
        for tolerance in TOLERANCES {
            for micros in SIZES {
                let row = Row::measure(folder, &text, scene, tolerance, micros)?;
                tables.push_str(&row.line());
                csv.push_str(&row.csv(scene.name));
                row.figures(&mut figures, stops);
            }
        }
        tables.push('\n');
    }
    let page = measure::page("steps", &[("runs", &RUNS), ("part", &PART)]) + &measure::asked(&figures) + &tables;
    Ok(Pages { page, csv })
}

impl Row {
    fn measure(folder: &Path, text: &str, scene: &Scene, tolerance: i32, micros: u32) -> Result<Self, String> {
        let accuracy = 10f64.powi(-tolerance);
        let count = (SPAN * 1e6).round() as u32 / micros;
        let mut gear = Gear::new(folder, scene, accuracy)?;
        let mut least = READS.map(|_| vec![f64::INFINITY; count.div_ceil(PART) as usize]);
        for _ in 0..RUNS.max(STEPS / count) {
            for (least, after) in least.iter_mut().zip(READS) {
                gear.run(count, SPAN / f64::from(count), after, least)?;
            }
        }
        let work = scene.work(text, accuracy, count, &[]).map_err(|e| e.to_string())?;
        let times = least.map(|parts| parts.iter().sum::<f64>() * 1e9 / f64::from(count));
        Ok(Self { micros, tolerance, times, evaluations: work.evaluations as f64 / f64::from(count) })
    }

    fn line(&self) -> String {
        let [step, motion, reactions, each, state] = self.times;
        let size =
            if self.micros < 1000 { format!("{} us", self.micros) } else { format!("{} ms", self.micros / 1000) };
        format!(
            "| {size} | 1e-{} | {step:.0} | {motion:.0} | {reactions:.0} | {each:.0} | {state:.0} | {:.1} |\n",
            self.tolerance, self.evaluations
        )
    }

    fn csv(&self, scene: &str) -> String {
        let [step, motion, reactions, each, state] = self.times.map(digits);
        let Self { micros, tolerance, evaluations, .. } = self;
        format!("{scene},{micros},1e-{tolerance},{step},{motion},{reactions},{each},{state},{evaluations:.3}\n")
    }

    /// Add the limits for this row, at a tolerance of 1e-9.
    fn figures(&self, figures: &mut Vec<Asked>, stops: &str) {
        let [step, motion, reactions, each, state] = self.times;
        match (self.tolerance, self.micros) {
            (9, 10) => figures.push(Asked::at_most(format!("doStep of 10 us, {stops}"), step, 150.0, " ns")),
            (9, 1000) => {
                let what = format!("doStep of 1 ms, state saved and restored, against one without, {stops}");
                figures.push(Asked::at_most(what, state / step, 1.2, " times"));
                let what = format!("doStep of 1 ms and three fmi2GetReal, {stops}");
                figures.push(Asked::at_most(what, motion, 400.0, " ns"));
                for (calls, time) in [("one fmi2GetReal of 4", reactions), ("four of 1", each)] {
                    let what = format!("four reactions after a step of 1 ms, {calls}, {stops}");
                    figures.push(Asked::at_most(what, time - step, 300.0, " ns"));
                }
            }
            _ => {}
        }
    }
}
