//! Figures of a linkage over its motion: loops and unknowns, Newton-Raphson, four-bar loops and slider-cranks, swings and strokes.

mod chain;
mod chains;
mod slider_crank;
mod sweep;
mod travel;

pub use chain::{ChainKind, CrankChain, DeadPoint};
pub(super) use travel::turning;
pub use travel::{Travel, Traveller};

use super::description::Linkage;
use super::loads::drive_loads;
use super::loops::{LinkLoop, LoopUnknowns, independent_loops, unknowns};
use super::solve::Solver;
use super::track::Track;
use sweep::{Sweep, finer};

/// Figures of a linkage over its motion.
#[derive(Clone, Debug)]
pub struct LinkageStudy {
    /// Independent loops.
    pub loops: Vec<LinkLoop>,
    /// Unknowns of their vectors: twice as many as loops.
    pub unknowns: LoopUnknowns,
    /// Groups that are solved by Newton-Raphson.
    pub newton: Vec<NewtonFigures>,
    /// Four-bar loops and slider-cranks.
    pub chains: Vec<CrankChain>,
    /// Angles of links that turn, then ways along guides.
    pub travels: Vec<Travel>,
    /// Loads of the drives; empty for a linkage without masses.
    pub loads: Vec<LoadFigures>,
}

/// Load of one drive over the motion: a torque, N m, or along a guide a force, N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadFigures {
    /// Index of the drive.
    pub drive: usize,
    /// Greatest size with its sign, and its time, s.
    pub peak: (f64, f64),
    /// Root mean square over the positions.
    pub rms: f64,
}

/// Newton-Raphson of one group over the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonFigures {
    /// Index in solving order.
    pub group: usize,
    /// Most iterations at one position, and its time, s.
    pub iterations: (u32, f64),
    /// Largest residual of the group's equations, m (rad times the linkage's size), and its time, s.
    pub residual_m: (f64, f64),
}

/// Finds all figures of a track. Without a position there are loops and unknowns alone.
pub fn study(linkage: &Linkage, track: &Track) -> LinkageStudy {
    // Turning points are looked for between positions that are near enough to each other.
    let finer = finer(linkage);
    let finer = finer.as_ref().map(|finer| (finer, super::track(finer)));
    let (of, positions) = match &finer {
        Some((finer, positions)) => (*finer, positions),
        None => (linkage, track),
    };
    let sweep = Sweep::new(of, positions);
    let of_sweep = sweep.as_ref();
    LinkageStudy {
        loops: independent_loops(linkage),
        unknowns: unknowns(linkage),
        newton: newton(linkage, track),
        chains: of_sweep.map_or_else(Vec::new, |sweep| chains::chains(linkage, sweep)),
        travels: of_sweep.map_or_else(Vec::new, |sweep| travel::travels(linkage, sweep)),
        loads: loads(linkage, track),
    }
}

fn newton(linkage: &Linkage, track: &Track) -> Vec<NewtonFigures> {
    let Ok((solver, _)) = Solver::start(linkage) else {
        return Vec::new();
    };
    let groups = linkage.groups.iter().enumerate();
    let iterated = groups.filter(|(_, group)| group.is_iterated());
    let figures = iterated.map(|(group, _)| {
        let mut figures = NewtonFigures {
            group,
            iterations: (0, 0.0),
            residual_m: (0.0, 0.0),
        };
        for position in &track.positions {
            let iterations = position.groups[group].iterations;
            if iterations > figures.iterations.0 {
                figures.iterations = (iterations, position.t);
            }
            let residual = solver.residual(group, position);
            if residual > figures.residual_m.0 {
                figures.residual_m = (residual, position.t);
            }
        }
        figures
    });
    figures.collect()
}

fn loads(linkage: &Linkage, track: &Track) -> Vec<LoadFigures> {
    if !linkage.has_masses() {
        return Vec::new();
    }
    let solved = track.positions.iter();
    let solved: Vec<(f64, Vec<f64>)> = solved
        .filter_map(|position| Some((position.t, drive_loads(linkage, position)?)))
        .collect();
    let figures = (0..linkage.drives.len()).map(|drive| {
        let mut peak = (0.0, 0.0);
        let mut squares = 0.0;
        for (t, loads) in &solved {
            let load: f64 = loads[drive];
            squares += load * load;
            if load.abs() > f64::abs(peak.0) {
                peak = (load, *t);
            }
        }
        LoadFigures {
            drive,
            peak,
            rms: (squares / solved.len().max(1) as f64).sqrt(),
        }
    });
    figures.collect()
}
