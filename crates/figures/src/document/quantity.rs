//! Numbers with units in words. The end of a key names the unit.

/// Ends of keys, and their units. The first that fits counts.
const UNITS: [(&str, &str); 25] = [
    ("_nm_s_rad", "N m s/rad"),
    ("_nm_rad", "N m/rad"),
    ("_rad_s2", "rad/s^2"),
    ("_rad_s", "rad/s"),
    ("_rad_m", "rad/m"),
    ("_m_s2", "m/s^2"),
    ("_m_s", "m/s"),
    ("_m_n", "m/N"),
    ("_kg_m2", "kg m^2"),
    ("_nm", "N m"),
    ("_kg", "kg"),
    ("_hz", "Hz"),
    ("_us", "us"),
    ("_ms", "ms"),
    ("_rad", "rad"),
    ("_deg", "deg"),
    ("_percent", "%"),
    ("_m2", "m^2"),
    ("_m", "m"),
    ("_n", "N"),
    ("_w", "W"),
    ("_j", "J"),
    ("_v", "V"),
    ("_a", "A"),
    ("_s", "s"),
];

/// Words of a key, and the unit of its values if the end names one.
pub(super) fn parts_of(key: &str) -> (&str, Option<&'static str>) {
    let found = UNITS.iter().find_map(|(end, unit)| {
        let words = key.strip_suffix(end)?;
        // The determinant of A is no current.
        (key != "det_a").then_some((words, Some(*unit)))
    });
    found.unwrap_or((key, None))
}

/// Unit of the values at `key`, if its end names one.
pub(super) fn unit_of(key: &str) -> Option<&'static str> {
    parts_of(key).1
}

/// Factor and name of the unit in which people read a value of this size.
pub(super) fn readable(unit: &'static str, size: f64) -> (f64, &'static str) {
    match unit {
        "m" if (1e-12..1e-3).contains(&size) => (1e6, "um"),
        "m" if (1e-3..0.1).contains(&size) => (1e3, "mm"),
        "s" if (1e-12..1e-3).contains(&size) => (1e6, "us"),
        "s" if (1e-3..0.1).contains(&size) => (1e3, "ms"),
        "rad" if (1e-12..0.1).contains(&size) => (1e3, "mrad"),
        "m^2" => (1e4, "cm^2"),
        _ => (1.0, unit),
    }
}

/// Four digits of a number; an exponent only where zeros would hide the size.
pub fn digits(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".into()
    } else if (1e-4..1e6).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}

/// A number in a unit. Seconds keep their microseconds: ticks are told apart by them.
pub(super) fn number(value: f64, unit: &str) -> String {
    if unit == "s" && (0.1..1e9).contains(&value.abs()) {
        let text = format!("{value:.6}");
        return text.trim_end_matches('0').trim_end_matches('.').into();
    }
    match value.fract() == 0.0 && value.abs() < 1e6 {
        // Zero has no sign.
        true => format!("{}", value + 0.0),
        false => digits(value),
    }
}

/// Numbers with one unit behind them.
pub(super) fn quantities(values: &[f64], unit: Option<&'static str>) -> String {
    let size = values.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let (factor, unit) = readable(unit.unwrap_or_default(), size);
    let texts: Vec<String> = values.iter().map(|v| number(factor * v, unit)).collect();
    let text = texts.join(", ");
    match unit {
        "" => text,
        "%" => format!("{text} %"),
        unit => format!("{text} {unit}"),
    }
}

/// A number in the unit in which people read a value of this size: `0.0005` in `m` is `500 um`.
pub fn quantity(value: f64, unit: &'static str) -> String {
    quantities(&[value], Some(unit))
}
