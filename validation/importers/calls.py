"""The calls that an importer makes, recorded by `spy.c` between the importer and the FMU's library."""

from __future__ import annotations

import itertools
import os
import re
import subprocess
import zipfile
from pathlib import Path

from drivers import STEP


def spied(fmu: Path, work: Path) -> Path:
    """A copy of the FMU with `spy.c` in the place of its library."""
    spy = work / "spy.so"
    source = Path(__file__).with_name("spy.c")
    compiler = os.environ.get("CC", "cc")
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", str(spy), str(source), "-ldl"], check=True)
    path = work / "spied" / fmu.name
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(fmu) as original, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as copy:
        for entry in original.namelist():
            if entry.startswith("binaries/linux64/"):
                copy.writestr("binaries/linux64/original.so", original.read(entry))
                copy.write(spy, entry)
            else:
                copy.writestr(entry, original.read(entry))
    return path


class Trace:
    """The recorded calls of one run."""

    def __init__(self, path: Path) -> None:
        self.lines = path.read_text(encoding="utf-8").splitlines()

    def names(self) -> list[str]:
        """Names of the functions, in the order of the calls."""
        return [line.split()[0] for line in self.lines]

    def first(self, name: str) -> str | None:
        """The first call of a function; None if there is none."""
        return next((line for line in self.lines if line.split()[0] == name), None)

    def argument(self, function: str, key: str) -> str:
        """An argument of the first call of a function."""
        found = re.search(rf"\b{key}=(\S*)", self.first(function) or "")
        return found.group(1) if found else "not called"

    def location(self) -> str:
        """Form of the resource location, without the folder."""
        location = self.argument("fmi2Instantiate", "fmuResourceLocation")
        return re.sub(r"^(\w*:?/*).*/(resources/?)$", r"\1.../\2", location)

    def callbacks(self) -> str:
        """Members of the callbacks that are NULL."""
        members = ("logger", "allocateMemory", "freeMemory", "stepFinished", "componentEnvironment")
        null = [member for member in members if self.argument("fmi2Instantiate", member) == "NULL"]
        return ", ".join(null) or "none"

    def experiment(self) -> str:
        """Arguments of fmi2SetupExperiment."""
        if self.first("fmi2SetupExperiment") is None:
            return "not called"
        get = lambda key: self.argument("fmi2SetupExperiment", key)  # noqa: E731
        tolerance = f"tolerance {get('tolerance')}" if get("toleranceDefined") != "0" else "no tolerance"
        stop = f"stop time {get('stopTime')} s" if get("stopTimeDefined") != "0" else "no stop time"
        return f"start time {get('startTime')} s, {tolerance}, {stop}"

    def moved(self, verb: str, first: str | None, last: str) -> str:
        """Number of values set or read between the first calls of two functions."""
        names = self.names()
        begin = names.index(first) if first else 0
        calls = [line for line in self.lines[begin : names.index(last)] if line.startswith(f"fmi2{verb}")]
        calls = [line for line in calls if re.match(rf"fmi2{verb}(Real|Integer|Boolean|String) ", line)]
        if not calls:
            return "none"
        count = sum(int(re.search(r"n=(\d+)", line).group(1)) for line in calls)
        return f"{count} in {len(calls)} call{'s' if len(calls) > 1 else ''}"

    def step(self, number: int) -> str:
        """The functions called from the end of one step to the end of the next, with the number of values of each."""
        places = [i for i, name in enumerate(self.names()) if name == "fmi2DoStep"]
        shown = []
        for line in self.lines[places[number - 1] + 1 : places[number] + 1]:
            name, count = line.split()[0].removeprefix("fmi2"), re.search(r"\bn=(\d+)", line)
            shown.append(f"{name}({count.group(1)})" if count else name)
        groups = [(key, len(list(group))) for key, group in itertools.groupby(shown)]
        return ", ".join(f"{count} x {key}" if count > 1 else key for key, count in groups)

    def points(self) -> str:
        """How the communication points are computed, and the step sizes that occur."""
        calls = [line for line in self.lines if line.startswith("fmi2DoStep")]
        values = [tuple(map(float, re.findall(r"=(\S+)", line)[:2])) for line in calls]
        points, sizes = [point for point, _ in values], {size for _, size in values}
        products = [n * STEP for n in range(len(points))]
        sums = list(itertools.accumulate([0.0] + [STEP] * (len(points) - 1)))
        way = "n h" if points == products else "running sum" if points == sums else "neither n h nor a running sum"
        off = max(abs(point - product) for point, product in zip(points, products, strict=True))
        spread = (
            "h exact"
            if sizes == {STEP}
            else f"{len(sizes)} values of h within {max(abs(s - STEP) for s in sizes):.0e} s"
        )
        return f"{way}{f' (off n h by {off:.0e} s at most)' if off else ''}, {spread}"

    def ending(self) -> str:
        """The functions called after the last step, except those that read."""
        names = self.names()
        last = len(names) - 1 - names[::-1].index("fmi2DoStep")
        rest = [name.removeprefix("fmi2") for name in names[last + 1 :] if not name.startswith("fmi2Get")]
        return ", ".join(rest) or "nothing"

    def refused(self) -> list[str]:
        """Calls with another status than fmi2OK."""
        return [line for line in self.lines if re.search(r"-> (?!0$|instance$)", line)]
