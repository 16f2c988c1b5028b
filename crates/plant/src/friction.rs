//! Friction of a revolute joint: viscous, and Coulomb's with a region around rest in which it
//! grows smoothly.
//!
//! ```text
//! moment = b w + c s (3 - s^2) / 2,   s = w / w_stick limited to -1..1
//! ```
//! The moment and its slope are continuous at the edge of the region. Inside, a joint "sticks": it
//! creeps at a rate below w_stick as long as the load stays below c. The regions are modes, so that
//! each formula is smooth as far as a method may look; the events at the edges switch them.

use crate::scalar::Differentiable;

/// Friction of one joint; zero and absent are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// b, N m s/rad.
    pub viscous: f64,
    /// c, N m.
    pub coulomb: f64,
    /// w_stick, rad/s, positive.
    pub stick: f64,
}

/// Region of a joint's rate w.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Region {
    /// w < -w_stick.
    Backward,
    /// Within the stick region.
    #[default]
    Stick,
    /// w > w_stick.
    Forward,
}

impl Friction {
    /// The region that `rate` lies in.
    pub fn region(&self, rate: f64) -> Region {
        if rate > self.stick {
            Region::Forward
        } else if rate < -self.stick {
            Region::Backward
        } else {
            Region::Stick
        }
    }

    /// Moment against a rotation with `rate`, by the formula of `region`.
    ///
    /// A method may look beyond the region's edge before the event there is located. There the formula
    /// of sticking rises on, to the slope that it has at rest, so that iterations find their way back.
    #[inline(always)]
    pub fn moment<T: Differentiable>(&self, rate: T, region: Region) -> T {
        let coulomb = match region {
            Region::Backward => T::from(-self.coulomb),
            Region::Forward => T::from(self.coulomb),
            Region::Stick => {
                let s = rate * (1.0 / self.stick);
                let shape = if s.value().abs() <= 1.0 {
                    s * (T::from(3.0) - s * s) * 0.5
                } else {
                    let edge = T::from(1.0_f64.copysign(s.value()));
                    edge + (s - edge * 2.0 + T::from(1.0) / s) * 1.5
                };
                shape * self.coulomb
            }
        };
        rate * self.viscous + coulomb
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_and_slope_are_continuous_at_the_edges() {
        let friction = Friction {
            viscous: 0.3,
            coulomb: 2.0,
            stick: 1e-3,
        };
        for (edge, region) in [(1e-3, Region::Forward), (-1e-3, Region::Backward)] {
            let stick = |rate| friction.moment(rate, Region::Stick);
            let slip = |rate| friction.moment(rate, region);
            assert!((stick(edge) - slip(edge)).abs() < 1e-15);
            // The difference of the two formulas is c (1 - s)^2 (2 + s) / 2 near s = 1: of second
            // order, at a thousandth of the region 3e-6.
            let near = edge * 1.001;
            assert!((stick(near) - slip(near)).abs() < 2.0 * 1.6e-6);
        }
    }

    #[test]
    fn friction_never_drives() {
        let friction = Friction {
            viscous: 0.1,
            coulomb: 1.0,
            stick: 0.01,
        };
        for step in -1000..=1000 {
            let rate = f64::from(step) * 1e-4;
            assert!(friction.moment(rate, friction.region(rate)) * rate >= 0.0);
        }
    }
}
