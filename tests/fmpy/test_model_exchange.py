"""Model exchange of FMI 2.0 and FMI 3.0 by FMPy's CVode against co-simulation by the FMU's own integration.

As a program, `python tests/fmpy/test_model_exchange.py <folder of FMUs>` prints `validation/results/model_exchange.md`.
"""

from __future__ import annotations

import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest
from conftest import FMU_FOLDER, NAME
from fmpy import read_model_description, simulate_fmu

SCENES: dict[str, tuple[float, dict[str, float | bool | str]]] = {
    "retraction": (0.13, {}),
    "rest at the up stop": (0.2, {}),
    "rebounds from the up stop": (0.25, {"upstop.restitution": 0.5}),
    "bumper": (0.16, {"upstop.stiffness": 1e5, "upstop.damping": 100.0}),
    "friction": (0.13, {"friction.enabled": True}),
    "caught by the lock": (0.2, {"uplock.engage": True, "upstop.restitution": 0.5}),
}
"""Stop time [s] and start values that differ from those of the file, by scene."""

EXTENSIONS = {"2.0": "fmu", "3.0": "fmi3.fmu"}
"""File extension of the packed FMUs, by version of FMI."""

OUTPUTS = ["crank.angle", "crank.speed", "wheel.x"]
TOLERANCES = [1e-6, 1e-9]
"""Relative tolerances of CVode. Its local errors add up over some hundred steps."""
BOUND = 100.0
"""Largest allowed difference, in tolerances. A difference of 1e-6 of the largest value is always allowed."""


def largest_differences(fmu: Path, scene: str, tolerance: float) -> dict[str, float]:
    """Largest difference of each output at common points, relative to its largest value."""
    stop, values = SCENES[scene]
    common = {"output": OUTPUTS, "start_values": values, "stop_time": stop, "output_interval": 1e-3}
    own = simulate_fmu(str(fmu), fmi_type="CoSimulation", relative_tolerance=1e-11, **common)
    theirs = simulate_fmu(str(fmu), fmi_type="ModelExchange", solver="CVode", relative_tolerance=tolerance, **common)
    assert theirs["time"][-1] == pytest.approx(stop)
    # Events add rows. Of several rows with one time the last one counts.
    at = np.searchsorted(theirs["time"], own["time"] + 1e-9) - 1
    assert np.allclose(theirs["time"][at], own["time"], atol=1e-9)
    return {n: float(np.max(np.abs(theirs[n][at] - own[n])) / np.max(np.abs(own[n]))) for n in OUTPUTS}


@pytest.fixture(params=EXTENSIONS)
def either(request: pytest.FixtureRequest) -> Path:
    """The packed FMU of each version."""
    return FMU_FOLDER / f"{NAME}.{EXTENSIONS[request.param]}"


def test_model_exchange_is_declared(either: Path) -> None:
    description = read_model_description(str(either))
    assert description.modelExchange.modelIdentifier == NAME
    names = [unknown.variable.name for unknown in description.derivatives]
    assert names == ["along_curve.speed", "along_curve.acceleration"]
    assert description.numberOfContinuousStates == 2
    assert description.numberOfEventIndicators > 0


@pytest.mark.parametrize("scene", SCENES)
def test_a_solver_of_the_host_gives_the_motion_of_co_simulation(either: Path, scene: str) -> None:
    for tolerance in TOLERANCES:
        differences = largest_differences(either, scene, tolerance)
        assert all(difference < max(BOUND * tolerance, 1e-6) for difference in differences.values()), differences


@pytest.mark.parametrize("solver", ["CVode", "Euler"])
@pytest.mark.parametrize("extension", EXTENSIONS.values())
def test_a_prescribed_motion_does_not_depend_on_the_solver(extension: str, solver: str) -> None:
    """All outputs but `energy.drift` at the points of co-simulation, over the end of the profile at 1 s."""
    fmu = str(FMU_FOLDER / f"SmoothRetraction.{extension}")
    names = [v.name for v in read_model_description(fmu).modelVariables if v.causality == "output" and not v.dimensions]
    names = [name for name in names if name != "energy.drift"]
    common = {"output": names, "stop_time": 1.1, "output_interval": 0.01}
    own = simulate_fmu(fmu, fmi_type="CoSimulation", **common)
    theirs = simulate_fmu(fmu, fmi_type="ModelExchange", solver=solver, step_size=0.01, **common)
    at = np.searchsorted(theirs["time"], own["time"] + 1e-9) - 1
    assert np.allclose(theirs["time"][at], own["time"], atol=1e-9)
    assert own["crank.angle"][-1] == pytest.approx(-1.3)
    for name in names:
        scale = np.max(np.abs(own[name]))
        assert np.max(np.abs(theirs[name][at].astype(float) - own[name])) <= 1e-11 * scale, name


def main(folder: Path) -> None:
    """Print the table."""
    print("# Model exchange by CVode against co-simulation")
    print()
    print(f"Landing gear as packed by `cargo fmu package`, in FMPy {fmpy.__version__}: its CVode at two relative")
    print("tolerances against co-simulation at 1e-11, largest difference at points of 1 ms, relative to its largest")
    print("value. Made by")
    print("`python tests/fmpy/test_model_exchange.py target/fmu`.")
    print()
    print("| scene | FMI | tolerance | " + " | ".join(f"`{name}`" for name in OUTPUTS) + " |")
    print("|---|---|---|" + "---|" * len(OUTPUTS))
    for scene in SCENES:
        for version, extension in EXTENSIONS.items():
            for tolerance in TOLERANCES:
                differences = largest_differences(folder / f"{NAME}.{extension}", scene, tolerance)
                row = " | ".join(f"{differences[name]:.1e}" for name in OUTPUTS)
                print(f"| {scene} | {version} | {tolerance:.0e} | {row} |")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
