//! Checks that a machine can be homed from its start pose, and come back there: the chain is
//! followed by forward kinematics, motor angles first.

use crate::Scene;
use crate::homing::PlacedHoming;
use crate::read::{Document, Place};
use crate::words::short;
use core::f64::consts::{PI, TAU};
use trirrr_core::forward::{Forward, Track, Tracker};
use trirrr_core::machine::Geometry;
use trirrr_core::number::Arithmetic;
use trirrr_core::singularity::Distances;
use trirrr_service::features::{Contact, HomingMotor};

/// Longest way of a motor between two looks, rad.
const STEP_RAD: f64 = 0.01;

/// Parts that a look may be divided into.
const MOST_PARTS: u32 = 64;

/// A machine whose motors are moved.
struct Chain<'s> {
    scene: &'s Scene,
    geometry: Geometry<f64>,
    distances: Distances<f64>,
    tracker: Tracker<f64>,
    /// Angles of the motors, rad, not wrapped.
    angles: [f64; 3],
    /// Track of the platform.
    track: Track<f64>,
}

/// Refuses homing whose way, from the start pose to the references and back, the machine cannot go.
pub(crate) fn check_homing(
    document: &Document,
    scene: &Scene,
    placed: &PlacedHoming,
    geometry: Geometry<f64>,
) {
    let start = scene.job.start;
    let Ok(position) = geometry.position(&start) else {
        return;
    };
    let angles = geometry.motor_angles(&position);
    let forward = Forward::build(&scene.parameters, &geometry);
    let tracker = Tracker::new(forward, scene.limits.parallel_distance_min, MOST_PARTS);
    let Ok(track) = tracker.start(&angles, start) else {
        return;
    };
    let mut chain = Chain {
        scene,
        geometry,
        distances: Distances::build(&scene.parameters),
        tracker,
        angles,
        track,
    };
    if let Err((place, reason)) = chain.home(placed, angles) {
        document.refuse(place, reason);
    }
}

impl Chain<'_> {
    fn home<'p>(
        &mut self,
        placed: &'p PlacedHoming,
        start: [f64; 3],
    ) -> Result<(), (&'p Place, String)> {
        let homing = &placed.homing;
        let place = &placed.angles;
        let rate = self.scene.tick_rate_hz;
        for stage in 0..3 {
            let mut ways = [0.0; 3];
            let mut back = [0.0; 3];
            for (i, motor) in homing.motors.iter().enumerate() {
                if motor.stage != stage {
                    continue;
                }
                let sign = motor.sign();
                let way = (sign * (motor.angle_rad - self.angles[i])).rem_euclid(TAU);
                if way > motor.travel_max_rad {
                    let reason = format!(
                        "the reference of motor {} is {} rad from the start pose, which is more",
                        i + 1,
                        short(way)
                    );
                    return Err((&placed.travel, reason));
                }
                let overrun = match homing.contact {
                    Contact::Switch => {
                        motor.overrun_rad(homing.contact, homing.debounce_ticks, 1.0 / rate)
                    }
                    Contact::Stall | Contact::Torque | Contact::Unfelt => 0.0,
                };
                ways[i] = sign * (way + overrun);
                back[i] = -sign * (motor.back_off_rad + overrun);
            }
            let at = |text| format!("{text} (sequence {})", stage + 1);
            self.run(&homing.motors, ways, &at("on the way to the references"))
                .map_err(|reason| (place, reason))?;
            self.go(back, &at("on the way back from the references"))
                .map_err(|reason| (place, reason))?;
        }
        let home = [0, 1, 2].map(|i| {
            let way = (start[i] - self.angles[i]).rem_euclid(TAU);
            if way > PI { way - TAU } else { way }
        });
        self.go(home, "on the way from the references to the start pose")
            .map_err(|reason| (place, reason))
    }

    /// The motors move by `ways`, each at its own rate until it is there.
    fn run(&mut self, motors: &[HomingMotor; 3], ways: [f64; 3], when: &str) -> Result<(), String> {
        let mut left = ways;
        loop {
            let time = |i: usize| left[i].abs() / motors[i].search_rate_rad_s;
            let moving = [0, 1, 2].into_iter().filter(|&i| left[i] != 0.0);
            let Some(next) = moving.min_by(|&a, &b| time(a).total_cmp(&time(b))) else {
                return Ok(());
            };
            let until = time(next);
            let part = [0, 1, 2].map(|i| match i == next {
                true => left[i],
                false => {
                    let most = motors[i].search_rate_rad_s * until;
                    left[i].clamp(-most, most)
                }
            });
            self.go(part, when)?;
            for (left, part) in left.iter_mut().zip(part) {
                *left -= part;
            }
        }
    }

    /// The motors move by `ways` in proportion.
    fn go(&mut self, ways: [f64; 3], when: &str) -> Result<(), String> {
        let longest = ways.iter().fold(0.0, |most: f64, way| most.max(way.abs()));
        let steps = (longest / STEP_RAD).ceil() as u32;
        let from = self.angles;
        for step in 1..=steps {
            let part = f64::from(step) / f64::from(steps);
            self.angles = [0, 1, 2].map(|i| from[i] + ways[i] * part);
            self.look().map_err(|reason| {
                let angles = self.angles.map(|angle| short(wrapped(angle)));
                format!("{when}, with the motors at {}: {reason}", angles.join(", "))
            })?;
        }
        Ok(())
    }

    /// Follows the platform to where the motors are now.
    fn look(&mut self) -> Result<(), String> {
        let angles = self.angles.map(wrapped);
        let track = self.tracker.follow(&self.track, &angles);
        self.track = track.map_err(|error| error.to_string())?;
        let position = self
            .geometry
            .position(&self.track.pose)
            .map_err(|status| status.to_string())?;
        let least = self.scene.limits.serial_distance_min;
        for (leg, distance) in self.distances.serial(&position).into_iter().enumerate() {
            // Written so that a value that is not a number is refused.
            let allowed = distance >= least && distance > 0.0;
            if !allowed {
                return Err(format!(
                    "serial singularity: leg {}, distance {}, the least allowed is {}",
                    leg + 1,
                    short(distance),
                    short(least)
                ));
            }
        }
        let there = self.geometry.motor_angles(&position);
        for (leg, (there, angle)) in there.into_iter().zip(angles).enumerate() {
            if wrapped(there - angle).abs() > STEP_RAD / 10.0 {
                return Err(format!("leg {} is in another working mode", leg + 1));
            }
        }
        Ok(())
    }
}

/// `angle` in (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    let (sin, cos) = <f64 as Arithmetic>::sin_cos(angle);
    <f64 as Arithmetic>::atan2(sin, cos)
}
