//! Places the base joints of a 3-PRRR machine for a path: the slider positions, held over the path,
//! that keep the machine furthest from its singularities, and the loads there.

use nalgebra::Vector3;
use trirrr_core::machine::example;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_linkage::redundant::{
    RedundantMachine, RedundantParameters, SliderParameters, SliderState, Travel, place,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The thesis machine with each base joint on a slider along x.
    let thesis = example();
    let guide = SliderParameters {
        direction_rad: 0.0,
        mass_kg: 0.5,
    };
    let machine = RedundantMachine::<f64, 3>::build(&RedundantParameters {
        legs: thesis.legs,
        sliders: [Some(guide); 3],
        platform: thesis.platform,
        gravity_m_s2: thesis.gravity_m_s2,
        wrench_force_n: thesis.wrench_force_n,
        wrench_torque_nm: thesis.wrench_torque_nm,
    })?;
    let path: Vec<Pose<f64>> = (0..=20)
        .map(|step| f64::from(step) / 20.0)
        .map(|s| Pose::from_f64(0.21 + 0.07 * s, 0.22 + 0.06 * s, 0.16 + 0.05 * s))
        .collect();

    let travel = Some(Travel {
        low_m: -0.1,
        high_m: 0.1,
    });
    let best = place(&machine, &path, &[travel; 3])?;
    println!("sliders at {:.4?} m", best.sliders_m);
    println!(
        "least distance {:.4} at pose {}, of {} placements",
        best.distance, best.pose, best.looked_at
    );

    // Motors and sliders while the platform accelerates through the middle of the path.
    let setpoint = Setpoint {
        pose: path[10],
        velocity: Vector3::new(0.3, 0.2, 0.0),
        acceleration: Vector3::new(2.0, 1.0, 0.0),
    };
    let sliders = best.sliders_m.map(SliderState::at);
    let motion = machine.evaluate(&setpoint, &sliders, &[0.0; 3])?;
    for (leg, motor) in motion.motors.iter().enumerate() {
        let force = motion.sliders[leg].map_or(0.0, |slider| slider.force);
        println!(
            "leg {}: motor {:>8.5} N m, slider {:>8.4} N",
            leg + 1,
            motor.torque,
            force
        );
    }
    Ok(())
}
