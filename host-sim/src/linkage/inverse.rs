//! `trirrr linkage --inverse-deg`: both solutions of a serial arm for the motion of its end link.

use super::LinkageArgs;
use crate::arguments::{LARGEST, pose_deg, pose_rad, three};
use crate::failure::CliError;
use crate::results::ResultFolder;
use crate::terminal::show;
use clap::Args;
use std::path::Path;
use trirrr_figures::document::{Document, Facts};
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
    results.end(None)?;
    let mut document = document(linkage, &arm, end, &branches);
    show(document.files(results.files()), args.json)
}

fn document(
    linkage: &Linkage,
    arm: &SerialArm,
    end: &EndMotion,
    branches: &[ArmBranch; 2],
) -> Document {
    let [x, y, angle] = end.pose;
    let mut document = Document::new();
    let point = linkage.point_name(arm.end);
    let drives = arm.joints.map(|joint| linkage.joints[joint].name.clone());
    document.note(format!(
        "{}: inverse for {point} at {x:.6} m, {y:.6} m, {:.4} deg",
        linkage.name,
        angle.to_degrees()
    ));
    for branch in branches {
        let side = if branch.elbow > 0.0 { "left" } else { "right" };
        document.heading(format!(
            "elbow on the {side}; sine of its angle {:.6}; residual {:.1e} m",
            branch.distance, branch.residual_m
        ));
        let rows = branch.drives.iter().enumerate();
        let rows = rows.map(|(place, [value, rate, acceleration])| {
            Facts::new()
                .text("drive", drives[place].as_str())
                .derived("angle", "deg", value.to_degrees())
                .decimals(4)
                .derived("angle in rad", "", value)
                .decimals(8)
                .derived("rate", "rad/s", rate)
                .derived("acceleration", "rad/s^2", acceleration)
                .derived(
                    "torque",
                    "N m",
                    branch.torques_nm.map(|torques| torques[place]),
                )
        });
        document.table("", rows.collect());
    }
    let of = |branch: &ArmBranch| {
        Facts::new()
            .data("elbow", branch.elbow as i32)
            .data("angles_rad", branch.drives.map(|drive| drive[0]))
            .data("rates_rad_s", branch.drives.map(|drive| drive[1]))
            .data("accelerations_rad_s2", branch.drives.map(|drive| drive[2]))
            .data("torques_nm", branch.torques_nm)
            .data("distance", branch.distance)
            .data("residual_m", branch.residual_m)
    };
    document.pairs(
        Facts::new()
            .data("name", &linkage.name)
            .data("point", point)
            .data("pose", end.pose)
            .data("velocity", end.velocity)
            .data("acceleration", end.acceleration)
            .data("drives", drives)
            .rows("branches", branches.iter().map(of)),
    );
    document
}
