//! Instruction counts that the `count` image prints.

use anyhow::{Context, Result, bail, ensure};

/// Counts of one run, in instructions, the empty call taken off.
#[derive(Debug, PartialEq)]
pub(crate) struct Counts {
    pub(crate) ticks: Vec<u32>,
    pub(crate) setpoints: Vec<u32>,
    /// One RRR dyad, position only.
    pub(crate) dyads: Vec<u32>,
    /// Checksum of the results.
    pub(crate) bits: u64,
}

/// Reads `empty E F G`, then `tick T S D` per tick, then `bits HEX`, counts being in units of which
/// an instruction takes `units`.
pub(crate) fn parse(printed: &str, units: f64) -> Result<Counts> {
    let mut empty = None;
    let mut bits = None;
    let mut ticks = Vec::new();
    let mut setpoints = Vec::new();
    let mut dyads = Vec::new();
    for line in printed.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("empty") => empty = Some(three(words, units).with_context(|| line.to_owned())?),
            Some("tick") => {
                let counts = three(words, units).with_context(|| line.to_owned())?;
                let empty = empty.context("a tick before the empty call")?;
                let less = |count: u32, empty: u32| {
                    count
                        .checked_sub(empty)
                        .with_context(|| format!("{line}: less than the empty call's {empty}"))
                };
                ticks.push(less(counts[0], empty[0])?);
                setpoints.push(less(counts[1], empty[1])?);
                dyads.push(less(counts[2], empty[2])?);
            }
            Some("bits") => {
                let word = words.next().context("no checksum after `bits`")?;
                bits = Some(u64::from_str_radix(word, 16).with_context(|| line.to_owned())?);
            }
            _ => bail!("the image says: {line}"),
        }
    }
    let bits = bits.context("the image printed no checksum")?;
    Ok(Counts {
        ticks,
        setpoints,
        dyads,
        bits,
    })
}

/// Three counts. The counter's reading lags by less than one unit at either end, so the nearest
/// whole number of instructions is the right one.
fn three<'a>(mut words: impl Iterator<Item = &'a str>, units: f64) -> Result<[u32; 3]> {
    let mut next = || -> Result<u32> {
        let count: u32 = words.next().context("a count is missing")?.parse()?;
        Ok((f64::from(count) / units).round() as u32)
    };
    Ok([next()?, next()?, next()?])
}

/// Least, mean (to a tenth) and greatest.
#[derive(Debug, PartialEq)]
pub(crate) struct Spread {
    pub(crate) min: f64,
    pub(crate) mean: f64,
    pub(crate) max: f64,
}

impl Spread {
    pub(crate) fn of(counts: &[u32]) -> Result<Self> {
        ensure!(!counts.is_empty(), "nothing was counted");
        let sum: f64 = counts.iter().copied().map(f64::from).sum();
        let extreme = |found: Option<&u32>| f64::from(*found.expect("not empty"));
        Ok(Self {
            min: extreme(counts.iter().min()),
            mean: (10.0 * sum / counts.len() as f64).round() / 10.0,
            max: extreme(counts.iter().max()),
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
        let counts = parse(printed, 6.4).expect("well formed");
        assert_eq!(counts.ticks, [100, 90]);
        assert_eq!(counts.setpoints, [10, 10]);
        assert_eq!(counts.dyads, [50, 50]);
        assert_eq!(counts.bits, 255);
    }

    #[test]
    fn every_count_is_exact_under_the_slowest_clock() {
        for instructions in 1..100_000_u32 {
            for lag in [-0.999, 0.0, 0.999] {
                let units = (f64::from(instructions) * 4.096 + lag) as u32;
                let text = format!("{units} {units} {units}");
                let counts = three(text.split(' '), 4.096).expect("three counts");
                assert_eq!(counts, [instructions; 3], "read as {units}");
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
            let error = parse(printed, 1.0).expect_err(printed);
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
