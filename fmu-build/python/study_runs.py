"""The runs of a study by the functions of a packed FMU; the same arithmetic as in `cargo fmu sweep`.

FMPy loads the library and makes the instance. The functions are then called directly, each bound to arguments that
lie ready in memory, which costs a fraction of a call by FMPy: that converts the arguments of each and can log it.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p
from functools import partial
from pathlib import Path
from typing import Any

import fmpy
from fmpy import fmi2, logging, read_model_description

JUST_AFTER = 64.0 * sys.float_info.epsilon
"""Relative distance after an event at which its state is searched first."""
HALVINGS = 1100
"""Largest number of steps in the search for an event."""
CLOSE = 1e-9
"""Relative difference below which two times count as equal."""
WARNING = 1
"""Largest status with which a function has done its task."""
ERROR = 3
"""Status of a function that returned an error."""
FATAL = 4
"""Status after which the instance can only be freed."""

Plan = dict[str, Any]
Call = Callable[[], int]
"""A function of the FMU bound to its arguments. It returns its status."""


class RunError(Exception):
    """The reason why a run failed."""


class FaultError(RunError):
    """The run failed because of a fault of the FMU. The instance is lost."""

    def __init__(self) -> None:
        super().__init__("an internal fault stopped the run; please report it")


def is_close(a: float, b: float) -> bool:
    """Whether two times are equal except for rounding."""
    return a == b or abs(a - b) <= CLOSE * max(abs(a), abs(b))


TYPES: dict[str, tuple[str, type]] = {
    "real": ("Real", c_double),
    "boolean": ("Boolean", c_int),
    "text": ("Integer", c_int),
}
"""Names of the types in function names, and the types of their values in C."""


def logger() -> tuple[Any, dict[int, list[str]]]:
    """The one logger of this process, and the messages of each instance by the environment that it hands back.

    FMPy knows one logger in a process, and each study brings a copy of this module: all share what stands in FMPy's.
    """
    shared = vars(fmpy)
    logs: dict[int, list[str]] = shared.setdefault("linkage_fmu_logs", {})

    def keep(instance: int | None, _name: bytes, _status: int, _category: bytes, message: bytes) -> None:
        if (log := logs.get(instance or 0)) is not None:
            log.append(message.decode())

    if "linkage_fmu_logger" not in shared:
        shared["linkage_fmu_logger"] = fmi2.fmi2CallbackLoggerTYPE(keep)
    return shared["linkage_fmu_logger"], logs


class Variables:
    """Variables of one type with memory for their values, which one call sets or reads."""

    def __init__(self, instance: Instance, kind: str, references: Iterable[int]) -> None:
        name, c_type = TYPES[kind]
        listed = list(references)
        self.values = (c_type * len(listed))()
        arguments = (c_uint * len(listed))(*listed), c_size_t(len(listed)), self.values
        self.set = instance.bound(f"Set{name}", *arguments)
        self.get = instance.bound(f"Get{name}", *arguments)


class Instance:
    """One instance of the FMU."""

    def __init__(self, folder: Path) -> None:
        self.log: list[str] = []
        own_logger, self.logs = logger()
        self.logs[id(self)] = self.log
        description = read_model_description(folder)
        enumerations = [variable for variable in description.modelVariables if variable.type == "Enumeration"]
        self.enumerations = {variable.valueReference: variable for variable in enumerations}
        self.fmu = fmi2.FMU2Slave(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="study",
        )
        self.callbacks = fmi2.fmi2CallbackFunctions()
        self.callbacks.logger = own_logger
        self.callbacks.componentEnvironment = id(self)
        self.callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        self.callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        logging.addLoggerProxy(byref(self.callbacks))
        self.fmu.instantiate(callbacks=self.callbacks)
        self.component = c_void_p(self.fmu.component)

    def bound(self, name: str, *arguments: Any) -> Call:  # noqa: ANN401
        """A function bound to its arguments, which must be values of C."""
        function = self.fmu.dll[f"fmi2{name}"]
        function.restype = c_int
        return partial(function, self.component, *arguments)

    def setting(self, kind: str, references: list[int], values: list[Any]) -> Call:
        """Function that sets variables, or the slopes of inputs for the next step, to these values."""
        if kind == "slope":
            count = len(references)
            arguments = (c_uint * count)(*references), c_size_t(count), (c_int * count)(*[1] * count)
            return self.bound("SetRealInputDerivatives", *arguments, (c_double * count)(*values))
        variables = Variables(self, kind, references)
        if kind == "text":
            numbers = [self.items(reference).get(word, 0) for reference, word in zip(references, values, strict=True)]
            if 0 in numbers:
                unknown = numbers.index(0)
                return partial(self.refuse, references[unknown], values[unknown])
            values = numbers
        variables.values[:] = values
        return variables.set

    def items(self, reference: int) -> dict[str, int]:
        """Numbers of the items of an Enumeration by their names."""
        return {item.name: int(item.value) for item in self.enumerations[reference].declaredType.items}

    def refuse(self, reference: int, word: str) -> int:
        """Status for a text that is no item of an Enumeration. The log contains the reason in the words of the FMU."""
        allowed = " or ".join(f'"{item}"' for item in self.items(reference))
        self.log.append(f'fmi2SetInteger: {self.enumerations[reference].name} = "{word}": must be {allowed}')
        return ERROR

    def why(self) -> str:
        """The last message of the FMU without the name of the function."""
        return self.log[-1].partition(": ")[2] if self.log else "the FMU gave no reason"

    def do(self, call: Call, what: str) -> None:
        """Make a call. If it returns an error, the reason with the prefix `what` is raised."""
        status = call()
        if status > WARNING:
            if status == FATAL:
                raise FaultError
            raise RunError(f"{what}: {self.why()}" if what else self.why())


class State:
    """A saved state of the FMU, whose memory is used repeatedly."""

    def __init__(self, instance: Instance) -> None:
        self.handle = c_void_p()
        self.keep = instance.bound("GetFMUstate", byref(self.handle))
        self.restore = instance.bound("SetFMUstate", self.handle)


class Step:
    """A step of the plan, with all values that are set before it."""

    def __init__(self, instance: Instance, entry: Plan) -> None:
        self.start, self.end, self.label = entry["start"], entry["end"], entry["label"]
        self.end_label = entry["end_label"]
        self.what = f"step at {self.label} s"
        self.settings = [instance.setting(*setting) for setting in entry["settings"]]
        self.instance = instance
        self.whole = self.of(self.end - self.start)

    def of(self, h: float) -> Call:
        """A step of length h [s] from the same start."""
        return self.instance.bound("DoStep", c_double(self.start), c_double(h), c_int(1))


class Event:
    """A condition that an impact makes true: number of impacts since the start, and time of the last impact."""

    def __init__(self, instance: Instance, entry: Plan) -> None:
        self.name = entry["name"]
        self.counted, self.timed = (Variables(instance, "real", [entry[key]]) for key in ("count", "time"))

    def count(self) -> float:
        """The number of impacts since the start."""
        self.counted.get()
        return self.counted.values[0]

    def time(self) -> float:
        """Time of the last impact [s]."""
        self.timed.get()
        return self.timed.values[0]


class Factors:
    """Factors of one type that one call sets."""

    def __init__(self, instance: Instance, entry: list[Any]) -> None:
        self.kind, self.indices, self.references, self.names, self.texts = entry
        self.variables = Variables(instance, self.kind, self.references)
        self.instance = instance

    def take(self, point: tuple[float, ...]) -> Call:
        """Function that sets the values of a run."""
        values = [point[index] for index in self.indices]
        if self.kind != "real":
            for name, value in zip(self.names, values, strict=True):
                if math.isnan(value):
                    raise RunError(f"{name} has no value")
            if self.kind == "text":
                words = [texts[int(value)] for texts, value in zip(self.texts, values, strict=True)]
                return self.instance.setting(self.kind, self.references, words)
            values = [bool(value) for value in values]
        self.variables.values[:] = values
        return self.variables.set


class Runner:
    """One instance of the FMU for many runs. No run depends on previous runs."""

    def __init__(self, folder: Path, plan: Plan) -> None:
        self.plan = plan
        self.instance = instance = Instance(folder)
        self.start = [instance.setting(*setting) for setting in plan["start"]]
        self.factors = [Factors(instance, call) for call in plan["calls"]]
        self.initialize = instance.bound("ExitInitializationMode")
        self.steps = [Step(instance, step) for step in plan["steps"]]
        self.stop_at = Event(instance, plan["stop_at"]) if plan["stop_at"] is not None else None
        self.events = []
        responses = plan["responses"]
        for index, event in enumerate(plan["events"]):
            own = [r["column"] for r in responses if r["measure"] == "event" and r["event"] == index]
            same = self.stop_at if event == plan["stop_at"] else None
            self.events.append((same or Event(instance, event), own))
        self.observed = [
            (response, Variables(instance, "boolean" if response["is_boolean"] else "real", [response["reference"]]))
            for response in responses
            if response["measure"] != "event"
        ]
        self.fresh, self.before = State(instance), State(instance)
        self.is_fresh_kept = False

    def renew(self) -> None:
        """Restore the FMU as it is before the values of the factors are set."""
        if self.is_fresh_kept:
            self.instance.do(self.fresh.restore, "the state before a run")
            return
        self.instance.fmu.setupExperiment(startTime=0.0)
        for setting in self.start:
            self.instance.do(setting, "start values")
        self.instance.fmu.enterInitializationMode()
        self.instance.do(self.fresh.keep, "the state before a run")
        self.is_fresh_kept = True

    def run(self, point: tuple[float, ...], values: list[float]) -> str:
        """Make the run with these values of the factors. Returns remarks about the run."""
        instance, reads, stop_at, stopped = self.instance, bool(self.observed), self.stop_at, False
        if instance.log:
            instance.log.clear()
        self.renew()
        for factors in self.factors:
            instance.do(factors.take(point), "")
        instance.do(self.initialize, "initialisation at 0 s")
        self.undefined = ""
        if reads:
            self.sums, self.time = [[0.0, 0.0] for _ in self.observed], 0.0
            self.observe(values, 0.0, "at 0 s", True, False)
        has_events, last = stop_at is not None or bool(self.events), self.steps[-1]
        for step in self.steps:
            for setting in step.settings:
                instance.do(setting, f"inputs at {step.label} s")
            if has_events:
                self.before.keep()
            self.make(step, step.whole)
            end, label, first_time = step.end, "", None
            if stop_at is not None and stop_at.count() != 0.0:
                stopped, end, label = True, self.time_of(stop_at, step), "at the impact (scenario.stop_at)"
                first_time = end
            self.find_events(step, first_time, end, values)
            if stopped and reads:
                self.step_to(stop_at, step, end)
            if reads:
                self.observe(values, end, label or f"at {step.end_label} s", False, stopped or step is last)
            if stopped:
                break
        missed = ""
        if stop_at is not None and not stopped:
            stop = self.plan["stop_label"]
            missed = f"the output {stop_at.name} (scenario.stop_at) did not become true within {stop} s"
        return "; ".join(remark for remark in (missed, self.undefined) if remark)

    def make(self, step: Step, call: Call) -> None:
        """Make a step from the start of `step`."""
        self.instance.do(call, step.what)

    def find_events(self, step: Step, first_time: float | None, end: float, values: list[float]) -> None:
        """Report the times of events that occur first in this step, until `end` [s]. `first_time`: time of the event
        that ends the run, if it occurs."""
        for event, own in self.events:
            if event is self.stop_at:
                time = first_time
            elif not all(math.isnan(values[column]) for column in own) or event.count() == 0.0:
                continue
            else:
                time = self.time_of(event, step)
            if time is not None and time <= end:
                for column in own:
                    values[column] = time

    def time_of(self, event: Event, step: Step) -> float:
        """Time of the first impact of an event that occurred in this completed step [s]."""
        if event.count() == 1.0:
            return event.time()
        without, met = 0.0, step.end - step.start
        time = step.start + met
        for _ in range(HALVINGS):
            h = 0.5 * (without + met)
            if h <= without or h >= met:
                time = step.start + met
                break
            self.before.restore()
            self.make(step, step.of(h))
            count = event.count()
            if count == 0.0:
                without = h
            elif count == 1.0:
                time = event.time()
                break
            else:
                met = h
        self.before.restore()
        self.make(step, step.whole)
        return time

    def step_to(self, event: Event, step: Step, time: float) -> None:
        """Bring the FMU into the state just after an event, which occurred in this completed step at `time` [s]."""
        whole = step.end - step.start
        later = JUST_AFTER * max(abs(time), sys.float_info.min)
        while True:
            h = (time + later) - step.start
            self.before.restore()
            if h >= whole:
                self.make(step, step.whole)
                return
            self.make(step, step.of(h))
            if event.count() > 0.0:
                return
            later *= 2.0

    def observe(self, values: list[float], time: float, label: str, is_first: bool, is_last: bool) -> None:
        """Read the FMU at a time [s]."""
        for (response, variable), sums in zip(self.observed, self.sums, strict=True):
            measure, column = response["measure"], response["column"]
            if measure == "final" and not is_last:
                continue
            if measure == "course" and not any(is_close(instant, time) for instant in response["times"]):
                continue
            self.instance.do(variable.get, "")
            value = float(variable.values[0])
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
        self.instance.fmu.freeInstance()
        self.instance.logs.pop(id(self.instance), None)
