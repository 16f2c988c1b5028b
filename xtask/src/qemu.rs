//! Runs an image that ends by itself and speaks through semihosting.

use crate::cores::Core;
use anyhow::{Context, Result, bail};
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Far beyond what any image here needs.
const TIME_LIMIT: Duration = Duration::from_secs(300);

/// Runs the image and returns what it printed. An image that fails, or does not end, is an error.
pub(crate) fn run(core: &Core, image: &Path) -> Result<String> {
    let mut command = Command::new(core.emulator.command);
    command.arg("-M").args(core.machine);
    command
        .args(["-display", "none", "-monitor", "none", "-serial", "null"])
        .args(["-chardev", "stdio,id=semihosting,signal=off"])
        .arg("-semihosting-config")
        .arg("enable=on,target=native,chardev=semihosting");
    output(command.arg("-kernel").arg(image), TIME_LIMIT)
        .with_context(|| format!("of the Debian package {}", core.emulator.package))
}

/// Returns what `command` prints, once it has ended well. Its failure, with what it said, or a run
/// beyond `limit` is an error.
pub(crate) fn output(command: &mut Command, limit: Duration) -> Result<String> {
    let child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let ended = child
        .context("cannot be started")
        .and_then(|child| wait(child, limit));
    ended.with_context(|| format!("{command:?}"))
}

fn wait(mut child: Child, limit: Duration) -> Result<String> {
    let stdout = read_all(child.stdout.take().context("no pipe")?);
    let stderr = read_all(child.stderr.take().context("no pipe")?);
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
    let printed = stdout.join().expect("reading does not panic")?;
    let complained = stderr.join().expect("reading does not panic")?;
    match status {
        Some(status) if status.success() => Ok(printed),
        Some(status) => bail!("ended with {status}\n{printed}{complained}"),
        None => bail!(
            "did not end within {} s\n{printed}{complained}",
            limit.as_secs()
        ),
    }
}

fn read_all(mut from: impl Read + Send + 'static) -> JoinHandle<io::Result<String>> {
    thread::spawn(move || {
        let mut text = String::new();
        from.read_to_string(&mut text).map(|_| text)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cores::Emulator;

    fn shell(script: &str, limit: Duration) -> Result<String> {
        output(Command::new("sh").args(["-c", script]), limit)
    }

    #[test]
    fn what_was_printed_comes_back() {
        let text = shell("echo bits 12", Duration::from_secs(10)).expect("ends well");
        assert_eq!(text, "bits 12\n");
    }

    #[test]
    fn a_failing_image_is_an_error_with_its_output() {
        let error = shell("echo out; echo err >&2; exit 3", Duration::from_secs(10));
        let text = format!("{:#}", error.expect_err("exit status 3"));
        assert!(
            text.contains("exit status: 3") && text.contains("out\nerr\n"),
            "{text}"
        );
    }

    #[test]
    fn an_image_that_does_not_end_is_stopped() {
        let error = shell("exec sleep 60", Duration::from_millis(50));
        let text = format!("{:#}", error.expect_err("stopped"));
        assert!(text.contains("did not end"), "{text}");
    }

    #[test]
    fn a_missing_emulator_is_named_with_its_package() {
        let core = Core {
            emulator: Emulator {
                command: "qemu-system-x",
                package: "qemu-system-misc",
            },
            ..*crate::cores::named("m0").expect("a core")
        };
        let text = format!("{:#}", run(&core, Path::new("image")).expect_err("missing"));
        assert!(text.contains("qemu-system-x") && text.contains("package qemu-system-misc"));
    }
}
