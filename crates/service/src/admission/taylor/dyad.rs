//! The links of a dyad over an interval, from the motion of its ends.
//!
//! The tick finds r1 and r2 by squares, a root and quotients of the span d. As Taylor models these forget that they are
//! made of one d, and the bounds of r1 and r2 come out several times as wide as d is known. Here they follow from d
//! itself.
//!
//! In the middle let d = a + b with the links a and b. Where d moves by m, r1 moves by v, and r2 by m - v. No link
//! changes its length:
//!
//! ```text
//! a.v = (p - |v|^2) / 2                p = l1^2 - |a|^2
//! b.v = b.m + (|m - v|^2 - q) / 2      q = l2^2 - |b|^2
//! ```
//!
//! a and b are numbers, so p and q are what they are off. With S = a x b, and E v for v turned by +90 degrees:
//!
//! ```text
//! v     =  (b.m / S) E a + c
//! m - v = -(a.m / S) E b - c
//! c     = ((|m - v|^2 - q) E a + (|v|^2 - p) E b) / (2 S)
//! ```
//!
//! Let |v| <= V and |m - v| <= W be assumed, and follow for the right-hand sides. Then, by Brouwer's theorem, there is
//! a v that keeps both: the circles cross there. They cross once on each side of d. Where l1 W + l2 V + V W < |S|,
//! r1 x r2 has the sign of S, so it is the place on the side of a.

use super::{Float, Rough, Roundoffs, TaylorModel, Terms};
use crate::admission::Enclose;
use nalgebra::Vector2;
use trirrr_core::dyad::DyadPosition;
use trirrr_core::number::Arithmetic;

/// Steps of Newton's method to the links in the middle.
const STEPS: u32 = 2;

impl<N: Enclose> TaylorModel<N> {
    /// Replaces r1 and r2 of `links` by narrower bounds, where they are rough and not too far from linear. `d` is the
    /// span, and the squares of the lengths are `l1_sq` and `l2_sq`.
    #[inline(never)]
    pub(in crate::admission) fn narrow(
        links: &mut DyadPosition<Self>,
        d: &Vector2<Self>,
        [l1_sq, l2_sq]: [Float<N>; 2],
    ) {
        let half = <Float<N>>::HALF;
        let [dx, dy] = [d.x.rough(), d.y.rough()];
        let [mut ax, mut ay] = [links.r1.x.middle(), links.r1.y.middle()];
        let mut steps = 0;
        let (bx, by, s, p, q) = loop {
            let (bx, by) = (dx.constant - ax, dy.constant - ay);
            let s = <Float<N>>::ab_minus_cd(ax, by, ay, bx);
            let p = l1_sq - <Float<N>>::ab_plus_cd(ax, ax, ay, ay);
            let q = l2_sq - <Float<N>>::ab_plus_cd(bx, bx, by, by);
            if steps == STEPS {
                break (bx, by, s, p, q);
            }
            steps += 1;
            let per_twice_s = half.div(s);
            let step_x = <Float<N>>::ab_plus_cd(q, ay, p, by) * per_twice_s;
            let step_y = <Float<N>>::ab_plus_cd(q, ax, p, bx) * per_twice_s;
            ax += step_x;
            ay -= step_y;
        };
        let p = p.abs() + Roundoffs::Eight.of::<N>(l1_sq);
        let q = q.abs() + Roundoffs::Eight.of::<N>(l2_sq);
        let (l1, l2) = (l1_sq.sqrt(), l2_sq.sqrt());
        let per_s = <Float<N>>::ONE.div(s);
        let size = per_s.abs();

        // Turns of the links, linear and otherwise.
        let turn1 = <Float<N>>::ab_plus_cd(bx, dx.linear, by, dy.linear) * per_s;
        let turn2 = -(<Float<N>>::ab_plus_cd(ax, dx.linear, ay, dy.linear) * per_s);
        let more1 = <Float<N>>::ab_plus_cd(bx.abs(), dx.error, by.abs(), dy.error) * size;
        let more2 = <Float<N>>::ab_plus_cd(ax.abs(), dx.error, ay.abs(), dy.error) * size;
        let (v, w) = (l1 * (turn1.abs() + more1), l2 * (turn2.abs() + more2));
        let rest = |v: Float<N>, w: Float<N>| {
            half * size * <Float<N>>::ab_plus_cd(l1, w * w + q, l2, v * v + p)
        };
        let twice = rest(v, w);
        let assumed = twice + twice;
        let (v, w) = (v + assumed, w + assumed);
        // A thousandth is far more than rounding, unless the links are nearly in line.
        let with_rounding = |x: Float<N>| x + x * <Float<N>>::ratio(1, 1024);
        let widest = l1 * w + l2 * v + v * w;
        let bent = l1 * l2 * size;
        if !(with_rounding(rest(v, w)) <= assumed
            && with_rounding(widest) * size < <Float<N>>::ONE
            && bent <= <Float<N>>::ratio(1024, 1)
            && s * links.r1_cross_r2.middle() > <Float<N>>::ZERO)
        {
            return;
        }

        // The two factors of c lie between these, -q / 2S and -p / 2S, and twice as much: half of it is known.
        let quarter = half * half;
        let (of_a, of_b) = (quarter * (w * w) * per_s, quarter * (v * v) * per_s);
        let (more_a, more_b) = (of_a.abs() + half * q * size, of_b.abs() + half * p * size);
        let x = -<Float<N>>::ab_plus_cd(of_a, ay, of_b, by);
        let y = <Float<N>>::ab_plus_cd(of_a, ax, of_b, bx);
        let error_x = <Float<N>>::ab_plus_cd(more_a, ay.abs(), more_b, by.abs());
        let error_y = <Float<N>>::ab_plus_cd(more_a, ax.abs(), more_b, bx.abs());
        // Twice the lengths: more than all terms, as often as a result is larger for lying near the line.
        let total = (l1 + l2) * (bent + bent);
        let model = |constant: Float<N>, linear: Float<N>, error: Float<N>| {
            let terms = Terms {
                total,
                width: total,
            };
            let model: Rough<N> = TaylorModel {
                constant,
                linear,
                error,
            };
            model.rounded(terms, Roundoffs::Eight).result()
        };
        links.r1 = Vector2::new(
            model(ax + x, -(turn1 * ay), error_x + more1 * ay.abs()),
            model(ay + y, turn1 * ax, error_y + more1 * ax.abs()),
        );
        links.r2 = Vector2::new(
            model(bx - x, -(turn2 * by), error_x + more2 * by.abs()),
            model(by - y, turn2 * bx, error_y + more2 * bx.abs()),
        );
    }
}
