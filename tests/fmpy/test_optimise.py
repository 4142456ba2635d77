"""`cargo fmu optimise`: no design of an independent search is better; bytes do not depend on the number of threads;
Ctrl-C."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from conftest import REPOSITORY, program

COMMAND = program("fmu-studies")
STUDY = REPOSITORY / "docs" / "studies" / "least_force.json"
TAKEN = ("crank.actuator_x", "follower.actuator_y")
"""Two of the four coordinates, so that few samples are dense."""
SAMPLES = 1000
NEAR = 0.02
"""Half the side of the additionally sampled box around the optimum, relative to the whole range."""

Row = dict[str, str]


def run(*arguments: str) -> None:
    """Run a command, which must succeed."""
    done = subprocess.run([*COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout


def reduced(evaluations: int) -> dict[str, Any]:
    """The study of the example with two coordinates, coarser steps and this number of evaluations."""
    study = json.loads(STUDY.read_text(encoding="utf-8"))
    study["mechanism"] = str(STUDY.parent / study["mechanism"])
    study["factors"] = {name: study["factors"][name] for name in TAKEN}
    study["scenario"]["output_interval"] = 0.002
    study["search"] = {"evaluations": evaluations, "seed": 5}
    return study


def written(folder: Path, study: dict[str, Any], name: str) -> str:
    """A file with the study."""
    path = folder / name
    path.write_text(json.dumps(study), encoding="utf-8")
    return str(path)


def rows(path: Path) -> list[Row]:
    """Rows of a table."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def keeps(row: Row, study: dict[str, Any]) -> bool:
    """Whether a run satisfies all limits."""
    limits = study["constraints"].items()
    return row["failed"] == "0" and all(
        limit.get("at_least", float("-inf")) <= float(row[name]) <= limit.get("at_most", float("inf"))
        for name, limit in limits
    )


def sampled(folder: Path, study: dict[str, Any], bounds: dict[str, tuple[float, float]], name: str) -> list[Row]:
    """Independent samples of designs within these bounds, computed by `cargo fmu sweep`."""
    other = {key: value for key, value in study.items() if key not in ("objective", "constraints", "search")}
    other["factors"] = {name: {"uniform": list(ends)} for name, ends in bounds.items()}
    other["sampling"] = {"method": "random", "count": SAMPLES, "seed": 11}
    run("sweep", written(folder, other, f"{name}.json"), "--csv", "--out", str(folder / name))
    return rows(folder / name / "runs.csv")


def test_no_sampled_design_is_better_and_the_best_one_is_written(tmp_path: Path) -> None:
    study = reduced(600)
    path = written(tmp_path, study, "study.json")
    for threads in ("1", "2"):
        run("optimise", path, "--csv", "--threads", threads, "--out", str(tmp_path / threads))
    names = ("evaluations.csv", "evaluations.parquet", "optimum.json", "mechanism.json", "designs.svg")
    for name in names:
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes(), name
    optimum = json.loads((tmp_path / "1" / "optimum.json").read_text(encoding="utf-8"))
    best = optimum["best"]
    peak = best["responses"]["peak"]
    assert best["violation"] == 0.0
    assert peak < optimum["present"]["responses"]["peak"]
    assert optimum["evaluations"] <= 600

    # The rows agree, and an independent search finds no better design in the whole range or near the optimum.
    evaluations = rows(tmp_path / "1" / "evaluations.csv")
    assert len(evaluations) == optimum["evaluations"] + 1
    assert min(float(row["peak"]) for row in evaluations if keeps(row, study)) == peak
    whole = {name: tuple(study["factors"][name]["bounds"]) for name in TAKEN}
    around = {}
    for name, (least, largest) in whole.items():
        half = NEAR * (largest - least)
        around[name] = (max(least, best["factors"][name] - half), min(largest, best["factors"][name] + half))
    far = [float(row["peak"]) for row in sampled(tmp_path, study, whole, "far") if keeps(row, study)]
    near = [float(row["peak"]) for row in sampled(tmp_path, study, around, "near") if keeps(row, study)]
    assert len(far) > 20
    assert len(near) > 20
    assert peak < min(far)
    assert peak < min(near)
    # Close to an optimum there are designs that are only slightly worse.
    assert min(near) < 1.01 * peak

    # The written definition has the best values and gives the same responses.
    as_written = {key: value for key, value in study.items() if key not in ("objective", "constraints", "search")}
    as_written |= {"mechanism": str(tmp_path / "1" / "mechanism.json"), "factors": {}}
    run("sweep", written(tmp_path, as_written, "again.json"), "--csv", "--out", str(tmp_path / "again"))
    again = rows(tmp_path / "again" / "runs.csv")[0]
    for name, value in best["responses"].items():
        assert float(again[name]) == pytest.approx(value, rel=1e-12, abs=1e-12), name
    run("check", "--deny-warnings", str(tmp_path / "1" / "mechanism.json"))


@pytest.mark.skipif(os.name != "posix", reason="sends SIGINT")
def test_a_search_that_is_ended_gives_the_best_so_far(tmp_path: Path) -> None:
    # Afterwards the environment of the optimiser exists.
    run("optimise", written(tmp_path, reduced(20), "short.json"), "--out", str(tmp_path / "short"))
    study = json.loads(STUDY.read_text(encoding="utf-8")) | {"search": {"evaluations": 1_000_000}}
    study["mechanism"] = str(STUDY.parent / study["mechanism"])
    path, out = written(tmp_path, study, "study.json"), tmp_path / "out"
    # On a slow machine the optimiser may request its first design late.
    for wait in (4.0, 20.0, 80.0):
        shutil.rmtree(out, ignore_errors=True)
        optimum = ended_after(wait, path, out)
        if optimum["evaluations"] > 0:
            break
    assert optimum["ended"] == "stopped by the user"
    assert 0 < optimum["evaluations"] < 1_000_000
    assert len(rows(out / "evaluations.csv")) == optimum["evaluations"] + 1
    assert (out / "mechanism.json").is_file()


def ended_after(wait: float, path: str, out: Path) -> dict[str, Any]:
    """The report of a search that a Ctrl-C ends this number of seconds after its start."""
    command = [*COMMAND, "optimise", path, "--csv", "--out", str(out)]
    # A separate session, so that the whole group receives the signal, as from a terminal.
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )
    limit = time.monotonic() + 600
    # The folder is created before the optimiser starts.
    while not out.exists() and time.monotonic() < limit and process.poll() is None:
        time.sleep(0.02)
    time.sleep(wait)
    os.killpg(process.pid, signal.SIGINT)
    said, _ = process.communicate(timeout=120)
    if not (out / "optimum.json").exists():
        # The search ended before the first design was evaluated.
        return {"evaluations": 0}
    assert process.returncode == 130, said
    return json.loads((out / "optimum.json").read_text(encoding="utf-8"))
