//! Refusals of board files, each by its message, and the shipped files.

use super::*;
use trirrr_scene::SceneError;

/// The generic board with `from` replaced by `to`, for a scene that needs these.
fn changed(from: &str, to: &str, needs: &Needs) -> Result<BoardFile, SceneError> {
    let text = shipped("generic-f405");
    assert!(text.contains(from), "{from}");
    let text = text.replacen(from, to, 1);
    BoardFile::parse(&text, "own.toml", Some((Family::Stm32f405, needs)))
}

fn needs(drive: &str) -> Needs {
    Needs {
        scene: "scenes/own.toml".into(),
        drive: drive.into(),
        ..Needs::default()
    }
}

fn refusal(read: Result<BoardFile, SceneError>) -> String {
    match read {
        Ok(_) => panic!("not refused"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_pin_that_cannot_do_its_work_is_refused_with_those_that_can() {
    for (from, to, said) in [
        (
            "output = \"PA5\"",
            "output = \"PA6\"",
            "tool.output = \"PA6\": is no pin of TIM2 CH1; on stm32f405rg it is PA0, PA5",
        ),
        (
            "transmit = \"PB10\"",
            "transmit = \"PB11\"",
            "log.transmit = \"PB11\": is no pin of usart3 TX; on stm32f405rg it is PB10, PC10",
        ),
        (
            "receive = \"PA3\"",
            "receive = \"PD6\"",
            "line.receive = \"PD6\": stm32f405rg has no such pin; it has PA0 to PA15, PB0 to PB15, PC0 to PC15, PD2",
        ),
        (
            "encoder_b = [\"PA9\", \"PB7\"",
            "encoder_b = [\"PA9\", \"PB5\"",
            "amplifier.encoder_b[2] = \"PB5\": is no pin of TIM4 CH2; on stm32f405rg it is PB7",
        ),
        (
            "release = \"PB0\"",
            "release = \"PA13\"",
            "brake.release = \"PA13\": cannot be used: PA13 is the debug port",
        ),
        (
            "release = \"PB0\"",
            "release = \"PA12 \"",
            "brake.release = \"PA12 \": stm32f405rg has no such pin",
        ),
        (
            "receive = \"PB8\"",
            "receive = \"!PB8\"",
            "can.receive = \"!PB8\": cannot be inverted",
        ),
        (
            "port = \"usart2\"",
            "port = \"uart4\"",
            "line.port = \"uart4\": must be one of \"usart1\", \"usart2\", \"usart3\", \"usart6\", \"usb\"",
        ),
        (
            "step = [\"PC0\", \"PC1\", \"PC2\"]",
            "step = [\"PC0\", \"PC1\"]",
            "stepper.step = [\"PC0\", \"PC1\"]: must be 3 pins, of motor 1, 2 and 3, found 2",
        ),
        (
            "hold_us = 1\n",
            "",
            "stepper.hold_us: missing, expected a number",
        ),
        (
            "hold_us = 1\n",
            "hold_us = -1\n",
            "stepper.hold_us = -1: must be from 0 to 10000",
        ),
        (
            "[brake]\nrelease",
            "[brake]\nrelese",
            "brake.relese = \"PB0\": unknown key; did you mean `release`?",
        ),
        (
            "[brake]",
            "[brakes]",
            "brakes = [brakes]: unknown key; did you mean `brake`?",
        ),
    ] {
        let text = refusal(changed(from, to, &needs("none")));
        assert!(
            text.starts_with("own.toml:") && text.contains(said),
            "{said}\n{text}"
        );
    }
}

#[test]
fn spare_pins_are_lists_with_as_many_as_the_scene_names() {
    let spare = |outputs, inputs| Needs {
        spare: [outputs, inputs],
        ..needs("none")
    };
    let outputs = "outputs = [\"PA10\", \"PA11\", \"PA12\", \"PD2\"]";
    assert!(changed(outputs, outputs, &spare(4, 2)).is_ok());
    let text = refusal(changed(outputs, outputs, &spare(5, 1)));
    let said =
        "has 4 pins, and scenes/own.toml names 5 [[io.outputs]]: add free pins, or name fewer";
    assert!(text.contains(said), "{text}");
    let text = refusal(changed(outputs, "outputs = []", &spare(1, 1)));
    assert!(
        text.contains("io.outputs = []: must be 1 to 8 pins, found 0"),
        "{text}"
    );
    let text = refusal(changed(outputs, "", &spare(1, 0)));
    let said = "io.outputs: missing: scenes/own.toml has spare outputs, and this board names no pin for it";
    assert!(text.contains(said), "{text}");
    let text = refusal(changed(
        "\"PA11\", \"PA12\"",
        "\"PA10\", \"PA12\"",
        &spare(1, 1),
    ));
    assert!(text.contains("PA10 is that of io.outputs[1]"), "{text}");
    // An image takes the first ones.
    let board = changed(
        outputs,
        outputs.replace("\"PA10\"", "\"!PA10\"").as_str(),
        &spare(1, 2),
    );
    let text = source::source(
        &board.unwrap_or_else(|error| panic!("{error}")),
        &spare(1, 2),
    );
    for part in [
        "pub(crate) type Output1 = Inverted<Pin<'A', 10>>;",
        "pub(crate) type Output2 = NoPin;",
        "pub(crate) type Input2 = Pin<'B', 11>;",
        "pub(crate) type Input3 = NoPin;",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn a_pin_has_one_function_in_an_image() {
    let text = refusal(changed(
        "release = \"PB0\"",
        "release = \"PA7\"",
        &needs("none"),
    ));
    assert!(
        text.contains("brake.release = \"PA7\": PA7 is that of inputs.door in line"),
        "{text}"
    );
    // Twice in one list.
    let text = refusal(changed(
        "\"PC1\", \"PC2\"",
        "\"PC0\", \"PC2\"",
        &needs("none"),
    ));
    assert!(
        text.contains("stepper.step[2] = \"PC0\": PC0 is that of stepper.step[1]"),
        "{text}"
    );
    // An image has steppers or amplifiers, and both are enabled by PB12.
    assert!(changed("[brake]", "[brake]", &needs("stepper")).is_ok());
    let taken = "[taken]\nPA7 = \"a button\"\n[brake]";
    let text = refusal(changed("[brake]", taken, &needs("none")));
    assert!(
        text.contains(
            "inputs.door = \"PA7\": PA7 is taken by the board, as [taken] says: a button"
        ),
        "{text}"
    );
    let taken = "[taken]\nGP25 = \"a light\"\n[brake]";
    let text = refusal(changed("[brake]", taken, &needs("none")));
    assert!(
        text.contains("taken.GP25 = \"a light\": stm32f405rg has no such pin"),
        "{text}"
    );
}

#[test]
fn a_board_without_a_pin_that_the_scene_needs_is_refused() {
    let braked = Needs {
        brake: true,
        ..needs("none")
    };
    let text = refusal(changed("[brake]\nrelease = \"PB0\"\n", "", &braked));
    assert!(
        text.contains(
            "brake.release: missing: scenes/own.toml has a brake, and this board names no pin for it; any free pin would do"
        ),
        "{text}"
    );
    let enabled = Needs {
        tool: "duty".into(),
        tool_enable: true,
        ..needs("none")
    };
    let text = refusal(changed("enable = \"PA4\"\n", "", &enabled));
    assert!(
        text.contains("tool.enable: missing: scenes/own.toml has a tool with an enable line"),
        "{text}"
    );
    assert!(changed("enable = \"PA4\"\n", "", &needs("none")).is_ok());
    // The headers of a Feather have too few pins for encoders.
    let text = shipped("feather-f405");
    let read = BoardFile::parse(&text, "feather", Some((Family::Stm32f405, &needs("bldc"))));
    let text = refusal(read);
    assert!(
        text.contains(
            "amplifier.encoder_a: missing: scenes/own.toml has brushless motors with amplifiers, and this board names no \
             pin for it; TIM1 CH1 is at PA8; TIM4 CH1 is at PB6; TIM5 CH1 is at PA0"
        ),
        "{text}"
    );
    let read = BoardFile::parse(
        &shipped("pico"),
        "pico",
        Some((Family::Rp2040, &needs("odrive"))),
    );
    let text = refusal(read);
    assert!(
        text.contains("scenes/own.toml has drives on CAN, and the RP2040 has no CAN controller"),
        "{text}"
    );
}

#[test]
fn a_board_of_another_chip_is_refused() {
    let read = BoardFile::parse(
        &shipped("pico"),
        "pico.toml",
        Some((Family::Stm32f405, &needs("none"))),
    );
    assert_eq!(
        refusal(read),
        "pico.toml:3: chip = \"rp2040\": is a chip of the firmware for the RP2040, which `cargo fw-rp2040` builds; \
         `cargo fw` is for \"stm32f405rg\" or \"stm32f405vg\""
    );
    let text = refusal(changed("stm32f405rg", "stm32f407vg", &needs("none")));
    assert!(
        text.contains(
            "chip = \"stm32f407vg\": must be one of \"stm32f405rg\", \"stm32f405vg\", \"stm32g474re\", \"rp2040\""
        ),
        "{text}"
    );
    assert_eq!(
        text.lines().count(),
        1,
        "pins of another chip may be right: {text}"
    );
    let can = shipped("pico") + "\n[can]\nreceive = \"GP2\"\ntransmit = \"GP3\"\n";
    let text = refusal(BoardFile::parse(&can, "pico.toml", None));
    assert!(
        text.contains("can: must be left out: the RP2040 has no CAN controller"),
        "{text}"
    );
}

#[test]
fn a_crystal_makes_the_clock_or_is_refused() {
    for (crystal, said) in [
        (
            "14.7456",
            "does not make exactly 168 MHz of it; of whole MHz 4, 5, 6, 7, 8",
        ),
        ("3", "must be from 4 to 26"),
        ("27", "must be from 4 to 26"),
        ("8.0000001", "does not make exactly 168 MHz"),
    ] {
        let to = format!("crystal_mhz = {crystal}\n");
        let text = refusal(changed("crystal_mhz = 8\n", &to, &needs("none")));
        assert!(
            text.contains(&format!("crystal_mhz = {crystal}: ")),
            "{text}"
        );
        assert!(text.contains(said), "{text}");
    }
    assert!(changed("crystal_mhz = 8\n", "crystal_mhz = 10.5\n", &needs("none")).is_ok());
}

#[test]
fn times_of_a_driver_fit_between_two_slots() {
    let stepping = Needs {
        // 20,000 steps per second in ticks of 1 ms: 24.4 us.
        slots: Some((41_001, 1000.0)),
        ..needs("stepper")
    };
    assert!(changed("pulse_us = 2\n", "pulse_us = 21.5\n", &stepping).is_ok());
    for (from, to, key) in [
        ("pulse_us = 2\n", "pulse_us = 24\n", "stepper.pulse_us = 24"),
        ("setup_us = 1\n", "setup_us = 30\n", "stepper.setup_us = 30"),
        ("hold_us = 1\n", "hold_us = 30\n", "stepper.hold_us = 30"),
    ] {
        let text = refusal(changed(from, to, &stepping));
        assert!(
            text.contains(key)
                && text.contains("the steppers of scenes/own.toml have 21.76 us for it")
                && text.contains("41001 slots per second of 24.38 us"),
            "{text}"
        );
    }
    // 32.6 us are 30.7 slots in a tick: 14 steps, and a slot more.
    let text = refusal(changed("hold_us = 1\n", "hold_us = 30\n", &stepping));
    assert!(
        text.contains("step_rate_limit_hz of 14000 leaves time"),
        "{text}"
    );
    let text = refusal(changed("hold_us = 1\n", "hold_us = 9000\n", &stepping));
    assert!(text.contains("a tick of the scene is too short"), "{text}");
}

#[test]
fn a_line_and_its_log_have_ports_of_their_own() {
    let (from, to) = (
        "port = \"usart3\"\ntransmit = \"PB10\"",
        "port = \"usart2\"\ntransmit = \"PD5\"",
    );
    let text = refusal(changed(from, to, &needs("none")));
    assert!(
        text.contains("log.port = \"usart2\": is that of the line"),
        "{text}"
    );
    let text = refusal(changed(
        "[log]\nport = \"usart3\"\ntransmit = \"PB10\"\n",
        "",
        &needs("none"),
    ));
    assert!(
        text.contains("log: missing, expected [log] with a port of usart1, usart2, usart3, usart6"),
        "{text}"
    );
}

#[test]
fn what_names_a_board_is_looked_for_in_order() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let of = |variable: Option<&str>, scene: Option<&str>| {
        let needs = Needs {
            board: scene.map(Into::into),
            ..needs("none")
        };
        let file = chosen(variable, &needs, Family::Stm32f405, &root)?;
        let name = file.file_name().unwrap_or_default();
        Ok::<_, String>(name.to_string_lossy().into_owned())
    };
    assert_eq!(of(None, None).as_deref(), Ok("generic-f405.toml"));
    assert_eq!(of(None, Some("pico")).as_deref(), Ok("pico.toml"));
    let path = "firmware/boards/files/feather-f405.toml";
    assert_eq!(
        of(Some(path), Some("pico")).as_deref(),
        Ok("feather-f405.toml")
    );
    let said = of(Some("fether"), None).expect_err("no such board");
    assert!(
        said.starts_with("BOARD=fether: no such board: ")
            && said.contains("shipped boards are feather-f405, generic-f405, nucleo-g474re, pico,"),
        "{said}"
    );
    let said = of(None, Some("own/board.toml")).expect_err("no such file");
    assert!(
        said.starts_with("scenes/own.toml: board = \"own/board.toml\": "),
        "{said}"
    );
}

/// The shipped board `name` for an image whose line is USB by the build.
fn over_usb(name: &str, change: (&str, &str), mut needs: Needs) -> Result<BoardFile, SceneError> {
    let text = shipped(name);
    let (from, to) = change;
    assert!(text.contains(from), "{from}");
    let chip = ["f405", "g474", "pico"].map(|part| name.contains(part));
    let family = match chip {
        [true, ..] => Family::Stm32f405,
        [_, true, _] => Family::Stm32g474,
        _ => Family::Rp2040,
    };
    needs.usb_line = true;
    BoardFile::parse(&text.replacen(from, to, 1), name, Some((family, &needs)))
}

#[test]
fn a_line_over_usb_leaves_the_pins_of_a_port_to_other_functions() {
    let same = ("[line]", "[line]");
    for name in ["generic-f405", "feather-f405", "nucleo-g474re", "pico"] {
        let board = over_usb(name, same, needs("none")).unwrap_or_else(|error| panic!("{error}"));
        assert!(board.has_usb_line() && board.pins(Role::LineTransmit).is_none());
        let pins: Vec<&str> = board.usb.iter().map(|(_, pin)| pin.name.as_str()).collect();
        let at: &[&str] = if name == "pico" {
            &[]
        } else {
            &["PA11", "PA12"]
        };
        assert_eq!(pins, at, "{name}");
    }
    // That of the line.
    let brake = ("release = \"GP17\"", "release = \"GP0\"");
    assert!(over_usb("pico", brake, needs("none")).is_ok());
    // By the file, in every image.
    let port = "port = \"uart0\"\n";
    let by_file = shipped("pico").replace(port, "port = \"usb\"\n");
    let text = refusal(BoardFile::parse(&by_file, "own.toml", None));
    assert!(
        text.contains(
            "line.transmit = \"GP0\": must be left out: USB has pins of its own on rp2040"
        ),
        "{text}"
    );
    let pins = "transmit = \"GP0\"\nreceive = \"GP1\"\n";
    let board = BoardFile::parse(&by_file.replace(pins, ""), "own.toml", None);
    assert!(board.is_ok_and(|board| board.has_usb_line()));
}

#[test]
fn a_pin_of_usb_has_no_other_function_in_the_image() {
    let same = ("[line]", "[line]");
    let text = refusal(over_usb("nucleo-g474re", same, needs("moteus")));
    assert!(
        text.contains("can.receive = \"PA11\": PA11 is that of USB, and the line is USB"),
        "{text}"
    );
    let taken = ("PA11 = \"USB D-\"", "PA11 = \"a button\"");
    let text = refusal(over_usb("feather-f405", taken, needs("none")));
    assert!(
        text.contains("PA11 is that of USB, and the line is USB: it is taken by a button"),
        "{text}"
    );
}

#[test]
fn a_driver_of_steppers_has_less_time_where_usb_masks_the_slots() {
    let of = |slots_hz| Needs {
        slots: Some((slots_hz, 500.0)),
        ..needs("stepper")
    };
    let same = ("[line]", "[line]");
    assert!(over_usb("nucleo-g474re", same, of(41_000)).is_ok());
    assert!(over_usb("nucleo-g474re", same, of(81_000)).is_ok());
    let text = refusal(over_usb("nucleo-g474re", same, of(121_000)));
    assert!(
        text.contains("stepper.pulse_us = 2: the steppers of scenes/own.toml have 0.00 us for it")
            && text.contains("less 8.47 us that an edge may be late; step_rate_limit_hz of"),
        "{text}"
    );
    assert!(over_usb("generic-f405", same, of(81_000)).is_err());
    // Critical sections let the slots pass.
    assert!(over_usb("pico", same, of(81_000)).is_ok());
}

#[test]
fn the_line_of_a_build_is_usb_or_that_of_the_board() {
    assert_eq!(asks_for_usb(None), Ok(false));
    assert_eq!(asks_for_usb(Some("usb")), Ok(true));
    let error = asks_for_usb(Some("uart")).expect_err("not refused");
    assert!(error.starts_with("LINE=uart: must be usb"), "{error}");
}

/// Names of the board files in `folder`, sorted.
fn shipped_names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let files = entries.map(|entry| entry.path());
    let tables = files.filter(|file| file.extension().is_some_and(|end| end == "toml"));
    let mut names: Vec<String> = tables
        .filter_map(|file| Some(file.file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    names
}

/// The shipped boards and their tables in `docs/board.md`. `TRIRRR_BLESS=1 cargo test -p trirrr-image --features generate board` writes them.
#[test]
fn the_tables_of_the_manual_are_those_of_the_shipped_boards() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let names = shipped_names(&root.join(FILES));
    assert_eq!(names, BOARDS);
    let path = root.join("docs/board.md");
    let mut text = fs::read_to_string(&path).expect("the manual");
    let before = text.clone();
    for name in names {
        let board = BoardFile::parse(&shipped(&name), &name, None);
        let board = board.unwrap_or_else(|error| panic!("{error}"));
        let (begin, end) = (format!("<!-- board {name} -->\n"), "<!-- end of board -->");
        let start = text
            .find(&begin)
            .unwrap_or_else(|| panic!("{begin} in docs/board.md"));
        let start = start + begin.len();
        let length = text[start..].find(end).expect("the table's end");
        let head = format!(
            "{}: chip `{}`, crystal {} MHz, line at {}, log at {}.\n\n",
            board.description,
            board.chip.name,
            board.crystal_mhz,
            board
                .line
                .map_or("USB".into(), |port| port.name.to_uppercase()),
            board.log.name.to_uppercase()
        );
        let table = format!("\n{head}{}\n", table(&board));
        text.replace_range(start..start + length, &table);
    }
    if env::var_os("TRIRRR_BLESS").is_some() {
        fs::write(&path, text).expect("the manual is written");
    } else {
        assert!(
            before == text,
            "docs/board.md differs; TRIRRR_BLESS=1 writes it"
        );
    }
}
