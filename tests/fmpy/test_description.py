"""modelDescription.xml against the standard's schema and FMPy's rules, and the layout of the zip file."""

from __future__ import annotations

import os
import subprocess
import zipfile
from pathlib import Path

import pytest
from conftest import NAME, REPOSITORY, Start
from fmpy import read_model_description, sharedLibraryExtension
from fmpy.validation import validate_fmu

LONGEST_PACKAGING = 900.0
"""Time limit for packing, including a cold build [s]."""


def test_validation_reports_no_fault(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []


def test_description_matches_the_schema(fmu: Path) -> None:
    description = read_model_description(str(fmu), validate=True, validate_variable_names=True)
    assert description.fmiVersion == "2.0"
    assert description.modelName == description.coSimulation.modelIdentifier == NAME
    assert description.modelExchange.modelIdentifier == NAME
    assert description.numberOfEventIndicators == 15
    assert description.numberOfContinuousStates == 2
    assert description.coSimulation.canHandleVariableCommunicationStepSize
    assert description.coSimulation.canNotUseMemoryManagementFunctions


def test_default_experiment_is_complete(fmu: Path) -> None:
    experiment = read_model_description(str(fmu)).defaultExperiment
    assert float(experiment.startTime) == 0.0
    assert float(experiment.stopTime) > 0.0
    assert float(experiment.stepSize) > 0.0
    assert float(experiment.tolerance) == 1e-9


def test_start_values_are_those_of_the_binary(fmu: Path, instantiate: Start) -> None:
    instance = instantiate()
    checked = 0
    for name, variable in instance.variables.items():
        if variable.type == "Real" and variable.start is not None:
            assert instance.get(name) == [float(variable.start)], name
            checked += 1
    assert checked > 10


def test_every_dependency_is_an_input_or_a_parameter(fmu: Path) -> None:
    description = read_model_description(str(fmu))
    for unknown in description.outputs:
        assert unknown.dependencies is not None, unknown.variable.name
        states = {"along_curve.position", "along_curve.speed"}
        inputs = [known for known in unknown.dependencies if known.name not in states]
        assert {known.causality for known in inputs} <= {"input"}, unknown.variable.name
    for unknown in description.initialUnknowns:
        known = {known.causality for known in unknown.dependencies or []}
        assert known <= {"input", "parameter"}, unknown.variable.name


@pytest.mark.parametrize(
    ("name", "causality", "unit"),
    [
        ("actuator.force", "input", "N"),
        ("load_factor", "input", "1"),
        ("wheel.force_x", "input", "N"),
        ("wheel.force_y", "input", "N"),
        ("crank.torque", "input", "N.m"),
        ("follower.torque", "input", "N.m"),
        *[(f"{body}.angle", "output", "rad") for body in ("crank", "coupler", "follower")],
        *[(f"{body}.speed", "output", "rad/s") for body in ("crank", "coupler", "follower")],
        *[(f"{body}.acceleration", "output", "rad/s2") for body in ("crank", "coupler", "follower")],
        *[(f"joint{i}.{force}", "output", "N") for i in (1, 2, 3, 4) for force in ("force_x", "force_y", "force")],
        ("actuator.length", "output", "m"),
        ("actuator.speed", "output", "m/s"),
        ("actuator.acceleration", "output", "m/s2"),
        ("actuator.reduced_mass", "output", "kg"),
        ("actuator.holding_force", "output", "N"),
        ("wheel.x", "output", "m"),
        ("wheel.y", "output", "m"),
        *[(f"energy.{kind}", "output", "J") for kind in ("kinetic", "potential", "drift")],
        ("solver.tolerance", "parameter", "1"),
        ("crank.start_angle", "parameter", "rad"),
        ("crank.start_speed", "parameter", "rad/s"),
        ("crank.length", "parameter", "m"),
    ],
)
def test_the_interface_is_as_agreed(fmu: Path, name: str, causality: str, unit: str | None) -> None:
    variables = {variable.name: variable for variable in read_model_description(str(fmu)).modelVariables}
    assert (variables[name].causality, variables[name].unit) == (causality, unit)


def test_angles_are_shown_in_degrees(fmu: Path) -> None:
    for variable in read_model_description(str(fmu)).modelVariables:
        assert variable.unit != "rad" or variable.displayUnit == "deg", variable.name


def test_zip_is_plain_and_ordered(fmu: Path) -> None:
    with zipfile.ZipFile(fmu) as archive:
        entries = archive.infolist()
    names = [entry.filename for entry in entries]
    assert names[0] == "modelDescription.xml"
    assert names[1:] == sorted(names[1:])
    assert "resources/mechanism.json" in names
    assert "documentation/index.html" in names
    assert [name for name in names if name.endswith(f"/{NAME}{sharedLibraryExtension}")]
    for entry in entries:
        assert not entry.filename.startswith(("/", "./")), entry.filename
        assert not entry.filename.endswith("/"), entry.filename
        assert "\\" not in entry.filename
        assert entry.date_time == (1980, 1, 1, 0, 0, 0)
        is_stored = entry.filename.startswith("binaries/") or entry.filename.endswith("tables.bin")
        assert entry.compress_type == (zipfile.ZIP_STORED if is_stored else zipfile.ZIP_DEFLATED)


def test_packing_twice_gives_the_same_bytes(tmp_path: Path) -> None:
    contents = []
    for folder in ("first", "second"):
        command = [os.environ.get("CARGO", "cargo"), "fmu", "package", "--out", str(tmp_path / folder)]
        subprocess.run(command, cwd=REPOSITORY, check=True, capture_output=True, timeout=LONGEST_PACKAGING)
        contents.append((tmp_path / folder / f"{NAME}.fmu").read_bytes())
    assert contents[0] == contents[1]
