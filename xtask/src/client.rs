//! `cargo xtask client`: the Python package, as a user installs it, and its client against `trirrr device`, over TCP.
//!
//! `pip` builds the package with its native core in a virtual environment; types, tests and examples are checked there. The client plays a scene's job on the device and records its telemetry; the table it writes has to be
//! the one that `trirrr run` writes: what the machine sent, in the bits; what the client computes
//! itself, to its rounding. The client does not plan: of a job along a path it plays the moves that `trirrr plan` writes.

use crate::programs::{Programs, python_in, succeed};
use crate::repository::{root, target_directory};
use anyhow::{Context, Result, bail, ensure};
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;
use trirrr_scene::Scene;

/// Version of mypy whose verdicts on the package's types count.
const MYPY: &str = "mypy==2.4.1";

/// Scenes that are played, how much faster than in real time, and their number type.
const SCENES: [(&str, &str, &str); 4] = [
    ("thesis", "2", "f64"),
    ("chained", "4", "f32"),
    // Homed first, to switches and to hard stops that nothing feels. The second one's job is a path.
    ("pick-home", "5", "fixed"),
    ("plotter", "5", "f32"),
];

/// A scene whose second motor may search 0.8 rad, where its motors stand so that it would have to
/// search further, and what the client then has to say.
const IN_VAIN: (&str, [&str; 3], &str) = (
    "pick-home",
    ["0", "0.6", "0"],
    "homing: motor 2 has not found its switch or stop within 0.8 rad",
);

/// Roundings that the columns which the client computes may be from the core's, of the largest value
/// of the column: closing the triangle takes some twenty operations on either side, with what
/// cancels in the distal link's motion weighed by up to l1 / l2 = 1.
const ROUNDINGS: f64 = 64.0;

/// Returns how far the client's computed columns may be from the core's, as a part of the largest
/// value of the column.
pub(crate) fn rounding(scalar: &str) -> f64 {
    let unit = match scalar {
        "f64" => f64::EPSILON / 2.0,
        "fixed" => (-29_f64).exp2(),
        _ => f64::from(f32::EPSILON) / 2.0,
    };
    ROUNDINGS * unit
}

/// First column of the table that the machine does not send; of the later ones, it sends `tool`.
const FIRST_COMPUTED: &str = "detA";

pub(crate) fn run() -> Result<()> {
    let trirrr = Programs::build()?.trirrr;
    install()?;
    let mut types = python();
    types
        .args(["-m", "mypy"])
        .current_dir(package())
        .env("MYPY_CACHE_DIR", folder().join("mypy"));
    succeed(&mut types, "the check of the package's types")?;
    let mut tests = python();
    tests
        .args(["-m", "unittest", "discover", "-s"])
        .arg(package().join("tests"))
        .env("TRIRRR", &trirrr);
    succeed(&mut tests, "the package's own tests")?;
    examples(&trirrr)?;
    notebooks()?;
    for (name, speed, scalar) in SCENES {
        let scene = root().join("scenes").join(format!("{name}.toml"));
        let out = cleared(folder().join(name))?;
        let mut simulated = Command::new(&trirrr);
        simulated
            .arg("run")
            .arg(&scene)
            .args(["--fast", "--out"])
            .arg(out.join("run"));
        succeed(simulated.stdout(Stdio::null()), "trirrr run")?;
        let moves = planned_moves(&trirrr, &scene, &out.join("plan"))?;
        let device = Device::start(&trirrr, &scene, speed, &[])?;
        let mut client = client(&scene, &device, &out.join("streamed"));
        if let Some(moves) = moves {
            client.arg("--moves").arg(moves);
        }
        succeed(&mut client, "the client")?;
        drop(device);
        let [expected, found] = ["run", "streamed"].map(|run| out.join(run).join("ticks.csv"));
        compare(&expected, &found, rounding(scalar)).with_context(|| format!("scene {name}"))?;
        println!("{name}: the tables agree");
        ensure!(
            out.join("streamed/ticks.svg").is_file(),
            "the client drew nothing"
        );
    }
    in_vain(&trirrr)
}

/// The table of moves that `trirrr plan` writes into `out`, if the job of `scene` is a path.
pub(crate) fn planned_moves(trirrr: &Path, scene: &Path, out: &Path) -> Result<Option<PathBuf>> {
    if Scene::read(scene)?.job.path.is_none() {
        return Ok(None);
    }
    let mut plan = Command::new(trirrr);
    plan.arg("plan").arg(scene).arg("--out").arg(out);
    succeed(plan.stdout(Stdio::null()), "trirrr plan")?;
    Ok(Some(out.join("moves.csv")))
}

/// The client, to play `scene` on `device`.
fn client(scene: &Path, device: &Device, out: &Path) -> Command {
    let mut client = python();
    client
        .args(["-m", "trirrr"])
        .arg(scene)
        .args(["--port", &device.address, "--out"])
        .arg(out);
    client
}

/// The folder of the package.
fn package() -> PathBuf {
    root().join("clients/python")
}

/// The path of results of an earlier call, without them: an earlier version of the program may have written them, and `trirrr` replaces
/// what it knows alone.
pub(crate) fn cleared(path: PathBuf) -> Result<PathBuf> {
    let removed = match path.is_dir() {
        true => fs::remove_dir_all(&path),
        false if path.exists() => fs::remove_file(&path),
        false => Ok(()),
    };
    removed.with_context(|| path.display().to_string())?;
    Ok(path)
}

/// The folder of what is installed and written here.
fn folder() -> PathBuf {
    target_directory().join("ci/client")
}

/// Python of the virtual environment, away from the sources: what is imported is what was installed.
fn python() -> Command {
    let mut python = Command::new(folder().join("venv/bin/python"));
    python.current_dir(folder());
    python
}

/// Makes the virtual environment if it is missing, and installs the package and what its checks need.
fn install() -> Result<()> {
    fs::create_dir_all(folder()).with_context(|| folder().display().to_string())?;
    python_in(&folder().join("venv"))?;
    let started = Instant::now();
    let mut pip = python();
    pip.args(["-m", "pip", "install", "--quiet", MYPY])
        .arg(format!(
            "{}[figures,notebooks,progress,serial,tables]",
            package().display()
        ))
        // The profile of the other programs here: compiling takes longer than running.
        .env("MATURIN_PEP517_ARGS", "--profile dev --features shared")
        .env("CARGO_TARGET_DIR", target_directory());
    succeed(&mut pip, "the installation of the Python package")?;
    println!("installed in {:.0} s", started.elapsed().as_secs_f64());
    Ok(())
}

/// Files of a folder of the package with this ending, in order.
fn files_of(name: &str, ending: &str) -> Result<Vec<PathBuf>> {
    let place = package().join(name);
    let files = fs::read_dir(&place).with_context(|| place.display().to_string())?;
    let paths = files.map(|file| Ok(file?.path()));
    let mut files = paths.collect::<std::io::Result<Vec<_>>>()?;
    files.retain(|file| file.extension().is_some_and(|found| found == ending));
    files.sort();
    ensure!(!files.is_empty(), "{}: no {ending}", place.display());
    Ok(files)
}

/// Executes every notebook from its first cell to its last. They hold their numbers to those of the documents.
fn notebooks() -> Result<()> {
    for notebook in files_of("notebooks", "ipynb")? {
        println!("{}", notebook.display());
        let mut run = Command::new(folder().join("venv/bin/jupyter-execute"));
        run.arg(&notebook)
            .arg("--timeout=300")
            .current_dir(folder())
            .env("TRIRRR_REPOSITORY", root());
        succeed(&mut run, &notebook.display().to_string())?;
    }
    Ok(())
}

/// Runs every example, with a device that has the scene of the first one.
fn examples(trirrr: &Path) -> Result<()> {
    let examples = files_of("examples", "py")?;
    let scene = root().join("scenes/thesis.toml");
    let device = Device::start(trirrr, &scene, "2", &[])?;
    for example in examples {
        println!("{}", example.display());
        let mut run = python();
        run.arg(&example).arg(&device.address).env("TRIRRR", trirrr);
        succeed(&mut run, &example.display().to_string())?;
    }
    Ok(())
}

/// A machine that cannot be homed: the client says why, and plays nothing; told to recover it, it homes
/// it from where it has come to, and plays the job.
fn in_vain(trirrr: &Path) -> Result<()> {
    let (name, offsets, expected) = IN_VAIN;
    let scene = root().join("scenes").join(format!("{name}.toml"));
    let out = folder().join("in-vain");
    // What an earlier run has left is none of this one's.
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| out.display().to_string())?;
    }
    let device = Device::start(
        trirrr,
        &scene,
        "5",
        &[&["--offset-rad"], offsets.as_slice()].concat(),
    )?;
    let output = client(&scene, &device, &out)
        .output()
        .context("the client cannot be started")?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(
        output.status.code() == Some(1) && said.contains(expected),
        "a machine whose homing fails: the client ended with {}: {said}",
        output.status
    );
    let table = out.join("ticks.csv");
    ensure!(
        !table.exists(),
        "the client has played a job on a machine that is not homed"
    );
    println!("{name}: {}", said.trim_end());
    succeed(
        client(&scene, &device, &out).args(["--recover", "1"]),
        "the client, told to recover the machine,",
    )?;
    let expected = folder().join(name).join("run");
    compare(&expected.join("ticks.csv"), &table, rounding("fixed"))
        .with_context(|| format!("scene {name}, recovered"))
}

/// `trirrr device` in the background; it ends with this value.
struct Device {
    child: Child,
    address: String,
}

impl Device {
    fn start(trirrr: &Path, scene: &Path, speed: &str, more: &[&str]) -> Result<Self> {
        let mut child = Command::new(trirrr)
            .arg("device")
            .arg(scene)
            .args(["--listen", "tcp:127.0.0.1:0", "--speed", speed])
            .args(more)
            .stdout(Stdio::piped())
            .spawn()
            .context("trirrr device cannot be started")?;
        let mut lines = BufReader::new(child.stdout.take().context("it has an output")?).lines();
        let mut device = Self {
            child,
            address: String::new(),
        };
        let first = lines.next().context("trirrr device ended")??;
        device.address = first
            .split(' ')
            .next()
            .filter(|word| word.starts_with("tcp:"))
            .with_context(|| format!("trirrr device does not say where it listens: {first}"))?
            .to_owned();
        // Who does not read would stop it once the pipe is full.
        std::thread::spawn(move || lines.for_each(drop));
        Ok(device)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // It may have ended by itself; then there is nothing to do.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A table of numbers by columns.
struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    fn read(path: &Path) -> Result<Self> {
        let read = || -> Result<Self> {
            let mut reader = csv::Reader::from_path(path)?;
            Ok(Self {
                names: reader.headers()?.iter().map(Into::into).collect(),
                rows: reader.deserialize().collect::<Result<_, _>>()?,
            })
        };
        read().with_context(|| path.display().to_string())
    }
}

/// Compares two tables: what the machine sent in the bits, the rest to `tolerance` of the column's
/// largest value.
pub(crate) fn compare(expected: &Path, found: &Path, tolerance: f64) -> Result<()> {
    let [expected, found] = [Table::read(expected)?, Table::read(found)?];
    ensure!(
        expected.names == found.names,
        "columns: {:?}, found {:?}",
        expected.names,
        found.names
    );
    ensure!(
        expected.rows.len() == found.rows.len(),
        "{} rows, found {}",
        expected.rows.len(),
        found.rows.len()
    );
    let sent = expected
        .names
        .iter()
        .position(|name| name == FIRST_COMPUTED)
        .context(FIRST_COMPUTED)?;
    for (column, name) in expected.names.iter().enumerate() {
        let exact = column < sent || name == "tool";
        let largest = expected
            .rows
            .iter()
            .map(|row| row[column].abs())
            .fold(0.0, f64::max);
        for (tick, (a, b)) in expected.rows.iter().zip(&found.rows).enumerate() {
            let (a, b) = (a[column], b[column]);
            let agrees = match exact {
                true => a == b,
                false => (a - b).abs() <= tolerance * largest,
            };
            if !agrees {
                bail!("{name} at tick {tick}: {a:?}, found {b:?}, largest {largest:?}");
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::EMULATOR;
    use crate::packages::choose_host;
    use crate::repository::{cargo, text};
    use std::collections::BTreeSet;

    const EDGES: &str = "normal,build,dev";

    /// Packages that are compiled, each with the features that are asked of it.
    fn compiled(choose: impl FnOnce(&mut Command), edges: &str) -> BTreeSet<String> {
        let mut tree = cargo();
        tree.args(["tree", "--prefix", "none", "--no-dedupe"])
            .args(["--format", "{p} {f}", "--edges", edges]);
        choose(&mut tree);
        let lines = text(&mut tree).expect("cargo tree");
        lines.lines().map(str::to_owned).collect()
    }

    /// Fails if `some` has a package that `all` does not have with the same features, but for `own`.
    fn assert_part(
        some: &BTreeSet<String>,
        all: &BTreeSet<String>,
        own: Option<&str>,
        advice: &str,
    ) {
        let is_other = |line: &&String| own.is_none_or(|own| !line.starts_with(own));
        let others: Vec<_> = some.difference(all).filter(is_other).collect();
        assert!(others.is_empty(), "{advice}: {others:#?}");
    }

    /// The package is compiled beside what the tests have compiled: libraries with other features would be compiled once more.
    #[test]
    fn the_package_asks_of_libraries_what_the_tests_do() {
        let all = compiled(choose_host, EDGES);
        let choose = |tree: &mut Command| {
            tree.args(["--package", "trirrr-python", "--features", "shared"]);
        };
        let package = compiled(choose, "normal,build");
        assert_part(
            &package,
            &all,
            Some("trirrr-python "),
            "add to the feature `shared` of clients/python/native, or take from it, what makes these different",
        );
        assert!(package.len() > 50, "{package:#?}");
    }

    /// Programs and docs are compiled without what tests alone ask for.
    #[test]
    fn the_programs_ask_of_libraries_what_the_tests_do() {
        let all = compiled(choose_host, EDGES);
        let programs = compiled(choose_host, "normal,build");
        let advice = "packages.rs: choose_host has to ask for what makes these different";
        assert_part(&programs, &all, None, advice);
        assert!(programs.len() > 50, "{programs:#?}");
    }

    /// The bench is compiled beside the tests, too: without its emulator nothing else is compiled once more.
    #[test]
    fn the_bench_asks_of_libraries_what_the_tests_do() {
        let all = compiled(choose_host, EDGES);
        let choose = |tree: &mut Command| {
            choose_host(tree);
            tree.args(["--features", EMULATOR]);
        };
        let with_emulator = compiled(choose, EDGES);
        assert_part(
            &all,
            &with_emulator,
            Some("trirrr-mcu-bench "),
            "tests/mcu-bench/Cargo.toml: ask for these with the features that the emulator asks for",
        );
        assert!(with_emulator.len() > all.len(), "there is no emulator");
    }
}
