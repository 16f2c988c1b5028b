//! `trirrr linkage --inverse-deg`: both solutions of a serial arm for the motion of its end link.

use super::LinkageArgs;
use crate::arguments::{LARGEST, pose_deg, pose_rad, three};
use crate::failure::CliError;
use crate::results::ResultFolder;
use crate::terminal::{digits, print};
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use trirrr_linkage::assur::{ArmBranch, ArmError, EndMotion, Linkage, SerialArm, inverse_files};

/// Motion of the end link of a serial arm.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct InverseArgs {
    /// Serial arm only: drives for the first traced point of the end link at x, y (m) and the end link's angle, degrees
    #[arg(long, value_name = "X,Y,ANGLE", value_parser = pose_deg, conflicts_with = "steps")]
    pub inverse_deg: Option<[f64; 3]>,
    /// The same with the angle in rad
    #[arg(long, value_name = "X,Y,ANGLE", value_parser = pose_rad, conflicts_with_all = ["inverse_deg", "steps"])]
    pub inverse_rad: Option<[f64; 3]>,
    /// Velocity of the point, m/s, and rate of the end link, rad/s [default: at rest]
    #[arg(long, value_name = "VX,VY,RATE", value_parser = velocity)]
    pub end_velocity: Option<[f64; 3]>,
    /// Acceleration of the point, m/s^2, and of the end link, rad/s^2 [default: none]
    #[arg(long, value_name = "AX,AY,ACCELERATION", value_parser = acceleration)]
    pub end_acceleration: Option<[f64; 3]>,
}

fn velocity(text: &str) -> Result<[f64; 3], String> {
    three(
        text,
        ["VX", "VY", "RATE"],
        [LARGEST; 3],
        "m/s, m/s and rad/s",
    )
}

fn acceleration(text: &str) -> Result<[f64; 3], String> {
    let names = ["AX", "AY", "ACCELERATION"];
    three(text, names, [LARGEST; 3], "m/s^2, m/s^2 and rad/s^2")
}

impl InverseArgs {
    /// The motion that is asked for, if any.
    ///
    /// # Errors
    /// Refused: a velocity or an acceleration without a pose.
    pub(super) fn end(&self) -> Result<Option<EndMotion>, CliError> {
        let Some(pose) = self.inverse_deg.or(self.inverse_rad) else {
            let given = [
                ("--end-velocity", self.end_velocity),
                ("--end-acceleration", self.end_acceleration),
            ];
            return match given.iter().find(|(_, value)| value.is_some()) {
                Some((name, _)) => Err(CliError::Refused(format!(
                    "{name} belongs to --inverse-deg or --inverse-rad"
                ))),
                None => Ok(None),
            };
        };
        Ok(Some(EndMotion {
            pose,
            velocity: self.end_velocity.unwrap_or_default(),
            acceleration: self.end_acceleration.unwrap_or_default(),
        }))
    }
}

/// Finds both solutions, writes a table and a figure, and prints them.
///
/// # Errors
/// Refused: the linkage is no serial arm, or the end is out of reach. Failed: a file cannot be written.
pub(super) fn command(
    args: &LinkageArgs,
    linkage: &Linkage,
    end: &EndMotion,
) -> Result<(), CliError> {
    let refused = |error: ArmError| CliError::Refused(format!("{}: {error}", args.file.display()));
    let arm = SerialArm::of(linkage).map_err(refused)?;
    let branches = arm.inverse(linkage, end).map_err(refused)?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(format!("{}-inverse", linkage.name)),
    };
    let mut results = ResultFolder::for_command(&folder, "linkage --inverse")?;
    for (name, drawn) in inverse_files(linkage, &arm, &branches) {
        results.figure(name, drawn)?;
    }
    results.end(Ok(()))?;
    match args.json {
        true => print(&format!("{:#}\n", as_json(linkage, &arm, end, &branches))),
        false => print(&text(linkage, &arm, end, &branches, &results.files())),
    }
}

fn text(
    linkage: &Linkage,
    arm: &SerialArm,
    end: &EndMotion,
    branches: &[ArmBranch; 2],
    files: &[PathBuf],
) -> String {
    let [x, y, angle] = end.pose;
    let mut text = format!(
        "{}: inverse for {} at {x:.6} m, {y:.6} m, {:.4} deg\n",
        linkage.name,
        linkage.point_name(arm.end),
        angle.to_degrees()
    );
    for branch in branches {
        let side = if branch.elbow > 0.0 { "left" } else { "right" };
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "\nelbow on the {side}; sine of its angle {:.6}; residual {:.1e} m\n\
             drive         angle deg    angle rad        rate rad/s  acceleration rad/s^2{}",
            branch.distance,
            branch.residual_m,
            if branch.torques_nm.is_some() {
                "    torque N m"
            } else {
                ""
            }
        );
        for (place, [value, rate, acceleration]) in branch.drives.iter().enumerate() {
            let _ = write!(
                text,
                "{:<12} {:>10.4} {value:>12.8} {:>17} {:>21}",
                linkage.joints[arm.joints[place]].name,
                value.to_degrees(),
                digits(*rate),
                digits(*acceleration)
            );
            if let Some(torques) = branch.torques_nm {
                let _ = write!(text, " {:>13}", digits(torques[place]));
            }
            text.push('\n');
        }
    }
    text.push('\n');
    for file in files {
        let _ = writeln!(text, "wrote    {}", file.display());
    }
    text
}

fn as_json(
    linkage: &Linkage,
    arm: &SerialArm,
    end: &EndMotion,
    branches: &[ArmBranch; 2],
) -> Value {
    let of = |branch: &ArmBranch| {
        json!({
            "elbow": branch.elbow as i32,
            "angles_rad": branch.drives.map(|drive| drive[0]),
            "rates_rad_s": branch.drives.map(|drive| drive[1]),
            "accelerations_rad_s2": branch.drives.map(|drive| drive[2]),
            "torques_nm": branch.torques_nm,
            "distance": branch.distance,
            "residual_m": branch.residual_m,
        })
    };
    json!({
        "name": linkage.name,
        "point": linkage.point_name(arm.end),
        "pose": end.pose,
        "velocity": end.velocity,
        "acceleration": end.acceleration,
        "drives": arm.joints.map(|joint| linkage.joints[joint].name.clone()),
        "branches": branches.each_ref().map(of),
    })
}
