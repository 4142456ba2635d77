"""MuJoCo: a tree of hinges, with the loops closed by the equality constraint `connect`."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from xml.etree import ElementTree

import mujoco
from measure import Point, fastest
from scenes import GROUND, Scene, Vector, less

TOOL = "MuJoCo"


def numbers(*values: float) -> str:
    """Numbers as XML text that parses to the same bits."""
    return " ".join(map(repr, values))


def definition(scene: Scene, integrator: str, h: float, solref: Vector) -> str:
    """The scene as MJCF. Each body's frame has its origin at the joint to its parent and the axes of the plane."""
    root = ElementTree.Element("mujoco")
    solver = {"solver": "Newton", "tolerance": "1e-15", "iterations": "100", "jacobian": "dense"}
    gravity = numbers(*scene.gravity, 0.0)
    option = ElementTree.SubElement(root, "option", solver, timestep=repr(h), integrator=integrator, gravity=gravity)
    ElementTree.SubElement(option, "flag", contact="disable", refsafe="disable", limit="disable")
    world = ElementTree.SubElement(root, "worldbody")
    elements, origins = {GROUND: world}, {GROUND: (0.0, 0.0)}
    for joint in scene.tree:
        number, body = joint.second, scene.bodies[joint.second]
        at = less(joint.at, origins[joint.first])
        element = ElementTree.SubElement(elements[joint.first], "body", name=f"b{number}", pos=numbers(*at, 0.0))
        ElementTree.SubElement(element, "joint", name=f"j{number}", type="hinge", axis="0 0 1")
        centre, inertia = numbers(*less(body.centre, joint.at), 0.0), numbers(*[body.inertia] * 3)
        ElementTree.SubElement(element, "inertial", mass=repr(body.mass), pos=centre, diaginertia=inertia)
        elements[number], origins[number] = element, joint.at
    equality = ElementTree.SubElement(root, "equality")
    for joint in scene.loops:
        bodies = {"body1": f"b{joint.first}", "body2": f"b{joint.second}"}
        soft = {"solref": numbers(*solref), "solimp": "0.9999 0.9999 1 0.5 1"}
        anchor = numbers(*less(joint.at, origins[joint.first]), 0.0)
        ElementTree.SubElement(equality, "connect", bodies | soft, anchor=anchor)
    tendons, actuators = ElementTree.SubElement(root, "tendon"), ElementTree.SubElement(root, "actuator")
    for i, strut in enumerate(scene.struts):
        tendon = ElementTree.SubElement(tendons, "spatial", name=f"t{i}")
        if strut.stiffness:
            tendon.set("stiffness", repr(strut.stiffness))
            tendon.set("springlength", repr(strut.free_length))
        for end, (number, at) in enumerate(((strut.first, strut.from_), (strut.second, strut.to))):
            local = less(at, origins[number])
            ElementTree.SubElement(elements[number], "site", name=f"s{i}{end}", pos=numbers(*local, 0.0))
            ElementTree.SubElement(tendon, "site", site=f"s{i}{end}")
        ElementTree.SubElement(actuators, "motor", tendon=f"t{i}", gear=repr(strut.push))
    ElementTree.SubElement(actuators, "motor", joint="j0", gear=repr(scene.torque))
    return ElementTree.tostring(root, encoding="unicode")


def points(scene: Scene) -> Iterator[Point]:
    """All curves: integrators with their best ratio of the constraint's time constant to the step and the next ratios.

    Steps for which the motion diverges are omitted.
    """
    mujoco.set_mju_user_warning(lambda _: None)
    curves = [("RK4", 1.0, 20_000), ("RK4", 2.0, 100_000), ("RK4", 4.0, 20_000)]
    curves += [("Euler", 2.0, 50_000), ("implicit", 2.0, 50_000)]
    for integrator, ratio, most in curves:
        for steps in (10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000, 50_000, 100_000):
            if steps > most:
                break
            h = scene.span / steps
            began = time.perf_counter()
            model = mujoco.MjModel.from_xml_string(definition(scene, integrator, h, (ratio * h, 1.0)))
            data = mujoco.MjData(model)
            setup = time.perf_counter() - began

            def run(model: mujoco.MjModel = model, data: mujoco.MjData = data, steps: int = steps) -> float:
                mujoco.mj_resetData(model, data)
                data.ctrl[:] = 1.0
                mujoco.mj_step(model, data, nstep=steps)
                return scene.start + float(data.qpos[0])

            if diverges(run, data):
                continue
            angle, seconds = fastest(run)
            setting = f"{steps} steps; time constant {ratio:g} h"
            yield Point(scene.name, TOOL, integrator, setting, abs(angle - scene.exact), seconds, setup)


def diverges(run: Callable[[], float], data: mujoco.MjData) -> bool:
    """Whether MuJoCo has reset the simulation because the motion diverged."""
    run()
    return data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number > 0
