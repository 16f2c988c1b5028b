//! Prints the coupler curve of a four-bar linkage over one turn of the crank, in f32 as on a
//! microcontroller: `cargo run -p trirrr-linkage --example coupler_curve > curve.csv`.

use nalgebra::Vector2;
use std::f32::consts::TAU;
use trirrr_linkage::Drive;
use trirrr_linkage::mechanism::four_bar::{FourBar, SHIPPED};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Grashof's class says if the crank turns fully, before any position is solved.
    assert!(SHIPPED.turns_fully());
    let linkage = FourBar::<f32>::new(&SHIPPED)?;
    let mut least_distance = f32::INFINITY;

    println!("crank_rad,x_m,y_m,vx_m_s,vy_m_s,ax_m_s2,ay_m_s2");
    for step in 0..72u8 {
        let drive = Drive {
            angle: TAU * f32::from(step) / 72.0,
            rate: 2.0,
            acceleration: 0.0,
        };
        let motion = linkage.at(&drive)?;
        // Any point of any link follows from the motion of the link: here 0.2 m along the coupler
        // and 0.1 m to its left.
        let tracer = motion.coupler.point(Vector2::new(0.2, 0.1));
        let (p, v, a) = (tracer.position, tracer.velocity, tracer.acceleration);
        println!(
            "{},{},{},{},{},{},{}",
            drive.angle, p.x, p.y, v.x, v.y, a.x, a.y
        );
        least_distance = least_distance.min(motion.singularity_distance);
    }
    eprintln!("sine of the transmission angle: at least {least_distance:.3}");
    Ok(())
}
