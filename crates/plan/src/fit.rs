//! Fit of quintic moves to a smoothed motion.

use crate::extreme::greater;
use nalgebra::Vector3;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Ends, Pose, Quintics, Segment, Setpoint};

/// Longest move, s.
pub(crate) const LONGEST_S: f64 = 0.128;
/// Part of the largest acceleration by which a move may differ from the motion.
const DIFFERENCE: f64 = 0.005;
/// Instants at which a move is compared.
const INSTANTS: u32 = 8;
/// Margin beyond an excess.
pub(crate) const MARGIN: f64 = 1e-3;

/// A smooth motion in time, in eighths of a tick.
pub(crate) trait Motion<B: Number> {
    /// The setpoint at a time.
    fn at(&self, eighths: u32) -> Setpoint<B>;

    /// Greatest speed of D at a time, m/s, if it is limited.
    fn feed(&self, eighths: u32) -> Option<B>;
}

/// Allowed differences of moves from a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit<B: Number> {
    /// A tick, s.
    pub(crate) period: B::Factor,
    /// Tolerances of D in m and of alpha in rad. Half of them is for the smoothed motion itself.
    pub(crate) tolerances: [B; 2],
    /// From D to a point of the platform whose acceleration counts, m.
    pub(crate) lever: B,
    /// Part of the feed by which a move may be faster than the motion.
    pub(crate) faster: B,
    /// Acceleration that the rounding of poses makes.
    pub(crate) noise: B,
    /// Largest acceleration of the motion.
    pub(crate) largest: B,
}

impl<B: Number> Fit<B> {
    /// Largest difference of the move between `states`, from tick `from` to `to`, in parts of what is allowed.
    pub(crate) fn difference(
        &self,
        motion: &impl Motion<B>,
        [from, to]: [u32; 2],
        states: &[Setpoint<B>; 2],
    ) -> B {
        let ticks = to - from;
        let segment = Segment::new(&ends(states), ticks, self.period);
        let [metres, radians] = self.tolerances;
        let mut most = B::ZERO;
        for instant in 1..INSTANTS {
            let time = from * INSTANTS + ticks * instant;
            let played = segment.at_fraction(B::ratio(instant, INSTANTS));
            let smooth = motion.at(time);
            let off = played.pose.displacement(&smooth.pose);
            let bent = played.acceleration - smooth.acceleration;
            most = greater(most, twice(plane(off)).div(metres));
            most = greater(most, twice(off.z.abs()).div(radians));
            let allowed = B::from_f64(DIFFERENCE) * self.largest + self.noise;
            most = greater(most, size(bent, self.lever).div(allowed));
            if let Some(feed) = motion.feed(time) {
                let faster = plane(played.velocity) - plane(smooth.velocity);
                most = greater(most, faster.div(self.faster * feed));
            }
        }
        most
    }
}

fn twice<B: Number>(value: B) -> B {
    value + value
}

/// Length of the part in the plane.
pub(crate) fn plane<B: Number>(v: Vector3<B>) -> B {
    B::ab_plus_cd(v.x, v.x, v.y, v.y).sqrt()
}

/// Size of an acceleration: that of D, m/s^2, and that of a point about D.
pub(crate) fn size<B: Number>(acceleration: Vector3<B>, lever: B) -> B {
    plane(acceleration) + lever * acceleration.z.abs()
}

/// Ends of the quintic between two states.
pub(crate) fn ends<B: Number>(states: &[Setpoint<B>; 2]) -> Ends<B, Quintics> {
    let [start, end] = states;
    Ends {
        from: start.pose,
        to: end.pose,
        velocities: [start.velocity, end.velocity],
        accelerations: Some([start.acceleration.into(), end.acceleration.into()]),
    }
}

/// The pose without a motion: what is computed at an end of a motion is rounded.
pub(crate) fn rest<B: Number>(pose: Pose<B>) -> Setpoint<B> {
    let zero = Vector3::from([B::ZERO; 3]);
    Setpoint {
        pose,
        velocity: zero,
        acceleration: zero,
    }
}

/// The uniform cubic spline in time with these coefficients, `step` s apart: the setpoint at the part `w` of the way
/// from the second to the third. Its acceleration is an average of that of the poses over two steps.
pub(crate) fn smoothed<B: Number>(poses: [&Pose<B>; 4], w: B, step: B) -> Setpoint<B> {
    let (one, two, half) = (B::ONE, B::ONE + B::ONE, B::HALF);
    let (three, sixth) = (two + one, B::ratio(1, 6));
    let [first, origin, third, last] = poses;
    let [before, after, last] = [first, third, last].map(|other| origin.displacement(other));
    let sum = |weights: [B; 3]| -> Vector3<B> {
        before * weights[0] + after * weights[1] + last * weights[2]
    };
    let v = one - w;
    let way = sum([
        v * v * v * sixth,
        (one + three * w * (one + w - w * w)) * sixth,
        w * w * w * sixth,
    ]);
    let velocity = sum([
        -(half * v * v),
        half + w - (one + half) * w * w,
        half * w * w,
    ]);
    let acceleration = sum([v, one - three * w, w]);
    let per_step = one.div(step);
    Setpoint {
        pose: origin.displaced(way),
        velocity: velocity * per_step,
        acceleration: acceleration * (per_step * per_step),
    }
}
