//! `riprap.World`.

use std::path::PathBuf;

use pyo3::exceptions::{PyRuntimeWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use riprap::scene::resolve::Scene;
use riprap::world::ledger::Energy;

use crate::blocks::Blocks;
use crate::engine::{Goal, Handle, Start};
use crate::gauges::Gauges;
use crate::water::Water;

/// Slack of a due time, × interval: a sum of steps may fall short of it by round-off.
const SLACK: f64 = 1e-9;

/// Function that is called with the world at an interval; after each step without one.
#[derive(Debug)]
pub struct Calls {
    /// s.
    every: Option<f64>,
    call: Option<Py<PyAny>>,
}

impl Calls {
    /// Checks the interval.
    pub fn new(every: Option<f64>, call: Option<Py<PyAny>>) -> PyResult<Self> {
        match every {
            Some(every) if !(every.is_finite() && 0.0 < every) => Err(PyValueError::new_err(
                format!("every must be a time above 0 s, found {every}"),
            )),
            _ => Ok(Self { every, call }),
        }
    }

    /// Next goal on the way from a time to another one; s.
    fn next(&self, time: f64, until: f64) -> Goal {
        match (&self.call, self.every) {
            (None, _) => Goal::Time(until),
            (Some(_), None) => Goal::Steps(1),
            (Some(_), Some(every)) => {
                let n_done = (time / every + SLACK).floor();
                Goal::Time(((n_done + 1.0 - SLACK) * every).min(until))
            }
        }
    }

    /// Whether a call is due at a time after the last one was looked at before; s.
    fn is_due(&self, before: f64, now: f64) -> bool {
        let n_at = |time: f64, every: f64| (time / every + SLACK).floor();
        match self.every {
            None => true,
            Some(every) => n_at(before, every) < n_at(now, every),
        }
    }

    fn tell(&self, world: &Bound<'_, World>) -> PyResult<()> {
        let Some(call) = &self.call else {
            return Ok(());
        };
        call.call1(world.py(), (world,)).map(|_| ())
    }
}

/// Names and numbers of a world that never change.
#[derive(Debug)]
pub struct Constants {
    /// Name of each block.
    pub block_names: Vec<String>,
    /// Name of each gauge.
    pub gauge_names: Vec<String>,
    title: String,
    duration: f64,
    has_water: bool,
}

/// Blocks and water at one time.
#[pyclass(frozen, module = "riprap")]
#[derive(Debug)]
pub struct World {
    pub engine: Handle,
    pub constants: Constants,
}

#[pymethods]
impl World {
    /// Title of the scene.
    #[getter]
    fn title(&self) -> &str {
        &self.constants.title
    }

    /// Duration of the scene; s.
    #[getter]
    fn duration(&self) -> f64 {
        self.constants.duration
    }

    /// Simulated time, 0 until water or blocks have settled; s.
    #[getter]
    pub fn time(&self, py: Python<'_>) -> PyResult<f64> {
        self.engine.ask(py, |engine| Ok(engine.world()?.time()))
    }

    /// Steps since t = 0.
    #[getter]
    fn steps(&self, py: Python<'_>) -> PyResult<u64> {
        self.engine
            .ask(py, |engine| Ok(engine.world()?.clock().steps))
    }

    /// Size of the last step, None before the first one; s.
    #[getter]
    fn time_step(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        self.engine
            .ask(py, |engine| Ok(engine.world()?.clock().last_dt))
    }

    /// Whether the water is still settling before t = 0.
    #[getter]
    fn is_settling(&self, py: Python<'_>) -> PyResult<bool> {
        self.engine
            .ask(py, |engine| Ok(engine.run()?.is_settling()))
    }

    /// Hash of every number of the state: equal hashes, equal worlds. It is that of `summary.json`.
    #[getter]
    fn state_hash(&self, py: Python<'_>) -> PyResult<String> {
        self.engine
            .ask(py, |engine| Ok(engine.world()?.state_hash()))
    }

    /// The water; None for a scene without.
    #[getter]
    fn water(slf: Bound<'_, Self>) -> PyResult<Option<Water>> {
        let has_water = slf.get().constants.has_water;
        Ok(has_water.then(|| Water::of(slf.unbind())))
    }

    /// The blocks by name or number.
    #[getter]
    fn blocks(slf: Bound<'_, Self>) -> Blocks {
        Blocks::of(slf.unbind())
    }

    /// Readings of the gauges by name, at the present state.
    #[getter]
    fn gauges(slf: Bound<'_, Self>) -> Gauges {
        Gauges::of(slf.unbind())
    }

    /// Energy by term (J), and `momentum_residual` (-).
    #[getter]
    fn ledger<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (terms, residual) = self.engine.ask(py, |engine| {
            let world = engine.world()?;
            Ok((world.energy().terms(), world.momentum_residual()))
        })?;
        let ledger = PyDict::new(py);
        for (name, term) in Energy::TERMS.iter().zip(terms) {
            ledger.set_item(name, term)?;
        }
        ledger.set_item("momentum_residual", residual)?;
        Ok(ledger)
    }

    /// Takes `n` steps, those of settling included; returns the time (s).
    #[pyo3(signature = (n = 1))]
    fn step(&self, py: Python<'_>, n: u64) -> PyResult<f64> {
        self.advance(py, Goal::Steps(n))
    }

    /// Settles the water if need be, and takes steps until a time (s), the duration of the scene without.
    ///
    /// `call` is called with this world at t = 0 and every so many seconds (`every`), after each step without: at the first
    /// step at or after the due time. When Ctrl-C or an exception ends it, the state is written to the file `checkpoint`, if
    /// there is one.
    #[pyo3(signature = (*, until = None, every = None, call = None, checkpoint = None))]
    fn run(
        slf: &Bound<'_, Self>,
        until: Option<f64>,
        every: Option<f64>,
        call: Option<Py<PyAny>>,
        checkpoint: Option<PathBuf>,
    ) -> PyResult<()> {
        let until = until.unwrap_or(slf.get().constants.duration);
        if until.is_nan() {
            return Err(PyValueError::new_err("until must be a time, found nan"));
        }
        let ended = Self::drive(slf, until, &Calls::new(every, call)?);
        match (&ended, checkpoint) {
            (Err(_), Some(path)) => slf.get().checkpoint(slf.py(), path).and(ended),
            _ => ended,
        }
    }

    /// Writes the state to a file, for `Scene.world(resume=...)`.
    fn checkpoint(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let written = self.engine.ask(py, move |engine| engine.write_state(&path));
        written.map(|_| ())
    }

    fn __repr__(&self) -> String {
        format!("<riprap.World {:?}>", self.constants.title)
    }
}

impl World {
    /// Starts the engine of a scene.
    pub fn start(py: Python<'_>, scene: Scene, start: Start) -> PyResult<Self> {
        let constants = Constants {
            block_names: scene.block_names.clone(),
            gauge_names: scene.gauges.iter().map(|g| g.name.clone()).collect(),
            title: scene.title.clone(),
            duration: scene.duration,
            has_water: scene.fluid.is_some(),
        };
        let engine = Handle::start(py, scene, start)?;
        Ok(Self { engine, constants })
    }

    /// Takes steps until a time (s), with calls on the way.
    ///
    /// When it fails, or a signal or a call ends it, a run with records is finished with what there is.
    pub fn drive(world: &Bound<'_, Self>, until: f64, calls: &Calls) -> PyResult<()> {
        let (py, this) = (world.py(), world.get());
        let driven = this.drive_on(world, until, calls);
        if driven.is_err() && this.has_records(py)? {
            // the first error is the one to tell
            let _ = this.finish(py);
        }
        driven
    }

    fn drive_on(&self, world: &Bound<'_, Self>, until: f64, calls: &Calls) -> PyResult<()> {
        let py = world.py();
        if self.is_settling(py)? {
            self.advance(py, Goal::Time(0.0))?;
        }
        let mut time = self.time(py)?;
        if time == 0.0 {
            calls.tell(world)?;
        }
        while time < until {
            let before = time;
            time = self.advance(py, calls.next(before, until))?;
            if calls.is_due(before, time) {
                calls.tell(world)?;
            }
        }
        Ok(())
    }

    fn has_records(&self, py: Python<'_>) -> PyResult<bool> {
        self.engine.ask(py, |engine| Ok(engine.has_records()))
    }

    fn advance(&self, py: Python<'_>, goal: Goal) -> PyResult<f64> {
        let advanced = self.engine.advance(py, goal)?;
        for note in advanced.notes {
            let note = std::ffi::CString::new(note)?;
            PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), &note, 2)?;
        }
        Ok(advanced.time)
    }

    /// Ends a run with records.
    pub fn finish(&self, py: Python<'_>) -> PyResult<()> {
        self.engine.ask(py, |engine| engine.finish().map(|_| ()))
    }
}
