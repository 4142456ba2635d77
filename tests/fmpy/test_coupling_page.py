"""The loop of docs/how-to/couple-two-fmus.md that couples gear and hydraulic actuator, run as it is printed there."""

from __future__ import annotations

import re
from typing import Any

import pytest
from conftest import FMU_FOLDER, REPOSITORY

LONGEST = 40
"""Largest number of lines of the loop."""
RETRACTION_TIME = 4.065842490726519
"""Time at which the gear is up [s], by an independent integration of gear and hydraulics as a single system."""
ANGLES = {100: 0.769550975553854, 1000: 0.253250298772210, 2000: -0.242429680769236, 3000: -0.759970553164200}
"""Angle of the crank [rad] by time in milliseconds, from the same integration."""


def loop() -> str:
    """The code, with the path of the folder of the packed FMUs."""
    page = (REPOSITORY / "docs" / "how-to" / "couple-two-fmus.md").read_text(encoding="utf-8")
    code = re.search(r"```python\n(.*?)```", page, re.DOTALL)
    assert code
    assert "target/fmu/" in code[1]
    return code[1].replace("target/fmu", FMU_FOLDER.as_posix())


def run(code: str) -> dict[str, Any]:
    """Run the code and return its variables."""
    left: dict[str, Any] = {}
    exec(compile(code, "couple-two-fmus.md", "exec"), left)
    for slave in (left["gear"], left["oil"]):
        slave.terminate()
        slave.freeInstance()
    return left


def test_the_loop_is_short() -> None:
    assert len(loop().splitlines()) <= LONGEST


def test_the_loop_retracts_the_gear(capsys: pytest.CaptureFixture[str]) -> None:
    left = run(loop())
    for step, angle in ANGLES.items():
        assert left["angles"][step] == pytest.approx(angle, abs=1e-5), step
    assert left["time_up"] == pytest.approx(RETRACTION_TIME, abs=1e-5)
    printed = re.fullmatch(r"gear up after (\S+) s\n", capsys.readouterr().out)
    assert printed
    assert float(printed[1]) == pytest.approx(RETRACTION_TIME, abs=1e-5)


def test_a_step_of_20_ms_has_the_accuracy_stated_on_the_page() -> None:
    code = loop()
    assert "STEP, UP = 1e-3," in code
    left = run(code.replace("STEP, UP = 1e-3,", "STEP, UP = 20e-3,"))
    for step, angle in ANGLES.items():
        assert left["angles"][step // 20] == pytest.approx(angle, abs=3e-3), step
    assert left["time_up"] == pytest.approx(RETRACTION_TIME, abs=2e-3)
