//! Service of the scene: its types, its memory, its construction.

#[cfg(all(contact, not(scene_over_line)))]
use crate::scene::CONTACT;
#[cfg(all(feedback, not(scene_over_line)))]
use crate::scene::FEEDBACK;
#[cfg(all(homing, not(scene_over_line)))]
use crate::scene::HOMING;
#[cfg(levels)]
use crate::scene::LEVELS;
#[cfg(not(adjustable))]
use crate::scene::{BATCHES, COEFFICIENTS, PARTS};
use crate::scene::{Curves, Model, NAME, Planner, Scalar, TICK_RATE_HZ};
#[cfg(interlocks)]
use crate::scene::{INPUTS, INTERLOCKS, Probe};
#[cfg(all(adjustable, not(scene_over_line)))]
use crate::scene::{LIMITS, PARAMETERS};
#[cfg(not(scene_over_line))]
use crate::scene::{SETTINGS, START};
#[cfg(scene_over_line)]
use crate::stored_scene::{self, PlayedScene};
#[cfg(update)]
use crate::update::NewImage;
use trirrr_protocol::message::{self, Board, Clock, Firmware, Start};
#[cfg(adjustable)]
use trirrr_service::Adjustable;
#[cfg(not(adjustable))]
use trirrr_service::Compiled;
#[cfg(contact)]
use trirrr_service::WithContact;
#[cfg(feedback)]
use trirrr_service::WithFeedback;
#[cfg(homing)]
use trirrr_service::WithHoming;
#[cfg(interlocks)]
use trirrr_service::WithInterlocks;
#[cfg(levels)]
use trirrr_service::WithLevels;
#[cfg(update)]
use trirrr_service::WithUpdate;
use trirrr_service::{Scene, Settings};

#[cfg(contact_refused)]
compile_error!(
    "[contact] needs a number type with a floating point: build the image with TRIRRR_SCALAR=f32, or leave [contact] out"
);

/// Places for moves; one stays empty. At one tick a move, and 1 kHz, the machine has a quarter of a second to live on.
#[cfg(not(any(levels, small)))]
const MOVES: usize = 257;
/// Power lists take the room of some.
#[cfg(all(levels, not(small)))]
const MOVES: usize = 225;
/// The RAM of an RP2040 holds the program, too. With moves of 4 ms, the shortest of a plan, the machine has half a second to live on.
#[cfg(small)]
const MOVES: usize = 129;

/// Places for telemetry samples; one stays empty. The background sends while the tick adds.
const SAMPLES: usize = 8;

/// Machine with its limits: a client may change them, or the coefficients are in the image.
#[cfg(not(adjustable))]
type MachineScene = Compiled<'static, Model, Curves, Planner, BATCHES>;
#[cfg(adjustable)]
type MachineScene = Adjustable<Model, Curves, Planner>;

/// Scene with its power lists, if it plays any.
#[cfg(not(levels))]
type LevelScene = MachineScene;
#[cfg(levels)]
type LevelScene = WithLevels<MachineScene, { LEVELS as usize }>;

/// The same with its homing, if it has any.
#[cfg(not(homing))]
type HomedScene = LevelScene;
#[cfg(homing)]
type HomedScene = WithHoming<'static, LevelScene>;

/// The same with its feedback, if its drives tell where they are.
#[cfg(not(feedback))]
type MeasuredScene = HomedScene;
#[cfg(feedback)]
type MeasuredScene = WithFeedback<'static, HomedScene>;

/// The same with its detection of contacts, if it has any.
#[cfg(not(contact))]
type FeelingScene = MeasuredScene;
#[cfg(contact)]
type FeelingScene = WithContact<'static, MeasuredScene, Retreat>;

/// The same with its emergency stop, its door, its limit switches and its probe, if it has any.
#[cfg(not(interlocks))]
type GuardedScene = FeelingScene;
#[cfg(interlocks)]
type GuardedScene = WithInterlocks<FeelingScene, INPUTS, Probe>;

/// The same with its spare outputs and inputs, if it has any.
#[cfg(not(digital))]
type SwitchedScene = GuardedScene;
#[cfg(digital)]
type SwitchedScene = trirrr_service::WithDigital<GuardedScene>;

/// Scene of this image. Its program may be replaced over the line.
#[cfg(not(update))]
pub(crate) type ImageScene = SwitchedScene;
#[cfg(update)]
pub(crate) type ImageScene = WithUpdate<SwitchedScene, NewImage>;

/// Retreat of this image after a contact.
#[cfg(all(contact, not(retreat)))]
use trirrr_service::NoRetreat as Retreat;
#[cfg(retreat)]
use trirrr_service::Retreats as Retreat;

/// Content of what the drives tell in a tick.
pub type Readings = trirrr_service::ReadingsOf<ImageScene>;

/// A part of the scene in a reply.
type ScenePart = <ImageScene as Scene>::Part;

/// Memory between both halves.
pub type Channels = trirrr_service::Channels<ImageScene, MOVES, SAMPLES>;

/// Half that ticks.
pub(crate) type SceneForeground = trirrr_service::Foreground<'static, ImageScene>;

/// Half that talks.
pub(crate) type SceneBackground = trirrr_service::Background<'static, ImageScene>;

/// Message to the host.
pub(crate) type Message = message::Message<Scalar, ScenePart>;

/// Message to the host, its parts borrowed.
pub(crate) type MessageRef<'m> = message::MessageRef<'m, Scalar, ScenePart>;

/// Request of the host.
pub(crate) type Request = trirrr_service::RequestOf<ImageScene>;

/// Output of a tick.
pub type Output = trirrr_service::Output<Scalar>;

/// Builds both halves of the scene's service. The machine stands at the start of its job.
// A call: inlined, the board's crate would compile it for speed.
#[cfg(scene_over_line)]
#[inline(never)]
pub fn build(
    channels: &'static mut Channels,
    board: Board,
    firmware: &'static Firmware,
) -> (SceneForeground, SceneBackground) {
    // Before the frame of the rest: the check of a scene in the flash takes a third of the stack.
    let played = stored_scene::played();
    build_scene(channels, board, firmware, &played)
}

/// Builds both halves of the scene's service. The machine stands at the start of its job.
// A call: inlined, the board's crate would compile it for speed.
#[inline(never)]
#[cfg(not(scene_over_line))]
pub fn build(
    channels: &'static mut Channels,
    board: Board,
    firmware: &'static Firmware,
) -> (SceneForeground, SceneBackground) {
    build_scene(channels, board, firmware)
}

#[cfg_attr(scene_over_line, inline(never))]
#[cfg_attr(not(scene_over_line), inline(always))]
fn build_scene(
    channels: &'static mut Channels,
    board: Board,
    firmware: &'static Firmware,
    #[cfg(scene_over_line)] played: &PlayedScene,
) -> (SceneForeground, SceneBackground) {
    #[cfg(not(adjustable))]
    let scene = Compiled {
        coefficients: &COEFFICIENTS,
        parts: PARTS,
        types: core::marker::PhantomData,
    };
    #[cfg(all(adjustable, not(scene_over_line)))]
    let scene = MachineScene::new(PARAMETERS, LIMITS);
    #[cfg(not(scene_over_line))]
    let (start, own) = (START, SETTINGS);
    #[cfg(scene_over_line)]
    let PlayedScene {
        parameters,
        limits,
        start,
        settings: own,
        #[cfg(homing)]
        homing,
        #[cfg(feedback)]
        feedback,
        #[cfg(contact)]
        contact,
    } = *played;
    #[cfg(scene_over_line)]
    let scene = MachineScene::new(parameters, limits);
    #[cfg(levels)]
    let scene = WithLevels {
        scene,
        room: LEVELS,
    };
    #[cfg(all(homing, not(scene_over_line)))]
    let homing = &HOMING;
    #[cfg(homing)]
    let scene = WithHoming {
        scene,
        homing: Some(homing),
    };
    log_start(&board);
    #[cfg(all(feedback, not(scene_over_line)))]
    let feedback = &FEEDBACK;
    #[cfg(feedback)]
    let scene = WithFeedback {
        scene,
        feedback: Some(feedback),
    };
    #[cfg(all(contact, not(scene_over_line)))]
    let contact = &CONTACT;
    #[cfg(contact)]
    let scene = WithContact {
        scene,
        contact: Some(contact),
        retreat: Retreat,
    };
    #[cfg(interlocks)]
    let scene = WithInterlocks {
        scene,
        parameters: INTERLOCKS,
        probe: core::marker::PhantomData,
    };
    #[cfg(digital)]
    let scene = trirrr_service::WithDigital {
        scene,
        parameters: crate::scene::DIGITAL,
    };
    #[cfg(update)]
    let scene = WithUpdate {
        scene,
        slot: NewImage::new(firmware),
    };
    // The reader of the scene refuses a start out of reach. The error is not formatted: that would bring
    // floats as text into the image.
    let settings = Settings {
        board,
        firmware,
        ..own
    };
    let Ok(halves) = channels.split(scene, start, settings) else {
        panic!("the start is out of reach");
    };
    halves
}

/// Logs how the board has started.
fn log_start(board: &Board) {
    defmt::info!("scene {=str}, {=f64} ticks per second", NAME, TICK_RATE_HZ);
    match board.clock {
        Clock::Crystal | Clock::Emulated | Clock::Host => {}
        Clock::Internal => defmt::warn!("the crystal does not start: internal oscillator and PLL"),
        Clock::Slow => defmt::warn!("no crystal and no PLL: internal oscillator"),
        Clock::WrongCrystal => {
            defmt::error!("check crystal_mhz of the board file: the crystal is another")
        }
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
        Start::CrystalStopped => defmt::error!("started after the crystal stopped"),
        Start::LowSupply => defmt::error!("started after the supply sagged"),
    }
}
