"""Retract and extend a landing gear with door, locks and one hydraulic system: three FMUs of an SSP package.

The host does nothing but copy outputs to inputs, as the package says, and move the levers of the pilot: selector,
pump, by-passes, hand pump. The order of door, locks and gear is that of the valves in the hydraulic system.

Run by `cargo fmu demo --system`. Writes a table and a picture of pressures, positions, flows and states over time, and
a film of gear and door.
"""

from __future__ import annotations

import argparse
import csv
import math
import shutil
from collections import defaultdict
from dataclasses import dataclass, field
from graphlib import TopologicalSorter
from itertools import groupby
from pathlib import Path

import matplotlib as mpl
from fmpy import extract, read_model_description
from fmpy.ssp.ssd import read_ssd
from part import Part

mpl.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.animation import PillowWriter

STEP = 2e-3
"""Communication step [s]."""
SWEEP = (0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3, 20e-3)
"""Communication steps of the table of events [s]."""
ENDS = ((0, "gear is up"), (1, "gear is down"), (3, "gear is down"))
"""Events in the table: number of the action of the pilot, text."""
END = 38.0
"""End of the run [s]."""
FRAME = 0.25
"""Time between two pictures of the film [s]."""
FRAMES_PER_SECOND = 12
"""Pictures of the film per second."""
PUMP_PRESSURE = 10e6
"""Pressure of the hand pump while the pilot operates it [Pa]."""
LEVERS: tuple[tuple[float, str, dict[str, float]], ...] = (
    (0.0, "", {"selector.command": 0.0}),
    (0.5, "selector up", {"selector.command": -1.0}),
    (8.0, "selector down", {"selector.command": 1.0}),
    (17.0, "selector up", {"selector.command": -1.0}),
    (
        24.0,
        "emergency: pump off, by-passes open, hand pump",
        {
            "engine_pump.speed": 0.0,
            "selector.command": 0.0,
            "gear_dump.open": 1.0,
            "door_dump.open": 1.0,
            "hand_pump.pressure": PUMP_PRESSURE,
        },
    ),
)
"""Actions of the pilot: time [s], text, inputs of the hydraulic system."""
STATES: tuple[tuple[str, str, str, str], ...] = (
    ("hydraulics", "doorlock.engaged", "door lock engages", "door lock releases"),
    ("door", "closed", "door is closed", "door starts to open"),
    ("door", "open", "door is open", "door starts to close"),
    ("hydraulics", "downlock.engaged", "downlock engages", "downlock releases"),
    ("hydraulics", "uplock.engaged", "uplock engages", "uplock releases"),
    ("gear", "retracted", "gear is up", "gear leaves the up stop"),
    ("gear", "extended", "gear is down", "gear leaves the down stop"),
)
"""Boolean outputs, and the texts for their change to true and to false."""
CURVES: dict[str, tuple[str, ...]] = {
    "gear": ("crank.angle", "follower.angle", "actuator.length"),
    "door": ("door.angle", "actuator.length"),
    "hydraulics": (
        "supply.pressure",
        "up_line.pressure",
        "down_line.pressure",
        "gear.chamber_a.pressure",
        "gear.chamber_b.pressure",
        "door.chamber_a.pressure",
        "door.chamber_b.pressure",
        "engine_pump.flow",
        "gear.chamber_a.flow",
        "gear.chamber_b.flow",
        "door.chamber_a.flow",
        "gear_dump.flow",
        "gear.force",
        "door.force",
        "volume.from_reservoirs",
        "volume.balance",
        "energy.throttling",
        "energy.balance",
    ),
}
"""Real outputs in the table."""


@dataclass
class Copy:
    """Outputs of one FMU for inputs of another, by one call each."""

    source: str
    target: str
    is_boolean: bool
    outputs: list[int] = field(default_factory=list)
    inputs: list[int] = field(default_factory=list)


class System:
    """The FMUs of an SSP package and their connections."""

    def __init__(self, package: Path) -> None:
        self.folder = Path(extract(package))
        described = read_ssd(str(package)).system
        self.parts = {one.name: Part(self.folder / one.source) for one in described.elements}
        self.copies = self.order(described.connections)

    def order(self, connections: list) -> list[Copy]:
        """The connections in an order in which each output is read after the inputs on which it depends are set."""
        needs: dict[tuple[str, str], set[tuple[str, str]]] = defaultdict(set)
        types = {}
        for name, part in self.parts.items():
            description = read_model_description(part.folder)
            for unknown in description.outputs:
                needs[name, unknown.variable.name] |= {(name, known.name) for known in unknown.dependencies or []}
            types |= {(name, variable.name): variable.type for variable in description.modelVariables}
        sources = {}
        for one in connections:
            start, end = (one.startElement, one.startConnector), (one.endElement, one.endConnector)
            needs[end].add(start)
            sources[end] = start
        sorter, waves = TopologicalSorter(needs), []
        sorter.prepare()
        while sorter.is_active():
            ready = sorter.get_ready()
            waves.append(sorted(end for end in ready if end in sources))
            sorter.done(*ready)
        copies = []
        for wave in waves:

            def way(end: tuple[str, str]) -> tuple[str, str, str]:
                return sources[end][0], end[0], types[end]

            for (source, target, kind), ends in groupby(sorted(wave, key=way), way):
                copy = Copy(source, target, kind == "Boolean")
                for end in ends:
                    copy.outputs.append(self.parts[source].references[sources[end][1]])
                    copy.inputs.append(self.parts[target].references[end[1]])
                copies.append(copy)
        return copies

    def exchange(self) -> None:
        """Copy all connected outputs to their inputs."""
        for copy in self.copies:
            source, target = self.parts[copy.source].slave, self.parts[copy.target].slave
            if copy.is_boolean:
                target.setBoolean(copy.inputs, source.getBoolean(copy.outputs))
            else:
                target.setReal(copy.inputs, source.getReal(copy.outputs))

    def start(self, step: float) -> None:
        """Initialise all FMUs; `step` is the communication step [s]."""
        slaves = [part.slave for part in self.parts.values()]
        for slave in slaves:
            slave.setupExperiment(startTime=0.0)
            slave.enterInitializationMode()
        self.parts["hydraulics"].write({"preview.horizon": step})
        self.exchange()
        for slave in slaves:
            slave.exitInitializationMode()

    def step(self, now: float, step: float) -> None:
        """One communication step."""
        self.exchange()
        for part in self.parts.values():
            part.slave.doStep(now, step)

    def states(self) -> list[bool]:
        """The Boolean outputs."""
        read = [(self.parts[part], name) for part, name, *_ in STATES]
        return [bool(part.slave.getBoolean([part.references[name]])[0]) for part, name in read]

    def values(self) -> list[float]:
        """The Real outputs of the table."""
        return [value for name, columns in CURVES.items() for value in self.parts[name].read(*columns)]

    def close(self) -> None:
        """Free all instances and remove the extracted files."""
        for part in self.parts.values():
            part.close()
        shutil.rmtree(self.folder, ignore_errors=True)


@dataclass
class Run:
    """Events with their times [s], and a row of the table for each communication point."""

    events: list[tuple[float, str]] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)

    def column(self, part: str, name: str, factor: float = 1.0) -> list[float]:
        """Values of one output."""
        index = 1 + [(part, one) for part, names in CURVES.items() for one in names].index((part, name))
        return [factor * row[index] for row in self.rows]

    def state(self, part: str, name: str) -> list[float]:
        """Values of a Boolean output."""
        index = [one[:2] for one in STATES].index((part, name)) - len(STATES)
        return [row[index] for row in self.rows]


def run(package: Path, step: float = STEP, end: float = END) -> Run:
    """Run the levers in steps of `step` [s] up to `end` [s]."""
    system, found, levers = System(package), Run(), list(LEVERS)
    try:
        system.start(step)
        states = system.states()
        for i in range(round(end / step)):
            now = i * step
            while levers and levers[0][0] <= now + 0.5 * step:
                _, words, inputs = levers.pop(0)
                system.parts["hydraulics"].write(inputs)
                if words:
                    found.events.append((now, f"-- {words}"))
            found.rows.append([now, *system.values(), *states])
            system.step(now, step)
            before, states = states, system.states()
            for was, is_now, (*_, true, false) in zip(before, states, STATES, strict=True):
                if was != is_now:
                    found.events.append((now + step, true if is_now else false))
        found.rows.append([round(end / step) * step, *system.values(), *states])
    finally:
        system.close()
    return found


def write_table(found: Run, path: Path) -> None:
    """Write all rows with 17 digits in SI units."""
    names = [f"{part}.{name}" for part, columns in CURVES.items() for name in columns]
    names += [f"{part}.{name}" for part, name, *_ in STATES]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time", *names])
        writer.writerows([f"{row[0]:.12g}", *map(repr, map(float, row[1:]))] for row in found.rows)


def write_plot(found: Run, path: Path) -> None:
    """Draw positions, pressures, flows and states over time."""
    time, pressure, flow = [row[0] for row in found.rows], 1e-6, 6e4
    panels = (
        (
            "angle [deg]",
            [("gear", "crank.angle", "gear, crank"), ("door", "door.angle", "door")],
            math.degrees(1.0),
        ),
        (
            "pressure [MPa]",
            [
                ("hydraulics", "supply.pressure", "supply"),
                ("hydraulics", "gear.chamber_a.pressure", "gear, piston side"),
                ("hydraulics", "gear.chamber_b.pressure", "gear, rod side"),
                ("hydraulics", "door.chamber_a.pressure", "door, piston side"),
                ("hydraulics", "door.chamber_b.pressure", "door, rod side"),
            ],
            pressure,
        ),
        (
            "flow [l/min]",
            [
                ("hydraulics", "engine_pump.flow", "pump"),
                ("hydraulics", "gear.chamber_a.flow", "into the gear, piston side"),
                ("hydraulics", "door.chamber_a.flow", "into the door, piston side"),
                ("hydraulics", "gear_dump.flow", "by-pass of the gear"),
            ],
            flow,
        ),
    )
    with plt.rc_context({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False}):
        figure, axes = plt.subplots(
            4, 1, figsize=(11, 11), sharex=True, layout="constrained", height_ratios=(3, 3, 3, 2)
        )
        for axis, (label, curves, factor) in zip(axes, panels, strict=False):
            for part, name, words in curves:
                axis.plot(time, found.column(part, name, factor), linewidth=1.0, label=words)
            axis.set_ylabel(label)
            axis.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
        for row, (part, name, *_) in enumerate(reversed(STATES)):
            state = [row + 0.7 * value for value in found.state(part, name)]
            axes[3].fill_between(time, row, state, step="pre", linewidth=0)
        axes[3].set_yticks([row + 0.35 for row in range(len(STATES))], [one[1] for one in reversed(STATES)], fontsize=8)
        axes[3].set_xlabel("time [s]")
        for at, words, _ in LEVERS[1:]:
            for axis in axes:
                axis.axvline(at, color="black", linewidth=0.8, linestyle=":")
            axes[0].text(at, 1.02, words.split(":")[0], transform=axes[0].get_xaxis_transform(), fontsize=9)
        axes[0].set_xlim(0.0, time[-1])
        figure.savefig(path, dpi=110, metadata={"Software": None})
        plt.close(figure)


def turned(angle: float, x: float, y: float) -> complex:
    """A point of a body that is turned by an angle [rad]."""
    return complex(x, y) * complex(math.cos(angle), math.sin(angle))


def gear_lines(crank: float, follower: float) -> list[tuple[list[complex], str, float]]:
    """Lines of the gear from the side [m], with colour and width: as its definition states them, with up upwards."""
    base, top = complex(0.5729, 0), turned(crank, 0.1755, 0)
    end = base + turned(follower, 0.34, 0)
    wheel = turned(crank - 2.4, 0.759, 0)
    jack = [turned(crank, -0.05, -0.138), base + turned(follower, 0.02, 0.12)]
    upright = turned(math.pi / 2 - 1.13, 1, 0)
    lines = [([0j, wheel], "black", 3.0), ([0j, top], "black", 2.0), ([top, end, base], "grey", 2.0)]
    return [([upright * at for at in line], *look) for line, *look in [*lines, (jack, "tab:orange", 4.0)]]


def door_lines(angle: float) -> list[tuple[list[complex], str, float]]:
    """Lines of the door from the front [m]."""
    jack = [complex(-0.2, 0.3464), turned(angle, 0, 0.15)]
    return [([0j, turned(angle, 0.5, 0)], "tab:blue", 4.0), (jack, "tab:orange", 3.0)]


def write_film(found: Run, path: Path) -> None:
    """Draw gear, door, locks and the pressures of the gear's cylinder as a GIF, faster than in reality."""
    time = [row[0] for row in found.rows]
    every = max(1, round(FRAME / (time[1] - time[0])))
    columns = {
        name: found.column(part, name)[::every]
        for part, name in (("gear", "crank.angle"), ("gear", "follower.angle"), ("door", "door.angle"))
    }
    pressures = {
        words: found.column("hydraulics", f"{name}.pressure", 1e-6)[::every]
        for words, name in (
            ("supply", "supply"),
            ("gear, piston", "gear.chamber_a"),
            ("gear, rod", "gear.chamber_b"),
            ("door, piston", "door.chamber_a"),
            ("door, rod", "door.chamber_b"),
        )
    }
    locks = {one: found.state("hydraulics", f"{one}.engaged")[::every] for one in ("uplock", "downlock", "doorlock")}
    with plt.rc_context({"font.size": 8}):
        figure, axes = plt.subplots(1, 3, figsize=(7.2, 3.0), width_ratios=(3, 2, 2))
        figure.subplots_adjust(left=0.02, right=0.98, bottom=0.16, top=0.92, wspace=0.5)
        writer = PillowWriter(fps=FRAMES_PER_SECOND)
        with writer.saving(figure, str(path), dpi=80):
            for k, at in enumerate(time[::every]):
                act = [words for begin, words, _ in LEVERS if begin <= at][-1].split(":")[0]
                for axis in axes:
                    axis.clear()
                views = (
                    (gear_lines(columns["crank.angle"][k], columns["follower.angle"][k]), (-1.0, 0.8, -1.2, 0.75)),
                    (door_lines(columns["door.angle"][k]), (-0.3, 0.6, -0.55, 0.45)),
                )
                for axis, (lines, window), title in zip(
                    axes, views, ("gear, side view", "door, front view"), strict=False
                ):
                    for line, color, width in lines:
                        axis.plot([p.real for p in line], [p.imag for p in line], color=color, linewidth=width)
                    axis.set_title(title, fontsize=8)
                    axis.set_aspect("equal")
                    axis.axis(window)
                    axis.axis("off")
                wheel = views[0][0][0][0][1]
                axes[0].add_patch(plt.Circle((wheel.real, wheel.imag), 0.12, fill=False, linewidth=2.0))
                axes[0].text(-1.0, 0.65, f"{at:4.1f} s  {act}")
                held = ", ".join(one for one, state in locks.items() if state[k]) or "none"
                axes[0].text(-1.0, -1.18, f"locks engaged: {held}")
                axes[2].barh(list(pressures), [values[k] for values in pressures.values()], color="tab:red")
                axes[2].set_xlim(0, 25)
                axes[2].invert_yaxis()
                axes[2].set_xlabel("pressure [MPa]")
                writer.grab_frame()
        plt.close(figure)


def phases(found: Run) -> list[dict[str, float]]:
    """First time of each event after each action of the pilot [s]."""
    parts: list[dict[str, float]] = []
    for time, words in found.events:
        if words.startswith("--"):
            parts.append({})
        else:
            parts[-1].setdefault(words, time)
    return parts


def print_sweep(package: Path) -> None:
    """Print a row for each communication step: times of the events, the largest difference from the shortest step."""
    shortest = phases(run(package, SWEEP[0]))
    for step in SWEEP:
        found = phases(run(package, step))
        pairs = zip(found, shortest, strict=True)
        late = max(abs(part[words] - time) for part, short in pairs for words, time in short.items())
        times = [f"{found[action][words]:.3f} s" for action, words in ENDS]
        print(" | ".join([f"| {1e3 * step:g} ms", *times, f"{1e3 * late:.1f} ms |"]), flush=True)


def main() -> None:
    """Run the demo."""
    parser = argparse.ArgumentParser(description="Retract and extend a landing gear with door, locks and hydraulics.")
    parser.add_argument("package", type=Path, help="LandingGearSystem.ssp")
    parser.add_argument("--step", type=float, default=STEP, help="communication step [s]")
    parser.add_argument("--out", type=Path, default=Path(), help="folder for system.csv, system.png and system.gif")
    parser.add_argument("--sweep", action="store_true", help="only print times of events for several steps")
    arguments = parser.parse_args()
    if arguments.sweep:
        print_sweep(arguments.package)
        return
    found = run(arguments.package, arguments.step)
    print(f"steps of {1e3 * arguments.step:g} ms")
    for at, words in found.events:
        print(f"{at:8.3f} s  {words}")
    volume = max(map(abs, found.column("hydraulics", "volume.balance")))
    energy = max(map(abs, found.column("hydraulics", "energy.balance")))
    throttled = found.column("hydraulics", "energy.throttling")[-1]
    print(f"volume.balance at most {1e6 * volume:.1e} ml, energy.balance at most {energy:.1e} J of {throttled:.0f} J")
    arguments.out.mkdir(parents=True, exist_ok=True)
    table, plot, film = (arguments.out / f"system.{kind}" for kind in ("csv", "png", "gif"))
    write_table(found, table)
    write_plot(found, plot)
    write_film(found, film)
    print(f"table {table}\nplot  {plot}\nfilm  {film}")


if __name__ == "__main__":
    main()
