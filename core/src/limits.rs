//! Limits of a machine: as a scene gives them ([`LimitParameters`], SI units, `f64`), and as the
//! admission and the tick compare with them ([`Limits`], any number type).

use crate::machine::{BuildError, Quantity};
use crate::number::Number;
use crate::source::ToSource;
use crate::to_source;

/// Limits as a scene gives them. `None`: no limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitParameters {
    /// Largest joint rate of either sign, rad/s.
    pub rate_rad_s: Option<[f64; 3]>,
    /// Largest joint acceleration of either sign, rad/s^2.
    pub acceleration_rad_s2: Option<[f64; 3]>,
    /// Largest torque at the joint of either sign, N m.
    pub torque_nm: Option<[f64; 3]>,
    /// Largest mechanical power of either sign, W.
    pub power_w: Option<[f64; 3]>,
    /// Largest joint jerk of either sign, rad/s^3: rate of change of the acceleration.
    pub jerk_rad_s3: Option<[f64; 3]>,
    /// Least [distance](crate::singularity) of each leg from its serial singularity,
    /// |r1 x r2| / (l1 l2): the sine of the angle between its links.
    pub serial_distance_min: f64,
    /// Least [distance](crate::singularity) of the machine from its parallel singularity,
    /// |det A| over the greatest value it can have.
    pub parallel_distance_min: f64,
}

to_source!(pub [] LimitParameters [] in trirrr_core::limits {
    rate_rad_s,
    acceleration_rad_s2,
    torque_nm,
    power_w,
    jerk_rad_s3,
    serial_distance_min,
    parallel_distance_min,
});

impl LimitParameters {
    /// A joint rate is inversely proportional to this distance.
    pub const SERIAL_DISTANCE_MIN: f64 = 0.01;
    /// A torque is inversely proportional to this distance.
    pub const PARALLEL_DISTANCE_MIN: f64 = 0.01;
}

impl Default for LimitParameters {
    fn default() -> Self {
        Self {
            rate_rad_s: None,
            acceleration_rad_s2: None,
            torque_nm: None,
            power_w: None,
            jerk_rad_s3: None,
            serial_distance_min: Self::SERIAL_DISTANCE_MIN,
            parallel_distance_min: Self::PARALLEL_DISTANCE_MIN,
        }
    }
}

/// Limits in the number type `N`, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<N> {
    /// Largest joint rate of either sign.
    pub rate: Option<[N; 3]>,
    /// Largest joint acceleration of either sign.
    pub acceleration: Option<[N; 3]>,
    /// Largest torque at the joint of either sign.
    pub torque: Option<[N; 3]>,
    /// Largest mechanical power of either sign.
    pub power: Option<[N; 3]>,
    /// Largest joint jerk of either sign.
    pub jerk: Option<[N; 3]>,
    /// Least distance of each leg from its serial singularity.
    pub serial_distance: N,
    /// Least distance of the machine from its parallel singularity.
    pub parallel_distance: N,
}

to_source!(pub [N: ToSource] Limits [N] in trirrr_core::limits {
    rate,
    acceleration,
    torque,
    power,
    jerk,
    serial_distance,
    parallel_distance,
});

impl<N: Number> Limits<N> {
    /// Checks `parameters` and builds the limits.
    ///
    /// # Errors
    /// The first quantity that is refused.
    pub fn build(parameters: &LimitParameters) -> Result<Self, BuildError> {
        let motors = |quantity, values: Option<[f64; 3]>| match values {
            None => Ok(None),
            Some([a, b, c]) => {
                let limit = |leg, value: f64| {
                    let held = N::from_f64(value);
                    let good = held > N::ZERO && held.is_finite();
                    require(good, quantity, Some(leg), value, POSITIVE).map(|()| held)
                };
                Ok(Some([limit(0, a)?, limit(1, b)?, limit(2, c)?]))
            }
        };
        let distance = |quantity, value: f64| {
            let good = (0.0..1.0).contains(&value);
            require(good, quantity, None, value, FRACTION).map(|()| N::from_f64(value))
        };
        Ok(Self {
            rate: motors(Quantity::RateLimit, parameters.rate_rad_s)?,
            acceleration: motors(Quantity::AccelerationLimit, parameters.acceleration_rad_s2)?,
            torque: motors(Quantity::TorqueLimit, parameters.torque_nm)?,
            power: motors(Quantity::PowerLimit, parameters.power_w)?,
            jerk: motors(Quantity::JerkLimit, parameters.jerk_rad_s3)?,
            serial_distance: distance(Quantity::SerialDistance, parameters.serial_distance_min)?,
            parallel_distance: distance(
                Quantity::ParallelDistance,
                parameters.parallel_distance_min,
            )?,
        })
    }

    /// The same in another number type.
    pub fn map<M>(&self, change: impl Fn(N) -> M) -> Limits<M> {
        let motors = |values: Option<[N; 3]>| values.map(|values| values.map(&change));
        Limits {
            rate: motors(self.rate),
            acceleration: motors(self.acceleration),
            torque: motors(self.torque),
            power: motors(self.power),
            jerk: motors(self.jerk),
            serial_distance: change(self.serial_distance),
            parallel_distance: change(self.parallel_distance),
        }
    }
}

const POSITIVE: &str = "a positive number within the range of the number type";
const FRACTION: &str = "0 or more and less than 1";

fn require(
    good: bool,
    quantity: Quantity,
    leg: Option<usize>,
    value: f64,
    expected: &'static str,
) -> Result<(), BuildError> {
    if good {
        Ok(())
    } else {
        Err(BuildError {
            quantity,
            leg,
            value,
            expected,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn build<N: Number>(change: impl Fn(&mut LimitParameters)) -> Result<Limits<N>, BuildError> {
        let mut parameters = LimitParameters::default();
        change(&mut parameters);
        Limits::build(&parameters)
    }

    #[test]
    fn names_what_it_refuses() {
        type Change = fn(&mut LimitParameters);
        let cases: [(Change, Quantity, Option<usize>); 8] = [
            (
                |p| p.rate_rad_s = Some([1.0, 0.0, 1.0]),
                Quantity::RateLimit,
                Some(1),
            ),
            (
                |p| p.acceleration_rad_s2 = Some([-1.0; 3]),
                Quantity::AccelerationLimit,
                Some(0),
            ),
            (
                |p| p.torque_nm = Some([1.0, 1.0, f64::NAN]),
                Quantity::TorqueLimit,
                Some(2),
            ),
            (
                |p| p.power_w = Some([f64::INFINITY; 3]),
                Quantity::PowerLimit,
                Some(0),
            ),
            (
                |p| p.jerk_rad_s3 = Some([1.0, 1.0, 0.0]),
                Quantity::JerkLimit,
                Some(2),
            ),
            // Beyond binary32.
            (
                |p| p.torque_nm = Some([1e39; 3]),
                Quantity::TorqueLimit,
                Some(0),
            ),
            (
                |p| p.serial_distance_min = 1.0,
                Quantity::SerialDistance,
                None,
            ),
            (
                |p| p.parallel_distance_min = -0.1,
                Quantity::ParallelDistance,
                None,
            ),
        ];
        for (change, quantity, leg) in cases {
            let error = build::<f32>(change).expect_err("a bad limit");
            assert_eq!((error.quantity, error.leg), (quantity, leg), "{error}");
        }
    }
}
