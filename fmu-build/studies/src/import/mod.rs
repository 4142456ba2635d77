//! `cargo fmu import`: converts mechanisms of other programs to definitions.
//!
//! In: a file or link of PMKS or PMKS+, a file of Pyslvs, MuJoCo (MJCF), ROS (URDF) or Gazebo (SDF), or a table of
//! joints. Out: the text of a definition, and the omitted parts of the file. The module must not know how a mechanism
//! moves.

mod bars;
mod couple;
mod masses;
mod mjcf;
mod planar;
mod plus;
mod plus_old;
mod pmks;
mod pyslvs;
mod sdf;
mod spatial;
mod table;
#[cfg(test)]
mod tests;
mod urdf;
mod xml;

use anyhow::{Context, Result, bail};
use fmu_build::files;
pub use fmu_cli::{Import as Arguments, ImportForm as Form};
use linkage_fmu::component::Component;
use std::path::Path;

/// Largest file that is imported [bytes].
const LARGEST: u64 = 16 << 20;

/// A definition, and notes about omitted and added parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// Text of the definition.
    pub definition: String,
    /// Notes, one per line.
    pub notes: Vec<String>,
}

/// Read a file and write it as a definition.
///
/// # Errors
/// The file cannot be read, or contains no planar mechanism; the definition cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let path = &arguments.path;
    let shown = path.display();
    // A link contains the mechanism.
    let link = path.to_str().filter(|path| path.contains("://"));
    let text = match link {
        Some(link) => link.to_owned(),
        None => {
            let text = String::from_utf8(files::read(path, LARGEST)?).ok();
            text.with_context(|| format!("{shown}: the file is not UTF-8 text; save the file as UTF-8"))?
        }
    };
    let form = match arguments.form {
        Some(form) => form,
        None => form_of(path, &text).with_context(|| format!("{shown}"))?,
    };
    let stem = path.file_stem().filter(|_| link.is_none()).unwrap_or_default().to_string_lossy();
    let folder = path.parent().unwrap_or_else(|| Path::new("")).to_owned();
    let included = |file: &str| -> Result<String> {
        String::from_utf8(files::read(&folder.join(file), LARGEST)?)
            .ok()
            .with_context(|| format!("{file}: the file is not UTF-8 text; save the file as UTF-8"))
    };
    let imported = import_with(form, &stem, &text, &included).with_context(|| format!("{shown}"))?;
    for note in &imported.notes {
        eprintln!("note: {note}");
    }
    match &arguments.out {
        Some(out) => {
            files::replace_named(out, "--out", imported.definition.as_bytes())?;
            eprintln!("{}", out.display());
        }
        None => print!("{}", imported.definition),
    }
    // A mechanism without exactly one degree of freedom is written too, so that the user can correct it.
    if let Err(refused) = Component::from_definition(Component::definition_files()[0], &imported.definition) {
        eprintln!("warning: {refused}; `cargo fmu check` prints the details");
    }
    Ok(())
}

/// The format of a file, by its name, or else by its first characters.
fn form_of(path: &Path, text: &str) -> Result<Form> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    Ok(match (ending.as_str(), bare(text).trim_start()) {
        (_, text) if plus::is_plus(text) || plus_old::is_old_plus(text) => Form::PmksPlus,
        (_, text) if text.starts_with('{') && text.contains("\"TypeOfJoint\"") => Form::Pmks,
        ("urdf" | "xacro", _) => Form::Urdf,
        ("sdf" | "world", _) => Form::Sdf,
        ("mjcf", _) => Form::Mjcf,
        ("csv", _) => Form::Table,
        (_, text) if text.starts_with("M[") || text.contains("mechanism:") && text.contains("M[") => Form::Pyslvs,
        (_, text) if text.contains("<mujoco") => Form::Mjcf,
        (_, text) if text.contains("<sdf") => Form::Sdf,
        (_, text) if text.contains("<robot") => Form::Urdf,
        ("txt" | "pmks", _) => Form::Pmks,
        (_, text) if text.contains("mech=") => Form::Pmks,
        _ => {
            bail!(
                "the format of this file is unknown; state the format with --form pmks, pmks-plus, pyslvs, mjcf, \
                urdf, sdf or table"
            )
        }
    })
}

/// A text without the byte order mark that programs on Windows write.
fn bare(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// The definition of a mechanism in this format. `name` is used if the file has no name.
///
/// # Errors
/// The text has another format, or contains parts that no planar mechanism has. The message states the place.
pub fn import(form: Form, name: &str, text: &str) -> Result<Imported> {
    import_with(form, name, text, &|file| {
        bail!(
            "{file}: the import of a text cannot read included files: import the \
        file by its path"
        )
    })
}

/// As [`import`], with the texts of included files by their paths in the file.
///
/// # Errors
/// The errors of [`import`], also for an included file.
pub fn import_with(form: Form, name: &str, text: &str, include: &dyn Fn(&str) -> Result<String>) -> Result<Imported> {
    let text = bare(text);
    let linkage = match form {
        Form::Pmks => table::linkage(name, &pmks::of_pmks(text)?)?,
        Form::PmksPlus if plus_old::is_old_plus(text) => plus_old::of_old_plus(name, text)?,
        Form::PmksPlus => plus::of_plus(name, text)?,
        Form::Pyslvs => table::linkage(name, &pyslvs::of_pyslvs(text)?)?,
        Form::Table => table::linkage(name, &table::of_csv(text)?)?,
        Form::Mjcf => spatial::project(mjcf::of_mjcf(name, text, include)?)?,
        Form::Urdf => spatial::project(urdf::of_urdf(name, text)?)?,
        Form::Sdf => spatial::project(sdf::of_sdf(name, text)?)?,
    };
    Ok(Imported { definition: linkage.definition()?, notes: linkage.notes })
}
