//! Settings that a scene gives to the core's service.

use crate::drive::Drive;
use crate::homing::Homing;
use crate::job_path::{TOLERANCE_M, TOLERANCE_RAD};
use crate::scene::Scene;
use trirrr_core::machine::Geometry;
use trirrr_core::number::Number;
use trirrr_core::status::Status;
use trirrr_core::units::Units;
use trirrr_plan::window::WindowSettings;
use trirrr_protocol::message::{AngleReference, Board, Firmware, Message, Request, Transmit};
use trirrr_protocol::wire::schema;
use trirrr_service::features::{Contact, HomingMotor, HomingParameters, HomingTimes, Planning};
use trirrr_service::{SceneIdentity, Settings, name};

/// Shortest time of a move that a machine plans itself, s. The motion is smoothed over twice as much: a shorter one leaves
/// curves less, a longer one has less noise of rounding.
const STEP_S: f64 = 0.003;

/// Settings of a planner of paths: the tolerances are those of the scene's own path, or what they would be by default.
fn planning<N: Number>(scene: &Scene, units: &Units) -> Planning<N> {
    let tolerances = scene
        .job
        .path
        .as_ref()
        .map_or([TOLERANCE_M, TOLERANCE_RAD], |path| {
            [path.tolerance_m, path.tolerance_rad]
        });
    let radii = scene.parameters.legs.iter().map(|leg| leg.joint_radius_m);
    let period = units.time(scene.period_s());
    let settings = WindowSettings {
        period_s: period,
        ticks: (STEP_S * scene.tick_rate_hz).round().max(1.0) as u32,
        tolerance_m: tolerances[0] / units.length_m(),
        tolerance_rad: tolerances[1],
        lever_m: radii.fold(0.0, f64::max) / units.length_m(),
        hold_rate: scene.ramp().least_rate(period),
    };
    settings.planning()
}

/// The way in which the machine of a scene knows where its motors are.
fn reference(scene: &Scene) -> AngleReference {
    let is_on_bus = |drives: &[Drive; 3]| drives.iter().any(|drive| drive.can().is_some());
    match &scene.homing {
        Some(homing) if homing.contact == Contact::Unfelt => AngleReference::Blind,
        Some(_) => AngleReference::Homed,
        // An encoder on a motor counts from where it is switched on; a drive on the bus knows its joint.
        None if scene.drives.as_ref().is_some_and(is_on_bus) => AngleReference::Measured,
        None => AngleReference::Declared,
    }
}

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
        power: scene.power.times(scene.tick_rate_hz),
        reactions: scene.reactions,
        planning: scene.service.plans_paths.then(|| planning(scene, units)),
        scene: SceneIdentity {
            schema: schema::key::<Request<N>, Message<N>>(),
            key: scene.key,
            name: name(&scene.name),
            tick_rate_hz: scene.tick_rate_hz,
            length_m: units.length_m(),
            time_s: units.time_s(),
            mass_kg: units.of(0, 0, 1),
            reference: reference(scene),
        },
        board: Board::HOST,
        firmware: &Firmware::SIMULATOR,
    }
}

impl Homing {
    /// As the service of `scene` needs it, in `units`: with how long its parts take.
    ///
    /// # Errors
    /// The machine cannot stand at its start; the reader of the scene would have said so.
    pub fn parameters(&self, scene: &Scene, units: &Units) -> Result<HomingParameters, Status> {
        let start = scene.job.start;
        let geometry = Geometry::<f64>::build(&scene.parameters);
        let geometry = geometry.map_err(|_| Status::OutOfRange)?;
        let angles = geometry.motor_angles(&geometry.position(&start)?);
        let motors = self.motors.map(|motor| HomingMotor {
            search_rate_rad_s: motor.search_rate_rad_s / units.rate_rad_s(),
            stall_torque_nm: motor.stall_torque_nm / units.torque_nm(),
            latch_rate_rad_s: motor.latch_rate_rad_s / units.rate_rad_s(),
            acceleration_rad_s2: motor.acceleration_rad_s2 / units.acceleration_rad_s2(),
            ..motor
        });
        let in_units = units.pose(&start);
        Ok(HomingParameters {
            contact: self.contact,
            motors,
            debounce_ticks: self.debounce_ticks,
            stall_is_fault: self.stall_is_fault,
            start: [in_units.position.x, in_units.position.y, in_units.angle],
            times: HomingTimes::new(
                self.contact,
                &motors,
                self.debounce_ticks,
                angles,
                units.time(scene.period_s()),
                scene.ramp().ticks,
            ),
        })
    }
}
