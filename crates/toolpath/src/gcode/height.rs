//! Height of the tool.

/// Height of the tool, in work coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Height {
    /// Height, m; infinite before the first motion of Z, and at the home place.
    pub(super) z_m: f64,
    /// Height from which G91 counts, m.
    pub(super) base_m: f64,
    pub(super) lowest_m: f64,
    /// The last motion of Z went down.
    pub(super) is_down: bool,
    /// First motion with the tool on at a height from which Z has not gone down: line and height, m.
    pub(super) lit: Option<(u32, f64)>,
}

impl Default for Height {
    fn default() -> Self {
        Self {
            z_m: f64::INFINITY,
            base_m: 0.0,
            lowest_m: f64::INFINITY,
            is_down: false,
            lit: None,
        }
    }
}

impl Height {
    /// Goes to a height. An infinite one is not known.
    pub(super) fn go(&mut self, z_m: f64) {
        if z_m != self.z_m {
            self.is_down = match self.z_m.is_finite() {
                true => z_m < self.z_m,
                // Below the zero point is in the material.
                false => z_m < 0.0,
            };
        }
        self.z_m = z_m;
        if z_m.is_finite() {
            (self.base_m, self.lowest_m) = (z_m, self.lowest_m.min(z_m));
        }
    }

    /// Begins another program at the same height.
    pub(super) fn end_program(&mut self) {
        (self.lowest_m, self.lit) = (self.z_m, None);
    }

    /// The place of the path gets this height (G92, G10 L20).
    pub(super) fn shift_to(&mut self, z_m: f64) {
        let by = z_m - self.base_m;
        self.base_m = z_m;
        self.z_m += by;
        self.lowest_m += by;
        if let Some((_, lit)) = &mut self.lit {
            *lit += by;
        }
    }
}
