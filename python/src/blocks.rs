//! `riprap.Blocks` and `riprap.Block`: rock by name.

use numpy::PyArray1;
use pyo3::exceptions::{PyIndexError, PyKeyError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyIterator, PyList};
use riprap::world::World as EngineWorld;
use riprap_dda::{Load, Motion};

use crate::world::World;

/// Forces and moments about the centroid by source.
const SOURCES: [&str; 3] = ["water", "contact", "gravity"];

/// The blocks of a world, by name or number.
#[pyclass(frozen, module = "riprap", mapping)]
#[derive(Debug)]
pub struct Blocks {
    world: Py<World>,
}

/// A block.
#[pyclass(frozen, module = "riprap")]
#[derive(Debug)]
pub struct Block {
    world: Py<World>,
    number: usize,
}

/// A vector as an array.
type Vector<'py> = Bound<'py, PyArray1<f64>>;

impl Blocks {
    pub fn of(world: Py<World>) -> Self {
        Self { world }
    }

    fn names(&self) -> &[String] {
        &self.world.get().constants.block_names
    }

    fn number(&self, key: &Bound<'_, PyAny>) -> PyResult<usize> {
        let n_blocks = self.names().len();
        if let Ok(number) = key.extract::<usize>() {
            return (number < n_blocks).then_some(number).ok_or_else(|| {
                PyIndexError::new_err(format!("no block {number}; there are {n_blocks}"))
            });
        }
        let name: String = key.extract()?;
        let found = self.names().iter().position(|other| *other == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = self.names().iter().map(String::as_str).collect();
            let close = riprap::scene::parse::suggestion(&name, &names);
            PyKeyError::new_err(format!("no block `{name}`{close}"))
        })
    }
}

#[pymethods]
impl Blocks {
    fn __getitem__(&self, py: Python<'_>, key: &Bound<'_, PyAny>) -> PyResult<Block> {
        let number = self.number(key)?;
        let world = self.world.clone_ref(py);
        Ok(Block { world, number })
    }

    fn __contains__(&self, key: &Bound<'_, PyAny>) -> bool {
        self.number(key).is_ok()
    }

    fn __len__(&self) -> usize {
        self.names().len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyList::new(py, self.names())?.try_iter()
    }

    /// Names of the blocks.
    fn keys(&self) -> Vec<String> {
        self.names().to_vec()
    }
}

impl Block {
    fn ask<T: Send + 'static>(
        &self,
        py: Python<'_>,
        look: impl FnOnce(&EngineWorld, usize) -> T + Send + 'static,
    ) -> PyResult<T> {
        let number = self.number;
        let engine = &self.world.get().engine;
        engine.ask(py, move |engine| Ok(look(engine.world()?, number)))
    }

    fn vector<'py, const N: usize>(
        &self,
        py: Python<'py>,
        look: impl FnOnce(&EngineWorld, usize) -> [f64; N] + Send + 'static,
    ) -> PyResult<Vector<'py>> {
        Ok(PyArray1::from_slice(py, &self.ask(py, look)?))
    }

    fn loads<'py>(
        &self,
        py: Python<'py>,
        part: fn(&Load) -> [f64; 3],
    ) -> PyResult<Bound<'py, PyDict>> {
        let loads = self.ask(py, |world, b| {
            let weight = Load {
                force: world.gravity * world.blocks.mass(b),
                ..Load::default()
            };
            [world.fluid_load(b), world.blocks.contact_force(b), weight]
        })?;
        let by_source = PyDict::new(py);
        for (source, load) in SOURCES.iter().zip(&loads) {
            by_source.set_item(source, PyArray1::from_slice(py, &part(load)))?;
        }
        Ok(by_source)
    }
}

#[pymethods]
impl Block {
    /// Name in the scene.
    #[getter]
    fn name(&self) -> &str {
        &self.world.get().constants.block_names[self.number]
    }

    /// Number, as in the tables of a run.
    #[getter]
    fn number(&self) -> usize {
        self.number
    }

    /// `free`, `fixed` or `prescribed`.
    #[getter]
    fn kind(&self, py: Python<'_>) -> PyResult<&'static str> {
        self.ask(py, |world, b| match world.blocks.motion(b) {
            _ if world.is_fixed(b) => "fixed",
            Motion::Prescribed(_) => "prescribed",
            _ => "free",
        })
    }

    /// Whether it has left the domain.
    #[getter]
    fn is_removed(&self, py: Python<'_>) -> PyResult<bool> {
        self.ask(py, |world, b| world.blocks.is_removed(b))
    }

    /// kg.
    #[getter]
    fn mass(&self, py: Python<'_>) -> PyResult<f64> {
        self.ask(py, |world, b| world.blocks.mass(b))
    }

    /// m³.
    #[getter]
    fn volume(&self, py: Python<'_>) -> PyResult<f64> {
        self.ask(py, |world, b| world.blocks.volume(b))
    }

    /// Centroid; m.
    #[getter]
    fn centroid<'py>(&self, py: Python<'py>) -> PyResult<Vector<'py>> {
        self.vector(py, |world, b| world.blocks.centroid(b).into())
    }

    /// Velocity of the centroid; m/s.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Vector<'py>> {
        self.vector(py, |world, b| world.blocks.velocity(b).into())
    }

    /// Angular velocity; rad/s.
    #[getter]
    fn angular_velocity<'py>(&self, py: Python<'py>) -> PyResult<Vector<'py>> {
        self.vector(py, |world, b| world.blocks.angular_velocity(b).into())
    }

    /// Turn since the start, a quaternion (x, y, z, w).
    #[getter]
    fn attitude<'py>(&self, py: Python<'py>) -> PyResult<Vector<'py>> {
        self.vector(py, |world, b| world.blocks.orientation(b).coords.into())
    }

    /// Forces by source: `water`, `contact`, `gravity`; N.
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.loads(py, |load| load.force.into())
    }

    /// Moments about the centroid by source; N m.
    #[getter]
    fn moment<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.loads(py, |load| load.torque.into())
    }

    fn __repr__(&self) -> String {
        format!("<riprap.Block {:?}>", self.name())
    }
}
