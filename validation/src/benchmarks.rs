//! Published benchmark mechanisms: error against exact values, run time and work, and what each further loop costs.
#[path = "../../fmu-build/src/chain/mechanism.rs"]
pub mod mechanism;

use crate::measure::{self, Row};
use linkage_fmu::model::{Model, ModelError};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// One mechanism with an output whose value at the end of the span is known.
struct Scene {
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

/// Angle of bar 0 [rad] after 10 s for N four-bars: pi/2 - 2 am(t/2 | -4 k), k = 9.81 ((N + 1)/2 + N) / ((N + 1)/3 + N).
const CHAINS: [(u32, f64); 3] =
    [(2, -30.179_800_860_191_205), (10, -30.050_933_495_986_976), (40, -30.026_637_417_190_84)];

/// The tables in Markdown.
pub fn table(descriptions: &Path) -> Result<String, String> {
    let mut out = String::from("# Published benchmark mechanisms\n\n");
    let _ = writeln!(
        out,
        "In the engine, without a host, one core. Error: the named output at the end against its exact value. Time: the \
         fastest of several runs, the steps alone. Evaluations: of the right-hand side. Instantiation: reading, closing \
         the loops, tracing the curve and building the tables that the first step needs, once.\n"
    );
    for scene in scenes(descriptions)? {
        scene.report(&mut out).map_err(|e| format!("{}: {e}", scene.title))?;
    }
    Ok(out)
}

fn scenes(descriptions: &Path) -> Result<Vec<Scene>, String> {
    let read = |name: &str| measure::mechanism(&descriptions.join(name));
    let (andrews, slcrank) = (read("AndrewsSqueezer")?, read("SlCrank")?);
    let mut scenes = Vec::new();
    for steps in [1, 300] {
        scenes.push(Scene {
            title: format!("Andrews' squeezer, 0.03 s in {steps} doSteps"),
            text: andrews.clone(),
            span: 0.03,
            steps,
            output: "K1.angle",
            unit: "rad",
            exact: 15.810_771_195_153_797,
        });
    }
    for steps in [1, 1000] {
        scenes.push(Scene {
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
    fn report(&self, out: &mut String) -> Result<(), ModelError> {
        /// Runs of which the fastest counts.
        const RUNS: usize = 50;
        let began = Instant::now();
        let mut model = Model::from_json(&self.text)?;
        let instantiation = began.elapsed().as_secs_f64() * 1e3;
        let _ = writeln!(out, "## {}\n\nInstantiation {instantiation:.1} ms.\n", self.title);
        out.push_str(&measure::heading(self.unit));
        for exponent in [6, 9, 12] {
            let row = Row::measure(&mut model, 10f64.powi(-exponent), self.span, self.steps, RUNS)?;
            let error = (measure::output(&mut model, self.output)? - self.exact).abs();
            out.push_str(&row.line(exponent, error));
        }
        out.push('\n');
        Ok(())
    }
}
