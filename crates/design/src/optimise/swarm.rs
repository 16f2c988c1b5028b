//! Swarms and simplices over a space, on argmin's solvers; and the log that they share.

use super::plan::{SearchPlan, SearchWatch};
use super::{Appraisal, DesignPoint, Objective, StudyMode};
use argmin::core::PopulationState;
use argmin::core::{
    CostFunction, Error, IterState, Problem, SendAlias, Solver, State, SyncAlias, TerminationStatus,
};
use argmin::solver::neldermead::NelderMead;
use argmin::solver::particleswarm::{Particle, ParticleSwarm};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;
use std::borrow::Borrow;
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::sync::atomic::Ordering;

/// Cost of a candidate that is not looked at any more.
const UNSEEN: f64 = f64::MAX;

/// Largest part of a range by which a particle moves at first.
const FIRST_STEP: f64 = 0.2;

/// Spread of the costs at the corners of a simplex below which it has arrived.
const ARRIVED: f64 = 1e-10;

/// Quantity that a solver makes small.
#[derive(Clone, Copy, Debug)]
pub(super) enum SearchTarget {
    /// Cost of an objective.
    Least(usize),
    /// Cost of the second objective, where that of the first is at most this.
    Within(f64),
}

impl SearchTarget {
    /// Fitness of a candidate, less is better: less than 1 where it does the job and keeps what the target asks for, from 1 to 2 where it
    /// does the job, and more the farther it is from doing it.
    pub(super) fn fitness(self, each: &Appraisal, objectives: &[Objective]) -> f64 {
        let squashed = |value: f64| value / (1.0 + value.abs());
        let found = match &each.found {
            Ok(found) => found,
            Err(fault) => return 2.0 + squashed(fault.shortfall),
        };
        let cost = |index: usize| objectives[index].cost(found[index]);
        match self {
            Self::Least(index) => squashed(cost(index)),
            Self::Within(most) if cost(0) > most => {
                let scale = most.abs().max(f64::MIN_POSITIVE);
                1.0 + squashed((cost(0) - most) / scale)
            }
            Self::Within(_) => squashed(cost(1)),
        }
    }
}

type PointKey = (Option<String>, Vec<u64>);

/// All candidates that were looked at, in order.
pub(super) struct SearchLog<'a> {
    pub(super) plan: &'a SearchPlan<'a>,
    appraise: &'a (dyn Fn(DesignPoint) -> Appraisal + Sync),
    watch: &'a SearchWatch<'a>,
    pub(super) known: RefCell<Vec<Appraisal>>,
    places: RefCell<HashMap<PointKey, usize>>,
    /// Nothing more is to be looked at.
    pub(super) has_ended: Cell<bool>,
}

impl<'a> SearchLog<'a> {
    pub(super) fn new(
        plan: &'a SearchPlan<'a>,
        appraise: &'a (dyn Fn(DesignPoint) -> Appraisal + Sync),
        watch: &'a SearchWatch<'a>,
    ) -> Self {
        Self {
            plan,
            appraise,
            watch,
            known: RefCell::default(),
            places: RefCell::default(),
            has_ended: Cell::new(false),
        }
    }

    pub(super) fn count(&self) -> usize {
        self.known.borrow().len()
    }

    /// Looks at `points`, each of them once, on all cores; the fitness of each for `target`.
    pub(super) fn fitness(&self, points: Vec<DesignPoint>, target: SearchTarget) -> Vec<f64> {
        let keys: Vec<PointKey> = points.iter().map(point_key).collect();
        let mut fresh: Vec<(PointKey, DesignPoint)> = Vec::new();
        for (key, point) in keys.iter().zip(points) {
            let is_known = self.places.borrow().contains_key(key);
            if !is_known && !fresh.iter().any(|(other, _)| other == key) {
                fresh.push((key.clone(), point));
            }
        }
        let room = self.plan.evaluations.saturating_sub(self.count());
        if fresh.len() > room {
            fresh.truncate(room);
            self.has_ended.set(true);
        }
        let is_over = || self.watch.stop.load(Ordering::Relaxed);
        let (appraise, told) = (self.appraise, self.watch.told);
        let looked_at: Vec<Option<Appraisal>> = fresh
            .par_iter()
            .map(|(_, point)| {
                let found = (!is_over()).then(|| appraise(point.clone()));
                told();
                found
            })
            .collect();
        for ((key, _), each) in fresh.into_iter().zip(looked_at) {
            match each {
                Some(each) => {
                    self.places.borrow_mut().insert(key, self.count());
                    self.known.borrow_mut().push(each);
                }
                None => self.has_ended.set(true),
            }
        }
        let (places, known) = (self.places.borrow(), self.known.borrow());
        let objectives = self.plan.objectives;
        let of = |key: &PointKey| {
            let place = places.get(key);
            place.map_or(UNSEEN, |place| target.fitness(&known[*place], objectives))
        };
        keys.iter().map(of).collect()
    }

    /// Parts of the best candidate for `target`, in `mode` or in any, with its mode.
    pub(super) fn best(
        &self,
        target: SearchTarget,
        mode: Option<Option<StudyMode>>,
    ) -> Option<DesignPoint> {
        let known = self.known.borrow();
        let objectives = self.plan.objectives;
        let of_mode = known
            .iter()
            .filter(|each| mode.is_none_or(|mode| each.point.mode == mode));
        let fitness = |each: &&Appraisal| target.fitness(each, objectives);
        let best = of_mode.min_by(|one, other| fitness(one).total_cmp(&fitness(other)));
        best.map(|each| each.point.clone())
    }
}

fn point_key(point: &DesignPoint) -> PointKey {
    let bits = point.values.iter().map(|value| value.to_bits());
    (point.mode.map(|mode| mode.to_string()), bits.collect())
}

/// Fitness over the parts of the ranges, in one mode.
struct SpaceCost<'a> {
    log: &'a SearchLog<'a>,
    mode: Option<StudyMode>,
    target: SearchTarget,
}

impl CostFunction for SpaceCost<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, parts: &Vec<f64>) -> Result<f64, Error> {
        let costs = self.bulk_cost(&[parts])?;
        Ok(costs.first().copied().unwrap_or(UNSEEN))
    }

    /// A generation at once: the log looks at it on all cores.
    fn bulk_cost<P>(&self, params: &[P]) -> Result<Vec<f64>, Error>
    where
        P: Borrow<Vec<f64>> + SyncAlias,
        f64: SendAlias,
        Self: SyncAlias,
    {
        let space = self.log.plan.space;
        let point = |parts: &P| space.point(self.mode, parts.borrow());
        let points = params.iter().map(point).collect();
        Ok(self.log.fitness(points, self.target))
    }
}

type SwarmState = PopulationState<Particle<Vec<f64>, f64>, f64>;

/// Swarm of particles in one mode.
pub(super) struct Swarm<'a> {
    problem: Problem<SpaceCost<'a>>,
    solver: ParticleSwarm<Vec<f64>, f64, Xoshiro256PlusPlus>,
    /// None: the solver failed.
    state: Option<SwarmState>,
}

impl<'a> Swarm<'a> {
    /// Swarm of `count` particles, some of them at `known` parts, the others drawn by `seed`.
    pub(super) fn new(
        log: &'a SearchLog<'a>,
        (mode, target): (Option<StudyMode>, SearchTarget),
        known: &[Vec<f64>],
        count: usize,
        seed: u64,
    ) -> Self {
        let dimensions = log.plan.space.ranges.len();
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        // 53 bits: each number from 0 to 1 that binary64 has evenly spaced.
        let mut draw = || (random.next_u64() >> 11) as f64 * 2.0_f64.powi(-53);
        let mut positions: Vec<Vec<f64>> = known.iter().take(count).cloned().collect();
        while positions.len() < count {
            positions.push((0..dimensions).map(|_| draw()).collect());
        }
        let points = positions
            .iter()
            .map(|parts| log.plan.space.point(mode, parts));
        let costs = log.fitness(points.collect(), target);
        let particles = positions.into_iter().zip(costs).map(|(position, cost)| {
            let velocity = (0..dimensions).map(|_| FIRST_STEP * (2.0 * draw() - 1.0));
            Particle::new(position, cost, velocity.collect())
        });
        let particles: Vec<_> = particles.collect();
        let bounds = (vec![0.0; dimensions], vec![1.0; dimensions]);
        let mut solver = ParticleSwarm::new(bounds, count).with_rng_generator(random);
        let mut problem = Problem::new(SpaceCost { log, mode, target });
        let state = SwarmState::new().population(particles);
        let begun = solver.init(&mut problem, state);
        Self {
            problem,
            solver,
            state: begun.ok().map(|(state, _)| state),
        }
    }

    /// Fitness of the best particle so far.
    pub(super) fn fitness(&self) -> f64 {
        self.state.as_ref().map_or(UNSEEN, SwarmState::get_cost)
    }

    /// Moves all particles once; false: the solver failed.
    pub(super) fn step(&mut self) -> bool {
        let Some(state) = self.state.take() else {
            return false;
        };
        let next = self.solver.next_iter(&mut self.problem, state);
        self.state = next.ok().map(|(state, _)| state);
        self.state.is_some()
    }
}

/// Moves a simplex about the best candidate for `target` until it has arrived, or `end` candidates were looked at.
pub(super) fn refine(log: &SearchLog<'_>, target: SearchTarget, size: f64, end: usize) {
    let Some(best) = log.best(target, None) else {
        return;
    };
    let centre = log.plan.space.parts(&best.values);
    let mut corners = vec![centre.clone()];
    for axis in 0..centre.len() {
        let mut corner = centre.clone();
        // Towards the middle, so that the corner is within the bounds.
        corner[axis] += if corner[axis] > 0.5 { -size } else { size };
        corners.push(corner);
    }
    let rounds = 100 + 60 * centre.len();
    let mut problem = Problem::new(SpaceCost {
        log,
        mode: best.mode,
        target,
    });
    let Ok(mut solver) = NelderMead::new(corners).with_sd_tolerance(ARRIVED) else {
        return;
    };
    let state: IterState<Vec<f64>, (), (), (), (), f64> = IterState::new();
    let Ok((mut state, _)) = solver.init(&mut problem, state) else {
        return;
    };
    for _ in 0..rounds {
        let has_arrived = Solver::<SpaceCost<'_>, _>::terminate(&mut solver, &state)
            != TerminationStatus::NotTerminated;
        if has_arrived || log.has_ended.get() || log.count() >= end {
            return;
        }
        match solver.next_iter(&mut problem, state) {
            Ok((next, _)) => state = next,
            Err(_) => return,
        }
    }
}
