//! Random machines with limits, and random targets.

use core::f64::consts::TAU;
use nalgebra::Vector3;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::Parameters;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_tests::draw::Draw;
use trirrr_tests::instant::{Coordinates, Instant, State};
use trirrr_tests::random::Case;
use trirrr_tests::workspace::{Workspace, machine};

/// A machine with limits, and a pose to start from.
#[derive(Clone)]
pub(crate) struct Setting {
    pub(crate) parameters: Parameters,
    pub(crate) limits: LimitParameters,
    pub(crate) period_s: f64,
    pub(crate) start: Coordinates,
    pub(crate) turn: f64,
    pub(crate) reach: f64,
    /// Side of the parallel singularity at the start.
    pub(crate) side: bool,
}

pub(crate) fn setpoint(state: &State) -> Setpoint<f64> {
    let [x, y, alpha] = state.pose;
    Setpoint {
        pose: Pose::from_f64(x, y, alpha),
        velocity: Vector3::from(state.velocity),
        acceleration: Vector3::from(state.acceleration),
    }
}

impl Setting {
    /// Draws limits for a machine; none where it cannot stand at its start.
    pub(crate) fn draw(case: &Case, draw: &mut Draw) -> Option<Self> {
        let (parameters, start, turn) = machine(case, draw);
        let reach = parameters
            .legs
            .iter()
            .map(|leg| leg.proximal_m + leg.distal_m)
            .fold(f64::INFINITY, f64::min);
        let torque = |acceleration: Coordinates| {
            let state = State {
                pose: start,
                acceleration,
                ..State::default()
            };
            Instant::of(&parameters, &state)
                .torque
                .map(f64::abs)
                .into_iter()
                .fold(0.0, f64::max)
        };
        let size = reach * draw.log_within(2.0, 100.0);
        let standing = torque([0.0; 3]);
        let moving = torque([size, size, 0.0]).max(torque([size, -size, 0.0]));
        let torque = standing * draw.within(1.0, 3.0) + moving;
        let each = |draw: &mut Draw, value: f64| {
            [0; 3].map(|_| {
                value
                    * if draw.chance(0.3) {
                        draw.within(1.0, 2.0)
                    } else {
                        1.0
                    }
            })
        };
        let mut limits = LimitParameters {
            serial_distance_min: draw.log_within(0.01, 0.15),
            parallel_distance_min: draw.log_within(0.01, 0.15),
            ..LimitParameters::default()
        };
        if draw.chance(0.8) {
            let rate = draw.log_within(0.3, 20.0);
            limits.rate_rad_s = Some(each(draw, rate));
        }
        if draw.chance(0.6) {
            let acceleration = draw.log_within(3.0, 300.0);
            limits.acceleration_rad_s2 = Some(each(draw, acceleration));
        }
        if torque > 0.0 && draw.chance(0.6) {
            limits.torque_nm = Some(each(draw, torque));
        }
        if torque > 0.0 && draw.chance(0.2) {
            let power = torque * draw.log_within(0.3, 10.0);
            limits.power_w = Some(each(draw, power));
        }
        let at_rest = State {
            pose: start,
            ..State::default()
        };
        let setting = Self {
            parameters,
            limits,
            period_s: draw.log_within(1e-4, 1e-2),
            start,
            turn,
            reach,
            side: Instant::of(&parameters, &at_rest).side,
        };
        (setting.part(&at_rest) < 0.9).then_some(setting)
    }

    /// Largest part of a limit in this state, or at rest in its pose.
    pub(crate) fn part(&self, state: &State) -> f64 {
        let at_rest = State {
            pose: state.pose,
            ..State::default()
        };
        [state, &at_rest]
            .map(|state| Instant::of(&self.parameters, state).part_of(&self.limits, self.side))
            .into_iter()
            .fold(0.0, f64::max)
    }

    /// A target about `from`, somewhere in the workspace or anywhere.
    pub(crate) fn target(&self, from: Coordinates, draw: &mut Draw) -> State {
        let workspace = Workspace {
            parameters: &self.parameters,
            serial_min: self.limits.serial_distance_min,
            parallel_min: self.limits.parallel_distance_min,
            side: self.side,
        };
        let anywhere = draw.chance(0.1);
        let mut pose = from;
        for _ in 0..20 {
            let size = self.reach * draw.log_within(0.001, 0.6);
            let heading = draw.within(0.0, TAU);
            let turn = match draw.chance(0.3) {
                true => 0.0,
                false => self.turn * draw.within(-1.0, 1.0) * (size / self.reach * 4.0).min(1.0),
            };
            let next = [
                from[0] + size * heading.cos(),
                from[1] + size * heading.sin(),
                from[2] + turn,
            ];
            if anywhere || workspace.holds(next) {
                pose = next;
                break;
            }
        }
        let mut vector = |part: f64, speed: f64| match draw.chance(part) {
            true => {
                let heading = draw.within(0.0, TAU);
                let turn = draw.within(-1.0, 1.0) * speed;
                [
                    self.reach * speed * heading.cos(),
                    self.reach * speed * heading.sin(),
                    turn,
                ]
            }
            false => [0.0; 3],
        };
        let velocity = vector(0.3, 0.3);
        let acceleration = match velocity == [0.0; 3] {
            true => [0.0; 3],
            false => vector(0.3, 1.0),
        };
        // As fast as it may be there, at most.
        let mut target = State {
            pose,
            velocity,
            acceleration,
        };
        for _ in 0..40 {
            if self.part(&target) < 0.9 || anywhere {
                break;
            }
            target.velocity = target.velocity.map(|v| 0.7 * v);
            target.acceleration = target.acceleration.map(|a| 0.5 * a);
        }
        target
    }
}
