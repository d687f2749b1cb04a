//! `riprap serve`: a sweep as a model for tools of uncertainty quantification.

mod http;

use std::collections::BTreeMap;
use std::net::{IpAddr, Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde_json::{Map, Value};

use super::accuracy::{self, Asked, Budget};
use super::run::start_threads;
use super::sweep::Place;
use super::{Exit, Program, failed, refused, say, show, stop_on_signal};
use crate::messages::{Code, Message};
use crate::scene::parse::Override;
use crate::study::sweep::design::median;
use crate::study::sweep::plan::{Row, Sweep, overrides};
use crate::study::sweep::row::{Outcome, Terms, folder_of, run_row};
use crate::study::trade::results::value_of;
use crate::study::umbridge::{Fault, FaultKind, Model};

/// Time between two looks for a client.
const WAIT: Duration = Duration::from_millis(10);
/// Port of UM-Bridge.
const PORT: u16 = 4242;

/// Serve a sweep as a model to UM-Bridge clients.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    place: Place,
    /// Port; that of the environment variable PORT, or else 4242, when left out. 0 chooses a free one.
    #[arg(long, value_name = "N")]
    port: Option<u16>,
    /// Address to listen at; this machine alone when left out. There is no protection: whoever reaches it may start runs.
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    host: IpAddr,
    /// Threads of a run; all cores when left out.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

pub(crate) fn execute(arguments: &Arguments, program: &Program) -> Exit {
    serve(arguments, program).unwrap_or_else(|exit| exit)
}

fn serve(arguments: &Arguments, program: &Program) -> Result<Exit, Exit> {
    let (sweep, runs) = arguments.place.load()?;
    let unusable = |message: String| refused(Message::new(Code::UnusableStudy, message));
    // a wrong sweep is told now, not to the first client
    let median: Vec<String> = sweep.file.inputs.iter().map(median).collect();
    if let Some((input, _)) =
        (sweep.file.inputs.iter().zip(&median)).find(|(_, value)| value.parse::<f64>().is_err())
    {
        return Err(unusable(format!(
            "input `{}` has texts for values, but clients send numbers",
            input.name
        )));
    }
    let row = Row {
        number: 0,
        overrides: overrides(&sweep.file, &median, None),
        inputs: median,
        replica: None,
    };
    sweep.plan(&row).map_err(refused)?;
    start_threads(arguments.threads)?;
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signal(&stop);
    let cannot = |error: std::io::Error| {
        let message = format!("cannot listen at {}: {error}", arguments.host);
        failed(Message::new(Code::UnusableArgument, message))
    };
    let listener = TcpListener::bind((arguments.host, port(arguments)?)).map_err(cannot)?;
    listener.set_nonblocking(true).map_err(cannot)?;
    let address = listener.local_addr().map_err(cannot)?;
    let model = Forward {
        sweep: &sweep,
        runs: &runs,
        median: row,
        stop: &stop,
        program,
        jobs: arguments.threads,
        levels: Mutex::new(BTreeMap::new()),
        turn: Mutex::new(()),
    };
    show(&format!(
        "model `forward` of {} inputs and {} outputs at http://{address}; Ctrl-C ends it",
        model.n_inputs(),
        model.n_outputs()
    ));
    std::thread::scope(|scope| {
        while !stop.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, _)) => {
                    let model = &model;
                    scope.spawn(move || http::converse(stream, model));
                }
                // nobody there, or one that has gone again
                Err(_) => std::thread::sleep(WAIT),
            }
        }
    });
    Ok(Exit::Interrupted)
}

/// The port of the command line, the environment, or the protocol.
fn port(arguments: &Arguments) -> Result<u16, Exit> {
    let of_environment = || match std::env::var("PORT") {
        Ok(text) => text.parse().map_err(|_| {
            let message = format!("the environment has PORT={text}, no port from 0 to 65535");
            refused(Message::new(Code::UnusableArgument, message))
        }),
        Err(_) => Ok(PORT),
    };
    arguments.port.map_or_else(of_environment, Ok)
}

/// The runs of a sweep as a model.
struct Forward<'a> {
    sweep: &'a Sweep,
    runs: &'a Path,
    /// The row of all medians, for which levels are chosen.
    median: Row,
    stop: &'a AtomicBool,
    program: &'a Program,
    jobs: Option<usize>,
    /// Overrides of error budgets chosen so far.
    levels: Mutex<BTreeMap<String, Vec<Override>>>,
    /// One run at a time: each takes all threads.
    turn: Mutex<()>,
}

impl Model for Forward<'_> {
    fn n_inputs(&self) -> usize {
        self.sweep.file.inputs.len()
    }

    fn n_outputs(&self) -> usize {
        self.sweep.file.outputs.len()
    }

    fn evaluate(&self, inputs: &[f64], config: &Map<String, Value>) -> Result<Vec<f64>, Fault> {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let inputs: Vec<String> = inputs.iter().map(f64::to_string).collect();
        let mut all = overrides(&self.sweep.file, &inputs, None);
        all.extend(self.level(config)?);
        let row = Row {
            number: 0,
            inputs,
            replica: None,
            overrides: all,
        };
        let invalid = |error: Message| Fault::new(FaultKind::InvalidInput, error.to_string());
        let no_output = |message: String| Fault::new(FaultKind::InvalidOutput, message);
        let (scene, planned) = self.sweep.scene_of(&row).map_err(invalid)?;
        let terms = Terms {
            case: &self.sweep.case(),
            runs: self.runs,
            wall_limit: None,
            stop: self.stop,
            checkpoint_wanted: Arc::default(),
        };
        let outcome = run_row(scene, &planned.key, terms).map_err(|e| no_output(e.to_string()))?;
        match outcome {
            Outcome::Ended(ended) if ended.completed => {}
            Outcome::Ended(ended) => {
                return Err(no_output(format!("the run failed: {}", ended.message)));
            }
            Outcome::Stopped | Outcome::OutOfTime => {
                return Err(no_output(
                    "the server was stopped; the run goes on from its checkpoint when asked again"
                        .into(),
                ));
            }
        }
        let folder = folder_of(self.runs, &planned.key);
        let outputs = self.sweep.file.outputs.iter().zip(&planned.blocks);
        outputs
            .map(|(output, block)| value_of(output, *block, &folder).map_err(no_output))
            .collect()
    }
}

impl Forward<'_> {
    /// Overrides of a level: of a spacing, or of an error budget.
    fn level(&self, config: &Map<String, Value>) -> Result<Vec<Override>, Fault> {
        let invalid = |message: String| Fault::new(FaultKind::InvalidInput, message);
        let known = ["spacing", "error", "of"];
        if let Some(key) = config.keys().find(|key| !known.contains(&key.as_str())) {
            return Err(invalid(format!(
                "config has `{key}`; it may have `spacing` in m, or `error` such as 0.05 with `of`, the quantity of the error"
            )));
        }
        match (config.get("spacing"), config.get("error")) {
            (None, None) => Ok(Vec::new()),
            (Some(_), Some(_)) => Err(invalid(
                "config has both `spacing` and `error`: an error chooses its spacing".into(),
            )),
            (Some(spacing), None) => match spacing.as_f64().filter(|x| 0.0 < *x) {
                Some(spacing) => Ok(vec![Override {
                    path: "fluid.resolution".into(),
                    value: format!("Spacing({spacing})"),
                }]),
                None => Err(invalid(format!(
                    "config.spacing is {spacing}, expected a number > 0; m"
                ))),
            },
            (None, Some(error)) => self.level_of_error(error, config.get("of")),
        }
    }

    /// Overrides of an error budget, chosen once for the medians of the inputs, so that a level is one model.
    fn level_of_error(&self, error: &Value, of: Option<&Value>) -> Result<Vec<Override>, Fault> {
        let invalid = |message: String| Fault::new(FaultKind::InvalidInput, message);
        let text = error
            .as_str()
            .map_or_else(|| error.to_string(), str::to_owned);
        let budget: Budget = text.parse().map_err(invalid)?;
        let of = of.and_then(Value::as_str);
        let name = format!("{text} {}", of.unwrap_or_default());
        let mut levels = self.levels.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(level) = levels.get(&name) {
            return Ok(level.clone());
        }
        let (scene, _) = self
            .sweep
            .scene_of(&self.median)
            .map_err(|e| invalid(e.to_string()))?;
        let folder: PathBuf = self
            .runs
            .join("levels")
            .join(name.replace(['%', ' ', '/'], "_"));
        let asked = Asked {
            case: &self.sweep.case(),
            budget,
            of,
            overrides: &self.median.overrides,
            folder: &folder,
            program: self.program,
            jobs: self.jobs,
        };
        let chosen = accuracy::plan(&asked, &scene, self.stop).map_err(|_| {
            say("no level for a client's error budget");
            invalid(format!("no settings are known for an error of {text}: the server says why; give `of` or a `spacing`"))
        })?;
        levels.insert(name, chosen.overrides.clone());
        Ok(chosen.overrides)
    }
}
