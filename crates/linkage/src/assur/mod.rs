//! Assur analysis: a planar mechanism of links and joints, decomposed into Assur groups and solved
//! over its motion.
//!
//! [`Linkage::read`] reads and checks a file, and compares Gruebler's count with the drives
//! ([`Mobility`]). It orders the links into groups ([`Group`]): driven links, dyads, and larger
//! groups. [`track()`] solves the groups in that order at every step: dyads in closed form, larger
//! groups by Newton-Raphson. [`files()`] gives a table and figures, [`header`] and [`summary`]
//! describe the result.
//!
//! ```
//! use trirrr_linkage::assur::{Linkage, track};
//!
//! let text = r#"
//! name = "four-bar"
//! [[link]]
//! name = "frame"
//! points_m = { O = [0.0, 0.0], Q = [0.4, 0.0] }
//! [[link]]
//! name = "crank"
//! length_m = 0.1
//! ends = ["O", "A"]
//! [[link]]
//! name = "coupler"
//! length_m = 0.35
//! ends = ["A", "B"]
//! [[link]]
//! name = "rocker"
//! length_m = 0.25
//! ends = ["Q", "B"]
//! [[joint]]
//! name = "O"
//! kind = "revolute"
//! at = ["frame.O", "crank.O"]
//! [[joint]]
//! name = "A"
//! kind = "revolute"
//! at = ["crank.A", "coupler.A"]
//! [[joint]]
//! name = "B"
//! kind = "revolute"
//! at = ["coupler.B", "rocker.B"]
//! branch = 1
//! [[joint]]
//! name = "Q"
//! kind = "revolute"
//! at = ["rocker.Q", "frame.Q"]
//! [[drive]]
//! joint = "O"
//! rate_rad_s = 1.0
//! "#;
//! let linkage = Linkage::parse(text, "four-bar.toml")?;
//! assert_eq!(linkage.groups[1].title(), "dyad RRR");
//! let track = track(&linkage);
//! assert_eq!(track.positions.len(), 361);
//! assert!(track.closure < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arm;
mod chain;
mod constraint;
mod dependence;
mod description;
mod draw;
mod dyad;
#[cfg(test)]
mod example;
mod factors;
mod figures;
mod files;
mod groups;
mod loads;
mod loops;
mod mobility;
mod newton;
mod parts;
mod rail;
mod read;
mod report;
mod solve;
mod state;
mod study;
mod table;
mod track;

pub use arm::{ArmBranch, ArmError, EndMotion, SerialArm};
pub use description::{
    FRAME, Joint, JointDrive, JointKind, LinkBody, Linkage, MotionSpan, PointRef, Prismatic,
    SlotPart,
};
pub use files::{NamedFile, files, inverse_files};
pub use groups::{Dyad, Group, GroupKind};
pub use loads::drive_loads;
pub use loops::{LinkLoop, LoopUnknowns, independent_loops, unknowns};
pub use mobility::Mobility;
pub use report::{header, stopped, summary};
pub use solve::{Position, Unsolved};
pub use state::{LinkState, Reason, Solved};
pub use study::{
    ChainKind, CrankChain, DeadPoint, LinkageStudy, LoadFigures, NewtonFigures, Travel, Traveller,
    study,
};
pub use track::{Stop, Track, track};
