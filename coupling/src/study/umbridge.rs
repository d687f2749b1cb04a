//! The protocol of UM-Bridge 1.0 (Seelinger et al. 2023, Journal of Open Source Software 8), by which tools of uncertainty
//! quantification call a model: five routes of HTTP with JSON bodies. Pure: a request in, an answer out.

use serde_json::{Map, Value, json};

/// Name of the model.
pub const MODEL: &str = "forward";
/// Version of the protocol.
const VERSION: f64 = 1.0;

/// A model of numbers.
pub trait Model {
    /// Numbers that it takes.
    fn n_inputs(&self) -> usize;

    /// Numbers that it gives.
    fn n_outputs(&self) -> usize;

    /// Its outputs.
    ///
    /// # Errors
    ///
    /// [`Fault`] for inputs that cannot be, and for a run that fails.
    fn evaluate(&self, inputs: &[f64], config: &Map<String, Value>) -> Result<Vec<f64>, Fault>;
}

/// An error of the protocol.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Type.
    pub kind: FaultKind,
    /// For the user of the client.
    pub message: String,
}

/// Type of an error of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// No such model.
    ModelNotFound,
    /// Derivatives.
    UnsupportedFeature,
    /// Wrong sizes, values, or text.
    InvalidInput,
    /// A run without the outputs.
    InvalidOutput,
}

/// Answer to a request.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Status of HTTP.
    pub status: u16,
    /// Body.
    pub body: Value,
}

impl Fault {
    /// An error.
    pub fn new(kind: FaultKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
        }
    }
}

impl FaultKind {
    fn as_str(self) -> &'static str {
        match self {
            Self::ModelNotFound => "ModelNotFound",
            Self::UnsupportedFeature => "UnsupportedFeature",
            Self::InvalidInput => "InvalidInput",
            Self::InvalidOutput => "InvalidOutput",
        }
    }
}

impl From<Fault> for Answer {
    fn from(fault: Fault) -> Self {
        let status = match fault.kind {
            FaultKind::InvalidOutput => 500,
            _ => 400,
        };
        let (kind, message) = (fault.kind.as_str(), fault.message);
        Self {
            status,
            body: json!({"error": {"type": kind, "message": message}}),
        }
    }
}

/// Answers a request.
pub fn answer(method: &str, path: &str, body: &[u8], model: &dyn Model) -> Answer {
    let found = match (method, path) {
        ("GET", "/Info") => Ok(json!({"protocolVersion": VERSION, "models": [MODEL]})),
        ("POST", "/ModelInfo") => request(body).map(|_| {
            json!({"support": {
                "Evaluate": true, "Gradient": false, "ApplyJacobian": false, "ApplyHessian": false
            }})
        }),
        ("POST", "/InputSizes") => request(body).map(|_| json!({"inputSizes": [model.n_inputs()]})),
        ("POST", "/OutputSizes") => {
            request(body).map(|_| json!({"outputSizes": [model.n_outputs()]}))
        }
        ("POST", "/Evaluate") => request(body).and_then(|request| evaluate(&request, model)),
        ("POST", "/Gradient" | "/ApplyJacobian" | "/ApplyHessian") => {
            let message = "the model has no derivatives; it supports Evaluate";
            Err(Fault::new(FaultKind::UnsupportedFeature, message))
        }
        _ => {
            let message = format!(
                "no route {method} {path}; the model has GET /Info and POST /ModelInfo, /InputSizes, /OutputSizes, /Evaluate"
            );
            let fault = Fault::new(FaultKind::InvalidInput, message);
            return Answer {
                status: 404,
                ..fault.into()
            };
        }
    };
    match found {
        Ok(body) => Answer { status: 200, body },
        Err(fault) => fault.into(),
    }
}

/// The object in a body, which names the model.
fn request(body: &[u8]) -> Result<Map<String, Value>, Fault> {
    let invalid = |message: String| Fault::new(FaultKind::InvalidInput, message);
    let value: Value = serde_json::from_slice(body).map_err(|error| {
        invalid(format!(
            "the body is no JSON ({error}); NaN and infinity have no place in it"
        ))
    })?;
    let Value::Object(request) = value else {
        return Err(invalid("the body is no JSON object".into()));
    };
    match request.get("name").and_then(Value::as_str) {
        Some(MODEL) => Ok(request),
        Some(name) => Err(Fault::new(
            FaultKind::ModelNotFound,
            format!("no model `{name}`; there is `{MODEL}`"),
        )),
        None => Err(invalid("`name` of the model is missing".into())),
    }
}

fn evaluate(request: &Map<String, Value>, model: &dyn Model) -> Result<Value, Fault> {
    let invalid = |message: String| Fault::new(FaultKind::InvalidInput, message);
    let n = model.n_inputs();
    let vectors = request.get("input").and_then(Value::as_array);
    let vectors = vectors.ok_or_else(|| invalid(format!("`input` is missing: [[{n} numbers]]")))?;
    let [Value::Array(vector)] = vectors.as_slice() else {
        let count = vectors.len();
        return Err(invalid(format!(
            "`input` has {count} elements, expected one vector: [[{n} numbers]]"
        )));
    };
    if vector.len() != n {
        let message = format!(
            "the input vector has {} numbers, expected {n}",
            vector.len()
        );
        return Err(invalid(message));
    }
    let numbers = vector.iter().enumerate().map(|(k, value)| {
        let number = value.as_f64().filter(|x| x.is_finite());
        number.ok_or_else(|| invalid(format!("input[0][{k}] is {value}, no number")))
    });
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
    let config = match request.get("config") {
        None | Some(Value::Null) => Map::new(),
        Some(Value::Object(config)) => config.clone(),
        Some(other) => return Err(invalid(format!("`config` is {other}, no object"))),
    };
    let outputs = model.evaluate(&numbers, &config)?;
    match outputs.iter().position(|x| !x.is_finite()) {
        Some(k) => Err(Fault::new(
            FaultKind::InvalidOutput,
            format!("output {k} is {}", outputs[k]),
        )),
        None => Ok(json!({"output": [outputs]})),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of two numbers and their product.
    struct Sum;

    impl Model for Sum {
        fn n_inputs(&self) -> usize {
            2
        }

        fn n_outputs(&self) -> usize {
            2
        }

        fn evaluate(&self, inputs: &[f64], config: &Map<String, Value>) -> Result<Vec<f64>, Fault> {
            let factor = config.get("factor").and_then(Value::as_f64).unwrap_or(1.0);
            Ok(vec![
                factor * (inputs[0] + inputs[1]),
                inputs[0] * inputs[1],
            ])
        }
    }

    fn post(path: &str, body: &str) -> Answer {
        answer("POST", path, body.as_bytes(), &Sum)
    }

    #[test]
    fn the_five_routes_answer() {
        let info = answer("GET", "/Info", b"", &Sum);
        assert_eq!(
            info.body,
            json!({"protocolVersion": 1.0, "models": ["forward"]})
        );
        let name = r#"{"name": "forward", "config": {}}"#;
        assert_eq!(post("/ModelInfo", name).body["support"]["Evaluate"], true);
        assert_eq!(post("/InputSizes", name).body, json!({"inputSizes": [2]}));
        assert_eq!(post("/OutputSizes", name).body, json!({"outputSizes": [2]}));
        let found = post(
            "/Evaluate",
            r#"{"name": "forward", "input": [[1.5, 2]], "config": {"factor": 2}}"#,
        );
        assert_eq!(
            (found.status, found.body),
            (200, json!({"output": [[7.0, 3.0]]}))
        );
    }

    #[test]
    fn errors_have_the_type_of_the_protocol() {
        for (path, body, kind, status) in [
            (
                "/Evaluate",
                r#"{"name": "backward", "input": [[1, 2]]}"#,
                "ModelNotFound",
                400,
            ),
            (
                "/Gradient",
                r#"{"name": "forward"}"#,
                "UnsupportedFeature",
                400,
            ),
            (
                "/Evaluate",
                r#"{"name": "forward", "input": [[1]]}"#,
                "InvalidInput",
                400,
            ),
            (
                "/Evaluate",
                r#"{"name": "forward", "input": [[1], [2]]}"#,
                "InvalidInput",
                400,
            ),
            (
                "/Evaluate",
                r#"{"name": "forward", "input": [[1, "2"]]}"#,
                "InvalidInput",
                400,
            ),
            (
                "/Evaluate",
                r#"{"name": "forward", "input": [[1, NaN]]}"#,
                "InvalidInput",
                400,
            ),
            (
                "/Evaluate",
                r#"{"name": "forward", "input": [[1, null]]}"#,
                "InvalidInput",
                400,
            ),
            ("/Evaluate", r#"{"name": "forward"}"#, "InvalidInput", 400),
            (
                "/Evaluate",
                r#"{"name": "forward", "input": [[1, 2]], "config": 3}"#,
                "InvalidInput",
                400,
            ),
            ("/Evaluate", r#"{"input": [[1, 2]]}"#, "InvalidInput", 400),
            ("/Evaluate", "[]", "InvalidInput", 400),
            ("/Evaluate", "", "InvalidInput", 400),
            (
                "/Evaluate",
                r#"{"name": "forward", "input": [[1e308, 1e308]]}"#,
                "InvalidOutput",
                500,
            ),
            ("/Other", r#"{"name": "forward"}"#, "InvalidInput", 404),
        ] {
            let found = post(path, body);
            assert_eq!(found.body["error"]["type"], kind, "{body}: {}", found.body);
            assert_eq!(found.status, status, "{body}");
        }
    }
}
