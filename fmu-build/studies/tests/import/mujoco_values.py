"""Accelerations of small mechanisms by MuJoCo, for the tests of the import: writes `files/mujoco.json`.

It also writes `files/mujoco_schema.txt`, the elements and attributes of MJCF.

    pip install mujoco==4.0.0 numpy && python mujoco_values.py

A case consists of MJCF, the joint that is held while loops are closed, its speed, controls, and outputs of the imported
definition as sums over joints. MuJoCo's own constraints are soft. Here its mass matrix, forces and constraint Jacobian
give the accelerations for rigid constraints.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import mujoco
import numpy as np
from mujoco_cases import cases


class Rigid:
    """A model with rigid constraints."""

    def __init__(self, case: dict) -> None:
        files = {name: text.encode() for name, text in case.get("files", {}).items()}
        self.model = mujoco.MjModel.from_xml_string(case["mjcf"], files)
        self.data = mujoco.MjData(self.model)
        for name, value in case.get("control", {}).items():
            self.data.ctrl[self.model.actuator(name).id] = value
        self.held = self.model.joint(case.get("held", "swing")).dofadr[0]
        self.close()
        _, jacobian = self.constraints(self.data.qpos)
        hold = np.eye(1, self.model.nv, self.held)
        speed = np.append(np.zeros(len(jacobian)), case.get("speed", 0.0))
        self.data.qvel[:] = np.linalg.lstsq(np.vstack([jacobian, hold]), speed, rcond=None)[0]

    def constraints(self, qpos: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals and Jacobian of the equalities at a position."""
        data = mujoco.MjData(self.model)
        data.qpos[:] = qpos
        mujoco.mj_forward(self.model, data)
        rows = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        return data.efc_pos[rows], data.efc_J.reshape(-1, self.model.nv)[rows]

    def close(self) -> None:
        """Close the loops. The held joint keeps its position in the file."""
        for _ in range(30):
            gap, jacobian = self.constraints(self.data.qpos)
            hold = np.eye(1, self.model.nv, self.held)
            step = np.linalg.lstsq(np.vstack([jacobian, hold]), np.append(-gap, 0.0), rcond=None)[0]
            self.data.qpos += step

    def acceleration(self) -> np.ndarray:
        model, data = self.model, self.data
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        force = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
        # MuJoCo softens friction losses too. Here Coulomb's law in motion applies.
        if not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS:
            force -= model.dof_frictionloss * np.sign(data.qvel)
        _, jacobian = self.constraints(data.qpos)
        h = 1e-3

        def rate(h: float) -> np.ndarray:
            ahead, behind = (self.constraints(data.qpos + sign * h * data.qvel)[1] for sign in (1, -1))
            return (ahead - behind) @ data.qvel / (2 * h)

        drift = (4 * rate(h / 2) - rate(h)) / 3
        count = len(jacobian)
        whole = np.block([[mass, jacobian.T], [jacobian, np.zeros((count, count))]])
        return np.linalg.lstsq(whole, np.append(force, -drift), rcond=1e-12)[0][: model.nv]

    def summed(self, numbers: np.ndarray, of: dict) -> float:
        """Sum over joints of the numbers of their coordinates with their signs."""
        return float(sum(sign * numbers[self.model.joint(joint).dofadr[0]] for joint, sign in of.items()))

    def travel(self, span: float) -> np.ndarray:
        """Change of the coordinates in a time, by the Runge-Kutta method in steps of 0.1 ms."""
        model, data = self.model, self.data
        model.opt.integrator, model.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, 1e-4
        start = data.qpos.copy()
        for _ in range(round(span / model.opt.timestep)):
            mujoco.mj_step(model, data)
        return data.qpos - start


def schema() -> list[str]:
    """Elements by their paths, each with its attributes."""
    lines, path = [], []
    for line in mujoco.mj_printSchema(False, False).splitlines():
        found = re.match(r"( *)([(\w)]+) \([!?*R]\) *(.*)", line)
        if found:
            path = [*path[: len(found[1]) // 3], found[2].replace("(world)body", "worldbody/body")]
            lines.append(["/".join(path), found[3]])
        elif line.strip():
            lines[-1][1] += " " + line.strip()
    return [f"{path}: {' '.join(names.split())}".strip() for path, names in lines if "/default/" not in path]


def main() -> None:
    written = []
    for case in cases():
        rigid = Rigid(case)
        found = rigid.acceleration()
        outputs = case.pop("outputs")
        value = {name: rigid.summed(found, of) for name, of in outputs.items()}
        if "span" in case:
            moved = rigid.travel(case["span"])
            travels = {name.replace("acceleration", "angle"): rigid.summed(moved, of) for name, of in outputs.items()}
            case["travel"] = travels
        inertia = {
            name: repr(float(max(rigid.model.body(name).inertia)))
            for name in ("arm", "other", "crank", "rod", "rocker")
            if f'name="{name}"' in case["mjcf"]
        }
        for key in ("urdf", "sdf"):
            if key in case and "other" in inertia:
                case[key] = case[key].format(iyy=inertia["arm"], other=inertia["other"])
            elif key in case:
                # The rod in SDF is rotated by 30 rad about y, together with its centre.
                at, sin, cos = [0.2, 0.05], np.sin(30.0), np.cos(30.0)
                case[key] = case[key].format(
                    **inertia,
                    crank_angle=0.3,
                    crank_x=inertia["crank"],
                    rod_mass=repr(float(rigid.model.body("rod").mass[0])),
                    rod_x=repr(float(cos * at[0] - sin * at[1])),
                    rod_z=repr(float(sin * at[0] + cos * at[1])),
                )
        written.append(case | {"accelerations": {name: float(number) for name, number in value.items()}})
        print(case["name"], written[-1]["accelerations"])
    folder = Path(__file__).parent / "files"
    (folder / "mujoco.json").write_text(json.dumps(written, indent=1) + "\n", encoding="utf-8")
    (folder / "mujoco_schema.txt").write_text("\n".join(schema()) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
