//! Maps of wave impact: highest water, arrival time, inundation depth.

mod arrival;
pub(crate) mod rasters;

use std::path::{Path, PathBuf};

use arrival::{Arrival, Rule, Scales};
use rayon::prelude::*;
use riprap_dda::{Blocks, Vec3};
use riprap_sph::Fluid;

use super::background::Background;
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
    /// Conditions of an arrival.
    rule: Rule,
    /// Change of the surface that counts as arrival, and of a block that counts as motion; m.
    arrival_threshold: f64,
    /// Still-water level and the accuracy of a particle surface, a spacing; NaN without water; m.
    still: [f64; 2],
    /// Centroids of the blocks at the start; m.
    starts: Vec<Vec3>,
    /// Height of the surface at t = 0, NaN where it was dry; m.
    at_start: Vec<f64>,
    /// Highest surface so far, NaN where all was dry; m.
    highest: Vec<f64>,
    /// Still water and arrivals.
    arrival: Arrival,
    /// Last reading of the surface at each point (m), with the stillness of the water then.
    read: Vec<(Option<u64>, f64)>,
    background: Background<()>,
}

/// Maps of one moment, to be written.
struct Sheets {
    folder: PathBuf,
    /// The ground with the heights of the sheet; m.
    ground: Grid,
    origin: (f64, f64, f64),
    crs: Option<Crs>,
    /// s.
    time: f64,
    highest: Vec<f64>,
    arrival: Vec<f64>,
    inundation: Vec<f64>,
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
            rule: rule(asked, scene, world),
            arrival_threshold: asked.arrival_threshold,
            still: (scene.fluid.as_ref()).map_or([f64::NAN; 2], |fluid| {
                [
                    fluid.lattice.still_water_level,
                    fluid.walls.particle_spacing,
                ]
            }),
            starts: (0..world.blocks.n_blocks())
                .map(|b| world.blocks.centroid(b))
                .collect(),
            at_start: none.clone(),
            arrival: Arrival::at(none.len()),
            read: vec![(None, f64::NAN); none.len()],
            background: Background::new(),
            highest: none,
            ground,
        }
    }

    /// Current elevation of the surface, read again only where the water may have moved; m.
    fn surface(&mut self, fluid: &Fluid) -> Vec<f64> {
        let points: Vec<[usize; 2]> = self.ground.points().collect();
        let ground = &self.ground;
        (self.read.par_iter_mut().zip(&points))
            .map(|((before, surface), &point)| {
                let [x, y] = ground.place(point);
                let stillness = fluid.stillness(x, y);
                if stillness.is_none() || stillness != *before {
                    *surface = fluid.surface_elevation(x, y).unwrap_or(f64::NAN);
                    *before = stillness;
                }
                *surface
            })
            .collect()
    }

    /// Surface, the ground where dry; m.
    fn wet_or_dry(&self, surface: &[f64]) -> Vec<f64> {
        let ground = surface.iter().zip(&self.ground.heights);
        let height = ground.map(|(z, ground)| if z.is_nan() { *ground } else { *z });
        height.collect()
    }

    /// Points beside bodies that have moved and reach into the water.
    fn moving(&self, blocks: &Blocks, surface: &[f64]) -> Vec<bool> {
        let mut found = vec![false; surface.len()];
        let grid = &self.ground;
        let has_moved = |&b: &usize| {
            let way = blocks.centroid(b) - self.starts[b];
            !blocks.is_fixed(b) && !blocks.is_removed(b) && self.arrival_threshold < way.norm()
        };
        let parts = (0..self.starts.len()).filter(has_moved);
        for part in parts.flat_map(|b| blocks.parts_of(b)) {
            let (low, high) = blocks.part_aabb(part);
            let range = [0, 1].map(|axis| {
                let place = |x: f64| (x - grid.corner[axis]) / grid.spacing;
                let beside = self.rule.reach() as f64;
                let first = (place(low[axis]) - beside).ceil().max(0.0) as usize;
                let last = (place(high[axis]) + beside).floor().max(-1.0) + 1.0;
                first..(last as usize).min(grid.n[axis])
            });
            for k in range[1]
                .clone()
                .flat_map(|j| range[0].clone().map(move |i| [i, j]))
            {
                let k = grid.index(k);
                // dry ground is NaN
                found[k] |= low.z <= surface[k] + self.still[1];
            }
        }
        found
    }

    /// Largest water depth where it was dry at the start and the water has come; m.
    fn inundation(&self) -> Vec<f64> {
        let depth = |k: usize| {
            let is_flooded = self.at_start[k].is_nan() && self.arrival.time[k].is_finite();
            let depth = self.highest[k] - self.ground.heights[k];
            if is_flooded && 0.0 < depth {
                depth
            } else {
                f64::NAN
            }
        };
        (0..self.highest.len()).map(depth).collect()
    }

    /// Highest surface, over the still-water level where the surface was within a spacing of it at the start: there it was at rest,
    /// known to half a spacing; m.
    fn highest_over_still(&self) -> Vec<f64> {
        let [level, accuracy] = self.still;
        let heights = self.highest.iter().zip(&self.at_start);
        let over = heights.map(|(highest, before)| {
            if (before - level).abs() <= accuracy {
                level + (highest - before)
            } else {
                *highest
            }
        });
        over.collect()
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
            arrival: map(&self.arrival.time),
        }
    }

    /// Maps so far, at a time (s).
    fn sheets(&self, time: f64) -> Sheets {
        Sheets {
            folder: self.folder.clone(),
            ground: self.ground.clone(),
            origin: self.origin,
            crs: self.crs.clone(),
            time,
            highest: self.highest_over_still(),
            arrival: self.arrival.time.clone(),
            inundation: self.inundation(),
        }
    }
}

impl Sheets {
    /// Writes all maps.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    fn write(self) -> Result<(), ObserveError> {
        let raised = self.highest.iter().map(|z| z + self.origin.2).collect();
        for (name, values) in [
            (run_folder::MAXIMUM_ELEVATION, raised),
            (run_folder::FIRST_ARRIVAL, self.arrival.clone()),
            (run_folder::INUNDATION_DEPTH, self.inundation.clone()),
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
        vtk::write(&self.folder.join(run_folder::MAPS), &self.on_land())?;
        Ok(())
    }

    /// The ground with values at its points.
    fn on_land(&self) -> PolyData {
        let fields = [
            ("MaximumElevation", &self.highest),
            ("FirstArrival", &self.arrival),
            ("InundationDepth", &self.inundation),
        ];
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
            time: self.time,
            ..PolyData::default()
        }
    }
}

/// Conditions of an arrival: water that flows in, or from the start, is a wave from the start.
fn rule(asked: &recording::Maps, scene: &Scene, world: &World) -> Rule {
    let fluid = scene.fluid.as_ref();
    let rule = Rule::still(
        asked.arrival_threshold,
        Scales {
            depth: fluid.map_or(0.0, |fluid| fluid.lattice.depth),
            gravity: scene.gravity.norm(),
            particles: fluid.map_or(0.0, |fluid| fluid.walls.particle_spacing),
            points: asked.spacing,
            interval: asked.interval,
        },
    );
    let has_openings = fluid.is_some_and(|fluid| !fluid.openings.is_empty());
    let flows = world.water.as_ref().is_some_and(|water| {
        let velocities = &water.fluid.particles().velocity;
        velocities.iter().any(|v| v.norm() > 0.0)
    });
    if has_openings || flows {
        rule.flowing()
    } else {
        rule
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
        let (height, time) = (self.wet_or_dry(&now), world.time());
        if time <= 0.0 {
            self.at_start.clone_from(&now);
            self.arrival.begin(&height);
        } else {
            let moving = self.moving(&world.blocks, &now);
            let columns = self.ground.n[0];
            self.arrival
                .update(self.rule, columns, (&height, &moving), time);
        }
        for (highest, surface) in self.highest.iter_mut().zip(now) {
            // a maximum of NaN and a number is the number
            *highest = highest.max(surface);
        }
        self.schedule.done(world.time());
        let sheets = self.sheets(world.time());
        self.background.put(move || sheets.write())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let state = (self.schedule, &self.at_start, &self.highest, &self.arrival);
        postcard::to_extend(&state, out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        // each file is complete before it is renamed
        self.background.wait()
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, rest);
        ((schedule, self.at_start, self.highest, self.arrival), rest) =
            postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        Ok(rest)
    }
}
