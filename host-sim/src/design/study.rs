//! Study of a machine: everything that its report shows.

use super::DesignArgs;
use super::field::{AngleStudy, errors_m, loads};
pub(super) use super::field::{LoadCase, Surface};
use crate::failure::CliError;
use crate::figures::Animation;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::PI;
use trirrr_core::machine::Elbow;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::units::Units;
use trirrr_design::loads::{PoseLoads, stiffness_nm_rad};
use trirrr_design::modes::{MODES, ModeFault, ModeFigures, ModeResult, in_mode, job_in};
use trirrr_design::motors::{Candidate, CatalogueMotor, JobLoad, SHIPPED, read_catalogue};
use trirrr_design::ratios::{self, RatioInstant};
use trirrr_design::reactions::{self, JobReactions};
use trirrr_design::workspace::{CellGrid, Conditions, Workspace};
use trirrr_scene::read::files::{self, LONGEST_TABLE};
use trirrr_scene::record::Record;
use trirrr_scene::{JobPlayer, Scene, pipeline};

/// Cells along the longer side of maps for which many are made.
const COARSE: usize = 96;

/// Degrees from one angle of the platform to the next.
const ALPHA_STEP: i32 = 10;

/// Durations at which the job is looked at, in parts of its own.
const FACTORS: [f64; 15] = [
    0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.15, 1.3, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0,
];

/// Motors whose points are drawn.
const MOTORS_DRAWN: usize = 3;

/// Pieces of a path that is planned for every motor.
const PLANNED_PIECES: usize = 32;

/// Points of the job's path in figures, at most.
const PATH_POINTS: u32 = 2_000;

/// Working mode on the job.
pub(super) struct ModeRow {
    pub(super) result: ModeResult,
    /// Duration of the job, s, planned in this mode where the scene asks for the least time.
    pub(super) duration_s: Option<f64>,
    /// First line of the refusal of the scene in this mode.
    pub(super) refusal: Option<String>,
}

impl ModeRow {
    /// Returns true if the scene is good in this mode.
    pub(super) fn is_feasible(&self) -> bool {
        self.refusal.is_none() && self.result.fault.is_none()
    }

    /// Why it is not.
    pub(super) fn reason(&self) -> Option<String> {
        match (&self.result.fault, &self.refusal) {
            (Some(ModeFault { t_s, reason }), _) => Some(format!("at {t_s:.3} s: {reason}")),
            (None, Some(refusal)) => Some(refusal.clone()),
            (None, None) => None,
        }
    }
}

/// Area that is reached with one angle of the platform.
pub(super) struct AlphaRow {
    pub(super) degrees: f64,
    /// Bounds of the area, m^2.
    pub(super) area_m2: [f64; 2],
    /// Values that half of the places there keep, and nine of ten: rate for 1 m/s, rad/s; torque of the load, N m; offset of D for 0.1
    /// degrees, m; displacement for 1 N, m, or 0 where the stiffness is not known. None where there is no place.
    pub(super) values: Option<[[f64; 2]; 4]>,
}

/// Motor of the catalogue on the job.
pub(super) struct MotorRow {
    pub(super) motor: CatalogueMotor,
    pub(super) candidate: Candidate,
    /// Least time in which it does the job, s; none: it does not, or was not looked at.
    pub(super) least_time_s: Option<f64>,
    /// Speeds and torques at its shaft along the job, of the first motors alone.
    pub(super) points: Vec<[f64; 2]>,
}

/// Everything that is found of a machine.
pub(super) struct Study {
    pub(super) scene: Scene,
    pub(super) modes: Vec<ModeRow>,
    /// Angle of the maps, rad.
    pub(super) alpha_rad: f64,
    /// Map of what the legs reach.
    pub(super) reach: Workspace,
    /// Angle to both sides that the map of the workspace asks for, rad.
    pub(super) turn_rad: f64,
    /// What keeps the distances of the scene's limits, with all angles within the turn.
    pub(super) work: Surface,
    /// The same with all angles of the platform.
    pub(super) total: Surface,
    pub(super) alphas: Vec<AlphaRow>,
    /// Grid of the maps of values.
    pub(super) coarse: CellGrid,
    /// Loads at centres of cells that the machine works in.
    pub(super) loads: Vec<Option<PoseLoads>>,
    /// Load of the maps of torques.
    pub(super) case: LoadCase,
    /// Stiffness between motors and links, N m/rad, if it is known.
    pub(super) stiffness_nm_rad: Option<[f64; 3]>,
    /// Bounds of the offset of D there, m, in a scene with tolerances.
    pub(super) errors_m: Option<Vec<Option<f64>>>,
    /// Forces in the joints A, B and C of each leg.
    pub(super) reactions: JobReactions,
    /// Ratios of rates along the job.
    pub(super) ratios: Vec<RatioInstant>,
    /// The job in motion.
    pub(super) animation: Animation,
    /// Figures of the job in other durations, s.
    pub(super) durations: Vec<(f64, ModeFigures)>,
    /// Motors of the catalogue on the job, those with the greatest margins first.
    pub(super) motors: Vec<MotorRow>,
    /// Path of D along the job, m.
    pub(super) path: Vec<[f64; 2]>,
    /// The machine at the start of the job.
    pub(super) start: Record,
}

impl Study {
    /// Reads the scene and studies its machine.
    pub(super) fn of(args: &DesignArgs) -> Result<Self, CliError> {
        Self::at_length(args, true)
    }

    /// As [`of`](Self::of), without what takes long: areas over alpha, ratios, durations, motors.
    pub(super) fn brief(args: &DesignArgs) -> Result<Self, CliError> {
        Self::at_length(args, false)
    }

    fn at_length(args: &DesignArgs, is_full: bool) -> Result<Self, CliError> {
        let refused =
            |reason: String| CliError::Refused(format!("{}: {reason}", args.scene.display()));
        let catalogue = catalogue(args)?;
        let (scene, modes) = modes(args)?;
        // With torques, also where the tick of the scene computes none.
        let machine = pipeline::build_in::<f64>(&scene.parameters, Units::SI)
            .map_err(|error| refused(error.to_string()))?;
        let at_rest = |pose| Setpoint {
            pose,
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        };
        let start = machine
            .evaluate(0.0, &at_rest(scene.job.start))
            .map_err(|status| refused(format!("the start of the job: {status}")))?;
        let alpha_rad = args.alpha.map_or(scene.job.start.angle, f64::to_radians);
        let side = Some(start.det_a > 0.0);
        let turn = args.turn.to_radians();
        let limits = &scene.limits;
        let conditions = |alpha_rad: [f64; 2]| Conditions {
            serial_min: limits.serial_distance_min,
            parallel_min: limits.parallel_distance_min,
            side,
            alpha_rad,
        };
        let grid = CellGrid::around(&scene.parameters, args.cells as usize);
        let reach = Conditions {
            serial_min: 0.0,
            parallel_min: 0.0,
            side: None,
            alpha_rad: [alpha_rad; 2],
        };
        let reach = Workspace::map(&scene.parameters, &reach, grid);
        let turned = conditions([alpha_rad - turn, alpha_rad + turn]);
        let work = Surface::of(&scene, &turned, grid);
        let coarse = CellGrid::around(&scene.parameters, COARSE);
        let total = Surface::of(&scene, &conditions([-PI, PI]), coarse);
        let case = LoadCase {
            load_n: args.load_n,
            acceleration_m_s2: args.acceleration_m_s2,
        };
        let stiffness_nm_rad = match args.stiffness_nm_rad {
            Some(stiffness) => Some([stiffness; 3]),
            None => stiffness_nm_rad(&scene),
        };
        let of_angles = AngleStudy {
            scene: &scene,
            machine: &*machine,
            grid: coarse,
            case,
            stiffness_nm_rad,
        };
        let alphas = (-180..=180)
            .step_by(ALPHA_STEP as usize)
            .filter(|_| is_full)
            .map(|degrees: i32| {
                let degrees = f64::from(degrees);
                of_angles.row(degrees, &conditions([degrees.to_radians(); 2]))
            });
        let alphas = alphas.collect();
        let loads = match is_full {
            true => loads(&*machine, &work, &coarse, alpha_rad),
            false => vec![None; coarse.size[0] * coarse.size[1]],
        };
        let own_s = scene.duration_s();
        // One at least: the figure has an axis.
        let factors = FACTORS.iter().take(if is_full { FACTORS.len() } else { 1 });
        let durations = factors.filter_map(|&factor| {
            let found = job_in(&scene, factor).ok()?;
            Some((factor * own_s, found.figures?))
        });
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        let step = player.ticks() / PATH_POINTS + 1;
        let path = (0..=player.ticks())
            .step_by(step as usize)
            .chain([player.ticks()])
            .map(|tick| player.at(tick).pose.position.into());
        let mut animation = Animation::new(u64::from(player.ticks()) + 1, true);
        for tick in 0..=player.ticks() {
            let t_s = f64::from(tick) * scene.period_s();
            // What cannot be reached is a reason in the table of modes.
            if let Ok(record) = machine.evaluate(t_s, &player.at(tick)) {
                animation.push(&record);
            }
        }
        Ok(Self {
            modes,
            alpha_rad,
            turn_rad: turn,
            reach,
            work,
            total,
            alphas,
            errors_m: errors_m(&scene, &loads, &coarse, alpha_rad),
            coarse,
            loads,
            case,
            stiffness_nm_rad,
            reactions: reactions::along_job(&scene).map_err(refused)?,
            ratios: ratios::along_job(&scene).map_err(refused)?,
            animation,
            durations: durations.collect(),
            motors: match is_full {
                true => motors(&scene, &catalogue).map_err(refused)?,
                false => Vec::new(),
            },
            path: path.collect(),
            start,
            scene,
        })
    }

    /// The mode of the scene.
    pub(super) fn own_mode(&self) -> [Elbow; 3] {
        elbows_of(&self.scene)
    }

    /// The feasible mode with the least peak torque.
    pub(super) fn best_mode(&self) -> Option<&ModeRow> {
        let peak = |row: &&ModeRow| {
            let figures = row.result.figures;
            figures.map_or(f64::INFINITY, |figures| largest(figures.torque_peak_nm))
        };
        let feasible = self.modes.iter().filter(|row| row.is_feasible());
        feasible.min_by(|one, other| peak(one).total_cmp(&peak(other)))
    }
}

/// The motors on the job. Of a long path, the first ones alone are planned for.
fn motors(scene: &Scene, catalogue: &[CatalogueMotor]) -> Result<Vec<MotorRow>, String> {
    let load = JobLoad::of(scene)?;
    let pieces = scene.job.path.as_ref().map_or(0, |path| path.pieces.len());
    let planned = match pieces <= PLANNED_PIECES {
        true => catalogue.len(),
        false => MOTORS_DRAWN,
    };
    let candidates = load.candidates(catalogue);
    let row = |(place, candidate): (usize, Candidate)| {
        let motor = &catalogue[candidate.motor];
        let gear = candidate.gear_ratio;
        MotorRow {
            least_time_s: (place < planned)
                .then(|| load.least_time_s(motor, gear))
                .flatten(),
            points: match place < MOTORS_DRAWN {
                true => load.rotor_points(motor, gear),
                false => Vec::new(),
            },
            motor: motor.clone(),
            candidate,
        }
    };
    let numbered: Vec<_> = candidates.into_iter().enumerate().collect();
    Ok(numbered.into_par_iter().map(row).collect())
}

fn catalogue(args: &DesignArgs) -> Result<Vec<CatalogueMotor>, CliError> {
    let (name, text) = match &args.motors {
        None => ("the shipped catalogue".into(), SHIPPED.to_owned()),
        Some(file) => {
            let name = file.display().to_string();
            let text = files::text_in(file, LONGEST_TABLE)
                .map_err(|error| CliError::Refused(format!("{name}: cannot be read: {error}")))?;
            (name, text)
        }
    };
    let motors =
        read_catalogue(&text).map_err(|error| CliError::Refused(format!("{name}: {error}")))?;
    Ok(match args.supply_v {
        Some(supply) => motors.iter().map(|each| each.at_supply(supply)).collect(),
        None => motors,
    })
}

pub(super) fn largest(values: [f64; 3]) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

/// The scene, and its job in all working modes: each is read, and planned, as its own scene.
fn modes(args: &DesignArgs) -> Result<(Scene, Vec<ModeRow>), CliError> {
    let own = args.set.scene(&args.scene);
    let mut read = Vec::new();
    for elbows in MODES {
        read.push(match &own {
            // Its own mode is read, and planned, already.
            Ok(scene) if elbows_of(scene) == elbows => Ok(scene.clone()),
            _ => with_elbows(args, elbows)?,
        });
    }
    let scene = match own {
        Ok(scene) => scene,
        Err(refusal) => match read.iter().find_map(|scene| scene.as_ref().ok()) {
            Some(scene) => scene.clone(),
            None => return Err(refusal),
        },
    };
    let rows = MODES.into_iter().zip(read).map(|(elbows, read)| {
        let failed = CliError::Failed;
        Ok(match read {
            Ok(scene) => ModeRow {
                result: job_in(&scene, 1.0).map_err(failed)?,
                duration_s: Some(scene.duration_s()),
                refusal: None,
            },
            Err(refusal) => ModeRow {
                result: in_mode(&scene, elbows).map_err(failed)?,
                duration_s: None,
                refusal: refusal.to_string().lines().next().map(str::to_owned),
            },
        })
    });
    let rows = rows.collect::<Result<Vec<_>, CliError>>()?;
    Ok((scene, rows))
}

/// The scene with other elbows, as the reader takes or refuses it.
fn with_elbows(args: &DesignArgs, elbows: [Elbow; 3]) -> Result<Result<Scene, CliError>, CliError> {
    let mut set = args.set.clone();
    for (leg, elbow) in elbows.into_iter().enumerate() {
        let setting = format!("machine.leg[{}].elbow={}", leg + 1, elbow.sign());
        set.set.push(
            setting
                .parse()
                .map_err(|_| CliError::Failed(format!("{setting} is no setting")))?,
        );
    }
    Ok(set.scene(&args.scene))
}

fn elbows_of(scene: &Scene) -> [Elbow; 3] {
    scene.parameters.legs.each_ref().map(|leg| leg.elbow)
}
