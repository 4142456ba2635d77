"""This project's FMU, called from Python through FMI's C functions as a host calls it."""

from __future__ import annotations

import ctypes
import time
import zipfile
from collections.abc import Iterator
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from xml.etree import ElementTree

from four_bar import EXACT, SPAN
from measure import Point, fastest

TOOL = "linkage-fmu"
METHOD = "FMU; C functions from Python"
OUTPUT = "crank.angle"
OK, CO_SIMULATION = 0, 1


class Fmu:
    """One instance of a packed FMU in its initial state, with the given tolerance."""

    def __init__(self, folder: Path, tolerance: float) -> None:
        description = ElementTree.parse(folder / "modelDescription.xml").getroot()
        variable = description.find(f"ModelVariables/ScalarVariable[@name='{OUTPUT}']")
        if variable is None:
            raise RuntimeError(f"{folder}: no variable {OUTPUT}")
        (library,) = (path for path in (folder / "binaries").glob("*/*") if path.is_file())
        self.library = ctypes.CDLL(str(library))
        instantiate = self.library.fmi2Instantiate
        instantiate.restype = c_void_p
        callbacks = (c_void_p * 5)()
        guid, resources = description.attrib["guid"].encode(), (folder / "resources").as_uri().encode()
        self.instance = c_void_p(
            instantiate(c_char_p(b"peer"), c_int(CO_SIMULATION), c_char_p(guid), c_char_p(resources), callbacks, 0, 0)
        )
        self.call("fmi2SetupExperiment", c_int(1), c_double(tolerance), c_double(0.0), c_int(0), c_double(0.0))
        self.call("fmi2EnterInitializationMode")
        self.call("fmi2ExitInitializationMode")
        self.start = c_void_p()
        self.call("fmi2GetFMUstate", byref(self.start))
        self.reference, self.value = c_uint(int(variable.attrib["valueReference"])), c_double()

    def call(self, name: str, *arguments: object) -> None:
        """Call one function of FMI; any status but fmi2OK is an error."""
        if getattr(self.library, name)(self.instance, *arguments) != OK:
            raise RuntimeError(f"{name} failed")

    def run(self) -> float:
        """Restore the initial state and make one step to the end; returns the angle there [rad]."""
        self.call("fmi2SetFMUstate", self.start)
        self.call("fmi2DoStep", c_double(0.0), c_double(SPAN), c_int(1))
        self.call("fmi2GetReal", byref(self.reference), c_size_t(1), byref(self.value))
        return self.value.value

    def close(self) -> None:
        """Free the instance."""
        self.call("fmi2FreeFMUstate", byref(self.start))
        self.library.fmi2FreeInstance(self.instance)


def points(archive: Path, work: Path) -> Iterator[Point]:
    """The curve."""
    folder = work / archive.stem
    with zipfile.ZipFile(archive) as packed:
        packed.extractall(folder)
    for half in range(4, 27):
        tolerance = 10 ** (-half / 2)
        began = time.perf_counter()
        fmu = Fmu(folder, tolerance)
        setup = time.perf_counter() - began
        angle, seconds = fastest(fmu.run)
        fmu.close()
        yield Point("S1", TOOL, METHOD, f"tolerance {tolerance:.1e}", abs(angle - EXACT), seconds, setup)
