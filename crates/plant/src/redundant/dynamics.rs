//! Forward dynamics of a redundant machine.

use super::{COORDINATES, SLIDERS};
use nalgebra::{SMatrix, SVector, Vector3};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::status::Status;
use trirrr_linkage::redundant::{RedundantMachine, RedundantMotion, SliderState};

pub(super) type Coordinates = [f64; COORDINATES];

/// A machine, and which coordinate each slider is.
pub(super) struct Dynamics<const LEGS: usize> {
    pub(super) machine: RedundantMachine<f64, LEGS>,
    /// Leg of each slider.
    pub(super) sliders: Vec<usize>,
    /// Direction of each slider.
    directions: Vec<[f64; 2]>,
}

/// Motors and sliders at a state.
pub(super) struct Joints<const LEGS: usize> {
    pub(super) motion: RedundantMotion<f64, LEGS>,
    /// Rates of the motors over rates of the coordinates.
    turns: [Coordinates; LEGS],
}

impl<const LEGS: usize> Dynamics<LEGS> {
    /// `directions` has the angle of each leg's slider, rad, if the leg has one.
    pub(super) fn new(
        machine: RedundantMachine<f64, LEGS>,
        directions: &[Option<f64>; LEGS],
    ) -> Self {
        let legs = directions.iter().enumerate();
        let (sliders, directions) = legs
            .filter_map(|(leg, direction)| {
                let (sin, cos) = (*direction)?.sin_cos();
                Some((leg, [cos, sin]))
            })
            .unzip();
        Self {
            machine,
            sliders,
            directions,
        }
    }

    /// Number of coordinates in use.
    fn count(&self) -> usize {
        3 + self.sliders.len()
    }

    /// Motion with the rates `v` and accelerations `a` at the coordinates `q`.
    ///
    /// # Errors
    /// [`Status`] of a state without a motion.
    pub(super) fn joints(
        &self,
        q: &Coordinates,
        v: &Coordinates,
        a: &Coordinates,
    ) -> Result<Joints<LEGS>, Status> {
        let setpoint = Setpoint {
            pose: Pose::from_f64(q[0], q[1], q[2]),
            velocity: Vector3::new(v[0], v[1], v[2]),
            acceleration: Vector3::new(a[0], a[1], a[2]),
        };
        let mut states = [SliderState::at(0.0); LEGS];
        for (number, &leg) in self.sliders.iter().enumerate() {
            states[leg] = SliderState {
                position: q[3 + number],
                velocity: v[3 + number],
                acceleration: a[3 + number],
            };
        }
        let motion = self.machine.evaluate(&setpoint, &states, &[0.0; LEGS])?;
        let turns = core::array::from_fn(|leg| {
            let position = &motion.legs[leg].position;
            let (c, r2) = (position.platform_joint, position.links.r2);
            let inverse = 1.0 / position.links.r1_cross_r2;
            let mut row = [0.0; COORDINATES];
            row[0] = r2.x * inverse;
            row[1] = r2.y * inverse;
            row[2] = (c.x * r2.y - c.y * r2.x) * inverse;
            if let Some(number) = self.sliders.iter().position(|&it| it == leg) {
                // Only what C is ahead of A turns the leg.
                let [ux, uy] = self.directions[number];
                row[3 + number] = -(row[0] * ux + row[1] * uy);
            }
            row
        });
        Ok(Joints { motion, turns })
    }

    /// Forces of the coordinates that `torques` of the motors and `forces` of the sliders make, without the wrench.
    pub(super) fn forces(
        joints: &Joints<LEGS>,
        torques: &[f64; LEGS],
        forces: &[f64; SLIDERS],
    ) -> SVector<f64, COORDINATES> {
        let mut all = SVector::<f64, COORDINATES>::zeros();
        for (number, force) in forces.iter().enumerate() {
            all[3 + number] = *force;
        }
        for (turns, torque) in joints.turns.iter().zip(torques) {
            for (force, turn) in all.iter_mut().zip(turns) {
                *force += turn * torque;
            }
        }
        all
    }

    /// Forces of the coordinates that the motion in `joints` needs, beside those of the wrench.
    fn needed(&self, joints: &Joints<LEGS>) -> SVector<f64, COORDINATES> {
        let torques = joints.motion.motors.map(|motor| motor.torque);
        let mut forces = [0.0; SLIDERS];
        for (force, &leg) in forces.iter_mut().zip(&self.sliders) {
            *force = joints.motion.sliders[leg].map_or(0.0, |slider| slider.force);
        }
        Self::forces(joints, &torques, &forces)
    }

    /// Accelerations of the coordinates under `torques` and `forces`. `still` is the motion without accelerations.
    ///
    /// # Errors
    /// [`Status`] of a state without a motion; out of range where nothing resists.
    pub(super) fn accelerations(
        &self,
        q: &Coordinates,
        v: &Coordinates,
        still: &Joints<LEGS>,
        torques: &[f64; LEGS],
        forces: &[f64; SLIDERS],
    ) -> Result<Coordinates, Status> {
        let h = self.needed(still);
        let mut mass = SMatrix::<f64, COORDINATES, COORDINATES>::identity();
        for k in 0..self.count() {
            let mut unit = [0.0; COORDINATES];
            unit[k] = 1.0;
            let column = self.needed(&self.joints(q, v, &unit)?) - h;
            mass.set_column(k, &column);
        }
        let right = Self::forces(still, torques, forces) - h;
        let solved = mass.cholesky().ok_or(Status::OutOfRange)?.solve(&right);
        let mut accelerations = [0.0; COORDINATES];
        accelerations[..self.count()].copy_from_slice(&solved.as_slice()[..self.count()]);
        Ok(accelerations)
    }
}
