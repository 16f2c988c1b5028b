//! The worst instant of a move that is refused.
//!
//! The admission names the first instant at which a limit is broken, where it is broken by little. A user wants to know by how much
//! the move is beyond the limit in all.

use crate::job_move::JobMove;
use crate::pipeline::Pipeline;
use crate::record::Record;
use crate::words::{self, short};
use nalgebra::Vector3;
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::{Bounded, Violation};

/// Most instants of a move that are looked at.
const INSTANTS: u32 = 4096;

/// Part by which the worst value has to be beyond the first one to be worth a word.
const WORTH: f64 = 1e-3;

/// Value of the quantity that `found` is about: its size, at one instant.
fn value(found: &Violation<f64>, record: &Record) -> Option<f64> {
    let leg = found
        .index
        .and_then(|index| record.legs.get(usize::from(index)));
    match found.what {
        Bounded::Rate => leg.map(|leg| leg.dth1.abs()),
        Bounded::Acceleration => leg.map(|leg| leg.ddth1.abs()),
        Bounded::Torque => leg.map(|leg| leg.torque.abs()),
        Bounded::Power => leg.map(|leg| leg.power.abs()),
        Bounded::SerialDistance => leg.map(|leg| leg.serial),
        Bounded::ParallelDistance => Some(record.parallel),
        Bounded::Reach | Bounded::Range | Bounded::Jerk | Bounded::AccelerationJump => None,
    }
}

/// A move that is refused, and the machine without limits.
pub(crate) struct RefusedMove<'a> {
    pub(crate) each: &'a JobMove,
    pub(crate) period_s: f64,
    pub(crate) machine: &'a dyn Pipeline<f64>,
}

impl RefusedMove<'_> {
    /// Describes how far the move is beyond the limit at worst, with a semicolon before; empty where that is nothing new, or not known.
    pub(crate) fn worst(&self, found: &Violation<f64>) -> String {
        if found.ramp || !found.certain {
            return String::new();
        }
        let is_least = matches!(
            found.what,
            Bounded::SerialDistance | Bounded::ParallelDistance
        );
        let Some((t, worst)) = self.extreme(found, is_least, false) else {
            return String::new();
        };
        let (beyond, news) = match is_least {
            true => (worst < found.limit, worst < found.value * (1.0 - WORTH)),
            false => (worst > found.limit, worst > found.value * (1.0 + WORTH)),
        };
        let mut text = String::new();
        if beyond && news {
            text = format!(
                "; at worst {}{} at t = {} s",
                short(worst),
                words::unit(found.what),
                short(t)
            );
            if !is_least {
                text += &format!(", {} times as much as allowed", short(worst / found.limit));
            }
        }
        if found.what == Bounded::Torque
            && let Some((t, standing)) = self.extreme(found, false, true)
            && standing > found.limit
        {
            text += &format!(
                "; no duration helps: to stand where the move is at t = {} s takes {} N m",
                short(t),
                short(standing)
            );
        }
        text
    }

    /// Time and value of the extreme over the move, or over the poses of the move at rest.
    fn extreme(&self, found: &Violation<f64>, is_least: bool, at_rest: bool) -> Option<(f64, f64)> {
        let ticks = self.each.duration_ticks;
        let segment = self.each.segment::<f64>(ticks, self.period_s);
        let count = ticks.clamp(1, INSTANTS);
        let instants = (0..=count).filter_map(|instant| {
            let part = f64::from(instant) / f64::from(count);
            let mut setpoint: Setpoint<f64> = segment.at_fraction(part);
            if at_rest {
                setpoint.velocity = Vector3::zeros();
                setpoint.acceleration = Vector3::zeros();
            }
            let t = part * f64::from(ticks) * self.period_s;
            // Where the machine cannot be there is no value.
            let record = self.machine.evaluate(t, &setpoint).ok()?;
            Some((t, value(found, &record)?))
        });
        match is_least {
            true => instants.min_by(|a, b| a.1.total_cmp(&b.1)),
            false => instants.max_by(|a, b| a.1.total_cmp(&b.1)),
        }
    }
}
