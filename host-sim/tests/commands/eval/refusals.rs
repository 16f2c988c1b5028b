//! Every way a table or a row can be wrong.

use super::{MACHINE, MACHINE_HEADER, MOVE, MOVE_HEADER, STATE, STATE_HEADER, table};
use trirrr_host_sim::eval::{RowCounts, evaluate};
use trirrr_scene::NumberType;

fn refusal(cases: &[u8]) -> String {
    let failure = evaluate(NumberType::F64, "cases.csv", cases, &mut Vec::new()).unwrap_err();
    assert_eq!(failure.exit_code(), 2, "{failure}");
    failure.to_string()
}

#[test]
fn a_bad_row_says_what_is_wrong_and_the_others_go_on() {
    let good = format!("{MACHINE},{STATE}");
    // Fields are replaced by their place in the row.
    let with = |place: usize, value: &str| {
        let mut fields: Vec<&str> = good.split(',').collect();
        fields[place] = value;
        fields.join(",")
    };
    let cases = [
        (
            with(2, "-0.2"),
            "invalid: z1_1 = -0.2: must be greater than 0",
        ),
        (with(10, "0"), "invalid: z2_2 = 0: must be greater than 0"),
        (
            with(4, "-0.02"),
            "invalid: h_1 = -0.02: must not be negative",
        ),
        (with(6, "2"), "invalid: sg_1 = 2: must be 1 or -1"),
        (with(21, "-1"), "invalid: m = -1: must not be negative"),
        (with(22, "nan"), "invalid: I = nan: is not finite"),
        (with(0, "inf"), "invalid: ax_1 = inf: is not finite"),
        (with(23, "1e999"), "invalid: x = 1e999: is not finite"),
        (with(23, "left"), "invalid: x = left: is not a number"),
        (with(24, ""), "invalid: y is empty"),
        (with(23, "0.9"), "unreachable: leg 1"),
        (
            format!("{good},7"),
            "invalid: 33 fields where the header has 32 (write decimal points)",
        ),
        (MACHINE.into(), "invalid: 23 fields where the header has 32"),
        (good.clone(), "ok"),
    ];
    let lines: Vec<String> = cases.iter().map(|(line, _)| line.clone()).collect();
    let table_text = format!("{MACHINE_HEADER},{STATE_HEADER}\n{}\n", lines.join("\n"));
    let (count, rows) = table(NumberType::F64, table_text.as_bytes());
    assert_eq!(
        count,
        RowCounts {
            rows: cases.len(),
            ok: 1,
            is_cut: false
        }
    );
    for (row, (_, status)) in rows.iter().zip(&cases) {
        assert_eq!(row[1], *status);
    }
}

#[test]
fn what_f32_cannot_hold_is_said_to_be_so() {
    let good = format!("{MACHINE},{STATE}");
    let far = good.replacen("0,0.433", "1e60,0.433", 1);
    let short = good.replacen("0.2,0.2", "0.2,1e-60", 1);
    let cases = format!("{MACHINE_HEADER},{STATE_HEADER}\n{far}\n{short}\n");
    let (_, rows) = table(NumberType::F32, cases.as_bytes());
    assert_eq!(
        rows[0][1],
        "invalid: ax_1 = 1e60: is beyond the range of f32"
    );
    assert_eq!(
        rows[1][1],
        "invalid: z2_1 = 1e-60: is too small for f32, it would count as 0"
    );
}

#[test]
fn a_time_outside_its_move_is_invalid() {
    let rows = ["-0.1", "1.1", "1"]
        .map(|t| format!("{MACHINE},{MOVE},{t}"))
        .join("\n");
    let endless = format!(
        "{MACHINE},{},0",
        MOVE.strip_suffix('1').unwrap().to_owned() + "0"
    );
    let cases = format!("{MACHINE_HEADER},{MOVE_HEADER}\n{rows}\n{endless}\n");
    let (_, rows) = table(NumberType::F64, cases.as_bytes());
    let statuses: Vec<&str> = rows.iter().map(|row| row[1].as_str()).collect();
    assert_eq!(
        statuses,
        [
            "invalid: t = -0.1: must not be negative",
            "invalid: t = 1.1: must not be greater than T",
            "ok",
            "invalid: T = 0: must be greater than 0",
        ]
    );
}

#[test]
fn the_singularities_are_statuses() {
    // With D at the origin, alpha = 0 and both links 1 m, a leg of the platform joint (0.5, 0)
    // and the base joint (2.5, 0) is exactly stretched. The first leg is the one reported.
    let leg = |x: &str, y: &str, lam: &str| format!("{x},{y},1,1,0.5,{lam},1");
    let stretched = [
        leg("2.5", "0", "0"),
        leg("-10", "0", "0"),
        leg("-10", "0", "0"),
        "1,1,0,0,0,0,0,0,0,0,0".into(),
    ]
    .join(",");
    // The same leg three times: the distal links share one line.
    let parallel = [
        leg("1", "0", "0"),
        leg("1", "0", "0"),
        leg("1", "0", "0"),
        "1,1,0,0,0,0,0,0,0,0,0".into(),
    ]
    .join(",");
    let cases = format!("{MACHINE_HEADER},{STATE_HEADER}\n{stretched}\n{parallel}\n");
    for scalar in [NumberType::F64, NumberType::F32] {
        let (_, rows) = table(scalar, cases.as_bytes());
        assert_eq!(rows[0][1], "serial singular: leg 1");
        assert_eq!(rows[1][1], "parallel singular");
    }
}

#[test]
fn a_table_without_rows_gives_a_header_and_one_without_columns_is_refused() {
    let header = format!("{MACHINE_HEADER},{STATE_HEADER}");
    assert!(table(NumberType::F64, header.as_bytes()).1.is_empty());
    assert!(refusal(b"").contains("cases.csv: is empty"));
    let message = refusal(header.replace("z2_3,", "").as_bytes());
    assert_eq!(message, "cases.csv: column z2_3 is missing");
    let message = refusal(format!("{MACHINE_HEADER},x0,xf,y0,yf,a0,af,T\n").as_bytes());
    assert_eq!(message, "cases.csv: column t is missing");
    let message = refusal(format!("{header},m\n").as_bytes());
    assert_eq!(message, "cases.csv: column m is there more than once");
}

#[test]
fn bytes_that_are_no_text_spoil_their_row_only() {
    let mut cases = format!("{MACHINE_HEADER},{STATE_HEADER}\n{MACHINE},{STATE}\n").into_bytes();
    cases.extend_from_slice(b"\xff\xfe");
    cases.extend_from_slice(format!("{MACHINE},{STATE}\n").as_bytes());
    let (count, rows) = table(NumberType::F64, &cases);
    assert_eq!(
        count,
        RowCounts {
            rows: 2,
            ok: 1,
            is_cut: false
        }
    );
    assert!(rows[1][1].starts_with("invalid: ax_1 = "), "{}", rows[1][1]);
    assert!(rows[1][1].ends_with("is not a number"));
}

/// Beyond 2^31 turns an angle of fixed point would saturate without a word.
#[test]
fn fixed_point_refuses_an_angle_of_more_turns_than_it_counts() {
    let header = format!("{MACHINE_HEADER},{STATE_HEADER}");
    let alpha = header.split(',').position(|name| name == "alpha").unwrap();
    let good = format!("{MACHINE},{STATE}");
    let rows = ["1e10", "1.4e10", "1e308"].map(|value| {
        let mut fields: Vec<&str> = good.split(',').collect();
        fields[alpha] = value;
        fields.join(",")
    });
    let cases = format!("{header}\n{}\n", rows.join("\n"));
    let (_, rows) = table(NumberType::Fixed, cases.as_bytes());
    let statuses: Vec<&str> = rows.iter().map(|row| row[1].as_str()).collect();
    assert!(!statuses[0].contains("alpha"), "{statuses:?}");
    for status in &statuses[1..] {
        assert!(status.contains("alpha is 1."), "{status}");
        assert!(status.contains("rad; in fixed point it may be"), "{status}");
    }
}

/// Whatever column is large, positive or negative: a row has either no result in fixed point, or the one
/// that f64 has. A value that saturates would be off by its own size.
#[test]
fn fixed_point_holds_every_column_or_refuses_the_row() {
    let header = format!("{MACHINE_HEADER},{STATE_HEADER},gx,gy,Wx,Wy,Wa");
    let moving = "0.21,0.22,0.157,0.1,-0.2,0.3,0.42,0.36,0.314";
    let good = format!("{MACHINE},{moving},0.1,-9.81,0.5,-0.4,0.03");
    let fields: Vec<&str> = good.split(',').collect();
    let (mut lines, mut sizes) = (Vec::new(), Vec::new());
    for column in 0..fields.len() {
        for exponent in [0, 1, 2, 3, 4, 6, 8, 9, 10, 12, 20, 40, 100, 200, 300] {
            for digits in ["1.7", "-3.1", "6.3"] {
                let value = format!("{digits}e{exponent}");
                let mut row = fields.clone();
                row[column] = &value;
                lines.push(row.join(","));
                sizes.push(value.parse::<f64>().unwrap().abs());
            }
        }
    }
    let cases = format!("{header}\n{}\n", lines.join("\n"));
    let (_, fixed) = table(NumberType::Fixed, cases.as_bytes());
    let (_, exact) = table(NumberType::F64, cases.as_bytes());
    let number = |row: &[String], column: usize| -> f64 { row[column].parse().unwrap() };
    let mut compared = 0;
    for (((line, fixed), exact), size) in lines.iter().zip(&fixed).zip(&exact).zip(sizes) {
        if fixed[1] != "ok" {
            continue;
        }
        assert_eq!(exact[1], "ok", "{line}");
        compared += 1;
        // The three motors of each result; det A stands alone.
        let groups = [2, 5, 8, 11, 14, 17, 20, 24, 27].map(|first| first..first + 3);
        for (index, group) in groups.into_iter().enumerate() {
            let largest = match index {
                0 | 1 => 1.0,
                _ => group.clone().fold(0.0, |largest: f64, column| {
                    largest.max(number(exact, column).abs())
                }),
            };
            // Units of time fit the largest rate, acceleration or load, so small ones are coarse. What saturates
            // is off by its own size.
            let greatest = |columns: core::ops::Range<usize>| {
                columns.fold(0.0, |most: f64, column| {
                    most.max(number(exact, column).abs())
                })
            };
            let w = greatest(8..14).max(greatest(14..20).max(size).sqrt());
            let coarse = match index {
                2 | 3 => 1e-4 * w,
                4 | 5 => 1e-4 * w * w,
                7 => 1e-5 * w * w,
                8 => 1e-5 * w * w * w,
                _ => 0.0,
            };
            for column in group {
                let mut error = number(fixed, column) - number(exact, column);
                if index < 2 {
                    error = error.sin();
                }
                assert!(
                    error.abs() <= 0.02 * largest + coarse,
                    "{line}: {fixed:?} {exact:?}"
                );
            }
        }
    }
    assert!((300..lines.len()).contains(&compared), "{compared}");
}
