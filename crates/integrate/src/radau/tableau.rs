//! The numbers of the method (Hairer and Wanner, *Solving Ordinary Differential Equations II*, IV.8).

use crate::dense::SQRT_6;
use crate::system::Matrix;
use nalgebra::Complex;

/// Weights of the stages in the estimate of the error.
pub(super) const ESTIMATE: [f64; 3] = [
    -(13.0 + 7.0 * SQRT_6) / 3.0,
    (-13.0 + 7.0 * SQRT_6) / 3.0,
    -1.0 / 3.0,
];
/// Eigenvalues of the inverse of the method's matrix: one real, and a pair of complex ones.
pub(super) const REAL: f64 = 3.637_834_252_744_496;
pub(super) const COMPLEX: Complex<f64> = Complex::new(2.681_082_873_627_752, 3.050_430_199_247_411);
/// Eigenvectors of the inverse of the method's matrix, which split its equations.
pub(super) const JOIN: Matrix<3> = [
    [
        0.091_232_394_870_892_94,
        -0.141_255_295_020_954_2,
        -0.030_029_194_105_147_424,
    ],
    [
        0.241_717_932_707_107,
        0.204_129_352_293_799_93,
        0.382_942_112_757_261_9,
    ],
    [0.966_048_182_615_093, 1.0, 0.0],
];
/// The inverse of [`JOIN`].
pub(super) const SPLIT: Matrix<3> = [
    [
        4.325_579_890_063_155,
        0.339_199_251_815_809_87,
        0.541_770_539_935_874_9,
    ],
    [
        -4.178_718_591_551_905,
        -0.327_682_820_761_062_4,
        0.476_623_554_500_550_44,
    ],
    [
        -0.502_872_634_945_786_9,
        2.571_926_949_855_605,
        -0.596_039_204_828_224_9,
    ],
];
