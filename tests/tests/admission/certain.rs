//! A limit that is said to be broken for certain is broken, and nearly every broken limit is said to be.

use crate::dense::{Density, extremes};
use crate::judge::judge;
use crate::moves::{in_type, offer};
use trirrr_service::admission::Enclose;
use trirrr_tests::draw::{Draw, machines, within_a_turn};
use trirrr_tests::random::share;

const DENSITY: Density = Density {
    samples: 200,
    every_speed: true,
};

/// Judges `count` random moves with limits as near as 1e-6 of what they need. Of those that break a limit by
/// more than 1e-4 of it, by the samples, no more than `unproven` in a hundred may be called unproven.
fn study<N: Enclose>(count: u32, unproven: u32) {
    let mut draw = Draw::new(77);
    let (mut broken, mut doubted) = (0, 0);
    for case in machines(77).take(count as usize) {
        let offer = offer(&within_a_turn(&case), &mut draw, DENSITY, 1e-6);
        let offered = in_type::<N>(&offer.offered);
        let excess = extremes(&offer.setting, offered, DENSITY).excess(&offer.setting);
        let Err(found) = judge(&offer.setting, offered).verdict else {
            continue;
        };
        let label = format!("{found:?} {excess} {offer:?}");
        if found.certain {
            // Samples miss a peak by less than this.
            assert!(excess > -1e-4, "{label}");
        }
        if let (true, Some(error)) = (excess.is_finite(), found.error) {
            let [value, error, limit] = [found.value, error, found.limit].map(N::to_f64);
            let breaks = (value - error) > limit || (value + error) < limit;
            assert!(breaks || !found.certain, "{label}");
        }
        if excess > 1e-4 && excess.is_finite() {
            broken += 1;
            doubted += u32::from(!found.certain);
        }
    }
    println!("{broken} break a limit, {doubted} of them are only called unproven");
    assert!(broken > count / 10);
    assert!(doubted * 100 <= broken * unproven, "{doubted} of {broken}");
}

#[test]
fn what_is_certain_is_so_f64() {
    study::<f64>(share(300), 1);
}

#[test]
fn what_is_certain_is_so_f32() {
    study::<f32>(share(300), 10);
}
