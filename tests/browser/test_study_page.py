"""The page of `cargo fmu sweep --page` in a browser: every tab is drawn, nothing is loaded, and there are no errors."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
from conftest import REPOSITORY, Show

TABS = ["Main effects", "Scatter matrix", "Distributions", "Response surfaces", "Sobol's indices"]
#: Elements that exist after Bokeh has drawn the page.
READY = ".bk-Tabs canvas, .bk-Figure"


@pytest.fixture(scope="session")
def study_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a small study by Saltelli's design."""
    program = os.environ.get("LINKAGE_VIEW")
    assert program, "LINKAGE_VIEW names no program; run the tests by `cargo fmu test`"
    folder = tmp_path_factory.mktemp("study")
    study = {
        "mechanism": str(REPOSITORY / "modelDescription" / "LandingGearRetraction"),
        "factors": {"actuator.force": {"uniform": [28000, 36000]}, "load_factor": {"uniform": [1, 3]}},
        "sampling": {"method": "saltelli", "count": 64, "seed": 3},
        "scenario": {"stop_time": 0.6, "stop_at": "retracted"},
        "responses": {"retraction": {"event": "retracted"}, "angle": {"final": "crank.angle"}},
    }
    path = folder / "small.json"
    path.write_text(json.dumps(study), encoding="utf-8")
    out = folder / "out"
    command = [program, "sweep", str(path), "--page", "--out", str(out)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return out / "page.html"


def test_every_tab_is_drawn(study_page: Path, show: Show) -> None:
    page = show(study_page, ready=READY).page
    for title in TABS:
        page.get_by_text(title, exact=True).first.click()
        figures = page.locator(".bk-Figure:visible")
        figures.first.wait_for()
        # A figure with drawn data has pixels in more colours than those of its background and axes.
        colours = figures.first.locator("canvas").first.evaluate(
            "(canvas) => {"
            " const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;"
            " const found = new Set();"
            " for (let i = 0; i < pixels.length; i += 4) found.add(pixels.slice(i, i + 4).join());"
            " return found.size; }"
        )
        assert colours > 10, title


def test_axes_have_units_and_what_does_not_change_has_no_plot(study_page: Path) -> None:
    text = study_page.read_text(encoding="utf-8")
    assert '"actuator.force [kN]"' in text
    assert '"retraction [s]"' in text
    # In every run the gear ends at its stop, so its final angles differ only by rounding.
    assert '"angle [rad]"' not in text


def test_a_phone_and_a_dark_screen_show_it(study_page: Path, show: Show) -> None:
    page = show(study_page, ready=READY).page
    page.set_viewport_size({"width": 390, "height": 800})
    page.emulate_media(color_scheme="dark")
    for title in TABS:
        page.get_by_text(title, exact=True).first.click()
        page.locator(".bk-Figure:visible").first.wait_for()
        wide, narrow = page.evaluate("[document.scrollingElement.scrollWidth, document.scrollingElement.clientWidth]")
        assert wide <= narrow, f"{title}: the page is {wide} pixels wide"
    assert "invert" in page.evaluate("getComputedStyle(document.body).filter")
