//! Weight of the main job: what compiles for it, what the program holds, and what it hands over.

use crate::programs::{Programs, succeed};
use crate::repository::{cargo, root, target_directory};
use anyhow::{Context, Result, ensure};
use clap::Args;
use object::{File, Object, ObjectSymbol};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Function of the service's tick: one in the program for each service that was compiled.
const TICK: &str = "tick_observed";

/// Services of the program: one for each number type and for each of the two models, with torques and without.
const SERVICES: usize = 8;

/// Most packages that are compiled for the main job.
const PACKAGES: usize = 110;

/// Most bytes of the program.
const PROGRAM: u64 = 30_000_000;

#[derive(Args)]
pub(crate) struct WeightArgs {
    /// Build the main job as on a fresh machine, in the release profile, and print what it costs
    #[arg(long, conflicts_with = "hand_over")]
    first_run: bool,
    /// Build the program of the main job, and try what it hands over
    #[arg(long)]
    hand_over: bool,
}

pub(crate) fn run(args: &WeightArgs) -> Result<()> {
    if args.first_run {
        return first_run();
    }
    if args.hand_over {
        return hand_over();
    }
    check_services(&Programs::built().trirrr)?;
    Ok(())
}

/// Builds the program of the main job beside that of all commands, and checks what it hands over.
fn hand_over() -> Result<()> {
    let mut build = cargo();
    build.args(["build", "--quiet", "--bin", "trirrr"]);
    succeed(&mut build, "the program of the main job")?;
    let own = target_directory().join("ci/main-job");
    fs::create_dir_all(&own)?;
    let (lean, full) = (own.join("trirrr"), own.join("trirrr-full"));
    let _ = fs::remove_file(&full);
    fs::copy(Programs::built().trirrr, &lean)?;
    check_services(&lean)?;
    // Cargo puts both builds of this program in the same place: the one with all commands comes back.
    let with_all = Programs::build()?.trirrr.with_file_name("trirrr-full");
    check_services(&with_all)?;

    let linkage = ["linkage", "linkages/no-such.toml"];
    let alone = answer(&lean, &linkage)?;
    ensure!(
        alone.0 == Some(1) && alone.1.contains("cargo install"),
        "alone, the program says: {alone:?}"
    );
    fs::copy(with_all, &full)?;
    let plotter = ["check", "--machine", "scenes/plotter.toml"];
    let drawing = [plotter.as_slice(), &["no-such.svg"]].concat();
    let picture = ["run", "no-such.toml", "--png"];
    for arguments in [&linkage[..], &["design", "--help"], &drawing, &picture] {
        let (by_lean, by_full) = (answer(&lean, arguments)?, answer(&full, arguments)?);
        ensure!(
            by_lean == by_full,
            "{arguments:?}: {by_lean:?}, and trirrr-full {by_full:?}"
        );
    }
    println!("the main job hands over to trirrr-full as it should");
    Ok(())
}

/// Exit code of a program, and all that it prints.
fn answer(program: &Path, arguments: &[&str]) -> Result<(Option<i32>, String)> {
    let output = Command::new(program)
        .current_dir(root())
        .args(arguments)
        .output()
        .with_context(|| program.display().to_string())?;
    let printed = [output.stdout, output.stderr].concat();
    let printed = String::from_utf8_lossy(&printed).replace("trirrr-full", "trirrr");
    Ok((output.status.code(), printed))
}

/// Checks that nobody but the crate of the machine has compiled a service.
fn check_services(program: &Path) -> Result<usize> {
    let data = fs::read(program).with_context(|| program.display().to_string())?;
    let file = File::parse(&*data)?;
    let names = file.symbols().filter_map(|symbol| symbol.name().ok());
    let services = names.filter(|name| is_tick(name)).count();
    println!("{}: {services} services", program.display());
    ensure!(services > 0, "no symbol shows a service");
    ensure!(
        services <= SERVICES,
        "{services} services, at most {SERVICES}: a package compiles again what trirrr-client has compiled; \
         machines are played by `trirrr_client::local`, generic in HostNumber"
    );
    Ok(services)
}

/// Returns true for the symbol of the function itself, not for those of closures in it.
fn is_tick(symbol: &str) -> bool {
    let Some((_, rest)) = symbol.split_once(TICK) else {
        return false;
    };
    // The end of a mangled name, and the hash behind it.
    rest.starts_with("17h")
}

/// Runs the main job in an empty target directory.
fn first_run() -> Result<()> {
    let build = target_directory().join("first-run");
    if build.exists() {
        fs::remove_dir_all(&build)?;
    }
    let run = |arguments: &[&str]| {
        let mut command = cargo();
        command.args(["run", "--release", "--target-dir"]);
        command.arg(&build).arg("--").args(arguments);
        command
    };
    let out = build.join("out").display().to_string();
    let (begin, before) = (Instant::now(), processor_seconds()?);
    let output = run(&["run", "--fast", "--out", &out]).output()?;
    let (wall, processor) = (begin.elapsed(), processor_seconds()? - before);
    let printed = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "the main job failed: {printed}");
    let compiled = printed.lines().filter(|line| line.contains("Compiling "));
    let packages = compiled.count();
    let program = build.join("release/trirrr");
    let bytes = fs::metadata(&program)?.len();
    let services = check_services(&program)?;
    println!("| the first run | |\n|---|---|");
    println!("| processor time | {processor:.0} s |");
    println!("| wall time | {:.0} s |", wall.as_secs_f64());
    println!("| packages compiled | {packages} |");
    println!("| program | {:.1} MB |", bytes as f64 * 1e-6);
    println!("| services in it | {services} |");
    ensure!(packages <= PACKAGES, "at most {PACKAGES} packages");
    ensure!(bytes <= PROGRAM, "at most {PROGRAM} bytes");
    // What it hands over is built by itself.
    let help = run(&["linkage", "--help"]).output()?;
    let printed = String::from_utf8_lossy(&help.stdout);
    ensure!(
        help.status.success() && printed.contains("Assur"),
        "the command that is handed over says: {printed}"
    );
    Ok(())
}

/// Processor time of all programs that this one has started and that have ended, s.
fn processor_seconds() -> Result<f64> {
    let stat = fs::read_to_string("/proc/self/stat").context("only Linux counts it")?;
    // Behind the name, which may hold anything, in ticks of 10 ms.
    let (_, fields) = stat.rsplit_once(')').context("no name")?;
    let fields: Vec<&str> = fields.split_whitespace().collect();
    let ticks =
        |index: usize| -> Result<f64> { Ok(fields.get(index).context("too few fields")?.parse()?) };
    Ok((ticks(13)? + ticks(14)?) * 0.01)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tick_is_told_from_what_is_in_it() {
        let of = "_ZN14trirrr_service10foreground19Foreground$LT$S$GT$13tick_observed";
        assert!(is_tick(&format!("{of}17h0123456789abcdefE")));
        assert!(!is_tick(&format!(
            "{of}28_$u7b$$u7b$closure$u7d$$u7d$17h0123456789abcdefE"
        )));
        assert!(!is_tick("main"));
    }

    #[test]
    fn processor_time_of_children_grows() {
        let before = processor_seconds().expect("Linux");
        let spin = "i=0; while [ $i -lt 20000 ]; do i=$((i+1)); done";
        let status = Command::new("sh").args(["-c", spin]).status();
        assert!(status.expect("a shell").success());
        assert!(processor_seconds().expect("Linux") >= before);
    }
}
