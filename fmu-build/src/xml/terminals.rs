//! The writer of `terminalsAndIcons.xml`: which variables belong together as one connection.
//!
//! In: the table of variables. Out: the text of the file, one terminal for each drive: its force or torque goes in; its
//! length, angle or position, with the first two derivatives, comes out. FMI 2.0.5, 2.3, takes the file over from FMI
//! 3.0, 2.4.9, with that version in it.

use super::common::{document, element, empty, group};
use anyhow::Result;
use linkage_fmu::mechanism::quantity::{Output, Quantity};
use linkage_fmu::variables::{Variable, Variables};

/// Path of the file in an FMU.
pub const PATH: &str = "terminalsAndIcons/terminalsAndIcons.xml";

/// One drive's variables.
struct Terminal<'a> {
    name: &'a str,
    members: Vec<&'a Variable>,
}

/// The text of the file; none if the mechanism has no drive.
///
/// # Errors
/// XML cannot be written.
pub fn to_xml(variables: &Variables<Quantity>) -> Result<Option<String>> {
    let terminals = terminals(variables);
    if terminals.is_empty() {
        return Ok(None);
    }
    let text = document("fmiTerminalsAndIcons", &[("fmiVersion", "3.0".to_owned())], |xml| {
        group(xml, "Terminals", |xml| {
            terminals.iter().try_for_each(|Terminal { name, members }| {
                let attributes = [
                    ("name", (*name).to_owned()),
                    ("matchingRule", "bus".to_owned()),
                    ("description", format!("The drive {name}")),
                ];
                element(xml, "Terminal", &attributes, |xml| {
                    members.iter().try_for_each(|member| {
                        let attributes = [
                            ("variableName", member.name.clone()),
                            ("memberName", quantity(member).to_owned()),
                            ("variableKind", "signal".to_owned()),
                        ];
                        empty(xml, "TerminalMemberVariable", &attributes)
                    })
                })
            })
        })
    })?;
    Ok(Some(text))
}

/// What follows the dot in `actuator.force`.
fn quantity(variable: &Variable) -> &str {
    variable.name.rsplit_once('.').map_or(variable.name.as_str(), |(_, quantity)| quantity)
}

/// The drives: an input, and the displacement along which it does work, with its derivatives.
fn terminals(variables: &Variables<Quantity>) -> Vec<Terminal<'_>> {
    let all = || (0..).zip(variables.list());
    all()
        .filter_map(|(reference, input)| {
            let (name, _) = input.name.rsplit_once('.')?;
            let Some(Quantity::Input(index)) = variables.quantity(reference) else { return None };
            // Springs have a length too, but under another name.
            let displacements: Vec<_> = all()
                .filter(|(reference, output)| {
                    let quantity = variables.quantity(*reference);
                    matches!(quantity, Some(Quantity::Output(Output::Displacement { load, .. })) if load == index)
                        && output.name.rsplit_once('.').is_some_and(|(owner, _)| owner == name)
                })
                .map(|(_, output)| output)
                .collect();
            let members = std::iter::once(input).chain(displacements.iter().copied()).collect();
            (!displacements.is_empty()).then_some(Terminal { name, members })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::{MECHANISM, Workspace};
    use linkage_fmu::mechanism::Model;
    use std::fs;

    fn file_of(name: &str) -> Option<String> {
        let path = Workspace::locate().descriptions().join(name).join("resources").join(MECHANISM);
        let model = Model::from_json(&fs::read_to_string(path).unwrap()).unwrap();
        to_xml(model.variables()).unwrap()
    }

    #[test]
    fn a_drive_is_a_terminal() {
        let expected = |name: &str, members: &[&str]| {
            let mut lines = format!("<Terminal name=\"{name}\" matchingRule=\"bus\" description=\"The drive {name}\">");
            for member in members {
                lines += &format!(
                    "<TerminalMemberVariable variableName=\"{name}.{member}\" memberName=\"{member}\" variableKind=\"signal\"/>"
                );
            }
            lines + "</Terminal>"
        };
        for (mechanism, terminal) in [
            ("LandingGearRetraction", expected("actuator", &["force", "length", "speed", "acceleration"])),
            ("FourBar", expected("drive", &["torque", "angle", "speed", "acceleration"])),
        ] {
            let text: String = file_of(mechanism).unwrap().lines().map(str::trim).collect();
            assert_eq!(text.matches("<Terminal ").count(), 1, "{text}");
            assert!(text.contains(&terminal), "{terminal} is not in {text}");
        }
    }

    #[test]
    fn without_a_drive_there_is_no_file() {
        assert_eq!(file_of("FourBarChain"), None);
        assert_eq!(file_of("AndrewsSqueezer"), None);
    }
}
