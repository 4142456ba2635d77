//! Published benchmark mechanisms: error against exact values, run time and work, and what each further loop costs.

use crate::asked;
use crate::measure::{self, COLUMNS, Pages, Row};
use fmu_build::chain::mechanism;
use linkage_fmu::mechanism::{Model, ModelError};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Span of Andrews' squeezer [s], and the exact angle of its crank then [rad].
pub const ANDREWS_SPAN: f64 = 0.03;
pub const K1_ANGLE: f64 = 15.810_771_195_153_797;

/// One mechanism with an output whose value at the end of the span is known.
struct Scene {
    /// Word for CSV.
    name: String,
    title: String,
    text: String,
    /// Span [s] and doSteps in it.
    span: f64,
    steps: u32,
    /// Output, its unit and exact value.
    output: &'static str,
    unit: &'static str,
    exact: f64,
}

/// Angle of bar 0 [rad] after 10 s for N four-bars: pi/2 - 2 am(t/2 | -4 k), k = 9.81 ((N + 1)/2 + N) / ((N + 1)/3 +
/// N).
const CHAINS: [(u32, f64); 3] =
    [(2, -30.179_800_860_191_205), (10, -30.050_933_495_986_976), (40, -30.026_637_417_190_84)];

/// The tables in Markdown and CSV.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    let words = "In the engine, without a host, one core. Error: the named output at the end against its exact value. Time: the \
         fastest of several runs, the steps alone. Evaluations: of the right-hand side. Instantiation: reading, closing \
         the loops, tracing the curve and building the tables that the first step needs, once.";
    let (mut out, mut csv) = (asked::page("Published benchmark mechanisms", words), String::from(COLUMNS));
    for scene in scenes(descriptions)? {
        scene.report(&mut out, &mut csv).map_err(|e| format!("{}: {e}", scene.title))?;
    }
    Ok(Pages { page: out, csv })
}

fn scenes(descriptions: &Path) -> Result<Vec<Scene>, String> {
    let read = |name: &str| measure::mechanism(&descriptions.join(name));
    let (andrews, slcrank) = (read("AndrewsSqueezer")?, read("SlCrank")?);
    let mut scenes = Vec::new();
    for steps in [1, 300] {
        scenes.push(Scene {
            name: "AndrewsSqueezer".into(),
            title: format!("Andrews' squeezer, 0.03 s in {steps} doSteps"),
            text: andrews.clone(),
            span: ANDREWS_SPAN,
            steps,
            output: "K1.angle",
            unit: "rad",
            exact: K1_ANGLE,
        });
    }
    for steps in [1, 1000] {
        scenes.push(Scene {
            name: "SlCrank".into(),
            title: format!("Slider-crank idaSlCrank, 10 s in {steps} doSteps"),
            text: slcrank.clone(),
            span: 10.0,
            steps,
            output: "crank.angle",
            unit: "rad",
            exact: 1.275_675_848_650,
        });
    }
    for (count, exact) in CHAINS {
        for steps in [1, 1000] {
            scenes.push(Scene {
                name: format!("FourBarChain{count}"),
                title: format!("Chain of {count} four-bars ({} bodies), 10 s in {steps} doSteps", 2 * count + 1),
                text: mechanism::text(count),
                span: 10.0,
                steps,
                output: "bar0.angle",
                unit: "rad",
                exact,
            });
        }
    }
    Ok(scenes)
}

impl Scene {
    fn report(&self, out: &mut String, csv: &mut String) -> Result<(), ModelError> {
        /// Runs of which the fastest counts.
        const RUNS: usize = 50;
        let began = Instant::now();
        let mut model = Model::from_json(&self.text)?;
        let instantiation = began.elapsed().as_secs_f64() * 1e3;
        let _ = writeln!(out, "## {}\n\nInstantiation {instantiation:.1} ms.\n", self.title);
        out.push_str(&measure::heading(self.unit));
        for exponent in [4, 6, 8, 9, 10, 12] {
            let row = Row::measure(&mut model, 10f64.powi(-exponent), self.span, self.steps, RUNS)?;
            let error = (measure::output(&mut model, self.output)? - self.exact).abs();
            out.push_str(&row.line(exponent, error));
            csv.push_str(&row.csv(&self.name, self.steps, exponent, error));
        }
        out.push('\n');
        Ok(())
    }
}
