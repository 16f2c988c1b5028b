//! Solves a vector loop by Newton-Raphson: position, rates and accelerations of a slider-crank from
//! its closure equation, and the same mechanism in closed form for comparison.

use nalgebra::Vector2;
use trirrr_linkage::closure::{Closure, ClosureInput, Length, Reference, Term};
use trirrr_linkage::rrp::Rrp;
use trirrr_linkage::{Crank, Drive, GuideMotion};

const CRANK_M: f64 = 0.1;
const ROD_M: f64 = 0.35;
const OFFSET_M: f64 = 0.05;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // crank + rod = slide along x + offset of the guide along y. Unknown 0 is the angle of the rod,
    // unknown 1 the slide, input 0 the angle of the crank.
    let loop_of = |length, reference, offset| Term::new(0, length, reference, offset);
    let terms = [
        loop_of(Length::Constant(CRANK_M), Reference::Driven(0), 0.0),
        loop_of(Length::Constant(ROD_M), Reference::Unknown(0), 0.0),
        loop_of(Length::Unknown(1), Reference::Fixed, 0.0).reversed(),
        loop_of(
            Length::Constant(OFFSET_M),
            Reference::Fixed,
            std::f64::consts::FRAC_PI_2,
        )
        .reversed(),
    ];
    let closure = Closure::<f64, 2, 1>::new(&terms)?;
    // The guide along the x axis; the joint of the rod stands off by the offset.
    let crank_link = Crank::<f64>::new(Vector2::new(0.0, 0.0), CRANK_M);
    let guide = GuideMotion::fixed(Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0));
    let dyad = Rrp::<f64>::from_offsets(ROD_M, 0.0, OFFSET_M, 1.0);

    // The solution of each step is the guess of the next: the loop stays on its branch.
    let mut guess = [0.0, ROD_M];
    for degrees in (0..360u16).step_by(30) {
        let crank = ClosureInput {
            value: f64::from(degrees).to_radians(),
            rate: 10.0,
            acceleration: 0.0,
        };
        let at = closure.position(&[crank], guess)?;
        let rates = closure.rates(&[crank], &at)?;
        let accelerations = closure.accelerations(&[crank], &at, &rates)?;
        guess = at.unknowns;

        let drive = Drive {
            angle: crank.value,
            rate: crank.rate,
            acceleration: crank.acceleration,
        };
        let tip = crank_link.tip(&crank_link.at(&drive));
        let [slide] = dyad.solve(&tip, &guide)?.slides;
        println!(
            "{degrees:>3} deg: slide {:.6} m, {:>9.6} m/s, {:>10.6} m/s^2; {} iterations, condition \
             {:.1}, off the closed form by {:.0e} m",
            at.unknowns[1],
            rates[1],
            accelerations[1],
            at.iterations,
            at.condition,
            (at.unknowns[1] - slide.length).abs()
        );
        assert!((accelerations[1] - slide.acceleration).abs() < 1e-12 * 100.0);
    }
    Ok(())
}
