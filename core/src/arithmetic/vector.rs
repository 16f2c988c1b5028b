//! The operations on plane vectors that the whole pipeline is made of.

use super::WideArithmetic;
use nalgebra::Vector2;

/// Scalar product a . b.
#[inline(always)]
pub fn dot<N: WideArithmetic>(a: Vector2<N>, b: Vector2<N>) -> N {
    N::dot_of(&a, &b)
}

/// Plane cross product a x b = ax by - ay bx, positive when b lies counter-clockwise of a.
#[inline(always)]
pub fn cross<N: WideArithmetic>(a: Vector2<N>, b: Vector2<N>) -> N {
    N::cross_of(&a, &b)
}

/// Scalar product a . b, not rounded.
#[inline(always)]
pub fn sum_dot<N: WideArithmetic>(a: Vector2<N>, b: Vector2<N>) -> N::Sum {
    N::sum_dot_of(&a, &b)
}

/// Plane cross product a x b, not rounded.
#[inline(always)]
pub fn sum_cross<N: WideArithmetic>(a: Vector2<N>, b: Vector2<N>) -> N::Sum {
    N::sum_cross_of(&a, &b)
}

/// `v` turned by +90 degrees (E v in the documentation).
#[inline(always)]
pub fn perpendicular<N: WideArithmetic>(v: Vector2<N>) -> Vector2<N> {
    Vector2::new(-v.y, v.x)
}
