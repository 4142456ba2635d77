"""The report on the papers: results of its runs, and agreement of the committed pages with the output of `cargo fmu
report`."""

from __future__ import annotations

import re

import pytest
from bench_figures import figures
from conftest import FMU_FOLDER, REPOSITORY
from report.build import sections
from report.html import Shown, html
from report.page import Section, text

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])")
ROUNDING = 1e-10
"""Error of identities of the one-element model: a few rounding errors of the tables, 1e-13, with a margin."""
REFERENCE_TIME = 0.13205985274426
"""Retraction without friction by a quadrature with 34 digits [s]."""
REFERENCE_TIME_WITH_FRICTION = 0.13448835
"""Retraction with friction, by an independent program [s]."""
EXTENSION_TIME = 0.19169689347761
"""Extension under 9 kN by a quadrature of the energy balance with 34 digits [s]."""
ELASTIC_LIMIT = 1.389e-4
"""Angle of the gear after 0.13 s with elastic rods minus that with rigid links [rad], for small steps."""


@pytest.fixture(scope="module")
def found() -> dict[str, Section]:
    """The numbers, without drawings."""
    return {section.title: section for section in sections(FMU_FOLDER)}


def test_retraction_time_and_angle(found: dict[str, Section]) -> None:
    values = found["[HF08] motion"].values
    assert round(values["retraction_time"], 3) == 0.132
    assert abs(values["retraction_time"] - REFERENCE_TIME) < 1e-10
    assert abs(values["angle"] - 2.1) < 1e-12


def test_friction_adds_about_two_per_cent(found: dict[str, Section]) -> None:
    values = found["[HF08] friction"].values
    assert 1.5 < values["share"] < 2.5
    assert 1.5 < values["share_air"] < 2.5
    assert abs(values["rough_time"] - REFERENCE_TIME_WITH_FRICTION) < 1e-8
    assert values["law"] < 1e-12
    assert (values["static"], values["kinetic"]) == (0.19, 0.026)
    # At rest this friction is 0: both motions start equally.
    assert values["start"] == pytest.approx(values["rough_start"], rel=1e-12)


def test_loads_superpose_and_friction_costs_force(found: dict[str, Section]) -> None:
    assert found["[HF08] loads"].values["superposition"] < ROUNDING
    assert found["[HF08] loads"].values["drag_end"] < 0.2
    values = found["[HF08] inverse dynamics"].values
    assert values["extra_least"] > 0.0
    assert values["plain"] < values["forward"] < 30e3
    assert values["round_trip"] < ROUNDING


def test_extension_ends_at_the_time_of_the_energy_integral(found: dict[str, Section]) -> None:
    values = found["[HF08] extension"].values
    assert abs(values["time"] - EXTENSION_TIME) < 1e-9
    assert abs(values["time"] - values["interpolated"]) < 1e-9


def test_loads_on_the_fuselage_balance_weight_and_inertia(found: dict[str, Section]) -> None:
    assert found["[HF08] fuselage"].values["balance"] < ROUNDING


def test_appendix_needs_its_corrections(found: dict[str, Section]) -> None:
    values = found["[HF08] appendix"].values
    # Central differences of the ratios, and Runge-Kutta steps.
    assert values["formulas"] < 1e-9
    assert abs(values["corrected"] - REFERENCE_TIME) < 1e-8
    assert abs(values["printed"] - REFERENCE_TIME) > 0.01


def test_finite_elements_as_printed_approach_rigid_links(found: dict[str, Section]) -> None:
    values = found["[HF08] finite elements"].values
    # Newmark's method is of second order: a step four times as long has an error about 16 times as large.
    assert abs(values["finer"]) < abs(values["literal"]) < abs(values["coarse"]) < 5e-5
    # Steps of 10 us add 4e2 h^2.
    assert abs(values["exact"] - ELASTIC_LIMIT) < 2e-7


def test_bodies_superpose(found: dict[str, Section]) -> None:
    values = found["[CK16] superposition"].values
    assert values["superposition"] < ROUNDING
    assert values["closed"] < ROUNDING


def test_the_attachments_found_need_less_force(found: dict[str, Section]) -> None:
    values = found["Design"].values
    # The search reads the force every 0.5 ms of a retraction. The report uses other angles and may miss the peak
    # slightly.
    assert 0.999 * 5927.67 < values["found"] < 5927.68
    assert 0.999 * 7050.55 < values["built"] < 7050.56


@pytest.mark.parametrize("title", ["[CK16] slider-crank", "[CK16] jib"])
def test_one_element_model(found: dict[str, Section], title: str) -> None:
    for name in ("closed", "identity", "sum", "round_trip"):
        assert found[title].values[name] < ROUNDING, name


def test_committed_page(found: dict[str, Section]) -> None:
    """The text equals the output of the command. Numbers agree to one unit of their last digit."""
    committed = (REPOSITORY / "validation" / "report.md").read_text(encoding="utf-8")
    written = text(list(found.values()))
    again = "; run `cargo fmu report` and commit what it writes"
    assert NUMBER.sub("#", committed) == NUMBER.sub("#", written), f"the words differ{again}"
    for there, here in zip(NUMBER.findall(committed), NUMBER.findall(written), strict=True):
        decimals = len(there.partition(".")[2])
        unit = 0.0 if "e" in there else 1.01 * 10.0**-decimals if decimals else 0.0
        assert abs(float(there) - float(here)) <= unit, f"{there} is now {here}{again}"


def test_committed_html(found: dict[str, Section]) -> None:
    """The text of the page equals the output of the command, except for pictures and the embedded page of the gear."""
    committed = (REPOSITORY / "validation" / "report.html").read_text(encoding="utf-8")
    results, empty = REPOSITORY / "validation" / "results", b""
    pictures = {figure.name: empty for section in found.values() for figure in section.figures}
    written = html(list(found.values()), pictures, "", [Shown(figure, empty) for figure in figures(results)])
    held = re.compile(r'(src="data:image/png;base64,|srcdoc=")[^"]*')
    assert len(held.findall(committed)) == len(pictures) + 6
    again = "; run `cargo fmu report` and commit what it writes"
    there, here = (NUMBER.sub("#", held.sub("", text)) for text in (committed, written))
    assert there == here, f"the words differ{again}"


def test_committed_figures(found: dict[str, Section]) -> None:
    """One PNG and one SVG file for each figure of the page, and no other figures of the papers."""
    names = {figure.name for section in found.values() for figure in section.figures}
    folder = REPOSITORY / "validation" / "figures"
    there = {path.name for path in folder.iterdir() if path.name.startswith(("ck16_", "hf08_", "design_"))}
    assert there == {f"{name}.{suffix}" for name in names for suffix in ("png", "svg")}
