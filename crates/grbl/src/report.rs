//! Status report, `<...>`.

use crate::input::RECEIVE_BUFFER;
use crate::settings::Settings;
use crate::state::State;
use crate::view::{ContactsView, MachineView};
use trirrr_toolpath::ToolPlace;
use trirrr_toolpath::gcode::LaserMode;

/// Reports from one with the work offset, or the overrides, to the next.
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

/// State of the tool, as the program has it: `S` for M3 and `C` for M4 of GRBL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Accessory(pub(crate) LaserMode);

/// Content of a report beside the machine.
pub(crate) struct ReportContent {
    pub(crate) state: State,
    /// Zero of the active coordinate system in the fixed frame.
    pub(crate) zero: ToolPlace,
    pub(crate) free_bytes: usize,
    pub(crate) overrides: Overrides,
    pub(crate) accessory: Accessory,
}

/// Fields that a report has where they have changed, and else now and then.
#[derive(Debug, Default)]
pub(crate) struct Reporter {
    zero: Seldom<ToolPlace>,
    overrides: Seldom<(Overrides, Accessory)>,
}

/// Value as it was reported last, with the reports since.
#[derive(Debug)]
struct Seldom<T>(Option<(T, u32)>);

impl<T> Default for Seldom<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<T: Copy + PartialEq> Seldom<T> {
    /// Returns true if this report has the value.
    fn is_due(&mut self, value: T) -> bool {
        match &mut self.0 {
            Some((shown, since)) if *shown == value && *since + 1 < SELDOM => {
                *since += 1;
                false
            }
            shown => {
                *shown = Some((value, 0));
                true
            }
        }
    }
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
fn less(a: ToolPlace, b: ToolPlace) -> ToolPlace {
    let ToolPlace {
        position_m: [x, y],
        alpha_rad,
    } = b;
    plus(
        a,
        ToolPlace {
            position_m: [-x, -y],
            alpha_rad: -alpha_rad,
        },
    )
}

/// Sum of two places.
pub(crate) fn plus(a: ToolPlace, b: ToolPlace) -> ToolPlace {
    let ([x, y], [bx, by]) = (a.position_m, b.position_m);
    ToolPlace {
        position_m: [x + bx, y + by],
        alpha_rad: a.alpha_rad + b.alpha_rad,
    }
}

impl Reporter {
    /// The report, with its end of line.
    pub(crate) fn report(
        &mut self,
        view: &MachineView,
        settings: &Settings,
        content: &ReportContent,
    ) -> String {
        let inches = settings.inches;
        let mut text = format!("<{}", content.state);
        let (name, place) = match settings.report & 1 {
            1 => ("MPos", view.place),
            _ => ("WPos", less(view.place, content.zero)),
        };
        text += &format!("|{name}:{}", axes(place, inches));
        if settings.report & 2 != 0 {
            let free = content.free_bytes.min(RECEIVE_BUFFER);
            text += &format!("|Bf:{},{free}", view.free);
        }
        let feed = view.speed_m_s * 60.0 * if inches { 1000.0 / 25.4 } else { 1000.0 };
        let power = view.power * settings.full_power;
        text += &format!("|FS:{feed:.0},{power:.0}");
        text += &pins(view);
        if self.zero.is_due(content.zero) {
            text += &format!("|WCO:{}", axes(content.zero, inches));
        }
        if self
            .overrides
            .is_due((content.overrides, content.accessory))
        {
            let Overrides { feed, rapid, power } = content.overrides;
            text += &format!("|Ov:{feed},{rapid},{power}");
            text += match content.accessory.0 {
                LaserMode::Off => "",
                LaserMode::Constant => "|A:S",
                LaserMode::FollowsSpeed => "|A:C",
            };
        }
        text + ">\r\n"
    }
}

/// Contacts that are active: P for the probe, X, Y, Z for the limit switches of the motors 1, 2, 3, D for the door.
fn pins(view: &MachineView) -> String {
    let ContactsView {
        door,
        probe,
        limits: [x, y, z],
    } = view.contacts;
    let pins = [('P', probe), ('X', x), ('Y', y), ('Z', z), ('D', door)];
    let active: String = pins
        .iter()
        .filter(|(_, is)| *is)
        .map(|(pin, _)| *pin)
        .collect();
    match active.as_str() {
        "" => active,
        active => format!("|Pn:{active}"),
    }
}
