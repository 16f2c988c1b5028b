//! Measurements that cannot see everything: named, held, and harmless where they are not seen.

use crate::accuracy::{errors, largest, measured, scene, start};
use crate::true_machine::{Draw, TrueMachine};
use trirrr_calibration::{
    Calibration, CalibrationRefusal, CalibrationSetup, DeviceReading, MARGIN, MeasuredRow,
    ParameterGroup, SafeRegion, calibrate,
};
use trirrr_core::machine::Parameters;

/// Poses spread over the region and its three angles: every so many of the candidates.
pub(crate) fn spread(places: &[[f64; 3]], count: usize) -> Vec<[f64; 3]> {
    let step = places.len() / count;
    let step = if step.is_multiple_of(3) {
        step - 1
    } else {
        step
    };
    places.iter().step_by(step).take(count).copied().collect()
}

pub(crate) struct Bench {
    pub(crate) nominal: Parameters,
    pub(crate) start: [f64; 3],
    pub(crate) places: Vec<[f64; 3]>,
    pub(crate) machine: TrueMachine,
    pub(crate) rows: Vec<MeasuredRow>,
}

impl Bench {
    pub(crate) fn new(seed: u64, count: usize) -> Self {
        let scene = scene("thesis.toml");
        let nominal = scene.parameters;
        let region = SafeRegion::of(&scene, 15_f64.to_radians(), MARGIN).expect("a region");
        let places = region.poses();
        let mut draw = Draw(seed);
        let machine = TrueMachine::near(&nominal, &mut draw, 0.5e-3, 5e-3);
        let rows = measured(&machine, &nominal, &spread(&places, count), &mut draw);
        Self {
            nominal,
            start: start(&scene),
            places,
            machine,
            rows,
        }
    }

    pub(crate) fn calibrate(
        &self,
        setup: &CalibrationSetup,
    ) -> Result<Calibration, CalibrationRefusal> {
        calibrate(&self.nominal, self.start, &self.rows, setup, &self.places)
    }

    /// Largest error over the workspace with the calibrated machine.
    pub(crate) fn worst(&self, found: &Calibration) -> f64 {
        let used = found.values.put_into(&self.nominal);
        largest(&errors(
            &self.machine,
            &used,
            found.values.offsets_rad(),
            &self.places,
        ))
    }
}

#[test]
fn places_without_angles_leave_the_platform_s_frame_open() {
    let mut bench = Bench::new(11, 45);
    for row in &mut bench.rows {
        if let DeviceReading::Place { angle_rad, .. } = &mut row.reading {
            *angle_rad = None;
        }
    }
    let found = bench
        .calibrate(&CalibrationSetup::default())
        .expect("a calibration");
    assert_eq!(found.blind.len(), 1, "{:?}", found.blind);
    assert!(
        found.blind[0].contains("angle of the platform's frame"),
        "{:?}",
        found.blind
    );
    assert!(found.seen() <= 20);
    let joint = found.shares[4];
    assert!(joint > 0.1 && joint < 0.999_999, "{joint}");
}

#[test]
fn a_device_with_a_frame_of_its_own_is_found_and_the_machine_stays_where_it_was() {
    let mut bench = Bench::new(12, 40);
    let device = [0.7, -1.3, 2.2];
    for row in &mut bench.rows {
        if let DeviceReading::Place {
            place_m: [x, y],
            angle_rad,
        } = &mut row.reading
        {
            let (dx, dy) = (*x - device[0], *y - device[1]);
            let (sin, cos) = f64::sin_cos(device[2]);
            (*x, *y) = (cos * dx + sin * dy, cos * dy - sin * dx);
            *angle_rad = angle_rad.map(|angle| angle - device[2]);
        }
    }
    let mut setup = CalibrationSetup::default();
    let refusal = bench.calibrate(&setup).expect_err("another frame");
    assert!(
        matches!(refusal, CalibrationRefusal::OtherFrame { .. }),
        "{refusal}"
    );
    assert!(refusal.to_string().contains("--free device"), "{refusal}");
    setup.free.push(ParameterGroup::Device);
    let found = bench.calibrate(&setup).expect("a calibration");
    assert_eq!(found.blind.len(), 3, "{:?}", found.blind);
    assert!(
        found
            .blind
            .iter()
            .all(|words| words.contains("whole machine")),
        "{:?}",
        found.blind
    );
    for (found, real) in found.values.device().iter().zip(device) {
        assert!((found - real).abs() < 5e-3, "{found} {real}");
    }
    // The frame of the machine is free; what the machine does in it is not.
    let [before, after] = found.check_sizes().expect("rows that were kept out");
    let (before, after) = (
        before.place_m.expect("places"),
        after.place_m.expect("places"),
    );
    assert!(before > 4.0 * after && after < 60e-6, "{before} {after}");
}

#[test]
fn distances_from_one_point_do_not_see_a_turn_about_it() {
    let mut bench = Bench::new(13, 90);
    let centre_m = [0.25, 0.2];
    for row in &mut bench.rows {
        let DeviceReading::Place {
            place_m: [x, y],
            angle_rad,
        } = row.reading
        else {
            panic!("no place");
        };
        let near = [x, y, angle_rad.expect("an angle")];
        let real = bench.machine.pose(row.angles_rad, near).expect("a pose");
        row.reading = DeviceReading::Distance {
            distance_m: (real[0] - centre_m[0]).hypot(real[1] - centre_m[1]),
            centre_m,
        };
    }
    match bench.calibrate(&CalibrationSetup::default()) {
        Ok(found) => {
            let turn = found
                .blind
                .iter()
                .find(|words| words.contains("about the fixed point"));
            assert!(turn.is_some(), "{:?}", found.blind);
        }
        Err(refusal) => assert!(
            refusal.to_string().contains("about the fixed point"),
            "{refusal}"
        ),
    }
}

#[test]
fn a_platform_that_was_never_turned_is_told() {
    let mut bench = Bench::new(16, 30);
    let alpha = bench.start[2];
    let level: Vec<[f64; 3]> = bench
        .places
        .iter()
        .copied()
        .filter(|pose| pose[2] == alpha)
        .collect();
    let poses: Vec<[f64; 3]> = level.iter().step_by(level.len() / 30).copied().collect();
    bench.rows = measured(&bench.machine, &bench.nominal, &poses, &mut Draw(3));
    // Nearly one angle: errors of the machine turn the platform a little.
    let said = match bench.calibrate(&CalibrationSetup::default()) {
        Ok(found) => [found.blind, found.weak].concat().join("; "),
        Err(refusal) => refusal.to_string(),
    };
    assert!(said.contains("one angle only"), "{said}");
}

#[test]
fn held_groups_stay_as_they_are() {
    let bench = Bench::new(14, 30);
    let mut setup = CalibrationSetup::default();
    setup.free.retain(|group| *group != ParameterGroup::Offset);
    setup.expected_m = 3e-3;
    let found = bench.calibrate(&setup).expect("a calibration");
    assert_eq!(found.values.offsets_rad(), [0.0; 3]);
    // Offsets are in the machine, so the noise is not all that is left.
    assert!(found.noise_factor > 1.5, "{}", found.noise_factor);
}

#[test]
fn an_outlier_is_named_and_left_out() {
    let mut bench = Bench::new(15, 40);
    if let DeviceReading::Place { place_m, .. } = &mut bench.rows[17].reading {
        place_m[1] += 1e-3;
    }
    let line = bench.rows[17].line;
    let found = bench
        .calibrate(&CalibrationSetup::default())
        .expect("a calibration");
    let outliers: Vec<u32> = found
        .rows
        .iter()
        .filter(|row| row.is_outlier)
        .map(|row| row.row.line)
        .collect();
    assert_eq!(outliers, [line]);
    let named = found
        .rows
        .iter()
        .find(|row| row.row.line == line)
        .expect("the row");
    assert!((40.0..60.0).contains(&named.sigmas), "{}", named.sigmas);
    assert!(bench.worst(&found) < 60e-6);
    let setup = CalibrationSetup {
        keeps_outliers: true,
        ..CalibrationSetup::default()
    };
    let kept = bench.calibrate(&setup).expect("a calibration");
    assert!(kept.rows.iter().all(|row| !row.is_outlier));
    assert!(kept.noise_factor > 2.0, "{}", kept.noise_factor);
}
