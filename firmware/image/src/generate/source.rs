//! The text that an image includes.

use super::FIXED;
use super::kinds::{links_path, payload_path};
use crate::Move;
use std::fmt::Write;
use trirrr_core::machine::{Elbow, LegParameters, LinkParameters, Parameters};
use trirrr_core::machine::{LinksKind, PayloadKind};
use trirrr_core::setpoint::Pose;
use trirrr_core::units::Units;
use trirrr_scene::{RangeError, Scene, units_of_scene};

/// The whole file, for the Rust type `scalar`, in the units that it needs. Every number is written
/// so that it is read back as the same bits.
///
/// # Errors
/// A quantity that does not fit the number type.
pub fn source(scene: &Scene, scalar: &str) -> Result<String, RangeError> {
    let units = units(scene, scalar)?;
    let parameters = &units.parameters(&scene.parameters);
    let moves = &scene.job.in_units(&units).moves;
    let mut text = String::new();
    let mut line = |arguments: std::fmt::Arguments<'_>| {
        text.write_fmt(arguments)
            .expect("writing to a String cannot fail");
        text.push('\n');
    };
    line(format_args!("pub type Scalar = {scalar};"));
    line(format_args!(
        "pub type Payload = {};",
        payload_path(PayloadKind::of(parameters), scalar)
    ));
    line(format_args!(
        "pub type Links = {};",
        links_path(LinksKind::of(parameters), scalar)
    ));
    line(format_args!("pub const NAME: &str = {:?};", scene.name));
    line(format_args!(
        "pub const TICK_RATE_HZ: f64 = {:?};",
        scene.tick_rate_hz
    ));
    line(format_args!(
        "#[allow(dead_code)]\npub const KEY: u32 = {};",
        scene.key
    ));
    line(format_args!(
        "#[allow(dead_code)]\npub const PERIOD_S: f64 = {:?};",
        scene.period_s()
    ));
    line(format_args!("#[allow(dead_code)]"));
    line(format_args!(
        "pub const UNITS: trirrr_core::units::Units = trirrr_core::units::{units:?};"
    ));
    line(format_args!(
        "#[allow(dead_code)]\npub const UNITS_SI: [f64; 3] = [{:?}, {:?}, {:?}];",
        units.length_m(),
        units.time_s(),
        units.of(0, 0, 1)
    ));
    // What follows is in these units.
    line(format_args!(
        "pub const PERIOD: f64 = {:?};",
        units.time(scene.period_s())
    ));
    line(format_args!(
        "pub const PARAMETERS: trirrr_core::machine::Parameters = {};",
        machine(parameters)
    ));
    // Those who play a scene without judging its moves need none of this.
    line(format_args!("#[allow(dead_code)]"));
    line(format_args!(
        "pub const LIMITS: trirrr_core::limits::LimitParameters = trirrr_core::limits::{:?};",
        units.limits(&scene.limits)
    ));
    line(format_args!("#[allow(dead_code)]"));
    line(format_args!(
        "pub const RAMP_TICKS: u16 = {};",
        scene.ramp_ticks()
    ));
    let silence = scene.service.silence_timeout_s * scene.tick_rate_hz;
    line(format_args!("#[allow(dead_code)]"));
    line(format_args!(
        "pub const SILENCE_TICKS: u32 = {};",
        silence.round().clamp(1.0, f64::from(u32::MAX)) as u32
    ));
    line(format_args!("#[allow(dead_code)]"));
    line(format_args!(
        "pub const TELEMETRY_TICKS: u16 = {};",
        scene.service.telemetry_ticks
    ));
    let start = units.pose(&scene.job.start);
    line(format_args!("#[allow(dead_code)]"));
    line(format_args!(
        "pub const START: [f64; 3] = [{:?}, {:?}, {:?}];",
        start.position.x, start.position.y, start.angle
    ));
    line(format_args!("#[allow(dead_code)]"));
    line(format_args!(
        "pub static MOVES: [trirrr_image::Move; {}] = [",
        moves.len()
    ));
    for each in moves {
        // `Debug` of an enum with named fields of numbers and arrays is its source.
        line(format_args!(
            "    trirrr_image::Move::{:?},",
            constant(each)
        ));
    }
    line(format_args!("];"));
    Ok(text)
}

/// The units of an image for the Rust type `scalar`.
///
/// # Errors
/// A quantity that does not fit the number type.
pub fn units(scene: &Scene, scalar: &str) -> Result<Units, RangeError> {
    match scalar == FIXED {
        true => units_of_scene(scene),
        false => Ok(Units::SI),
    }
}

fn constant(each: &trirrr_scene::Move) -> Move {
    let pose = |pose: &Pose<f64>| [pose.position.x, pose.position.y, pose.angle];
    let (from, to, ticks) = (pose(&each.from), pose(&each.to), each.duration_ticks);
    if each.is_rest_to_rest() {
        return Move::RestToRest { from, to, ticks };
    }
    Move::Hermite {
        from,
        from_velocity: each.start_velocity.into(),
        to,
        to_velocity: each.end_velocity.into(),
        ticks,
    }
}

fn machine(p: &Parameters) -> String {
    let m = "trirrr_core::machine";
    let [a, b, c] = p.legs.each_ref().map(leg);
    format!(
        "{m}::Parameters {{\n    legs: [\n{a},\n{b},\n{c},\n    ],\n    \
         platform: {m}::PlatformParameters {{ mass_kg: {:?}, inertia_kgm2: {:?}, com_m: {} }},\n    \
         gravity_m_s2: {},\n    wrench_force_n: {},\n    wrench_torque_nm: {:?},\n}}",
        p.platform.mass_kg,
        p.platform.inertia_kgm2,
        vector(p.platform.com_m.x, p.platform.com_m.y),
        vector(p.gravity_m_s2.x, p.gravity_m_s2.y),
        vector(p.wrench_force_n.x, p.wrench_force_n.y),
        p.wrench_torque_nm,
    )
}

fn leg(leg: &LegParameters) -> String {
    let m = "trirrr_core::machine";
    let elbow = match leg.elbow {
        Elbow::Positive => "Positive",
        Elbow::Negative => "Negative",
    };
    format!(
        "        {m}::LegParameters {{ base_m: {}, proximal_m: {:?}, distal_m: {:?}, \
         joint_radius_m: {:?}, joint_angle_rad: {:?}, elbow: {m}::Elbow::{elbow}, \
         proximal: {}, distal: {}, rotor_inertia_kgm2: {:?} }}",
        vector(leg.base_m.x, leg.base_m.y),
        leg.proximal_m,
        leg.distal_m,
        leg.joint_radius_m,
        leg.joint_angle_rad,
        link(&leg.proximal),
        link(&leg.distal),
        leg.rotor_inertia_kgm2,
    )
}

fn link(link: &LinkParameters) -> String {
    format!("trirrr_core::machine::{link:?}")
}

fn vector(x: f64, y: f64) -> String {
    format!("nalgebra::Vector2::new({x:?}, {y:?})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn shipped(name: &str) -> String {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let scene = Scene::read(scenes.join(name)).expect("a shipped scene is good");
        source(&scene, "f32").expect("SI units")
    }

    #[test]
    fn a_scene_gets_the_types_it_needs_and_no_others() {
        for (name, kind) in [
            ("thesis.toml", "Massless"),
            (
                "thesis-links.toml",
                "Massive<f32, trirrr_core::torque::links::Horizontal>",
            ),
            (
                "vertical.toml",
                "Massive<f32, trirrr_core::torque::links::InPlane<f32>>",
            ),
        ] {
            let text = shipped(name);
            let line = format!("pub type Links = trirrr_core::torque::links::{kind};\n");
            assert!(text.contains(&line), "{name}: {text}");
        }
    }

    #[test]
    fn moves_are_written_with_every_digit_and_their_kind() {
        let text = shipped("thesis.toml");
        // pi/20 and pi/15, as they are read back.
        let (from, to) = (core::f64::consts::PI / 20.0, core::f64::consts::PI / 15.0);
        let line = format!(
            "    trirrr_image::Move::RestToRest {{ from: [0.21, 0.22, {from:?}], \
             to: [0.28, 0.28, {to:?}], ticks: 100 }},\n"
        );
        assert!(text.contains(&line), "{line}{text}");
        assert!(shipped("engraving.toml").contains("trirrr_image::Move::Hermite {"));
    }
}
