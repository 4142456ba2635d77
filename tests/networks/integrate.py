"""A hydraulic network by the equations of docs/explanation/hydraulic-network.md, integrated by SciPy.

Usage: python integrate.py network.json TIME... [VALVE=COMMAND] [--radau] prints the state at these times. The cylinders
move their reduced mass against their holding force; limits are not looked at. It shares nothing with the FMU but the
definition file.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from math import exp, pi, sqrt, tanh
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

Element = dict[str, Any]
Vector = np.ndarray
CHECK_WIDTH = 5e4
PUMP_ROUNDING = 0.02


def soft(x: float, w: float) -> float:
    return 0.5 * (x + sqrt(x * x + w * w))


def gate(x: float, w: float) -> float:
    return 0.5 * (1 + x / sqrt(x * x + w * w))


def orifice(d: float, k: float, laminar: float, transition: float, switches: bool = False) -> float:
    series = k * laminar
    head = max(abs(d), transition) if switches else sqrt(d * d + transition**2)
    return 2 * d * k / (series + sqrt(series**2 + 4 * head))


class Network:
    """The equations of one network."""

    def __init__(self, definition: Element) -> None:
        self.d = definition
        fluid = {"ambient_pressure": 101325.0, "bulk_modulus": 1.4e9, "air_fraction": 0.005, "polytropic_exponent": 1.4}
        self.fluid = fluid | definition.get("fluid", {})
        self.nodes = definition.get("nodes", {})
        self.cylinders = definition.get("cylinders", {})
        self.valves = definition.get("valves", {})
        self.pressures = list(self.nodes) + [f"{name}.{side}" for name in self.cylinders for side in "ab"]
        self.spools = [name for name, valve in self.valves.items() if "frequency" in valve]
        self.names = self.pressures + [f"{name}.{part}" for name in self.spools for part in ("position", "rate")]
        self.names += self.moving()
        self.index = {name: index for index, name in enumerate(self.names)}

    def moving(self) -> list[str]:
        """Names of the states of the masses that the cylinders move."""
        return [f"{name}.{part}" for name in self.cylinders for part in ("length", "speed")]

    def motion(self, y: Element) -> dict[str, tuple[float, float]]:
        """Length and speed of each cylinder."""
        return {name: (y[f"{name}.length"], y[f"{name}.speed"]) for name in self.cylinders}

    def moved(self, y: Element, force: dict[str, float]) -> Element:
        """Rates of the masses that the cylinders move, under the cylinder forces."""
        rate = {}
        for name, one in self.cylinders.items():
            rate[f"{name}.length"] = y[f"{name}.speed"]
            rate[f"{name}.speed"] = (force[name] - one.get("holding_force", 0.0)) / one["reduced_mass"]
        return rate

    def group(self, name: str) -> Iterable[Element]:
        return self.d.get(name, {}).values()

    def start(self) -> Vector:
        y = {name: node.get("start_pressure", 0.0) for name, node in self.nodes.items()}
        y |= {f"{name}.{part}": 0.0 for name in self.spools for part in ("position", "rate")}
        for name, one in self.cylinders.items():
            for side in "ab":
                y[f"{name}.{side}"] = one.get(f"chamber_{side}", {}).get("start_pressure", 0.0)
        y |= self.moving_start()
        return np.array([y[name] for name in self.names])

    def moving_start(self) -> Element:
        """Start states of the masses that the cylinders move."""
        start = {}
        for name, one in self.cylinders.items():
            start[f"{name}.length"], start[f"{name}.speed"] = one["length"], one.get("speed", 0.0)
        return start

    def modulus(self, p: float) -> float:
        f = self.fluid
        absolute = p + f["ambient_pressure"]
        n, bulk = f["polytropic_exponent"], f["bulk_modulus"]
        r = f["air_fraction"] * (f["ambient_pressure"] / absolute) ** (1 / n)
        return bulk * (1 + r) / (1 + r * bulk / (n * absolute))

    def rates(self, _t: float, vector: Vector) -> Vector:
        y = dict(zip(self.names, vector, strict=True))
        p = {name: y[name] for name in self.pressures}
        p |= {name: one.get("pressure", 0.0) for name, one in self.d.get("reservoirs", {}).items()}
        net = dict.fromkeys(p, 0.0)
        resistance, rate, compliance, force, motion = {}, {}, {}, {}, self.motion(y)
        ambient = self.fluid["ambient_pressure"]
        for name, node in self.nodes.items():
            compliance[name] = node["volume"] / self.modulus(p[name])
            compliance[name] += node.get("hose_volume", 0.0) / node.get("hose_modulus", 5e8)
        for name, one in self.cylinders.items():
            bore, rod = one.get("bore", 0.045), one.get("rod", 0.025)
            stroke, closed = one.get("stroke", 0.33), one.get("closed_length", 0.412)
            area = {"a": pi / 4 * bore**2, "b": pi / 4 * (bore**2 - rod**2)}
            x, v = motion[name][0] - closed, motion[name][1]
            way = {"a": x, "b": stroke - x}
            drop = one.get("rated_pressure_drop", 3.5e6)
            leak = {"internal": 2e-13, "external_a": 0.0, "external_b": 5e-14} if "leakage" in one else {}
            leak |= one.get("leakage", {})
            across = leak.get("internal", 0.0) * (p[f"{name}.a"] - p[f"{name}.b"])
            for side, sign in (("a", -1), ("b", 1)):
                port, chamber = f"{name}.{side}", one.get(f"chamber_{side}", {})
                flows = []
                if chamber.get("restrictor_flow", 0.0) > 0:
                    flows.append((1.0, chamber["restrictor_flow"]))
                length = chamber.get("cushion_length", 0.0)
                if length > 0 and chamber.get("cushion_flow", 0.0) > 0:
                    flows.append((max(0.0, 1 - way[side] / length) ** 3, chamber["cushion_flow"]))
                resistance[port] = sum(part * drop / flow**2 for part, flow in flows)
                volume = chamber.get("dead_volume", 6e-5)
                volume += 0 if one.get("oil_volume") == "constant" else area[side] * way[side]
                hose, walls = chamber.get("hose_volume", 0.0), one.get("wall_modulus", 0.0)
                compliance[port] = volume / self.modulus(p[port]) + hose / one.get("hose_modulus", 5e8)
                compliance[port] += (volume - hose) / walls if walls > 0 else 0.0
                net[port] += sign * (across + area[side] * v) - leak.get(f"external_{side}", 0.0) * p[port]
            friction = 0.0
            if "seal" in one:
                seal = {
                    "coulomb": 250.0,
                    "static": 400.0,
                    "stribeck_speed": 0.02,
                    "transition_speed": 0.005,
                    "viscous": 500.0,
                    "pressure_area": 0.0,
                } | one["seal"]
                level = seal["coulomb"] + (seal["static"] - seal["coulomb"]) * exp(-((v / seal["stribeck_speed"]) ** 2))
                level += seal["pressure_area"] * (soft(p[f"{name}.a"], 1e5) + soft(p[f"{name}.b"], 1e5))
                friction = level * tanh(v / seal["transition_speed"]) + seal["viscous"] * v
            force[name] = area["a"] * p[f"{name}.a"] - area["b"] * p[f"{name}.b"] - friction
        for one in self.group("accumulators"):
            absolute = p[one["at"]] + ambient
            n = one.get("polytropic_exponent", 1.4)
            gas = one.get("volume", 1e-3) * ((one.get("precharge_pressure", 10e6) + ambient) / absolute) ** (1 / n)
            compliance[one["at"]] += gas / (n * absolute)

        def flow(one: Element, start: str, end: str, k: float, laminar: float = 0.0) -> None:
            d = p[start] - p[end]
            outlets = resistance.get(start, 0.0) * gate(d, CHECK_WIDTH)
            outlets += resistance.get(end, 0.0) * gate(-d, CHECK_WIDTH)
            switches = one.get("transition") == "switch"
            q = orifice(d, k / sqrt(1 + k * k * outlets), laminar, one.get("transition_pressure", 1e5), switches)
            net[start] -= q
            net[end] += q

        def coefficient(one: Element, key: str = "rated_flow", default: float = 1e-4) -> float:
            return one.get(key, default) / sqrt(one.get("rated_pressure_drop", 3.5e6))

        def gated(
            one: Element,
            forward: float,
            back: float,
            g: float = 1.0,
            h: float = 1.0,
            cracking: float = 0.0,
            width: float = CHECK_WIDTH,
            laminar: float = 0.0,
        ) -> None:
            d = p[one["from"]] - p[one["to"]]
            root = gate(d - cracking, width) * g * sqrt(forward) + gate(-d, CHECK_WIDTH) * h * sqrt(back)
            flow(one, one["from"], one["to"], root**2, laminar)

        def linear(one: Element, q: float) -> None:
            net[one["from"]] -= q
            net[one["to"]] += q

        for one in self.group("resistances"):
            forward = coefficient(one)
            back = coefficient(one, "reverse_flow", one.get("rated_flow", 1e-4))
            conductance = one.get("laminar_conductance", 0.0)
            gated(one, forward, back, laminar=1 / conductance if conductance > 0 else 0.0)
        for one in self.group("checks"):
            cracking, width = one.get("cracking_pressure", 0.0), one.get("width", 5e4)
            if one.get("conductance", 0.0) > 0:
                linear(one, one["conductance"] * soft(p[one["from"]] - p[one["to"]] - cracking, width))
            else:
                gated(one, coefficient(one), 0.0, cracking=cracking, width=width)
        for one in self.group("reliefs"):
            over = soft(p[one["from"]] - one.get("pressure", 28e6), one.get("width", 1e5))
            linear(one, one.get("conductance", 1e-10) * over)
        for group in ("priorities", "sequences"):
            for one in self.group(group):
                pilot = p[one.get("pilot", one["from"])]
                g = gate(pilot - one.get("pressure", 10e6), one.get("width", 2e5))
                gated(one, coefficient(one), coefficient(one, "reverse_flow", 0.0), g=g)
        for one in self.group("position_valves"):
            beyond = motion[one["cylinder"]][0] - one["length"]
            g = gate(-beyond if one.get("opens") == "below" else beyond, one.get("width", 5e-5))
            gated(one, coefficient(one), coefficient(one, "reverse_flow", 0.0), g=g)
        for one in self.group("pilot_checks"):
            h = gate(p[one["pilot"]] - one.get("ratio", 0.3) * p[one["to"]], one.get("width", 5e4))
            gated(one, coefficient(one), coefficient(one), h=h)
        for one in self.group("counterbalances"):
            total = p[one["to"]] + one.get("ratio", 3.0) * p[one["pilot"]]
            h = gate(total - one.get("pressure", 25e6), one.get("width", 1e6))
            gated(one, coefficient(one), coefficient(one), h=h)
        for one in self.group("bypasses"):
            flow(one, one["from"], one["to"], one.get("open", 0.0) * coefficient(one))
        for name, one in self.valves.items():
            spool = y[f"{name}.position"] if name in self.spools else one.get("command", 0.0)
            overlap, clearance = one.get("overlap", 0.0), one.get("clearance", 2e-3)
            plus, minus = soft(spool - overlap, clearance), soft(-spool - overlap, clearance)
            b = one.get("rated_flow_b", one.get("rated_flow", 1e-4))
            for start, end, opening, key, default in (
                ("supply", "a", plus, "rated_flow", 1e-4),
                ("supply", "b", minus, "rated_flow_b", b),
                ("a", "return", minus, "rated_flow_a_return", one.get("rated_flow", 1e-4)),
                ("b", "return", plus, "rated_flow_b_return", b),
            ):
                flow(one, one[start], one[end], opening * coefficient(one, key, default))
            if name in self.spools:
                omega, zeta, speed = 2 * pi * one["frequency"], one.get("damping_ratio", 0.8), y[f"{name}.rate"]
                rate[f"{name}.position"] = speed
                rate[f"{name}.rate"] = omega**2 * (one.get("command", 0.0) - spool) - 2 * zeta * omega * speed
        for one in self.group("pumps"):
            q = one.get("max_flow", 1.5e-4)
            if one.get("type", "compensated") == "compensated":
                most, full = one.get("max_pressure", 20.7e6), one.get("full_pressure", 20e6)
                part = (most - p[one["to"]]) / (most - full)
                q *= soft(part, PUMP_ROUNDING) - soft(part - 1, PUMP_ROUNDING)
            net[one["from"]] -= q
            net[one["to"]] += q
        rate |= self.moved(y, force)
        rate |= {name: net[name] / compliance[name] for name in self.pressures}
        return np.array([rate[name] for name in self.names])


def integrate(network: Network, times: list[float], method: str = "DOP853", rtol: float = 1e-12) -> Vector:
    size = np.array([1e5 if name in network.pressures else 1e-2 for name in network.names])
    result = solve_ivp(
        network.rates, (0, times[-1]), network.start(), method, t_eval=times, rtol=rtol, atol=rtol * size, max_step=0.01
    )
    assert result.success, result.message
    return result.y.T


if __name__ == "__main__":
    definition = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    for valve, _, command in (one.partition("=") for one in sys.argv[2:] if "=" in one):
        definition["valves"][valve]["command"] = float(command)
    own = Network(definition)
    times = [time for time in sys.argv[2:] if time != "--radau" and "=" not in time]
    method = "Radau" if "--radau" in sys.argv else "DOP853"
    for time, state in zip(times, integrate(own, [float(time) for time in times], method), strict=True):
        for name, value in zip(own.names, state, strict=True):
            print(time, name, repr(float(value)))
