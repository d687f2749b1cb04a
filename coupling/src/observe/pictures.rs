//! What `overview.svg` shows: three side views, gauge records, the energy ledger.

use std::path::{Path, PathBuf};

use super::gauges::Gauges;
use super::ledgers::{ENERGY_COLUMNS, energy_row};
use crate::overview::{Outline, Overview, Record, Snapshot, svg};
use crate::scene::resolve::Scene;
use crate::world::World;

use super::ObserveError;

/// Gathers the material of `overview.svg` during a run.
#[derive(Debug)]
pub struct Pictures {
    overview: Overview,
    /// Place of each gauge record in the gauges' row.
    places: Vec<usize>,
    duration: f64,
}

impl Pictures {
    /// Nothing seen yet.
    pub fn new(scene: &Scene) -> Self {
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
                    .map_or(0.0, |f| f.lattice.particle_spacing()),
                snapshots: Vec::new(),
                gauges: columns
                    .iter()
                    .map(|(_, name, unit)| record(name, unit))
                    .collect(),
                energy: ENERGY_COLUMNS
                    .iter()
                    .map(|name| record(name, "J"))
                    .collect(),
                view: ([min.0, min.2], [max.0, max.2]),
            },
            places: columns.iter().map(|(place, _, _)| *place).collect(),
            duration: scene.file.time.duration,
        }
    }

    /// Takes over the row that the gauges have just written.
    pub fn note_gauges(&mut self, row: &[f64]) {
        let Some(&time) = row.first() else { return };
        for (record, &place) in self.overview.gauges.iter_mut().zip(&self.places) {
            record.time.push(time);
            record.value.push(row[place]);
        }
    }

    /// Notes the energy ledger; potential energy counts from the start.
    pub fn note_energy(&mut self, world: &World) {
        let row = energy_row(&world.energy());
        for (record, value) in self.overview.energy.iter_mut().zip(row) {
            record.time.push(world.time());
            record.value.push(value);
        }
    }

    /// Takes the view at the start and, once, at the middle.
    pub fn note_view(&mut self, world: &World) {
        let due = match self.overview.snapshots.len() {
            0 => 0.0,
            1 => 0.5 * self.duration,
            _ => return,
        };
        if due <= world.time() {
            self.overview.snapshots.push(snapshot(world));
        }
    }

    /// Takes the last view and writes `overview.svg`.
    ///
    /// # Errors
    ///
    /// [`ObserveError::Write`] names the file.
    pub fn write(
        &mut self,
        folder: &Path,
        world: &World,
        subtitle: String,
    ) -> Result<PathBuf, ObserveError> {
        self.overview.snapshots.push(snapshot(world));
        self.overview.subtitle = subtitle;
        // a term that the scene does not have needs no line in the legend
        self.overview
            .energy
            .retain(|record| record.value.iter().any(|&value| value != 0.0));
        let path = folder.join("overview.svg");
        std::fs::write(&path, svg(&self.overview)).map_err(|source| ObserveError::Write {
            path: path.display().to_string(),
            source,
        })?;
        Ok(path)
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
    let blocks = &world.blocks;
    let middle = 0.5 * (world.domain.0.y + world.domain.1.y);
    let outlines = (0..blocks.n_blocks())
        .filter(|&block| !blocks.is_removed(block))
        .flat_map(|block| blocks.parts_of(block).map(move |part| (block, part)))
        // the view is cut along the middle of the domain: side walls do not hide the water
        .filter(|&(_, part)| {
            let (low, high) = blocks.part_aabb(part);
            low.y <= middle && middle <= high.y
        })
        .map(|(block, part)| Outline {
            points: convex_outline(
                blocks
                    .part_points(part)
                    .iter()
                    .map(|v| [v.x as f32, v.z as f32])
                    .collect(),
            ),
            is_fixed: world.is_fixed(block),
        })
        .collect();
    Snapshot {
        time: world.time(),
        positions,
        speeds,
        outlines,
    }
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
