//! Maps of wave impact: highest water, arrival time, inundation depth.

mod rasters;

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use riprap_sph::Fluid;

use super::{ObserveError, Observer, Schedule};
use crate::files::vtk::{self, Array, PolyData, Polygons, Values};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::crs::Crs;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording;
use crate::scene::terrain::grid::{Grid, MapGrid};
use crate::world::World;
use crate::world::ground::Ground;

/// Extremes of the water at the points of one grid; NaN where dry.
#[derive(Clone, Debug, PartialEq)]
pub struct MapExtremes {
    /// Height of the surface at the start; m.
    pub at_start: Grid,
    /// Highest surface; m.
    pub highest: Grid,
    /// Arrival time of the water; s.
    pub arrival: Grid,
}

/// Writes `maps.vtp`, and for each map an ASCII grid and a GeoTIFF.
#[derive(Debug)]
pub struct Maps {
    schedule: Schedule,
    folder: PathBuf,
    /// Heights of the ground, NaN where there is none; m.
    ground: Grid,
    /// Map coordinates of the scene's origin; m.
    origin: (f64, f64, f64),
    /// Reference system of the map, if known.
    crs: Option<Crs>,
    /// Change of the surface since the start that counts as arrival; m.
    arrival_threshold: f64,
    /// Height of the surface at t = 0, NaN where it was dry; m.
    at_start: Vec<f64>,
    /// Highest surface so far, NaN where all was dry; m.
    highest: Vec<f64>,
    /// Time of arrival, NaN without arrival; s.
    arrival: Vec<f64>,
}

impl Maps {
    /// Maps in `folder`.
    pub fn new(folder: &Path, asked: &recording::Maps, scene: &Scene, world: &World) -> Self {
        let domain = &scene.domain;
        let (min, max) = ([domain.min.x, domain.min.y], [domain.max.x, domain.max.y]);
        let spacing = asked.spacing;
        let n = [0, 1].map(|axis| (((max[axis] - min[axis]) / spacing) as usize).max(2));
        let mut ground = Grid {
            n,
            // centered in the domain
            corner: [0, 1].map(|axis| {
                let rest = max[axis] - min[axis] - (n[axis] - 1) as f64 * spacing;
                min[axis] + 0.5 * rest
            }),
            spacing,
            heights: Vec::new(),
        };
        let land = Ground::of(&world.blocks);
        let height = |point| land.height_under_the_sky(ground.place(point));
        ground.heights = ground
            .points()
            .map(|p| height(p).unwrap_or(f64::NAN))
            .collect();
        let none = vec![f64::NAN; ground.heights.len()];
        Self {
            schedule: Schedule::every(asked.interval),
            folder: folder.to_owned(),
            origin: (scene.terrain.as_ref()).map_or((0.0, 0.0, 0.0), |terrain| terrain.origin),
            crs: (scene.terrain.as_ref()).and_then(|terrain| terrain.crs.clone()),
            arrival_threshold: asked.arrival_threshold,
            at_start: none.clone(),
            highest: none.clone(),
            arrival: none,
            ground,
        }
    }

    /// Current elevation of the surface; m.
    fn surface(&self, fluid: &Fluid) -> Vec<f64> {
        let points: Vec<[usize; 2]> = self.ground.points().collect();
        points
            .par_iter()
            .map(|&point| {
                let [x, y] = self.ground.place(point);
                fluid.surface_elevation(x, y).unwrap_or(f64::NAN)
            })
            .collect()
    }

    /// Largest water depth where it was dry at the start; m.
    fn inundation(&self) -> Vec<f64> {
        let heights = self.highest.iter().zip(&self.ground.heights);
        heights
            .zip(&self.at_start)
            .map(|((highest, ground), at_start)| {
                if at_start.is_nan() {
                    (highest - ground).max(0.0)
                } else {
                    f64::NAN
                }
            })
            .map(|depth| if 0.0 < depth { depth } else { f64::NAN })
            .collect()
    }

    /// Extremes so far.
    pub fn extremes(&self) -> MapExtremes {
        let map = |values: &[f64]| Grid {
            heights: values.to_vec(),
            ..self.ground
        };
        MapExtremes {
            at_start: map(&self.at_start),
            highest: map(&self.highest),
            arrival: map(&self.arrival),
        }
    }

    /// Writes all maps.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write(&self, time: f64) -> Result<(), ObserveError> {
        let inundation = self.inundation();
        let raised = |heights: &[f64]| {
            heights
                .iter()
                .map(|z| z + self.origin.2)
                .collect::<Vec<_>>()
        };
        for (name, values) in [
            (run_folder::MAXIMUM_ELEVATION, raised(&self.highest)),
            (run_folder::FIRST_ARRIVAL, self.arrival.clone()),
            (run_folder::INUNDATION_DEPTH, inundation.clone()),
        ] {
            let mut map = MapGrid {
                grid: Grid {
                    heights: values,
                    ..self.ground
                },
                crs: self.crs.clone(),
            };
            map.grid.shift([self.origin.0, self.origin.1]);
            rasters::write(&self.folder.join(name), &map)?;
        }
        let on_land = [
            ("MaximumElevation", &self.highest),
            ("FirstArrival", &self.arrival),
            ("InundationDepth", &inundation),
        ];
        vtk::write(
            &self.folder.join(run_folder::MAPS),
            &self.sheet(time, &on_land),
        )?;
        Ok(())
    }

    /// The ground with values at its points.
    fn sheet(&self, time: f64, fields: &[(&str, &Vec<f64>)]) -> PolyData {
        let grid = &self.ground;
        let lowest = grid.range().0;
        let lowest = if lowest.is_finite() { lowest } else { 0.0 };
        let points = grid.points().map(|point| {
            let [x, y] = grid.place(point);
            let z = grid.heights[grid.index(point)];
            let z = if z.is_finite() { z } else { lowest };
            [x as f32, y as f32, z as f32]
        });
        let mut polygons = Polygons::default();
        for [i, j] in grid
            .points()
            .filter(|[i, j]| i + 1 < grid.n[0] && j + 1 < grid.n[1])
        {
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            let corners = corners.map(|point| grid.index(point) as i32);
            polygons.connectivity.extend(corners);
            polygons.offsets.push(polygons.connectivity.len() as i32);
        }
        let of = |&(name, values): &(&str, &Vec<f64>)| Array {
            name: name.to_owned(),
            components: 1,
            values: Values::F32(values.iter().map(|&value| value as f32).collect()),
        };
        PolyData {
            points: points.collect(),
            polygons,
            point_data: fields.iter().map(of).collect(),
            time,
            ..PolyData::default()
        }
    }
}

impl Observer for Maps {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        let now = match &world.water {
            Some(water) => self.surface(&water.fluid),
            None => vec![f64::NAN; self.highest.len()],
        };
        let is_first = world.time() <= 0.0;
        if is_first {
            self.at_start.clone_from(&now);
        }
        for (k, &surface) in now.iter().enumerate() {
            // a maximum of NaN and a number is the number
            self.highest[k] = self.highest[k].max(surface);
            let before = self.at_start[k];
            let has_come = if before.is_nan() {
                surface.is_finite()
            } else {
                self.arrival_threshold < (surface - before).abs()
            };
            if !is_first && has_come && self.arrival[k].is_nan() {
                self.arrival[k] = world.time();
            }
        }
        self.schedule.done(world.time());
        self.write(world.time())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let state = (self.schedule, &self.at_start, &self.highest, &self.arrival);
        postcard::to_extend(&state, out)
    }

    fn sync(&self) -> Result<(), ObserveError> {
        // each file is complete before it is renamed
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, rest);
        ((schedule, self.at_start, self.highest, self.arrival), rest) =
            postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        Ok(rest)
    }
}
