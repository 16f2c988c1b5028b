//! The Scotch yoke: the pin of a crank slides in a slot across a yoke, the yoke along a level
//! fixed guide through the crank's centre. Crank + PPR.

use super::{Crank, DimensionError, fixed_guide, lengths};
use crate::ppr::Ppr;
use crate::{Drive, GuideMotion, LinkMotion, LinkageStatus, SlideMotion};
use nalgebra::Vector2;
use trirrr_core::number::{Arithmetic, Number};

/// Length in m, angle in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// Of the crank.
    pub crank: f64,
    /// Angle from the guide to the slot; a quarter turn gives harmonic motion.
    pub slot_angle: f64,
}

/// A slot that leans by 10 degrees.
pub const SHIPPED: Dimensions = Dimensions {
    crank: 0.1,
    slot_angle: 80.0 * (core::f64::consts::PI / 180.0),
};

/// Coefficients of a Scotch yoke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScotchYoke<N> {
    crank: Crank<N>,
    guide: GuideMotion<N>,
    dyad: Ppr<N>,
}

/// Motion of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// Origin at the centre, x axis towards the pin.
    pub crank: LinkMotion<N>,
    /// Origin where the slot crosses the guide, x axis along the guide.
    pub yoke: LinkMotion<N>,
    /// From the centre to the yoke along the guide.
    pub slide: SlideMotion<N>,
    /// From the guide to the pin along the slot.
    pub pin: SlideMotion<N>,
    /// Distance from the singularity, 0 to 1; the same at all angles.
    pub singularity_distance: N,
}

impl<N: Number> ScotchYoke<N> {
    /// Builds the coefficients.
    ///
    /// # Errors
    /// [`DimensionError`]: also for a slot parallel to the guide.
    pub fn new(dimensions: &Dimensions) -> Result<Self, DimensionError> {
        lengths([("crank", dimensions.crank)])?;
        let (sin, cos) = <f64 as Arithmetic>::sin_cos(dimensions.slot_angle);
        // Below this not even binary64 tells the slot from the guide.
        if !(sin.abs() > 2.0 * f64::EPSILON) {
            return Err(DimensionError {
                name: "slot_angle",
                value: dimensions.slot_angle,
                wanted: "the slot must not be parallel to the guide",
            });
        }
        let origin = Vector2::new(0.0, 0.0);
        Ok(Self {
            crank: Crank::new(origin, dimensions.crank),
            guide: fixed_guide(origin, 0.0),
            // The dyad counts its second slide from the pin, against the slot's direction.
            dyad: Ppr::from_offsets(Vector2::new(-cos, -sin), origin),
        })
    }

    /// The links for the crank driven by `drive`.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn at(&self, drive: &Drive<N>) -> Result<Motion<N>, LinkageStatus> {
        let crank = self.crank.at(drive);
        let dyad = self.dyad.solve(&self.guide, &self.crank.tip(&crank))?;
        Ok(Motion {
            crank,
            yoke: dyad.slider,
            slide: dyad.first_slide,
            pin: dyad.second_slide,
            singularity_distance: dyad.singularity_distance,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_slot_gives_harmonic_motion() {
        let dimensions = Dimensions {
            crank: 0.1,
            slot_angle: core::f64::consts::FRAC_PI_2,
        };
        let linkage = ScotchYoke::<f64>::new(&dimensions).unwrap();
        for k in 0..24 {
            let angle = f64::from(k) * 0.3;
            let drive = Drive {
                angle,
                rate: 2.0,
                acceleration: 0.5,
            };
            let at = linkage.at(&drive).unwrap();
            let (sin, cos) = <f64 as Arithmetic>::sin_cos(angle);
            assert!((at.slide.length - 0.1 * cos).abs() < 1e-16);
            assert!((at.pin.length - 0.1 * sin).abs() < 1e-16);
            assert!((at.slide.rate + 0.2 * sin).abs() < 1e-15);
            assert!((at.slide.acceleration + 0.4 * cos + 0.05 * sin).abs() < 1e-15);
        }
    }

    #[test]
    fn refuses_a_slot_along_the_guide() {
        for slot_angle in [0.0, core::f64::consts::PI, f64::NAN] {
            let dimensions = Dimensions {
                crank: 0.1,
                slot_angle,
            };
            let error = ScotchYoke::<f64>::new(&dimensions).unwrap_err();
            assert_eq!(error.name, "slot_angle");
        }
    }
}
