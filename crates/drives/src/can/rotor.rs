//! From the joint to the rotor behind its gear, and from radians to turns.

use crate::command::count::Countable;
use crate::command::winding::Winding;
use trirrr_core::tick::Motor;

/// What a rotor has to do, as drives take it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorCommand {
    /// Position, turns.
    pub position: f32,
    /// Velocity, turns per second.
    pub velocity: f32,
    /// Torque of the rotor, N m, that the motion takes.
    pub torque: f32,
}

/// From a joint in a machine's own units to its rotor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorScale {
    /// Turns of the rotor per turn of the joint, negative where reversed.
    gear: f32,
    /// Turns per second of the rotor per unit of joint rate.
    velocity: f32,
    /// N m of the rotor per unit of joint torque.
    torque: f32,
    /// The joint angle at which the drive's position is 0, turns.
    zero: f64,
}

impl RotorScale {
    /// A gear of `gear_ratio` turns of the rotor per turn of the joint, `reversed` or not; the drive's
    /// position is 0 at joint angle `zero_rad`. A unit of rate is `rate_rad_s`, a unit of torque
    /// `torque_nm`: both 1 for the float types.
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
            zero: zero_rad,
        }
    }
}

/// A rotor, with the turns of its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rotor<N: Countable> {
    scale: RotorScale,
    zero: N::Angle,
    /// From the zero.
    winding: Winding,
}

impl<N: Countable> Rotor<N> {
    pub(super) fn new(scale: RotorScale, angle: N::Angle) -> Self {
        let zero = N::angle_from_f64(scale.zero);
        Self {
            scale,
            zero,
            winding: Winding::near_zero::<N>(angle - zero),
        }
    }

    #[inline(always)]
    pub(super) fn command(&mut self, motor: &Motor<N>) -> RotorCommand {
        self.winding = self.winding.after::<N>(motor.angle - self.zero);
        // Within half a turn of a whole one, so that what is near 0 is not rounded as a turn is.
        let part = self.winding.part as i32;
        let whole = self.winding.whole.wrapping_add(i32::from(part < 0));
        let turns = whole as f32 + part as f32 * (1.0 / 4_294_967_296.0);
        RotorCommand {
            position: turns * self.scale.gear,
            velocity: motor.rate.to_f32() * self.scale.velocity,
            torque: motor.torque.to_f32() * self.scale.torque,
        }
    }
}
