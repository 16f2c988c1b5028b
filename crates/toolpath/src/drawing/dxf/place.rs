//! Places in the plane: from the frame of a block to that of the drawing.

/// Affine map of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Affine {
    /// Images of the axes.
    axes: [[f64; 2]; 2],
    /// Image of the zero point.
    zero: [f64; 2],
}

impl Affine {
    /// Map that multiplies lengths by `factor`.
    pub(super) fn scale(factor: f64) -> Self {
        Self {
            axes: [[factor, 0.0], [0.0, factor]],
            zero: [0.0; 2],
        }
    }

    /// Map that mirrors x.
    pub(super) fn mirror_x() -> Self {
        Self {
            axes: [[-1.0, 0.0], [0.0, 1.0]],
            zero: [0.0; 2],
        }
    }

    /// Map that scales along the axes, turns by `angle` (rad), and moves.
    pub(super) fn new(scales: [f64; 2], angle: f64, zero: [f64; 2]) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self {
            axes: [
                [scales[0] * cos, scales[0] * sin],
                [-scales[1] * sin, scales[1] * cos],
            ],
            zero,
        }
    }

    /// Image of a point.
    pub(super) fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [along, across] = self.axes;
        [0, 1].map(|i| self.zero[i] + x * along[i] + y * across[i])
    }

    /// Map that does `first`, and then this one.
    pub(super) fn after(&self, first: &Self) -> Self {
        let zero = self.point(first.zero);
        let image = |axis: [f64; 2]| {
            let [along, across] = self.axes;
            [0, 1].map(|i| axis[0] * along[i] + axis[1] * across[i])
        };
        Self {
            axes: first.axes.map(image),
            zero,
        }
    }

    /// Sense of circles: 1 or -1 where they stay circles, none where they become ellipses.
    pub(super) fn circle_sense(&self) -> Option<f64> {
        let [[a, b], [c, d]] = self.axes;
        let size = a.abs() + b.abs() + c.abs() + d.abs();
        let near = |difference: f64| difference.abs() <= 1e-9 * size;
        match () {
            () if near(a - d) && near(b + c) => Some(1.0),
            () if near(a + d) && near(b - c) => Some(-1.0),
            () => None,
        }
    }
}
