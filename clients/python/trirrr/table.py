"""Tables of numbers: columns by name, as arrays of numpy, as pandas or Arrow."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Table(Mapping[str, Array]):
    """Columns of equal length, by name. SI units."""

    def __init__(self, names: Sequence[str], rows: Array) -> None:
        self.names = list(names)
        #: All numbers, shape (rows, columns).
        self.rows = rows

    def __getitem__(self, name: str) -> Array:
        try:
            return self.rows[:, self.names.index(name)]
        except ValueError:
            raise KeyError(f"no column {name!r}; columns are {', '.join(self.names)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        return f"<Table of {len(self.rows)} rows: {', '.join(self.names)}>"

    def columns(self, *names: str) -> Array:
        """The columns of these names side by side, shape (rows, names)."""
        return np.stack([self[name] for name in names], axis=1)

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame``. Needs pandas."""
        import pandas

        return pandas.DataFrame(dict(self))

    def to_arrow(self) -> Any:
        """A ``pyarrow.Table``. Needs pyarrow."""
        import pyarrow

        return pyarrow.table(dict(self))

    def to_csv(self, path: str | Path) -> None:
        """Writes a CSV file; every number reads back as itself."""
        with Path(path).open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(self.names)
            writer.writerows(map(repr, row) for row in self.rows.tolist())

    @classmethod
    def from_csv(cls, path: str | Path) -> Table:
        """Reads a table of numbers, such as ``ticks.csv`` of ``trirrr run``."""
        with Path(path).open(newline="") as file:
            names = next(csv.reader(file))
            rows = np.loadtxt(file, delimiter=",", dtype=np.float64, ndmin=2)
        return cls(names, rows.reshape(-1, len(names)))


__all__ = ["Array", "Table"]
