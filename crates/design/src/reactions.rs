//! Forces in the nine joints along a job, for bearings and pins.

use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::reaction::Reactions;
use trirrr_core::tick::Tick;
use trirrr_scene::{JobPlayer, Scene};

/// Force in a joint along a job, N.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct JointForce {
    /// Largest size.
    pub peak_n: f64,
    /// Root mean square of the size.
    pub rms_n: f64,
}

/// Forces in the joints A, B and C of each leg along a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobReactions {
    /// Peak and root mean square of the sizes.
    pub forces: [[JointForce; 3]; 3],
    /// The forces at instants of the job, N: along and across the link on whose pin they act. At A the base pulls at the proximal link, at
    /// B the proximal at the distal link, both in the axes of the proximal link, A to B; at C the distal link pulls at the platform, in the axes of the distal
    /// link, B to C.
    pub vectors: Vec<[[[f64; 2]; 3]; 3]>,
}

/// Instants whose vectors are kept, at most.
const VECTORS: u32 = 1_000;

/// Forces in the joints A, B and C of each leg along the job of `scene`, without friction.
///
/// # Errors
/// The machine is refused, or a setpoint of the job has no motion.
pub fn along_job(scene: &Scene) -> Result<JobReactions, String> {
    let kind = ModelKind::of(&scene.parameters, true);
    kind.visit(Along { scene, kind })
}

struct Along<'a> {
    scene: &'a Scene,
    kind: ModelKind,
}

impl ModelVisitor<f64> for Along<'_> {
    type Output = Result<JobReactions, String>;

    fn visit<M: Model<N = f64>>(self) -> Self::Output {
        let Self { scene, kind } = self;
        let tick =
            Tick::<M>::build(kind.with(&scene.parameters)).map_err(|error| error.to_string())?;
        let reactions = Reactions::<f64>::build(&scene.parameters);
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        let mut found = JobReactions::default();
        let step = player.ticks() / VECTORS + 1;
        for (instant, setpoint) in (0_u32..).zip(player.setpoints()) {
            let motion = tick
                .evaluate(&setpoint)
                .map_err(|status| status.to_string())?;
            let joints = reactions
                .forces(&motion)
                .map_err(|status| status.to_string())?;
            let mut vectors = [[[0.0; 2]; 3]; 3];
            for (index, joints) in joints.iter().enumerate() {
                let links = &motion.legs[index].position.links;
                let axes = [links.r1, links.r1, links.r2].map(|link| link.normalize());
                let of_joints = [joints.base, joints.elbow, joints.platform];
                for (joint, (force, axis)) in of_joints.into_iter().zip(axes).enumerate() {
                    let size = force.norm();
                    let sums = &mut found.forces[index][joint];
                    sums.peak_n = sums.peak_n.max(size);
                    sums.rms_n += size * size;
                    vectors[index][joint] = [axis.dot(&force), axis.perp(&force)];
                }
            }
            if instant.is_multiple_of(step) {
                found.vectors.push(vectors);
            }
        }
        let count = f64::from(player.ticks() + 1);
        for force in found.forces.as_flattened_mut() {
            force.rms_n = (force.rms_n / count).sqrt();
        }
        Ok(found)
    }
}
