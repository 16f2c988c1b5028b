//! Requests of browsers: their heads, who may make them, and answers.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tungstenite::handshake::machine::TryParse;
use tungstenite::handshake::server::{Request, Response, write_response};
use tungstenite::http::header::{HOST, ORIGIN};
use tungstenite::http::{HeaderName, StatusCode};

/// Longest head of a request, bytes.
const LONGEST_HEAD: usize = 1 << 14;

/// Time that a browser has for its request.
const PATIENCE: Duration = Duration::from_secs(2);

/// Head of a request.
pub(super) enum Head {
    /// A whole one.
    Request(Box<Request>),
    /// Bytes that are none, or not in time.
    Wrong,
    /// Nothing has come. The connection is closed without an answer: a browser opens some ahead of its requests, and would take the answer
    /// for that to a request that it is about to send.
    Nothing,
}

/// Reads the head of a request.
///
/// # Errors
/// The connection.
pub(super) fn read(browser: &mut TcpStream) -> io::Result<Head> {
    browser.set_nonblocking(false)?;
    browser.set_read_timeout(Some(PATIENCE))?;
    browser.set_write_timeout(Some(PATIENCE))?;
    let begin = Instant::now();
    let mut head = Vec::new();
    let mut bytes = [0; 1024];
    while head.len() < LONGEST_HEAD && begin.elapsed() < PATIENCE {
        let length = match browser.read(&mut bytes) {
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => 0,
            read => read?,
        };
        if length == 0 {
            break;
        }
        head.extend_from_slice(&bytes[..length]);
        match Request::try_parse(&head) {
            Ok(Some((_, request))) => return Ok(Head::Request(Box::new(request))),
            Ok(None) => {}
            Err(_) => return Ok(Head::Wrong),
        }
    }
    Ok(match head.is_empty() {
        true => Head::Nothing,
        false => Head::Wrong,
    })
}

/// Answers with `body`, and closes.
///
/// # Errors
/// The connection.
pub(super) fn answer(
    browser: &mut TcpStream,
    status: StatusCode,
    kind: &str,
    body: &str,
) -> io::Result<()> {
    let response = Response::builder()
        .status(status)
        .header("Content-Type", format!("{kind}; charset=utf-8"))
        .header("Content-Length", body.len())
        .header("Cache-Control", "no-store")
        .header("Connection", "close")
        // No other page shows this one, to have its buttons pressed unseen.
        .header("Content-Security-Policy", "frame-ancestors 'none'")
        .header("X-Content-Type-Options", "nosniff")
        .body(())
        .map_err(io::Error::other)?;
    send(browser, &response)?;
    browser.write_all(body.as_bytes())?;
    browser.flush()
}

/// Sends the head of an answer.
///
/// # Errors
/// The connection.
pub(super) fn send(browser: &mut TcpStream, response: &Response) -> io::Result<()> {
    let mut head = Vec::new();
    write_response(&mut head, response).map_err(io::Error::other)?;
    browser.write_all(&head)
}

/// Returns true for a request that names this computer by address or by `localhost`: another site may point a name of its own to this
/// address.
pub(super) fn is_local(request: &Request) -> bool {
    let Some(host) = header(request, &HOST) else {
        return false;
    };
    let name = host.rsplit_once(':').map_or(host, |(name, _)| name);
    ["127.0.0.1", "localhost"].contains(&name)
}

/// Returns true for a request that a page makes which came from this server: browsers name the origin of the page that opens a WebSocket.
pub(super) fn is_own(request: &Request) -> bool {
    let origin = header(request, &ORIGIN);
    let own = header(request, &HOST).map(|host| format!("http://{host}"));
    is_local(request) && origin.is_some() && origin == own.as_deref()
}

/// The value of a header that stands there once.
fn header<'a>(request: &'a Request, name: &HeaderName) -> Option<&'a str> {
    let mut values = request.headers().get_all(name).iter();
    let value = values.next()?.to_str().ok()?;
    values.next().is_none().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(headers: &[(&str, &str)]) -> Request {
        let mut request = Request::builder().uri("/board");
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        request.body(()).unwrap()
    }

    #[test]
    fn a_host_is_this_computer_or_another() {
        for (host, local) in [
            ("127.0.0.1:7340", true),
            ("localhost", true),
            ("example.org:7340", false),
            ("127.0.0.1.example.org", false),
            ("", false),
        ] {
            assert_eq!(is_local(&request(&[("host", host)])), local, "{host:?}");
        }
        assert!(!is_local(&request(&[("origin", "127.0.0.1:7340")])));
        let twice = [("host", "127.0.0.1"), ("host", "127.0.0.1")];
        assert!(!is_local(&request(&twice)));
    }

    #[test]
    fn a_page_of_another_origin_is_none_of_its_own() {
        for (host, origin, own) in [
            ("127.0.0.1:7340", Some("http://127.0.0.1:7340"), true),
            ("localhost:7340", Some("http://localhost:7340"), true),
            ("127.0.0.1:7340", Some("http://127.0.0.1:8000"), false),
            ("127.0.0.1:7340", Some("https://127.0.0.1:7340"), false),
            ("127.0.0.1:7340", Some("http://localhost:7340"), false),
            ("127.0.0.1:7340", Some("https://example.org"), false),
            ("127.0.0.1:7340", Some("null"), false),
            ("127.0.0.1:7340", None, false),
            // A name that another site points here: both agree, and neither is this computer.
            ("example.org:7340", Some("http://example.org:7340"), false),
        ] {
            let mut headers = vec![("host", host)];
            headers.extend(origin.map(|origin| ("origin", origin)));
            assert_eq!(is_own(&request(&headers)), own, "{host} {origin:?}");
        }
    }
}
