"""Studies of `trirrr design --vary` in parts, over any executor.

    from concurrent.futures import ThreadPoolExecutor
    from trirrr import study

    with ThreadPoolExecutor(8) as executor:
        found = study.run("lift.toml", vary=["mode"], objectives=["torque"], shards=8, executor=executor)
    print(found["result"]["best"]["set"])

An executor has `submit`, as those of concurrent.futures and the client of Dask, or `map`, as the pool of Ray. A worker needs the
program `trirrr`, and no file: the scene goes with the task, and the part of the study comes back.
"""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from .errors import TrirrrError

#: Program, place of the scene, texts of the files by place, arguments.
Task = tuple[str, str, dict[str, str], list[str]]


class StudyRefused(TrirrrError):
    """The program refuses the study, with its reason."""


def run(
    scene: str | os.PathLike[str],
    vary: Iterable[str],
    objectives: Iterable[str],
    *,
    shards: int = 1,
    executor: Any = None,
    evaluations: int = 400,
    seed: int = 1,
    settings: Iterable[str] = (),
    arguments: Sequence[str] = (),
    out: str | os.PathLike[str] | None = None,
    program: str | None = None,
) -> Any:
    """Carries out a study of `scene` in `shards` parts and puts them together; returns the study.json of the whole.

    `vary`: texts as for --vary. `objectives`: one name or two, as for --for. `settings`: texts as for --set. `arguments`: further ones of
    `trirrr design`, such as ["--turn", "10"]. `out`: folder of the results. `program`: path of `trirrr` on all workers.
    Raises StudyRefused.
    """
    scene = Path(scene)
    program = program or os.environ.get("TRIRRR", "trirrr")
    asked = [part for text in vary for part in ("--vary", text)]
    asked += ["--for", ",".join(objectives), "--evaluations", str(evaluations), "--seed", str(seed)]
    common = [part for text in settings for part in ("--set", text)] + list(arguments)
    place, files = _files(scene)
    tasks = [
        (program, place, files, common + asked + ["--shard", f"{part}/{shards}"])
        for part in range(1, shards + 1)
    ]
    with tempfile.TemporaryDirectory() as folder:
        parts = []
        for number, text in enumerate(_mapped(executor, tasks), 1):
            part = Path(folder) / f"part-{number}.json"
            part.write_text(text, encoding="utf-8")
            parts.append(str(part))
        command = [program, "design", str(scene), *common, "--json", "--merge", *parts]
        if out is not None:
            command += ["--out", str(out)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise StudyRefused(done.stderr.strip())
        return json.loads(done.stdout)


def _files(scene: Path) -> tuple[str, dict[str, str]]:
    """The scene and the file of its machine: the place of the scene, and texts by their places in a folder."""
    text = scene.read_text(encoding="utf-8")
    paths = [scene.resolve()]
    try:
        machine = tomllib.loads(text).get("machine")
    except tomllib.TOMLDecodeError:
        # The program says what is wrong, with its line.
        machine = None
    if isinstance(machine, str):
        named = (scene.parent / machine).resolve()
        paths += [named] if named.is_file() else []
    base = os.path.commonpath([path.parent for path in paths])
    places = [os.path.relpath(path, base) for path in paths]
    texts = [path.read_text(encoding="utf-8") for path in paths]
    return places[0], dict(zip(places, texts))


def _mapped(executor: Any, tasks: list[Task]) -> list[str]:
    if executor is None:
        return [part_of_study(task) for task in tasks]
    if hasattr(executor, "submit"):
        futures = [executor.submit(part_of_study, task) for task in tasks]
        return [future.result() for future in futures]
    return list(executor.map(part_of_study, tasks))


def part_of_study(task: Task) -> str:
    """Carries out a part of a study, on a worker; returns its study.json."""
    program, place, files, arguments = task
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = Path(folder) / "scenes" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        out = Path(folder) / "out"
        scene = Path(folder) / "scenes" / place
        command = [program, "design", str(scene), *arguments, "--out", str(out)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        found = out / "study.json"
        # A part none of whose candidates does the job fails, and counts.
        if done.returncode not in (0, 1) or not found.is_file():
            raise StudyRefused(done.stderr.strip().replace(f"{folder}/scenes/", ""))
        return found.read_text(encoding="utf-8")
