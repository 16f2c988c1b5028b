//! The key that was probably meant by one that does not exist.

/// Units that end a key, longest first, so that `_rad_s2` is not taken for `_s2`.
const UNITS: &[(&str, &str)] = &[
    ("nm_rad_s", "N m/(rad s)"),
    ("rad_s3", "rad/s^3"),
    ("rad_s2", "rad/s^2"),
    ("m_s2", "m/s^2"),
    ("rad_s", "rad/s"),
    ("nm_s_rad", "N m s/rad"),
    ("nm_rad", "N m/rad"),
    ("v_s_rad", "V s/rad"),
    ("nm_a", "N m/A"),
    ("m_s", "m/s"),
    ("kgm2", "kg m^2"),
    ("rad", "rad"),
    ("deg", "degrees"),
    ("rpm", "1/min"),
    ("mm", "mm"),
    ("ohm", "ohm"),
    ("nm", "N m"),
    ("kg", "kg"),
    ("hz", "Hz"),
    ("h", "H"),
    ("m", "m"),
    ("n", "N"),
    ("s", "s"),
    ("v", "V"),
    ("a", "A"),
    ("w", "W"),
];

/// Units that scenes do not use, but that people write.
const FOREIGN_UNITS: &[&str] = &[
    "deg_s2", "rpm_s", "mm_s2", "deg_s", "kgcm2", "gcm2", "mm_s", "degrees", "radians", "ncm",
    "khz", "mhz", "inch", "min", "cm", "um", "us", "ms", "km", "in", "mv", "ma", "mh", "uh", "kn",
    "kw", "mw", "g", "t",
];

/// The unit that the last part of a key names, written for a reader; `None` for a key without.
pub(super) fn unit_of(key: &str) -> Option<&'static str> {
    UNITS
        .iter()
        .find(|(suffix, _)| split_suffix(key, suffix).is_some())
        .map(|(_, unit)| *unit)
}

/// `key` without its `_suffix`.
pub(super) fn split_suffix<'a>(key: &'a str, suffix: &str) -> Option<&'a str> {
    key.strip_suffix(suffix)?.strip_suffix('_')
}

/// `key` without its unit, known or foreign.
fn stem(key: &str) -> &str {
    let own = UNITS.iter().map(|(suffix, _)| *suffix);
    FOREIGN_UNITS
        .iter()
        .copied()
        .chain(own)
        .find_map(|suffix| split_suffix(key, suffix))
        .unwrap_or(key)
}

/// The one of `known` that `key` was probably meant to be: the same name with another unit, or a
/// name within a few letters, or a part of a longer name (`radius_mm` for `joint_radius_m`).
pub(super) fn suggest<'k>(key: &str, known: &[&'k str]) -> Option<&'k str> {
    let lower = key.to_lowercase();
    let wanted = stem(&lower);
    if let Some(same) = known.iter().find(|k| stem(k) == wanted) {
        return Some(same);
    }
    let near = known
        .iter()
        .map(|k| (edit_distance(wanted, stem(k)), *k))
        .min()
        .filter(|(distance, _)| *distance <= wanted.chars().count().div_ceil(4));
    if let Some((_, near)) = near {
        return Some(near);
    }
    known
        .iter()
        .find(|k| wanted.len() >= 3 && stem(k).split('_').any(|part| part == wanted))
        .copied()
}

/// The question after the reason for which a value is refused that is none of `known`; empty where it resembles none.
pub(crate) fn did_you_mean(value: &str, known: &[&str]) -> String {
    match suggest(value, known) {
        Some(meant) => format!("; did you mean \"{meant}\"?"),
        None => String::new(),
    }
}

/// Levenshtein's distance, in characters.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEG: &[&str] = &[
        "base_m",
        "proximal_m",
        "distal_m",
        "joint_radius_m",
        "joint_angle_rad",
        "elbow",
    ];

    #[test]
    fn the_same_name_with_another_unit_is_recognised() {
        for (wrong, right) in [
            ("distal_mm", "distal_m"),
            ("distal", "distal_m"),
            ("joint_angle_deg", "joint_angle_rad"),
            ("joint_radius_cm", "joint_radius_m"),
            ("Base_m", "base_m"),
        ] {
            assert_eq!(suggest(wrong, LEG), Some(right), "{wrong}");
        }
    }

    #[test]
    fn slips_and_partial_names_are_recognised() {
        for (wrong, right) in [
            ("dstal_m", "distal_m"),
            ("elbo", "elbow"),
            ("proximall_mm", "proximal_m"),
            ("radius_mm", "joint_radius_m"),
            ("angle_deg", "joint_angle_rad"),
        ] {
            assert_eq!(suggest(wrong, LEG), Some(right), "{wrong}");
        }
    }

    #[test]
    fn a_name_that_resembles_nothing_gets_no_suggestion() {
        assert_eq!(suggest("colour", LEG), None);
        assert_eq!(suggest("", LEG), None);
        assert_eq!(suggest("x", &[]), None);
    }

    #[test]
    fn units_are_read_from_the_key() {
        assert_eq!(unit_of("rate_rad_s"), Some("rad/s"));
        assert_eq!(unit_of("duration_s"), Some("s"));
        assert_eq!(unit_of("acceleration_rad_s2"), Some("rad/s^2"));
        assert_eq!(unit_of("valpha_rad_s"), Some("rad/s"));
        assert_eq!(unit_of("gravity_m_s2"), Some("m/s^2"));
        assert_eq!(unit_of("elbow"), None);
        assert_eq!(unit_of("microsteps"), None);
    }

    #[test]
    fn edit_distances() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("abc", "abc"), 0);
    }
}
