//! Candidates that no other one beats.

use super::{Appraisal, Objective};

/// Costs of a candidate: less is better.
fn costs(found: &[f64], objectives: &[Objective]) -> Vec<f64> {
    let both = objectives.iter().zip(found);
    both.map(|(objective, value)| objective.cost(*value))
        .collect()
}

/// Feasible candidates that no other one beats in all objectives, with rising costs of the first; numbers in `all`. Of equal ones the
/// first stays.
pub fn front(all: &[Appraisal], objectives: &[Objective]) -> Vec<usize> {
    let feasible = all.iter().enumerate().filter_map(|(index, each)| {
        let found = each.found.as_ref().ok()?;
        Some((index, costs(found, objectives)))
    });
    let mut sorted: Vec<(usize, Vec<f64>)> = feasible.collect();
    let order = |one: &[f64], other: &[f64]| {
        let pairs = one.iter().zip(other);
        pairs.fold(std::cmp::Ordering::Equal, |order, (one, other)| {
            order.then(one.total_cmp(other))
        })
    };
    sorted.sort_by(|one, other| order(&one.1, &other.1).then(one.0.cmp(&other.0)));
    let mut kept: Vec<(usize, Vec<f64>)> = Vec::new();
    for (index, costs) in sorted {
        let is_beaten = |(_, other): &(usize, Vec<f64>)| {
            other.iter().zip(&costs).all(|(other, own)| other <= own)
        };
        if !kept.iter().any(is_beaten) {
            kept.push((index, costs));
        }
    }
    kept.into_iter().map(|(index, _)| index).collect()
}

/// Candidate of a front beyond which one objective costs much for little of the other: the one that lies farthest before the straight
/// line between the ends, in parts of the front's extent. With one or two candidates, the first.
pub fn knee(all: &[Appraisal], objectives: &[Objective], front: &[usize]) -> Option<usize> {
    let of = |index: &usize| {
        let found = all[*index].found.as_ref().ok()?;
        Some(costs(found, objectives))
    };
    let points: Vec<Vec<f64>> = front.iter().filter_map(of).collect();
    let (first, last) = (points.first()?, points.last()?);
    let before = |costs: &Vec<f64>| {
        let parts = (0..costs.len()).map(|axis| {
            let extent = (last[axis] - first[axis]).abs();
            let least = first[axis].min(last[axis]);
            match extent > 0.0 {
                true => (costs[axis] - least) / extent,
                false => 0.0,
            }
        });
        // On the line the parts sum up to 1.
        1.0 - parts.sum::<f64>()
    };
    let mut best: Option<(f64, usize)> = None;
    for (index, costs) in front.iter().zip(&points) {
        let distance = before(costs);
        if best.is_none_or(|(most, _)| distance > most + 1e-12) {
            best = Some((distance, *index));
        }
    }
    best.map(|(_, index)| index)
}

/// Candidate that a study takes: the best in its one objective, or the knee of its two.
pub fn best(all: &[Appraisal], objectives: &[Objective]) -> Option<usize> {
    knee(all, objectives, &front(all, objectives))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimise::{CandidateFault, DesignPoint};

    fn appraised(values: &[[f64; 2]]) -> Vec<Appraisal> {
        let point = DesignPoint {
            mode: None,
            values: Vec::new(),
        };
        let of = |found: Vec<f64>| Appraisal {
            point: point.clone(),
            found: Ok(found),
        };
        values.iter().map(|pair| of(pair.to_vec())).collect()
    }

    #[test]
    fn a_front_has_what_no_other_candidate_beats() {
        use Objective::{Time, Torque, Workspace};
        let mut all = appraised(&[
            [2.0, 2.0],
            [1.0, 3.0],
            [3.0, 1.0],
            [3.0, 3.0],
            [1.0, 3.0],
            [1.5, 2.0],
        ]);
        all.push(Appraisal {
            point: all[0].point.clone(),
            found: Err(CandidateFault {
                reason: "none".into(),
                shortfall: 1.0,
            }),
        });
        assert_eq!(front(&all, &[Torque, Time]), [1, 5, 2]);
        // More workspace is better.
        assert_eq!(front(&all, &[Workspace, Time]), [2]);
        assert_eq!(best(&all, &[Torque]), Some(1));
        assert_eq!(best(&all[6..], &[Torque]), None);
    }

    #[test]
    fn the_knee_lies_farthest_before_the_line_between_the_ends() {
        use Objective::{Time, Torque};
        let all = appraised(&[[0.0, 10.0], [1.0, 5.0], [2.0, 1.0], [10.0, 0.0]]);
        let objectives = [Torque, Time];
        let found = front(&all, &objectives);
        assert_eq!(knee(&all, &objectives, &found), Some(2));
        assert_eq!(knee(&all, &objectives, &found[..1]), Some(0));
    }
}
