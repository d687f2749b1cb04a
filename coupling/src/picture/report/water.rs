//! The water of a report: its particles by number, or the height of its surface as a raster.

use std::collections::BTreeMap;

use super::packed::{Frames, Range, speed_code};
use crate::files::vtk::{PolyData, Values};
use crate::picture::render::RenderError;
use crate::picture::render::recording::{Recording, Timed, read};

/// Particles up to which those in space are shown one by one.
const MOST_PARTICLES: usize = 60_000;
/// Cells along the longer side of a raster, at most.
const MOST_CELLS: f32 = 320.0;
/// Width of a cell of a raster, in spacings, at least: one without a particle on a calm surface would be a hole.
const CELL: f32 = 1.5;
/// Height of a particle above its surroundings, in spacings, from which on it is spray.
const SPRAY: f32 = 2.5;
/// Of a position.
const BITS: u32 = 12;

/// Water as it is shown.
pub(super) struct Water {
    /// s.
    pub times: Vec<f64>,
    pub frames: Frames,
    pub look: Look,
    /// Speed at the upper end of the colors; m/s.
    pub largest_speed: f32,
}

/// What the items of the frames are.
pub(super) enum Look {
    /// Particles: interval of each coordinate (x and z in a plane); m.
    Particles { ranges: Vec<Range> },
    /// Highest points of the cells of a raster, row after row.
    Surface {
        /// Lower corner; m.
        corner: [f32; 2],
        /// m.
        cell: f32,
        /// Along x and y.
        size: [usize; 2],
        height: Range,
    },
}

/// Particles of a frame.
struct Particles {
    ids: Vec<i32>,
    points: Vec<[f32; 3]>,
    speeds: Vec<f32>,
}

impl Particles {
    fn of(data: &PolyData) -> Self {
        let find = |name: &str| data.point_data.iter().find(|array| array.name == name);
        let ids = match find("Id").map(|array| &array.values) {
            Some(Values::I32(ids)) => ids.clone(),
            _ => (0..data.points.len() as i32).collect(),
        };
        let speed = |v: &[f32]| v.iter().map(|x| x * x).sum::<f32>().sqrt();
        let speeds = match find("Velocity").map(|array| &array.values) {
            Some(Values::F32(v)) => v.chunks_exact(3).map(speed).collect(),
            _ => vec![0.0; data.points.len()],
        };
        Self {
            ids,
            points: data.points.clone(),
            speeds,
        }
    }

    /// Those with a finite place: number, place and speed.
    fn iter(&self) -> impl Iterator<Item = (i32, &[f32; 3], f32)> {
        let all = self.ids.iter().zip(&self.points).zip(&self.speeds);
        all.filter(|((_, x), _)| x.iter().all(|x| x.is_finite()))
            .map(|((&id, x), &speed)| (id, x, speed))
    }
}

impl Water {
    /// Level at rest, the middle of the first heights, and the largest change that one height in two hundred exceeds; m.
    pub fn swing(&self, height: Range) -> (f64, f64) {
        let value = |code: u16| f64::from(height.lo) + f64::from(code) * height.quantum();
        let of = |codes: &[u16]| -> Vec<f64> {
            let wet = codes.iter().filter(|&&code| code < height.absent());
            wet.map(|&code| value(code)).collect()
        };
        let first = self.frames.codes.first().map(|codes| of(codes));
        let mut first = first.unwrap_or_default();
        first.sort_by(f64::total_cmp);
        let rest = first.get(first.len() / 2).copied().unwrap_or(0.0);
        // over what was there first: at a steep shore a cell may hold deep water alone
        let swing = self.frames.codes.iter().map(|codes| {
            let wet = |code: &u16| *code < height.absent();
            let both = self.frames.codes.first().into_iter().flatten().zip(codes);
            let both = both.filter(|(first, now)| wet(first) && wet(now));
            let mut rises: Vec<f64> = both
                .map(|(&first, &now)| (value(now) - value(first)).abs())
                .collect();
            rises.sort_by(f64::total_cmp);
            let place = rises.len().saturating_sub(1 + rises.len() / 200);
            rises.get(place).copied().unwrap_or(0.0)
        });
        (rest, swing.fold(1e-6, f64::max))
    }
}

/// Box around the particles of all frames, their numbers and their speeds.
struct Extent {
    lo: [f32; 3],
    hi: [f32; 3],
    /// Where each particle was first.
    first: BTreeMap<i32, [f32; 3]>,
    /// Speed that one particle in a thousand exceeds in the fastest frame; m/s.
    fast: f32,
}

impl Extent {
    fn of(files: &[Timed]) -> Result<Self, RenderError> {
        let mut extent = Self {
            lo: [f32::INFINITY; 3],
            hi: [f32::NEG_INFINITY; 3],
            first: BTreeMap::new(),
            fast: 0.0,
        };
        for file in files {
            let particles = Particles::of(&read(&file.path)?);
            for (id, x, _) in particles.iter() {
                extent.lo = std::array::from_fn(|k| extent.lo[k].min(x[k]));
                extent.hi = std::array::from_fn(|k| extent.hi[k].max(x[k]));
                extent.first.entry(id).or_insert(*x);
            }
            let mut speeds: Vec<f32> = particles.iter().map(|(_, _, speed)| speed).collect();
            speeds.sort_by(f32::total_cmp);
            let place = speeds.len().saturating_sub(1 + speeds.len() / 1000);
            let fast = speeds.get(place).copied().unwrap_or(0.0);
            if fast.is_finite() {
                extent.fast = extent.fast.max(fast);
            }
        }
        Ok(extent)
    }
}

/// Reads the water of a run; `None` without.
pub(super) fn water(run: &Recording) -> Result<Option<Water>, RenderError> {
    if run.water.is_empty() {
        return Ok(None);
    }
    let extent = Extent::of(&run.water)?;
    if extent.first.is_empty() {
        return Ok(None);
    }
    // over terrain a surface shows the wave, and particles do not
    let has_terrain = run.fixed.iter().any(|body| body.is_terrain);
    let is_few = extent.first.len() <= MOST_PARTICLES && !has_terrain;
    let is_particles = run.scene.is_plane || is_few;
    let water = if is_particles {
        particles(&run.water, &extent, run.scene.is_plane)
    } else {
        surface(&run.water, &extent, run.spacing)
    };
    water.map(Some)
}

fn times(files: &[Timed]) -> Vec<f64> {
    files.iter().map(|file| file.time).collect()
}

fn particles(files: &[Timed], extent: &Extent, is_plane: bool) -> Result<Water, RenderError> {
    let axes: &[usize] = if is_plane { &[0, 2] } else { &[0, 1, 2] };
    let ranges: Vec<Range> = (axes.iter())
        .map(|&k| Range {
            lo: extent.lo[k],
            hi: extent.hi[k].max(extent.lo[k] + f32::EPSILON),
            bits: BITS,
        })
        .collect();
    let place = in_order(extent, &ranges, axes);
    let n_items = place.len();
    let mut frames = Frames {
        n_items,
        ..Frames::default()
    };
    for file in files {
        let absent = ranges.iter().flat_map(|r| vec![r.absent(); n_items]);
        let mut codes: Vec<u16> = absent.collect();
        let mut speeds = vec![0_u8; n_items];
        for (id, x, speed) in Particles::of(&read(&file.path)?).iter() {
            let Some(&at) = place.get(&id) else { continue };
            for (c, (&k, range)) in axes.iter().zip(&ranges).enumerate() {
                codes[c * n_items + at] = range.code(x[k]);
            }
            speeds[at] = speed_code(speed, extent.fast);
        }
        frames.codes.push(codes);
        frames.speeds.push(speeds);
    }
    Ok(Water {
        times: times(files),
        frames,
        look: Look::Particles { ranges },
        largest_speed: extent.fast,
    })
}

/// Places of the particles along a curve through where they were first, so that neighbors have similar codes.
fn in_order(extent: &Extent, ranges: &[Range], axes: &[usize]) -> BTreeMap<i32, usize> {
    let key = |x: &[f32; 3]| {
        let codes = ranges.iter().zip(axes).map(|(range, &k)| range.code(x[k]));
        let codes: Vec<u16> = codes.collect();
        (0..BITS).rev().fold(0_u64, |key, bit| {
            let digits = codes.iter().map(|code| u64::from(code >> bit & 1));
            digits.fold(key, |key, digit| key << 1 | digit)
        })
    };
    let mut order: Vec<(u64, i32)> = (extent.first.iter()).map(|(&id, x)| (key(x), id)).collect();
    order.sort_unstable();
    let numbered = order.into_iter().enumerate();
    numbered.map(|(place, (_, id))| (id, place)).collect()
}

fn surface(files: &[Timed], extent: &Extent, spacing: Option<f64>) -> Result<Water, RenderError> {
    let (lo, hi) = (extent.lo, extent.hi);
    let longer = (hi[0] - lo[0]).max(hi[1] - lo[1]);
    let spacing = spacing.map_or(longer / MOST_CELLS, |spacing| spacing as f32);
    let cell = (CELL * spacing).max(longer / MOST_CELLS);
    let count = |k: usize| ((hi[k] - lo[k]) / cell).floor() as usize + 1;
    let size = [count(0), count(1)];
    let height = Range {
        lo: lo[2],
        hi: (hi[2] + 0.5 * spacing).max(lo[2] + f32::EPSILON),
        bits: BITS,
    };
    let mut frames = Frames {
        n_items: size[0] * size[1],
        ..Frames::default()
    };
    for file in files {
        let particles = Particles::of(&read(&file.path)?);
        let mut cells = Cells::empty(size);
        for (_, x, speed) in particles.iter() {
            let column = |k: usize| (((x[k] - lo[k]) / cell) as usize).min(size[k] - 1);
            cells.add([column(0), column(1)], x[2] + 0.5 * spacing, speed);
        }
        cells.remove_spray(SPRAY * spacing);
        cells.fill_holes();
        frames
            .codes
            .push(cells.height.iter().map(|&z| height.code(z)).collect());
        let codes = cells.speed.iter().map(|&v| speed_code(v, extent.fast));
        frames.speeds.push(codes.collect());
    }
    Ok(Water {
        times: times(files),
        frames,
        look: Look::Surface {
            corner: [lo[0], lo[1]],
            cell,
            size,
            height,
        },
        largest_speed: extent.fast,
    })
}

/// A raster of surface heights (m, NaN where dry) and of speeds there (m/s).
struct Cells {
    size: [usize; 2],
    height: Vec<f32>,
    speed: Vec<f32>,
}

impl Cells {
    fn empty(size: [usize; 2]) -> Self {
        let n = size[0] * size[1];
        Self {
            size,
            height: vec![f32::NAN; n],
            speed: vec![0.0; n],
        }
    }

    fn add(&mut self, [i, j]: [usize; 2], z: f32, speed: f32) {
        let at = i + self.size[0] * j;
        if self.height[at].is_nan() || self.height[at] < z {
            (self.height[at], self.speed[at]) = (z, speed);
        }
    }

    /// The wet ones among the eight cells around one.
    fn around(&self, at: usize) -> impl Iterator<Item = usize> {
        let [nx, ny] = self.size.map(|n| n as isize);
        let (i, j) = ((at % self.size[0]) as isize, (at / self.size[0]) as isize);
        let steps = (-1..=1).flat_map(|dj| (-1..=1).map(move |di| (di, dj)));
        steps
            .filter(|&step| step != (0, 0))
            .map(move |(di, dj)| (i + di, j + dj))
            .filter(move |&(i, j)| 0 <= i && i < nx && 0 <= j && j < ny)
            .map(move |(i, j)| (i + nx * j) as usize)
            .filter(|&other| !self.height[other].is_nan())
    }

    /// Heights of single particles over the middle of their surroundings by more than a limit (m) give way to that.
    fn remove_spray(&mut self, limit: f32) {
        let mut heights = Vec::with_capacity(8);
        let kept: Vec<f32> = (0..self.height.len())
            .map(|at| {
                heights.clear();
                heights.extend(self.around(at).map(|other| self.height[other]));
                heights.sort_by(f32::total_cmp);
                match heights.get(heights.len() / 2) {
                    Some(&middle) if middle + limit < self.height[at] => middle,
                    None => f32::NAN,
                    _ => self.height[at],
                }
            })
            .collect();
        self.height = kept;
    }

    /// Dry cells among at least six wet ones are as these on average.
    fn fill_holes(&mut self) {
        let mut filled = Vec::new();
        for at in (0..self.height.len()).filter(|&at| self.height[at].is_nan()) {
            let (mut n, mut height, mut speed) = (0.0, 0.0, 0.0);
            for other in self.around(at) {
                n += 1.0;
                height += self.height[other];
                speed += self.speed[other];
            }
            if 5.5 < n {
                filled.push((at, height / n, speed / n));
            }
        }
        for (at, height, speed) in filled {
            (self.height[at], self.speed[at]) = (height, speed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_has_neither_spray_nor_holes() {
        let mut cells = Cells::empty([9, 9]);
        for at in 0..81 {
            if at != 40 {
                cells.add([at % 9, at / 9], 1.0, 0.5);
            }
        }
        cells.add([2, 2], 3.0, 9.0);
        cells.remove_spray(0.5);
        cells.fill_holes();
        assert!(cells.height.iter().all(|&z| z == 1.0), "{:?}", cells.height);
        // one cell of water by itself is spray, too
        let mut alone = Cells::empty([9, 9]);
        alone.add([4, 4], 1.0, 0.5);
        alone.remove_spray(0.5);
        assert!(alone.height.iter().all(|z| z.is_nan()));
    }
}
