//! Paths of what grew first: as lines for ParaView, and as three lines of text.

use std::fmt::Write as _;

use riprap_dda::Vec3;

use super::growth::{Grown, Object, Quantity, Scales};
use crate::files::vtk::{Array, PolyData, Polygons, Values};
use crate::output::observe::arrays::{integers, scalars, single, vectors};
use crate::output::run_folder::OFFENDERS;
use crate::scene::overlaps::on_the_map;
use crate::scene::resolve::Scene;
use crate::world::World;

/// Last values of a quantity in words.
const SPOKEN: usize = 6;
/// Distance up to which the closest block is named; × spacing.
const NEAR: f64 = 5.0;

/// Recording of objects over some steps.
#[derive(Debug)]
pub struct Paths {
    paths: Vec<Path>,
    /// Place of the first object when it had grown.
    beside: String,
}

/// Path of an object.
#[derive(Debug)]
struct Path {
    grown: Grown,
    samples: Vec<Sample>,
}

/// State of an object after a step; quantities that it does not have are NaN.
#[derive(Clone, Copy, Debug)]
struct Sample {
    step: u64,
    /// s.
    time: f64,
    /// m.
    position: Vec3,
    /// m/s.
    velocity: Vec3,
    /// kg/m³.
    density: f64,
    /// Pa.
    pressure: f64,
    /// Largest at any of its contacts; m.
    overlap: f64,
    /// With the fastest point of a block by its spin; m/s.
    speed: f64,
}

impl Paths {
    /// Paths of some objects, of which nothing is recorded.
    pub fn new(grown: Vec<Grown>) -> Self {
        let path = |grown| Path {
            grown,
            samples: Vec::new(),
        };
        Self {
            paths: grown.into_iter().map(path).collect(),
            beside: String::new(),
        }
    }

    /// Records the present state, after a step and at a time (s).
    pub fn record(&mut self, world: &World, scene: &Scene, (step, time): (u64, f64)) {
        for path in &mut self.paths {
            let sample = match path.grown.object {
                Object::Particle(id) => {
                    let fluid = world.water.as_ref().map(|water| &water.fluid);
                    fluid.and_then(|fluid| {
                        let particles = fluid.particles();
                        let a = particles.id.iter().position(|other| *other == id)?;
                        Some(Sample {
                            step,
                            time,
                            position: particles.position[a],
                            velocity: particles.velocity[a],
                            density: particles.water_density(a),
                            pressure: particles.pressure[a],
                            overlap: f64::NAN,
                            speed: particles.velocity[a].norm(),
                        })
                    })
                }
                Object::Block(b) => Some(Sample {
                    step,
                    time,
                    position: world.blocks.centroid(b),
                    velocity: world.blocks.velocity(b),
                    density: f64::NAN,
                    pressure: f64::NAN,
                    overlap: deepest(world, b).map_or(0.0, |(overlap, _)| overlap),
                    speed: world.blocks.velocity(b).norm()
                        + world.blocks.angular_velocity(b).norm() * world.blocks.radius(b),
                }),
            };
            let Some(mut sample) = sample else { continue };
            // a viewer finds no bounds for what is nowhere: it stays where it was last
            if !sample.position.iter().all(|x| x.is_finite()) {
                let Some(last) = path.samples.last() else {
                    continue;
                };
                sample.position = last.position;
            }
            path.samples.push(sample);
        }
        if let Some(path) = self.paths.first()
            && path.grown.step == step
            && let Some(sample) = path.samples.last()
        {
            self.beside = beside(path.grown.object, sample, world, scene);
        }
    }

    /// Leaves out all but the last samples of each path.
    pub fn shorten(&mut self, n_samples: usize) {
        for path in &mut self.paths {
            let n_older = path.samples.len().saturating_sub(n_samples);
            path.samples.drain(..n_older);
        }
    }

    /// A line per object through its places, with its values at each.
    pub fn poly_data(&self) -> PolyData {
        let drawn = || self.paths.iter().filter(|path| 1 < path.samples.len());
        let samples = || drawn().flat_map(|path| &path.samples);
        let per_point = |value: &dyn Fn(&Path) -> i32| -> Vec<i32> {
            let of = |path| std::iter::repeat_n(value(path), path.samples.len());
            drawn().flat_map(of).collect()
        };
        let column = |value: &dyn Fn(&Sample) -> f64| -> Vec<f32> {
            samples().map(|sample| value(sample) as f32).collect()
        };
        let number = |grown: &Grown| {
            let same = |path: &Path| path.grown == *grown;
            1 + self.paths.iter().position(same).unwrap_or_default() as i32
        };
        let n_points = samples().count() as i32;
        let ends = drawn().scan(0, |end, path| {
            *end += path.samples.len() as i32;
            Some(*end)
        });
        PolyData {
            points: samples().map(|sample| single(&sample.position)).collect(),
            lines: Polygons {
                connectivity: (0..n_points).collect(),
                offsets: ends.collect(),
            },
            point_data: vec![
                integers("Order", per_point(&|path| number(&path.grown))),
                integers(
                    "Id",
                    per_point(&|path| match path.grown.object {
                        Object::Particle(id) => u32::from(id) as i32,
                        Object::Block(_) => -1,
                    }),
                ),
                integers(
                    "BlockId",
                    per_point(&|path| match path.grown.object {
                        Object::Particle(_) => -1,
                        Object::Block(b) => b as i32,
                    }),
                ),
                integers("Step", samples().map(|sample| sample.step as i32).collect()),
                Array {
                    name: "Time".to_owned(),
                    components: 1,
                    values: Values::F64(samples().map(|sample| sample.time).collect()),
                },
                vectors("Velocity", samples().map(|sample| &sample.velocity)),
                scalars("Speed", column(&|sample| sample.speed)),
                scalars("Density", column(&|sample| sample.density)),
                scalars("Pressure", column(&|sample| sample.pressure)),
                scalars("Overlap", column(&|sample| sample.overlap)),
            ],
            time: samples().map(|sample| sample.time).fold(0.0, f64::max),
            ..PolyData::default()
        }
    }

    /// First offender with its place, growth of its quantity, and all that followed; `None` without an offender.
    pub fn in_words(&self, scene: &Scene, scales: Scales) -> Option<String> {
        let (first, others) = self.paths.split_first()?;
        let Grown {
            object,
            quantity,
            step,
            ..
        } = first.grown;
        let at = first.samples.iter().rfind(|sample| sample.step <= step);
        let at = at.or(first.samples.first())?;
        let (begin, end) = (first.samples.first()?.step, first.samples.last()?.step);
        let n = end - begin;
        let origin = scene.terrain.as_ref().map(|terrain| terrain.origin);
        let quality = quantity.name();
        let mut text = match first.grown.is_large() {
            true => "first to grow".to_owned(),
            false => format!("nothing grew to twice the largest before within {n} steps; suspect"),
        };
        let _ = write!(
            text,
            ": {} near ({:.4}, {:.4}, {:.4}) m{}{}: its {quality}, at step {step}, {}",
            in_words(object, scene),
            at.position.x,
            at.position.y,
            at.position.z,
            on_the_map(&at.position, origin),
            self.beside,
            before_the_end(end - step),
        );
        let values: Vec<String> = (first.samples.iter())
            .rev()
            .take(SPOKEN)
            .rev()
            .map(|sample| digits(quantity.of(sample)))
            .collect();
        let _ = write!(
            text,
            "\nits {quality}: {} {}, the last {} of {n} steps; {}",
            values.join(", "),
            quantity.unit(),
            values.len(),
            largest_before(object, quantity, scales),
        );
        let then: Vec<String> = others
            .iter()
            .map(|path| {
                let Grown {
                    object, quantity, ..
                } = path.grown;
                format!(
                    "{} ({}, step {})",
                    in_words(object, scene),
                    quantity.name(),
                    path.grown.step
                )
            })
            .collect();
        let named = then.len().min(3);
        let more = match then.len() - named {
            0 => String::new(),
            n_more => format!(" and {n_more} more"),
        };
        let then = match named {
            0 => "nothing else".to_owned(),
            _ => format!("then {}{more}", then[..named].join(", ")),
        };
        let _ = write!(
            text,
            "\n{then}; paths of the last {n} steps: {OFFENDERS}, lines with values for ParaView"
        );
        Some(text)
    }
}

impl Quantity {
    fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Density => "density",
            Self::Overlap => "overlap",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Speed => "m/s",
            Self::Density => "kg/m3",
            Self::Overlap => "m",
        }
    }

    fn of(self, sample: &Sample) -> f64 {
        match self {
            Self::Speed => sample.speed,
            Self::Density => sample.density,
            Self::Overlap => sample.overlap,
        }
    }
}

fn before_the_end(n_steps: u64) -> String {
    match n_steps {
        0 => "the last".to_owned(),
        1 => "the last but one".to_owned(),
        n => format!("{n} before the last"),
    }
}

/// A value with the digits that show how it grows.
fn digits(value: f64) -> String {
    match value.abs() {
        size if (0.01..1e6).contains(&size) || size == 0.0 => format!("{value:.4}"),
        _ => format!("{value:.3e}"),
    }
}

fn in_words(object: Object, scene: &Scene) -> String {
    match object {
        Object::Particle(id) => format!("particle {id}"),
        Object::Block(b) => format!("block `{}`", name(b, scene)),
    }
}

fn name(block: usize, scene: &Scene) -> &str {
    scene.block_names.get(block).map_or("", String::as_str)
}

/// Largest value of the quantity among all objects of the kind when the recording began, or what counts as little.
fn largest_before(object: Object, quantity: Quantity, scales: Scales) -> String {
    match (object, quantity) {
        (Object::Particle(_), Quantity::Speed) => {
            format!("before, no particle had more than {:.4} m/s", scales.speed)
        }
        (_, Quantity::Density) => format!(
            "before, no particle was more than {:.1} % off the reference",
            100.0 * scales.density
        ),
        (Object::Block(_), Quantity::Speed) => {
            format!(
                "before, no block had more than {:.4} m/s",
                scales.block_speed
            )
        }
        (_, Quantity::Overlap) => format!(
            "before, no block overlapped by more than {:.2} % of its size",
            100.0 * scales.overlap
        ),
    }
}

/// Deepest contact of a block with its partner; overlap in m.
fn deepest(world: &World, block: usize) -> Option<(f64, usize)> {
    let contacts = world.blocks.contacts();
    let own = contacts.iter().filter_map(|contact| {
        let (a, b) = (contact.blocks.0.index(), contact.blocks.1.index());
        let partner = match block {
            _ if a == block => b,
            _ if b == block => a,
            _ => return None,
        };
        Some((contact.overlap, partner))
    });
    own.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// The block that a particle is beside, or that a block touches deepest.
fn beside(object: Object, sample: &Sample, world: &World, scene: &Scene) -> String {
    match object {
        Object::Block(b) => deepest(world, b).map_or(String::new(), |(_, partner)| {
            format!(", against block `{}`", name(partner, scene))
        }),
        Object::Particle(_) => {
            let blocks = &world.blocks;
            let spacing = scene
                .fluid
                .as_ref()
                .map_or(0.0, |f| f.walls.particle_spacing);
            let distances = (0..blocks.n_parts()).filter_map(|part| {
                let found = blocks.surface_point_within(part, &sample.position, NEAR * spacing)?;
                Some((found.distance, blocks.block_of_part(part)))
            });
            let closest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
            closest.map_or(String::new(), |(distance, block)| {
                format!(
                    ", {:.2} spacings from block `{}`",
                    distance / spacing,
                    name(block, scene)
                )
            })
        }
    }
}
