//! Instruction counts that an image prints.

use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;

/// Counts of one run, in instructions, the empty call taken off.
#[derive(Debug, PartialEq)]
pub(crate) struct Counts {
    /// Lines of counts, by the word in front of them.
    lines: BTreeMap<String, Vec<Vec<u32>>>,
    /// Checksum of the results.
    pub(crate) bits: u64,
}

impl Counts {
    /// Reads `empty COUNTS`, then lines of `kinds` with as many counts (`width`), then `bits HEX`, an
    /// instruction being `units` of a count.
    pub(crate) fn parse(printed: &str, units: f64, kinds: &[&str], width: usize) -> Result<Self> {
        let (mut empty, mut bits, mut lines) = (None, None, BTreeMap::<_, Vec<_>>::new());
        for line in printed.lines() {
            let (kind, values) = line.split_once(' ').unwrap_or((line, ""));
            if kind == "bits" {
                bits = Some(u64::from_str_radix(values, 16).with_context(|| line.to_owned())?);
                continue;
            }
            let is_known = kind == "empty" || kinds.contains(&kind);
            ensure!(is_known, "the image says: {line}");
            let counts = instructions(values, units).with_context(|| line.to_owned())?;
            ensure!(counts.len() == width, "{line}: not {width} counts");
            if kind == "empty" {
                empty = Some(counts);
                continue;
            }
            let empty = empty.as_ref().context("a tick before the empty call")?;
            let less = counts.iter().zip(empty).map(|(count, empty)| {
                let less = count.checked_sub(*empty);
                less.with_context(|| format!("{line}: less than the empty call's {empty}"))
            });
            let less = less.collect::<Result<Vec<u32>>>()?;
            lines.entry(kind.to_owned()).or_default().push(less);
        }
        let bits = bits.context("the image printed no checksum")?;
        Ok(Self { lines, bits })
    }

    /// One count of every line of a kind.
    pub(crate) fn column(&self, kind: &str, column: usize) -> Vec<u32> {
        let lines = self.lines.get(kind).into_iter().flatten();
        lines.map(|line| line[column]).collect()
    }

    pub(crate) fn spread(&self, kind: &str, column: usize) -> Result<Spread> {
        Spread::of(&self.column(kind, column))
    }
}

/// Counts as instructions. The counter's reading lags by less than one unit at either end, so the nearest
/// whole number of instructions is the right one.
fn instructions(values: &str, units: f64) -> Result<Vec<u32>> {
    let instructions = |value: &str| {
        let count: u32 = value.parse()?;
        Ok((f64::from(count) / units).round() as u32)
    };
    values.split_whitespace().map(instructions).collect()
}

/// Least, mean (to a tenth) and greatest.
#[derive(Debug, PartialEq)]
pub(crate) struct Spread {
    pub(crate) min: f64,
    pub(crate) mean: f64,
    pub(crate) max: f64,
}

impl Spread {
    fn of(counts: &[u32]) -> Result<Self> {
        let [min, max] = [counts.iter().min(), counts.iter().max()]
            .map(|extreme| extreme.copied().context("nothing was counted"));
        let sum: f64 = counts.iter().copied().map(f64::from).sum();
        Ok(Self {
            min: min?.into(),
            mean: (10.0 * sum / counts.len() as f64).round() / 10.0,
            max: max?.into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_become_instructions_and_the_empty_call_is_taken_off() {
        // 10 instructions are 64 units, read as 63, 64 or 65.
        let printed = "empty 63 65 64\ntick 704 128 384\ntick 640 127 385\nbits 00ff\n";
        let counts = Counts::parse(printed, 6.4, &["tick"], 3).expect("well formed");
        assert_eq!(counts.column("tick", 0), [100, 90]);
        assert_eq!(counts.column("tick", 1), [10, 10]);
        assert_eq!(counts.column("tick", 2), [50, 50]);
        assert_eq!(counts.bits, 255);
    }

    #[test]
    fn every_count_is_exact_under_the_slowest_clock() {
        for count in 1..100_000_u32 {
            for lag in [-0.999, 0.0, 0.999] {
                let units = (f64::from(count) * 4.096 + lag) as u32;
                let text = format!("{units} {units} {units}");
                let counts = instructions(&text, 4.096).expect("three counts");
                assert_eq!(counts, [count; 3], "read as {units}");
            }
        }
    }

    #[test]
    fn what_is_not_a_count_is_an_error() {
        for (printed, reason) in [
            ("error: leg 1", "the image says: error: leg 1"),
            ("tick 5 5 5", "a tick before the empty call"),
            ("empty 1 1 1\ntick 5 5 5\n", "the image printed no checksum"),
            ("empty 7 7 7\ntick 5 9 9", "less than the empty call's 7"),
            ("empty 1 1", "empty 1 1"),
            ("bits xyz", "bits xyz"),
        ] {
            let error = Counts::parse(printed, 1.0, &["tick"], 3).expect_err(printed);
            assert!(error.to_string().contains(reason), "{printed}: {error}");
        }
    }

    #[test]
    fn spread() {
        let spread = Spread::of(&[3, 1, 1]).expect("not empty");
        assert_eq!(
            spread,
            Spread {
                min: 1.0,
                mean: 1.7,
                max: 3.0
            }
        );
        assert!(Spread::of(&[]).is_err());
    }
}
