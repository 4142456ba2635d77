"""terminalsAndIcons.xml: valid after the schema of FMI 3.0, as FMI 2.0.5 has it, and true to the variables; icons."""

from __future__ import annotations

import zipfile
from pathlib import Path

import fmpy
import pytest
from conftest import FMU_FOLDER, REPOSITORY
from fmpy import extract, read_model_description
from lxml import etree

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
"""FMPy's copy of the schema."""


@pytest.mark.parametrize(
    ("name", "drives"),
    [
        ("LandingGearRetraction", {"actuator": ["force", "length", "speed", "acceleration"]}),
        ("CraneJib", {"cylinder": ["force", "length", "speed", "acceleration"]}),
        ("SliderCrank", {"drive": ["torque", "angle", "speed", "acceleration"]}),
    ],
)
def test_each_drive_is_a_terminal(tmp_path: Path, name: str, drives: dict[str, list[str]]) -> None:
    folder = Path(extract(str(FMU_FOLDER / f"{name}.fmu"), str(tmp_path)))
    document = etree.parse(folder / "terminalsAndIcons" / "terminalsAndIcons.xml")
    etree.XMLSchema(etree.parse(SCHEMA)).assertValid(document)
    variables = {variable.name: variable for variable in read_model_description(folder).modelVariables}
    found = {}
    for terminal in document.iter("Terminal"):
        members = list(terminal.iter("TerminalMemberVariable"))
        found[terminal.get("name")] = [member.get("memberName") for member in members]
        causalities = [variables[member.get("variableName")].causality for member in members]
        assert causalities == ["input", "output", "output", "output"]
    assert found == drives


@pytest.mark.parametrize("name", sorted(p.parent.name for p in (REPOSITORY / "modelDescription").glob("*/resources")))
def test_each_fmu_has_an_icon_and_documentation(name: str) -> None:
    with zipfile.ZipFile(FMU_FOLDER / f"{name}.fmu") as archive:
        assert archive.read("model.png").startswith(b"\x89PNG\r\n")
        assert b"<html" in archive.read("documentation/index.html")
        document = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
    etree.XMLSchema(etree.parse(SCHEMA)).assertValid(document)
    assert document.find("GraphicalRepresentation/Icon") is not None


def test_without_a_drive_there_is_no_terminal(tmp_path: Path) -> None:
    folder = Path(extract(str(FMU_FOLDER / "FourBarChain.fmu"), str(tmp_path)))
    document = etree.parse(folder / "terminalsAndIcons" / "terminalsAndIcons.xml")
    assert document.find("Terminals") is None
