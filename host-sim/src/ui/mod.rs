//! `trirrr ui`: the page with a scene, for a browser on this computer.

use crate::arguments::{DEFAULT_SCENE, scene_text};
use crate::failure::CliError;
use crate::terminal::{print, say};
use clap::Args;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use std::{env, fs, thread};
use trirrr_scene::Scene;

/// Name of the page's file.
const PAGE: &str = "trirrr.html";

/// Longest head of a request, bytes.
const LONGEST_HEAD: u64 = 1 << 14;

/// Time that a browser has for its request.
const PATIENCE: Duration = Duration::from_secs(2);

/// Pause between two looks at the port.
const PAUSE: Duration = Duration::from_millis(10);

/// `trirrr ui`.
///
/// Serves the page with a scene to the browsers of this computer, until Ctrl-C. The page computes by itself: drags the platform, checks the
/// scene while it is edited, plays its job. The file is read again each time that the browser loads the page; the page writes nothing.
#[derive(Args, Clone, Debug)]
pub struct UiArgs {
    /// The scene, a TOML file
    #[arg(value_name = "SCENE.toml", default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// TCP port on the loopback address; 0 takes a free one
    #[arg(long, default_value_t = 7340)]
    pub port: u16,
    /// The page, as `cargo xtask page` writes it; by default trirrr.html beside the program, or where that command puts it
    #[arg(long, value_name = "FILE.html")]
    pub page: Option<PathBuf>,
}

/// Serves the page until `stop` is raised.
///
/// # Errors
/// Refused: there is no page, the scene cannot be read, or has its machine in a file of its own. Failed: the port cannot be opened.
pub fn command(args: &UiArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let page = page(args.page.as_deref())?;
    let (text, name) = scene_text(&args.scene)?;
    if let Ok(scene) = Scene::draft_set(&text, &name, &[])
        && let Some(machine) = scene.machine_file
    {
        return Err(CliError::Refused(format!(
            "{name}: machine = {}: the page has no files; write the machine into the scene",
            machine.display()
        )));
    }
    let failed = |error: io::Error| CliError::Failed(format!("port {}: {error}", args.port));
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, args.port)).map_err(failed)?;
    listener.set_nonblocking(true).map_err(failed)?;
    let address = listener.local_addr().map_err(failed)?;
    print(&format!(
        "{name}: open http://{address}/ in a browser; Ctrl-C ends\n"
    ))?;
    while !stop.load(Ordering::Relaxed) {
        match listener.accept() {
            // A browser that goes away in the middle stops nothing.
            Ok((browser, _)) => {
                if let Err(error) = answer(&browser, &page, &args.scene) {
                    say(&format!("a browser was not answered: {error}"));
                }
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => thread::sleep(PAUSE),
            Err(error) => return Err(failed(error)),
        }
    }
    Ok(())
}

/// Reads the page, and tells it where its scene is.
fn page(given: Option<&Path>) -> Result<String, CliError> {
    let places = match given {
        Some(file) => vec![file.to_owned()],
        None => usual_places(),
    };
    let found = places.iter().find(|file| given.is_some() || file.is_file());
    let file = found.ok_or_else(|| {
        let places: Vec<_> = places.iter().map(|file| file.display().to_string()).collect();
        CliError::Refused(format!(
            "the page is not built: none of {}; `cargo xtask page --build-only` in the repository writes it, --page names another file",
            places.join(", ")
        ))
    })?;
    let text = fs::read_to_string(file).map_err(|error| {
        CliError::Refused(format!("{}: cannot be read: {error}", file.display()))
    })?;
    const BEGIN: &str = "<html lang=\"en\"";
    match text.contains(BEGIN) {
        true => Ok(text.replacen(BEGIN, &format!("{BEGIN} data-scene=\"scene.toml\""), 1)),
        false => Err(CliError::Refused(format!(
            "{}: is not the page that `cargo xtask page` writes",
            file.display()
        ))),
    }
}

/// Files that may hold the page: beside the program, and where the chore writes it.
fn usual_places() -> Vec<PathBuf> {
    let program = env::current_exe().unwrap_or_default();
    let folder = program.parent().unwrap_or(Path::new(""));
    // The program of the repository is target/PROFILE/trirrr.
    let built = folder.parent().unwrap_or(Path::new("")).join("page");
    vec![folder.join(PAGE), built.join(PAGE)]
}

/// Answers one request.
fn answer(browser: &TcpStream, page: &str, scene: &Path) -> io::Result<()> {
    browser.set_nonblocking(false)?;
    browser.set_read_timeout(Some(PATIENCE))?;
    browser.set_write_timeout(Some(PATIENCE))?;
    let mut head = BufReader::new(browser.take(LONGEST_HEAD));
    let mut request = String::new();
    head.read_line(&mut request)?;
    let mut is_local = false;
    loop {
        let mut line = String::new();
        if head.read_line(&mut line)? == 0 || line.trim().is_empty() {
            break;
        }
        is_local |= names_this_computer(&line);
    }
    let mut words = request.split_whitespace();
    let (status, kind, body) = match (words.next(), words.next()) {
        // Another site may point a name of its own to this address.
        _ if !is_local => (
            "403 Forbidden",
            "text/plain",
            "only for this computer".into(),
        ),
        (Some("GET"), Some("/")) => ("200 OK", "text/html", page.to_owned()),
        (Some("GET"), Some("/scene.toml")) => match scene_text(scene) {
            Ok((text, _)) => ("200 OK", "application/toml", text),
            Err(error) => ("404 Not Found", "text/plain", error.to_string()),
        },
        _ => ("404 Not Found", "text/plain", "no such page".into()),
    };
    let mut browser = browser;
    write!(
        browser,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {}\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n{body}",
        body.len()
    )?;
    browser.flush()
}

/// Returns true for a header `Host` with an address or name of this computer.
fn names_this_computer(header: &str) -> bool {
    let Some((name, host)) = header.split_once(':') else {
        return false;
    };
    let host = host.trim();
    let host = host.rsplit_once(':').map_or(host, |(host, _)| host);
    name.eq_ignore_ascii_case("host") && ["127.0.0.1", "localhost"].contains(&host)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_host_is_this_computer_or_another() {
        for (header, local) in [
            ("Host: 127.0.0.1:7340\r\n", true),
            ("host: localhost\r\n", true),
            ("Host: example.org:7340\r\n", false),
            ("Host: 127.0.0.1.example.org\r\n", false),
            ("Origin: 127.0.0.1:7340\r\n", false),
            ("\r\n", false),
        ] {
            assert_eq!(names_this_computer(header), local, "{header:?}");
        }
    }
}
