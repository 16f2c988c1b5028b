//! Layout of telemetry: a header, then records of one length, least significant byte first, in SI units.

use trirrr_client::describe::Units;
use trirrr_protocol::message::{Acting, State, Telemetry, Transmit};

/// Version of the layout.
pub const VERSION: u32 = 1;

/// Bytes of the header.
pub const HEADER_BYTES: usize = 24;

/// Bytes of a record.
pub const RECORD_BYTES: usize = 216;

/// A record of one sample.
pub(crate) type RecordBytes = [u8; RECORD_BYTES];

/// Header of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BatchHeader {
    /// Session of the program that has taken the samples. Numbers count within it.
    pub session: u64,
    /// Ticks from one sample to the next.
    pub every: u32,
    /// Records in the batch.
    pub count: u32,
}

/// Parts of a record that account for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordPlace {
    /// Number of the sample in the session, from 0, without a gap.
    pub number: u64,
    /// Tick of the machine, modulo 2^32.
    pub tick: u32,
    /// Samples that the machine has dropped so far, modulo 2^32.
    pub lost: u32,
}

/// Returns `records` behind their header.
pub(crate) fn batch<'a>(
    header: BatchHeader,
    records: impl Iterator<Item = &'a RecordBytes>,
) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER_BYTES + header.count as usize * RECORD_BYTES);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((RECORD_BYTES as u32).to_le_bytes());
    bytes.extend(header.session.to_le_bytes());
    bytes.extend(header.every.to_le_bytes());
    bytes.extend(header.count.to_le_bytes());
    records.for_each(|record| bytes.extend_from_slice(record));
    bytes
}

/// Reads a batch. `None` where it is none of this version.
pub fn read(bytes: &[u8]) -> Option<(BatchHeader, Vec<RecordPlace>)> {
    let header = bytes.get(..HEADER_BYTES)?;
    let word = |at: usize| Some(u32::from_le_bytes(header.get(at..at + 4)?.try_into().ok()?));
    if word(0)? != VERSION || word(4)? != RECORD_BYTES as u32 {
        return None;
    }
    let session = u64::from_le_bytes(header.get(8..16)?.try_into().ok()?);
    let (every, count) = (word(16)?, word(20)?);
    let (records, rest) = bytes.get(HEADER_BYTES..)?.as_chunks::<RECORD_BYTES>();
    if !rest.is_empty() || records.len() != count as usize {
        return None;
    }
    let places = records.iter().map(|record| {
        let word = |at: usize| Some(u32::from_le_bytes(record.get(at..at + 4)?.try_into().ok()?));
        Some(RecordPlace {
            number: u64::from_le_bytes(record.get(..8)?.try_into().ok()?),
            tick: word(8)?,
            lost: word(28)?,
        })
    });
    let header = BatchHeader {
        session,
        every,
        count,
    };
    Some((header, places.collect::<Option<_>>()?))
}

/// Returns the record of `sample`, the one of `number` in its session. `units` are those of the machine.
pub(crate) fn record<N: Transmit>(
    number: u64,
    sample: &Telemetry<N>,
    units: &Units,
) -> RecordBytes {
    let mut record = [0; RECORD_BYTES];
    let mut writer = RecordWriter {
        record: &mut record,
        at: 0,
    };
    writer.put(&number.to_le_bytes());
    writer.put(&sample.tick.to_le_bytes());
    writer.put(&[sample.state as u8, acting(sample.acting)]);
    writer.put(&sample.fields.0.to_le_bytes());
    writer.put(&sample.number.to_le_bytes());
    writer.put(&sample.at.to_le_bytes());
    writer.put(&sample.part.to_le_bytes());
    writer.put(&sample.lost.to_le_bytes());
    let rate = 1.0 / units.time_s;
    let speed = units.length_m * rate;
    let torque = units.mass_kg * speed * speed;
    let setpoint = &sample.setpoint;
    let position = setpoint.pose.position;
    writer.float(position.x.to_f64() * units.length_m);
    writer.float(position.y.to_f64() * units.length_m);
    writer.float(N::angle_to_f64(setpoint.pose.angle));
    for (vector, linear, angular) in [
        (&setpoint.velocity, speed, rate),
        (&setpoint.acceleration, speed * rate, rate * rate),
    ] {
        writer.float(vector.x.to_f64() * linear);
        writer.float(vector.y.to_f64() * linear);
        writer.float(vector.z.to_f64() * angular);
    }
    sample
        .angles
        .into_iter()
        .for_each(|angle| writer.float(N::angle_to_f64(angle)));
    for (values, unit) in [
        (&sample.rates, rate),
        (&sample.accelerations, rate * rate),
        (&sample.torques, torque),
    ] {
        values
            .iter()
            .for_each(|value| writer.float(value.to_f64() * unit));
    }
    writer.float(sample.tool.to_f64());
    writer.put(&sample.duration.to_le_bytes());
    record
}

/// Returns angles (rad), rates (rad/s) and torques (N m) of a record.
pub(crate) fn joints(record: &RecordBytes) -> [[f64; 3]; 3] {
    [104, 128, 176].map(|start| {
        [0, 1, 2].map(|motor| {
            let mut bytes = [0; 8];
            let at = start + 8 * motor;
            bytes.copy_from_slice(&record[at..at + 8]);
            f64::from_le_bytes(bytes)
        })
    })
}

/// Writes a record from its first byte on.
struct RecordWriter<'a> {
    record: &'a mut RecordBytes,
    at: usize,
}

impl RecordWriter<'_> {
    fn put(&mut self, bytes: &[u8]) {
        let end = self.at + bytes.len();
        self.record[self.at..end].copy_from_slice(bytes);
        self.at = end;
    }

    fn float(&mut self, value: f64) {
        self.put(&value.to_le_bytes());
    }
}

/// Number of a cause, as on the line.
fn acting(acting: Acting) -> u8 {
    match acting {
        Acting::Nothing => 0,
        Acting::Hold => 1,
        Acting::Resume => 2,
        Acting::Stop => 3,
        Acting::Silence => 4,
        Acting::QueueDry => 5,
        Acting::Limit(_) => 6,
        Acting::Door => 7,
        Acting::Probe => 8,
    }
}

/// Returns true if a machine in `state` may move: it is not at rest for good.
pub(crate) fn may_move(state: State) -> bool {
    !state.is_at_rest()
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_core::setpoint::{Pose, Setpoint};
    use trirrr_protocol::message::TelemetryFields;

    /// Sample whose values tell their places.
    fn sample(tick: u32) -> Telemetry<f64> {
        Telemetry {
            tick,
            state: State::Holding,
            acting: Acting::Silence,
            number: 7,
            at: 8,
            part: 9,
            lost: 10,
            fields: TelemetryFields::ALL,
            setpoint: Setpoint {
                pose: Pose::from_f64(1.0, 2.0, 3.0),
                velocity: [4.0, 5.0, 6.0].into(),
                acceleration: [7.0, 8.0, 9.0].into(),
            },
            angles: [10.0, 11.0, 12.0],
            rates: [13.0, 14.0, 15.0],
            accelerations: [16.0, 17.0, 18.0],
            torques: [19.0, 20.0, 21.0],
            tool: 22.0,
            duration: 23,
        }
    }

    #[test]
    fn a_record_has_the_layout_of_the_manual() {
        let units = Units {
            length_m: 2.0,
            time_s: 0.5,
            mass_kg: 3.0,
            tick_rate_hz: 100.0,
        };
        let record = record(u64::MAX, &sample(0x0102_0304), &units);
        assert_eq!(record[..8], [0xff; 8]);
        assert_eq!(record[8..12], [4, 3, 2, 1]);
        assert_eq!(record[12..16], [State::Holding as u8, 4, 127, 0]);
        let word = |at: usize| u32::from_le_bytes(record[at..at + 4].try_into().unwrap());
        assert_eq!([16, 20, 24, 28].map(word), [7, 8, 9, 10]);
        let float = |index: usize| {
            let at = 32 + 8 * index;
            f64::from_le_bytes(record[at..at + 8].try_into().unwrap())
        };
        let found: Vec<f64> = (0..22).map(float).collect();
        // A speed is 2 m / 0.5 s, an acceleration 2 m / 0.25 s^2, a torque 3 kg 4 m^2 / 0.25 s^2.
        let expected = [
            2.0, 4.0, 3.0, 16.0, 20.0, 12.0, 56.0, 64.0, 36.0, 10.0, 11.0, 12.0, 26.0, 28.0, 30.0,
            64.0, 68.0, 72.0, 912.0, 960.0, 1008.0, 22.0,
        ];
        assert_eq!(found, expected);
        let joints = [
            [10.0, 11.0, 12.0],
            [26.0, 28.0, 30.0],
            [912.0, 960.0, 1008.0],
        ];
        assert_eq!(super::joints(&record), joints);
        assert_eq!(word(208), 23);
    }

    #[test]
    fn a_batch_is_read_back_and_a_damaged_one_is_none() {
        let units = Units::si(100.0);
        let records = [5, 6].map(|number| record(number, &sample(100 + number as u32), &units));
        let header = BatchHeader {
            session: 0x0123_4567_89ab_cdef,
            every: 1,
            count: 2,
        };
        let bytes = batch(header, records.iter());
        let place = |number, tick| RecordPlace {
            number,
            tick,
            lost: 10,
        };
        assert_eq!(
            read(&bytes),
            Some((header, vec![place(5, 105), place(6, 106)]))
        );
        assert_eq!(read(&bytes[..bytes.len() - 1]), None);
        assert_eq!(read(&bytes[..20]), None);
        let mut other = bytes;
        other[0] += 1;
        assert_eq!(read(&other), None);
    }
}
