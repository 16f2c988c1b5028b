//! binary32 against binary64: the same verdicts but where a limit is near.

use crate::dense::{Density, extremes};
use crate::judge::judge;
use crate::moves::{in_type, offer};
use trirrr_protocol::message::{LeastDuration, Move};
use trirrr_tests::draw::{Draw, machines, within_a_turn};

const DENSITY: Density = Density {
    samples: 300,
    every_speed: false,
};

#[test]
fn verdicts_agree_away_from_limits() {
    let mut draw = Draw::new(31);
    let (mut admitted, mut refused, mut durations) = (0, 0, 0);
    // Kept in binary64 by little, not for certain in binary32.
    let mut near = 0;
    for case in machines(31).take(400) {
        let offer = offer(&within_a_turn(&case), &mut draw, DENSITY, 1e-2);
        let single = in_type::<f32>(&offer.offered);
        let found = extremes(&offer.setting, offer.offered, DENSITY);
        let excess = found.excess(&offer.setting);
        if excess.abs() < 5e-3 {
            continue;
        }
        let double = judge(&offer.setting, offer.offered).verdict;
        let single = judge(&offer.setting, single).verdict;
        let label = format!("{double:?} {single:?} {excess} {offer:?}");
        match (double, single) {
            (Ok(()), Ok(())) => admitted += 1,
            (Err(double), Err(single)) => {
                refused += 1;
                // With its wider bounds binary32 cannot be sure for as long; it names what is broken for
                // certain rather than what comes first.
                assert!(
                    single.certain || f64::from(single.at) <= double.at + 1e-3,
                    "{label}"
                );
                if let (
                    Some(LeastDuration { enough: double, .. }),
                    Some(LeastDuration { enough: single, .. }),
                ) = (double.shortest, single.shortest)
                {
                    // Nearer to a limit that the duration hardly moves, binary32 needs longer: what
                    // it names is never too short.
                    assert!(
                        f64::from(single) >= 0.995 * f64::from(double) - 1.0,
                        "{label}"
                    );
                    let slower = Move {
                        ticks: single,
                        ..*offer.offered.common()
                    };
                    assert_eq!(judge(&offer.setting, &slower).verdict, Ok(()), "{label}");
                    durations += 1;
                }
            }
            (Ok(()), Err(_)) if excess > -0.05 => near += 1,
            _ => panic!("{label}"),
        }
    }
    assert!(
        admitted > 50 && refused > 50 && durations > 20,
        "{admitted} {refused} {durations}"
    );
    assert!(near * 50 < admitted, "{near} of {admitted}");
}
