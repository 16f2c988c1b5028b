//! Motors with amplifiers and encoders: set values to the count, what the tick measures, and that they let go.

mod common;

use common::{Edge, Pin, Random, Scope, output};
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use std::cell::Cell;
use std::convert::Infallible;
use std::f64::consts::TAU;
use std::rc::Rc;
use trirrr_core::number::Fixed;
use trirrr_drives::bldc::{
    AmplifierParameters, Bldcs, EncoderScale, LoopLine, LoopMotor, LoopUnits, Loops,
};
use trirrr_drives::count::Countable;
use trirrr_drives::joint::LoopParameters;
use trirrr_drives::{Active, Enable};
use trirrr_protocol::message::{DriveReading, DriveState};

/// 84 MHz over 5 kHz.
const FULL: u16 = 16_800;
const CENTRE: u16 = FULL / 2;
const COUNTS_PER_REV: u32 = 4096;
const GEARS: [f64; 3] = [1.0, 6.0, 5.18];
/// Full scale at the joint, N m.
const SCALE_NM: [f64; 3] = [1.5, 4.0, 3.0];
const KP: f64 = 80.0;
const KD: f64 = 1.5;
/// rad/(N m)
const COMPLIANCE: f64 = 1e-3;
const TICK_RATE_HZ: f64 = 1000.0;
const PER_TICK: u32 = 5;
const PERIOD_S: f64 = 1.0 / (TICK_RATE_HZ * PER_TICK as f64);
const START: [f64; 3] = [2.9, -0.4, 1.0];

/// A PWM output.
#[derive(Clone, Debug, Default)]
struct Pwm(Rc<Cell<u16>>);

impl ErrorType for Pwm {
    type Error = Infallible;
}

impl SetDutyCycle for Pwm {
    fn max_duty_cycle(&self) -> u16 {
        FULL
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        assert!(duty <= FULL);
        self.0.set(duty);
        Ok(())
    }
}

struct Bench<'l, N> {
    tick: Bldcs<&'l LoopLine>,
    loops: Loops<&'l LoopLine, Pwm, Pin>,
    pwm: [Pwm; 3],
    scope: Scope,
    reversed: bool,
    /// Joints, rad.
    joints: [f64; 3],
    number: std::marker::PhantomData<N>,
}

impl<'l, N: Countable> Bench<'l, N> {
    fn new(line: &'l LoopLine, reversed: bool, ki: f64) -> Self {
        let scope = Scope::default();
        let pwm = [(); 3].map(|()| Pwm::default());
        let motor = |index: usize| LoopMotor {
            amplifier: AmplifierParameters {
                duty: [0.1, 0.9],
                full_scale_nm: SCALE_NM[index] as f32,
                reversed,
            },
            encoder: EncoderScale::new(COUNTS_PER_REV, GEARS[index], reversed),
            encoder_bandwidth_rad_s: 1000.0,
            compliance_rad_nm: COMPLIANCE as f32,
            controller: LoopParameters {
                kp_nm_rad: KP,
                kd_nm_s_rad: KD,
                ki_nm_rad_s: ki,
                feed_forward: true,
                torque_max_nm: SCALE_NM[index],
                period_s: PERIOD_S,
            },
        };
        let Ok(enable) = Enable::new(scope.pin("enable"), Active::High);
        let motors = [motor(0), motor(1), motor(2)];
        let loops = Loops::new(line, &motors, pwm.clone(), enable, PER_TICK);
        let units = LoopUnits {
            rate_rad_s: 1.0,
            acceleration_rad_s2: 1.0,
            torque_nm: 1.0,
            tick_rate_hz: TICK_RATE_HZ as f32,
        };
        Self {
            tick: Bldcs::new::<N>(line, units, START.map(N::angle_from_f64)),
            loops,
            pwm,
            scope,
            reversed,
            joints: START,
            number: std::marker::PhantomData,
        }
    }

    /// Counts of the encoders, from where they began.
    fn counts(&self) -> [i64; 3] {
        let sign = if self.reversed { -1.0 } else { 1.0 };
        [0, 1, 2].map(|i| {
            let turns = (self.joints[i] - START[i]) / TAU;
            (sign * turns * GEARS[i] * f64::from(COUNTS_PER_REV)).round() as i64
        })
    }

    fn sample(&mut self, failed: [bool; 3]) {
        self.loops
            .sample(self.counts().map(|count| count as u16), failed);
    }

    fn measure(&mut self) -> [DriveReading<N>; 3] {
        self.tick.measure()
    }

    fn duties(&self) -> [u16; 3] {
        self.pwm.each_ref().map(|pwm| pwm.0.get())
    }

    /// Levels of the enable line since the last call.
    fn enables(&self) -> Vec<bool> {
        let edges = self.scope.take();
        edges.iter().map(|Edge { high, .. }| *high).collect()
    }
}

/// Joints that stand where the loops see them: the set value is that of P, D and the torque of the tick, by the formula.
fn set_values<N: Countable>(reversed: bool, tolerance: f64) {
    let line = LoopLine::new();
    let mut bench = Bench::<N>::new(&line, reversed, 0.0);
    let mut random = Random(11);
    // Anywhere, many turns away, reached in steps that the counter follows.
    for _ in 0..200 {
        for joint in &mut bench.joints {
            *joint += 0.3 + 0.05 * random.signed();
        }
        bench.sample([false; 3]);
    }
    for _ in 0..300 {
        bench.sample([false; 3]);
    }
    let mut full = 0;
    for _ in 0..2000 {
        let counted = bench.counts();
        let sign = if reversed { -1.0 } else { 1.0 };
        let wanted = [0, 1, 2].map(|i| {
            let turns = sign * counted[i] as f64 / (GEARS[i] * f64::from(COUNTS_PER_REV));
            let off = 0.02 * random.signed();
            let angle = common::wrapped(START[i] + TAU * turns + off);
            [angle, random.signed(), random.signed(), off]
        });
        bench.tick.apply(&output::<N>(
            wanted.map(|[angle, rate, torque, _]| [angle, rate, torque]),
            true,
        ));
        bench.sample([false; 3]);
        for (i, [_, rate, torque, off]) in wanted.into_iter().enumerate() {
            let asked = KP * (off + COMPLIANCE * torque) + KD * rate + torque;
            let most = SCALE_NM[i];
            let share = sign * asked.clamp(-most, most) / most;
            let counts = f64::from(FULL) * (0.5 + 0.4 * share);
            let found = f64::from(bench.duties()[i]);
            assert!(
                (found - counts).abs() <= 0.5 + tolerance,
                "{i}: {found} {counts}"
            );
            full += u32::from(asked.abs() > most);
        }
    }
    assert!(full > 300, "{full}");
    assert_eq!(bench.enables(), [false, true]);
}

#[test]
fn the_set_value_is_that_of_the_loop_to_the_count() {
    // 80 N m/rad and 4,480 counts per N m: 3e-7 rad of rounding are a tenth of a count.
    set_values::<f64>(false, 0.05);
    set_values::<f32>(true, 0.3);
    set_values::<Fixed>(false, 0.05);
}

/// Angles from counts, rates from tick to tick, and a new zero that moves nothing.
#[test]
fn the_tick_measures_joints_wherever_they_are() {
    for reversed in [false, true] {
        let line = LoopLine::new();
        let mut bench = Bench::<f64>::new(&line, reversed, 0.0);
        let unheard = bench.measure();
        assert!(unheard.iter().all(|reading| reading.age == u16::MAX));
        let rates = [3.0, -2.0, 0.5];
        let mut readings = unheard;
        for _ in 0..2000 {
            for _ in 0..PER_TICK {
                for (joint, rate) in bench.joints.iter_mut().zip(rates) {
                    *joint += rate * PERIOD_S;
                }
                bench.sample([false; 3]);
            }
            readings = bench.measure();
        }
        for (i, reading) in readings.iter().enumerate() {
            let count = TAU / (GEARS[i] * f64::from(COUNTS_PER_REV));
            let off = common::wrapped(reading.angle - bench.joints[i]);
            assert!(off.abs() <= 0.5001 * count, "{i}: {off:e}");
            assert!(
                (reading.rate - rates[i]).abs() <= count * TICK_RATE_HZ,
                "{i}"
            );
            assert_eq!((reading.state, reading.age), (DriveState::Off, 0));
        }
        // Homing found that the joints stand elsewhere.
        let before = bench.joints;
        bench.tick.shift::<f64>([0.25, -0.5, 3.0]);
        let shifted = bench.measure();
        for i in 0..3 {
            let off = common::wrapped(shifted[i].angle - readings[i].angle - [0.25, -0.5, 3.0][i]);
            assert!(off.abs() < 1e-8, "{off:e}");
        }
        assert_eq!(shifted[0].age, 1);
        let stand = |i: usize| [shifted[i].angle, 0.0, 0.0];
        for _ in 0..300 {
            bench
                .tick
                .apply(&output::<f64>([stand(0), stand(1), stand(2)], true));
            for _ in 0..PER_TICK {
                bench.sample([false; 3]);
            }
        }
        assert_eq!(bench.joints, before);
        // Nothing pulls: the command is where the joints stand.
        assert_eq!(bench.duties(), [CENTRE; 3]);
    }
}

#[test]
fn off_is_no_current_and_enable_low() {
    let line = LoopLine::new();
    let mut bench = Bench::<f32>::new(&line, false, 0.0);
    assert_eq!(
        (bench.enables(), bench.duties()),
        (vec![false], [CENTRE; 3])
    );
    let wanted = START.map(|angle| [angle, 0.0, 0.5]);
    let give = |bench: &mut Bench<'_, f32>, on: bool| bench.tick.apply(&output::<f32>(wanted, on));
    let pulls = |duties: [u16; 3]| duties.iter().all(|duty| *duty > CENTRE + 300);

    // The first sample after the tick, and not before it.
    bench.sample([false; 3]);
    give(&mut bench, true);
    assert_eq!(bench.duties(), [CENTRE; 3]);
    bench.sample([false; 3]);
    assert_eq!(bench.enables(), [true]);
    assert!(pulls(bench.duties()));
    assert_eq!(bench.measure()[0].state, DriveState::On);

    // A tick without motion.
    give(&mut bench, false);
    bench.sample([false; 3]);
    assert_eq!(
        (bench.enables(), bench.duties()),
        (vec![false], [CENTRE; 3])
    );
    assert_eq!(bench.measure()[0].state, DriveState::Off);

    // One amplifier fails: all let go, in the same sample, and the next tick knows which.
    give(&mut bench, true);
    bench.sample([false; 3]);
    assert_eq!(bench.enables(), [true]);
    bench.sample([false, true, false]);
    assert_eq!(
        (bench.enables(), bench.duties()),
        (vec![false], [CENTRE; 3])
    );
    let states = bench
        .measure()
        .map(|reading| (reading.state, reading.error));
    assert_eq!(states[1], (DriveState::Fault, 1));
    // It does not go on by itself within the tick when the failure ends.
    bench.sample([false; 3]);
    assert!(bench.enables().is_empty());
    assert_eq!(bench.duties(), [CENTRE; 3]);

    // A tick that hangs: within three ticks.
    give(&mut bench, true);
    let mut samples = 0;
    bench.sample([false; 3]);
    while bench.duties() != [CENTRE; 3] {
        bench.sample([false; 3]);
        samples += 1;
        assert!(samples <= 3 * PER_TICK, "{samples}");
    }
    assert_eq!(bench.enables(), [true, false]);
    assert_eq!(samples, 3 * PER_TICK);
}

/// Between ticks the reference goes on at its rate, up to a tick; then it stands.
#[test]
fn the_reference_goes_on_between_ticks() {
    let line = LoopLine::new();
    let mut bench = Bench::<f64>::new(&line, false, 0.0);
    for _ in 0..10 {
        bench.sample([false; 3]);
    }
    let rate = 0.4;
    bench
        .tick
        .apply(&output::<f64>(START.map(|angle| [angle, rate, 0.0]), true));
    for sample in 0..12 {
        bench.sample([false; 3]);
        let elapsed = f64::from(sample.min(PER_TICK)) * PERIOD_S;
        for (i, duty) in bench.duties().into_iter().enumerate() {
            let share = (KP * rate * elapsed + KD * rate) / SCALE_NM[i];
            let counts = f64::from(FULL) * (0.5 + 0.4 * share);
            assert!(
                (f64::from(duty) - counts).abs() < 0.6,
                "{sample}: {duty} {counts}"
            );
        }
    }
}
