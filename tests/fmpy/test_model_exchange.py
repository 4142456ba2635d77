"""Model exchange by FMPy's CVode against co-simulation by the FMU's own integration."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import NAME
from fmpy import simulate_fmu

SCENES: dict[str, tuple[float, dict[str, float | bool | str]]] = {
    "retraction": (0.13, {}),
    "rest at the up stop": (0.2, {}),
    "rebounds from the up stop": (0.25, {"upstop.restitution": 0.5}),
    "bumper": (0.16, {"upstop.stiffness": 1e5, "upstop.damping": 100.0}),
    "friction": (0.13, {"friction.enabled": True}),
    "caught by the lock": (0.2, {"uplock.engage": True, "upstop.restitution": 0.5}),
}
"""Stop time [s] and start values that differ from those of the file, by what happens."""

OUTPUTS = ["crank.angle", "crank.speed", "actuator.force"]


def largest_differences(fmu: Path, scene: str, tolerance: float) -> dict[str, float]:
    """Largest difference of each output at common points, relative to its largest value, away from impacts."""
    stop, values = SCENES[scene]
    common = {"output": OUTPUTS, "start_values": values, "stop_time": stop, "output_interval": 1e-3}
    own = simulate_fmu(str(fmu), fmi_type="CoSimulation", relative_tolerance=1e-11, **common)
    theirs = simulate_fmu(
        str(fmu), fmi_type="ModelExchange", solver="CVode", relative_tolerance=tolerance, **common
    )
    assert theirs["time"][-1] == pytest.approx(stop)
    # Events add rows: of equal times the last one counts.
    at = np.searchsorted(theirs["time"], own["time"] + 1e-9) - 1
    assert np.allclose(theirs["time"][at], own["time"], atol=1e-9)
    return {n: float(np.max(np.abs(theirs[n][at] - own[n]) / np.max(np.abs(own[n])))) for n in OUTPUTS}


@pytest.mark.parametrize("scene", SCENES)
def test_a_solver_of_the_host_gives_the_motion_of_co_simulation(fmu: Path, scene: str) -> None:
    assert NAME in fmu.name
    differences = largest_differences(fmu, scene, 1e-9)
    # CVode's local error per step accumulates over some hundred steps.
    assert all(difference < 1e-5 for difference in differences.values()), differences
