//! Runs an image that ends by itself and speaks through semihosting.

use crate::cores::{Core, Emulator};
use anyhow::{Context, Result, bail};
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// Far beyond what any image here needs.
const TIME_LIMIT: Duration = Duration::from_secs(300);

/// Runs the image and returns what it printed. An image that fails, or does not end, is an error.
pub(crate) fn run(core: &Core, image: &Path) -> Result<String> {
    let child = Command::new(core.emulator.command)
        .arg("-M")
        .args(core.machine)
        .args(["-display", "none", "-monitor", "none", "-serial", "null"])
        .args(["-chardev", "stdio,id=semihosting,signal=off"])
        .args([
            "-semihosting-config",
            "enable=on,target=native,chardev=semihosting",
        ])
        .arg("-kernel")
        .arg(image)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| missing(error, core.emulator))?;
    wait(child, TIME_LIMIT).with_context(|| {
        format!(
            "{} -M {} with {}",
            core.emulator.command,
            core.machine[0],
            image.display()
        )
    })
}

fn missing(error: std::io::Error, emulator: Emulator) -> anyhow::Error {
    if error.kind() == ErrorKind::NotFound {
        anyhow::anyhow!(
            "{} is not installed: it comes with the Debian package {}",
            emulator.command,
            emulator.package
        )
    } else {
        anyhow::Error::new(error).context(format!("{} cannot be started", emulator.command))
    }
}

/// Returns what a program prints until it ends. A program that fails, or takes longer than `limit`,
/// is an error with all that it printed.
pub(crate) fn wait(mut child: Child, limit: Duration) -> Result<String> {
    let mut stdout = child.stdout.take().context("no pipe to the emulator")?;
    let mut stderr = child.stderr.take().context("no pipe to the emulator")?;
    // Both are drained while it runs: an image that prints much would fill the pipe and wait.
    let printed = thread::spawn(move || {
        let mut text = String::new();
        stdout.read_to_string(&mut text).map(|_| text)
    });
    let complained = thread::spawn(move || {
        let mut text = String::new();
        stderr.read_to_string(&mut text).map(|_| text)
    });

    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break Some(status);
        }
        if start.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            break None;
        }
        thread::sleep(Duration::from_millis(5));
    };
    let printed = printed.join().expect("reading does not panic")?;
    let complained = complained.join().expect("reading does not panic")?;
    match status {
        Some(status) if status.success() => Ok(printed),
        Some(status) => bail!("ended with {status}\n{printed}{complained}"),
        None => bail!(
            "did not end within {} s\n{printed}{complained}",
            limit.as_secs()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str) -> Child {
        Command::new("sh")
            .args(["-c", script])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("sh runs")
    }

    #[test]
    fn what_was_printed_comes_back() {
        let text = wait(shell("echo bits 12"), Duration::from_secs(10)).expect("ends well");
        assert_eq!(text, "bits 12\n");
    }

    #[test]
    fn a_failing_image_is_an_error_with_its_output() {
        let error = wait(
            shell("echo out; echo err >&2; exit 3"),
            Duration::from_secs(10),
        );
        let text = error.expect_err("exit status 3").to_string();
        assert!(
            text.contains("exit status: 3") && text.contains("out\nerr\n"),
            "{text}"
        );
    }

    #[test]
    fn an_image_that_does_not_end_is_stopped() {
        let error = wait(shell("exec sleep 60"), Duration::from_millis(50));
        assert!(
            error
                .expect_err("stopped")
                .to_string()
                .contains("did not end")
        );
    }

    #[test]
    fn a_missing_emulator_is_named_with_its_package() {
        let emulator = Emulator {
            command: "qemu-system-x",
            package: "qemu-system-misc",
        };
        let text = missing(ErrorKind::NotFound.into(), emulator).to_string();
        assert!(text.contains("qemu-system-x") && text.contains("package qemu-system-misc"));
    }
}
