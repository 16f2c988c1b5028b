//! Files of a solved linkage: the table and the figures.

use super::arm::{ArmBranch, SerialArm};
use super::description::Linkage;
use super::track::Track;
use super::{draw, table};
use trirrr_figures::canvas::Drawn;

/// Name of a file and its content.
pub type NamedFile = (&'static str, Drawn);

/// Makes the table `linkage.csv` and the figures. The track must have a position.
pub fn files(linkage: &Linkage, track: &Track) -> impl Iterator<Item = NamedFile> {
    let table = ("linkage.csv", Ok(table::csv(linkage, track)));
    std::iter::once(table).chain(draw::figures(linkage, track))
}

/// Makes the table `inverse.csv` and a figure of both solutions.
pub fn inverse_files(
    linkage: &Linkage,
    arm: &SerialArm,
    branches: &[ArmBranch; 2],
) -> [NamedFile; 2] {
    let positions = branches.each_ref().map(|branch| branch.position.clone());
    let track = Track {
        positions: positions.into(),
        stop: None,
        closure: 0.0,
        nearest: Vec::new(),
    };
    let table = (
        "inverse.csv",
        Ok(table::inverse_csv(linkage, arm, branches)),
    );
    [table, ("inverse.svg", draw::inverse(linkage, &track))]
}
