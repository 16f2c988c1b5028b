//! `trirrr ui`, as a browser meets it.

mod common;

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Stdio};

/// A page by its first words: the program looks for no more.
const PAGE: &str = "<!doctype html><html lang=\"en\"><title>trirrr</title>";

/// The program, ended with the test.
struct Served {
    program: Child,
    address: String,
}

impl Served {
    fn new(folder: &Path, scene: &str) -> Self {
        let arguments = ["ui", scene, "--port", "0", "--page", "page.html"];
        let mut command = common::command(folder, &arguments);
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
    let served = Served::new(folder.path(), "my.toml");
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
        let output = common::command(folder.path(), &arguments)
            .output()
            .expect("output");
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(page) && error.contains(said), "{error}");
    }
}
