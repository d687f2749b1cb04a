//! Data of `overview.svg`: three side views, plan views, paths of falling blocks, gauge records, the energy ledger.

mod plan;

use std::path::{Path, PathBuf};

use riprap_dda::Vec3;

use super::overview::plan::FromAbove;
use super::overview::{Chart, Outline, Overview, Record, Snapshot, svg};
use crate::files::table::{TableData, read_table};
use crate::output::observe::ObserveError;
use crate::output::observe::gauges::Gauges;
use crate::output::observe::maps::Maps;
use crate::output::observe::trajectories::Trajectories;
use crate::output::run_folder;
use crate::saved::{Read, Saved};
use crate::scene::resolve::Scene;
use crate::world::World;
use crate::world::ledger::Energy;

/// Collects the data of `overview.svg` during a run.
#[derive(Debug)]
pub struct OverviewData {
    overview: Overview,
    /// Index of each gauge record in the row of gauges.
    places: Vec<usize>,
    duration: f64,
}

impl OverviewData {
    /// Nothing seen yet.
    pub fn new(scene: &Scene, world: &World) -> Self {
        let columns = Gauges::scalar_columns(scene);
        let record = |name: &str, unit: &str| Record {
            name: name.to_owned(),
            unit: unit.to_owned(),
            time: Vec::new(),
            value: Vec::new(),
        };
        let (min, max) = (scene.file.domain.min, scene.file.domain.max);
        Self {
            overview: Overview {
                title: scene.file.title.clone(),
                subtitle: String::new(),
                particle_spacing: scene
                    .fluid
                    .as_ref()
                    .map_or(0.0, |f| f.walls.particle_spacing),
                snapshots: Vec::new(),
                charts: Vec::new(),
                gauges: columns
                    .iter()
                    .map(|(_, name, unit)| record(name, unit))
                    .collect(),
                energy: Energy::TERMS.iter().map(|name| record(name, "J")).collect(),
                view: ([min.0, min.2], [max.0, max.2]),
                plan: plan::begun(scene, world),
            },
            places: columns.iter().map(|(place, _, _)| *place).collect(),
            duration: scene.file.time.duration,
        }
    }

    /// Takes the records of gauges and of the energy ledger from the tables of the run.
    fn read_records(&mut self, folder: &Path) -> Result<(), ObserveError> {
        let gauges = read_table(&folder.join(run_folder::GAUGES))?;
        let energy = read_table(&folder.join(run_folder::ENERGY))?;
        let places = self.places.iter().copied();
        fill(&mut self.overview.gauges, &gauges, places);
        fill(&mut self.overview.energy, &energy, 1..);
        Ok(())
    }

    /// Appends the views taken so far to some bytes.
    pub fn save(&self, out: Vec<u8>) -> Saved {
        let plans = self.overview.plan.as_ref().map(|plan| &plan.views);
        postcard::to_extend(&(&self.overview.snapshots, plans), out)
    }

    /// Restores the views; returns the rest of the bytes.
    pub fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        let (views, rest): (Option<Vec<FromAbove>>, _);
        ((self.overview.snapshots, views), rest) = postcard::take_from_bytes(bytes)?;
        if let Some((plan, views)) = self.overview.plan.as_mut().zip(views) {
            plan.views = views;
        }
        Ok(rest)
    }

    /// Plots bounce heights and run-out of the tracked blocks.
    pub fn add_trajectories(&mut self, trajectories: &Trajectories) {
        let run_outs = trajectories.run_outs();
        if run_outs.is_empty() {
            return;
        }
        self.overview.charts = vec![bounce_heights(&trajectories.heights()), reached(&run_outs)];
    }

    /// Draws the maps.
    pub fn add_maps(&mut self, maps: &Maps) {
        if let Some(plan) = &mut self.overview.plan {
            plan::add_maps(plan, maps);
        }
    }

    /// Takes the view at the start, also from above, and once at the middle.
    pub fn add_view(&mut self, world: &World) {
        let due = match self.overview.snapshots.len() {
            0 => 0.0,
            1 => 0.5 * self.duration,
            _ => return,
        };
        if due <= world.time() {
            if self.overview.snapshots.is_empty() {
                self.add_plan_view(world);
            }
            self.overview.snapshots.push(snapshot(world));
        }
    }

    fn add_plan_view(&mut self, world: &World) {
        if let Some(plan) = &mut self.overview.plan {
            plan.views.push(plan::from_above(plan, world));
        }
    }

    /// Takes the last view and writes `overview.svg`.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write(
        &mut self,
        folder: &Path,
        world: &World,
        subtitle: String,
    ) -> Result<PathBuf, ObserveError> {
        self.overview.snapshots.push(snapshot(world));
        self.add_plan_view(world);
        self.overview.subtitle = subtitle;
        self.read_records(folder)?;
        // terms absent from the scene are omitted from the legend
        self.overview
            .energy
            .retain(|record| record.value.iter().any(|&value| value != 0.0));
        let path = folder.join(run_folder::OVERVIEW);
        std::fs::write(&path, svg(&self.overview)).map_err(|source| ObserveError::Write {
            path: path.display().to_string(),
            source,
        })?;
        Ok(path)
    }
}

/// Envelope of the heights above ground over the horizontal distance, and the heights exceeded by 10 % and
/// 50 % of the blocks.
fn bounce_heights(heights: &[(f64, Vec<f64>)]) -> Chart {
    // NaN, where no block passed, is a gap
    let passed_by = |share: f64| -> Vec<f64> {
        let rank = |heights: &Vec<f64>| {
            let place = ((1.0 - share) * heights.len() as f64) as usize;
            let place = place.min(heights.len().saturating_sub(1));
            heights.get(place).copied().unwrap_or(f64::NAN)
        };
        heights.iter().map(|(_, heights)| rank(heights)).collect()
    };
    let curve = |name: &str, share: f64| Record {
        name: name.to_owned(),
        unit: "m".to_owned(),
        time: heights.iter().map(|(distance, _)| *distance).collect(),
        value: passed_by(share),
    };
    Chart {
        label: "bounce height".to_owned(),
        along: "horizontal distance from the start [m]".to_owned(),
        curves: vec![
            curve("highest", 0.0),
            curve("one in ten above", 0.1),
            curve("half above", 0.5),
        ],
    }
}

/// Cumulative distribution of the run-out, as a step function.
fn reached(run_outs: &[f64]) -> Chart {
    let n = run_outs.len() as f64;
    let steps = (0..).zip(run_outs);
    let mut stair = Record {
        name: "blocks".to_owned(),
        unit: String::new(),
        time: vec![0.0],
        value: vec![0.0],
    };
    for (k, &run_out) in steps {
        stair.time.extend([run_out, run_out]);
        stair.value.extend([f64::from(k) / n, f64::from(k + 1) / n]);
    }
    Chart {
        label: "share of blocks".to_owned(),
        along: "went no farther than [m]".to_owned(),
        curves: vec![stair],
    }
}

/// Fills records with the columns of a table at these places; the first is the time.
fn fill(records: &mut [Record], table: &TableData, places: impl Iterator<Item = usize>) {
    let Some(time) = table.values.first() else {
        return;
    };
    for (record, place) in records.iter_mut().zip(places) {
        if let Some(values) = table.values.get(place) {
            record.time.clone_from(time);
            record.value.clone_from(values);
        }
    }
}

fn snapshot(world: &World) -> Snapshot {
    let (mut positions, mut speeds) = (Vec::new(), Vec::new());
    if let Some(water) = &world.water {
        let particles = water.fluid.particles();
        positions = particles
            .position
            .iter()
            .map(|x| [x.x as f32, x.y as f32, x.z as f32])
            .collect();
        speeds = particles.velocity.iter().map(|v| v.norm() as f32).collect();
    }
    Snapshot {
        time: world.time(),
        positions,
        speeds,
        outlines: outlines(world),
    }
}

/// Silhouettes of the blocks cut by the middle plane of the domain, without side walls that would hide the water. On
/// terrain, which appears as a section only, all moving blocks.
fn outlines(world: &World) -> Vec<Outline> {
    let blocks = &world.blocks;
    let middle = 0.5 * (world.domain().0.y + world.domain().1.y);
    let is_present = |&b: &usize| !blocks.is_removed(b);
    // only surfaces have no volume
    let (surfaces, solids): (Vec<usize>, Vec<usize>) = (0..blocks.n_blocks())
        .filter(is_present)
        .partition(|&b| blocks.volume(b) == 0.0);
    let shows_all = !surfaces.is_empty();
    let sections = surfaces.iter().flat_map(|&b| {
        let (vertices, faces) = blocks.world_polygons(b);
        section(&vertices, &faces, middle, world.domain().0.z)
    });
    let solids = solids
        .into_iter()
        .flat_map(|block| blocks.parts_of(block).map(move |part| (block, part)))
        .filter(|&(block, part)| {
            let (low, high) = blocks.part_aabb(part);
            low.y <= middle && middle <= high.y || shows_all && !world.is_fixed(block)
        })
        .map(|(block, part)| {
            let points = blocks.part_points(part);
            Outline {
                points: convex_outline(points.iter().map(in_view).collect()),
                is_fixed: world.is_fixed(block),
            }
        });
    sections.chain(solids).collect()
}

fn in_view(x: &Vec3) -> [f32; 2] {
    [x.x as f32, x.z as f32]
}

/// Section of a triangulated surface at `y` = middle: the ground below a terrain, down to `bottom` (m); individual cuts
/// where it overhangs.
fn section(vertices: &[Vec3], faces: &[Vec<u32>], middle: f64, bottom: f64) -> Vec<Outline> {
    let corner = |v: u32| vertices[v as usize];
    let cut = |face: &Vec<u32>| -> Vec<[f32; 2]> {
        (0..face.len())
            .map(|k| (corner(face[k]), corner(face[(k + 1) % face.len()])))
            .filter(|(p, q)| (p.y <= middle) != (q.y <= middle))
            .map(|(p, q)| in_view(&p.lerp(&q, (middle - p.y) / (q.y - p.y))))
            .collect()
    };
    let cuts = faces.iter().map(cut).filter(|cut| !cut.is_empty());
    let looks_up = |face: &Vec<u32>| {
        let [a, b, c] = [0, 1, 2].map(|k| corner(face[k]));
        (b - a).xy().perp(&(c - a).xy()) > 0.0
    };
    let outline = |points| Outline {
        points,
        is_fixed: true,
    };
    if !faces.iter().all(looks_up) {
        return cuts.map(outline).collect();
    }
    let mut points: Vec<[f32; 2]> = cuts.flatten().collect();
    points.sort_by(|p, q| p[0].total_cmp(&q[0]));
    points.dedup();
    let Some((&first, &last)) = points.first().zip(points.last()) else {
        return Vec::new();
    };
    let bottom = bottom as f32;
    points.extend([[last[0], bottom], [first[0], bottom]]);
    vec![outline(points)]
}

/// Convex hull in the plane by Andrew's monotone chain, counter-clockwise.
fn convex_outline(mut points: Vec<[f32; 2]>) -> Vec<[f32; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let turns_left = |o: [f32; 2], a: [f32; 2], b: [f32; 2]| {
        (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]) > 0.0
    };
    let chain = |points: &mut dyn Iterator<Item = [f32; 2]>| {
        let mut chain: Vec<[f32; 2]> = Vec::new();
        for p in points {
            while let [.., o, a] = chain.as_slice()
                && !turns_left(*o, *a, p)
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_section_of_a_terrain_is_what_lies_below_it() {
        let at = |x: f64, y: f64| Vec3::new(x, y, x * x + y);
        let vertices = [
            at(0.0, 0.0),
            at(2.0, 0.0),
            at(4.0, 0.0),
            at(0.0, 2.0),
            at(2.0, 2.0),
            at(4.0, 2.0),
        ];
        let faces = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]].map(|face| face.to_vec());
        let found = section(&vertices, &faces, 1.0, -3.0);
        let expected = [
            [0.0, 1.0],
            [1.0, 3.0],
            [2.0, 5.0],
            [3.0, 11.0],
            [4.0, 17.0],
            [4.0, -3.0],
            [0.0, -3.0],
        ];
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].points, expected);
        // a surface facing down is not a terrain
        let turned = faces.map(|face| face.into_iter().rev().collect());
        assert_eq!(section(&vertices, &turned, 1.0, -3.0).len(), 4);
    }

    #[test]
    fn the_outline_of_a_box_with_points_inside_is_its_corners() {
        let points = vec![
            [0.0, 0.0],
            [1.0, 0.0],
            [0.5, 0.5],
            [1.0, 2.0],
            [0.0, 2.0],
            [0.0, 1.0],
        ];
        assert_eq!(
            convex_outline(points),
            [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]]
        );
    }
}
