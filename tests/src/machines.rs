//! The machines that the reference data is about.

use crate::table::Row;
use nalgebra::{Vector2, Vector3};
use trirrr_core::machine::{Elbow, LegParameters, LinkParameters, Parameters, PlatformParameters};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};

/// The thesis machine: massless links, horizontal, no wrench.
pub fn thesis() -> Parameters {
    let leg = |base: [f64; 2], joint_angle_rad: f64| LegParameters {
        base_m: Vector2::from(base),
        proximal_m: 0.2,
        distal_m: 0.2,
        joint_radius_m: 0.02,
        joint_angle_rad,
        elbow: Elbow::Positive,
        proximal: LinkParameters::default(),
        distal: LinkParameters::default(),
        rotor_inertia_kgm2: 0.0,
    };
    Parameters {
        legs: [
            leg([0.0, 0.433], 2.617_993_877_991_494_4),
            leg([0.5, 0.433], 0.523_598_775_598_298_8),
            leg([0.25, 0.0], 4.712_388_980_384_69),
        ],
        platform: PlatformParameters {
            mass_kg: 0.5,
            inertia_kgm2: 0.5 * 0.5 * (0.1 * 0.1),
            com_m: Vector2::new(0.0, 0.0),
            tool_point_m: Vector2::new(0.0, 0.0),
        },
        gravity_m_s2: Vector2::new(0.0, 0.0),
        wrench_force_n: Vector2::new(0.0, 0.0),
        wrench_torque_nm: 0.0,
    }
}

/// The same with uniform rods of `mass_kg` as links.
pub fn with_rods(mut parameters: Parameters, mass_kg: f64) -> Parameters {
    for leg in &mut parameters.legs {
        leg.proximal = LinkParameters::uniform_rod(mass_kg, leg.proximal_m);
        leg.distal = LinkParameters::uniform_rod(mass_kg, leg.distal_m);
    }
    parameters
}

/// The same under gravity (0, -9.81) m/s^2 and with a wrench (1.5 N, -2 N, 0.03 N m).
pub fn under_gravity_and_wrench(parameters: Parameters) -> Parameters {
    Parameters {
        gravity_m_s2: Vector2::new(0.0, -9.81),
        wrench_force_n: Vector2::new(1.5, -2.0),
        wrench_torque_nm: 0.03,
        ..parameters
    }
}

/// The machine in a row of `extreme.csv`.
pub fn of_row(row: Row<'_>) -> Parameters {
    let legs = [1, 2, 3].map(|leg| {
        let number = |stem: &str| row.number(&format!("{stem}_{leg}"));
        LegParameters {
            base_m: Vector2::new(number("ax"), number("ay")),
            proximal_m: number("z1"),
            distal_m: number("z2"),
            joint_radius_m: number("h"),
            joint_angle_rad: number("lam"),
            elbow: match number("sg") {
                1.0 => Elbow::Positive,
                -1.0 => Elbow::Negative,
                other => panic!("sg_{leg} is {other}"),
            },
            proximal: LinkParameters::default(),
            distal: LinkParameters::default(),
            rotor_inertia_kgm2: 0.0,
        }
    });
    let parameters = Parameters {
        legs,
        platform: PlatformParameters {
            mass_kg: row.number("m"),
            inertia_kgm2: row.number("I"),
            com_m: Vector2::new(0.0, 0.0),
            tool_point_m: Vector2::new(0.0, 0.0),
        },
        gravity_m_s2: Vector2::new(row.number("gx"), row.number("gy")),
        wrench_force_n: Vector2::new(row.number("Wx"), row.number("Wy")),
        wrench_torque_nm: row.number("Wa"),
    };
    with_rods(parameters, row.number("ml"))
}

/// The state in a row, from the columns that hold its acceleration.
pub fn state_of_row<N: Number>(row: Row<'_>, acceleration: [&str; 3]) -> Setpoint<N> {
    let vector =
        |columns: [&str; 3]| Vector3::from(columns.map(|column| N::from_f64(row.number(column))));
    Setpoint {
        pose: Pose::from_f64(row.number("x"), row.number("y"), row.number("alpha")),
        velocity: vector(["vx", "vy", "valpha"]),
        acceleration: vector(acceleration),
    }
}
