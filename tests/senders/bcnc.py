#!/usr/bin/env python3
"""Drives `trirrr grbl` by bCNC's own sender, without its windows: connect, unlock, home, jog, run a file, hold, resume, abort.

Needs `pip install bCNC`. The only argument is the program `trirrr`. Prints what bCNC saw; ends with 1 at the first surprise.
"""

import builtins
import importlib.util
import math
import queue
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "scenes" / "engraving.toml"
PATIENCE_S = 60.0

# bCNC's modules find each other by their folder, and are translated by a builtin.
package = importlib.util.find_spec("bCNC")
if package is None or not package.submodule_search_locations:
    sys.exit("bCNC is not installed: pip install bCNC")
folder = Path(package.submodule_search_locations[0])
sys.path[:0] = [str(folder / part) for part in ("", "lib", "plugins", "controllers")]
builtins._ = lambda text: text
builtins.N_ = lambda text: text

import Utils  # noqa: E402

Utils.prgpath = str(folder)
# The user's own settings are left alone: neither read nor written.
Utils.iniUser = "/dev/null"
Utils.hisFile = "/dev/null"
Utils.loadConfiguration(True)
from CNC import CNC  # noqa: E402
from Sender import Sender  # noqa: E402


class Headless(Sender):
    """bCNC's sender with what its window gives it."""

    def __init__(self):
        super().__init__()
        self.controllerLoad()
        self.controllerSet("GRBL1")
        self.said = []

    def hear(self):
        while True:
            try:
                self.said.append(self.log.get_nowait())
            except queue.Empty:
                return

    def until(self, what, wanted):
        end = time.monotonic() + PATIENCE_S
        while not wanted():
            self.hear()
            if time.monotonic() > end:
                sys.exit(f"bCNC: no {what}; state {state()}, place {place()}, {self.said[-20:]}")
            time.sleep(0.02)
        print(f"{what}: {state()} at {place()}")

    def idle(self, what):
        # Two polls: the state before may be one that is over.
        time.sleep(0.4)
        self.until(what, lambda: state() == "Idle" and self.queue.empty())

    def errors(self):
        self.hear()
        return [line for _, line in self.said if str(line).startswith(("error", "ALARM"))]


def state():
    return CNC.vars["state"].split(":")[0]


def place():
    return tuple(float(CNC.vars[axis]) for axis in ("mx", "my"))


def near(where):
    if math.dist(place(), where) > 0.01:
        sys.exit(f"bCNC: at {place()}, and not at {where}")


def run(sender):
    start = (250.0, 245.0)
    sender.until("report", lambda: state() == "Alarm")
    sender.unlock()
    sender.idle("unlocked")
    near(start)
    sender.home()
    sender.idle("home")
    sender.mcontrol.jog("X5")
    sender.idle("jogged")
    near((255.0, 245.0))
    if sender.errors():
        sys.exit(f"bCNC: {sender.errors()}")
    # A file: a square, with the laser on.
    for line in ("G21 G91", "M4 S500", "G1 X20 F1200", "G1 Y20", "G1 X-20", "G1 Y-20", "M5", "G90"):
        sender.sendGCode(line)
    sender.until("running", lambda: state() == "Run")
    sender.idle("file played")
    near((255.0, 245.0))
    sender.sendGCode("G91")
    sender.sendGCode("G1 X-40 F300")
    sender.until("running", lambda: state() == "Run" and place()[0] < 253.0)
    sender.feedHold()
    sender.until("hold", lambda: state() == "Hold")
    held = place()
    time.sleep(0.5)
    near(held)
    sender.resume()
    sender.until("resumed", lambda: state() == "Run" and place()[0] < held[0] - 0.5)
    sender.softReset()
    sender.idle("aborted")
    stopped = place()
    if not 215.5 < stopped[0] < held[0]:
        sys.exit(f"bCNC: stopped at {stopped}")
    sender.sendGCode("G90 G1 X250 Y245 F3000")
    sender.idle("back")
    near(start)
    if sender.errors():
        sys.exit(f"bCNC: {sender.errors()}")


def main():
    command = [sys.argv[1], "grbl", str(SCENE), "--listen", "tcp:127.0.0.1:0"]
    sender = Headless()
    server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        address = server.stdout.readline().split(" ")[0].removeprefix("tcp:")
        sender.open(f"socket://{address}", 115200)
        run(sender)
        print("bCNC: good")
    finally:
        if sender.serial is not None:
            sender.close()
        server.kill()


main()
