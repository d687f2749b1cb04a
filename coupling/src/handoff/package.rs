//! One hand-off: the water of a world in columns, its fitness, and all of its files.

use std::path::Path;

use riprap_sph::Dimensions;
use serde_json::json;

use super::columns::{Columns, Raster, Water, columns, ground_with_blocks};
use super::fitness::{Fitness, fitness};
use super::formats::Sheet;
use super::readiness::{Reason, State, is_absorbing};
use crate::files::table::TableData;
use crate::files::vtk::replace_file;
use crate::output::observe::ObserveError;
use crate::scene::crs::Crs;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::{HandoffFormat, PlanLine};
use crate::world::World;

/// Parts of a scene that a hand-off needs.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Cells.
    pub raster: Raster,
    /// Level of rest; m.
    pub level: f64,
    /// Distance of particles at rest; m.
    spacing: f64,
    title: String,
    origin: (f64, f64, f64),
    crs: Option<Crs>,
    gravity: f64,
    is_absorbing: Vec<bool>,
}

/// Files to write.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Folder, made where it is missing.
    pub folder: &'a Path,
    /// Formats of a raster; a section has its own.
    pub formats: &'a [HandoffFormat],
    /// Lines of the scene and their records so far.
    pub lines: (&'a [(String, PlanLine)], Option<&'a TableData>),
    /// Why now, and the power and crests that say so.
    pub reason: (Reason, Option<State>),
}

/// A hand-off that was made.
#[derive(Clone, Debug)]
pub struct Package {
    /// Columns.
    pub columns: Columns,
    /// Numbers that say whether the flow is ready.
    pub fitness: Fitness,
}

impl Setting {
    /// Setting of a scene with cells of a side (m) and a level of rest (m); `None` without water.
    pub fn new(scene: &Scene, cell: f64, level: f64) -> Option<Self> {
        let fluid = scene.fluid.as_ref()?;
        let raster = raster(scene, cell);
        let terrain = scene.terrain.as_ref();
        Some(Self {
            is_absorbing: (0..raster.n_cells())
                .map(|cell| is_absorbing(scene, raster.center(cell)))
                .collect(),
            raster,
            level,
            spacing: fluid.walls.particle_spacing,
            title: scene.title.clone(),
            origin: terrain.map_or((0.0, 0.0, 0.0), |terrain| terrain.origin),
            crs: terrain.and_then(|terrain| terrain.crs.clone()),
            gravity: scene.gravity.norm(),
        })
    }

    /// Particles of a world; `None` without water.
    pub fn water<'a>(&self, world: &'a World) -> Option<Water<'a>> {
        let fluid = &world.water.as_ref()?.fluid;
        let particles = fluid.particles();
        Some(Water {
            position: &particles.position,
            velocity: &particles.velocity,
            pressure: &particles.pressure,
            mass: &particles.mass,
            volume: fluid.particle_volume(),
            spacing: self.spacing,
        })
    }

    /// Whether it has one row of cells: a section.
    pub fn is_section(&self) -> bool {
        self.raster.n[1] == 1
    }

    /// Columns and fitness of a world; `None` without water.
    pub fn package(&self, world: &World) -> Option<Package> {
        let water = self.water(world)?;
        let ground = ground_with_blocks(&world.blocks);
        let columns = columns(self.raster, water, &ground, self.gravity);
        let fitness = fitness(&columns, water, self.level, self.gravity);
        Some(Package { columns, fitness })
    }

    /// Writes all files of a package at a time (s): those of the formats, and `handoff.json` last.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write(
        &self,
        package: &Package,
        world: &World,
        request: Request,
    ) -> Result<(), ObserveError> {
        let folder = request.folder;
        std::fs::create_dir_all(folder).map_err(|source| ObserveError::Write {
            path: folder.display().to_string(),
            source,
        })?;
        let sheet = Sheet {
            columns: &package.columns,
            title: &self.title,
            origin: self.origin,
            crs: self.crs.as_ref(),
            level: self.level,
            time: world.time(),
            gravity: self.gravity,
            is_absorbing: &self.is_absorbing,
        };
        if self.is_section() {
            sheet.write_section(folder)?;
        } else {
            for format in request.formats {
                match format {
                    HandoffFormat::NetCdf => sheet.write_netcdf(folder)?,
                    HandoffFormat::Esri => sheet.write_esri(folder)?,
                    HandoffFormat::Funwave => sheet.write_funwave(folder)?,
                    HandoffFormat::Geoclaw => sheet.write_geoclaw(folder)?,
                    HandoffFormat::Swash => sheet.write_swash(request.lines, folder)?,
                }
            }
        }
        let text = self.numbers(package, world, request.reason);
        replace_file(&folder.join("handoff.json"), &[text.as_bytes()])?;
        Ok(())
    }

    /// Fitness, why now, and both sides of what is conserved.
    fn numbers(
        &self,
        package: &Package,
        world: &World,
        (reason, state): (Reason, Option<State>),
    ) -> String {
        let columns = &package.columns;
        let sum = |axis: usize| columns.momentum.iter().map(|p| p[axis]).sum::<f64>();
        let mut momentum = [0.0; 2];
        let mut volume = 0.0;
        if let Some(water) = self.water(world) {
            volume = water.mass.len() as f64 * water.volume;
            for (mass, v) in water.mass.iter().zip(water.velocity) {
                momentum[0] += mass * v.x;
                momentum[1] += mass * v.y;
            }
        }
        let mut numbers = json!({
            "time_s": world.time(),
            "reason": reason,
            "still_water_level_m": self.level,
            "cells": columns.raster.n,
            "cell_m": columns.raster.side,
            "volume_of_columns_m3": columns.volume.iter().sum::<f64>(),
            "volume_of_particles_m3": volume,
            "momentum_of_columns_kg_m_per_s": [sum(0), sum(1)],
            "momentum_of_particles_kg_m_per_s": momentum,
            "fitness": package.fitness,
        });
        if let Some(state) = state {
            numbers["power_w"] = state.power.into();
            numbers["largest_power_w"] = state.largest_power.into();
            numbers["largest_elevation_m"] = state.crests[0].into();
            numbers["mean_elevation_at_absorbers_m"] = state.crests[1].into();
        }
        format!("{numbers:#}\n")
    }
}

/// Cells over the domain.
fn raster(scene: &Scene, cell: f64) -> Raster {
    let (min, max) = (scene.domain.min, scene.domain.max);
    let size = [max.x - min.x, max.y - min.y];
    let is_section = scene
        .fluid
        .as_ref()
        .is_some_and(|fluid| matches!(fluid.settings.dimensions, Dimensions::Two { .. }));
    // 2.4 m are 24 cells of 0.1 m, whatever the round-off
    let n = size.map(|size| ((size / cell - 1e-6).ceil() as usize).max(1));
    Raster {
        n: if is_section { [n[0], 1] } else { n },
        corner: [min.x, min.y],
        side: if is_section {
            [cell, size[1]]
        } else {
            [cell; 2]
        },
    }
}
