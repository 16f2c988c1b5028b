//! Random moves on random machines: nothing infeasible is admitted, and little that is feasible is
//! refused.

use crate::dense::{Density, extremes};
use crate::judge::judge;
use crate::moves::{Draw, in_type, machines, offer, within_a_turn};
use std::fmt;
use std::thread;
use trirrr_service::admission::Enclose;

/// What came of so many moves.
#[derive(Clone, Debug, Default)]
struct Tally {
    moves: u32,
    /// Beyond reach or across a singularity.
    impossible: u32,
    feasible: u32,
    admitted: u32,
    /// Feasible, but refused: by how much, relative to the limit that is nearest, each would keep it.
    refused: Vec<f64>,
    /// Infeasible, but admitted: by how much a limit is exceeded.
    wrong: Vec<f64>,
    /// Steps of each move that was admitted.
    steps: Vec<u32>,
    /// Steps of each move that was refused, the search for a duration included.
    refusal_steps: Vec<u32>,
}

impl Tally {
    fn joined(mut self, other: Self) -> Self {
        self.moves += other.moves;
        self.impossible += other.impossible;
        self.feasible += other.feasible;
        self.admitted += other.admitted;
        self.refused.extend(other.refused);
        self.wrong.extend(other.wrong);
        self.steps.extend(other.steps);
        self.refusal_steps.extend(other.refusal_steps);
        self
    }

    /// Refused although feasible with every limit kept by more than `margin` of it.
    fn refused_beyond(&self, margin: f64) -> usize {
        self.refused.iter().filter(|&&kept| kept > margin).count()
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let spread = |steps: &[u32]| {
            let mut steps = steps.to_vec();
            steps.sort_unstable();
            let at = |part: f64| {
                let place = (part * steps.len() as f64) as usize;
                steps.get(place.min(steps.len().saturating_sub(1))).copied()
            };
            let [median, most] = [0.5, 1.0].map(|part| at(part).unwrap_or(0));
            format!("median {median}, most {most}")
        };
        let nearest = self.refused.iter().copied().fold(0.0, f64::max);
        writeln!(
            f,
            "{} moves: {} impossible, {} feasible, {} admitted",
            self.moves, self.impossible, self.feasible, self.admitted
        )?;
        writeln!(f, "infeasible but admitted: {}", self.wrong.len())?;
        writeln!(
            f,
            "feasible but refused: {} ({:.2} %); kept by more than 1e-5 of the limit: {}, 1e-4: {}, \
             1e-3: {}; the furthest by {nearest:.2e}",
            self.refused.len(),
            100.0 * self.refused.len() as f64 / f64::from(self.feasible.max(1)),
            self.refused_beyond(1e-5),
            self.refused_beyond(1e-4),
            self.refused_beyond(1e-3),
        )?;
        writeln!(f, "intervals of the admitted: {}", spread(&self.steps))?;
        write!(
            f,
            "intervals of the refused: {}",
            spread(&self.refusal_steps)
        )
    }
}

fn tally<N: Enclose>(seed: u64, moves: usize, samples: u32, nearest: f64) -> Tally {
    let density = Density {
        samples,
        every_speed: false,
    };
    let mut draw = Draw::new(seed);
    let mut tally = Tally::default();
    for case in machines(seed).take(moves) {
        // An angle of many turns is known the less the more there are: that is not what is studied.
        let case = within_a_turn(&case);
        let offer = offer(&case, &mut draw, density, nearest);
        let offered = in_type::<N>(&offer.offered);
        // The tick's own numbers count: those of the number type.
        let extremes = extremes(&offer.setting, &offered, density);
        let excess = extremes.excess(&offer.setting);
        let judged = judge(&offer.setting, &offered);
        let feasible = excess <= 0.0;
        tally.moves += 1;
        tally.impossible += u32::from(!extremes.possible);
        tally.feasible += u32::from(feasible);
        match judged.verdict {
            Ok(()) => {
                tally.admitted += 1;
                tally.steps.push(judged.steps);
                if !feasible {
                    tally.wrong.push(excess);
                    println!("admitted, exceeds by {excess:e}: {offer:?}");
                }
            }
            Err(_) => {
                tally.refusal_steps.push(judged.steps);
                if feasible {
                    tally.refused.push(-excess);
                }
            }
        }
    }
    tally
}

fn on_two_threads<N: Enclose>(moves: usize, samples: u32, nearest: f64) -> Tally {
    thread::scope(|scope| {
        let halves =
            [1, 2].map(|seed| scope.spawn(move || tally::<N>(seed, moves / 2, samples, nearest)));
        halves
            .into_iter()
            .map(|half| half.join().expect("no panic"))
            .fold(Tally::default(), Tally::joined)
    })
}

fn hold(tally: &Tally) {
    println!("{tally}");
    assert_eq!(tally.wrong.len(), 0, "infeasible moves were admitted");
    // The check would hold trivially if hardly any move were of the one kind or of the other.
    assert!(tally.feasible > tally.moves / 4, "too few are feasible");
    let infeasible = tally.moves - tally.feasible - tally.impossible;
    assert!(infeasible > tally.moves / 8, "too few break a limit");
}

#[test]
fn nothing_infeasible_is_admitted_f64() {
    hold(&on_two_threads::<f64>(400, 1000, 1e-6));
}

#[test]
fn nothing_infeasible_is_admitted_f32() {
    hold(&on_two_threads::<f32>(400, 1000, 1e-2));
}

/// The figure: 10,000 moves, 10,000 samples each. A minute or two, so only on request.
#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn nothing_infeasible_is_admitted_of_ten_thousand() {
    let tally = on_two_threads::<f64>(10_000, 10_000, 1e-6);
    hold(&tally);
    // With limits as near as a millionth of themselves.
    assert!(tally.refused.len() as f64 <= 0.01 * f64::from(tally.feasible));
    assert_eq!(tally.refused_beyond(1e-3), 0);
}

/// The same in binary32, with fewer samples and limits no nearer than a hundredth.
#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn nothing_infeasible_is_admitted_of_ten_thousand_f32() {
    let tally = on_two_threads::<f32>(10_000, 1_000, 1e-2);
    hold(&tally);
    assert!(tally.refused.len() as f64 <= 0.02 * f64::from(tally.feasible));
}
