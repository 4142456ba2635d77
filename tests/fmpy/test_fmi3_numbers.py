"""Numbers of FMI 3.0 through FMPy: accuracy, derivatives, internal steps, tunable parameters, Enumerations."""

from __future__ import annotations

import re
import shutil
import zipfile
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from conftest import FMU_FOLDER, NAME
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi3 import FMU3Slave
from test_accuracy import GLOBAL_OVER_LOCAL, REFERENCE, ROUND_OFF, STEP

FMU = FMU_FOLDER / f"{NAME}.fmi3.fmu"
ROUNDING = 1e-12
"""Error of derivatives, relative to the sum of the magnitudes of their terms: a reaction is a difference of larger
forces."""

NAME_OF = "friction.kinetic_coefficient"
"""A tunable parameter."""

Make = Callable[..., FMU3Slave]


@pytest.fixture
def make() -> Iterator[Make]:
    """Creates instances of FMI 3.0. `variables` contains the variables of the description by name."""
    unpacked = extract(str(FMU))
    description = read_model_description(unpacked)
    made: list[FMU3Slave] = []

    def instance(**arguments: object) -> FMU3Slave:
        new = FMU3Slave(
            guid=description.instantiationToken, unzipDirectory=unpacked, modelIdentifier=NAME, instanceName="gear"
        )
        new.variables = {variable.name: variable for variable in description.modelVariables}
        new.description = description
        new.instantiate(**arguments)
        made.append(new)
        return new

    yield instance
    for one in made:
        one.freeInstance()
    shutil.rmtree(unpacked, ignore_errors=True)


def started(instance: FMU3Slave, tolerance: float) -> FMU3Slave:
    """The instance in step mode, at the start of scene S1."""
    instance.enterInitializationMode(tolerance=tolerance, startTime=0.0)
    instance.exitInitializationMode()
    return instance


@pytest.mark.parametrize(("tolerance", "bound"), [(1e-9, GLOBAL_OVER_LOCAL * 1e-9), (1e-13, ROUND_OFF)])
@pytest.mark.parametrize("time", REFERENCE)
def test_s1_against_the_quadrature(make: Make, time: float, tolerance: float, bound: float) -> None:
    instance = started(make(), tolerance)
    for i in range(round(time / STEP)):
        instance.doStep(i * STEP, STEP)
    (angle,) = instance.getFloat64([instance.variables["crank.angle"].valueReference])
    assert angle == pytest.approx(REFERENCE[time], abs=bound, rel=0.0)


def test_adjoint_and_directional_derivatives_are_one_matrix(make: Make) -> None:
    """u' (J v) = (J' u)' v for random u and v, up to rounding."""
    instance = started(make(), 1e-9)
    instance.doStep(0.0, 0.05)
    outputs = [unknown.variable for unknown in instance.description.outputs]
    unknowns = [
        v for v in outputs if v.type == "Float64" and v.variability == "continuous" and v.name != "energy.drift"
    ]
    inputs = [v for v in instance.variables.values() if v.causality == "input" and v.type == "Float64"]
    rows, columns = ([v.valueReference for v in group] for group in (unknowns, inputs))
    count = sum(int(np.prod(v.shape)) if v.shape else 1 for v in unknowns)
    assert count > 60
    assert len(columns) > 3
    matrix = np.array(
        [instance.getDirectionalDerivative(rows, [column], [1.0], nSensitivity=count) for column in columns]
    ).T
    assert matrix.shape == (count, len(columns))
    assert np.count_nonzero(matrix) > count
    random = np.random.default_rng(1)
    for _ in range(10):
        u, v = random.normal(size=count) / np.maximum(1.0, np.abs(matrix).max(axis=1)), random.normal(size=len(columns))
        forward = np.array(instance.getDirectionalDerivative(rows, columns, v, nSensitivity=count))
        back = np.array(instance.getAdjointDerivative(rows, columns, u, nSensitivity=len(columns)))
        size = np.abs(u) @ np.abs(matrix) @ np.abs(v)
        assert abs(u @ forward - back @ v) <= ROUNDING * size
        assert np.all(np.abs(forward - matrix @ v) <= ROUNDING * (np.abs(matrix) @ np.abs(v)) + 1e-300)


def test_intermediate_updates_report_every_internal_step(make: Make) -> None:
    updates: list[tuple[float, float]] = []
    lines: list[str] = []

    def update(_environment: object, time: float, *_arguments: object) -> None:
        updates.append((time, instance.getFloat64([angle])[0]))

    def log(_environment: object, _status: int, _category: bytes, message: bytes) -> None:
        lines.append(message.decode())

    instance = make(intermediateUpdate=update, loggingOn=True, logMessage=log)
    angle = instance.variables["crank.angle"].valueReference
    started(instance, 1e-12)
    assert instance.doStep(0.0, 0.13) == (False, False, False, 0.13)
    (end,) = instance.getFloat64([angle])
    instance.terminate()
    (cost,) = (line for line in lines if line.startswith("terminated"))
    accepted = int(re.search(r"in (\d+) accepted steps", cost)[1])
    # The last internal step ends with the communication step and need not be reported.
    assert accepted - 1 <= len(updates) <= accepted, cost
    assert accepted > 5
    times = [time for time, _ in updates]
    assert times == sorted(set(times))
    assert times[0] > 0.0
    assert times[-1] <= 0.13
    # Each reported state is a state of the motion: a step of another instance to the same time ends there.
    for time, seen in updates[:: max(1, len(updates) // 5)]:
        other = started(make(), 1e-12)
        other.doStep(0.0, time)
        assert other.getFloat64([angle])[0] == pytest.approx(seen, abs=ROUND_OFF, rel=0.0)
    assert end == pytest.approx(REFERENCE[0.13], abs=ROUND_OFF, rel=0.0)


def test_tunable_parameters_change_between_steps() -> None:
    """A signal of FMPy for a tunable parameter acts from its time on."""
    variables = {v.name: v for v in read_model_description(str(FMU)).modelVariables}
    assert variables["friction.kinetic_coefficient"].variability == "tunable"
    assert variables["crank.mass"].variability == "fixed"

    def run(after: float) -> np.ndarray:
        signals = np.array([(0.0, 0.026), (0.05, after), (0.13, after)], dtype=[("time", float), (NAME_OF, float)])
        return simulate_fmu(
            str(FMU),
            start_values={"friction.enabled": True},
            input=signals,
            output=["crank.angle", "energy.drift"],
            stop_time=0.13,
            output_interval=STEP,
        )

    plain, tuned = run(0.026), run(0.4)
    assert np.array_equal(plain["crank.angle"][:50], tuned["crank.angle"][:50])
    assert abs(plain["crank.angle"][-1] - tuned["crank.angle"][-1]) > 1e-3
    assert np.max(np.abs(tuned["energy.drift"])) < 1e-4


def test_enumerations_have_items(make: Make) -> None:
    instance = make()
    method, mode = (instance.variables[name] for name in ("solver.method", "contact.mode"))
    assert [(item.name, int(item.value)) for item in method.declaredType.items] == [("reduced", 1), ("rigid_fem", 2)]
    assert [item.name for item in mode.declaredType.items] == ["free", "pushed", "resting", "locked", "arrived"]
    assert instance.getInt64([method.valueReference]) == [1]
    instance.setInt64([instance.variables["solver.method"].valueReference], [2])
    assert instance.getInt64([method.valueReference]) == [2]
    instance.setInt64([method.valueReference], [1])
    started(instance, 1e-9)
    seen = []
    for i in range(20):
        seen.append(instance.getInt64([mode.valueReference])[0])
        instance.doStep(i * 0.02, 0.02)
    # At rest on the down stop, in motion, at rest on the up stop.
    assert seen[0] == 3
    assert 1 in seen
    assert seen[-1] == 3


def test_bounds_sizes_and_rates_are_declared() -> None:
    for extension in ("fmu", "fmi3.fmu"):
        description = read_model_description(str(FMU_FOLDER / f"{NAME}.{extension}"))
        variables = {v.name: v for v in description.modelVariables}
        assert variables["crank.speed"].derivative is variables["crank.angle"]
        assert variables["wheel.acceleration_y"].derivative is variables["wheel.velocity_y"]
        assert (float(variables["upstop.restitution"].min), float(variables["upstop.restitution"].max)) == (0.0, 1.0)
        assert float(variables["actuator.force"].nominal) == 30_000.0
        assert float(variables["along_curve.position"].nominal) > 0.0


def test_licences_are_listed_and_packed() -> None:
    for extension in ("fmu", "fmi3.fmu"):
        with zipfile.ZipFile(FMU_FOLDER / f"{NAME}.{extension}") as archive:
            names = archive.namelist()
            description = archive.read("modelDescription.xml").decode()
            notices = archive.read("documentation/licenses/THIRD-PARTY.txt").decode()
            animation = archive.read("documentation/animation.html").decode()
        for name in ("license.txt", "LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt"):
            assert f"documentation/licenses/{name}" in names
        assert 'license="License of the library: MIT OR Apache-2.0' in description
        assert 'copyright="' in description
        assert "nalgebra" in notices
        assert "Leon Sorokin" in notices
        assert "Leon Sorokin" in animation
