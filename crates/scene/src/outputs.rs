//! Changes of spare outputs along a job: at elements of its path, and with its moves.

use crate::io::SparePins;
use crate::job_move::JobMove;
use crate::read::Section;

/// Outputs that go on, and outputs that go off, a bit for each. None does both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct OutputBits {
    /// Outputs that go on.
    pub on: u8,
    /// Outputs that go off.
    pub off: u8,
}

impl OutputBits {
    /// The output `index`, from 0 and below 8, goes on or off.
    pub fn one(index: u8, on: bool) -> Self {
        let bit = 1_u8.checked_shl(index.into()).unwrap_or(0);
        match on {
            true => Self { on: bit, off: 0 },
            false => Self { on: 0, off: bit },
        }
    }

    /// These, and then the `later` ones.
    #[must_use]
    pub fn then(self, later: Self) -> Self {
        Self {
            on: (self.on & !later.off) | later.on,
            off: (self.off & !later.on) | later.off,
        }
    }
}

/// Change of outputs at an element of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathOutputs {
    /// Number of the element in the file, from 0.
    pub source: usize,
    /// They change as its motion begins; otherwise in its dwell.
    pub with_motion: bool,
    /// Outputs.
    pub bits: OutputBits,
}

/// Outputs that change with the moves of a job: in the tick in which a move begins.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JobOutputs {
    /// Index of a move, from 0, and the outputs; in order, each move once.
    changes: Vec<(u32, OutputBits)>,
}

impl JobOutputs {
    /// Changes of the moves `steps`, each with the number of its element.
    pub(crate) fn of(path: &[PathOutputs], steps: &[(usize, JobMove)]) -> Self {
        let mut found = Self::default();
        let mut steps = (0..).zip(steps).peekable();
        for change in path {
            let is_before = |step: &(u32, &(usize, JobMove))| {
                let (source, each) = step.1;
                // A stand that waits for the tool has the number of the motion behind it.
                *source < change.source || (change.with_motion && is_stand(each))
            };
            while steps.next_if(is_before).is_some() {}
            if let Some((index, _)) = steps.peek() {
                found.add(*index, change.bits);
            }
        }
        found
    }

    /// Adds a change with the move `index`: none is known of a move behind it.
    pub fn add(&mut self, index: u32, bits: OutputBits) {
        match self.changes.last_mut() {
            Some((last, before)) if *last == index => *before = before.then(bits),
            _ => self.changes.push((index, bits)),
        }
    }

    /// Adds those of moves that follow behind the first `moves` ones.
    pub(crate) fn append(&mut self, moves: u32, behind: &Self) {
        for (index, bits) in &behind.changes {
            self.add(moves + index, *bits);
        }
    }

    /// Returns true if no output changes.
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// Returns the changes: index of the move, and outputs.
    pub fn changes(&self) -> &[(u32, OutputBits)] {
        &self.changes
    }

    /// Returns the change with the move `index`.
    pub fn get(&self, index: u32) -> Option<OutputBits> {
        let found = self.changes.binary_search_by_key(&index, |(of, _)| *of);
        found.ok().map(|at| self.changes[at].1)
    }

    /// Returns the index of the first move behind `index` with which outputs change.
    pub fn next_behind(&self, index: u32) -> Option<u32> {
        let behind = self.changes.partition_point(|(of, _)| *of <= index);
        self.changes.get(behind).map(|(of, _)| *of)
    }

    /// Returns the number of changes with moves from index `from` on, up to `to`.
    pub fn count(&self, from: u32, to: u32) -> usize {
        let before = |index| self.changes.partition_point(|(of, _)| *of < index);
        before(to).saturating_sub(before(from))
    }

    /// Returns the changes of the rest of the job, whose move `lead` is the move `index` of the whole one: with it come all changes up to
    /// there.
    #[must_use]
    pub fn rest(&self, index: u32, lead: u32) -> Self {
        let mut rest = Self::default();
        for (of, bits) in &self.changes {
            rest.add(of.saturating_sub(index) + lead, *bits);
        }
        rest
    }
}

/// Reads `outputs` of a table of a job: names of spare outputs, and their levels. No bit of what is refused, and none without `pins`.
pub(crate) fn read_outputs(each: &Section, pins: Option<&SparePins>) -> OutputBits {
    let Some(section) = each.optional_section("outputs") else {
        return OutputBits::default();
    };
    let Some(pins) = pins else {
        section.ignore_rest();
        return OutputBits::default();
    };
    let names = section.names();
    if names.is_empty() {
        let reason = "names no output; leave it out, or give some, as { NAME = true }";
        each.refuse("outputs", reason);
    }
    names.into_iter().fold(OutputBits::default(), |bits, name| {
        let on = section.boolean(name);
        let Some(index) = pins.output(name) else {
            section.refuse(name, no_output(pins));
            return bits;
        };
        on.map_or(bits, |on| bits.then(OutputBits::one(index, on)))
    })
}

fn no_output(pins: &SparePins) -> String {
    match pins.output_names()[..] {
        [] => "the scene names no spare outputs: [[io.outputs]] would".into(),
        ref names => format!(
            "no spare output has this name; those of [[io.outputs]] are {}",
            names.join(", ")
        ),
    }
}

fn is_stand(each: &JobMove) -> bool {
    each.from == each.to
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_several_changes_the_last_one_of_each_output_counts() {
        let bits = OutputBits::one(0, true).then(OutputBits::one(1, false));
        assert_eq!(bits, OutputBits { on: 1, off: 2 });
        let bits = bits.then(OutputBits::one(0, false));
        assert_eq!(bits, OutputBits { on: 0, off: 3 });
        assert_eq!(OutputBits::one(8, true), OutputBits::default());
    }

    #[test]
    fn the_rest_of_a_job_begins_with_all_changes_before_it() {
        let mut outputs = JobOutputs::default();
        for (index, bits) in [
            (0, OutputBits::one(0, true)),
            (3, OutputBits::one(1, true)),
            (3, OutputBits::one(2, true)),
            (7, OutputBits::one(0, false)),
        ] {
            outputs.add(index, bits);
        }
        assert_eq!(outputs.changes().len(), 3);
        assert_eq!(outputs.get(3), Some(OutputBits { on: 6, off: 0 }));
        assert_eq!(outputs.next_behind(3), Some(7));
        assert_eq!(outputs.count(0, 7), 2);
        let rest = outputs.rest(5, 2);
        let expected = [
            (2, OutputBits { on: 7, off: 0 }),
            (4, OutputBits { on: 0, off: 1 }),
        ];
        assert_eq!(rest.changes(), expected);
        let mut whole = JobOutputs::default();
        whole.append(0, &outputs);
        whole.append(8, &outputs);
        assert_eq!(whole.get(8), Some(OutputBits { on: 1, off: 0 }));
    }
}
