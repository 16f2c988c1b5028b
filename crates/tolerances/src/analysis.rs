//! Bounds along a job, interval by interval.

use crate::machine::UncertainMachine;
use crate::model::{BoxModel, VARIABLES};
use crate::parameter::{HalfWidths, Parameter, TIME};
use nalgebra::Vector3;
use std::f64::consts::PI;
use thiserror::Error;
use trirrr_core::machine::BuildError;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Pose, Quintics, Segment, Setpoint};
use trirrr_scene::{JobMove, Scene};

/// A move is divided into 2^3 intervals at first, and into 2^9 at most.
const DEPTHS: (u32, u32) = (3, 9);
/// An interval is short enough if the remainder of the error is at most this part of what is linear, and that of the
/// torques at most this part of the greatest torque.
const SMALL_REMAINDERS: (f64, f64) = (0.01, 0.002);
/// An interval is halved once more only if halving took at least this much of the remainder: what is left belongs to the
/// tolerances, not to time.
const WORTH_HALVING: f64 = 0.75;
/// Directions in which the error at the tool is measured, over half a turn.
const DIRECTIONS: u32 = 64;

/// Reason for which a scene cannot be analysed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Unanalysable {
    /// The scene has no tolerances.
    #[error(
        "the scene has no [tolerances]: add the table with the half-width of what is not exact, such as `distal_m = \
         0.0001` for links of plus or minus 0.1 mm"
    )]
    NoTolerances,
    /// The nominal machine is none in binary64.
    #[error(transparent)]
    Machine(#[from] BuildError),
}

/// Bounds of a scene's job over the box of its tolerances, in SI units.
pub struct ToleranceAnalysis<'s> {
    scene: &'s Scene,
    half_widths: HalfWidths,
    machine: UncertainMachine,
}

/// Bounds that hold at every instant of an interval of time, for every machine within the tolerances.
#[derive(Clone, Copy, Debug)]
pub struct TimeSpan {
    /// Number of the move, from 0.
    pub job_move: usize,
    /// Start of the interval, s, counted from the start of the job.
    pub start_s: f64,
    /// End of the interval, s.
    pub end_s: f64,
    /// Commanded pose in the middle of the interval.
    pub pose: Pose<f64>,
    /// Error at the tool; `None` where no bound is proven.
    pub tool: Option<ToolError>,
    /// Least and greatest rate of each motor, rad/s; `None` where no bound is proven.
    pub rates: Option<[[f64; 2]; 3]>,
    /// Least and greatest torque of each motor, N m; `None` where no bound is proven, and in a scene without torques.
    pub torques: Option<[[f64; 2]; 3]>,
    /// Torques over the box, of which the ranges are.
    torque_models: Option<[BoxModel; 3]>,
    /// Size of the remainders, 1 where they are just [small](SMALL_REMAINDERS).
    remainder: f64,
}

/// Error of the platform's pose: the real pose less the commanded one.
#[derive(Clone, Copy, Debug)]
pub struct ToolError {
    /// dx, dy and dalpha.
    error: Vector3<BoxModel>,
}

/// Share of one parameter in the error at the tool, to first order: the change for plus one half-width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contribution {
    /// The parameter.
    pub parameter: Parameter,
    /// Half-width of the parameter, in its unit.
    pub half_width: f64,
    /// Change of x, m.
    pub dx_m: f64,
    /// Change of y, m.
    pub dy_m: f64,
    /// Change of alpha, rad.
    pub dalpha_rad: f64,
    /// Change along the direction of the greatest error, m.
    pub along_m: f64,
}

impl ToolError {
    /// Bounds of the sizes of dx (m), dy (m) and dalpha (rad).
    pub fn sizes(&self) -> [f64; 3] {
        self.error.map(|component| component.magnitude()).into()
    }

    /// Bound of the distance between real and commanded position, m.
    pub fn distance_m(&self) -> f64 {
        self.greatest().0
    }

    /// Bound of the distance, and the unit vector of the direction in which the error is greatest.
    ///
    /// An error of length d has at least d cos(pi / 2 n) along the nearest of n directions over half a turn.
    fn greatest(&self) -> (f64, [f64; 2]) {
        let turned = |part: f64| <f64 as Arithmetic>::sin_cos(PI * part / f64::from(DIRECTIONS));
        let along = |index: u32| {
            let (sin, cos) = turned(f64::from(index));
            let [x, y] = [cos, sin].map(BoxModel::from_f64);
            let size = (self.error.x * x + self.error.y * y).magnitude();
            (size, [cos, sin])
        };
        let (size, direction) = (0..DIRECTIONS)
            .map(along)
            .fold(
                (0.0, [1.0, 0.0]),
                |most, next| if next.0 > most.0 { next } else { most },
            );
        let (_, cos) = turned(0.5);
        (size / cos * (1.0 + 1e-15), direction)
    }

    fn remainder(&self) -> f64 {
        // Below this part of the machine, or of a radian, everything is rounding.
        let relative = |error: f64, spread: f64| error / spread.max(1e-12);
        let spread = |model: &BoxModel| model.spread() - model.linear[TIME].abs();
        let e = &self.error;
        let position = relative(e.x.error.max(e.y.error), spread(&e.x).max(spread(&e.y)));
        position.max(relative(e.z.error, spread(&e.z))) / SMALL_REMAINDERS.0
    }
}

impl<'s> ToleranceAnalysis<'s> {
    /// Prepares the analysis of `scene`.
    ///
    /// # Errors
    /// [`Unanalysable`].
    pub fn new(scene: &'s Scene) -> Result<Self, Unanalysable> {
        let half_widths = HalfWidths::of(scene).ok_or(Unanalysable::NoTolerances)?;
        Ok(Self {
            scene,
            half_widths,
            machine: UncertainMachine::build(&scene.parameters, &half_widths)?,
        })
    }

    /// The bounds of the whole job, in the order of time. Each move is analysed when its first interval is asked for.
    pub fn spans(&self) -> impl Iterator<Item = TimeSpan> {
        let mut ticks = 0;
        self.scene
            .job
            .moves
            .iter()
            .enumerate()
            .flat_map(move |(index, each)| {
                let start = ticks;
                ticks += each.duration_ticks;
                self.of_move(index, each, start)
            })
    }

    /// Bounds of the error at the tool where the machine is commanded to stand at `pose`; `None` where none is proven.
    pub fn at_rest(&self, pose: &Pose<f64>) -> Option<ToolError> {
        let zero = Vector3::from([BoxModel::ZERO; 3]);
        let setpoint = Setpoint {
            pose: Pose {
                position: pose.position.map(BoxModel::point),
                angle: BoxModel::point(pose.angle),
            },
            velocity: zero,
            acceleration: zero,
        };
        let commanded = self.machine.commanded(&setpoint).ok()?;
        let error = self.machine.platform_error(&commanded)?;
        Some(ToolError { error })
    }

    /// Shares of the parameters in the torque of `motor`, 0 to 2, during `span`, to first order: the change for plus one
    /// half-width, N m. The greatest comes first; parameters without a share are left out.
    pub fn torque_budget(&self, span: &TimeSpan, motor: usize) -> Vec<(Parameter, f64)> {
        let shares = span.torque_models.iter().flat_map(|torques| {
            Parameter::all().map(|parameter| (parameter, parameter.slope(&torques[motor])))
        });
        let mut shares: Vec<_> = shares.filter(|(_, share)| *share != 0.0).collect();
        shares.sort_by(|(_, a), (_, b)| b.abs().total_cmp(&a.abs()));
        shares
    }

    /// Half-width of `parameter` in its unit.
    pub fn half_width(&self, parameter: Parameter) -> f64 {
        self.half_widths.half_width(parameter)
    }

    /// Shares of the parameters in the error at the tool during `span`, the greatest along the direction of the greatest
    /// error first; those of parameters without a share are left out.
    pub fn budget(&self, tool: &ToolError) -> Vec<Contribution> {
        let (_, [cos, sin]) = tool.greatest();
        let mut shares: Vec<Contribution> = Parameter::all()
            .map(|parameter| {
                let [dx_m, dy_m, dalpha_rad]: [f64; 3] = tool
                    .error
                    .map(|component| parameter.slope(&component))
                    .into();
                Contribution {
                    parameter,
                    half_width: self.half_width(parameter),
                    dx_m,
                    dy_m,
                    dalpha_rad,
                    along_m: dx_m * cos + dy_m * sin,
                }
            })
            .filter(|share| [share.dx_m, share.dy_m, share.dalpha_rad] != [0.0; 3])
            .collect();
        shares.sort_by(|a, b| b.along_m.abs().total_cmp(&a.along_m.abs()));
        shares
    }

    fn of_move(&self, index: usize, each: &JobMove, start: u32) -> Vec<TimeSpan> {
        let mut spans = Vec::new();
        let work = MoveInTime {
            index,
            start,
            ticks: each.duration_ticks,
            segment: segment(each, self.scene.period_s()),
        };
        let (first, _) = DEPTHS;
        for number in 0..1 << first {
            self.divide(&work, (first, number), f64::INFINITY, &mut spans);
        }
        spans
    }

    /// Bounds the interval `number` of 2^`depth`, or its halves where these are worth it. `before` is the remainder of
    /// twice the interval.
    fn divide(
        &self,
        work: &MoveInTime,
        (depth, number): (u32, u32),
        before: f64,
        spans: &mut Vec<TimeSpan>,
    ) {
        let span = self.bounded(work, depth, number);
        let (_, deepest) = DEPTHS;
        let is_good = span.remainder <= 1.0
            || (span.remainder.is_finite() && span.remainder > WORTH_HALVING * before);
        if is_good || depth == deepest {
            spans.push(span);
            return;
        }
        for half in 0..2 {
            self.divide(work, (depth + 1, 2 * number + half), span.remainder, spans);
        }
    }

    fn bounded(&self, work: &MoveInTime, depth: u32, number: u32) -> TimeSpan {
        // Powers of two: exact.
        let intervals = f64::from(1u32 << depth);
        let middle = (f64::from(number) + 0.5) / intervals;
        let fraction = BoxModel::variable(middle, TIME, 0.5 / intervals);
        let setpoint = work.segment.at_fraction(fraction);
        let at = |number: u32| {
            let ticks =
                f64::from(work.start) + f64::from(work.ticks) * f64::from(number) / intervals;
            ticks * self.scene.period_s()
        };
        let place = setpoint.pose.position;
        let mut span = TimeSpan {
            job_move: work.index,
            start_s: at(number),
            end_s: at(number + 1),
            pose: Pose::from_f64(
                place.x.constant,
                place.y.constant,
                setpoint.pose.angle.constant,
            ),
            tool: None,
            rates: None,
            torques: None,
            torque_models: None,
            remainder: f64::INFINITY,
        };
        let Ok(commanded) = self.machine.commanded(&setpoint) else {
            return span;
        };
        let rates = commanded.each_ref().map(|leg| leg.rate());
        if rates.iter().all(|rate| rate.is_finite()) {
            span.rates = Some(rates.map(|rate| rate.range()));
        }
        let Some(error) = self.machine.platform_error(&commanded) else {
            return span;
        };
        let tool = ToolError { error };
        span.tool = Some(tool);
        span.remainder = tool.remainder();
        if self.scene.torque {
            let pose = Pose {
                position: place + error.xy(),
                angle: setpoint.pose.angle + error.z,
            };
            let real = self.machine.real_legs(&commanded, &error);
            let torques = self.machine.torques(&pose, &commanded, &real);
            let torques = torques
                .ok()
                .filter(|all| all.iter().all(|each| each.is_finite()));
            span.torques = torques.map(|all| all.map(|each| each.range()));
            span.torque_models = torques;
            span.remainder = span
                .remainder
                .max(torques.map_or(f64::INFINITY, remainder_of_torques));
        }
        span
    }
}

/// Greatest remainder relative to the greatest torque.
fn remainder_of_torques(torques: [BoxModel; 3]) -> f64 {
    let greatest = |size: fn(&BoxModel) -> f64| torques.iter().map(size).fold(0.0, f64::max);
    let size = greatest(|torque| torque.constant.abs() + torque.spread());
    greatest(|torque| torque.error) / size.max(f64::MIN_POSITIVE) / SMALL_REMAINDERS.1
}

/// A move of the job over the box.
struct MoveInTime {
    index: usize,
    /// Ticks before the move.
    start: u32,
    ticks: u32,
    segment: Segment<BoxModel, Quintics>,
}

/// The move as it is commanded, in real numbers: without the rounding of the tick's number type.
fn segment(each: &JobMove, period_s: f64) -> Segment<BoxModel, Quintics> {
    let (ticks, period) = (each.duration_ticks, BoxModel::from_f64(period_s));
    let ends = each.ends::<f64>();
    let pose = |pose: &Pose<f64>| Pose {
        position: pose.position.map(BoxModel::point),
        angle: BoxModel::point(pose.angle),
    };
    let exact = ends.convert(pose, BoxModel::point);
    Segment::of_kind(&exact, ends.is_rest_to_rest(), ticks, period)
}

const _: () = assert!(TIME < VARIABLES);
