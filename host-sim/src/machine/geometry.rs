//! Another geometry for a board whose scene can be replaced: leg by leg, all of them or none.

use super::talk::{Talk, other_answer};
use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::numbers::in_boards_numbers;
use std::sync::atomic::AtomicBool;
use trirrr_client::describe;
use trirrr_core::machine::Parameters;
use trirrr_protocol::message::scene::{Leg, Platform, Section, SectionName};
use trirrr_protocol::message::{Acting, Command, State, Status};
use trirrr_scene::{Scene, in_number_type};
use trirrr_service::ServiceNumber;

/// Geometry that a board has taken.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReplacedGeometry {
    /// Pose at which the platform stands by the geometry before: x, y (m), alpha (rad).
    pub(crate) stood: [f64; 3],
    /// The same by the new one. The motors have not moved.
    pub(crate) stands: [f64; 3],
}

/// Gives the board of `scene` the geometry of `machine`: base joints, lengths, platform joints. The motors stand at the angles that the
/// board counts, plus `offsets_rad`. Masses stay those that the board has.
///
/// # Errors
/// Refused: by the board, which then has the geometry that it had. Failed: the port, or a board that did not take its own geometry back.
pub(crate) fn replace_geometry(
    args: &MachineArgs,
    scene: &Scene,
    machine: &Parameters,
    offsets_rad: [f64; 3],
    stop: &AtomicBool,
) -> Result<ReplacedGeometry, CliError> {
    in_boards_numbers(args.scalar, scene.number, |number| {
        in_number_type!(number, N => {
            let mut talk = Talk::<N>::open(args, scene, stop)?;
            // The board's legs are given from the point of the tool that is mounted now.
            let machine = match scene.tools {
                Some(_) => machine.at_tool_point(read_platform(&mut talk)?.tool_point_m.into()),
                None => *machine,
            };
            replace(&mut talk, &machine, offsets_rad)
        })
    })
}

fn replace<N: ServiceNumber>(
    talk: &mut Talk<'_, N>,
    machine: &Parameters,
    offsets_rad: [f64; 3],
) -> Result<ReplacedGeometry, CliError> {
    let stood = pose(talk)?;
    let mut before = Vec::new();
    for ((index, own), offset) in (0..).zip(&machine.legs).zip(offsets_rad) {
        let kept = read(talk, index)?;
        let wanted = Leg::from(own);
        let leg = Leg {
            proximal: kept.proximal,
            distal: kept.distal,
            rotor_inertia_kgm2: kept.rotor_inertia_kgm2,
            elbow_positive: kept.elbow_positive,
            encoder_offset_rad: kept.encoder_offset_rad + offset,
            ..wanted
        };
        if let Err(refusal) = talk.done(put(index, leg)) {
            for (index, leg) in (0..).zip(before) {
                talk.done(put(index, leg)).map_err(|error| {
                    CliError::Failed(format!(
                        "the board has taken a part of the geometry, and not its own back ({error}): start it anew"
                    ))
                })?;
            }
            return Err(refusal);
        }
        before.push(kept);
    }
    Ok(ReplacedGeometry {
        stood,
        stands: pose(talk)?,
    })
}

fn put<N: ServiceNumber>(index: u8, leg: Leg) -> Command<N> {
    Command::Replace(Section::Leg { index, leg })
}

fn read<N: ServiceNumber>(talk: &mut Talk<'_, N>, index: u8) -> Result<Leg, CliError> {
    match talk.section(SectionName::Leg(index))? {
        Section::Leg { leg, .. } => Ok(leg),
        _ => Err(other_answer()),
    }
}

/// Reads the platform that the board counts with.
pub(super) fn read_platform<N: ServiceNumber>(
    talk: &mut Talk<'_, N>,
) -> Result<Platform, CliError> {
    match talk.section(SectionName::Platform)? {
        Section::Platform(platform) => Ok(platform),
        _ => Err(other_answer()),
    }
}

/// Pose at which the machine stands, m and rad.
fn pose<N: ServiceNumber>(talk: &mut Talk<'_, N>) -> Result<[f64; 3], CliError> {
    let status = talk.status()?;
    stands(&status, &talk.units()).ok_or_else(|| {
        let remedy = match status.state {
            State::Disabled => " (`trirrr enable` switches its drives on)",
            _ => "",
        };
        CliError::Refused(format!(
            "not while the machine is {}{remedy}",
            describe::state(status.state, Acting::Nothing)
        ))
    })
}

/// Pose at the end of all moves: x, y (m), alpha (rad); none where the board knows none.
pub(super) fn stands<N: ServiceNumber>(
    status: &Status<N>,
    units: &describe::Units,
) -> Option<[f64; 3]> {
    let pose = status.end.as_ref()?.pose;
    let [x, y] = [pose.position.x, pose.position.y].map(|value| value.to_f64() * units.length_m);
    Some([x, y, N::angle_to_f64(pose.angle)])
}
