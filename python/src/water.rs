//! `riprap.Water`: particles as arrays.

use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use riprap::world::World as EngineWorld;
use riprap_sph::{Particles, Vec3};

use crate::world::World;

/// The water of a world.
#[pyclass(frozen, module = "riprap")]
#[derive(Debug)]
pub struct Water {
    world: Py<World>,
}

impl Water {
    pub fn of(world: Py<World>) -> Self {
        Self { world }
    }

    fn ask<T: Send + Default + 'static>(
        &self,
        py: Python<'_>,
        look: impl FnOnce(&Particles) -> T + Send + 'static,
    ) -> PyResult<T> {
        self.world.get().engine.ask(py, |engine| {
            Ok(particles(engine.world()?).map_or_else(T::default, look))
        })
    }

    fn vectors<'py>(
        &self,
        py: Python<'py>,
        column: fn(&Particles) -> &[Vec3],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.ask(py, move |particles| flat(column(particles)))?)
    }

    fn numbers<'py>(
        &self,
        py: Python<'py>,
        column: fn(&Particles) -> &[f64],
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let values = self.ask(py, move |particles| column(particles).to_vec())?;
        Ok(PyArray1::from_vec(py, values))
    }
}

#[pymethods]
impl Water {
    /// Position of each particle, (n, 3); m.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.vectors(py, |particles| &particles.position)
    }

    /// Velocity of each particle, (n, 3); m/s.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.vectors(py, |particles| &particles.velocity)
    }

    /// Density of each particle; kg/m³.
    #[getter]
    fn density<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.numbers(py, |particles| &particles.density)
    }

    /// Pressure of each particle; Pa.
    #[getter]
    fn pressure<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.numbers(py, |particles| &particles.pressure)
    }

    /// Mass of each particle; kg.
    #[getter]
    fn mass<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.numbers(py, |particles| &particles.mass)
    }

    /// Number of each particle, which it keeps while rows are sorted by place.
    #[getter]
    fn id<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let ids = self.ask(py, |particles| {
            particles
                .id
                .iter()
                .map(|id| id.index() as u32)
                .collect::<Vec<u32>>()
        })?;
        Ok(PyArray1::from_vec(py, ids))
    }

    /// A column with a row for each number ever given; NaN for particles that have left.
    fn by_id<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let vectors: Option<fn(&Particles) -> &[Vec3]> = match name {
            "position" => Some(|particles| &particles.position),
            "velocity" => Some(|particles| &particles.velocity),
            _ => None,
        };
        if let Some(column) = vectors {
            let sorted = self.ask(py, move |particles| {
                flat(&by_id(particles, column(particles), Vec3::repeat(f64::NAN)))
            })?;
            return Ok(rows(py, sorted)?.into_any());
        }
        let column: fn(&Particles) -> &[f64] = match name {
            "density" => |particles| &particles.density,
            "pressure" => |particles| &particles.pressure,
            "mass" => |particles| &particles.mass,
            _ => {
                return Err(PyKeyError::new_err(format!(
                    "no column `{name}` of the water; there are position, velocity, density, pressure and mass"
                )));
            }
        };
        let sorted = self.ask(py, move |particles| {
            by_id(particles, column(particles), f64::NAN)
        })?;
        Ok(PyArray1::from_vec(py, sorted).into_any())
    }

    /// Elevation of the free surface at a point in plan view, NaN where it is dry; m.
    fn surface_elevation(&self, py: Python<'_>, x: f64, y: f64) -> PyResult<f64> {
        self.world.get().engine.ask(py, move |engine| {
            let water = engine.world()?.water.as_ref();
            let elevation = water.and_then(|water| water.fluid.surface_elevation(x, y));
            Ok(elevation.unwrap_or(f64::NAN))
        })
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.ask(py, Particles::len)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<riprap.Water of {} particles>", self.__len__(py)?))
    }
}

fn particles(world: &EngineWorld) -> Option<&Particles> {
    world.water.as_ref().map(|water| water.fluid.particles())
}

/// A value for each number that was ever given, some for particles that have left.
fn by_id<T: Clone>(particles: &Particles, values: &[T], gone: T) -> Vec<T> {
    let mut sorted = vec![gone; particles.n_made() as usize];
    for (id, value) in particles.id.iter().zip(values) {
        sorted[id.index()] = value.clone();
    }
    sorted
}

fn flat(vectors: &[Vec3]) -> Vec<f64> {
    vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect()
}

/// An array of three columns.
fn rows(py: Python<'_>, flat: Vec<f64>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let n = flat.len() / 3;
    PyArray1::from_vec(py, flat).reshape([n, 3])
}
