"""Goals, with a machine that is a list of answers."""

import unittest
from types import SimpleNamespace

from trirrr.exchange import Exchange, Refused
from trirrr.goals import Mover, NoMotion
from trirrr.messages import Bounded, Violation
from trirrr.postcard import Value


#: Leg 1 would be 2 length units long, 1 is allowed.
REACH = Violation(
    what=Bounded.Reach(), index=0, at=0.0, value=2.0, error=0.0, limit=1.0, certain=True, ramp=False, shortest=None
)


class Machine:
    """Takes a goal at the second time that it is asked, and stands there after a few questions."""

    def __init__(self, refused=None):
        self.identity = SimpleNamespace(length_m=0.5, time_s=1.0, mass_kg=1.0, ramp_ticks=100, tick_rate_hz=1000.0)
        self.asked, self.goals, self.refused = [], [], refused
        self.left = 0

    def ask(self, command):
        self.asked.append(command.name)
        if command.name == "Start":
            self.left = 3
        if command.name != "Status":
            return None
        self.left = max(self.left - 1, 0)
        waits = bool(self.goals) and "Start" not in self.asked
        pose = SimpleNamespace(x=0.4, y=0.6, alpha=0.1)
        return SimpleNamespace(
            end=SimpleNamespace(pose=pose),
            refused=self.refused if self.goals else None,
            fault=None,
            planning=False,
            state=Value("Running" if self.left else "Idle", None),
            acting=Value("Nothing", None),
            next=5,
            admitted=5,
            done=4 if waits or self.left else 5,
        )

    def retarget(self, pose, velocity, cut, seconds):
        self.goals.append((pose, velocity, cut, seconds))
        if len(self.goals) == 1:
            raise Refused(Value("Retarget", None), Value("Retargeting", None))

    enable = Exchange.enable

    def listen(self, seconds):
        pass


class Goals(unittest.TestCase):
    def test_a_goal_is_asked_for_until_it_is_taken_and_started(self):
        machine = Machine()
        self.assertEqual(Mover(machine).move_to((0.2, 0.3, 0.1)), (0.2, 0.3, 0.1))
        self.assertEqual(machine.goals, [((0.2, 0.3, 0.1), (0.0, 0.0, 0.0), True, 0.0)] * 2)
        self.assertEqual(machine.asked.count("Start"), 1)

    def test_a_step_counts_from_the_end_of_what_is_planned(self):
        machine = Machine()
        Mover(machine).step((0.01, 0.0, -0.1))
        (x, y, alpha), *_ = machine.goals[-1]
        self.assertAlmostEqual(x, 0.21)
        self.assertAlmostEqual(y, 0.3)
        self.assertAlmostEqual(alpha, 0.0)

    def test_a_refused_goal_says_why(self):
        machine = Machine(refused=SimpleNamespace(number=5, violation=REACH))
        with self.assertRaisesRegex(NoMotion, "span of leg 1 would be 1 m"):
            Mover(machine).move_to((0.9, 0.3, 0.1))


if __name__ == "__main__":
    unittest.main()
