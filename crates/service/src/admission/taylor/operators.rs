//! Sums, products and comparisons.
//!
//! The compiler passes what has the layout of C in registers of the FPU, and keeps the rest in memory. So these
//! functions have the calling convention of C. On a board each stands once (size: docs/size.md, rule 3). A host has the room for
//! them where they are used: the calls were a third of a plan there.

use super::{Float, Rough, Roundoffs, TaylorModel, Terms};
use crate::admission::Enclose;
use crate::admission::enclose::Centre;
use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use trirrr_core::number::Arithmetic;

impl<N: Enclose, C: Centre<Float<N>>> TaylorModel<N, C> {
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        let sum = Self {
            constant: self.constant + other.constant,
            linear: self.linear + other.linear,
            error: self.error + other.error,
        };
        sum.rounded_again()
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        let (model, terms) = self.product(other);
        model.rounded(terms, Roundoffs::Three)
    }

    /// a b + c d.
    #[inline(always)]
    fn products(a: Self, b: Self, c: Self, d: Self) -> Self {
        let ((ab, terms_ab), (cd, terms_cd)) = (a.product(b), c.product(d));
        let model = Self {
            constant: ab.constant + cd.constant,
            linear: ab.linear + cd.linear,
            error: ab.error + cd.error,
        };
        let terms = Terms {
            total: terms_ab.total + terms_cd.total,
            width: terms_ab.width + terms_cd.width,
        };
        model.rounded(terms, Roundoffs::Five)
    }

    /// A product whose rounding is not counted yet, with its terms.
    #[inline(always)]
    fn product(self, other: Self) -> (Self, Terms<N>) {
        let (a, b) = (self, other);
        // The term in t^2 lies between 0 and its value at the ends: half of it is known.
        let half_square = <Float<N>>::HALF * (a.linear * b.linear);
        let (middle_a, middle_b) = (a.middle(), b.middle());
        let (linear_a, linear_b) = (a.linear.abs(), b.linear.abs());
        let (size_a, size_b) = (middle_a.abs() + linear_a, middle_b.abs() + linear_b);
        let model = Self {
            constant: a.constant * b.constant + C::exactly(half_square),
            linear: <Float<N>>::ab_plus_cd(middle_a, b.linear, a.linear, middle_b),
            error: half_square.abs()
                + <Float<N>>::ab_plus_cd(size_a + a.error, b.error, size_b, a.error),
        };
        let terms = Terms {
            total: size_a * size_b,
            width: size_a * linear_b + linear_a * size_b,
        };
        (model, terms)
    }

    /// 1 / self. With x = c + d and |d| <= r,
    /// 1 / x = 1 / c - d / c^2 + d^2 / (c^2 x), the last term of the sign of c. None where x may be zero.
    #[inline(always)]
    fn inverse(self) -> Option<Self> {
        let (size, radius) = (self.middle().abs(), self.radius());
        let least = size - (radius + Roundoffs::Eight.of::<N>(size + radius));
        if !(least > <Float<N>>::ZERO) {
            return None;
        }
        let inverse = C::ONE.div(self.constant);
        let near = inverse.nearest();
        let squared = near * near;
        let half_rest = <Float<N>>::HALF * (squared * (radius * radius).div(least));
        let rest_towards = if near > <Float<N>>::ZERO {
            half_rest
        } else {
            -half_rest
        };
        let linear = -(self.linear * squared);
        let model = Self {
            constant: inverse + C::exactly(rest_towards),
            linear,
            error: squared * self.error + half_rest,
        };
        let terms = Terms {
            total: near.abs() + linear.abs() + half_rest,
            width: linear.abs() + half_rest,
        };
        Some(model.rounded(terms, Roundoffs::Eight))
    }

    /// The root of a model that is positive in its middle and nowhere negative.
    ///
    /// With x = c + d, s the root of c, and |d| <= r <= c:
    /// sqrt(x) = s + d / (2 s) - (sqrt(x) - s)^2 / (2 s), where |sqrt(x) - s| is at most
    /// r / (s + (c - r) / s), and 2 / (2 - p) <= 1 + p for p = r / c.
    #[inline(always)]
    fn root(self) -> Self {
        let (middle, radius) = (self.middle(), self.radius());
        let root = self.constant.sqrt();
        let near = root.nearest();
        let half_inverse = <Float<N>>::HALF.div(near);
        let part = radius * half_inverse;
        let proportion = <Float<N>>::ONE + radius.div(middle);
        let size = part * proportion;
        let half_rest = <Float<N>>::HALF * (half_inverse * (size * size));
        let linear = self.linear * half_inverse;
        let model = Self {
            constant: root - C::exactly(half_rest),
            linear,
            error: self.error * half_inverse + half_rest,
        };
        let terms = Terms {
            total: near + linear.abs() + half_rest,
            width: linear.abs() + half_rest,
        };
        model.rounded(terms, Roundoffs::Eight)
    }
}

#[inline(never)]
extern "C" fn precise_sum<N: Enclose>(a: TaylorModel<N>, b: TaylorModel<N>) -> TaylorModel<N> {
    a.plus(b)
}

#[inline(never)]
extern "C" fn precise_product<N: Enclose>(a: TaylorModel<N>, b: TaylorModel<N>) -> TaylorModel<N> {
    a.times(b)
}

#[inline(always)]
fn either_sum<N: Enclose>(a: TaylorModel<N>, b: TaylorModel<N>) -> TaylorModel<N> {
    if a.are_rough(b) {
        a.rough().plus(b.rough()).result()
    } else {
        precise_sum(a, b)
    }
}

#[cfg_attr(target_os = "none", inline(never))]
#[cfg_attr(not(target_os = "none"), inline(always))]
pub(in crate::admission) extern "C" fn sum<N: Enclose>(
    a: TaylorModel<N>,
    b: TaylorModel<N>,
) -> TaylorModel<N> {
    either_sum(a, b)
}

#[cfg_attr(target_os = "none", inline(never))]
#[cfg_attr(not(target_os = "none"), inline(always))]
pub(in crate::admission) extern "C" fn difference<N: Enclose>(
    a: TaylorModel<N>,
    b: TaylorModel<N>,
) -> TaylorModel<N> {
    either_sum(a, -b)
}

#[cfg_attr(target_os = "none", inline(never))]
#[cfg_attr(not(target_os = "none"), inline(always))]
pub(in crate::admission) extern "C" fn product<N: Enclose>(
    a: TaylorModel<N>,
    b: TaylorModel<N>,
) -> TaylorModel<N> {
    if !a.are_rough(b) {
        return precise_product(a, b);
    }
    a.rough().times(b.rough()).result()
}

/// a b + c d.
#[cfg_attr(target_os = "none", inline(never))]
#[cfg_attr(not(target_os = "none"), inline(always))]
pub(in crate::admission) extern "C" fn sum_of_products<N: Enclose>(
    a: TaylorModel<N>,
    b: TaylorModel<N>,
    c: TaylorModel<N>,
    d: TaylorModel<N>,
) -> TaylorModel<N> {
    /// A function of its own, so that the rough way keeps no registers.
    #[inline(never)]
    extern "C" fn precisely<N: Enclose>(
        a: TaylorModel<N>,
        b: TaylorModel<N>,
        c: TaylorModel<N>,
        d: TaylorModel<N>,
    ) -> TaylorModel<N> {
        precise_sum(precise_product(a, b), precise_product(c, d))
    }
    if !(a.are_rough(b) || c.are_rough(d)) {
        return precisely(a, b, c, d);
    }
    <Rough<N>>::products(a.rough(), b.rough(), c.rough(), d.rough()).result()
}

/// a b - c d.
#[cfg_attr(target_os = "none", inline(never))]
#[cfg_attr(not(target_os = "none"), inline(always))]
pub(in crate::admission) extern "C" fn difference_of_products<N: Enclose>(
    a: TaylorModel<N>,
    b: TaylorModel<N>,
    c: TaylorModel<N>,
    d: TaylorModel<N>,
) -> TaylorModel<N> {
    sum_of_products(a, b, -c, d)
}

/// The same, rounded once more.
#[inline(never)]
pub(super) extern "C" fn rounded_again<N: Enclose>(x: TaylorModel<N>) -> TaylorModel<N> {
    x.map(Rough::rounded_again, TaylorModel::rounded_again)
}

/// 1 / x.
#[inline(never)]
pub(in crate::admission) extern "C" fn inverse<N: Enclose>(x: TaylorModel<N>) -> TaylorModel<N> {
    #[inline(never)]
    extern "C" fn precisely<N: Enclose>(x: TaylorModel<N>) -> TaylorModel<N> {
        x.inverse().unwrap_or(TaylorModel::unknown())
    }
    if x.is_rough() {
        match x.rough().inverse() {
            Some(inverse) => inverse.result(),
            None => TaylorModel::unknown(),
        }
    } else {
        precisely(x)
    }
}

/// The root of a model that is positive in its middle and nowhere negative.
#[inline(never)]
pub(in crate::admission) extern "C" fn root<N: Enclose>(x: TaylorModel<N>) -> TaylorModel<N> {
    #[inline(never)]
    extern "C" fn precisely<N: Enclose>(x: TaylorModel<N>) -> TaylorModel<N> {
        x.root()
    }
    if x.is_rough() {
        x.rough().root().result()
    } else {
        precisely(x)
    }
}

impl<N: Enclose> Add for TaylorModel<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        sum(self, other)
    }
}

impl<N: Enclose> Sub for TaylorModel<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        difference(self, other)
    }
}

impl<N: Enclose> Mul for TaylorModel<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        product(self, other)
    }
}

impl<N: Enclose> Neg for TaylorModel<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            constant: -self.constant,
            linear: -self.linear,
            error: self.error,
        }
    }
}

impl<N: Enclose> AddAssign for TaylorModel<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<N: Enclose> SubAssign for TaylorModel<N> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<N: Enclose> MulAssign for TaylorModel<N> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<N: Enclose> PartialOrd for TaylorModel<N> {
    /// The order that holds at all times; `None` where there is no such order.
    #[inline(never)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let difference = *self - *other;
        let middle = difference.middle();
        if difference.least_magnitude() > <Float<N>>::ZERO {
            middle.partial_cmp(&<Float<N>>::ZERO)
        } else if difference.is_zero() {
            Some(Ordering::Equal)
        } else {
            None
        }
    }
}

impl<N: Enclose> PartialEq for TaylorModel<N> {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}
