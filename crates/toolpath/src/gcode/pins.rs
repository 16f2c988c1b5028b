//! Outputs and inputs of a block: M62 to M66.
use super::block::ValueWord;
use super::refusal::{GcodeRefusal, RefusalKind};
use super::run::LineRun;
use crate::{Act, InputAct, InputChange, OutputAct};

/// Reason to refuse an output that waits for a motion which does not come.
pub(super) const NO_MOTION: &str =
    "no motion follows with which the output would change; M64 and M65 change it at once";

/// M62 to M65 of a block.
#[derive(Clone, Copy)]
pub(super) struct OutputCode<'t> {
    pub(super) on: bool,
    pub(super) with_motion: bool,
    pub(super) text: &'t str,
}

impl LineRun<'_, '_> {
    /// M62 to M65.
    pub(super) fn output(&mut self) -> Result<(), GcodeRefusal> {
        let Some(OutputCode {
            on,
            with_motion,
            text,
        }) = self.output
        else {
            return Ok(());
        };
        let Some(word) = self.block.value(b'P') else {
            let reason = "an output needs P with its number";
            return Err(self.block.refuse(RefusalKind::MissingWord, text, reason));
        };
        let index = self.pin(word, self.fixed.outputs, "output")?;
        if with_motion {
            self.state.waiting = Some(self.block.number);
        }
        // As in a dwell: a gripper must not let go for it.
        let tool = self.tool_at_rest();
        self.push(
            tool,
            Act::Output(OutputAct {
                index,
                on,
                with_motion,
            }),
        );
        Ok(())
    }

    /// M66.
    pub(super) fn input(&mut self) -> Result<(), GcodeRefusal> {
        let Some(text) = self.input else {
            return Ok(());
        };
        let [number, change, timeout] = [b'P', b'L', b'Q'].map(|letter| self.block.value(letter));
        let missing = |reason| self.block.refuse(RefusalKind::MissingWord, text, reason);
        let number = number.ok_or_else(|| missing("a wait needs P with the number of an input"))?;
        let change = change.ok_or_else(|| {
            missing(
                "a wait needs L: L1 until the input goes on, L2 off, L3 until it is on, L4 is off",
            )
        })?;
        let until = match change.value {
            1.0 => InputChange::Rise,
            2.0 => InputChange::Fall,
            3.0 => InputChange::High,
            4.0 => InputChange::Low,
            0.0 => {
                let reason = "no parameter takes the level of an input; L1 to L4 wait for one";
                return Err(self
                    .block
                    .refuse(RefusalKind::Unsupported, change.text, reason));
            }
            _ => {
                let reason = "the wait ends with L1, the input goes on, L2, off, L3, it is on, or L4, is off";
                return Err(self
                    .block
                    .refuse(RefusalKind::Unsupported, change.text, reason));
            }
        };
        let timeout =
            timeout.ok_or_else(|| missing("a wait needs Q with the seconds that it may last"))?;
        if timeout.value <= 0.0 {
            let reason = "the seconds of a wait are positive";
            return Err(self
                .block
                .refuse(RefusalKind::Unsupported, timeout.text, reason));
        }
        let index = self.pin(number, self.fixed.inputs, "input")?;
        // The tool is off while the machine waits: a laser that stands burns.
        self.push(
            None,
            Act::Input(InputAct {
                index,
                until,
                timeout_s: timeout.value,
            }),
        );
        Ok(())
    }

    /// Number of a spare output or input in a word; `count` is how many there are, `kind` which.
    fn pin(&self, word: ValueWord<'_>, count: u8, kind: &str) -> Result<u8, GcodeRefusal> {
        (0..count)
            .find(|number| f64::from(*number) == word.value)
            .ok_or_else(|| {
                let reason = match count {
                    0 => format!("there are no {kind}s: [[io.{kind}s]] of the scene names them"),
                    _ => format!(
                        "there is no such {kind}; they have the numbers 0 to {}",
                        count - 1
                    ),
                };
                self.block
                    .refuse(RefusalKind::Unsupported, word.text, &reason)
            })
    }
}
