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
import time
import uuid
from pathlib import Path
from typing import Any, BinaryIO

import cloudpickle
import study_runs
from dask import config
from dask.distributed import Client, Future, LocalCluster, WorkerPlugin, get_worker
from fmpy import extract
from study_runs import FaultError, Plan, RunError, Runner

WAITING = 4
"""Chunks of each worker that are under way."""
FAILURES = 20
"""Workers that a chunk may lose before it is given up."""
FATAL = 2**64 - 1
"""Number of a chunk that stands for an error."""


LOOK = 1.0
"""Time between two looks at the number of workers and at the wish to stop [s]."""


class Study(WorkerPlugin):
    """The FMU and the plan on each worker, also on those that come later."""

    def __init__(self, fmu: bytes, plan: Plan) -> None:
        # Several studies may share a scheduler.
        self.name = f"linkage-fmu-study-{uuid.uuid4().hex}"
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

    def forget_runner(self) -> None:
        """Another instance for the next run of this thread: this one is lost."""
        del self.runners.own


def make(name: str, runs: int, data: bytes) -> bytes:
    """Make the runs of a chunk; its bytes."""
    study = get_worker().plugins[name]
    factors, columns = study.plan["factors"], study.plan["columns"]
    numbers, remarks = bytearray(), bytearray()
    for index in range(runs):
        point = struct.unpack_from(f"<{factors}d", data, 8 * factors * index)
        values, failed = [math.nan] * columns, False
        try:
            remark = study.runner().run(point, values)
        except RunError as error:
            values, remark, failed = [math.nan] * columns, str(error), True
            if isinstance(error, FaultError):
                study.forget_runner()
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
    factors = plugin.plan["factors"]

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
    workers = max(threads_of(client), 1)
    room = threading.Semaphore(WAITING * workers)
    threading.Thread(target=submit, args=(client, plugin, room, done), daemon=True).start()
    try:
        hand_back(client, arguments.plan, (workers, room, done), out)
    finally:
        client.unregister_worker_plugin(plugin.name)
        client.close()
        if cluster is not None:
            cluster.close()
    # A thread may still wait for chunks that nobody sends.
    os._exit(0)


def hand_back(
    client: Client,
    plan: Path,
    under_way: tuple[int, threading.Semaphore, queue.Queue[tuple[int, Future] | None]],
    out: BinaryIO,
) -> None:
    """Write the chunks that are made. The program that reads them removes the plan when it wants no more."""
    workers, room, done = under_way
    looked = time.monotonic()
    while plan.exists():
        if time.monotonic() > looked + LOOK:
            more, looked = threads_of(client) - workers, time.monotonic()
            if more > 0:
                workers += more
                room.release(WAITING * more)
        try:
            made = done.get(timeout=LOOK)
        except queue.Empty:
            continue
        if made is None:
            return
        chunk, future = made
        try:
            data = future.result()
        except Exception as error:
            chunk, data = FATAL, f"chunk {chunk}: {error}".encode()
        out.write(struct.pack("<QQ", chunk, len(data)) + data)
        out.flush()
        future.release()
        room.release()


def threads_of(client: Client) -> int:
    """Threads of all workers."""
    return sum(client.nthreads().values())


if __name__ == "__main__":
    main()
