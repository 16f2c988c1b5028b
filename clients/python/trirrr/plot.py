"""Figures of recorded telemetry as SVG: with matplotlib where it is installed, without it plainer."""

from __future__ import annotations

import math
from pathlib import Path
from xml.sax.saxutils import escape

from . import record
from .record import COLUMNS

#: Title of each panel, unit, columns.
PANELS = [
    ("Position", "m", ["x", "y"]),
    ("Angle", "rad", ["alpha"]),
    ("Joint rates", "rad/s", ["dth1_1", "dth1_2", "dth1_3"]),
    ("Torques", "N m", ["tau1", "tau2", "tau3"]),
    ("Powers", "W", ["P1", "P2", "P3"]),
    ("Tool", "of its power", ["tool"]),
]

_COLOURS = ["#0072b2", "#d55e00", "#009e73"]


def plot(path: str, rows: list[list[float]], title: str, torque: bool) -> str:
    """Draws ``rows`` (in the columns of ``record``) to ``path``. Returns the name of the tool used.

    A machine without ``torque`` has no panels of torques and powers."""
    columns = {name: [row[index] for row in rows] for index, name in enumerate(COLUMNS)}
    kept = set(record.columns(torque))
    panels = [panel for panel in PANELS if kept.issuperset(panel[2])]
    try:
        import matplotlib

        matplotlib.use("svg")
        from matplotlib import pyplot
    except ImportError:
        Path(path).write_text(_svg(columns, panels, title))
        return "own SVG"
    figure, axes = pyplot.subplots(len(panels), 1, sharex=True, figsize=(8, 2 * len(panels)))
    for axis, (name, unit, series) in zip(axes, panels):
        for column, colour in zip(series, _COLOURS):
            axis.plot(columns["t"], columns[column], color=colour, label=column)
        axis.set_ylabel(f"{name}\n{unit}")
        axis.legend(loc="upper right")
        axis.grid(True, alpha=0.3)
    axes[-1].set_xlabel("time, s")
    figure.suptitle(title)
    figure.tight_layout()
    figure.savefig(path)
    pyplot.close(figure)
    return "matplotlib"


_WIDTH, _HEIGHT, _LEFT, _TOP, _GAP = 800, 150, 90, 40, 30


def _svg(columns: dict[str, list[float]], panels: list[tuple[str, str, list[str]]], title: str) -> str:
    times = columns["t"]
    height = _TOP + len(panels) * (_HEIGHT + _GAP)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH}" height="{height}" '
        'font-family="sans-serif" font-size="12">',
        f'<rect width="{_WIDTH}" height="{height}" fill="white"/>',
        f'<text x="{_LEFT}" y="24" font-size="16">{escape(title)}</text>',
    ]
    for index, (name, unit, series) in enumerate(panels):
        top = _TOP + index * (_HEIGHT + _GAP)
        parts += _panel(top, f"{name}, {unit}", times, {each: columns[each] for each in series})
    return "\n".join(parts + ["</svg>\n"])


def _panel(top: float, label: str, times: list[float], series: dict[str, list[float]]) -> list[str]:
    values = [value for each in series.values() for value in each if math.isfinite(value)]
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    span = high - low or 1.0
    duration = times[-1] - times[0] if len(times) > 1 and times[-1] > times[0] else 1.0
    width = _WIDTH - _LEFT - 20
    parts = [
        f'<text x="{_LEFT}" y="{top - 5}">{escape(label)}</text>',
        f'<rect x="{_LEFT}" y="{top}" width="{width}" height="{_HEIGHT}" fill="none" stroke="#888"/>',
        f'<text x="{_LEFT - 5}" y="{top + 10}" text-anchor="end">{high:.4g}</text>',
        f'<text x="{_LEFT - 5}" y="{top + _HEIGHT}" text-anchor="end">{low:.4g}</text>',
    ]
    for number, (name, each) in enumerate(series.items()):
        points = " ".join(
            f"{_LEFT + (time - times[0]) / duration * width:.1f},"
            f"{top + _HEIGHT - (value - low) / span * _HEIGHT:.1f}"
            for time, value in zip(times, each)
        )
        colour = _COLOURS[number]
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}"/>')
        x = _LEFT + width - 60 * (len(series) - number)
        parts.append(f'<text x="{x}" y="{top - 5}" fill="{colour}">{escape(name)}</text>')
    return parts
