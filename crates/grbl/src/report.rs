//! Status report, `<...>`.

use crate::input::RECEIVE_BUFFER;
use crate::settings::Settings;
use crate::view::MachineView;
use std::fmt::Write as _;
use trirrr_toolpath::ToolPlace;

/// Reports between two that have work offset and overrides.
const SELDOM: u32 = 10;

/// Overrides, percent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Overrides {
    pub(crate) feed: u8,
    pub(crate) rapid: u8,
    pub(crate) power: u8,
}

impl Overrides {
    pub(crate) const NORMAL: Self = Self {
        feed: 100,
        rapid: 100,
        power: 100,
    };
}

/// Content of a report beside the machine.
pub(crate) struct ReportContent<'a> {
    pub(crate) state: &'a str,
    /// Zero of the active coordinate system in the fixed frame.
    pub(crate) zero: ToolPlace,
    pub(crate) free_bytes: usize,
    pub(crate) overrides: Overrides,
    /// Number of the report.
    pub(crate) count: u32,
}

/// X, Y, Z and A in millimetres, or inches, and degrees. Z is 0: the machine moves in the plane.
pub(crate) fn axes(place: ToolPlace, inches: bool) -> String {
    let [x, y] = place.position_m;
    let (length, digits) = match inches {
        true => (1000.0 / 25.4, 4),
        false => (1000.0, 3),
    };
    let (x, y, a) = (x * length, y * length, place.alpha_rad.to_degrees());
    // No negative zero.
    let [x, y, a] = [x, y, a].map(|value| value + 0.0);
    format!("{x:.digits$},{y:.digits$},0.000,{a:.3}")
}

/// Difference of two places.
pub(crate) fn less(a: ToolPlace, b: ToolPlace) -> ToolPlace {
    let [x, y] = a.position_m;
    let [bx, by] = b.position_m;
    ToolPlace {
        position_m: [x - bx, y - by],
        alpha_rad: a.alpha_rad - b.alpha_rad,
    }
}

/// The report, with its end of line.
pub(crate) fn status(view: &MachineView, settings: &Settings, content: &ReportContent) -> String {
    let inches = settings.inches;
    let mut text = format!("<{}", content.state);
    let position = match settings.report & 1 {
        1 => format!("|MPos:{}", axes(view.place, inches)),
        _ => format!("|WPos:{}", axes(less(view.place, content.zero), inches)),
    };
    text += &position;
    if settings.report & 2 != 0 {
        let free = content.free_bytes.min(RECEIVE_BUFFER);
        // Writing to a String does not fail.
        let _ = write!(text, "|Bf:{},{free}", view.room);
    }
    let feed = view.speed_m_s * 60.0 * if inches { 1000.0 / 25.4 } else { 1000.0 };
    let _ = write!(
        text,
        "|FS:{feed:.0},{:.0}",
        view.power * settings.full_power
    );
    match content.count % SELDOM {
        0 => text += &format!("|WCO:{}", axes(content.zero, inches)),
        1 => {
            let Overrides { feed, rapid, power } = content.overrides;
            text += &format!("|Ov:{feed},{rapid},{power}");
        }
        _ => {}
    }
    text + ">\r\n"
}
