"""Plans three paths of the thesis machine beside TOPP-RA, on the same uniform grids with the same limits, in one run.

Needs `pip install toppra==0.6.10`. TOPP-RA gets its constraints ready made: rates, accelerations and torques at the marks
of the grid, computed by trirrr. Its time is that of its two passes alone. The time of trirrr includes the
kinematics and dynamics of every cell, as Taylor models.

    python3 lab/toppra/compare.py
"""

import csv
import logging
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import toppra
from toppra.algorithm import TOPPRA
from toppra.constraint import DiscretizationType
from toppra.constraint.linear_constraint import LinearConstraint

RATE, ACCELERATION, TORQUE = 5.0, 60.0, 0.3
RUNS = 5
ROOT = Path(__file__).resolve().parents[2]


class AtMarks(LinearConstraint):
    """|a u + b x + c| <= limit, and x <= xmax, with everything given at the marks."""

    def __init__(self, a, b, c, limits, xmax):
        super().__init__()
        self.rows = (a, b, c)
        self.limits, self.xmax = limits, xmax
        self.dof = 3
        self.identical = True
        self.set_discretization_type(DiscretizationType.Interpolation)

    def compute_constraint_params(self, path, gridpoints, *args, **kwargs):
        count = len(self.limits)
        f = np.vstack((np.eye(count), -np.eye(count)))
        g = np.hstack((self.limits, self.limits))
        xbound = np.column_stack((np.zeros_like(self.xmax), self.xmax))
        return (*self.rows, f, g, None, xbound)


def their_plan(table):
    """Median seconds, and the duration."""
    marks = table[:, 0]
    rate, acceleration, a, b, c = (table[:, 1 + k :: 5] for k in range(5))
    constraint = AtMarks(
        np.hstack((rate, a)),
        np.hstack((acceleration, b)),
        np.hstack((np.zeros_like(rate), c)),
        np.array([ACCELERATION] * 3 + [TORQUE] * 3),
        ((RATE / np.abs(rate).max(axis=1)) ** 2),
    )
    # Only its ends and its dimension are used.
    path = toppra.SplineInterpolator([0, 1], np.array([[0.0] * 3, [1.0] * 3]))
    seconds = []
    for _ in range(RUNS):
        begin = time.perf_counter()
        planner = TOPPRA([constraint], path, gridpoints=marks, solver_wrapper="seidel")
        _, velocities, _ = planner.compute_parameterization(0.0, 0.0)
        seconds.append(time.perf_counter() - begin)
    duration = (2 * np.diff(marks) / (velocities[1:] + velocities[:-1])).sum()
    return statistics.median(seconds), duration


def main():
    logging.getLogger("toppra").setLevel(logging.ERROR)
    with tempfile.TemporaryDirectory() as folder:
        command = "cargo run --quiet --release -p trirrr-plan --example plan_grid --".split()
        printed = subprocess.run(
            [*command, folder], cwd=ROOT, check=True, capture_output=True, text=True
        )
        print("| path | cells | TOPP-RA, ms | trirrr, ms | ratio | TOPP-RA, s | trirrr, s | bound, s |")
        print("|---|---:|---:|---:|---:|---:|---:|---:|")
        for row in csv.DictReader(printed.stdout.splitlines()):
            table = np.loadtxt(Path(folder) / f"{row['path']}-{row['cells']}.csv", delimiter=",")
            theirs, duration = their_plan(table)
            ours = float(row["seconds"])
            assert duration >= float(row["least_s"]) * 0.99, "the two do not plan the same"
            print(
                f"| {row['path']} | {row['cells']} | {1e3 * theirs:.2f} | {1e3 * ours:.3f} | {theirs / ours:.0f} "
                f"| {duration:.5f} | {float(row['duration_s']):.5f} | {float(row['least_s']):.5f} |"
            )


if __name__ == "__main__":
    main()
