"""States a second: angles, rates, accelerations and torques of the motors, on one core. Build with `pip install` for true figures."""

import os

os.environ["RAYON_NUM_THREADS"] = "1"

import time
from pathlib import Path

import numpy as np

from trirrr import Machine

STATES = 1_000_000

machine = Machine.from_scene(Path(__file__).resolve().parents[3] / "scenes/thesis.toml")
draw = np.random.default_rng(1)
poses = np.array([0.245, 0.25, 0.18]) + draw.uniform(-1, 1, (STATES, 3)) * [0.035, 0.03, 0.05]
velocities = draw.uniform(-0.1, 0.1, (STATES, 3))
accelerations = draw.uniform(-0.5, 0.5, (STATES, 3))

seconds = []
for _ in range(7):
    # Time of this process on the core: what others do there does not count.
    begin = time.process_time()
    machine.motors(poses, velocities, accelerations)
    seconds.append(time.process_time() - begin)
print(f"{STATES / min(seconds) / 1e6:.2f} million states a second on one core, with torques")
