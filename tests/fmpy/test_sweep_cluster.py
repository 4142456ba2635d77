"""`cargo fmu sweep --workers N`: rows identical to those of the native run, also if a worker is killed."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import REPOSITORY, program

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="finds the workers in /proc")

PYTHON = REPOSITORY / "target" / "venv-cluster" / "bin" / "python"
"""The environment that `--workers` creates."""
COMMAND = [*program("fmu-studies"), "sweep"]


def start(study: Path, out: Path, *options: str) -> subprocess.Popen[str]:
    """Start a study."""
    arguments = [*COMMAND, str(study), "--csv", "--out", str(out), *options]
    return subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def finish(process: subprocess.Popen[str]) -> None:
    """Wait for the end of a study, which must succeed."""
    said, _ = process.communicate(timeout=600)
    assert process.returncode == 0, said


WORKER = "spawn_main"
"""Text in the command line of a worker, which multiprocessing has spawned."""


def processes(root: int, word: str) -> list[int]:
    """Processes below this process with this word in their command line."""
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
        if word in words.get(process, ""):
            found.append(process)
    return found


@pytest.fixture
def study(fmu: Path, tmp_path: Path) -> Path:
    """Runs that end at their event, that do not reach it, and that fail, with every kind of response."""
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
        # A quarter of the chunks is complete.
        if journal.exists() and journal.stat().st_size > 300_000 and (found := processes(process.pid, WORKER)):
            os.kill(found[0], signal.SIGKILL)
            killed = True
        time.sleep(0.01)
    finish(process)
    assert killed
    same_files(native, cluster)
    rows = (native / "runs.csv").read_text().splitlines()
    assert len(rows) == 1 + 32 * 256
    said = "\n".join(rows)
    assert "crank.mass = -1" in said
    assert "solver.max_steps = 3 was reached" in said
    assert 'must be ""reduced"" or ""rigid_fem""' in said


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[str]:
    """Address of a scheduler with two workers that were started manually. Their temporary files are in
    `tmp_path/workers`."""
    scheduler_file, own_files = tmp_path / "scheduler.json", tmp_path / "workers"
    own_files.mkdir()
    dask = [str(PYTHON), "-m", "dask"]
    own = ["--no-dashboard", "--host", "127.0.0.1"]
    environment = os.environ | {"TMPDIR": str(own_files)}
    processes = [subprocess.Popen([*dask, "scheduler", *own, "--port", "0", "--scheduler-file", str(scheduler_file)])]
    try:
        limit = time.monotonic() + 60
        while not (scheduler_file.exists() and scheduler_file.stat().st_size > 0) and time.monotonic() < limit:
            time.sleep(0.05)
        address = json.loads(scheduler_file.read_text(encoding="utf-8"))["address"]
        worker = [*dask, "worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
        worker += ["--local-directory", str(tmp_path)]
        processes += [subprocess.Popen(worker, env=environment) for _ in range(2)]
        yield address
    finally:
        # A worker searches for its lost scheduler for some time.
        for process in reversed(processes):
            process.kill()
            process.wait()


def same_files(one: Path, other: Path) -> None:
    """Both folders have identical results."""
    for name in ("runs.csv", "runs.parquet", "study.json"):
        assert (one / name).read_bytes() == (other / name).read_bytes(), name


def changed(study: Path, name: str, **sections: Any) -> Path:  # noqa: ANN401
    """A study next to this study with other sections."""
    stated = json.loads(study.read_text(encoding="utf-8")) | sections
    path = study.with_name(name)
    path.write_text(json.dumps(stated), encoding="utf-8")
    return path


def test_studies_share_a_scheduler_and_clean_up_its_workers(study: Path, scheduler: str, tmp_path: Path) -> None:
    one = changed(study, "one.json", sampling={"method": "sobol", "count": 16})
    other = changed(
        study,
        "other.json",
        sampling={"method": "latin_hypercube", "count": 8, "seed": 1},
        start_values={},
        responses={"least": {"minimum": "crank.angle"}},
    )
    native, local, remote = ([tmp_path / f"{place}{k}" for k in range(2)] for place in ("native", "local", "remote"))
    finish(start(one, native[0]))
    finish(start(other, native[1]))
    finish(start(one, local[0], "--workers", "1"))
    processes = [start(one, remote[0], "--scheduler", scheduler), start(other, remote[1], "--scheduler", scheduler)]
    for process in processes:
        finish(process)
    same_files(native[0], local[0])
    for k in range(2):
        same_files(native[k], remote[k])
    assert len((native[0] / "runs.csv").read_text().splitlines()) == 1 + 32 * 16
    assert list((tmp_path / "workers").glob("linkage-fmu-*")) == []


def test_a_study_on_a_scheduler_is_ended_and_resumed(study: Path, scheduler: str, tmp_path: Path) -> None:
    native, remote = tmp_path / "native", tmp_path / "remote"
    finish(start(study, native))
    process = start(study, remote, "--scheduler", scheduler)
    journal, limit = remote / "runs.journal", time.monotonic() + 600
    while not (journal.exists() and journal.stat().st_size > 100_000) and time.monotonic() < limit:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    assert process.returncode == 130, said
    assert list((tmp_path / "workers").glob("linkage-fmu-*")) == []
    finish(start(study, remote, "--scheduler", scheduler, "--resume"))
    same_files(native, remote)


def test_an_fmu_of_fmi_3_is_packed_again_for_the_workers(fmu: Path, study: Path, tmp_path: Path) -> None:
    newer = fmu.with_suffix(".fmi3.fmu")
    small = changed(study, "fmi3.json", mechanism=str(newer), sampling={"method": "sobol", "count": 2})
    native, cluster = tmp_path / "native", tmp_path / "cluster"
    finish(start(small, native))
    finish(start(small, cluster, "--workers", "1"))
    same_files(native, cluster)


PENDULUM: dict[str, Any] = {
    "name": "Pendulum",
    "parameters": {"inner": 0.1, "outer": 0.3},
    "gravity": {"acceleration": 9.81, "up_angle": 1.5},
    "bodies": {"ground": {}, "bar": {"length": "outer - inner", "mass": 1, "shape": "uniform_rod"}},
    "joints": {"pivot": {"type": "revolute", "first": "ground.origin", "second": "bar.origin"}},
    "start": {"body": "bar", "angle": 0.5},
    "guess": {"bar": 0.5},
}


def test_factors_are_set_together_on_a_cluster_too(tmp_path: Path) -> None:
    (tmp_path / "mechanism.json").write_text(json.dumps(PENDULUM), encoding="utf-8")
    stated = {
        "mechanism": "mechanism.json",
        "factors": {"inner": {"values": [0.1, 0.4, 0.9]}, "outer": {"values": [0.3, 0.6, 1.4]}},
        "scenario": {"stop_time": 0.5},
        "responses": {"angle": {"final": "bar.angle"}, "length": {"final": "bar.length"}},
    }
    study = tmp_path / "pendulum.json"
    study.write_text(json.dumps(stated), encoding="utf-8")
    native, cluster = tmp_path / "native", tmp_path / "cluster"
    finish(start(study, native))
    finish(start(study, cluster, "--workers", "1"))
    same_files(native, cluster)
    with (native / "runs.csv").open(encoding="utf-8", newline="") as file:
        failed = [row["message"] for row in csv.DictReader(file) if row["failed"] == "1"]
    assert len(failed) == 3
    assert all("bar.length" in message for message in failed), failed


FORCES = [f"load{index}" for index in range(20)]
RUNS = 150_000


def test_the_client_of_a_cluster_does_not_grow_with_the_runs(tmp_path: Path) -> None:
    # With a damper, the runs need the workers: the energy integral does not serve.
    damped = PENDULUM | {
        "springs": {"damper": {"joint": "pivot", "damping": 0.1}},
        "forces": {name: {"at": "bar.end"} for name in FORCES},
    }
    (tmp_path / "mechanism.json").write_text(json.dumps(damped), encoding="utf-8")
    stated = {
        "mechanism": "mechanism.json",
        "factors": {f"{name}.force_{axis}": {"uniform": [0, 1]} for name in FORCES for axis in "xy"},
        "sampling": {"method": "random", "count": RUNS, "seed": 1},
        "scenario": {"stop_time": 1e-3},
        "responses": {"angle": {"final": "bar.angle"}},
    }
    study = tmp_path / "many.json"
    study.write_text(json.dumps(stated), encoding="utf-8")
    process, taken = start(study, tmp_path / "cluster", "--workers", "2"), []
    journal = tmp_path / "cluster" / "runs.journal"
    while process.poll() is None:
        time.sleep(0.05)
        try:
            done = journal.stat().st_size / (RUNS * 8 * (2 * len(FORCES) + 1))
            # During the runs: after them the client writes the table.
            if 0.3 < done < 1.0:
                client = Path("/proc", str(processes(process.pid, "cluster.py")[0]))
                taken.append(1024.0 * int((client / "status").read_text().split("VmRSS:")[1].split()[0]))
        except (OSError, IndexError):
            # The journal does not exist yet, or the study has just ended.
            continue
    finish(process)
    # The values of the factors that are added between these two samples have 33 MB. Pending tasks have at most 8 MB.
    assert len(taken) > 5
    assert max(taken[-3:]) - taken[0] < 16e6, taken


def test_a_scheduler_that_does_not_answer_is_an_error_in_one_sentence(study: Path, tmp_path: Path) -> None:
    """Without a traceback, and with a remedy: a port without a listener, and an invalid address."""
    addresses = ["tcp://127.0.0.1:1", "nowhere"]
    waiting = [start(study, tmp_path / str(index), "--scheduler", address) for index, address in enumerate(addresses)]
    for index, (address, process) in enumerate(zip(addresses, waiting, strict=True)):
        said, _ = process.communicate(timeout=600)
        assert process.returncode == 1, said
        assert "Traceback" not in said, said
        message = f"error: the cluster: no Dask scheduler answers at {address} within 30 s ("
        assert message in said, said
        assert "; start a scheduler on that machine with `dask scheduler`, check the address" in said, said
        assert not (tmp_path / str(index) / "runs.journal").exists(), "nothing to resume"
