//! VTK frames: water, blocks, contacts and pressures on faces. They are copied from the world and written beside the run.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use riprap_dda::Vec3;

use super::arrays::{integers, scalars, single, vectors};
use super::background::Background;
use super::face_pressures::face_pressures;
use super::{ObserveError, Observer, Schedule};
use crate::files::vtk::{self, Array, Collection, PolyData, Polygons, Values};
use crate::output::observe::labels::Labels;
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::{BlockField, Sampling, WaterField};
use crate::world::{Water, World};

/// A kind of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Water,
    Blocks,
    Contacts,
    Faces,
}

/// All kinds, in the order of their names in the run folder.
const KINDS: [Kind; 4] = [Kind::Water, Kind::Blocks, Kind::Contacts, Kind::Faces];

/// Frames of one kind, at times of their own.
#[derive(Debug)]
struct Stream {
    kind: Kind,
    sampling: Sampling,
    schedule: Schedule,
    collection: Collection,
}

impl Stream {
    fn stem(&self) -> &'static str {
        run_folder::FRAMES[self.kind as usize]
    }

    /// Number of the next frame.
    fn next(&self) -> u32 {
        self.collection.frames().len() as u32
    }

    /// Removes later frames, which the run will write again.
    fn remove_later_frames(&self, folder: &Path) -> Result<(), ObserveError> {
        for number in self.next().. {
            let path = folder.join(run_folder::frame(self.stem(), number));
            match std::fs::remove_file(&path) {
                Ok(()) => {}
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => break,
                Err(source) => {
                    return Err(ObserveError::Write {
                        path: path.display().to_string(),
                        source,
                    });
                }
            }
        }
        Ok(())
    }
}

/// Writes `water_00000.vtp`, `blocks_00000.vtp`, ... and their collections, each kind at its own times.
#[derive(Debug)]
pub struct Frames {
    folder: PathBuf,
    water_fields: Vec<WaterField>,
    block_fields: Vec<BlockField>,
    labels: Labels,
    /// Kinds that the world has and the scene asks for, in order.
    streams: Vec<Stream>,
    /// Of a world without any.
    none: Schedule,
    background: Background<FrameFiles>,
}

/// Frames of one time on disk.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameFiles {
    /// Simulated time; s.
    pub time: f64,
    /// Names within the run folder.
    pub names: Vec<String>,
}

/// A frame to be written, and the collection that lists it then.
struct Pending {
    name: String,
    data: PolyData,
    list: Collection,
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
            .filter(|&b| world.is_fixed(b) && !blocks.is_removed(b))
            .collect();
        if !fixed.is_empty() {
            let data = block_polygons(world, &fixed, &[], &labels);
            let time = world.time();
            let path = folder.join(run_folder::FIXED_BLOCKS);
            vtk::write(&path, &PolyData { time, ..data })?;
        }
        let has_movers = (0..blocks.n_blocks()).any(|b| !world.is_fixed(b));
        let has_water = world.water.is_some();
        let asked = KINDS.map(|kind| match kind {
            Kind::Water => (has_water, output.water),
            Kind::Blocks => (has_movers, output.blocks),
            Kind::Contacts => (output.contacts, output.contact_frames),
            Kind::Faces => (output.face_pressures && has_water, output.face_frames),
        });
        let streams = KINDS.into_iter().zip(asked);
        let streams = streams.filter(|(_, (is_asked, _))| *is_asked);
        Ok(Self {
            folder: folder.to_path_buf(),
            water_fields: output.water_fields.clone(),
            block_fields: output.block_fields.clone(),
            labels,
            streams: streams
                .map(|(kind, (_, sampling))| Stream {
                    kind,
                    sampling,
                    schedule: Schedule::every(sampling.interval),
                    collection: Collection::new(folder, run_folder::FRAMES[kind as usize]),
                })
                .collect(),
            none: Schedule::every(output.frame_interval),
            background: Background::new(),
        })
    }

    /// Files written since the last call, oldest first.
    ///
    /// # Errors
    ///
    /// The first failure among them.
    pub fn take_written(&mut self) -> Result<Vec<FrameFiles>, ObserveError> {
        self.background.take_written()
    }

    /// Waits until all frames are on disk.
    ///
    /// # Errors
    ///
    /// The first failure among them.
    pub fn wait(&mut self) -> Result<(), ObserveError> {
        self.background.wait()
    }

    /// Hands over a frame of each kind for which `is_wanted`.
    fn write(
        &mut self,
        world: &World,
        is_wanted: impl Fn(&Schedule) -> bool,
    ) -> Result<(), ObserveError> {
        let time = world.time();
        let (water_fields, block_fields) = (&self.water_fields, &self.block_fields);
        let labels = &self.labels;
        let mut pending = Vec::new();
        for stream in &mut self.streams {
            if !is_wanted(&stream.schedule) {
                continue;
            }
            let sampling = &stream.sampling;
            let data = match (stream.kind, &world.water) {
                (Kind::Water, Some(water)) => water_points(water, water_fields, sampling),
                (Kind::Faces, Some(water)) => face_pressures(water, &world.blocks, sampling),
                (Kind::Water | Kind::Faces, None) => PolyData::default(),
                (Kind::Blocks, _) => {
                    block_polygons(world, &moving_blocks(world, sampling), block_fields, labels)
                }
                (Kind::Contacts, _) => contact_points(world, sampling),
            };
            let name = run_folder::frame(stream.stem(), stream.next());
            stream.collection.add(time, name.clone())?;
            stream.schedule.done(time);
            pending.push(Pending {
                name,
                data: PolyData { time, ..data },
                list: stream.collection.clone(),
            });
        }
        if pending.is_empty() {
            return Ok(());
        }
        let folder = self.folder.clone();
        self.background.put(move || {
            let mut names = Vec::new();
            for Pending { name, data, list } in pending {
                vtk::write(&folder.join(&name), &data)?;
                list.write()?;
                names.push(name);
            }
            Ok(FrameFiles { time, names })
        })
    }
}

impl Observer for Frames {
    /// The schedule of the kind that is due next.
    fn schedule(&self) -> &Schedule {
        let schedules = self.streams.iter().map(|stream| &stream.schedule);
        schedules
            .min_by(|a, b| a.next_due().total_cmp(&b.next_due()))
            .unwrap_or(&self.none)
    }

    fn is_due(&self, world: &World) -> bool {
        let time = world.time();
        let mut streams = self.streams.iter();
        streams.any(|stream| stream.schedule.is_due(time))
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        let time = world.time();
        self.write(world, |schedule| schedule.is_due(time))
    }

    fn observe_last(&mut self, world: &World) -> Result<(), ObserveError> {
        let time = world.time();
        self.write(world, |schedule| schedule.last() != Some(time))
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let saved = KINDS.map(|kind| {
            let stream = self.streams.iter().find(|stream| stream.kind == kind);
            stream.map(|stream| (stream.schedule, stream.collection.frames()))
        });
        postcard::to_extend(&saved, out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        // each file is synced before it is renamed
        self.background.wait()
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        // a state restored within a run: frames on their way are removed as later ones, or were failures that ended it
        self.background.wait()?;
        type Listed = [Option<(Schedule, Vec<(f64, String)>)>; 4];
        let (listed, rest) = postcard::take_from_bytes::<Listed>(bytes)?;
        for (kind, saved) in KINDS.into_iter().zip(listed) {
            let stream = self.streams.iter_mut().find(|stream| stream.kind == kind);
            if let (Some(stream), Some((schedule, frames))) = (stream, saved) {
                stream.schedule.resume(schedule);
                stream.collection.go_back(frames)?;
                stream.remove_later_frames(&self.folder)?;
            }
        }
        Ok(rest)
    }
}

/// Blocks that move and are in the domain and the box.
fn moving_blocks(world: &World, sampling: &Sampling) -> Vec<usize> {
    let blocks = &world.blocks;
    (0..blocks.n_blocks())
        .filter(|&b| !world.is_fixed(b) && !blocks.is_removed(b))
        .filter(|&b| sampling.holds(&blocks.centroid(b)))
        .collect()
}

/// Particles in order of id, so that a particle has the same index in all frames that are not of a box.
fn water_points(water: &Water, fields: &[WaterField], sampling: &Sampling) -> PolyData {
    let particles = water.fluid.particles();
    let is_shown = |&a: &u32| {
        let a = a as usize;
        u32::from(particles.id[a]).is_multiple_of(sampling.stride.max(1))
            && sampling.holds(&particles.position[a])
    };
    let mut order: Vec<u32> = (0..particles.len() as u32).filter(is_shown).collect();
    order.par_sort_unstable_by_key(|&a| particles.id[a as usize]);
    let order = order.iter().map(|&a| a as usize);
    let column = |values: &[f64]| order.clone().map(|a| values[a] as f32).collect();
    let point_data = fields
        .iter()
        .map(|field| match field {
            WaterField::Porosity => {
                let of = |a| particles.porosity_of(a) as f32;
                scalars("Porosity", order.clone().map(of).collect())
            }
            WaterField::Velocity => {
                vectors("Velocity", order.clone().map(|a| &particles.velocity[a]))
            }
            WaterField::Density => {
                let of = |a| particles.water_density(a) as f32;
                scalars("Density", order.clone().map(of).collect())
            }
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
fn contact_points(world: &World, sampling: &Sampling) -> PolyData {
    let mut contacts = world.blocks.contacts();
    contacts.retain(|contact| sampling.holds(&contact.point));
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
        ..PolyData::default()
    }
}
