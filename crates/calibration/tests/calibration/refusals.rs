//! Measurements that calibrate nothing, with the reason.

use crate::blind::Bench;
use trirrr_calibration::{CalibrationRefusal, CalibrationSetup, DeviceReading, ParameterGroup};

fn refusal(bench: &Bench) -> String {
    let setup = CalibrationSetup::default();
    bench.calibrate(&setup).expect_err("a refusal").to_string()
}

#[test]
fn one_pose_again_and_again_is_refused() {
    let mut bench = Bench::new(21, 30);
    let first = bench.rows[0];
    for (number, row) in (0..).zip(&mut bench.rows) {
        *row = first;
        row.line = 2 + number;
        if let DeviceReading::Place { place_m, .. } = &mut row.reading {
            place_m[0] += 1e-5 * f64::from(number % 3);
        }
    }
    let text = refusal(&bench);
    assert!(
        text.contains("would leave") && text.contains("--propose"),
        "{text}"
    );
}

#[test]
fn few_rows_are_refused() {
    let mut bench = Bench::new(22, 30);
    bench.rows.truncate(7);
    assert!(
        refusal(&bench).contains("nothing is left to check"),
        "{}",
        refusal(&bench)
    );
    let setup = CalibrationSetup {
        free: vec![ParameterGroup::Base],
        ..CalibrationSetup::default()
    };
    // Six unknowns of 21 values can be checked.
    assert!(!matches!(
        bench.calibrate(&setup),
        Err(CalibrationRefusal::TooFew { .. })
    ));
    let setup = CalibrationSetup {
        free: Vec::new(),
        ..CalibrationSetup::default()
    };
    assert_eq!(
        bench.calibrate(&setup).expect_err("nothing"),
        CalibrationRefusal::NothingFree
    );
}

#[test]
fn wrong_units_and_orders_are_named() {
    let degrees = |bench: &mut Bench| {
        for row in &mut bench.rows {
            row.angles_rad = row.angles_rad.map(f64::to_degrees);
        }
    };
    let millimetres = |bench: &mut Bench| {
        for row in &mut bench.rows {
            if let DeviceReading::Place { place_m, .. } = &mut row.reading {
                *place_m = place_m.map(|part| 1e3 * part);
            }
        }
    };
    let swapped = |bench: &mut Bench| {
        for row in &mut bench.rows {
            row.angles_rad.swap(0, 1);
        }
    };
    let no_loop = |bench: &mut Bench| bench.rows[4].angles_rad = [2.6, 0.5, -1.6];
    type Spoil<'a> = &'a dyn Fn(&mut Bench);
    let cases: [(Spoil, &str); 4] = [
        (&degrees, "th1_1_deg"),
        (&millimetres, "x_mm"),
        (&swapped, "order"),
        (&no_loop, "6: th1_1, th1_2, th1_3: the loops"),
    ];
    for (spoil, word) in cases {
        let mut bench = Bench::new(23, 30);
        spoil(&mut bench);
        let text = refusal(&bench);
        assert!(text.contains(word), "{word}: {text}");
    }
}
