"""The verdict of the machine's service on a move, before any board is there: every instant is proven, or the move is refused."""

from pathlib import Path

from trirrr import Machine

machine = Machine.from_scene(Path(__file__).resolve().parents[3] / "scenes/thesis.toml")
goal = (0.26, 0.26, 0.2)

verdict = machine.admit(goal, duration_s=0.1)
print("0.1 s:", verdict.reason or "admitted")
if verdict.enough_s is not None:
    verdict = machine.admit(goal, verdict.enough_s)
    print("as long as it takes:", verdict.reason or "admitted")
print("out of reach:", machine.admit((0.9, 0.9, 0.0), 5.0).reason)
