"""Plots of `cargo fmu simulate --plot`: panels, units with prefixes, ticks, Booleans as steps, no date in a file."""

from __future__ import annotations

import io
import sys

import matplotlib as mpl
import numpy as np
import pytest
from conftest import REPOSITORY

sys.path.append(str(REPOSITORY / "fmu-build" / "python"))
import plot

TIME = {"name": "time", "quantity": "Time", "unit": "s", "values": [0.0, 0.5, 1.0]}


def line(name: str, quantity: str | None, unit: str | None, *values: float | None) -> dict[str, object]:
    """A line of a plan."""
    return {"name": name, "quantity": quantity, "unit": unit, "values": list(values)}


def drawn(*lines: dict[str, object]) -> plot.Figure:
    """The picture of these lines over time."""
    with mpl.rc_context(plot.STYLE):
        return plot.draw({"title": "Gear", "x": TIME, "lines": list(lines)})


@pytest.mark.parametrize(
    ("unit", "size", "shown", "factor"),
    [
        ("N", 3e4, "kN", 1e-3),
        ("N", 900.0, "N", 1.0),
        ("Pa", 2.1e7, "MPa", 1e-6),
        ("N.m", 3e4, "kN\u00b7m", 1e-3),
        ("m", 3e-3, "mm", 1e3),
        ("m", 3e5, "10\u00b3 m", 1e-3),
        ("m2", 3e-5, "10\u207b\u2076 m\u00b2", 1e6),
        ("kg.m2", 3.0, "kg\u00b7m\u00b2", 1.0),
        ("deg/s2", 3e6, "10\u2076 deg/s\u00b2", 1e-6),
        ("1", 1e-5, "10\u207b\u2076", 1e6),
        ("J", 0.0, "J", 1.0),
    ],
)
def test_large_and_small_values_have_a_prefix(unit: str, size: float, shown: str, factor: float) -> None:
    words, found = plot.unit_with_prefix(unit, size)
    assert words == shown
    assert found == pytest.approx(factor, rel=1e-12)


def test_each_quantity_has_its_panel() -> None:
    canvas = drawn(
        line("leg.angle", "Angle", "deg", 0.0, 45.0, 90.0),
        line("up", None, None, 0.0, 0.0, 1.0),
        line("jack.force", "Force", "N", 3e4, None, 2e4),
        line("brace.angle", "Angle", "deg", 1.0, 2.0, 3.0),
    )
    angle, force, flags = canvas.axes
    assert canvas.get_suptitle() == "Gear"
    assert [axes.get_ylabel() for axes in canvas.axes] == ["Angle [deg]", "Force [kN]", ""]
    assert [text.get_text() for text in angle.get_legend().get_texts()] == ["leg.angle", "brace.angle"]
    assert flags.get_xlabel() == "time [s]"
    # A missing value is a gap in the line.
    np.testing.assert_array_equal(np.isnan(force.lines[0].get_ydata()), [False, True, False])
    assert [tick.get_text() for tick in flags.get_yticklabels()] == ["false", "true"]
    assert flags.lines[0].get_drawstyle() == "steps-post"


def test_a_quantity_without_a_name_has_that_of_its_variables() -> None:
    names = ("eigenvalue 1, real", "eigenvalue 1, imaginary", "eigenvalue 2, real")
    axes = drawn(
        *(line(name, None, "1/s", 0.0, 1.0, 2.0) for name in names),
        line("gear.mass_rate", None, "kg/m", 0.0, 1.0, 2.0),
    ).axes
    assert [own.get_ylabel() for own in axes] == ["Eigenvalue [1/s]", "Mass rate [kg/m]"]


def test_ticks_are_plain_numbers() -> None:
    around_zero = drawn(line("a", "Length", "m", -1.2, 0.0, 1.2))
    around_zero.canvas.draw()
    ticks = [text.get_text() for text in around_zero.axes[0].get_yticklabels()]
    assert "0.0" in ticks
    assert all(len(tick) <= 5 and "e" not in tick for tick in ticks), ticks
    # A constant with the rounding of a computation is a straight line.
    constant = drawn(line("a", "Length", "m", 1.0, 1.0 + 1e-15, 1.0)).axes[0]
    assert constant.get_ylim() == pytest.approx((0.9, 1.1))


def test_omitted_plots_are_reported(capsys: pytest.CaptureFixture[str]) -> None:
    many = [line(f"joint{k}.force", "Force", "N", 0.0, 1.0, 2.0) for k in range(plot.LINES + 3)]
    assert len(drawn(*many, line("up", None, None, 0.0, 1.0, 1.0)).axes) == 2
    assert "note: 3 variables are not drawn" in capsys.readouterr().err


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_picture_has_the_same_bytes_each_time(
    ending: str, monkeypatch: pytest.MonkeyPatch, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    plan = plot.json.dumps({"title": "Gear", "x": TIME, "lines": [line("a", "Length", "m", 1.0, 0.5, 0.25)]})
    pictures = []
    for _ in range(2):
        monkeypatch.setattr(sys, "argv", ["plot.py", ending])
        monkeypatch.setattr(sys, "stdin", io.StringIO(plan))
        plot.main()
        pictures.append(capsysbinary.readouterr().out)
    assert pictures[0] == pictures[1]
    assert len(pictures[0]) > 1000
