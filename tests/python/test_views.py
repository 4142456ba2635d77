"""Views for notebooks: well-formed, escaped, in the colours of the page, with the numbers of the objects."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import linkage_fmu as lf
import numpy as np
import pytest
from linkage_fmu import _html

SCRIPT = "<script>alert('&\"1\"')</script>"


def parsed(view: str | None) -> ElementTree.Element:
    """The view as XML, which is stricter than HTML."""
    return ElementTree.fromstring(f"<div>{(view or '').replace('<br>', '<br/>')}</div>")


def rows(view: str | None) -> list[list[str]]:
    """Texts of the cells of the table, by rows."""
    return [["".join(cell.itertext()) for cell in row] for row in parsed(view).iter("tr")]


def path(values: np.ndarray) -> str:
    """Corners of a drawn curve."""
    drawn = re.search(r"d='([^']*)'", _html._curve(values))
    return drawn[1] if drawn else ""


def test_a_result_shows_its_variables(gear: lf.Mechanism) -> None:
    names = ["crank.angle", "joint1.force", "coupler.speed", "retracted"]
    result = gear.simulate(stop_time=0.14, output_interval=1e-3, output=names)
    view = result._repr_html_()
    assert "Result of LandingGearRetraction: 141 rows from 0 s to 0.14 s" in (view or "")
    head, angle, force, speed, retracted = rows(view)
    assert head[1:6] == ["unit", "first", "last", "minimum", "maximum"]
    for cells, name, unit in ((angle, "crank.angle", "rad"), (force, "joint1.force", "N")):
        assert cells[:2] == [name, unit]
        values = result[name]
        assert [float(cell) for cell in cells[2:6]] == pytest.approx(
            [values[0], values[-1], values.min(), values.max()], rel=1e-5
        )
    assert retracted[:4] == ["retracted", "", "False", "True"]
    assert view is not None
    assert view.count("<path") == 4
    assert np.signbit(result["coupler.speed"][0])
    assert speed[2] == "0", "zero has no sign"


def test_a_part_of_a_result_has_a_view_or_none(gear: lf.Mechanism) -> None:
    result = gear.simulate(stop_time=0.1, output=["crank.angle", "crank.speed"])
    assert "10 rows" in (result[:10]._repr_html_() or "")
    assert [row[0] for row in rows(result[["crank.speed"]]._repr_html_())[1:]] == ["crank.speed"]
    texts = result.astype([("time", float), ("crank.angle", "U8"), ("crank.speed", float)])
    assert [row[0] for row in rows(texts._repr_html_())[1:]] == ["crank.speed"]
    for part in (result[:0], result.reshape(1, -1), result == result):
        assert part._repr_html_() is None


def test_a_long_result_shows_its_first_variables(gear: lf.Mechanism) -> None:
    result = gear.simulate(stop_time=0.1)
    view = result._repr_html_()
    count = len(result.names) - 1
    assert count > _html.MOST_ROWS
    assert f"({_html.MOST_ROWS} of {count} variables; to_pandas() shows all columns)" in (view or "")
    assert len(rows(view)) == 1 + _html.MOST_ROWS


def test_kinematics_show_their_outputs(gear: lf.Mechanism) -> None:
    travel = gear.kinematics(50, ["crank.angle", "actuator.holding_force"])
    view = travel._repr_html_()
    assert "51 positions" in view
    _, angle, force = rows(view)
    assert angle[:2] == ["crank.angle", "rad"]
    assert float(angle[3]) == pytest.approx(travel["crank.angle"][-1], rel=1e-5)
    assert float(force[5]) == pytest.approx(travel["actuator.holding_force"].max(), rel=1e-5)


@pytest.mark.parametrize("name", lf.examples())
def test_a_mechanism_shows_its_drawing(name: str) -> None:
    mechanism = lf.example(name)
    view = mechanism._repr_html_()
    assert mechanism.name in view
    assert parsed(view).find("div/{http://www.w3.org/2000/svg}svg") is not None
    causalities = [own.causality for own in mechanism.variables]
    assert f"{causalities.count('input')} inputs, {causalities.count('output')} outputs" in view


def test_a_mechanism_shows_its_warnings() -> None:
    given = lf.example("LandingGearRetraction").to_dict()
    given["torques"] = {**given.get("torques", {}), "idle": {"on": "ground", "torque": 1.0}}
    mechanism = lf.Mechanism(given)
    assert mechanism.warnings
    assert [row[1] for row in rows(mechanism._repr_html_()) if row[0] == "warning"] == mechanism.warnings


def test_texts_are_escaped() -> None:
    given = lf.example("FourBar").to_dict()
    given["description"] = SCRIPT
    mechanism = lf.Mechanism(given)
    finding = lf.Finding("error", SCRIPT, SCRIPT, SCRIPT, 1, 1)
    fact = lf.Fact(SCRIPT, SCRIPT, (lf.Quantity(SCRIPT, 1.0, SCRIPT),), SCRIPT)
    report = lf.Report(SCRIPT, (finding,), (fact,), "")
    renamed = mechanism.simulate(stop_time=0.1, output=["crank.angle"])
    renamed.dtype.names = ("time", SCRIPT)
    for view in (mechanism._repr_html_(), report._repr_html_(), renamed._repr_html_()):
        assert view is not None
        assert "<script" not in view
        assert SCRIPT in "".join(parsed(view).itertext())


def test_views_have_the_colours_of_the_page(gear: lf.Mechanism) -> None:
    """Only the drawing of a mechanism has fixed colours, on its own background."""
    ground, _, table = gear._repr_html_().partition("</div>")
    assert ground.startswith("<div style='background:#fff")
    views = [table, gear.check()._repr_html_(), gear.kinematics(5)._repr_html_(), gear.simulate()._repr_html_()]
    for view in views:
        assert view
        assert not re.search(r"#[0-9a-f]{3,6}\b|rgb|background|(?<![-\w])color:", view)
        assert set(re.findall(r"(?:stroke|fill)='([^']*)'", view)) <= {"currentColor", "none"}


def test_a_curve_has_the_shape_of_its_values() -> None:
    assert path(np.array([0.0, 1.0, 0.5])) == "M0.0 21.0L60.0 1.0L120.0 11.0"
    assert path(np.array([3.0, 3.0])) == "M0.0 11.0L120.0 11.0"
    assert path(np.array([0.0, np.nan, 1.0, 0.0])) == "M0.0 21.0M80.0 1.0L120.0 21.0"
    assert path(np.array([-1.7e308, 1.7e308])) == "M0.0 21.0L120.0 1.0"
    for values in ([np.nan, np.nan], [1.0], [np.inf, -np.inf]):
        assert path(np.array(values)) == ""


def test_a_curve_of_many_values_keeps_its_peaks() -> None:
    values = np.zeros(100_001)
    values[54_321], values[7] = 1.0, np.nan
    drawn = path(values)
    assert len(re.findall("[ML]", drawn)) <= 2 * _html.POINTS
    ((x,),) = [(float(x),) for x, y in re.findall(r"[ML]([\d.]+) ([\d.]+)", drawn) if y == "1.0"]
    assert x == pytest.approx(0.54321 * _html.WIDTH, abs=1.0)
