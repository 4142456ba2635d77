"""terminalsAndIcons.xml: valid by the schema of FMI 3.0, as FMI 2.0.5 requires, and consistent with the variables;
icons."""

from __future__ import annotations

import zipfile
from pathlib import Path

import fmpy
import pytest
from conftest import FMU_FOLDER, REPOSITORY
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave
from lxml import etree

MOTION = ["speed", "acceleration"]
ELEMENT = ["reduced_mass", "reduced_mass_derivative", "holding_force", "holding_force_derivative"]
LIMITS = ["lower_limit", "upper_limit"]
"""Outputs of a drive of a mechanism with stops."""
ROTARY = ["reduced_inertia", "reduced_inertia_derivative", "holding_torque", "holding_torque_derivative"]
SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
"""FMPy's copy of the schema."""
TIME_UP = 4.065842490726519
"""Time at which the gear is up [s], by an independent integration of gear and hydraulics as a single system."""


@pytest.mark.parametrize("extension", ["fmu", "fmi3.fmu"])
@pytest.mark.parametrize(
    ("name", "drives"),
    [
        ("LandingGearRetraction", {"actuator": ["force", "length", *MOTION, *ELEMENT, *LIMITS]}),
        ("CraneJib", {"cylinder": ["force", "length", *MOTION, *ELEMENT]}),
        ("SliderCrank", {"drive": ["torque", "angle", *MOTION, *ROTARY]}),
    ],
)
def test_each_drive_is_a_terminal(tmp_path: Path, name: str, drives: dict[str, list[str]], extension: str) -> None:
    folder = Path(extract(str(FMU_FOLDER / f"{name}.{extension}"), str(tmp_path)))
    document = etree.parse(folder / "terminalsAndIcons" / "terminalsAndIcons.xml")
    etree.XMLSchema(etree.parse(SCHEMA)).assertValid(document)
    variables = {variable.name: variable for variable in read_model_description(folder).modelVariables}
    found = {}
    for terminal in document.iter("Terminal"):
        members = list(terminal.iter("TerminalMemberVariable"))
        found[terminal.get("name")] = [member.get("memberName") for member in members]
        causalities = [variables[member.get("variableName")].causality for member in members]
        assert causalities == ["input"] + ["output"] * (len(members) - 1)
        assert {member.get("variableKind") for member in members} == {"signal"}
        assert terminal.get("matchingRule") == "bus"
        assert terminal.get("terminalKind") == f"_linkage_fmu_drive_{members[1].get('memberName')}"
    assert found == drives


@pytest.mark.parametrize("name", sorted(p.parent.name for p in (REPOSITORY / "modelDescription").glob("*/resources")))
def test_each_fmu_has_an_icon_and_documentation(name: str) -> None:
    with zipfile.ZipFile(FMU_FOLDER / f"{name}.fmu") as archive:
        assert archive.read("model.png").startswith(b"\x89PNG\r\n")
        assert b"<html" in archive.read("documentation/index.html")
        document = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
    etree.XMLSchema(etree.parse(SCHEMA)).assertValid(document)
    assert document.find("GraphicalRepresentation/Icon") is not None


class Part:
    """An instance of an FMU of FMI 3.0 in initialization mode, with the members of its only terminal."""

    def __init__(self, name: str, folder: Path) -> None:
        unpacked = extract(str(FMU_FOLDER / f"{name}.fmi3.fmu"), str(folder / name))
        description = read_model_description(unpacked)
        self.variables = {variable.name: variable for variable in description.modelVariables}
        (terminal,) = etree.parse(Path(unpacked) / "terminalsAndIcons" / "terminalsAndIcons.xml").iter("Terminal")
        self.kind = terminal.get("terminalKind")
        self.members = {
            member.get("memberName"): self.variables[member.get("variableName")]
            for member in terminal.iter("TerminalMemberVariable")
        }
        self.slave = FMU3Slave(
            guid=description.instantiationToken, unzipDirectory=unpacked, modelIdentifier=name, instanceName=name
        )
        self.slave.instantiate()
        self.slave.enterInitializationMode(startTime=0.0)

    def get(self, name: str) -> float:
        return self.slave.getFloat64([self.variables[name].valueReference])[0]


def connect(source: Part, target: Part) -> None:
    """Pass each output of a terminal to the input of the other terminal with the same name."""
    for name, output in source.members.items():
        known = target.members.get(name)
        if output.causality == "output" and known is not None and known.causality == "input":
            target.slave.setFloat64([known.valueReference], source.slave.getFloat64([output.valueReference]))


def test_a_cylinder_is_plugged_on_a_drive_by_the_terminals_alone(tmp_path: Path) -> None:
    step, start, up = 1e-3, 0.8, -1.3
    gear, oil = Part("LandingGearRetraction", tmp_path), Part("HydraulicActuator", tmp_path)
    assert gear.kind == oil.kind == "_linkage_fmu_drive_length"
    assert set(oil.members) <= set(gear.members)
    gear.slave.setBoolean([gear.variables["downstop.enabled"].valueReference], [False])
    ramp = {"command.ramp_amplitude": 0.65, "command.ramp_time": 0.1}
    oil.slave.setFloat64([oil.variables[name].valueReference for name in ramp], list(ramp.values()))
    connect(gear, oil)
    gear.slave.exitInitializationMode()
    oil.slave.exitInitializationMode()
    angle, speed, count = start, 0.0, 0
    while angle + speed * step > up:
        connect(gear, oil)
        connect(oil, gear)
        for part in (gear, oil):
            part.slave.doStep(count * step, step)
        angle, speed = gear.get("crank.angle"), gear.get("crank.speed")
        count += 1
    time_up = count * step + (up - angle) / speed
    # As exact as the loop of docs/how-to/couple-two-fmus.md, which uses the names of the variables.
    assert time_up == pytest.approx(TIME_UP, abs=1e-5)
    for part in (gear, oil):
        part.slave.terminate()
        part.slave.freeInstance()


def test_without_a_drive_there_is_no_terminal(tmp_path: Path) -> None:
    folder = Path(extract(str(FMU_FOLDER / "FourBarChain.fmu"), str(tmp_path)))
    document = etree.parse(folder / "terminalsAndIcons" / "terminalsAndIcons.xml")
    assert document.find("Terminals") is None
