"""All working modes at a pose, and all assembly modes at the motor angles of that pose."""

from pathlib import Path

import numpy as np

from trirrr import Machine

machine = Machine.from_scene(Path(__file__).resolve().parents[3] / "scenes/thesis.toml")
for elbows, angles in machine.working_modes(machine.start).items():
    print("elbows", elbows, "motors, deg", np.degrees(angles).round(2))

found = machine.forward(machine.angles(machine.start))
for pose, parallel in zip(found.poses[: found.counts], found.parallel, strict=False):
    print("pose", pose.round(4), "distance from the parallel singularity", parallel.round(4))
