//! One move of a job, of any kind.

use super::{Hermite, Pose, Quintic, RestToRest, Setpoint};
use crate::number::Number;
use crate::source::ToSource;
use core::fmt::{self, Debug, Write};
use nalgebra::Vector3;

/// Kinds of moves that a machine plays: a type, so that a scene without quintics pays nothing for them.
pub trait CurveKind: Copy + Debug + PartialEq + ToSource + 'static {
    /// True if moves may have to keep a limit of jerk.
    const JERK: bool;

    /// Accelerations that a move has at both ends, (ax, ay, alphaddot).
    type Accelerations<N: Number>: Copy + Debug + PartialEq;

    /// A move with accelerations at its ends.
    type Quintic<N: Number>: Curve<N> + Copy + Debug + PartialEq + ToSource;

    /// No accelerations: a cubic.
    fn none<N: Number>() -> Self::Accelerations<N>;

    /// These accelerations, where the machine plays quintics.
    fn some<N: Number>(accelerations: [[N; 3]; 2]) -> Option<Self::Accelerations<N>>;

    /// The accelerations, if there are any.
    fn given<N: Number>(accelerations: &Self::Accelerations<N>) -> Option<[[N; 3]; 2]>;

    /// The accelerations in another number type.
    fn convert<N: Number, T: Number>(
        accelerations: &Self::Accelerations<N>,
        convert: impl Fn(N) -> T,
    ) -> Self::Accelerations<T>;

    /// The move between `ends`, if it is a quintic.
    fn quintic<N: Number>(
        ends: &Ends<N, Self>,
        ticks: u32,
        period: N::Factor,
    ) -> Option<Self::Quintic<N>>;
}

/// Cubics only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cubics {}

/// Cubics and quintics. Without `JERK` no limit of jerk is checked, and no code for it kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quintics<const JERK: bool = true> {}

/// The quintic of a machine that plays none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoQuintic {}

/// Setpoints of a move.
pub trait Curve<N: Number> {
    /// The setpoint at `tick`, counted from the start of the move; beyond the end, the end.
    fn at(&self, tick: u32) -> Setpoint<N>;

    /// The setpoint `part` of a tick, less than 1, after `tick`, or at the whole tick; beyond the end, the end.
    fn between(&self, tick: u32, part: Option<N>) -> Setpoint<N>;

    /// The setpoint at the fraction `s` of the duration, 0 to 1; for times between ticks.
    fn at_fraction(&self, s: N) -> Setpoint<N>;

    /// Third derivative of the pose there.
    fn jerk_at_fraction(&self, s: N) -> Vector3<N>;

    /// Length of the move in ticks.
    fn ticks(&self) -> u32;
}

/// All that determines the curve of a move besides its duration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends<N: Number, K: CurveKind = Cubics> {
    /// Pose at the start.
    pub from: Pose<N>,
    /// Pose at the end.
    pub to: Pose<N>,
    /// (vx, vy, alphadot) at the start and at the end.
    pub velocities: [Vector3<N>; 2],
    /// Accelerations there, for a quintic.
    pub accelerations: K::Accelerations<N>,
}

/// One move of a job. A move that starts and ends at rest does without the general cubic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment<N: Number, K: CurveKind = Cubics> {
    /// From rest to rest.
    RestToRest(RestToRest<N>),
    /// With a velocity at one end at least.
    Hermite(Hermite<N>),
    /// With accelerations at both ends.
    Quintic(K::Quintic<N>),
}

impl CurveKind for Cubics {
    type Accelerations<N: Number> = ();
    type Quintic<N: Number> = NoQuintic;
    const JERK: bool = false;

    #[inline(always)]
    fn none<N: Number>() {}

    #[inline(always)]
    fn some<N: Number>(_: [[N; 3]; 2]) -> Option<()> {
        None
    }

    #[inline(always)]
    fn given<N: Number>((): &()) -> Option<[[N; 3]; 2]> {
        None
    }

    #[inline(always)]
    fn convert<N: Number, T: Number>((): &(), _: impl Fn(N) -> T) {}

    #[inline(always)]
    fn quintic<N: Number>(_: &Ends<N>, _: u32, _: N::Factor) -> Option<NoQuintic> {
        None
    }
}

impl<const JERK: bool> CurveKind for Quintics<JERK> {
    type Accelerations<N: Number> = Option<[[N; 3]; 2]>;
    type Quintic<N: Number> = Quintic<N>;
    const JERK: bool = JERK;

    fn none<N: Number>() -> Option<[[N; 3]; 2]> {
        None
    }

    fn some<N: Number>(accelerations: [[N; 3]; 2]) -> Option<Option<[[N; 3]; 2]>> {
        Some(Some(accelerations))
    }

    fn given<N: Number>(accelerations: &Option<[[N; 3]; 2]>) -> Option<[[N; 3]; 2]> {
        *accelerations
    }

    fn convert<N: Number, T: Number>(
        accelerations: &Option<[[N; 3]; 2]>,
        convert: impl Fn(N) -> T,
    ) -> Option<[[T; 3]; 2]> {
        accelerations.map(|both| both.map(|one| one.map(&convert)))
    }

    fn quintic<N: Number>(
        ends: &Ends<N, Self>,
        ticks: u32,
        period: N::Factor,
    ) -> Option<Quintic<N>> {
        let accelerations = ends.accelerations?.map(Vector3::from);
        let poses = [ends.from, ends.to];
        Some(Quintic::new(
            poses,
            ends.velocities,
            accelerations,
            ticks,
            period,
        ))
    }
}

impl ToSource for Cubics {
    fn write_type(out: &mut dyn Write) -> fmt::Result {
        out.write_str("trirrr_core::setpoint::Cubics")
    }

    fn write_value(&self, _: &mut dyn Write) -> fmt::Result {
        match *self {}
    }
}

impl<const JERK: bool> ToSource for Quintics<JERK> {
    fn write_type(out: &mut dyn Write) -> fmt::Result {
        write!(out, "trirrr_core::setpoint::Quintics<{JERK}>")
    }

    fn write_value(&self, _: &mut dyn Write) -> fmt::Result {
        match *self {}
    }
}

impl ToSource for NoQuintic {
    fn write_type(out: &mut dyn Write) -> fmt::Result {
        out.write_str("trirrr_core::setpoint::NoQuintic")
    }

    fn write_value(&self, _: &mut dyn Write) -> fmt::Result {
        match *self {}
    }
}

impl<N: Number, K: CurveKind> ToSource for Segment<N, K> {
    fn write_type(out: &mut dyn Write) -> fmt::Result {
        out.write_str("trirrr_core::setpoint::Segment<")?;
        N::write_type(out)?;
        out.write_str(", ")?;
        K::write_type(out)?;
        out.write_str(">")
    }

    fn write_value(&self, out: &mut dyn Write) -> fmt::Result {
        out.write_str("trirrr_core::setpoint::Segment::")?;
        match self {
            Self::RestToRest(segment) => {
                out.write_str("RestToRest(")?;
                segment.write_value(out)?;
            }
            Self::Hermite(segment) => {
                out.write_str("Hermite(")?;
                segment.write_value(out)?;
            }
            Self::Quintic(segment) => {
                out.write_str("Quintic(")?;
                segment.write_value(out)?;
            }
        }
        out.write_str(")")
    }
}

impl<N: Number> Curve<N> for NoQuintic {
    #[inline(always)]
    fn at(&self, _: u32) -> Setpoint<N> {
        match *self {}
    }

    #[inline(always)]
    fn between(&self, _: u32, _: Option<N>) -> Setpoint<N> {
        match *self {}
    }

    #[inline(always)]
    fn at_fraction(&self, _: N) -> Setpoint<N> {
        match *self {}
    }

    #[inline(always)]
    fn jerk_at_fraction(&self, _: N) -> Vector3<N> {
        match *self {}
    }

    #[inline(always)]
    fn ticks(&self) -> u32 {
        match *self {}
    }
}

impl<N: Number> Curve<N> for Quintic<N> {
    #[inline(always)]
    fn at(&self, tick: u32) -> Setpoint<N> {
        self.at(tick)
    }

    #[inline(always)]
    fn between(&self, tick: u32, part: Option<N>) -> Setpoint<N> {
        self.between(tick, part)
    }

    fn at_fraction(&self, s: N) -> Setpoint<N> {
        self.at_fraction(s)
    }

    fn jerk_at_fraction(&self, s: N) -> Vector3<N> {
        self.jerk_at_fraction(s)
    }

    fn ticks(&self) -> u32 {
        self.ticks()
    }
}

impl<N: Number, K: CurveKind> Ends<N, K> {
    /// The ends in another number type.
    pub fn convert<T: Number>(
        &self,
        pose: impl Fn(&Pose<N>) -> Pose<T>,
        number: impl Fn(N) -> T,
    ) -> Ends<T, K> {
        let [start, end] = &self.velocities;
        Ends {
            from: pose(&self.from),
            to: pose(&self.to),
            velocities: [start.map(&number), end.map(&number)],
            accelerations: K::convert(&self.accelerations, number),
        }
    }

    /// Returns true if the move is a cubic that is at rest at both ends.
    pub fn is_rest_to_rest(&self) -> bool {
        let zero = N::ZERO;
        let is_zero = |v: &Vector3<N>| v.x == zero && v.y == zero && v.z == zero;
        let [start, end] = &self.velocities;
        K::given(&self.accelerations).is_none() && is_zero(start) && is_zero(end)
    }
}

impl<N: Number, K: CurveKind> Segment<N, K> {
    /// The move between `ends` in `ticks` ticks of `period` seconds each, both positive.
    pub fn new(ends: &Ends<N, K>, ticks: u32, period: N::Factor) -> Self {
        Self::of_kind(ends, ends.is_rest_to_rest(), ticks, period)
    }

    /// As [`Segment::new`], for numbers that cannot tell whether they are zero.
    pub fn of_kind(ends: &Ends<N, K>, rest_to_rest: bool, ticks: u32, period: N::Factor) -> Self {
        if let Some(quintic) = K::quintic(ends, ticks, period) {
            return Self::Quintic(quintic);
        }
        let Ends { from, to, .. } = *ends;
        if rest_to_rest {
            return Self::RestToRest(RestToRest::new(from, to, ticks, period));
        }
        let [start, end] = ends.velocities;
        Self::Hermite(Hermite::new(from, start, to, end, ticks, period))
    }

    /// The setpoint at `tick`, counted from the start of the move; beyond the end, the end.
    #[inline(always)]
    pub fn at(&self, tick: u32) -> Setpoint<N> {
        match self {
            Self::RestToRest(segment) => segment.at(tick),
            Self::Hermite(segment) => segment.at(tick),
            Self::Quintic(segment) => segment.at(tick),
        }
    }

    /// The setpoint at the fraction `s` of the duration, 0 to 1; for times between ticks.
    #[inline(never)]
    pub fn at_fraction(&self, s: N) -> Setpoint<N> {
        match self {
            Self::RestToRest(segment) => segment.at_fraction(s),
            Self::Hermite(segment) => segment.at_fraction(s),
            Self::Quintic(segment) => segment.at_fraction(s),
        }
    }

    /// Third derivative of the pose there, in ticks of `period`. From move to move it may jump.
    #[inline(never)]
    pub fn jerk_at_fraction(&self, s: N, period: N::Factor) -> Vector3<N> {
        match self {
            Self::RestToRest(segment) => segment.jerk(period),
            Self::Hermite(segment) => segment.jerk_at_fraction(s),
            Self::Quintic(segment) => segment.jerk_at_fraction(s),
        }
    }

    /// The setpoint `part` of a tick, less than 1, after `tick`, or at the whole tick; beyond the end, the end.
    #[inline(always)]
    pub fn between(&self, tick: u32, part: Option<N>) -> Setpoint<N> {
        match self {
            Self::RestToRest(segment) => segment.between(tick, part),
            Self::Hermite(segment) => segment.between(tick, part),
            Self::Quintic(segment) => segment.between(tick, part),
        }
    }

    /// Length of the move in ticks.
    pub fn ticks(&self) -> u32 {
        match self {
            Self::RestToRest(segment) => segment.ticks(),
            Self::Hermite(segment) => segment.ticks(),
            Self::Quintic(segment) => segment.ticks(),
        }
    }
}
