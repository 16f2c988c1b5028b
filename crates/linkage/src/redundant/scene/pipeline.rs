//! A machine of a scene behind one object: the scene knows the number of legs at run time, the machine as a constant.

use super::RedundantScene;
use super::record::{RedundantLegRecord, RedundantRecord, SliderRecord};
use crate::redundant::{Placement, PlacementError, RedundantMachine, SliderState, Travel, place};
use trirrr_core::machine::BuildError;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::status::Status;
use trirrr_scene::record::LegRecord;

/// Machine of a scene, in f64.
pub trait RedundantPipeline: Send + Sync {
    /// Evaluates one setpoint. `sliders` and `wanted` have an entry for each leg. The record carries the time `t`, s.
    ///
    /// # Errors
    /// [`Status`] of a setpoint without a motion.
    fn evaluate(
        &self,
        t: f64,
        setpoint: &Setpoint<f64>,
        sliders: &[SliderState<f64>],
        wanted: &[f64],
    ) -> Result<RedundantRecord, Status>;

    /// Returns the least distance to a singularity at `pose` with the sliders at `sliders`, m.
    ///
    /// # Errors
    /// [`Status`] of a pose that the machine does not reach.
    fn distance(&self, pose: &Pose<f64>, sliders: &[f64]) -> Result<f64, Status>;

    /// Places the sliders that have a travel; see [`place`].
    ///
    /// # Errors
    /// [`PlacementError`].
    fn placed(
        &self,
        path: &[Pose<f64>],
        travels: &[Option<Travel>],
    ) -> Result<(Vec<f64>, usize), PlacementError>;
}

impl RedundantScene {
    /// Builds the machine of the scene.
    ///
    /// # Errors
    /// First quantity that is refused.
    pub fn pipeline(&self) -> Result<Box<dyn RedundantPipeline>, BuildError> {
        match self.kind.legs() {
            4 => build::<4>(self),
            6 => build::<6>(self),
            _ => build::<3>(self),
        }
    }
}

struct OfLegs<const LEGS: usize> {
    machine: RedundantMachine<f64, LEGS>,
}

fn build<const LEGS: usize>(
    scene: &RedundantScene,
) -> Result<Box<dyn RedundantPipeline>, BuildError> {
    let parameters = scene
        .parameters::<LEGS>()
        .expect("the reader counts the legs of each kind");
    let machine = RedundantMachine::build(&parameters)?;
    Ok(Box::new(OfLegs { machine }))
}

/// The first `LEGS` entries of a list that has one for each leg.
fn each<T: Copy, const LEGS: usize>(list: &[T]) -> [T; LEGS] {
    core::array::from_fn(|leg| list[leg])
}

impl<const LEGS: usize> RedundantPipeline for OfLegs<LEGS> {
    fn evaluate(
        &self,
        t: f64,
        setpoint: &Setpoint<f64>,
        sliders: &[SliderState<f64>],
        wanted: &[f64],
    ) -> Result<RedundantRecord, Status> {
        let states = each::<_, LEGS>(sliders);
        let motion = self.machine.evaluate(setpoint, &states, &each(wanted))?;
        let least = match wanted.iter().all(|wanted| *wanted == 0.0) {
            true => motion,
            false => self.machine.evaluate(setpoint, &states, &[0.0; LEGS])?,
        };
        let at = states.map(|state| state.position);
        let distances = self.machine.distances(&setpoint.pose, &at)?;
        let leg = |index: usize| {
            let (motor, leg) = (&motion.motors[index], &motion.legs[index]);
            let links = &leg.position.links;
            let joints = &motion.joints[index];
            let base = setpoint.pose.position + leg.position.platform_joint - links.r1 - links.r2;
            RedundantLegRecord {
                leg: LegRecord {
                    th1: motor.angle,
                    th2: leg.position.distal_angle(),
                    dth1: motor.rate,
                    dth2: leg.rates.distal,
                    ddth1: motor.acceleration,
                    ddth2: leg.accelerations.distal,
                    torque: motor.torque,
                    power: motor.torque * motor.rate,
                    cross: links.r1_cross_r2,
                    serial: distances.serial[index],
                    base: base.into(),
                    r1: links.r1.into(),
                    r2: links.r2.into(),
                },
                least_torque: least.motors[index].torque,
                joints: [joints.base, joints.elbow, joints.platform].map(Into::into),
                slider: motion.sliders[index].map(|drive| SliderRecord {
                    position: states[index].position,
                    velocity: states[index].velocity,
                    acceleration: states[index].acceleration,
                    force: drive.force,
                    power: drive.power,
                }),
            }
        };
        let pose = &setpoint.pose;
        Ok(RedundantRecord {
            t,
            pose: [pose.position.x, pose.position.y, pose.angle],
            velocity: setpoint.velocity.into(),
            acceleration: setpoint.acceleration.into(),
            legs: (0..LEGS).map(leg).collect(),
            parallel: motion.parallel,
        })
    }

    fn distance(&self, pose: &Pose<f64>, sliders: &[f64]) -> Result<f64, Status> {
        let distances = self.machine.distances(pose, &each(sliders))?;
        let serial = distances.serial.into_iter();
        Ok(serial.fold(distances.parallel, f64::min))
    }

    fn placed(
        &self,
        path: &[Pose<f64>],
        travels: &[Option<Travel>],
    ) -> Result<(Vec<f64>, usize), PlacementError> {
        let Placement {
            sliders_m,
            looked_at,
            ..
        } = place(&self.machine, path, &each::<_, LEGS>(travels))?;
        Ok((sliders_m.to_vec(), looked_at))
    }
}
