//! `trirrr ui`: the page with a scene, for a browser on this computer, and the way from the page to a board.

mod relay;
mod request;

use crate::arguments::{DEFAULT_SCENE, scene_text};
use crate::failure::CliError;
use crate::serve::read_key;
use crate::terminal::{print, say};
use clap::Args;
use relay::BoardLine;
use request::Head;
use std::io;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use std::{env, thread};
use trirrr_line::Address;
use trirrr_scene::read::files::{LONGEST_TABLE, text_in};
use trirrr_scene::read::{machine_file_of, machine_path, on_disk};
use trirrr_scene::{Scene, SceneError};
use tungstenite::handshake::server::create_response;
use tungstenite::http::StatusCode;

/// Name of the page's file.
const PAGE: &str = "trirrr.html";

/// Path of the file that the scene takes its machine from.
const MACHINE: &str = "/machine.toml";

/// Path of the board's WebSocket.
const BOARD: &str = "/board";

/// Kind of an answer in words.
const TEXT: &str = "text/plain";

/// Pause between two looks at the port.
const PAUSE: Duration = Duration::from_millis(10);

/// `trirrr ui`.
///
/// Serves the page with a scene to the browsers of this computer, until Ctrl-C. The page computes by itself: drags the platform, checks the
/// scene while it is edited, plays its job. The file is read again each time that the browser loads the page; the page writes nothing.
/// With --board the page may connect to a board, and move it.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Only the page that this program serves gets to the board, one page at a time: requests of other sites are refused. The board's port is open \
while a page is connected. A page that goes away leaves the machine to the scene's host timeout: it comes to rest on its path.")]
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
    /// The board to which the page may connect: /dev/tty..., or tcp:HOST:PORT for `trirrr device` or `trirrr bridge`
    #[arg(long, value_name = "PORT")]
    pub board: Option<Address>,
    /// Rate of a serial port
    #[arg(
        long,
        value_name = "BAUD",
        default_value_t = 921_600,
        requires = "board"
    )]
    pub baud: u32,
    /// Key file of the board's port, if it is a TCP port that expects a key
    #[arg(long, value_name = "FILE", requires = "board")]
    pub key: Option<PathBuf>,
}

/// Answers to browsers.
struct Served<'a> {
    page: String,
    scene: &'a Path,
    board: Option<BoardLine>,
}

/// Serves the page until `stop` is raised.
///
/// # Errors
/// Refused: there is no page, the scene, the file of its machine or the key file cannot be read. Failed: the port
/// cannot be opened.
pub fn command(args: &UiArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let key = args.key.as_deref().map(read_key).transpose()?;
    let board = args.board.clone();
    let served = Served {
        page: page(args.page.as_deref(), args.board.as_ref())?,
        scene: &args.scene,
        board: board.map(|address| BoardLine::new(address, args.baud, key)),
    };
    let (_, name) = scene_text(&args.scene)?;
    machine_text(&args.scene)?;
    let failed = |error: io::Error| CliError::Failed(format!("port {}: {error}", args.port));
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, args.port)).map_err(failed)?;
    listener.set_nonblocking(true).map_err(failed)?;
    let address = listener.local_addr().map_err(failed)?;
    print(&format!(
        "{name}: open http://{address}/ in a browser; Ctrl-C ends\n"
    ))?;
    thread::scope(|threads| {
        while !stop.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((browser, _)) => {
                    // A browser opens connections ahead of its requests: none waits for another.
                    threads.spawn(|| {
                        // A browser that goes away in the middle stops nothing.
                        if let Err(error) = answer(browser, &served, stop) {
                            say(&format!("a browser was not answered: {error}"));
                        }
                    });
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => thread::sleep(PAUSE),
                Err(error) => return Err(failed(error)),
            }
        }
        Ok(())
    })
}

/// Reads the file that the scene in `scene` takes its machine from, if it has one of its own.
fn machine_text(scene: &Path) -> Result<Option<String>, CliError> {
    let (text, name) = scene_text(scene)?;
    let Some(file) = machine_file_of(&text) else {
        return Ok(None);
    };
    let file = machine_path(scene, &file);
    let refused = |reason: String| CliError::Refused(format!("{name}: machine = {reason}"));
    let text = on_disk(&file).map_err(refused)?;
    match fault_of_machine(&text) {
        None => Ok(Some(text)),
        Some(fault) => Err(refused(format!(
            "{}: is no machine: {fault}",
            file.display()
        ))),
    }
}

/// First reason why `text` is not that of a machine. The scene may be of somebody else and name any file of this computer: of files that
/// are no machines nothing is handed out.
fn fault_of_machine(text: &str) -> Option<String> {
    const SCENE: &str = "name = \"page\"\nmachine = \"machine.toml\"\n";
    let machines = |_: &Path| Ok(text.to_owned());
    let read = Scene::draft_from(SCENE, "", &machines);
    let Err(SceneError::Refused { problems, .. }) = read else {
        return None;
    };
    // What this scene lacks itself, its job, is no fault of the machine.
    let mut of_machine = problems
        .iter()
        .filter(|problem| problem.source.is_some() || problem.key == "machine");
    // Without the line of the file: it may be a secret.
    of_machine.next().map(|problem| match problem.key.as_str() {
        "" => format!("line {} is not TOML", problem.line),
        _ => format!("line {}: {}", problem.line, problem.reason),
    })
}

/// Reads the page, and tells it where its scene is, and the name of the board.
fn page(given: Option<&Path>, board: Option<&Address>) -> Result<String, CliError> {
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
    let text = text_in(file, LONGEST_TABLE).map_err(|error| {
        CliError::Refused(format!("{}: cannot be read: {error}", file.display()))
    })?;
    const BEGIN: &str = "<html lang=\"en\"";
    match text.contains(BEGIN) {
        true => {
            let board = board.map(|address| attribute(&address.to_string()));
            let board = board.map(|name| format!(" data-board=\"{name}\""));
            let board = board.unwrap_or_default();
            let begin = format!("{BEGIN} data-scene=\"scene.toml\"{board}");
            Ok(text.replacen(BEGIN, &begin, 1))
        }
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
fn answer(mut browser: TcpStream, served: &Served<'_>, stop: &AtomicBool) -> io::Result<()> {
    let asked = match request::read(&mut browser)? {
        Head::Request(request) => request,
        Head::Nothing => return Ok(()),
        Head::Wrong => {
            let status = StatusCode::BAD_REQUEST;
            return request::answer(&mut browser, status, TEXT, "expected GET over HTTP/1.1");
        }
    };
    let (status, kind, body) = match asked.uri().path() {
        _ if !request::is_local(&asked) => {
            (StatusCode::FORBIDDEN, TEXT, "only for this computer".into())
        }
        "/" => (StatusCode::OK, "text/html", served.page.clone()),
        "/scene.toml" => match scene_text(served.scene) {
            Ok((text, _)) => (StatusCode::OK, "application/toml", text),
            Err(error) => (StatusCode::NOT_FOUND, TEXT, error.to_string()),
        },
        MACHINE => match machine_text(served.scene) {
            Ok(Some(text)) => (StatusCode::OK, "application/toml", text),
            Ok(None) => (
                StatusCode::NOT_FOUND,
                TEXT,
                "the scene has its machine itself".into(),
            ),
            Err(error) => (StatusCode::NOT_FOUND, TEXT, error.to_string()),
        },
        BOARD => match (&served.board, create_response(&asked)) {
            (Some(_), _) if !request::is_own(&asked) => (
                StatusCode::FORBIDDEN,
                TEXT,
                "only for the page that this program serves".into(),
            ),
            (Some(board), Ok(upgrade)) => {
                request::send(&mut browser, &upgrade)?;
                say(&format!("a page connects to {}", board.address));
                let why = board.carry(browser, stop);
                let why = why.map_or(String::new(), |why| format!(": {why}"));
                say(&format!("the page has left {}{why}", board.address));
                return Ok(());
            }
            (Some(_), Err(error)) => (StatusCode::BAD_REQUEST, TEXT, error.to_string()),
            (None, _) => (
                StatusCode::NOT_FOUND,
                TEXT,
                "no board: start trirrr ui with --board PORT".into(),
            ),
        },
        _ => (StatusCode::NOT_FOUND, TEXT, "no such page".into()),
    };
    request::answer(&mut browser, status, kind, &body)
}

/// Text as the value of an attribute.
fn attribute(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('"', "&quot;");
    text.replace('<', "&lt;")
}
