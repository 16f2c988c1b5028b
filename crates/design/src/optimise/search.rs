//! Course of a study: which solver looks where, with how many of the evaluations.

use super::plan::{SearchPlan, SearchWatch, mixed};
use super::swarm::{SearchLog, SearchTarget, Swarm, refine};
use super::{Appraisal, DesignPoint, front};

/// Part of the evaluations that the swarms take; the simplex has the others.
const GLOBAL: f64 = 0.7;

/// Moves of all swarms after which the worse half of them ends.
const ROUNDS: usize = 3;

/// Levels of the first objective at which the second one is made small.
const LEVELS: usize = 6;

/// Sizes of the simplices, one after the other, in parts of the ranges.
const SIZES: [f64; 3] = [0.05, 0.2, 0.01];

/// Looks for the best candidates of `plan`; all that were looked at, in order. The first ones are the scene's own values in each mode.
pub fn search(
    plan: &SearchPlan<'_>,
    appraise: &(dyn Fn(DesignPoint) -> Appraisal + Sync),
    watch: &SearchWatch<'_>,
) -> Vec<Appraisal> {
    let log = SearchLog::new(plan, appraise, watch);
    let all = plan.evaluations;
    match plan.objectives {
        [_, _] => {
            minimise(&log, SearchTarget::Least(0), all / 4, 0);
            minimise(&log, SearchTarget::Least(1), all / 2, 1);
            for level in 0..LEVELS {
                let Some(most) = level_between(&log, level) else {
                    break;
                };
                let end = all / 2 + (level + 1) * (all - all / 2) / LEVELS;
                minimise(&log, SearchTarget::Within(most), end, 2 + level as u64);
            }
        }
        _ => minimise(&log, SearchTarget::Least(0), all, 0),
    }
    log.known.into_inner()
}

/// Cost of the first objective at a level between the ends of the front so far.
fn level_between(log: &SearchLog<'_>, level: usize) -> Option<f64> {
    let known = log.known.borrow();
    let objectives = log.plan.objectives;
    let ends = front(&known, objectives);
    let cost = |index: &usize| {
        let found = known[*index].found.as_ref().ok()?;
        Some(objectives[0].cost(found[0]))
    };
    let (low, high) = (cost(ends.first()?)?, cost(ends.last()?)?);
    Some(low + (high - low) * (level as f64 + 1.0) / (LEVELS as f64 + 1.0))
}

/// Makes `target` small until `end` candidates were looked at in all.
fn minimise(log: &SearchLog<'_>, target: SearchTarget, end: usize, phase: u64) {
    let plan = log.plan;
    let own = plan.space.parts(&plan.own);
    let begun = log.count();
    let points = plan.modes.iter().map(|mode| plan.space.point(*mode, &own));
    let found = log.fitness(points.collect(), target);
    if plan.space.ranges.is_empty() || log.has_ended.get() {
        return;
    }
    let left = end.saturating_sub(log.count());
    let global = begun + (GLOBAL * end.saturating_sub(begun) as f64) as usize;
    let particles = (3 * plan.space.ranges.len() + 4).min(24);
    // The most promising modes, as many as have two generations.
    let mut modes: Vec<(usize, f64)> = found.into_iter().enumerate().collect();
    modes.sort_by(|one, other| one.1.total_cmp(&other.1));
    modes.truncate((left / (2 * particles)).max(1));
    let mut swarms: Vec<Swarm<'_>> = Vec::new();
    for (index, _) in modes {
        let mode = plan.modes[index];
        let mut known = vec![own.clone()];
        let best = log.best(target, Some(mode));
        known.extend(best.map(|point| plan.space.parts(&point.values)));
        known.dedup();
        let seed = mixed(mixed(plan.seed, phase), index as u64);
        if log.count() < global && !log.has_ended.get() {
            swarms.push(Swarm::new(log, (mode, target), &known, particles, seed));
        }
    }
    let mut stalled = 0;
    for round in 1.. {
        let before = log.count();
        for swarm in &mut swarms {
            if log.count() < global && !log.has_ended.get() {
                swarm.step();
            }
        }
        if round % ROUNDS == 0 {
            swarms.sort_by(|one, other| one.fitness().total_cmp(&other.fitness()));
            swarms.truncate(swarms.len().div_ceil(2));
        }
        // Swarms that stand still look at nothing new.
        stalled = if log.count() == before {
            stalled + 1
        } else {
            0
        };
        if log.count() >= global || log.has_ended.get() || stalled > 2 * ROUNDS {
            break;
        }
    }
    for size in SIZES {
        if log.count() < end && !log.has_ended.get() {
            refine(log, target, size, end);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::modes::MODES;
    use crate::optimise::{CandidateFault, DesignSpace, Objective, StudyMode, best};
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

    fn space(modes: bool) -> DesignSpace {
        let varied = ["a=-2..2", "b=-2..2"].map(|text| text.parse().unwrap());
        let mut space = DesignSpace::of(&varied).unwrap();
        if modes {
            space.modes = MODES.map(StudyMode).into();
        }
        space
    }

    fn run(space: &DesignSpace, objectives: &[Objective], evaluations: usize) -> Vec<Appraisal> {
        let plan = SearchPlan {
            space,
            modes: match space.modes.is_empty() {
                true => vec![None],
                false => space.modes.iter().copied().map(Some).collect(),
            },
            own: vec![1.5, -1.5],
            objectives,
            evaluations,
            seed: 7,
        };
        // Rosenbrock's valley in one mode, higher in all others, on a disc alone; the second objective asks for the opposite.
        let appraise = |point: DesignPoint| {
            let [a, b] = [point.values[0], point.values[1]];
            let offset = match point.mode.map(|mode| mode.to_string()).as_deref() {
                None | Some("+-+") => 0.0,
                _ => 5.0,
            };
            let valley = (1.0 - a).powi(2) + 100.0 * (b - a * a).powi(2) + offset;
            let beyond = a.hypot(b) - 1.6;
            let found = match beyond > 0.0 {
                true => Err(CandidateFault {
                    reason: "beyond".into(),
                    shortfall: beyond,
                }),
                false => Ok([valley, (a + 1.0).powi(2) + b * b]
                    .into_iter()
                    .take(objectives.len())
                    .collect()),
            };
            Appraisal { point, found }
        };
        let watch = SearchWatch {
            stop: &AtomicBool::new(false),
            told: &|| {},
        };
        search(&plan, &appraise, &watch)
    }

    #[test]
    fn a_search_finds_the_valley_and_its_mode_from_beyond_the_bounds() {
        for modes in [false, true] {
            let space = space(modes);
            let found = run(&space, &[Objective::Torque], 1200);
            assert!(found.len() <= 1200);
            let best = &found[best(&found, &[Objective::Torque]).unwrap()];
            let value = best.found.as_ref().unwrap()[0];
            assert!(value < 0.01, "{best:?}");
            if modes {
                assert_eq!(best.point.mode.unwrap().to_string(), "+-+");
            }
            assert_eq!(found, run(&space, &[Objective::Torque], 1200));
        }
    }

    /// The front of two squares of distances is the straight line between their centres.
    #[test]
    fn a_front_has_its_ends_and_what_is_between() {
        let space = space(false);
        let both = [Objective::Torque, Objective::Time];
        let found = run(&space, &both, 1500);
        let ends = front(&found, &both);
        assert!(ends.len() > 8, "{}", ends.len());
        let of = |index: usize| found[index].found.clone().unwrap();
        let (first, last) = (of(ends[0]), of(ends[ends.len() - 1]));
        assert!(first[0] < 0.05 && last[1] < 1e-3, "{first:?} {last:?}");
        for pair in ends.windows(2) {
            let (one, other) = (of(pair[0]), of(pair[1]));
            assert!(one[0] < other[0] && one[1] > other[1]);
        }
    }

    #[test]
    fn a_search_that_is_ended_keeps_what_it_has() {
        let space = space(false);
        let stop = AtomicBool::new(false);
        let seen = AtomicUsize::new(0);
        let plan = SearchPlan {
            space: &space,
            modes: vec![None],
            own: vec![0.0, 0.0],
            objectives: &[Objective::Torque],
            evaluations: 10_000,
            seed: 1,
        };
        let appraise = |point: DesignPoint| {
            if seen.fetch_add(1, Ordering::Relaxed) == 40 {
                stop.store(true, Ordering::Relaxed);
            }
            let found = Ok(vec![point.values[0].powi(2)]);
            Appraisal { point, found }
        };
        let watch = SearchWatch {
            stop: &stop,
            told: &|| {},
        };
        let found = search(&plan, &appraise, &watch);
        assert!((41..80).contains(&found.len()), "{}", found.len());
    }

    #[test]
    fn parts_share_modes_and_evaluations() {
        let space = space(true);
        let whole = SearchPlan {
            space: &space,
            modes: space.modes.iter().copied().map(Some).collect(),
            own: vec![0.0; 2],
            objectives: &[Objective::Torque],
            evaluations: 100,
            seed: 3,
        };
        let parts = (0..3).map(|index| {
            let mut part = whole.clone();
            part.take_part(index, 3);
            part
        });
        let parts: Vec<_> = parts.collect();
        assert_eq!(
            parts.iter().map(|part| part.evaluations).sum::<usize>(),
            100
        );
        assert_eq!(parts.iter().map(|part| part.modes.len()).sum::<usize>(), 8);
        assert_ne!(parts[0].seed, parts[1].seed);
        let mut many = whole.clone();
        many.take_part(8, 9);
        assert_eq!(many.modes, whole.modes);
    }
}
