//! Solves a vector loop by Newton-Raphson: position, rates and accelerations of a slider-crank from
//! its closure equation, and the same mechanism in closed form for comparison.

use trirrr_linkage::Drive;
use trirrr_linkage::closure::{Closure, Input, Length, Reference, Term};
use trirrr_linkage::mechanism::slider_crank::{SHIPPED, SliderCrank};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // crank + rod = slide along x + offset of the guide along y. Unknown 0 is the angle of the rod,
    // unknown 1 the slide, input 0 the angle of the crank.
    let loop_of = |length, reference, offset| Term::new(0, length, reference, offset);
    let terms = [
        loop_of(Length::Constant(SHIPPED.crank), Reference::Driven(0), 0.0),
        loop_of(Length::Constant(SHIPPED.rod), Reference::Unknown(0), 0.0),
        loop_of(Length::Unknown(1), Reference::Fixed, 0.0).reversed(),
        loop_of(
            Length::Constant(SHIPPED.offset),
            Reference::Fixed,
            std::f64::consts::FRAC_PI_2,
        )
        .reversed(),
    ];
    let closure = Closure::<f64, 2, 1>::new(&terms)?;
    let closed_form = SliderCrank::<f64>::new(&SHIPPED)?;

    // The solution of each step is the guess of the next: the loop stays on its branch.
    let mut guess = [0.0, SHIPPED.rod];
    for degrees in (0..360u16).step_by(30) {
        let crank = Input {
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
        let slide = closed_form.at(&drive)?.slide;
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
