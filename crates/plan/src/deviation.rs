//! Distance of moves from the path, everywhere between two instants.

use crate::law::Law;
use crate::path::PathPlace;
use crate::piece::joint;
use crate::run::Run;
use nalgebra::Vector3;
use trirrr_core::setpoint::{Pose, Quintics, Segment};

/// Steps towards the nearest place of the path.
const STEPS: u32 = 12;
/// Step, in tolerances, that is none.
const NEAR: f64 = 1e-2;
/// Distance that may lie between two instants above both, in tolerances.
const BETWEEN: f64 = 0.02;
/// Length of the path between two nearest places, over the way that is played, beyond which they lie on two branches.
const LONGER: f64 = 1.5;
/// Intervals of a move at first.
const INTERVALS: u32 = 16;
/// Halvings of an interval at most.
const HALVINGS: u32 = 12;
/// Largest value of a cubic between four equally spaced places over the largest there.
const CUBIC: f64 = 1.64;

/// A measure of the distance from the path of a run.
pub(crate) struct Deviation<'a> {
    pub(crate) law: &'a Law<'a>,
    /// Allowed differences of x, y and alpha.
    pub(crate) tolerances: Vector3<f64>,
    pub(crate) period_s: f64,
}

/// A move while it is compared.
struct Compared<'a> {
    segment: &'a Segment<f64, Quintics>,
    /// Ticks of its start and its end.
    knots: [f64; 2],
    /// Bound of the second derivative of the distance, in tolerances and s.
    bend: f64,
}

/// A fraction of a move, and how it lies beside the path.
#[derive(Clone, Copy)]
struct Looked {
    part: f64,
    played: Pose<f64>,
    /// The nearest place of the path that was found.
    nearest: PathPlace,
    /// Distance from there, in tolerances.
    distance: f64,
}

/// The larger of the distances in the plane and of alpha.
fn size(v: &Vector3<f64>) -> f64 {
    libm::hypot(v.x, v.y).max(v.z.abs())
}

impl Deviation<'_> {
    /// Largest distance of `segment`, which is played from tick `knots[0]` to `knots[1]`, from the path, in parts of the
    /// tolerances. Anything up to 1 is a bound; beyond it, the largest that was found.
    pub(crate) fn of(&self, segment: &Segment<f64, Quintics>, knots: [f64; 2]) -> f64 {
        let played = (0..=3).map(|third| {
            let state = segment.at_fraction(f64::from(third) / 3.0);
            size(&state.acceleration.component_div(&self.tolerances))
        });
        let compared = Compared {
            segment,
            knots,
            bend: CUBIC * played.fold(0.0, f64::max) + LONGER * LONGER * self.bend(knots),
        };
        let looked = (0..=INTERVALS)
            .map(|interval| self.look(&compared, f64::from(interval) / f64::from(INTERVALS)));
        let looked: Vec<Looked> = looked.collect();
        let intervals = looked.windows(2);
        let largest = intervals.map(|ends| self.between(&compared, [&ends[0], &ends[1]], HALVINGS));
        largest.fold(0.0, f64::max)
    }

    /// The largest distance between two instants of a move.
    fn between(&self, compared: &Compared, [a, b]: [&Looked; 2], halvings: u32) -> f64 {
        let [start, end] = compared.knots;
        let time_s = (b.part - a.part) * (end - start) * self.period_s;
        let most = a.distance.max(b.distance);
        // The difference of two motions rises between two instants by an eighth of its second derivative times the square of
        // the time at most: of the move, and of the plan with a time of its own.
        let rise = 0.125 * compared.bend * time_s * time_s;
        // The nearest place may also jump. No distance changes faster than the place does that is played.
        let way = size(&self.way(&a.played, &b.played)) + rise;
        let is_beside = self.length(a.nearest, b.nearest) <= LONGER * way + BETWEEN;
        let is_near = way <= BETWEEN || a.distance + b.distance + way <= 2.0;
        let passes = is_near || (is_beside && (most + rise <= 1.0 || rise <= BETWEEN));
        if most > 1.0 || passes || halvings == 0 {
            return most;
        }
        let middle = self.look(compared, 0.5 * (a.part + b.part));
        let halves = [[a, &middle], [&middle, b]];
        let [first, second] = halves.map(|half| self.between(compared, half, halvings - 1));
        first.max(second)
    }

    /// Length of the path between two places, in tolerances, or about it: infinite if a piece lies between.
    fn length(&self, a: PathPlace, b: PathPlace) -> f64 {
        let (a, b) = match (a.piece, a.p) <= (b.piece, b.p) {
            true => (a, b),
            false => (b, a),
        };
        let part = |piece: usize, from: f64, to: f64| {
            let first = self.law.pieces()[piece].piece.at(0.5 * (from + to)).first;
            size(&first.component_div(&self.tolerances)) * (to - from)
        };
        match b.piece - a.piece {
            0 => part(a.piece, a.p, b.p),
            1 => part(a.piece, a.p, 1.0) + part(b.piece, 0.0, b.p),
            _ => f64::INFINITY,
        }
    }

    /// From one pose to another, in tolerances.
    fn way(&self, from: &Pose<f64>, to: &Pose<f64>) -> Vector3<f64> {
        from.displacement(to).component_div(&self.tolerances)
    }

    /// Looks for the nearest place of the path at a fraction of a move, from that of the plan on. The path ends where the run does.
    fn look(&self, compared: &Compared, part: f64) -> Looked {
        let [start, end] = compared.knots;
        let mut place = self.law.place(start + part * (end - start));
        let played = compared.segment.at_fraction(part).pose;
        let mut looked = Looked {
            part,
            played,
            nearest: place,
            distance: f64::INFINITY,
        };
        for _ in 0..STEPS {
            let point = self.law.pieces()[place.piece].piece.at(place.p);
            let off = self.way(&point.pose, &played);
            if size(&off) < looked.distance {
                (looked.nearest, looked.distance) = (place, size(&off));
            }
            let along = point.first.component_div(&self.tolerances);
            // A difference along the path is one in time.
            let step = off.dot(&along) / along.dot(&along);
            let next = self.moved(place, step);
            let is_near = (next.p - place.p).abs() * size(&along) <= NEAR;
            if (next.piece == place.piece && is_near) || !step.is_finite() {
                break;
            }
            place = next;
        }
        looked
    }

    /// The place that lies `step` of the parameter on, or back, from `place`.
    fn moved(&self, place: PathPlace, step: f64) -> PathPlace {
        let pieces = self.law.pieces();
        let run = &self.law.run().pieces;
        let PathPlace { mut piece, mut p } = place;
        p += step;
        let scale = |before: usize| {
            joint(&pieces[before].piece, &pieces[before + 1].piece).map_or(1.0, f64::sqrt)
        };
        while p > 1.0 && piece + 1 < run.end {
            p = (p - 1.0) * scale(piece);
            piece += 1;
        }
        while p < 0.0 && piece > run.start {
            piece -= 1;
            p = 1.0 + p / scale(piece);
        }
        PathPlace {
            piece,
            p: p.clamp(0.0, 1.0),
        }
    }

    /// Largest acceleration of the plan between two ticks, in tolerances.
    fn bend(&self, knots: [f64; 2]) -> f64 {
        let run: &Run = self.law.run();
        let mut most: f64 = 0.0;
        for index in self.law.cells(knots) {
            let place = run.places[index];
            let [start, end] = run.ends_of(index);
            let acceleration = run.acceleration(index);
            let piece = &self.law.pieces()[place.piece].piece;
            for (p, square) in [(place.p, start), (place.p + run.cells[index].length(), end)] {
                let point = piece.at(p);
                let bent = point.first * acceleration + point.second * square;
                most = most.max(size(&bent.component_div(&self.tolerances)));
            }
        }
        most
    }
}
