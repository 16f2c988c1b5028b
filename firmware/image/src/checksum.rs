//! Checksum over results: equal if all results have the same bits.

use trirrr_core::number::Number;
use trirrr_core::status::Status;
use trirrr_core::tick::Motor;

/// FNV-1a, 64 bits, over the values as binary64, which is exact for every number type.
///
/// Compares results of two machines. No protection against forged results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checksum(u64);

impl Default for Checksum {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Checksum {
    /// Adds the twelve results of a motion.
    pub fn add<N: Number>(&mut self, motors: &[Motor<N>; 3]) {
        for motor in motors {
            self.word(N::angle_to_f64(motor.angle).to_bits());
            for value in [motor.rate, motor.acceleration, motor.torque] {
                self.word(value.to_f64().to_bits());
            }
        }
    }

    /// Adds the status of a setpoint without a motion.
    pub fn add_status(&mut self, status: Status) {
        self.word(match status {
            Status::Unreachable { leg } => 0x10 + leg as u64,
            Status::SerialSingular { leg } => 0x20 + leg as u64,
            Status::ParallelSingular => 0x30,
            Status::OutOfRange => 0x40,
        });
    }

    /// Checksum of everything added so far.
    pub fn value(self) -> u64 {
        self.0
    }

    fn word(&mut self, word: u64) {
        self.bytes(&word.to_le_bytes());
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_test_vectors_of_fnv_1a() {
        for (text, expected) in [
            ("", 0xcbf2_9ce4_8422_2325),
            ("a", 0xaf63_dc4c_8601_ec8c),
            ("foobar", 0x8594_4171_f739_67e8),
        ] {
            let mut checksum = Checksum::default();
            checksum.bytes(text.as_bytes());
            assert_eq!(checksum.value(), expected, "{text:?}");
        }
    }

    #[test]
    fn one_bit_in_one_result_shows() {
        let motor = Motor {
            angle: 1.0_f32,
            rate: 2.0,
            acceleration: 3.0,
            torque: 4.0,
        };
        let sum = |motors: [Motor<f32>; 3]| {
            let mut checksum = Checksum::default();
            checksum.add(&motors);
            checksum.value()
        };
        let reference = sum([motor; 3]);
        for leg in 0..3 {
            let mut motors = [motor; 3];
            motors[leg].torque = motors[leg].torque.next_up();
            assert_ne!(sum(motors), reference);
            motors = [motor; 3];
            motors[leg].angle = motors[leg].angle.next_down();
            assert_ne!(sum(motors), reference);
        }
        // The sign of zero is a bit too.
        let still = |rate| {
            let mut motors = [motor; 3];
            motors[1].rate = rate;
            sum(motors)
        };
        assert_ne!(still(0.0), still(-0.0));
    }

    #[test]
    fn a_status_counts_and_its_leg_too() {
        let sum = |status| {
            let mut checksum = Checksum::default();
            checksum.add_status(status);
            checksum.value()
        };
        assert_ne!(
            sum(Status::Unreachable { leg: 0 }),
            sum(Status::Unreachable { leg: 1 })
        );
        assert_ne!(sum(Status::ParallelSingular), sum(Status::OutOfRange));
    }
}
