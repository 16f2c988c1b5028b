//! A service with contact detection on a machine in forward dynamics, with drives that count and err.

use std::f64::consts::TAU;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{Geometry, Parameters, example};
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{Horizontal, Massive};
use trirrr_core::torque::payload::Centred;
use trirrr_plant::friction::Friction;
use trirrr_plant::mechanics::{JointMoments, Mechanics};
use trirrr_protocol::message::{
    Command, DriveReading, DriveState, Fault, Move, QuinticMove, Reply, State,
};
use trirrr_service::board::CommandOf;
use trirrr_service::coefficients::{ContactCoefficients, FeedbackCoefficients};
use trirrr_service::features::{
    ContactModel, ContactObserver, ContactParameters, FeedbackParameters, On,
};
use trirrr_service::{
    Adjustable, Channels, Output, Power, SceneParts, Service, Settings, StopCategory, scene,
};

type Links = Dynamic<f32, Centred<f32>, Massive<f32, Horizontal>>;
scene! {
    /// A machine that feels contacts.
    Scene: Adjustable<Links>, feedback = On, contact = On
}

/// Samples of the drives in a second: encoder, loop, and step of the mechanics.
const SAMPLES_HZ: f64 = 8000.0;
/// Counts of the encoder for each turn of the rotor.
const COUNTS: f64 = 4096.0;
/// Bandwidth of the drives' observers of their encoders, rad/s: as an ODrive is delivered.
const ENCODER_BANDWIDTH: f64 = 1000.0;
/// Gains of the drives at the joint.
const GAINS: [f64; 2] = [300.0, 3.0];

/// Ends of the motion, the first also the start.
const ENDS: [[f64; 3]; 2] = [[0.21, 0.22, 0.157], [0.28, 0.28, 0.209]];

/// Machine and detection of a bench.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setup {
    pub(crate) tick_rate_hz: f64,
    pub(crate) gear: f64,
    pub(crate) rotor_inertia: f64,
    /// Standard deviation of a torque reading at the joint, N m.
    pub(crate) torque_noise: f64,
    /// Coulomb friction of the motors at the joints, N m.
    pub(crate) coulomb: f64,
    pub(crate) contact: ContactParameters,
}

/// Drive with an encoder at the rotor.
struct Drive {
    /// Angle of a count 0, rad at the joint.
    phase: f64,
    angle: f64,
    rate: f64,
    torque: f64,
    /// Message to the board: rate and torque in the middle of a tick.
    told: [f64; 2],
}

pub(crate) struct Bench {
    setup: Setup,
    mechanics: Mechanics,
    friction: Friction,
    q: [f64; 3],
    v: [f64; 3],
    /// Joint angles, not wrapped.
    joints: [f64; 3],
    drives: [Drive; 3],
    power: Power,
    service: Service<'static, Scene>,
    random: Random,
    /// Estimate of the force and moment at the tool, by the platform's true pose.
    pub(crate) wrench: [f32; 3],
    estimate: Estimate,
}

/// A host's estimate beside that of the tick.
struct Estimate {
    tick: Tick<Links>,
    coefficients: ContactCoefficients<f32>,
    observer: ContactObserver<f32>,
    before: Option<Output<f32>>,
}

impl Estimate {
    /// Force and moment at the tool, from the readings that answer the output before.
    fn wrench(&mut self, readings: &[DriveReading<f32>; 3], pose: Pose<f32>) -> [f32; 3] {
        let Some(before) = &self.before else {
            return [0.0; 3];
        };
        let model = ContactModel::at(&self.tick, pose, &self.coefficients).unwrap();
        let told = readings.map(|reading| [reading.rate, reading.torque]);
        let deviations = self.coefficients.deviations(&told, &before.motors);
        let external = self
            .observer
            .observe(&self.coefficients, &model, &deviations);
        model.at_tool(&external)
    }
}

/// Numbers of a normal distribution.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let (a, b) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
    }
}

fn machine(setup: &Setup) -> Parameters {
    let mut parameters = example();
    for leg in &mut parameters.legs {
        for (link, length) in [
            (&mut leg.proximal, leg.proximal_m),
            (&mut leg.distal, leg.distal_m),
        ] {
            // Uniform rods.
            link.mass_kg = 0.05;
            link.com_m = 0.5 * length;
            link.inertia_kgm2 = 0.05 * length * length / 12.0;
        }
        leg.rotor_inertia_kgm2 = setup.gear * setup.gear * setup.rotor_inertia;
    }
    parameters
}

fn pose([x, y, alpha]: [f64; 3]) -> Pose<f32> {
    Pose::from_f64(x, y, alpha)
}

impl Bench {
    pub(crate) fn new(setup: Setup, seed: u64) -> Self {
        let parameters = machine(&setup);
        let mechanics = Mechanics::build(&parameters, true).unwrap();
        let geometry = Geometry::<f32>::build(&parameters).unwrap();
        let watch = FeedbackParameters {
            timeout_ticks: 50,
            enable_ticks: 500,
            still_rad: 5e-3,
            standing_rad: 0.05,
            moving_rad: 0.1,
            window_ticks: 5,
        };
        let feedback =
            FeedbackCoefficients::build(&watch, &parameters, &geometry, pose(ENDS[0])).unwrap();
        let contact = ContactCoefficients::build(&setup.contact, 1.0 / setup.tick_rate_hz).unwrap();
        let scene = SceneParts {
            feedback: Some(Box::leak(Box::new(feedback))),
            contact: Some(Box::leak(Box::new(contact))),
            ..Adjustable::new(parameters, LimitParameters::default()).into()
        };
        let channels = Box::leak(Box::new(Channels::<Scene, 8, 8>::new()));
        let service = channels
            .service(scene, pose(ENDS[0]), Settings::at(setup.tick_rate_hz))
            .unwrap();
        let mut random = Random(seed | 1);
        let q = ENDS[0];
        let legs = mechanics.configuration(None, q, [0.0; 3]).unwrap().legs;
        let joints = [0, 1, 2].map(|leg| mechanics.motor_angle(leg, &legs[leg]));
        let drives = joints.map(|angle| Drive {
            phase: random.uniform() * TAU / (COUNTS * setup.gear),
            angle,
            rate: 0.0,
            torque: 0.0,
            told: [0.0; 2],
        });
        let mut bench = Self {
            setup,
            mechanics,
            friction: Friction {
                viscous: 0.0,
                coulomb: setup.coulomb,
                stick: 1e-3,
            },
            q,
            v: [0.0; 3],
            joints,
            drives,
            power: Power::Off,
            service,
            random,
            estimate: Estimate {
                tick: Tick::build(&parameters).unwrap(),
                coefficients: contact,
                observer: ContactObserver::AT_REST,
                before: None,
            },
            wrench: [0.0; 3],
        };
        bench.run(5);
        bench.done(Command::Enable);
        for _ in 0..1000 {
            if bench.service.state() == State::Idle {
                return bench;
            }
            bench.tick();
        }
        panic!("{:?}", bench.service.status());
    }

    fn done(&mut self, command: CommandOf<Scene>) {
        assert_eq!(self.service.submit(&command), Reply::Done, "{command:?}");
    }

    fn state(&self) -> State {
        self.service.state()
    }

    pub(crate) fn fault(&mut self) -> Option<Fault<f32>> {
        self.service.status().fault
    }

    fn push(&mut self, push: [f64; 3]) {
        self.mechanics.set_push(push);
    }

    /// Moves there and back for ever, `ticks` each way.
    fn shuttle(&mut self, ticks: u32) {
        // It was enabled where its drives said that it stands.
        let status = self.service.status();
        let from = status.end.unwrap().pose;
        let to = pose(ENDS[(status.next as usize + 1) % 2]);
        // Quintics: no jump of the acceleration, which a drive would follow late.
        let next = QuinticMove {
            common: Move::rest_to_rest(status.next, from, to, ticks),
            start_acceleration: [0.0; 3],
            end_acceleration: [0.0; 3],
        };
        self.done(Command::Quintic(next));
        while self.service.step() {}
        self.done(Command::Start);
    }

    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// One tick of the board, then the machine until the next. Returns the output.
    pub(crate) fn tick(&mut self) -> Output<f32> {
        let readings = [0, 1, 2].map(|leg| self.reading(leg));
        self.wrench = self.estimate.wrench(&readings, pose(self.q));
        self.service.hear(readings);
        let output = *self.service.tick();
        self.power = output.power;
        self.estimate.before = Some(output);
        while self.service.step() {}
        while self.service.outgoing().is_some() {}
        let samples = (SAMPLES_HZ / self.setup.tick_rate_hz).round() as u32;
        for sample in 0..samples {
            self.sample(&output, sample, samples / 2);
        }
        output
    }

    fn reading(&mut self, leg: usize) -> DriveReading<f32> {
        let noise = self.setup.torque_noise * self.random.normal();
        let drive = &self.drives[leg];
        DriveReading {
            state: match self.power {
                Power::On => DriveState::On,
                _ => DriveState::Off,
            },
            age: 0,
            state_age: 0,
            rate: drive.told[0] as f32,
            torque: (drive.told[1] + noise) as f32,
            ..DriveReading::unheard(f64::atan2(drive.angle.sin(), drive.angle.cos()) as f32)
        }
    }

    /// Encoders, loops and mechanics, at `sample` of the tick.
    fn sample(&mut self, output: &Output<f32>, sample: u32, middle: u32) {
        let period = 1.0 / SAMPLES_HZ;
        let since = f64::from(sample) * period;
        let at = self.mechanics.configuration(None, self.q, self.v).unwrap();
        let mut moments = [JointMoments::default(); 3];
        for (leg, moment) in moments.iter_mut().enumerate() {
            let angle = self.mechanics.motor_angle(leg, &at.legs[leg]);
            let way = angle - self.joints[leg];
            self.joints[leg] += way - TAU * (way / TAU).round();
            let drive = &mut self.drives[leg];
            let count = TAU / (COUNTS * self.setup.gear);
            let counted = ((self.joints[leg] - drive.phase) / count).round() * count + drive.phase;
            let ahead = drive.angle + period * drive.rate;
            let error = counted - ahead;
            let quick = 2.0 * ENCODER_BANDWIDTH * period;
            drive.angle = ahead + quick * error;
            drive.rate += 0.25 * quick * quick / period * error;
            let motor = &output.motors[leg];
            let target = f64::from(motor.angle) + f64::from(motor.rate) * since;
            let off = target - drive.angle;
            let off = off - TAU * (off / TAU).round();
            drive.torque = match output.power {
                Power::On => {
                    GAINS[0] * off
                        + GAINS[1] * (f64::from(motor.rate) - drive.rate)
                        + f64::from(motor.torque)
                }
                _ => 0.0,
            };
            if sample == middle {
                drive.told = [drive.rate, drive.torque];
            }
            let rate = at.legs[leg].rates[0];
            let friction = self.friction.moment(rate, self.friction.region(rate));
            moment.proximal = drive.torque - friction;
        }
        let acceleration = self.mechanics.acceleration(&at, &moments).unwrap();
        let state = self.q.iter_mut().zip(&mut self.v);
        for ((place, rate), acceleration) in state.zip(acceleration) {
            *rate += period * acceleration;
            *place += period * *rate;
        }
    }
}

/// Motor of 1.5e-6 kg m^2 behind a gear of 80, at 2 kHz: what it takes to feel a newton within 5 ms.
pub(crate) const FINE: Setup = Setup {
    tick_rate_hz: 2000.0,
    gear: 80.0,
    rotor_inertia: 1.5e-6,
    torque_noise: 0.01,
    coulomb: 0.0,
    contact: detection(0.22, 50.0, 1),
};

/// Motor of 1e-5 kg m^2 behind a gear of 10, at 1 kHz, as in `scenes/plant-odrive.toml`: a count of its encoder is 28 um at
/// the tool.
pub(crate) const COARSE: Setup = Setup {
    tick_rate_hz: 1000.0,
    gear: 10.0,
    rotor_inertia: 1e-5,
    torque_noise: 0.01,
    coulomb: 0.0,
    contact: detection(0.5, 20.0, 2),
};

/// Detection of forces beyond `force_n`.
pub(crate) const fn detection(
    force_n: f64,
    bandwidth_hz: f64,
    confirm_ticks: u16,
) -> ContactParameters {
    ContactParameters {
        force_n,
        torque_nm: 1e3,
        bandwidth_hz,
        confirm_ticks,
        model_ticks: 20,
        coulomb_nm: [0.0; 3],
        viscous_nm_s_rad: [0.0; 3],
        sliding_rad_s: 0.05,
        late_ticks: 0,
        told_after: 0.5,
        reaction: StopCategory::StopAndHold,
        retreat_ticks: 0,
    }
}

impl Bench {
    /// Bench that stands or moves for ever, a while after it was enabled.
    pub(crate) fn settled(setup: Setup, seed: u64, moves: bool) -> Self {
        let mut bench = Self::new(setup, seed);
        for _ in 0..200 + seed % 211 {
            bench.go_on(moves);
        }
        bench
    }

    /// One tick; a job that is over begins anew.
    pub(crate) fn go_on(&mut self, moves: bool) {
        if moves && self.state() == State::Idle {
            self.shuttle((0.7 * self.setup.tick_rate_hz) as u32);
        }
        self.tick();
    }

    /// Ticks from the begin of a push to the fault, and the fault; none within half a second.
    pub(crate) fn feel(&mut self, push: [f64; 3], moves: bool) -> Option<(u32, Fault<f32>)> {
        self.push(push);
        let most = (0.5 * self.setup.tick_rate_hz) as u32;
        for ticks in 0..most {
            self.go_on(moves);
            if let Some(fault) = self.fault() {
                return Some((ticks, fault));
            }
        }
        None
    }
}
