"""The two mechanisms as plane bodies, joints and forces, from which the models of EXUDYN and MuJoCo are built.

Points have their positions at the start, in the plane's frame; angles are relative to the start. The compared angle is
that of the first body.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import atan2, cos, hypot, pi, sin, sqrt

Vector = tuple[float, float]

GROUND = -1
"""Number of the fixed body."""


@dataclass(frozen=True)
class Body:
    """A rigid body: mass [kg], inertia about the centre of mass [kg m2], centre of mass [m]."""

    mass: float
    inertia: float
    centre: Vector


@dataclass(frozen=True)
class Joint:
    """A revolute joint of two bodies at a point [m]."""

    first: int
    second: int
    at: Vector


@dataclass(frozen=True)
class Strut:
    """A force between two points of two bodies: constant and repulsive [N], or a spring [N/m, m]."""

    first: int
    from_: Vector
    second: int
    to: Vector
    push: float = 0.0
    stiffness: float = 0.0
    free_length: float = 0.0


@dataclass(frozen=True)
class Scene:
    """A mechanism at rest, the loads on it, and the exact angle of body 0 after a time."""

    name: str
    span: float
    """Length of the run [s]."""
    start: float
    """Angle of body 0 at the start [rad]."""
    exact: float
    """Angle of body 0 at the end [rad]."""
    bodies: list[Body]
    joints: list[Joint]
    struts: list[Strut]
    gravity: Vector = (0.0, 0.0)
    """Acceleration of gravity [m/s2]."""
    torque: float = 0.0
    """Torque on body 0 [N m]."""
    tree: list[Joint] = field(init=False)
    """The joint of each body, in the order of the list, with an earlier body or the ground."""
    loops: list[Joint] = field(init=False)
    """The other joints."""

    def __post_init__(self) -> None:
        hung: set[int] = {GROUND}
        tree, loops = [], []
        for joint in self.joints:
            if joint.second in hung:
                loops.append(joint)
            else:
                hung.add(joint.second)
                tree.append(joint)
        object.__setattr__(self, "tree", tree)
        object.__setattr__(self, "loops", loops)


def add(a: Vector, b: Vector) -> Vector:
    """Sum of two vectors."""
    return (a[0] + b[0], a[1] + b[1])


def less(a: Vector, b: Vector) -> Vector:
    """Difference of two vectors."""
    return (a[0] - b[0], a[1] - b[1])


def polar(length: float, angle: float) -> Vector:
    """Vector of this length and direction."""
    return (length * cos(angle), length * sin(angle))


def place(origin: Vector, angle: float, local: Vector) -> Vector:
    """Position of a point of a body's frame."""
    c, s = cos(angle), sin(angle)
    return (origin[0] + c * local[0] - s * local[1], origin[1] + s * local[0] + c * local[1])


def middle(a: Vector, b: Vector) -> Vector:
    """The middle of two points."""
    return ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)


def landing_gear() -> Scene:
    """Scene S1: 30 kN, load factor 3, from rest at theta2 = 0.8 rad."""
    theta2, a, d = 0.8, (0.0, 0.0), (0.5729, 0.0)
    coupler, follower = 0.217, 0.34
    b = polar(0.1755, theta2)
    wheel = polar(0.759, theta2 - 2.4)
    diagonal = less(d, b)
    length = hypot(*diagonal)
    along = (coupler**2 - follower**2 + length**2) / (2 * length)
    c = place(b, atan2(diagonal[1], diagonal[0]), (along, sqrt(coupler**2 - along**2)))
    theta4 = atan2(c[1] - d[1], c[0] - d[0])

    crank, leg, tyre = 13.689, 36.8, 19.5
    mass = crank + leg + tyre
    parts = [(crank, middle(a, b)), (leg, middle(a, wheel)), (tyre, wheel)]
    centre = (sum(m * x for m, (x, _) in parts) / mass, sum(m * y for m, (_, y) in parts) / mass)
    about_a = crank * 0.1755**2 / 3 + (leg / 3 + tyre) * 0.759**2

    def rod(mass: float, first: Vector, second: Vector) -> Body:
        return Body(mass, mass * hypot(*less(second, first)) ** 2 / 12, middle(first, second))

    chi = pi / 2 - 1.13
    return Scene(
        name="S1",
        span=0.13,
        start=theta2,
        exact=-1.2377117266891367,
        bodies=[
            Body(mass, about_a - mass * (centre[0] ** 2 + centre[1] ** 2), centre),
            rod(0.72037056, b, c),
            rod(3.850704, d, c),
        ],
        joints=[Joint(GROUND, 0, a), Joint(0, 1, b), Joint(GROUND, 2, d), Joint(1, 2, c)],
        struts=[Strut(0, place(a, theta2, (-0.050, -0.138)), 2, place(d, theta4, (0.020, 0.120)), push=30e3)],
        gravity=(-3 * 9.81 * sin(chi), -3 * 9.81 * cos(chi)),
    )


def squeezer() -> Scene:
    """Andrews' squeezing mechanism: seven bodies, three loops (Hairer & Wanner)."""
    beta, gamma, delta = -0.061713890014276496, 0.45527981916307038, 0.48736497954384255
    phi, epsilon = 0.22266839016588588, 1.2305474445498212
    o, a, b, c = (0.0, 0.0), (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
    k3, k4, k6, k7 = gamma, phi + delta, epsilon - phi, epsilon
    p = polar(0.007, beta)
    e = place(b, k3, (0.0, -0.035))
    g = add(a, polar(0.04, delta))
    h = place(a, k7, (0.0, -0.04))
    bodies = [
        Body(0.04325, 2.194e-6, polar(0.00092, beta)),
        Body(0.00365, 4.410e-7, place(p, beta, (-0.0115, 0.0))),
        Body(0.02373, 5.255e-6, place(b, k3, (0.01043, -0.01874))),
        Body(0.00706, 5.667e-7, place(g, k4, (0.0, -0.00579))),
        Body(0.07050, 1.169e-5, place(a, delta, (0.02308, 0.00916))),
        Body(0.00706, 5.667e-7, place(h, k6, (0.00579, 0.0))),
        Body(0.05498, 1.912e-5, place(a, k7, (0.00449, -0.01228))),
    ]
    joints = [
        Joint(GROUND, 0, o),
        Joint(0, 1, p),
        Joint(GROUND, 2, b),
        Joint(GROUND, 4, a),
        Joint(GROUND, 6, a),
        Joint(4, 3, g),
        Joint(6, 5, h),
        *(Joint(1, other, e) for other in (2, 3, 5)),
    ]
    spring = Strut(2, place(b, k3, (0.02, -0.018)), GROUND, c, stiffness=4530.0, free_length=0.07785)
    return Scene("Andrews", 0.03, beta, 15.8107711951537971, bodies, joints, [spring], torque=0.033)
