//! Number of assembly modes by Sturm's theorem in 31 digits, from the sextic in t = tan(alpha / 2): for
//! the tests of this folder. It shares the equation with the search, and none of its arithmetic.

use super::random::Closed;
use std::vec;
use std::vec::Vec;
use trirrr_double_double::DoubleDouble;

type Plane = [DoubleDouble; 2];

fn number(x: f64) -> DoubleDouble {
    DoubleDouble::new(x)
}

fn minus(a: Plane, b: Plane) -> Plane {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Plane, b: Plane) -> DoubleDouble {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Plane, b: Plane) -> DoubleDouble {
    a[0] * b[1] - a[1] * b[0]
}

/// The polynomial 1, t, t^2, ... of (1 + t^2) (constant + cos_part cos alpha + sin_part sin alpha).
fn quadratic(
    constant: DoubleDouble,
    cos_part: DoubleDouble,
    sin_part: DoubleDouble,
) -> Vec<DoubleDouble> {
    vec![
        constant + cos_part,
        sin_part + sin_part,
        constant - cos_part,
    ]
}

fn times(a: &[DoubleDouble], b: &[DoubleDouble]) -> Vec<DoubleDouble> {
    let mut product = vec![number(0.0); a.len() + b.len() - 1];
    for (i, &x) in a.iter().enumerate() {
        for (j, &y) in b.iter().enumerate() {
            product[i + j] = product[i + j] + x * y;
        }
    }
    product
}

/// The sextic of the machine, with its parameters and angles as they are.
fn sextic(case: &Closed) -> Vec<DoubleDouble> {
    let place = |length: f64, angle: f64| {
        let (sin, cos) = number(angle).sin_cos();
        [number(length) * cos, number(length) * sin]
    };
    let legs = &case.parameters.legs;
    let elbow = |leg: usize| {
        let [x, y] = place(legs[leg].proximal_m, case.angles[leg]);
        [
            number(legs[leg].base_m.x) + x,
            number(legs[leg].base_m.y) + y,
        ]
    };
    let joint = |leg: usize| place(legs[leg].joint_radius_m, legs[leg].joint_angle_rad);
    let l_sq = |leg: usize| number(legs[leg].distal_m) * number(legs[leg].distal_m);
    let e = [1, 2].map(|leg| minus(joint(leg), joint(0)));
    let b = [1, 2].map(|leg| minus(elbow(leg), elbow(0)));
    // R e_i . b_j and R e_i x b_j, by their parts in cosine and sine.
    let product = |i: usize, j: usize| {
        let constant = dot(e[i], e[j]) + dot(b[i], b[j]);
        let cos_part = dot(e[i], b[j]) + dot(e[j], b[i]);
        let sin_part = cross(e[i], b[j]) + cross(e[j], b[i]);
        quadratic(constant, -cos_part, -sin_part)
    };
    let (m11, m12, m22) = (product(0, 0), product(0, 1), product(1, 1));
    let area = quadratic(
        cross(e[0], e[1]) + cross(b[0], b[1]),
        cross(e[1], b[0]) - cross(e[0], b[1]),
        dot(e[0], b[1]) - dot(e[1], b[0]),
    );
    let half = number(0.5);
    let n = |leg: usize, square: &[DoubleDouble]| {
        let difference = l_sq(leg) - l_sq(0);
        vec![
            half * (difference - square[0]),
            -(half * square[1]),
            half * (difference - square[2]),
        ]
    };
    let (n1, n2) = (n(1, &m11), n(2, &m22));
    let one = quadratic(number(1.0), number(0.0), number(0.0));
    let terms = [
        (number(1.0), times(&times(&n1, &n1), &m22)),
        (number(1.0), times(&times(&n2, &n2), &m11)),
        (number(-2.0), times(&times(&n1, &n2), &m12)),
        (-l_sq(0), times(&times(&area, &area), &one)),
    ];
    let mut sum = vec![number(0.0); 7];
    for (factor, term) in terms {
        for (sum, term) in sum.iter_mut().zip(term) {
            *sum = *sum + factor * term;
        }
    }
    sum
}

/// The negated remainder of a / b.
fn next(a: &[DoubleDouble], b: &[DoubleDouble]) -> Vec<DoubleDouble> {
    let mut rest = a.to_vec();
    while rest.len() >= b.len() {
        let factor = rest[rest.len() - 1] / b[b.len() - 1];
        let shift = rest.len() - b.len();
        for (i, &of_b) in b.iter().enumerate() {
            rest[shift + i] = rest[shift + i] - factor * of_b;
        }
        rest.pop();
    }
    let largest = rest
        .iter()
        .fold(0.0, |largest: f64, c| largest.max(c.value().abs()));
    // Scaled, so that no chain leaves the range.
    let scale = number(-1.0 / largest);
    rest.into_iter().map(|c| c * scale).collect()
}

/// The number of modes; all roots have to be simple.
pub(super) fn modes(case: &Closed) -> usize {
    let f = sextic(case);
    let slope: Vec<_> = (1..f.len()).map(|i| f[i] * number(i as f64)).collect();
    let mut chain = vec![f, slope];
    while chain[chain.len() - 1].len() > 1 {
        let rest = next(&chain[chain.len() - 2], &chain[chain.len() - 1]);
        chain.push(rest);
    }
    // The signs at plus and minus infinity.
    let changes = |negative: bool| {
        let signs = chain.iter().map(|polynomial| {
            let odd = polynomial.len() % 2 == 0;
            (polynomial[polynomial.len() - 1].value() > 0.0) ^ (negative && odd)
        });
        let signs: Vec<bool> = signs.collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    };
    changes(true) - changes(false)
}
