"""Retract the landing gear by its hydraulic actuator: couple the two packed FMUs through FMPy by several schemes, and
compare them with the FMU of both as one system; print errors, write a table and a plot.

usage: demo_hydraulic.py GEAR HYDRAULICS WHOLE [--out DIR]
"""

from __future__ import annotations

import argparse
import csv
import math
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
from demo import GEAR_UP, time_to
from part import Part

mpl.use("Agg")
import matplotlib.pyplot as plt

STEP = 1e-3
"""Communication step [s]."""
TOLERANCE = 1e-12
"""Relative tolerance of both integrations. Their errors are smaller than those of the coupling."""
LONGEST = 4500
"""Largest number of steps of a run. The gear is up after 4066 steps."""
LOST = 30_000.0
"""Force above which a coupling counts as unstable [N]: more than the largest force of the cylinder."""

REFERENCE_TIME = 4.065842490726519
"""Time at which the gear is up [s], by a Taylor-series integration of gear and hydraulics as a single system."""
REFERENCE = {
    50: (0.793138133418578, -1232.161703436),
    100: (0.769550975553854, -1605.896803131),
    200: (0.703967315179619, -2008.847879986),
    500: (0.523620580328936, -921.6257163131),
    1000: (0.253250298772210, 471.0857748807),
    2000: (-0.242429680769236, 2710.350675763),
    3000: (-0.759970553164200, 5284.562808813),
    3500: (-1.05718309261089, 6463.272957934),
    3800: (-1.22821155571711, 5265.166473185),
    4000: (-1.28835660508442, 3674.566628157),
}
"""Angle of the crank [rad] and force [N] by time in milliseconds, from the same integration."""

FOLLOW = 2
"""Number of the item `follow` of `coupling.mode`."""
COMMAND = {"command.ramp_amplitude": 0.65, "command.ramp_time": 0.1}
"""The valve opens to 0.65 within 0.1 s."""
ELEMENT = tuple(
    f"actuator.{term}"
    for term in (
        "reduced_mass",
        "reduced_mass_derivative",
        "holding_force",
        "holding_force_derivative",
        "lower_limit",
        "upper_limit",
    )
)
"""Outputs of the gear as one element at the actuator."""
OF_GEAR = ("crank.angle", "crank.speed", "actuator.length", "actuator.speed", "energy.kinetic", "energy.potential")
OF_HYDRAULICS = (
    "actuator.force",
    "chamber_a.pressure",
    "chamber_b.pressure",
    "valve.position",
    "energy.supplied",
    "energy.piston",
    "energy.throttling",
    "energy.balance",
    "coupling.stable_step",
)
COLUMNS = (*OF_GEAR, *OF_HYDRAULICS)


@dataclass(frozen=True)
class Scheme:
    """A scheme for the exchange of force and motion."""

    title: str
    colour: str
    previews: bool = True
    """Whether the hydraulics uses the gear's one-element outputs. Otherwise each side holds the previous values of the
    other side."""
    linear: bool = False
    """Whether the gear gets the predicted force as a linear function, by an input derivative. Otherwise it gets the
    held mean force."""
    two_passes: bool = False
    """Whether the hydraulics repeats the step with the motion of the gear. Otherwise it keeps the predicted motion."""


SCHEMES = (
    Scheme("plain exchange, inputs held", "#999999", previews=False),
    Scheme("preview, mean force held", "#d9822b"),
    Scheme("preview, force with its rate", "#24527a", linear=True),
    Scheme("preview, two passes", "#3a7d44", linear=True, two_passes=True),
)
STANDARD = 1
"""Scheme of the table: every host can use it."""


@dataclass
class Run:
    """One run: time and outputs at every communication point until the gear is up or the coupling is unstable."""

    scheme: Scheme
    rows: list[list[float]]
    time_up: float | None

    def column(self, name: str) -> list[float]:
        """Values of one output, or of `time` [s], at the communication points."""
        index = 0 if name == "time" else 1 + COLUMNS.index(name)
        return [row[index] for row in self.rows]

    def interface_energy(self) -> list[float]:
        """Energy that the coupling added [J]: gain of the gear since the start minus the work of the hydraulics."""
        gear = [kinetic + potential for kinetic, potential in self.pairs("energy.kinetic", "energy.potential")]
        return [own - gear[0] - work for own, work in zip(gear, self.column("energy.piston"), strict=True)]

    def pairs(self, first: str, second: str) -> list[tuple[float, float]]:
        """Values of two outputs."""
        return list(zip(self.column(first), self.column(second), strict=True))

    def errors(self, whole: list[tuple[float, float]]) -> list[tuple[float, float]]:
        """Errors of angle [rad] and force [N] at every communication point, against the run of the whole system."""
        rows = self.pairs("crank.angle", "actuator.force")
        return [(abs(a - b), abs(f - g)) for (a, f), (b, g) in zip(rows, whole, strict=False)]


def hermite(speed: float, end: list[float], way: float, accelerations: list[float], h: float) -> list[float]:
    """Derivatives of orders 1 to 4 of the speed at the beginning of a step of size h. The speed is the polynomial of
    degree 4 in time with the values and slopes of both ends, and with the integral `way`."""
    start, last = accelerations
    rise, slope = end[1] - speed - start * h, (last - start) * h
    mean = way / h - speed - 0.5 * start * h
    fourth = 30.0 * (mean - 0.5 * rise + slope / 12.0)
    third = slope - 2.0 * rise - 2.0 * fourth
    second = rise - third - fourth
    return [start, 2.0 * second / h**2, 6.0 * third / h**3, 24.0 * fourth / h**4]


def integrate(path: Path) -> list[tuple[float, float]]:
    """Angle of the crank [rad] and force [N] of the single system, at all communication points."""
    whole = Part(path)
    try:
        whole.choose("downstop.enabled", False)
        whole.write(COMMAND)
        whole.slave.setupExperiment(tolerance=TOLERANCE, startTime=0.0)
        whole.slave.enterInitializationMode()
        whole.slave.exitInitializationMode()
        rows = [whole.read("crank.angle", "actuator.force")]
        for i in range(LONGEST):
            whole.slave.doStep(i * STEP, STEP)
            rows.append(whole.read("crank.angle", "actuator.force"))
    finally:
        whole.close()
    return [(angle, force) for angle, force in rows]


class Pair:
    """The gear and its hydraulic actuator."""

    def __init__(self, gear: Path, hydraulics: Path) -> None:
        self.gear, self.hydraulics = Part(gear), Part(hydraulics)

    def close(self) -> None:
        """Free both instances."""
        self.gear.close()
        self.hydraulics.close()

    def start(self, scheme: Scheme) -> None:
        """Set up a run: the valve opens to 0.65 within 0.1 s. Without the down stop the gear moves at once."""
        for part in (self.gear, self.hydraulics):
            part.slave.reset()
        self.gear.choose("downstop.enabled", False)
        self.hydraulics.write(COMMAND)
        if scheme.two_passes:
            self.hydraulics.slave.setInteger([self.hydraulics.references["coupling.mode"]], [FOLLOW])
        for part in (self.gear, self.hydraulics):
            part.slave.setupExperiment(tolerance=TOLERANCE, startTime=0.0)
            part.slave.enterInitializationMode()
        self.pass_motion(scheme)
        for part in (self.gear, self.hydraulics):
            part.slave.exitInitializationMode()

    def pass_motion(self, scheme: Scheme) -> None:
        """Pass the motion of the gear to the hydraulics, and its one-element outputs if the hydraulics predicts the
        motion."""
        names = ("actuator.length", "actuator.speed", *(ELEMENT if scheme.previews else ()))
        self.hydraulics.write(dict(zip(names, self.gear.read(*names), strict=True)))

    def step(self, scheme: Scheme, now: float) -> None:
        """One communication step."""
        gear, hydraulics = self.gear, self.hydraulics
        self.pass_motion(scheme)
        length, speed = gear.read("actuator.length", "actuator.speed")
        if not scheme.previews:
            gear.write({"actuator.force": hydraulics.read("actuator.force")[0]})
        elif scheme.linear:
            force, rate = hydraulics.read("preview.force", "preview.force_rate")
            gear.write({"actuator.force": force})
            gear.derivatives("actuator.force", [rate])
        else:
            gear.write({"actuator.force": hydraulics.read("preview.force_mean")[0]})
        accelerations = hydraulics.read("preview.start_acceleration", "preview.acceleration")
        gear.slave.doStep(now, STEP)
        if scheme.two_passes:
            end = gear.read("actuator.length", "actuator.speed")
            polynomial = hermite(speed, end, end[0] - length, accelerations, STEP)
            hydraulics.derivatives("actuator.speed", polynomial)
        hydraulics.slave.doStep(now, STEP)

    def outputs(self) -> list[float]:
        """Outputs at a communication point. The force is that under the present speed of the gear."""
        length, speed = self.gear.read("actuator.length", "actuator.speed")
        self.hydraulics.write({"actuator.length": length, "actuator.speed": speed})
        return [*self.gear.read(*OF_GEAR), *self.hydraulics.read(*OF_HYDRAULICS)]

    def retract(self, scheme: Scheme) -> Run:
        """Run until the gear is up or the coupling is unstable."""
        self.start(scheme)
        run = Run(scheme, [[0.0, *self.outputs()]], None)
        for i in range(LONGEST):
            self.step(scheme, i * STEP)
            outputs = self.outputs()
            run.rows.append([(i + 1) * STEP, *outputs])
            rest = time_to(GEAR_UP - outputs[0], *self.gear.read("crank.speed", "crank.acceleration"))
            if rest <= STEP:
                run.time_up = (i + 1) * STEP + rest
                break
            if abs(outputs[len(OF_GEAR)]) > LOST:
                break
        return run


def report(runs: list[Run], whole: list[tuple[float, float]]) -> str:
    """The figures."""
    off = [max(abs(whole[step][k] - reference[k]) for step, reference in REFERENCE.items()) for k in (0, 1)]
    lines = [
        f"steps of {STEP * 1e3:g} ms; reference: gear up after {REFERENCE_TIME:.9f} s",
        f"{'integrated as one system':30s}differs from the reference by {off[0]:.1e} rad, {off[1]:.1e} N",
    ]
    for run in runs:
        errors = run.errors(whole)
        energy = max(map(abs, run.interface_energy()))
        up = "unstable" if run.time_up is None else f"up after {run.time_up:.9f} s"
        lines.append(
            f"{run.scheme.title:30s}{up:23s}   largest errors {max(e[0] for e in errors):.1e} rad, "
            f"{max(e[1] for e in errors):.1e} N, energy created by the coupling {energy:.1e} J"
        )
    standard = runs[STANDARD]
    last = dict(zip(("time", *COLUMNS), standard.rows[-1], strict=True))
    gained = last["energy.kinetic"] + last["energy.potential"]
    gained -= sum(dict(zip(("time", *COLUMNS), standard.rows[0], strict=True))[k] for k in OF_GEAR[-2:])
    limits = [limit for limit in standard.column("coupling.stable_step") if limit > 0.0]
    lines += [
        f"energies                      supplied {last['energy.supplied']:.1f} J, lost by throttling "
        f"{last['energy.throttling']:.1f} J, work of the piston {last['energy.piston']:.1f} J, gained by the gear "
        f"{gained:.1f} J",
        f"energy.balance                {last['energy.balance']:.1e} J (0 except for rounding)",
        f"coupling.stable_step          {1e3 * min(limits):.2f} to {1e3 * max(limits):.2f} ms during the run: the "
        "largest stable step of a plain exchange of force and motion",
    ]
    return "\n".join(lines)


def write_table(run: Run, path: Path) -> None:
    """Write all rows with 17 digits in SI units, with the energy at the interface."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time", *COLUMNS, "interface_energy"])
        for row, energy in zip(run.rows, run.interface_energy(), strict=True):
            writer.writerow([f"{row[0]:.12g}", *map(repr, [*row[1:], energy])])


def write_plot(runs: list[Run], whole: list[tuple[float, float]], path: Path) -> None:
    """Draw pressures, force, angle and valve, and for every scheme the errors and the energy at the interface."""
    run = runs[STANDARD]
    time = run.column("time")
    with plt.rc_context({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False}):
        figure, panels = plt.subplots(3, 2, figsize=(11, 10), sharex=True, layout="constrained")
        (pressure, force), (angle, valve), (error, energy) = panels
        for chamber, style in (("a", "-"), ("b", "--")):
            values = [1e-6 * p for p in run.column(f"chamber_{chamber}.pressure")]
            pressure.plot(time, values, style, label=f"chamber {chamber.upper()}")
        pressure.set_ylabel("pressure [MPa]")
        pressure.legend()
        force.plot(time, [1e-3 * f for f in run.column("actuator.force")])
        marks = [1e-3 * step for step in REFERENCE]
        dot = {"linestyle": "none", "marker": "o", "markersize": 4, "color": "black", "fillstyle": "none"}
        force.plot(marks, [1e-3 * f for _, f in REFERENCE.values()], label="reference", **dot)
        force.set_ylabel("actuator force [kN]")
        force.legend(loc="lower right")
        angle.plot(time, [math.degrees(a) for a in run.column("crank.angle")])
        angle.plot(marks, [math.degrees(a) for a, _ in REFERENCE.values()], label="reference", **dot)
        angle.set_ylabel("crank angle [deg]")
        angle.legend()
        valve.plot(time, run.column("valve.position"), label="spool position [1]")
        valve.plot(time, [10.0 * v for v in run.column("actuator.speed")], "--", label="actuator speed [0.1 m/s]")
        valve.set_ylabel("spool, actuator speed")
        valve.legend()
        for other in runs:
            colour = other.scheme.colour
            errors = [max(angle, 1e-16) for angle, _ in other.errors(whole)]
            error.semilogy(other.column("time")[1:], errors[1:], color=colour, linewidth=1.0)
            made = [max(abs(e), 1e-12) for e in other.interface_energy()[1:]]
            energy.semilogy(other.column("time")[1:], made, color=colour, linewidth=1.0, label=other.scheme.title)
        error.set_ylabel("error of the crank angle [rad]")
        error.set_ylim(1e-13, 1e-1)
        energy.set_ylabel("energy created by the coupling [J]")
        energy.set_ylim(1e-9, 1e2)
        energy.legend(fontsize=8, ncols=2, loc="upper left")
        for panel in panels.flat:
            panel.set_xlim(0.0, time[-1])
        for panel in panels[-1]:
            panel.set_xlabel("time [s]")
        figure.suptitle(
            f"Landing gear and hydraulic actuator, coupled in steps of {STEP * 1e3:g} ms: gear up after "
            f"{run.time_up:.4f} s"
        )
        figure.savefig(path, dpi=150, metadata={"Software": None})
        plt.close(figure)


def main() -> None:
    """Run the demo."""
    parser = argparse.ArgumentParser(description="Retract the landing gear by its hydraulic actuator.")
    parser.add_argument("gear", type=Path, help="LandingGearRetraction.fmu")
    parser.add_argument("hydraulics", type=Path, help="HydraulicActuator.fmu")
    parser.add_argument("whole", type=Path, help="LandingGearRetractionHydraulic.fmu")
    parser.add_argument("--out", type=Path, default=Path(), help="folder for hydraulic.csv and hydraulic.png")
    arguments = parser.parse_args()
    pair = Pair(arguments.gear, arguments.hydraulics)
    try:
        runs = [pair.retract(scheme) for scheme in SCHEMES]
    finally:
        pair.close()
    if runs[STANDARD].time_up is None:
        raise SystemExit(f"error: crank.angle did not reach {GEAR_UP} rad within {LONGEST * STEP:g} s")
    whole = integrate(arguments.whole)
    print(report(runs, whole))
    arguments.out.mkdir(parents=True, exist_ok=True)
    table, plot = arguments.out / "hydraulic.csv", arguments.out / "hydraulic.png"
    write_table(runs[STANDARD], table)
    write_plot(runs, whole, plot)
    print(f"table                         {table}\nplot                          {plot}")


if __name__ == "__main__":
    main()
