//! Settings that a scene gives to the core's service.

use crate::scene::Scene;
use trirrr_core::units::Units;
use trirrr_protocol::message::{Board, Message, Request, Transmit};
use trirrr_protocol::wire::schema;
use trirrr_service::{SceneIdentity, Settings, name};

/// The settings of the scene's service in the number type `N`, in `units`: those of an image and those of
/// a simulator, so that both say the same of themselves. A board puts its own in the place of
/// [`Board::HOST`].
pub fn settings<N: Transmit>(scene: &Scene, units: &Units) -> Settings<N> {
    // The cast saturates; the reader holds the time to an hour.
    let silence = scene.service.silence_timeout_s * scene.tick_rate_hz;
    Settings {
        period: N::factor_from_f64(units.time(scene.period_s())),
        ramp: scene.ramp(),
        host_timeout_ticks: silence.round().max(1.0) as u32,
        telemetry_every: scene.service.telemetry_ticks as u16,
        scene: SceneIdentity {
            schema: schema::key::<Request<N>, Message<N>>(),
            key: scene.key,
            name: name(&scene.name),
            tick_rate_hz: scene.tick_rate_hz,
            length_m: units.length_m(),
            time_s: units.time_s(),
            mass_kg: units.of(0, 0, 1),
        },
        board: Board::HOST,
    }
}
