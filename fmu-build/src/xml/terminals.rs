//! The writer of `terminalsAndIcons.xml`: position of the icon, and variables that form one connection.
//!
//! In: the component. Out: the text of the file. FMI 2.0.5, 2.3, uses the file of FMI 3.0, 2.4.9, with the version of
//! FMI 3.0.

use super::common::{document, element, empty, group};
use anyhow::Result;
use linkage_fmu::component::Component;
use linkage_fmu::variables::Terminal;

/// Path of the file in an FMU.
pub const PATH: &str = "terminalsAndIcons/terminalsAndIcons.xml";

/// Prefix of the kind of a terminal. Two terminals fit if the position of the drive is the same quantity in both. Kinds
/// of a tool start with an underline and the name of the tool (FMI 3.0.2, 2.4.9.2.1).
const KIND: &str = "_linkage_fmu_drive_";

/// Half the side of the icon in the coordinates of a diagram, whose origin is the middle.
const HALF: &str = "100";
/// Size of a unit of these coordinates on the screen [mm], as in Modelica's diagrams.
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
            terminals.into_iter().try_for_each(|Terminal { name, kind, description, members }| {
                // With `bus`, members without a counterpart may stay open: a plain force can move the drive too.
                let attributes = [
                    ("name", name),
                    ("matchingRule", "bus".to_owned()),
                    ("terminalKind", [KIND, &kind].concat()),
                    ("description", description),
                ];
                element(xml, "Terminal", &attributes, |xml| {
                    members.into_iter().try_for_each(|member| {
                        let variable = interface.get(member.variable).map_or("", |variable| &variable.name);
                        // A force between two points is one number for both sides. It is no flow variable whose sum is
                        // zero.
                        let attributes = [
                            ("variableName", variable.to_owned()),
                            ("memberName", member.name),
                            ("variableKind", "signal".to_owned()),
                        ];
                        empty(xml, "TerminalMemberVariable", &attributes)
                    })
                })
            })
        })
    })
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
            let mut lines = format!(
                "<Terminal name=\"{name}\" matchingRule=\"bus\" terminalKind=\"_linkage_fmu_drive_{}\" \
                 description=\"Connection of the drive {name}: force, motion, reduced mass and load\">",
                members[1]
            );
            for member in members {
                lines += &format!(
                    "<TerminalMemberVariable variableName=\"{name}.{member}\" memberName=\"{member}\" \
                     variableKind=\"signal\"/>"
                );
            }
            lines + "</Terminal>"
        };
        let linear = ["reduced_mass", "reduced_mass_derivative", "holding_force", "holding_force_derivative"];
        let limits = ["lower_limit", "upper_limit"];
        let rotary = ["reduced_inertia", "reduced_inertia_derivative", "holding_torque", "holding_torque_derivative"];
        for (mechanism, name, motion, element, limits) in [
            ("LandingGearRetraction", "actuator", ["force", "length", "speed", "acceleration"], linear, &limits[..]),
            ("FourBar", "drive", ["torque", "angle", "speed", "acceleration"], rotary, &[]),
        ] {
            let terminal = expected(name, &[&motion[..], &element, limits].concat());
            let text: String = file_of(mechanism).lines().map(str::trim).collect();
            assert_eq!(text.matches("<Terminal ").count(), 1, "{text}");
            assert!(text.contains(&terminal), "{terminal} is not in {text}");
        }
    }

    /// Members with equal names are an output and an input with one unit. All members of the actuator have a
    /// counterpart.
    #[test]
    fn a_hydraulic_actuator_can_be_plugged_on_the_drive_that_it_moves() {
        let terminal = |name: &str, file: &str| {
            let path = Workspace::locate().descriptions().join(name).join("resources").join(file);
            let component = Component::from_definition(file, &fs::read_to_string(path).unwrap()).unwrap();
            let terminal = component.terminals().remove(0);
            (terminal, component)
        };
        let ((gear, of_gear), (oil, of_oil)) =
            (terminal("LandingGearRetraction", MECHANISM), terminal("HydraulicActuator", "hydraulics.json"));
        assert_eq!(gear.kind, oil.kind);
        assert_eq!(oil.members.len(), 10);
        for member in oil.members {
            let other = gear.members.iter().find(|other| other.name == member.name).unwrap();
            let [own, other] =
                [of_oil.interface().get(member.variable).unwrap(), of_gear.interface().get(other.variable).unwrap()];
            assert_eq!(own.unit, other.unit, "{}", member.name);
            assert_ne!(own.is_output(), other.is_output(), "{}", member.name);
            assert_eq!(own.is_output(), member.name == "force");
        }
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
