//! The service of the scene: its types, its memory, and how it is built.

use crate::scene::{
    KEY, LIMITS, Links, NAME, PARAMETERS, PERIOD, Payload, RAMP_TICKS, SILENCE_TICKS, START,
    Scalar, TELEMETRY_TICKS, TICK_RATE_HZ, UNITS_SI,
};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::Parameters;
use trirrr_core::message::{Board, Clock, FaultCode, Message, Request, Start};
use trirrr_core::number::Number;
use trirrr_core::service::{
    self, BackgroundOf, Compiled, ForegroundOf, SceneIdentity, Settings, name,
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
/// Where the board started because it had failed, that is a fault: the drives stay off until the
/// host has acknowledged it.
pub(crate) fn build(channels: &'static mut Channels, board: Board) -> (Foreground, Background) {
    let [x, y, alpha] = START;
    let [length_m, time_s, mass_kg] = UNITS_SI;
    let halves = channels.split(
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
            board,
        },
    );
    note(&board);
    // The build script has built this very service.
    let (mut foreground, background) = halves.expect("the scene can be built");
    if board.start.is_failure() {
        foreground.raise(FaultCode::Board, None, Scalar::ONE, Scalar::ZERO);
    }
    (foreground, background)
}

/// How the board has started, for the log.
fn note(board: &Board) {
    defmt::info!("scene {=str}, {=f64} ticks per second", NAME, TICK_RATE_HZ);
    match board.clock {
        Clock::Crystal | Clock::Emulated | Clock::Host => {}
        Clock::Internal => defmt::warn!("the crystal does not start: internal oscillator and PLL"),
        Clock::Slow => defmt::warn!("no crystal and no PLL: internal oscillator"),
    }
    match &board.start {
        Start::Power | Start::Reset => {}
        Start::Watchdog => defmt::error!("started by the watchdog"),
        Start::Panic { file, line } => {
            let file = core::str::from_utf8(file).unwrap_or_default();
            defmt::error!("started after a panic in {=str}, line {=u32}", file, line);
        }
        Start::HardFault(at) => {
            defmt::error!("started after a hard fault at {=u32:#x}", at.pc);
        }
        Start::StackOverflow(at) => {
            defmt::error!("started after a stack overflow at {=u32:#x}", at.pc);
        }
    }
}
