//! Retargets of random machines from random states of motion, judged by the independent model at many instants.

mod drawn;
mod ends;
mod jerk;
mod judge;
mod published;
mod session;

use drawn::Setting;
use session::{Session, Tally};
use std::thread;
use trirrr_tests::draw::{Draw, machines};
use trirrr_tests::random::share;

fn tally(seed: u64, sessions: usize, count: u32, samples: u32) -> Tally {
    let mut draw = Draw::new(seed);
    let mut all = Tally::default();
    let mut cases = machines(seed);
    let mut done = 0;
    while done < sessions {
        let case = cases.next().expect("machines");
        let Some(setting) = Setting::draw(&case, &mut draw) else {
            continue;
        };
        done += 1;
        let session = Session {
            setting: &setting,
            draw: &mut draw,
            count,
            samples,
        };
        all.join(session.run());
    }
    all
}

/// `unconfirmed`: refusals for which the judge may find a motion to rest that the planner does not try.
fn study(sessions: usize, count: u32, samples: u32, unconfirmed: usize) {
    let halves = thread::scope(|scope| {
        let halves =
            [1, 2].map(|seed| scope.spawn(move || tally(seed, sessions / 2, count, samples)));
        halves.map(|half| half.join().expect("no panic"))
    });
    let [mut all, other] = halves;
    all.join(other);
    all.steps.sort_unstable();
    let steps =
        |part: f64| all.steps[((part * all.steps.len() as f64) as usize).min(all.steps.len() - 1)];
    println!(
        "{} retargets: {} planned, of them {} of one move and {} of none; refused for start, target, stop, arrival, way: {:?}",
        all.steps.len(),
        all.planned,
        all.one_move,
        all.at_once,
        all.refused
    );
    println!(
        "largest part of a limit {:.9}; steps: median {}, 90 % {}, 99 % {}, most {}",
        all.largest,
        steps(0.5),
        steps(0.9),
        steps(0.99),
        steps(1.0)
    );
    for failed in all.failed.iter().take(5) {
        println!("{failed}");
    }
    assert!(
        all.failed.len() <= unconfirmed,
        "{} refusals are not confirmed",
        all.failed.len()
    );
}

#[test]
fn no_random_retarget_fails() {
    study(share(100) as usize, 50, 100, 0);
}

#[test]
#[ignore = "takes minutes"]
fn hardly_a_refusal_of_a_million_is_not_confirmed() {
    study(5_000, 200, 40, 100);
}
