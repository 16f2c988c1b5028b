//! The dense check: the tick itself, at so many instants of a move, with the setpoints of normal
//! speed and of holds, stops and resumes.

use crate::judge::Setting;
use trirrr_core::model::{Model, ModelVisitor};
use trirrr_core::setpoint::{Ends, Quintics, Segment, Setpoint};
use trirrr_core::singularity::{Distances, det_a};
use trirrr_core::status::Status;
use trirrr_core::tick::Tick;
use trirrr_protocol::message::AnyMove;
use trirrr_service::admission::Enclose;
use trirrr_service::paces::{MovePaces, Pace};

/// How closely a move is looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Density {
    /// Intervals; both ends of each are evaluated.
    pub(crate) samples: u32,
    /// Speeds between rest and normal at each: those of the greatest powers, or many.
    pub(crate) every_speed: bool,
}

/// The largest sizes, or least distances, at one instant or all along.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extremes {
    /// Within reach, and det A never changes its sign.
    pub(crate) possible: bool,
    /// Within the range of the number type, on every ramp.
    pub(crate) in_range: bool,
    pub(crate) serial: [f64; 3],
    pub(crate) parallel: f64,
    pub(crate) rate: [f64; 3],
    pub(crate) acceleration: [f64; 3],
    pub(crate) torque: [f64; 3],
    pub(crate) power: [f64; 3],
}

impl Extremes {
    const NONE: Self = Self {
        possible: true,
        in_range: true,
        serial: [f64::INFINITY; 3],
        parallel: f64::INFINITY,
        rate: [0.0; 3],
        acceleration: [0.0; 3],
        torque: [0.0; 3],
        power: [0.0; 3],
    };

    /// Takes in what the tick computes for `setpoint` at the pace `u` that changes by `slope`; the torques.
    fn add<N: Enclose, M: Model<N = N>>(
        &mut self,
        tick: &Tick<M>,
        setpoint: &Setpoint<N>,
        u: f64,
        slope: f64,
    ) -> [f64; 3] {
        // A factor: in the units of fixed point a ramp is steeper than what they hold.
        let (u, slope) = (N::from_f64(u), N::factor_from_f64(slope));
        let scaled = Setpoint {
            pose: setpoint.pose,
            velocity: setpoint.velocity * u,
            acceleration: setpoint.acceleration * (u * u)
                + setpoint.velocity.map(|v| v.scaled(slope)),
        };
        let motion = match tick.evaluate(&scaled) {
            Ok(motion) => motion,
            Err(status) => {
                self.possible = false;
                self.in_range &= status != Status::OutOfRange;
                return [0.0; 3];
            }
        };
        for (leg, motor) in motion.motors.iter().enumerate() {
            let raise = |greatest: &mut f64, value: f64| *greatest = greatest.max(value.abs());
            raise(&mut self.rate[leg], motor.rate.to_f64());
            raise(&mut self.acceleration[leg], motor.acceleration.to_f64());
            raise(&mut self.torque[leg], motor.torque.to_f64());
            raise(&mut self.power[leg], (motor.torque * motor.rate).to_f64());
        }
        motion.motors.map(|motor| motor.torque.to_f64())
    }

    fn join(&mut self, other: &Self) {
        self.possible &= other.possible;
        self.in_range &= other.in_range;
        self.parallel = self.parallel.min(other.parallel);
        for leg in 0..3 {
            self.serial[leg] = self.serial[leg].min(other.serial[leg]);
            self.rate[leg] = self.rate[leg].max(other.rate[leg]);
            self.acceleration[leg] = self.acceleration[leg].max(other.acceleration[leg]);
            self.torque[leg] = self.torque[leg].max(other.torque[leg]);
            self.power[leg] = self.power[leg].max(other.power[leg]);
        }
    }

    /// The least of the three.
    pub(crate) fn least_serial(&self) -> f64 {
        self.serial.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// By how much, relative to the limit, the limit that is exceeded furthest is exceeded;
    /// negative where all are kept.
    pub(crate) fn excess(&self, setting: &Setting) -> f64 {
        if !self.possible {
            return f64::INFINITY;
        }
        let limits = &setting.limits;
        let mut excess = f64::NEG_INFINITY;
        for (limit, values) in [
            (limits.rate_rad_s, self.rate),
            (limits.acceleration_rad_s2, self.acceleration),
            (limits.torque_nm, self.torque),
            (limits.power_w, self.power),
        ] {
            for (limit, value) in limit.iter().flatten().zip(values) {
                excess = excess.max(value / limit - 1.0);
            }
        }
        for (limit, value) in [
            (limits.serial_distance_min, self.least_serial()),
            (limits.parallel_distance_min, self.parallel),
        ] {
            if limit > 0.0 {
                excess = excess.max(1.0 - value / limit);
            }
        }
        excess
    }
}

/// The move as the tick plays it.
pub(crate) fn segment<N: Enclose>(
    offered: impl Into<AnyMove<N>>,
    period_s: f64,
) -> Segment<N, Quintics> {
    let offered = offered.into();
    let common = offered.common();
    let ends = Ends {
        from: common.from,
        to: common.to,
        velocities: [common.start_velocity, common.end_velocity].map(Into::into),
        accelerations: offered.accelerations(),
    };
    Segment::new(&ends, common.ticks, N::factor_from_f64(period_s))
}

/// The extremes of a move.
pub(crate) fn extremes<N: Enclose>(
    setting: &Setting,
    offered: impl Into<AnyMove<N>>,
    density: Density,
) -> Extremes {
    let mut found = Extremes::NONE;
    visit(setting, offered, density, &mut |_, at| {
        found.join(at);
        at.possible
    });
    found
}

/// Calls `visitor` with the fraction of the move and the extremes there, as long as it returns true.
pub(crate) fn visit<N: Enclose>(
    setting: &Setting,
    offered: impl Into<AnyMove<N>>,
    density: Density,
    visitor: &mut Visitor<'_>,
) {
    setting.kind().visit(Visit {
        setting,
        offered: offered.into(),
        density,
        visitor,
    });
}

type Visitor<'v> = dyn FnMut(f64, &Extremes) -> bool + 'v;

struct Visit<'a, 'v, N: Enclose> {
    setting: &'a Setting,
    offered: AnyMove<N>,
    density: Density,
    visitor: &'a mut Visitor<'v>,
}

impl<N: Enclose> ModelVisitor<N> for Visit<'_, '_, N> {
    type Output = ();

    fn visit<M: Model<N = N>>(self) {
        with::<N, M>(self.setting, &self.offered, self.density, self.visitor);
    }
}

fn with<N: Enclose, M: Model<N = N>>(
    setting: &Setting,
    offered: &AnyMove<N>,
    density: Density,
    visitor: &mut Visitor<'_>,
) {
    let tick = Tick::<M>::build(setting.kind().with(&setting.parameters)).expect("a good machine");
    let distances = Distances::<N>::build(&setting.parameters);
    let segment = segment(offered, setting.period_s);
    let ramp = 1.0 / (f64::from(setting.ramp.ticks) * setting.period_s);
    let mut side = None;
    for sample in 0..=density.samples {
        let setpoint = segment.at_fraction(N::ratio(sample, density.samples));
        let mut at = Extremes::NONE;
        let mut evaluate = |u: f64, slope: f64| at.add(&tick, &setpoint, u, slope);
        evaluate(1.0, 0.0);
        for slope in [ramp, -ramp] {
            let fast = evaluate(1.0, slope);
            let slow = evaluate(0.0, slope);
            // On a ramp the power at the speed u is w u (slow (1 - u^2) + fast u^2), with w the rate at
            // normal speed: greatest where slow = 3 (slow - fast) u^2, if not at the end.
            for (slow, fast) in slow.into_iter().zip(fast) {
                let squared = slow / (3.0 * (slow - fast));
                if (0.0..1.0).contains(&squared) {
                    evaluate(squared.sqrt(), slope);
                }
            }
        }
        if density.every_speed {
            for speed in 0..100 {
                for slope in [ramp, -ramp] {
                    evaluate(f64::from(speed) / 100.0, slope);
                }
            }
        }
        match tick.geometry().position(&setpoint.pose) {
            Ok(position) => {
                at.serial = distances.serial(&position).map(N::to_f64);
                at.parallel = distances.parallel(&position).to_f64();
                let positive = det_a(&position) > N::ZERO;
                at.possible &= *side.get_or_insert(positive) == positive;
            }
            Err(_) => at.possible = false,
        }
        if !visitor(f64::from(sample) / f64::from(density.samples), &at) {
            return;
        }
    }
}

/// The extremes of a move at the rates of `paces`, at paces from rest to normal speed, at so many instants.
pub(crate) fn visit_paced(
    setting: &Setting,
    offered: &AnyMove<f64>,
    paces: &MovePaces,
    samples: u32,
) -> Extremes {
    setting.kind().visit(VisitPaced {
        setting,
        offered,
        paces,
        samples,
    })
}

struct VisitPaced<'a> {
    setting: &'a Setting,
    offered: &'a AnyMove<f64>,
    paces: &'a MovePaces,
    samples: u32,
}

impl ModelVisitor<f64> for VisitPaced<'_> {
    type Output = Extremes;

    fn visit<M: Model<N = f64>>(self) -> Extremes {
        let setting = self.setting;
        let tick =
            Tick::<M>::build(setting.kind().with(&setting.parameters)).expect("a good machine");
        let segment = segment(*self.offered, setting.period_s);
        let ramp = 1.0 / (f64::from(setting.ramp.ticks) * setting.period_s);
        let ticks = self.offered.common().ticks;
        let mut found = Extremes::NONE;
        for sample in 0..=self.samples {
            let at = f64::from(sample) / f64::from(self.samples);
            let setpoint = segment.at_fraction(at);
            let whole = ((at * f64::from(ticks)) as u32).min(ticks - 1);
            let pace = self.paces.at(ticks, whole);
            for percent in 0..=50 {
                let u = f64::from(percent) / 50.0;
                let rate = |[rest, normal]: [u8; 2]| {
                    let (rest, normal) = (f64::from(rest), f64::from(normal));
                    ramp * (rest + (normal - rest) * u * u) / f64::from(Pace::LEVELS)
                };
                for slope in [0.0, -rate(pace.slower), rate(pace.faster)] {
                    found.add(&tick, &setpoint, u, slope);
                }
            }
        }
        found
    }
}
