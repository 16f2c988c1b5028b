"""The program `trirrr` for tests: simulated boards, and results to compare with."""

import os
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
SCENES = ROOT / "scenes"


def program() -> str | None:
    """Path of the program: TRIRRR, or one that was built here, or one that is installed."""
    built = [ROOT / "target" / profile / "trirrr" for profile in ("release", "debug")]
    places = [os.environ.get("TRIRRR"), *(str(each) for each in built if each.is_file()), shutil.which("trirrr")]
    return next((place for place in places if place), None)


class Device:
    """`trirrr device` on a free port; a context that ends with it."""

    def __init__(self, scene: str, speed: float = 2.0, more: tuple[str, ...] = (), address: str = "tcp:127.0.0.1:0") -> None:
        command = [program(), "device", str(SCENES / scene), "--listen", address, "--speed", str(speed), *more]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.address = self._process.stdout.readline().split(" ")[0]

    def __enter__(self) -> str:
        return self.address

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()
        self._process.stdout.close()
