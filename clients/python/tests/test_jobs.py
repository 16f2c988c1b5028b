"""Jobs from scenes and tables."""

import tempfile
import unittest
from pathlib import Path

from trirrr import jobs
from trirrr.messages import Command, OutputSwitch

SCENES = Path(__file__).resolve().parents[3] / "scenes"

TABLE = (
    "piece,duration,x,y,alpha,vx,vy,valpha,ax,ay,aalpha,power,speed\n"
    "1,0.0,0.22,0.24,0.1,0,0,0,0,0,0,0,0\n"
    "1,0.1,0.225,0.24,0.1,0.1,0,0,0,0,0,0,0\n"
    "2,0.1,0.23,0.24,0.1,0,0,0,0,0,0,1.0,0.06\n"
)


class JobAlongAPath(unittest.TestCase):
    """A job along a path needs the table of its moves."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.table = str(Path(folder.name) / "moves.csv")
        Path(self.table).write_text(TABLE)

    def test_the_table_is_played_beside_its_scene(self):
        scene = str(SCENES / "plotter.toml")
        job = jobs.read(scene, self.table)
        # The scene takes its machine from another file: the key is that of both.
        texts = Path(scene).read_bytes() + (SCENES / "thesis.toml").read_bytes()
        self.assertEqual(job.scene, jobs.scene_key(texts))
        self.assertEqual((job.number, job.torque, len(job.legs)), ("f32", False, 3))
        self.assertEqual([step.power for step in job.steps], [0.0, 1.0])

    def test_what_does_not_go_together_is_refused(self):
        for path, moves, reason in [
            (str(SCENES / "plotter.toml"), None, "`moves`"),
            (str(SCENES / "thesis.toml"), self.table, "moves of its own"),
            (self.table, self.table, "goes with a scene"),
        ]:
            with self.assertRaisesRegex(jobs.JobError, reason):
                jobs.read(path, moves)


class Outputs(unittest.TestCase):
    """Spare outputs that change with the moves of a scene."""

    def read(self, old: str, new: str) -> jobs.Job:
        text = (SCENES / "inputs/valves.toml").read_text().replace("../thesis.toml", str(SCENES / "thesis.toml"))
        self.assertIn(old, text)
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "scene.toml"
            scene.write_text(text.replace(old, new))
            return jobs.read(str(scene))

    def test_they_are_bits_of_the_moves(self):
        job = jobs.read(str(SCENES / "inputs/valves.toml"))
        self.assertEqual([step.switched for step in job.steps], [(0b11, 0), (0, 0b01)])
        self.assertEqual(jobs.switch(job.steps[1], 7), Command.OutputsAt(OutputSwitch(number=7, on=0, off=1)))
        self.assertIsNone(jobs.switch(jobs.read(str(SCENES / "thesis.toml")).steps[0], 0))

    def test_what_the_scene_does_not_name_is_refused(self):
        for new, reason in [
            ("{ vent = false }", r"^[^:]*: job.move\[2\].outputs.vent: .* its outputs are air, vacuum$"),
            ("{ air = 0 }", "outputs.air = 0: expected true or false"),
        ]:
            with self.assertRaisesRegex(jobs.JobError, reason):
                self.read("{ air = false }", new)
        with tempfile.TemporaryDirectory() as folder:
            table, scene = Path(folder) / "moves.csv", Path(folder) / "scene.toml"
            table.write_text(TABLE)
            scene.write_text((SCENES / "engraving.toml").read_text() + "\n[[job.path]]\noutputs = { air = true }\n")
            with self.assertRaisesRegex(jobs.JobError, "outputs change along its path"):
                jobs.read(str(scene), str(table))


class OtherUnits(unittest.TestCase):
    """Lengths in mm, angles in degrees and rates in 1/min are those of the same key in SI units."""

    def read(self, *changes: tuple[str, str]) -> jobs.Job:
        text = (SCENES / "thesis.toml").read_text()
        for old, new in changes:
            self.assertIn(old, text)
            text = text.replace(old, new)
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "scene.toml"
            scene.write_text(text)
            return jobs.read(str(scene))

    def test_a_pose_is_the_same_in_mm_and_degrees(self):
        start = self.read().steps[0].start
        job = self.read(("x_m = 0.21,", "x_mm = 210,"), ("alpha_rad = 0.15707963267948966", "alpha_deg = 9"))
        self.assertEqual(job.steps[0].start, start)

    def test_both_are_refused(self):
        with self.assertRaisesRegex(jobs.JobError, "x_m and x_mm are both given"):
            self.read(("x_m = 0.21,", "x_m = 0.21, x_mm = 210,"))

    def test_semicolons_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            table = Path(folder) / "moves.csv"
            table.write_text("x;y;alpha;duration\n")
            with self.assertRaisesRegex(jobs.JobError, "separate columns by commas"):
                jobs.read(str(table))


if __name__ == "__main__":
    unittest.main()
