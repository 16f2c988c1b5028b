//! The service of the scene: its types, its memory, and how it is built.

use crate::background;
use crate::line::Received;
#[cfg(homing)]
use crate::scene::HOMING;
use crate::scene::{
    COEFFICIENTS, Links, NAME, PARTS, Payload, SETTINGS, START, Scalar, TICK_RATE_HZ,
};
use trirrr_protocol::message::{Board, Clock, Start};
#[cfg(homing)]
use trirrr_service::WithHoming;
use trirrr_service::{
    self, BackgroundOf, Compiled, ForegroundOf, MessageOf, MessageRefOf, RequestOf, Settings,
};

/// Room for moves, one place stays empty.
const MOVES: usize = 16;

/// Room for telemetry samples, one place stays empty: they are sent while the next ones come.
const SAMPLES: usize = 8;

type Known = Compiled<'static, Scalar, Payload, Links>;

#[cfg(not(homing))]
type Scene = Known;

#[cfg(homing)]
type Scene = WithHoming<'static, Scalar, Known>;

/// The memory between the two halves.
pub type Channels = trirrr_service::Channels<Scalar, Payload, Links, Scene, MOVES, SAMPLES>;

/// The half that ticks.
pub type Foreground = ForegroundOf<'static, Scalar, Payload, Links, Scene>;

/// The half that talks.
pub(crate) type Background = BackgroundOf<'static, Scalar, Payload, Links, Scene>;

/// What it says.
pub(crate) type Message = MessageOf<Scalar, Payload, Links, Scene>;

/// The same where it lies.
pub(crate) type MessageRef<'m> = MessageRefOf<'m, Scalar, Payload, Links, Scene>;

/// What it is asked.
pub(crate) type Request = RequestOf<Scalar, Payload, Links, Scene>;

/// What goes out in a tick.
pub type Output = trirrr_service::Output<Scalar>;

/// Puts the service of the scene together, the machine standing where its job starts. Every
/// coefficient is in the image.
// Called once; inlined it would be compiled with its caller, for speed.
#[inline(never)]
pub fn build(
    channels: &'static mut Channels,
    board: Board,
    received: Received,
) -> (Foreground, background::Background) {
    let scene = Compiled {
        coefficients: &COEFFICIENTS,
        parts: PARTS,
    };
    #[cfg(homing)]
    let scene = WithHoming {
        scene,
        homing: Some(&HOMING),
    };
    note(&board);
    // The reader of the scene lets no start pass in which the machine cannot stand. Nothing is formatted: that
    // would bring floats as text into the image.
    let Ok((foreground, background)) = channels.split(scene, START, Settings { board, ..SETTINGS })
    else {
        panic!("the start is out of reach");
    };
    (
        foreground,
        background::Background::new(background, received),
    )
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
            defmt::error!(
                "started after a panic in {=[u8]:a}, line {=u32}",
                *file,
                line
            );
        }
        Start::HardFault(at) => {
            defmt::error!("started after a hard fault at {=u32:#x}", at.pc);
        }
        Start::StackOverflow(at) => {
            defmt::error!("started after a stack overflow at {=u32:#x}", at.pc);
        }
    }
}
