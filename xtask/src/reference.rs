//! What the host computes for a scene's job: the bits that every core has to give.

use anyhow::{Context, Result, bail};
use trirrr_core::machine::{LinksKind, Parameters, PayloadKind};
use trirrr_core::number::{Coarse, Fixed, Number};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{Horizontal, InPlane, Links, Massive, Massless, Rotors};
use trirrr_core::torque::payload::{Centred, Offset, Payload, PositionOnly};
use trirrr_image::Checksum;
use trirrr_scene::{JobPlayer, Scene};

/// Checksum over every tick of the job in the number type called `scalar`.
pub(crate) fn checksum(scene: &Scene, scalar: &str) -> Result<u64> {
    match scalar {
        "f32" => with_number::<f32>(scene),
        "fixed" => with_number::<Fixed>(scene),
        "micromath" => with_number::<Coarse>(scene),
        _ => bail!("{scalar}: the host has no such number type"),
    }
}

fn with_number<N: Number>(scene: &Scene) -> Result<u64> {
    match PayloadKind::of(&scene.parameters) {
        _ if !scene.torque => with_links::<N, PositionOnly, Massless>(scene),
        PayloadKind::Centred => with_payload::<N, Centred<N>>(scene),
        PayloadKind::Offset => with_payload::<N, Offset<N>>(scene),
    }
}

fn with_payload<N: Number, P: Payload<N>>(scene: &Scene) -> Result<u64> {
    match LinksKind::of(&scene.parameters) {
        LinksKind::Massless => with_links::<N, P, Massless>(scene),
        LinksKind::Rotors => with_links::<N, P, Rotors<N>>(scene),
        LinksKind::MassiveHorizontal => with_links::<N, P, Massive<N, Horizontal>>(scene),
        LinksKind::MassiveInPlane => with_links::<N, P, Massive<N, InPlane<N>>>(scene),
    }
}

fn with_links<N: Number, P: Payload<N>, L: Links<N>>(scene: &Scene) -> Result<u64> {
    let units = trirrr_scene::units::<N>(scene)?;
    let period = units.time(scene.period_s());
    let player = JobPlayer::<N>::new(&scene.job.in_units(&units), period);
    sum::<N, P, L>(&units.parameters(&scene.parameters), player.setpoints())
        .with_context(|| format!("scene {}", scene.name))
}

fn sum<N: Number, P: Payload<N>, L: Links<N>>(
    parameters: &Parameters,
    setpoints: impl Iterator<Item = Setpoint<N>>,
) -> Result<u64> {
    let tick = Tick::<N, P, L>::build(parameters)?;
    let mut checksum = Checksum::default();
    for setpoint in setpoints {
        match tick.evaluate(&setpoint) {
            Ok(motion) => checksum.add(&motion.motors),
            Err(status) => checksum.add_status(status),
        }
    }
    Ok(checksum.value())
}
