//! Placement of the sliders of a kinematically redundant machine: the positions, held over a whole
//! path, at which the machine stays furthest from its singularities.
//!
//! The search maximises the smallest of all scale-free distances, serial of every leg and parallel,
//! over the poses of the path. That function has ridges, so the search uses no derivatives. It
//! starts on a grid over the travels, then takes steps from the best points of the grid to all
//! neighbours, and halves the steps whenever no neighbour is better. The result is a maximum among its neighbours;
//! that no better one lies between the points of the grid is not proved.

use crate::redundant::RedundantMachine;
use thiserror::Error;
use trirrr_core::setpoint::Pose;

/// Points that the grid may have, all sliders together.
const GRID: usize = 4096;
/// Points of the grid from which the search goes on.
const STARTS: usize = 8;
/// Steps are halved down to this part of a travel.
const FINEST: f64 = 1e-5;

/// Range of a slider, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel {
    /// The lowest position.
    pub low_m: f64,
    /// The highest.
    pub high_m: f64,
}

/// Best placement found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement<const LEGS: usize> {
    /// Position of each leg's slider, m; 0 for a leg without one.
    pub sliders_m: [f64; LEGS],
    /// The smallest scale-free distance to a singularity on the path.
    pub distance: f64,
    /// The pose of the path where it is reached.
    pub pose: usize,
    /// Placements that were looked at.
    pub looked_at: usize,
}

/// Reason why there is no placement.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum PlacementError {
    /// There is no pose.
    #[error("the path holds no pose")]
    EmptyPath,
    /// There is nothing to place.
    #[error("no leg has a travel")]
    NoTravel,
    /// A travel is not an interval.
    #[error("the travel of leg {} runs from {low_m} to {high_m} m", leg + 1)]
    Travel {
        /// The leg, from 0.
        leg: usize,
        /// Its lowest position.
        low_m: f64,
        /// Its highest.
        high_m: f64,
    },
    /// No placement on the grid reaches the whole path.
    #[error("none of {looked_at} placements reaches every pose; the best fails at pose {pose}")]
    Unreachable {
        /// Placements that were looked at.
        looked_at: usize,
        /// The furthest pose, counted from 0, that any of them failed at.
        pose: usize,
    },
}

/// A placement and what it is worth.
#[derive(Clone, Copy)]
struct Rated<const LEGS: usize> {
    sliders: [f64; LEGS],
    distance: f64,
    pose: usize,
}

/// The smallest distance on the path, and the pose it belongs to; the first pose out of reach if
/// there is one.
fn rate<const LEGS: usize>(
    machine: &RedundantMachine<f64, LEGS>,
    path: &[Pose<f64>],
    sliders: &[f64; LEGS],
) -> Result<(f64, usize), usize> {
    let mut least = (f64::INFINITY, 0);
    for (index, pose) in path.iter().enumerate() {
        let distances = machine.distances(pose, sliders).map_err(|_| index)?;
        let smallest = distances
            .serial
            .iter()
            .fold(distances.parallel, |a, &b| a.min(b));
        if smallest < least.0 {
            least = (smallest, index);
        }
    }
    Ok(least)
}

/// The placement of the sliders within `travels` that keeps `path` furthest from singularities. A
/// leg without a travel keeps its slider, if it has one, at 0.
///
/// # Errors
/// [`PlacementError`].
pub fn place<const LEGS: usize>(
    machine: &RedundantMachine<f64, LEGS>,
    path: &[Pose<f64>],
    travels: &[Option<Travel>; LEGS],
) -> Result<Placement<LEGS>, PlacementError> {
    if path.is_empty() {
        return Err(PlacementError::EmptyPath);
    }
    let mut moving = Vec::new();
    for (leg, travel) in travels.iter().enumerate() {
        let Some(Travel { low_m, high_m }) = *travel else {
            continue;
        };
        if !(low_m <= high_m && (high_m - low_m).is_finite()) {
            return Err(PlacementError::Travel { leg, low_m, high_m });
        }
        moving.push((leg, low_m, high_m));
    }
    if moving.is_empty() {
        return Err(PlacementError::NoTravel);
    }

    // As many points per slider as the grid allows, the ends and the middle at least.
    let mut levels = 3;
    while (levels + 2usize).saturating_pow(moving.len() as u32) <= GRID {
        levels += 2;
    }
    let points = levels.pow(moving.len() as u32);
    let mut looked_at = 0;
    let mut furthest = 0;
    let mut look = |sliders: [f64; LEGS]| {
        looked_at += 1;
        match rate(machine, path, &sliders) {
            Ok((distance, pose)) => Some(Rated {
                sliders,
                distance,
                pose,
            }),
            Err(pose) => {
                furthest = furthest.max(pose);
                None
            }
        }
    };

    let mut best: Vec<Rated<LEGS>> = Vec::new();
    for point in 0..points {
        let mut sliders = [0.0; LEGS];
        let mut rest = point;
        for &(leg, low, high) in &moving {
            let part = (rest % levels) as f64 / (levels - 1) as f64;
            sliders[leg] = low + part * (high - low);
            rest /= levels;
        }
        if let Some(rated) = look(sliders) {
            let worse = |other: &Rated<LEGS>| other.distance >= rated.distance;
            best.insert(best.partition_point(worse), rated);
            best.truncate(STARTS);
        }
    }

    // All neighbours at a step: every slider down, left or up.
    let neighbours = 3usize.pow(moving.len() as u32);
    for start in &mut best {
        let mut step = 1.0 / (levels - 1) as f64;
        while step > FINEST {
            let mut better: Option<Rated<LEGS>> = None;
            for neighbour in 0..neighbours {
                let mut sliders = start.sliders;
                let mut rest = neighbour;
                for &(leg, low, high) in &moving {
                    let way = (rest % 3) as f64 - 1.0;
                    sliders[leg] = (sliders[leg] + way * step * (high - low)).clamp(low, high);
                    rest /= 3;
                }
                if sliders == start.sliders {
                    continue;
                }
                let least = better.map_or(start.distance, |better| better.distance);
                better = look(sliders)
                    .filter(|rated| rated.distance > least)
                    .or(better);
            }
            match better {
                Some(better) => *start = better,
                None => step *= 0.5,
            }
        }
    }
    let top = best
        .into_iter()
        .reduce(|a, b| if b.distance > a.distance { b } else { a });
    match top {
        Some(top) => Ok(Placement {
            sliders_m: top.sliders,
            distance: top.distance,
            pose: top.pose,
            looked_at,
        }),
        None => Err(PlacementError::Unreachable {
            looked_at,
            pose: furthest,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::redundant::{RedundantParameters, SliderParameters};
    use nalgebra::Vector2;
    use trirrr_core::machine::{Elbow, LegParameters, LinkParameters, PlatformParameters};

    /// The thesis machine with its first two base joints on the upper side and the third on the
    /// lower one.
    fn machine() -> RedundantMachine<f64, 3> {
        let leg = |x: f64, y: f64, degrees: f64| LegParameters {
            base_m: Vector2::new(x, y),
            proximal_m: 0.2,
            distal_m: 0.2,
            joint_radius_m: 0.02,
            joint_angle_rad: degrees.to_radians(),
            elbow: Elbow::Positive,
            proximal: LinkParameters::default(),
            distal: LinkParameters::default(),
            rotor_inertia_kgm2: 0.0,
        };
        let guide = SliderParameters {
            direction_rad: 0.0,
            mass_kg: 0.5,
        };
        let parameters = RedundantParameters {
            legs: [
                leg(0.0, 0.433, 150.0),
                leg(0.5, 0.433, 30.0),
                leg(0.25, 0.0, 270.0),
            ],
            sliders: [Some(guide); 3],
            platform: PlatformParameters {
                mass_kg: 0.5,
                inertia_kgm2: 0.0025,
                com_m: Vector2::new(0.0, 0.0),
                tool_point_m: Vector2::new(0.0, 0.0),
            },
            gravity_m_s2: Vector2::new(0.0, 0.0),
            wrench_force_n: Vector2::new(0.0, 0.0),
            wrench_torque_nm: 0.0,
        };
        RedundantMachine::build(&parameters).unwrap()
    }

    /// The thesis's move, in 21 poses.
    fn path() -> Vec<Pose<f64>> {
        let pose = |index: i32| {
            let s = f64::from(index) / 20.0;
            let degrees = 9.0 + 3.0 * s;
            Pose::from_f64(0.21 + 0.07 * s, 0.22 + 0.06 * s, degrees.to_radians())
        };
        (0..=20).map(pose).collect()
    }

    fn travel(by: f64) -> Option<Travel> {
        Some(Travel {
            low_m: -by,
            high_m: by,
        })
    }

    #[test]
    fn no_placement_of_a_dense_scan_is_better() {
        let (machine, path) = (machine(), path());
        for travels in [
            [travel(0.15), None, None],
            [travel(0.15), travel(0.1), None],
            [travel(0.1), travel(0.1), travel(0.1)],
        ] {
            let found = place(&machine, &path, &travels).unwrap();
            let at_rest = rate(&machine, &path, &[0.0; 3]).unwrap().0;
            assert!(found.distance > 1.01 * at_rest, "{found:?}, {at_rest}");
            let again = rate(&machine, &path, &found.sliders_m);
            assert_eq!(again, Ok((found.distance, found.pose)));
            let scan = |leg: usize, part: i32| {
                travels[leg].map_or(0.0, |travel| {
                    travel.low_m + (travel.high_m - travel.low_m) * f64::from(part) / 40.0
                })
            };
            let parts = |leg: usize| 0..=(if travels[leg].is_some() { 40 } else { 0 });
            for a in parts(0) {
                for b in parts(1) {
                    for c in parts(2) {
                        let sliders = [scan(0, a), scan(1, b), scan(2, c)];
                        if let Ok((distance, _)) = rate(&machine, &path, &sliders) {
                            assert!(distance <= found.distance + 1e-4, "{sliders:?}: {found:?}");
                        }
                    }
                }
            }
            for (position, travel) in found.sliders_m.iter().zip(travels) {
                let inside = travel.map_or(*position == 0.0, |travel| {
                    (travel.low_m..=travel.high_m).contains(position)
                });
                assert!(inside, "{found:?}");
            }
        }
    }

    #[test]
    fn reaches_what_the_machine_at_rest_does_not() {
        let machine = machine();
        let path: Vec<_> = (0..10)
            .map(|i| Pose::from_f64(0.45 + 0.005 * f64::from(i), 0.25, 0.0))
            .collect();
        assert!(rate(&machine, &path, &[0.0; 3]).is_err());
        let found = place(&machine, &path, &[travel(0.3); 3]).unwrap();
        assert!(found.distance > 0.1, "{found:?}");
    }

    #[test]
    fn says_why_there_is_none() {
        let (machine, path) = (machine(), path());
        assert_eq!(
            place(&machine, &[], &[travel(0.1); 3]),
            Err(PlacementError::EmptyPath)
        );
        assert_eq!(
            place(&machine, &path, &[None; 3]),
            Err(PlacementError::NoTravel)
        );
        let backwards = Travel {
            low_m: 0.1,
            high_m: -0.1,
        };
        let error = place(&machine, &path, &[None, Some(backwards), None]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the travel of leg 2 runs from 0.1 to -0.1 m"
        );
        let far = [path[0], Pose::from_f64(5.0, 5.0, 0.0)];
        let error = place(&machine, &far, &[travel(0.1), None, None]).unwrap_err();
        assert!(
            matches!(error, PlacementError::Unreachable { pose: 1, .. }),
            "{error}"
        );
    }
}
