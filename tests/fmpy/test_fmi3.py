"""FMUs of FMI 3.0: the standard's schema, FMPy as host, and results bit-identical to FMI 2.0."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from conftest import NAME, REPOSITORY
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from test_own_mechanism import package, refused

NAMES = [NAME, "HydraulicActuator", "SliderCrank"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with FMUs of both versions."""
    out = tmp_path_factory.mktemp("both versions")
    paths = [str(REPOSITORY / "modelDescription" / name) for name in NAMES]
    done = package(Path(), *paths, "--out", str(out), "--no-animation")
    assert done.returncode == 0, done.stderr
    return out


@pytest.mark.parametrize("name", NAMES)
def test_both_versions_are_valid_and_equal(folder: Path, name: str) -> None:
    second, third = folder / f"{name}.fmu", folder / f"{name}.fmi3.fmu"
    assert validate_fmu(str(second)) == []
    assert validate_fmu(str(third)) == []
    description = read_model_description(str(third), validate=True, validate_variable_names=True)
    assert description.fmiVersion == "3.0"
    assert description.coSimulation.modelIdentifier == name
    assert description.coSimulation.canSerializeFMUstate
    with zipfile.ZipFile(third) as archive:
        assert any(entry.startswith("binaries/x86_64-") for entry in archive.namelist())
    before = read_model_description(str(second))
    names = [v.name for v in description.modelVariables]
    scalars = [v.name for v in before.modelVariables] + ["time"]
    assert names[: len(scalars)] == scalars
    vectors = description.modelVariables[len(scalars) :]
    assert [v.valueReference for v in vectors] == list(range(len(scalars), len(names)))
    assert all(v.shape == (2,) and v.causality == "output" for v in vectors)
    for one, other in zip(description.modelVariables, before.modelVariables, strict=False):
        assert (one.valueReference, one.unit, one.causality) == (other.valueReference, other.unit, other.causality)
        assert one.start == other.start


def test_a_retraction_has_the_bits_of_fmi_2(folder: Path) -> None:
    def run(extension: str) -> np.ndarray:
        return simulate_fmu(
            str(folder / f"{NAME}.{extension}"),
            start_values={"actuator.force": 30_000.0, "load_factor": 3.0, "friction.enabled": True},
            output=["crank.angle", "joint2.force", "upstop.reached"],
            stop_time=0.13,
            output_interval=1e-3,
            relative_tolerance=1e-9,
        )

    second, third = run("fmu"), run("fmi3.fmu")
    assert len(third) == len(second) == 131
    for name in second.dtype.names:
        assert np.array_equal(second[name], third[name]), name


VECTORS = {
    "joint1.reaction": ["joint1.force_x", "joint1.force_y"],
    "wheel.position": ["wheel.x", "wheel.y"],
    "wheel.velocity": ["wheel.velocity_x", "wheel.velocity_y"],
    "wheel.acceleration": ["wheel.acceleration_x", "wheel.acceleration_y"],
}


def test_vectors_are_their_elements(folder: Path) -> None:
    fmu = str(folder / f"{NAME}.fmi3.fmu")
    description = read_model_description(fmu)
    named = {v.name: v for v in description.modelVariables}
    found = [v.name for v in description.modelVariables if v.shape]
    assert found == [f"joint{n}.reaction" for n in range(1, 5)] + list(VECTORS)[1:]
    assert named["joint1.reaction"].unit == "N"
    outputs = {unknown.variable.name: unknown for unknown in description.outputs}
    initial = {unknown.variable.name: unknown for unknown in description.initialUnknowns}
    for vector, elements in VECTORS.items():
        for unknowns in (outputs, initial):
            knowns = {known.name for known in unknowns[vector].dependencies}
            assert knowns == {known.name for name in elements for known in unknowns[name].dependencies}
    output = [name for vector, elements in VECTORS.items() for name in (vector, *elements)]
    result = simulate_fmu(fmu, output=output, stop_time=0.13, output_interval=1e-3)
    for vector, elements in VECTORS.items():
        assert result[vector].shape == (131, 2)
        for axis, name in enumerate(elements):
            assert np.array_equal(result[vector][:, axis], result[name])
        assert np.any(result[vector] != 0.0)
    # Without a list of outputs FMPy records all of them.
    every = simulate_fmu(fmu, stop_time=0.05, output_interval=1e-2)
    assert every["joint4.reaction"].shape == (6, 2)


@pytest.fixture
def gear(folder: Path) -> Iterator[FMU3Slave]:
    """An instance of FMI 3.0 in step mode. `references` contains the references of its variables by name."""
    unpacked = extract(str(folder / f"{NAME}.fmi3.fmu"))
    description = read_model_description(unpacked)
    instance = FMU3Slave(
        guid=description.instantiationToken,
        unzipDirectory=unpacked,
        modelIdentifier=NAME,
        instanceName="gear",
    )
    instance.references = {v.name: v.valueReference for v in description.modelVariables}
    instance.instantiate()
    instance.enterInitializationMode(tolerance=1e-9, startTime=0.0)
    instance.exitInitializationMode()
    yield instance
    instance.terminate()
    instance.freeInstance()
    shutil.rmtree(unpacked, ignore_errors=True)


def test_states_derivatives_and_time(gear: FMU3Slave) -> None:
    angle, time, acceleration, force = (
        gear.references[name] for name in ("crank.angle", "time", "crank.acceleration", "actuator.force")
    )
    assert gear.doStep(0.0, 0.01) == (False, False, False, 0.01)
    state = gear.getFMUState()
    stored = gear.serializeFMUState(state)
    gear.doStep(0.01, 0.02)
    there = gear.getFloat64([angle, time])
    assert there[1] == 0.03
    for again in (state, gear.deserializeFMUState(stored)):
        gear.setFMUState(again)
        gear.doStep(0.01, 0.02)
        assert gear.getFloat64([angle, time]) == there
        gear.freeFMUState(again)
    forward = gear.getDirectionalDerivative([acceleration], [force], [2.0])
    back = gear.getAdjointDerivative([acceleration], [force], [2.0])
    assert forward[0] == back[0] != 0.0
    (before,) = gear.getFloat64([acceleration])
    gear.setFloat64([force], [gear.getFloat64([force])[0] + 10.0])
    # The acceleration is linear in the force.
    assert gear.getFloat64([acceleration])[0] - before == pytest.approx(5.0 * forward[0], rel=1e-9)


@pytest.mark.parametrize(("version", "extension"), [("2", "fmu"), ("3", "fmi3.fmu")])
def test_one_version_can_be_packed_alone(tmp_path: Path, version: str, extension: str) -> None:
    path = REPOSITORY / "modelDescription" / "SliderCrank"
    done = package(Path(), str(path), "--fmi", version, "--out", str(tmp_path), "--no-animation", "--no-results")
    assert done.returncode == 0, done.stderr
    assert [made.name for made in tmp_path.iterdir()] == [f"SliderCrank.{extension}"]
    assert f"SliderCrank.{extension} (" in done.stdout


def test_the_system_is_one_of_fmi_2(tmp_path: Path) -> None:
    assert "--fmi 2" in refused(package(Path(), "--ssp", "--fmi", "3", "--out", str(tmp_path)))


RETRACTED = 0.1320598527442597
"""Time at which the crank reaches its up stop, from a quadrature with 34 digits [s]."""


def test_steps_return_early_at_the_stop(folder: Path) -> None:
    description = read_model_description(str(folder / f"{NAME}.fmi3.fmu"))
    assert description.coSimulation.hasEventMode
    assert description.coSimulation.mightReturnEarlyFromDoStep
    assert read_model_description(str(folder / "HydraulicActuator.fmi3.fmu")).coSimulation.hasEventMode
    assert not read_model_description(str(folder / "SliderCrank.fmi3.fmu")).coSimulation.hasEventMode

    def run(**arguments: bool) -> np.ndarray:
        return simulate_fmu(
            str(folder / f"{NAME}.fmi3.fmu"),
            start_values={"upstop.restitution": 0.125},
            output=["crank.angle", "crank.speed", "upstop.impact_count", "upstop.impact_time"],
            stop_time=0.4,
            output_interval=0.05,
            relative_tolerance=1e-13,
            **arguments,
        )

    whole, early = run(), run(use_event_mode=True, early_return_allowed=True)
    at_stop = early[np.abs(early["time"] - RETRACTED) < 1e-12]
    # Before and after the impact.
    assert list(at_stop["upstop.impact_count"]) == [0, 1]
    assert at_stop["crank.speed"][1] == -0.125 * at_stop["crank.speed"][0]
    assert at_stop["upstop.impact_time"][1] == at_stop["time"][1]
    # Rounding decides whether the mechanism bounces once more or rests at the end of a series.
    assert early["upstop.impact_count"][-1] == pytest.approx(whole["upstop.impact_count"][-1], abs=1)
    assert early["upstop.impact_count"][-1] > 5
    assert early["upstop.impact_time"][-1] == pytest.approx(whole["upstop.impact_time"][-1], abs=1e-10)
    assert early["crank.angle"][-1] == pytest.approx(whole["crank.angle"][-1], abs=1e-11)
    # Event mode changes nothing if steps do not return early.
    quiet = run(use_event_mode=True)
    for name in whole.dtype.names:
        assert np.array_equal(whole[name], quiet[name]), name


def test_the_callback_reads_values_within_a_step_and_ends_it(folder: Path) -> None:
    unpacked = extract(str(folder / f"{NAME}.fmi3.fmu"))
    description = read_model_description(unpacked)
    assert description.coSimulation.providesIntermediateUpdate
    assert description.coSimulation.canReturnEarlyAfterIntermediateUpdate
    references = {v.name: v.valueReference for v in description.modelVariables}
    angle = references["crank.angle"]
    instance = FMU3Slave(
        guid=description.instantiationToken,
        unzipDirectory=unpacked,
        modelIdentifier=NAME,
        instanceName="gear",
    )
    updates: list[tuple[float, float]] = []

    flags: set[tuple] = set()

    # Exceptions in the callback would be lost, so it only records values.
    def update(_environment: object, time: float, *arguments: object) -> None:
        *step_flags, requested, stop = arguments
        flags.add(tuple(step_flags))
        updates.append((time, instance.getFloat64([angle])[0]))
        if len(updates) == 3:
            requested[0], stop[0] = True, 0.09

    instance.instantiate(
        earlyReturnAllowed=True,
        intermediateUpdate=update,
        requiredIntermediateVariables=[angle],
    )
    instance.enterInitializationMode(tolerance=1e-12, startTime=0.0)
    instance.exitInitializationMode()
    assert instance.doStep(0.0, 0.13) == (False, False, True, 0.09)
    assert len(updates) >= 3
    # Set requested, get allowed, step finished, can return early.
    assert flags == {(False, True, True, True)}
    assert all(0.0 < time < 0.09 for time, _ in updates)
    (at_end,) = instance.getFloat64([angle])
    assert all(at_end < value < 0.8 for _, value in updates)
    updates += [(0.0, 0.0)] * 3
    assert instance.doStep(0.09, 0.04) == (False, False, False, 0.13)
    assert instance.getFloat64([angle])[0] == pytest.approx(-1.2377117266891367, abs=1e-10)
    instance.terminate()
    instance.freeInstance()
    shutil.rmtree(unpacked, ignore_errors=True)
