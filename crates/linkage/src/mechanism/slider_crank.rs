//! The slider-crank: crank A-B, rod B-D, slider D on a straight fixed guide. A is the origin.
//!
//! In its eccentric-disc form the crank is a disc that turns about a point off its centre, and
//! the rod ends in a ring around the disc. The centre of the disc is the tip of a crank as long as
//! the eccentricity, and the rod reaches from there to the slider's pin.

use super::{Crank, DimensionError, branch, finite, fixed_guide, lengths};
use crate::rrp::Rrp;
use crate::{Drive, GuideMotion, LinkMotion, LinkageStatus, SlideMotion};
use nalgebra::Vector2;
use trirrr_core::number::Number;

/// Lengths in m, angle in rad, and the branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// A-B.
    pub crank: f64,
    /// B-D.
    pub rod: f64,
    /// Distance of the guide to the left of A.
    pub offset: f64,
    /// Direction of the guide.
    pub guide_angle: f64,
    /// +1: the slider lies ahead of the crank along the guide.
    pub branch: f64,
}

/// An offset slider-crank on a level guide; rod - crank > offset, so it turns fully.
pub const SHIPPED: Dimensions = Dimensions {
    crank: 0.1,
    rod: 0.35,
    offset: 0.05,
    guide_angle: 0.0,
    branch: 1.0,
};

/// Lengths in m of the eccentric-disc form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EccentricDisc {
    /// From the fixed pivot to the centre of the disc; less than the radius.
    pub eccentricity: f64,
    /// Radius of the disc.
    pub radius: f64,
    /// From the rim of the disc to the slider's pin, along the rod.
    pub rim_to_pin: f64,
}

/// A disc of 60 mm radius, 25 mm off centre: an equivalent crank of 25 mm and rod of 200 mm.
pub const SHIPPED_DISC: EccentricDisc = EccentricDisc {
    eccentricity: 0.025,
    radius: 0.06,
    rim_to_pin: 0.14,
};

/// Coefficients of a slider-crank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderCrank<N> {
    crank: Crank<N>,
    guide: GuideMotion<N>,
    dyad: Rrp<N>,
}

/// Motion of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// Origin at A, x axis towards B.
    pub crank: LinkMotion<N>,
    /// Origin at D, x axis towards B.
    pub rod: LinkMotion<N>,
    /// Origin at D, x axis along the guide.
    pub slider: LinkMotion<N>,
    /// From the foot of A on the guide to D.
    pub slide: SlideMotion<N>,
    /// Distance from the singularity, 0 to 1.
    pub singularity_distance: N,
}

impl EccentricDisc {
    /// The equivalent slider-crank on a level guide through the pivot, slider ahead.
    ///
    /// # Errors
    /// [`DimensionError`]: also when the pivot does not lie within the disc.
    pub fn dimensions(&self) -> Result<Dimensions, DimensionError> {
        lengths([
            ("eccentricity", self.eccentricity),
            ("radius", self.radius),
            ("rim_to_pin", self.rim_to_pin),
        ])?;
        if self.eccentricity >= self.radius {
            return Err(DimensionError {
                name: "eccentricity",
                value: self.eccentricity,
                wanted: "it has to be less than the radius, for the pivot to lie within the disc",
            });
        }
        Ok(Dimensions {
            crank: self.eccentricity,
            rod: self.radius + self.rim_to_pin,
            offset: 0.0,
            guide_angle: 0.0,
            branch: 1.0,
        })
    }
}

impl<N: Number> SliderCrank<N> {
    /// Builds the coefficients.
    ///
    /// # Errors
    /// [`DimensionError`].
    pub fn new(dimensions: &Dimensions) -> Result<Self, DimensionError> {
        lengths([("crank", dimensions.crank), ("rod", dimensions.rod)])?;
        finite([
            ("offset", dimensions.offset),
            ("guide_angle", dimensions.guide_angle),
        ])?;
        branch("branch", dimensions.branch)?;
        let origin = Vector2::new(0.0, 0.0);
        Ok(Self {
            crank: Crank::new(origin, dimensions.crank),
            guide: fixed_guide(origin, dimensions.guide_angle),
            // The offset is the dyad's own: from the foot of A, the joint stands off by it.
            dyad: Rrp::from_offsets(dimensions.rod, 0.0, dimensions.offset, dimensions.branch),
        })
    }

    /// The links for the crank driven by `drive`.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn at(&self, drive: &Drive<N>) -> Result<Motion<N>, LinkageStatus> {
        let crank = self.crank.at(drive);
        let dyad = self.dyad.solve(&self.crank.tip(&crank), &self.guide)?;
        Ok(Motion {
            crank,
            rod: dyad.link,
            slider: dyad.slider,
            slide: dyad.slide,
            singularity_distance: dyad.singularity_distance,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_disc_is_a_slider_crank() {
        let dimensions = SHIPPED_DISC.dimensions().unwrap();
        let linkage = SliderCrank::<f64>::new(&dimensions).unwrap();
        let at = |angle| {
            let drive = Drive {
                angle,
                rate: 10.0,
                acceleration: 0.0,
            };
            linkage.at(&drive).unwrap()
        };
        // Both ends of the stroke, which is twice the eccentricity.
        let (far, near) = (at(0.0), at(core::f64::consts::PI));
        assert!((far.slide.length - 0.225).abs() < 1e-15);
        assert!((near.slide.length - 0.175).abs() < 1e-15);
        assert!(far.slide.rate.abs() < 1e-15);
        // r w^2 (1 + r / l), its value at the far end.
        let acceleration = -0.025 * 100.0 * (1.0 + 0.025 / 0.2);
        assert!((far.slide.acceleration - acceleration).abs() < 1e-14);
    }

    #[test]
    fn the_pivot_lies_within_the_disc() {
        let disc = EccentricDisc {
            eccentricity: 0.07,
            ..SHIPPED_DISC
        };
        assert_eq!(disc.dimensions().unwrap_err().name, "eccentricity");
    }
}
