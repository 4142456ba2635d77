"""A user's mechanism in any folder: written, packed by `cargo fmu package`, simulated."""

from __future__ import annotations

import json
import math
import os
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import REPOSITORY, Instance, program
from fmpy import extract, simulate_fmu
from fmpy.validation import validate_fmu

CRANK = 0.1
"""Length of the crank [m]."""
ROD = 0.3
"""Length of the connecting rod [m]."""
SPEED = 20.0
"""Angular speed of the crank at the start [rad/s]."""
ROUNDING = 1e-12
"""Distance [m] of positions from the closed form. The errors of the tables are about 1e-13 of the mechanism's size."""


def mechanism() -> dict[str, Any]:
    """A slider-crank mechanism without loads."""
    revolute = {"type": "revolute"}
    return {
        "$schema": "../wherever it was/mechanism.schema.json",
        "name": "SliderCrank",
        "description": "Schubkurbel, größer",
        "bodies": {
            "ground": {},
            "crank": {"length": CRANK, "mass": 1.2, "shape": "uniform_rod"},
            "rod": {"length": ROD, "mass": 0.9, "shape": "uniform_rod"},
            "slider": {"mass": 0.5},
        },
        "joints": {
            "bearing": {**revolute, "first": "ground.origin", "second": "crank.origin"},
            "pin": {**revolute, "first": "crank.end", "second": "rod.origin"},
            "wrist": {**revolute, "first": "rod.end", "second": "slider.origin"},
            "guide": {"type": "prismatic", "first": "ground.origin", "second": "slider.origin"},
        },
        "torques": {"motor": {"on": "crank"}},
        "markers": {"piston": {"at": "slider.origin"}},
        "start": {"body": "crank", "angle": 0.5, "speed": SPEED},
        "guess": {"crank": 0.5, "rod": -0.16, "guide": 0.38},
        "experiment": {"stop_time": 0.5, "step_size": 0.005},
    }


def package(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """`cargo fmu package` with these arguments, called in this folder."""
    command = [*program("fmu-build"), "package", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, encoding="utf-8", timeout=900.0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a space and an umlaut in its name."""
    folder = tmp_path_factory.mktemp("own") / "my mechanisms ü"
    folder.mkdir()
    return folder


@pytest.fixture(scope="module")
def packed(folder: Path) -> Path:
    """The packed slider-crank mechanism, named by a path relative to the folder above it."""
    (folder / "slider crank.json").write_text(json.dumps(mechanism(), ensure_ascii=False), encoding="utf-8")
    done = package(folder.parent, f"{folder.name}/slider crank.json", "--out", f"{folder.name}/out")
    assert done.returncode == 0, done.stderr
    fmu = folder / "out" / "SliderCrank.fmu"
    assert str(Path(folder.name) / "out" / "SliderCrank.fmu") in done.stdout
    return fmu


def test_is_valid(packed: Path) -> None:
    assert validate_fmu(str(packed)) == []


def test_the_schema_is_in_the_folder_of_the_mechanism(packed: Path) -> None:
    with zipfile.ZipFile(packed) as fmu:
        inside = json.loads(fmu.read("resources/mechanism.json"))
        schema = json.loads(fmu.read(f"resources/{inside['$schema']}"))
    assert inside == {**mechanism(), "$schema": "mechanism.schema.json"}
    assert set(inside) <= set(schema["properties"])


def test_slider_follows_the_crank(packed: Path) -> None:
    """Closed form: x = r cos(theta) + sqrt(l^2 - r^2 sin(theta)^2)."""
    names = ["crank.angle", "crank.speed", "guide.position", "guide.speed", "piston.x", "piston.y", "energy.drift"]
    result = simulate_fmu(str(packed), output=[*names, "energy.kinetic"])
    assert result["time"][-1] == pytest.approx(0.5, rel=1e-12)
    angle, speed = result["crank.angle"], result["crank.speed"]
    assert angle[-1] > 0.5 + math.tau
    sine = CRANK * np.sin(angle)
    reach = np.sqrt(ROD**2 - sine**2)
    position = CRANK * np.cos(angle) + reach
    np.testing.assert_allclose(result["guide.position"], position, rtol=0.0, atol=ROUNDING)
    np.testing.assert_allclose(result["piston.x"], position, rtol=0.0, atol=ROUNDING)
    np.testing.assert_allclose(result["piston.y"], 0.0, rtol=0.0, atol=ROUNDING)
    # The derivative of the closed form. The rounding of a speed is that of a position times the crank's speed.
    along = -sine * (1.0 + CRANK * np.cos(angle) / reach)
    np.testing.assert_allclose(result["guide.speed"], along * speed, rtol=0.0, atol=10.0 * ROUNDING * SPEED)
    kinetic = result["energy.kinetic"][0]
    np.testing.assert_allclose(result["energy.kinetic"], kinetic, rtol=1e-9)
    assert np.max(np.abs(result["energy.drift"])) <= 1e-9 * kinetic


def test_two_mechanisms_run_in_one_process(packed: Path, extracted: Path, tmp_path: Path) -> None:
    """One library under two names in one process: each instance has its own mechanism."""
    folders = [extracted, Path(extract(packed, str(tmp_path / "own")))]

    def run(folders: list[Path]) -> list[dict[str, float | int]]:
        instances = [Instance(folder).start() for folder in folders]
        for i in range(20):
            for instance in instances:
                instance.run(i, i + 1, 1e-3)
        outputs = [instance.outputs() for instance in instances]
        for instance in instances:
            instance.slave.freeInstance()
        return outputs

    gear, own = run(folders)
    assert "guide.position" in own
    assert "guide.position" not in gear
    assert [gear] == run(folders[:1])
    assert [own] == run(folders[1:])


def refused(done: subprocess.CompletedProcess[str]) -> str:
    """The one line of an error message. Cargo's own lines are indented."""
    assert done.returncode == 1, done.stdout + done.stderr
    lines = [line for line in done.stderr.splitlines() if not line.startswith(" ")]
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith("error: ")
    return lines[0]


BAD_FILES: dict[str, tuple[str, list[str]]] = {
    "not JSON": ('{ "name": ', ["bad.json:1:"]),
    "name with a space": (json.dumps({**mechanism(), "name": "Slider Crank"}), ['name = "Slider Crank"', "letter"]),
    "name with a digit first": (json.dumps({**mechanism(), "name": "4bar"}), ['name = "4bar"', "letter"]),
    "misspelt key": (json.dumps({**mechanism(), "marker": {}}), ["marker", "`markers`"]),
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_bad_file_is_rejected_with_its_faults(tmp_path: Path, name: str) -> None:
    text, fragments = BAD_FILES[name]
    (tmp_path / "bad.json").write_text(text, encoding="utf-8")
    done = package(tmp_path, "bad.json", "--out", "out")
    assert "nothing was packed: bad.json" in refused(done)
    for fragment in fragments:
        assert fragment in done.stdout
    assert not (tmp_path / "out").exists()


def test_bad_path_is_rejected_in_one_line(tmp_path: Path) -> None:
    assert "no such file or folder" in refused(package(tmp_path, "nowhere.json"))
    assert "/dev/null: this is not a regular file" in refused(package(tmp_path, "/dev/null"))
    assert "contains no mechanism.json or hydraulics.json" in refused(package(tmp_path, "."))
    (tmp_path / "own.json").write_text(json.dumps(mechanism()), encoding="utf-8")
    (tmp_path / "taken").write_text("a file", encoding="utf-8")
    line = refused(package(tmp_path, "own.json", "--out", f"taken{os.sep}fmus"))
    assert "taken" in line
    assert "give another folder with --out" in line


def test_bucket_passes_where_friction_locks_it(folder: Path) -> None:
    """A run that records every output continues where a force of the drive has no value."""
    fixture = REPOSITORY / "tests" / "fixtures" / "excavator_bucket.json"
    done = package(folder, str(fixture), "--out", "out")
    assert done.returncode == 0, done.stderr
    start = {"bucket.start_angle": 2.55, "bucket.start_speed": 1.5, "cylinder.force": 2e4, "digging.torque": -100.0}
    result = simulate_fmu(
        str(folder / "out" / "ExcavatorBucket.fmu"), start_values=start, stop_time=0.24, output_interval=4e-3
    )
    locked = result["cylinder.self_locking"].astype(bool)
    assert 2 < np.count_nonzero(locked) < len(locked) - 10
    inverse = ("cylinder.required_force", "cylinder.breakaway_force_forward", "cylinder.breakaway_force_backward")
    defined = np.array([np.isfinite(result[name]) for name in inverse])
    assert np.array_equal(np.all(defined, axis=0), ~locked)
    assert [name for name in result.dtype.names if name not in inverse and not np.all(np.isfinite(result[name]))] == []
    assert result["bucket.angle"][-1] > 2.7


@pytest.mark.parametrize("version", ["2", "3"])
def test_a_mechanism_without_masses_has_only_its_motion(folder: Path, version: str) -> None:
    """The slider-crank mechanism without masses at constant speed of its crank, over more than a turn."""
    own = mechanism()
    own["name"] = "Massless"
    own["bodies"] = {"ground": {}, "crank": {"length": CRANK}, "rod": {"length": ROD}, "slider": {}}
    own["actuators"] = {"servo": {"joint": "bearing", "motion": {"profile": "constant_speed", "speed": SPEED}}}
    own["start"]["speed"] = 0
    del own["torques"]
    (folder / "massless.json").write_text(json.dumps(own), encoding="utf-8")
    done = package(folder, "massless.json", "--fmi", version, "--out", "massless")
    assert done.returncode == 0, done.stderr
    fmu = folder / "massless" / ("Massless.fmu" if version == "2" else "Massless.fmi3.fmu")
    assert validate_fmu(str(fmu)) == []
    names = ["guide.position", "guide.speed", "guide.acceleration"]
    result = simulate_fmu(str(fmu), output=names, output_interval=0.005)
    sine, cosine = np.sin(0.5 + SPEED * result["time"]), np.cos(0.5 + SPEED * result["time"])
    along = np.sqrt(ROD**2 - (CRANK * sine) ** 2)
    first = -(CRANK**2) * sine * cosine / along
    second = (-(CRANK**2) * (cosine**2 - sine**2) - first**2) / along
    position, speed, acceleration = (result[name] for name in names)
    np.testing.assert_allclose(position, CRANK * cosine + along, rtol=0.0, atol=ROUNDING)
    np.testing.assert_allclose(speed, SPEED * (first - CRANK * sine), rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(acceleration, SPEED**2 * (second - CRANK * cosine), rtol=0.0, atol=1e-7)
