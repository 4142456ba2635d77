"""Run the SSP package of the landing-gear system in libcosim and in ECOS: times of the events of a retraction and an
extension, compared with those of the demonstration's loop.

usage: system.py LandingGearSystem.ssp      prints a table for each communication step
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "fmu-build" / "python"))
import demo_system

END = 17.0
"""End of the run [s]: a retraction and an extension."""
STEPS = (1e-3, 2e-3, 5e-3)
"""Communication steps [s]."""

Times = dict[str, list[float]]


def events(states: Callable[[], list[bool]], advance: Callable[[int], None], step: float) -> Times:
    """Times of the events by their labels. `advance` makes a step after the levers of this step are set."""
    found: Times = {}
    before: list[bool] = []
    for i in range(round(END / step)):
        advance(i)
        now = states()
        # An observer has no values before the first step.
        for was, is_now, (*_, true, false) in zip(before or now, now, demo_system.STATES, strict=True):
            if was != is_now:
                found.setdefault(true if is_now else false, []).append(round((i + 1) * step, 9))
        before = now
    return found


def levers(i: int, step: float) -> dict[str, float]:
    """Inputs that the pilot sets before step i."""
    due = [inputs for at, _, inputs in demo_system.LEVERS if round(at / step) == i]
    return {name: value for inputs in due for name, value in inputs.items()}


def fmpy(package: Path, step: float) -> Times:
    """Times with the loop of the demonstration."""
    found: Times = {}
    for time, words in demo_system.run(package, step, END).events:
        if not words.startswith("--"):
            found.setdefault(words, []).append(time)
    return found


def cosim(package: Path, step: float) -> Times:
    """Times with libcosim through libcosimpy, fixed-step algorithm."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver

    execution = CosimExecution.from_ssp_file(str(package), step_size=round(step * 1e9))
    slaves = {part: execution.slave_index_from_instance_name(part) for part in ("gear", "door", "hydraulics")}
    references = {
        part: {variable.name.decode(): variable.reference for variable in execution.slave_variables(slave)}
        for part, slave in slaves.items()
    }
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    execution.add_observer(observer)
    assert execution.add_manipulator(manipulator)

    def states() -> list[bool]:
        read = observer.last_boolean_values
        return [bool(read(slaves[part], [references[part][name]])[0]) for part, name, *_ in demo_system.STATES]

    def advance(i: int) -> None:
        for name, value in levers(i, step).items():
            manipulator.slave_real_values(slaves["hydraulics"], [references["hydraulics"][name]], [value])
        assert execution.step(), f"step {i}"

    return events(states, advance, step)


def ecos(package: Path, step: float) -> Times:
    """Times with ECOS through ecospy."""
    # The library of ecospy needs oneTBB, which its wheel installs in the lib folder of the environment.
    ctypes.CDLL(str(Path(sys.prefix) / "lib" / "libtbb.so.12"), mode=ctypes.RTLD_GLOBAL)
    from ecospy import EcosSimulation

    with EcosSimulation(ssp_path=str(package), step_size=step) as simulation:
        assert simulation.init()

        def states() -> list[bool]:
            return [bool(simulation.get_bool(f"{part}::{name}")) for part, name, *_ in demo_system.STATES]

        def advance(i: int) -> None:
            for name, value in levers(i, step).items():
                simulation.set_real(f"hydraulics::{name}", value)
            simulation.step(1)

        found = events(states, advance, step)
        simulation.terminate()
        return found


def main() -> None:
    package = Path(sys.argv[1])
    hosts = {"FMPy": fmpy, "libcosim": cosim, "ECOS": ecos}
    for step in STEPS:
        found = {}
        for host, run in hosts.items():
            try:
                found[host] = run(package, step)
            except Exception as error:  # the failure of a host is a result
                print(f"{host}, {1e3 * step:g} ms: {type(error).__name__}: {error}")
        print(f"step {1e3 * step:g} ms".ljust(32) + "".join(host.rjust(22) for host in found))
        for words in found["FMPy"]:
            times = [" ".join(f"{time:.3f}" for time in one.get(words, [])) for one in found.values()]
            print(words.ljust(32) + "".join(time.rjust(22) for time in times), flush=True)


if __name__ == "__main__":
    main()
