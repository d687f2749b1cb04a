//! As much of HTTP/1.1 as clients of the protocol speak: one request a connection, with its length in the head.

use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::time::Duration;

use crate::study::umbridge::{Answer, Fault, FaultKind, Model, answer};

/// Largest head of a request; bytes.
const LARGEST_HEAD: u64 = 16_384;
/// Largest body of a request; bytes.
const LARGEST_BODY: usize = 1_048_576;
/// Time that a client may take to send its request, and to take its answer.
const PATIENCE: Duration = Duration::from_secs(10);

/// A request.
struct Request {
    method: String,
    path: String,
    body: Vec<u8>,
}

/// Answers the request of a client. One that goes away or sends nonsense harms nobody else.
pub(super) fn converse(stream: TcpStream, model: &dyn Model) {
    let answered = read(&stream).map(|request| match request {
        Ok(Request { method, path, body }) => answer(&method, &path, &body, model),
        Err(fault) => fault.into(),
    });
    if let Ok(answer) = answered {
        // the client is gone
        let _ = write(&stream, &answer);
    }
}

/// The request of a client, or what is wrong with it.
fn read(stream: &TcpStream) -> io::Result<Result<Request, Fault>> {
    // a listener that does not block may pass that on
    stream.set_nonblocking(false)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let invalid = |message: &str| Ok(Err(Fault::new(FaultKind::InvalidInput, message)));
    let mut reader = BufReader::new(stream);
    let mut head = (&mut reader).take(LARGEST_HEAD);
    let mut line = String::new();
    head.read_line(&mut line)?;
    let mut words = line.split_whitespace();
    let (method, target) = match (words.next(), words.next()) {
        (Some(method), Some(target)) => (method.to_owned(), target.to_owned()),
        _ => return invalid("no request of HTTP"),
    };
    let (mut length, mut expects) = (0_usize, false);
    loop {
        line.clear();
        if head.read_line(&mut line)? == 0 {
            return invalid("the head of the request is longer than 16 kB or breaks off");
        }
        let Some((name, value)) = line.trim_end().split_once(':') else {
            break;
        };
        let value = value.trim();
        match name.to_ascii_lowercase().as_str() {
            "content-length" => match value.parse() {
                Ok(given) if given <= LARGEST_BODY => length = given,
                _ => return invalid("content-length is no number up to 1 MB"),
            },
            "transfer-encoding" => return invalid("send content-length, not a transfer encoding"),
            "expect" => expects = true,
            _ => {}
        }
    }
    if expects {
        (&mut &*stream).write_all(b"HTTP/1.1 100 Continue\r\n\r\n")?;
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body)?;
    let path = target
        .split(['?', '#'])
        .next()
        .unwrap_or_default()
        .to_owned();
    Ok(Ok(Request { method, path, body }))
}

fn write(mut stream: &TcpStream, answer: &Answer) -> io::Result<()> {
    let reason = match answer.status {
        200 => "OK",
        404 => "Not Found",
        500 => "Internal Server Error",
        _ => "Bad Request",
    };
    let body = answer.body.to_string();
    let text = format!(
        "HTTP/1.1 {} {reason}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
        answer.status,
        body.len()
    );
    stream.write_all(text.as_bytes())?;
    stream.flush()
}
