//! The tick as SymForce generates it, behind safe functions.
//!
//! A setpoint is pose, velocity and acceleration; a row is angle, rate, acceleration and torque of each motor.
#![allow(unsafe_code)]

unsafe extern "C" {
    fn symforce_massless(
        setpoints: *const [f64; 9],
        count: usize,
        k: *const f64,
        rows: *mut [f64; 12],
    );
    fn symforce_links(
        setpoints: *const [f64; 9],
        count: usize,
        k: *const f64,
        rows: *mut [f64; 12],
    );
}

/// Evaluates a machine with massless links; `k` in the order of `MasslessCoefficients` of the generated code.
///
/// # Panics
/// There is not a row for each setpoint.
pub fn massless(setpoints: &[[f64; 9]], k: &[f64; 36], rows: &mut [[f64; 12]]) {
    assert_eq!(setpoints.len(), rows.len());
    // SAFETY: the loop reads `count` structs of 9 numbers and one of 36, and writes 12 numbers for each.
    unsafe {
        symforce_massless(
            setpoints.as_ptr(),
            setpoints.len(),
            k.as_ptr(),
            rows.as_mut_ptr(),
        )
    }
}

/// Evaluates a machine whose links have masses; `k` in the order of `LinksCoefficients` of the generated code.
///
/// # Panics
/// There is not a row for each setpoint.
pub fn links(setpoints: &[[f64; 9]], k: &[f64; 48], rows: &mut [[f64; 12]]) {
    assert_eq!(setpoints.len(), rows.len());
    // SAFETY: the loop reads `count` structs of 9 numbers and one of 48, and writes 12 numbers for each.
    unsafe {
        symforce_links(
            setpoints.as_ptr(),
            setpoints.len(),
            k.as_ptr(),
            rows.as_mut_ptr(),
        )
    }
}
