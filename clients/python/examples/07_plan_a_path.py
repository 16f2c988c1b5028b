"""The least time of a path, with a proven lower bound, and its moves as a table."""

from pathlib import Path

from trirrr import Machine

OUT = Path("out/python")
OUT.mkdir(parents=True, exist_ok=True)

machine = Machine.from_scene(Path(__file__).resolve().parents[3] / "scenes/plotter.toml")
plan = machine.plan()
print(f"{plan.duration_s:.4f} s played; no motion along the path takes less than {plan.lower_bound_s:.4f} s")
plan.moves.to_csv(OUT / "moves.csv")
print(f"{len(plan.moves.rows) - 1} moves in {OUT / 'moves.csv'}; a board plays them with Board.run(scene, moves=...)")
