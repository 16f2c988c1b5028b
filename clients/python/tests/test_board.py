"""Boards: `trirrr device` on TCP."""

import asyncio
import contextlib
import io
import math
import socket
import sys
import threading
import time
import unittest

from programs import SCENES, Device
import trirrr
from trirrr import AsyncBoard, Board, BoardError, TrirrrError
from trirrr.board import Carried
from trirrr.exchange import Refused
from trirrr.goals import NoMotion
from trirrr.jobs import read
from trirrr.messages import Command, SectionName
from trirrr.ports import Port, PortError, open_port
from trirrr.stream import JobFailed, Stream


class Boards(unittest.TestCase):
    def test_inputs_of_a_machine_are_told_in_words(self) -> None:
        # Pressed and open from the start for as long as the test takes.
        presses = ("--press", "estop@0", "--press", "door@0")
        with Device("inputs/guarded.toml", more=presses) as address, Board.connect(address) as board:
            while (status := board.status()).inputs != "emergency stop pressed, or its wire broken; door open":
                time.sleep(0.01)
            self.assertEqual(status.state, "Fault")
            self.assertRegex(str(status.fault), "the emergency stop was pressed, or its wire is broken")
            with self.assertRaisesRegex(Refused, "release it before the fault is acknowledged"):
                board.clear_fault()
        with Device("inputs/guarded.toml", more=("--press", "door@0")) as address, Board.connect(address) as board:
            while board.status().inputs != "emergency stop released; door open":
                time.sleep(0.01)
            board.enable()
            with self.assertRaisesRegex(JobFailed, "the door is open: nothing moves before it is closed"):
                board.run(SCENES / "inputs/guarded.toml")
        with Device("thesis.toml") as address, Board.connect(address) as board:
            self.assertIsNone(board.status().inputs)

    def test_a_machine_probes_a_wall(self) -> None:
        with Device("inputs/probing.toml", more=("--touch", "x=0.25")) as address, Board.connect(address) as board:
            with self.assertRaisesRegex(BoardError, "no probing while the machine is disabled"):
                board.probe((0.28, 0.22, 0.157), 0.5)
            board.enable()
            felt = board.probe((0.28, 0.22, 0.157), 0.5)
            assert felt is not None
            # A tick at 0.15 m/s at most is 0.2 mm.
            self.assertTrue(0.25 <= felt.pose[0] < 0.2502, felt)
            self.assertIsNone(felt.measured)
            with self.assertRaisesRegex(Refused, "the probe touches before the run"):
                board.probe((0.28, 0.22, 0.157), 0.5)
            let_go = board.probe((0.21, 0.22, 0.157), 0.5, away=True)
            assert let_go is not None
            self.assertTrue(0.2497 < let_go.pose[0] < 0.25, let_go)
            self.assertIsNone(board.probe((0.21, 0.22, 0.157), 0.5))
            self.assertIn("no motor on its limit switch", str(board.status().inputs))

    def test_a_machine_is_enabled_moved_and_plays_a_job(self) -> None:
        with Device("thesis.toml") as address, Board.connect(address) as board:
            self.assertEqual((board.name, board.status().state), ("thesis", "Disabled"))
            self.assertTrue(board.firmware.endswith(", simulator"), board.firmware)
            self.assertEqual(board.enable().state, "Idle")
            start = board.status().end
            assert start is not None
            there = board.move((0.25, 0.24, 0.1))
            for found, asked in zip(there, (0.25, 0.24, 0.1), strict=True):
                self.assertAlmostEqual(found, asked, places=6)
            with self.assertRaisesRegex(NoMotion, "no motion to the goal"):
                board.move((9.0, 9.0, 0.0))
            # It goes to the start by itself.
            board.run(SCENES / "thesis.toml")
            seen: list[tuple[int, int, str]] = []
            ticks = board.run(
                SCENES / "thesis.toml", recover_s=0.5, progress=lambda *now: seen.append(now)
            )
            # More than 101 where the host was too slow and the machine waited for it.
            self.assertGreaterEqual(len(ticks["tau1"]), 101)
            self.assertAlmostEqual(ticks["x"][-1], 0.28, places=6)
            self.assertEqual(seen[-1][:2], (1, 1))
            # The same job once more, behind a bar.
            shown = io.StringIO()
            with contextlib.redirect_stderr(shown):
                board.run(SCENES / "thesis.toml", recover_s=0.5, progress=True)
            self.assertRegex(shown.getvalue(), r"100%.* 1/1 ")
            # The conversation goes on after a job.
            self.assertEqual(board.status().moves, 0)
            with self.assertRaisesRegex(Refused, "a feed override is 1 to 100 percent"):
                board.feed(0)

    def test_a_hold_gets_through_while_a_job_is_played(self) -> None:
        with Device("thesis.toml", speed=0.5) as address, Board.connect(address) as board:
            board.enable()
            held: list[str] = []

            def hold() -> None:
                while board.status().state != "Running":
                    time.sleep(0.02)
                board.hold()
                while (state := board.status().state) != "Holding":
                    time.sleep(0.02)
                held.append(state)
                board.resume()

            thread = threading.Thread(target=hold)
            thread.start()
            ticks = board.run(SCENES / "thesis.toml")
            thread.join(timeout=30)
            self.assertEqual(held, ["Holding"])
            # It stood for some ticks, and came to the end of the path all the same.
            self.assertGreater(len(ticks["t"]), 101)
            self.assertAlmostEqual(ticks["x"][-1], 0.28, places=6)

    def test_threads_open_no_line_beside_that_of_a_job(self) -> None:
        class Switching(Board):
            """Another thread comes between what is read of the job and what is done with it."""

            @property
            def _job(self) -> Stream | None:
                job: Stream | None = self.__dict__.get("job")
                time.sleep(0.01)
                return job

            @_job.setter
            def _job(self, job: Stream | None) -> None:
                self.__dict__["job"] = job

        with Device("thesis.toml", speed=5.0) as address, Switching.connect(address) as board:
            board.enable()
            open_line = board._open
            opened: list[bool] = []

            def counted() -> Port:
                opened.append(threading.current_thread() is threading.main_thread())
                return open_line()

            board._open = counted
            ended = threading.Event()

            def look() -> None:
                while not ended.is_set():
                    board.status()

            threads = [threading.Thread(target=look) for _ in range(3)]
            for thread in threads:
                thread.start()
            board.run(SCENES / "thesis.toml")
            ended.set()
            for thread in threads:
                thread.join()
            # That of the job, and the board's own behind it.
            self.assertEqual(opened, [True, True])

    def test_a_line_that_is_given_back_ends_a_wait_in_another_thread(self) -> None:
        with socket.create_server(("127.0.0.1", 0)) as server:
            port = open_port(f"tcp:127.0.0.1:{server.getsockname()[1]}")
            machine = server.accept()[0]
            said: list[object] = []

            def wait() -> None:
                try:
                    said.append(port.receive(60.0))
                except PortError as error:
                    said.append(error)

            thread = threading.Thread(target=wait)
            thread.start()
            time.sleep(0.1)
            port.close()
            # The machine takes one client at a time: it hears at once that this one has gone.
            machine.settimeout(30.0)
            self.assertEqual(machine.recv(1), b"")
            thread.join(timeout=30.0)
            self.assertIsInstance(said[0], PortError)
            machine.close()

    def test_a_task_that_is_cancelled_brings_the_machine_to_rest_and_leaves_the_board_usable(self) -> None:
        async def cancel(address: str) -> None:
            async with await AsyncBoard.connect(address) as board:
                await board.enable()
                start = (await board.status()).end
                assert start is not None

                async def moving(task: asyncio.Task[object]) -> None:
                    while (await board.status()).state != "Running":
                        self.assertFalse(task.done())
                        await asyncio.sleep(0.01)

                goals = ((0.3, 0.3, 0.2), (0.25, 0.25, 0.0))
                calls = [lambda: board.run(SCENES / "thesis.toml"), lambda: board.jog((0.01, 0.0, 0.0), 30.0)]
                calls.append(lambda: board.follow(goals * 50, 0.3))
                for call in calls:
                    task = asyncio.create_task(call())
                    await moving(task)
                    task.cancel()
                    # A second one does not leave it in motion either.
                    await asyncio.sleep(0)
                    task.cancel()
                    with self.assertRaises(asyncio.CancelledError):
                        await task
                    status = await board.status()
                    self.assertEqual((status.state, status.moves), ("Idle", 0))
                # The same by a time that is out.
                task = asyncio.create_task(asyncio.wait_for(board.run(SCENES / "thesis.toml"), 60.0))
                await moving(task)
                with self.assertRaises(TimeoutError):
                    async with asyncio.timeout(0):
                        await task
                self.assertEqual((await board.status()).state, "Idle")
                there = await board.move(start)
                self.assertAlmostEqual(there[0], start[0], places=6)
                # What is to stop a machine is sent all the same.
                await asyncio.wait_for(board.stop(), 60.0)

        with Device("thesis.toml", speed=0.2) as address:
            asyncio.run(cancel(address))

    def test_ctrl_c_in_a_move_brings_the_machine_to_rest(self) -> None:
        with Device("thesis.toml", speed=0.2) as address, Board.connect(address) as board:
            board.enable()

            moving = threading.Event()
            exchange = board._own
            listen = exchange.listen

            def interrupted(seconds: float) -> None:
                listen(seconds)
                if not moving.is_set() and exchange.ask(Command.Status()).state.name == "Running":
                    moving.set()
                    raise KeyboardInterrupt

            exchange.listen = interrupted  # type: ignore[method-assign]
            with self.assertRaises(KeyboardInterrupt):
                board.move((0.3, 0.3, 0.2))
            status = board.status()
            self.assertEqual((status.state, status.moves), ("Idle", 0))
            assert status.end is not None
            self.assertGreater(math.dist(status.end, (0.3, 0.3, 0.2)), 1e-3)

    def test_a_request_that_an_exception_cut_off_is_asked_again_before_the_next(self) -> None:
        with Device("thesis.toml") as address, Board.connect(address) as board:
            exchange = board._own
            take, cut = exchange._take, []

            def failing(timeout: float, request: object) -> object:
                if not cut and request is not None:
                    cut.append(request)
                    raise KeyboardInterrupt
                return take(timeout, request)

            exchange._take = failing  # type: ignore[method-assign,assignment]
            with self.assertRaises(KeyboardInterrupt):
                board.enable()
            self.assertEqual(len(cut), 1)
            self.assertEqual(board.enable().state, "Idle")

    def test_a_run_that_was_stopped_says_so(self) -> None:
        with Device("thesis.toml", speed=0.3) as address, Board.connect(address) as board:
            board.enable()

            def stop() -> None:
                while board.status().state != "Running":
                    time.sleep(0.01)
                with self.assertRaisesRegex(BoardError, "a job is under way"):
                    board.move((0.25, 0.24, 0.1))
                board.stop()

            thread = threading.Thread(target=stop)
            thread.start()
            with self.assertRaisesRegex(JobFailed, r"the job was left in move 1 of 1 \(.*stop"):
                board.run(SCENES / "thesis.toml")
            thread.join(timeout=30)
            self.assertEqual(board.status().state, "Idle")
            board.run(SCENES / "thesis.toml")

    def test_a_board_is_there_again_after_its_restart(self) -> None:
        with Device("thesis.toml") as address:
            board = Board.connect(address)
            self.assertEqual(board.enable().state, "Idle")
        with self.assertRaises(PortError):
            board.status()
        with Device("thesis.toml", address=address), board:
            self.assertEqual(board.status().state, "Disabled")
            self.assertEqual(board.enable().state, "Idle")
        with self.assertRaises(PortError):
            board.status()

    def test_all_errors_are_of_one_class(self) -> None:
        core = {"MotionError", "PlanError", "SceneError"}
        named = [name for name in trirrr.__all__ if name.endswith(("Error", "Failed")) or name in ("NoMotion", "Refused", "Silent")]
        self.assertGreater(len(named), 10)
        for name in named:
            error = getattr(trirrr, name)
            self.assertTrue(issubclass(error, TrirrrError), name)
        self.assertTrue(core <= set(named))
        self.assertTrue(issubclass(PortError, BoardError) and issubclass(PortError, OSError))
        with self.assertRaisesRegex(BoardError, "tcp:HOST:PORT"):
            Board.connect("tcp:nowhere")

    def test_poses_and_feeds_are_checked(self) -> None:
        with Device("thesis.toml") as address, Board.connect(address) as board:
            with self.assertRaisesRegex(ValueError, "a pose has three numbers"):
                board.move((0.2, 0.2))  # type: ignore[arg-type]
            with self.assertRaisesRegex(ValueError, "50.5 is no whole number"):
                board.feed(50.5)  # type: ignore[arg-type]
            with self.assertRaisesRegex(JobFailed, "scene"):
                board.run(SCENES / "vertical.toml")

    def test_boards_move_at_the_same_time(self) -> None:
        async def both(addresses: list[str]) -> list[tuple[float, float, float]]:
            boards = [await AsyncBoard.connect(address) for address in addresses]
            await asyncio.gather(*(board.enable() for board in boards))
            ends = await asyncio.gather(*(board.move((0.25, 0.24, 0.1)) for board in boards))
            for board in boards:
                await board.__aexit__()
            return list(ends)

        with Device("thesis.toml") as one, Device("thesis.toml") as other:
            ends = asyncio.run(both([one, other]))
        self.assertEqual(ends[0], ends[1])

    def test_an_exchanged_tool_is_another_tool_point(self) -> None:
        # Of scenes/tools.toml: a platform of 0.5 kg with its centre of mass at the middle, and the gripper.
        mass, part = 0.85, 0.35 / 0.85
        com = (0.02 * part - 0.03, 0.03 * part - 0.05)
        # Two bodies about their common centre: their reduced mass at their distance.
        inertia = 0.0025 + 4e-4 + 0.5 * part * (0.02**2 + 0.03**2)
        gripper = Carried(mass, inertia, com, (0.03, 0.05))
        with Device("tools.toml") as address, Board.connect(address) as board:
            board.enable()
            x, y, alpha = board.status().end
            found = board.mount(gripper)
            cos, sin = math.cos(alpha), math.sin(alpha)
            # The pen's point is at (0, 0.03).
            wanted = (x + 0.03 * cos - 0.02 * sin, y + 0.03 * sin + 0.02 * cos, alpha)
            for have, want in zip(found, wanted, strict=True):
                self.assertAlmostEqual(have, want, places=6)
            told = board._ask(Command.Read(SectionName.Platform())).content
            self.assertEqual((told.mass_kg, told.tool_point_m), (mass, (0.03, 0.05)))
            with self.assertRaises(Refused):
                board.mount(Carried(-1.0, inertia, com, (0.0, 0.0)))
            self.assertAlmostEqual(board.status().end[0], wanted[0], places=6)

    def test_a_job_for_another_tool_is_refused(self) -> None:
        machine = read(str(SCENES / "tools.toml"))
        gripper = machine.tools["gripper"]
        with Device("tools.toml") as address, Board.connect(address) as board:
            board.enable()
            board.mount(Carried(gripper.mass_kg, gripper.inertia_kgm2, gripper.com_m, gripper.tool_point_m))
            with self.assertRaisesRegex(JobFailed, "carries the tool 'gripper', and the job is for the tool 'pen'"):
                board.run(SCENES / "tools.toml", recover_s=0.5)
            board.mount(Carried(1.0, 0.01, (0.0, 0.0), (0.0, 0.0)))
            with self.assertRaisesRegex(JobFailed, "carries no tool of the scene"):
                board.run(SCENES / "tools.toml", recover_s=0.5)
            pen = machine.tools["pen"]
            board.mount(Carried(pen.mass_kg, pen.inertia_kgm2, pen.com_m, pen.tool_point_m))
            ticks = board.run(SCENES / "tools.toml", recover_s=0.5)
            self.assertAlmostEqual(ticks["x"][-1], 0.27, places=6)

    def test_outputs_are_switched_by_name(self) -> None:
        scene = SCENES / "inputs/valves.toml"
        with (
            # Slow, that no state of the outputs passes between two looks.
            Device("inputs/valves.toml", speed=0.5, more=("--press", "sheet@0")) as address,
            Board.connect(address, scene=scene) as board,
        ):
            with self.assertRaisesRegex(Refused, "not while the machine is disabled"):
                board.output("vacuum", True)
            board.enable()
            with self.assertRaisesRegex(BoardError, "has no output 'vent'; its outputs are air, vacuum"):
                board.output("vent", True)
            board.output("vacuum", True)
            # An output of jobs waits for one.
            board.output("air", True)
            while board.status().outputs_on != ("vacuum",) or board.status().inputs_active != ("sheet",):
                time.sleep(0.01)
            board.output("vacuum", False)
            seen: set[tuple[str | int, ...]] = set()
            ended = threading.Event()

            def look() -> None:
                while not ended.wait(0.02):
                    seen.add(board.status().outputs_on)

            thread = threading.Thread(target=look)
            thread.start()
            board.run(scene)
            ended.set()
            thread.join()
            # The job switches both on, and the air off.
            self.assertLessEqual(seen, {(), ("air", "vacuum"), ("vacuum",)})
            self.assertIn(("air", "vacuum"), seen)
            self.assertEqual(board.status().outputs_on, ("vacuum",))
            with self.assertRaisesRegex(Refused, "names 2 spare outputs"):
                board.output(2, False)
            board.disable()
            while board.status().outputs_on:
                time.sleep(0.01)
        with Device("thesis.toml") as address, Board.connect(address) as board:
            with self.assertRaisesRegex(BoardError, "connect with scene="):
                board.output("air", True)
            with self.assertRaisesRegex(Refused, "names no spare output"):
                board.output(0, True)
            self.assertEqual(board.status().outputs_on, ())

    def test_a_machine_is_homed(self) -> None:
        with Device("pick-home.toml", speed=1.0) as address, Board.connect(address) as board:
            self.assertEqual(board.enable().state, "Unhomed")
            end = board.home()
            self.assertEqual(board.status().state, "Idle")
            self.assertEqual(board.home(), end)

    def test_nobody_at_the_address_is_said(self) -> None:
        with self.assertRaisesRegex(PortError, "127.0.0.1:1"):
            Board.connect("tcp:127.0.0.1:1")

    def test_a_board_needs_neither_numpy_nor_the_native_core(self) -> None:
        import subprocess

        code = (
            "import sys\n"
            "for name in ('numpy', 'matplotlib', 'trirrr._native'):\n"
            "    sys.modules[name] = None\n"
            "import trirrr\n"
            "trirrr.Board, trirrr.SceneError\n"
            "try:\n"
            "    trirrr.Machine\n"
            "except ImportError:\n"
            "    print('no Machine')\n"
        )
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
        self.assertEqual((done.stdout.strip(), done.stderr), ("no Machine", ""))


if __name__ == "__main__":
    unittest.main()
