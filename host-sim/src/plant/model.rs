//! The plant as a system of differential equations.

use super::control::{Commands, Continuous, JointReference, Measured, SampledController};
use super::friction::{Friction, Region};
use super::layout::{Layout, RATES, ROTOR_RATES, ROTORS, three};
use super::mechanics::{JointMoments, LegState, Mechanics};
use super::motor::{Motor, wrapped};
use super::path::JobPath;
use super::refusal::Refusal;
use super::stability::LoopGains;
use super::statistics::Statistics;
use super::watch::{Ending, Watch};
use trirrr_core::singularity;
use trirrr_scene::{Controller, Drive, Plant as Scenario, Scene, Transmission};

/// What commands the motors.
pub enum Control {
    /// Nothing changes what they are told.
    Held,
    /// A controller continuous in time.
    Continuous(Box<Continuous>),
    /// A sampled controller and its rate in Hz.
    Sampled {
        /// The controller.
        controller: Box<dyn SampledController>,
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
    pub(super) mechanics: Mechanics,
    pub(super) motors: [Motor; 3],
    pub(super) transmission: [Transmission; 3],
    /// Inertia of each rotor at its joint, kg m^2; used where the transmission is elastic.
    pub(super) rotors: [f64; 3],
    pub(super) joints: Joints,
    pub(super) control: Control,
    pub(super) path: JobPath,
    /// What the motors are told, where the control does not act at every instant.
    pub(super) held: [f64; 3],
    /// Counts of the rotors' encoders per radian of the joint, where there are any.
    pub(super) counts_per_radian: Option<[f64; 3]>,
    pub(super) last_counts: Option<[f64; 3]>,
    /// Joint angles at the start, and unwrapped ones near the present ones.
    pub(super) start: [f64; 3],
    pub(super) near: [f64; 3],
    pub(super) commands: Commands,
    pub(super) slips: [i64; 3],
    pub(super) watches: Vec<Watch>,
    pub(super) following_error: Option<f64>,
    /// 1 / the greatest det A.
    pub(super) det_a_scale: f64,
    /// 1 / (l1 l2) of each leg.
    pub(super) cross_scale: [f64; 3],
    /// Whether a singularity is near enough to be watched for.
    pub(super) near_singular: bool,
    pub(super) ending: Option<Ending>,
    pub(super) statistics: Statistics,
    /// Gains of a sampled loop, to judge it by.
    pub(super) loop_gains: Option<LoopGains>,
    /// Largest kinetic energy noted, J.
    pub(super) kinetic_peak: f64,
}

/// Everything of the plant at one instant that is not in its state.
#[derive(Clone, Copy, Debug)]
pub struct Outputs {
    /// The legs.
    pub legs: [LegState; 3],
    /// Joint angles theta_i1, in (-pi, pi].
    pub angles: [f64; 3],
    /// Angles at the rotors' side of the transmissions.
    pub rotor_angles: [f64; 3],
    /// Rates there.
    pub rotor_rates: [f64; 3],
    /// What each motor is told.
    pub told: [f64; 3],
    /// Torque of each motor at the joint, N m.
    pub torques: [f64; 3],
    /// Current of each winding, A; 0 without.
    pub currents: [f64; 3],
}

impl<const N: usize> Plant<N> {
    const ELASTIC: bool = N == 14 || N == 17;
    const CURRENTS: bool = N == 11 || N == 17;
    /// What the state holds.
    pub const LAYOUT: Layout = Layout {
        elastic: Self::ELASTIC,
        currents: Self::CURRENTS,
    };

    /// The plant of `scene` under `control`, and its state at rest at the start of the job.
    ///
    /// # Errors
    /// What the machine or its drives are refused for.
    ///
    /// # Panics
    /// If `N` is not the dimension of the scene's layout, which [`layout_of`] tells.
    pub fn build(scene: &Scene, control: Control) -> Result<(Self, [f64; N]), Refusal> {
        assert_eq!(layout_of(scene), Self::LAYOUT, "state of another scene");
        assert_eq!(Self::LAYOUT.dimension(), N);
        let parameters = &scene.parameters;
        let mechanics = Mechanics::build(parameters, !Self::ELASTIC)?;
        let drive = |leg: usize| scene.drives.as_ref().map(|drives| &drives[leg]);
        let motors = [
            Motor::build(drive(0))?,
            Motor::build(drive(1))?,
            Motor::build(drive(2))?,
        ];
        let scenario = scene.plant.as_ref();
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
        let counts = scenario.and_then(|plant| plant.encoder_counts_per_rev);
        let gears = [0, 1, 2].map(|leg| drive(leg).map_or(1.0, |drive: &Drive| drive.gear_ratio));
        let pose = scene.job.start;
        let q = [pose.position.x, pose.position.y, pose.angle];
        let legs = mechanics.legs(q, [0.0; 3])?;
        let start = [0, 1, 2].map(|leg| mechanics.motor_angle(leg, &legs[leg]));
        let mut state = [0.0; N];
        state[..3].copy_from_slice(&q);
        if Self::ELASTIC {
            state[ROTORS..ROTORS + 3].copy_from_slice(&start);
        }
        let greatest = singularity::greatest_det_a(parameters);
        let mut plant = Self {
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
            counts_per_radian: counts
                .map(|counts| gears.map(|gear| gear * f64::from(counts) / std::f64::consts::TAU)),
            last_counts: None,
            start,
            near: start,
            commands: Commands {
                angle: start,
                ..Commands::default()
            },
            slips: [0; 3],
            watches: Vec::new(),
            following_error: scenario.and_then(|plant: &Scenario| plant.following_error_rad),
            det_a_scale: if greatest > 0.0 { 1.0 / greatest } else { 0.0 },
            cross_scale: parameters
                .legs
                .map(|leg| 1.0 / (leg.proximal_m * leg.distal_m)),
            near_singular: true,
            ending: None,
            statistics: Statistics::default(),
            loop_gains: None,
            kinetic_peak: 0.0,
        };
        plant.loop_gains = scenario
            .and_then(|plant| plant.controller)
            .map(|controller| plant.gains_of(&controller));
        plant.watches = plant.list_watches();
        plant.accelerations(0.0, &state)?;
        Ok((plant, state))
    }

    /// Tells every motor something else from now on.
    pub fn hold(&mut self, told: [f64; 3]) {
        self.held = told;
    }

    /// What was gathered so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Why the run ended, where the plant ended it.
    pub fn ending(&self) -> Option<Ending> {
        self.ending
    }

    #[inline(always)]
    pub(super) fn legs(&self, y: &[f64; N]) -> Result<[LegState; 3], Refusal> {
        Ok(self.mechanics.legs(three(y, 0), three(y, RATES))?)
    }

    /// Joint angle of leg `leg`, unwrapped.
    #[inline]
    pub(super) fn joint_angle(&self, leg: usize, state: &LegState) -> f64 {
        let angle = self.mechanics.motor_angle(leg, state);
        self.near[leg] + wrapped(angle - self.near[leg])
    }

    /// Angle at the rotor's side of the transmission, unwrapped, and its rate.
    #[inline(always)]
    pub(super) fn rotor(&self, leg: usize, state: &LegState, y: &[f64; N]) -> Measured {
        if Self::ELASTIC {
            Measured {
                angle: y[ROTORS + leg],
                rate: y[ROTOR_RATES + leg],
            }
        } else {
            Measured {
                angle: self.joint_angle(leg, state),
                rate: state.rates[0],
            }
        }
    }

    #[inline(always)]
    fn current(y: &[f64; N], leg: usize) -> f64 {
        if Self::CURRENTS {
            y[Self::LAYOUT.current() + leg]
        } else {
            0.0
        }
    }

    /// What the motors are told at `t`.
    #[inline(always)]
    pub(super) fn told(
        &self,
        t: f64,
        legs: &[LegState; 3],
        y: &[f64; N],
    ) -> Result<[f64; 3], Refusal> {
        match &self.control {
            Control::Continuous(continuous) => self.told_by(continuous, t, legs, y),
            Control::Held | Control::Sampled { .. } => Ok(self.held),
        }
    }

    #[inline(never)]
    fn told_by(
        &self,
        continuous: &Continuous,
        t: f64,
        legs: &[LegState; 3],
        y: &[f64; N],
    ) -> Result<[f64; 3], Refusal> {
        let references = continuous.references(t)?;
        Ok([0, 1, 2].map(|leg| {
            let measured = self.rotor(leg, &legs[leg], y);
            continuous.command(leg, &self.motors[leg], &references[leg], &measured)
        }))
    }

    /// Torque of motor `leg` at the joint.
    #[inline(always)]
    fn motor_torque(
        &self,
        leg: usize,
        told: f64,
        state: &LegState,
        y: &[f64; N],
        rate: f64,
    ) -> f64 {
        match &self.motors[leg] {
            Motor::Ideal => told,
            Motor::Bldc(winding) => winding.torque_constant * Self::current(y, leg),
            Motor::Stepper(field) => {
                let angle = self.rotor(leg, state, y).angle - self.start[leg];
                field.torque(told, angle, rate)
            }
        }
    }

    #[inline(always)]
    fn friction(&self, kind: usize, leg: usize, rate: f64) -> f64 {
        match &self.joints.friction[kind] {
            Some(friction) => friction.moment(rate, self.joints.regions[kind][leg]),
            None => 0.0,
        }
    }

    /// y' at `t`.
    #[inline(always)]
    pub(super) fn slope(&self, t: f64, y: &[f64; N], dy: &mut [f64; N]) -> Result<(), Refusal> {
        let legs = self.legs(y)?;
        let told = self.told(t, &legs, y)?;
        self.slope_under(&told, &legs, y, dy)
    }

    /// y' with the motors told `told`.
    #[inline(always)]
    fn slope_under(
        &self,
        told: &[f64; 3],
        legs: &[LegState; 3],
        y: &[f64; N],
        dy: &mut [f64; N],
    ) -> Result<(), Refusal> {
        let (q, v) = (three(y, 0), three(y, RATES));
        let mut moments = [JointMoments::default(); 3];
        let (mut work, mut loss) = (0.0, 0.0);
        for leg in 0..3 {
            let state = &legs[leg];
            let [rate1, rate2] = state.rates;
            let rate = if Self::ELASTIC {
                y[ROTOR_RATES + leg]
            } else {
                rate1
            };
            let torque = self.motor_torque(leg, told[leg], state, y, rate);
            if let Motor::Bldc(winding) = &self.motors[leg] {
                let current = Self::current(y, leg);
                if Self::CURRENTS {
                    dy[Self::LAYOUT.current() + leg] =
                        winding.current_rate(told[leg], current, rate);
                }
                work += told[leg] * current;
                loss += winding.loss(current, rate);
            } else {
                if Self::CURRENTS {
                    dy[Self::LAYOUT.current() + leg] = 0.0;
                }
                work += torque * rate;
            }
            let rubbing = self.friction(0, leg, rate);
            loss += rubbing * rate;
            let moment = &mut moments[leg];
            if Self::ELASTIC {
                let spring = &self.transmission[leg];
                let twist = wrapped(y[ROTORS + leg] - self.mechanics.motor_angle(leg, state));
                let slip = rate - rate1;
                let damping = spring.damping_nm_s_rad * slip;
                moment.proximal = spring.stiffness_nm_rad * twist + damping;
                loss += damping * slip;
                dy[ROTORS + leg] = rate;
                dy[ROTOR_RATES + leg] = (torque - rubbing - moment.proximal) / self.rotors[leg];
            } else {
                moment.proximal = torque - rubbing;
            }
            let (bend, tilt) = (rate2 - rate1, v[2] - rate2);
            moment.elbow = self.friction(1, leg, bend);
            moment.platform = self.friction(2, leg, tilt);
            loss += moment.elbow * bend + moment.platform * tilt;
        }
        let acceleration = self.mechanics.acceleration(q, v, legs, &moments)?;
        dy[..3].copy_from_slice(&v);
        dy[RATES..RATES + 3].copy_from_slice(&acceleration);
        dy[N - 2] = work;
        dy[N - 1] = loss;
        Ok(())
    }

    /// (x'', y'', alpha'') at `t`.
    ///
    /// # Errors
    /// As the plant's equations.
    pub fn accelerations(&self, t: f64, y: &[f64; N]) -> Result<[f64; 3], Refusal> {
        let mut dy = [0.0; N];
        self.slope(t, y, &mut dy)?;
        Ok(three(&dy, RATES))
    }

    /// What can be seen of the plant at `t` besides its state.
    ///
    /// # Errors
    /// As the plant's equations.
    pub fn outputs(&self, t: f64, y: &[f64; N]) -> Result<Outputs, Refusal> {
        let legs = self.legs(y)?;
        let told = self.told(t, &legs, y)?;
        let rotors = [0, 1, 2].map(|leg| self.rotor(leg, &legs[leg], y));
        Ok(Outputs {
            angles: [0, 1, 2].map(|leg| self.mechanics.motor_angle(leg, &legs[leg])),
            rotor_angles: rotors.map(|rotor| rotor.angle),
            rotor_rates: rotors.map(|rotor| rotor.rate),
            told,
            torques: [0, 1, 2]
                .map(|leg| self.motor_torque(leg, told[leg], &legs[leg], y, rotors[leg].rate)),
            currents: [0, 1, 2].map(|leg| Self::current(y, leg)),
            legs,
        })
    }

    /// Kinetic, potential, magnetic and elastic energy together, J.
    ///
    /// # Errors
    /// [`Refusal::Pose`].
    pub fn energy(&self, y: &[f64; N]) -> Result<f64, Refusal> {
        let (q, v) = (three(y, 0), three(y, RATES));
        let legs = self.mechanics.legs(q, v)?;
        let mut energy =
            self.mechanics.kinetic_energy(q, v, &legs) + self.mechanics.potential_energy(q, &legs);
        for leg in 0..3 {
            if Self::ELASTIC {
                let rate = y[ROTOR_RATES + leg];
                let angle = self.mechanics.motor_angle(leg, &legs[leg]);
                let twist = wrapped(y[ROTORS + leg] - angle);
                let stiffness = self.transmission[leg].stiffness_nm_rad;
                energy += 0.5 * (self.rotors[leg] * rate * rate + stiffness * twist * twist);
            }
            if let Motor::Bldc(winding) = &self.motors[leg] {
                let current = Self::current(y, leg);
                energy += 0.5 * winding.inductance * current * current;
            }
        }
        Ok(energy)
    }

    /// Looks at the energies, for the size of what flows.
    pub(super) fn note_energy(&mut self, y: &[f64; N]) -> Result<(), Refusal> {
        let (q, v) = (three(y, 0), three(y, RATES));
        let legs = self.mechanics.legs(q, v)?;
        let kinetic = self.mechanics.kinetic_energy(q, v, &legs);
        self.kinetic_peak = self.kinetic_peak.max(kinetic);
        Ok(())
    }

    /// What `controller` makes of a deviation of each joint.
    fn gains_of(&self, controller: &Controller) -> LoopGains {
        let mut gains = LoopGains {
            angle: [0.0; 3],
            rate: [0.0; 3],
        };
        for (leg, motor) in self.motors.iter().enumerate() {
            let (kp, kd) = (controller.kp_nm_rad[leg], controller.kd_nm_s_rad[leg]);
            (gains.angle[leg], gains.rate[leg]) = match motor {
                Motor::Ideal => (-kp, -kd),
                Motor::Bldc(winding) => {
                    let per_torque = winding.resistance / winding.torque_constant;
                    (-kp * per_torque, winding.back_emf - kd * per_torque)
                }
                Motor::Stepper(_) => (0.0, 0.0),
            };
        }
        gains
    }

    /// Derivatives of y' by what each motor is told.
    pub(super) fn input_slopes(&self, y: &[f64; N]) -> Result<[[f64; N]; 3], Refusal> {
        let legs = self.legs(y)?;
        let mut without = [0.0; N];
        self.slope_under(&[0.0; 3], &legs, y, &mut without)?;
        let mut slopes = [[0.0; N]; 3];
        for (motor, slope) in slopes.iter_mut().enumerate() {
            let mut told = [0.0; 3];
            told[motor] = 1.0;
            self.slope_under(&told, &legs, y, slope)?;
            for (with, without) in slope.iter_mut().zip(&without) {
                *with -= without;
            }
        }
        Ok(slopes)
    }

    /// Derivatives by the state of the angle that each motor's controller sees, then of the rate,
    /// for a machine at rest.
    pub(super) fn sensed_slopes(&self, y: &[f64; N]) -> Result<[[[f64; N]; 2]; 3], Refusal> {
        let legs = self.legs(y)?;
        let mut slopes = [[[0.0; N]; 2]; 3];
        for (leg, [angle, rate]) in slopes.iter_mut().enumerate() {
            if Self::ELASTIC {
                angle[ROTORS + leg] = 1.0;
                rate[ROTOR_RATES + leg] = 1.0;
            } else {
                angle[..3].copy_from_slice(&legs[leg].k1);
                rate[RATES..RATES + 3].copy_from_slice(&legs[leg].k1);
            }
        }
        Ok(slopes)
    }

    /// What the joints should do at `t`, where the control says so at every instant.
    pub(super) fn references(&self, t: f64) -> Option<Result<[JointReference; 3], Refusal>> {
        match &self.control {
            Control::Continuous(continuous) => Some(continuous.references(t)),
            _ => None,
        }
    }
}

/// What the state of `scene`'s plant holds.
pub fn layout_of(scene: &Scene) -> Layout {
    let bldc = |drive: &Drive| matches!(drive.kind, trirrr_scene::DriveKind::Bldc(_));
    let transmission = scene.plant.as_ref().and_then(|plant| plant.transmission);
    Layout {
        elastic: transmission.is_some(),
        currents: scene.drives.is_some_and(|drives| drives.iter().any(bldc)),
    }
}
