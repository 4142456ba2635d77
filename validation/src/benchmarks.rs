//! Error against exact values, run time and work: scene S1, published benchmark mechanisms, and what each further loop
//! costs.

use crate::measure::{self, Pages, heading, timed};
use crate::scene::{SPAN, THETA2};
use fmu_build::chain;
use linkage_fmu::mechanism::{Model, ModelError, Statistics};
use std::fmt::Write;
use std::path::Path;

/// Span of Andrews' squeezer [s], and the exact angle of its crank then [rad].
pub const ANDREWS_SPAN: f64 = 0.03;
pub const K1_ANGLE: f64 = 15.810_771_195_153_797;

/// Head of the CSV.
const COLUMNS: &str = "scene,steps,tolerance,error_rad,time_us,evaluations,accepted,rejected\n";
/// Numbers of steps in which a span is run.
const ONE_OR_MANY: [u32; 2] = [1, 1000];

/// One mechanism with an output whose value at the end of the span is known.
struct Scene {
    /// Word for CSV.
    name: String,
    title: String,
    /// Span [s].
    span: f64,
    /// Output, its unit and exact value.
    output: &'static str,
    exact: f64,
}

/// Angle of bar 0 [rad] after 10 s for N four-bars: pi/2 - 2 am(t/2 | -4 k), k = 9.81 ((N + 1)/2 + N) / ((N + 1)/3 +
/// N).
const CHAINS: [(u32, f64); 3] =
    [(2, -30.179_800_860_191_205), (10, -30.050_933_495_986_976), (40, -30.026_637_417_190_84)];

/// Scene S1: run time of a whole retraction against its error; the table in Markdown and CSV.
pub fn retraction(descriptions: &Path) -> Result<Pages, String> {
    /// Runs of which the fastest counts.
    const RUNS: usize = 300;
    let text = measure::mechanism(&descriptions.join("LandingGearRetraction"))?;
    let mut instantiation = f64::INFINITY;
    let mut model = timed(&mut instantiation, || Model::from_json(&text)).map_err(|e| e.to_string())?;
    let words = format!(
        "Scene S1 (30 kN, load factor 3, from rest, 0.13 s) in the engine, without a host. Error: theta2 at 0.13 s \
         against the 34-digit reference. Time: the fastest of {RUNS} runs, the steps alone, one core. Evaluations: of \
         the \
         right-hand side. Reading and tracing the mechanism took {:.1} ms, once.",
        instantiation * 1e3
    );
    let page = measure::page("Run time of a whole retraction against its error", &words);
    let mut pages = Pages { page, csv: COLUMNS.into() };
    let (name, output, exact) = ("LandingGearRetraction".into(), "crank.angle", THETA2);
    let scene = Scene { name, title: String::new(), span: SPAN, output, exact };
    for (title, steps) in
        [("One doStep of 0.13 s", 1), ("130 doSteps of 1 ms", 130), ("13 000 doSteps of 10 us", 13_000)]
    {
        let _ = writeln!(pages.page, "## {title}\n");
        let runs = (RUNS / (1 + steps as usize / 500)).max(10);
        scene.rows(&mut model, steps, [4, 6, 8, 10, 12, 13], runs, &mut pages).map_err(|e| e.to_string())?;
    }
    Ok(pages)
}

/// The published mechanisms; the tables in Markdown and CSV.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    let words = "In the engine, without a host, one core. Error: the named output at the end against its exact value. \
        Time: the \
         fastest of several runs, the steps alone. Evaluations: of the right-hand side. Instantiation: reading, \
         closing \
         the loops, tracing the curve and building the tables that the first step needs, once.";
    let mut pages = Pages { page: measure::page("Published benchmark mechanisms", words), csv: COLUMNS.into() };
    let read = |name: &str| measure::mechanism(&descriptions.join(name));
    let scene = |name: &str, title: &str, span: f64, output: &'static str, exact: f64| Scene {
        name: name.into(),
        title: title.into(),
        span,
        output,
        exact,
    };
    let mut scenes = vec![
        (
            scene("AndrewsSqueezer", "Andrews' squeezer", ANDREWS_SPAN, "K1.angle", K1_ANGLE),
            read("AndrewsSqueezer")?,
            [1, 300],
        ),
        (
            scene("SlCrank", "Slider-crank idaSlCrank", 10.0, "crank.angle", 1.275_675_848_650),
            read("SlCrank")?,
            ONE_OR_MANY,
        ),
    ];
    for (count, exact) in CHAINS {
        let title = format!("Chain of {count} four-bars ({} bodies)", 2 * count + 1);
        let chain_of = scene(&format!("FourBarChain{count}"), &title, 10.0, "bar0.angle", exact);
        scenes.push((chain_of, chain::text(count), ONE_OR_MANY));
    }
    for (scene, text, counts) in scenes {
        for steps in counts {
            scene.report(&text, steps, &mut pages).map_err(|e| format!("{}: {e}", scene.title))?;
        }
    }
    Ok(pages)
}

impl Scene {
    fn report(&self, text: &str, steps: u32, pages: &mut Pages) -> Result<(), ModelError> {
        let mut instantiation = f64::INFINITY;
        let mut model = timed(&mut instantiation, || Model::from_json(text))?;
        let (title, span) = (&self.title, self.span);
        let _ = writeln!(pages.page, "## {title}, {span} s in {steps} doSteps\n");
        let _ = writeln!(pages.page, "Instantiation {:.1} ms.\n", instantiation * 1e3);
        self.rows(&mut model, steps, [4, 6, 8, 9, 10, 12], 50, pages)
    }

    /// One row for each tolerance 10^-exponent, each the fastest of `runs` runs.
    fn rows(
        &self,
        model: &mut Model,
        steps: u32,
        exponents: [i32; 6],
        runs: usize,
        pages: &mut Pages,
    ) -> Result<(), ModelError> {
        pages.page += &heading(&["tolerance", "error [rad]", "time [us]", "evaluations", "steps", "rejected"]);
        let h = self.span / f64::from(steps);
        for exponent in exponents {
            let mut seconds = f64::INFINITY;
            for _ in 0..runs {
                model.reset();
                model.set_tolerance(10f64.powi(-exponent))?;
                model.initialize()?;
                timed(&mut seconds, || (0..steps).try_for_each(|_| model.step(h)))?;
            }
            let time = seconds * 1e6;
            let Statistics { evaluations, accepted, rejected, .. } = model.statistics();
            let error = (measure::output(model, self.output)? - self.exact).abs();
            let _ = writeln!(
                pages.page,
                "| 1e-{exponent} | {error:.1e} | {time:.1} | {evaluations} | {accepted} | {rejected} |"
            );
            let _ = writeln!(
                pages.csv,
                "{},{steps},1e-{exponent},{error:.2e},{time:.2},{evaluations},{accepted},{rejected}",
                self.name
            );
        }
        pages.page.push('\n');
        Ok(())
    }
}
