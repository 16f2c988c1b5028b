//! Jobs that can be played and were hardly meant so, and what is left out of a file.

use std::fs;
use std::path::Path;
use tempfile::TempDir;

const MACHINE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/engraving.toml");

/// Runs `trirrr COMMAND FILE --machine .. ARGUMENTS`: exit code, standard output, and standard error.
fn trirrr(command: &str, file: &str, content: &str, arguments: &[&str]) -> (i32, String, String) {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join(file), content).unwrap();
    let output = crate::common::command(&folder, &[])
        .args([command, file, "--machine", MACHINE, "--origin", "230,250"])
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (
        output.status.code().unwrap(),
        text(&output.stdout),
        text(&output.stderr),
    )
}

/// `check`, `run` and `plan` say the same, in one line each, with the line of the file; `check --json` has it as `remarks`.
#[test]
fn what_was_hardly_meant_is_told() {
    for (file, content, arguments, told) in [
        (
            "a.nc",
            "M3\nG1 X10 F6000\n",
            &[][..],
            "warning: line 1: the tool is never on",
        ),
        (
            "a.nc",
            "M3 S9\nG1 X10 F6000\nG4 P70\n",
            &[],
            "warning: line 3: the machine stands for 70 s",
        ),
        (
            "a.nc",
            "M3 S9\nG1 X10 F6000\nG4 P0.2\n",
            &[],
            "warning: line 3: the tool stays on while",
        ),
        (
            "a.nc",
            "T1 M6\nG1 X9 F6000 S1 M3\nM6 T7 (a fine pen)\nX0\n",
            &[],
            "warning: line 3: change to tool 7 (a fine pen)",
        ),
        (
            "a.dxf",
            "0\nSECTION\n2\nENTITIES\n0\nTEXT\n8\n0\n0\nLINE\n8\n0\n10\n0\n20\n0\n11\n9\n21\n0\n0\nENDSEC\n0\nEOF\n",
            &["--speed", "6000"],
            "warning: line 6: 1 entity TEXT is left out",
        ),
        (
            "a.svg",
            "<svg xmlns='http://www.w3.org/2000/svg' width='9mm' height='9mm' viewBox='0 0 9 9'><g fill='none' stroke='red'><path d='M0 0H9'/><path id='b' d='M9 0H0'/></g></svg>",
            &["--speed", "6000"],
            "warning: 1 line or curve lies on others",
        ),
        (
            "a.svg",
            "<svg xmlns='http://www.w3.org/2000/svg' width='9mm' height='9mm' viewBox='0 0 9 9'><path d='M0 0H2V2' fill='none' stroke='red'/></svg>",
            &["--speed", "600000", "--scale", "0.1"],
            "warning: on the whole the job is played at",
        ),
    ] {
        for command in ["check", "run", "plan"] {
            let fast = if command == "run" {
                &["--fast"][..]
            } else {
                &[]
            };
            let (code, _, said) = trirrr(command, file, content, &[arguments, fast].concat());
            assert_eq!(code, 0, "{said}");
            assert!(said.contains(told), "{command} {content}: {said}");
            assert!(said.lines().all(|line| line.len() < 250), "{said}");
        }
        let (_, json, _) = trirrr("check", file, content, &[arguments, &["--json"]].concat());
        let remarks = json.split("\"remarks\"").nth(1).unwrap_or_default();
        assert!(
            remarks.contains(told.trim_start_matches("warning: ")),
            "{json}"
        );
    }
    let (code, _, said) = trirrr("check", "a.nc", "M3 S9\nG0 X5\nG1 X10 F6000\n", &[]);
    assert_eq!((code, said.as_str()), (0, ""));
}

/// The tool follows Z; a program that Z lifts is refused where Z has no effect, and both options are in the refusal of Z.
#[test]
fn z_is_the_tool_or_has_no_effect() {
    let lifts = "M3 S1000\nG0 X0 Y0\nG1 Z-1 F2000\nX10 F5000\nZ3\nX20\nZ-1\nX30\nM5\n";
    let (code, _, said) = trirrr("check", "a.nc", lifts, &[]);
    assert!(
        code == 2
            && said.contains("a.nc:3: Z-1: ")
            && said.contains("--tool-by-z")
            && said.contains("--ignore-z"),
        "{said}"
    );
    let (code, _, said) = trirrr("check", "a.nc", lifts, &["--ignore-z"]);
    assert!(
        code == 2 && said.contains("a.nc:6: the tool is on"),
        "{said}"
    );
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("a.nc"), lifts).unwrap();
    let output = crate::common::command(&folder, &[])
        .args([
            "run",
            "--fast",
            "--tool-by-z",
            "a.nc",
            "--machine",
            MACHINE,
            "--origin",
            "230,250",
        ])
        .output()
        .unwrap();
    assert!(output.status.success());
    let table = fs::read_to_string(folder.path().join("out/a/ticks.csv")).unwrap();
    let mut rows = table.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let [x, tool] = ["x", "tool"].map(|name| header.iter().position(|each| *each == name).unwrap());
    let lit: Vec<f64> = rows
        .filter(|row| row[tool].parse::<f64>().unwrap() > 0.0)
        .map(|row| 1e3 * row[x].parse::<f64>().unwrap() - 230.0)
        .collect();
    let (inside, outside): (Vec<f64>, Vec<f64>) = lit
        .into_iter()
        .partition(|x| (-0.1..10.1).contains(x) || (19.9..30.1).contains(x));
    assert!(inside.len() > 100 && outside.is_empty(), "{outside:?}");
    // For a job alone.
    let output = crate::common::command(&folder, &[])
        .args(["check", MACHINE, "--ignore-z"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let (code, _, said) = trirrr("check", "a.nc", lifts, &["--ignore-z", "--tool-by-z"]);
    assert!(code == 2 && said.contains("cannot be used with"), "{said}");
}

/// What a DXF file leaves to its user.
#[test]
fn a_dxf_is_read_as_its_user_says() {
    let dxf = |unit: u32, entities: &str| {
        let pairs = format!(
            "0 SECTION 2 HEADER 9 $INSUNITS 70 {unit} 0 ENDSEC 0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"
        );
        pairs.replace(' ', "\n") + "\n"
    };
    let line = "0 LINE 8 0 10 0 20 0 11 9 21 0";
    let speed = ["--speed", "6000"];
    for (content, arguments, code, told) in [
        (dxf(6, line), &["--unit", "mm"][..], 0, ""),
        (
            dxf(6, &line.replace("11 9", "11 9000")),
            &[],
            2,
            "a.dxf: the drawing is 9000 by 0 m large, with 1 m a unit by $INSUNITS",
        ),
        (
            dxf(6, line),
            &[],
            2,
            "a.dxf: the drawing is 9000 by 0 mm on the machine",
        ),
        (
            dxf(4, &format!("{line} 0 TEXT 8 0 1 a")),
            &["--leave-out", "text,point"],
            0,
            "",
        ),
        (
            dxf(4, &format!("{line} {line}")),
            &["--drop-doubles"],
            0,
            "and is left out",
        ),
    ] {
        let (found, _, said) = trirrr(
            "check",
            "a.dxf",
            &content,
            &[&speed[..], arguments].concat(),
        );
        assert_eq!(found, code, "{said}");
        // The gain of another order is told of every drawing that has one.
        let said: String = said
            .lines()
            .filter(|line| !line.starts_with("trirrr: order:"))
            .collect();
        assert!(
            said.contains(told) && (said.is_empty() || !told.is_empty()),
            "{told}: {said}"
        );
    }
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='9mm' height='9mm'><path d='M0 0H9' stroke='red'/></svg>";
    let (code, _, said) = trirrr("check", "a.svg", svg, &["--speed", "6000", "--unit", "mm"]);
    assert!(
        code == 2 && said.contains("--unit: it is for DXF alone"),
        "{said}"
    );
}

/// Messages are short, and name the place, whatever the file is.
#[test]
fn foreign_files_are_named_in_short() {
    for (file, content, told) in [
        ("a.nc", "; FLAVOR:Marlin\nG21\nM140 S60\n", "a.nc:3: M140: "),
        ("a.plt", "IN;SP1;PU0,0;PD100,100;\n", "HPGL"),
        ("a.h", "BEGIN PGM 7 MM\nL X+10\n", "Heidenhain"),
        ("a.nc", "G1 X1,5 F600\n", "X1.5"),
        ("a.nc", "$H\nG1 X1 F600\n", "`trirrr grbl`"),
    ] {
        let (code, _, said) = trirrr("check", file, content, &[]);
        assert_eq!(code, 2);
        assert!(said.contains(told) && said.len() < 400, "{said}");
    }
    let line = "x".repeat(50_000);
    for file in ["a.nc", "a.dxf"] {
        let arguments = if file == "a.dxf" {
            &["--speed", "600"][..]
        } else {
            &[]
        };
        let (code, _, said) = trirrr("check", file, &line, arguments);
        assert!(code == 2 && said.len() < 400, "{said}");
    }
    assert!(Path::new(MACHINE).exists());
}
