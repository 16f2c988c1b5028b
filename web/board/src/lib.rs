//! A board at the other end of a line that the page has: bytes in, bytes out, and the time of the page's clock.
//!
//! Compiled for `wasm32-unknown-unknown` the crate is the page's second module, which is loaded when the user connects a board. It knows
//! nothing of scenes but what the first module, `web/src/board.rs`, tells it. Units are SI, angles radians. Errors are sentences.

mod hindrance;
mod scene;
mod talk;
mod view;

use scene::TalkScene;
use std::time::Duration;
use talk::{BoardTalk, Talk};
use trirrr_core::number::Fixed;
use trirrr_scene::NumberType;
use wasm_bindgen::prelude::wasm_bindgen;

/// Command of the user to a board.
#[wasm_bindgen]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardCommand {
    /// Switch the drives on.
    Enable,
    /// Come to rest, then switch the drives off.
    Disable,
    /// Acknowledge a fault.
    Acknowledge,
    /// Look for the motors; in a scene without homing, move them to the start of the job after a fault.
    Home,
    /// Play the job of the scene.
    Run,
    /// Come to rest on the path.
    Hold,
    /// Go on.
    Resume,
    /// Come to rest on the path and drop the rest.
    Stop,
    /// Move by a step, which [`Board::step`] gives.
    Step,
}

impl BoardCommand {
    /// All of them, in their order.
    pub const ALL: [Self; 9] = [
        Self::Enable,
        Self::Disable,
        Self::Acknowledge,
        Self::Home,
        Self::Run,
        Self::Hold,
        Self::Resume,
        Self::Stop,
        Self::Step,
    ];
}

/// Values of the three motors at the joints.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DriveValues {
    /// Angles, rad.
    pub angles: Vec<f64>,
    /// Rates, rad/s.
    pub rates: Vec<f64>,
    /// Torques, N m.
    pub torques: Vec<f64>,
}

/// Sample of one tick.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoardSample {
    /// Time since the board was switched on, s.
    pub time: f64,
    /// Pose, velocity and acceleration of the platform that the board asks for, three each.
    pub setpoint: Vec<f64>,
    /// Values that the board asks of the motors.
    pub commanded: DriveValues,
    /// Values that the drives told last; none of drives that tell nothing.
    pub measured: Option<DriveValues>,
}

/// State of a conversation and of the machine.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoardView {
    /// State of the machine in words, or the reason why there is none.
    pub sentence: String,
    /// The board does not talk with this page: the sentence says why.
    #[wasm_bindgen(js_name = isClosed)]
    pub is_closed: bool,
    /// The sentence tells of trouble.
    #[wasm_bindgen(js_name = isBad)]
    pub is_bad: bool,
    /// The page plays the job of the scene.
    #[wasm_bindgen(js_name = isPlaying)]
    pub is_playing: bool,
    /// [`BoardCommand::Home`] is a recovery now.
    #[wasm_bindgen(js_name = isRecovery)]
    pub is_recovery: bool,
    /// Moves of the job that are played,
    pub done: u32,
    /// and all of them.
    pub moves: u32,
    /// Emergency stop and door in words; none where the scene names neither.
    pub inputs: Option<String>,
    /// Reason why each command would do nothing now, in the order of the commands; empty where it would do something.
    pub hindrances: Vec<String>,
    /// The last sample.
    pub sample: Option<BoardSample>,
}

/// Conversation with the board of a scene. It gives no command by itself that switches drives on or moves them.
///
/// Times are milliseconds of a clock of the page that never goes back.
#[wasm_bindgen]
pub struct Board {
    talk: Box<dyn Talk>,
    due: f64,
}

fn time(now_ms: f64) -> Duration {
    Duration::try_from_secs_f64(now_ms / 1e3).unwrap_or_default()
}

#[wasm_bindgen]
impl Board {
    /// Prepares the conversation with the board of a scene, whose parts are those of `BoardScene` in the first module. Another conversation
    /// should have another number `conversation`.
    ///
    /// # Errors
    /// Parts that are not those of a scene.
    #[wasm_bindgen(constructor)]
    #[allow(clippy::too_many_arguments)] // They are the fields of a struct of another module.
    pub fn new(
        name: String,
        number: &str,
        key: u32,
        figures: &[f64],
        moves: &[f64],
        levels: Vec<u8>,
        ranges: &[u32],
        outputs: &[u32],
        tools: Vec<String>,
        bodies: &[f64],
        conversation: u32,
    ) -> Result<Self, String> {
        let mut scene = TalkScene::new(name, number, key, figures, moves, levels, ranges)?;
        scene.switch(outputs)?;
        scene.carry(tools, bodies)?;
        let talk: Box<dyn Talk> = match scene.number {
            NumberType::F64 => Box::new(BoardTalk::<f64>::new(scene, conversation)),
            // Both have the same bytes on the line; the key of the hello tells them apart.
            NumberType::F32 | NumberType::Micromath => {
                Box::new(BoardTalk::<f32>::new(scene, conversation))
            }
            NumberType::Fixed => Box::new(BoardTalk::<Fixed>::new(scene, conversation)),
        };
        Ok(Self { talk, due: 0.0 })
    }

    /// Returns the bytes that are to be sent now, none most of the time.
    pub fn poll(&mut self, now_ms: f64) -> Vec<u8> {
        let mut bytes = Vec::new();
        let until = self.talk.poll(time(now_ms), &mut bytes);
        self.due = until.as_secs_f64() * 1e3;
        bytes
    }

    /// Time at which [`poll`](Self::poll) is to be called again, unless bytes come or a command is given before, ms.
    #[wasm_bindgen(getter)]
    pub fn due(&self) -> f64 {
        self.due
    }

    /// Takes bytes that came from the board.
    pub fn receive(&mut self, bytes: &[u8], now_ms: f64) {
        self.talk.receive(bytes, time(now_ms));
    }

    /// Gives a command.
    ///
    /// # Errors
    /// The reason why it would do nothing now.
    pub fn command(&mut self, command: BoardCommand) -> Result<(), String> {
        self.talk.command(command)
    }

    /// Moves by a step, slowly: D by `x` and `y`, m, the platform by `alpha`, rad, from where the last step ends.
    ///
    /// # Errors
    /// The reason why the machine does not move now; a step that is not finite.
    pub fn step(&mut self, x: f64, y: f64, alpha: f64) -> Result<(), String> {
        match [x, y, alpha].iter().all(|value| value.is_finite()) {
            true => self.talk.step([x, y, alpha]),
            false => Err("a step is three finite numbers".into()),
        }
    }

    /// Brings the machine to rest, whatever it does: a job holds and can be resumed, all else is stopped. Never refused.
    pub fn halt(&mut self) {
        self.talk.halt();
    }

    /// Takes the sentences out that came since the last call.
    #[wasm_bindgen(js_name = takeNotes)]
    pub fn take_notes(&mut self) -> Vec<String> {
        self.talk.take_notes()
    }

    /// Returns what is known of the machine.
    pub fn view(&self) -> BoardView {
        self.talk.view()
    }
}
