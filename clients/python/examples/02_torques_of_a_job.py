"""Torques of a scene's job over arrays, and the largest of each motor."""

from pathlib import Path

import numpy as np

from trirrr import Machine

SCENES = Path(__file__).resolve().parents[3] / "scenes"

machine = Machine.from_scene(SCENES / "thesis.toml")
job = machine.setpoints()
motors = machine.motors(job.poses, job.velocities, job.accelerations)
print("peak torque, N m:  ", np.abs(motors.torques).max(axis=0))
print("RMS torque, N m:   ", np.sqrt((motors.torques**2).mean(axis=0)))
print("peak speed, 1/min: ", np.abs(motors.rates).max(axis=0) * 60 / (2 * np.pi))
print("bearing at A, N:   ", np.linalg.norm(machine.reactions(*job[1:]), axis=-1).max(axis=0)[:, 0])
