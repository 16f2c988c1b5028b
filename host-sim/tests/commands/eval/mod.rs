//! `trirrr eval`: values, and every way a table or a row can be wrong.

mod command;
mod refusals;
mod values;

use trirrr_host_sim::eval::{RowCounts, evaluate};
use trirrr_scene::NumberType;

const RESULT_HEADER: &str = "case,status,th1_1,th1_2,th1_3,th2_1,th2_2,th2_3,dth1_1,dth1_2,dth1_3,\
    dth2_1,dth2_2,dth2_3,ddth1_1,ddth1_2,ddth1_3,ddth2_1,ddth2_2,ddth2_3,D1,D2,D3,detA,\
    tau1,tau2,tau3,P1,P2,P3";

const MACHINE_HEADER: &str = "ax_1,ay_1,z1_1,z2_1,h_1,lam_1,sg_1,ax_2,ay_2,z1_2,z2_2,h_2,lam_2,sg_2,\
    ax_3,ay_3,z1_3,z2_3,h_3,lam_3,sg_3,m,I";
const MACHINE: &str = "0,0.433,0.2,0.2,0.02,2.6179938779914944,1,\
    0.5,0.433,0.2,0.2,0.02,0.5235987755982988,1,0.25,0,0.2,0.2,0.02,4.71238898038469,1,0.5,0.0025";
const STATE_HEADER: &str = "x,y,alpha,vx,vy,valpha,acx,acy,acalpha";
/// The thesis's move at its start.
const STATE: &str = "0.21,0.22,0.15707963267948966,0,0,0,0.42,0.36,0.31415926535897931";
const MOVE_HEADER: &str = "x0,xf,y0,yf,a0,af,T,t";
const MOVE: &str = "0.21,0.28,0.22,0.28,0.15707963267948966,0.20943951023931953,1";
/// True torques of the thesis's move at both ends, to the digits given.
const START: [f64; 3] = [0.012528697, 0.014246763, -0.029750897];
const END: [f64; 3] = [-0.019558387, -0.015416587, 0.039628158];

/// Evaluates a table and checks what holds for every result.
fn table(scalar: NumberType, cases: &[u8]) -> (RowCounts, Vec<Vec<String>>) {
    let mut results = Vec::new();
    let count = evaluate(scalar, "cases.csv", cases, &mut results).expect("results");
    let text = String::from_utf8(results).unwrap();
    assert_eq!(text.lines().next(), Some(RESULT_HEADER));
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let rows: Vec<Vec<String>> = reader
        .records()
        .map(|row| row.unwrap().iter().map(Into::into).collect())
        .collect();
    assert_eq!(count.rows, rows.len());
    assert_eq!(count.ok, rows.iter().filter(|row| row[1] == "ok").count());
    for row in &rows {
        for field in &row[2..] {
            if row[1] == "ok" {
                assert!(field.parse::<f64>().unwrap().is_finite());
            } else {
                assert_eq!(field, "");
            }
        }
    }
    (count, rows)
}

/// tau1 to tau3 of a row of results.
fn torques(row: &[String]) -> [f64; 3] {
    [24, 25, 26].map(|field| row[field].parse().unwrap())
}

fn assert_near(computed: [f64; 3], expected: [f64; 3], tolerance: f64) {
    for (computed, expected) in computed.iter().zip(expected) {
        assert!(
            (computed - expected).abs() < tolerance,
            "{computed} {expected}"
        );
    }
}
