"""The native core over arrays, against the program and against formulas of its own."""

import copy
import multiprocessing
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import trirrr
from programs import SCENES, program
from trirrr import Machine, MotionError, PlanError, SceneError, Table

THESIS = SCENES / "thesis.toml"

#: The thesis machine with masses in its links and gravity in its plane.
HEAVY = [
    "gravity_m_s2=[0.5, -9.8]",
    "limits.torque_nm=50",
    "links.proximal={ mass_kg = 0.05 }",
    "links.distal={ mass_kg = 0.05 }",
]


def thesis(*settings: str) -> Machine:
    return Machine.from_scene(THESIS, settings)


def command(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([program(), *map(str, arguments)], capture_output=True, text=True, check=False)


def closed(machine: Machine, pose: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Lengths of the distal links that lie between the elbows at `angles` and the platform at `pose`."""
    lengths = []
    for number, leg in enumerate(machine.legs):
        way = pose[..., 2] + leg.joint_angle_rad
        joint = pose[..., :2] + leg.joint_radius_m * np.stack([np.cos(way), np.sin(way)], axis=-1)
        th = angles[..., number]
        elbow = np.asarray(leg.base_m) + leg.proximal_m * np.stack([np.cos(th), np.sin(th)], axis=-1)
        lengths.append(np.linalg.norm(joint - elbow, axis=-1))
    return np.stack(lengths, axis=-1)


class Arrays(unittest.TestCase):
    def setUp(self) -> None:
        self.machine = thesis(*HEAVY)
        draw = np.random.default_rng(5)
        self.poses = np.array([0.245, 0.25, 0.18]) + draw.uniform(-1, 1, (400, 3)) * [0.03, 0.03, 0.05]
        self.velocities = draw.uniform(-0.1, 0.1, (400, 3))
        self.accelerations = draw.uniform(-0.5, 0.5, (400, 3))

    def test_links_close_and_rates_are_derivatives(self) -> None:
        h = 1e-6
        angles = self.machine.angles(self.poses)
        lengths = closed(self.machine, self.poses, angles)
        np.testing.assert_allclose(lengths, np.tile([leg.distal_m for leg in self.machine.legs], (400, 1)), rtol=1e-12)
        ahead, behind = (self.machine.angles(self.poses + sign * h * self.velocities) for sign in (1, -1))
        np.testing.assert_allclose(
            self.machine.rates(self.poses, self.velocities), (ahead - behind) / (2 * h), atol=1e-7
        )

    def test_torques_are_the_gradient_of_energy_at_rest_and_balance_reactions(self) -> None:
        # Virtual work: the power of the motors is that of gravity, negated.
        at_rest = self.machine.torques(self.poses)
        rates = self.machine.rates(self.poses, self.velocities)
        h = 1e-6
        power = np.einsum("ij,ij->i", at_rest, rates)
        changes = (self.energy(self.poses + h * self.velocities) - self.energy(self.poses - h * self.velocities)) / (2 * h)
        np.testing.assert_allclose(power, changes, atol=1e-6)
        # The base holds the weight of everything.
        reactions = self.machine.reactions(self.poses)
        self.assertEqual(reactions.shape, (400, 3, 3, 2))
        held = reactions[:, :, 0, :].sum(axis=1)
        weight = -np.array([0.5, -9.8]) * self.mass()
        np.testing.assert_allclose(held, np.tile(weight, (400, 1)), rtol=1e-9)

    def mass(self) -> float:
        return self.platform_kg() + 6 * 0.05

    @staticmethod
    def platform_kg() -> float:
        import tomllib

        return float(tomllib.loads(THESIS.read_text())["platform"]["mass_kg"])

    def energy(self, poses: np.ndarray) -> np.ndarray:
        """Potential energy of uniform rods and of a platform whose mass is in D."""
        gravity = np.array([0.5, -9.8])
        angles = self.machine.angles(poses)
        total = -self.platform_kg() * poses[:, :2] @ gravity
        for number, leg in enumerate(self.machine.legs):
            way = poses[:, 2] + leg.joint_angle_rad
            joint = poses[:, :2] + leg.joint_radius_m * np.stack([np.cos(way), np.sin(way)], axis=-1)
            th = angles[:, number]
            r1 = leg.proximal_m * np.stack([np.cos(th), np.sin(th)], axis=-1)
            base = np.asarray(leg.base_m)
            elbow = base + r1
            total -= 0.05 * (base + 0.1 / leg.proximal_m * r1) @ gravity
            total -= 0.05 * (elbow + 0.1 / leg.distal_m * (joint - elbow)) @ gravity
        return total

    def test_tools_of_a_scene_are_platforms(self) -> None:
        machine = Machine.from_scene(SCENES / "tools.toml")
        self.assertEqual(list(machine.tools), ["pen", "gripper"])
        gripper = machine.tools["gripper"]
        self.assertEqual((gripper.mass_kg, gripper.tool_point_m), (0.85, (0.03, 0.05)))
        np.testing.assert_allclose(gripper.com_m, (0.02 * 0.35 / 0.85 - 0.03, 0.03 * 0.35 / 0.85 - 0.05))
        self.assertEqual(thesis().tools, {})

    def test_shapes_follow_the_arguments_and_broadcast(self) -> None:
        one = self.machine.torques(self.poses[0])
        self.assertEqual(one.shape, (3,))
        grid = self.machine.motors(self.poses.reshape(20, 20, 3), self.velocities[0])
        self.assertEqual([part.shape for part in grid], [(20, 20, 3)] * 4)
        same = self.machine.motors(self.poses, np.tile(self.velocities[0], (400, 1)))
        np.testing.assert_array_equal(grid.torques.reshape(-1, 3), same.torques)
        turned = np.asfortranarray(self.poses)
        np.testing.assert_array_equal(self.machine.angles(turned), self.machine.angles(self.poses))
        self.assertEqual(self.machine.angles(np.empty((0, 3))).shape, (0, 3))
        for wrong in (1.0, [1.0, 2.0], np.zeros((3, 2))):
            with self.assertRaisesRegex(ValueError, r"\(\.\.\., 3\)"):
                self.machine.angles(wrong)

    def test_states_without_motion_are_named_or_nan(self) -> None:
        poses = self.poses[:6].reshape(2, 3, 3).copy()
        poses[1, 1] = [9.0, 9.0, 0.0]
        with self.assertRaises(MotionError) as raised:
            self.machine.torques(poses)
        self.assertRegex(str(raised.exception), r"1 of 6 states .* \[1, 1\]: unreachable: leg 1")
        self.assertEqual([row for row, _ in raised.exception.rows], [4])
        for found in (
            self.machine.torques(poses, invalid="nan"),
            self.machine.distances(poses, invalid="nan").serial,
            self.machine.reactions(poses, invalid="nan"),
        ):
            lost = np.isnan(found).any(axis=tuple(range(2, found.ndim)))
            np.testing.assert_array_equal(lost, [[False] * 3, [False, True, False]])
        with self.assertRaisesRegex(ValueError, "expected 'raise' or 'nan'"):
            self.machine.angles(poses, invalid="zero")  # type: ignore[arg-type]

    def test_forward_kinematics_finds_the_pose_among_all(self) -> None:
        angles = self.machine.angles(self.poses)
        found = self.machine.forward(angles)
        self.assertTrue(found.complete.all())
        away = np.abs(found.poses - self.poses[:, None, :]).max(axis=-1)
        np.testing.assert_allclose(np.nanmin(away, axis=1), 0.0, atol=1e-9)
        for mode in range(6):
            there = found.counts > mode
            self.assertTrue(np.isnan(found.poses[~there, mode]).all())
            lengths = closed(self.machine, found.poses[there, mode], angles[there])
            np.testing.assert_allclose(lengths, np.tile([0.2] * 3, (there.sum(), 1)), rtol=1e-8)
        self.assertEqual(len(self.machine.working_modes(tuple(self.poses[0]))), 8)
        own = self.machine.working_modes(tuple(self.poses[0]))[self.machine.elbows]
        np.testing.assert_allclose(own, angles[0], atol=1e-12)

    def test_distances_vanish_where_a_leg_is_stretched(self) -> None:
        leg = self.machine.legs[0]
        # Towards the stretched leg 1, D on the line from its base.
        reach = np.linspace(0.39, 0.4 - 1e-9, 50)
        way = 0.18 + leg.joint_angle_rad
        joint = leg.joint_radius_m * np.array([np.cos(way), np.sin(way)])
        middle = np.array([0.245, 0.25])
        line = (middle - leg.base_m) / np.linalg.norm(middle - leg.base_m)
        at = np.asarray(leg.base_m) + reach[:, None] * line - joint
        poses = np.column_stack([at, np.full(50, 0.18)])
        serial = self.machine.distances(poses, invalid="nan").serial[:, 0]
        serial = serial[~np.isnan(serial)]
        if len(serial):
            self.assertTrue((np.diff(serial) < 0).all())

    def test_a_forked_process_computes_too(self) -> None:
        expected = self.machine.angles(self.poses)
        context = multiprocessing.get_context("fork")
        ours, theirs = context.Pipe()

        def work() -> None:
            theirs.send(self.machine.angles(self.poses))

        child = context.Process(target=work)
        child.start()
        self.assertTrue(ours.poll(60), "the forked process has not answered")
        np.testing.assert_array_equal(ours.recv(), expected)
        child.join()


class Scenes(unittest.TestCase):
    def test_messages_are_those_of_the_program(self) -> None:
        text = THESIS.read_text().replace("proximal_m = 0.2", "proximal_m = -0.2", 1).replace("x_m", "x_mm", 1)
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "wrong.toml"
            scene.write_text(text)
            problems = trirrr.check(scene)
            with self.assertRaises(SceneError) as raised:
                Machine.from_scene(scene)
            said = command("check", scene)
        self.assertEqual(said.returncode, 2)
        self.assertIn(str(raised.exception), said.stderr)
        self.assertEqual(raised.exception.problems, problems)
        self.assertIn(("machine.leg[1].proximal_m", "-0.2"), [(each.key, each.value) for each in problems])
        self.assertEqual(trirrr.check(THESIS), [])
        with self.assertRaisesRegex(SceneError, "cannot be read"):
            trirrr.check("nowhere.toml")

    def test_settings_replace_values(self) -> None:
        self.assertEqual(thesis("machine.leg[*].elbow=-1").elbows, (-1, -1, -1))
        with self.assertRaisesRegex(SceneError, "did you mean `distal_m`"):
            thesis("machine.leg[1].distl_m=0.2")
        with self.assertRaisesRegex(ValueError, "KEY=VALUE"):
            thesis("number")

    def test_what_a_scene_does_not_have_is_refused(self) -> None:
        still = Machine.from_scene(SCENES / "plotter.toml")
        with self.assertRaisesRegex(ValueError, "torque = false"):
            still.torques(still.start)
        with self.assertRaisesRegex(ValueError, "no plant"):
            thesis().run(plant=True)
        with self.assertRaisesRegex(PlanError, "no \\[\\[job.path\\]\\]"):
            thesis().plan()

    def test_a_verdict_names_the_limit_and_a_duration_that_is_long_enough(self) -> None:
        machine = thesis()
        to = (0.25, 0.25, 0.1)
        short = machine.admit(to, 0.02)
        self.assertFalse(short)
        self.assertRegex(str(short.reason), "torque of motor 1 would be .* the most allowed is 0.1 N m")
        assert short.enough_s is not None
        self.assertTrue(machine.admit(to, short.enough_s))
        self.assertFalse(machine.admit(to, short.enough_s - 1.5 / machine.tick_rate_hz))
        self.assertRegex(str(machine.admit((9.0, 9.0, 0.0), 1.0).reason), "the end: unreachable: leg 1")
        moving = machine.admit(to, 1.0, start_velocity=(0.01, 0.0, 0.0), accelerations=((0.0,) * 3, (0.0,) * 3))
        self.assertTrue(moving)
        for wrong in (0.0, -1.0, float("nan"), 1e12):
            with self.assertRaisesRegex(ValueError, "at least one tick|duration"):
                machine.admit(to, wrong)


class Runs(unittest.TestCase):
    def run_both(self, scene: str, tables: list[str]) -> trirrr.machine.Run:
        run = Machine.from_scene(SCENES / scene).run()
        self.assertIsNone(run.reason)
        with tempfile.TemporaryDirectory() as folder:
            done = command("run", SCENES / scene, "--fast", "--out", folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            for table in tables:
                expected = Table.from_csv(Path(folder) / f"{table}.csv")
                found = getattr(run, table)
                self.assertEqual(found.names, expected.names)
                np.testing.assert_array_equal(found.rows, expected.rows)
        return run

    def test_ticks_have_the_bits_of_the_program(self) -> None:
        run = self.run_both("thesis.toml", ["ticks"])
        self.assertIsNone(run.plant)
        # The ideal motion, evaluated over arrays, is the same.
        machine = thesis()
        motors = machine.motors(*machine.setpoints()[1:])
        np.testing.assert_array_equal(motors.torques, run.ticks.columns("tau1", "tau2", "tau3"))

    def test_the_plant_has_the_bits_of_the_program(self) -> None:
        self.run_both("plant-thesis.toml", ["ticks", "plant"])

    def test_a_number_type_of_a_board_runs(self) -> None:
        self.run_both("pick-home.toml", ["ticks"])

    def test_a_plan_is_that_of_the_program(self) -> None:
        machine = Machine.from_scene(SCENES / "plotter.toml")
        plan = machine.plan()
        self.assertLessEqual(plan.lower_bound_s, plan.planned_s)
        self.assertLessEqual(plan.planned_s, plan.duration_s)
        with tempfile.TemporaryDirectory() as folder:
            done = command("plan", SCENES / "plotter.toml", "--out", folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            expected = Table.from_csv(Path(folder) / "moves.csv")
        np.testing.assert_array_equal(plan.moves.rows, expected.rows)
        self.assertEqual(plan.moves.names, expected.names)


class Tables(unittest.TestCase):
    def test_tables_go_to_pandas_arrow_and_csv(self) -> None:
        table = Table(["t", "x"], np.array([[0.0, 0.1], [0.5, 1 / 3]]))
        frame = table.to_pandas()
        self.assertEqual(list(frame.columns), ["t", "x"])
        np.testing.assert_array_equal(frame["x"], table["x"])
        self.assertEqual(table.to_arrow().to_pydict(), {"t": [0.0, 0.5], "x": [0.1, 1 / 3]})
        with tempfile.TemporaryDirectory() as folder:
            table.to_csv(Path(folder) / "t.csv")
            np.testing.assert_array_equal(Table.from_csv(Path(folder) / "t.csv").rows, table.rows)
        with self.assertRaisesRegex(KeyError, "columns are t, x"):
            table["y"]
        self.assertEqual(len(copy.copy(table)), 2)


if __name__ == "__main__":
    unittest.main()
