//! Board files: read and checked whole.

use super::chip::{CHIPS, Chip, Family, SerialPort};
use super::clock::Pll;
use super::needs::Needs;
use super::role::{ROLES, Role, RoleEntry};
use std::collections::BTreeMap;
use trirrr_scene::SceneError;
use trirrr_scene::read::{Bound, Document, Place, Section, with_root};

/// Keys that stand before the first table.
const TOP_KEYS: &[&str] = &["description", "chip", "crystal_mhz"];

/// Drives of which an image has one kind: their tables may name the same pins.
const ALTERNATIVES: [&str; 3] = ["stepper", "amplifier", "can"];

/// Longest time that a driver may ask for, us: a slot of the slowest steps.
const LONGEST_US: f64 = 10_000.0;

/// Pin with what the wiring makes of its level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WiredPin {
    /// Name of the pin: `PC0`, `GP6`.
    pub name: String,
    /// Port and number: `PC` and 0.
    pub(super) place: (&'static str, u8),
    /// The wiring inverts the level.
    pub inverted: bool,
}

/// A checked board file.
pub struct BoardFile {
    /// Description in the author's words.
    pub description: String,
    /// The chip.
    pub chip: &'static Chip,
    /// The crystal, MHz.
    pub crystal_mhz: f64,
    pub(super) pll: Pll,
    /// Port of the line, none where that is USB; and port of the log.
    pub(super) line: Option<&'static SerialPort>,
    pub(super) log: &'static SerialPort,
    /// Pins of USB, where the line is USB and the chip has them at a port.
    pub(super) usb: Vec<(&'static str, WiredPin)>,
    pins: BTreeMap<Role, Vec<WiredPin>>,
    /// Pins that parts of the board have, and what for.
    pub taken: Vec<(String, String)>,
}

impl BoardFile {
    /// Reads and checks the board file in `text`. `file` is named in errors. With `firmware` and `needs` the board is one for this
    /// firmware, and has all that the scene needs.
    ///
    /// # Errors
    /// [`SceneError::Refused`] with everything found wrong.
    pub fn parse(
        text: &str,
        file: &str,
        target: Option<(Family, &Needs)>,
    ) -> Result<Self, SceneError> {
        let document = Document::new(text, TOP_KEYS);
        let board = with_root(&document, text, |root| read_board(root, target));
        match board.filter(|_| document.is_clean()) {
            Some(board) => Ok(board),
            None => Err(document.into_error(file)),
        }
    }

    /// The pins of a role, one or one for each motor; none if the board does not name them.
    pub fn pins(&self, role: Role) -> Option<&[WiredPin]> {
        self.pins.get(&role).map(Vec::as_slice)
    }

    /// Returns true if the line is USB.
    pub fn has_usb_line(&self) -> bool {
        self.line.is_none()
    }
}

/// A pin that a key names.
struct Named {
    place: Place,
    pin: WiredPin,
    table: &'static str,
    role: Role,
}

fn read_board(root: &Section, target: Option<(Family, &Needs)>) -> Option<BoardFile> {
    let description = root.optional_text("description").unwrap_or_default();
    let chips = CHIPS.map(|chip| (chip.name, chip));
    let Some(chip) = root.choice("chip", &chips) else {
        // Any pin may be right on the chip that was meant.
        root.ignore_rest();
        return None;
    };
    if let Some((family, _)) = target
        && chip.family != family
    {
        root.refuse("chip", other_chip(chip, family));
        root.ignore_rest();
        return None;
    }
    let crystal = read_crystal(root, chip);
    let taken = read_taken(root, chip);
    let mut tables = BTreeMap::new();
    for entry in &ROLES {
        if !tables.contains_key(entry.table)
            && let Some(section) = root.optional_section(entry.table)
        {
            tables.insert(entry.table, section);
        }
    }
    for (table, reason) in chip.without {
        if let Some(section) = tables.remove(table) {
            section.ignore_rest();
            root.refuse_list(table, format!("must be left out: {reason}"));
        }
    }
    let named_line = read_port(root, &tables, "line", chip);
    let log = read_log(root, &tables, chip);
    let line = named_line.flatten();
    if let (Some(line), Some(log)) = (line, log)
        && line.name == log.name
    {
        tables["log"].refuse("port", "is that of the line: the log has a port of its own");
    }
    let is_usb =
        matches!(named_line, Some(None)) || target.is_some_and(|(_, needs)| needs.usb_line);
    let mut named = Vec::new();
    let mut pins = BTreeMap::new();
    for entry in &ROLES {
        let Some(section) = tables.get(entry.table) else {
            continue;
        };
        // USB has pins of its own: those of the file are left alone.
        if is_usb && entry.table == "line" {
            match named_line {
                Some(None) if section.has(entry.key) => {
                    section.refuse(entry.key, usb_pins(chip));
                }
                _ => _ = section.optional_text(entry.key),
            }
            continue;
        }
        let port = match entry.table {
            "line" => line,
            "log" => log,
            _ => None,
        };
        if let Some(found) = read_pins(section, entry, chip, port) {
            let of_role = found.iter().map(|named| named.pin.clone()).collect();
            pins.insert(entry.role, of_role);
            named.extend(found);
        }
    }
    refuse_twice(root, &named, taken.as_deref().unwrap_or_default());
    if is_usb {
        let needs = target.map(|(_, needs)| needs);
        refuse_beside_usb(
            root,
            &named,
            taken.as_deref().unwrap_or_default(),
            needs,
            chip,
        );
    }
    let times = tables.get("stepper").map(|stepper| {
        TIMES.map(|key| {
            let us = stepper.number(key, Bound::Within(0.0, LONGEST_US));
            us.map(|us| us * 1e-6)
        })
    });
    if let Some((_, needs)) = target {
        refuse_missing(root, &tables, &pins, needs, chip);
        if let (Some(stepper), Some(times)) = (tables.get("stepper"), times) {
            refuse_times(stepper, times, needs, (chip, is_usb));
        }
    }
    let (crystal_mhz, pll) = crystal?;
    Some(BoardFile {
        description: description.into_owned(),
        chip,
        crystal_mhz,
        pll,
        line: named_line?.filter(|_| !is_usb),
        usb: if is_usb {
            pins_of_usb(chip)
        } else {
            Vec::new()
        },
        log: log?,
        pins,
        taken: taken?,
    })
}

/// The reason that refuses a chip of another firmware.
fn other_chip(chip: &Chip, wanted: Family) -> String {
    let same = CHIPS.iter().filter(|chip| chip.family == wanted);
    let same: Vec<String> = same.map(|chip| format!("\"{}\"", chip.name)).collect();
    format!(
        "is a chip of the firmware for the {}, which `{}` builds; `{}` is for {}",
        chip.family.name(),
        chip.family.command(),
        wanted.command(),
        same.join(" or ")
    )
}

/// The crystal, MHz, and what the PLL makes of it.
fn read_crystal(root: &Section, chip: &Chip) -> Option<(f64, Pll)> {
    let clock = chip.family.clock();
    let (least, most) = clock.crystal_hz;
    let mhz = |hz: u32| f64::from(hz) / 1e6;
    let crystal = root.number("crystal_mhz", Bound::Within(mhz(least), mhz(most)))?;
    let hz = (crystal * 1e6).round();
    // Written to the Hz: a rate in a data sheet has no more digits.
    let exact = (crystal * 1e6 - hz).abs() < 1e-3;
    let pll = clock.pll(hz as u32).filter(|_| exact);
    if pll.is_none() {
        root.refuse(
            "crystal_mhz",
            format!(
                "the PLL of {} does not make exactly {} MHz of it; of whole MHz {} would do",
                chip.name,
                mhz(clock.core_hz),
                clock.good_crystals()
            ),
        );
    }
    Some((crystal, pll?))
}

/// `[taken]`: pins that parts of the board have.
fn read_taken(root: &Section, chip: &Chip) -> Option<Vec<(String, String)>> {
    let Some(section) = root.optional_section("taken") else {
        return Some(Vec::new());
    };
    let mut taken = Vec::new();
    for name in section.names() {
        let what = section.text(name)?;
        if chip.pin(name).is_none() {
            section.refuse(name, no_pin(chip));
        }
        taken.push((name.to_owned(), what.into_owned()));
    }
    Some(taken)
}

fn no_pin(chip: &Chip) -> String {
    format!(
        "{} has no such pin; it has {}",
        chip.name,
        chip.pins_in_words()
    )
}

/// The port of the line; `Some(None)` is USB.
fn read_port(
    root: &Section,
    tables: &BTreeMap<&str, Section>,
    table: &str,
    chip: &Chip,
) -> Option<Option<&'static SerialPort>> {
    let ports = chip.serial_ports.iter().map(|port| (port.name, Some(port)));
    read_choice(root, tables, table, ports.chain([("usb", None)]).collect())
}

fn read_log(
    root: &Section,
    tables: &BTreeMap<&str, Section>,
    chip: &Chip,
) -> Option<&'static SerialPort> {
    let ports = chip.serial_ports.iter().map(|port| (port.name, port));
    read_choice(root, tables, "log", ports.collect())
}

fn read_choice<P: Copy>(
    root: &Section,
    tables: &BTreeMap<&str, Section>,
    table: &str,
    ports: Vec<(&'static str, P)>,
) -> Option<P> {
    let Some(section) = tables.get(table) else {
        let ports: Vec<&str> = ports.iter().map(|(name, _)| *name).collect();
        let reason = format!(
            "missing, expected [{table}] with a port of {} and its pins",
            ports.join(", ")
        );
        root.refuse(table, reason);
        return None;
    };
    section.choice("port", &ports)
}

/// Pins of USB with the names of their fields.
fn pins_of_usb(chip: &Chip) -> Vec<(&'static str, WiredPin)> {
    let named = ["usb_minus", "usb_plus"].into_iter().zip(chip.usb.pins);
    let placed = named.filter_map(|(field, name)| {
        let pin = WiredPin {
            name: (*name).into(),
            place: chip.pin(name)?,
            inverted: false,
        };
        Some((field, pin))
    });
    placed.collect()
}

/// The reason that refuses pins of a line over USB.
fn usb_pins(chip: &Chip) -> String {
    match chip.usb.pins {
        [] => format!("must be left out: USB has pins of its own on {}", chip.name),
        pins => format!(
            "must be left out: USB is at {} on {}",
            pins.join(" and "),
            chip.name
        ),
    }
}

/// Refuses functions of the image at the pins of USB, and pins of USB that another part of the board has.
fn refuse_beside_usb(
    root: &Section,
    named: &[Named],
    taken: &[(String, String)],
    needs: Option<&Needs>,
    chip: &Chip,
) {
    let is_usb = |name: &str| chip.usb.pins.contains(&name);
    let is_in_image = |role: Role| {
        let of_scene = |needs: &Needs| needs.roles().contains_key(&role);
        role == Role::LogTransmit || needs.is_none_or(of_scene)
    };
    for other in named.iter().filter(|other| is_usb(&other.pin.name)) {
        if is_in_image(other.role) {
            let reason = format!("{} is that of USB, and the line is USB", other.pin.name);
            root.refuse_at(&other.place, reason);
        }
    }
    // The plug is a part of the board, too.
    let of_others = taken
        .iter()
        .filter(|(name, what)| is_usb(name) && !what.contains("USB"));
    for (name, what) in of_others {
        root.refuse(
            "taken",
            format!("{name} is that of USB, and the line is USB: it is taken by {what}"),
        );
    }
}

/// The pins of a role that its table names. A key that is left out is looked for once it is needed.
fn read_pins(
    section: &Section,
    entry: &RoleEntry,
    chip: &Chip,
    port: Option<&SerialPort>,
) -> Option<Vec<Named>> {
    let is_line = matches!(entry.table, "line" | "log");
    if !section.has(entry.key) && !is_line {
        return None;
    }
    let texts = match entry.count {
        1 => vec![(section.place_of(entry.key), section.text(entry.key)?)],
        count => {
            let texts = section.texts(entry.key)?;
            if entry.is_list && !(1..=count).contains(&texts.len()) {
                let reason = format!("must be 1 to {count} pins, found {}", texts.len());
                section.refuse(entry.key, reason);
                return None;
            }
            if !entry.is_list && texts.len() != count {
                let reason = format!(
                    "must be {count} pins, of motor 1, 2 and 3, found {}",
                    texts.len()
                );
                section.refuse(entry.key, reason);
                return None;
            }
            texts
                .into_iter()
                .map(|(place, text)| (place, text.into()))
                .collect()
        }
    };
    let pins = texts.into_iter().enumerate().map(|(index, (place, text))| {
        let (name, inverted) = match text.strip_prefix('!') {
            Some(name) => (name, true),
            None => (text.as_ref(), false),
        };
        match check_pin(name, inverted, index, entry, chip, port) {
            Ok(place_of_pin) => Some(Named {
                place,
                pin: WiredPin {
                    name: name.to_owned(),
                    place: place_of_pin,
                    inverted,
                },
                table: entry.table,
                role: entry.role,
            }),
            Err(reason) => {
                section.refuse_at(&place, reason);
                None
            }
        }
    });
    // All are looked at before the first refusal counts.
    pins.collect::<Vec<_>>().into_iter().collect()
}

/// Place of the pin, or the reason for which it cannot have the role.
fn check_pin(
    name: &str,
    inverted: bool,
    index: usize,
    entry: &RoleEntry,
    chip: &Chip,
    port: Option<&SerialPort>,
) -> Result<(&'static str, u8), String> {
    let place = chip.pin(name).ok_or_else(|| no_pin(chip))?;
    if let Some(reason) = chip.withheld(name, entry.is_output) {
        return Err(format!("cannot be used: {name} {reason}"));
    }
    if inverted && !entry.inverts {
        return Err("cannot be inverted: the level is that of a protocol or of a counter".into());
    }
    let by_port = port.map(|port| match entry.role {
        Role::LineReceive => (format!("{} RX", port.name), port.receive),
        _ => (format!("{} TX", port.name), port.transmit),
    });
    let signal = chip.signal(entry.role, index);
    let needed = by_port.or_else(|| signal.map(|signal| (signal.name.to_owned(), signal.pins)));
    match needed {
        Some((signal, pins)) if !pins.contains(&name) => Err(format!(
            "is no pin of {signal}; on {} it is {}",
            chip.name,
            chip.usable(pins)
        )),
        _ => Ok(place),
    }
}

/// Refuses pins with two functions in one image, and pins that a part of the board has.
fn refuse_twice(root: &Section, named: &[Named], taken: &[(String, String)]) {
    for (index, later) in named.iter().enumerate() {
        let name = &later.pin.name;
        if let Some((_, what)) = taken.iter().find(|(taken, _)| taken == name) {
            let reason = format!("{name} is taken by the board, as [taken] says: {what}");
            root.refuse_at(&later.place, reason);
        }
        let is_other = |earlier: &&Named| {
            let apart = earlier.table != later.table
                && [earlier.table, later.table]
                    .iter()
                    .all(|table| ALTERNATIVES.contains(table));
            earlier.pin.name == *name && !apart && !earlier.role.is_apart(later.role)
        };
        if let Some(earlier) = named.iter().take(index).find(is_other) {
            let reason = format!(
                "{name} is that of {} in line {}: a pin has one function",
                earlier.place.key, earlier.place.line
            );
            root.refuse_at(&later.place, reason);
        }
    }
}

/// Refuses a board without a pin that the scene needs.
fn refuse_missing(
    root: &Section,
    tables: &BTreeMap<&str, Section>,
    pins: &BTreeMap<Role, Vec<WiredPin>>,
    needs: &Needs,
    chip: &Chip,
) {
    for (role, what) in needs.roles() {
        let entry = role.entry();
        let there = tables.get(entry.table);
        let wanted = needs.listed(role);
        if let (Some(found), Some(table)) = (pins.get(&role), there)
            && found.len() < wanted
        {
            let found = found.len();
            let reason = format!(
                "has {found} pins, and {} names {wanted} [[io.{}]]: add free pins, or name fewer",
                needs.scene, entry.key
            );
            table.refuse(entry.key, reason);
        }
        // One that is there and refused has its own message.
        if pins.contains_key(&role) || there.is_some_and(|table| table.has(entry.key)) {
            continue;
        }
        let would_do = (0..entry.count).filter_map(|index| chip.signal(role, index));
        let mut would_do = would_do
            .map(|signal| format!("{} is at {}", signal.name, chip.usable(signal.pins)))
            .collect::<Vec<_>>()
            .join("; ");
        if would_do.is_empty() {
            would_do = "any free pin would do".into();
        }
        let mut reason = format!(
            "missing: {} has {what}, and this board names no pin for it; {would_do}",
            needs.scene
        );
        if let Some((_, without)) = chip.without.iter().find(|(table, _)| *table == entry.table) {
            reason = format!("missing: {} has {what}, and {without}", needs.scene);
        }
        match there {
            Some(table) => table.refuse(entry.key, reason),
            None => root.refuse_at(
                &Place {
                    key: role.path(),
                    ..root.place()
                },
                reason,
            ),
        }
    }
}

/// Times of a driver: step pulse, high and low; direction before a step; direction after a step.
const TIMES: [&str; 3] = ["pulse_us", "setup_us", "hold_us"];

/// Refuses times that are longer than a slot of the scene's steppers.
fn refuse_times(
    stepper: &Section,
    times: [Option<f64>; 3],
    needs: &Needs,
    (chip, has_usb): (&Chip, bool),
) {
    let Some((slots_hz, tick_rate_hz)) = needs.slots else {
        return;
    };
    let clock = chip.family.clock();
    let slot_s = clock.slot_s(slots_hz);
    // An edge comes at the end of its slot's run, the next one at the begin of its own.
    let late_s = clock.late_s(has_usb);
    let sure_s = slot_s - late_s;
    for (key, time_s) in TIMES.into_iter().zip(times) {
        let Some(time_s) = time_s.filter(|time_s| *time_s > sure_s) else {
            continue;
        };
        // Two slots for each step, and one more in each tick.
        let slots_per_tick = (1.0 / ((time_s + late_s) * tick_rate_hz)).floor();
        let most_hz = ((slots_per_tick - 1.0) / 2.0).floor() * tick_rate_hz;
        let remedy = match most_hz > 0.0 {
            true => format!("step_rate_limit_hz of {most_hz} leaves time for it"),
            false => "a tick of the scene is too short for it".into(),
        };
        stepper.refuse(
            key,
            format!(
                "the steppers of {} have {:.2} us for it: {slots_hz} slots per second of {:.2} us, less {:.2} us that \
                 an edge may be late; {remedy}",
                needs.scene,
                sure_s.max(0.0) * 1e6,
                slot_s * 1e6,
                late_s * 1e6
            ),
        );
    }
}
