//! Inputs that bounce.

/// A switch, or what a drive says of a stall, taken for true once it has been the same for some
/// ticks. What it changes by is known from the first of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Input {
    closed: bool,
    /// Readings in a row that differ from `closed`.
    differing: u16,
}

impl Input {
    /// Takes a reading. Whether it is the first of those that may turn out to be a change.
    pub(super) fn read(&mut self, closed: bool, ticks: u16) -> bool {
        if closed == self.closed {
            self.differing = 0;
            return false;
        }
        self.differing = self.differing.saturating_add(1);
        let first = self.differing == 1;
        if self.differing >= ticks {
            self.closed = closed;
            self.differing = 0;
        }
        first
    }

    /// Returns true if the input is closed, bounces taken out.
    pub(super) fn is_closed(self) -> bool {
        self.closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_counts_once_it_has_lasted() {
        let mut input = Input::default();
        // A spike, then bounces, then closed for good from the ninth reading on.
        let readings = [
            (false, false, false),
            (true, true, false),
            (false, false, false),
            (true, true, false),
            (true, false, false),
            (false, false, false),
            (true, true, false),
            (true, false, false),
            (true, false, true),
            (true, false, true),
            (false, true, true),
            (true, false, true),
            (false, true, true),
            (false, false, true),
            (false, false, false),
        ];
        for (index, (reading, first, closed)) in readings.into_iter().enumerate() {
            assert_eq!(input.read(reading, 3), first, "reading {index}");
            assert_eq!(input.is_closed(), closed, "reading {index}");
        }
    }

    #[test]
    fn a_clean_input_counts_at_once() {
        for ticks in [0, 1] {
            let mut input = Input::default();
            assert!(input.read(true, ticks));
            assert!(input.is_closed());
            assert!(!input.read(true, ticks));
            assert!(input.read(false, ticks));
            assert!(!input.is_closed());
        }
    }
}
