//! Machines whose drives tell where they are, with drives that fail; one of them feels what pushes it, and retreats.

use super::*;
use crate::settings::StopCategory;
use trirrr_core::machine::Geometry;
use trirrr_protocol::message::{DriveReading, DriveState};

type Told = super::super::contact::Felt<f64>;

/// Most acts on the way to a state in the short search.
const DEPTH: usize = 4;

const WATCH: FeedbackParameters = FeedbackParameters {
    timeout_ticks: 5,
    enable_ticks: 20,
    still_rad: 1e-3,
    standing_rad: 0.005,
    moving_rad: 0.02,
    window_ticks: 3,
};

const FELT: ContactParameters = ContactParameters {
    force_n: 1.0,
    torque_nm: 0.05,
    bandwidth_hz: 20.0,
    confirm_ticks: 3,
    model_ticks: 4,
    coulomb_nm: [0.0; 3],
    viscous_nm_s_rad: [0.0; 3],
    sliding_rad_s: 0.05,
    late_ticks: 0,
    told_after: 0.0,
    reaction: StopCategory::StopThenOff,
    retreat_ticks: 10,
};

/// Ticks that a drive takes to go on.
const GOES_ON: u8 = 2;

/// Angle by which a joint is off its command, and by which one is moved whose drive is off.
const SLIP_RAD: f64 = 0.03;

/// Torque of a push on the first joint, N m.
const PUSH_NM: f64 = 0.4;

/// Changes around drives that tell where they are.
#[derive(Clone, Copy, Debug, Default)]
struct Defects {
    slips: bool,
    silent: bool,
    errs: bool,
    pushes: bool,
}

/// Drives that follow their commands, or do not. With `FEELS` the machine feels contacts.
struct DrivenMachine<const FEELS: bool> {
    bench: Bench<Told>,
    angles: [f64; 3],
    /// Ticks that the drives have been on for, up to when they follow.
    on: Option<u8>,
    last: Output<f64>,
    /// Ticks for which the second drive has been silent.
    age: u16,
    defects: Defects,
}

impl<const FEELS: bool> DrivenMachine<FEELS> {
    fn reading(&self, i: usize) -> DriveReading<f64> {
        let has_error = self.defects.errs && i == 2;
        let state = match self.on {
            _ if has_error => DriveState::Fault,
            None => DriveState::Off,
            Some(GOES_ON) => DriveState::On,
            Some(_) => DriveState::Preparing,
        };
        let age = if i == 1 { self.age } else { 0 };
        let motor = &self.last.motors[i];
        // A push is what the drive does not have to give.
        let push = if i == 0 && self.defects.pushes {
            PUSH_NM
        } else {
            0.0
        };
        DriveReading {
            state,
            error: u32::from(has_error),
            age,
            state_age: age,
            rate: motor.rate,
            torque: motor.torque - push,
            ..DriveReading::unheard(self.angles[i])
        }
    }

    fn obey(&mut self, output: &Output<f64>) {
        self.on = match (output.is_on(), self.on) {
            (false, _) => None,
            (true, None) => Some(0),
            (true, Some(ticks)) => Some((ticks + 1).min(GOES_ON)),
        };
        if self.on == Some(GOES_ON) {
            self.angles = output.motors.map(|motor| motor.angle);
            if self.defects.slips {
                self.angles[0] += SLIP_RAD;
            }
        }
        self.age = match self.defects.silent {
            true => (self.age + 1).min(2 * WATCH.timeout_ticks),
            false => 0,
        };
        self.last = *output;
    }
}

impl<const FEELS: bool> Explored for DrivenMachine<FEELS> {
    type Scene = Told;

    const ACTS: &'static [Act] = &[
        Act::Ask(Ask::Enable),
        Act::Ask(Ask::Start),
        Act::Ask(Ask::Hold),
        Act::Ask(Ask::Resume),
        Act::Ask(Ask::Stop),
        Act::Ask(Ask::Disable),
        Act::Ask(Ask::ClearFault),
        Act::Ask(Ask::Recover),
        Act::Ask(Ask::Offer),
        Act::Ask(Ask::Retarget),
        Act::World(World::Slips(true)),
        Act::World(World::Slips(false)),
        Act::World(World::Silent(true)),
        Act::World(World::Silent(false)),
        Act::World(World::Errs(true)),
        Act::World(World::Errs(false)),
        Act::World(World::Pushes(true)),
        Act::World(World::Pushes(false)),
        Act::Fails(FaultCode::Overrun),
        Act::Ticks(1),
        Act::Ticks(7),
        Act::Ticks(20),
        Act::Silence,
    ];

    const STARTS: &'static [&'static [Act]] = &[&[], &[Act::Ask(Ask::Enable), Act::Ticks(20)]];

    fn switched_on() -> Self {
        let geometry = Geometry::<f64>::build(&example()).unwrap();
        let feedback = FeedbackCoefficients::build(&WATCH, &example(), &geometry, home()).unwrap();
        let contact = ContactCoefficients::build(&FELT, PERIOD_S).unwrap();
        let scene = SceneParts {
            feedback: Some(Box::leak(Box::new(feedback))),
            contact: FEELS.then(|| &*Box::leak(Box::new(contact))),
            ..Adjustable::new(example(), LimitParameters::default()).into()
        };
        let bench = Bench::with_room::<4>(scene, home(), timed_settings());
        let last = *bench.service.output();
        Self {
            bench,
            angles: last.motors.map(|motor| motor.angle),
            on: None,
            last,
            age: 0,
            defects: Defects::default(),
        }
    }

    fn bench(&mut self) -> &mut Bench<Told> {
        &mut self.bench
    }

    fn tick(&mut self) -> Output<f64> {
        let readings = [0, 1, 2].map(|i| self.reading(i));
        self.bench.service.hear(readings);
        let output = self.bench.tick();
        self.obey(&output);
        self.bench.judge();
        output
    }

    fn change(&mut self, world: World) {
        let defects = &mut self.defects;
        match world {
            World::Slips(slips) => {
                // A joint whose drive is off is moved.
                if slips != defects.slips && self.on.is_none() {
                    self.angles[0] += if slips { SLIP_RAD } else { -SLIP_RAD };
                }
                defects.slips = slips;
            }
            World::Silent(silent) => defects.silent = silent,
            World::Errs(errs) => defects.errs = errs,
            World::Pushes(pushes) => defects.pushes = pushes,
            World::Switches(_)
            | World::Presses(_)
            | World::Opens(_)
            | World::Touches(_)
            | World::Limits(_) => {}
        }
    }

    fn mend(&mut self) {
        self.defects = Defects::default();
    }

    fn world(&self) -> String {
        let Defects { pushes, .. } = self.defects;
        let defects = Defects {
            pushes: pushes && FEELS,
            ..self.defects
        };
        let sign = |motor: &trirrr_core::tick::Motor<f64>| (motor.rate > 0.0, motor.rate < 0.0);
        let silent = self.age > WATCH.timeout_ticks;
        format!(
            "{defects:?} {silent} {:?} {:?}",
            self.on,
            sign(&self.last.motors[0])
        )
    }
}

#[test]
fn drives_that_tell_are_survivable_and_have_a_way_out() {
    let kinds = explore::<DrivenMachine<false>>(Some(DEPTH)).kinds;
    assert_taken(taken::MEASURED_MACHINE);
    // All but those of homing.
    assert_eq!(kinds.len(), 12, "{kinds:?}");
}

#[test]
fn contacts_are_survivable_and_have_a_way_out() {
    let kinds = explore::<DrivenMachine<true>>(Some(DEPTH)).kinds;
    assert_eq!(kinds.len(), 12, "{kinds:?}");
}

/// The searches end by themselves: there are no other states.
#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn all_states_of_drives_that_tell_are_explored() {
    assert!(explore::<DrivenMachine<false>>(None).deepest > DEPTH);
}

#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn all_states_of_contacts_are_explored() {
    let extent = explore::<DrivenMachine<true>>(None);
    assert!(extent.deepest > DEPTH);
}
