//! `trirrr ui`, as a browser meets it.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;
use tungstenite::client::{IntoClientRequest, client};
use tungstenite::{Error, HandshakeError, Message, WebSocket};

/// A page by its first words: the program looks for no more.
const PAGE: &str = "<!doctype html><html lang=\"en\"><title>trirrr</title>";

/// The program, ended with the test.
struct Served {
    program: Child,
    address: String,
}

impl Served {
    fn new(folder: &Path, scene: &str, more: &[&str]) -> Self {
        let arguments = ["ui", scene, "--port", "0", "--page", "page.html"];
        let mut command = crate::common::command(folder, &[&arguments, more].concat());
        let mut program = command
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let out = program.stdout.take().expect("its output");
        let mut line = String::new();
        BufReader::new(out).read_line(&mut line).expect("a line");
        let (_, rest) = line.split_once("http://").expect("an address");
        let (address, _) = rest.split_once('/').expect("a path");
        let address = address.to_owned();
        Self { program, address }
    }

    fn get(&self, path: &str, host: &str) -> String {
        let mut line = TcpStream::connect(&self.address).expect("a connection");
        write!(line, "GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n").expect("a request");
        let mut answer = String::new();
        line.read_to_string(&mut answer).expect("an answer");
        answer
    }
}

/// A page of `origin`, or none, that asks `served` for the board.
fn connected(served: &Served, origin: Option<&str>) -> Result<WebSocket<TcpStream>, u16> {
    let mut request = format!("ws://{}/board", served.address)
        .into_client_request()
        .expect("a request");
    if let Some(origin) = origin {
        let origin = origin.parse().expect("a header");
        request.headers_mut().insert("origin", origin);
    }
    let stream = TcpStream::connect(&served.address).expect("a connection");
    match client(request, stream) {
        Ok((page, _)) => Ok(page),
        Err(HandshakeError::Failure(Error::Http(answer))) => Err(answer.status().as_u16()),
        Err(error) => panic!("{error}"),
    }
}

/// Reason for which the server closes the WebSocket.
fn reason(page: &mut WebSocket<TcpStream>) -> String {
    match page.read() {
        Ok(Message::Close(Some(frame))) => frame.reason.to_string(),
        other => panic!("{other:?}"),
    }
}

fn folder_with_page() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("page.html"), PAGE).expect("written");
    fs::write(folder.path().join("my.toml"), "name = \"one\"\n").expect("written");
    folder
}

#[test]
fn only_the_page_itself_gets_to_the_board() {
    let folder = folder_with_page();
    let board = TcpListener::bind("127.0.0.1:0").expect("a port");
    let board = format!("tcp:{}", board.local_addr().expect("an address"));
    let served = Served::new(folder.path(), "my.toml", &["--board", &board]);
    let port = served.address.rsplit_once(':').expect("a port").1;
    for origin in [
        None,
        Some("null"),
        Some("https://example.org"),
        Some("http://127.0.0.1:1"),
        Some("http://127.0.0.1"),
        Some(&format!("https://{}", served.address)),
        Some(&format!("http://localhost:{port}")),
    ] {
        let found = connected(&served, origin).map(|_| ());
        assert_eq!(found, Err(403), "{origin:?}");
    }
    // A name of another site that points here.
    let mut line = TcpStream::connect(&served.address).expect("a connection");
    write!(
        line,
        "GET /board HTTP/1.1\r\nHost: example.org\r\nOrigin: http://example.org\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    )
    .expect("a request");
    let mut answer = String::new();
    line.read_to_string(&mut answer).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 403"), "{answer}");
    // No page of another site shows this one in a frame.
    let page = served.get("/", &served.address);
    assert!(page.contains("frame-ancestors 'none'"), "{page}");
    assert!(page.contains(&format!("data-board=\"{board}\"")), "{page}");
    assert!(connected(&served, Some(&format!("http://{}", served.address))).is_ok());
}

#[test]
fn a_scene_is_served_with_the_file_of_its_machine() {
    let folder = folder_with_page();
    fs::write(
        folder.path().join("job.toml"),
        "machine = \"thesis.toml\"\n",
    )
    .expect("written");
    let thesis = include_str!("../../../scenes/thesis.toml");
    fs::write(folder.path().join("thesis.toml"), thesis).expect("written");
    let served = Served::new(folder.path(), "job.toml", &[]);
    let machine = served.get("/machine.toml", &served.address);
    assert!(machine.starts_with("HTTP/1.1 200"), "{machine}");
    assert!(machine.ends_with(thesis), "{machine}");
    // No other file is served, and none to another site.
    let page = served.get("/my.toml", &served.address);
    assert!(page.starts_with("HTTP/1.1 404"), "{page}");
    let other = served.get("/machine.toml", "example.org");
    assert!(other.starts_with("HTTP/1.1 403"), "{other}");
    let alone = Served::new(folder.path(), "my.toml", &[]);
    let none = alone.get("/machine.toml", &alone.address);
    assert!(none.starts_with("HTTP/1.1 404"), "{none}");
    fs::write(folder.path().join("lost.toml"), "machine = \"none.toml\"\n").expect("written");
    let arguments = ["ui", "lost.toml", "--port", "0", "--page", "page.html"];
    let refused = crate::common::command(folder.path(), &arguments)
        .output()
        .expect("an end");
    assert_eq!(refused.status.code(), Some(2));
    let why = String::from_utf8_lossy(&refused.stderr);
    assert!(why.contains("machine = none.toml: cannot be read"), "{why}");
}

/// The scene of somebody else may name any file of this computer. What is no machine is not handed out, and no word of it.
#[test]
fn what_is_no_machine_is_not_handed_out() {
    let folder = folder_with_page();
    let thesis = include_str!("../../../scenes/thesis.toml");
    let write =
        |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    write("job.toml", "machine = \"secret\"\n");
    write("secret", thesis);
    let served = Served::new(folder.path(), "job.toml", &[]);
    let machine = || served.get("/machine.toml", &served.address);
    assert!(machine().starts_with("HTTP/1.1 200"));
    let hidden = format!("hidden = \"word\"\n{thesis}\n[more]\nhidden = \"word\"\n");
    let cut = thesis.replace("distal_m", "hidden_word");
    for secret in [
        "word",
        "root:word:0\n",
        "hidden = \"word\"",
        "[registry]\ntoken = \"word\"",
        "machine = \"word\"",
        &hidden,
        &cut,
    ] {
        write("secret", secret);
        let answer = machine();
        assert!(answer.starts_with("HTTP/1.1 404"), "{secret}: {answer}");
        assert!(!answer.contains("word"), "{secret}: {answer}");
        let arguments = ["ui", "job.toml", "--port", "0", "--page", "page.html"];
        let refused = crate::common::command(folder.path(), &arguments).output();
        assert_eq!(refused.expect("an end").status.code(), Some(2));
    }
}

#[test]
fn bytes_go_both_ways_for_one_page_at_a_time() {
    let folder = folder_with_page();
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let board = format!("tcp:{}", listener.local_addr().expect("an address"));
    let served = Served::new(folder.path(), "my.toml", &["--board", &board]);
    let origin = format!("http://{}", served.address);
    let mut page = connected(&served, Some(&origin)).expect("connected");
    let (mut line, _) = listener.accept().expect("the line");
    page.send(Message::binary(&b"\x02\x00 to the board"[..]))
        .expect("sent");
    let mut bytes = [0; 15];
    line.read_exact(&mut bytes).expect("bytes");
    assert_eq!(&bytes, b"\x02\x00 to the board");
    line.write_all(b"\xff\x00 to the page").expect("written");
    assert_eq!(
        page.read().expect("bytes"),
        Message::binary(&b"\xff\x00 to the page"[..])
    );

    let mut other = connected(&served, Some(&origin)).expect("connected");
    assert!(reason(&mut other).contains("another page has the board"));

    // The page goes: so does the board's line, and the next page gets it.
    drop(page);
    assert_eq!(line.read(&mut bytes).expect("the end"), 0);
    let mut page = loop {
        let mut page = connected(&served, Some(&origin)).expect("connected");
        page.get_ref()
            .set_read_timeout(Some(Duration::from_millis(200)))
            .expect("set");
        match page.read() {
            Err(Error::Io(_)) => break page,
            _ => continue,
        }
    };
    let (line, _) = listener.accept().expect("the line");
    drop(line);
    page.get_ref().set_read_timeout(None).expect("set");
    let why = reason(&mut page);
    assert!(why.contains(&board) && why.contains("closed"), "{why}");

    // Without the board a page hears so.
    drop(listener);
    let mut page = connected(&served, Some(&origin)).expect("connected");
    let why = reason(&mut page);
    assert!(why.contains("nothing listens there"), "{why}");
}

/// A browser opens connections ahead of its requests: it would take an answer for that to the request that it is about to send.
#[test]
fn a_connection_without_a_request_is_closed_without_an_answer() {
    let folder = folder_with_page();
    let served = Served::new(folder.path(), "my.toml", &[]);
    for (sent, answered) in [("", ""), ("GET /\r\n\r\n", "HTTP/1.1 400")] {
        let mut line = TcpStream::connect(&served.address).expect("a connection");
        line.write_all(sent.as_bytes()).expect("written");
        let mut answer = String::new();
        line.read_to_string(&mut answer).expect("the end");
        assert!(answer.starts_with(answered), "{answer}");
        assert_eq!(answer.is_empty(), answered.is_empty(), "{answer}");
    }
}

#[test]
fn a_program_without_a_board_has_no_way_to_one() {
    let folder = folder_with_page();
    let served = Served::new(folder.path(), "my.toml", &[]);
    let origin = format!("http://{}", served.address);
    assert_eq!(connected(&served, Some(&origin)).map(|_| ()), Err(404));
    assert!(!served.get("/", &served.address).contains("data-board"));
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

#[test]
fn the_page_and_the_scene_as_it_is_now_are_served_to_this_computer() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name);
    fs::write(file("page.html"), PAGE).expect("written");
    fs::write(file("my.toml"), "name = \"one\"\n").expect("written");
    let served = Served::new(folder.path(), "my.toml", &[]);
    let page = served.get("/", &served.address);
    assert!(page.starts_with("HTTP/1.1 200 OK"), "{page}");
    assert!(
        page.ends_with("<html lang=\"en\" data-scene=\"scene.toml\"><title>trirrr</title>"),
        "{page}"
    );
    assert!(
        served
            .get("/scene.toml", &served.address)
            .ends_with("\r\n\r\nname = \"one\"\n")
    );
    fs::write(file("my.toml"), "name = \"two\"\n").expect("written");
    assert!(
        served
            .get("/scene.toml", "localhost")
            .ends_with("\r\n\r\nname = \"two\"\n")
    );
    assert!(
        served
            .get("/my.toml", &served.address)
            .starts_with("HTTP/1.1 404")
    );
    assert!(
        served
            .get("/scene.toml", "example.org")
            .starts_with("HTTP/1.1 403")
    );
}

#[test]
fn a_page_that_is_missing_or_another_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("other.html"), "<p>").expect("written");
    for (page, said) in [
        ("none.html", "cannot be read"),
        ("other.html", "`cargo xtask page` writes"),
    ] {
        let arguments = ["ui", "--page", page, "--port", "0"];
        let output = crate::common::command(folder.path(), &arguments)
            .output()
            .expect("output");
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(page) && error.contains(said), "{error}");
    }
}
