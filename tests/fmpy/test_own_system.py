"""A user's own system, anywhere on disk: packed by `cargo fmu package --ssp`, run by FMPy's `simulate_ssp`."""

from __future__ import annotations

import json
import math
import subprocess
import zipfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conftest import program
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd
from lxml import etree

STIFFNESS, MASS, AMPLITUDE, CART = 50.0, 0.5, 0.1, 2.0
"""Stiffness of the spring [N/m], mass on the spring [kg], its start position [m], mass of the cart [kg]."""
STEP = 0.01
"""Communication step [s]."""
NAMESPACES = {
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
}
PARAMETERS = f"""<?xml version="1.0" encoding="UTF-8"?>
<v:ParameterSet xmlns:v="{NAMESPACES["ssv"]}" xmlns:c="{NAMESPACES["ssc"]}" version="1.0" name="oscillator">
  <v:Parameters>
    <v:Parameter name="spring.stiffness"><v:Real value="{STIFFNESS / 175.126835}" unit="lbf/in"/></v:Parameter>
    <v:Parameter name="block.mass"><v:Real value="3"/></v:Parameter>
  </v:Parameters>
  <v:Units><c:Unit name="lbf/in"><c:BaseUnit kg="1" s="-2" factor="175.126835"/></c:Unit></v:Units>
</v:ParameterSet>
"""


def block(name: str, mass: float, more: dict[str, Any], position: float) -> dict[str, Any]:
    """A block on a slide."""
    return {
        "name": name,
        "bodies": {"ground": {}, "block": {"mass": mass}},
        "joints": {"slide": {"type": "prismatic", "first": "ground.origin", "second": "block.origin"}},
        **more,
        "start": {"joint": "slide", "position": position, "speed": 0},
        "guess": {"slide": position},
        "experiment": {"stop_time": 1, "step_size": STEP},
    }


def package(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """`cargo fmu package --ssp` with these arguments, called in this folder."""
    command = [*program("fmu-build"), "package", "--ssp", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, encoding="utf-8", timeout=900.0)


@pytest.fixture(scope="module")
def packed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package of an oscillator that pushes a cart, in a folder with a space and an umlaut in its name."""
    folder = tmp_path_factory.mktemp("own") / "my systems ü"
    folder.mkdir()
    spring = {"springs": {"spring": {"joint": "slide", "stiffness": 1, "free_length": 0}}}
    push = {"actuators": {"push": {"joint": "slide", "force": 0}}}
    system = {
        "name": "Pushed",
        "description": "Oscillator & cart",
        "fmus": {
            "oscillator": {
                "definition": "oscillator.json",
                "parameters": "oscillator values.ssv",
                "values": {"block.mass": f"{1000 * MASS} g"},
            },
            "cart": "cart.json",
        },
        "connections": [["oscillator.spring.force", "cart.push.force"]],
        "connectors": ["oscillator.slide.position", "cart.slide.speed"],
    }
    for name, content in (
        ("oscillator.json", block("Oscillator", 7.0, spring, AMPLITUDE)),
        ("cart.json", block("Cart", CART, push, 0.0)),
        ("own system.json", system),
    ):
        (folder / name).write_text(json.dumps(content, ensure_ascii=False), encoding="utf-8")
    (folder / "oscillator values.ssv").write_text(PARAMETERS, encoding="utf-8")
    small = ["--no-animation", "--no-results", "--fmi", "2"]
    done = package(folder.parent, f"{folder.name}/own system.json", "--out", f"{folder.name}/out", *small)
    assert done.returncode == 0, done.stderr
    assert ": warning: " not in done.stdout, done.stdout
    path = folder / "out" / "Pushed.ssp"
    assert str(Path(folder.name) / "out" / "Pushed.ssp") in done.stdout
    return path


def values(packed: Path) -> list[SimpleNamespace]:
    """Values in the package, by the name of the FMU and the variable. `simulate_ssp` does not read them itself."""
    with zipfile.ZipFile(packed) as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
    found = []
    for component in root.iterfind(".//{*}Component"):
        for parameter in component.iterfind(".//ssv:Parameter", NAMESPACES):
            name = f"{component.get('name')}.{parameter.get('name')}"
            found.append(
                SimpleNamespace(name=name, value=float(parameter[0].get("value")), unit=parameter[0].get("unit"))
            )
    return found


def test_the_package_follows_the_schema_of_ssp(packed: Path) -> None:
    system = read_ssd(str(packed), validate=True).system
    assert [(element.name, element.source) for element in system.elements] == [
        ("oscillator", "resources/Oscillator.fmu"),
        ("cart", "resources/Cart.fmu"),
    ]


def test_values_are_in_the_units_of_the_variables(packed: Path) -> None:
    found = {value.name: (value.value, value.unit) for value in values(packed)}
    assert found == {
        "oscillator.block.mass": (MASS, "kg"),
        "oscillator.spring.stiffness": (pytest.approx(STIFFNESS, rel=1e-14), "N/m"),
    }


def test_fmpy_runs_the_package_as_in_closed_form(packed: Path) -> None:
    """The oscillator moves as x = a cos(omega t). The cart has a constant force in each step, so that its speed is the
    sum of the impulses. `simulate_ssp` sets the force to 0 in the first step, and later to the output of the step
    before."""
    parameters = SimpleNamespace(parameters=values(packed))
    rows = simulate_ssp(str(packed), stop_time=1.0 - 0.5 * STEP, step_size=STEP, parameter_set=parameters)
    assert len(rows) == 100
    end = STEP * np.arange(1, len(rows) + 1)
    position = AMPLITUDE * np.cos(math.sqrt(STIFFNESS / MASS) * end)
    np.testing.assert_allclose(rows["oscillator.slide.position"], position, rtol=0.0, atol=1e-7 * AMPLITUDE)
    force = rows["cart.push.force"]
    np.testing.assert_array_equal(force, rows["oscillator.spring.force"])
    np.testing.assert_allclose(np.abs(force), STIFFNESS * np.abs(position), rtol=0.0, atol=1e-6 * STIFFNESS * AMPLITUDE)
    speed = STEP / CART * np.concatenate([[0.0], np.cumsum(force)[:-1]])
    assert np.max(np.abs(speed)) > 0.1
    np.testing.assert_allclose(rows["cart.slide.speed"], speed, rtol=0.0, atol=1e-12)


def test_a_wrong_system_is_rejected_before_anything_is_written(packed: Path, tmp_path: Path) -> None:
    system = {
        "name": "Wrong",
        "fmus": {"oscillator": str(packed.parent.parent / "oscillator.json")},
        "connectors": ["oscillator.slide.speeed"],
    }
    (tmp_path / "wrong.json").write_text(json.dumps(system, indent=2), encoding="utf-8")
    done = package(tmp_path, "wrong.json", "--out", "out")
    assert done.returncode == 1
    message = 'wrong.json: connectors[0]: oscillator: there is no variable "slide.speeed": the most similar names are'
    assert message in done.stderr
    assert "slide.speed" in done.stderr
    assert "(line 7, column 5)" in done.stderr
    assert not (tmp_path / "out").exists()
