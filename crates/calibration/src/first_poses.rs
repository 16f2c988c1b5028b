//! Poses of the nominal machine at the angles of a table, before anything is fitted.

use crate::closure::{LoopClosure, close, crosses, turned};
use crate::columns::ColumnFault;
use crate::measurement::{DeviceReading, MeasuredRow, seen_at};
use crate::parameter::{DEVICE, KinematicVector, wrapped};
use trirrr_core::forward::Forward;
use trirrr_core::machine::{Geometry, Parameters};
use trirrr_core::setpoint::Pose;

/// Rows that are named, at most.
const MOST_NAMED: usize = 10;

/// The nominal machine with the place where it starts.
pub(crate) struct NominalMachine<'a> {
    pub(crate) parameters: &'a Parameters,
    pub(crate) geometry: Geometry<f64>,
    forward: Forward<f64>,
    start: Pose<f64>,
    side: bool,
}

impl<'a> NominalMachine<'a> {
    /// The machine of `parameters` in the assembly mode that it has at `start`. None where it has no pose there.
    pub(crate) fn new(parameters: &'a Parameters, start: [f64; 3]) -> Option<Self> {
        let geometry = Geometry::<f64>::build(parameters).ok()?;
        let forward = Forward::build(parameters, &geometry);
        let start = Pose::from_f64(start[0], start[1], start[2]);
        let angles = geometry.motor_angles(&geometry.position(&start).ok()?);
        let side = forward.side(&angles, &start);
        Some(Self {
            parameters,
            geometry,
            forward,
            start,
            side,
        })
    }

    /// Motor angles at a pose, rad; none out of reach.
    pub(crate) fn angles(&self, pose: [f64; 3]) -> Option<[f64; 3]> {
        let pose = Pose::from_f64(pose[0], pose[1], pose[2]);
        let position = self.geometry.position(&pose).ok()?;
        Some(self.geometry.motor_angles(&position))
    }

    /// Closed loops at these motor angles, in the working mode and the assembly mode of the machine: the one that is nearest
    /// to where the reading puts it, or to the start where `is_aligned` is false. Reason where there is none.
    fn pose_of(
        &self,
        values: &KinematicVector,
        row: &MeasuredRow,
        is_aligned: bool,
    ) -> Result<LoopClosure, String> {
        let found = self.forward.assemblies(&row.angles_rad);
        let found = found.map_err(|error| error.to_string())?;
        if found.modes().is_empty() {
            return Err("the loops of the scene's machine close in no pose at these angles".into());
        }
        let fits = |pose: [f64; 3]| {
            let signs = crosses(values, &row.angles_rad, pose);
            let legs = signs.iter().zip(&self.parameters.legs);
            legs.fold(true, |fits, (sign, leg)| {
                fits && sign * leg.elbow.sign() <= 0.0
            })
        };
        let candidates = found.modes().iter().filter_map(|mode| {
            let near = [self.start.angle + wrapped(mode.pose.angle - self.start.angle)];
            let pose = [mode.pose.position.x, mode.pose.position.y, near[0]];
            let closed = close(values, &row.angles_rad, pose)?;
            (closed.side == self.side && fits(closed.pose)).then_some(closed)
        });
        let far = |closed: &LoopClosure| self.far_from(values, row, closed, is_aligned);
        let nearest = candidates.min_by(|one, other| far(one).total_cmp(&far(other)));
        nearest.ok_or_else(|| {
            "the scene's machine has a pose at these angles only in another working mode or assembly mode".into()
        })
    }

    /// Distance of a pose from where the row suggests it, m.
    fn far_from(
        &self,
        values: &KinematicVector,
        row: &MeasuredRow,
        closed: &LoopClosure,
        is_aligned: bool,
    ) -> f64 {
        let seen = seen_at(values, closed.pose);
        match row.reading {
            DeviceReading::Place { place_m, .. } if is_aligned => {
                (seen[0] - place_m[0]).hypot(seen[1] - place_m[1])
            }
            _ => {
                let start = self.start.position;
                (closed.pose[0] - start.x).hypot(closed.pose[1] - start.y)
            }
        }
    }

    /// Poses of all rows.
    ///
    /// # Errors
    /// Rows whose angles fit no pose, with their lines.
    pub(crate) fn poses(
        &self,
        values: &KinematicVector,
        rows: &[MeasuredRow],
        is_aligned: bool,
    ) -> Result<Vec<LoopClosure>, Vec<ColumnFault>> {
        let found = rows.iter().map(|row| self.pose_of(values, row, is_aligned));
        let found: Vec<Result<LoopClosure, String>> = found.collect();
        if found.iter().all(Result::is_ok) {
            return Ok(found.into_iter().flatten().collect());
        }
        let failed = found.iter().filter(|one| one.is_err()).count();
        let mut faults: Vec<ColumnFault> = Vec::new();
        if self.are_degrees(values, rows, rows.len() - failed) {
            let reason = "the angles close the loops if they are degrees: name the columns th1_1_deg, th1_2_deg, th1_3_deg";
            faults.push(ColumnFault::of_column("th1_1", reason));
            return Err(faults);
        }
        for (row, found) in rows.iter().zip(found) {
            if let Err(reason) = found {
                let [a, b, c] = row.angles_rad;
                let mut fault =
                    ColumnFault::of_line(row.line, format!("{reason} ({a}, {b}, {c} rad)"));
                fault.column = "th1_1, th1_2, th1_3".into();
                faults.push(fault);
            }
        }
        if faults.len() > MOST_NAMED {
            let more = faults.len() - MOST_NAMED;
            faults.truncate(MOST_NAMED);
            faults.push(ColumnFault::of_line(
                0,
                format!("so in {more} more rows; are the motors in their order, and the angles those of the scene?"),
            ));
        }
        Err(faults)
    }

    /// Most rows have a pose if their angles are taken as degrees, more than the `fitting` ones that have one as they are.
    fn are_degrees(&self, values: &KinematicVector, rows: &[MeasuredRow], fitting: usize) -> bool {
        let as_degrees = rows.iter().filter(|row| {
            let mut degrees = **row;
            degrees.angles_rad = row.angles_rad.map(f64::to_radians);
            self.pose_of(values, &degrees, false).is_ok()
        });
        let count = as_degrees.count();
        2 * count > rows.len() && count > fitting
    }
}

/// `values` with the device where it fits measured places best, for a machine that has not moved yet: a rotation and a shift in
/// closed form. None with fewer than two places that are apart.
pub(crate) fn aligned(
    values: &KinematicVector,
    rows: &[MeasuredRow],
    closed: &[LoopClosure],
) -> Option<KinematicVector> {
    let mut plain = *values;
    plain.0[DEVICE..DEVICE + 3].fill(0.0);
    let pairs: Vec<[[f64; 2]; 2]> = rows
        .iter()
        .zip(closed)
        .filter_map(|(row, at)| match row.reading {
            DeviceReading::Place { place_m, .. } => {
                let [x, y, _] = seen_at(&plain, at.pose);
                Some([[x, y], place_m])
            }
            DeviceReading::Distance { .. } => None,
        })
        .collect();
    let count = pairs.len() as f64;
    let middle =
        |side: usize, axis: usize| pairs.iter().map(|pair| pair[side][axis]).sum::<f64>() / count;
    let middles = [0, 1].map(|side| [middle(side, 0), middle(side, 1)]);
    let (mut along, mut across) = (0.0, 0.0);
    for pair in &pairs {
        let [own, seen] =
            [0, 1].map(|side| [0, 1].map(|axis| pair[side][axis] - middles[side][axis]));
        along += own[0] * seen[0] + own[1] * seen[1];
        across += own[0] * seen[1] - own[1] * seen[0];
    }
    if pairs.len() < 2 || along.hypot(across) < 1e-12 {
        return None;
    }
    // The device sees the machine turned back by the angle of its own frame.
    let angle = -across.atan2(along);
    let [x, y] = turned(middles[1], angle);
    plain.0[DEVICE] = middles[0][0] - x;
    plain.0[DEVICE + 1] = middles[0][1] - y;
    plain.0[DEVICE + 2] = angle;
    Some(plain)
}
