//! From the joint to the rotor behind its gear, and from radians to turns.

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
}

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
            zero: zero_rad,
        }
    }
}

/// Rotor with the turns of its joint.
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
        // Within half a turn of a whole one: a small angle must not be rounded like a whole turn.
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
