"""A design study: which link lengths and working mode take the least torque? In parts, over two processes.

Needs the program `trirrr` on the path, or named by TRIRRR.
"""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from trirrr import Machine, study

SCENE = Path(__file__).resolve().parents[3] / "scenes/design/lift.toml"

with ThreadPoolExecutor(2) as executor:
    found = study.run(
        SCENE,
        vary=["mode", "machine.leg[*].distal_m=0.12..0.15"],
        objectives=["torque"],
        evaluations=40,
        shards=2,
        executor=executor,
        arguments=["--cells", "32"],
    )
best = found["result"]["best"]
print("least torque:", best["found"], "with", best["set"])

# The machine that was found, for further questions.
machine = Machine.from_scene(SCENE, settings=best["set"])
print(machine)
