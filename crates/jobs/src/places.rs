//! Places in the file of a job of what is refused.

use crate::drawing::PlacedDrawing;
use std::fmt;
use trirrr_scene::Unplanned;
use trirrr_toolpath::PathFault;

/// Places in the file of the elements of a path.
pub struct ElementPlaces {
    /// Places of one pass.
    pub places: PlacesIn,
    /// Numbers of elements that each pass through the file has, at least 1.
    pub pass: u32,
    /// Passes.
    pub repeat: u32,
}

/// Places in a file, by the numbers of elements.
pub enum PlacesIn {
    /// Lines of a text.
    Lines,
    /// Shapes of a drawing.
    Drawing(Box<PlacedDrawing>),
    /// Rows of an image, or whatever has names of its own for its elements.
    Named(Box<dyn Fn(u32) -> String>),
}

impl ElementPlaces {
    /// Place in the file of an element, by its number from 1.
    pub fn of(&self, number: u32) -> String {
        let behind = number.saturating_sub(1);
        let (pass, number) = (behind / self.pass + 1, behind % self.pass + 1);
        let place = match &self.places {
            PlacesIn::Drawing(placed) => format!(" {}", placed.drawing.place_of(number)),
            PlacesIn::Named(name) => format!(" {}", name(number)),
            PlacesIn::Lines => number.to_string(),
        };
        match self.repeat {
            1 => place,
            repeat if number == self.pass => format!(" way back after time {pass} of {repeat}"),
            repeat => format!("{place} (time {pass} of {repeat})"),
        }
    }

    /// Line of the file of an element, by its number from 1; none of a file without lines, and of a way back.
    fn line(&self, number: u32) -> Option<u32> {
        let number = number.saturating_sub(1) % self.pass + 1;
        let is_back = self.repeat > 1 && number == self.pass;
        (matches!(self.places, PlacesIn::Lines) && !is_back).then_some(number)
    }

    /// Refusal of a path without a plan, at its place.
    pub fn refusal(&self, error: &Unplanned) -> JobRefusal {
        let number = number(error).map(|number| number + 1);
        let place = number.map(|number| self.of(number) + ":");
        // The size tells a wrong unit, whatever the place.
        let size = match (&self.places, breach(error)) {
            (PlacesIn::Drawing(placed), Some(_)) => placed.extent(),
            _ => None,
        };
        let size = size.map_or(String::new(), |size| format!(" {size};"));
        JobRefusal {
            line: number.and_then(|number| self.line(number)),
            text: format!("{size}{} {error}", place.unwrap_or_default()),
            reason: error.to_string(),
        }
    }
}

/// Refusal of a job's file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobRefusal {
    /// Line of the file, from 1, if it has one.
    pub line: Option<u32>,
    /// Place and reason, to stand behind the name of the file and a colon.
    pub text: String,
    /// The reason alone.
    pub reason: String,
}

impl fmt::Display for JobRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl From<PathFault> for JobRefusal {
    fn from(fault: PathFault) -> Self {
        let reason = PathFault {
            line: 0,
            ..fault.clone()
        };
        Self {
            line: (fault.line > 0).then_some(fault.line),
            text: in_line(&fault),
            reason: reason.to_string(),
        }
    }
}

/// A fault, to stand behind the name of its file and a colon.
pub fn in_line(fault: &PathFault) -> String {
    let space = if fault.line == 0 { " " } else { "" };
    format!("{space}{fault}")
}

/// Number of the element that cannot be planned, from 0.
pub fn number(error: &Unplanned) -> Option<u32> {
    match error {
        Unplanned::Path { number, .. }
        | Unplanned::NoAlpha { number, .. }
        | Unplanned::Dwell { number }
        | Unplanned::LongDwell { number, .. }
        | Unplanned::Levels { number }
        | Unplanned::Tool { number } => Some(*number as u32),
        Unplanned::Machine(_) | Unplanned::Units | Unplanned::Ticks(_) => None,
    }
}

/// Place at which a path cannot be planned, m.
pub fn breach(error: &Unplanned) -> Option<[f64; 2]> {
    match error {
        Unplanned::Path { refusal, .. } | Unplanned::NoAlpha { refusal, .. } => {
            Some(refusal.pose.position.into())
        }
        _ => None,
    }
}
