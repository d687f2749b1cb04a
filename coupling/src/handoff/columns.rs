//! Columns of water on a raster.

use rayon::prelude::*;
use riprap_dda::{Blocks, Vec3};

use crate::world::ground::Ground;

/// Samples of the ground along a side of a cell.
const SAMPLES: usize = 8;
/// Share of a cell below water from which it has a depth.
const LEAST_OPEN: f64 = 0.25;
/// Height of FUNWAVE's velocities under the surface at rest over the depth; –: Kennedy et al. (2001), Coastal Engineering 42.
const ALPHA: f64 = 0.531;
/// Height of the particles whose pressure is continued to the bed; × particle spacing.
const BESIDE_BED: f64 = 2.0;
/// Weight of particles, from which a velocity is fitted over the depth.
const LEAST_WEIGHT: f64 = 3.0;

/// A raster in plan view. A section has one row as wide as it is thick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raster {
    /// Cells along x and y.
    pub n: [usize; 2],
    /// South-west corner of the south-west cell; m.
    pub corner: [f64; 2],
    /// Sides of a cell; m.
    pub side: [f64; 2],
}

/// Particles of water.
#[derive(Clone, Copy, Debug)]
pub struct Water<'a> {
    /// m.
    pub position: &'a [Vec3],
    /// m/s.
    pub velocity: &'a [Vec3],
    /// Pa.
    pub pressure: &'a [f64],
    /// kg.
    pub mass: &'a [f64],
    /// Volume of each; m³.
    pub volume: f64,
    /// Distance of particles at rest; m.
    pub spacing: f64,
}

/// Columns of water, row by row from the south-west.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// The raster.
    pub raster: Raster,
    /// Volume; m³.
    pub volume: Vec<f64>,
    /// Mass; kg.
    pub mass: Vec<f64>,
    /// Momentum; kg m/s.
    pub momentum: Vec<[f64; 2]>,
    /// Mean elevation of the ground, with blocks that lie on it, where water may be; NaN outside of the ground; m.
    pub ground: Vec<f64>,
    /// Depth of the water, 0 where dry; m.
    pub depth: Vec<f64>,
    /// Surface, the ground where dry; m.
    pub surface: Vec<f64>,
    /// Mean velocity over the depth; m/s.
    pub velocity: Vec<[f64; 2]>,
    /// Velocity at 0.531 of the depth below the surface, for Boussinesq solvers; m/s.
    pub velocity_alpha: Vec<[f64; 2]>,
    /// Pressure at the bed, from the particles within two spacings of it; NaN where dry; Pa.
    pub bed_pressure: Vec<f64>,
    /// Extent of the particles in height over the depth; much above 1 where a crest breaks; –.
    pub stretch: Vec<f64>,
}

impl Raster {
    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.n[0] * self.n[1]
    }

    /// Area of a cell; m².
    pub fn area(&self) -> f64 {
        self.side[0] * self.side[1]
    }

    /// Center of a cell; m.
    pub fn center(&self, cell: usize) -> [f64; 2] {
        let place = [cell % self.n[0], cell / self.n[0]];
        [0, 1].map(|axis| self.corner[axis] + (place[axis] as f64 + 0.5) * self.side[axis])
    }

    /// Cell of a place; `None` outside of all.
    pub fn cell_at(&self, at: [f64; 2]) -> Option<usize> {
        let is_inside = (0..2).all(|axis| {
            let along = at[axis] - self.corner[axis];
            (0.0..self.n[axis] as f64 * self.side[axis]).contains(&along)
        });
        is_inside.then(|| self.cell_of(at))
    }

    /// Cell of a place, the nearest one of a place outside.
    fn cell_of(&self, at: [f64; 2]) -> usize {
        let [i, j] = [0, 1].map(|axis| {
            let place = ((at[axis] - self.corner[axis]) / self.side[axis]).floor();
            place.clamp(0.0, self.n[axis] as f64 - 1.0) as usize
        });
        j * self.n[0] + i
    }

    /// Cells around a place along one axis with their weights, which sum to one: a quadratic B-spline, folded at the ends.
    fn weights(&self, x: f64, axis: usize) -> [(usize, f64); 3] {
        let last = self.n[axis] as f64 - 1.0;
        let place = ((x - self.corner[axis]) / self.side[axis] - 0.5).clamp(-0.5, last + 0.5);
        let nearest = place.round();
        let d = place - nearest;
        let cell = |offset: f64| (nearest + offset).clamp(0.0, last) as usize;
        [
            (cell(-1.0), 0.5 * (0.5 - d) * (0.5 - d)),
            (cell(0.0), 0.75 - d * d),
            (cell(1.0), 0.5 * (0.5 + d) * (0.5 + d)),
        ]
    }
}

/// Sums of the particles of a column, weighted.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    weight: f64,
    mass: f64,
    momentum: [f64; 2],
    /// Of height, its square, and velocities times it: for a line through velocities over the height.
    z: f64,
    zz: f64,
    u: [f64; 2],
    uz: [f64; 2],
}

/// Sums water into columns over the ground.
///
/// ```text
/// V = Σ w V_a,  M = Σ w m_a,  P = Σ w m_a v_a;     h = V/A,  η = ground + h,  U = P/M;  dry where h < a half spacing
/// ```
/// `w` is a quadratic B-spline of a cell along each side. `A` and the ground are of what is below water, spread by the same `w`.
///
/// The pressure at the bed continues that of its particles by the weight of the water (of gravity, m/s²) between them.
pub fn columns(raster: Raster, water: Water, ground: &Ground, gravity: f64) -> Columns {
    let n = raster.n_cells();
    let mut sums = vec![Sums::default(); n];
    let mut range = vec![[f64::INFINITY, f64::NEG_INFINITY]; n];
    for ((x, v), mass) in water.position.iter().zip(water.velocity).zip(water.mass) {
        let across = raster.weights(x.y, 1);
        for (i, along) in raster.weights(x.x, 0) {
            for (j, across) in across {
                let (cell, w) = (j * raster.n[0] + i, along * across);
                let sums = &mut sums[cell];
                sums.weight += w;
                sums.mass += w * mass;
                sums.z += w * x.z;
                sums.zz += w * x.z * x.z;
                for axis in 0..2 {
                    sums.momentum[axis] += w * mass * v[axis];
                    sums.u[axis] += w * v[axis];
                    sums.uz[axis] += w * v[axis] * x.z;
                }
                if 0.0 < w {
                    range[cell] = [range[cell][0].min(x.z), range[cell][1].max(x.z)];
                }
            }
        }
    }
    let mut columns = Columns {
        raster,
        volume: sums.iter().map(|sums| sums.weight * water.volume).collect(),
        mass: sums.iter().map(|sums| sums.mass).collect(),
        momentum: sums.iter().map(|sums| sums.momentum).collect(),
        ground: vec![f64::NAN; n],
        depth: vec![0.0; n],
        surface: vec![f64::NAN; n],
        velocity: vec![[0.0; 2]; n],
        velocity_alpha: vec![[0.0; 2]; n],
        bed_pressure: vec![f64::NAN; n],
        stretch: vec![0.0; n],
    };
    let beds = beds(&raster, water, ground);
    let mut is_wet = vec![false; n];
    for cell in 0..n {
        let Bed { area, height, dry } = beds[cell];
        let depth = columns.volume[cell] / area;
        // ground under the water only where there is enough of it
        if !(LEAST_OPEN * raster.area() <= area && 0.5 * water.spacing <= depth) {
            (columns.ground[cell], columns.surface[cell]) = (dry, dry);
            continue;
        }
        let bed = height / area;
        let sums = &sums[cell];
        let mean = sums.momentum.map(|momentum| momentum / sums.mass);
        columns.ground[cell] = bed;
        columns.depth[cell] = depth;
        columns.surface[cell] = bed + depth;
        columns.velocity[cell] = mean;
        let z = bed + (1.0 - ALPHA) * depth;
        columns.velocity_alpha[cell] = sums.at(z, water.spacing).unwrap_or(mean);
        is_wet[cell] = true;
        columns.stretch[cell] = (range[cell][1] - range[cell][0] + water.spacing) / depth;
    }
    press(&mut columns, water, (&is_wet, gravity));
    columns
}

/// Fills in the pressure at the bed of wet cells.
///
/// ```text
/// p = Σ (p_a + ρ g (z_a − bed)) / n      over the particles of the cell within two spacings of the bed
/// ```
fn press(columns: &mut Columns, water: Water, (is_wet, gravity): (&[bool], f64)) {
    let mut sums = vec![[0.0; 2]; is_wet.len()];
    let density = water.mass.first().map_or(0.0, |mass| mass / water.volume);
    for (x, pressure) in water.position.iter().zip(water.pressure) {
        let cell = columns.raster.cell_of([x.x, x.y]);
        let height = x.z - columns.ground[cell];
        if is_wet[cell] && height < BESIDE_BED * water.spacing {
            sums[cell][0] += 1.0;
            sums[cell][1] += pressure + density * gravity * height;
        }
    }
    for (pressure, [n, sum]) in columns.bed_pressure.iter_mut().zip(sums) {
        *pressure = sum / n;
    }
}

/// Volume of the water in each cell; m³.
pub fn volumes(raster: Raster, water: Water) -> Vec<f64> {
    let mut volumes = vec![0.0; raster.n_cells()];
    for x in water.position {
        let across = raster.weights(x.y, 1);
        for (i, along) in raster.weights(x.x, 0) {
            for (j, across) in across {
                volumes[j * raster.n[0] + i] += along * across * water.volume;
            }
        }
    }
    volumes
}

impl Sums {
    /// Velocity at a height by a line fitted over the height; `None` where the column is too thin for one.
    fn at(&self, z: f64, spacing: f64) -> Option<[f64; 2]> {
        let w = self.weight;
        let middle = self.z / w;
        let variance = self.zz / w - middle * middle;
        (LEAST_WEIGHT <= w && spacing * spacing < variance).then(|| {
            [0, 1].map(|axis| {
                let mean = self.u[axis] / w;
                let slope = (self.uz[axis] / w - mean * middle) / variance;
                mean + slope * (z - middle)
            })
        })
    }
}

/// Ground of a cell.
#[derive(Clone, Copy, Debug)]
struct Bed {
    /// Area below water, spread as the water is: uniform water has the same depth beside walls; m².
    area: f64,
    /// Elevation of it, times the area; m³.
    height: f64,
    /// Mean elevation of the whole cell; NaN without ground; m.
    dry: f64,
}

/// Ground of all cells from samples. One is below water if it is lower than the highest particle in its cell: tops of walls are not.
fn beds(raster: &Raster, water: Water, ground: &Ground) -> Vec<Bed> {
    let mut top = vec![f64::NEG_INFINITY; raster.n_cells()];
    for x in water.position {
        let cell = raster.cell_of([x.x, x.y]);
        top[cell] = top[cell].max(x.z + 0.5 * water.spacing);
    }
    let across = if raster.n[1] == 1 { 1 } else { SAMPLES };
    let share = |k: usize, n: usize| (k as f64 + 0.5) / n as f64 - 0.5;
    let places: Vec<[f64; 2]> = (0..across)
        .flat_map(|j| (0..SAMPLES).map(move |i| [share(i, SAMPLES), share(j, across)]))
        .collect();
    let sampled: Vec<Vec<([f64; 2], f64)>> = (0..raster.n_cells())
        .into_par_iter()
        .map(|cell| {
            let center = raster.center(cell);
            let at = |place: &[f64; 2]| {
                [0, 1].map(|axis| center[axis] + place[axis] * raster.side[axis])
            };
            let samples = places.iter().map(at);
            samples
                .filter_map(|at| Some((at, ground.height_under_the_sky(at)?)))
                .collect()
        })
        .collect();
    let mean = |samples: &Vec<([f64; 2], f64)>| {
        samples.iter().map(|(_, z)| z).sum::<f64>() / samples.len() as f64
    };
    let mut beds: Vec<Bed> = sampled
        .iter()
        .map(|samples| Bed {
            area: 0.0,
            height: 0.0,
            dry: mean(samples),
        })
        .collect();
    let area = raster.area() / places.len() as f64;
    for (cell, samples) in sampled.iter().enumerate() {
        for (at, z) in samples.iter().filter(|(_, z)| *z < top[cell]) {
            for (j, along_y) in raster.weights(at[1], 1) {
                for (i, along_x) in raster.weights(at[0], 0) {
                    let bed = &mut beds[j * raster.n[0] + i];
                    let part = area * along_x * along_y;
                    bed.area += part;
                    bed.height += part * z;
                }
            }
        }
    }
    beds
}

/// The ground with all blocks that lie on it, as solvers of the far field take it.
pub fn ground_with_blocks(blocks: &Blocks) -> Ground {
    let mut triangles = Vec::new();
    for block in (0..blocks.n_blocks()).filter(|&b| !blocks.is_removed(b)) {
        let (vertices, faces) = blocks.world_polygons(block);
        for face in faces {
            let corners: Vec<Vec3> = face.iter().map(|&v| vertices[v as usize]).collect();
            let fan = 2..corners.len();
            triangles.extend(fan.map(|k| [corners[0], corners[k - 1], corners[k]]));
        }
    }
    Ground::over(triangles)
}
