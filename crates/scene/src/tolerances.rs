//! Tolerances of the machine: by how much its quantities may differ from what the scene gives.

use crate::read::{Bound, Section};
use std::f64::consts::PI;
use trirrr_core::machine::{LegParameters, Parameters};

/// Half-widths of what is not exact: the real value lies between nominal minus and nominal plus half-width. All are
/// finite and not negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Length of the proximal link of each leg, m; less than the length.
    pub proximal_m: [f64; 3],
    /// Length of the distal link of each leg, m; less than the length.
    pub distal_m: [f64; 3],
    /// x and y of the base joint of each leg, m.
    pub base_m: [f64; 3],
    /// x and y of the platform joint of each leg in the platform's frame, m.
    pub joint_m: [f64; 3],
    /// Joint angle of each motor, rad, without the [resolution](crate::Scene::motor_resolution_rad) of its drive.
    pub motor_angle_rad: [f64; 3],
    /// Rotor inertia of each motor, relative to the nominal one; less than 1.
    pub rotor_inertia_fraction: [f64; 3],
    /// Platform with its payload.
    pub platform: BodyTolerances,
    /// Each of the six links.
    pub links: BodyTolerances,
    /// x and y of the external force, N.
    pub force_n: f64,
    /// External moment, N m.
    pub torque_nm: f64,
}

/// Half-widths of a rigid body's masses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyTolerances {
    /// Mass, relative to the nominal one; less than 1.
    pub mass_fraction: f64,
    /// Moment of inertia about the centre of mass, relative to the nominal one; less than 1.
    pub inertia_fraction: f64,
    /// Coordinates of the centre of mass, m; of a link, along it.
    pub com_m: f64,
}

/// Reads `[tolerances]`: `Some(None)` where it is left out. Without `parameters`, which were refused, half-widths are
/// not compared with them.
pub(crate) fn read_tolerances(
    root: &Section,
    parameters: Option<&Parameters>,
) -> Option<Option<Tolerances>> {
    if !root.has("tolerances") {
        return Some(None);
    }
    let section = root.section("tolerances")?;
    let wrench = match section.has("wrench") {
        true => section.section("wrench").and_then(|wrench| {
            let force = wrench.number_or("force_n", Bound::NotNegative, 0.0);
            let torque = wrench.number_or("torque_nm", Bound::NotNegative, 0.0);
            Some((force?, torque?))
        }),
        false => Some((0.0, 0.0)),
    };
    let proximal_m = legs(&section, "proximal_m", Bound::NotNegative);
    let distal_m = legs(&section, "distal_m", Bound::NotNegative);
    let base_m = legs(&section, "base_m", Bound::NotNegative);
    let joint_m = legs(&section, "joint_m", Bound::NotNegative);
    let motor_angle_rad = legs(&section, "motor_angle_rad", Bound::Within(0.0, PI));
    let rotor_inertia_fraction = legs(&section, "rotor_inertia_fraction", Bound::Fraction);
    let (platform, links) = (body(&section, "platform"), body(&section, "links"));
    let (force_n, torque_nm) = wrench?;
    let tolerances = Tolerances {
        proximal_m: proximal_m?,
        distal_m: distal_m?,
        base_m: base_m?,
        joint_m: joint_m?,
        motor_angle_rad: motor_angle_rad?,
        rotor_inertia_fraction: rotor_inertia_fraction?,
        platform: platform?,
        links: links?,
        force_n,
        torque_nm,
    };
    match parameters {
        Some(parameters) => check(&section, &tolerances, parameters).then_some(Some(tolerances)),
        None => Some(Some(tolerances)),
    }
}

/// One half-width for the three legs, or three; 0 where it is left out.
fn legs<'d>(section: &Section<'d, '_>, key: &'d str, bound: Bound) -> Option<[f64; 3]> {
    match section.has(key) {
        true => section.number_or_three(key, bound),
        false => Some([0.0; 3]),
    }
}

fn body<'d>(section: &Section<'d, '_>, key: &'d str) -> Option<BodyTolerances> {
    if !section.has(key) {
        return Some(BodyTolerances::default());
    }
    let body = section.section(key)?;
    let mass = body.number_or("mass_fraction", Bound::Fraction, 0.0);
    let inertia = body.number_or("inertia_fraction", Bound::Fraction, 0.0);
    let com = body.number_or("com_m", Bound::NotNegative, 0.0);
    Some(BodyTolerances {
        mass_fraction: mass?,
        inertia_fraction: inertia?,
        com_m: com?,
    })
}

/// Refuses half-widths with which the machine would not be one: a link that may have no length, a joint or a centre
/// of mass that may lie beyond the legs' reach. Returns `true` if there is none.
fn check(section: &Section, tolerances: &Tolerances, parameters: &Parameters) -> bool {
    let lengths = |of: fn(&LegParameters) -> f64| parameters.legs.each_ref().map(of);
    let reach = lengths(|leg| leg.proximal_m + leg.distal_m);
    let t = tolerances;
    let of_legs = [
        (
            "proximal_m",
            t.proximal_m,
            "the length of the proximal link",
            lengths(|leg| leg.proximal_m),
        ),
        (
            "distal_m",
            t.distal_m,
            "the length of the distal link",
            lengths(|leg| leg.distal_m),
        ),
        ("base_m", t.base_m, "the reach", reach),
        ("joint_m", t.joint_m, "the reach", reach),
    ];
    let mut good = true;
    for (key, half_widths, what, bounds) in of_legs {
        let Some(leg) = (0..3).find(|leg| half_widths[*leg] >= bounds[*leg]) else {
            continue;
        };
        let reason = format!(
            "must be less than {what} of leg {}, {:?} (m): give the half-width of the tolerance, as 0.0001 for plus \
             or minus 0.1 mm",
            leg + 1,
            bounds[leg]
        );
        section.refuse(key, reason);
        good = false;
    }
    let longest = reach.into_iter().fold(0.0, f64::max);
    for (key, body) in [
        ("platform", tolerances.platform),
        ("links", tolerances.links),
    ] {
        if body.com_m >= longest {
            let reason = format!(
                "com_m = {:?} must be less than the reach of the longest leg, {longest:?} (m)",
                body.com_m
            );
            section.refuse(key, reason);
            good = false;
        }
    }
    good
}
