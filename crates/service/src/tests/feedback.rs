//! Drives that tell where they are: enabled where the machine stands, and watched.

use super::*;
use std::vec;
use trirrr_core::forward::Forward;
use trirrr_core::machine::Geometry;
use trirrr_core::number::Number;
use trirrr_protocol::message::{DriveFault, DriveReading, DriveState, FaultCode, NotEnabled};

crate::scene! {
    /// The thesis machine, whose drives tell where they are.
    Measured [N: ServiceNumber] [N]: Thesis<N>, batches = On, update = NoImage, feedback = On
}

const PARAMETERS: FeedbackParameters = FeedbackParameters {
    timeout_ticks: 20,
    enable_ticks: 100,
    still_rad: 1e-3,
    standing_rad: 0.01,
    moving_rad: 0.05,
    window_ticks: 3,
};

/// Ticks that a drive takes to go on, and those by which it follows late.
const GOES_ON: u32 = 4;

/// A drive as it should be, and what is wrong with it.
#[derive(Clone, Debug)]
struct Drive {
    angle: f64,
    /// Ticks since it was told to go on; none while it is off.
    on: Option<u32>,
    error: u32,
    /// It tells nothing any more.
    dead: bool,
    /// It is off whatever it is told.
    stuck: bool,
    /// It has to be calibrated.
    raw: bool,
    /// It slips by so much in each tick.
    slip: f64,
    /// Ticks since it told anything.
    age: u16,
    restarts: u8,
    /// Greatest step of its command since it was on.
    jump: f64,
    cleared: u32,
}

impl Drive {
    fn at(angle: f64) -> Self {
        Self {
            angle,
            on: None,
            error: 0,
            dead: false,
            stuck: false,
            raw: false,
            slip: 0.0,
            age: 0,
            restarts: 0,
            jump: 0.0,
            cleared: 0,
        }
    }

    fn obey(&mut self, power: Power, commanded: f64) {
        match power {
            Power::Clear => (self.error, self.cleared) = (0, self.cleared + 1),
            Power::On if !self.stuck => {
                let ticks = self.on.map_or(0, |ticks| ticks + 1);
                self.on = Some(ticks);
                self.jump = self.jump.max((commanded - self.angle).abs());
                if ticks >= GOES_ON {
                    self.angle = commanded;
                }
            }
            _ => self.on = None,
        }
        self.angle += self.slip;
        self.age = if self.dead {
            self.age.saturating_add(1)
        } else {
            0
        };
    }

    fn state(&self) -> DriveState {
        match self.on {
            _ if self.error != 0 => DriveState::Fault,
            _ if self.raw => DriveState::Uncalibrated,
            Some(ticks) if ticks >= GOES_ON => DriveState::On,
            Some(_) => DriveState::Preparing,
            None => DriveState::Off,
        }
    }

    fn reading<N: Number>(&self) -> DriveReading<N> {
        DriveReading {
            state: self.state(),
            error: self.error,
            age: self.age,
            state_age: self.age,
            restarts: self.restarts,
            ..DriveReading::unheard(N::angle_from_f64(wrap(self.angle)))
        }
    }
}

fn wrap(angle: f64) -> f64 {
    f64::atan2(angle.sin(), angle.cos())
}

/// A machine with drives, which stands anywhere.
struct Rig<N: ServiceNumber> {
    bench: Bench<Measured<N>>,
    drives: [Drive; 3],
    powers: Vec<Power>,
}

/// Feedback of the thesis machine. The memory is never freed.
pub(super) fn coefficients<N: ServiceNumber>() -> &'static FeedbackCoefficients<N> {
    let geometry = Geometry::<N>::build(&example()).unwrap();
    let coefficients = FeedbackCoefficients::build(&PARAMETERS, &example(), &geometry, home());
    Box::leak(Box::new(coefficients.unwrap()))
}

pub(super) fn angles_at(pose: [f64; 3]) -> Option<[f64; 3]> {
    let geometry = Geometry::<f64>::build(&example()).unwrap();
    let [x, y, alpha] = pose;
    let position = geometry.position(&Pose::from_f64(x, y, alpha)).ok()?;
    Some(geometry.motor_angles(&position))
}

impl<N: ServiceNumber> Rig<N> {
    /// Switched on, its joints at `angles`.
    fn new(angles: [f64; 3], limits: LimitParameters) -> Self {
        let scene = SceneParts {
            feedback: Some(coefficients()),
            ..Adjustable::new(example(), limits).into()
        };
        let mut rig = Self {
            bench: Bench::off(scene, home(), settings()),
            drives: angles.map(Drive::at),
            powers: vec![],
        };
        rig.ticks(3);
        rig
    }

    fn tick(&mut self) -> Output<N> {
        let readings = self.drives.each_ref().map(Drive::reading);
        self.bench.service.hear(readings);
        let output = self.bench.tick();
        for (drive, motor) in self.drives.iter_mut().zip(&output.motors) {
            let commanded = N::angle_to_f64(motor.angle);
            let way = wrap(commanded - drive.angle);
            drive.obey(output.power, drive.angle + way);
        }
        if self.powers.last() != Some(&output.power) {
            self.powers.push(output.power);
        }
        while self.bench.service.step() {}
        output
    }

    fn ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    fn enable(&mut self) -> State {
        self.bench.done(Command::Enable);
        for _ in 0..200 {
            self.tick();
            let state = self.bench.state();
            if !matches!(state, State::Enabling | State::Disabling) {
                return state;
            }
        }
        panic!("{:?}", self.bench.status());
    }

    fn fault(&mut self) -> Option<(FaultCode, Option<u8>)> {
        self.bench
            .status()
            .fault
            .map(|fault| (fault.code, fault.index))
    }
}

fn started() -> Rig<f64> {
    let mut rig = Rig::new(
        angles_at([0.25, 0.24, 0.1]).unwrap(),
        LimitParameters::default(),
    );
    assert_eq!(rig.enable(), State::Idle);
    rig
}

/// The first command is where the joints are, to rounding, and no drive is on before it is told.
#[test]
fn a_machine_is_enabled_where_it_stands() {
    let there = [0.25, 0.24, 0.1];
    let mut rig = Rig::<f32>::new(angles_at(there).unwrap(), LimitParameters::default());
    assert_eq!(rig.powers, [Power::Off]);
    assert_eq!(rig.enable(), State::Idle);
    assert_eq!(rig.powers, [Power::Off, Power::Check, Power::On]);
    for drive in &rig.drives {
        assert!(drive.jump < 2e-6, "{drive:?}");
        assert_eq!(drive.cleared, 0);
    }
    let end = rig.bench.status().end.unwrap().pose;
    for (found, there) in [end.position.x, end.position.y, end.angle]
        .iter()
        .zip(there)
    {
        assert!((f64::from(*found) - there).abs() < 2e-6, "{end:?}");
    }
    // And it plays from there.
    let status = rig.bench.status();
    rig.bench
        .offer(rest(status.next, end, pose(0.28, 0.28, 0.2), 100));
    rig.bench.done(Command::Start);
    rig.ticks(105);
    assert_eq!((rig.bench.state(), rig.fault()), (State::Idle, None));
}

/// Every pose in the workspace is found, and none but it; the list of all assembly modes is the judge.
#[test]
fn the_pose_is_found_anywhere_in_the_workspace() {
    let geometry = Geometry::<f64>::build(&example()).unwrap();
    let forward = Forward::build(&example(), &geometry);
    let side = forward.side(&angles_at([0.21, 0.22, 0.157]).unwrap(), &home());
    let mut random = 0x1234_5678_9abc_def1_u64;
    let mut next = |from: f64, to: f64| {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        from + (to - from) * (random >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut found, mut many) = (0, 0);
    while found < 400 {
        let there = [next(0.05, 0.45), next(0.05, 0.45), next(-1.0, 1.2)];
        let Some(angles) = angles_at(there) else {
            continue;
        };
        let at = Pose::from_f64(there[0], there[1], there[2]);
        if forward.side(&angles, &at) != side {
            continue;
        }
        // As the search counts them: elbows and side of the scene.
        let all = forward.assemblies(&angles).unwrap();
        let fits = all.modes().iter().filter(|mode| {
            let position = geometry.position(&mode.pose);
            let same = position.is_ok_and(|position| {
                let turned = geometry.motor_angles(&position);
                turned
                    .iter()
                    .zip(&angles)
                    .all(|(a, b)| wrap(a - b).abs() < 1e-3)
            });
            same && (mode.det_a > 0.0) == side && mode.distance > 1e-3
        });
        let modes = fits.count();
        if all.modes().iter().any(|mode| mode.distance < 1e-2) {
            continue;
        }
        let mut rig = Rig::<f32>::new(angles, LimitParameters::default());
        let state = rig.enable();
        match modes {
            1 => {
                assert_eq!(state, State::Idle, "{there:?} {:?}", rig.bench.status());
                let end = rig.bench.status().end.unwrap().pose;
                let off = f64::from(end.position.x) - there[0];
                assert!(off.abs() < 1e-4, "{there:?} {end:?}");
                found += 1;
            }
            _ => {
                assert_eq!(state, State::Disabled, "{there:?}");
                let why = rig.bench.status().not_enabled;
                assert_eq!(why, Some(NotEnabled::ManyPoses), "{there:?} {modes}");
                many += 1;
            }
        }
    }
    std::println!("{found} poses found, {many} with more than one");
}

#[test]
fn a_drive_that_is_not_ready_refuses_with_its_own_reason() {
    type Defect = fn(&mut Drive);
    let cases: [(Defect, DriveState, u32); 4] = [
        (|drive| drive.dead = true, DriveState::Silent, 0),
        (|drive| drive.error = 77, DriveState::Fault, 77),
        (|drive| drive.raw = true, DriveState::Uncalibrated, 0),
        (|drive| drive.stuck = true, DriveState::Off, 0),
    ];
    for (defect, state, error) in cases {
        let mut rig = Rig::<f64>::new(
            angles_at([0.25, 0.24, 0.1]).unwrap(),
            LimitParameters::default(),
        );
        defect(&mut rig.drives[1]);
        rig.ticks(30);
        assert_eq!(rig.enable(), State::Disabled);
        let refused = NotEnabled::Drive {
            motor: 1,
            state,
            error,
        };
        assert_eq!(rig.bench.status().not_enabled, Some(refused));
        assert_eq!(rig.tick().power, Power::Off);
        // Mended, it goes on. An error is cleared when a host asks for it, and not before.
        rig.drives[1] = Drive {
            error,
            ..Drive::at(rig.drives[1].angle)
        };
        assert_eq!(rig.drives[1].cleared, 0);
        if error != 0 {
            rig.bench.done(Command::ClearFault);
            rig.tick();
            assert_eq!(rig.drives[1].cleared, 1);
        }
        assert_eq!(rig.enable(), State::Idle);
        assert_eq!(rig.bench.status().not_enabled, None);
    }
}

#[test]
fn joints_that_fit_no_pose_refuse() {
    let angles = angles_at([0.25, 0.24, 0.1]).unwrap();
    // The elbow of leg 1 on its other side: the same place of the platform, another working mode.
    let mut rig = Rig::<f64>::new(
        [angles[0] + 2.0, angles[1], angles[2]],
        LimitParameters::default(),
    );
    assert_eq!(rig.enable(), State::Disabled);
    assert_eq!(rig.bench.status().not_enabled, Some(NotEnabled::NoPose));

    let near = LimitParameters {
        parallel_distance_min: 0.99,
        ..LimitParameters::default()
    };
    let mut rig = Rig::<f64>::new(angles, near);
    assert_eq!(rig.enable(), State::Disabled);
    let why = rig.bench.status().not_enabled;
    assert!(matches!(why, Some(NotEnabled::Singular { .. })), "{why:?}");
}

#[test]
fn a_joint_that_moves_refuses() {
    let mut rig = Rig::<f64>::new(
        angles_at([0.25, 0.24, 0.1]).unwrap(),
        LimitParameters::default(),
    );
    rig.drives[2].slip = 2e-3;
    assert_eq!(rig.enable(), State::Disabled);
    let why = rig.bench.status().not_enabled;
    assert!(
        matches!(why, Some(NotEnabled::Moves { motor: 2, .. })),
        "{why:?}"
    );
}

/// Each defect of a drive that is on is the fault of its own, within its time, and the drives are off from then on.
#[test]
fn a_drive_that_fails_is_a_fault() {
    type Defect = fn(&mut Drive);
    let cases: [(Defect, FaultCode, u32); 4] = [
        (
            |drive| drive.dead = true,
            FaultCode::Drive(DriveFault::Silent),
            u32::from(PARAMETERS.timeout_ticks) + 2,
        ),
        (
            |drive| drive.error = 9,
            FaultCode::Drive(DriveFault::Reported),
            2,
        ),
        (
            |drive| (drive.stuck, drive.on) = (true, None),
            FaultCode::Drive(DriveFault::NotOn),
            2,
        ),
        (
            |drive| (drive.slip, drive.angle) = (0.0, drive.angle + 0.02),
            FaultCode::FollowingError,
            2,
        ),
    ];
    for (defect, code, most) in cases {
        let mut rig = started();
        rig.ticks(10);
        assert_eq!(rig.fault(), None);
        defect(&mut rig.drives[0]);
        if code == FaultCode::FollowingError {
            // It stays where it is.
            rig.drives[0].slip = 0.02;
        }
        let mut ticks = 0;
        while rig.fault().is_none() {
            rig.tick();
            ticks += 1;
            assert!(
                ticks <= most.max(u32::from(PARAMETERS.window_ticks) + 1),
                "{code:?}"
            );
        }
        assert_eq!(rig.fault(), Some((code, Some(0))));
        assert_eq!(rig.tick().power, Power::Off);
    }
}

/// A dead drive tows nobody: in the middle of a job, too.
#[test]
fn a_dead_drive_stops_a_job() {
    let mut rig = started();
    let end = rig.bench.status().end.unwrap().pose;
    rig.bench.offer(rest(0, end, pose(0.28, 0.28, 0.2), 100));
    rig.bench.done(Command::Start);
    rig.ticks(30);
    rig.drives[1].dead = true;
    rig.ticks(u32::from(PARAMETERS.timeout_ticks) + 2);
    assert_eq!(
        rig.fault(),
        Some((FaultCode::Drive(DriveFault::Silent), Some(1)))
    );
    // Back again, it is measured anew, and goes on where it stands: no recovery.
    rig.drives[1].dead = false;
    rig.bench.done(Command::ClearFault);
    rig.ticks(2);
    assert_eq!(rig.enable(), State::Idle);
    let stands = rig.bench.status().end.unwrap().pose;
    assert!(stands != end);
}

/// A restart is a fault of drives that are on. It is told when the machine is enabled, of all drives that have restarted by then, and
/// acknowledged by no `ClearFault` that comes before that.
#[test]
fn a_restart_is_told_before_it_is_acknowledged() {
    let mut rig = started();
    rig.drives[2].restarts = 7;
    rig.ticks(2);
    assert_eq!(
        rig.fault(),
        Some((FaultCode::Drive(DriveFault::Restarted), Some(2)))
    );
    assert_eq!(rig.tick().power, Power::Off);
    let angles = rig.drives.each_ref().map(|drive| wrap(drive.angle));
    let told = |rig: &mut Rig<f64>, legs: [bool; 3]| {
        let angle = |leg: usize| legs[leg].then_some(angles[leg]);
        let angles = [angle(0), angle(1), angle(2)];
        let wanted = NotEnabled::Restarted { angles };
        assert_eq!(rig.enable(), State::Disabled);
        assert_eq!(rig.bench.status().not_enabled, Some(wanted));
        assert!(wanted.wants_acknowledgement());
    };
    // That fault is acknowledged, and not where the joint is.
    rig.bench.done(Command::ClearFault);
    rig.ticks(2);
    told(&mut rig, [false, false, true]);
    // Another one meanwhile, which no host was told.
    rig.drives[0].restarts = 255;
    rig.ticks(2);
    rig.bench.done(Command::ClearFault);
    rig.ticks(2);
    told(&mut rig, [true, false, false]);
    told(&mut rig, [true, false, false]);
    rig.bench.done(Command::ClearFault);
    rig.ticks(2);
    assert_eq!(rig.enable(), State::Idle);
    rig.ticks(20);
    assert_eq!((rig.fault(), rig.bench.status().not_enabled), (None, None));
    // Off by a host, a drive restarts: the same.
    rig.bench.done(Command::Disable);
    rig.ticks(100);
    rig.drives[1].restarts += 1;
    told(&mut rig, [false, true, false]);
}

/// Homing finds the joints anyway: nobody has to acknowledge where they are taken to be.
#[test]
fn a_machine_with_homing_is_unhomed_behind_a_restart() {
    let parameters = super::homing::parameters(Contact::Switch);
    let homing = HomingCoefficients::build(&parameters, PERIOD_S);
    let scene = SceneParts {
        homing: Some(&*Box::leak(Box::new(homing))),
        feedback: Some(coefficients()),
        ..Adjustable::new(example(), LimitParameters::default()).into()
    };
    let mut bench = Bench::<Homed<f64>>::off(scene, home(), settings());
    let mut drives = super::homing::home_angles().map(Drive::at);
    let mut ticks = |bench: &mut Bench<Homed<f64>>, restarts: [u8; 3]| {
        for (drive, restarts) in drives.iter_mut().zip(restarts) {
            drive.restarts = restarts;
        }
        for _ in 0..30 {
            let readings = drives.each_ref().map(Drive::reading);
            bench.service.hear(readings);
            let output = bench.tick();
            for drive in &mut drives {
                let angle = drive.angle;
                drive.obey(output.power, angle);
            }
            while bench.service.step() {}
        }
    };
    ticks(&mut bench, [0, 1, 0]);
    bench.done(Command::Enable);
    ticks(&mut bench, [0, 1, 0]);
    assert_eq!(bench.state(), State::Unhomed);
    ticks(&mut bench, [0, 1, 2]);
    let code = bench.status().fault.map(|fault| fault.code);
    assert_eq!(code, Some(FaultCode::Drive(DriveFault::Restarted)));
    bench.done(Command::ClearFault);
    ticks(&mut bench, [0, 1, 2]);
    bench.done(Command::Enable);
    ticks(&mut bench, [0, 1, 2]);
    let status = bench.status();
    assert_eq!((status.state, status.not_enabled), (State::Unhomed, None));
}

#[test]
fn a_host_gets_samples_of_the_drives() {
    let mut rig = started();
    rig.bench.done(Command::Drives { every: 2 });
    rig.bench.drives.clear();
    rig.ticks(10);
    let ticks: Vec<u32> = rig.bench.drives.iter().map(|sample| sample.tick).collect();
    assert_eq!(ticks.len(), 5);
    assert!(ticks.windows(2).all(|pair| pair[1] == pair[0] + 2));
    assert_eq!(rig.bench.drives[0].drives[0].state, DriveState::On);
    let mut plain = Bench::<Thesis<f64>>::new();
    assert_eq!(
        plain.refused(Command::Drives { every: 1 }),
        Refusal::NoFeedback
    );
}
