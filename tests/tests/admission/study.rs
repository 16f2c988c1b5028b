//! Random moves on random machines: nothing infeasible is admitted, and little that is feasible is
//! refused.

use crate::dense::{Density, extremes};
use crate::judge::judge;
use crate::moves::{Offer, in_f64, offer, offer_quintic};
use std::fmt;
use std::thread;
use trirrr_core::number::Fixed;
use trirrr_scene::Scene;
use trirrr_service::admission::Enclose;
use trirrr_tests::draw::{Draw, machines, within_a_turn};
use trirrr_tests::random::{Case, share};

const THESIS: &str = include_str!("../../../scenes/thesis.toml");

/// Moves of each number type.
const MOVES: usize = share(1000) as usize;

/// What came of so many moves.
#[derive(Clone, Debug, Default)]
struct Tally {
    moves: u32,
    /// In no units within the number type's range, at normal speed and on every ramp: the tick refuses by itself
    /// what is beyond it.
    unheld: u32,
    /// Beyond reach or across a singularity.
    impossible: u32,
    feasible: u32,
    admitted: u32,
    /// Feasible, but refused: by how much, relative to the limit that is nearest, each would keep it.
    refused: Vec<f64>,
    /// Feasible and refused, by the tick's own values alone and by the true motion alone.
    by_each: [[u32; 2]; 2],
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
        self.unheld += other.unheld;
        for (own, other) in self
            .by_each
            .iter_mut()
            .flatten()
            .zip(other.by_each.iter().flatten())
        {
            *own += other;
        }
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
            "{} moves: {} beyond the type's range, {} impossible, {} feasible, {} admitted",
            self.moves, self.unheld, self.impossible, self.feasible, self.admitted
        )?;
        for (of, [feasible, refused]) in ["the tick's values", "the true motion"]
            .into_iter()
            .zip(self.by_each)
        {
            writeln!(f, "by {of}: {feasible} feasible, {refused} of them refused")?;
        }
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

/// A random offer on a machine, with limits as near as so much of themselves.
type Offering = fn(&Case, &mut Draw, Density, f64) -> Offer;

fn tally<N: Enclose>(
    offering: Offering,
    seed: u64,
    moves: usize,
    samples: u32,
    nearest: f64,
) -> Tally {
    let density = Density {
        samples,
        every_speed: false,
    };
    let thesis = Scene::parse(THESIS, "thesis.toml").expect("a good scene");
    let mut draw = Draw::new(seed);
    let mut tally = Tally::default();
    for case in machines(seed).take(moves) {
        // An angle of many turns is known the less the more there are: that is not what is studied.
        let case = within_a_turn(&case);
        let offer = offering(&case, &mut draw, density, nearest);
        tally.moves += 1;
        let Some((setting, offered)) = offer.in_type::<N>(&thesis) else {
            tally.unheld += 1;
            continue;
        };
        let own = extremes(&setting, offered, density);
        if !own.in_range {
            tally.unheld += 1;
            continue;
        }
        // The bounds hold both what a tick computes and what is true of the very numbers of the move.
        let truth = extremes(&setting, in_f64(&offered), density);
        let excesses = [&own, &truth].map(|extremes| extremes.excess(&setting));
        let excess = excesses[0].max(excesses[1]);
        let judged = judge(&setting, offered);
        let feasible = excess <= 0.0;
        for (by, excess) in tally.by_each.iter_mut().zip(excesses) {
            by[0] += u32::from(excess <= 0.0);
            by[1] += u32::from(excess <= 0.0 && judged.verdict.is_err());
        }
        tally.impossible += u32::from(!(own.possible && truth.possible));
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
    of_kind::<N>(offer, moves, samples, nearest)
}

fn of_kind<N: Enclose>(offering: Offering, moves: usize, samples: u32, nearest: f64) -> Tally {
    thread::scope(|scope| {
        let halves = [1, 2].map(|seed| {
            scope.spawn(move || tally::<N>(offering, seed, moves / 2, samples, nearest))
        });
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
    let held = tally.moves - tally.unheld;
    assert!(tally.feasible > held / 4, "too few are feasible");
    let infeasible = held - tally.feasible - tally.impossible;
    assert!(infeasible > held / 8, "too few break a limit");
}

/// At most `part` of the feasible moves, or one, are refused, whichever values say what is feasible.
fn hold_refused(tally: &Tally, part: f64) {
    for [feasible, refused] in tally.by_each {
        assert!(
            f64::from(refused) <= (part * f64::from(feasible)).max(1.0),
            "{refused} of {feasible}"
        );
    }
}

#[test]
fn nothing_infeasible_is_admitted_f64() {
    hold(&on_two_threads::<f64>(MOVES, 1000, 1e-6));
}

#[test]
fn nothing_infeasible_is_admitted_f32() {
    let tally = on_two_threads::<f32>(MOVES, 1000, 1e-3);
    hold(&tally);
    hold_refused(&tally, 0.008);
}

#[test]
fn nothing_infeasible_is_admitted_fixed() {
    hold(&on_two_threads::<Fixed>(MOVES, 1000, 1e-3));
}

#[test]
fn nothing_infeasible_is_admitted_of_quintics() {
    hold(&of_kind::<f64>(offer_quintic, MOVES / 2, 1000, 1e-6));
    hold(&of_kind::<f32>(offer_quintic, MOVES / 2, 1000, 1e-3));
    hold(&of_kind::<Fixed>(offer_quintic, MOVES / 2, 1000, 1e-3));
}

/// The figures of quintics.
#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn nothing_infeasible_is_admitted_of_ten_thousand_quintics() {
    hold(&of_kind::<f64>(offer_quintic, 10_000, 1_000, 1e-6));
    let tally = of_kind::<f32>(offer_quintic, 10_000, 1_000, 1e-3);
    hold(&tally);
    hold_refused(&tally, 0.01);
    hold(&of_kind::<Fixed>(offer_quintic, 10_000, 1_000, 1e-3));
}

/// The figure: 10,000 moves, 10,000 samples each. A minute or two, so only on request.
#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn nothing_infeasible_is_admitted_of_ten_thousand() {
    let tally = on_two_threads::<f64>(10_000, 10_000, 1e-6);
    hold(&tally);
    // With limits as near as a millionth of themselves.
    hold_refused(&tally, 0.01);
    assert_eq!(tally.refused_beyond(1e-3), 0);
}

/// The same in binary32, with fewer samples and limits no nearer than a thousandth.
#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn nothing_infeasible_is_admitted_of_ten_thousand_f32() {
    let tally = on_two_threads::<f32>(10_000, 1_000, 1e-3);
    hold(&tally);
    hold_refused(&tally, 0.003);
}

/// And in fixed point.
#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn nothing_infeasible_is_admitted_of_ten_thousand_fixed() {
    hold(&on_two_threads::<Fixed>(10_000, 1_000, 1e-3));
}
