//! Generator of drawings.

use std::fmt::Write;

/// Random numbers, and the drawing that is made of them.
pub(crate) struct Random {
    state: u64,
    ids: u32,
}

const PAINTS: [&str; 14] = [
    "red",
    "#00f",
    "#0f08",
    "rgb(1, 2, 3)",
    "rgb(10 20 30 / 50%)",
    "hsl(120, 50%, 50%)",
    "oklch(60% 0.2 20)",
    "rgba(255,0,0,0)",
    "transparent",
    "none",
    "currentColor",
    "url(#grad)",
    "url(#void)",
    "lab(50% 20 30)",
];

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Self {
            state: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1,
            ids: 0,
        };
        for _ in 0..8 {
            random.next();
        }
        random
    }

    fn next(&mut self) -> u64 {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 7;
        self.state ^= self.state << 17;
        self.state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11
    }

    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    fn chance(&mut self, part: u64) -> bool {
        self.below(part) == 0
    }

    fn number(&mut self, low: f64, high: f64) -> f64 {
        let value = low + (high - low) * self.below(1 << 20) as f64 / f64::from(1 << 20);
        (1e2 * value).round() / 1e2
    }

    fn of<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.below(list.len() as u64) as usize]
    }

    /// Length with a unit, of about so many pixels.
    fn length(&mut self, low: f64, high: f64) -> String {
        let value = self.number(low, high);
        match self.below(8) {
            0 => format!("{}mm", (1e3 * value * 25.4 / 96.0).round() / 1e3),
            1 => format!("{}pt", (1e3 * value * 0.75).round() / 1e3),
            2 => format!("{value}px"),
            3 => format!("{value}%"),
            _ => format!("{value}"),
        }
    }

    /// A whole file.
    pub(crate) fn file(&mut self) -> String {
        let view = match self.below(4) {
            0 => String::new(),
            1 => " viewBox=\"0 0 200 150\"".into(),
            2 => " viewBox=\"-20 -30 180 240\"".into(),
            _ => " viewBox=\"500000 5400000 200 150\"".into(),
        };
        let aspect = match self.below(4) {
            0 => format!(
                " preserveAspectRatio=\"{}\"",
                self.of(&["none", "xMinYMax slice", "xMaxYMid", "xMidYMin meet"])
            ),
            _ => String::new(),
        };
        let shift = match view.contains("500000") {
            true => "<g transform=\"translate(500000 5400000)\">",
            false => "<g>",
        };
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\"{view}{aspect} color=\"#123456\">",
            self.of(&["200", "60mm", "2in", "150pt"]),
            self.of(&["150", "50mm", "300", "10pc"]),
        );
        text += "<style>.a{stroke:red;fill:none} g > .b, #none {stroke:#00f !important} rect.c{fill:none;stroke-width:2px} .d{opacity:0} .e:first-child{stroke:lime}</style>";
        text += "<linearGradient id=\"grad\"><stop stop-color=\"red\"/><stop offset=\"1\" stop-color=\"blue\" stop-opacity=\"0\"/></linearGradient>";
        text += "<linearGradient id=\"void\"><stop stop-opacity=\"0\"/></linearGradient>";
        text += "<symbol id=\"sym\" viewBox=\"0 0 50 40\"><path d=\"M-10 20 L60 20 M5 5 C20 0 30 40 45 35\" fill=\"none\" stroke=\"red\"/></symbol>";
        text += "<defs><g id=\"part\"><path d=\"M0 0 q10 20 30 5 t20 10\" fill=\"none\"/><circle r=\"7\" fill=\"none\"/></g></defs>";
        text +=
            "<clipPath id=\"cr\"><rect x=\"20\" y=\"30\" width=\"90\" height=\"70\"/></clipPath>";
        text += "<clipPath id=\"cc\"><circle cx=\"80\" cy=\"70\" r=\"45\"/><path d=\"M100 60 h80 v60 z\"/></clipPath>";
        text += "<clipPath id=\"cb\" clipPathUnits=\"objectBoundingBox\"><ellipse cx=\".5\" cy=\".5\" rx=\".4\" ry=\".3\"/></clipPath>";
        text += "<clipPath id=\"ce\" transform=\"rotate(10)\"><path fill-rule=\"evenodd\" clip-rule=\"evenodd\" d=\"M10 10h120v100h-120z M40 30h50v50h-50z\"/></clipPath>";
        text += shift;
        for _ in 0..=self.below(4) {
            self.element(&mut text, 0, false);
        }
        text + "</g></svg>"
    }

    fn element(&mut self, text: &mut String, depth: u32, clipped: bool) {
        match self.below(10) {
            0..=2 if depth < 4 => self.group(text, depth, clipped),
            3 => self.copy(text),
            4 if depth < 4 && !clipped => self.viewport(text, depth),
            _ => self.shape(text, clipped),
        }
    }

    fn group(&mut self, text: &mut String, depth: u32, clipped: bool) {
        let mut attributes = self.place(false);
        attributes += &self.look(clipped);
        let mut inner = clipped;
        if !clipped && self.chance(3) {
            let clip = self.of(&["cr", "cc", "ce"]);
            let _ = write!(attributes, " clip-path=\"url(#{clip})\"");
            inner = true;
        }
        let _ = write!(text, "<g{attributes}>");
        for _ in 0..=self.below(3) {
            self.element(text, depth + 1, inner);
        }
        *text += "</g>";
    }

    fn copy(&mut self, text: &mut String) {
        let place = self.place(false);
        let look = self.look(true);
        let (x, y) = (self.number(-20.0, 90.0), self.number(-20.0, 90.0));
        let _ = match self.chance(2) {
            true => write!(
                text,
                "<use href=\"#part\" x=\"{x}\" y=\"{y}\"{place}{look}/>"
            ),
            false => write!(
                text,
                "<use href=\"#sym\" x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"60\"{place}{look}/>",
                self.number(20.0, 90.0)
            ),
        };
    }

    fn viewport(&mut self, text: &mut String, depth: u32) {
        let (x, y) = (self.number(-20.0, 60.0), self.number(-20.0, 60.0));
        let (width, height) = (self.number(50.0, 150.0), self.number(50.0, 150.0));
        let view = self.of(&[
            "",
            " viewBox=\"0 0 100 100\"",
            " viewBox=\"-20 10 150 60\" preserveAspectRatio=\"none\"",
        ]);
        let overflow = self.of(&["", "", " overflow=\"visible\""]);
        let _ = write!(
            text,
            "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"{view}{overflow}>"
        );
        for _ in 0..=self.below(3) {
            self.element(text, depth + 1, true);
        }
        *text += "</svg>";
    }

    /// A transform, as attribute or as style. About the box of a shape alone: that of a group is larger in the browser than all in it.
    fn place(&mut self, of_shape: bool) -> String {
        let (a, b) = (self.number(-30.0, 60.0), self.number(-30.0, 60.0));
        let angle = self.number(-180.0, 180.0);
        let scale = self.number(0.5, 2.0);
        match self.below(12) {
            0 => format!(" transform=\"translate({a} {b}) rotate({angle})\""),
            1 => format!(
                " transform=\"translate({a},{b})scale({scale},{})\"",
                self.number(0.5, 1.5)
            ),
            2 => format!(" transform=\"rotate({angle} {a} {b})\""),
            3 => format!(" transform=\"matrix({scale} .2 -.3 1 {a} {b})\""),
            4 => format!(
                " transform=\"skewX({}) skewY(5)\"",
                self.number(-30.0, 30.0)
            ),
            5 => format!(" style=\"transform:translate({a}px,{b}px) rotate({angle}deg)\""),
            6 => format!(" style=\"transform:rotate({angle}deg);transform-origin:{a}px {b}px\""),
            7 if of_shape => format!(
                " style=\"transform:scale({scale},-1) skewX(10deg);transform-box:fill-box;transform-origin:center\""
            ),
            8 => format!(" style=\"translate:{a}px {b}px;rotate:.1turn;scale:{scale}\""),
            _ => String::new(),
        }
    }

    /// Paints and opacities. Behind clips, nothing is filled.
    fn look(&mut self, clipped: bool) -> String {
        let mut look = String::new();
        if self.chance(3) {
            let _ = write!(look, " stroke=\"{}\"", self.of(&PAINTS));
        }
        if clipped {
            look += " fill=\"none\"";
        } else if self.chance(3) {
            let _ = write!(look, " fill=\"{}\"", self.of(&PAINTS));
        }
        if self.chance(8) {
            let _ = write!(
                look,
                " {}=\"{}\"",
                self.of(&["opacity", "stroke-opacity", "fill-opacity"]),
                self.of(&["0", "0.001", "0.5", "50%", "1"])
            );
        }
        if self.chance(10) {
            let _ = write!(
                look,
                " visibility=\"{}\"",
                self.of(&["hidden", "visible", "collapse"])
            );
        }
        if self.chance(20) {
            look += " display=\"none\"";
        }
        if !clipped && self.chance(6) {
            let _ = write!(look, " class=\"{}\"", self.of(&["a", "b", "c", "d", "a e"]));
        }
        if self.chance(6) {
            let _ = write!(
                look,
                " stroke-dasharray=\"{}\" stroke-dashoffset=\"{}\"",
                self.of(&["10", "5,3", "8 2 4", "none", "20 30"]),
                self.number(-20.0, 20.0)
            );
        }
        look
    }

    fn shape(&mut self, text: &mut String, clipped: bool) {
        let mut attributes = self.place(true);
        attributes += &self.look(clipped);
        if !attributes.contains(" stroke=") && !self.chance(4) {
            let _ = write!(
                attributes,
                " stroke=\"{}\"",
                self.of(&["black", "red", "#00f"])
            );
        }
        if clipped && self.chance(4) && !attributes.contains("transform-box") {
            attributes += " clip-path=\"url(#cb)\"";
        }
        if self.chance(12) {
            let _ = write!(
                attributes,
                " stroke-width=\"{}\"",
                self.of(&["0", "2", "1mm", "1%"])
            );
        }
        self.ids += 1;
        let _ = write!(attributes, " id=\"s{}\"", self.ids);
        let at = [self.length(0.0, 80.0), self.length(0.0, 80.0)];
        let sides = [self.length(5.0, 90.0), self.length(5.0, 90.0)];
        let radii = [self.length(2.0, 30.0), self.length(2.0, 30.0)];
        let _ = match self.below(9) {
            0 => write!(
                text,
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{attributes}/>",
                at[0], at[1], sides[0], sides[1]
            ),
            1 => write!(
                text,
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\"{attributes}/>",
                at[0], at[1], sides[0], sides[1], radii[0]
            ),
            2 => write!(
                text,
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{attributes}/>",
                at[0], at[1], radii[0]
            ),
            3 => write!(
                text,
                "<ellipse cx=\"{}\" cy=\"{}\" rx=\"{}\" ry=\"{}\"{attributes}/>",
                at[0], at[1], radii[0], radii[1]
            ),
            4 => write!(
                text,
                "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{attributes}/>",
                at[0], at[1], sides[0], sides[1]
            ),
            5 => {
                let points: Vec<String> = (0..2 + self.below(4))
                    .map(|_| format!("{},{}", self.number(0.0, 100.0), self.number(0.0, 100.0)))
                    .collect();
                let name = self.of(&["polyline", "polygon"]);
                write!(
                    text,
                    "<{name} points=\"{}\"{attributes}/>",
                    points.join(" ")
                )
            }
            _ => {
                let data = self.path();
                write!(text, "<path d=\"{data}\"{attributes}/>")
            }
        };
    }

    fn path(&mut self) -> String {
        let mut data = format!("M{} {}", self.number(0.0, 100.0), self.number(0.0, 100.0));
        for _ in 0..=self.below(6) {
            let letter = self.of(&[
                "L", "l", "H", "h", "V", "v", "C", "c", "S", "s", "Q", "q", "T", "t", "A", "a",
                "Z", "m", "M",
            ]);
            let count = match letter.to_ascii_uppercase().as_str() {
                "L" | "T" | "M" => 2,
                "H" | "V" => 1,
                "C" => 6,
                "S" | "Q" => 4,
                "A" => 0,
                _ => {
                    data += letter;
                    continue;
                }
            };
            let is_small = letter.chars().all(char::is_lowercase);
            let (low, high) = if is_small {
                (-40.0, 40.0)
            } else {
                (0.0, 100.0)
            };
            data += letter;
            if count == 0 {
                let _ = write!(
                    data,
                    "{} {} {} {} {} ",
                    self.number(5.0, 50.0),
                    self.number(5.0, 50.0),
                    self.number(-90.0, 90.0),
                    self.below(2),
                    self.below(2)
                );
            }
            for _ in 0..if count == 0 { 2 } else { count } {
                let _ = write!(data, "{} ", self.number(low, high));
            }
        }
        // A move at the end draws nothing, and counts for the size of the path in the browser alone.
        while let Some(last) = data.rfind(|letter: char| letter.is_ascii_alphabetic()) {
            if last == 0 || !data[last..].starts_with(['m', 'M']) {
                break;
            }
            data.truncate(last);
        }
        data
    }
}
