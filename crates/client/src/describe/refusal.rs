//! Refusals of commands.

use super::{Units, state, violation};
use trirrr_protocol::message::{Acting, PROTOCOL, Refusal, SceneNeed, Transmit, UpdateRefusal};

/// Describes the reason why a command was not executed. `ticks` is the duration of the move that was
/// refused, if the command was a move.
pub fn refusal<N: Transmit>(refusal: &Refusal<N>, ticks: u32, units: &Units) -> String {
    match refusal {
        Refusal::HelloFirst => "the board has had no hello since it was switched on".into(),
        Refusal::Protocol { expected } => format!(
            "the board speaks version {expected} of the protocol, this program version {PROTOCOL}"
        ),
        Refusal::Schema { expected } => match super::board::number_type(*expected) {
            Some(number) => format!(
                "the board computes in {number}, and was spoken to in another number type: give --scalar {number}, or \
                 number = \"{number}\" in the scene"
            ),
            None => format!(
                "the board's messages have another layout (schema key {expected:#010x}): it was built from another version \
                 of this program"
            ),
        },
        Refusal::Scene { expected } => format!(
            "the board was built for another scene (key {expected:#010x}): build its image from \
             this one, or name the scene that it has"
        ),
        Refusal::Sequence { expected } => {
            format!("the board expects request number {expected}: has it two clients?")
        }
        Refusal::SequenceReused => {
            "the request's number was used for another command: has the board two clients?".into()
        }
        Refusal::State(found) => {
            let state = state(*found, Acting::Nothing);
            format!("not while the machine is {state}")
        }
        Refusal::NothingQueued => "no move is queued".into(),
        Refusal::Undecided => "a queued move is not admitted yet".into(),
        Refusal::EndsMoving => {
            "the queued moves end before the machine could come to rest on them".into()
        }
        Refusal::QueueFull => "the queue is full".into(),
        Refusal::MoveNumber { expected } => {
            format!("the board expects move number {expected}: has it two clients?")
        }
        Refusal::NotFinite => "a value is infinite or not a number".into(),
        Refusal::Duration { longest } => {
            format!("its duration is {ticks} ticks; 1 to {longest} are allowed")
        }
        Refusal::StartPose => {
            "it does not start where the last one ends, or where the machine stands".into()
        }
        Refusal::StartAcceleration => {
            "it does not start with the acceleration that the last one ends with".into()
        }
        Refusal::Retargeting => "the board is still planning the last retarget".into(),
        Refusal::FeedOverride => "a feed override is 1 to 100 percent".into(),
        Refusal::NoQuintics => "the board's image holds no code for quintic moves".into(),
        Refusal::NoPaths => {
            "the board's image plans no paths: set plans_paths in [service] of its scene, or send moves".into()
        }
        Refusal::PathUnderWay => {
            "the board plans a path: wait for its end, or stop, before other moves".into()
        }
        Refusal::Feed => "the feed of a piece is negative".into(),
        Refusal::NoFeedback => "the drives of the board's scene tell nothing".into(),
        Refusal::NoBatches => {
            "the board's image takes no batches of moves: set batches in [service] of its scene".into()
        }
        Refusal::Check { expected } => format!(
            "the moves of the batch do not start where the last one ends (its checksum is {expected:#010x}): has the board two \
             clients?"
        ),
        Refusal::NoLevels => {
            "the board's image plays no power lists: set power_lists in [service] of its scene".into()
        }
        Refusal::LevelNumber { expected } => format!(
            "the levels of power are not those that follow (number {expected} does): has the board two clients?"
        ),
        Refusal::LevelsFull => "the board has no room for more levels of power yet".into(),
        Refusal::LevelRange => {
            "its levels of power do not cover it, are more than two a tick, or D turns back on the way".into()
        }
        Refusal::EmergencyStop => {
            "the emergency stop is pressed, or its wire is broken: release it before the fault is acknowledged".into()
        }
        Refusal::DoorOpen => "the door is open: nothing moves before it is closed".into(),
        Refusal::NoProbe => "the board's scene names no probe: [inputs.probe] would".into(),
        Refusal::ProbeTouches => "the probe touches before the run".into(),
        Refusal::ProbeOpen => "the probe does not touch before the run, which is to lead away".into(),
        Refusal::LimitSwitch { motor } => {
            let motor = u32::from(*motor) + 1;
            format!("motor {motor} stands on its limit switch: only a recovery or homing moves the machine off it")
        }
        Refusal::NoOutput { outputs: 0 } => {
            "the board's scene names no spare output: [[io.outputs]] would".into()
        }
        Refusal::NoOutput { outputs } => {
            let last = outputs - 1;
            format!("the board's scene names {outputs} spare outputs, of the numbers 0 to {last}")
        }
        Refusal::OutputsFull => {
            "the board has no room for more changes of outputs with moves yet".into()
        }
        Refusal::StartVelocity => "it does not start as fast as the last one ends".into(),
        Refusal::Tool => "the tool's power is not from 0 to 1, or its speed negative".into(),
        Refusal::NotAdjustable => "the board's image holds no code to change its scene".into(),
        Refusal::NotInImage => {
            "the board's image holds no code for such links, loads or such a centre of mass".into()
        }
        Refusal::NoSuchLeg => "there is no such leg".into(),
        Refusal::Parameter { quantity, leg } => {
            let leg = of_leg(*leg);
            format!("{quantity}{leg} cannot be built")
        }
        Refusal::NoPose => "with the new geometry, no pose fits the motors' angles".into(),
        Refusal::Recovery(found) => violation(found, ticks, units),
        Refusal::Busy => "the board's tick has not taken the commands before this one".into(),
        Refusal::NoHoming => {
            "the scene has no [homing]: the board knows where its motors are".into()
        }
        Refusal::NoUpdate => {
            "the machine's program cannot be replaced over the line: a simulator has no flash; a board needs update = true in \
             [service] of its scene, its boot loader, and to be flashed with a probe once"
                .into()
        }
        Refusal::Update(refusal) => update(refusal),
    }
}

/// The leg of a quantity, behind it.
fn of_leg(leg: Option<u8>) -> String {
    leg.map_or_else(String::new, |leg| format!(" of leg {}", u32::from(leg) + 1))
}

/// Describes the reason why a step of an update was not taken, and what to do.
fn update(refusal: &UpdateRefusal) -> String {
    match refusal {
        UpdateRefusal::Board => {
            "the image is for another board: build it with the board that the machine tells, BOARD=NAME cargo fw".into()
        }
        UpdateRefusal::Chip => {
            "the image is for another chip: build it with the board that the machine tells, BOARD=NAME cargo fw".into()
        }
        UpdateRefusal::Start { expected } => format!(
            "the image does not begin at {expected:#010x}: build it from a scene with update = true in [service]"
        ),
        UpdateRefusal::Length { longest } => {
            format!("the image is longer than {longest} bytes, or empty")
        }
        UpdateRefusal::NotBegun => "no image was begun: send it again".into(),
        UpdateRefusal::Block { expected } => format!(
            "the bytes are not those that follow ({expected} are there): has the board two clients?"
        ),
        UpdateRefusal::Checksum { found } => format!(
            "the image in the flash has the checksum {found:#010x} and not its own: send it again"
        ),
        UpdateRefusal::Flash { place, status } => format!(
            "the flash cannot be written at {place:#x} (status {status:#x}): send the image again; if that fails, too, the flash is worn out"
        ),
        UpdateRefusal::JournalFull => {
            "the journal of updates has no room: restart the board, and send the image again".into()
        }
        UpdateRefusal::NoScene => "the board's image takes no scene over the line: build one with scene_over_line = true in \
             [service], and send it by `trirrr update`"
            .into(),
        UpdateRefusal::SceneLayout => {
            "the board does not read the values of the scene: send them by the trirrr of the version that it runs, or \
             update its program"
                .into()
        }
        UpdateRefusal::SceneNeeds(need) => {
            let need = scene_need(*need);
            format!("the board's image lacks what the scene needs: {need}")
        }
        UpdateRefusal::SceneValue { quantity, leg } => {
            let leg = of_leg(*leg);
            format!("the board cannot build the scene: {quantity}{leg}")
        }
        UpdateRefusal::SceneStart => {
            "the machine of the scene cannot stand at the start of its job: change [job] start or the machine".into()
        }
    }
}

/// Names a part of a scene that an image may lack, and where the scene has it.
pub fn scene_need(need: SceneNeed) -> &'static str {
    match need {
        SceneNeed::Torques => "torques (torque is not false)",
        SceneNeed::PayloadOffset => {
            "a centre of mass off the reference point (com_m in [platform])"
        }
        SceneNeed::Rotors => "rotor inertia (rotor_inertia_kgm2, or that of [[drive]])",
        SceneNeed::LinkMasses => "masses of links (proximal and distal in [[machine.leg]])",
        SceneNeed::Gravity => "gravity in the plane (gravity_m_s2, mounted)",
        SceneNeed::Quintics => "quintic moves (accelerations in [[job.move]], a path, plans_paths)",
        SceneNeed::Jerk => "a limit of jerk (jerk_rad_s3 in [limits])",
        SceneNeed::Paths => "a planner of paths (plans_paths in [service])",
        SceneNeed::Batches => "batches of moves (batches in [service], short or planned moves)",
        SceneNeed::PowerLists => "room for so many levels of power (power_lists in [service])",
        SceneNeed::Number => "its number type (number)",
        SceneNeed::TickRate => "its tick rate (tick_rate_hz)",
        SceneNeed::Drives => {
            "its drives (kind and constants of [[drive]], but steps and gears of steppers)"
        }
        SceneNeed::Brake => "its brake (brake in [power], there or not)",
        SceneNeed::ToolOutput => "its output to the tool ([tool])",
        SceneNeed::Inputs => "its inputs, or spare inputs and outputs ([inputs], [io])",
        SceneNeed::Lamp => "its status lamp (there or not)",
        SceneNeed::Homing => {
            "its kind of homing ([homing], there or not, kind and level of its switches)"
        }
        SceneNeed::Feedback => "feedback of the drives ([feedback], there or not)",
        SceneNeed::Contact => {
            "detection of contacts ([contact], there or not, with a retreat or without)"
        }
    }
}
