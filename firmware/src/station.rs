//! The service of the scene: its types, its memory, and how it is built.

use crate::scene::{
    KEY, LIMITS, Links, NAME, PARAMETERS, PERIOD, Payload, RAMP_TICKS, SILENCE_TICKS, START,
    Scalar, TELEMETRY_TICKS, TICK_RATE_HZ, UNITS_SI,
};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::Parameters;
use trirrr_core::message::{Message, Request};
use trirrr_core::number::Number;
use trirrr_core::service::{
    self, BackgroundOf, Compiled, ForegroundOf, SceneIdentity, ServiceError, Settings, name,
};
use trirrr_core::setpoint::Pose;
use trirrr_core::wire::schema;

/// Room for moves, one place stays empty.
const MOVES: usize = 16 + 1;

/// Room for telemetry samples, one place stays empty: they are sent while the next ones come.
const SAMPLES: usize = 8;

static MACHINE: Parameters = PARAMETERS;
static MACHINE_LIMITS: LimitParameters = LIMITS;

type Scene = Compiled<'static>;

/// The memory between the two halves.
pub(crate) type Channels = service::Channels<Scalar, Payload, Links, Scene, MOVES, SAMPLES>;

/// The half that ticks.
pub(crate) type Foreground = ForegroundOf<'static, Scalar, Payload, Links, Scene>;

/// The half that talks.
pub(crate) type Background = BackgroundOf<'static, Scalar, Payload, Links, Scene>;

/// What goes out in a tick.
pub(crate) type Output = service::Output<Scalar>;

/// Builds the service of the scene, the machine standing where its job starts.
///
/// # Errors
/// A machine, limits or a pose that the scene's number type cannot hold.
pub(crate) fn build(
    channels: &'static mut Channels,
) -> Result<(Foreground, Background), ServiceError> {
    let [x, y, alpha] = START;
    let [length_m, time_s, mass_kg] = UNITS_SI;
    channels.split(
        Compiled {
            parameters: &MACHINE,
            limits: &MACHINE_LIMITS,
        },
        Pose::from_f64(x, y, alpha),
        Settings {
            period: Scalar::factor_from_f64(PERIOD),
            ramp_ticks: RAMP_TICKS,
            silence_ticks: SILENCE_TICKS,
            telemetry_every: TELEMETRY_TICKS,
            scene: SceneIdentity {
                schema: const { schema::key::<Request<Scalar>, Message<Scalar>>() },
                key: KEY,
                name: const { name(NAME) },
                tick_rate_hz: TICK_RATE_HZ,
                length_m,
                time_s,
                mass_kg,
            },
        },
    )
}
