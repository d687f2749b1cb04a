//! Sampling of wall particles: moving bodies individually, fixed ones as a single solid, thin solids side by side.

use riprap_dda::Shape;
use riprap_sph::boundary::integral::Face;
use riprap_sph::boundary::sampling::{
    Region, Rows, UnionLattice, WallSample, is_behind, sample_behind, sample_behind_side,
    sample_behind_surface, sample_convex, sample_prism, sample_sphere, sample_union,
};
use riprap_sph::{Dimensions, Fluid, SymmetryPlane, Vec3};

use super::Part;
use super::cutting::{image, pieces};
use super::endless::Endless;
use super::thin_solids::{Thinness, is_covered, is_side_of_plate, sides, thinness};

impl Part {
    /// Whether every face is across an axis of the scene.
    fn is_upright_box(&self) -> bool {
        self.faces.len() == 6
            && self
                .faces
                .iter()
                .all(|(normal, _)| normal.iter().any(|n| n.abs() > 1.0 - 1e-9))
    }
}

/// A part that is a thin solid.
pub(super) struct Thin {
    pub(super) part: usize,
    /// Faces at which it only seems to end.
    pub(super) ends: Vec<bool>,
    /// Side of each face.
    pub(super) side_of: Vec<u32>,
    /// Points behind each side.
    pub(super) behind: Vec<Vec<WallSample>>,
}

/// Largest radius of a stone about its middle, over the support radius.
const STONE: f64 = 1.5;

/// Largest distance of the corners of some parts from their middle; m.
fn reach_of(parts: &[Part]) -> f64 {
    let corners = || parts.iter().flat_map(Part::corners);
    let middle = corners().sum::<Vec3>() / corners().count().max(1) as f64;
    let distances = corners().map(|x| (x - middle).norm());
    distances.fold(0.0, f64::max)
}

/// Faces of a part that may be a thin solid.
struct Faces {
    /// At which it only seems to end.
    ends: Vec<bool>,
    /// On which fluid may be.
    open: Vec<bool>,
    thinness: Thinness,
}

/// Sampler of wall particles.
pub(super) struct Sampler {
    pub(super) lattice: UnionLattice,
    pub(super) endless: Endless,
    /// In a 2-D flow: position of the plane, and width of the slice; m.
    plane: Option<(f64, f64)>,
    pub(super) symmetry: Vec<SymmetryPlane>,
}

impl Sampler {
    pub(super) fn new(fluid: &Fluid) -> Self {
        let settings = fluid.settings();
        let support_radius = settings.support_radius();
        let (min, max) = settings.domain;
        let mut lattice = UnionLattice {
            anchor: min,
            particle_spacing: settings.mean_spacing(),
            support_radius,
            region: Region { min, max },
        };
        let mut plane = None;
        match settings.dimensions {
            Dimensions::Two { width } => {
                let middle = 0.5 * (min.y + max.y);
                let half = 0.5 * lattice.particle_spacing;
                lattice.anchor.y = middle - half;
                (lattice.region.min.y, lattice.region.max.y) = (middle - half, middle + half);
                plane = Some((middle, width));
            }
            Dimensions::Three => {
                let mut repeating = (0..3).filter(|&axis| settings.periodic[axis]);
                if let (Some(axis), None) = (repeating.next(), repeating.next()) {
                    // a whole number of rows in the period
                    lattice.particle_spacing = settings.particle_spacing[axis];
                }
            }
        }
        Self {
            lattice,
            endless: Endless::of(fluid),
            plane,
            symmetry: settings.symmetry_planes().collect(),
        }
    }

    /// Points of a spherical block, in front of planes of symmetry; empty for others.
    pub(super) fn sphere(&self, block: usize, shape: &Shape) -> Vec<(usize, WallSample)> {
        let Shape::Sphere { center, radius } = shape else {
            return Vec::new();
        };
        let (spacing, support) = (self.lattice.particle_spacing, self.lattice.support_radius);
        let is_before = |sample: &WallSample| {
            let mut planes = self.symmetry.iter();
            planes.all(|plane| 0.0 <= plane.distance(&sample.position))
        };
        sample_sphere(*center, *radius, spacing, support)
            .into_iter()
            .filter(is_before)
            .map(|sample| (block, sample))
            .collect()
    }

    /// Points behind a surface of triangles, in front of planes of symmetry; empty for other shapes.
    pub(super) fn surface(
        &self,
        shape: &Shape,
        is_taken: impl Fn(&Vec3) -> bool + Sync,
    ) -> Vec<WallSample> {
        let Shape::Surface(surface) = shape else {
            return Vec::new();
        };
        let height_within = |x: &Vec3, distance: f64| {
            let foot = surface.surface_point_within(x, distance)?;
            Some(foot.distance)
        };
        let is_here = |sample: &WallSample| {
            self.is_no_image(&sample.position) && self.is_before_planes(&sample.position)
        };
        let mut samples = sample_behind_surface(&self.lattice, height_within, is_taken);
        samples.retain(is_here);
        samples
    }

    /// Thin and thick parts among some parts (`inside` is their portion in the domain); thin ones get points behind each of their
    /// sides, except sides covered by other parts. A stone among stones, no larger than the kernel support, is not a thin solid: it
    /// separates no bodies of water, and thousands of touching thin solids would dominate the cost.
    pub(super) fn thin_solids(&self, inside: &[Part], parts: &[Part]) -> (Vec<Thin>, Vec<usize>) {
        if reach_of(inside) < STONE * self.lattice.support_radius {
            return (Vec::new(), (0..parts.len()).collect());
        }
        let (mut thin_solids, mut others) = (Vec::new(), Vec::new());
        for (k, part) in parts.iter().enumerate() {
            match self.solid(k, part, inside) {
                Some(thin) => thin_solids.push(thin),
                None => others.push(k),
            }
        }
        (thin_solids, others)
    }

    /// Each side of a plate has its own layers of points through it. Other sides share the points of the shell, each with its own
    /// pressures: where two sides have the same points nothing changes as a particle passes their edge. Outside, which
    /// a side hides beyond the opposite ones and where the thin solid continues, all have their own layers.
    fn solid(&self, number: usize, whole: &Part, all: &[Part]) -> Option<Thin> {
        let part = &all[number];
        let support = self.lattice.support_radius;
        let Faces {
            ends,
            open,
            thinness,
        } = self.open_faces(number, part, all)?;
        if !thinness.is_thin {
            return None;
        }
        let shell = self.body(std::slice::from_ref(whole));
        let faces = part.faces();
        let sides = sides(part, self.lattice.particle_spacing);
        let behind = |side: &Vec<usize>| {
            if !side.iter().any(|&face| open[face]) {
                return Vec::new();
            }
            let mut samples = self.behind_side(side, part);
            let mut of_side = side.iter();
            if !of_side.any(|&face| is_side_of_plate(part, face, support)) {
                samples.retain(|sample| !part.may_be_within(&sample.position, 0.0));
                let is_near = |sample: &&WallSample| {
                    let mut of_side = side.iter();
                    of_side.any(|&face| is_behind(&faces[face], &sample.position, support))
                };
                samples.extend(shell.iter().filter(is_near));
            }
            samples.retain(|sample| self.is_before_planes(&sample.position));
            samples
        };
        let mut side_of = vec![0; faces.len()];
        for (number, side) in sides.iter().enumerate() {
            for &face in side {
                side_of[face] = number as u32;
            }
        }
        Some(Thin {
            part: number,
            behind: sides.iter().map(behind).collect(),
            side_of,
            ends,
        })
    }

    /// Rows of points along the axis in which a part has no end.
    fn rows(&self, part: &Part) -> Option<Rows> {
        let axis = self.endless.first_of(part)?;
        let Region { min, max } = &self.endless.domain;
        let length = max[axis] - min[axis];
        let count = (length / self.lattice.particle_spacing).round().max(1.0);
        Some(Rows {
            axis,
            from: min[axis],
            width: length / count,
            count: count as usize,
        })
    }

    /// Points behind a side of a part.
    fn behind_side(&self, side: &[usize], part: &Part) -> Vec<WallSample> {
        let (spacing, support) = (self.lattice.particle_spacing, self.lattice.support_radius);
        let of = |part: &Part, rows: Option<Rows>| {
            let faces = part.faces();
            let side: Vec<Face> = side.iter().map(|&k| faces[k]).collect();
            match side.as_slice() {
                [face] => sample_behind(face, rows, spacing, support),
                side => sample_behind_side(side, rows, spacing, support),
            }
        };
        let Some((middle, _)) = self.plane else {
            return of(part, self.rows(part));
        };
        let row = Rows {
            axis: 1,
            from: middle - 0.5 * spacing,
            width: spacing,
            count: 1,
        };
        self.row_in_slice(of(&self.as_one_row(part, middle), Some(row)))
    }

    /// Open faces of a part and its thickness between them; `None` if it cannot be a thin solid.
    fn open_faces(&self, number: usize, part: &Part, all: &[Part]) -> Option<Faces> {
        let (spacing, support) = (self.lattice.particle_spacing, self.lattice.support_radius);
        let ends = self.ends(part)?;
        let others = all.iter().enumerate().filter(|&(k, _)| k != number);
        let others: Vec<&Part> = others.map(|(_, other)| other).collect();
        let is_open = |((normal, corners), is_end): (&(Vec3, Vec<Vec3>), &bool)| {
            !is_end && !is_covered(normal, corners, &others, spacing)
        };
        let open: Vec<bool> = part.faces.iter().zip(&ends).map(is_open).collect();
        let mut thinness = thinness(part, &open, &others, (spacing, support));
        for other in &mut thinness.stands_on {
            // counted among all
            *other += usize::from(number <= *other);
        }
        Some(Faces {
            ends,
            open,
            thinness,
        })
    }

    /// Parts that are thin in one place and rest on others elsewhere, cut along the faces of these: a part that rests on
    /// something is not a thin solid. A slope that extends beyond its floor is sharp only out there.
    pub(super) fn cut_where_they_stand(
        &self,
        owners: Vec<usize>,
        standing: Vec<Part>,
    ) -> (Vec<usize>, Vec<Part>) {
        let inside: Vec<Part> = standing
            .iter()
            .map(|part| self.endless.inside(part))
            .collect();
        let cut = |(number, part): (usize, Part)| {
            let thinness = self
                .open_faces(number, &inside[number], &inside)
                .map(|faces| faces.thinness)
                .unwrap_or_default();
            if !thinness.is_thin {
                return vec![part];
            }
            let faces = thinness.stands_on.iter().flat_map(|&k| &inside[k].faces);
            let planes = faces.filter_map(|(normal, corners)| {
                let is_along = |axis: usize| normal[axis].abs() > 0.5;
                let is_end =
                    (0..3).any(|axis| is_along(axis) && self.endless.has_no_end(&part, axis));
                let offset = normal.dot(corners.first()?);
                (!is_end).then_some((*normal, offset))
            });
            pieces(part.clone(), planes)
        };
        let parts = owners.into_iter().zip(standing.into_iter().enumerate());
        parts
            .flat_map(|(owner, part)| cut(part).into_iter().map(move |piece| (owner, piece)))
            .unzip()
    }

    fn is_before_planes(&self, x: &Vec3) -> bool {
        self.symmetry.iter().all(|plane| 0.0 <= plane.distance(x))
    }

    /// Faces that do not end a fixed part: at sides of the domain beyond which it continues, or at a plane of symmetry.
    pub(super) fn seeming_ends(&self, part: &Part) -> Vec<bool> {
        let slack = 1e-6 * self.lattice.particle_spacing;
        let is_seeming = |(normal, corners): &(Vec3, Vec<Vec3>)| {
            (0..3).any(|axis| normal[axis].abs() > 0.5 && self.endless.has_no_end(part, axis))
                || self.symmetry.iter().any(|plane| {
                    let mut corners = corners.iter();
                    corners.all(|x| plane.distance(x) <= slack)
                })
        };
        part.faces.iter().map(is_seeming).collect()
    }

    /// Faces that do not end a part: it continues beyond a periodic side, across a 2-D flow, or
    /// at a plane of symmetry. `None` for a part that cannot be a thin solid: without ends in two directions, or
    /// near a plane of symmetry and oblique to it, as thin solids are not mirrored.
    fn ends(&self, part: &Part) -> Option<Vec<bool>> {
        let mut endless = (0..3).filter(|&axis| self.endless.has_no_end(part, axis));
        let (first, second) = (endless.next(), endless.next());
        if second.is_some() {
            return None;
        }
        let near = 2.0 * self.lattice.support_radius;
        let slack = 1e-6 * self.lattice.particle_spacing;
        part.faces
            .iter()
            .map(|(normal, corners)| {
                let mut is_end = first.is_some_and(|axis| normal[axis].abs() > 0.5);
                for plane in &self.symmetry {
                    let distances = corners.iter().map(|x| plane.distance(x));
                    let (least, most) = distances
                        .fold((f64::INFINITY, 0.0_f64), |(least, most), d| {
                            (least.min(d), most.max(d))
                        });
                    let is_upright = normal[plane.axis].abs() < 1e-9 && least <= slack;
                    let is_cut = most <= slack;
                    if least < near && !is_upright && !is_cut {
                        return None;
                    }
                    is_end |= is_cut;
                }
                Some(is_end)
            })
            .collect()
    }

    fn is_no_image(&self, x: &Vec3) -> bool {
        let Region { min, max } = &self.endless.domain;
        (0..3).all(|axis| {
            !self.endless.periodic[axis] || (min[axis] <= x[axis] && x[axis] < max[axis])
        })
    }

    /// Points of fixed bodies, which are one solid together with their images in planes of symmetry, in front
    /// of these planes, each with its part.
    pub(super) fn standing(&self, parts: &[Part]) -> Vec<(usize, WallSample)> {
        let mut with_images = parts.to_vec();
        for plane in &self.symmetry {
            let images: Vec<Part> = with_images.iter().map(|part| image(part, plane)).collect();
            with_images.extend(images);
        }
        self.union(&with_images)
            .into_iter()
            .filter(|(_, sample)| {
                self.symmetry
                    .iter()
                    .all(|plane| 0.0 <= plane.distance(&sample.position))
            })
            .map(|(part, sample)| (part % parts.len(), sample))
            .collect()
    }

    /// Points of bodies that are one solid, each with the first part that it is in.
    fn union(&self, parts: &[Part]) -> Vec<(usize, WallSample)> {
        let parts: Vec<Part> = parts
            .iter()
            .map(|part| self.endless.without_ends(part))
            .collect();
        let faces: Vec<Vec<Face>> = parts.iter().map(Part::faces).collect();
        let faces: Vec<&[Face]> = faces.iter().map(Vec::as_slice).collect();
        let samples = sample_union(&faces, &self.lattice);
        let samples = samples.iter().map(|s| (s.part, s.sample));
        self.in_slice(samples.filter(|(_, sample)| self.is_no_image(&sample.position)))
    }

    /// Points of a single body.
    pub(super) fn body(&self, parts: &[Part]) -> Vec<WallSample> {
        let [part] = parts else {
            return self.whole(parts);
        };
        let (spacing, support_radius) =
            (self.lattice.particle_spacing, self.lattice.support_radius);
        if let Some(samples) = self.prism(part) {
            return samples;
        }
        let repeats = self.endless.periodic.contains(&true);
        match self.plane {
            None if repeats && part.is_upright_box() => {
                // a whole number of rows in what is inside
                let Region { min, max } = &self.endless.domain;
                let inside = (0..3).filter(|&axis| self.endless.periodic[axis]);
                let inside = inside.fold(part.clone(), |part, axis| {
                    part.along(axis, |x| x.clamp(min[axis], max[axis]))
                });
                sample_convex(&inside.faces(), spacing, support_radius)
            }
            None if repeats => self.whole(parts),
            None => sample_convex(&part.faces(), spacing, support_radius),
            Some(_) => self.whole(parts),
        }
    }

    /// Points of a prism across a 2-D flow, or across a periodic domain; `None` for other bodies.
    fn prism(&self, part: &Part) -> Option<Vec<WallSample>> {
        let (spacing, support) = (self.lattice.particle_spacing, self.lattice.support_radius);
        let Some((middle, _)) = self.plane else {
            let axis = self.endless.first_of(part)?;
            return sample_prism(&self.endless.inside(part).faces(), axis, spacing, support);
        };
        let slice = self.as_one_row(part, middle);
        let samples = sample_prism(&slice.faces(), 1, spacing, support)?;
        Some(self.row_in_slice(samples))
    }

    /// A prism across a 2-D flow, with the thickness of one row of its lattice.
    fn as_one_row(&self, part: &Part, middle: f64) -> Part {
        let corners = part.corners().map(|x| x.y);
        let center = corners.sum::<f64>() / part.corners().count() as f64;
        let half = 0.5 * self.lattice.particle_spacing;
        part.along(1, |y| middle + if y < center { -half } else { half })
    }

    /// As a union, wherever it stands.
    fn whole(&self, parts: &[Part]) -> Vec<WallSample> {
        let corners = parts.iter().flat_map(Part::corners);
        let mut region = corners.fold(self.lattice.region, |region, x| Region {
            min: region.min.inf(x),
            max: region.max.sup(x),
        });
        let narrow = &self.lattice.region;
        for axis in 0..3 {
            if self.endless.periodic[axis] || (self.plane.is_some() && axis == 1) {
                (region.min[axis], region.max[axis]) = (narrow.min[axis], narrow.max[axis]);
            }
        }
        let everywhere = Self {
            lattice: UnionLattice {
                region,
                ..self.lattice
            },
            endless: self.endless,
            plane: self.plane,
            symmetry: Vec::new(),
        };
        let union = everywhere.union(parts);
        union.into_iter().map(|(_, sample)| sample).collect()
    }

    fn row_in_slice(&self, samples: Vec<WallSample>) -> Vec<WallSample> {
        let row = self.in_slice(samples.into_iter().map(|sample| (0, sample)));
        row.into_iter().map(|(_, sample)| sample).collect()
    }

    /// In a 2-D flow the row in the plane, with the width of the slice; otherwise all points.
    fn in_slice(
        &self,
        samples: impl Iterator<Item = (usize, WallSample)>,
    ) -> Vec<(usize, WallSample)> {
        let Some((middle, width)) = self.plane else {
            return samples.collect();
        };
        let spacing = self.lattice.particle_spacing;
        samples
            .filter(|(_, sample)| (sample.position.y - middle).abs() < 0.4 * spacing)
            .map(|(part, sample)| {
                let position = Vec3::new(sample.position.x, middle, sample.position.z);
                let volume = sample.volume * (width / spacing);
                (part, WallSample { position, volume })
            })
            .collect()
    }
}
