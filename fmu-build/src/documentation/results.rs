//! Reference results according to the layered standard FMI-LS-REF 1.0.0-alpha.1: the results of the default run, for
//! comparison with the results of other tools.
//!
//! In: a model. Out: inputs and outputs of its default run as CSV, and the manifest that names them.

use crate::archive::Entry;
use crate::documentation::{ANIMATION, PAGE};
use crate::run;
use crate::workspace::Workspace;
use crate::xml::common::{document, empty, number};
use anyhow::{Context, Result, bail};
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Causality, Value, Variable};
use std::{fs, process};

/// Folder in the FMU.
pub const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";
/// Path of the manifest in the FMU.
pub const MANIFEST: &str = "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml";
/// Path of the remarks, as recommended by the layered standard.
const REMARKS: &str = "documentation/fmi-ls-ref.txt";
/// Largest number of rows of the results: enough for a curve, and small compared with the library.
const MOST_ROWS: u64 = 200;
/// Largest number of outputs of a model with results.
const MOST_OUTPUTS: usize = 2000;

/// Inputs and outputs of the default run.
#[derive(Clone, Debug)]
pub struct Results {
    name: String,
    /// The inputs as CSV. None for a model without inputs.
    inputs: Option<String>,
    outputs: String,
    /// Time between two steps of the run [s].
    pub interval: f64,
    /// Number of steps between two rows.
    pub stride: u64,
    /// Rows of the results.
    pub rows: usize,
}

impl Results {
    /// Run the model from its start values over its experiment.
    ///
    /// # Errors
    /// The run fails or ends early, or the model has too many outputs.
    pub fn new(workspace: &Workspace, component: &Component) -> Result<Self> {
        let is_output = |variable: &&Variable| variable.causality == Causality::Output;
        let count = component.interface().list().iter().filter(is_output).count();
        if count > MOST_OUTPUTS {
            bail!(
                "the model has {count} outputs, but at most {MOST_OUTPUTS} are allowed; record the outputs you need \
                 with `{} simulate`",
                workspace.program()
            );
        }
        let folder = workspace.target("reference");
        fs::create_dir_all(&folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
        let path = folder.join(format!("{}-{}.csv", component.name(), process::id()));
        let mut after = component.clone();
        let ran = run::default_run(&mut after, &path, MOST_ROWS);
        let text = fs::read_to_string(&path).with_context(|| format!("{}: cannot be read", path.display()));
        // The next run overwrites a remaining file.
        let _ = fs::remove_file(&path);
        let (run::DefaultRun { interval, stride }, outputs) = (ran?, text?);
        let rows = outputs.lines().count().saturating_sub(1);
        Ok(Self {
            name: component.name().to_owned(),
            inputs: inputs(component, &mut after)?,
            outputs,
            interval,
            stride,
            rows,
        })
    }

    /// Path of the outputs in the FMU.
    pub fn outputs_path(&self) -> String {
        format!("{FOLDER}/{}_out.csv", self.name)
    }

    /// Path of the inputs in the FMU, if there are any.
    pub fn inputs_path(&self) -> Option<String> {
        self.inputs.as_ref().map(|_| format!("{FOLDER}/{}_in.csv", self.name))
    }

    /// The text of the remarks.
    fn remarks(&self) -> String {
        format!(
            "Reference results of {name}, in the form of the layered standard FMI-LS-REF.\n\n\
             {name}_out.csv contains every output over the default experiment, with {rows}.\n\
             All parameters and inputs have their start values. The communication step is {interval} s.\n\
             The library in this FMU computed these results. On the same platform, a run with the same communication\n\
             steps gives identical results. On other platforms the rounding can differ.\n\
             NaN marks an output without a value in the present state.\n{inputs}",
            name = self.name,
            interval = number(self.interval),
            rows = match self.stride {
                1 => "one row for each communication step".to_owned(),
                stride => format!("one row for every {stride} communication steps, and one row for the end of the run"),
            },
            inputs = match &self.inputs {
                Some(_) => format!(
                    "{}_in.csv contains the inputs, which are constant. A simulation tool that interpolates the inputs \
                     can introduce rounding errors.\n",
                    self.name
                ),
                None => String::new(),
            }
        )
    }

    /// The files for the FMU, in which the definition has this path.
    ///
    /// # Errors
    /// XML cannot be written.
    pub fn entries(self, definition: &str, is_animated: bool) -> Result<Vec<Entry>> {
        let remarks = self.remarks();
        let (outputs, inputs) = (format!("{}_out.csv", self.name), format!("{}_in.csv", self.name));
        let above = |path: &str| format!("../../{path}");
        let animation =
            is_animated.then(|| ("text/html", above(ANIMATION), "document", "Animation of the default run"));
        let of_inputs =
            self.inputs.as_ref().map(|_| ("text/csv", inputs.clone(), "other", "Inputs of the default experiment"));
        let related = [
            Some(("text/csv", outputs.clone(), "result", "Output of the default experiment")),
            of_inputs,
            Some(("application/json", above(definition), "model", "Definition from which the FMU was built")),
            Some(("text/html", above(PAGE), "document", "Documentation")),
            animation,
        ];
        let namespace = "http://fmi-standard.org/fmi-ls-manifest";
        let root = [
            ("xmlns:fmi-ls", namespace),
            ("fmi-ls:fmi-ls-name", "org.fmi-standard.fmi-ls-ref"),
            ("fmi-ls:fmi-ls-version", "1.0.0-alpha.1"),
            (
                "fmi-ls:fmi-ls-description",
                "Layered Standard providing information on related files included in an FMU.",
            ),
        ]
        .map(|(name, value)| (name, value.to_owned()));
        let manifest = document("fmiReferences", &root, |xml| {
            related.into_iter().flatten().try_for_each(|(kind, source, role, description)| {
                let attributes = [("type", kind), ("source", &source), ("role", role), ("description", description)];
                empty(xml, "Related", &attributes.map(|(name, value)| (name, value.to_owned())))
            })
        })?;
        let mut entries = vec![
            Entry { name: MANIFEST.to_owned(), content: manifest.into_bytes() },
            Entry { name: REMARKS.to_owned(), content: remarks.into_bytes() },
            Entry { name: format!("{FOLDER}/{outputs}"), content: self.outputs.into_bytes() },
        ];
        entries
            .extend(self.inputs.map(|text| Entry { name: format!("{FOLDER}/{inputs}"), content: text.into_bytes() }));
        Ok(entries)
    }
}

/// The inputs of the default run: their start values at the start and at the end. None if a step changes inputs, such
/// as the length of a cylinder that follows its predicted motion: constant inputs would reset it. `after`: the
/// component at the end of the run.
fn inputs(component: &Component, after: &mut Component) -> Result<Option<String>> {
    let list = component.interface().list().iter().enumerate();
    let inputs: Vec<_> = list.filter(|(_, variable)| variable.causality == Causality::Input).collect();
    let mut moves =
        |reference: usize, value: f64| after.real(reference as u32).is_ok_and(|now| now.to_bits() != value.to_bits());
    if inputs.iter().any(|(reference, input)| matches!(input.start, Some(Value::Real(v)) if moves(*reference, v))) {
        return Ok(None);
    }
    let values = inputs.iter().filter_map(|(_, input)| match input.start {
        Some(Value::Real(value)) => Some((input.name.as_str(), number(value))),
        Some(Value::Boolean(value)) => Some((input.name.as_str(), u8::from(value).to_string())),
        _ => None,
    });
    let (mut names, mut starts): (Vec<&str>, Vec<String>) = values.unzip();
    if names.is_empty() {
        return Ok(None);
    }
    names.insert(0, "time");
    let mut head = csv::WriterBuilder::new().quote_style(csv::QuoteStyle::Always).from_writer(Vec::new());
    head.write_record(&names)?;
    let mut text = String::from_utf8(head.into_inner().context("the head of the inputs")?)?;
    for time in [0.0, component.experiment().stop_time] {
        starts.insert(0, number(time));
        text += &starts.join(",");
        text.push('\n');
        starts.remove(0);
    }
    Ok(Some(text))
}
