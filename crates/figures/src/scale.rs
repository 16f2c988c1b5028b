//! Axes: round ticks that carry no float noise, and engineering prefixes.

/// One axis of a figure: its range, its ticks and the unit that they are counted in.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Low end of the range shown, in the unit of the data.
    pub low: f64,
    /// High end of the range shown, in the unit of the data.
    pub high: f64,
    /// Ticks: position in the unit of the data, and label.
    pub ticks: Vec<(f64, String)>,
    /// Unit of the tick labels, such as `mN m`.
    pub unit: String,
}

/// Extent of an axis beyond the range of the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Margin {
    /// The range is shown as it is.
    Exact,
    /// A twentieth of the range is added at both ends.
    Padded,
}

/// Relative spans below this are rounding noise around a constant.
const NOISE: f64 = 1e-12;

impl Axis {
    /// An axis over `low..=high` (finite, in `unit`) with about `intervals` ticks.
    pub fn new(low: f64, high: f64, unit: &str, margin: Margin, intervals: f64) -> Self {
        let exponent = engineering_exponent(low.abs().max(high.abs()));
        Self::scaled(
            low,
            high,
            10f64.powi(exponent),
            prefixed(unit, exponent),
            margin,
            intervals,
        )
    }

    /// A time axis over `0..=end` seconds, in minutes or hours where seconds would be unwieldy.
    pub fn time(start: f64, end: f64) -> Self {
        let (factor, unit) = match end {
            _ if end >= 7200.0 => (3600.0, "h"),
            _ if end >= 600.0 => (60.0, "min"),
            _ => return Self::new(start, end, "s", Margin::Exact, 10.0),
        };
        Self::scaled(start, end, factor, unit.into(), Margin::Exact, 10.0)
    }

    fn scaled(
        low: f64,
        high: f64,
        factor: f64,
        unit: String,
        margin: Margin,
        intervals: f64,
    ) -> Self {
        // Scaled first: the differences of what follows cannot overflow.
        let (mut from, mut to) = (low / factor, high / factor);
        let largest = from.abs().max(to.abs());
        if largest == 0.0 {
            (from, to) = (-1.0, 1.0);
        } else if to - from <= NOISE * largest {
            (from, to) = (from - 0.2 * largest, to + 0.2 * largest);
        } else if margin == Margin::Padded {
            let pad = (to - from) / 20.0;
            (from, to) = (from - pad, to + pad);
        }
        let step = TickDistance::for_span((to - from) / intervals);
        let ticks = step
            .multiples(from, to)
            .map(|count| (step.value(count) * factor, step.label(count)))
            .collect();
        Self {
            low: from * factor,
            high: to * factor,
            ticks,
            unit,
        }
    }

    /// Relative position of `value` on the axis: 0 at the low end, 1 at the high end.
    pub fn fraction(&self, value: f64) -> f64 {
        // Halved: the span of a range as wide as the format would overflow.
        let fraction = (value / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0);
        // A tick at the very end may be a rounding outside.
        fraction.clamp(0.0, 1.0)
    }
}

/// A tick distance of 1, 2 or 5 times a power of ten, held in integers.
#[derive(Clone, Copy)]
struct TickDistance {
    mantissa: i64,
    exponent: i32,
}

impl TickDistance {
    /// The smallest step not below `span`.
    fn for_span(span: f64) -> Self {
        let exponent = span.log10().floor() as i32;
        let mantissa = span / 10f64.powi(exponent);
        // A hair of tolerance: 0.2 / 0.1 must not fall over to the next step.
        let (mantissa, exponent) = match mantissa {
            m if m <= 1.0 + 1e-9 => (1, exponent),
            m if m <= 2.0 + 1e-9 => (2, exponent),
            m if m <= 5.0 + 1e-9 => (5, exponent),
            _ => (1, exponent + 1),
        };
        Self { mantissa, exponent }
    }

    fn size(self) -> f64 {
        self.value(1)
    }

    fn value(self, count: i64) -> f64 {
        let mantissa = (count * self.mantissa) as f64;
        // Dividing by a power of ten rounds once where multiplying by its inverse rounds twice.
        if self.exponent < 0 {
            mantissa / 10f64.powi(-self.exponent)
        } else {
            mantissa * 10f64.powi(self.exponent)
        }
    }

    /// The counts of the multiples inside `from..=to`.
    fn multiples(self, from: f64, to: f64) -> std::ops::RangeInclusive<i64> {
        let hair = 1e-9;
        let first = (from / self.size() - hair).ceil() as i64;
        let last = (to / self.size() + hair).floor() as i64;
        first..=last
    }

    /// `count` steps in decimal, from integers: exact, with the same decimals on every tick.
    fn label(self, count: i64) -> String {
        let value = count * self.mantissa;
        let digits = value.unsigned_abs().to_string();
        let sign = if value < 0 { "\u{2212}" } else { "" };
        if value == 0 {
            "0".into()
        } else if self.exponent >= 0 {
            format!("{sign}{digits}{}", "0".repeat(self.exponent as usize))
        } else {
            let decimals = -self.exponent as usize;
            let padded = format!("{digits:0>width$}", width = decimals + 1);
            let (whole, fraction) = padded.split_at(padded.len() - decimals);
            format!("{sign}{whole}.{fraction}")
        }
    }
}

/// The power of ten, a multiple of three, to count values of this size in. Sizes from 0.1 to 1000
/// stay as they are.
fn engineering_exponent(largest: f64) -> i32 {
    if largest == 0.0 || (0.1..1000.0).contains(&largest) {
        0
    } else {
        // The least normal number bounds it: 10^-308 is the last power of ten to divide by.
        (largest.log10().floor() as i32).div_euclid(3).max(-102) * 3
    }
}

/// `unit` counted in 10^exponent: with the SI prefix where there is one.
fn prefixed(unit: &str, exponent: i32) -> String {
    const PREFIXES: [(i32, &str); 8] = [
        (-12, "p"),
        (-9, "n"),
        (-6, "\u{b5}"),
        (-3, "m"),
        (0, ""),
        (3, "k"),
        (6, "M"),
        (9, "G"),
    ];
    let prefix = PREFIXES.iter().find(|(power, _)| *power == exponent);
    match prefix {
        _ if exponent == 0 => unit.into(),
        Some((_, prefix)) if !unit.is_empty() => format!("{prefix}{unit}"),
        _ => format!("{} {unit}", power_of_ten(exponent))
            .trim_end()
            .into(),
    }
}

/// Returns ten with `exponent` as a power.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    let power: String = exponent.to_string().chars().map(superscript).collect();
    format!("10{power}")
}

fn superscript(digit: char) -> char {
    match digit {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        _ => char::from_u32(0x2070 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    }
}

/// Formats a time, given in s, with few digits.
pub fn seconds(t: f64) -> String {
    if t == 0.0 {
        return "0 s".into();
    }
    let decimals = (3 - t.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{t:.decimals$}");
    // Through the number again, which drops trailing zeros.
    let text = text
        .parse::<f64>()
        .map_or(text, |value| format!("{value:?}"));
    format!("{} s", text.strip_suffix(".0").unwrap_or(&text))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_and_exact() {
        let axis = Axis::new(0.0, 1.0, "s", Margin::Exact, 10.0);
        assert_eq!(
            labels(&axis),
            [
                "0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1.0"
            ]
        );
        assert_eq!(axis.ticks[3].0, 0.3);
        let axis = Axis::new(-0.04, 0.03, "N m", Margin::Padded, 5.0);
        assert_eq!(axis.unit, "mN m");
        assert_eq!(labels(&axis), ["\u{2212}40", "\u{2212}20", "0", "20"]);
    }

    #[test]
    fn every_size_gets_a_handful_of_finite_ticks() {
        for power in [-320, -300, -12, -5, -1, 0, 2, 5, 40, 300] {
            let size = 10f64.powi(power);
            for (low, high) in [(-size, size), (0.0, size), (size, 1.5 * size), (size, size)] {
                let axis = Axis::new(low, high, "m", Margin::Padded, 5.0);
                let count = axis.ticks.len();
                assert!((2..=8).contains(&count), "{low} {high}: {axis:?}");
                for (value, label) in &axis.ticks {
                    assert!((0.0..=1.0).contains(&axis.fraction(*value)), "{axis:?}");
                    assert!(label.len() <= 8, "{label}");
                }
            }
        }
        let axis = Axis::new(f64::MIN, f64::MAX, "m", Margin::Exact, 5.0);
        assert_eq!([axis.fraction(f64::MIN), axis.fraction(0.0)], [0.0, 0.5]);
    }

    #[test]
    fn constants_get_a_range_around_them() {
        for value in [0.0, 0.25, -3.0, 1e6] {
            let axis = Axis::new(value, value, "rad", Margin::Padded, 5.0);
            assert!(axis.low < value && value < axis.high);
            assert!((axis.fraction(value) - 0.5).abs() < 1e-12);
        }
        // 0.1 + 0.2 and 0.3 are one constant.
        let axis = Axis::new(0.3, 0.1 + 0.2, "m", Margin::Padded, 5.0);
        assert!(axis.high - axis.low > 0.1);
    }

    #[test]
    fn units_take_prefixes() {
        assert_eq!(prefixed("N m", -3), "mN m");
        assert_eq!(prefixed("m", 3), "km");
        assert_eq!(prefixed("", -6), "10\u{207b}\u{2076}");
        assert_eq!(prefixed("W", 15), "10\u{b9}\u{2075} W");
        assert_eq!(Axis::time(0.0, 36_000.0).unit, "h");
        assert_eq!(Axis::time(0.0, 0.02).unit, "ms");
        assert_eq!(labels(&Axis::time(0.0, 36_000.0))[1], "1");
    }

    #[test]
    fn times_are_short() {
        assert_eq!(seconds(0.0), "0 s");
        assert_eq!(seconds(0.1 + 0.2), "0.3 s");
        assert_eq!(seconds(1.0), "1 s");
        assert_eq!(seconds(12_345.678), "12346 s");
        assert_eq!(seconds(0.000123456), "0.0001235 s");
    }
}
