//! Prints the coupler curve of a four-bar linkage over one turn of the crank, in f32 as on a
//! microcontroller: `cargo run -p trirrr-linkage --example coupler_curve > curve.csv`.

use nalgebra::Vector2;
use std::f32::consts::TAU;
use trirrr_linkage::rrr::{Rrr, SolveRrr};
use trirrr_linkage::{Crank, Drive, FourBar, PointMotion};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let lengths = FourBar {
        ground: 0.4,
        crank: 0.1,
        coupler: 0.35,
        rocker: 0.25,
    };
    // Grashof's class says if the crank turns fully, before any position is solved.
    assert!(lengths.turns_fully());
    let crank = Crank::<f32>::new(Vector2::new(0.0, 0.0), lengths.crank);
    let dyad = Rrr::<f32>::new(lengths.coupler, lengths.rocker, 1.0);
    let pivot = PointMotion::fixed(Vector2::new(0.4, 0.0));
    let mut least_distance = f32::INFINITY;

    println!("crank_rad,x_m,y_m,vx_m_s,vy_m_s,ax_m_s2,ay_m_s2");
    for step in 0..72u8 {
        let drive = Drive {
            angle: TAU * f32::from(step) / 72.0,
            rate: 2.0,
            acceleration: 0.0,
        };
        let motion = dyad.solve(&crank.tip(&crank.at(&drive)), &pivot)?;
        // Any point of any link follows from the motion of the link: here 0.2 m along the coupler
        // and 0.1 m to its left.
        let tracer = motion.first.point(Vector2::new(0.2, 0.1));
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
