"""EXUDYN: rigid bodies in the plane with revolute joints, by its implicit integrators.

Its explicit integrators do not support joints (EXUDYN's documentation, "Explicit solvers"), hence no closed loops.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import partial

import exudyn
from exudyn import itemInterface as items
from measure import Point, fastest
from scenes import GROUND, Scene, Vector

TOOL = "EXUDYN"
NEWTON = ((1e-12, False), (1e-9, True), (1e-6, False), (1e-6, True))
"""Tolerances of Newton's iterations, relative and absolute, and whether they keep their Jacobian. With small steps a
loose tolerance limits the error, so that only the first is used there."""
STEPS = (*(n * ten for ten in (1, 10) for n in (10, 13, 16, 20, 25, 32, 40, 50, 63, 80)), 1000, 1300, 2000)
SMALL_STEPS = (5000, 10_000, 20_000, 50_000)
"""Numbers of equal steps."""


class Model:
    """A scene in EXUDYN, ready to run."""

    def __init__(self, scene: Scene) -> None:
        self.container = exudyn.SystemContainer()
        self.system = system = self.container.AddSystem()
        self.scene = scene
        ground = system.AddObject(items.ObjectGround())
        self.nodes, self.bodies = [], []
        for body in scene.bodies:
            node = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[*body.centre, 0.0]))
            number = system.AddObject(items.ObjectRigidBody2D(mass=body.mass, inertia=body.inertia, nodeNumber=node))
            weight = [body.mass * g for g in scene.gravity]
            centre = system.AddMarker(items.MarkerBodyPosition(bodyNumber=number))
            system.AddLoad(items.LoadForceVector(markerNumber=centre, loadVector=[*weight, 0.0]))
            self.nodes.append(node)
            self.bodies.append(number)

        def marker(body: int, at: Vector) -> int:
            centre = (0.0, 0.0) if body == GROUND else scene.bodies[body].centre
            number = ground if body == GROUND else self.bodies[body]
            local = [at[0] - centre[0], at[1] - centre[1], 0.0]
            return system.AddMarker(items.MarkerBodyPosition(bodyNumber=number, localPosition=local))

        for joint in scene.joints:
            markers = [marker(joint.first, joint.at), marker(joint.second, joint.at)]
            system.AddObject(items.ObjectJointRevolute2D(markerNumbers=markers))
        for strut in scene.struts:
            markers = [marker(strut.first, strut.from_), marker(strut.second, strut.to)]
            law = {"referenceLength": strut.free_length, "stiffness": strut.stiffness, "force": -strut.push}
            system.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=markers, **law))
        if scene.torque:
            turned = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=self.nodes[0], coordinate=2))
            system.AddLoad(items.LoadCoordinate(markerNumber=turned, load=scene.torque))
        system.Assemble()

    def run(self, settings: exudyn.SimulationSettings, solver: exudyn.DynamicSolverType) -> float:
        """Angle of body 0 at the end [rad]."""
        self.system.SolveDynamic(settings, solverType=solver, updateInitialValues=False, storeSolver=False)
        coordinates = self.system.GetNodeOutput(self.nodes[0], exudyn.OutputVariableType.Coordinates)
        return self.scene.start + float(coordinates[2])


def settings(
    span: float, steps: int, radius: float | None, tolerance: float, modified: bool
) -> exudyn.SimulationSettings:
    """Solver settings: equal steps, Newton's iterations, no output. `radius`: spectral radius at infinity."""
    result = exudyn.SimulationSettings()
    result.solution.file.write = False
    integration = result.timeIntegration
    integration.endTime, integration.numberOfSteps = span, steps
    integration.adaptiveStep = False
    integration.newton.useModifiedNewton = modified
    integration.newton.relativeTolerance = integration.newton.absoluteTolerance = tolerance
    if radius is not None:
        integration.generalizedAlpha.spectralRadius = radius
    return result


def points(scene: Scene) -> Iterator[Point]:
    """All curves. A line states each step size for which Newton's iterations fail."""
    exudyn.config.printToConsole = False
    solvers = exudyn.DynamicSolverType
    curves = [
        ("generalised alpha; radius 1", solvers.GeneralizedAlpha, 1.0),
        ("generalised alpha; radius 0.9", solvers.GeneralizedAlpha, 0.9),
        ("trapezoidal; index 2", solvers.TrapezoidalIndex2, None),
    ]
    sweep = [(steps, *newton) for steps in STEPS for newton in NEWTON]
    sweep += [(steps, *NEWTON[0]) for steps in SMALL_STEPS]
    for method, solver, radius in curves:
        for steps, tolerance, modified in sweep:
            began = time.perf_counter()
            model = Model(scene)
            setup = time.perf_counter() - began
            setting = f"{steps} steps; Newton {tolerance:.0e}{' modified' if modified else ''}"

            try:
                chosen = settings(scene.span, steps, radius, tolerance, modified)
                angle, seconds = fastest(partial(model.run, chosen, solver))
            except (ValueError, RuntimeError) as error:
                print(f"{TOOL} {scene.name} {method}; {setting}: {str(error).splitlines()[0]}")
                continue
            yield Point(scene.name, TOOL, method, setting, abs(angle - scene.exact), seconds, setup)
