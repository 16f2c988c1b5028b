//! The table: one row per position, SI units.

use super::arm::{ArmBranch, SerialArm};
use super::description::{JointKind, Linkage};
use super::loads::drive_loads;
use super::solve::Position;
use super::track::Track;
use crate::motion::PointMotion;
use trirrr_core::number::{dot, perpendicular};

/// The table with its header.
pub(super) fn csv(linkage: &Linkage, track: &Track) -> String {
    // Debug text is the shortest that reads back as the same number.
    let mut text = columns(linkage).join(",");
    text.push('\n');
    for position in &track.positions {
        let values = row(linkage, position).into_iter();
        let mut row: Vec<String> = values.map(|v| format!("{v:?}")).collect();
        if linkage.has_masses() {
            // At a singular position there are none: empty fields.
            let loads = drive_loads(linkage, position);
            let load = |drive: usize| loads.as_ref().map(|loads| format!("{:?}", loads[drive]));
            row.extend((0..linkage.drives.len()).map(|drive| load(drive).unwrap_or_default()));
        }
        text.push_str(&row.join(","));
        text.push('\n');
    }
    text
}

/// The names of the columns.
fn columns(linkage: &Linkage) -> Vec<String> {
    let mut names = vec!["t".to_owned()];
    let mut add = |prefixes: &[&str], name: &str| {
        names.extend(prefixes.iter().map(|prefix| format!("{prefix}_{name}")));
    };
    for drive in &linkage.drives {
        add(&["q"], &linkage.joints[drive.joint].name);
    }
    for link in &linkage.links[linkage.moving_links()] {
        add(&["th", "dth", "ddth"], &link.name);
    }
    // A pin in a slot has its way along the slot.
    for joint in &linkage.joints {
        if matches!(joint.kind, JointKind::Prismatic(_)) {
            add(&["s", "ds", "dds"], &joint.name);
        }
    }
    for &point in &linkage.traces {
        let name = linkage.point_name(point);
        add(&["x", "y", "vx", "vy", "ax", "ay"], &name);
    }
    for drive in linkage.drives.iter().filter(|_| linkage.has_masses()) {
        let load = if drive.slides { "f" } else { "tau" };
        add(&[load], &linkage.joints[drive.joint].name);
    }
    names
}

fn row(linkage: &Linkage, position: &Position) -> Vec<f64> {
    let mut row = vec![position.t];
    row.extend(linkage.drives.iter().map(|drive| drive.at(position.t)[0]));
    for state in &position.states[linkage.moving_links()] {
        row.extend([state.angle, state.motion.rate, state.motion.acceleration]);
    }
    for joint in 0..linkage.joints.len() {
        row.extend(position.slide(linkage, joint).into_iter().flatten());
    }
    for &point in &linkage.traces {
        let m = position.point(linkage, point);
        for v in [m.position, m.velocity, m.acceleration] {
            row.extend([v.x, v.y]);
        }
    }
    row
}

/// Both solutions of an arm's inverse: a row each.
pub(super) fn inverse_csv(linkage: &Linkage, arm: &SerialArm, branches: &[ArmBranch; 2]) -> String {
    let mut names = vec!["elbow".to_owned()];
    let of_joints = |prefix: &str| {
        let names = arm.joints.iter().map(|&joint| &linkage.joints[joint].name);
        let names = names.map(|name| format!("{prefix}_{name}"));
        names.collect::<Vec<_>>()
    };
    for prefix in ["q", "dq", "ddq"] {
        names.extend(of_joints(prefix));
    }
    names.extend(["distance".into(), "residual".into()]);
    if linkage.has_masses() {
        names.extend(of_joints("tau"));
    }
    let mut text = names.join(",");
    text.push('\n');
    for branch in branches {
        let mut row = vec![branch.elbow];
        for order in 0..3 {
            row.extend(branch.drives.map(|drive| drive[order]));
        }
        row.extend([branch.distance, branch.residual_m]);
        row.extend(branch.torques_nm.into_iter().flatten());
        let row: Vec<String> = row.into_iter().map(|v| format!("{v:?}")).collect();
        text.push_str(&row.join(","));
        text.push('\n');
    }
    text
}

impl Position {
    /// Returns the motion of a point.
    pub fn point(&self, linkage: &Linkage, point: super::PointRef) -> PointMotion<f64> {
        self.states[point.link].motion.point(linkage.local(point))
    }

    /// Returns distance, rate and acceleration along the guide of a prismatic joint, from the
    /// guide's point to the slider's: m, m/s, m/s^2. `None` for a pin.
    pub fn slide(&self, linkage: &Linkage, joint: usize) -> Option<[f64; 3]> {
        let JointKind::Prismatic(slide) = &linkage.joints[joint].kind else {
            return None;
        };
        let guide = &self.states[slide.guide.link].motion;
        let u = slide.along(&self.states);
        let n = perpendicular(u);
        let d = self
            .point(linkage, slide.slider)
            .relative_to(&self.point(linkage, slide.guide));
        let (w, e) = (guide.rate, guide.acceleration);
        // u' = w n, u'' = e n - w^2 u.
        let length = dot(u, d.position);
        let across = dot(n, d.position);
        let rate = dot(u, d.velocity) + w * across;
        let acceleration =
            dot(u, d.acceleration) + 2.0 * w * dot(n, d.velocity) + e * across - w * w * length;
        Some([length, rate, acceleration])
    }
}
