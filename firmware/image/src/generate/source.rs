//! The text that an image includes.

use super::constant::constant;
use super::kinds::{Machine, ModelPath};
use super::{COARSE, FIXED, autonomous, drive, over_line};
use nalgebra::Vector3;
use std::error::Error;
use std::fmt::Write;
use trirrr_core::machine::Geometry;
use trirrr_core::number::{Coarse, Fixed};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::scene::{Section, SectionName};
use trirrr_protocol::wire::schema::longest;
use trirrr_scene::{NormalContact, Scene, offer};
use trirrr_service::coefficients::{
    ContactCoefficients, FeedbackCoefficients, HomingCoefficients, SceneValues,
};
use trirrr_service::{ServiceNumber, Settings, key};

/// The whole file, for the Rust type `scalar`, in the units that it needs. Every number is written
/// so that it is read back as the same bits.
///
/// # Errors
/// A quantity that does not fit the number type; a number type that no image is built for.
pub fn source(scene: &Scene, scalar: &str) -> Result<String, Box<dyn Error>> {
    match scalar {
        "f64" => source_in::<f64>(scene, scalar),
        "f32" => source_in::<f32>(scene, scalar),
        FIXED => source_in::<Fixed>(scene, scalar),
        COARSE => source_in::<Coarse>(scene, scalar),
        _ => Err(format!("{scalar}: no image is built for it").into()),
    }
}

fn source_in<N: ServiceNumber>(scene: &Scene, scalar: &str) -> Result<String, Box<dyn Error>> {
    let units = trirrr_scene::units::<N>(scene)?;
    let parameters = &units.parameters(&scene.parameters);
    let limits = &units.limits(&scene.limits);
    let job = scene.job.in_units(&units);
    let period = units.time(scene.period_s());
    let kind = scene.model();
    let machine = Machine {
        kind,
        parameters,
        limits,
        ramp: scene.ramp(),
        period,
    };
    let coefficients_source = kind.visit::<N, _>(machine)?;
    let mut file = File(String::new());
    file.line(&format!("pub type Scalar = {scalar};"));
    let model = kind.visit_image::<N, _>(ModelPath);
    file.line(&format!("pub type Model = {model};"));
    let curves = match (limits.jerk_rad_s3.is_some(), scene.plays_quintics()) {
        (true, _) => "Quintics<true>",
        (false, true) => "Quintics<false>",
        (false, false) => "Cubics",
    };
    file.line(&format!(
        "pub type Curves = trirrr_core::setpoint::{curves};"
    ));
    let planner = match scene.service.plans_paths {
        true => format!(
            "trirrr_plan::window::ServicePlanner<Scalar, {}, {}>",
            offer::PIECES,
            offer::CELLS
        ),
        false => "()".into(),
    };
    file.line(&format!("pub type Planner = {planner};"));
    features(&mut file, scene, scalar);
    let can_feel = scene.contact.is_none() || scalar != FIXED;
    file.constant("CAN_FEEL", "bool", can_feel.to_string());
    let has_steppers = drive::kind(scene) == drive::STEPPER;
    file.constant("HAS_STEPPERS", "bool", has_steppers.to_string());
    file.constant("NAME", "&str", format!("{:?}", scene.name));
    file.constant("TICK_RATE_HZ", "f64", format!("{:?}", scene.tick_rate_hz));
    file.constant("PERIOD_S", "f64", format!("{:?}", scene.period_s()));

    // What the service is built from.
    let start = &job.start;
    let start = Pose::<N>::from_f64(start.position.x, start.position.y, start.angle);
    let start = (constant(&start), "trirrr_core::setpoint::Pose<Scalar>");
    file.constant("START", start.1, start.0);
    let settings = settings(&trirrr_scene::settings::<N>(scene, &units));
    let service = "trirrr_service";
    file.constant(
        "SETTINGS",
        &format!("{service}::Settings<Scalar>"),
        settings,
    );
    let coefficients = format!("{service}::coefficients::Coefficients<Model>");
    file.global("COEFFICIENTS", &coefficients, coefficients_source);
    file.line(machine_source(scene.service.adjustable));
    let (parameters_type, limits_type) = (
        "trirrr_core::machine::Parameters",
        "trirrr_core::limits::LimitParameters",
    );
    file.constant("PARTS", &format!("{service}::Parts"), parts(scene)?);

    if scene.service.scene_over_line {
        let types = over_line::types(scene, scalar)?;
        // Scenes that an image of another scene or other types has taken are none of this one.
        let owner = format!("{types:?} {} {}", scene.key, SceneValues::LAYOUT);
        file.constant("SCENE_OWNER", "u32", key(owner.as_bytes()).to_string());
        let types_type = "trirrr_protocol::message::SceneTypes";
        file.constant("TYPES", types_type, constant(&types));
    }

    if let Some(own) = &scene.service.autonomous {
        autonomous::write::<N>(&mut file, scene, own, machine)?;
    }

    if let Some(homing) = &scene.homing {
        let parameters = homing.parameters(scene, &units)?;
        let coefficients = HomingCoefficients::<N>::build(&parameters, period);
        let homing_type = format!("{service}::coefficients::HomingCoefficients<Scalar>");
        file.global("HOMING", &homing_type, constant(&coefficients));
    }
    let active_high = scene
        .homing
        .as_ref()
        .is_some_and(|homing| homing.active_high);
    file.constant("HOMING_ACTIVE_HIGH", "bool", active_high.to_string());

    // A contact to ground of an input that is pulled up: high while it is open.
    for (name, normally) in [
        ("DOOR_OPEN_HIGH", scene.inputs.door_normally),
        ("PROBE_TOUCHES_HIGH", scene.inputs.probe_normally),
        ("LIMITS_HIGH", scene.inputs.limits_normally),
    ] {
        let is_high = normally == NormalContact::Closed;
        file.constant(name, "bool", is_high.to_string());
    }
    let active_high = scene.spare_pins.active_high();
    file.constant("INPUTS_ACTIVE_HIGH", "u8", active_high.to_string());
    let named = (1_u16 << scene.spare_pins.parameters().inputs) - 1;
    file.constant("INPUTS_NAMED", "u8", named.to_string());

    if let Some(feedback) = &scene.feedback {
        let geometry = Geometry::<N>::build(parameters)?;
        let start = Pose::from_f64(job.start.position.x, job.start.position.y, job.start.angle);
        let feedback = feedback.parameters(scene.tick_rate_hz);
        let coefficients =
            FeedbackCoefficients::<N>::build(&feedback, parameters, &geometry, start)
                .ok_or("the start is out of reach")?;
        let feedback_type = format!("{service}::coefficients::FeedbackCoefficients<Scalar>");
        file.global("FEEDBACK", &feedback_type, constant(&coefficients));
    }

    if let Some(contact) = &scene.contact {
        let parameters = contact.parameters(scene.tick_rate_hz);
        // None in fixed point: an image with it is refused, by `CAN_FEEL`.
        if let Some(coefficients) = ContactCoefficients::<N>::build(&parameters, scene.period_s()) {
            let contact_type = format!("{service}::coefficients::ContactCoefficients<Scalar>");
            file.global("CONTACT", &contact_type, constant(&coefficients));
        }
    }

    file.line(&parts_source(scene, scalar));

    // What measurements are made from: the description, and the job, in the machine's units.
    file.constant("UNITS", "trirrr_core::units::Units", constant(&units));
    file.constant("PERIOD", "f64", format!("{period:?}"));
    file.constant(
        "RAMP",
        "trirrr_service::paces::Ramp",
        constant(&scene.ramp()),
    );
    file.constant("PARAMETERS", parameters_type, constant(parameters));
    file.constant("LIMITS", limits_type, constant(limits));
    let mut moves = String::from("[\n");
    for each in &job.moves {
        writeln!(moves, "    {},", move_source(each))?;
    }
    moves.push(']');
    let moves_type = format!("[trirrr_image::Move; {}]", job.moves.len());
    file.global("MOVES", &moves_type, moves);
    Ok(file.0)
}

/// The features that the scene has, each as a type: [`On`](trirrr_service::features::On), or `()`; the scene with them, and with `U` as the
/// place of another program.
fn features(file: &mut File, scene: &Scene, scalar: &str) {
    let interlocks = &scene.inputs.interlocks;
    let bits = [
        ("STOP", interlocks.emergency_stop.is_some()),
        ("DOOR", interlocks.door.is_some()),
        ("LIMITS", interlocks.limits.is_some()),
    ];
    let named = bits.iter().filter(|(_, is_named)| *is_named);
    let named: Vec<String> = named
        .map(|(name, _)| format!("trirrr_service::features::input_bits::{name}"))
        .collect();
    let inputs = match named.is_empty() {
        true => "0".into(),
        false => named.join(" | "),
    };
    let feels = scene.contact.filter(|_| scalar != FIXED);
    let mut declared = String::new();
    for (name, has, bits) in [
        ("Batches", scene.takes_batches(), None),
        ("Levels", scene.service.power_lists > 0, None),
        ("Homing", scene.homing.is_some(), None),
        ("Feedback", scene.feedback.is_some(), None),
        ("Contact", feels.is_some(), None),
        ("Retreat", feels.is_some_and(|it| it.retreat_s > 0.0), None),
        ("Interlocks", scene.inputs.are_named(), Some(inputs)),
        ("Probe", interlocks.probe.is_some(), None),
        ("Digital", scene.spare_pins.are_named(), None),
    ] {
        feature(file, name, has, bits);
        // The place of another program stands behind the moves in batches.
        let update = if name == "Batches" {
            ", update = U"
        } else {
            ""
        };
        // Without a host there are no others.
        if scene.service.autonomous.is_none() || ["Homing", "Interlocks"].contains(&name) {
            declared += &format!(", {} = {name}{update}", name.to_lowercase());
        }
    }
    file.line(&format!(
        "trirrr_service::scene! {{\n#[allow(dead_code)]\npub ImageScene [U: trirrr_service::features::ImageSlot] [U]: \
         Machine{declared}\n}}"
    ));
    for (name, has) in [
        // Pins of the interlocks.
        ("StopPin", interlocks.emergency_stop.is_some()),
        ("DoorPin", interlocks.door.is_some()),
        ("ButtonPin", scene.inputs.button.is_some()),
        ("LimitPins", scene.inputs.has_limit_pins()),
        ("LimitsAtHoming", scene.inputs.limits_share_homing),
    ] {
        feature(file, name, has, None);
    }
    let levels = scene.service.power_lists.to_string();
    file.constant("LEVELS", "usize", levels);
}

/// A feature as a type, with its `bits`.
fn feature(file: &mut File, name: &str, has: bool, bits: Option<String>) {
    let feature = match (has, bits) {
        (false, _) => "()".into(),
        (true, None) => "trirrr_service::features::On".into(),
        (true, Some(bits)) => format!("trirrr_service::features::On<{{ {bits} }}>"),
    };
    file.line(&format!(
        "#[allow(dead_code)]\npub type {name} = {feature};"
    ));
}

/// The machine with its limits: clients may change them, or the coefficients are in the image.
fn machine_source(is_adjustable: bool) -> &'static str {
    match is_adjustable {
        true => {
            "pub type Machine = trirrr_service::Adjustable<Model, Curves, Planner>;\n\
             #[allow(dead_code)]\npub fn machine() -> Machine { Machine::new(PARAMETERS, LIMITS) }"
        }
        false => {
            "pub type Machine = trirrr_service::board::Compiled<'static, Model, Curves, Planner>;\n\
             #[allow(dead_code)]\npub fn machine() -> Machine {\n\
             Machine { coefficients: &COEFFICIENTS, parts: PARTS, types: core::marker::PhantomData }\n}"
        }
    }
}

/// The function that makes the values of the features, around a machine.
fn parts_source(scene: &Scene, scalar: &str) -> String {
    let value = |has: bool, name: &str| match has {
        true => format!("Some(&{name})"),
        false => "None".into(),
    };
    let feels = scene.contact.is_some() && scalar != FIXED;
    format!(
        "#[allow(dead_code)]\npub fn parts<S: trirrr_service::Scene<N = Scalar>>(machine: S::Machine, update: S::Update) -> \
         trirrr_service::SceneParts<'static, S> {{\n\
         trirrr_service::SceneParts {{ machine, update, levels: {}, homing: {}, feedback: {}, contact: {}, \
         interlocks: {}, digital: {} }}\n}}",
        scene.service.power_lists,
        value(scene.homing.is_some(), "HOMING"),
        value(scene.feedback.is_some(), "FEEDBACK"),
        value(feels, "CONTACT"),
        constant(&scene.inputs.interlocks),
        constant(&scene.spare_pins.parameters()),
    )
}

/// The parts of the scene, as the bytes that they are sent as.
fn parts(scene: &Scene) -> Result<String, Box<dyn Error>> {
    let part = |name| {
        let section = Section::of(name, &scene.parameters, &scene.limits);
        let section = section.ok_or("a machine has three legs")?;
        let mut room = [0; longest::<Section>()];
        let bytes = postcard::to_slice(&section, &mut room)?;
        Ok::<_, Box<dyn Error>>(format!("&{bytes:?}"))
    };
    let [a, b, c] = [0, 1, 2].map(|leg| part(SectionName::Leg(leg)));
    Ok(format!(
        "trirrr_service::Parts {{ legs: [{}, {}, {}], platform: {}, limits: {} }}",
        a?,
        b?,
        c?,
        part(SectionName::Platform)?,
        part(SectionName::Limits)?,
    ))
}

/// The text so far.
pub(super) struct File(String);

impl File {
    fn line(&mut self, line: &str) {
        self.0.push_str(line);
        self.0.push('\n');
    }

    fn item(&mut self, kind: &str, name: &str, of: &str, value: &str) {
        // No image needs all of it.
        self.line("#[allow(dead_code)]");
        self.line(&format!("pub {kind} {name}: {of} = {value};"));
    }

    /// A value that is copied where it is used,
    pub(super) fn constant(&mut self, name: &str, of: &str, value: String) {
        self.item("const", name, of, &value);
    }

    /// and one that has a place, in flash.
    pub(super) fn global(&mut self, name: &str, of: &str, value: String) {
        self.item("static", name, of, &value);
    }
}

fn move_source(each: &trirrr_scene::JobMove) -> String {
    let pose = |pose: &Pose<f64>| constant(&[pose.position.x, pose.position.y, pose.angle]);
    let velocity = |velocity: Vector3<f64>| constant(&<[f64; 3]>::from(velocity));
    let (from, to, ticks) = (pose(&each.from), pose(&each.to), each.duration_ticks);
    let kind = "trirrr_image::Move";
    if let Some([start, end]) = each.accelerations {
        let [v0, v1] = [each.start_velocity, each.end_velocity].map(velocity);
        let [a0, a1] = [start, end].map(velocity);
        return format!(
            "{kind}::Quintic {{ poses: [{from}, {to}], velocities: [{v0}, {v1}], \
             accelerations: [{a0}, {a1}], ticks: {ticks} }}"
        );
    }
    if each.ends::<f64>().is_rest_to_rest() {
        return format!("{kind}::RestToRest {{ from: {from}, to: {to}, ticks: {ticks} }}");
    }
    let (start, end) = (velocity(each.start_velocity), velocity(each.end_velocity));
    format!(
        "{kind}::Hermite {{ from: {from}, from_velocity: {start}, to: {to}, to_velocity: {end}, \
         ticks: {ticks} }}"
    )
}

/// The settings, for the board of a host: the firmware puts its own board in.
fn settings<N: ServiceNumber>(settings: &Settings<N>) -> String {
    let Settings {
        period,
        ramp,
        host_timeout_ticks,
        telemetry_every,
        power,
        reactions,
        planning,
        scene,
        board: _,
        firmware: _,
    } = settings;
    format!(
        "trirrr_service::Settings {{ period: {}, ramp: {}, \
         host_timeout_ticks: {host_timeout_ticks}, telemetry_every: {telemetry_every}, \
         power: {}, reactions: {}, planning: {}, scene: {}, board: trirrr_protocol::message::Board::HOST, \
         firmware: &trirrr_protocol::message::Firmware::SIMULATOR }}",
        constant(period),
        constant(ramp),
        constant(power),
        constant(reactions),
        planning.map_or("None".into(), |planning| format!(
            "Some({})",
            constant(&planning)
        )),
        constant(scene),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn shipped(name: &str) -> String {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let scene = Scene::read(scenes.join(name)).expect("a shipped scene is good");
        source(&scene, "f32").expect("SI units")
    }

    #[test]
    fn a_scene_gets_the_types_it_needs_and_no_others() {
        for (name, kind) in [
            ("thesis.toml", "Massless"),
            (
                "thesis-links.toml",
                "Massive<f32, trirrr_core::torque::links::Horizontal>",
            ),
            (
                "vertical.toml",
                "Massive<f32, trirrr_core::torque::links::InPlane<f32>>",
            ),
        ] {
            let text = shipped(name);
            let line = text
                .lines()
                .find(|line| line.starts_with("pub type Model = "));
            let line = line.expect("an image has a model");
            let links = format!(", trirrr_core::torque::links::{kind}>;");
            assert!(line.ends_with(&links), "{name}: {line}");
        }
    }

    #[test]
    fn tolerances_are_not_in_an_image() {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let scene = Scene::read(scenes.join("vertical.toml")).expect("a shipped scene is good");
        assert!(scene.tolerances.is_some());
        let exact = Scene {
            tolerances: None,
            ..scene.clone()
        };
        let source = |scene: &Scene| source(scene, "f32").expect("SI units");
        assert_eq!(source(&scene), source(&exact));
    }

    #[test]
    fn a_scene_with_power_lists_has_their_room_and_no_other_has() {
        let text = shipped("paths/raster.toml");
        assert!(text.contains("pub const LEVELS: usize = 4096;\n"));
        assert!(text.contains("pub type Levels = trirrr_service::features::On;\n"));
        assert!(shipped("engraving.toml").contains("pub type Levels = ();\n"));
    }

    #[test]
    fn a_scene_with_inputs_has_their_settings_and_no_other_has() {
        let text = shipped("inputs/guarded.toml");
        for line in [
            "emergency_stop: Some(trirrr_service::features::EmergencyStop { debounce_ticks: 3, category: trirrr_service::StopCategory::StopThenOff, })",
            "door: Some(trirrr_service::features::Door { debounce_ticks: 10, })",
            "pub type Interlocks = trirrr_service::features::On<{ trirrr_service::features::input_bits::STOP | trirrr_service::features::input_bits::DOOR }>;",
            "pub type Probe = ();",
            "pub const DOOR_OPEN_HIGH: bool = true;",
        ] {
            assert!(text.contains(line), "{line}");
        }
        let text = shipped("inputs/probing.toml");
        for line in [
            "probe: Some(trirrr_service::features::ProbeInput { debounce_ticks: 2, })",
            "limits: Some(trirrr_service::features::LimitInputs { debounce_ticks: 2, })",
            "trirrr_service::features::input_bits::STOP | trirrr_service::features::input_bits::DOOR | trirrr_service::features::input_bits::LIMITS }>;",
            "pub type Probe = trirrr_service::features::On;",
            "pub const PROBE_TOUCHES_HIGH: bool = false;",
            "pub const LIMITS_HIGH: bool = true;",
            "limit_switch: trirrr_service::StopCategory::StopAndHold",
        ] {
            assert!(text.contains(line), "{line}");
        }
        assert!(shipped("engraving.toml").contains("pub type Interlocks = ();\n"));
    }

    #[test]
    fn a_scene_with_spare_pins_has_their_settings_and_no_other_has() {
        let text = shipped("inputs/valves.toml");
        for line in [
            "trirrr_service::features::DigitalParameters { outputs: 2, in_jobs: 1, inputs: 1, debounce_ticks: [10, 1, 1, 1, 1, 1, 1, 1], }",
            "pub const INPUTS_ACTIVE_HIGH: u8 = 0;",
            "pub type Digital = trirrr_service::features::On;",
        ] {
            assert!(text.contains(line), "{line}\n{text}");
        }
        assert!(shipped("inputs/probing.toml").contains("pub type Digital = ();\n"));
    }

    #[test]
    fn moves_are_written_with_every_digit_and_their_kind() {
        let text = shipped("thesis.toml");
        // pi/20 and pi/15, as they are read back.
        let (from, to) = (core::f64::consts::PI / 20.0, core::f64::consts::PI / 15.0);
        let line = format!(
            "    trirrr_image::Move::RestToRest {{ from: [0.21, 0.22, {from:?}], \
             to: [0.28, 0.28, {to:?}], ticks: 100 }},\n"
        );
        assert!(text.contains(&line), "{line}{text}");
        assert!(shipped("chained.toml").contains("trirrr_image::Move::Hermite {"));
        assert!(shipped("engraving.toml").contains("trirrr_image::Move::Quintic {"));
    }
}
