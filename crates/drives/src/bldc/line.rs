//! From the tick to the loops, and back.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering, fence};

/// References of the joints from the tick, and what the loops measure. The loops preempt the tick, or run on another core, and neither
/// waits.
///
/// Each way has two places. The writer takes the one that is not read, and then turns the round: nobody sees half a reference, or half a
/// measurement.
#[derive(Debug)]
pub struct LoopLine {
    places: [ReferencePlace; 2],
    /// Counts the ticks that gave references. Its last bit is the place to be read.
    round: AtomicU32,
    on: AtomicBool,
    measured: [MeasuredPlace; 2],
    /// Counts the samples that were measured. Its last bit is the place to be read.
    sample: AtomicU32,
}

/// References of three joints: angles in 2^-32 of a turn from count 0, the rest as the bits of binary32.
#[derive(Debug)]
struct ReferencePlace([[AtomicU32; 3]; 4]);

/// Measurements of a sample, torques as the bits of binary32.
#[derive(Debug)]
struct MeasuredPlace {
    turns: [AtomicU32; 3],
    torques: [AtomicU32; 3],
    failed: [AtomicBool; 3],
}

/// Reference of a joint, its angle counted from count 0 of its encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Counted {
    /// 2^-32 of a turn.
    pub(super) turn: u32,
    /// rad/s, rad/s^2, N m.
    pub(super) rate: f32,
    pub(super) acceleration: f32,
    pub(super) torque: f32,
}

/// Measurements of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measurements {
    /// Angles of the joints from count 0, in 2^-32 of a turn.
    pub(super) turns: [u32; 3],
    /// Torques that the amplifiers are told, N m.
    pub(super) torques: [f32; 3],
    /// The amplifier reports a failure.
    pub(super) failed: [bool; 3],
}

impl Default for LoopLine {
    fn default() -> Self {
        Self::new()
    }
}

impl LoopLine {
    /// Off, with nothing measured.
    pub const fn new() -> Self {
        Self {
            places: [const { ReferencePlace([const { [const { AtomicU32::new(0) }; 3] }; 4]) }; 2],
            round: AtomicU32::new(0),
            on: AtomicBool::new(false),
            measured: [const {
                MeasuredPlace {
                    turns: [const { AtomicU32::new(0) }; 3],
                    torques: [const { AtomicU32::new(0) }; 3],
                    failed: [const { AtomicBool::new(false) }; 3],
                }
            }; 2],
            sample: AtomicU32::new(0),
        }
    }

    /// Starts the next round: these references, loops on.
    #[inline(always)]
    pub(super) fn give(&self, references: &[Counted; 3]) {
        let next = self.round.load(Ordering::Relaxed).wrapping_add(1);
        let [even, odd] = &self.places;
        let ReferencePlace([turns, rates, accelerations, torques]) =
            if next & 1 == 0 { even } else { odd };
        put(turns, references.each_ref().map(|each| each.turn));
        put(rates, references.each_ref().map(|each| each.rate.to_bits()));
        put(
            accelerations,
            references
                .each_ref()
                .map(|each| each.acceleration.to_bits()),
        );
        put(
            torques,
            references.each_ref().map(|each| each.torque.to_bits()),
        );
        self.round.store(next, Ordering::Release);
        self.on.store(true, Ordering::Release);
    }

    /// Switches the loops off: no current from the next sample on.
    #[inline(always)]
    pub(super) fn off(&self) {
        self.on.store(false, Ordering::Release);
    }

    #[inline(always)]
    pub(super) fn is_on(&self) -> bool {
        self.on.load(Ordering::Acquire)
    }

    #[inline(always)]
    pub(super) fn round(&self) -> u32 {
        self.round.load(Ordering::Acquire)
    }

    /// References of the round.
    #[inline(always)]
    pub(super) fn references(&self, round: u32) -> [Counted; 3] {
        let [even, odd] = &self.places;
        let ReferencePlace([turns, rates, accelerations, torques]) =
            if round & 1 == 0 { even } else { odd };
        let (turns, rates) = (get(turns), get(rates));
        let (accelerations, torques) = (get(accelerations), get(torques));
        let of = |[turn, rate, acceleration, torque]: [u32; 4]| Counted {
            turn,
            rate: f32::from_bits(rate),
            acceleration: f32::from_bits(acceleration),
            torque: f32::from_bits(torque),
        };
        let ([t1, t2, t3], [r1, r2, r3]) = (turns, rates);
        let ([a1, a2, a3], [q1, q2, q3]) = (accelerations, torques);
        [
            of([t1, r1, a1, q1]),
            of([t2, r2, a2, q2]),
            of([t3, r3, a3, q3]),
        ]
    }

    /// Gives the tick what was measured.
    #[inline(always)]
    pub(super) fn publish(&self, measured: &Measurements) {
        let next = self.sample.load(Ordering::Relaxed).wrapping_add(1);
        let place = self.place(next);
        // Whoever sees a word of this sample sees the count of the one before it.
        fence(Ordering::Release);
        put(&place.turns, measured.turns);
        put(&place.torques, measured.torques.map(f32::to_bits));
        for (place, failed) in place.failed.iter().zip(measured.failed) {
            place.store(failed, Ordering::Relaxed);
        }
        self.sample.store(next, Ordering::Release);
    }

    /// Number of the last sample, and what was measured in it. A sample that comes while the tick reads makes it read
    /// once more, for which there is time before the next.
    #[inline(always)]
    pub(super) fn measured(&self) -> (u32, Measurements) {
        let before = self.sample.load(Ordering::Acquire);
        let measured = self.read(before);
        let after = self.sample.load(Ordering::Acquire);
        match before == after {
            true => (before, measured),
            false => (after, self.read(after)),
        }
    }

    #[inline(always)]
    fn place(&self, sample: u32) -> &MeasuredPlace {
        let [even, odd] = &self.measured;
        if sample & 1 == 0 { even } else { odd }
    }

    #[inline(always)]
    fn read(&self, sample: u32) -> Measurements {
        let place = self.place(sample);
        Measurements {
            turns: get(&place.turns),
            torques: get(&place.torques).map(f32::from_bits),
            failed: place
                .failed
                .each_ref()
                .map(|each| each.load(Ordering::Acquire)),
        }
    }
}

#[inline(always)]
fn put(places: &[AtomicU32; 3], values: [u32; 3]) {
    for (place, value) in places.iter().zip(values) {
        place.store(value, Ordering::Relaxed);
    }
}

#[inline(always)]
fn get(places: &[AtomicU32; 3]) -> [u32; 3] {
    places.each_ref().map(|place| place.load(Ordering::Acquire))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    const SAMPLES: u32 = if cfg!(miri) { 200 } else { 20_000 };

    /// One thread measures and takes references, the other gives references and takes measurements: each sees those of one moment, and
    /// none older than before. Neither is overtaken: there is one sample at most while the other side reads, and one round.
    #[test]
    fn each_side_sees_the_words_of_one_moment() {
        let (line, seen, taken) = (LoopLine::new(), AtomicU32::new(0), AtomicU32::new(0));
        let measurements = |sample: u32| Measurements {
            turns: [sample; 3],
            torques: [sample as f32; 3],
            failed: [sample % 2 == 1; 3],
        };
        let reference = |round: u32| Counted {
            turn: round,
            rate: round as f32,
            acceleration: -(round as f32),
            torque: 2.0 * round as f32,
        };
        thread::scope(|scope| {
            scope.spawn(|| {
                for sample in 1..=SAMPLES {
                    while seen.load(Ordering::Acquire) + 1 < sample {
                        thread::yield_now();
                    }
                    line.publish(&measurements(sample));
                    let round = line.round();
                    assert_eq!(line.references(round), [reference(round); 3]);
                    assert!(round >= taken.load(Ordering::Relaxed));
                    taken.store(round, Ordering::Release);
                }
            });
            let (mut before, mut round) = (0, 0);
            while before < SAMPLES {
                let (sample, measured) = line.measured();
                assert!(measured == measurements(sample) && sample >= before);
                before = sample;
                seen.store(sample, Ordering::Release);
                if taken.load(Ordering::Acquire) == round {
                    round += 1;
                    line.give(&[reference(round); 3]);
                }
                thread::yield_now();
            }
        });
    }
}
