"""The documentation in the packed FMUs: it loads without errors, and its drawings agree with the engine."""

from __future__ import annotations

import csv
import itertools
import json
import math
import os
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import FMU_FOLDER, Show, Shown, definition, inaccessible

NAMES = sorted(fmu.stem for fmu in FMU_FOLDER.glob("*.fmu") if not fmu.name.endswith(".fmi3.fmu"))
GEAR = "LandingGearRetraction"

Unpack = Callable[[str], Path]


@pytest.fixture
def unpacked(tmp_path: Path) -> Unpack:
    """Unpacks the FMU of this name."""

    def unpack(name: str) -> Path:
        with zipfile.ZipFile(FMU_FOLDER / f"{name}.fmu") as archive:
            archive.extractall(tmp_path / name)
        return tmp_path / name

    return unpack


def opened(show: Show, folder: Path, scheme: str = "light", width: int = 1200) -> Shown:
    return show(folder / "documentation" / "index.html", ready="footer", scheme=scheme, width=width)


def test_there_are_fmus() -> None:
    assert len(NAMES) >= 8


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_each_page_loads_without_errors_or_requests(name: str, scheme: str, unpacked: Unpack, show: Show) -> None:
    page = opened(show, unpacked(name), scheme=scheme).page
    assert page.title() == name
    drawing = page.locator("figure .wide svg[role=img]")
    assert drawing.count() == 1
    # Screen readers read the name and the description of the drawing.
    named = drawing.get_attribute("aria-labelledby") or ""
    assert all((page.locator(f"#{part}").text_content() or "").strip() for part in named.split())
    assert len(named.split()) == 2
    for table in page.locator("table").all():
        assert table.locator("th[scope=col]").count() >= 2
    for table in page.locator("section:not(.readme) table").all():
        assert table.locator("tbody th[scope=row]").count() == table.locator("tbody tr").count()
    headings = page.evaluate("[...document.querySelectorAll('h1, h2, h3')].map((h) => Number(h.tagName[1]))")
    assert headings[0] == 1
    assert all(b - a <= 1 for a, b in itertools.pairwise(headings))


def test_markup_in_texts_has_no_effect(tmp_path: Path, show: Show) -> None:
    """A description and a README that contain scripts, pictures and closing tags."""
    markup = "</script></svg></style><img src=https://x.y/z onerror=alert(1)> \"'& \u202ereversed {{ 7*7 }}"
    mechanism = definition("FourBar")
    mechanism["description"] = markup
    (tmp_path / "mechanism.json").write_text(json.dumps(mechanism), encoding="utf-8")
    readme = f"# {markup}\n\n{markup}\n\n<script>alert(2)</script>\n\n[link](javascript:alert(3))\n"
    (tmp_path / "README.md").write_text(readme, encoding="utf-8")
    program = os.environ["LINKAGE_VIEW"]
    command = [program, "package", str(tmp_path), "--out", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900, check=False)
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(tmp_path / "out" / "FourBar.fmu") as archive:
        archive.extractall(tmp_path / "unpacked")
    page = opened(show, tmp_path / "unpacked").page
    assert page.locator("script, img, a[href^=javascript]").count() == 0
    assert page.locator("p.lead").inner_text() == markup
    assert page.locator(".readme h3").inner_text().endswith("{{ 7*7 }}")
    # The animation receives its texts as data.
    shown = show(tmp_path / "unpacked" / "documentation" / "animation.html")
    assert shown.data()["description"] == markup


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("width", [1200, 390])
def test_nothing_is_wider_than_the_page(name: str, width: int, unpacked: Unpack, show: Show) -> None:
    page = opened(show, unpacked(name), width=width).page
    assert page.evaluate("document.documentElement.scrollHeight") < 6000
    page.evaluate("document.querySelectorAll('details').forEach((section) => (section.open = true))")
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    boxes = page.evaluate(
        "[...document.querySelectorAll('.scroll, .drawing')].map((box) => [box.scrollWidth, box.clientWidth])"
    )
    assert width > 390 or all(inner <= outer + 1 for inner, outer in boxes)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_letters_stand_out(scheme: str, unpacked: Unpack, show: Show) -> None:
    """Contrast of text and background: at least 4.5 according to WCAG 2.2."""
    page = opened(show, unpacked(GEAR), scheme=scheme).page
    colours = page.evaluate(
        """() => ["--ink", "--muted", "--accent"].flatMap((name) => ["--bg", "--panel", "--soft"].map((ground) => {
          const style = getComputedStyle(document.documentElement);
          return [name, ground, style.getPropertyValue(name).trim(), style.getPropertyValue(ground).trim()];
        }))"""
    )

    def luminance(colour: str) -> float:
        parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    for name, ground, one, other in colours:
        light, dark = sorted([luminance(one), luminance(other)], reverse=True)
        assert (light + 0.05) / (dark + 0.05) >= 4.5, (name, ground, one, other)


def test_drawn_joints_are_where_the_engine_has_them(unpacked: Unpack, show: Show) -> None:
    """Drawn joints against the first row of the reference results and the lengths of the definition."""
    folder = unpacked(GEAR)
    shown = opened(show, folder)
    bodies = json.loads((folder / "resources" / "mechanism.json").read_text(encoding="utf-8"))["bodies"]
    results = folder / "extra" / "org.fmi-standard.fmi-ls-ref" / f"{GEAR}_out.csv"
    with results.open(encoding="utf-8", newline="") as lines:
        start = {name: float(value) for name, value in next(csv.DictReader(lines)).items()}
    crank, follower, base = (bodies[body]["length"] for body in ("crank", "follower", "ground"))
    (x1, y1), (x4, y4) = (shown.center(f"[data-joint=joint{k}]") for k in (1, 4))
    scale = (x4 - x1) / base
    assert scale > 200
    assert abs(y4 - y1) < 0.1
    angles = {body: start[f"{body}.angle"] for body in ("crank", "follower")}
    turn = {body: (math.cos(angle), math.sin(angle)) for body, angle in angles.items()}
    expected = {
        "[data-joint=joint2]": (crank * turn["crank"][0], crank * turn["crank"][1]),
        "[data-joint=joint3]": (base + follower * turn["follower"][0], follower * turn["follower"][1]),
        "[data-marker=wheel]": (start["wheel.x"], start["wheel.y"]),
    }
    for selector, (x, y) in expected.items():
        assert math.dist(shown.center(selector), (x1 + scale * x, y1 - scale * y)) < 0.5, selector


def test_names_in_the_drawing_stand_apart(unpacked: Unpack, show: Show) -> None:
    for name in (GEAR, "FourBar", "CraneJib"):
        page = opened(show, unpacked(name)).page
        boxes = [text.bounding_box() for text in page.locator("figure .wide svg text").all()]
        frame = page.locator("figure .wide svg").bounding_box()
        assert frame is not None
        found = [box for box in boxes if box is not None]
        assert len(found) > 8
        for k, a in enumerate(found):
            assert frame["x"] <= a["x"], name
            assert a["x"] + a["width"] <= frame["x"] + frame["width"], name
            for b in found[k + 1 :]:
                wide = min(a["x"] + a["width"], b["x"] + b["width"]) - max(a["x"], b["x"])
                high = min(a["y"] + a["height"], b["y"] + b["height"]) - max(a["y"], b["y"])
                # A text box includes the space above and below the letters, in which boxes may overlap.
                assert wide <= 0 or high <= 5, name


def test_the_links_open_the_animation_and_the_results(unpacked: Unpack, show: Show) -> None:
    folder = unpacked(GEAR)
    page = opened(show, folder).page
    links = page.locator("ul.links a").all()
    targets = [(folder / "documentation" / (link.get_attribute("href") or "")).resolve() for link in links]
    assert len(targets) == 4
    assert all(target.is_file() for target in targets)
    animation = show(folder / "documentation" / "animation.html")
    assert animation.page.title() == GEAR
    assert animation.data()["status"] == "whole"


def test_it_prints_on_white_with_all_tables(unpacked: Unpack, show: Show, tmp_path: Path) -> None:
    page = opened(show, unpacked(GEAR), scheme="dark").page
    page.emulate_media(media="print", color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert page.locator("nav").is_hidden()
    assert page.locator("#parameters table").is_visible()
    printed = tmp_path / "page.pdf"
    page.pdf(path=printed, format="A4")
    assert printed.read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize(("scheme", "width"), [("light", 1200), ("dark", 390)])
def test_axe_finds_nothing_serious(scheme: str, width: int, unpacked: Unpack, show: Show) -> None:
    shown = opened(show, unpacked(GEAR), scheme, width)
    shown.page.evaluate("document.querySelectorAll('details').forEach((one) => (one.open = true))")
    assert inaccessible(shown) == []
