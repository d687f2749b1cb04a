//! Water in joints that are too narrow for particles: the uplift under a block that rests on its bed.
//!
//! Between a face of a moving block and another solid within a spacing there is no room for particles, and their pressure
//! reaches no farther in than the support of the kernel. The joint holds water all the same. Faces are sampled
//! with points a spacing apart; in a closed joint the pressure between points that water or air reaches is
//! that of steady seepage through a joint of uniform width, as under a dam without drains:
//!
//! ```text
//! p = p_water          at points within the kernel of the water, extrapolated along gravity
//! p = 0                at open points outside of it, and at an edge next to air
//! ∇²(p − ρ g·x) = 0    in the joint between them, no flow through its closed ends
//! F = −Σ s p A n       on the block, the opposite on its support                         [N]
//! s = max(min(1, 2 − gap/dp), 1 − S/0.1) · min(1, (S₁ − S)/(S₁ − S₀)),   S = Σ V W at the point, each ≥ 0
//! ```
//! `s` fades it out as the joint opens and particles enter. A hollow under a block that particles cannot enter, since joints close it
//! on all sides, is a joint up to a depth of four spacings, with `4 − gap/dp` in place of the first factor. The field is kept from step to step and relaxed by a few sweeps
//! in each, so that a change of level spreads through a long joint over many steps. The water of a joint has no volume. It
//! continues around the edges of blocks, into adjacent joints and through pores between blocks that are too narrow for
//! particles: points of two faces that are close to each other are neighbors, too.
//! Joints near water are full at the start. A dry one that water reaches later fills from point to point, no faster than
//! the head at its face drives water in, `u = √(2 max p/ρ)`; ahead of the front there is air. A joint of two blocks with
//! points is sampled from both sides, and each counts half. Its work on the free blocks is a term of the energy ledger.
//! Joints surrounded by air carry no pressure. Those of `sealed` blocks have the same field, but the pressure acts only where block
//! and bed have parted, from a twentieth of a spacing on, in full from a tenth: a bed of triangles is 0.03 spacings off its terrain.
//! Real water comes into a gap that opens under water from its sides, which a flow in a plane does not have.

use rayon::prelude::*;
use riprap_dda::{BlockDefinition, Blocks, Load};
use riprap_sph::boundary::sampling::{FaceSample, sample_face};
use riprap_sph::fluid::ContinuedPressure;
use riprap_sph::{Fluid, Vec3};

use crate::saved::{Read, Saved};
use crate::walls::{Part, clipped_by_symmetry, face_lattice, parts};

mod hollows;
mod links;
mod reached;
mod surroundings;

use hollows::Hollows;
use links::Links;
use reached::Reached;
use surroundings::{Ahead, Surroundings, is_near};

/// Largest width of a joint, in spacings; full pressure up to one, and up to the whole where there is no particle.
const REACH: f64 = 2.0;
/// Widths, in spacings, between which a sealed joint opens.
const OPENING: (f64, f64) = (0.05, 0.1);
/// Fractions `Σ V W` of the support that is water: below the first the joint carries the pressure, above the second the
/// walls do; at a face of a submerged block it is a half.
const SHARES: (f64, f64) = (0.25, 0.4);
/// Fraction above which a point in a joint has the pressure of the water near it.
const REACHED: f64 = 0.1;
/// Fraction below which an open point has air ahead of it.
const DRY: f64 = 0.05;
/// Relaxation sweeps at the start and in each step.
const SWEEPS: (usize, usize) = (2000, 8);
/// Weighted sum of the vectors from its neighbors, in spacings, above which a point is at an edge; a missing row gives 1.
const LACKING: f64 = 0.5;
/// Points per parallel task.
const CHUNK: usize = 32;
/// Largest scalar product of the normals of the two sides of a joint.
const OPPOSED: f64 = -0.5;

/// Sampling point of a face.
#[derive(Clone, Copy, Debug)]
struct Point {
    block: u32,
    /// First point of its face.
    face: u32,
    /// Position relative to the centroid, in the initial axes; m.
    local: Vec3,
    /// Outward normal, in the initial axes.
    normal: Vec3,
    /// Area of its cell; m².
    area: f64,
    /// Direction across the edge of the face that the point is at, in the initial axes; `None` within the face.
    across: Option<Vec3>,
}

/// Range of the points of a face.
#[derive(Clone, Debug)]
struct FacePoints {
    first: usize,
    last: usize,
}

/// Face with solids near it.
#[derive(Clone, Debug)]
struct NearFace {
    block: u32,
    /// Its first active point, and one past its last.
    points: [u32; 2],
    /// Its first part of another block, and one past its last.
    parts: [u32; 2],
}

/// Block with joints that are open to water.
#[derive(Clone, Debug)]
struct Jointed {
    block: usize,
    faces: Vec<FacePoints>,
}

/// Joints of all free blocks, and of those with prescribed motion whose forces are recorded: water in a joint does not move these.
#[derive(Clone, Debug)]
pub struct JointWater {
    spacing: f64,
    blocks: Vec<Jointed>,
    /// Whether a block is one of them; one per block.
    is_jointed: Vec<bool>,
    /// Whether its joints are closed to water until they open; one per block.
    is_sealed: Vec<bool>,
    /// Those of free blocks first.
    points: Vec<Point>,
    /// Number of points of free blocks.
    n_of_free: usize,
    /// Neighbors of each point in its face, with the squares of the spacing over their distances.
    neighbors: Vec<Vec<(u32, f64)>>,
    /// Last position of each point; m.
    places: Vec<Vec3>,
    /// Pressure at each point; Pa.
    pressure: Vec<f64>,
    /// Water-filled fraction of each cell, 0 to 1.
    full: Vec<f64>,
    /// Time of the last update; s.
    found_at: Option<f64>,
    loads: Vec<Load>,
    scratch: Scratch,
}

#[derive(Clone, Debug, Default)]
struct Scratch {
    reached: Reached,
    /// Parts near a block, and near each of some faces.
    near: Vec<u32>,
    near_faces: Vec<NearFace>,
    near_parts: Vec<u32>,
    /// Points of faces with a joint, the face of each, their positions, normals and the space ahead.
    active: Vec<u32>,
    faces: Vec<u32>,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    ahead: Vec<Ahead>,
    water: ContinuedPressure,
    /// Points at an edge outside of the kernel of the water, the open places beside them and the water there.
    edges: Vec<usize>,
    beside: Vec<Vec3>,
    water_beside: ContinuedPressure,
    /// Points with a pressure that follows from their neighbors, in order.
    inner: Vec<u32>,
    hollows: Hollows,
    links: Links,
    next: Vec<f64>,
}

impl NearFace {
    /// Surroundings of its points, from the parts near each face and the domain (m); spacing in m.
    fn surroundings<'a>(
        &self,
        (blocks, near_parts, domain): (&'a Blocks, &'a [u32], (Vec3, Vec3)),
        is_sealed: bool,
        spacing: f64,
    ) -> Surroundings<'a> {
        let [first, last] = self.parts.map(|part| part as usize);
        Surroundings {
            blocks,
            block: self.block as usize,
            near: &near_parts[first..last],
            domain,
            is_sealed,
            spacing,
        }
    }
}

impl JointWater {
    /// Joints of the blocks in their initial positions; those of prescribed ones where their forces are recorded.
    pub fn new(
        definitions: &[BlockDefinition],
        blocks: &Blocks,
        fluid: &Fluid,
        (is_sealed, is_recorded): (impl Fn(usize) -> bool, impl Fn(usize) -> bool),
    ) -> Self {
        let settings = fluid.settings();
        let (spacing, middle) = face_lattice(fluid);
        let planes: Vec<_> = settings.symmetry_planes().collect();
        let mut joints = Self {
            spacing,
            blocks: Vec::new(),
            is_jointed: vec![false; blocks.n_blocks()],
            is_sealed: vec![false; blocks.n_blocks()],
            points: Vec::new(),
            n_of_free: 0,
            neighbors: Vec::new(),
            places: Vec::new(),
            pressure: Vec::new(),
            full: Vec::new(),
            found_at: None,
            loads: vec![Load::default(); blocks.n_blocks()],
            scratch: Scratch::default(),
        };
        let free = (0..definitions.len()).filter(|&b| blocks.is_free(b));
        let is_prescribed = |b: &usize| !blocks.is_fixed(*b) && !blocks.is_free(*b);
        let prescribed = (0..definitions.len()).filter(|b| is_prescribed(b) && is_recorded(*b));
        for b in free.chain(prescribed) {
            let parts: Vec<Part> = parts(&definitions[b].shape)
                .iter()
                .filter_map(|part| clipped_by_symmetry(part, &planes))
                .collect();
            let mut faces = Vec::new();
            for (k, part) in parts.iter().enumerate() {
                for face in part.faces() {
                    let samples = sample_face(&face, spacing);
                    // nothing gets between the parts of one block
                    let is_outer = |s: &&FaceSample| {
                        let ahead = s.position + face.normal * (0.1 * spacing);
                        let mut others = parts.iter().enumerate().filter(|(other, _)| *other != k);
                        !others.any(|(_, part)| {
                            let nearest = part.nearest_plane(&ahead);
                            nearest.is_some_and(|(_, distance)| distance < 0.0)
                        })
                    };
                    let samples: Vec<FaceSample> =
                        samples.iter().filter(is_outer).copied().collect();
                    faces.push(joints.add_face(
                        &samples,
                        &face.normal,
                        middle,
                        b,
                        blocks.centroid(b),
                    ));
                }
            }
            joints.is_jointed[b] = true;
            joints.is_sealed[b] = is_sealed(b);
            // a sphere has no face that another could cover
            if !faces.is_empty() {
                joints.blocks.push(Jointed { block: b, faces });
            }
            if blocks.is_free(b) {
                joints.n_of_free = joints.points.len();
            }
        }
        joints.pressure = vec![0.0; joints.points.len()];
        joints.places = vec![Vec3::zeros(); joints.points.len()];
        joints.scratch.next = joints.pressure.clone();
        joints.full = joints.pressure.clone();
        joints
    }

    fn add_face(
        &mut self,
        samples: &[FaceSample],
        normal: &Vec3,
        middle: Option<f64>,
        block: usize,
        centroid: Vec3,
    ) -> FacePoints {
        let first = self.points.len();
        for sample in samples {
            // cells meet along an edge; diagonal ones do not
            let reach = 1.3
                * sample
                    .size
                    .norm_squared()
                    .max(sample.size.x * sample.size.y);
            let near: Vec<(u32, f64)> = samples
                .iter()
                .enumerate()
                .map(|(k, other)| (k, (other.position - sample.position).norm_squared()))
                .filter(|&(_, d2)| 0.0 < d2 && d2 < reach)
                .map(|(k, d2)| ((first + k) as u32, self.spacing.powi(2) / d2))
                .collect();
            // within the face there are neighbors on all sides
            let mut lacking: Vec3 = near
                .iter()
                .map(|&(other, weight)| {
                    (sample.position - samples[other as usize - first].position) * weight
                })
                .sum();
            if middle.is_some() {
                lacking.y = 0.0;
            }
            let across = (LACKING * self.spacing < lacking.norm()).then(|| lacking.normalize());
            self.neighbors.push(near);
            let mut position = sample.position;
            // a plane flow has particles in the middle of the slice only
            position.y = middle.unwrap_or(position.y);
            self.points.push(Point {
                block: block as u32,
                face: first as u32,
                local: position - centroid,
                normal: *normal,
                area: sample.area,
                across,
            });
        }
        FacePoints {
            first,
            last: self.points.len(),
        }
    }

    /// Appends its state to a byte buffer.
    pub(crate) fn save(&self, out: Vec<u8>) -> Saved {
        let field = (&self.places, &self.pressure, &self.full);
        postcard::to_extend(&(field, self.found_at, &self.loads), out)
    }

    /// Restores a saved state.
    pub(crate) fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        let (field, rest);
        let n_blocks = self.loads.len();
        ((field, self.found_at, self.loads), rest) = postcard::take_from_bytes(bytes)?;
        (self.places, self.pressure, self.full) = field;
        let n = self.places.len();
        let is_whole = [n, n] == [self.pressure.len(), self.full.len()] && self.n_of_free <= n;
        if !is_whole || self.loads.len() != n_blocks {
            return Err(postcard::Error::DeserializeBadEncoding);
        }
        if n != self.points.len() {
            // a run taken further may record other blocks with prescribed motion
            let (kept, all) = (self.n_of_free, self.points.len());
            self.places.truncate(kept);
            self.places.resize(all, Vec3::zeros());
            for column in [&mut self.pressure, &mut self.full] {
                column.truncate(kept);
                column.resize(all, 0.0);
            }
        }
        Ok(rest)
    }

    /// Force and moment of joint water on every block; N, N m about the centroid.
    pub fn loads(&self) -> &[Load] {
        &self.loads
    }

    /// Force on the free blocks; N.
    pub fn force_on_free_blocks(&self, blocks: &Blocks) -> Vec3 {
        self.on_free(blocks).map(|(_, load)| load.force).sum()
    }

    /// Power on the free blocks; W.
    pub fn power_on_free_blocks(&self, blocks: &Blocks) -> f64 {
        let power = |(b, load): (usize, &Load)| {
            load.force.dot(&blocks.velocity(b)) + load.torque.dot(&blocks.angular_velocity(b))
        };
        self.on_free(blocks).map(power).sum()
    }

    fn on_free<'a>(&'a self, blocks: &'a Blocks) -> impl Iterator<Item = (usize, &'a Load)> {
        let loads = self.loads.iter().enumerate();
        loads.filter(|(b, _)| blocks.is_free(*b))
    }

    /// Pressures and loads at the present state and time (s); after the fluid's pressures.
    pub fn update(&mut self, fluid: &Fluid, blocks: &Blocks, time: f64) {
        let last = self.found_at.replace(time);
        self.loads.fill(Load::default());
        self.find_joints(fluid, blocks);
        if self.scratch.active.is_empty() {
            return;
        }
        let weight = fluid.settings().gravity * fluid.settings().reference_density;
        self.find_water(fluid);
        self.find_hollows(fluid, blocks);
        self.set_boundary_points();
        self.set_edge_points(fluid, &weight);
        self.link_inner_points();
        match last {
            Some(last) => {
                let density = fluid.settings().reference_density;
                self.advance(time - last, density);
                self.relax(SWEEPS.1, &weight);
            }
            None => {
                for &k in &self.scratch.inner {
                    self.full[k as usize] = 1.0;
                }
                self.relax(SWEEPS.0, &weight);
            }
        }
        self.sum(blocks);
    }

    /// Finds the water at every active point.
    fn find_water(&mut self, fluid: &Fluid) {
        let scratch = &mut self.scratch;
        scratch.water.find(fluid, &scratch.positions);
        for (ahead, water) in scratch.ahead.iter_mut().zip(scratch.water.found()) {
            ahead.water = water;
        }
    }

    /// Sets the pressure of points that the water's kernel reaches, or air; the others are inner points, or at an edge.
    fn set_boundary_points(&mut self) {
        let scratch = &mut self.scratch;
        scratch.inner.clear();
        scratch.edges.clear();
        scratch.beside.clear();
        for (n, (&k, ahead)) in scratch.active.iter().zip(&scratch.ahead).enumerate() {
            let [share, pressure] = ahead.water;
            let point = &self.points[k as usize];
            // particles that came into a hollow stand free in it and would empty it, unless they fill it
            let is_shut = self.is_sealed[point.block as usize] || ahead.is_hollow;
            let reached = match is_shut {
                true => SHARES.1,
                false => REACHED,
            };
            match ahead.joint {
                Some(_) if share < reached => match ahead.beside {
                    None => scratch.inner.push(k),
                    Some(place) => {
                        scratch.edges.push(n);
                        scratch.beside.push(place);
                    }
                },
                None if share < DRY && ahead.is_pore => scratch.inner.push(k),
                None if share < DRY => {
                    (self.pressure[k as usize], self.full[k as usize]) = (0.0, 0.0);
                }
                _ => {
                    (self.pressure[k as usize], self.full[k as usize]) = (pressure.max(0.0), 1.0);
                }
            }
        }
    }

    /// Sets the pressure of points at an edge from the water or air beside the block; those at a pore are inner points.
    fn set_edge_points(&mut self, fluid: &Fluid, weight: &Vec3) {
        let scratch = &mut self.scratch;
        scratch.water_beside.find(fluid, &scratch.beside);
        let edges = scratch.edges.iter().zip(&scratch.beside);
        for ((&n, place), [share, pressure]) in edges.zip(scratch.water_beside.found()) {
            let below = weight.dot(&(scratch.positions[n] - place));
            let k = scratch.active[n] as usize;
            if share < DRY && scratch.ahead[n].is_pore {
                scratch.inner.push(k as u32);
                continue;
            }
            (self.pressure[k], self.full[k]) = if share < DRY {
                (0.0, 0.0)
            } else {
                ((pressure + below).max(0.0), 1.0)
            };
        }
        scratch.inner.sort_unstable();
    }

    /// Neighbors of inner points in other faces.
    fn link_inner_points(&mut self) {
        let points = &self.points;
        let are_linked = |k: u32, other: u32| {
            let (a, b) = (&points[k as usize], &points[other as usize]);
            // around an edge, or across a joint; not through a block
            a.face != b.face && (a.block != b.block || OPPOSED < a.normal.dot(&b.normal))
        };
        let scratch = &mut self.scratch;
        scratch.links.find(
            &scratch.inner,
            &scratch.active,
            &self.places,
            self.spacing,
            are_linked,
        );
    }

    /// Faces with a joint, and the space ahead of each of their points.
    fn find_joints(&mut self, fluid: &Fluid, blocks: &Blocks) {
        self.find_near_faces(fluid, blocks);
        let Scratch {
            near_faces,
            near_parts,
            active,
            faces,
            positions,
            normals,
            ahead,
            ..
        } = &mut self.scratch;
        let (points, spacing, is_sealed) = (&self.points, self.spacing, &self.is_sealed);
        let (near_faces, near_parts) = (&*near_faces, &*near_parts);
        ahead.resize(active.len(), Ahead::default());
        ahead
            .par_iter_mut()
            .zip(active.par_iter().zip(faces.par_iter()))
            .zip(positions.par_iter().zip(normals.par_iter()))
            .with_min_len(CHUNK)
            .for_each(|((ahead, (&k, &face)), (x, normal))| {
                let face = &near_faces[face as usize];
                let block = face.block as usize;
                let around = (blocks, near_parts.as_slice(), fluid.settings().domain);
                let surroundings = face.surroundings(around, is_sealed[block], spacing);
                let turned = |across| blocks.orientation(block) * across;
                let across = points[k as usize].across.map(turned);
                *ahead = surroundings.ahead(x, normal, across);
            });
        self.keep_faces_with_joints();
    }

    /// Faces with other solids near them, and where all of their points are.
    fn find_near_faces(&mut self, fluid: &Fluid, blocks: &Blocks) {
        let Scratch {
            reached,
            near,
            near_faces,
            near_parts,
            active,
            faces,
            positions,
            normals,
            ..
        } = &mut self.scratch;
        near_faces.clear();
        near_parts.clear();
        active.clear();
        faces.clear();
        positions.clear();
        normals.clear();
        let reach = REACH * self.spacing;
        let farthest = hollows::REACH * self.spacing;
        reached.find(&self.blocks, reach, fluid, blocks);
        for (jointed, reached) in self.blocks.iter().zip(&reached.blocks) {
            let b = jointed.block;
            if blocks.is_removed(b) {
                continue;
            }
            if !reached.is_reached {
                for face in &jointed.faces {
                    self.full[face.first..face.last].fill(0.0);
                }
                continue;
            }
            let is_within = |part: usize, bounds: &(Vec3, Vec3), reach: f64| {
                is_near(&blocks.part_aabb(part), bounds, reach, self.spacing)
            };
            near.clear();
            let others = (0..blocks.n_parts()).filter(|&part| {
                blocks.block_of_part(part) != b && is_within(part, &reached.bounds, farthest)
            });
            near.extend(others.map(|part| part as u32));
            if near.is_empty() {
                continue;
            }
            let (centroid, gradient) = (blocks.centroid(b), blocks.gradient(b));
            let turn = blocks.orientation(b);
            for face in &jointed.faces {
                let (first_point, first_part) = (active.len(), near_parts.len());
                let nowhere = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
                let mut bounds = nowhere;
                for k in face.first..face.last {
                    let point = &self.points[k];
                    let x = centroid + gradient * point.local;
                    bounds = (bounds.0.inf(&x), bounds.1.sup(&x));
                    active.push(k as u32);
                    faces.push(near_faces.len() as u32);
                    positions.push(x);
                    normals.push(turn * point.normal);
                    self.places[k] = x;
                }
                let is_within_face = |part: u32, reach| is_within(part as usize, &bounds, reach);
                if near.iter().any(|&part| is_within_face(part, reach)) {
                    let others = near.iter().copied();
                    near_parts.extend(others.filter(|&part| is_within_face(part, farthest)));
                }
                near_faces.push(NearFace {
                    block: b as u32,
                    points: [first_point, active.len()].map(|k| k as u32),
                    parts: [first_part, near_parts.len()].map(|k| k as u32),
                });
            }
        }
    }

    /// Drops the active points of all other faces.
    fn keep_faces_with_joints(&mut self) {
        let Scratch {
            near_faces,
            active,
            faces,
            positions,
            normals,
            ahead,
            ..
        } = &mut self.scratch;
        let mut n = 0;
        for face in near_faces {
            let points = face.points[0] as usize..face.points[1] as usize;
            if !ahead[points.clone()]
                .iter()
                .any(|ahead| ahead.joint.is_some())
            {
                continue;
            }
            active.copy_within(points.clone(), n);
            faces.copy_within(points.clone(), n);
            positions.copy_within(points.clone(), n);
            normals.copy_within(points.clone(), n);
            ahead.copy_within(points.clone(), n);
            n += points.len();
        }
        active.truncate(n);
        faces.truncate(n);
        positions.truncate(n);
        normals.truncate(n);
        ahead.truncate(n);
    }

    /// Advances the fronts of water in dry joints by a time (s); density in kg/m³.
    fn advance(&mut self, elapsed: f64, density: f64) {
        let Scratch {
            inner, next, links, ..
        } = &mut self.scratch;
        for face in self.blocks.iter().flat_map(|jointed| &jointed.faces) {
            let [from, to] =
                [face.first, face.last].map(|end| inner.partition_point(|&k| (k as usize) < end));
            let inner = &inner[from..to];
            if inner.iter().all(|&k| 1.0 <= self.full[k as usize]) {
                continue;
            }
            let pressures = self.pressure[face.first..face.last].iter();
            let head = pressures.copied().fold(0.0, f64::max);
            let is_full = |other: u32| 1.0 <= self.full[other as usize];
            for (n, &k) in (from..).zip(inner) {
                let k = k as usize;
                next[k] = self.full[k];
                let beside = links.of(n).iter().filter(|(other, _)| is_full(*other));
                let beside = beside.map(|&(other, _)| self.pressure[other as usize]);
                let head = beside
                    .reduce(f64::max)
                    .map_or(head, |other| other.max(head));
                let has_come = |&(other, _): &(u32, f64)| is_full(other);
                if self.neighbors[k].iter().any(has_come) || links.of(n).iter().any(has_come) {
                    let rise = (2.0 * head / density).sqrt() * elapsed / self.spacing;
                    next[k] = (self.full[k] + rise).min(1.0);
                }
            }
            for &k in inner {
                self.full[k as usize] = next[k as usize];
            }
        }
    }

    /// Relaxes the pressure toward steady seepage where the joints are full; unit weight of water in N/m³.
    fn relax(&mut self, sweeps: usize, weight: &Vec3) {
        let Scratch {
            inner, next, links, ..
        } = &mut self.scratch;
        for &k in inner.iter() {
            if self.full[k as usize] < 1.0 {
                self.pressure[k as usize] = 0.0;
            }
        }
        for _ in 0..sweeps {
            for (n, &k) in inner.iter().enumerate() {
                let k = k as usize;
                let (mut sum, mut total) = (0.0, 0.0);
                for &(other, share) in self.neighbors[k].iter().chain(links.of(n)) {
                    let other = other as usize;
                    total += share;
                    // ahead of a front there is air
                    if 1.0 <= self.full[other] {
                        let below = weight.dot(&(self.places[k] - self.places[other]));
                        sum += share * (self.pressure[other] + below);
                    }
                }
                next[k] = if self.full[k] < 1.0 || total == 0.0 {
                    0.0
                } else {
                    (sum / total).max(0.0)
                };
            }
            for &k in inner.iter() {
                self.pressure[k as usize] = next[k as usize];
            }
        }
    }

    fn sum(&mut self, blocks: &Blocks) {
        let Scratch {
            active,
            positions,
            normals,
            ahead,
            ..
        } = &self.scratch;
        for (((&k, x), normal), ahead) in active.iter().zip(positions).zip(normals).zip(ahead) {
            let Some((gap, partner)) = ahead.joint else {
                continue;
            };
            let width = gap / self.spacing;
            let by_water = ((SHARES.1 - ahead.water[0]) / (SHARES.1 - SHARES.0)).clamp(0.0, 1.0);
            let point = &self.points[k as usize];
            let (block, partner) = (point.block as usize, partner as usize);
            let is_sealed = self.is_sealed[block] || self.is_sealed[partner];
            let dry = 1.0 - ahead.water[0] / REACHED;
            let by_width = match is_sealed || ahead.is_hollow {
                true => (hollows::REACH - width).clamp(0.0, 1.0),
                false => dry.max(REACH - width).clamp(0.0, 1.0),
            };
            let by_seal = match is_sealed {
                true => ((width - OPENING.0) / (OPENING.1 - OPENING.0)).clamp(0.0, 1.0),
                false => 1.0,
            };
            // points of the partner, if any, sample this joint, too
            let sides = if self.is_jointed[partner] && !blocks.is_removed(partner) {
                2.0
            } else {
                1.0
            };
            let share = by_width * by_water * by_seal / sides;
            let force = normal * (-self.pressure[k as usize] * point.area * share);
            self.loads[block].add(&force, &(x - blocks.centroid(block)));
            self.loads[partner].add(&-force, &(x - blocks.centroid(partner)));
        }
    }
}
