"""Kinematics, linearisation, equilibria, studies, packing, pages."""

from __future__ import annotations

import json
from pathlib import Path

import linkage_fmu as lf
import numpy as np
import pytest
from linkage_fmu import build


def test_a_report_has_findings_and_facts(gear: lf.Mechanism) -> None:
    report = gear.check()
    assert report.errors == []
    assert str(report).endswith(report.text.rstrip()[-20:])
    assert report.about("Travel") or report.about("Range") or report.facts
    assert "<table>" in report._repr_html_()
    (held,) = gear.equilibria()
    assert held.of == "crank"
    assert held["stable position"] == pytest.approx(-1.3)
    with pytest.raises(KeyError, match="stable position"):
        held["nothing"]


def test_kinematics_agree_with_differences_and_with_the_outputs(gear: lf.Mechanism) -> None:
    kinematics = gear.kinematics(400)
    assert len(kinematics) == 401
    angle, length = kinematics["crank.angle"], kinematics["actuator.length"]
    found = kinematics.influence("crank.angle", "actuator.length")
    differences = np.gradient(angle, length, edge_order=2)
    assert found[2:-2] == pytest.approx(differences[2:-2], rel=2e-3)
    for k in (50, 200, 350):
        at = gear.simulation({"crank.start_angle": float(angle[k])})
        for name in ("actuator.length", "actuator.reduced_mass", "actuator.holding_force", "wheel.x"):
            assert kinematics[name][k] == pytest.approx(at[name], rel=1e-9, abs=1e-9), name
    frame = kinematics.to_pandas()
    assert list(frame.columns) == list(kinematics)
    loaded = gear.kinematics(10, ["actuator.holding_force"], {"load_factor": 1})
    assert not np.allclose(loaded["actuator.holding_force"], kinematics["actuator.holding_force"][::40])


def test_a_linear_model_is_that_of_the_equation_of_motion(gear: lf.Mechanism) -> None:
    model = gear.linearise(outputs=["crank.angle", "joint1.force"], inputs=["actuator.force"])
    assert model.A.shape == (2, 2)
    assert model.B.shape == (2, 1)
    assert model.C.shape == (2, 2)
    assert model.D.shape == (2, 1)
    simulation = gear.simulation()
    (expected,) = simulation.directional_derivative(["crank.acceleration"], ["actuator.force"], [1.0])
    assert model.B[1, 0] == pytest.approx(expected)
    along = gear.linearise_travel(10, held_by="actuator.force")
    assert len(along) == 11
    assert all(at.holding is not None for at in along)
    a, _, _, _ = model
    assert a is model.A


def test_a_drawn_mechanism_is_short() -> None:
    parts = (
        build.body("crank", mass=1.2),
        build.body("rod", mass=0.9),
        build.body("slider", mass=np.float32(0.5)),
        build.pin("bearing", "ground", "crank", at=(0, 0)),
        build.pin("pin", "crank", "rod", at=np.array([80, 60])),
        build.pin("wrist", "rod", "slider", at=(360, 0)),
        build.slide("guide", "ground", "slider", at=(360, 0)),
        build.torque("motor", on="crank", torque=2),
        build.start("crank", angle=30),
    )
    definition = build.mechanism("Press", *parts)
    press = lf.Mechanism(definition)
    assert press.simulation()["crank.angle"] == pytest.approx(np.pi / 6)
    assert json.loads(press.to_json()) == press.to_dict() == definition
    with pytest.raises(lf.InputError, match="two parts have this name"):
        build.mechanism("Press", *parts, build.pin("pin", "crank", "rod", at=(80, 60)))
    with pytest.raises(lf.InputError, match="is not a point"):
        build.mechanism("Press", build.pin("pin", "ground", "rod", at=(80, 60, 2)))


STUDY = {
    "factors": {"load_factor": {"values": [1, 2, 3]}, "actuator.force": {"range": [30000, 34000], "steps": 3}},
    "scenario": {"stop_time": 1.0, "stop_at": "retracted", "output_interval": 0.001},
    "responses": {"time_up": {"event": "retracted"}, "peak": {"maximum": "joint1.force"}},
}


def test_a_sweep_is_a_table(gear: lf.Mechanism, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    calls: list[tuple[int, int]] = []
    frame = lf.sweep(STUDY, gear, progress=lambda done, of: calls.append((done, of)), out=tmp_path / "out")
    assert len(frame) == 9
    assert calls[-1] == (9, 9)
    assert capfd.readouterr() == ("", "")
    assert (tmp_path / "out" / "runs.parquet").is_file()
    row = frame[(frame["load_factor"] == 3) & (frame["actuator.force"] == 30000)].iloc[0]
    assert row["time_up"] == pytest.approx(0.132059852, abs=1e-8)
    path = tmp_path / "study.json"
    gear.save(tmp_path / "gear.json")
    path.write_text(json.dumps({**STUDY, "mechanism": "gear.json"}), encoding="utf-8")
    again = lf.sweep(path)
    assert again.equals(frame)


def test_a_callback_ends_a_sweep(gear: lf.Mechanism) -> None:
    def stop(done: int, of: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lf.sweep(STUDY, gear, progress=stop)
    assert len(lf.sweep(STUDY, gear)) == 9, "the wish to end one study must not end the next"


def test_an_optimum_is_a_mechanism(gear: lf.Mechanism) -> None:
    pytest.importorskip("scipy")
    study = {
        "factors": {"crank.actuator_x": {"bounds": [-0.08, -0.02]}},
        "scenario": {"stop_time": 0.6, "stop_at": "retracted", "output_interval": 0.001},
        "responses": {"time_up": {"event": "retracted"}},
        "objective": {"minimise": "time_up"},
        "search": {"evaluations": 30, "seed": 1},
    }
    best = lf.optimise(study, gear)
    assert best.responses["time_up"] <= best.present["time_up"]
    assert len(best.evaluations) >= 20
    assert best.mechanism.simulation()["crank.actuator_x"] == pytest.approx(best.factors["crank.actuator_x"])
    assert (best._repr_svg_() or "").startswith("<svg")


def test_a_mechanism_is_packed(tmp_path: Path) -> None:
    crank = lf.Mechanism(lf.example("SliderCrank").to_dict())
    paths = crank.package(tmp_path, animation=False, results=False)
    assert [path.name for path in paths] == ["SliderCrank.fmu", "SliderCrank.fmi3.fmu"]
    verdict = lf.validate(paths[0])
    assert verdict, verdict
    assert str(verdict).endswith("\nvalid") or str(verdict) == "valid"
    stated = lf.info(paths[0])
    assert "crank.angle" in str(stated)
    assert stated["definition"] == "mechanism.json"
    (tmp_path / "broken.fmu").write_bytes(b"PK")
    assert not lf.validate(tmp_path / "broken.fmu")
    assert lf.Mechanism(paths[0]).name == "SliderCrank"


def test_a_page_moves_the_mechanism(gear: lf.Mechanism, tmp_path: Path) -> None:
    page = gear.view(stop_time=0.1)
    assert "<script" in page.html
    assert page._repr_html_().startswith("<iframe srcdoc=")
    assert page.save(tmp_path / "gear.html").stat().st_size == len(page.html.encode())
    run = gear.simulate(stop_time=0.1, start_values={"load_factor": 1}, output=["crank.angle"])
    assert run.animate().html != page.html
    signal = {"time": [0, 1], "load_factor": [1, 1]}
    with pytest.raises(lf.InputError, match="inputs over time cannot be animated"):
        gear.simulate(stop_time=0.1, input=signal, output=["crank.angle"]).animate()
