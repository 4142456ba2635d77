"""The module `build` contains functions for short definitions of mechanisms. In the functions of `build`, points are
coordinates of a drawing of the mechanism in millimetres, and angles are in degrees.

```python
from linkage_fmu import Mechanism, build

press = Mechanism(
    build.mechanism(
        "Press",
        build.body("crank", mass=1.2),
        build.body("rod", mass=0.9),
        build.body("slider", mass=0.5),
        build.pin("bearing", "ground", "crank", at=(0, 0)),
        build.pin("pin", "crank", "rod", at=(80, 60)),
        build.pin("wrist", "rod", "slider", at=(360, 0)),
        build.slide("guide", "ground", "slider", at=(360, 0)),
        build.torque("motor", on="crank", torque=2),
        build.start("crank", angle=30),
    )
)
```

The function `mechanism` returns the definition as a dict. You can add any other key of the file format to the returned
dict.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from numbers import Real
from typing import Any

from ._errors import InputError, wrong

#: Section of the definition, name in the section, keys, and the points of bodies in the drawing.
Part = tuple[str, str, dict[str, Any], dict[str, tuple[str, Sequence[float]]]]


def body(name: str, mass: float | None = None, inertia: float | None = None, **keys: object) -> Part:
    """Add a body with its mass [kg] and moment of inertia [kg.m2]. Without the argument `inertia`, a body with two pins
    is a uniform rod. Further arguments of `body` are keys of the body."""
    _texts(name=name)
    given = {"mass": mass, "inertia": inertia, **keys}
    return "bodies", name, {key: value for key, value in given.items() if value is not None}, {}


def pin(name: str, first: str, second: str, at: Sequence[float], **keys: object) -> Part:
    """A revolute joint (pin) between two bodies, at a point of the drawing [mm]."""
    return _joint("revolute", name, (first, second), at, keys)


def slide(name: str, first: str, second: str, at: Sequence[float], **keys: object) -> Part:
    """A prismatic joint (slide) between two bodies, along the x axis of the first body, at a point of the drawing
    [mm]."""
    return _joint("prismatic", name, (first, second), at, keys)


def actuator(
    name: str,
    first: tuple[str, Sequence[float]],
    second: tuple[str, Sequence[float]],
    force: float = 0.0,
    **keys: object,
) -> Part:
    """A linear actuator between two bodies, with a force [N] that is positive if the actuator pushes. The arguments
    `first` and `second` each contain a body and a point of the drawing [mm]."""
    _texts(name=name)
    for argument, end in (("first", first), ("second", second)):
        if not isinstance(end, tuple | list) or len(end) != 2:
            wrong(argument, end, 'a body and a point: ("crank", (x, y)) in mm')
        _texts(**{argument: end[0]})
    places = {first[0]: (name, first[1]), second[0]: (name, second[1])}
    ends = {"first": f"{first[0]}.{name}", "second": f"{second[0]}.{name}"}
    return "actuators", name, {**ends, "force": force, **keys}, places


def torque(name: str, on: str, torque: float = 0.0) -> Part:
    """An external torque on a body [N.m]."""
    _texts(name=name, on=on)
    return "torques", name, {"on": on, "torque": torque}, {}


def force(name: str, on: str, at: Sequence[float], **keys: object) -> Part:
    """An external force on a body at a point of the drawing [mm]."""
    _texts(name=name, on=on)
    return "forces", name, {"at": f"{on}.{name}", **keys}, {on: (name, at)}


def stop(name: str, body: str, limit: str, angle: float, **keys: object) -> Part:
    """A stop that limits the angle of a body [deg]. The argument `limit` is "lower" or "upper"."""
    _texts(name=name, body=body)
    return "stops", name, {"body": body, "limit": limit, "angle": angle, **keys}, {}


def start(body: str, angle: float | None = None, **keys: object) -> Part:
    """Start position of the mechanism: the angle of a body [deg]."""
    _texts(body=body)
    given = {"body": body, "angle": angle, **keys}
    return "start", "", {key: value for key, value in given.items() if value is not None}, {}


def mechanism(name: str, *parts: Part, **keys: object) -> dict[str, Any]:
    """Return the definition of a mechanism that consists of the given parts. Further arguments of `mechanism` are keys
    of the definition, such as `gravity`.

    In the definition that `mechanism` returns, the first point of each body has the name `origin`, and the second point
    has the name `end`. Any other point of a body has the name of the joint or load at the point.

    Raises:
        InputError: two parts of one type in `parts` have the same name, or a point is not a pair of numbers.
    """
    bodies: dict[str, dict[str, Any]] = {"ground": {}}
    sections: dict[str, Any] = {}
    for part in parts:
        if not isinstance(part, tuple) or len(part) != 4:
            wrong("parts", part, "a part that build.body, build.pin, build.slide or a similar function returns")
    for section, own, values, _ in parts:
        if section == "start":
            sections["start"] = values
            continue
        target = bodies if section == "bodies" else sections.setdefault(section, {})
        if own in target and not (section == "bodies" and own == "ground"):
            raise InputError(f"{section}.{own}: two parts have this name; rename one of the two parts")
        target[own] = dict(values)
    for section, own, _, places in parts:
        for body_name, (point, at) in places.items():
            place = at.tolist() if hasattr(at, "tolist") else at
            numbers = list(place) if isinstance(place, Iterable) else []
            if len(numbers) != 2 or not all(isinstance(number, Real) for number in numbers):
                raise InputError(f"{own}: {at!r} is not a point; write (x, y) in mm")
            named = _place(bodies.setdefault(body_name, {}), body_name == "ground", point, numbers)
            for key in ("first", "second", "at"):
                entry = sections.get(section, {}).get(own, {})
                if entry.get(key) == f"{body_name}.{point}":
                    entry[key] = f"{body_name}.{named}"
    if not bodies["ground"].get("points", True):
        del bodies["ground"]["points"]
    for values in bodies.values():
        drawn = values.get("drawn", {})
        if "mass" in values and "end" in drawn and not {"inertia", "shape"} & values.keys():
            values["shape"] = "uniform_rod"
    return {"name": name, "units": {"angle": "deg", "length": "mm"}, "bodies": bodies, **sections, **keys}


def _texts(**given: object) -> None:
    """Check that these arguments are names."""
    for argument, value in given.items():
        if not isinstance(value, str):
            wrong(argument, value, "a name")


def _joint(kind: str, name: str, bodies: tuple[str, str], at: Sequence[float], keys: dict[str, Any]) -> Part:
    first, second = bodies
    _texts(name=name, first=first, second=second)
    places = {first: (name, at), second: (name, at)}
    return "joints", name, {"type": kind, "first": f"{first}.{name}", "second": f"{second}.{name}", **keys}, places


def _place(values: dict[str, Any], is_ground: bool, point: str, at: list[float]) -> str:
    """Draw a point of a body. Returns the name of the point. The frame of the drawing is that of the ground."""
    drawn: dict[str, list[float]] = values.setdefault("points" if is_ground else "drawn", {})
    if is_ground and at == [0, 0]:
        return "origin"
    for known, place in drawn.items():
        if place == at:
            return known
    named = point if is_ground else "origin" if not drawn else "end" if "end" not in drawn else point
    drawn[named] = at
    return named
