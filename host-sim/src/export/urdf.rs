//! URDF, the format of ROS: a tree. The platform hangs on leg 1; the other loops are frames that have to meet.

use super::machine::{ExportedBody, ExportedLeg, ExportedMachine};
use std::fmt::Write;

/// The machine as a tree, with the frames `legI_end` and `legI_joint` of the loops that are open, and the joints that close them in Gazebo.
pub(super) fn text(machine: &ExportedMachine) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <link name=\"base\"/>\n",
        machine.name
    );
    let [first, ..] = &machine.legs;
    // From the platform joint of leg 1, the origin of the link.
    let from_first = |[x, y]: [f64; 2]| [x - first.joint_m[0], y - first.joint_m[1]];
    // Writing to a String does not fail.
    for (number, leg) in (1..).zip(&machine.legs) {
        let name = |part: &str| format!("leg{number}_{part}");
        let proximal = leg.proximal.with_rotor(leg.rotor_kgm2);
        let _ = write!(
            text,
            "{}{}{}{}",
            link(&name("proximal"), &proximal, leg.proximal_m),
            joint(
                &name("motor"),
                ["base", &name("proximal")],
                leg.base_m,
                &limits(leg)
            ),
            link(&name("distal"), &leg.distal, leg.distal_m),
            joint(
                &name("elbow"),
                [&name("proximal"), &name("distal")],
                [leg.proximal_m, 0.0],
                ""
            )
        );
        if number > 1 {
            text += &frame(&name("end"), &name("distal"), [leg.distal_m, 0.0]);
        }
    }
    let platform = ExportedBody {
        com_m: from_first(machine.platform.com_m),
        ..machine.platform
    };
    text += &link("platform", &platform, 0.0);
    text += &joint(
        "leg1_joint",
        ["leg1_distal", "platform"],
        [first.distal_m, 0.0],
        "",
    );
    text += &frame("tool", "platform", from_first([0.0; 2]));
    for (number, leg) in (1..).zip(&machine.legs).skip(1) {
        text += &frame(
            &format!("leg{number}_joint"),
            "platform",
            from_first(leg.joint_m),
        );
    }
    text += "  <gazebo>\n";
    for (number, leg) in (1..).zip(&machine.legs).skip(1) {
        let _ = writeln!(
            text,
            "    <joint name=\"leg{number}_loop\" type=\"revolute\"><pose relative_to=\"leg{number}_distal\">{} 0 0 0 0 0</pose>\
             <parent>leg{number}_distal</parent><child>platform</child><axis><xyz>0 0 1</xyz></axis></joint>",
            leg.distal_m
        );
    }
    text += "  </gazebo>\n</robot>\n";
    text
}

/// Limit that stands for none: the format wants both or neither.
const NONE: f64 = 1e9;

fn limits(leg: &ExportedLeg) -> String {
    match (leg.torque_nm, leg.rate_rad_s) {
        (None, None) => String::new(),
        (torque, rate) => format!(
            "<limit effort=\"{}\" velocity=\"{}\"/>",
            torque.unwrap_or(NONE),
            rate.unwrap_or(NONE)
        ),
    }
}

fn link(name: &str, body: &ExportedBody, length_m: f64) -> String {
    let ExportedBody {
        mass_kg,
        com_m: [x, y],
        inertia_kgm2: inertia,
    } = body;
    let shape = match length_m > 0.0 {
        true => format!(
            "<visual><origin xyz=\"{} 0 0\" rpy=\"0 {} 0\"/><geometry><cylinder radius=\"{}\" length=\"{length_m}\"/></geometry></visual>",
            0.5 * length_m,
            std::f64::consts::FRAC_PI_2,
            ExportedLeg::radius_m(length_m)
        ),
        false => "<visual><geometry><sphere radius=\"0.01\"/></geometry></visual>".into(),
    };
    format!(
        "  <link name=\"{name}\">\n    <inertial><origin xyz=\"{x} {y} 0\"/><mass value=\"{mass_kg}\"/>\
         <inertia ixx=\"{inertia}\" ixy=\"0\" ixz=\"0\" iyy=\"{inertia}\" iyz=\"0\" izz=\"{inertia}\"/></inertial>\n    {shape}\n  </link>\n"
    )
}

/// A joint about z without a stop.
fn joint(name: &str, [parent, child]: [&str; 2], [x, y]: [f64; 2], limits: &str) -> String {
    format!(
        "  <joint name=\"{name}\" type=\"continuous\">\n    <parent link=\"{parent}\"/><child link=\"{child}\"/>\n    \
         <origin xyz=\"{x} {y} 0\"/><axis xyz=\"0 0 1\"/>{limits}\n  </joint>\n"
    )
}

/// A frame that is fixed on a link.
fn frame(name: &str, parent: &str, [x, y]: [f64; 2]) -> String {
    format!(
        "  <link name=\"{name}\"/>\n  <joint name=\"{name}_fixed\" type=\"fixed\">\n    <parent link=\"{parent}\"/><child link=\"{name}\"/>\n    \
         <origin xyz=\"{x} {y} 0\"/>\n  </joint>\n"
    )
}
