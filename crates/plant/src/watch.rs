//! Events of a plant: the instants at which its equations change, and those at which its run ends.

use crate::friction::Friction;
use crate::motor::MotorModel;
use std::fmt;

/// One function of time and state that is watched for its zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Watch {
    /// det A: the motors cannot hold the platform.
    Parallel,
    /// A leg is stretched or folded.
    Serial(usize),
    /// A leg is so near to that that its angles become coordinates of the state.
    Lead(usize),
    /// The leg that leads is far from that again.
    Release,
    /// The move under way ends.
    MoveEnd,
    /// The rate of a joint leaves or enters its stick region.
    Stick {
        /// 0 motor, 1 elbow, 2 platform.
        kind: usize,
        /// The leg.
        leg: usize,
        /// Edge of the region, +1 or -1.
        side: f64,
    },
    /// The current of a motor reaches or leaves its limit.
    Current(usize),
    /// The voltage of a motor reaches or leaves its limit.
    Voltage(usize),
    /// The following error of a joint reaches its limit.
    FollowingError(usize),
    /// A stepper falls to another position of its field.
    Slip(usize),
}

/// Instant and cause of a run that the plant ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ending {
    /// Instant, s.
    pub t: f64,
    /// Cause.
    pub cause: Cause,
}

/// Cause that ends a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// det A changed its sign.
    Parallel,
    /// A leg is stretched or folded.
    Serial(usize),
    /// A joint is too far from where it should be.
    FollowingError {
        /// The leg.
        leg: usize,
        /// The limit, rad.
        limit: f64,
    },
}

impl Cause {
    /// Returns `true` for singularities of the machine.
    pub(crate) fn is_singularity(self) -> bool {
        matches!(self, Cause::Parallel | Cause::Serial(_))
    }
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let t = self.t;
        match self.cause {
            Cause::Parallel => write!(
                f,
                "the machine passes a parallel singularity at t = {t:.6} s"
            ),
            Cause::Serial(leg) => {
                write!(f, "leg {} is stretched or folded at t = {t:.6} s", leg + 1)
            }
            Cause::FollowingError { leg, limit } => write!(
                f,
                "the following error of joint {} reaches {limit} rad at t = {t:.6} s",
                leg + 1
            ),
        }
    }
}

const JOINTS: [&str; 3] = ["motor joint", "elbow", "platform joint"];

impl fmt::Display for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Watch::Parallel => f.write_str("the parallel singularity"),
            Watch::Serial(leg) => write!(f, "the stretch of leg {}", leg + 1),
            Watch::Lead(leg) => write!(f, "the approach to the stretch of leg {}", leg + 1),
            Watch::Release => f.write_str("the way back from the stretch of a leg"),
            Watch::MoveEnd => f.write_str("the end of a move"),
            Watch::Stick { kind, leg, .. } => {
                write!(f, "sticking of the {} of leg {}", JOINTS[kind], leg + 1)
            }
            Watch::Current(leg) => write!(f, "the current limit of motor {}", leg + 1),
            Watch::Voltage(leg) => write!(f, "the voltage limit of motor {}", leg + 1),
            Watch::FollowingError(leg) => write!(f, "the following error of joint {}", leg + 1),
            Watch::Slip(leg) => write!(f, "a slip of motor {}", leg + 1),
        }
    }
}

/// Lists the events of a plant with these motors and this friction in its joints. A controller
/// `continuous` in time changes its equations between samples; `following` limits its error.
pub(crate) fn list(
    friction: &[Option<Friction>; 3],
    motors: &[MotorModel; 3],
    continuous: bool,
    following: bool,
) -> Vec<Watch> {
    let mut watches = vec![
        Watch::Parallel,
        Watch::Serial(0),
        Watch::Serial(1),
        Watch::Serial(2),
        Watch::Lead(0),
        Watch::Lead(1),
        Watch::Lead(2),
        Watch::Release,
    ];
    for (kind, joint) in friction.iter().enumerate() {
        // Viscous friction alone has one formula at every rate.
        if !joint.is_some_and(|joint| joint.coulomb > 0.0) {
            continue;
        }
        for leg in 0..3 {
            watches.extend([1.0, -1.0].map(|side| Watch::Stick { kind, leg, side }));
        }
    }
    if continuous {
        watches.push(Watch::MoveEnd);
    }
    for (leg, motor) in motors.iter().enumerate() {
        match motor {
            MotorModel::Bldc(_) if continuous => {
                watches.extend([Watch::Current(leg), Watch::Voltage(leg)]);
            }
            MotorModel::Stepper(_) => watches.push(Watch::Slip(leg)),
            _ => {}
        }
        // A sampled controller reads the error at its samples.
        if continuous && following {
            watches.push(Watch::FollowingError(leg));
        }
    }
    watches
}
