//! `riprap.Scene`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use riprap::messages::Coded as _;
use riprap::output::checkpoint_file::{self, Checkpoint};
use riprap::output::run_folder::{self, ArchivedScene, Existing};
use riprap::picture::report;
use riprap::run::preparation::{Beginning, Note, Prepared, prepare};
use riprap::scene::access::{Access, FilesFrom};
use riprap::scene::error::SceneError;
use riprap::scene::parse::Override;
use riprap::scene::{self, resolve};

use crate::engine::{Records, Start};
use crate::errors::{problems, run_error, scene_error};
use crate::value::written;
use crate::wait::for_work;
use crate::world::{Calls, World};

/// Largest size of a report; bytes, as of the command line.
const REPORT_SIZE: u64 = 8_000_000;

/// A scene: text that was read, and fields set since.
#[pyclass(frozen, module = "riprap")]
#[derive(Clone, Debug)]
pub struct Scene {
    /// File, or the name of a text in its folder.
    case: PathBuf,
    text: String,
    overrides: Vec<Override>,
    files: FilesFrom,
}

/// A scene with its warnings.
type Resolved = Result<(resolve::Scene, SceneError), SceneError>;

#[pymethods]
impl Scene {
    /// Reads a scene; files that it names are in its folder, or anywhere with `allow_outside`.
    ///
    /// Fields and variants are checked here, values and files by `check`, `world` and `run`.
    #[staticmethod]
    #[pyo3(signature = (path, *, allow_outside = false))]
    fn read(py: Python<'_>, path: PathBuf, allow_outside: bool) -> PyResult<Self> {
        if !path.exists() {
            let message = format!("no scene at {}", path.display());
            return Err(PyFileNotFoundError::new_err(message));
        }
        let text = scene::text_of(&path).map_err(|error| scene_error(py, &error))?;
        let files = match allow_outside {
            true => FilesFrom::Anywhere,
            false => FilesFrom::SceneFolder,
        };
        let case = path;
        Self::checked(
            py,
            Self {
                case,
                text,
                overrides: Vec::new(),
                files,
            },
        )
    }

    /// Reads a scene from a text; files that it names are in `folder`.
    #[staticmethod]
    #[pyo3(signature = (text, *, folder = PathBuf::from("."), name = "scene.ron"))]
    fn parse(py: Python<'_>, text: String, folder: PathBuf, name: &str) -> PyResult<Self> {
        let (case, files) = (folder.join(name), FilesFrom::SceneFolder);
        Self::checked(
            py,
            Self {
                case,
                text,
                overrides: Vec::new(),
                files,
            },
        )
    }

    /// The scene with a field set, by its path: `scene.set("numerics.smoothing_length_ratio", 1.5)`.
    ///
    /// Text stands as in a scene file, `"Spacing(0.05)"`; numbers, truth values, tuples, lists, dicts and paths are written so. This
    /// scene stays as it is.
    fn set(&self, py: Python<'_>, path: String, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut changed = self.clone();
        let value = written(value)?;
        changed.overrides.push(Override { path, value });
        Self::checked(py, changed)
    }

    /// File of the scene.
    #[getter]
    fn path(&self) -> PathBuf {
        self.case.clone()
    }

    /// Text of the scene with all fields set.
    #[getter]
    fn text(&self, py: Python<'_>) -> PyResult<String> {
        let read = scene::read_text(&self.name(), &self.text, &self.overrides);
        read.map(|(text, _)| text)
            .map_err(|error| scene_error(py, &error))
    }

    /// Checks everything that can be checked before a run; returns the warnings.
    fn check(&self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        let (_, warnings) = self.resolved(py)?;
        problems(py, &warnings)
    }

    /// The world of the scene, in memory: water or blocks that are to settle first have not settled yet.
    ///
    /// `threads` are its own, all cores without; results do not depend on them. `resume` is a checkpoint of this scene,
    /// written by `World.checkpoint` or by a run.
    #[pyo3(signature = (*, threads = None, resume = None))]
    fn world(
        &self,
        py: Python<'_>,
        threads: Option<usize>,
        resume: Option<PathBuf>,
    ) -> PyResult<World> {
        let (scene, _) = self.resolved(py)?;
        let archived = archived(py, &scene)?;
        let scene_hash = checkpoint_file::scene_hash(&archived.text);
        let from = resume
            .map(|path| checkpoint(py, &path, &scene_hash))
            .transpose()?;
        World::start(
            py,
            scene,
            Start {
                threads,
                scene_hash,
                from,
                records: None,
            },
        )
    }

    #[pyo3(signature = (
        folder, *, until = None, every = None, call = None, threads = None, resume = false, force = false, report = true,
        checkpoint_interval = 600.0
    ))]
    /// Runs the scene into a folder, as `riprap run` does, and opens the folder.
    ///
    /// `call` is called with the world every so many seconds (`every`), after each step without. Ctrl-C and exceptions of `call` end the
    /// run in good order, with a checkpoint from which `resume=True` continues to the same bits.
    #[expect(
        clippy::too_many_arguments,
        reason = "keywords of a function of Python, as options of the command line"
    )]
    fn run(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        until: Option<f64>,
        every: Option<f64>,
        call: Option<Py<PyAny>>,
        threads: Option<usize>,
        resume: bool,
        force: bool,
        report: bool,
        checkpoint_interval: f64,
    ) -> PyResult<Py<PyAny>> {
        let beginning = match (resume, force) {
            (true, true) => {
                return Err(PyValueError::new_err("resume or force, not both"));
            }
            (true, false) => Beginning::Resumed,
            (false, true) => Beginning::New(Existing::Replace),
            (false, false) => Beginning::New(Existing::Keep),
        };
        let checkpoint_interval = Duration::try_from_secs_f64(checkpoint_interval)
            .map_err(|error| PyValueError::new_err(format!("checkpoint_interval: {error}")))?;
        let calls = Calls::new(every, call)?;
        let scene = match until {
            None => self.clone(),
            Some(until) => self.with("time.duration", format!("{until:?}")),
        };
        let (resolved, _) = scene.resolved(py)?;
        let archived = archived(py, &resolved)?;
        let prepared = prepare(&resolved, &scene.case, &folder, beginning);
        let prepared = prepared.map_err(|message| PyOSError::new_err(message.to_string()))?;
        if let Prepared::Ready { from, notes } = prepared {
            for note in notes {
                if let Note::Warning(message) = note {
                    warn(py, &message.to_string())?;
                }
            }
            if from.is_none() {
                let written = archived.write(&scene.case, &folder);
                written.map_err(|error| PyOSError::new_err(error.to_string()))?;
            }
            let start = Start {
                threads,
                scene_hash: checkpoint_file::scene_hash(&archived.text),
                from,
                records: Some(Records {
                    folder: folder.clone(),
                    checkpoint_interval,
                }),
            };
            let duration = resolved.duration;
            let world = Bound::new(py, World::start(py, resolved, start)?)?;
            let ended =
                World::drive(&world, duration, &calls).and_then(|()| world.get().finish(py));
            if report {
                write_report(py, &folder)?;
            }
            ended?;
        }
        let opened = py.import("riprap")?.call_method1("open", (folder,))?;
        Ok(opened.unbind())
    }

    fn __repr__(&self) -> String {
        format!("<riprap.Scene {}>", self.case.display())
    }
}

impl Scene {
    /// The scene, once its text is read.
    fn checked(py: Python<'_>, scene: Self) -> PyResult<Self> {
        match scene::read_text(&scene.name(), &scene.text, &scene.overrides) {
            Ok(_) => Ok(scene),
            Err(error) => Err(scene_error(py, &error)),
        }
    }

    fn with(&self, path: &str, value: String) -> Self {
        let mut changed = self.clone();
        let path = path.to_owned();
        changed.overrides.push(Override { path, value });
        changed
    }

    /// Its name in messages.
    fn name(&self) -> String {
        self.case.display().to_string()
    }

    /// The scene that runs, and its warnings.
    fn resolved(&self, py: Python<'_>) -> PyResult<(resolve::Scene, SceneError)> {
        let scene = self.clone();
        let resolve = move || -> Resolved {
            let folder = scene.case.parent().unwrap_or(Path::new("."));
            let access = Access {
                files: scene.files,
                ..Access::of(folder)
            };
            scene::load_text(&scene.name(), &scene.text, &scene.overrides, &access)
        };
        for_work(py, resolve)?.map_err(|error| scene_error(py, &error))
    }
}

fn archived(py: Python<'_>, scene: &resolve::Scene) -> PyResult<ArchivedScene> {
    ArchivedScene::of(scene)
        .map_err(|error| run_error(py, &error.to_string(), error.code().as_str()))
}

fn checkpoint(py: Python<'_>, path: &Path, scene_hash: &[u8; 32]) -> PyResult<Checkpoint> {
    let bytes = std::fs::read(path)
        .map_err(|error| PyOSError::new_err(format!("cannot read {}: {error}", path.display())))?;
    let read = checkpoint_file::read(path, &bytes, scene_hash);
    read.map_err(|error| run_error(py, &error.to_string(), error.code().as_str()))
}

/// Writes the page that plays the run, complete or not. The run does not fail with it.
fn write_report(py: Python<'_>, folder: &Path) -> PyResult<()> {
    let run = folder.to_owned();
    let file = folder.join(run_folder::REPORT);
    let written = py.detach(move || report::report(&run, &file, REPORT_SIZE));
    match written {
        Ok(_) => Ok(()),
        Err(error) => warn(py, &format!("no report: {error}")),
    }
}

fn warn(py: Python<'_>, message: &str) -> PyResult<()> {
    let message = std::ffi::CString::new(message.replace('\0', ""))?;
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 2)
}
