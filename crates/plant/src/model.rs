//! The plant as a system of differential equations.

use crate::control::{Commands, Continuous, JointReference};
use crate::friction::{Friction, Region};
use crate::layout::{Layout, ROTORS};
use crate::mechanics::Mechanics;
use crate::motor::MotorModel;
use crate::path::JobPath;
use crate::refusal::Refusal;
use crate::statistics::Statistics;
use crate::watch::{self, Ending, Watch};
use trirrr_core::machine::Parameters;
use trirrr_scene::{Drive, Plant as Scenario, Scene, Transmission};

/// Source of the motors' commands.
pub enum Control {
    /// Commands that only [`Plant::hold`] changes.
    Held,
    /// A controller continuous in time.
    Continuous(Box<Continuous>),
    /// Drives that sample the plant and command it from outside.
    Sampled {
        /// Samples per second.
        rate_hz: f64,
    },
}

/// Friction of the three joints of each leg (motor, elbow, platform), and where each of them is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Joints {
    /// By kind.
    pub friction: [Option<Friction>; 3],
    /// By kind, then leg.
    pub regions: [[Region; 3]; 3],
}

/// Machine, transmissions, motors and control; `N` state variables (see [`Layout`]).
pub struct Plant<const N: usize> {
    pub(crate) mechanics: Mechanics,
    pub(crate) motors: [MotorModel; 3],
    pub(crate) transmission: [Transmission; 3],
    /// Inertia of each rotor at its joint, kg m^2; used where the transmission is elastic.
    pub(crate) rotors: [f64; 3],
    pub(crate) joints: Joints,
    pub(crate) control: Control,
    pub(crate) path: JobPath,
    /// Commands of the motors, where the control does not act at every instant.
    pub(crate) held: [f64; 3],
    /// Counts of the rotors' encoders per radian of the joint, where there are any.
    pub(crate) counts_per_radian: Option<[f64; 3]>,
    pub(crate) last_counts: Option<[f64; 3]>,
    /// Joint angles at the start, and unwrapped ones near the present ones.
    pub(crate) start: [f64; 3],
    pub(crate) near: [f64; 3],
    pub(crate) commands: Commands,
    pub(crate) slips: [i64; 3],
    pub(crate) watches: Vec<Watch>,
    pub(crate) following_error: Option<f64>,
    /// 1 / the greatest det A.
    pub(crate) det_a_scale: f64,
    /// The leg whose angles are coordinates of the state.
    pub(crate) leading: Option<usize>,
    pub(crate) ending: Option<Ending>,
    pub(crate) statistics: Statistics,
}

impl<const N: usize> Plant<N> {
    pub(crate) const ELASTIC: bool = N == 14 || N == 17;
    pub(crate) const CURRENTS: bool = N == 11 || N == 17;
    /// Contents of the state.
    pub const LAYOUT: Layout = Layout {
        elastic: Self::ELASTIC,
        currents: Self::CURRENTS,
    };

    /// The plant of `scene` under `control`, and its state at rest at the start of the job.
    ///
    /// # Errors
    /// The machine or its drives are refused.
    ///
    /// # Panics
    /// If `N` is not the dimension of the scene's layout, which [`layout_of`] tells.
    pub fn build(scene: &Scene, control: Control) -> Result<(Self, [f64; N]), Refusal> {
        assert_eq!(layout_of(scene), Self::LAYOUT, "state of another scene");
        assert_eq!(Self::LAYOUT.dimension(), N);
        let scenario = scene.plant.as_ref();
        let parameters = &heavier(
            &scene.parameters,
            scenario.map_or(1.0, |plant| plant.mass_factor),
        );
        let mechanics = Mechanics::build(parameters, !Self::ELASTIC)?;
        let drive = |leg: usize| scene.drives.as_ref().map(|drives| &drives[leg]);
        let motors = [
            MotorModel::build(drive(0))?,
            MotorModel::build(drive(1))?,
            MotorModel::build(drive(2))?,
        ];
        let friction = scenario.map(|plant| plant.friction).unwrap_or_default();
        let friction = [friction.motor, friction.elbow, friction.platform].map(|joint| {
            joint.map(|joint| Friction {
                viscous: joint.viscous_nm_s_rad,
                coulomb: joint.coulomb_nm,
                stick: joint.stick_rad_s,
            })
        });
        let rigid = Transmission {
            stiffness_nm_rad: 0.0,
            damping_nm_s_rad: 0.0,
        };
        let per_radian = |leg| {
            // Amplifiers have the counters of a board.
            let drive = drive(leg).filter(|drive: &&Drive| drive.can().is_some())?;
            let counts = f64::from(drive.encoder_counts_per_rev?);
            Some(drive.gear_ratio * counts / std::f64::consts::TAU)
        };
        let counts = match (per_radian(0), per_radian(1), per_radian(2)) {
            (Some(first), Some(second), Some(third)) => Some([first, second, third]),
            _ => None,
        };
        let pose = scene.job.start;
        let q = [pose.position.x, pose.position.y, pose.angle];
        let legs = mechanics.configuration(None, q, [0.0; 3])?.legs;
        let start = [0, 1, 2].map(|leg| mechanics.motor_angle(leg, &legs[leg]));
        let mut state = [0.0; N];
        state[..3].copy_from_slice(&q);
        if Self::ELASTIC {
            state[ROTORS..ROTORS + 3].copy_from_slice(&start);
        }
        let greatest = parameters.greatest_det_a();
        let following_error = scenario.and_then(|plant: &Scenario| plant.following_error_rad);
        let continuous = matches!(control, Control::Continuous(_));
        let mut watches = watch::list(&friction, &motors, continuous, following_error.is_some());
        watches.retain(|watch| match *watch {
            Watch::Lead(leg) => mechanics.has_inertia(leg),
            _ => true,
        });
        let plant = Self {
            mechanics,
            motors,
            transmission: scenario
                .and_then(|plant| plant.transmission)
                .unwrap_or([rigid; 3]),
            rotors: parameters.legs.map(|leg| leg.rotor_inertia_kgm2),
            joints: Joints {
                friction,
                regions: Default::default(),
            },
            control,
            path: JobPath::new(scene),
            held: [0.0; 3],
            counts_per_radian: counts,
            last_counts: None,
            start,
            near: start,
            commands: Commands {
                angle: start,
                ..Commands::default()
            },
            slips: [0; 3],
            watches,
            following_error,
            det_a_scale: if greatest > 0.0 { 1.0 / greatest } else { 0.0 },
            leading: None,
            ending: None,
            statistics: Statistics::default(),
        };
        plant
            .accelerations(0.0, &state)
            .map_err(|refusal| match refusal {
                Refusal::NoInertia => Refusal::Scene {
                    key: "platform.mass_kg, inertia_kgm2".into(),
                    reason: refusal.to_string(),
                },
                other => other,
            })?;
        Ok((plant, state))
    }

    /// Holds `told` as the command of each motor from now on.
    pub fn hold(&mut self, told: [f64; 3]) {
        self.held = told;
    }

    /// Statistics up to now.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Cause and instant, if the plant ended the run.
    pub fn ending(&self) -> Option<Ending> {
        self.ending
    }

    /// Samples per second of the drives; `None` without samples.
    pub fn sample_rate(&self) -> Option<f64> {
        match self.control {
            Control::Sampled { rate_hz } => Some(rate_hz),
            Control::Held | Control::Continuous(_) => None,
        }
    }

    /// References of the joints at `t`, where the control acts at every instant.
    pub(crate) fn references(&self, t: f64) -> Option<Result<[JointReference; 3], Refusal>> {
        match &self.control {
            Control::Continuous(continuous) => Some(continuous.references(t)),
            _ => None,
        }
    }
}

/// Contents of the state of `scene`'s plant.
pub fn layout_of(scene: &Scene) -> Layout {
    let bldc = |drive: &Drive| matches!(drive.kind, trirrr_scene::DriveKind::Bldc(_));
    let transmission = scene.plant.as_ref().and_then(|plant| plant.transmission);
    Layout {
        elastic: transmission.is_some(),
        currents: scene.drives.is_some_and(|drives| drives.iter().any(bldc)),
    }
}

/// The machine with masses and inertias of links and platform `factor` times as large. Rotors stay.
fn heavier(parameters: &Parameters, factor: f64) -> Parameters {
    let mut heavier = *parameters;
    for leg in &mut heavier.legs {
        for link in [&mut leg.proximal, &mut leg.distal] {
            link.mass_kg *= factor;
            link.inertia_kgm2 *= factor;
        }
    }
    heavier.platform.mass_kg *= factor;
    heavier.platform.inertia_kgm2 *= factor;
    heavier
}
