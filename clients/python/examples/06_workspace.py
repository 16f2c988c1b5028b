"""A map of the workspace: distance from the parallel singularity over x and y, at the alpha of the start."""

from pathlib import Path

import numpy as np

from trirrr import Machine, figures

OUT = Path("out/python")
OUT.mkdir(parents=True, exist_ok=True)

machine = Machine.from_scene(Path(__file__).resolve().parents[3] / "scenes/thesis.toml")
x, y = np.meshgrid(np.linspace(0.0, 0.5, 251), np.linspace(0.0, 0.5, 251))
poses = np.stack([x, y, np.full_like(x, machine.start[2])], axis=-1)
# NaN where a leg does not reach.
parallel = machine.distances(poses, invalid="nan").parallel

figure = figures.new_figure(figsize=(7, 6))
axes = figure.subplots()
figure.colorbar(axes.contourf(x, y, parallel, levels=20), label="distance from the parallel singularity")
figures.machine(machine, axes=axes)
figure.savefig(OUT / "workspace.svg")
print(f"{np.isfinite(parallel).mean():.1%} of the map is within reach; wrote {OUT / 'workspace.svg'}")
