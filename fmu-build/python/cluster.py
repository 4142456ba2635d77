"""Make chunks of a study on a cluster of Dask: each worker runs the packed FMU through FMPy.

usage: cluster.py FMU PLAN (--workers N | --scheduler ADDRESS)

The plan is what `cargo fmu sweep` makes of a study. Chunks come on the standard input: number, number of runs, values
of the factors of each run. What is made goes to the standard output: number, number of bytes, bytes, as the journal of
the study has them.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import queue
import shutil
import signal
import struct
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any, BinaryIO

import cloudpickle
import study_runs
from dask import config
from dask.distributed import Client, Future, LocalCluster, WorkerPlugin, get_worker
from fmpy import extract
from study_runs import Plan, RunError, Runner

WAITING = 4
"""Chunks of each worker that are under way."""
FAILURES = 20
"""Workers that a chunk may lose before it is given up."""
FATAL = 2**64 - 1
"""Number of a chunk that stands for an error."""


class Study(WorkerPlugin):
    """The FMU and the plan on each worker, also on those that come later."""

    name = "linkage-fmu-study"

    def __init__(self, fmu: bytes, plan: Plan) -> None:
        self.fmu = fmu
        self.plan = plan

    def setup(self, worker: Any) -> None:  # noqa: ANN401
        """Unpack the FMU."""
        self.folder = Path(tempfile.mkdtemp(prefix="linkage-fmu-"))
        packed = self.folder / "study.fmu"
        packed.write_bytes(self.fmu)
        extract(str(packed), str(self.folder / "fmu"))
        self.runners = threading.local()

    def teardown(self, worker: Any) -> None:  # noqa: ANN401
        """Remove the extracted files."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def runner(self) -> Runner:
        """The instance of this thread."""
        if not hasattr(self.runners, "own"):
            self.runners.own = Runner(self.folder / "fmu", self.plan)
        return self.runners.own


def make(name: str, runs: int, data: bytes) -> bytes:
    """Make the runs of a chunk; its bytes."""
    runner = get_worker().plugins[name].runner()
    factors, columns = len(runner.plan["factors"]), runner.plan["columns"]
    numbers, remarks = bytearray(), bytearray()
    for index in range(runs):
        point = struct.unpack_from(f"<{factors}d", data, 8 * factors * index)
        values, failed = [math.nan] * columns, False
        try:
            remark = runner.run(point, values)
        except RunError as error:
            values, remark, failed = [math.nan] * columns, str(error), True
        numbers += struct.pack(f"<{factors + columns}d", *point, *values)
        if failed or remark:
            text = remark.encode()
            remarks += struct.pack("<IBI", index, failed, len(text)) + text
    return bytes(numbers + remarks)


def read(file: BinaryIO, count: int) -> bytes | None:
    """So many bytes; none at the end of the file."""
    data = file.read(count)
    return data if len(data) == count else None


def submit(
    client: Client, plugin: Study, room: threading.Semaphore, done: queue.Queue[tuple[int, Future] | None]
) -> None:
    """Hand all chunks of the standard input to the cluster; `done` has each that is made, and None at the end."""
    under_way = 0
    finished = threading.Semaphore(0)
    factors = len(plugin.plan["factors"])

    def put(chunk: int, future: Future) -> None:
        done.put((chunk, future))
        finished.release()

    while (head := read(sys.stdin.buffer, 12)) is not None:
        chunk, runs = struct.unpack("<QI", head)
        data = read(sys.stdin.buffer, 8 * factors * runs)
        if data is None:
            break
        room.acquire()
        future = client.submit(make, plugin.name, runs, data, pure=False)
        future.add_done_callback(lambda future, chunk=chunk: put(chunk, future))
        under_way += 1
    for _ in range(under_way):
        finished.acquire()
    done.put(None)


def main() -> None:
    """Read the arguments, make all chunks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("fmu", type=Path)
    parser.add_argument("plan", type=Path)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--scheduler")
    arguments = parser.parse_args()
    # The program that reads the chunks ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # What anything here prints must not stand among the chunks.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    # Workers of another machine do not have the module.
    cloudpickle.register_pickle_by_value(study_runs)
    config.set({"distributed.scheduler.allowed-failures": FAILURES})
    cluster = None
    if arguments.scheduler is None:
        cluster = LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None)
    client = Client(cluster if cluster is not None else arguments.scheduler)
    plugin = Study(arguments.fmu.read_bytes(), json.loads(arguments.plan.read_text(encoding="utf-8")))
    client.register_plugin(plugin)
    done: queue.Queue[tuple[int, Future] | None] = queue.Queue()
    workers = arguments.workers or max(sum(client.nthreads().values()), 1)
    room = threading.Semaphore(WAITING * workers)
    threading.Thread(target=submit, args=(client, plugin, room, done), daemon=True).start()
    while (made := done.get()) is not None:
        chunk, future = made
        try:
            data = future.result()
        except Exception as error:
            chunk, data = FATAL, f"chunk {chunk}: {error}".encode()
        out.write(struct.pack("<QQ", chunk, len(data)) + data)
        out.flush()
        future.release()
        room.release()
    client.close()
    if cluster is not None:
        cluster.close()


if __name__ == "__main__":
    main()
