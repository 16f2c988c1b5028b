//! Inertia and lever arms of a machine at a pose.

use super::parameters::ContactCoefficients;
use nalgebra::Vector3;
use trirrr_core::model::Model;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::tick::Tick;

/// Inertia of the machine in its joints, and the way from torques of the joints to the tool, at one pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactModel<N> {
    /// M, by rows: torques of the motors for each joint acceleration, kg m^2; times the weight of the momentum.
    pub(super) inertia: [[N; 3]; 3],
    /// K^T, by rows: force along x and y and moment about D for each torque of a joint, 1/m and 1.
    pub(super) to_tool: [[N; 3]; 3],
}

impl<N: Number> ContactModel<N> {
    /// Takes the model from the pipeline of the machine, at rest at `pose`. Torques are affine in the acceleration: those of
    /// three unit accelerations, less those at rest, are all there is to them. `None` where the pose has no motion.
    #[inline(never)] // size: docs/size.md, rule 3
    pub fn at<M: Model<N = N>>(
        tick: &Tick<M>,
        pose: Pose<N>,
        coefficients: &ContactCoefficients<N>,
    ) -> Option<Self> {
        let zero = Vector3::new(N::ZERO, N::ZERO, N::ZERO);
        let mut accelerations = [zero; 3];
        let mut torques = [zero; 3];
        let mut weight = zero;
        // At rest first, then along each axis of the platform: one call, four times.
        for axis in 0..4_usize {
            let mut acceleration = zero;
            let column = axis.checked_sub(1);
            if let Some(along) = column.and_then(|axis| acceleration.get_mut(axis)) {
                *along = N::ONE;
            }
            let setpoint = Setpoint {
                pose,
                velocity: zero,
                acceleration,
            };
            let [a, b, c] = evaluated(tick, &setpoint)?;
            let torque = Vector3::new(a[1], b[1], c[1]);
            let Some(column) = column else {
                weight = torque;
                continue;
            };
            if let (Some(rates), Some(needed)) =
                (accelerations.get_mut(column), torques.get_mut(column))
            {
                *rates = Vector3::new(a[0], b[0], c[0]);
                *needed = torque - weight;
            }
        }
        // K has these columns, M K those: M = (M K) K^-1, by the rows of the adjugate.
        let [kx, ky, kz] = &accelerations;
        let (yz, zx, xy) = (ky.cross(kz), kz.cross(kx), kx.cross(ky));
        let det = kx.x * yz.x + kx.y * yz.y + kx.z * yz.z;
        let scale = coefficients.weight.div(det);
        let [tx, ty, tz] = &torques;
        let row = |x: N, y: N, z: N| {
            let row = (yz * x + zx * y + xy * z) * scale;
            [row.x, row.y, row.z]
        };
        let inertia = [
            row(tx.x, ty.x, tz.x),
            row(tx.y, ty.y, tz.y),
            row(tx.z, ty.z, tz.z),
        ];
        let to_tool = accelerations.map(|column| [column.x, column.y, column.z]);
        let mut all = inertia.iter().chain(&to_tool).flatten();
        all.all(|entry| N::is_finite(*entry))
            .then_some(Self { inertia, to_tool })
    }

    /// Force along x and y and moment about D that hold `torques` at the joints, N and N m.
    #[inline(always)]
    pub fn at_tool(&self, torques: &[N; 3]) -> [N; 3] {
        product(&self.to_tool, torques)
    }

    /// Weighted momentum of joints that turn by these rates faster than commanded, rad/s.
    #[inline(always)]
    pub(super) fn momentum(&self, rates: &[N; 3]) -> [N; 3] {
        product(&self.inertia, rates)
    }
}

/// Acceleration and torque of each motor; none where the setpoint has no motion.
#[inline(never)]
fn evaluated<N: Number, M: Model<N = N>>(
    tick: &Tick<M>,
    setpoint: &Setpoint<N>,
) -> Option<[[N; 2]; 3]> {
    let motion = tick.evaluate(setpoint).ok()?;
    Some(
        motion
            .motors
            .map(|motor| [motor.acceleration, motor.torque]),
    )
}

#[inline(always)]
fn product<N: Arithmetic>(rows: &[[N; 3]; 3], [x, y, z]: &[N; 3]) -> [N; 3] {
    rows.each_ref().map(|[a, b, c]| *a * *x + *b * *y + *c * *z)
}
