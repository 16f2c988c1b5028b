//! Values: states, moves, loads, and the forms that a table can have.

use super::{END, MACHINE, MACHINE_HEADER, MOVE, MOVE_HEADER, START, STATE, STATE_HEADER};
use super::{assert_near, table, torques};
use trirrr_scene::NumberType;

#[test]
fn states_and_moves_give_true_torques_in_both_number_types() {
    let state = format!("{MACHINE_HEADER},{STATE_HEADER}\n{MACHINE},{STATE}\n");
    let moves = format!("{MACHINE_HEADER},{MOVE_HEADER}\n{MACHINE},{MOVE},0\n{MACHINE},{MOVE},1\n");
    for (scalar, tolerance) in [(NumberType::F64, 1e-9), (NumberType::F32, 1e-7)] {
        let (_, rows) = table(scalar, state.as_bytes());
        assert_eq!(rows[0][0], "1", "the row's number where there is no case");
        assert_near(torques(&rows[0]), START, tolerance);
        let (_, rows) = table(scalar, moves.as_bytes());
        assert_near(torques(&rows[0]), START, tolerance);
        assert_near(torques(&rows[1]), END, tolerance);
    }
    // A binary32 number is printed with the digits that tell it from other binary32 numbers.
    for scalar in [NumberType::F32, NumberType::Micromath] {
        let (_, rows) = table(scalar, state.as_bytes());
        for field in &rows[0][2..] {
            let value: f32 = field.parse().unwrap();
            let shortest: f32 = format!("{value:e}").parse().unwrap();
            let digits = |text: &str| text.bytes().filter(u8::is_ascii_digit).count();
            assert_eq!(shortest, value);
            assert!(
                digits(field) <= digits(&format!("{value:?}")) + 1,
                "{field}"
            );
        }
    }
}

#[test]
fn a_move_between_ticks_is_the_cubic() {
    // s = 1/4: blend 5/32, rate 9/8, acceleration 3.
    let moves = format!("{MACHINE_HEADER},{MOVE_HEADER}\n{MACHINE},{MOVE_AT_QUARTER}\n");
    let (hx, hy, ha) = (0.07, 0.06, 0.20943951023931953 - 0.15707963267948966);
    let values = [
        0.21 + hx * 5.0 / 32.0,
        0.22 + hy * 5.0 / 32.0,
        0.15707963267948966 + ha * 5.0 / 32.0,
        hx * 9.0 / 8.0 / 2.0,
        hy * 9.0 / 8.0 / 2.0,
        ha * 9.0 / 8.0 / 2.0,
        hx * 3.0 / 4.0,
        hy * 3.0 / 4.0,
        ha * 3.0 / 4.0,
    ];
    let values = values.map(|value: f64| value.to_string()).join(",");
    let state = format!("{MACHINE_HEADER},{STATE_HEADER}\n{MACHINE},{values}\n");
    let (_, by_move) = table(NumberType::F64, moves.as_bytes());
    let (_, by_state) = table(NumberType::F64, state.as_bytes());
    for (one, other) in by_move[0][2..].iter().zip(&by_state[0][2..]) {
        let (one, other): (f64, f64) = (one.parse().unwrap(), other.parse().unwrap());
        assert!((one - other).abs() < 1e-13, "{one} {other}");
    }
}

const MOVE_AT_QUARTER: &str = "0.21,0.28,0.22,0.28,0.15707963267948966,0.20943951023931953,2,0.5";

#[test]
fn loads_count_and_missing_ones_are_zero() {
    let loads = "ml,gx,gy,Wx,Wy,Wa";
    let rows = [
        "0,0,0,0,0,0",
        "0.05,0,0,0,0,0",
        "0.05,0,-9.81,1.5,-2.0,0.03",
    ];
    let rows: String = rows
        .iter()
        .map(|row| format!("{MACHINE},{row},{STATE}\n"))
        .collect();
    let cases = format!("{MACHINE_HEADER},{loads},{STATE_HEADER}\n{rows}");
    let (_, rows) = table(NumberType::F64, cases.as_bytes());
    assert_near(torques(&rows[0]), START, 1e-9);
    // Of tests/reference/true_links.csv and true_links_gravity.csv at t = 0.
    let with_links = [
        0.018_005_998_837_265_4,
        0.020_260_497_407_535_6,
        -0.037_917_434_262_834_6,
    ];
    let loaded = [
        1.355_742_136_511_471_2,
        -0.691_326_078_302_884,
        -0.591_915_302_307_381_3,
    ];
    assert_near(torques(&rows[1]), with_links, 1e-12);
    assert_near(torques(&rows[2]), loaded, 1e-12);
}

#[test]
fn any_order_unknown_columns_quotes_crlf_and_byte_order_mark() {
    let header: Vec<&str> = MACHINE_HEADER
        .split(',')
        .chain(STATE_HEADER.split(','))
        .collect();
    let values: Vec<&str> = MACHINE.split(',').chain(STATE.split(',')).collect();
    let mut columns: Vec<(&str, String)> = header
        .into_iter()
        .zip(values.into_iter().map(|v| format!("\" {v}\"")))
        .collect();
    columns.push(("case", "\"the \"\"first\"\", quoted\"".into()));
    columns.push(("note", "not a number".into()));
    columns.reverse();
    let (names, fields): (Vec<&str>, Vec<String>) = columns.into_iter().unzip();
    let cases = format!(
        "\u{feff}\"{}\"\r\n{}\r\n\r\n",
        names.join("\",\""),
        fields.join(",")
    );
    let (_, rows) = table(NumberType::F64, cases.as_bytes());
    assert_eq!(rows.len(), 1);
    assert_eq!(rows[0][..2], ["the \"first\", quoted", "ok"]);
    assert_near(torques(&rows[0]), START, 1e-9);
}
