"""The job on the simulated machine with motors, gears and friction: how far is the platform from where it should be?"""

from pathlib import Path

import numpy as np

from trirrr import Machine

machine = Machine.from_scene(Path(__file__).resolve().parents[3] / "scenes/plant-thesis.toml")
run = machine.run()
if run.plant is None or not run.is_complete:
    raise SystemExit(run.reason)
away = np.hypot(run.plant["x"] - run.plant["xref"], run.plant["y"] - run.plant["yref"])
worst = int(away.argmax())
print(f"largest distance {away[worst]:.3e} m at t = {run.plant['t'][worst]:.4f} s")
print("peak currents, A:", np.abs(run.plant.columns("i1", "i2", "i3")).max(axis=0))
