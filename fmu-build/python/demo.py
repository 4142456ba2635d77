"""Retract the landing gear: run the packed FMU through FMPy step by step, print figures, write a table and a plot.

usage: demo.py FMU [--out DIR]
"""

from __future__ import annotations

import argparse
import csv
import math
import statistics
import time
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
from part import Part

mpl.use("Agg")
import matplotlib.pyplot as plt

STEP = 1e-3
"""Communication step [s]."""
STEPS = 133
"""Number of steps of the run. The gear is up within the last step."""
GEAR_UP = -1.3
"""Angle of the crank at which the gear is up [rad]."""
PLOT_PARTS = 20
"""Parts of a step in the plot: joint reactions change within 1 ms when the gear reaches its stop."""
REPETITIONS = 20
"""Number of runs for the timing."""

REFERENCE_TIME = 0.1320598527442597
"""Time at which the gear is up [s], by a quadrature of the energy equation with 34 digits."""
REFERENCE_ANGLES = {
    20: 0.75457503788320041,
    50: 0.50930198670390647,
    100: -0.40913523120016843,
    130: -1.2377117266891367,
}
"""Angle of the crank [rad] by number of steps, from the same quadrature."""

COLUMNS = (
    "crank.angle",
    "crank.speed",
    "crank.acceleration",
    *(f"joint{number}.force" for number in (1, 2, 3, 4)),
    "actuator.length",
    "actuator.speed",
    "wheel.x",
    "wheel.y",
    "energy.drift",
)


@dataclass
class Retraction:
    """One run: time and outputs at every communication point, and time and outputs when the gear was up."""

    rows: list[list[float]]
    up: list[float]

    def column(self, name: str) -> list[float]:
        """Values of one output, or of `time` [s], at the communication points."""
        index = 0 if name == "time" else 1 + COLUMNS.index(name)
        return [row[index] for row in self.rows]

    def way_up(self) -> Retraction:
        """The run until the gear is up. The last row is this instant."""
        return Retraction([*(row for row in self.rows if row[0] < self.up[0]), self.up], self.up)


class Gear(Part):
    """The landing gear."""

    def start(self) -> None:
        """Set up a run with all defaults."""
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def retract(self, parts: int = 1) -> Retraction:
        """Run with all outputs, each step in `parts` parts; the part in which the gear comes up is split at that time.

        The remaining time to GEAR_UP follows from angle, speed and acceleration. Within one step of it, partial steps
        of nine tenths of that time close in, from the near side only, so a stop at GEAR_UP does no harm.
        """
        self.slave.reset()
        self.start()
        rows = [[0.0, *self.read(*COLUMNS)]]
        up: list[float] = []
        step = STEP / parts
        for i in range(STEPS * parts):
            now, end = i * step, (i + 1) * step
            while not up:
                angle, speed, acceleration = self.read("crank.angle", "crank.speed", "crank.acceleration")
                rest = time_to(GEAR_UP - angle, speed, acceleration)
                if rest < 1e-9:
                    up = [now + rest, *self.read(*COLUMNS)]
                    up[1] = GEAR_UP
                elif now + rest > end + 0.05 * step:
                    break
                else:
                    part = min(0.9 * rest, 0.5 * (end - now))
                    self.slave.doStep(now, part)
                    now += part
            self.slave.doStep(now, end - now)
            rows.append([end, *self.read(*COLUMNS)])
        if not up:
            raise SystemExit(f"error: crank.angle did not reach {GEAR_UP} rad within {STEPS * STEP:g} s")
        return Retraction(rows, up)

    def cost(self) -> float:
        """Time in fmi2DoStep for all steps of one run [s], including FMPy's own time."""
        self.slave.reset()
        self.start()
        total = 0
        for i in range(STEPS):
            before = time.perf_counter_ns()
            self.slave.doStep(i * STEP, STEP)
            total += time.perf_counter_ns() - before
        return total * 1e-9


def time_to(way: float, speed: float, acceleration: float) -> float:
    """Smallest t >= 0 with speed t + acceleration t^2 / 2 = way [s]; infinite if there is none."""
    root = speed * speed + 2.0 * acceleration * way
    if root < 0.0:
        return math.inf
    denominator = speed + math.copysign(math.sqrt(root), speed if speed else way)
    rest = 2.0 * way / denominator if denominator else math.inf
    return rest if rest >= 0.0 else math.inf


def report(run: Retraction, costs: list[float]) -> str:
    """The figures, one per line."""
    angles = run.column("crank.angle")
    time_up = run.up[0]
    travelled = abs(run.up[1] - angles[0])
    lines = [
        f"retraction time       {time_up:.12f} s   (reference {REFERENCE_TIME:.12f}, "
        f"error {time_up - REFERENCE_TIME:+.1e} s)",
        f"angle travelled       {travelled:.9f} rad = {math.degrees(travelled):.4f} deg",
    ]
    for step, reference in REFERENCE_ANGLES.items():
        error = angles[step] - reference
        lines.append(f"crank.angle at {step * STEP:.2f} s {angles[step]:+.12f} rad (error {error:+.1e} rad)")
    best, median = min(costs), statistics.median(costs)
    lines.append(
        f"time in fmi2DoStep    {best * 1e6:.0f} us for {STEPS} steps of {STEP * 1e3:g} ms, "
        f"{best / STEPS * 1e6:.2f} us a step (best of {len(costs)} runs, median {median * 1e6:.0f} us; FMPy included)"
    )
    return "\n".join(lines)


def write_table(run: Retraction, path: Path) -> None:
    """Write all rows with 17 digits in SI units."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time", *COLUMNS])
        writer.writerows([f"{row[0]:.12g}", *map(repr, row[1:])] for row in run.rows)


def write_plot(run: Retraction, path: Path) -> None:
    """Draw angle, speed, joint reactions and actuator length over time, until the gear is up."""
    run = run.way_up()
    time_up = 1e3 * run.up[0]
    milliseconds = [1e3 * t for t in run.column("time")]
    with plt.rc_context({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False}):
        figure, panels = plt.subplots(2, 2, figsize=(10, 7), sharex=True, layout="constrained")
        (angle, speed), (reaction, length) = panels
        angle.plot(milliseconds, [math.degrees(a) for a in run.column("crank.angle")])
        angle.set_ylabel("crank angle [deg]")
        speed.plot(milliseconds, run.column("crank.speed"))
        speed.set_ylabel("crank speed [rad/s]")
        for joint, style in zip(("joint1", "joint2", "joint3", "joint4"), ("-", "--", "-.", ":"), strict=True):
            force = [1e-3 * f for f in run.column(f"{joint}.force")]
            reaction.plot(milliseconds, force, style, linewidth=1.8, label=joint)
        reaction.set_ylabel("joint reaction [kN]")
        reaction.set_ylim(bottom=0.0)
        reaction.legend(ncols=2)
        length.plot(milliseconds, run.column("actuator.length"))
        length.set_ylabel("actuator length [m]")
        for panel in panels.flat:
            panel.set_xlim(0.0, time_up)
        for panel in panels[1]:
            panel.set_xlabel("time [ms]")
        figure.suptitle(f"Landing-gear retraction, 30 kN actuator, load factor 3: gear up after {time_up:.3f} ms")
        figure.savefig(path, dpi=150, metadata={"Software": None})
        plt.close(figure)


def main() -> None:
    """Run the demo."""
    parser = argparse.ArgumentParser(description="Run the landing-gear retraction through FMPy.")
    parser.add_argument("fmu", type=Path, help="LandingGearRetraction.fmu")
    parser.add_argument("--out", type=Path, default=Path(), help="folder for retraction.csv and retraction.png")
    arguments = parser.parse_args()
    gear = Gear(arguments.fmu)
    try:
        gear.start()
        run, fine = gear.retract(), gear.retract(PLOT_PARTS)
        costs = [gear.cost() for _ in range(REPETITIONS)]
    finally:
        gear.close()
    print(report(run, costs))
    arguments.out.mkdir(parents=True, exist_ok=True)
    table, plot = arguments.out / "retraction.csv", arguments.out / "retraction.png"
    write_table(run, table)
    write_plot(fine, plot)
    print(f"table                 {table}\nplot                  {plot}")


if __name__ == "__main__":
    main()
