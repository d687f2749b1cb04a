//! VTK frames: water, blocks, contacts and pressures on faces.

use std::path::{Path, PathBuf};

use riprap_dda::Vec3;

use super::arrays::{integers, scalars, single, vectors};
use super::face_pressures::face_pressures;
use super::{ObserveError, Observer, Schedule};
use crate::files::vtk::{self, Array, Collection, PolyData, Polygons, Values};
use crate::output::observe::labels::Labels;
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::{BlockField, WaterField};
use crate::world::{Water, World};

/// Writes `water_00000.vtp`, `blocks_00000.vtp`, ... and their collections.
#[derive(Debug)]
pub struct Frames {
    folder: PathBuf,
    schedule: Schedule,
    water_fields: Vec<WaterField>,
    block_fields: Vec<BlockField>,
    labels: Labels,
    water: Option<Collection>,
    blocks: Option<Collection>,
    contacts: Option<Collection>,
    faces: Option<Collection>,
    n_written: u32,
}

impl Frames {
    /// Frames of all kinds of objects in the world; fixed blocks are written here, once.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when the folder cannot be written.
    pub fn new(folder: &Path, scene: &Scene, world: &World) -> Result<Self, ObserveError> {
        let (blocks, output) = (&world.blocks, &scene.output);
        let labels = Labels::of(scene);
        let fixed: Vec<usize> = (0..blocks.n_blocks())
            .filter(|&b| world.is_fixed(b))
            .collect();
        if !fixed.is_empty() {
            let data = block_polygons(world, &fixed, &[], &labels);
            vtk::write(&folder.join(run_folder::FIXED_BLOCKS), &data)?;
        }
        let has_movers = fixed.len() < blocks.n_blocks();
        let collection = |stem: &str| Collection::new(folder, stem);
        Ok(Self {
            folder: folder.to_path_buf(),
            schedule: Schedule::every(output.frame_interval),
            water_fields: output.water_fields.clone(),
            block_fields: output.block_fields.clone(),
            labels,
            water: world
                .water
                .is_some()
                .then(|| collection(run_folder::WATER_FRAMES)),
            blocks: has_movers.then(|| collection(run_folder::BLOCK_FRAMES)),
            contacts: output
                .contacts
                .then(|| collection(run_folder::CONTACT_FRAMES)),
            faces: (output.face_pressures && world.water.is_some())
                .then(|| collection(run_folder::FACE_FRAMES)),
            n_written: 0,
        })
    }
}

impl Frames {
    fn collections(&self) -> [Option<&Collection>; 4] {
        [&self.water, &self.blocks, &self.contacts, &self.faces].map(Option::as_ref)
    }

    /// Removes later frames, which the run will write again.
    fn remove_later_frames(&self) -> Result<(), ObserveError> {
        for number in self.n_written.. {
            let mut is_any = false;
            for stem in run_folder::FRAMES {
                let path = self.folder.join(run_folder::frame(stem, number));
                match std::fs::remove_file(&path) {
                    Ok(()) => is_any = true,
                    Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
                    Err(source) => {
                        return Err(ObserveError::Write {
                            path: path.display().to_string(),
                            source,
                        });
                    }
                }
            }
            if !is_any {
                break;
            }
        }
        Ok(())
    }
}

impl Observer for Frames {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        let number = self.n_written;
        let folder = &self.folder;
        let write = |collection: &mut Collection, stem: &str, data: &PolyData| {
            let name = run_folder::frame(stem, number);
            vtk::write(&folder.join(&name), data)?;
            collection.push(data.time, name)
        };
        if let (Some(collection), Some(water)) = (&mut self.water, &world.water) {
            let mut data = water_points(water, &self.water_fields);
            data.time = world.time();
            write(collection, run_folder::WATER_FRAMES, &data)?;
        }
        if let Some(collection) = &mut self.blocks {
            let movers: Vec<usize> = (0..world.blocks.n_blocks())
                .filter(|&b| !world.is_fixed(b) && !world.blocks.is_removed(b))
                .collect();
            write(
                collection,
                run_folder::BLOCK_FRAMES,
                &block_polygons(world, &movers, &self.block_fields, &self.labels),
            )?;
        }
        if let Some(collection) = &mut self.contacts {
            write(
                collection,
                run_folder::CONTACT_FRAMES,
                &contact_points(world),
            )?;
        }
        if let (Some(collection), Some(water)) = (&mut self.faces, &world.water) {
            let mut data = face_pressures(water, &world.blocks);
            data.time = world.time();
            write(collection, run_folder::FACE_FRAMES, &data)?;
        }
        self.n_written += 1;
        self.schedule.done(world.time());
        Ok(())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let frames = self.collections().map(|c| c.map(Collection::frames));
        postcard::to_extend(&(self.schedule, self.n_written, frames), out)
    }

    fn sync(&self) -> Result<(), ObserveError> {
        // each file is synced before it is renamed
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        type Listed = [Option<Vec<(f64, String)>>; 4];
        let (schedule, listed, rest);
        ((schedule, self.n_written, listed), rest) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        let listed: Listed = listed;
        let Self {
            water,
            blocks,
            contacts,
            faces,
            ..
        } = self;
        for (collection, frames) in [water, blocks, contacts, faces].into_iter().zip(listed) {
            if let (Some(collection), Some(frames)) = (collection, frames) {
                collection.go_back(frames)?;
            }
        }
        self.remove_later_frames()?;
        Ok(rest)
    }
}

/// Particles in order of id, so that a particle has the same index in all frames.
fn water_points(water: &Water, fields: &[WaterField]) -> PolyData {
    let particles = water.fluid.particles();
    let mut order: Vec<u32> = (0..particles.len() as u32).collect();
    order.sort_unstable_by_key(|&a| particles.id[a as usize]);
    let order = order.iter().map(|&a| a as usize);
    let column = |values: &[f64]| order.clone().map(|a| values[a] as f32).collect();
    let point_data = fields
        .iter()
        .map(|field| match field {
            WaterField::Velocity => {
                vectors("Velocity", order.clone().map(|a| &particles.velocity[a]))
            }
            WaterField::Density => scalars("Density", column(&particles.density)),
            WaterField::Pressure => scalars("Pressure", column(&particles.pressure)),
            WaterField::Viscosity => {
                let of = |a| water.fluid.apparent_viscosity(a) as f32;
                scalars("Viscosity", order.clone().map(of).collect())
            }
            WaterField::Yielded => {
                let of = |a| i32::from(water.fluid.is_yielded(a));
                integers("Yielded", order.clone().map(of).collect())
            }
            WaterField::Id => integers(
                "Id",
                order
                    .clone()
                    .map(|a| u32::from(particles.id[a]) as i32)
                    .collect(),
            ),
        })
        .collect();
    PolyData {
        points: order.map(|a| single(&particles.position[a])).collect(),
        point_data,
        ..PolyData::default()
    }
}

/// Faces of blocks, with the values of the block on each face.
fn block_polygons(
    world: &World,
    which: &[usize],
    fields: &[BlockField],
    labels: &Labels,
) -> PolyData {
    let blocks = &world.blocks;
    let mut data = PolyData {
        time: world.time(),
        ..PolyData::default()
    };
    let (mut owner, mut numbers) = (Vec::new(), Vec::new());
    let Polygons {
        connectivity,
        offsets,
    } = &mut data.polygons;
    for &block in which {
        let (vertices, faces) = blocks.world_polygons(block);
        let first = data.points.len() as i32;
        data.points.extend(vertices.iter().map(single));
        for (number, face) in faces.iter().enumerate() {
            connectivity.extend(face.iter().map(|&v| first + v as i32));
            offsets.push(connectivity.len() as i32);
            owner.push(block);
            numbers.push(number);
        }
    }
    let per_face = |name: &str, value: &dyn Fn(usize) -> Vec3| {
        let values: Vec<Vec3> = owner.iter().map(|&block| value(block)).collect();
        vectors(name, values.iter())
    };
    labels.add_to(&mut data, &owner, &numbers);
    if which.iter().any(|&b| blocks.is_deformable(b)) {
        // xx yy zz yz zx xy, tension positive; a rigid block has none
        let stress = owner
            .iter()
            .flat_map(|&b| blocks.stress(b).unwrap_or([f64::NAN; 6]))
            .map(|c| c as f32)
            .collect();
        data.cell_data.push(Array {
            name: "Stress".to_owned(),
            components: 6,
            values: Values::F32(stress),
        });
    }
    for field in fields {
        data.cell_data.push(match field {
            BlockField::Velocity => per_face("Velocity", &|b| blocks.velocity(b)),
            BlockField::AngularVelocity => {
                per_face("AngularVelocity", &|b| blocks.angular_velocity(b))
            }
            BlockField::ForceFluid => per_face("ForceFluid", &|b| {
                world
                    .water
                    .as_ref()
                    .map_or(Vec3::zeros(), |water| water.interface.loads()[b].force)
            }),
            BlockField::ForceContact => {
                per_face("ForceContact", &|b| blocks.contact_force(b).force)
            }
        });
    }
    data
}

/// Contact points with normal, forces and state.
fn contact_points(world: &World) -> PolyData {
    let contacts = world.blocks.contacts();
    PolyData {
        points: contacts.iter().map(|c| single(&c.point)).collect(),
        point_data: vec![
            integers(
                "BlockA",
                contacts.iter().map(|c| c.blocks.0.index() as i32).collect(),
            ),
            integers(
                "BlockB",
                contacts.iter().map(|c| c.blocks.1.index() as i32).collect(),
            ),
            vectors("Normal", contacts.iter().map(|c| &c.normal)),
            scalars(
                "NormalForce",
                contacts.iter().map(|c| c.normal_force as f32).collect(),
            ),
            vectors("ShearForce", contacts.iter().map(|c| &c.shear_force)),
            scalars(
                "Overlap",
                contacts.iter().map(|c| c.overlap as f32).collect(),
            ),
            integers("State", contacts.iter().map(|c| c.state as i32).collect()),
        ],
        time: world.time(),
        ..PolyData::default()
    }
}
