//! What the build script of an image writes is what the host builds, in the bits: every shipped
//! scene in every number type that it fits.
//!
//! Compared as text: `Debug` writes a float with the digits that tell it from every other one, the
//! sign of zero included.

use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::Parameters;
use trirrr_core::number::WideArithmetic;
use trirrr_core::units::Units;
use trirrr_protocol::message::scene::Section;
use trirrr_service::coefficients::Coefficients;
use trirrr_service::features::{Feature, PathPlanner, PlayedCurves};
use trirrr_service::{Parts, name};

/// What the parts say, in `units`: all that there is to say of `any` machine.
fn in_units(parts: &Parts, units: &Units, any: &Parameters) -> (Parameters, LimitParameters) {
    let section = |bytes| postcard::from_bytes(bytes).expect("a part is whole");
    let Section::Platform(platform) = section(parts.platform) else {
        panic!("the platform stands where it belongs");
    };
    let mut parameters = platform.put_into(any);
    for (place, bytes) in parts.legs.iter().enumerate() {
        let Section::Leg { index, leg } = section(bytes) else {
            panic!("a leg stands where it belongs");
        };
        assert_eq!(usize::from(index), place);
        parameters.legs[place] = (&leg).into();
    }
    let Section::Limits(limits) = section(parts.limits) else {
        panic!("the limits stand where they belong");
    };
    (
        units.parameters(&parameters),
        units.limits(&(&limits).into()),
    )
}

macro_rules! images {
    ($($image:ident = $file:literal;)*) => {
        $(
            #[allow(clippy::approx_constant, clippy::excessive_precision, unreachable_pub)]
            mod $image {
                include!(concat!(env!("OUT_DIR"), $file));
            }

            #[test]
            fn $image() {
                use $image::*;
                let built = Coefficients::<Model>::build(
                    &PARAMETERS, &LIMITS, RAMP, PERIOD,
                );
                let built = built.expect("a shipped scene is good");
                assert_eq!(format!("{COEFFICIENTS:?}"), format!("{built:?}"));
                assert_eq!(in_units(&PARTS, &UNITS, &PARAMETERS), (PARAMETERS, LIMITS));
                let start = MOVES[0].ends::<Scalar, Curves>().from;
                assert_eq!(format!("{START:?}"), format!("{start:?}"));
                let period = <Scalar as WideArithmetic>::factor_from_f64(PERIOD);
                assert_eq!(format!("{:?}", SETTINGS.period), format!("{period:?}"));
                assert_eq!(SETTINGS.scene.name, name(NAME));
                let mut planner = <Planner as PathPlanner<Scalar>>::EMPTY;
                PathPlanner::<Scalar>::set_up(&mut planner, SETTINGS.planning);
                let can_plan = PathPlanner::<Scalar>::can_plan(&planner);
                assert_eq!(can_plan, SETTINGS.planning.is_some());
                // All shipped scenes leave it to the job: planned moves need batches. None has a move of fewer than 10 ticks by hand.
                assert_eq!(Batches::EXISTS, <Curves as PlayedCurves>::CUTS);
                assert_eq!(SETTINGS.scene.tick_rate_hz, TICK_RATE_HZ);
                assert_eq!(1.0 / TICK_RATE_HZ, PERIOD_S);
            }
        )*
    };
}

include!(concat!(env!("OUT_DIR"), "/images.rs"));
