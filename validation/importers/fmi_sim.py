"""Drive the packed landing gear with fmi-sim, a program in Rust from the crate of this name on crates.io.

For FMI 3.0 it runs a copy of the FMU whose description omits what release 0.7.0 does not read: attributes of Float64
variables such as units and nominal values, which its parser rejects as unknown, and vectors, which it reads as scalars.
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
"""Environment variable with the path of the program."""
UNREAD = ("quantity", "unit", "displayUnit", "relativeQuantity", "unbounded", "nominal")
"""Attributes of Float64 variables (FMI 3.0.2, 2.4.7.3) that fmi-sim rejects."""
EVENT = 0.13205985274425970
"""Time at which the gear reaches the up stop, by quadrature [s]."""
ALLOWED_EVENT = 1e-12
"""Allowed error of that time [s]."""
EULER = (1e-4, 1e-5)
"""Step sizes of model exchange by Euler's method [s]."""
ALLOWED_RATIO = 0.05
"""Allowed relative deviation of the ratio of both errors from the ratio of the steps."""

Table = list[dict[str, float]]


def program() -> Path | None:
    """Path of the program; None if it is not installed."""
    path = os.environ.get(PROGRAM)
    return Path(path) if path else None


def version() -> str:
    """Version of the program. fmi-sim prints it where it prints errors."""
    done = subprocess.run([str(program()), "--version"], capture_output=True, text=True)
    return re.search(r"\d+\.\d+\.\d+", done.stdout + done.stderr).group(0)


def understood(fmu: Path, folder: Path) -> Path:
    """In a folder, a copy of an FMU of FMI 3.0 whose description fmi-sim can read; an FMU of FMI 2.0 is not changed."""
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
    """One run: the outputs at each communication point. `signal` is a CSV table of inputs over time."""
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
    """Whether a cell contains a number, rather than a Boolean or the name of an item."""
    return re.match(r"-?(\d|NaN|inf)", text) is not None


def refusal(fmu: Path) -> str:
    """What fmi-sim prints for the FMU as it is packed."""
    command = [str(program()), "--model", str(fmu), "--output-file", os.devnull, "co-simulation"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300.0)
    assert done.returncode != 0, f"fmi-sim takes {fmu.name} as it is: leave `understood` out"
    return re.search(r"Error: (.*)", done.stderr).group(1)


def section(fmu: Path, angle: float) -> tuple[list[str], bool]:
    """The report's lines about event mode and model exchange in FMI 3.0, and whether all results are correct. `angle`:
    angle of the crank at 0.13 s by quadrature [rad]."""
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
        f"- Event mode with early return: the gear reaches the up stop at {before['time']:.16f} s, {event:.0e} s"
        f" from the quadrature (at most {ALLOWED_EVENT:.0e} s",
        f"  is allowed). The speed is {before['crank.speed']:.6f} rad/s before the impact, and 0 after it.",
        f"- Model exchange by its only solver, Euler's method of first order: the error at 0.13 s is {off[0]:.3e}"
        f" rad with steps of {EULER[0]:g} s,",
        f"  and {off[1]:.3e} rad with steps of {EULER[1]:g} s.",
    ]
    return lines, holds
