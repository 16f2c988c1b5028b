//! MJCF, the format of MuJoCo.

use super::machine::{ExportedBody, ExportedLeg, ExportedMachine};
use std::fmt::Write;

/// Step of the simulation, s, and time constant of the loops, which MuJoCo closes by soft constraints: four steps.
const STEP_S: f64 = 0.0005;
const LOOP_S: f64 = 0.002;

/// The machine with its loops closed, motors of torque, and a keyframe where it stands.
pub(super) fn text(machine: &ExportedMachine) -> String {
    let [gx, gy] = machine.gravity_m_s2;
    let mut text = format!(
        "<mujoco model=\"{}\">\n  <compiler angle=\"radian\" autolimits=\"true\"/>\n  \
         <option timestep=\"{STEP_S}\" gravity=\"{gx} {gy} 0\" integrator=\"implicitfast\"/>\n  \
         <default>\n    <geom type=\"capsule\" mass=\"0\" contype=\"0\" conaffinity=\"0\" rgba=\"0.5 0.55 0.6 1\"/>\n    \
         <joint axis=\"0 0 1\"/>\n  </default>\n  <worldbody>\n    <light pos=\"0 0 2\"/>\n",
        machine.name
    );
    // Writing to a String does not fail.
    for (number, leg) in (1..).zip(&machine.legs) {
        let _ = text.write_str(&leg_text(number, leg));
    }
    let _ = write!(
        text,
        "    <body name=\"platform\">\n{}",
        inertial(&machine.platform, 6)
    );
    for (name, kind, axis) in [
        ("x", "slide", "1 0 0"),
        ("y", "slide", "0 1 0"),
        ("alpha", "hinge", "0 0 1"),
    ] {
        let _ = writeln!(
            text,
            "      <joint name=\"platform_{name}\" type=\"{kind}\" axis=\"{axis}\"/>"
        );
    }
    for (number, leg) in (1..).zip(&machine.legs) {
        let [x, y] = leg.joint_m;
        let radius = ExportedLeg::radius_m(leg.distal_m);
        if x.hypot(y) > radius {
            let _ = writeln!(
                text,
                "      <geom fromto=\"0 0 0 {x} {y} 0\" size=\"{radius}\" rgba=\"0.8 0.5 0.2 1\"/>"
            );
        }
        let _ = writeln!(
            text,
            "      <site name=\"leg{number}_joint\" pos=\"{x} {y} 0\"/>"
        );
    }
    text += "      <site name=\"tool\"/>\n    </body>\n  </worldbody>\n  <equality>\n";
    for number in 1..=3 {
        let _ = writeln!(
            text,
            "    <connect name=\"leg{number}_loop\" site1=\"leg{number}_end\" site2=\"leg{number}_joint\" solref=\"{LOOP_S} 1\"/>"
        );
    }
    text += "  </equality>\n  <actuator>\n";
    for (number, leg) in (1..).zip(&machine.legs) {
        let range = leg.torque_nm.map_or(String::new(), |limit| {
            format!(" ctrlrange=\"-{limit} {limit}\"")
        });
        let _ = writeln!(
            text,
            "    <motor name=\"leg{number}_torque\" joint=\"leg{number}_motor\"{range}/>"
        );
    }
    let legs = machine.legs.iter();
    let angles = legs.flat_map(|leg| [leg.angles_rad[0], leg.angles_rad[1] - leg.angles_rad[0]]);
    let start: Vec<String> = angles
        .chain(machine.pose)
        .map(|value| value.to_string())
        .collect();
    let _ = write!(
        text,
        "  </actuator>\n  <keyframe>\n    <key name=\"start\" qpos=\"{}\"/>\n  </keyframe>\n</mujoco>\n",
        start.join(" ")
    );
    text
}

fn leg_text(number: u32, leg: &ExportedLeg) -> String {
    let [x, y] = leg.base_m;
    let ExportedLeg {
        proximal_m,
        distal_m,
        rotor_kgm2,
        ..
    } = leg;
    let [thick, thin] = [*proximal_m, *distal_m].map(ExportedLeg::radius_m);
    format!(
        "    <body name=\"leg{number}_proximal\" pos=\"{x} {y} 0\">\n{}      \
         <joint name=\"leg{number}_motor\" armature=\"{rotor_kgm2}\"/>\n      \
         <geom fromto=\"0 0 0 {proximal_m} 0 0\" size=\"{thick}\"/>\n      \
         <body name=\"leg{number}_distal\" pos=\"{proximal_m} 0 0\">\n{}        \
         <joint name=\"leg{number}_elbow\"/>\n        \
         <geom fromto=\"0 0 0 {distal_m} 0 0\" size=\"{thin}\"/>\n        \
         <site name=\"leg{number}_end\" pos=\"{distal_m} 0 0\"/>\n      </body>\n    </body>\n",
        inertial(&leg.proximal, 6),
        inertial(&leg.distal, 8)
    )
}

/// In the plane only the moment about z counts: the body is as a sphere.
fn inertial(body: &ExportedBody, indent: usize) -> String {
    let ExportedBody {
        mass_kg,
        com_m: [x, y],
        inertia_kgm2: inertia,
    } = body;
    format!(
        "{:indent$}<inertial pos=\"{x} {y} 0\" mass=\"{mass_kg}\" diaginertia=\"{inertia} {inertia} {inertia}\"/>\n",
        ""
    )
}
