//! Colours of number types, the same in every figure.

use trirrr_figures::style::{NUMBERS, RGBColor};
use trirrr_scene::NumberType;

/// Returns the colour of the number type that `name` begins with; none for other things.
pub(crate) fn of_number(name: &str) -> Option<RGBColor> {
    let number = name.split_whitespace().next()?.parse().ok()?;
    let index = NumberType::ALL.iter().position(|each| *each == number)?;
    NUMBERS.get(index).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_type_has_a_colour_of_its_own() {
        let colours = NumberType::ALL.map(|number| of_number(number.name()));
        for (index, colour) in colours.iter().enumerate() {
            assert!(colour.is_some() && !colours[..index].contains(colour));
        }
        assert_eq!(of_number("f32 with links"), of_number("f32"));
        assert_eq!(of_number("RK4"), None);
    }
}
