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
from array import array
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import cloudpickle
import study_runs
from dask import config
from dask.distributed import Client, Future, LocalCluster, WorkerPlugin, get_worker
from fmpy import extract
from study_runs import FaultError, Plan, RunError, Runner

WAITING = 4
"""Number of pending tasks per worker."""
LASTING = 0.5
"""Approximate time of a task [s]: long compared with the scheduler's work for it, short compared with a study."""
MOST_CHUNKS = 64
"""Largest number of chunks of a task."""
MOST_BYTES = 1 << 20
"""Approximate largest size of the factor values in a task [B]."""
FAILURES = 20
"""Number of workers that a task may lose before it is given up."""
LOGGED = 20
"""Number of messages between client, scheduler and workers that are kept for debugging."""
FATAL = 2**64 - 1
"""Number of the chunk that represents an error."""
ANSWER = 30
"""Time limit for the answer of a scheduler [s]."""
Done = queue.Queue[tuple[list[int], Future] | None]
"""Completed batches with the numbers of their chunks. None after the last batch."""
LOOK = 1.0
"""Time between two checks of the number of workers and of the request to stop [s]."""


class Study(WorkerPlugin):
    """The FMU and the plan on each worker, also on workers that join later."""

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

    def replace_runner(self) -> None:
        """Create another instance for the next run of this thread, because this one is lost."""
        del self.runners.own


@dataclass
class Batch:
    """Chunks of one task. Their number follows from the intended time of a task."""

    chunks: list[int] = field(default_factory=list)
    work: list[tuple[int, bytes]] = field(default_factory=list)
    """Number of runs of each chunk, and the values of their factors."""

    def add(self, chunk: int, runs: int, data: bytes) -> None:
        """Add a chunk."""
        self.chunks.append(chunk)
        self.work.append((runs, data))

    def is_full(self, most: int) -> bool:
        """Whether the batch has the intended number of chunks, or the largest size."""
        return len(self.chunks) >= most or sum(len(data) for _, data in self.work) >= MOST_BYTES


class Pace:
    """Intended number of chunks of a task, from the measured time of previous tasks."""

    chunks = 1

    def learn(self, seconds: float, chunks: int) -> None:
        """State that this number of chunks took this time."""
        self.chunks = max(1, min(MOST_CHUNKS, int(LASTING * chunks / max(seconds, 1e-9))))


def make_all(name: str, work: list[tuple[int, bytes]]) -> tuple[float, list[bytes]]:
    """Make the runs of some chunks. Returns the time [s] and the bytes of each chunk."""
    began = time.monotonic()
    made = [make(name, runs, data) for runs, data in work]
    return time.monotonic() - began, made


def make(name: str, runs: int, data: bytes) -> bytes:
    """Make the runs of a chunk. Returns its bytes."""
    study = get_worker().plugins[name]
    factors, columns = study.plan["factors"], study.plan["columns"]
    empty = [math.nan] * columns
    numbers, remarks = array("d"), bytearray()
    for index, point in enumerate(struct.iter_unpack(f"<{factors}d", data) if factors else [()] * runs):
        values, failed = empty.copy(), False
        try:
            remark = study.runner().run(point, values)
        except RunError as error:
            values, remark, failed = empty, str(error), True
            if isinstance(error, FaultError):
                study.replace_runner()
        numbers.extend(point)
        numbers.extend(values)
        if failed or remark:
            text = remark.encode()
            remarks += struct.pack("<IBI", index, failed, len(text)) + text
    if sys.byteorder != "little":
        numbers.byteswap()
    return numbers.tobytes() + bytes(remarks)


def read(file: BinaryIO, count: int) -> bytes | None:
    """Read this number of bytes. None at the end of the file."""
    data = file.read(count)
    return data if len(data) == count else None


def submit(client: Client, plugin: Study, room: threading.Semaphore, pace: Pace, done: Done) -> None:
    """Submit all chunks of the standard input to the cluster. `done` receives each batch, and None at the end."""
    under_way = 0
    finished = threading.Semaphore(0)
    factors = plugin.plan["factors"]

    def put(chunks: list[int], future: Future) -> None:
        done.put((chunks, future))
        finished.release()

    def send(batch: Batch) -> None:
        nonlocal under_way
        room.acquire()
        future = client.submit(make_all, plugin.name, batch.work, pure=False)
        future.add_done_callback(partial(put, batch.chunks))
        under_way += 1

    batch = Batch()
    while (head := read(sys.stdin.buffer, 12)) is not None:
        chunk, runs = struct.unpack("<QI", head)
        data = read(sys.stdin.buffer, 8 * factors * runs)
        if data is None:
            break
        batch.add(chunk, runs, data)
        if batch.is_full(pace.chunks):
            send(batch)
            batch = Batch()
    if batch.chunks:
        send(batch)
    for _ in range(under_way):
        finished.acquire()
    done.put(None)


def main() -> None:
    """Read the arguments and make all chunks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("fmu", type=Path)
    parser.add_argument("plan", type=Path)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--scheduler")
    arguments = parser.parse_args()
    # The program that reads the chunks ends this program.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Printed text must not mix with the chunks.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    # Workers on other machines do not have this module.
    cloudpickle.register_pickle_by_value(study_runs)
    # The log of messages would keep the values of all factors.
    config.set({"distributed.scheduler.allowed-failures": FAILURES, "distributed.admin.low-level-log-length": LOGGED})
    cluster = None
    if arguments.scheduler is None:
        cluster = LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None)
    try:
        client = Client(cluster if cluster is not None else arguments.scheduler, timeout=ANSWER)
    except (OSError, ValueError) as error:
        if cluster is not None:
            raise
        reason = str(error).partition("\n")[0]
        message = (
            f"no Dask scheduler answers at {arguments.scheduler} within {ANSWER} s ({reason}); start a scheduler on "
            "that machine with `dask scheduler`, check the address and whether the port is open, or use --workers N "
            "for processes on this machine"
        )
        write_chunk(out, FATAL, message.encode())
        os._exit(1)
    plugin = Study(arguments.fmu.read_bytes(), json.loads(arguments.plan.read_text(encoding="utf-8")))
    client.register_plugin(plugin)
    done: Done = queue.Queue()
    workers, pace = max(threads_of(client), 1), Pace()
    room = threading.Semaphore(WAITING * workers)
    threading.Thread(target=submit, args=(client, plugin, room, pace, done), daemon=True).start()
    try:
        return_chunks(client, arguments.plan, (workers, room, pace, done), out)
    finally:
        client.unregister_worker_plugin(plugin.name)
        client.close()
        if cluster is not None:
            cluster.close()
    # A thread may still wait for chunks that no one sends.
    os._exit(0)


def return_chunks(
    client: Client, plan: Path, under_way: tuple[int, threading.Semaphore, Pace, Done], out: BinaryIO
) -> None:
    """Write the completed chunks. The program that reads them removes the plan to stop this program."""
    workers, room, pace, done = under_way
    looked = time.monotonic()
    while plan.exists():
        if time.monotonic() > looked + LOOK:
            more, looked = threads_of(client) - workers, time.monotonic()
            if more > 0:
                workers += more
                room.release(WAITING * more)
        try:
            batch = done.get(timeout=LOOK)
        except queue.Empty:
            continue
        if batch is None:
            return
        chunks, future = batch
        try:
            seconds, made = future.result()
            pace.learn(seconds, len(chunks))
        except Exception as error:
            chunks, made = [FATAL], [f"chunk {chunks[0]}: {error}".encode()]
        for chunk, data in zip(chunks, made, strict=True):
            write_chunk(out, chunk, data)
        future.release()
        room.release()


def write_chunk(out: BinaryIO, chunk: int, data: bytes) -> None:
    """Write the bytes of a chunk, or an error."""
    out.write(struct.pack("<QQ", chunk, len(data)) + data)
    out.flush()


def threads_of(client: Client) -> int:
    """Number of threads of all workers."""
    return sum(client.nthreads().values())


if __name__ == "__main__":
    main()
