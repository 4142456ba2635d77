//! The writer of `terminalsAndIcons.xml`: where the icon stands, and which variables belong together as one connection.
//!
//! In: the component. Out: the text of the file. FMI 2.0.5, 2.3, takes the file over from FMI 3.0, 2.4.9, with that
//! version in it.

use super::common::{document, element, empty, group};
use anyhow::Result;
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Terminal, Variable};

/// Path of the file in an FMU.
pub const PATH: &str = "terminalsAndIcons/terminalsAndIcons.xml";

/// Half the side of the icon in the coordinates of a diagram, which count from its middle.
const HALF: &str = "100";
/// Size in which a tool shows a unit of these coordinates [mm], as in Modelica's diagrams.
const MILLIMETRES: &str = "0.1";

/// The text of the file.
///
/// # Errors
/// XML cannot be written.
pub fn to_xml(component: &Component) -> Result<String> {
    let (terminals, interface) = (component.terminals(), component.interface());
    document("fmiTerminalsAndIcons", &[("fmiVersion", "3.0".to_owned())], |xml| {
        group(xml, "GraphicalRepresentation", |xml| {
            let corners = ["x1", "y1", "x2", "y2"].map(|name| {
                let sign = if name.ends_with('1') { "-" } else { "" };
                (name, format!("{sign}{HALF}"))
            });
            let scale = ("suggestedScalingFactorTo_mm", MILLIMETRES.to_owned());
            empty(xml, "CoordinateSystem", &[corners.to_vec(), vec![scale]].concat())?;
            empty(xml, "Icon", &corners)
        })?;
        if terminals.is_empty() {
            return Ok(());
        }
        group(xml, "Terminals", |xml| {
            terminals.into_iter().try_for_each(|Terminal { name, description, members }| {
                let attributes = [("name", name), ("matchingRule", "bus".to_owned()), ("description", description)];
                element(xml, "Terminal", &attributes, |xml| {
                    members.into_iter().filter_map(|member| interface.get(member)).try_for_each(|member| {
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
    })
}

/// What follows the dot in `actuator.force`.
fn quantity(variable: &Variable) -> &str {
    variable.name.rsplit_once('.').map_or(variable.name.as_str(), |(_, quantity)| quantity)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::{MECHANISM, Workspace};
    use std::fs;

    fn file_of(name: &str) -> String {
        let path = Workspace::locate().descriptions().join(name).join("resources").join(MECHANISM);
        let text = fs::read_to_string(path).unwrap();
        to_xml(&Component::from_definition(MECHANISM, &text).unwrap()).unwrap()
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
            let text: String = file_of(mechanism).lines().map(str::trim).collect();
            assert_eq!(text.matches("<Terminal ").count(), 1, "{text}");
            assert!(text.contains(&terminal), "{terminal} is not in {text}");
        }
    }

    #[test]
    fn a_hydraulic_actuator_has_the_terminal_of_the_drive_that_it_moves() {
        let file = "hydraulics.json";
        let path = Workspace::locate().descriptions().join("HydraulicActuator").join("resources").join(file);
        let component = Component::from_definition(file, &fs::read_to_string(path).unwrap()).unwrap();
        let text: String = to_xml(&component).unwrap().lines().map(str::trim).collect();
        let members: Vec<&str> =
            text.split("memberName=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(members[..4], ["force", "length", "speed", "acceleration"]);
        let gear = file_of("LandingGearRetraction");
        assert!(members[..4].iter().all(|member| gear.contains(&format!("memberName=\"{member}\""))));
    }

    #[test]
    fn without_a_drive_there_is_an_icon_alone() {
        for name in ["FourBarChain", "AndrewsSqueezer"] {
            let text = file_of(name);
            assert!(text.contains("<Icon x1=\"-100\" y1=\"-100\" x2=\"100\" y2=\"100\"/>"), "{text}");
            assert!(!text.contains("Terminals>"), "{text}");
        }
    }
}
