//! Points of fixed bodies that touch or overlap: tank floors, walls, beaches.
//!
//! Such bodies are one solid. A face counts where it is exposed, that is without another part
//! directly above it. Below the exposed part of each cell of a face there is a column of points.
//! Where columns of faces on either side of a convex edge cross, the nearer face has the point;
//! behind a concave edge, without columns, the lattice of the first face is continued.

use nalgebra::Vector2;

use super::{Axes, WallSample, cells_along, n_layers};
use crate::Vec3;
use crate::boundary::integral::Face;
use close::ClosePoints;

mod close;

/// Points closer than this, of the spacing, are one when they fit into one cell: the two parts of a
/// divided cell are ½ apart.
const SAME_CELL: f64 = 0.51;
/// Of two points of exposed columns closer than this, of the spacing, the second is a copy.
const COPY: f64 = 0.3;
/// A cell that is partly exposed is divided into this many squared.
const DIVISIONS: usize = 8;
/// Distance above a face within which another face covers it; of the spacing.
const HAIR: f64 = 1e-3;
/// Largest cosine between the normals of two sides of a slab.
const OPPOSITE: f64 = -1.0 + 1e-9;
/// Round-off of positions; of the spacing.
const TOLERANCE: f64 = 1e-6;

/// A box parallel to the axes; m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Lowest corner; m.
    pub min: Vec3,
    /// Highest corner; m.
    pub max: Vec3,
}

impl Region {
    /// Larger by `margin` (m) on all sides.
    pub fn grown(&self, margin: f64) -> Self {
        Self {
            min: self.min.add_scalar(-margin),
            max: self.max.add_scalar(margin),
        }
    }

    /// Whether a point is inside or on the boundary.
    pub fn contains(&self, x: &Vec3) -> bool {
        (0..3).all(|axis| self.min[axis] <= x[axis] && x[axis] <= self.max[axis])
    }

    fn around<'a>(points: impl Iterator<Item = &'a Vec3>) -> Self {
        let nothing = Self {
            min: Vec3::repeat(f64::INFINITY),
            max: Vec3::repeat(-f64::INFINITY),
        };
        points.fold(nothing, |region, p| Self {
            min: region.min.inf(p),
            max: region.max.sup(p),
        })
    }

    fn intersection(&self, other: &Self) -> Self {
        Self {
            min: self.min.sup(&other.min),
            max: self.max.inf(&other.max),
        }
    }

    fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.max[axis] < self.min[axis])
    }
}

/// The lattice of [`sample_union`].
#[derive(Clone, Copy, Debug)]
pub struct UnionLattice {
    /// Corner of cells: along an axis of coordinates points sit at `anchor + (i + ½) dp`; m.
    pub anchor: Vec3,
    /// Distance `dp` of points; above zero; m.
    pub particle_spacing: f64,
    /// Reach `R` of the kernel; above zero; m.
    pub support_radius: f64,
    /// Region of the fluid. Faces outside get no points, and points are within this region extended by `R`.
    pub region: Region,
}

/// A point of a union.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnionSample {
    /// The first part that the point is in; index into the parts.
    pub part: usize,
    /// Position and volume.
    pub sample: WallSample,
}

/// Points of the union of convex parts, each given by its faces.
///
/// In a face the lattice follows a coordinate axis if one lies in the face, and is then
/// anchored; across a slope its spacing is the closest to `dp` that divides the face. A point has
/// the volume of the part of its cell that is exposed and closer to its own face than to others,
/// times `dp`. A slab exposed on both sides is filled from either to its middle, where a layer may be thinner than `dp`.
/// The order is that of parts, faces and cells.
pub fn sample_union(parts: &[&[Face]], lattice: &UnionLattice) -> Vec<UnionSample> {
    let union = Union::new(parts, lattice);
    let mut kept = Kept {
        copy: COPY * lattice.particle_spacing,
        close: ClosePoints::new(&union.bounds(), SAME_CELL * lattice.particle_spacing),
        samples: Vec::new(),
    };
    let exposed: Vec<Vec<Column>> = union.plates.iter().map(|p| union.exposed(p)).collect();
    for (plate, exposed) in union.plates.iter().zip(&exposed) {
        union.fill(plate, exposed, &mut kept, |cell, column, layer| {
            let layer = union.up_to_the_middle(plate, &plate.at(&column.place, 0.0), layer)?;
            Some((layer, union.mitred(plate, cell, column, layer.depth)))
        });
    }
    // the remaining points behind edges are pieces of cells beside others
    kept.copy = TOLERANCE * lattice.particle_spacing;
    let mut continued: Vec<Vec<bool>> = exposed
        .iter()
        .map(|cells| vec![false; cells.len()])
        .collect();
    for plate in 0..union.plates.len() {
        let behind = &union.plates[plate];
        let columns = behind.behind_edges(&exposed[plate], union.n_layers);
        union.fill(behind, &columns, &mut kept, |cell, _, layer| {
            let column = behind.column(cell, |place| {
                !union.is_exposed(behind, &behind.at(place, 0.0))
                    && !union.is_below_another(plate, &continued, &behind.at(place, layer.depth))
            });
            Some((layer, column))
        });
        continued[plate] = columns.iter().map(|column| 0.0 < column.share).collect();
    }
    kept.samples
}

/// The part of a cell that has points below it.
#[derive(Clone, Copy, Debug)]
struct Column {
    /// Centroid along the axes of the plate; m.
    place: Vector2<f64>,
    /// Of the cell's area; 0 to 1.
    share: f64,
}

/// A layer below a plate.
#[derive(Clone, Copy, Debug)]
struct Layer {
    /// Depth of its points; m.
    depth: f64,
    /// Thickness over the spacing.
    share: f64,
}

/// Points so far.
struct Kept {
    /// Points closer than this are copies; m.
    copy: f64,
    close: ClosePoints,
    samples: Vec<UnionSample>,
}

impl Kept {
    /// Adds a point, joins it to another of the same cell, or leaves out a copy.
    fn add(&mut self, new: UnionSample, cell_volume: f64) {
        let x = new.sample.position;
        let Some((near, distance)) = self.close.nearest(&x) else {
            self.close.push(&x);
            self.samples.push(new);
            return;
        };
        let old = &mut self.samples[near].sample;
        let volume = old.volume + new.sample.volume;
        if volume <= cell_volume * (1.0 + TOLERANCE) {
            old.position += (x - old.position) * (new.sample.volume / volume);
            old.volume = volume;
            self.close.move_to(near, &old.position);
        } else if self.copy <= distance {
            self.close.push(&x);
            self.samples.push(new);
        }
    }
}

/// The parts and the lattices of their faces.
struct Union<'a> {
    parts: &'a [&'a [Face<'a>]],
    lattice: &'a UnionLattice,
    n_layers: usize,
    plates: Vec<Plate<'a>>,
}

/// A face with its lattice, continued beyond the outline.
struct Plate<'a> {
    face: &'a Face<'a>,
    part: usize,
    axes: Axes,
    /// Lowest corner of the lattice along the axes; m.
    origin: Vector2<f64>,
    /// m.
    step: Vector2<f64>,
    n: [usize; 2],
    /// Coordinate of the plane along the normal; m.
    height: f64,
    /// Bounds of the columns and their continuation; m.
    reach: Region,
    /// Parts that touch `reach`.
    near_parts: Vec<usize>,
    /// Other faces, as indices into the plates, that touch `reach`.
    near_plates: Vec<usize>,
}

impl<'a> Union<'a> {
    fn new(parts: &'a [&'a [Face<'a>]], lattice: &'a UnionLattice) -> Self {
        let n_layers = n_layers(lattice.particle_spacing, lattice.support_radius);
        let margin = (n_layers + 1) as f64 * lattice.particle_spacing;
        let boxes: Vec<Region> = parts
            .iter()
            .map(|faces| Region::around(faces.iter().flat_map(|face| face.vertices)))
            .collect();
        let mut plates: Vec<Plate> = parts
            .iter()
            .enumerate()
            .flat_map(|(part, faces)| faces.iter().map(move |face| (part, face)))
            .filter_map(|(part, face)| Plate::new(part, face, lattice, margin))
            .collect();
        let reaches: Vec<Region> = plates.iter().map(|plate| plate.reach).collect();
        for (index, plate) in plates.iter_mut().enumerate() {
            let touches = |other: &Region| !plate.reach.intersection(other).is_empty();
            plate.near_parts = (0..parts.len()).filter(|&p| touches(&boxes[p])).collect();
            plate.near_plates = (0..reaches.len())
                .filter(|&other| other != index && touches(&reaches[other]))
                .collect();
        }
        Self {
            parts,
            lattice,
            n_layers,
            plates,
        }
    }

    fn bounds(&self) -> Region {
        let corners = self
            .plates
            .iter()
            .flat_map(|plate| [&plate.reach.min, &plate.reach.max]);
        Region::around(corners)
    }

    fn contains(&self, part: usize, x: &Vec3) -> bool {
        let tolerance = TOLERANCE * self.lattice.particle_spacing;
        self.parts[part]
            .iter()
            .all(|face| face.distance(x) <= tolerance)
    }

    /// Whether fluid may touch a plate at a point of its plane.
    fn is_exposed(&self, plate: &Plate, foot: &Vec3) -> bool {
        let hair = HAIR * self.lattice.particle_spacing;
        let above = foot + plate.face.normal * hair;
        self.lattice.region.grown(hair).contains(foot)
            && plate.has(foot, TOLERANCE * self.lattice.particle_spacing)
            && !plate
                .near_parts
                .iter()
                .any(|&part| part != plate.part && self.contains(part, &above))
    }

    /// The exposed part of every cell of a plate.
    fn exposed(&self, plate: &Plate) -> Vec<Column> {
        let is_exposed = |place: &Vector2<f64>| self.is_exposed(plate, &plate.at(place, 0.0));
        plate
            .cells()
            .map(|cell| plate.column(cell, is_exposed))
            .collect()
    }

    /// The part of an exposed column that is nearer to its own face than to others.
    ///
    /// A point that also belongs to another face, equally close to it, has its full volume: there the lattices
    /// of two faces at right angles coincide.
    fn mitred(&self, plate: &Plate, cell: [usize; 2], column: &Column, depth: f64) -> Column {
        let tolerance = TOLERANCE * self.lattice.particle_spacing;
        let x = plate.at(&plate.center(cell), depth);
        let is_shared = plate.near_plates.iter().any(|&other| {
            let other = &self.plates[other];
            let other_depth = -other.face.distance(&x);
            (other_depth - depth).abs() < tolerance
                && other.has_center_at(&x)
                && self.is_exposed(other, &(x + other.face.normal * other_depth))
        });
        if is_shared && !self.is_nearer_to_another(plate, depth, &x) {
            return *column;
        }
        let is_own = |place: &Vector2<f64>| {
            !self.is_nearer_to_another(plate, depth, &plate.at(place, depth))
        };
        let own = plate.column(cell, is_own);
        if own.share == 1.0 || column.share == 0.0 {
            return *column;
        }
        plate.column(cell, |place| {
            is_own(place) && self.is_exposed(plate, &plate.at(place, 0.0))
        })
    }

    /// The part of a layer on this side of the middle of a slab that is exposed on the other side too, below a foot; `None`
    /// beyond it. A layer whose points are in the middle itself is whole.
    fn up_to_the_middle(&self, plate: &Plate, foot: &Vec3, layer: Layer) -> Option<Layer> {
        let dp = self.lattice.particle_spacing;
        let (top, bottom) = (layer.depth - 0.5 * dp, layer.depth + 0.5 * dp);
        let opposite = plate.near_plates.iter().filter_map(|&other| {
            let other = &self.plates[other];
            let is_parallel = plate.face.normal.dot(&other.face.normal) < OPPOSITE;
            let thickness = -other.face.distance(foot);
            (is_parallel
                && TOLERANCE * dp < thickness
                && thickness < 2.0 * bottom
                && self.is_exposed(other, &(foot + other.face.normal * thickness)))
            .then_some(thickness)
        });
        let middle = 0.5 * opposite.fold(f64::INFINITY, f64::min);
        if bottom <= middle || (middle - layer.depth).abs() <= TOLERANCE * dp {
            Some(layer)
        } else if top + TOLERANCE * dp < middle {
            Some(Layer {
                depth: 0.5 * (top + middle),
                share: (middle - top) / dp,
            })
        } else {
            None
        }
    }

    /// Whether a point at `depth` below one plate is less deep below an exposed point of another.
    fn is_nearer_to_another(&self, plate: &Plate, depth: f64, x: &Vec3) -> bool {
        let tolerance = TOLERANCE * self.lattice.particle_spacing;
        plate.near_plates.iter().any(|&other| {
            let other = &self.plates[other];
            let other_depth = -other.face.distance(x);
            0.0 < other_depth
                && other_depth < depth - tolerance
                && self.is_exposed(other, &(x + other.face.normal * other_depth))
        })
    }

    /// Whether a point is in a column of a plate other than `plate`, exposed or continued.
    fn is_below_another(&self, plate: usize, continued: &[Vec<bool>], x: &Vec3) -> bool {
        let deepest = self.n_layers as f64 * self.lattice.particle_spacing;
        self.plates[plate].near_plates.iter().any(|&index| {
            let other = &self.plates[index];
            let depth = -other.face.distance(x);
            let is_continued = || other.cell_of(x).is_some_and(|cell| continued[index][cell]);
            0.0 < depth
                && depth < deepest
                && (is_continued() || self.is_exposed(other, &(x + other.face.normal * depth)))
        })
    }

    /// Adds the points of columns that are in the solid.
    fn fill(
        &self,
        plate: &Plate,
        columns: &[Column],
        kept: &mut Kept,
        part_of: impl Fn([usize; 2], &Column, Layer) -> Option<(Layer, Column)>,
    ) {
        let dp = self.lattice.particle_spacing;
        let cell_volume = plate.step.x * plate.step.y * dp;
        let within = self.lattice.region.grown(self.lattice.support_radius);
        for k in 0..self.n_layers {
            let whole = Layer {
                depth: (k as f64 + 0.5) * dp,
                share: 1.0,
            };
            let filled = plate.cells().zip(columns).filter(|(_, c)| 0.0 < c.share);
            for (cell, column) in filled {
                let Some((layer, column)) = part_of(cell, column, whole) else {
                    continue;
                };
                let x = plate.at(&column.place, layer.depth);
                let owner = || plate.near_parts.iter().find(|&&p| self.contains(p, &x));
                if 0.0 < column.share
                    && within.contains(&x)
                    && let Some(&part) = owner()
                {
                    let sample = WallSample {
                        position: x,
                        volume: cell_volume * column.share * layer.share,
                    };
                    kept.add(UnionSample { part, sample }, cell_volume);
                }
            }
        }
    }
}

impl<'a> Plate<'a> {
    /// The lattice of a face; `None` if it is beyond the region.
    fn new(part: usize, face: &'a Face<'a>, lattice: &UnionLattice, margin: f64) -> Option<Self> {
        let axes = Axes::along_coordinates(&face.normal);
        let region = lattice.region.grown(margin);
        let reach = Region::around(face.vertices.iter())
            .grown(margin)
            .intersection(&region);
        if reach.is_empty() {
            return None;
        }
        let height = face.normal.dot(face.vertices.first()?);
        let mut plate = Self {
            face,
            part,
            axes,
            origin: Vector2::zeros(),
            step: Vector2::zeros(),
            n: [0; 2],
            height,
            reach,
            near_parts: Vec::new(),
            near_plates: Vec::new(),
        };
        for (k, axis) in [axes.u, axes.v].iter().enumerate() {
            let along = face.vertices.iter().map(|p| axis.dot(p));
            let low = along.clone().fold(f64::INFINITY, f64::min);
            let high = along.fold(-f64::INFINITY, f64::max);
            let is_coordinate = 1.0 - 1e-12 < axis.amax();
            let (start, step) = if is_coordinate {
                (axis.dot(&lattice.anchor), lattice.particle_spacing)
            } else {
                (low, cells_along(high - low, lattice.particle_spacing).1)
            };
            let center = axis.dot(&(region.min + region.max)) * 0.5;
            let half = axis.abs().dot(&(region.max - region.min)) * 0.5;
            let from = (low - margin).max(center - half);
            let to = (high + margin).min(center + half);
            let first = ((from - start) / step).floor();
            plate.n[k] = (((to - start) / step).ceil() - first).max(0.0) as usize;
            plate.origin[k] = start + first * step;
            plate.step[k] = step;
        }
        Some(plate)
    }

    /// Cells in the order of their exposure.
    fn cells(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [n_u, n_v] = self.n;
        (0..n_v).flat_map(move |j| (0..n_u).map(move |i| [i, j]))
    }

    fn center(&self, [i, j]: [usize; 2]) -> Vector2<f64> {
        let cells = Vector2::new(i as f64, j as f64).add_scalar(0.5);
        self.origin + cells.component_mul(&self.step)
    }

    /// Whether a column runs through a point along its own middle.
    fn has_center_at(&self, x: &Vec3) -> bool {
        let place = (self.axes.plane(x) - self.origin).component_div(&self.step);
        let from_center = place.map(|p| (p - p.floor() - 0.5).abs());
        from_center.max() < HAIR
    }

    /// The part of a cell where a condition holds: all, nothing, or by a count of small cells.
    fn column(&self, cell: [usize; 2], holds: impl Fn(&Vector2<f64>) -> bool) -> Column {
        let center = self.center(cell);
        let place = |u: f64, v: f64| center + Vector2::new(u, v).component_mul(&self.step);
        // the outermost of the small cells
        let corner = 0.5 - 0.5 / DIVISIONS as f64;
        let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let n_corners = corners
            .iter()
            .filter(|(u, v)| holds(&place(u * corner, v * corner)))
            .count();
        if n_corners == corners.len() || (n_corners == 0 && !holds(&center)) {
            let share = if n_corners == 0 { 0.0 } else { 1.0 };
            return Column {
                place: center,
                share,
            };
        }
        let (mut count, mut sum) = (0.0, Vector2::zeros());
        let along = |k: usize| (k as f64 + 0.5) / DIVISIONS as f64 - 0.5;
        for j in 0..DIVISIONS {
            for i in 0..DIVISIONS {
                let place = place(along(i), along(j));
                if holds(&place) {
                    count += 1.0;
                    sum += place - center;
                }
            }
        }
        Column {
            place: center + sum / f64::max(count, 1.0),
            share: count / (DIVISIONS * DIVISIONS) as f64,
        }
    }

    /// The point below a position in the plane.
    fn at(&self, place: &Vector2<f64>, depth: f64) -> Vec3 {
        self.axes.u * place.x + self.axes.v * place.y + self.face.normal * (self.height - depth)
    }

    /// The cell whose column contains a point, as an index into [`Self::cells`].
    fn cell_of(&self, x: &Vec3) -> Option<usize> {
        let place = (self.axes.plane(x) - self.origin).component_div(&self.step);
        let [i, j] = [place.x, place.y].map(f64::floor);
        let is_on = 0.0 <= i && i < self.n[0] as f64 && 0.0 <= j && j < self.n[1] as f64;
        is_on.then(|| j as usize * self.n[0] + i as usize)
    }

    /// Whether a point of the plane is inside the outline.
    fn has(&self, foot: &Vec3, tolerance: f64) -> bool {
        let vertices = self.face.vertices;
        let next = vertices.iter().cycle().skip(1);
        vertices.iter().zip(next).all(|(p, q)| {
            let side = q - p;
            let outward = side.cross(&self.face.normal);
            outward.dot(&(foot - p)) <= tolerance * side.norm()
        })
    }

    /// Covered cells within `n` cells of an exposed one, along both directions.
    fn behind_edges(&self, exposed: &[Column], n: usize) -> Vec<Column> {
        let [n_u, n_v] = self.n;
        let spread = |from: &[bool], length: usize, stride: usize| -> Vec<bool> {
            (0..from.len())
                .map(|cell| {
                    let place = cell / stride % length;
                    let first = cell - place.min(n) * stride;
                    let count = place.min(n) + 1 + n.min(length - 1 - place);
                    (0..count).any(|k| from[first + k * stride])
                })
                .collect()
        };
        let is_exposed: Vec<bool> = exposed.iter().map(|column| 0.0 < column.share).collect();
        let is_near = spread(&spread(&is_exposed, n_u, 1), n_v, n_u);
        let rest = |((cell, column), is_near): (([usize; 2], &Column), bool)| {
            let center = self.center(cell);
            let share = if is_near { 1.0 - column.share } else { 0.0 };
            let lever = column.share / f64::max(share, TOLERANCE);
            Column {
                place: center - (column.place - center) * lever,
                share,
            }
        };
        self.cells().zip(exposed).zip(is_near).map(rest).collect()
    }
}
