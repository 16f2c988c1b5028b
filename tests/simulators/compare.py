"""Torques of `trirrr run` against MuJoCo and Pinocchio, which load what `trirrr export` writes.

python compare.py TRIRRR SCENES

Both give the mass matrix M, the bias h and the places of frames of the open tree. With the motion of a row of ticks.csv,

    M q'' + h = S' tau + J' lambda + P' w

has the three torques tau and the forces lambda in the loops as its only unknowns; w is the wrench of the scene on the platform. Nothing is
simulated, so no tolerance of a solver counts.
"""

import csv
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import mujoco
import numpy as np
import pinocchio as pin

# A scene, and the greatest difference of a torque as a part of the greatest one. Links of the thesis machine have no mass; simulators
# get 1e-6 kg, two millionths of the platform's.
SCENES = {"thesis": 3e-5, "thesis-links": 1e-9, "vertical": 1e-9}

LEGS = (1, 2, 3)


def rows(trirrr, scene, folder):
    """Rows of ticks.csv as dictionaries of numbers."""
    subprocess.run(
        [trirrr, "run", scene, "--fast", "--scalar", "f64", "--out", folder / "run"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    with open(folder / "run/ticks.csv", newline="") as table:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(table)]


def exported(trirrr, scene, folder, form):
    file = folder / f"machine.{form}"
    subprocess.run(
        [trirrr, "export", scene, "--format", form, "--out", file],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    return file


def wrench_of(scene):
    """Force, N, and moment, N m, of the scene on the platform at D."""
    with open(scene, "rb") as file:
        wrench = tomllib.load(file).get("wrench", {})
    return np.array([*wrench.get("force_n", [0.0, 0.0]), wrench.get("torque_nm", 0.0)])


def torques(mass, bias, acceleration, motors, loops):
    """Torques of the motors at the places `motors` of the coordinates; `loops` has a row for each equation of the loops, and the
    wrench is a part of `bias`."""
    unknowns = np.zeros((len(bias), 3 + len(loops)))
    for column, place in enumerate(motors):
        unknowns[place, column] = 1.0
    unknowns[:, 3:] = loops.T
    wanted = mass @ acceleration + bias
    found, *_ = np.linalg.lstsq(unknowns, wanted, rcond=None)
    assert np.allclose(unknowns @ found, wanted, atol=1e-9 * np.abs(wanted).max() + 1e-15)
    return found[:3]


def motion(row, leg, order):
    """Angles of the proximal link and of the elbow of a leg, or a derivative."""
    prefix = "d" * order
    first, second = row[f"{prefix}th1_{leg}"], row[f"{prefix}th2_{leg}"]
    return first, second - first


def platform(row, order):
    return [row[("", "v", "a")[order] + name] for name in ("x", "y", "alpha")]


def by_mujoco(file, table, wrench):
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    motors = [model.joint(f"leg{leg}_motor").dofadr[0] for leg in LEGS]
    load = np.zeros(model.nv)
    for name, value in zip(("x", "y", "alpha"), wrench):
        load[model.joint(f"platform_{name}").dofadr[0]] = value
    for row in table:
        values = []
        for order in range(3):
            angles = [angle for leg in LEGS for angle in motion(row, leg, order)]
            values.append(np.array(angles + platform(row, order)))
        data.qpos[:], data.qvel[:] = values[0], values[1]
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        loops = []
        for leg in LEGS:
            ends = []
            for name in ("end", "joint"):
                place = np.zeros((3, model.nv))
                mujoco.mj_jacSite(model, data, place, None, model.site(f"leg{leg}_{name}").id)
                ends.append(place[:2])
            loops.append(ends[0] - ends[1])
            gap = data.site(f"leg{leg}_end").xpos - data.site(f"leg{leg}_joint").xpos
            assert np.abs(gap).max() < 1e-9, gap
        yield torques(mass, data.qfrc_bias - load, values[2], motors, np.vstack(loops))


def by_pinocchio(file, table, gravity, wrench):
    model = pin.buildModelFromUrdf(str(file))
    model.gravity.linear = np.array([*gravity, 0.0])
    data = model.createData()
    joint = {name: model.joints[model.getJointId(name)] for name in model.names}
    motors = [joint[f"leg{leg}_motor"].idx_v for leg in LEGS]
    for row in table:
        values = np.zeros((3, model.nv))
        for order in range(3):
            for leg in LEGS:
                first, second = motion(row, leg, order)
                values[order, joint[f"leg{leg}_motor"].idx_v] = first
                values[order, joint[f"leg{leg}_elbow"].idx_v] = second
            turned = platform(row, order)[2] - sum(motion(row, 1, order))
            values[order, joint["leg1_joint"].idx_v] = turned
        # A continuous joint is a point on a circle.
        place = pin.integrate(model, pin.neutral(model), values[0])
        mass = pin.crba(model, data, place)
        mass = np.triu(mass) + np.triu(mass, 1).T
        bias = pin.nonLinearEffects(model, data, place, values[1])
        turn = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        tool = pin.computeFrameJacobian(model, data, place, model.getFrameId("tool"), turn)
        bias = bias - tool[[0, 1, 5]].T @ wrench
        loops = []
        for leg in (2, 3):
            ends = []
            for name in ("end", "joint"):
                frame = model.getFrameId(f"leg{leg}_{name}")
                ends.append(pin.computeFrameJacobian(model, data, place, frame, turn)[:2].copy())
            loops.append(ends[0] - ends[1])
            pin.framesForwardKinematics(model, data, place)
            gap = [data.oMf[model.getFrameId(f"leg{leg}_{name}")].translation for name in ("end", "joint")]
            assert np.abs(gap[0] - gap[1]).max() < 1e-9, gap
        yield torques(mass, bias, values[2], motors, np.vstack(loops))


def main(trirrr, scenes):
    print(f"MuJoCo {mujoco.__version__}, Pinocchio {pin.__version__}")
    print("| scene | setpoints | greatest torque, N m | MuJoCo | Pinocchio |")
    print("|---|---:|---:|---:|---:|")
    for name, most in SCENES.items():
        scene = scenes / f"{name}.toml"
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            table = rows(trirrr, scene, folder)
            wanted = np.array([[row[f"tau{leg}"] for leg in LEGS] for row in table])
            mjcf = exported(trirrr, scene, folder, "mjcf")
            wrench = wrench_of(scene)
            gravity = mujoco.MjModel.from_xml_path(str(mjcf)).opt.gravity[:2]
            found = [
                np.array(list(by_mujoco(mjcf, table, wrench))),
                np.array(list(by_pinocchio(exported(trirrr, scene, folder, "urdf"), table, gravity, wrench))),
            ]
        greatest = np.abs(wanted).max()
        parts = [np.abs(each - wanted).max() / greatest for each in found]
        print(f"| {name} | {len(table)} | {greatest:.4f} | {parts[0]:.1e} | {parts[1]:.1e} |")
        assert max(parts) < most, f"{name}: {parts}, of the greatest torque {most} at most"


if __name__ == "__main__":
    main(sys.argv[1], pathlib.Path(sys.argv[2]))
