//! Judges the moves of a job as the service of the scene would: with its own check of an offer and its own
//! admission, in the number type, units and model of the scene.

use crate::job_move::JobMove;
use crate::levels::JobLevels;
use crate::range::{RangeError, units};
use crate::{Scene, in_number_type, offer};
use thiserror::Error;
use trirrr_core::limits::Limits;
use trirrr_core::machine::BuildError;
use trirrr_core::model::{Model, ModelVisitor};
use trirrr_core::setpoint::Quintics;
use trirrr_core::units::Units;
use trirrr_protocol::message::{AnyMove, LevelRange, Refusal, Violation};
use trirrr_service::ServiceNumber;
use trirrr_service::admission::{Admission, Verdict};
use trirrr_service::features::check_levels;
use trirrr_service::paces::{MovePaces, check_offer, longest_move};

/// Judgement of a move: the rates at which a hold may slow it down, or why it is not played.
pub(crate) type Judgement = Result<MovePaces, Objection>;

/// Reason why a service does not play a move. Values are in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Objection {
    /// A value is beyond the range of the number type.
    NotFinite,
    /// The duration is no tick, or more than these ticks.
    Duration(u32),
    /// The tool's power or speed makes no sense in the number type.
    Tool,
    /// The move breaks a limit, or cannot be proven to keep it.
    Limit(Violation<f64>),
}

/// Reason why no move can be judged.
#[derive(Clone, Debug, Error, PartialEq)]
pub(crate) enum Unjudged {
    /// The machine or a limit is no value of the number type.
    #[error(transparent)]
    Machine(#[from] BuildError),
    /// The machine and its job fit no units of the number type.
    #[error(transparent)]
    Range(#[from] RangeError),
}

/// Judges each move of `scene`, wherever the moves before it end.
///
/// # Errors
/// [`Unjudged`].
pub(crate) fn judge(scene: &Scene) -> Result<Vec<Judgement>, Unjudged> {
    judge_with(scene, usize::MAX, true)
}

/// As [`judge`] the first `count` moves, but no violation names the shortest duration that would pass.
///
/// # Errors
/// [`Unjudged`].
pub(crate) fn judge_quickly(scene: &Scene, count: usize) -> Result<Vec<Judgement>, Unjudged> {
    judge_with(scene, count, false)
}

fn judge_with(scene: &Scene, count: usize, shortest: bool) -> Result<Vec<Judgement>, Unjudged> {
    in_number_type!(scene.number, N => judge_in::<N>(scene, count, shortest))
}

/// Judges each move of `scene` in the number type `N` of an image, which may be another than that of the scene.
///
/// # Errors
/// [`Unjudged`].
pub(crate) fn judge_in_type<N: ServiceNumber>(scene: &Scene) -> Result<Vec<Judgement>, Unjudged> {
    judge_in::<N>(scene, usize::MAX, false)
}

fn judge_in<N: ServiceNumber>(
    scene: &Scene,
    count: usize,
    shortest: bool,
) -> Result<Vec<Judgement>, Unjudged> {
    let units = units::<N>(scene)?;
    let mut moves = offer::moves::<N>(scene, &units);
    moves.truncate(count);
    let job = OfferedJob {
        scene,
        units: &units,
        moves: &moves,
        shortest,
    };
    Ok(scene.model().visit::<N, _>(job)?)
}

/// Moves of a scene's job in the number type `N`.
struct OfferedJob<'a, N: ServiceNumber> {
    scene: &'a Scene,
    units: &'a Units,
    moves: &'a [AnyMove<N>],
    /// Violations name the shortest duration.
    shortest: bool,
}

impl<N: ServiceNumber> ModelVisitor<N> for OfferedJob<'_, N> {
    type Output = Result<Vec<Judgement>, BuildError>;

    fn visit<M: Model<N = N>>(self) -> Self::Output {
        let Self {
            scene,
            units,
            moves,
            shortest,
        } = self;
        let mut admission = Admission::<M, Quintics>::build(
            scene.model().with(&units.parameters(&scene.parameters)),
            Limits::build(&units.limits(&scene.limits))?,
            scene.ramp(),
            units.time(scene.period_s()),
        )?;
        let judge = |(given, offered): (&JobMove, &AnyMove<N>)| {
            // Rounded to 0, a speed would make a constant power of one that follows the speed.
            let has_speed = given.tool.is_some_and(|tool| tool.speed_m_s > 0.0);
            match has_speed && offered.common().tool_speed == N::ZERO {
                true => Err(Objection::Tool),
                false => judgement(&mut admission, offered, units, shortest),
            }
        };
        Ok(scene.job.moves.iter().zip(moves).map(judge).collect())
    }
}

fn judgement<M: Model<N: ServiceNumber>>(
    admission: &mut Admission<M, Quintics>,
    offered: &AnyMove<M::N>,
    units: &Units,
    shortest: bool,
) -> Judgement {
    match check_offer(offered, longest_move(offer::CAPACITY)) {
        Ok(()) => {}
        Err(Refusal::Duration { longest }) => return Err(Objection::Duration(longest)),
        Err(Refusal::Tool) => return Err(Objection::Tool),
        Err(_) => return Err(Objection::NotFinite),
    }
    admission.offer_any(offered);
    loop {
        match admission.step() {
            Verdict::Undecided => {
                if let Some(violation) = admission.violation().filter(|_| !shortest) {
                    return Err(Objection::Limit(violation.in_si(units)));
                }
            }
            Verdict::Refused(violation) => return Err(Objection::Limit(violation.in_si(units))),
            Verdict::Admitted | Verdict::Nothing => return Ok(admission.paces()),
        }
    }
}

/// Index of the first move whose levels the service of `scene` would refuse: too many in a tick, or D turns back.
pub(crate) fn misfit(scene: &Scene, moves: &[JobMove], levels: &JobLevels) -> Option<usize> {
    in_number_type!(scene.number, N => misfit_in::<N>(scene, moves, levels))
}

fn misfit_in<N: ServiceNumber>(
    scene: &Scene,
    moves: &[JobMove],
    levels: &JobLevels,
) -> Option<usize> {
    // The units scale all lengths alike, and levels have none.
    let units = units::<N>(scene).ok()?;
    let period = N::factor_from_f64(units.time(scene.period_s()));
    let fits = |(index, range): &&(u32, LevelRange)| {
        let each = moves.get(*index as usize);
        each.is_none_or(|each| check_levels(&offer::one::<N>(each, &units), *range, period))
    };
    let misfit = levels.ranges.iter().find(|each| !fits(each))?;
    Some(misfit.0 as usize)
}
