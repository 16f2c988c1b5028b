//! What drives the motors: commands held from sample to sample, or a controller that acts at
//! every instant.

use super::motor::{Motor, Winding, wrapped};
use super::refusal::Refusal;
use crate::evaluator::{self, Evaluator};
use trirrr_core::drive::bldc::DriveLimit;
use trirrr_core::setpoint::{Hermite, RestToRest, Segment, Setpoint};
use trirrr_scene::{Controller, Move, Scene};

/// What is measured of a motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// Angle at the joint, rad, in -pi to pi.
    pub angle: f64,
    /// Rate at the joint, rad/s.
    pub rate: f64,
}

/// What a sampled controller gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Commands {
    /// What each motor is told until the next sample: torque in N m, voltage in V, or the angle of
    /// the field in rad at the joint from where it started.
    pub held: [f64; 3],
    /// Where each joint should be at this instant, rad.
    pub angle: [f64; 3],
    /// The limit of each drive that acts.
    pub limited: [Option<DriveLimit>; 3],
    /// Where the platform should be (x, y, alpha), at the instants of ticks.
    pub tool: Option<[f64; 3]>,
}

/// A sampled controller.
pub trait SampledController: Send {
    /// Takes sample `tick` of the joint controller and gives what is held until the next.
    ///
    /// # Errors
    /// What ends the run.
    fn sample(&mut self, tick: u64, measured: &[Measured; 3]) -> Result<Commands, Refusal>;
}

/// Where a joint should be, with its rate and the torque that takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointReference {
    /// rad.
    pub angle: f64,
    /// rad/s.
    pub rate: f64,
    /// N m, rotors included.
    pub torque: f64,
}

/// A controller that acts at every instant, its setpoints at every instant of the job.
pub struct Continuous {
    segments: Vec<TimedSegment>,
    /// The segment under way; past the last, the end of the job is held.
    segment: usize,
    rest: Setpoint<f64>,
    evaluator: Box<dyn Evaluator<f64>>,
    controller: Controller,
    /// Which limit acts in each motor: a mode, switched by events.
    pub limited: [Limited; 3],
}

/// Limits that act in a motor, with the sign of what they limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limited {
    /// +1 or -1 where the current is limited.
    pub current: Option<f64>,
    /// +1 or -1 where the voltage is limited.
    pub voltage: Option<f64>,
}

struct TimedSegment {
    start: f64,
    end: f64,
    segment: Segment<f64>,
}

/// Margins of a motor's command: zero where a limit begins or ends to act, positive beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// i^2 / limit^2 - 1.
    pub current: f64,
    /// u^2 / supply^2 - 1.
    pub voltage: f64,
}

impl Continuous {
    /// The controller of `scene`, which follows its job from t = 0.
    ///
    /// # Errors
    /// A machine that the core refuses.
    pub fn build(scene: &Scene, controller: Controller) -> Result<Self, Refusal> {
        let evaluator = evaluator::build::<f64>(&scene.parameters)
            .map_err(|error| Refusal::Machine(error.to_string()))?;
        let period = scene.period_s();
        let mut tick = 0_u32;
        let mut timed = |each: &Move| {
            let start = f64::from(tick) / scene.tick_rate_hz;
            tick += each.duration_ticks;
            TimedSegment {
                start,
                end: f64::from(tick) / scene.tick_rate_hz,
                segment: segment(each, period),
            }
        };
        let segments: Vec<_> = scene.job.moves.iter().map(&mut timed).collect();
        let last = scene.job.moves.last();
        let zero = nalgebra::Vector3::zeros();
        Ok(Self {
            segments,
            segment: 0,
            rest: Setpoint {
                pose: last.map_or(scene.job.start, |last| last.to),
                velocity: zero,
                acceleration: zero,
            },
            evaluator,
            controller,
            limited: Default::default(),
        })
    }

    /// The setpoint at `t`, by the formula of the segment under way.
    pub fn setpoint(&self, t: f64) -> Setpoint<f64> {
        let Some(timed) = self.segments.get(self.segment) else {
            return self.rest;
        };
        let s = (t - timed.start) / (timed.end - timed.start);
        match &timed.segment {
            Segment::RestToRest(segment) => segment.at_fraction(s),
            Segment::Hermite(segment) => segment.at_fraction(s),
        }
    }

    /// When the segment under way ends; `None` after the last.
    pub fn segment_end(&self) -> Option<f64> {
        self.segments.get(self.segment).map(|timed| timed.end)
    }

    /// Goes on to the next segment.
    pub fn next_segment(&mut self) {
        self.segment += 1;
    }

    /// What the joints should do at `t`.
    ///
    /// # Errors
    /// [`Refusal::Setpoint`].
    pub fn references(&self, t: f64) -> Result<[JointReference; 3], Refusal> {
        let record = self
            .evaluator
            .evaluate(t, &self.setpoint(t))
            .map_err(Refusal::Setpoint)?;
        Ok(record.legs.map(|leg| JointReference {
            angle: leg.th1,
            rate: leg.dth1,
            torque: leg.torque,
        }))
    }

    /// Torque wanted of motor `index`, before any limit.
    #[inline]
    fn torque(&self, index: usize, reference: &JointReference, measured: &Measured) -> f64 {
        let controller = &self.controller;
        let fed = if controller.feed_forward {
            reference.torque
        } else {
            0.0
        };
        controller.kp_nm_rad[index] * wrapped(reference.angle - measured.angle)
            + controller.kd_nm_s_rad[index] * (reference.rate - measured.rate)
            + fed
    }

    /// What motor `index` is told, by the formula of the limits that act.
    #[inline]
    pub fn command(
        &self,
        index: usize,
        motor: &Motor,
        reference: &JointReference,
        measured: &Measured,
    ) -> f64 {
        let torque = self.torque(index, reference, measured);
        let Motor::Bldc(winding) = motor else {
            return torque;
        };
        let limited = &self.limited[index];
        match limited.voltage {
            Some(sign) => sign * winding.supply,
            None => voltage(winding, limited, torque, measured.rate),
        }
    }

    /// How far motor `index` is beyond its limits.
    pub fn margins(
        &self,
        index: usize,
        winding: &Winding,
        reference: &JointReference,
        measured: &Measured,
    ) -> Margins {
        let torque = self.torque(index, reference, measured);
        let current = torque / (winding.torque_constant * winding.current_limit);
        let voltage =
            voltage(winding, &self.limited[index], torque, measured.rate) / winding.supply;
        Margins {
            current: current * current - 1.0,
            voltage: voltage * voltage - 1.0,
        }
    }

    /// Switches the limit of the current of motor `index` on or off.
    pub fn toggle_current(
        &mut self,
        index: usize,
        reference: &JointReference,
        measured: &Measured,
    ) {
        let sign = self.torque(index, reference, measured).signum();
        let limited = &mut self.limited[index];
        limited.current = match limited.current {
            None => Some(sign),
            Some(_) => None,
        };
    }

    /// Switches the limit of the voltage of motor `index` on or off.
    pub fn toggle_voltage(
        &mut self,
        index: usize,
        winding: &Winding,
        reference: &JointReference,
        measured: &Measured,
    ) {
        let torque = self.torque(index, reference, measured);
        let sign = voltage(winding, &self.limited[index], torque, measured.rate).signum();
        let limited = &mut self.limited[index];
        limited.voltage = match limited.voltage {
            None => Some(sign),
            Some(_) => None,
        };
    }
}

/// u = R i + N Ke w with the current limited, the voltage not.
#[inline]
fn voltage(winding: &Winding, limited: &Limited, torque: f64, rate: f64) -> f64 {
    let current = match limited.current {
        Some(sign) => sign * winding.current_limit,
        None => torque / winding.torque_constant,
    };
    winding.resistance * current + winding.back_emf * rate
}

fn segment(each: &Move, period: f64) -> Segment<f64> {
    let ticks = each.duration_ticks;
    if each.is_rest_to_rest() {
        return Segment::RestToRest(RestToRest::new(each.from, each.to, ticks, period));
    }
    let (v0, v1) = (each.start_velocity, each.end_velocity);
    Segment::Hermite(Hermite::new(each.from, v0, each.to, v1, ticks, period))
}
