//! Groups of blocks as one body: position, speed and submerged volume of a slide, and its energy transfer to the water.

use std::path::Path;

use riprap_dda::{Blocks, Vec3};

use super::{ObserveError, Observer, Schedule};
use crate::files::table::{Column, Start, Table};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::world::World;

/// Writes `masses.csv`.
#[derive(Debug)]
pub struct Masses {
    schedule: Schedule,
    table: Table,
    /// Blocks of each, and their initial positions; m.
    members: Vec<Vec<(usize, Vec3)>>,
    /// Still-water level; m.
    level: f64,
    row: Vec<f64>,
}

/// Columns of a mass and their units.
const COLUMNS: [(&str, &str); 11] = [
    ("x", "m"),
    ("y", "m"),
    ("z", "m"),
    ("speed", "m/s"),
    ("fastest", "m/s"),
    ("run_out", "m"),
    ("kinetic", "J"),
    ("potential", "J"),
    ("volume", "m3"),
    ("volume_under_water", "m3"),
    ("blocks", "-"),
];
/// Columns of the water: its energies, and the work of moving blocks on it since the start.
const WATER_COLUMNS: [&str; 3] = ["water.kinetic", "water.potential", "water.work"];

impl Masses {
    /// A table in `folder` with the columns of the scene's masses; a row per interval of `blocks.csv`.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when the table cannot be created.
    pub fn new(
        folder: &Path,
        scene: &Scene,
        world: &World,
        start: Start,
    ) -> Result<Self, ObserveError> {
        let mut columns = vec![Column::new("time", "s")];
        let mut members = Vec::new();
        for mass in &scene.masses {
            let named = COLUMNS.iter();
            columns.extend(named.map(|(c, unit)| Column::new(format!("{}.{c}", mass.name), *unit)));
            let blocks = mass.blocks.iter();
            members.push(blocks.map(|&b| (b, world.blocks.centroid(b))).collect());
        }
        if world.water.is_some() {
            columns.extend(WATER_COLUMNS.map(|c| Column::new(c, "J")));
        }
        Ok(Self {
            schedule: Schedule::every(scene.output.ledger_interval),
            table: Table::open(&folder.join(run_folder::MASSES), &columns, start)?,
            members,
            level: scene
                .fluid
                .as_ref()
                .map_or(f64::NEG_INFINITY, |water| water.lattice.still_water_level),
            row: Vec::with_capacity(columns.len()),
        })
    }
}

impl Observer for Masses {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        self.row.clear();
        self.row.push(world.time());
        for members in &self.members {
            push_mass(world, members, self.level, &mut self.row);
        }
        if let Some(water) = &world.water {
            let energies = water.fluid.energies();
            let given = world.work_on_water();
            self.row
                .extend([energies.kinetic, energies.potential, given]);
        }
        self.table.row(&self.row)?;
        self.schedule.done(world.time());
        Ok(())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        postcard::to_extend(&(self.schedule, self.table.length()), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        self.table.sync()?;
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, length, rest);
        ((schedule, length), rest) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        self.table.cut(length)?;
        Ok(rest)
    }
}

/// Appends [`COLUMNS`] of the blocks still in the domain; NaN if there are none.
fn push_mass(world: &World, members: &[(usize, Vec3)], level: f64, row: &mut Vec<f64>) {
    let blocks = &world.blocks;
    let left = || members.iter().filter(|&&(b, _)| !blocks.is_removed(b));
    let here = || left().map(|&(b, _)| b);
    let mass: f64 = here().map(|b| blocks.mass(b)).sum();
    let center: Vec3 = here()
        .map(|b| blocks.centroid(b) * blocks.mass(b))
        .sum::<Vec3>()
        / mass;
    let momentum: Vec3 = here().map(|b| blocks.velocity(b) * blocks.mass(b)).sum();
    let fastest = here()
        .map(|b| blocks.velocity(b).norm())
        .fold(f64::NAN, f64::max);
    let run_out = left()
        .map(|(b, start)| (blocks.centroid(*b) - start).xy().norm())
        .fold(f64::NAN, f64::max);
    let kinetic: f64 = here().map(|b| blocks.kinetic_energy(b)).sum();
    let potential: f64 = here()
        .map(|b| -blocks.mass(b) * world.gravity.dot(&blocks.centroid(b)))
        .sum();
    let volume: f64 = here().map(|b| volume_below(blocks, b, f64::INFINITY)).sum();
    let under_water: f64 = here().map(|b| volume_below(blocks, b, level)).sum();
    row.extend(center.iter());
    row.extend([momentum.norm() / mass, fastest, run_out, kinetic, potential]);
    row.extend([volume, under_water, here().count() as f64]);
}

/// Volume of a block below a level (m); m³.
///
/// ```text
/// V = Σ_faces ∫ (z − level) n_z dA    over what of each face is below          the cut adds nothing [m³]
/// ```
fn volume_below(blocks: &Blocks, block: usize, level: f64) -> f64 {
    let (vertices, faces) = blocks.world_polygons(block);
    // any level above the block will do for all of it
    let top = vertices
        .iter()
        .map(|x| x.z)
        .fold(f64::NEG_INFINITY, f64::max);
    let level = level.min(top);
    let mut below = Vec::new();
    let mut volume = 0.0;
    for face in faces {
        below.clear();
        for (k, &corner) in face.iter().enumerate() {
            let from = vertices[corner as usize];
            let to = vertices[face[(k + 1) % face.len()] as usize];
            if from.z <= level {
                below.push(from);
            }
            if (from.z < level && level < to.z) || (to.z < level && level < from.z) {
                below.push(from + (to - from) * ((level - from.z) / (to.z - from.z)));
            }
        }
        for pair in below.windows(2).skip(1) {
            let (a, b, c) = (below[0], pair[0], pair[1]);
            let twice_area = (b - a).xy().perp(&(c - a).xy());
            volume += 0.5 * twice_area * ((a.z + b.z + c.z) / 3.0 - level);
        }
    }
    volume
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use riprap_dda::{BlockDefinition, Isometry, Material, Motion, Polyhedron, Settings, Shape};

    fn blocks(parts: Vec<Polyhedron>) -> Blocks {
        let rock = Material {
            density: 2500.0,
            friction_angle: 0.5,
            residual_friction_angle: None,
            cohesion: 0.0,
            residual_cohesion: 0.0,
            tensile_strength: 0.0,
            restitution: 0.0,
            contact_stiffness: 1e8,
            joint_stiffness: None,
            shear_stiffness_ratio: 0.8,
            shear_damping_ratio: 0.2,
            rolling_friction: 0.0,
            twisting_friction: 0.0,
            elastic: None,
        };
        let body = BlockDefinition {
            shape: Shape::Polyhedra(parts),
            material: 0,
            motion: Motion::Free,
            velocity: Vec3::zeros(),
            angular_velocity: Vec3::zeros(),
            deformability: None,
        };
        Blocks::new(vec![body], vec![rock], Settings::default()).unwrap()
    }

    /// A cube of 2 m, upright and on its edge, in one part and in two: half of it is below its middle, of the upright one a quarter
    /// below 0.5 m, of the one on its edge `h²` of 2 m width below h.
    #[test]
    fn a_cube_is_cut_by_the_level() {
        let cuboid =
            |min: [f64; 3], max: [f64; 3]| Polyhedron::cuboid(min.into(), max.into()).unwrap();
        let whole = vec![cuboid([0.0; 3], [2.0; 3])];
        let halves = vec![
            cuboid([0.0; 3], [0.7, 2.0, 2.0]),
            cuboid([0.7, 0.0, 0.0], [2.0; 3]),
        ];
        let turn = UnitQuaternion::from_axis_angle(&Vec3::y_axis(), std::f64::consts::FRAC_PI_4);
        let on_edge = Isometry::from_parts(Vec3::new(0.0, 0.0, 2.0_f64.sqrt()).into(), turn);
        for parts in [whole, halves] {
            let turned = parts
                .iter()
                .map(|part| part.transformed(&on_edge))
                .collect();
            let (upright, turned) = (blocks(parts), blocks(turned));
            for (blocks, level, expected) in [
                (&upright, -1.0, 0.0),
                (&upright, 0.5, 2.0),
                (&upright, 1.0, 4.0),
                (&upright, f64::INFINITY, 8.0),
                (&turned, 0.5, 2.0 * 0.25),
                (&turned, 2.0_f64.sqrt(), 4.0),
                (&turned, 9.0, 8.0),
            ] {
                let found = volume_below(blocks, 0, level);
                assert!((found - expected).abs() < 1e-12, "{level}: {found}");
            }
        }
    }
}
