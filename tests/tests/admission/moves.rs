//! Random moves on random machines, with limits about what they need.

use crate::dense::{Density, extremes};
use crate::judge::Setting;
use core::f64::consts::TAU;
use nalgebra::Vector3;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{AnyMove, Move};
use trirrr_scene::{Job, JobMove, Scene};
use trirrr_service::paces::Ramp;
use trirrr_tests::draw::Draw;
use trirrr_tests::random::Case;

/// A move on a machine with limits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Offer {
    pub(crate) setting: Setting,
    pub(crate) offered: AnyMove<f64>,
}

/// A random move from where `case` stands: of 1/300 to 3/5 of the machine's size, from
/// rest to rest or not, in 10 to 1000 ticks.
pub(crate) fn random_move(case: &Case, draw: &mut Draw) -> (Move<f64>, f64, u16) {
    let size = case.size * draw.log_within(0.003, 0.6);
    let direction = draw.within(0.0, TAU);
    let turn = draw.within(-1.0, 1.0) * size / case.size;
    let step = [size * direction.cos(), size * direction.sin(), turn];
    let from = case.setpoint.pose;
    let ticks = draw.log_within(10.0, 1000.0) as u32;
    // The machine's natural time is a second, whatever its size: speeds go with the size.
    let duration = draw.log_within(0.1, 10.0);
    let ramp_ticks = (f64::from(ticks) * draw.log_within(0.03, 3.0)).max(1.0) as u16;
    let rest = draw.chance(0.5);
    let mut velocity = |end: bool| {
        if rest || (end && draw.chance(0.3)) {
            return [0.0; 3];
        }
        step.map(|step| step / duration * draw.within(-0.5, 2.0))
    };
    let offered = Move {
        number: 0,
        from,
        to: Pose::from_f64(
            from.position.x + step[0],
            from.position.y + step[1],
            from.angle + step[2],
        ),
        start_velocity: velocity(false),
        end_velocity: velocity(true),
        ticks,
        tool_power: 0.0,
        tool_speed: 0.0,
    };
    (offered, duration / f64::from(ticks), ramp_ticks)
}

/// `offered` as a quintic, with accelerations about those that a cubic has.
pub(crate) fn bent(offered: &Move<f64>, period_s: f64, draw: &mut Draw) -> AnyMove<f64> {
    let way = offered.from.displacement(&offered.to);
    let duration = f64::from(offered.ticks) * period_s;
    let mut acceleration = || {
        if draw.chance(0.3) {
            return [0.0; 3];
        }
        let each = way.map(|way| way / (duration * duration) * draw.within(-6.0, 6.0));
        each.into()
    };
    AnyMove::new(*offered, Some([acceleration(), acceleration()]))
}

/// The move in another number type.
pub(crate) fn in_type<N: Number>(offered: &AnyMove<f64>) -> AnyMove<N> {
    let accelerations = offered.accelerations();
    let accelerations = accelerations.map(|both| both.map(|one| one.map(N::from_f64)));
    let offered = offered.common();
    let pose = |pose: &Pose<f64>| Pose::from_f64(pose.position.x, pose.position.y, pose.angle);
    let common = Move {
        number: offered.number,
        from: pose(&offered.from),
        to: pose(&offered.to),
        start_velocity: offered.start_velocity.map(N::from_f64),
        end_velocity: offered.end_velocity.map(N::from_f64),
        ticks: offered.ticks,
        tool_power: N::from_f64(offered.tool_power),
        tool_speed: N::from_f64(offered.tool_speed),
    };
    AnyMove::new(common, accelerations)
}

/// The very move as numbers.
pub(crate) fn in_f64<N: Number>(offered: &AnyMove<N>) -> AnyMove<f64> {
    let accelerations = offered.accelerations();
    let accelerations = accelerations.map(|both| both.map(|one| one.map(N::to_f64)));
    let offered = offered.common();
    let pose = |pose: &Pose<N>| Pose {
        position: pose.position.map(N::to_f64),
        angle: N::angle_to_f64(pose.angle),
    };
    let common = Move {
        number: offered.number,
        from: pose(&offered.from),
        to: pose(&offered.to),
        start_velocity: offered.start_velocity.map(N::to_f64),
        end_velocity: offered.end_velocity.map(N::to_f64),
        ticks: offered.ticks,
        tool_power: offered.tool_power.to_f64(),
        tool_speed: offered.tool_speed.to_f64(),
    };
    AnyMove::new(common, accelerations)
}

impl Offer {
    /// The offer in units in which `N` holds its machine, limits and move, as a scene with this job would run in
    /// them, with limits that are numbers of `N`; `None` where there are none.
    pub(crate) fn in_type<N: Number>(&self, thesis: &Scene) -> Option<(Setting, AnyMove<N>)> {
        let (setting, offered) = (&self.setting, self.offered.common());
        let velocity = |velocity: [f64; 3]| Vector3::from(velocity);
        let only = JobMove {
            from: offered.from,
            to: offered.to,
            start_velocity: velocity(offered.start_velocity),
            end_velocity: velocity(offered.end_velocity),
            accelerations: self
                .offered
                .accelerations()
                .map(|both| both.map(Into::into)),
            duration_ticks: offered.ticks,
            tool: None,
        };
        let scene = Scene {
            parameters: setting.parameters,
            limits: setting.limits,
            tick_rate_hz: 1.0 / setting.period_s,
            job: Job::of(offered.from, vec![only]),
            ..thesis.clone()
        };
        let units = trirrr_scene::units::<N>(&scene).ok()?;
        let mut limits = units.limits(&setting.limits);
        let number = |value: &mut f64| *value = N::from_f64(*value).to_f64();
        for values in [
            &mut limits.rate_rad_s,
            &mut limits.acceleration_rad_s2,
            &mut limits.torque_nm,
            &mut limits.power_w,
            &mut limits.jerk_rad_s3,
        ] {
            values.iter_mut().flatten().for_each(number);
        }
        number(&mut limits.serial_distance_min);
        number(&mut limits.parallel_distance_min);
        Limits::<N>::build(&limits).ok()?;
        let parameters = units.parameters(&setting.parameters);
        parameters.check::<N>().ok()?;
        let only = &scene.job.in_units(&units).moves[0];
        let common = Move {
            from: only.from,
            to: only.to,
            start_velocity: only.start_velocity.into(),
            end_velocity: only.end_velocity.into(),
            ..*offered
        };
        let accelerations = only.accelerations.map(|both| both.map(Into::into));
        let offered = AnyMove::new(common, accelerations);
        let setting = Setting {
            parameters,
            limits,
            period_s: units.time(setting.period_s),
            ..*setting
        };
        Some((setting, in_type(&offered)))
    }
}

/// `value` times a factor about one: as often far from it as near, down to `nearest`.
fn about(value: f64, nearest: f64, draw: &mut Draw) -> f64 {
    let away = draw.log_within(nearest, 1.0);
    // Larger limits are kept, smaller ones broken: with up to four of them, mostly larger.
    if draw.chance(0.93) {
        value * (1.0 + away)
    } else {
        value / (1.0 + away)
    }
}

/// A cubic with limits about its extremes, each there or not, and as near as `nearest` of them.
pub(crate) fn offer(case: &Case, draw: &mut Draw, density: Density, nearest: f64) -> Offer {
    let (offered, period_s, ramp_ticks) = random_move(case, draw);
    limited(
        case,
        (&offered).into(),
        period_s,
        ramp_ticks,
        draw,
        density,
        nearest,
    )
}

/// As [`offer`], a quintic.
pub(crate) fn offer_quintic(case: &Case, draw: &mut Draw, density: Density, nearest: f64) -> Offer {
    let (offered, period_s, ramp_ticks) = random_move(case, draw);
    let offered = bent(&offered, period_s, draw);
    limited(case, offered, period_s, ramp_ticks, draw, density, nearest)
}

fn limited(
    case: &Case,
    offered: AnyMove<f64>,
    period_s: f64,
    ramp_ticks: u16,
    draw: &mut Draw,
    density: Density,
    nearest: f64,
) -> Offer {
    let mut setting = Setting {
        parameters: case.parameters,
        limits: LimitParameters {
            serial_distance_min: 0.01,
            parallel_distance_min: 0.01,
            ..LimitParameters::default()
        },
        ramp: Ramp::fixed(ramp_ticks),
        period_s,
    };
    let extremes = extremes(&setting, offered, density);
    if extremes.possible {
        let mut motors = |values: [f64; 3]| {
            let good = values.iter().all(|&value| value > 0.0);
            (good && draw.chance(0.6)).then(|| values.map(|value| about(value, nearest, draw)))
        };
        setting.limits.rate_rad_s = motors(extremes.rate);
        setting.limits.acceleration_rad_s2 = motors(extremes.acceleration);
        setting.limits.torque_nm = motors(extremes.torque);
        setting.limits.power_w = motors(extremes.power);
        let mut distance = |value: f64| (1.0 / about(1.0 / value, nearest, draw)).min(0.999);
        setting.limits.serial_distance_min = distance(extremes.least_serial());
        setting.limits.parallel_distance_min = distance(extremes.parallel);
    }
    Offer { setting, offered }
}
