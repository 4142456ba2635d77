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
from ctypes import byref
from pathlib import Path
from typing import Any, BinaryIO

import fmpy
from dask import config
from dask.distributed import Client, Future, LocalCluster, WorkerPlugin, get_worker
from fmpy import extract, fmi2, logging, read_model_description
from fmpy.fmi1 import FMICallException

WAITING = 4
"""Chunks of each worker that are under way."""
FAILURES = 20
"""Workers that a chunk may lose before it is given up."""
HALVINGS = 1100
"""Most steps that the search for an event takes."""
CLOSE = 1e-9
"""Relative difference below which two instants are one."""
FATAL = 2**64 - 1
"""Number of a chunk that stands for an error."""

Plan = dict[str, Any]


def is_close(a: float, b: float) -> bool:
    """Whether two instants are one but for rounding."""
    return a == b or abs(a - b) <= CLOSE * max(abs(a), abs(b))


class RunError(Exception):
    """Why a run failed."""


class Runner:
    """One instance of the FMU, run again and again; the same arithmetic as in `cargo fmu sweep`."""

    def __init__(self, folder: Path, plan: Plan) -> None:
        self.plan = plan
        self.log: list[str] = []
        description = read_model_description(folder)
        self.fmu = fmi2.FMU2Slave(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="study",
        )
        self.callbacks = fmi2.fmi2CallbackFunctions()
        self.callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(lambda *message: self.log.append(message[-1].decode()))
        self.callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        self.callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        logging.addLoggerProxy(byref(self.callbacks))
        self.fmu.instantiate(callbacks=self.callbacks)

    def why(self) -> str:
        """What the FMU said last, without the name of the function."""
        return self.log[-1].partition(": ")[2] if self.log else "the FMU gave no reason"

    def set(self, reference: int, kind: str, value: float | bool | str) -> None:
        """Set a variable, or the slope of an input for the next step."""
        if kind == "real":
            self.fmu.setReal([reference], [value])
        elif kind == "slope":
            self.fmu.setRealInputDerivatives([reference], [1], [value])
        elif kind == "boolean":
            self.fmu.setBoolean([reference], [bool(value)])
        else:
            self.fmu.setString([reference], [value])

    def get(self, reference: int, is_boolean: bool = False) -> float:
        """Present value of a variable."""
        read = self.fmu.getBoolean if is_boolean else self.fmu.getReal
        return float(read([reference])[0])

    def guarded(self, what: str, function: Any, *arguments: Any) -> Any:  # noqa: ANN401
        """Call a function of the FMU; an error is told with `what` before it."""
        self.log.clear()
        try:
            return function(*arguments)
        except FMICallException:
            raise RunError(f"{what}: {self.why()}" if what else self.why()) from None

    def run(self, point: tuple[float, ...], values: list[float]) -> str:
        """Make the run with these values of the factors; what is unusual about it."""
        plan = self.plan
        self.fmu.reset()
        self.fmu.setupExperiment(startTime=0.0)
        for reference, name, kind, value in plan["start"]:
            self.guarded(f"start value of {name}", self.set, reference, kind, value)
        for (reference, name, kind, texts), value in zip(plan["factors"], point, strict=True):
            setting = texts[int(value)] if kind == "text" else value
            self.guarded(name, self.set, reference, kind, setting)
        self.fmu.enterInitializationMode()
        self.guarded("initialisation at 0 s", self.fmu.exitInitializationMode)
        self.sums = [[0.0, 0.0] for _ in plan["responses"]]
        self.time = 0.0
        self.undefined = ""
        reads = any(response["measure"] != "event" for response in plan["responses"])
        if reads:
            self.observe(values, 0.0, "at 0 s", True, False)
        stop_at, stopped = plan["stop_at"], False
        events = stop_at is not None or plan["events"]
        for index, step in enumerate(plan["steps"]):
            for reference, kind, value in step["settings"]:
                self.guarded(f"inputs at {step['label']} s", self.set, reference, kind, value)
            before = self.fmu.getFMUstate() if events else None
            try:
                self.step(step, step["end"] - step["start"])
                end, label = step["end"], f"at {step['end_label']} s"
                if stop_at is not None and self.count(stop_at) != 0.0:
                    stopped, end, label = True, self.time_of(stop_at, step, before), "at the event"
                self.find_events(step, before, end, values)
                if stopped and reads:
                    self.step_to(stop_at, step, before, end)
            finally:
                if before is not None:
                    self.fmu.freeFMUstate(before)
            if reads:
                self.observe(values, end, label, False, stopped or index + 1 == len(plan["steps"]))
            if stopped:
                break
        missed = f"{stop_at['name']} did not come true within {plan['stop_label']} s" if stop_at and not stopped else ""
        return "; ".join(remark for remark in (missed, self.undefined) if remark)

    def step(self, step: Plan, h: float) -> None:
        """A step of this length from the beginning of `step` on."""
        self.guarded(f"step at {step['label']} s", self.fmu.doStep, step["start"], h)

    def count(self, event: Plan) -> float:
        """The number of impacts since the start."""
        return self.get(event["count"])

    def back(self, before: Any) -> None:  # noqa: ANN401
        """Back to the state at the beginning of the step."""
        self.fmu.setFMUstate(before)

    def find_events(self, step: Plan, before: Any, end: float, values: list[float]) -> None:  # noqa: ANN401
        """Tell the times of events that this step is the first to meet, until `end` [s]."""
        for index, event in enumerate(self.plan["events"]):
            responses = self.plan["responses"]
            own = [r["column"] for r in responses if r["measure"] == "event" and r["event"] == index]
            if not all(math.isnan(values[column]) for column in own) or self.count(event) == 0.0:
                continue
            time = self.time_of(event, step, before)
            if time <= end:
                for column in own:
                    values[column] = time

    def time_of(self, event: Plan, step: Plan, before: Any) -> float:  # noqa: ANN401
        """Time of the first impact of an event that this step, which is made, has met [s]."""
        if self.count(event) == 1.0:
            return self.get(event["time"])
        without, met = 0.0, step["end"] - step["start"]
        time = step["start"] + met
        for _ in range(HALVINGS):
            h = 0.5 * (without + met)
            if h <= without or h >= met:
                time = step["start"] + met
                break
            self.back(before)
            self.step(step, h)
            count = self.count(event)
            if count == 0.0:
                without = h
            elif count == 1.0:
                time = self.get(event["time"])
                break
            else:
                met = h
        self.back(before)
        self.step(step, step["end"] - step["start"])
        return time

    def step_to(self, event: Plan, step: Plan, before: Any, time: float) -> None:  # noqa: ANN401
        """Put the FMU into the state just after an event of this step, which is made and met it at `time` [s]."""
        whole = step["end"] - step["start"]
        later = 0.0
        while True:
            h = (time + later) - step["start"]
            self.back(before)
            if h >= whole:
                self.step(step, whole)
                return
            if h > 0.0:
                self.step(step, h)
                if self.count(event) > 0.0:
                    return
            later = max(2.0 * later, max(abs(time), sys.float_info.min) * sys.float_info.epsilon)

    def observe(self, values: list[float], time: float, label: str, is_first: bool, is_last: bool) -> None:
        """Read the FMU at an instant [s]."""
        for response, sums in zip(self.plan["responses"], self.sums, strict=True):
            measure, column = response["measure"], response["column"]
            if measure == "event" or (measure == "final" and not is_last):
                continue
            if measure == "course" and not any(is_close(instant, time) for instant in response["times"]):
                continue
            value = self.guarded("", self.get, response["reference"], response["is_boolean"])
            if math.isnan(value) and not self.undefined:
                self.undefined = f"{response['name']} has no value {label}"
            if measure == "final":
                values[column] = value
            elif measure == "extreme":
                sign = response["sign"]
                if is_first or math.isnan(value) or sign * value > sign * values[column]:
                    values[column : column + 2] = [value, math.nan if math.isnan(value) else time]
            elif measure == "course":
                for place, instant in enumerate(response["times"], column):
                    if is_close(instant, time):
                        values[place] = value
            else:
                is_square = measure == "root_mean_square"
                size = value * value if is_square else value
                if not is_first:
                    sums[1] += 0.5 * (sums[0] + size) * (time - self.time)
                sums[0] = size
                if is_last:
                    values[column] = math.sqrt(sums[1] / time) if is_square else sums[1]
        self.time = time

    def close(self) -> None:
        """Free the instance."""
        self.fmu.freeInstance()


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
