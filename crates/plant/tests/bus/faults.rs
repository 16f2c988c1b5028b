//! Faults at any time: each ends in the right reading or failure, with the outputs safe, and is left by the documented
//! way.

use crate::bench::{
    Bench, DAMIAO, Ended, MOTEUS, ODRIVE_HZ, T_MOTOR, TICK_RATE_HZ, TIMEOUT_TICKS, actuator,
    moteus, odrive,
};
use trirrr_drives::can::{Odrive, Protocol};
use trirrr_protocol::message::{DriveFault, DriveState};

/// Numbers without a pattern (splitmix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, bound: u32) -> u32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % u64::from(bound)) as u32
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    Dead,
    Idle,
    Hot,
    BoardOff,
    Lost(u32),
    Late(u64),
}

impl Fault {
    fn of(random: &mut Random) -> Self {
        match random.below(6) {
            0 => Self::Dead,
            1 => Self::Idle,
            2 => Self::Hot,
            3 => Self::BoardOff,
            4 => Self::Lost(1 + random.below(10)),
            // Up to five ticks.
            _ => Self::Late(u64::from(random.below(10_000_000))),
        }
    }
}

/// Differences between the kinds of drive.
#[derive(Clone, Copy)]
struct Kind {
    /// Ticks from one state to the next, as the drive tells it.
    state_ticks: u32,
    /// Code of a drive that is too hot.
    too_hot: u32,
    /// A drive that has left its loop is not seen: it has no state in its frames, or goes on with the next command,
    /// which has the mode in it.
    idles_unseen: bool,
}

fn case<P: Protocol, const LONGEST: usize>(
    bench: &mut Bench<P, LONGEST>,
    kind: Kind,
    random: &mut Random,
) {
    let fault = Fault::of(random);
    let leg = random.below(3) as usize;
    bench.enable(200).unwrap();
    let before = random.below(80);
    bench
        .watch(before)
        .unwrap_or_else(|ended| panic!("before {fault:?}: {ended:?}"));
    let began = bench.ticks;
    {
        let mut medium = bench.medium();
        match fault {
            Fault::Dead => medium.drive(leg).die(),
            Fault::Idle => medium.drive(leg).idle(),
            Fault::Hot => medium.drive(leg).heat(),
            Fault::BoardOff => medium.faults.board_is_off = true,
            Fault::Lost(percent) => medium.faults.lost_percent = percent,
            Fault::Late(late_ns) => medium.faults.late_ns = late_ns,
        }
    }
    let ended = bench.watch(150);
    let after = bench.ticks - began;
    let context = format!("{fault:?} of {leg} after {before} ticks: {ended:?} {after} ticks later");
    // From the message to the tick that reads it, and the age of the last message.
    let soon = kind.state_ticks + 3;
    match (fault, &ended) {
        (Fault::Dead, Err(Ended::Drive(found, reading))) => {
            assert_eq!((*found, reading.state), (leg, DriveState::On), "{context}");
            let age = reading.age.max(reading.state_age);
            assert!(age == TIMEOUT_TICKS + 1, "{context}");
            assert!(after <= u32::from(TIMEOUT_TICKS) + 3, "{context}");
        }
        (Fault::Idle, Err(Ended::Drive(found, reading))) => {
            assert_eq!((*found, reading.state), (leg, DriveState::Off), "{context}");
            assert!(after <= soon, "{context}");
        }
        (Fault::Idle, Ok(())) => assert!(kind.idles_unseen, "{context}"),
        (Fault::Hot, Err(Ended::Drive(found, reading))) => {
            assert_eq!(
                (*found, reading.state),
                (leg, DriveState::Fault),
                "{context}"
            );
            assert!(reading.error == kind.too_hot && after <= soon, "{context}");
        }
        (Fault::BoardOff, Err(Ended::Bus(DriveFault::BusOff))) => {
            assert!(after <= 1, "{context}");
        }
        // A tenth of the frames and a few ticks are no loss of a drive.
        (Fault::Lost(_) | Fault::Late(_), Ok(())) => {}
        _ => panic!("{context}"),
    }
    // The board switches off; one that cannot be heard leaves it to the watchdogs.
    bench.off(u32::from(TIMEOUT_TICKS) + 5);
    assert_eq!(bench.torques(), [0.0; 3], "{context}");
    {
        let mut medium = bench.medium();
        medium.drive(leg).cool();
        medium.faults = Default::default();
    }
    let recovered = bench.recover();
    match fault {
        Fault::Dead => {
            let Err(Ended::Drive(found, _)) = recovered else {
                panic!("{context}");
            };
            assert_eq!(found, leg, "{context}");
        }
        _ => recovered.unwrap_or_else(|ended| panic!("{context}, then {ended:?}")),
    }
    bench.off(60);
    assert_eq!(bench.torques(), [0.0; 3], "{context}");
}

fn inject(seeds: std::ops::Range<u64>) {
    let slow = (TICK_RATE_HZ / (ODRIVE_HZ / 21.0)).ceil() as u32;
    let kind = |state_ticks, too_hot, idles_unseen| Kind {
        state_ticks,
        too_hot,
        idles_unseen,
    };
    for seed in seeds {
        let random = &mut Random(seed);
        match seed % 4 {
            0 => case(
                &mut Bench::new(Odrive, odrive),
                kind(slow, 0x2000, false),
                random,
            ),
            1 => case(&mut Bench::new(MOTEUS, moteus), kind(1, 38, true), random),
            2 => case(
                &mut Bench::new(DAMIAO, actuator(DAMIAO)),
                kind(1, 0xC, false),
                random,
            ),
            _ => case(
                &mut Bench::new(T_MOTOR, actuator(T_MOTOR)),
                kind(1, 1, true),
                random,
            ),
        }
    }
}

#[test]
fn every_fault_ends_as_it_should() {
    inject(0..160);
}

#[test]
#[ignore = "minutes of run time; cargo xtask nightly runs it, optimised"]
fn a_million_faults_end_as_they_should() {
    let part = 1_000_000 / WORKERS;
    std::thread::scope(|scope| {
        for worker in 0..WORKERS {
            scope.spawn(move || inject(worker * part..(worker + 1) * part));
        }
    });
}

/// Threads of the test of a million faults.
const WORKERS: u64 = 8;
