//! Spare outputs that the program of a sender switches.

use trirrr_protocol::message::{Command, OutputSwitch, Transmit};
use trirrr_scene::{OutputBits, SparePins};
use trirrr_toolpath::OutputAct;

/// Outputs of a program whose paths the machine plans: the moves of a path are not known here, but for the first one of a path that
/// begins at rest.
pub(super) struct ProgramOutputs {
    /// Outputs of jobs. They fall where the machine comes to rest, and the program does not end there.
    of_jobs: u8,
    /// Those of them that the program has on.
    kept: u8,
    /// Changes with the next motion.
    with_motion: OutputBits,
    /// Move with which the machine knows them to change.
    told: Option<u32>,
    /// The program is over once the machine stands.
    ends: bool,
}

impl ProgramOutputs {
    pub(super) fn new(pins: &SparePins) -> Self {
        Self {
            of_jobs: pins.parameters().in_jobs,
            kept: 0,
            with_motion: OutputBits::default(),
            told: None,
            ends: false,
        }
    }

    /// Takes a change, and returns the command of one at rest.
    pub(super) fn switch<N: Transmit>(&mut self, act: OutputAct) -> Option<Command<N>> {
        let OutputAct {
            index,
            on,
            with_motion,
        } = act;
        let bits = OutputBits::one(index, on);
        self.kept = (self.kept & !bits.off | bits.on) & self.of_jobs;
        if with_motion {
            self.with_motion = self.with_motion.then(bits);
            return None;
        }
        Some(Command::Output { index, on })
    }

    /// Returns the change with a path that begins at rest with the move `number`, unless the machine knows it.
    pub(super) fn with_path(&self, number: u32) -> Option<OutputSwitch> {
        let kept = OutputBits {
            on: self.kept,
            off: 0,
        };
        let OutputBits { on, off } = kept.then(self.with_motion);
        let is_news = on | off != 0 && self.told != Some(number);
        is_news.then_some(OutputSwitch { number, on, off })
    }

    /// The machine knows the change with the move `number`.
    pub(super) fn are_told(&mut self, number: u32) {
        self.told = Some(number);
        self.with_motion = OutputBits::default();
    }

    /// The program ends behind what the machine has.
    pub(super) fn end(&mut self) {
        self.ends = true;
    }

    /// The machine has nothing left to play.
    pub(super) fn rest(&mut self) {
        if std::mem::take(&mut self.ends) {
            self.kept = 0;
        }
    }

    /// Forgets the program: outputs fall with it, or stay as they are.
    pub(super) fn clear(&mut self) {
        self.kept = 0;
        self.with_motion = OutputBits::default();
        self.told = None;
        self.ends = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_scene::SpareOutput;

    fn outputs() -> ProgramOutputs {
        let output = |name: &str, job_only| SpareOutput {
            name: name.into(),
            job_only,
        };
        ProgramOutputs::new(&SparePins {
            outputs: vec![output("air", true), output("vacuum", false)],
            inputs: Vec::new(),
        })
    }

    fn act(index: u8, on: bool, with_motion: bool) -> OutputAct {
        OutputAct {
            index,
            on,
            with_motion,
        }
    }

    #[test]
    fn a_change_with_the_motion_comes_with_the_next_path_once() {
        let mut outputs = outputs();
        assert_eq!(outputs.with_path(3), None);
        assert_eq!(outputs.switch::<f64>(act(1, true, true)), None);
        assert_eq!(outputs.switch::<f64>(act(1, false, true)), None);
        let expected = OutputSwitch {
            number: 3,
            on: 0,
            off: 0b10,
        };
        assert_eq!(outputs.with_path(3), Some(expected));
        outputs.are_told(3);
        assert_eq!(outputs.with_path(3), None);
        assert_eq!(outputs.with_path(4), None);
    }

    #[test]
    fn an_output_of_jobs_goes_on_with_each_path_until_the_program_ends() {
        let mut outputs = outputs();
        let command = Command::Output { index: 0, on: true };
        assert_eq!(outputs.switch::<f64>(act(0, true, false)), Some(command));
        outputs.switch::<f64>(act(1, true, false));
        for number in [3, 9] {
            let expected = OutputSwitch {
                number,
                on: 0b01,
                off: 0,
            };
            assert_eq!(outputs.with_path(number), Some(expected));
            outputs.are_told(number);
            assert_eq!(outputs.with_path(number), None);
            outputs.rest();
        }
        outputs.end();
        assert!(outputs.with_path(10).is_some(), "the machine still moves");
        outputs.rest();
        assert_eq!(outputs.with_path(10), None);
        outputs.switch::<f64>(act(0, true, false));
        outputs.switch::<f64>(act(0, false, false));
        assert_eq!(outputs.with_path(11), None);
    }
}
