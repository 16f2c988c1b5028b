"""Figures of runs and machines. Need matplotlib: ``pip install 'trirrr[figures]'``.

Each function takes an ``axes`` or makes a figure of its own, and returns the figure: ``savefig`` writes SVG, PDF or PNG.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .machine import Machine

#: Okabe and Ito's colours, which the colour-blind tell apart.
COLOURS = ("#0072b2", "#d55e00", "#009e73")

#: Panels of a run: title, unit, columns.
PANELS = (
    ("position", "m", ("x", "y")),
    ("angle", "rad", ("alpha",)),
    ("motor rates", "rad/s", ("dth1_1", "dth1_2", "dth1_3")),
    ("motor torques", "N m", ("tau1", "tau2", "tau3")),
    ("motor powers", "W", ("P1", "P2", "P3")),
    ("tool", "of its power", ("tool",)),
)


class NoMatplotlib(ImportError):
    """matplotlib is not installed."""


def new_figure(**options: Any) -> Figure:
    """A figure that needs no screen. ``NoMatplotlib`` says what to install."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise NoMatplotlib("figures need matplotlib: pip install 'trirrr[figures]'") from None
    return Figure(layout="constrained", **options)


def ticks(table: Mapping[str, Sequence[float] | Any], title: str = "") -> Figure:
    """Curves of a run over time. ``table`` has columns of ``ticks.csv``; panels whose columns are missing are left out."""
    panels = [panel for panel in PANELS if all(name in table for name in panel[2])]
    figure = new_figure(figsize=(8, 1.8 * len(panels) + 0.6))
    if not panels:
        raise ValueError("the table has no column that is drawn: x, alpha, dth1_1, tau1, P1, tool")
    all_axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (name, unit, columns) in zip(all_axes, panels, strict=True):
        for column, colour in zip(columns, COLOURS, strict=False):
            axes.plot(table["t"], table[column], color=colour, label=column)
        axes.set_ylabel(f"{name}\n{unit}")
        axes.grid(True, alpha=0.3)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    all_axes[-1].set_xlabel("time, s")
    if title:
        figure.suptitle(title)
    return figure


def machine(of: Machine, pose: Sequence[float] | None = None, axes: Axes | None = None) -> Figure:
    """The mechanism at ``pose``, at the start of the job if left out: base joints, links, platform."""
    import numpy as np

    at = np.asarray(of.start if pose is None else pose, dtype=float)
    angles = of.angles(at)
    chosen = axes if axes is not None else new_figure(figsize=(6, 6)).subplots()
    corners = []
    for number, (leg, angle) in enumerate(zip(of.legs, angles, strict=True)):
        base = np.asarray(leg.base_m)
        elbow = base + leg.proximal_m * np.array([np.cos(angle), np.sin(angle)])
        way = at[2] + leg.joint_angle_rad
        joint = at[:2] + leg.joint_radius_m * np.array([np.cos(way), np.sin(way)])
        corners.append(joint)
        path = np.stack([base, elbow, joint])
        chosen.plot(*path.T, "-o", color=COLOURS[number], label=f"leg {number + 1}")
        chosen.plot(*base, "s", color=COLOURS[number], markersize=9)
    chosen.fill(*np.stack(corners).T, color="0.5", alpha=0.3, label="platform")
    chosen.plot(at[0], at[1], "k+", label="D")
    chosen.set_aspect("equal")
    chosen.set_xlabel("x, m")
    chosen.set_ylabel("y, m")
    chosen.grid(True, alpha=0.3)
    chosen.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    figure = chosen.get_figure(root=True)
    if figure is None:
        raise ValueError("the axes belong to no figure")
    return figure


__all__ = ["NoMatplotlib", "machine", "new_figure", "ticks"]
