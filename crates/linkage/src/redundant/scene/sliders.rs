//! Sliders of a scene: guide, travel, limits, place.

use crate::redundant::{SliderParameters, Travel};
use trirrr_scene::read::{Bound, Section};

/// Slider of one leg, as the scene describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RedundantSlider {
    /// Direction in which the position grows, rad.
    pub direction_rad: f64,
    /// Mass of carriage and motor, kg.
    pub mass_kg: f64,
    /// Range of the position.
    pub travel: Travel,
    /// Position at the start of the job, m.
    pub position_m: f64,
    /// The reader has chosen the position.
    pub is_placed: bool,
    /// Limits of the slider's drive.
    pub limits: SliderLimits,
}

/// Limits of the drive of a slider.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SliderLimits {
    /// m/s.
    pub velocity_m_s: Option<f64>,
    /// N.
    pub force_n: Option<f64>,
    /// W.
    pub power_w: Option<f64>,
}

/// Gain of the best placement of the sliders.
#[derive(Clone, Debug, PartialEq)]
pub struct BestPlace {
    /// Least distance to a singularity on the job with the placed sliders in the middle of their travels; none where the
    /// machine does not reach the job there.
    pub before: Option<f64>,
    /// Least distance with the sliders where they are now.
    pub after: f64,
    /// Placements that were looked at.
    pub looked_at: usize,
}

impl RedundantSlider {
    /// Parameters of the guide.
    pub fn parameters(&self) -> SliderParameters {
        SliderParameters {
            direction_rad: self.direction_rad,
            mass_kg: self.mass_kg,
        }
    }

    /// Middle of the travel, m.
    pub(super) fn middle_m(&self) -> f64 {
        0.5 * (self.travel.low_m + self.travel.high_m)
    }

    /// Returns the reason for which `position` is outside of the travel.
    pub(super) fn outside(&self, position: f64) -> Option<String> {
        let Travel { low_m, high_m } = self.travel;
        (!(low_m..=high_m).contains(&position))
            .then(|| format!("is outside of the travel from {low_m:?} to {high_m:?} (m)"))
    }
}

/// Reads `slider` of a leg: `Some(None)` where it is left out.
pub(super) fn read_slider(leg: &Section) -> Option<Option<RedundantSlider>> {
    if !leg.has("slider") {
        return Some(None);
    }
    let section = leg.section("slider")?;
    let direction = section.number("direction_rad", Bound::TwoTurns);
    let mass = section.number("mass_kg", Bound::NotNegative);
    let travel = read_travel(&section);
    let is_placed = match section.has("place") {
        true => section.choice("place", &[("given", false), ("best", true)]),
        false => Some(false),
    };
    let position = match (is_placed, section.has("position_m")) {
        (Some(true), true) => {
            let reason = "place = \"best\" chooses the position: leave one of them out";
            section.refuse("position_m", reason);
            None
        }
        (_, true) => section.number("position_m", Bound::Finite).map(Some),
        (_, false) => Some(None),
    };
    let limits = read_slider_limits(&section);
    let mut slider = RedundantSlider {
        direction_rad: direction?,
        mass_kg: mass?,
        travel: travel?,
        position_m: 0.0,
        is_placed: is_placed?,
        limits: limits?,
    };
    match position? {
        Some(position) => {
            if let Some(reason) = slider.outside(position) {
                section.refuse("position_m", reason);
                return None;
            }
            slider.position_m = position;
        }
        None if slider.is_placed || slider.outside(0.0).is_some() => {
            slider.position_m = slider.middle_m();
        }
        None => {}
    }
    Some(Some(slider))
}

fn read_travel(section: &Section) -> Option<Travel> {
    let [low_m, high_m] = section.numbers::<2>("travel_m", Bound::Finite)?;
    if !(low_m < high_m && (high_m - low_m).is_finite()) {
        let reason = "expected the lowest position, then a higher one (m)";
        section.refuse("travel_m", reason);
        return None;
    }
    Some(Travel { low_m, high_m })
}

fn read_slider_limits(section: &Section) -> Option<SliderLimits> {
    if !section.has("limits") {
        return Some(SliderLimits::default());
    }
    let limits = section.section("limits")?;
    let limit = |key| match limits.has(key) {
        true => limits.number(key, Bound::Positive).map(Some),
        false => Some(None),
    };
    let (velocity, force, power) = (limit("velocity_m_s"), limit("force_n"), limit("power_w"));
    Some(SliderLimits {
        velocity_m_s: velocity?,
        force_n: force?,
        power_w: power?,
    })
}
