"""Homing before a job, with a machine that is told what to say; faults in words."""

import unittest
from dataclasses import replace
from types import SimpleNamespace

from trirrr import words
from trirrr.exchange import Exchange, Refused
from trirrr.jobs import Job, Step
from trirrr.messages import (
    Acting, Bounded, Command, DriveFault, DriveState, Fault, FaultCode, LeastDuration, NotEnabled, Quantity, Refusal, SceneNeed, State, UpdateRefusal,
    Violation,
)
from trirrr.numbers import Pose
from trirrr.postcard import BOOL, BYTE, F64, I32, N, U16, U32, U64, Enum, Optional, Struct, Tuple
from trirrr.stream import JobFailed, Stream

#: A machine in units of its own: 0.5 m, 0.25 s, 2 kg.
IDENTITY = SimpleNamespace(length_m=0.5, time_s=0.25, mass_kg=2.0, tick_rate_hz=100.0)


def status(state: str, fault=None, acting=None) -> SimpleNamespace:
    return SimpleNamespace(state=getattr(State, state)(), fault=fault, acting=acting or Acting.Nothing())


class Machine:
    """Says one thing after the other when it is asked for its status, the last for ever."""

    def __init__(self, *says, refusals=()) -> None:
        self.identity = IDENTITY
        self.says = list(says)
        self.refusals = list(refusals)
        self.heard = []
        self.pauses = []

    def ask(self, command):
        if command.name == "Status":
            return self.says.pop(0) if len(self.says) > 1 else self.says[0]
        self.heard.append(command.name)
        self.last = command
        if self.refusals and (refusal := self.refusals.pop(0)) is not None:
            raise Refused(command, refusal)
        return None

    enable = Exchange.enable

    def listen(self, seconds: float) -> None:
        self.pauses.append(seconds)


def stream(machine: Machine, **more) -> Stream:
    """A job of 10 mm in 1 s, on this machine."""
    step = Step((0.2, 0.2, 0.1), (0.21, 0.2, 0.1), (0.0,) * 3, (0.0,) * 3, 1.0, **more)
    stream = Stream(lambda: None, Job([step]), lambda message: None)
    stream.exchange = machine
    stream._moves = stream._job.moves(IDENTITY)
    return stream


def home(machine: Machine) -> None:
    stream(machine).home(0.05)


def recover(machine: Machine) -> None:
    stream(machine).recover(2.0, 0.05)


class Homing(unittest.TestCase):
    def test_a_machine_that_is_not_homed_is_homed_and_waited_for(self):
        says = [status(state) for state in ("Unhomed", "Homing", "Homing", "Recovering", "Idle")]
        machine = Machine(*says)
        home(machine)
        self.assertEqual(machine.heard, ["Home"])
        # It is let alone between two looks, and looked at until it is idle.
        self.assertEqual(machine.pauses, [0.05] * 3)
        self.assertEqual([left.state.name for left in machine.says], ["Idle"])

    def test_a_machine_that_knows_its_motors_is_left_alone(self):
        for state in ("Idle", "Running", "Cleared", "Fault"):
            machine = Machine(status(state))
            home(machine)
            self.assertEqual((machine.heard, machine.pauses), ([], []))

    def test_a_busy_machine_is_asked_again(self):
        says = [status(state) for state in ("Unhomed", "Homing", "Idle")]
        machine = Machine(*says, refusals=[Refusal.Busy(), None])
        home(machine)
        self.assertEqual(machine.heard, ["Home", "Home"])

    def test_a_refusal_is_an_error(self):
        machine = Machine(status("Unhomed"), refusals=[Refusal.NoHoming()])
        with self.assertRaisesRegex(JobFailed, "the scene has no \\[homing\\]"):
            home(machine)

    def test_a_fault_is_told_in_words(self):
        fault = Fault(FaultCode.HomingNotFound(), 1, 0.8, 0.8, 1234)
        machine = Machine(status("Unhomed"), status("Homing"), status("Fault", fault))
        with self.assertRaises(JobFailed) as raised:
            home(machine)
        text = "homing: motor 2 has not found its switch or stop within 0.8 rad (tick 1234)"
        self.assertEqual(str(raised.exception), text)

    def test_homing_that_is_given_up_is_an_error_with_its_reason(self):
        machine = Machine(status("Unhomed"), status("Homing"), status("Unhomed", acting=Acting.Silence()))
        with self.assertRaisesRegex(JobFailed, "homing was given up: Silence"):
            home(machine)


class Recovering(unittest.TestCase):
    FAULT = Fault(FaultCode.Overrun(), None, 1.5, 1.0, 7)

    def test_a_fault_is_acknowledged_and_the_motors_are_moved_to_the_start(self):
        # What the tick has not heard of is still there.
        says = [status("Fault", self.FAULT), status("Disabled", self.FAULT)]
        says += [status(state) for state in ("Disabled", "Disabled", "Cleared", "Recovering", "Recovering", "Idle")]
        machine = Machine(*says)
        recover(machine)
        self.assertEqual(machine.heard, ["ClearFault", "Enable", "Recover"])
        recovery = machine.last.content
        # 2 s at 100 Hz; 0.2 m in units of 0.5 m.
        self.assertEqual((recovery.ticks, recovery.to.x, recovery.to.alpha), (200, 0.4, 0.1))

    def test_a_machine_that_stands_elsewhere_is_moved_to_the_start(self):
        machine = Machine(*[status(state) for state in ("Idle", "Recovering", "Idle")])
        recover(machine)
        self.assertEqual(machine.heard, ["Recover"])

    def test_a_quintic_starts_where_a_cubic_does(self):
        machine = Machine(*[status(state) for state in ("Idle", "Recovering", "Idle")])
        stream(machine, accelerations=((0.0,) * 3, (0.0,) * 3)).recover(2.0, 0.05)
        self.assertEqual(machine.last.content.to.x, 0.4)

    def test_a_machine_beside_the_start_of_a_quintic_is_moved_there(self):
        # 0.1 mm away, in units of 0.5 m.
        end = SimpleNamespace(pose=Pose(0.4002, 0.4, 0.1))
        beside = SimpleNamespace(state=State.Idle(), end=end, next=0, done=0)
        machine = Machine(beside, status("Recovering"), status("Idle"))
        stream(machine, accelerations=((0.0,) * 3, (0.0,) * 3)).approach(0.05)
        self.assertEqual(machine.heard, ["Recover"])
        self.assertEqual(machine.last.content.to, Pose(0.4, 0.4, 0.1))

    def test_a_machine_that_is_being_stopped_is_waited_for(self):
        machine = Machine(*[status(state) for state in ("Stopping", "Stopping", "Idle", "Recovering", "Idle")])
        recover(machine)
        self.assertEqual(machine.heard, ["Recover"])

    def test_a_machine_with_homing_is_left_to_it(self):
        machine = Machine(status("Fault", self.FAULT), status("Disabled"), status("Disabled"), status("Unhomed"))
        recover(machine)
        self.assertEqual(machine.heard, ["ClearFault", "Enable"])

    def test_a_recovery_that_does_not_end_at_the_start_is_an_error(self):
        machine = Machine(status("Cleared"), status("Recovering"), status("Cleared", acting=Acting.Stop()))
        with self.assertRaisesRegex(JobFailed, "the recovery was given up: Stop"):
            recover(machine)
        machine = Machine(status("Cleared"), status("Recovering"), status("Fault", self.FAULT))
        with self.assertRaisesRegex(JobFailed, "a tick took 1.5 of its period"):
            recover(machine)


def example(kind):
    """A value of a type."""
    if kind in (BOOL, BYTE, U16, U32, U64, I32, N, F64):
        return 1
    match kind:
        case Optional():
            return example(kind.inner)
        case Tuple():
            return tuple(example(part) for part in kind.parts)
        case Struct():
            return kind(**{name: example(each) for name, each in kind.fields.items()})
        case Enum():
            return every(kind)[0]
    return 0.5


def every(kind):
    """A value of every variant."""
    values = []
    for name, content in kind.variants.items():
        make = getattr(kind, name)
        if content is None:
            values.append(make())
        elif name in kind.with_fields:
            values.append(make(**vars(example(content))))
        else:
            values += [make(inner) for inner in (every(content) if isinstance(content, Enum) else [example(content)])]
    return values


class Words(unittest.TestCase):
    def test_every_code_has_words(self):
        codes = [
            getattr(FaultCode, name)(*([] if kind is None else [getattr(kind, inner)()]))
            for name, kind in FaultCode.variants.items()
            for inner, _ in (kind.variants.items() if kind is not None else [(None, None)])
        ]
        told = {words.fault(Fault(code, 2, 0.5, 0.25, 7), IDENTITY) for code in codes}
        self.assertEqual(len(told), len(codes))
        for text in told:
            self.assertTrue(text.endswith(" (tick 7)"), text)
            self.assertNotIn("{", text)
            self.assertNotIn("None", text)

    def test_every_refusal_has_words(self):
        told = [words.refusal(value) for value in every(Refusal)]
        self.assertEqual(len(set(told)), len(told))
        for text in told + [words.not_enabled(value) for value in every(NotEnabled)]:
            self.assertNotIn("{", text)
            self.assertNotIn("None", text)
            self.assertNotRegex(text, r"\w\(")

    def test_a_refusal_counts_from_one_and_names_what_it_is_about(self):
        for found, text in [
            (Refusal.LimitSwitch(motor=1), "motor 2 stands on its limit switch: only"),
            (Refusal.Parameter(quantity=Quantity.DistalLength(), leg=2), "length of the distal link of leg 3 cannot"),
            (Refusal.Parameter(quantity=Quantity.Gravity(), leg=None), "gravity cannot be built"),
            (Refusal.State(State.Unhomed()), "not while the machine is not homed"),
            (Refusal.NoOutput(outputs=2), "names 2 spare outputs, of the numbers 0 to 1"),
            (Refusal.NoOutput(outputs=0), "names no spare output"),
            (Refusal.Update(UpdateRefusal.SceneNeeds(SceneNeed.Brake())), "its brake (brake in [power], there or not)"),
        ]:
            self.assertIn(text, words.refusal(found))
        late = Command.Recover(SimpleNamespace(ticks=0))
        self.assertIn("its duration is 0 ticks; 1 to 9", words.refusal(Refusal.Duration(longest=9), late))

    def test_drives_that_do_not_go_on_say_why(self):
        for error, text in [(0, "drive 3 is silent: look at"), (7, "drive 3 is silent and reports its code 7: clear it")]:
            found = NotEnabled.Drive(motor=2, state=DriveState.Silent(), error=error)
            self.assertIn(text, words.not_enabled(found))
            self.assertEqual(words.wants_acknowledgement(found), error != 0)
        restarted = NotEnabled.Restarted(angles=(None, 0.5, -1.0))
        text = "drive 2, drive 3; joint 2 is taken to be at 0.5 rad, joint 3 is taken to be at -1 rad, or whole turns"
        self.assertIn(text, words.not_enabled(restarted))
        self.assertTrue(words.wants_acknowledgement(restarted))
        near = NotEnabled.Singular(what=Bounded.SerialDistance(), leg=0, value=0.01, limit=0.02)
        text = "the distance from the serial singularity of leg 1 is 0.01, the least allowed is 0.02"
        self.assertIn(text, words.not_enabled(near))

    def test_limits_are_in_si_units(self):
        for what, index, text in [
            # 0.5 and 0.25 in units of 1 / 0.25 s, of 0.5^2 m^2 2 kg / 0.25^2 s^2, of nothing.
            (Bounded.Rate(), 0, "rate of motor 1 was 2 rad/s, the most allowed is 1 rad/s"),
            (Bounded.Torque(), 1, "torque of motor 2 was 4 N m, the most allowed is 2 N m"),
            (
                Bounded.ParallelDistance(),
                None,
                "distance from the parallel singularity was 0.5, the least allowed is 0.25",
            ),
            (Bounded.Range(), 2, "a result was beyond the range of the number type of leg 3"),
        ]:
            fault = Fault(FaultCode.Limit(what), index, 0.5, 0.25, 9)
            self.assertEqual(words.fault(fault, IDENTITY), f"{text} (tick 9)")

    def test_a_violation_says_whether_it_is_certain(self):
        shortest = LeastDuration(enough=640, too_short=639)
        # A torque of 4 units, each 8 N m, 25 ticks of 100 Hz into the move.
        found = Violation(
            what=Bounded.Torque(), index=1, at=0.25, value=4.0, error=0.5, limit=3.0,
            certain=True, ramp=True, shortest=shortest,
        )
        self.assertEqual(
            words.violation(found, 100, IDENTITY),
            "torque of motor 2 would be 32 N m (from 28 to 36) in a hold or a resume there, the most allowed is "
            "24 N m, 0.25 s into the move; 640 ticks (6.4 s) would be long enough, 639 are too few",
        )
        near = replace(found, certain=False, error=2.0, ramp=False, shortest=LeastDuration(640, 0))
        text = words.violation(near, 100, IDENTITY)
        self.assertIn("is not proven to keep its limit: it would be 32 N m (from 16 to 48), the most", text)
        self.assertTrue(text.endswith("long enough, fewer are not proven to be"), text)
        unknown = replace(near, what=Bounded.ParallelDistance(), index=None, error=None, shortest=None)
        self.assertEqual(
            words.violation(unknown, 100, IDENTITY),
            "distance from the parallel singularity has no bounds there, the least allowed is 3, 0.25 s into the move",
        )

    def test_drives_and_boards_are_named(self):
        reported = Fault(FaultCode.Drive(DriveFault.Reported()), 1, 33.0, 0.0, 5)
        self.assertEqual(words.fault(reported, IDENTITY), "drive 2 reports its code 33 (tick 5)")
        anew = Fault(FaultCode.Board(), None, 1.0, 0.0, 0)
        text = "the board has started anew because it had failed (tick 0)"
        self.assertEqual(words.fault(anew, IDENTITY), text)


if __name__ == "__main__":
    unittest.main()
