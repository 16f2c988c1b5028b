//! Arguments of `trirrr calibrate`.

use crate::arguments::{SetArgs, factor, number_type};
use crate::goals::MachineArgs;
use crate::job_file::origin;
use crate::stream::PortArgs;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use trirrr_calibration::{CalibrationSetup, MeasurementNoise, ParameterGroup};
use trirrr_line::Address;
use trirrr_scene::NumberType;

/// Readings that poses are proposed for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MeasuredKind {
    /// Place and angle of the target
    Pose,
    /// Place of the target alone
    Place,
}

/// Board that takes the calibrated geometry.
#[derive(Args, Clone, Debug)]
pub struct CalibratedBoardArgs {
    /// The board, /dev/tty... or tcp:HOST:PORT, which gets the calibrated legs and encoder offsets while it is idle, and keeps them until it is switched off.
    /// Its image must hold the code for that, as `trirrr device` does
    #[arg(long, value_name = "PORT", requires = "measurements")]
    pub port: Option<Address>,
    /// Rate of a serial port
    #[arg(
        long,
        value_name = "BAUD",
        default_value_t = 921_600,
        requires = "port"
    )]
    pub baud: u32,
    /// Key file of a TCP port that expects a key
    #[arg(long, value_name = "FILE", requires = "port")]
    pub key: Option<PathBuf>,
    /// Number type of the board's image [default: the scene's]
    #[arg(long, value_parser = number_type(), requires = "port")]
    pub scalar: Option<NumberType>,
    /// Seconds without an answer after which the board is given up
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = factor, requires = "port")]
    pub patience: f64,
    /// The joints have been turned by the encoder offsets since the poses were measured: the board gets none
    #[arg(long, requires = "port")]
    pub joints_placed: bool,
}

/// `trirrr calibrate`.
///
/// Finds base joints, link lengths, platform joints and encoder offsets of the machine from measured poses or distances. Says what the
/// measurements cannot see, and holds it. Writes calibration.json, residuals.csv, figures, and a copy of the scene with the calibrated values.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = COLUMNS)]
pub struct CalibrateArgs {
    /// The scene of the machine, a TOML file
    #[arg(value_name = "SCENE.toml")]
    pub scene: PathBuf,
    /// Table of measurements (columns: see --help)
    #[arg(value_name = "MEASUREMENTS.csv", required_unless_present = "propose")]
    pub measurements: Option<PathBuf>,
    /// Values in place of those of the scene.
    #[command(flatten)]
    pub set: SetArgs,
    /// Standard deviation of a measured coordinate or distance, m, of rows without their own
    #[arg(long, value_name = "M", default_value_t = 2e-5, value_parser = deviation)]
    pub noise_m: f64,
    /// Standard deviation of a measured angle, rad, of rows without their own
    #[arg(long, value_name = "RAD", default_value_t = 2e-4, value_parser = deviation)]
    pub noise_rad: f64,
    /// Group of parameters to fit, too: device, target. May stand several times
    #[arg(long, value_name = "GROUP", value_parser = group())]
    pub free: Vec<ParameterGroup>,
    /// Group of parameters that stays as it is: base, proximal, distal, joint, offset. May stand several times
    #[arg(long, value_name = "GROUP", value_parser = group())]
    pub hold: Vec<ParameterGroup>,
    /// Frame of the measuring device in that of the machine: x and y in mm, and its angle in degrees
    #[arg(long, value_name = "X,Y[,ANGLE]", value_parser = origin)]
    pub device: Option<[f64; 3]>,
    /// Measured target on the platform, from D: x and y in mm, and its angle in degrees
    #[arg(long, value_name = "X,Y[,ANGLE]", value_parser = origin)]
    pub target: Option<[f64; 3]>,
    /// Deviation that is expected of a length or a coordinate of a part, m
    #[arg(long, value_name = "M", default_value_t = 1e-3, value_parser = deviation)]
    pub expected_m: f64,
    /// Deviation that is expected of an encoder offset, rad
    #[arg(long, value_name = "RAD", default_value_t = 0.01, value_parser = deviation)]
    pub expected_rad: f64,
    /// Keep rows in the fit that are far off
    #[arg(long)]
    pub keep_outliers: bool,
    /// Propose so many poses to measure next, and write them as a table for `trirrr run --machine`
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=500))]
    pub propose: Option<u32>,
    /// Reading that the proposed poses are for
    #[arg(long, value_name = "KIND", default_value = "pose")]
    pub measure: MeasuredKind,
    /// Angle by which the platform may turn to both sides of that at the start of the job, degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 15.0, value_parser = turn)]
    pub turn: f64,
    /// Time for which the machine stands at each proposed pose, s
    #[arg(long, value_name = "SECONDS", default_value_t = 2.0, value_parser = crate::arguments::factor)]
    pub dwell: f64,
    /// The board.
    #[command(flatten)]
    pub board: CalibratedBoardArgs,
    /// Folder for what is written, made if missing; those of an earlier run go [default: out/NAME-calibration]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print calibration.json in place of the summary
    #[arg(long)]
    pub json: bool,
}

const COLUMNS: &str = "\
Columns of the measurements, in any order, separated by commas, with decimal points:
  th1_1, th1_2, th1_3           angles that the encoders told, or that were commanded, rad (or th1_1_deg, ...)
and in each row either a place of the target in the frame of the device
  x_m, y_m                      (or x_mm, y_mm)
  alpha_rad                     angle of the target, empty where it was not measured (or alpha_deg)
or its distance from a fixed point, as of a ball bar
  distance_m                    (or distance_mm)
  centre_x_m, centre_y_m        the fixed point in the frame of the device (or centre_x_mm, centre_y_mm)
and where wanted
  noise_m, noise_rad            standard deviations of the row (or noise_mm, noise_deg)
  note                          is not read
Rows that begin with # are comments.";

impl CalibrateArgs {
    /// Settings of the calibration.
    pub(super) fn setup(&self) -> CalibrationSetup {
        let in_si = |given: Option<[f64; 3]>| {
            let [x, y, angle] = given.unwrap_or_default();
            [1e-3 * x, 1e-3 * y, angle.to_radians()]
        };
        let mut setup = CalibrationSetup {
            device: in_si(self.device),
            target: in_si(self.target),
            expected_m: self.expected_m,
            expected_rad: self.expected_rad,
            keeps_outliers: self.keep_outliers,
            ..CalibrationSetup::default()
        };
        let added = self.free.iter().filter(|group| !setup.free.contains(group));
        let added: Vec<ParameterGroup> = added.copied().collect();
        setup.free.extend(added);
        setup.free.retain(|group| !self.hold.contains(group));
        setup
    }

    /// The machine that gets the calibrated geometry.
    pub(super) fn machine(&self) -> Option<MachineArgs> {
        let board = &self.board;
        Some(MachineArgs {
            scene: self.scene.clone(),
            set: self.set.clone(),
            line: PortArgs {
                port: board.port.clone()?,
                baud: board.baud,
                key: board.key.clone(),
            },
            scalar: board.scalar,
            patience: board.patience,
            feed: None,
        })
    }

    /// Noise of rows that give none.
    pub(super) fn noise(&self) -> MeasurementNoise {
        MeasurementNoise {
            place_m: self.noise_m,
            angle_rad: self.noise_rad,
        }
    }
}

fn group() -> impl TypedValueParser<Value = ParameterGroup> {
    let names = ParameterGroup::ALL.map(ParameterGroup::name);
    PossibleValuesParser::new(names).try_map(|name| {
        let found = ParameterGroup::ALL
            .into_iter()
            .find(|group| group.name() == name);
        found.ok_or("no group of this name")
    })
}

fn deviation(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (1e-9..=10.0).contains(&value) => Ok(value),
        _ => Err("expected a number from 1e-9 to 10".into()),
    }
}

fn turn(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (0.0..=180.0).contains(&value) => Ok(value),
        _ => Err("expected a number of degrees from 0 to 180".into()),
    }
}
