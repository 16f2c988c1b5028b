"""A first figure: the machine at the start of the job, and the curves of a run."""

from pathlib import Path

from trirrr import Machine, figures

OUT = Path("out/python")
OUT.mkdir(parents=True, exist_ok=True)

machine = Machine.from_scene(Path(__file__).resolve().parents[3] / "scenes/thesis.toml")
figures.machine(machine).savefig(OUT / "machine.svg")
figures.ticks(machine.run().ticks, machine.name).savefig(OUT / "ticks.svg")
print("wrote", OUT / "machine.svg", OUT / "ticks.svg")
