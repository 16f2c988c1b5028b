"""Studies in parts, with the program itself."""

import importlib.util
import tempfile
import unittest
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

from programs import ROOT, program
from trirrr import study

SCENE = ROOT / "scenes/design/lift.toml"


class Mapper:
    """Has `map` alone, as a pool of Ray."""

    def map(self, function, tasks):
        return [function(task) for task in reversed(list(tasks))][::-1]


@unittest.skipIf(program() is None, "trirrr is not built")
class Studies(unittest.TestCase):
    def run_study(self, executor, shards=3, **changed):
        with tempfile.TemporaryDirectory() as out:
            asked = {
                "vary": ["mode", "machine.leg[*].distal_m=0.12..0.15"],
                "objectives": ["torque"],
                "evaluations": 60,
                "arguments": ["--cells", "32"],
            } | changed
            found = study.run(SCENE, shards=shards, executor=executor, out=out, program=program(), **asked)
            self.assertTrue((Path(out) / "best.toml").is_file())
            return found

    def test_a_study_is_the_same_over_threads_processes_and_a_mere_map(self):
        alone = self.run_study(None)
        with ThreadPoolExecutor(2) as threads:
            self.assertEqual(self.run_study(threads), alone)
        with ProcessPoolExecutor(2) as processes:
            self.assertEqual(self.run_study(processes), alone)
        self.assertEqual(self.run_study(Mapper()), alone)
        found = [each["found"][0] for each in alone["candidates"] if each["found"]]
        self.assertEqual(alone["result"]["best"]["found"][0], min(found))
        self.assertLessEqual(len(alone["candidates"]), 60)
        # Each mode belongs to a part, and all of them are looked at.
        self.assertEqual(len({each["mode"] for each in alone["candidates"]}), 8)

    @unittest.skipIf(importlib.util.find_spec("distributed") is None, "Dask is not installed: pip install dask distributed")
    def test_a_study_is_the_same_over_processes_of_dask(self):
        from dask.distributed import Client, LocalCluster

        with LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            over = self.run_study(client, vary=["mode"], evaluations=8)
        self.assertEqual(over, self.run_study(None, vary=["mode"], evaluations=8))

    def test_a_wrong_bound_is_refused_with_key_and_reason(self):
        with self.assertRaises(study.StudyRefused) as refused:
            self.run_study(None, vary=["machine.leg[*].distl_m=0.1..0.2"])
        for part in ("machine.leg[*].distl_m", "did you mean `distal_m`"):
            self.assertIn(part, str(refused.exception))


if __name__ == "__main__":
    unittest.main()
