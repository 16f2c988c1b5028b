//! Results that the host computes for a scene's job: the bits that every core has to give.

use anyhow::{Context, Result, bail};
use trirrr_core::model::{Model, ModelVisitor, OfKind};
use trirrr_core::number::{Coarse, Fixed, Number};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::Tick;
use trirrr_image::Checksum;
use trirrr_scene::{JobPlayer, Scene};

/// Checksum over every tick of the job in the number type called `scalar`.
pub(crate) fn checksum(scene: &Scene, scalar: &str) -> Result<u64> {
    match scalar {
        "f64" => with_number::<f64>(scene),
        "f32" => with_number::<f32>(scene),
        "fixed" => with_number::<Fixed>(scene),
        "micromath" => with_number::<Coarse>(scene),
        _ => bail!("{scalar}: the host has no such number type"),
    }
}

fn with_number<N: Number>(scene: &Scene) -> Result<u64> {
    scene.model().visit::<N, _>(JobChecksum(scene))
}

struct JobChecksum<'a>(&'a Scene);

impl<N: Number> ModelVisitor<N> for JobChecksum<'_> {
    type Output = Result<u64>;

    fn visit<M: Model<N = N>>(self) -> Result<u64> {
        let Self(scene) = self;
        let units = trirrr_scene::units::<N>(scene)?;
        let period = units.time(scene.period_s());
        let player = JobPlayer::<N>::new(&scene.job.in_units(&units), period);
        let parameters = units.parameters(&scene.parameters);
        sum::<M>(scene.model().with(&parameters), player.setpoints())
            .with_context(|| format!("scene {}", scene.name))
    }
}

fn sum<M: Model>(
    machine: OfKind<'_>,
    setpoints: impl Iterator<Item = Setpoint<M::N>>,
) -> Result<u64> {
    let tick = Tick::<M>::build(machine)?;
    let mut checksum = Checksum::default();
    for setpoint in setpoints {
        match tick.evaluate(&setpoint) {
            Ok(motion) => checksum.add(&motion.motors),
            Err(status) => checksum.add_status(status),
        }
    }
    Ok(checksum.value())
}
