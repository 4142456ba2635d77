"""`cargo fmu sweep --workers N`: the rows of the native run to the byte, also when a worker is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from conftest import CARGO, REPOSITORY

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="finds the workers in /proc")

PROGRAM = os.environ.get("LINKAGE_FMU_BUILD")
"""The program itself, where it is built already."""
PYTHON = REPOSITORY / "target" / "venv-cluster" / "bin" / "python"
"""The environment that `--workers` makes."""
COMMAND = [PROGRAM, "sweep"] if PROGRAM else [*CARGO, "fmu-build", "--", "sweep"]


def start(study: Path, out: Path, *options: str) -> subprocess.Popen[str]:
    """Begin a study."""
    arguments = [*COMMAND, str(study), "--csv", "--out", str(out), *options]
    return subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def finish(process: subprocess.Popen[str]) -> None:
    """Wait for the end of a study, which must be a good one."""
    said, _ = process.communicate(timeout=600)
    assert process.returncode == 0, said


def workers(root: int) -> list[int]:
    """Processes of the workers below this one: those that multiprocessing has spawned, without its tracker."""
    parents: dict[int, list[int]] = {}
    words: dict[int, str] = {}
    for folder in Path("/proc").iterdir():
        if not folder.name.isdigit():
            continue
        try:
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
            words[int(folder.name)] = (folder / "cmdline").read_text()
        except OSError:
            continue
        parents.setdefault(parent, []).append(int(folder.name))
    found, open_ = [], [root]
    while open_:
        process = open_.pop()
        open_ += parents.get(process, [])
        if "spawn_main" in words.get(process, ""):
            found.append(process)
    return found


@pytest.fixture
def study(fmu: Path, tmp_path: Path) -> Path:
    """Runs that end at their event, do not get there, and fail; with every kind of response."""
    stated: dict[str, Any] = {
        "mechanism": str(fmu),
        "start_values": {"uplock.engage": True},
        "factors": {
            "upstop.restitution": {"values": [0, 0.5]},
            "friction.enabled": {"values": [False, True]},
            "solver.method": {"values": ["reduced", "rigid"]},
            "crank.mass": {"values": [13.689, -1]},
            "solver.max_steps": {"values": [100000, 3]},
            "load_factor": {"uniform": [1, 3]},
            "airspeed": {"uniform": [0, 80]},
        },
        "sampling": {"method": "sobol", "count": 256},
        "scenario": {
            "stop_time": 0.14,
            "stop_at": "retracted",
            "output_interval": 0.01,
            "inputs": {"actuator.force": [[0, 10000], [0.02, 30000], [0.02, 31000], [0.1, 29000]]},
        },
        "responses": {
            "met": {"event": "retracted"},
            "down": {"event": "extended"},
            "angle": {"final": "crank.angle"},
            "drift": {"final": "energy.drift"},
            "up": {"final": "retracted"},
            "peak": {"maximum": "joint1.force"},
            "least": {"minimum": "joint2.force_x"},
            "work": {"integral": "actuator.required_force"},
            "rms": {"root_mean_square": "joint3.force"},
            "course": {"course": "wheel.y", "times": [0, 0.013]},
        },
    }
    path = tmp_path / "study.json"
    path.write_text(json.dumps(stated))
    return path


def test_a_cluster_gives_the_rows_of_the_native_run_though_a_worker_is_killed(study: Path, tmp_path: Path) -> None:
    native, cluster = tmp_path / "native", tmp_path / "cluster"
    finish(start(study, native))
    process = start(study, cluster, "--workers", "2")
    journal, killed = cluster / "runs.journal", False
    limit = time.monotonic() + 600
    while not killed and process.poll() is None and time.monotonic() < limit:
        # A quarter of the chunks is there.
        if journal.exists() and journal.stat().st_size > 300_000 and (found := workers(process.pid)):
            os.kill(found[0], signal.SIGKILL)
            killed = True
        time.sleep(0.01)
    finish(process)
    assert killed
    for name in ("runs.csv", "runs.parquet", "study.json"):
        assert (native / name).read_bytes() == (cluster / name).read_bytes(), name
    rows = (native / "runs.csv").read_text().splitlines()
    assert len(rows) == 1 + 32 * 256
    said = "\n".join(rows)
    assert "crank.mass = -1" in said
    assert "solver.max_steps = 3 was met" in said
    assert 'must be ""reduced"" or ""rigid_fem""' in said


def test_a_scheduler_and_workers_that_were_started_by_hand_give_the_same_rows(study: Path, tmp_path: Path) -> None:
    stated = json.loads(study.read_text(encoding="utf-8"))
    stated["sampling"]["count"] = 8
    study.write_text(json.dumps(stated), encoding="utf-8")
    native, local, remote = tmp_path / "native", tmp_path / "local", tmp_path / "remote"
    finish(start(study, native))
    finish(start(study, local, "--workers", "1"))
    told = tmp_path / "scheduler.json"
    dask = [str(PYTHON), "-m", "dask"]
    own = ["--no-dashboard", "--host", "127.0.0.1"]
    processes = [subprocess.Popen([*dask, "scheduler", *own, "--port", "0", "--scheduler-file", str(told)])]
    try:
        limit = time.monotonic() + 60
        while not (told.exists() and told.stat().st_size > 0) and time.monotonic() < limit:
            time.sleep(0.05)
        address = json.loads(told.read_text(encoding="utf-8"))["address"]
        worker = [*dask, "worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
        processes += [subprocess.Popen([*worker, "--local-directory", str(tmp_path)]) for _ in range(2)]
        finish(start(study, remote, "--scheduler", address))
    finally:
        # A worker whose scheduler has gone looks for it for a while.
        for process in reversed(processes):
            process.kill()
            process.wait()
    for name in ("runs.csv", "runs.parquet", "study.json"):
        expected = (native / name).read_bytes()
        assert (local / name).read_bytes() == expected, name
        assert (remote / name).read_bytes() == expected, name
    assert len((native / "runs.csv").read_text().splitlines()) == 1 + 32 * 8
