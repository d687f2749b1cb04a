//! Sampling of the solids: the wall points of fixed and of moving blocks, those of thin solids behind their sides.

use riprap_dda::{BlockDefinition, Blocks};
use riprap_sph::Fluid;
use riprap_sph::Vec3;
use riprap_sph::boundary::sampling::WallSample;
use riprap_sph::boundary::thin_solids::Facet;
use riprap_sph::boundary::wall_particles::{Slip, WallParticles};

use crate::walls::cutting::clipped_by_symmetry;
use crate::walls::sampler::{Sampler, Thin};
use crate::walls::thin_solids::ThinSolids;
use crate::walls::{Part, parts};

/// The blocks of a scene, and their sampler.
pub(super) struct Solids<'a> {
    pub(super) definitions: &'a [BlockDefinition],
    pub(super) blocks: &'a Blocks,
    pub(super) sampler: &'a Sampler,
}

/// Convex parts of fixed blocks, cut where they stand in each other.
pub(super) struct Standing {
    /// Block of each part.
    owners: Vec<usize>,
    parts: Vec<Part>,
    /// The same inside the domain.
    pub(super) inside: Vec<Part>,
}

impl Solids<'_> {
    /// The convex parts of fixed blocks.
    pub(super) fn standing(&self) -> Standing {
        let (owners, parts): (Vec<usize>, Vec<Part>) = self
            .numbers(|b| self.blocks.is_fixed(b))
            .flat_map(|b| self.parts_of(b).map(move |part| (b, part)))
            .unzip();
        let (owners, parts) = self.sampler.cut_where_they_stand(owners, parts);
        let inside = self.inside(&parts);
        Standing {
            owners,
            parts,
            inside,
        }
    }

    /// Points of fixed blocks; points common to two solids belong to the polyhedron.
    pub(super) fn fixed_points(&self, standing: &Standing, thin_solids: &mut ThinSolids) -> Points {
        let Standing {
            owners,
            parts,
            inside,
        } = standing;
        let mut points = Points::default();
        let (thin, thick) = self.sampler.thin_solids(inside, parts);
        for thin in thin {
            let block = owners[thin.part];
            points.add_thin_solid(thin, inside, block, (thin_solids, self.blocks));
        }
        let whole: Vec<Part> = thick.iter().map(|&part| parts[part].clone()).collect();
        for (part, sample) in self.sampler.standing(&whole) {
            points.add(owners[thick[part]], sample, Facet::NONE);
        }
        let is_taken = |x: &Vec3| parts.iter().any(|part| part.may_be_within(x, 0.0));
        for b in self.numbers(|b| self.blocks.is_fixed(b)) {
            let shape = &self.definitions[b].shape;
            for (b, sample) in self.sampler.sphere(b, shape) {
                if !is_taken(&sample.position) {
                    points.add(b, sample, Facet::NONE);
                }
            }
            for sample in self.sampler.surface(shape, is_taken) {
                points.add(b, sample, Facet::NONE);
            }
        }
        points
    }

    /// Points of blocks that may move.
    pub(super) fn moving_points(&self, thin_solids: &mut ThinSolids) -> Points {
        let mut points = Points::default();
        for b in self.numbers(|b| !self.blocks.is_fixed(b)) {
            let parts: Vec<Part> = self.parts_of(b).collect();
            let inside = self.inside(&parts);
            let (thin, thick) = self.sampler.thin_solids(&inside, &parts);
            for thin in thin {
                points.add_thin_solid(thin, &inside, b, (thin_solids, self.blocks));
            }
            let thick: Vec<Part> = thick.iter().map(|&part| parts[part].clone()).collect();
            for sample in self.sampler.body(&thick) {
                points.add(b, sample, Facet::NONE);
            }
            for (b, sample) in self.sampler.sphere(b, &self.definitions[b].shape) {
                points.add(b, sample, Facet::NONE);
            }
        }
        points
    }

    /// Numbers of the blocks of a kind.
    fn numbers(&self, is_chosen: impl Fn(usize) -> bool) -> impl Iterator<Item = usize> {
        (0..self.definitions.len()).filter(move |&b| is_chosen(b))
    }

    /// Convex parts of a block in front of the planes of symmetry, as far as they reach the domain.
    fn parts_of(&self, block: usize) -> impl Iterator<Item = Part> {
        let sampler = self.sampler;
        parts(&self.definitions[block].shape)
            .into_iter()
            .filter_map(|part| clipped_by_symmetry(&part, &sampler.symmetry))
            .filter(|part| sampler.endless.reaches_domain(part))
    }

    fn inside(&self, parts: &[Part]) -> Vec<Part> {
        let inside = |part| self.sampler.endless.inside(part);
        parts.iter().map(inside).collect()
    }
}

/// Wall points before their placement.
#[derive(Default)]
pub(super) struct Points {
    pub(super) blocks: Vec<u32>,
    pub(super) samples: Vec<WallSample>,
    pub(super) facets: Vec<Facet>,
}

impl Points {
    fn add(&mut self, block: usize, sample: WallSample, facet: Facet) {
        self.blocks.push(block as u32);
        self.samples.push(sample);
        self.facets.push(facet);
    }

    /// Adds a part of a block to the thin solids, and the points behind each of its sides.
    fn add_thin_solid(
        &mut self,
        thin: Thin,
        parts: &[Part],
        block: usize,
        (thin_solids, blocks): (&mut ThinSolids, &Blocks),
    ) {
        let sides = (thin.ends, thin.side_of);
        let solid = thin_solids.add((thin.part, parts), sides, block, blocks);
        for (side, samples) in thin.behind.iter().enumerate() {
            let facet = Facet {
                solid,
                side: side as u32,
            };
            for &sample in samples {
                self.add(block, sample, facet);
            }
        }
    }

    pub(super) fn walls(&self, fluid: &Fluid, slip: Slip) -> WallParticles {
        let volumes = self.samples.iter().map(|s| s.volume).collect();
        let walls = WallParticles::new(fluid, volumes, slip);
        if self.facets.iter().all(|&facet| facet == Facet::NONE) {
            walls
        } else {
            walls.behind(self.facets.clone())
        }
    }
}
