"""Homing before a job, with a machine that is told what to say; faults in words."""

import unittest
from types import SimpleNamespace

from trirrr import words
from trirrr.exchange import Refused
from trirrr.jobs import Job
from trirrr.messages import Acting, Bounded, Command, DriveFault, Fault, FaultCode, Refusal, State
from trirrr.stream import JobFailed, Stream

#: A machine in units of its own: 0.5 m, 0.25 s, 2 kg.
IDENTITY = SimpleNamespace(length_m=0.5, time_s=0.25, mass_kg=2.0)


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
        if self.refusals and (refusal := self.refusals.pop(0)) is not None:
            raise Refused(command, refusal)
        return None

    def listen(self, seconds: float) -> None:
        self.pauses.append(seconds)


def home(machine: Machine) -> None:
    stream = Stream(lambda: None, Job([]), lambda message: None)
    stream.exchange = machine
    stream.home(0.05)


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
        says = [status(state) for state in ("Unhomed", "Unhomed", "Homing", "Idle")]
        machine = Machine(*says, refusals=[Refusal.Busy(), None])
        home(machine)
        self.assertEqual(machine.heard, ["Home", "Home"])

    def test_a_refusal_is_an_error(self):
        machine = Machine(status("Unhomed"), refusals=[Refusal.NoHoming()])
        with self.assertRaisesRegex(JobFailed, "NoHoming"):
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

    def test_drives_and_boards_are_named(self):
        reported = Fault(FaultCode.Drive(DriveFault.Reported()), 1, 33.0, 0.0, 5)
        self.assertEqual(words.fault(reported, IDENTITY), "drive 2 reports its code 33 (tick 5)")
        anew = Fault(FaultCode.Board(), None, 1.0, 0.0, 0)
        text = "the board has started anew because it had failed (tick 0)"
        self.assertEqual(words.fault(anew, IDENTITY), text)


if __name__ == "__main__":
    unittest.main()
