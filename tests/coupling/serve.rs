//! `riprap serve`: a client of UM-Bridge gets the numbers of the command line, wrong requests the errors of the protocol, and the
//! server lives on.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};

use crate::evidence::THROWN;
use crate::support::{riprap, words};

/// Water thrown down; the first input is its speed.
const SWEEP: &str = "(title: \"thrown\", case: \"thrown.ron\", design: Grid,\n\
     inputs: [\n\
       (name: \"speed\", set: [\"fluid.regions.water.velocity=(0, 0, -{})\"], values: Numbers([0.5])),\n\
       (name: \"sound\", set: [\"numerics.sound_speed={}\"], values: Numbers([20]))],\n\
     outputs: [\n\
       (name: \"p\", column: \"p\", take: Maximum(from: 0, to: 0.3)),\n\
       (name: \"end\", column: \"p\", take: At(0.3))])";

struct Server {
    child: Child,
    address: String,
}

impl Server {
    fn start(folder: &Path, more: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_riprap"))
            .args(["serve", "sweep.ron", "-o", "out"])
            .args(more)
            .current_dir(folder)
            .env("PORT", "0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut line)
            .unwrap();
        let address = line
            .split("http://")
            .nth(1)
            .unwrap()
            .split(';')
            .next()
            .unwrap();
        Self {
            child,
            address: address.to_owned(),
        }
    }

    /// Sends some bytes and reads to the end.
    fn send(&self, bytes: &[u8]) -> String {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        stream.write_all(bytes).unwrap();
        let mut text = String::new();
        // a server that does not read all of a wrong request may reset the connection
        let _ = stream.read_to_string(&mut text);
        text
    }

    fn ask(&self, method: &str, path: &str, body: &str) -> Value {
        let n = body.len();
        let request =
            format!("{method} {path} HTTP/1.1\r\nHost: x\r\nContent-Length: {n}\r\n\r\n{body}");
        let text = self.send(request.as_bytes());
        serde_json::from_str(text.split("\r\n\r\n").nth(1).unwrap_or_default()).unwrap()
    }

    fn evaluate(&self, input: Value, config: Value) -> Value {
        let body = json!({"name": "forward", "input": [input], "config": config});
        self.ask("POST", "/Evaluate", &body.to_string())
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn a_client_gets_the_numbers_of_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("thrown.ron"), THROWN).unwrap();
    std::fs::write(at("sweep.ron"), SWEEP).unwrap();
    let (file, alone) = (at("sweep.ron"), at("alone"));
    let output = riprap(&[
        "sweep",
        file.to_str().unwrap(),
        "-o",
        alone.to_str().unwrap(),
    ]);
    assert!(output.status.success(), "{}", words(&output));
    let table = std::fs::read_to_string(alone.join("collected.csv")).unwrap();
    let cells: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    let expected: Vec<f64> = cells[3..5]
        .iter()
        .map(|cell| cell.parse().unwrap())
        .collect();

    let server = Server::start(folder.path(), &[]);
    assert!(
        server.address.starts_with("127.0.0.1:"),
        "the loopback unless told otherwise"
    );
    assert_eq!(server.ask("GET", "/Info", "")["models"], json!(["forward"]));
    let name = json!({"name": "forward", "config": {}}).to_string();
    assert_eq!(
        server.ask("POST", "/InputSizes", &name)["inputSizes"],
        json!([2])
    );
    assert_eq!(
        server.ask("POST", "/OutputSizes", &name)["outputSizes"],
        json!([2])
    );
    assert_eq!(
        server.ask("POST", "/ModelInfo", &name)["support"]["Gradient"],
        false
    );

    // bit for bit, through text
    let found = server.evaluate(json!([0.5, 20]), json!({}));
    assert_eq!(found, json!({"output": [expected]}));
    let runs = || {
        let entries = std::fs::read_dir(at("out"))
            .unwrap()
            .map(|entry| entry.unwrap().path());
        let mut runs: Vec<_> = entries
            .filter(|path| path.is_dir())
            .map(|path| {
                let ended = std::fs::metadata(path.join("ended.json")).unwrap();
                (path, ended.modified().unwrap())
            })
            .collect();
        runs.sort();
        runs
    };
    let before = runs();
    assert_eq!(before.len(), 1);
    // the second time it is not run, nor for another way to write the numbers
    assert_eq!(server.evaluate(json!([0.5, 20.0]), json!({})), found);
    assert_eq!(runs(), before);
    // another level is another run
    let coarse = server.evaluate(json!([0.5, 20]), json!({"spacing": 0.05}));
    assert!(
        coarse["output"][0][0].is_f64() && coarse != found,
        "{coarse}"
    );
    assert_eq!(runs().len(), 2);

    let kind = |found: Value| {
        found["error"]["type"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    };
    let evaluate = |input| kind(server.evaluate(input, json!({})));
    assert_eq!(evaluate(json!([0.5])), "InvalidInput");
    assert_eq!(evaluate(json!([0.5, null])), "InvalidInput");
    assert_eq!(evaluate(json!([0.5, -1])), "InvalidInput");
    // it is compressed by more than it may be
    let failed = server.evaluate(json!([6, 9]), json!({}));
    assert!(
        failed["error"]["message"]
            .as_str()
            .unwrap()
            .contains("the run failed"),
        "{failed}"
    );
    assert_eq!(kind(failed), "InvalidOutput");
    for config in [
        json!({"spacing": -1}),
        json!({"spacing": 1, "error": 0.1}),
        json!({"level": 1}),
        json!({"error": 7}),
    ] {
        assert_eq!(
            kind(server.evaluate(json!([0.5, 20]), config)),
            "InvalidInput"
        );
    }
    let other = json!({"name": "other", "input": [[1, 2]]}).to_string();
    assert_eq!(
        kind(server.ask("POST", "/Evaluate", &other)),
        "ModelNotFound"
    );
    assert_eq!(
        kind(server.ask("POST", "/Gradient", &name)),
        "UnsupportedFeature"
    );
    assert_eq!(
        kind(server.ask(
            "POST",
            "/Evaluate",
            "{\"name\": \"forward\", \"input\": [[NaN, 1]]}"
        )),
        "InvalidInput"
    );
    // nonsense, a head without end, a body that is too long, and one that does not come
    for bytes in [
        b"\r\n\r\n".to_vec(),
        vec![b'x'; 100_000],
        b"POST /Evaluate HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n".to_vec(),
        b"POST /Evaluate HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n".to_vec(),
    ] {
        server.send(&bytes);
    }
    drop(TcpStream::connect(&server.address).unwrap());
    assert_eq!(server.evaluate(json!([0.5, 20]), json!({})), found);
}

#[test]
fn what_cannot_be_served_is_said_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("thrown.ron"), THROWN).unwrap();
    let refused = |text: &str, more: &[&str]| {
        std::fs::write(at("sweep.ron"), text).unwrap();
        let file = at("sweep.ron");
        let mut arguments = vec!["serve", file.to_str().unwrap()];
        arguments.extend(more);
        let output = riprap(&arguments);
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        words(&output)
    };
    let texts = SWEEP.replace("Numbers([20])", "Texts([\"fast\"])");
    assert!(refused(&texts, &[]).contains("input `sound` has texts for values"));
    let wrong = SWEEP.replace("Numbers([20])", "Numbers([-20])");
    assert!(refused(&wrong, &[]).contains("sound speed must be > 0"));
    assert!(refused(SWEEP, &["--host", "nowhere"]).contains("nowhere"));
}
