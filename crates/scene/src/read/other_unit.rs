//! Names of a key in units that people think in: degrees, millimetres, revolutions per minute.

use super::suggest::split_suffix;
use std::f64::consts::PI;

/// Converts a value from a unit to another one of the same quantity.
pub type Conversion = fn(f64) -> f64;

/// Two units of a quantity by the ends of keys, the one of SI first, and the conversions from the other one and to it.
struct UnitPair {
    suffixes: [&'static str; 2],
    to_si: Conversion,
    from_si: Conversion,
}

const PAIRS: [UnitPair; 3] = [
    UnitPair {
        suffixes: ["rad", "deg"],
        to_si: f64::to_radians,
        from_si: f64::to_degrees,
    },
    // Divided: the nearest number to the decimal that was written.
    UnitPair {
        suffixes: ["m", "mm"],
        to_si: |length| length / 1e3,
        from_si: |length| length * 1e3,
    },
    UnitPair {
        suffixes: ["rad_s", "rpm"],
        to_si: |rate| rate / 30.0 * PI,
        from_si: |rate| rate / PI * 30.0,
    },
];

/// Ends of keys whose unit only ends as one of a pair does.
const COMPOUND: [&str; 5] = ["nm_rad", "nm_s_rad", "v_s_rad", "nm_rad_s", "rad_m"];

/// Returns the name of `key` in the other unit that scenes know for its quantity, and the conversion of a value under that name to
/// the unit of `key`. None of a key whose unit has no other.
///
/// ```
/// let (name, to_own) = trirrr_scene::read::in_other_unit("distal_m").unwrap();
/// assert_eq!((name.as_str(), to_own(150.0)), ("distal_mm", 0.15));
/// ```
pub fn in_other_unit(key: &str) -> Option<(String, Conversion)> {
    if COMPOUND
        .iter()
        .any(|unit| split_suffix(key, unit).is_some())
    {
        return None;
    }
    PAIRS.iter().find_map(|pair| {
        let [si, other] = pair.suffixes;
        let named = |from: &str, to: &str| {
            let stem = split_suffix(key, from)?;
            Some(format!("{stem}_{to}"))
        };
        named(si, other)
            .map(|name| (name, pair.to_si))
            .or_else(|| named(other, si).map(|name| (name, pair.from_si)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_unit_has_its_other() {
        for (key, name, given, value) in [
            ("joint_angle_rad", "joint_angle_deg", 180.0, PI),
            ("base_m", "base_mm", 433.0, 0.433),
            ("rate_rad_s", "rate_rpm", 30.0, PI),
            ("joint_angle_deg", "joint_angle_rad", PI, 180.0),
            ("x_mm", "x_m", 0.25, 250.0),
        ] {
            let (found, to_own) = in_other_unit(key).expect(key);
            assert_eq!((found.as_str(), to_own(given)), (name, value), "{key}");
        }
    }

    #[test]
    fn compound_units_and_others_have_none() {
        for key in [
            "kp_nm_rad",
            "kd_nm_s_rad",
            "ki_nm_rad_s",
            "torque_constant_v_s_rad",
            "vx_m_s",
            "torque_nm",
            "rad",
            "elbow",
            "duration_s",
        ] {
            assert!(in_other_unit(key).is_none(), "{key}");
        }
    }
}
