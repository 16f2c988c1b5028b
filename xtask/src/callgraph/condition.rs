//! Conditions on the instructions of IT blocks: the ways through a block, and from one to the next.

/// Dependence of the instructions to come on a condition.
///
/// Two blocks in a row may ask for the same: `itt eq; addeq sp, #8; ...` and `it eq; popeq {pc}`. So what was
/// taken to hold is kept from one to the next, or the stack would seem to be two things at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Condition {
    /// Number of these instructions. A set bit of `then` means executed (bit 0: the next one).
    count: u8,
    then: u8,
    /// Condition that is taken to hold.
    holds: Option<u8>,
}

impl Condition {
    pub(super) const NONE: Self = Self {
        count: 0,
        then: 0,
        holds: None,
    };

    fn new(count: u8, then: u8, holds: Option<u8>) -> Self {
        let then = then & ((1 << count) - 1);
        Self { count, then, holds }
    }

    /// Returns true if the processor passes over the next instruction.
    pub(super) fn skips(self) -> bool {
        self.count > 0 && self.then & 1 == 0
    }

    /// Behind the next instruction, where it does not change the flags.
    pub(super) fn rest(self) -> Self {
        match self.count {
            0 => Self::NONE,
            _ => Self::new(self.count - 1, self.then >> 1, self.holds),
        }
    }

    /// Returns what may be behind the next instruction; `compares`: it changes the flags within a block.
    pub(super) fn after(self, compares: bool) -> Vec<Self> {
        let rest = self.rest();
        match compares {
            false => vec![rest],
            true => vec![
                Self::new(rest.count, rest.then, None),
                Self::new(rest.count, !rest.then, None),
            ],
        }
    }

    /// Returns what may be behind an `it` of `count` instructions. Those of `then` are executed where the
    /// condition holds, the others where its opposite does.
    /// Conditions are in pairs of opposites, which differ in the lowest bit.
    pub(super) fn of(self, condition: u8, count: u8, then: u8) -> Vec<Self> {
        [(condition, then), (condition ^ 1, !then)]
            .into_iter()
            .filter(|(holds, _)| self.holds != Some(holds ^ 1))
            .map(|(holds, then)| Self::new(count, then, Some(holds)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EQ: u8 = 0;
    const NE: u8 = 1;
    const CS: u8 = 2;

    /// Returns for each of the next instructions whether it is executed.
    fn executed(mut condition: Condition) -> Vec<bool> {
        let mut executed = Vec::new();
        while condition.count > 0 {
            executed.push(!condition.skips());
            condition = condition.rest();
        }
        executed
    }

    #[test]
    fn a_block_has_two_ways() {
        let ways = Condition::NONE.of(EQ, 3, 0b011).into_iter().map(executed);
        assert_eq!(
            ways.collect::<Vec<_>>(),
            [[true, true, false], [false, false, true]]
        );
    }

    #[test]
    fn the_next_block_goes_on_with_what_held_in_the_one_before() {
        for held in Condition::NONE.of(EQ, 1, 1) {
            let behind = held.rest();
            let executes = !held.skips();
            let same: Vec<_> = behind.of(EQ, 1, 1).into_iter().map(executed).collect();
            assert_eq!(same, [[executes]]);
            let opposite: Vec<_> = behind.of(NE, 1, 1).into_iter().map(executed).collect();
            assert_eq!(opposite, [[!executes]]);
            assert_eq!(behind.of(CS, 1, 1).len(), 2);
            // Any instruction between them may have changed the flags.
            assert_eq!(behind.rest().of(EQ, 1, 1).len(), 2);
        }
    }

    #[test]
    fn a_comparison_within_a_block_leaves_both_open() {
        let [held, _] = Condition::NONE.of(EQ, 2, 0b11)[..] else {
            panic!("two ways");
        };
        let ways: Vec<_> = held.after(true).into_iter().map(executed).collect();
        assert_eq!(ways, [[true], [false]]);
        assert_eq!(held.after(false), [held.rest()]);
    }
}
