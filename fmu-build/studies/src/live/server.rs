//! HTTP for one page on this machine.
//!
//! In: a listener on 127.0.0.1, a function from requests to answers. Out: answers to requests that contain the token
//! and come from the page itself. The module must not know the meaning of a request.
//!
//! A page of another site must not reach the server: it does not know the token in the path; with another name of this
//! machine (DNS rebinding) `Host` differs; a request of its script has its `Origin`. One connection is one request, so
//! that no bytes of one request are read as another request.

use anyhow::{Context, Result, anyhow};
use linkage_fmu::fmi::LARGEST_DEFINITION;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

/// Largest number of bytes of the head of a request.
const LARGEST_HEAD: usize = 16 << 10;
/// Largest number of fields of a head.
const FIELDS: usize = 64;
/// Largest number of bytes of a body: values, and a definition as JSON, in which a character may need two bytes.
const LARGEST_BODY: u64 = 2 * LARGEST_DEFINITION + (1 << 20);
/// Longest time that a client may send or receive nothing.
const PATIENCE: Duration = Duration::from_secs(10);
/// Largest number of simultaneous connections.
const CONNECTIONS: usize = 64;
/// Number of bytes of a rejected body that are read, so that the answer arrives.
const DRAINED: u64 = 1 << 16;
/// The page may only use its own text and its server. No page may contain it in a frame.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Address of the page.
pub struct Site {
    /// Names of the server in `Host`.
    hosts: [String; 2],
    token: String,
}

/// A request to the page's own address.
pub struct Request {
    /// Method, such as `GET`.
    pub method: String,
    /// Path after the token, without a leading slash.
    pub path: String,
    /// Query, without the question mark.
    pub query: String,
    body: Vec<u8>,
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    status: u16,
    kind: &'static str,
    body: Vec<u8>,
    /// Redirection to another address of the page.
    location: Option<String>,
}

impl Site {
    /// A site on this port, with a new token.
    ///
    /// # Errors
    /// The system provides no random numbers.
    pub fn new(port: u16) -> Result<Self> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|error| {
            anyhow!(
                "the system returned no random numbers for the address \
            of the page: {error}"
            )
        })?;
        let token = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { hosts: ["127.0.0.1", "localhost"].map(|host| format!("{host}:{port}")), token })
    }

    /// Address of the page.
    pub fn address(&self) -> String {
        format!("http://{}/{}/", self.hosts[0], self.token)
    }

    /// The path after the token and the query, if the request is allowed.
    fn admitted(&self, head: &httparse::Request) -> Result<(String, String), Answer> {
        let host = only(head, "host").unwrap_or_default();
        if !self.hosts.contains(&host) {
            return Err(Answer::refused(403, "the request names another host than the page"));
        }
        let is_own = |origin: String| origin.strip_prefix("http://") == Some(&host);
        let origin = only(head, "origin");
        let is_read = head.method == Some("GET");
        if !origin.map_or(is_read && !has(head, "origin"), is_own) {
            return Err(Answer::refused(403, "only the page that --live opens may send this request"));
        }
        if !only(head, "sec-fetch-site").is_none_or(|site| site == "same-origin" || site == "none") {
            return Err(Answer::refused(403, "only the page that --live opens may send this request"));
        }
        let target = head.path.unwrap_or_default();
        let (path, query) = target.split_once('?').unwrap_or((target, ""));
        let own = path.strip_prefix('/').unwrap_or_default();
        if is_same(own, &self.token) {
            return Err(Answer {
                location: Some(format!("/{own}/")),
                ..Answer::refused(308, "the address ends with /")
            });
        }
        match own.split_once('/').filter(|(token, _)| is_same(token, &self.token)) {
            Some((_, path)) => Ok((path.to_owned(), query.to_owned())),
            None => Err(Answer::refused(404, "there is no page at this address")),
        }
    }
}

/// Whether two texts are equal. The time does not depend on the place of a difference.
fn is_same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}

/// Whether a head has this field.
fn has(head: &httparse::Request, name: &str) -> bool {
    head.headers.iter().any(|field| field.name.eq_ignore_ascii_case(name))
}

/// Value of a field that occurs once in a head.
fn only(head: &httparse::Request, name: &str) -> Option<String> {
    let mut all = head.headers.iter().filter(|field| field.name.eq_ignore_ascii_case(name));
    let value = all.next().filter(|_| all.next().is_none())?;
    String::from_utf8(value.value.to_vec()).ok()
}

impl Request {
    /// The body as JSON.
    ///
    /// # Errors
    /// The body is no JSON, or has another structure.
    pub fn json<T: DeserializeOwned>(&self) -> Result<T> {
        serde_json::from_slice(&self.body).context("the body of the request")
    }
}

impl Answer {
    /// A page.
    pub fn page(html: String) -> Self {
        Self { status: 200, kind: "text/html; charset=utf-8", body: html.into_bytes(), location: None }
    }

    /// JSON.
    pub fn json(value: &impl Serialize) -> Self {
        match serde_json::to_vec(value) {
            Ok(body) => Self { status: 200, kind: "application/json", body, location: None },
            Err(error) => Self::refused(500, &error.to_string()),
        }
    }

    /// A rejection with its reason.
    pub fn refused(status: u16, why: &str) -> Self {
        Self { status, kind: "text/plain; charset=utf-8", body: why.into(), location: None }
    }

    fn write(&self, stream: &mut TcpStream) -> io::Result<()> {
        let Self { status, kind, body, location } = self;
        let word = if *status < 300 { "OK" } else { "Refused" };
        let location = location.as_ref().map_or_else(String::new, |path| format!("Location: {path}\r\n"));
        let head = format!(
            "HTTP/1.1 {status} {word}\r\n{location}Content-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\
             Cache-Control: no-store\r\nContent-Security-Policy: {POLICY}\r\nX-Content-Type-Options: nosniff\r\n\
             Referrer-Policy: no-referrer\r\nCross-Origin-Opener-Policy: same-origin\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\n\r\n",
            body.len()
        );
        stream.write_all(&[head.as_bytes(), body].concat())?;
        stream.shutdown(Shutdown::Write)
    }
}

/// Answer requests without end.
pub fn serve(listener: &TcpListener, site: &Arc<Site>, answer: impl Fn(&Request) -> Answer + Send + Sync + 'static) {
    let (open, answer) = (Arc::new(AtomicUsize::new(0)), Arc::new(answer));
    for stream in listener.incoming() {
        let Ok(mut stream) = stream else {
            // The system has no free handle at present.
            thread::sleep(Duration::from_millis(50));
            continue;
        };
        let place = Place::take(&open);
        let (site, answer) = (Arc::clone(site), Arc::clone(&answer));
        thread::spawn(move || {
            let outcome = match place {
                Some(_) => read(&mut stream, &site).map(|request| answer(&request)),
                None => Err(Answer::refused(503, "too many connections")),
            };
            let rejected = outcome.is_err();
            // A disconnected client needs no answer.
            if outcome.unwrap_or_else(|refused| refused).write(&mut stream).is_ok() && rejected {
                let _ = io::copy(&mut (&mut stream).take(DRAINED), &mut io::sink());
            }
            drop(place);
        });
    }
}

/// One of the allowed connections.
struct Place(Arc<AtomicUsize>);

impl Place {
    fn take(open: &Arc<AtomicUsize>) -> Option<Self> {
        let before = open.fetch_add(1, Ordering::Relaxed);
        let place = Self(Arc::clone(open));
        (before < CONNECTIONS).then_some(place)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// A complete and allowed request.
fn read(stream: &mut TcpStream, site: &Site) -> Result<Request, Answer> {
    let lost = |_| Answer::refused(408, "the request was not complete in time");
    stream.set_read_timeout(Some(PATIENCE)).map_err(lost)?;
    stream.set_write_timeout(Some(PATIENCE)).map_err(lost)?;
    let mut bytes = Vec::new();
    let mut block = [0; 4096];
    loop {
        let count = stream.read(&mut block).map_err(lost)?;
        bytes.extend_from_slice(&block[..count]);
        let mut fields = [httparse::EMPTY_HEADER; FIELDS];
        let mut head = httparse::Request::new(&mut fields);
        match head.parse(&bytes) {
            Ok(httparse::Status::Complete(length)) => {
                let (path, query) = site.admitted(&head)?;
                let method = head.method.unwrap_or_default().to_owned();
                let expected = length_of_body(&head)?;
                let mut body = bytes.split_off(length);
                let left = expected.saturating_sub(body.len() as u64);
                stream.take(left).read_to_end(&mut body).map_err(lost)?;
                if body.len() as u64 != expected {
                    return Err(Answer::refused(
                        400,
                        "the HTTP request has a content of another length than its Content-Length header states",
                    ));
                }
                return Ok(Request { method, path, query, body });
            }
            Ok(httparse::Status::Partial) if count > 0 && bytes.len() < LARGEST_HEAD => {}
            Ok(httparse::Status::Partial) => {
                return Err(Answer::refused(431, "the head of the HTTP request is too long or not complete"));
            }
            Err(_) => return Err(Answer::refused(400, "this is not a request of HTTP 1.1")),
        }
    }
}

/// Length of the body. A page of another site cannot send JSON without a preflight request, which is not answered.
fn length_of_body(head: &httparse::Request) -> Result<u64, Answer> {
    if has(head, "transfer-encoding") {
        return Err(Answer::refused(411, "the HTTP request has no valid Content-Length header; send this header"));
    }
    if !has(head, "content-length") {
        return Ok(0);
    }
    let stated = only(head, "content-length").filter(|text| text.bytes().all(|byte| byte.is_ascii_digit()));
    let length = stated.and_then(|length| length.parse().ok()).ok_or_else(|| Answer::refused(400, "no length"))?;
    if length > LARGEST_BODY {
        return Err(Answer::refused(413, "the content of the HTTP request is too large"));
    }
    if length > 0 && only(head, "content-type").is_none_or(|kind| kind != "application/json") {
        return Err(Answer::refused(415, "the content of the HTTP request must be JSON"));
    }
    Ok(length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::Ipv4Addr;

    /// Status of the answer to these bytes. `HOST` and `TOKEN` are replaced by the valid ones.
    fn status(port: u16, token: &str, request: &str) -> u16 {
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        let request = request.replace("HOST", &format!("127.0.0.1:{port}")).replace("TOKEN", token);
        stream.write_all(request.as_bytes()).unwrap();
        stream.shutdown(Shutdown::Write).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(answer.contains("frame-ancestors 'none'"), "{answer}");
        answer[9..12].parse().unwrap()
    }

    #[test]
    fn only_the_page_itself_is_answered() {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        let site = Arc::new(Site::new(port).unwrap());
        let token = site.token.clone();
        thread::spawn(move || {
            serve(&listener, &site, |request| {
                assert!(request.path.is_empty() && request.body.len() < 3, "{}", request.path);
                Answer::json(&request.query)
            });
        });
        let post = "POST /TOKEN/ HTTP/1.1\r\nHost: HOST\r\n";
        let json = "Content-Type: application/json\r\nContent-Length: 2\r\n";
        for (request, expected) in [
            ("GET /TOKEN/ HTTP/1.1\r\nHost: HOST\r\n\r\n".to_owned(), 200),
            ("GET /TOKEN/?a HTTP/1.1\r\nHost: HOST\r\nOrigin: http://HOST\r\n\r\n".into(), 200),
            (format!("{post}Origin: http://HOST\r\n{json}\r\n{{}}"), 200),
            ("GET /TOKEN HTTP/1.1\r\nHost: HOST\r\n\r\n".into(), 308),
            ("GET /TOKEN HTTP/1.1\r\nHost: evil.example\r\n\r\n".into(), 403),
            ("GET /0123456789abcdef0123456789abcdef/ HTTP/1.1\r\nHost: HOST\r\n\r\n".into(), 404),
            ("GET /../TOKEN/ HTTP/1.1\r\nHost: HOST\r\n\r\n".into(), 404),
            ("GET http://HOST/TOKEN/ HTTP/1.1\r\nHost: HOST\r\n\r\n".into(), 404),
            ("GET /TOKEN/ HTTP/1.1\r\n\r\n".into(), 403),
            ("GET /TOKEN/ HTTP/1.1\r\nHost: evil.example\r\n\r\n".into(), 403),
            ("GET /TOKEN/ HTTP/1.1\r\nHost: HOST\r\nHost: HOST\r\n\r\n".into(), 403),
            ("GET /TOKEN/ HTTP/1.1\r\nHost: HOST\r\nOrigin: https://HOST\r\n\r\n".into(), 403),
            ("GET /TOKEN/ HTTP/1.1\r\nHost: HOST\r\nOrigin: null\r\n\r\n".into(), 403),
            ("GET /TOKEN/ HTTP/1.1\r\nHost: HOST\r\nSec-Fetch-Site: cross-site\r\n\r\n".into(), 403),
            (format!("{post}{json}\r\n{{}}"), 403),
            (format!("{post}Origin: http://evil.example\r\n{json}\r\n{{}}"), 403),
            (format!("{post}Origin: http://HOST\r\nContent-Length: 2\r\n\r\n{{}}"), 415),
            (format!("{post}Origin: http://HOST\r\n{json}\r\n{{"), 400),
            (format!("{post}Origin: http://HOST\r\n{json}{json}\r\n{{}}"), 400),
            (format!("{post}Origin: http://HOST\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n{{}}\r\n0\r\n\r\n"), 411),
            (format!("{post}Origin: http://HOST\r\nContent-Length: 99999999999\r\n\r\n{{}}"), 413),
            (format!("GET /TOKEN/ HTTP/1.1\r\nA: {}", "a".repeat(20_000)), 431),
            ("GET /TOKEN/ HTTP/1.1\r\nHost: HOST".into(), 431),
            ("\u{16}\u{3}\u{1} hello\r\n\r\n".into(), 400),
        ] {
            assert_eq!(status(port, &token, &request), expected, "{}", &request[..request.len().min(200)]);
        }
    }
}
