//! Reader of SVG for the page, in a module of its own: the page needs it with the first drawing alone, and it is an eighth of all code.

use trirrr_toolpath::drawing::read_svg;
use wasm_bindgen::prelude::wasm_bindgen;

/// Drawing as numbers and names, or the reason why there is none.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadDrawing {
    /// Numbers of [`FlatDrawing`](trirrr_toolpath::drawing::FlatDrawing).
    pub numbers: Vec<f64>,
    /// Its names.
    pub names: Vec<String>,
    /// Reason of a refusal.
    pub reason: Option<String>,
    /// Word that is refused, possibly none.
    pub word: String,
    /// Line of the refusal, from 1; 0 without one.
    pub line: u32,
}

/// Reads an SVG file.
#[wasm_bindgen(js_name = readDrawing)]
pub fn read_drawing(text: &str) -> ReadDrawing {
    match read_svg(text) {
        Ok(drawing) => {
            let flat = drawing.flat();
            ReadDrawing {
                numbers: flat.numbers,
                names: flat.names,
                ..ReadDrawing::default()
            }
        }
        Err(fault) => ReadDrawing {
            reason: Some(fault.reason),
            word: fault.word,
            line: fault.line,
            ..ReadDrawing::default()
        },
    }
}
