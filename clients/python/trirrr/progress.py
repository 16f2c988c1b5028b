"""Progress of a job: a function of yours, or a bar of tqdm.

    board.run("scenes/thesis.toml", progress=True)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

#: Hears the moves done, their number, and the name of the machine's state. Of an update: bytes, their number, and the part of it.
Progress = Callable[[int, int, str], None]


@contextmanager
def hearing(progress: Progress | bool | None, unit: str = "move") -> Iterator[Progress]:
    """Gives ``progress`` itself if it is a function, a bar for ``True``, and a function that does nothing for ``False`` or ``None``.

    The bar counts ``unit``. It needs tqdm, the extra ``progress``. It is closed when the context ends, so that an error stands on a line of its own.
    """
    if not isinstance(progress, bool):
        yield progress or _ignore
    elif not progress:
        yield _ignore
    else:
        # Here: a client that draws no bar needs no tqdm.
        from tqdm.auto import tqdm

        with tqdm(unit=unit) as bar:

            def show(done: int, count: int, state: str) -> None:
                bar.total = count
                bar.set_description(state, refresh=False)
                # Not `update`: a job that goes back to its start counts down.
                bar.n = done
                bar.refresh()

            yield show


def _ignore(done: int, count: int, state: str) -> None:
    """Shows nothing."""
