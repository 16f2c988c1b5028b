//! Reading a whole scene: its tables, then its job.

use crate::contact::{ContactNeeds, read_contact};
use crate::controller::{Controller, read_controller};
use crate::drive::{Drive, DriveKind, read_drives};
use crate::error::SceneError;
use crate::feedback::read_feedback;
use crate::homing::{PlacedHoming, read_homing};
use crate::homing_path::check_homing;
use crate::inputs::read_inputs;
use crate::io::read_io;
use crate::job::{PlacedJob, read_job};
use crate::kind::refuse_redundant;
use crate::limits::read_limits;
use crate::machine::read_parameters;
use crate::number_type::NumberType;
use crate::own_job::check_tables;
use crate::path::check_job;
use crate::planning::plan_path;
use crate::plant::read_plant;
use crate::power::{read_power, read_reactions};
use crate::read::{
    Bound, Document, MachineTexts, Place, Section, Setting, did_you_mean, on_disk, text_of,
    with_scene_from,
};
use crate::scene::Scene;
use crate::service::read_service;
use crate::tolerances::read_tolerances;
use crate::tool::{check_tool, read_tool_port};
use std::path::Path;
use trirrr_core::limits::LimitParameters as Limits;
use trirrr_core::machine::Geometry;
use trirrr_service::key;

/// Slowest and fastest tick rate, Hz.
const TICK_RATE_HZ: (f64, f64) = (1.0, 100_000.0);

/// Keys of the scene itself; the rest stands in tables.
const TOP_KEYS: &[&str] = &[
    "kind",
    "name",
    "description",
    "machine",
    "board",
    "tick_rate_hz",
    "number",
    "torque",
    "gravity_m_s2",
    "mounted",
];

impl Scene {
    /// Reads and checks the scene in `file`.
    ///
    /// # Errors
    /// [`SceneError`] with everything found wrong.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::read_set(file, &[])
    }

    /// Reads the scene in `file` with `settings` in place of its own values.
    ///
    /// # Errors
    /// [`SceneError`] with everything found wrong.
    pub fn read_set(file: impl AsRef<Path>, settings: &[Setting]) -> Result<Self, SceneError> {
        let file = file.as_ref();
        Self::parse_set(&text_of(file)?, &file.display().to_string(), settings)
    }

    /// Checks the scene in `text`; `file` is named in errors, and the file of the machine is looked for beside it.
    ///
    /// # Errors
    /// [`SceneError::Refused`] with everything found wrong. Poses and paths are only looked at
    /// once nothing else is wrong.
    pub fn parse(text: &str, file: &str) -> Result<Self, SceneError> {
        Self::parse_set(text, file, &[])
    }

    /// Checks the scene in `text` with `settings` in place of its own values, as [`parse`](Self::parse).
    ///
    /// # Errors
    /// [`SceneError::Refused`] with everything found wrong.
    pub fn parse_set(text: &str, file: &str, settings: &[Setting]) -> Result<Self, SceneError> {
        Self::parse_in(text, file, settings, &on_disk, ReadDepth::Whole, &mut None)
    }

    /// Reads as [`parse_set`](Self::parse_set), and looks at no pose: the job may ask for what the machine cannot do. A path is not
    /// planned, so that a job with a path has no moves. Such a scene can be looked at, and not played.
    ///
    /// # Errors
    /// [`SceneError::Refused`] with every value that is refused.
    pub fn draft_set(text: &str, file: &str, settings: &[Setting]) -> Result<Self, SceneError> {
        Self::parse_in(text, file, settings, &on_disk, ReadDepth::Values, &mut None)
    }

    /// Reads as [`draft_set`](Self::draft_set), and takes the file of the machine from `machines`.
    ///
    /// # Errors
    /// As there.
    pub fn draft_from(text: &str, file: &str, machines: &MachineTexts) -> Result<Self, SceneError> {
        Self::parse_in(text, file, &[], machines, ReadDepth::Values, &mut None)
    }

    /// Reads the scene in `file` with `settings`, of which only the job is refused: its moves break a limit, or the machine cannot follow
    /// them; a path without a plan has no moves. None of a scene that is good, or wrong in another way. It must not be played.
    pub fn read_refused(file: impl AsRef<Path>, settings: &[Setting]) -> Option<Self> {
        let file = file.as_ref();
        let (text, name) = (text_of(file).ok()?, file.display().to_string());
        let (read, refused) = Self::parse_shown(&text, &name, settings, &on_disk);
        refused.filter(|_| read.is_err())
    }

    /// Checks as [`parse_set`](Self::parse_set), and returns the scene of which only the job is refused beside the refusal, to be shown and
    /// not played: [`read_refused`](Self::read_refused). The file of the machine is taken from `machines`.
    pub fn parse_shown(
        text: &str,
        file: &str,
        settings: &[Setting],
        machines: &MachineTexts,
    ) -> (Result<Self, SceneError>, Option<Self>) {
        let mut refused = None;
        let whole = ReadDepth::Whole;
        let read = Self::parse_in(text, file, settings, machines, whole, &mut refused);
        (read, refused)
    }

    /// `refused` is set where the machine or its job is refused once everything else is right.
    fn parse_in(
        text: &str,
        file: &str,
        settings: &[Setting],
        machines: &MachineTexts,
        depth: ReadDepth,
        refused: &mut Option<Self>,
    ) -> Result<Self, SceneError> {
        with_scene_from(
            text,
            file,
            settings,
            TOP_KEYS,
            machines,
            |document, root, whole| {
                let key = key(whole.keyed().as_bytes());
                let (mut scene, placed, homing, places) =
                    read_scene(document, root, key, depth, refused)
                        .filter(|_| document.is_clean())?;
                scene.machine_file = whole.machine_file.clone();
                if depth == ReadDepth::Whole {
                    check_machine(document, &scene, &placed, homing.as_ref(), &places);
                }
                if !document.is_clean() {
                    *refused = Some(scene.clone());
                }
                Some(scene)
            },
        )
    }
}

/// Extent to which a scene is looked at.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ReadDepth {
    /// Each value.
    Values,
    /// Poses, moves and paths, too.
    Whole,
}

/// Reads `tick_rate_hz`.
pub fn read_rate(root: &Section) -> Option<f64> {
    let (slowest, fastest) = TICK_RATE_HZ;
    root.number("tick_rate_hz", Bound::Within(slowest, fastest))
}

/// Shipped boards by the names of their files, without the folder and the end.
pub const BOARDS: [&str; 4] = ["feather-f405", "generic-f405", "nucleo-g474re", "pico"];

/// Returns true if a board is named by the path of its file.
pub fn is_board_file(board: &str) -> bool {
    board.ends_with(".toml") || board.contains(['/', '\\'])
}

/// Reads `board`. The build of an image looks for a file of the user's own; other programs have no use for it.
fn read_board(root: &Section) -> Option<String> {
    let board = root.text("board")?;
    if !is_board_file(&board) && !BOARDS.contains(&board.as_ref()) {
        let boards = BOARDS.map(|board| format!("\"{board}\"")).join(", ");
        let meant = did_you_mean(&board, &BOARDS);
        root.refuse(
            "board",
            format!("must be a shipped board, {boards}, or the path of a board file, which ends in .toml{meant}"),
        );
        return None;
    }
    Some(board.into_owned())
}

fn read_scene(
    document: &Document,
    root: &Section,
    key: u32,
    depth: ReadDepth,
    refused: &mut Option<Scene>,
) -> Option<(Scene, PlacedJob, Option<PlacedHoming>, Places)> {
    refuse_redundant(root)?;
    let name = root.folder_name("name");
    let description = root.optional_text("description").unwrap_or_default();
    let board = match root.has("board") {
        true => read_board(root).map(Some),
        false => Some(None),
    };
    let rate = read_rate(root);
    let number = match root.has("number") {
        true => root.choice("number", &NumberType::NAMES),
        false => Some(NumberType::F64),
    };
    let torque = match root.has("torque") {
        true => root.boolean("torque"),
        false => Some(true),
    };
    let drives = read_drives(root);
    let (parameters, tools) = read_parameters(root, drives.flatten()).unzip();
    let tools = tools.flatten();
    let tolerances = read_tolerances(root, parameters.as_ref());
    let limits = read_limits(root);
    let power = read_power(root, rate);
    let reactions = read_reactions(root);
    let measures = drives.flatten().is_some_and(|[drive, ..]| drive.measures());
    let feedback = read_feedback(root, rate, measures);
    let needs = ContactNeeds {
        rate,
        number,
        torque,
        drive: drives
            .flatten()
            .map(|[drive, ..]| drive)
            .filter(Drive::measures),
    };
    let of_contact = reactions.map(|(_, contact)| contact);
    let contact = read_contact(root, &needs, of_contact);
    let tool = read_tool_port(
        root,
        rate,
        drives.flatten().as_ref().map(|[drive, ..]| drive),
    );
    let service = read_service(root, rate, obstacle_to_planner(number, limits.as_ref()));
    if tools.is_some() && service.is_some_and(|service| !service.adjustable) {
        let reason = "an exchanged tool is another platform for the board, which takes one only with \
                      adjustable = true in [service]";
        root.refuse_list("tools", reason);
    }
    let controller = read_controller(root, rate);
    let plant = read_plant(root, drives, controller);
    if torque == Some(false) {
        refuse_torques(
            root,
            limits.as_ref(),
            drives.flatten().as_ref(),
            controller.flatten().as_ref(),
        );
    }
    let homing = read_homing(root, rate, limits.as_ref(), drives.flatten().as_ref());
    let inputs = read_inputs(root, rate, homing.as_ref());
    let io = read_io(root, rate);
    let placed = read_job(document, root, rate, io.as_ref().map(|(_, pins)| pins))?;
    let homing = homing?;
    let (has_lamp, spare_pins) = io?;
    let plant = plant?;
    let mut scene = Scene {
        key,
        machine_file: None,
        name: name?,
        description: description.into_owned(),
        board: board?,
        tick_rate_hz: rate?,
        number: number?,
        torque: torque?,
        parameters: parameters?,
        tools,
        drives: drives?,
        limits: limits?,
        service: service?,
        power: power?,
        reactions: reactions?.0,
        feedback: feedback?,
        contact: contact?,
        tool: tool?,
        inputs: inputs?,
        has_lamp,
        spare_pins,
        homing: homing.as_ref().map(|placed| placed.homing),
        job: placed.job.clone(),
        controller: controller?,
        plant: None,
        tolerances: tolerances?,
    };
    check_tables(root, &scene);
    if let Some(port) = &scene.tool {
        check_tool(document, port, &placed, scene.tick_rate_hz);
    }
    // A plan of a machine that is refused would only repeat why.
    if let Some(path) = &placed.path
        && document.is_clean()
    {
        match depth {
            ReadDepth::Whole => {
                if plan_path(document, &mut scene, path).is_none() {
                    scene.job.path = Some(path.path.clone());
                    *refused = Some(scene);
                    return None;
                }
            }
            ReadDepth::Values => scene.job.path = Some(path.path.clone()),
        }
    }
    if let Some(plant) = plant.filter(|_| depth == ReadDepth::Whole) {
        let duration_s = f64::from(scene.ticks()) / scene.tick_rate_hz;
        scene.plant = Some(plant.checked(root, duration_s)?);
    }
    if let Some(reason) = scene.open_end() {
        let place = Place {
            value: None,
            ..root.place_of("job")
        };
        document.refuse(&place, reason);
    }
    let places = Places {
        legs: Place {
            value: None,
            ..root.place_of("machine")
        },
        number: root.place_of("number"),
    };
    Some((scene, placed, homing, places))
}

/// Places in the file at which the machine and its number type are refused.
struct Places {
    legs: Place,
    number: Place,
}

/// Reason why the machine plans no paths, if there is one.
fn obstacle_to_planner(
    number: Option<NumberType>,
    limits: Option<&Limits>,
) -> Option<&'static str> {
    if number == Some(NumberType::Fixed) {
        return Some("needs a number type with a floating point: f32, micromath or f64");
    }
    let jerk = limits.is_some_and(|limits| limits.jerk_rad_s3.is_some());
    jerk.then_some("knows no limit of jerk: leave [limits] jerk_rad_s3 out, or plan on the host")
}

/// Refuses what asks for torques in a scene that computes none.
fn refuse_torques(
    root: &Section,
    limits: Option<&Limits>,
    drives: Option<&[Drive; 3]>,
    controller: Option<&Controller>,
) {
    let limited = limits.map_or([false; 2], |limits| {
        [limits.torque_nm.is_some(), limits.power_w.is_some()]
    });
    let bldc = drives.is_some_and(|drives| {
        let is_bldc = |drive: &Drive| matches!(drive.kind, DriveKind::Bldc(_));
        drives.iter().any(is_bldc)
    });
    let feed_forward = controller.is_some_and(|controller| controller.feed_forward);
    for (asks, what) in [
        (limited[0], "[limits] torque_nm"),
        (limited[1], "[limits] power_w"),
        (bldc, "a [[drive]] of kind \"bldc\""),
        (
            feed_forward,
            "[controller] feed_forward, which is true unless it says false,",
        ),
    ] {
        if asks {
            root.refuse(
                "torque",
                format!("{what} needs the torques that this leaves out"),
            );
        }
    }
}

/// Checks the poses and paths of the scene, which need a machine that is right in itself.
fn check_machine(
    document: &Document,
    scene: &Scene,
    placed: &PlacedJob,
    homing: Option<&PlacedHoming>,
    Places { legs, number }: &Places,
) {
    let geometry = match Geometry::<f64>::build(&scene.parameters) {
        Ok(geometry) => geometry,
        Err(error) => return document.refuse(legs, error.to_string()),
    };
    if scene.parameters.greatest_det_a() <= 0.0 {
        let reason = "the three platform joints fall together: nothing holds the platform's angle";
        return document.refuse(legs, reason);
    }
    if let Err(error) = check_job(document, scene, placed, number, geometry) {
        document.refuse(legs, error.to_string());
    }
    if let Some(homing) = homing {
        check_homing(document, scene, homing, geometry);
    }
}
