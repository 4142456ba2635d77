"""The scene file for OpenModelica's viewers, drawn by its rules with values that FMPy reads, and its page."""

from __future__ import annotations

import re
import sys
import types
import zipfile
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from conftest import FMU_FOLDER, FMUS, REPOSITORY
from fmpy import read_csv, read_model_description, simulate_fmu
from lxml import etree

DRAWN = [fmu for fmu in FMUS if "resources/mechanism.json" in zipfile.ZipFile(fmu).namelist()]
SOLIDS = {"box", "cylinder", "sphere"}
#: Entries of a shape in their order, with the number of values that a viewer reads from each entry.
ENTRIES = {
    "ident": 0,
    "type": 0,
    "T": 9,
    "r": 3,
    "r_shape": 3,
    "lengthDir": 3,
    "widthDir": 3,
    "length": 1,
    "width": 1,
    "height": 1,
    "extra": 1,
    "color": 3,
    "specCoeff": 1,
}
#: Error of a drawn position against its closed form [m]: that of the tables.
CLOSED_FORM = 1e-12
#: Rounding of sums of a few products.
ROUNDING = 4e-16

Array = np.ndarray


@dataclass
class Placed:
    """A shape in the mechanism frame: start point, unit vector along the shape, length."""

    begin: Array
    along: Array
    length: float

    @property
    def end(self) -> Array:
        return self.begin + self.length * self.along


class Scene:
    """A scene file, read as OMEdit reads it: the values of an entry are its elements in their order."""

    def __init__(self, fmu: Path) -> None:
        with zipfile.ZipFile(fmu) as archive:
            self.root = etree.fromstring(archive.read(f"resources/{fmu.stem}_visual.xml"))
        self.shapes = {shape.findtext("ident"): shape for shape in self.root}

    def names(self) -> set[str]:
        return {element.text for element in self.root.iter("cref")}

    def place(self, ident: str, values: dict[str, float]) -> Placed:
        """The rules of OMEdit's `rotateModelica2OSG`: vectors are rows, multiplied from the left of T."""

        def entry(name: str) -> Array:
            elements = self.shapes[ident].find(name)
            return np.array([values[e.text] if e.tag == "cref" else float(e.text) for e in elements])

        rotation = entry("T").reshape(3, 3)
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), rtol=0.0, atol=ROUNDING)
        assert np.linalg.det(rotation) > 0.0
        direction = entry("lengthDir")
        along = direction / np.linalg.norm(direction) @ rotation
        return Placed(entry("r_shape") @ rotation + entry("r"), along, entry("length")[0])


def run(fmu: Path, names: set[str]) -> list[dict[str, float]]:
    """Values of these variables in each row of the default run."""
    result = simulate_fmu(str(fmu), output=sorted(names))
    return [dict(zip(result.dtype.names, map(float, row), strict=True)) for row in result]


@pytest.mark.parametrize("fmu", DRAWN, ids=[fmu.stem for fmu in DRAWN])
def test_a_scene_is_whole_and_names_variables_of_its_fmu(fmu: Path) -> None:
    scene = Scene(fmu)
    assert scene.root.tag == "visualization"
    assert len(scene.shapes) == len(scene.root) > 1, "each name once"
    for ident, shape in scene.shapes.items():
        assert shape.tag == "shape"
        assert {child.tag: len(child) for child in shape} == ENTRIES, ident
        assert [child.tag for child in shape] == list(ENTRIES), ident
        assert shape.findtext("type") in SOLIDS, ident
        for element in (element for child in shape for element in child):
            assert element.tag in {"exp", "cref"}, ident
            assert element.text == element.text.strip(), ident
            assert element.tag == "cref" or np.isfinite(float(element.text)), ident
    variables = {variable.name: variable for variable in read_model_description(str(fmu)).modelVariables}
    assert {variables[name].type for name in scene.names()} == {"Real"}
    assert {variables[name].causality for name in scene.names()} <= {"local", "output"}
    moving = {name.rsplit(".frame.")[0] for name in variables if ".frame." in name}
    assert {name.split(".frame.")[0] for name in scene.names() if ".frame." in name} <= moving


def test_an_actuator_alone_has_no_scene() -> None:
    with zipfile.ZipFile(FMU_FOLDER / "HydraulicActuator.fmu") as archive:
        assert not [name for name in archive.namelist() if name.endswith("_visual.xml")]


@pytest.mark.parametrize("fmu", DRAWN, ids=[fmu.stem for fmu in DRAWN])
def test_frames_are_rotations_by_the_angles_of_the_bodies(fmu: Path) -> None:
    variables = {variable.name for variable in read_model_description(str(fmu)).modelVariables}
    bodies = sorted({name.removesuffix(".frame.cos") for name in variables if name.endswith(".frame.cos")})
    turning = [body for body in bodies if f"{body}.angle" in variables]
    parts = ("x", "y", "cos", "sin", "minus_sin")
    names = {f"{body}.frame.{part}" for body in bodies for part in parts} | {f"{body}.angle" for body in turning}
    assert bodies
    assert names <= variables
    result = simulate_fmu(str(fmu), output=sorted(names))
    for body in bodies:
        cos, sin, minus = (result[f"{body}.frame.{part}"] for part in ("cos", "sin", "minus_sin"))
        np.testing.assert_allclose(cos**2 + sin**2, 1.0, rtol=0.0, atol=ROUNDING)
        np.testing.assert_array_equal(minus, -sin)
        if body in turning:
            np.testing.assert_allclose(cos, np.cos(result[f"{body}.angle"]), rtol=0.0, atol=ROUNDING)
            np.testing.assert_allclose(sin, np.sin(result[f"{body}.angle"]), rtol=0.0, atol=ROUNDING)


def test_a_slider_crank_is_drawn_at_its_closed_form() -> None:
    """The crank of 0.05 m turns about the origin. The rod of 0.2 m connects its end with a point of the y axis."""
    fmu = FMU_FOLDER / "SliderCrank.fmu"
    scene, (crank, rod) = Scene(fmu), (0.05, 0.2)
    rows = run(fmu, scene.names() | {"crank.angle"})
    angles = [row["crank.angle"] for row in rows]
    assert max(angles) - min(angles) > 2.0 * np.pi, "all positions"
    for row in rows[::10]:
        pin = crank * np.array([np.cos(row["crank.angle"]), np.sin(row["crank.angle"]), 0.0])
        piston = np.array([0.0, pin[1] + np.sqrt(rod**2 - pin[0] ** 2), 0.0])
        for ident, ends in (("body.crank", [np.zeros(3), pin]), ("body.rod", [pin, piston])):
            link = scene.place(ident, row)
            np.testing.assert_allclose([link.begin, link.end], ends, rtol=0.0, atol=CLOSED_FORM, err_msg=ident)
        block, guide = scene.place("joint.cylinder", row), scene.place("guide.cylinder", row)
        np.testing.assert_allclose(0.5 * (block.begin + block.end), piston, rtol=0.0, atol=CLOSED_FORM)
        np.testing.assert_allclose([block.along, guide.along], [[0.0, 1.0, 0.0]] * 2, rtol=0.0, atol=CLOSED_FORM)
        assert guide.begin[1] < 0.0 < piston[1] < guide.end[1]
        for ident, center in (("bearing", np.zeros(3)), ("crankpin", pin), ("wristpin", piston)):
            axle = scene.place(f"joint.{ident}", row)
            np.testing.assert_allclose(0.5 * (axle.begin + axle.end), center, rtol=0.0, atol=CLOSED_FORM, err_msg=ident)
            np.testing.assert_array_equal(axle.along, [0.0, 0.0, 1.0])


def test_the_pins_of_the_gear_are_drawn_at_their_closed_form(fmu: Path) -> None:
    """The crank of 0.1755 m turns about the origin, the follower of 0.34 m about a point at the distance 0.5729 m."""
    scene = Scene(fmu)
    for row in run(fmu, scene.names() | {"crank.angle", "follower.angle"})[::20]:
        crank, follower = ([np.cos(a), np.sin(a), 0.0] for a in (row["crank.angle"], row["follower.angle"]))
        second = np.array([0.5729, 0.0, 0.0])
        ends = (np.zeros(3), 0.1755 * np.array(crank), second + 0.34 * np.array(follower), second)
        for number, expected in enumerate(ends, start=1):
            pin = scene.place(f"joint.joint{number}", row)
            np.testing.assert_allclose(0.5 * (pin.begin + pin.end), expected, rtol=0.0, atol=CLOSED_FORM)


def blocks() -> list[str]:
    """The examples for a notebook and for OpenModelica, with the path of the folder of the packed FMUs."""
    pages = [REPOSITORY / "docs" / page for page in ("viewers.md", "how-to/openmodelica.md")]
    texts = [page.read_text(encoding="utf-8") for page in pages]
    found = [code for text in texts for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL)]
    assert len(found) == 2
    return [code.replace("target/fmu", FMU_FOLDER.as_posix()) for code in found]


class Frames(HTMLParser):
    """The attributes of each iframe."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[dict[str, str | None]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag == "iframe"
        self.found.append(dict(attrs))


def test_the_cell_shows_the_page_of_the_fmu(monkeypatch: pytest.MonkeyPatch) -> None:
    """A notebook shows the last expression of a cell. IPython's HTML holds the text in `data`."""
    display = types.ModuleType("IPython.display")
    display.HTML = type("HTML", (), {"__init__": lambda self, data: setattr(self, "data", data)})
    monkeypatch.setitem(sys.modules, "IPython", types.ModuleType("IPython"))
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    *before, last = blocks()[0].rstrip().split("\n")
    left: dict[str, object] = {}
    exec(compile("\n".join([*before, f"shown = {last}"]), "docs/viewers.md", "exec"), left)
    parser = Frames()
    parser.feed(left["shown"].data)
    parser.close()
    (frame,) = parser.found
    with zipfile.ZipFile(FMU_FOLDER / "SliderCrank.fmu") as archive:
        page = archive.read("documentation/animation.html").decode()
    assert frame["srcdoc"] == page
    assert page.startswith("<!doctype html>") or page.startswith("<!DOCTYPE html>")
    assert page.rstrip().endswith("</html>")


def test_the_result_file_has_all_that_the_scene_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(blocks()[1], "docs/how-to/openmodelica.md", "exec"), {})
    result = read_csv(tmp_path / "SliderCrank_res.csv")
    root = etree.fromstring((tmp_path / "SliderCrank_visual.xml").read_bytes())
    assert {element.text for element in root.iter("cref")} <= set(result.dtype.names)
    assert len(result) > 100
    assert result.dtype.names[0] == "time"
