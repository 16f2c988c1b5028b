//! SDF, the format of Gazebo; Drake reads it, too.

use super::machine::{ExportedBody, ExportedLeg, ExportedMachine};
use std::fmt::Write;

/// A world with gravity, and the machine in it with its loops closed.
pub(super) fn text(machine: &ExportedMachine) -> String {
    let [gx, gy] = machine.gravity_m_s2;
    let name = &machine.name;
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\">\n  <world name=\"{name}\">\n    <gravity>{gx} {gy} 0</gravity>\n    \
         <model name=\"{name}\">\n"
    );
    // Writing to a String does not fail.
    for (number, leg) in (1..).zip(&machine.legs) {
        let [first, second] = leg.angles_rad;
        let [x, y] = leg.base_m;
        let (sin, cos) = first.sin_cos();
        let elbow = [x + leg.proximal_m * cos, y + leg.proximal_m * sin];
        // The rotor turns with the link.
        let proximal = leg.proximal.with_rotor(leg.rotor_kgm2);
        let _ = write!(
            text,
            "{}{}",
            link(
                &format!("leg{number}_proximal"),
                [x, y, first],
                &proximal,
                leg.proximal_m
            ),
            link(
                &format!("leg{number}_distal"),
                [elbow[0], elbow[1], second],
                &leg.distal,
                leg.distal_m
            )
        );
    }
    text += &link("platform", machine.pose, &machine.platform, 0.0);
    for (number, leg) in (1..).zip(&machine.legs) {
        let limits = [("effort", leg.torque_nm), ("velocity", leg.rate_rad_s)];
        let limits = limits.map(|(key, limit)| {
            limit.map_or(String::new(), |limit| format!("<{key}>{limit}</{key}>"))
        });
        let limits = match limits.concat() {
            none if none.is_empty() => none,
            some => format!("<limit>{some}</limit>"),
        };
        let name = |part: &str| format!("leg{number}_{part}");
        let end = format!(
            "        <pose relative_to=\"{}\">{} 0 0 0 0 0</pose>\n",
            name("distal"),
            leg.distal_m
        );
        text += &joint(&name("motor"), ["world", &name("proximal")], "", &limits);
        text += &joint(&name("elbow"), [&name("proximal"), &name("distal")], "", "");
        text += &joint(&name("joint"), [&name("distal"), "platform"], &end, "");
    }
    text += "    </model>\n  </world>\n</sdf>\n";
    text
}

/// A link at a pose in the plane, drawn as a bar of a length; the platform is drawn as a ball.
fn link(name: &str, [x, y, angle]: [f64; 3], body: &ExportedBody, length_m: f64) -> String {
    let ExportedBody {
        mass_kg,
        com_m: [cx, cy],
        inertia_kgm2: inertia,
    } = body;
    let shape = match length_m > 0.0 {
        true => format!(
            "<pose>{} 0 0 0 {} 0</pose><geometry><cylinder><radius>{}</radius><length>{length_m}</length></cylinder></geometry>",
            0.5 * length_m,
            std::f64::consts::FRAC_PI_2,
            ExportedLeg::radius_m(length_m)
        ),
        false => "<geometry><sphere><radius>0.01</radius></sphere></geometry>".into(),
    };
    format!(
        "      <link name=\"{name}\">\n        <pose>{x} {y} 0 0 0 {angle}</pose>\n        <inertial>\n          \
         <pose>{cx} {cy} 0 0 0 0</pose>\n          <mass>{mass_kg}</mass>\n          \
         <inertia><ixx>{inertia}</ixx><iyy>{inertia}</iyy><izz>{inertia}</izz></inertia>\n        </inertial>\n        \
         <visual name=\"shape\">{shape}</visual>\n      </link>\n"
    )
}

/// A joint about z between two links, in the frame of the second unless `pose` says another place.
fn joint(name: &str, [parent, child]: [&str; 2], pose: &str, limits: &str) -> String {
    format!(
        "      <joint name=\"{name}\" type=\"revolute\">\n{pose}        <parent>{parent}</parent>\n        <child>{child}</child>\n        \
         <axis><xyz>0 0 1</xyz>{limits}</axis>\n      </joint>\n"
    )
}
