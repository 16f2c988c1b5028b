//! Joints of a machine as `sensor_msgs/msg/JointState` of ROS 2, in CDR as DDS has it.

use std::time::Duration;

/// Names of the joints, in the order of the motors.
const NAMES: [&str; 3] = ["motor_1", "motor_2", "motor_3"];

/// CDR, least significant byte first.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Returns the message of the time `stamp` since 1970: angles (rad), rates (rad/s) and torques (N m).
pub(crate) fn joint_state(stamp: Duration, joints: &[[f64; 3]; 3]) -> Vec<u8> {
    let mut cdr = CdrWriter(ENCAPSULATION.into());
    // The type of ROS ends in 2038.
    cdr.word(stamp.as_secs() as u32);
    cdr.word(stamp.subsec_nanos());
    cdr.text("");
    cdr.word(NAMES.len() as u32);
    NAMES.iter().for_each(|name| cdr.text(name));
    for values in joints {
        cdr.word(values.len() as u32);
        values.iter().for_each(|value| cdr.float(*value));
    }
    cdr.0
}

/// Writes values at multiples of their sizes, counted from behind the encapsulation.
struct CdrWriter(Vec<u8>);

impl CdrWriter {
    fn align(&mut self, size: usize) {
        let length = self.0.len() - ENCAPSULATION.len();
        let aligned = length.next_multiple_of(size);
        self.0.resize(aligned + ENCAPSULATION.len(), 0);
    }

    fn word(&mut self, value: u32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    fn float(&mut self, value: f64) {
        self.align(8);
        self.0.extend(value.to_le_bytes());
    }

    /// A text with its zero, and the length of both before it.
    fn text(&mut self, text: &str) {
        self.word(text.len() as u32 + 1);
        self.0.extend(text.bytes());
        self.0.push(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_laid_out_as_cdr_asks() {
        let joints = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]];
        let bytes = joint_state(Duration::new(5, 6), &joints);
        assert_eq!(bytes[..4], [0, 1, 0, 0]);
        let body = &bytes[4..];
        assert_eq!(body[..8], [5, 0, 0, 0, 6, 0, 0, 0]);
        // An empty frame: one byte, the zero; then three bytes up to the next word.
        assert_eq!(body[8..16], [1, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(body[16..24], [3, 0, 0, 0, 8, 0, 0, 0]);
        assert_eq!(&body[24..32], b"motor_1\0");
        // Three texts of 12 bytes end at 56; a length, then numbers at a multiple of 8.
        assert_eq!(body[56..60], [3, 0, 0, 0]);
        let float = |at: usize| f64::from_le_bytes(body[at..at + 8].try_into().unwrap());
        assert_eq!([64, 72, 80].map(float), joints[0]);
        assert_eq!([96, 104, 112].map(float), joints[1]);
        assert_eq!([128, 136, 144].map(float), joints[2]);
        assert_eq!(body.len(), 152);
    }
}
