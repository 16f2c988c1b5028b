//! The program, as tests of its commands run it.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// `trirrr` with `arguments` in `folder`, not started yet.
pub(crate) fn command(folder: impl AsRef<Path>, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trirrr"));
    command.args(arguments).current_dir(folder);
    command
}

/// Runs `trirrr` with `arguments` in `folder` to its end.
pub(crate) fn trirrr(folder: impl AsRef<Path>, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

/// Value that a run which succeeded has printed.
pub(crate) fn json(output: &Output) -> Value {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Asserts that `examples` of what `command` prints with `--json` have the schema in `docs/schemas`. With `TRIRRR_BLESS` it is written.
pub(crate) fn keeps_schema(command: &str, examples: &[Value]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/schemas");
    let file = folder.join(command).with_extension("json");
    let schema =
        trirrr_figures::document::schema::of(&format!("trirrr {command} --json"), examples);
    let schema = format!("{schema:#}\n");
    if std::env::var_os("TRIRRR_BLESS").is_some() {
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(&file, &schema).unwrap();
    }
    let kept = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(
        kept == schema,
        "{}: is another than {schema}",
        file.display()
    );
}
