//! From the joint to the rotor behind its gear and back, and from radians to turns.

use super::heard::Heard;
use crate::count::Countable;
use crate::winding::Winding;
use trirrr_core::tick::Motor;

/// Command of a rotor, in the units of drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorCommand {
    /// Position, turns.
    pub position: f32,
    /// Velocity, turns per second.
    pub velocity: f32,
    /// Torque of the rotor for this motion, N m.
    pub torque: f32,
}

/// Meaning of a drive's position after it was switched on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Absolute {
    /// Position 0 is a joint angle of the scene, over all turns: the encoder knows the joint.
    Joint,
    /// Position 0 is that angle but for whole turns of the rotor. The joint is taken to be within half a turn of the
    /// rotor from the start of the job when the drive is heard first, and from where it was last after a restart.
    Rotor,
    /// Nothing. The joint is taken to be at the start of the job, and where it was last after a restart, until a homing
    /// tells better.
    Nothing,
}

/// Conversion from a joint, in the machine's units, to its rotor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorScale {
    /// Turns of the rotor per turn of the joint, negative where reversed.
    gear: f32,
    /// Turns per second of the rotor per unit of joint rate.
    velocity: f32,
    /// N m of the rotor per unit of joint torque.
    torque: f32,
    /// Joint angle at which the drive's position is 0, rad.
    zero: f64,
    absolute: Absolute,
    /// Longest time between two positions of a drive that has not restarted, ticks.
    gap: u16,
    /// N m of the rotor per ampere; 0 if a current tells no torque.
    torque_constant: f32,
}

/// Shortest [gap](RotorScale::positions_within), ticks: three questions for the position of an ODrive that is off, which come every
/// three ticks, and the tick of the answer.
pub const SHORTEST_GAP: u16 = 10;

impl RotorScale {
    /// Gear of `gear_ratio` turns of the rotor per turn of the joint, `reversed` or not. The drive's position is
    /// 0 at joint angle `zero_rad`. The machine's unit of rate is `rate_rad_s`, that of torque `torque_nm`: both
    /// 1 for the float types.
    pub const fn new(
        gear_ratio: f64,
        reversed: bool,
        zero_rad: f64,
        rate_rad_s: f64,
        torque_nm: f64,
    ) -> Self {
        let gear = if reversed { -gear_ratio } else { gear_ratio };
        Self {
            gear: gear as f32,
            velocity: (gear * rate_rad_s / core::f64::consts::TAU) as f32,
            torque: (torque_nm / gear) as f32,
            zero: zero_rad % core::f64::consts::TAU,
            absolute: Absolute::Joint,
            gap: SHORTEST_GAP,
            torque_constant: 0.0,
        }
    }

    /// Scale of a drive whose position means this.
    #[must_use]
    pub const fn knows(self, absolute: Absolute) -> Self {
        Self { absolute, ..self }
    }

    /// Scale of a drive whose positions come within so many ticks of each other, and at least [`SHORTEST_GAP`]. Behind a longer
    /// gap the drive may have restarted, and its joint may have moved by any angle.
    #[must_use]
    pub const fn positions_within(self, ticks: u16) -> Self {
        let gap = if ticks > SHORTEST_GAP {
            ticks
        } else {
            SHORTEST_GAP
        };
        Self { gap, ..self }
    }

    /// Scale of a motor with this torque per ampere, N m/A at the rotor, for drives that tell a current.
    #[must_use]
    pub const fn torque_constant(self, nm_per_a: f64) -> Self {
        Self {
            torque_constant: nm_per_a as f32,
            ..self
        }
    }
}

/// Rotor with the turns of its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rotor<N: Countable> {
    scale: RotorScale,
    zero: N::Angle,
    /// Joint from the zero: as measured while the drive is off, as commanded while it is on.
    winding: Winding,
    /// None until a position was heard.
    track: Option<RotorTrack>,
}

/// Positions of a drive up to the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RotorTrack {
    /// Turns from the zero that the drive's position lacks.
    offset: f32,
    /// Turns of the rotor from the zero at the last position.
    turns: f32,
    /// Turns per tick between the last two positions.
    pace: f32,
}

/// Motion of a joint, as its drive tells it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JointPlace<N: Countable> {
    winding: Winding,
    pub(super) angle: N::Angle,
}

impl<N: Countable> Rotor<N> {
    /// Rotor of a joint that stands at `angle`, near enough to tell what its drive does not know.
    pub(super) fn new(scale: RotorScale, angle: N::Angle) -> Self {
        let zero = N::angle_from_f64(scale.zero);
        Self {
            scale,
            zero,
            winding: Winding::near_zero::<N>(angle - zero),
            track: None,
        }
    }

    /// Returns true once a position was heard.
    #[inline(always)]
    pub(super) fn is_known(&self) -> bool {
        self.track.is_some()
    }

    /// Turns of the rotor from the zero.
    #[inline(always)]
    fn turns(&self) -> f32 {
        // Within half a turn of a whole one: a small angle must not be rounded like a whole turn.
        let part = self.winding.part as i32;
        let whole = self.winding.whole.wrapping_add(i32::from(part < 0));
        let turns = whole as f32 + part as f32 * (1.0 / 4_294_967_296.0);
        turns * self.scale.gear
    }

    /// Command that follows `motor`, the short way from the command before.
    #[inline(always)]
    pub(super) fn command(&mut self, motor: &Motor<N>) -> RotorCommand {
        self.winding = self.winding.after::<N>(motor.angle - self.zero);
        RotorCommand {
            position: self.turns() - self.track.map_or(0.0, |track| track.offset),
            velocity: motor.rate.to_f32() * self.scale.velocity,
            torque: motor.torque.to_f32() * self.scale.torque,
        }
    }

    /// Joint at the drive's `position`, turns, `age` ticks after the position before. Returns true with it if the drive has
    /// restarted, as far as positions tell: whole turns may be missing, and the joint is taken to be nearest to where it was.
    ///
    /// A position follows the last one at the pace of the two before it, by less than half a turn of the rotor off: a joint
    /// cannot do otherwise from one message to the next. Behind a gap that does not hold, for a hand or gravity moves a joint
    /// without torque.
    pub(super) fn measure(&mut self, position: f32, age: u16) -> (JointPlace<N>, bool) {
        let (track, restarts) = match &self.track {
            Some(track) => track.follow(position, age, &self.scale),
            None => (
                RotorTrack::begin(position, self.turns(), self.scale.absolute),
                false,
            ),
        };
        self.track = Some(track);
        let winding = Winding::of_turns(track.turns / self.scale.gear);
        let part = N::turn(self.zero).wrapping_add(winding.part);
        let place = JointPlace {
            winding,
            angle: N::angle_of(part),
        };
        (place, restarts)
    }

    /// Takes over a measured joint, from which the next command starts: for drives that are off.
    #[inline(always)]
    pub(super) fn stand(&mut self, measured: &JointPlace<N>) {
        self.winding = measured.winding;
    }

    /// Joint rate and torque of the motor at the joint, as the frame tells them; a part that it does not tell is
    /// none.
    pub(super) fn motion(&self, heard: &Heard) -> [Option<N>; 2] {
        let by_current = heard
            .current
            .filter(|_| self.scale.torque_constant > 0.0)
            .map(|current| current * self.scale.torque_constant);
        let torque = heard.torque.or(by_current);
        [
            heard
                .velocity
                .map(|velocity| N::from_f32(velocity / self.scale.velocity)),
            torque.map(|torque| N::from_f32(torque / self.scale.torque)),
        ]
    }

    /// Follows a new zero of the joint angle: it is greater `by` so much from now on, without a motion. The drive keeps
    /// its own.
    pub(super) fn shift(&mut self, by: N::Angle) {
        let part = N::turn(by);
        let turns = part as i32 as f32 * (1.0 / 4_294_967_296.0);
        if let Some(track) = &mut self.track {
            track.offset += turns * self.scale.gear;
            track.turns += turns * self.scale.gear;
        }
        self.winding = self.winding.turned(part as i32);
    }
}

impl RotorTrack {
    /// Track of a drive that is heard first, at `position`, with its joint near `turns`.
    fn begin(position: f32, turns: f32, absolute: Absolute) -> Self {
        let offset = match absolute {
            Absolute::Joint => 0.0,
            Absolute::Rotor => nearest(turns - position) as f32,
            Absolute::Nothing => turns - position,
        };
        Self {
            offset,
            turns: position + offset,
            pace: 0.0,
        }
    }

    /// Track after the next `position`, `age` ticks later. Returns true with it if the drive has restarted.
    fn follow(&self, position: f32, age: u16, scale: &RotorScale) -> (Self, bool) {
        let is_gap = age > scale.gap;
        let pace = if is_gap { 0.0 } else { self.pace };
        let ticks = f32::from(age);
        let expected = self.turns + pace * ticks;
        let missing = expected - (position + self.offset);
        let jumps = !(missing > -0.5 && missing < 0.5);
        let restarts = jumps || is_gap && scale.absolute != Absolute::Joint;
        if restarts {
            let offset = match scale.absolute {
                Absolute::Joint => self.offset,
                Absolute::Rotor => self.offset + nearest(missing) as f32,
                Absolute::Nothing => self.offset + missing,
            };
            let turns = position + offset;
            return (
                Self {
                    offset,
                    turns,
                    pace,
                },
                true,
            );
        }
        let turns = position + self.offset;
        let pace = match is_gap || age == 0 {
            true => pace,
            false => (turns - self.turns) / ticks,
        };
        let track = Self {
            offset: self.offset,
            turns,
            pace,
        };
        (track, false)
    }
}

/// Whole number nearest to `value`; the nearest that fits, and 0 for what is not a number.
fn nearest(value: f32) -> i32 {
    let half = if value < 0.0 { -0.5 } else { 0.5 };
    (value + half) as i32
}
