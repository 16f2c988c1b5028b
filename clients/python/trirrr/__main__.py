"""``python -m trirrr``: plays a job on a machine, records what it did, draws it."""

from __future__ import annotations

import argparse
import dataclasses
import math
import sys
from pathlib import Path

from . import figures, jobs, record
from .errors import TrirrrError
from .jobs import JobError
from .messages import Command, SectionName
from .numbers import NUMBERS
from .ports import open_port
from .record import Recorder
from .stream import Stream


def arguments() -> argparse.ArgumentParser:
    """The command line."""
    parser = argparse.ArgumentParser(prog="trirrr", description=__doc__)
    parser.add_argument("job", help="scene file (.toml), or a table of moves (.csv)")
    parser.add_argument("--moves", metavar="CSV", help="moves of a scene's job along a path, from `trirrr plan`")
    parser.add_argument("--port", required=True, help="serial port, or tcp:HOST:PORT")
    parser.add_argument("--baud", type=int, default=921_600, help="of a serial port (%(default)s)")
    parser.add_argument("--out", default="out", help="folder for ticks.csv and, with matplotlib, ticks.svg (%(default)s)")
    parser.add_argument("--every", type=int, default=1, help="ticks from one sample to the next")
    parser.add_argument("--any-scene", action="store_true", help="do not compare the machine's scene")
    parser.add_argument("--scalar", choices=list(NUMBERS), help="number type of the machine's image (the job's)")
    parser.add_argument(
        "--recover",
        type=positive,
        metavar="SECONDS",
        help="acknowledge a fault, and take so long to bring the machine to where the job starts",
    )
    parser.add_argument(
        "--feed",
        type=int,
        choices=range(1, 101),
        metavar="PERCENT",
        help="feed override, 1 to 100 %% of normal speed",
    )
    parser.add_argument("--answer", type=float, default=0.2, help="seconds to wait for an answer")
    parser.add_argument("--quiet", action="store_true", help="no progress")
    return parser


def positive(text: str) -> float:
    """A number of seconds."""
    value = float(text)
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text}: must be greater than 0")
    return value


def main() -> int:
    """0: the job is done. 1: it is not, and why. 2: it could not be tried."""
    options = arguments().parse_args()
    recorder = Recorder()

    def progress(done: int, moves: int, state: str) -> None:
        if not options.quiet:
            print(f"{done} of {moves} moves, {state.lower()}", flush=True)

    try:
        job = jobs.read(options.job, options.moves)
        if options.scalar:
            job = dataclasses.replace(job, number=options.scalar)
    except JobError as error:
        print(f"trirrr: {error}", file=sys.stderr)
        return 2
    stream = Stream(
        lambda: open_port(options.port, options.baud),
        job,
        recorder.hear,
        progress,
        options.every,
        options.any_scene,
        answer_s=options.answer,
        recover_s=options.recover,
        feed_percent=options.feed,
        survey=[Command.Read(SectionName.Leg(leg)) for leg in range(3)],
    )
    try:
        stream.run()
    except TrirrrError as error:
        print(f"trirrr: {options.port}: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"trirrr: {options.port}: stopped by the user: the machine stands on its path", file=sys.stderr)
        return 1
    finally:
        if stream.survey and recorder.samples:
            write(options.out, stream, recorder, Path(options.job).stem, job.torque)
    if not options.quiet:
        lost = recorder.missing if options.every == 1 else 0
        print(
            f"done: {len(recorder.samples)} samples, {lost} missing, {stream.repeated} requests "
            f"repeated, {stream.reconnected} reconnects, {sum(stream.damaged.values())} damaged frames"
        )
    return 0


def write(folder: str, stream: Stream, recorder: Recorder, title: str, torque: bool) -> None:
    """Writes table and figures of what was recorded."""
    out = Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    legs = [section.content.leg for section in stream.survey]
    exchange = stream.exchange
    rows = recorder.rows(exchange.identity, legs, exchange.numbers)
    recorder.write(str(out / "ticks.csv"), rows, torque)
    try:
        figures.ticks(record.as_columns(rows, torque), title).savefig(out / "ticks.svg")
    except figures.NoMatplotlib as error:
        print(f"trirrr: no ticks.svg: {error}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
