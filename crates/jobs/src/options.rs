//! Options of a job: what its file leaves open.

use trirrr_toolpath::drawing::{Kerf, Pen, PenKey};
use trirrr_toolpath::gcode::ZWords;
use trirrr_toolpath::{ToolPlace, ToolWork};

/// Zero point of a file, its corners, and what it leaves open. SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct JobOptions {
    /// Zero point of the file in the frame of the machine.
    pub origin: ToolPlace,
    /// Distance by which a corner may be rounded, m; 0: the machine stops at each. `G64 P` of the file goes before it.
    pub corner_m: f64,
    /// S for the full power of the tool.
    pub full_power: f64,
    /// Sense of words of Z.
    pub z: ZWords,
    /// The file is played so many times, one after the other; at least once.
    pub repeat: u32,
    /// Speed, pens and size of a drawing; speed of a table.
    pub drawing: DrawingOptions,
}

impl Default for JobOptions {
    fn default() -> Self {
        Self {
            origin: ToolPlace::default(),
            corner_m: 1e-5,
            full_power: 1000.0,
            z: ZWords::Refused,
            repeat: 1,
            drawing: DrawingOptions::default(),
        }
    }
}

/// Speed, pens and size of a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawingOptions {
    /// Speed along strokes, m/s. A drawing needs it; of a table it is that of rows without one.
    pub speed_m_s: Option<f64>,
    /// Power of the tool along strokes, 0 to 1. None: 1.
    pub power: Option<f64>,
    /// The power is the same at every speed. Else it is in proportion to the true speed.
    pub constant_power: bool,
    /// Pens of colours and layers.
    pub pens: Vec<PenOption>,
    /// Distance of the lines that fill areas, m. None: areas are not filled.
    pub hatch_m: Option<f64>,
    /// Distance of the tool from closed outlines, and leads, on the machine. None: the tool goes along the outlines.
    pub kerf: Option<Kerf>,
    /// Length on the machine of a length 1 in the drawing. None: 1.
    pub scale: Option<f64>,
    /// The drawing goes where the machine has the most room for its shape, and is made smaller where it does not fit.
    pub fit: bool,
    /// Lines and curves that lie on others of their layer and colour are left out.
    pub drop_doubles: bool,
}

impl DrawingOptions {
    /// Pen of the strokes without an own one at `speed_m_s`, and those of colours and layers.
    pub(crate) fn all_pens(&self, speed_m_s: f64) -> (Pen, Vec<(PenKey, Pen)>) {
        let pen = |power: Option<f64>, feed_m_s: f64| Pen {
            feed_m_s,
            work: power.map(|power| ToolWork {
                power,
                follows_speed: !self.constant_power,
            }),
        };
        let own = self.pens.iter().map(|each| {
            let feed_m_s = each.speed_m_s.unwrap_or(speed_m_s);
            (each.key.clone(), pen(each.power, feed_m_s))
        });
        (
            pen(Some(self.power.unwrap_or(1.0)), speed_m_s),
            own.collect(),
        )
    }
}

/// Pen of a colour or a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct PenOption {
    /// The strokes.
    pub key: PenKey,
    /// Power, 0 to 1. None: the strokes are left out.
    pub power: Option<f64>,
    /// Speed along the strokes, m/s. None: that of all strokes.
    pub speed_m_s: Option<f64>,
}
