"""Random calls with good and bad arguments: an answer or an exception of the module, and a module that works on.

LINKAGE_FMU_CALLS sets the number of calls, LINKAGE_FMU_SEED the first seed.
"""

from __future__ import annotations

import decimal
import faulthandler
import fractions
import inspect
import os
import random
import re
import threading
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import linkage_fmu as lf
import numpy as np
import pytest
from linkage_fmu import build

CALLS = int(os.environ.get("LINKAGE_FMU_CALLS", "400"))
SEED = int(os.environ.get("LINKAGE_FMU_SEED", "1"))
NAMES = ["crank.angle", "crank.speed", "actuator.force", "load_factor", "crank.mass", "friction.enabled"]
# Python itself rejects a call that does not fit the signature.
SIGNATURE = re.compile(r"argument|positional|constructor|object is not (callable|iterable|subscriptable)")
# An option of the command line.
OPTION = re.compile(r"--[a-z]")


class Raises:
    """Fails wherever it is used as a number or a list."""

    def __float__(self) -> float:
        raise ZeroDivisionError("of the object")

    def __iter__(self) -> Any:  # noqa: ANN401
        raise ZeroDivisionError("of the object")


BAD: list[Any] = [
    *(None, True, False, 0, 1, -1, 7, 2**31, 2**63, -(2**64), 10**400, 0.0, -0.0, 1e-320, 1e300, -1e-3, 1e9),
    *(float("nan"), float("inf"), -float("inf"), 1j, decimal.Decimal("0.01"), fractions.Fraction(1, 3)),
    *("", "crank.angel", "crank.angle", "45 deg", "1,5", "nan", "\0", "\udc80", "a\nb", "=", "x" * 5000, "{", "é" * 70),
    *(b"crank.angle", bytearray(8), [], (), {}, set(), frozenset(["crank.angle"]), object, Raises(), len, ...),
    *(["crank.angle", "crank.angle"], ["crank.angle", 5], [["crank.angle"]], [None], [1.0, 2.0], [0.0] * 17, range(3)),
    *({"crank.angle": 1.0}, {"load_factor": "1 m"}, {"load_factor": float("inf")}, {5: 1}, {"time": [0, 1]}, {"": ""}),
    *({"time": [0.0, 1.0], "load_factor": [1.0, 2.0]}, {"time": [[0], [1, 2]], "load_factor": [1]}, {"name": "A"}),
    *(np.zeros(2), np.zeros(0), np.zeros((2, 2)), np.float32(1.5), np.int8(3), np.bool_(True), np.array(1.0)),
    *(np.array(["a"]), np.array([None]), np.zeros(3, [("time", float)]), np.datetime64("2020"), np.arange(8)[::2]),
    *(Path("nowhere.json"), Path("/"), memoryview(b"12345678"), lambda *_: None, iter(["crank.angle"])),
]
"""Arguments that are rarely valid."""


def good(random: random.Random, gear: lf.Mechanism) -> list[Any]:
    """Arguments that are often valid."""
    names = random.sample(NAMES, random.randint(1, 3))
    values = {"load_factor": random.choice([1.0, "2", 3]), "crank.mass": random.choice([15, "20 kg", -1])}
    numbers = [random.random() for _ in names]
    return [random.choice(NAMES), names, tuple(names), values, numbers, np.array(numbers), 1e-3, 5e-3, 2, 0.01]


def targets(gear: lf.Mechanism, random: random.Random) -> list[Any]:
    """Objects of all classes, in all states."""
    closed, running = gear.simulation(), gear.simulation()
    closed.close()
    running.initialize()
    running.step(1e-3)
    text = lf.example("FourBar").to_dict()
    for body in text["bodies"].values():
        for key in ("mass", "inertia", "shape"):
            body.pop(key, None)
    result = gear.simulate(stop_time=5e-3, output_interval=1e-3, output=["crank.angle", "crank.speed"])
    return [
        *(gear, lf.example("HydraulicActuator"), lf.Mechanism(text)),
        *(closed, running, gear.simulation(), lf.example("HydraulicActuator").simulation()),
        *(running.prepare(NAMES[:3]), running.save(), result, result[1:2], gear.kinematics(3, ["crank.angle"])),
        *(gear.check(), gear.check().facts[0], lf, build),
    ]


# Functions that open a browser, need minutes, or that only the package calls, and a type.
LEFT_OUT = {"open", "optimise", "sweep", "package", "equilibria", "check", "view", "import_module", "wrong", "Part"}


def calls(target: Any) -> list[Callable[..., Any]]:  # noqa: ANN401
    """The callable members of an object."""
    if isinstance(target, np.ndarray):
        names = ["to_pandas", "plot", "animate", "__repr__", "__reduce__", "_repr_html_"]
    else:
        names = [name for name in dir(target) if not name.startswith("_") and name not in LEFT_OUT]
        special = ("__getitem__", "__setitem__", "__repr__", "_repr_html_")
        names += [name for name in special if hasattr(type(target), name)]
    # A property of a closed simulation raises.
    found = [getattr(target, name) for name in names if not inspect.isdatadescriptor(getattr(type(target), name, None))]
    # Mechanism is the only class of which users create objects.
    return [one for one in found if callable(one) and (one is lf.Mechanism or not isinstance(one, type))]


def tried(call: Callable[..., Any], given: list[Any], named: dict[str, Any]) -> str | None:
    """Make a call. Returns None, or a description of a wrong exception."""
    try:
        call(*given, **named)
    except lf.InternalError as error:
        return f"a fault of the engine: {error}"
    except (lf.LinkageError, KeyError, IndexError) as error:
        return None if str(error).strip() and not OPTION.search(str(error)) else f"a bad text: {error!r}"
    except TypeError as error:
        return None if SIGNATURE.search(str(error)) else f"{error!r}"
    except OSError as error:
        return None if error.filename else f"{error!r}"
    except BaseException as error:
        return f"{type(error).__name__}: {error}"
    return None


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_random_calls(gear: lf.Mechanism, folder: Path) -> None:
    random_ = random.Random(SEED)
    objects, faults = targets(gear, random_), []
    faulthandler.dump_traceback_later(60.0 + CALLS / 50.0, exit=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for number in range(CALLS):
            if number % 200 == 199:
                objects = targets(gear, random_)
            call = random_.choice(calls(random_.choice(objects)))

            def argument() -> Any:  # noqa: ANN401
                return random_.choice(BAD if random_.random() < 0.5 else good(random_, gear))

            given = [argument() for _ in range(random_.choice([0, 1, 1, 2, 2, 3]))]
            named = {}
            if random_.random() < 0.4:
                words = re.findall(r"(\w+)(?:=|,|\))", getattr(call, "__text_signature__", None) or "")
                words += list(getattr(getattr(call, "__code__", None), "co_varnames", ()))[: len(given) + 8]
                if words := [word for word in words if word not in ("self", "cls")]:
                    named = {random_.choice(words): argument()}
            fault = tried(call, given, named)
            if fault is not None:
                shown = ", ".join([*map(repr, given), *(f"{key}={value!r}" for key, value in named.items())])
                name = getattr(call, "__qualname__", repr(call))
                faults.append(f"{number}: {name}({shown[:300]}): {fault[:300]}")
    faulthandler.cancel_dump_traceback_later()
    assert not faults, "\n".join(faults)
    assert len(gear.simulate(stop_time=0.01, output=["crank.angle"])) > 1


def test_threads_that_share_a_simulation(gear: lf.Mechanism) -> None:
    """One thread at a time. The others get an exception, and all values are consistent."""
    simulation, faults, gave_way = gear.simulation(), [], []
    simulation.initialize()

    def work(seed: int) -> None:
        random_ = random.Random(seed)
        for _ in range(60):
            call = random_.choice(
                [
                    lambda: simulation.run_until(simulation.time + 1e-4),
                    lambda: simulation.get(["crank.angle", "crank.speed"]),
                    lambda: simulation.set(["load_factor"], [random_.random()]),
                    lambda: repr(simulation),
                    lambda: simulation.restore(simulation.save()),
                ]
            )
            try:
                call()
            except lf.SimulationError as error:
                gave_way.append(str(error))
            except lf.InputError as error:
                # Another thread has advanced the time between two calls.
                if "present time" not in str(error):
                    faults.append(repr(error))
            except BaseException as error:
                faults.append(repr(error))

    threads = [threading.Thread(target=work, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not faults
    assert all("another thread" in text for text in gave_way), gave_way
    assert np.isfinite(simulation["crank.angle"])
