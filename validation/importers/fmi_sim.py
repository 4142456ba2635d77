"""Drive the packed landing gear with fmi-sim, a program in Rust, of the crate of this name on crates.io.

Of an FMU of FMI 3.0 it gets a copy whose description leaves out what its release 0.7.0 does not read: units, nominal
values and the like of Float64 variables, which its parser refuses as unknown, and vectors, which it reads as one value.
The library and all scalars are those of the packed FMU.
"""

from __future__ import annotations

import csv
import itertools
import math
import os
import re
import subprocess
import tempfile
import zipfile
from pathlib import Path
from xml.etree import ElementTree

PROGRAM = "FMI_SIM"
"""Environment variable with the program's path."""
UNREAD = ("quantity", "unit", "displayUnit", "relativeQuantity", "unbounded", "nominal")
"""Attributes of Float64 variables (FMI 3.0.2, 2.4.7.3) that fmi-sim refuses."""
EVENT = 0.13205985274425970
"""Time at which the up stop is met, by quadrature [s]."""
ALLOWED_EVENT = 1e-12
"""Largest error of that time [s]."""
EULER = (1e-4, 1e-5)
"""Steps of model exchange by Euler's method [s]."""
ALLOWED_RATIO = 0.05
"""Largest deviation of the ratio of both errors from that of the steps, as a part of it."""

Table = list[dict[str, float]]


def program() -> Path | None:
    """The program, if there is one."""
    path = os.environ.get(PROGRAM)
    return Path(path) if path else None


def version() -> str:
    """Its version. The text stands where it tells errors."""
    done = subprocess.run([str(program()), "--version"], capture_output=True, text=True)
    return re.search(r"\d+\.\d+\.\d+", done.stdout + done.stderr).group(0)


def understood(fmu: Path, folder: Path) -> Path:
    """A copy of an FMU of FMI 3.0 in a folder, whose description has what fmi-sim reads; one of FMI 2.0 as it is."""
    with zipfile.ZipFile(fmu) as packed:
        description = ElementTree.fromstring(packed.read("modelDescription.xml"))
        if not description.get("fmiVersion").startswith("3."):
            return fmu
        variables, structure = description.find("ModelVariables"), description.find("ModelStructure")
        vectors = [variable for variable in variables if variable.find("Dimension") is not None]
        references = {vector.get("valueReference") for vector in vectors}
        for vector in vectors:
            variables.remove(vector)
        for unknown in [unknown for unknown in structure if unknown.get("valueReference") in references]:
            structure.remove(unknown)
        for variable in variables:
            for attribute in UNREAD:
                variable.attrib.pop(attribute, None)
        path = folder / fmu.name
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as copy:
            for entry in packed.namelist():
                is_description = entry == "modelDescription.xml"
                content = ElementTree.tostring(description, "utf-8") if is_description else packed.read(entry)
                copy.writestr(entry, content)
    return path


def run(fmu: Path, interface: str, *options: str, signal: str | None = None) -> Table:
    """One run; the outputs at each communication point. `signal` is a table of inputs over time, as CSV."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        out, table = folder / "outputs.csv", folder / "inputs.csv"
        command = [str(program()), "--model", str(understood(fmu, folder)), "--output-file", str(out)]
        if signal:
            table.write_text(signal, encoding="utf-8")
            command += ["--input-file", str(table)]
        done = subprocess.run([*command, interface, *options], capture_output=True, text=True, timeout=300.0)
        if done.returncode != 0:
            raise RuntimeError(f"fmi-sim ended with {done.returncode}: {done.stderr[:2000]}")
        with out.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    return [{name: float(text) for name, text in row.items() if is_number(text)} for row in rows]


def is_number(text: str) -> bool:
    """Whether a cell holds a number, not a Boolean or the name of an item."""
    return re.match(r"-?(\d|NaN|inf)", text) is not None


def refusal(fmu: Path) -> str:
    """What fmi-sim says of the FMU as it is packed."""
    command = [str(program()), "--model", str(fmu), "--output-file", os.devnull, "co-simulation"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300.0)
    assert done.returncode != 0, f"fmi-sim takes {fmu.name} as it is: leave `understood` out"
    return re.search(r"Error: (.*)", done.stderr).group(1)


def section(fmu: Path, angle: float) -> tuple[list[str], bool]:
    """The lines about event mode and model exchange in FMI 3.0, and whether all holds; `angle` is that of the crank at
    0.13 s by quadrature [rad]."""
    events = ("--event-mode-used", "--early-return-allowed", "--output-interval", "1e-3", "-f", "0.14")
    rows = run(fmu, "co-simulation", *events)
    before = next(row for row, later in itertools.pairwise(rows) if row["time"] == later["time"])
    event = abs(before["time"] - EVENT)
    off = []
    for step in EULER:
        end = run(fmu, "model-exchange", "--output-interval", f"{step:g}", "-f", "0.13")[-1]
        off.append(abs(end["crank.angle"] - angle))
    ratio = off[0] / off[1] / (EULER[0] / EULER[1])
    holds = event <= ALLOWED_EVENT and abs(ratio - 1.0) <= ALLOWED_RATIO and math.isfinite(ratio)
    lines = [
        f"- event mode with early return: the up stop is met at {before['time']:.16f} s, {event:.0e} s off the"
        f" quadrature (at most {ALLOWED_EVENT:.0e} s",
        f"  is allowed); the speed is {before['crank.speed']:.6f} rad/s before it, 0 after;",
        f"- model exchange by its only solver, Euler's method: {off[0]:.3e} rad off at 0.13 s with steps of"
        f" {EULER[0]:g} s,",
        f"  {off[1]:.3e} rad with {EULER[1]:g} s: the first order of that method.",
    ]
    return lines, holds
