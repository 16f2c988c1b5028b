//! Forces in the nine joints along a job, for bearings and pins.

use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::reaction::Reactions;
use trirrr_core::tick::Tick;
use trirrr_scene::{JobPlayer, Scene};

/// Force in a joint along a job, N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointForce {
    /// Largest size.
    pub peak_n: f64,
    /// Root mean square of the size.
    pub rms_n: f64,
}

/// Forces in the joints A, B and C of each leg along the job of `scene`, without friction.
///
/// # Errors
/// The machine is refused, or a setpoint of the job has no motion.
pub fn along_job(scene: &Scene) -> Result<[[JointForce; 3]; 3], String> {
    ModelKind::of(&scene.parameters, true).visit(Along { scene })
}

struct Along<'a> {
    scene: &'a Scene,
}

impl ModelVisitor<f64> for Along<'_> {
    type Output = Result<[[JointForce; 3]; 3], String>;

    fn visit<M: Model<N = f64>>(self) -> Self::Output {
        let Self { scene } = self;
        let tick = Tick::<M>::build(&scene.parameters).map_err(|error| error.to_string())?;
        let reactions = Reactions::<f64>::build(&scene.parameters);
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        let mut forces = [[JointForce::default(); 3]; 3];
        for setpoint in player.setpoints() {
            let motion = tick
                .evaluate(&setpoint)
                .map_err(|status| status.to_string())?;
            let joints = reactions
                .forces(&motion)
                .map_err(|status| status.to_string())?;
            for (leg, joints) in forces.iter_mut().zip(&joints) {
                for (force, found) in
                    leg.iter_mut()
                        .zip([joints.base, joints.elbow, joints.platform])
                {
                    let size = found.x * found.x + found.y * found.y;
                    force.peak_n = force.peak_n.max(size.sqrt());
                    force.rms_n += size;
                }
            }
        }
        let count = f64::from(player.ticks() + 1);
        for force in forces.as_flattened_mut() {
            force.rms_n = (force.rms_n / count).sqrt();
        }
        Ok(forces)
    }
}
