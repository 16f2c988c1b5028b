//! Levels of pins over time.

use crate::time::{SECOND, Time};
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, Write};

/// Level of a pin as the chip drives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    Low,
    High,
    /// The chip does not drive the pin: a resistor of the wiring decides.
    Floating,
}

impl Level {
    pub(crate) fn of(high: bool) -> Self {
        match high {
            true => Self::High,
            false => Self::Low,
        }
    }
}

/// Pin of a port: `Pin('A', 5)` is PA5.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Pin(pub(crate) char, pub(crate) u8);

impl fmt::Display for Pin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "P{}{}", self.0, self.1)
    }
}

/// Change of a pin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub(crate) time: Time,
    pub(crate) level: Level,
}

/// Edges of all pins.
#[derive(Debug, Default)]
pub(crate) struct Trace {
    edges: BTreeMap<Pin, Vec<Edge>>,
}

impl Trace {
    /// Records the level of a pin from `time` on. A level that the pin has is no edge.
    pub(crate) fn record(&mut self, time: Time, pin: Pin, level: Level) {
        if self.level(pin) != level {
            self.edges
                .entry(pin)
                .or_default()
                .push(Edge { time, level });
        }
    }

    /// Returns the present level of a pin. It floats before its first edge, as in a reset.
    pub(crate) fn level(&self, pin: Pin) -> Level {
        self.edges(pin)
            .last()
            .map_or(Level::Floating, |edge| edge.level)
    }

    /// Returns the edges of a pin, in the order of time.
    pub(crate) fn edges(&self, pin: Pin) -> &[Edge] {
        self.edges.get(&pin).map_or(&[], Vec::as_slice)
    }

    /// Writes `signals`, names with their pins, as Value Change Dump for a waveform viewer. A pin that floats is `z`.
    pub(crate) fn write_vcd(&self, signals: &[(&str, Pin)], to: &mut impl Write) -> io::Result<()> {
        writeln!(to, "$timescale 1 ns $end\n$scope module board $end")?;
        let mark = |index: usize| char::from(b'!' + index as u8);
        for (index, (name, pin)) in signals.iter().enumerate() {
            let name = name.replace(' ', "_");
            writeln!(to, "$var wire 1 {} {name}_{pin} $end", mark(index))?;
        }
        writeln!(to, "$upscope $end\n$enddefinitions $end\n#0\n$dumpvars")?;
        for index in 0..signals.len() {
            writeln!(to, "z{}", mark(index))?;
        }
        writeln!(to, "$end")?;
        let mut changes: Vec<(Time, usize, Level)> = Vec::new();
        for (index, (_, pin)) in signals.iter().enumerate() {
            let of_pin = self.edges(*pin).iter();
            changes.extend(of_pin.map(|edge| (edge.time, index, edge.level)));
        }
        changes.sort_by_key(|change| change.0);
        let mut written = None;
        for (time, index, level) in changes {
            let ns = u128::from(time) * 1_000_000_000 / u128::from(SECOND);
            if written != Some(ns) {
                writeln!(to, "#{ns}")?;
                written = Some(ns);
            }
            let value = match level {
                Level::Low => '0',
                Level::High => '1',
                Level::Floating => 'z',
            };
            writeln!(to, "{value}{}", mark(index))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::MICROSECOND;

    #[test]
    fn a_level_that_a_pin_has_is_no_edge() {
        let mut trace = Trace::default();
        let pin = Pin('C', 0);
        for (time, level) in [(1, Level::Low), (2, Level::Low), (3, Level::High)] {
            trace.record(time, pin, level);
        }
        let times: Vec<Time> = trace.edges(pin).iter().map(|edge| edge.time).collect();
        assert_eq!(times, [1, 3]);
    }

    #[test]
    fn a_dump_has_each_change_at_its_time_in_ns() {
        let mut trace = Trace::default();
        trace.record(MICROSECOND, Pin('A', 5), Level::High);
        trace.record(2 * MICROSECOND, Pin('A', 5), Level::Floating);
        let mut dump = Vec::new();
        trace
            .write_vcd(&[("tool", Pin('A', 5))], &mut dump)
            .expect("memory takes it");
        let dump = String::from_utf8(dump).expect("text");
        assert!(dump.contains("$var wire 1 ! tool_PA5 $end"), "{dump}");
        assert!(dump.ends_with("#1000\n1!\n#2000\nz!\n"), "{dump}");
    }
}
