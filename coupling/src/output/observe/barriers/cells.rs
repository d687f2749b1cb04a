//! Cells of the faces of a barrier: forces of contacts and pressure of water on each, and their envelope.
//!
//! Faces are those of the convex parts but for the ones inside of the same block. A face is divided by a grid over its bounding rectangle;
//! a contact belongs to the cell that is nearest to its point on the face that its normal points out of.

use riprap_dda::{BlockDefinition, Blocks, Motion, Polyhedron, Shape, Vec3, clipped_polygon};
use riprap_sph::fluid::ContinuedPressure;
use serde::{Deserialize, Serialize};

use super::forces::Peak;
use crate::files::vtk::{Array, PolyData, Values};
use crate::output::observe::arrays::{integers, single};
use crate::scene::resolved::recording::Barrier;
use crate::walls::face_lattice;
use crate::world::Water;

/// Distance of the places of pressure in front of their cells, × spacing: a thin solid hides the water from what is in it.
const IN_FRONT: f64 = 0.01;
/// Water fraction of the kernel support, `Σ V W`, below which a cell is dry; at a wetted plane wall it is one half.
const DRY: f64 = 0.05;
/// Cosine of the angle between a face and the flow from which on it looks upstream.
const UPSTREAM: f64 = 0.5;
/// Distance from a face of a probe that finds what lies on it; × size of the part, or height of the barrier.
const PROBE: f64 = 1e-6;

/// A face, in its place at the start.
#[derive(Clone, Debug)]
struct Face {
    /// Place of its block in the list of the barrier.
    block: usize,
    normal: Vec3,
    /// Corner of its bounding rectangle, and unit vectors along it; m.
    corner: Vec3,
    along: [Vec3; 2],
    n_cells: [usize; 2],
    /// m.
    size: [f64; 2],
    first: usize,
    outline: Vec<Vec3>,
}

impl Face {
    fn of(polyhedron: &Polyhedron, face: usize, (block, barrier): (usize, &Barrier)) -> Self {
        let outline: Vec<Vec3> = (polyhedron.face_vertices(face))
            .map(|v| polyhedron.vertices()[v as usize])
            .collect();
        let normal = polyhedron.face_normal(face);
        // level rows where the face is not level itself
        let [flow, _, up] = &barrier.axes;
        let level = up.cross(&normal);
        let level = if 1e-6 < level.norm() {
            level.normalize()
        } else {
            (flow.cross(&normal)).normalize()
        };
        let along = [level, normal.cross(&level)];
        let [low, high] = [f64::min, f64::max].map(|extreme: fn(f64, f64) -> f64| {
            along.map(|axis| outline.iter().map(|x| axis.dot(x)).reduce(extreme))
        });
        let range = |k: usize| (low[k].unwrap_or(0.0), high[k].unwrap_or(0.0));
        let length = [0, 1].map(|k| range(k).1 - range(k).0);
        // a length that is a whole number of cells but for round-off is divided by it
        let n_cells = length.map(|length| ((length / barrier.cell - 1e-6).ceil() as usize).max(1));
        let height = outline.first().map_or(0.0, |x| normal.dot(x));
        Self {
            block,
            corner: along[0] * range(0).0 + along[1] * range(1).0 + normal * height,
            size: [0, 1].map(|k| length[k] / n_cells[k] as f64),
            normal,
            along,
            n_cells,
            first: 0,
            outline,
        }
    }

    fn n(&self) -> usize {
        self.n_cells[0] * self.n_cells[1]
    }

    /// Cell nearest to a point, and its distance from the bounding rectangle (m).
    fn nearest(&self, x: &Vec3) -> (usize, f64) {
        let offset = x - self.corner;
        let mut away = Vec3::new(offset.dot(&self.normal), 0.0, 0.0);
        let place = [0, 1].map(|k| {
            let at = offset.dot(&self.along[k]);
            let length = self.size[k] * self.n_cells[k] as f64;
            away[k + 1] = at - at.clamp(0.0, length);
            // negative numbers become zero
            ((at / self.size[k]) as usize).min(self.n_cells[k] - 1)
        });
        (
            self.first + place[1] * self.n_cells[0] + place[0],
            away.norm(),
        )
    }

    /// Part of the face in one of its cells.
    fn outline_of(&self, cell: usize) -> Vec<Vec3> {
        let place = [cell % self.n_cells[0], cell / self.n_cells[0]];
        (0..2).fold(self.outline.clone(), |outline, k| {
            let at = |x: &Vec3| (x - self.corner).dot(&self.along[k]);
            let from = place[k] as f64 * self.size[k];
            let outline = clipped_polygon(&outline, |x| from - at(x));
            clipped_polygon(&outline, |x| at(x) - from - self.size[k])
        })
    }
}

/// Faces of a barrier with their cells, which never change.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    faces: Vec<Face>,
    /// First face of each block, and the number of all.
    first_face: Vec<usize>,
    cells: Vec<FaceCell>,
}

/// Part of a cell that is on its face.
#[derive(Clone, Copy, Debug)]
struct FaceCell {
    /// Centroid, in its place at the start; m.
    center: Vec3,
    /// m².
    area: f64,
    /// Number of the face.
    face: usize,
    /// Whether another block that forces do not move lies on it, which keeps the water away.
    is_covered: bool,
}

impl Grid {
    pub fn new(barrier: &Barrier, definitions: &[BlockDefinition]) -> Self {
        let (mut faces, mut first_face): (Vec<Face>, _) = (Vec::new(), vec![0]);
        for (number, &b) in barrier.blocks.iter().enumerate() {
            if let Shape::Polyhedra(parts) = &definitions[b].shape {
                for (k, part) in parts.iter().enumerate() {
                    let outer = (0..part.n_faces()).filter(|&f| !is_inside(parts, (k, f)));
                    faces.extend(outer.map(|f| Face::of(part, f, (number, barrier))));
                }
            }
            first_face.push(faces.len());
        }
        let solids: Vec<&Polyhedron> = (definitions.iter())
            .filter(|block| !matches!(block.motion, Motion::Free))
            .flat_map(|block| match &block.shape {
                Shape::Polyhedra(parts) => parts.as_slice(),
                Shape::Sphere { .. } | Shape::Surface(_) => &[],
            })
            .collect();
        let mut cells = Vec::new();
        for (number, face) in faces.iter_mut().enumerate() {
            face.first = cells.len();
            cells.extend((0..face.n()).map(|cell| {
                let (center, area) = centroid(&face.outline_of(cell), &face.normal);
                let probe = center + face.normal * (PROBE * barrier.height());
                FaceCell {
                    center,
                    area,
                    face: number,
                    is_covered: solids.iter().any(|solid| holds(solid, &probe)),
                }
            }));
        }
        Self {
            faces,
            first_face,
            cells,
        }
    }

    /// Cell of a contact at a point, by the normal that points out of a block; both at its place at the start.
    fn cell(&self, block: usize, point: &Vec3, outward: &Vec3, size: f64) -> Option<usize> {
        let faces = &self.faces[self.first_face[block]..self.first_face[block + 1]];
        let misfit = |face: &Face| {
            let (cell, distance) = face.nearest(point);
            (cell, distance / size + 1.0 - face.normal.dot(outward))
        };
        let best = faces.iter().map(misfit).min_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(cell, _)| cell)
    }
}

/// Whether a face of a part lies on another part.
fn is_inside(parts: &[Polyhedron], (k, face): (usize, usize)) -> bool {
    let part = &parts[k];
    let outline: Vec<Vec3> = (part.face_vertices(face))
        .map(|v| part.vertices()[v as usize])
        .collect();
    let normal = part.face_normal(face);
    let probe = centroid(&outline, &normal).0 + normal * (PROBE * part.size());
    let mut others = parts.iter().enumerate().filter(|&(other, _)| other != k);
    others.any(|(_, other)| holds(other, &probe))
}

fn holds(solid: &Polyhedron, x: &Vec3) -> bool {
    (0..solid.n_faces()).all(|face| solid.plane_distance(face, x) <= 0.0)
}

/// Centroid (m) and area (m²) of a convex polygon.
fn centroid(outline: &[Vec3], normal: &Vec3) -> (Vec3, f64) {
    let Some(first) = outline.first() else {
        return (Vec3::zeros(), 0.0);
    };
    let triangles = outline.windows(2).map(|pair| {
        let area = 0.5 * (pair[0] - first).cross(&(pair[1] - first)).dot(normal);
        ((first + pair[0] + pair[1]) / 3.0 * area, area)
    });
    let (moment, area) = triangles.fold((Vec3::zeros(), 0.0), |sum, triangle| {
        (sum.0 + triangle.0, sum.1 + triangle.1)
    });
    if 0.0 < area {
        (moment / area, area)
    } else {
        (*first, 0.0)
    }
}

/// Largest loads of a cell, and the impulse of its normal forces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Envelope {
    /// N.
    normal: f64,
    /// N.
    resultant: Peak,
    /// N s.
    impulse: f64,
    /// Normal force in the last step; N.
    now: f64,
}

/// Loads of all cells. Saved in checkpoints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct CellLoads {
    /// Of contacts in the last step, on the barrier, as it was placed at the start; N.
    force: Vec<Vec3>,
    /// Cells on which there was any.
    touched: Vec<u32>,
    solid: Vec<Envelope>,
    /// Empty without water.
    fluid: Vec<Envelope>,
}

/// End of a step, and the times over which the forces on cells act.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepShares {
    /// s.
    pub time: f64,
    /// Of the forces of contacts before and after it: springs share the step, those of contact dynamics are its means; s.
    pub contacts: [f64; 2],
    /// Of the pressure of water; s.
    pub water: f64,
}

/// What a step brought to the cells.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Local {
    pub step: StepShares,
    /// Largest resultant on a cell, of contacts and of water; N.
    pub largest: [f64; 2],
    /// Whether there was a moving body, and water.
    pub has_arrived: [bool; 2],
}

impl CellLoads {
    pub fn of(grid: &Grid, has_water: bool) -> Self {
        let n = grid.cells.len();
        Self {
            force: vec![Vec3::zeros(); n],
            touched: Vec::new(),
            solid: vec![Envelope::default(); n],
            fluid: vec![Envelope::default(); if has_water { n } else { 0 }],
        }
    }

    /// Takes the contacts of a step.
    pub fn book_contacts(
        &mut self,
        (grid, barrier): (&Grid, &Barrier),
        blocks: &Blocks,
        local: &mut Local,
    ) {
        let step = local.step;
        let Self {
            force,
            touched,
            solid,
            ..
        } = self;
        for cell in touched.drain(..).map(|cell| cell as usize) {
            let normal = -force[cell].dot(&grid.normal(cell));
            solid[cell].impulse += normal * step.contacts[0];
            solid[cell].now = 0.0;
            force[cell] = Vec3::zeros();
        }
        blocks.for_each_contact_of(&barrier.blocks, &mut |b, contact| {
            let (i, j) = (contact.blocks.0.index(), contact.blocks.1.index());
            let on_second = contact.normal * contact.normal_force + contact.shear_force;
            let (partner, on_barrier, outward) = match b == i {
                true => (j, -on_second, contact.normal),
                false => (i, on_second, -contact.normal),
            };
            let bears = on_barrier != Vec3::zeros();
            let Ok(member) = barrier.blocks.binary_search(&b) else {
                return;
            };
            local.has_arrived[0] |= bears && blocks.is_free(partner);
            let cell = match blocks.is_fixed(b) {
                true => grid.cell(member, &contact.point, &outward, barrier.cell),
                false => {
                    let pose = blocks.pose(b);
                    let point = pose.inverse_transform_point(&contact.point.into()).coords;
                    let outward = pose.inverse_transform_vector(&outward);
                    grid.cell(member, &point, &outward, barrier.cell)
                }
            };
            if let Some(cell) = cell.filter(|_| bears) {
                let on_barrier = match blocks.is_fixed(b) {
                    true => on_barrier,
                    false => blocks.pose(b).inverse_transform_vector(&on_barrier),
                };
                if force[cell] == Vec3::zeros() {
                    touched.push(cell as u32);
                }
                force[cell] += on_barrier;
            }
        });
        for cell in touched.iter().map(|&cell| cell as usize) {
            let normal = -force[cell].dot(&grid.normal(cell));
            let resultant = force[cell].norm();
            local.largest[0] = local.largest[0].max(resultant);
            solid[cell].take((normal, resultant), step.time, step.contacts[1]);
        }
    }

    /// Takes the pressures of the water after a step.
    pub fn book_water(
        &mut self,
        (grid, barrier): (&Grid, &Barrier),
        (water, blocks): (&Water, &Blocks),
        probe: &mut Probe,
        local: &mut Local,
    ) {
        let step = local.step;
        probe.find(grid, barrier, (water, blocks));
        let found = probe.pressures.found();
        for (&cell, [share, pressure]) in probe.cells.iter().zip(found) {
            let cell = cell as usize;
            let is_wet = DRY <= share;
            local.has_arrived[1] |= is_wet;
            let force = if is_wet {
                pressure * grid.cells[cell].area
            } else {
                0.0
            };
            local.largest[1] = local.largest[1].max(force.abs());
            self.fluid[cell].take((force, force.abs()), step.time, step.water);
        }
    }

    /// Cells as polygons in their places at the start, with the envelope of their loads.
    pub fn envelope(&self, grid: &Grid, barrier: &Barrier, time: f64) -> PolyData {
        let mut data = PolyData {
            time,
            ..PolyData::default()
        };
        let (mut owner, mut upstream, mut shown) = (Vec::new(), Vec::new(), Vec::new());
        for (cell, of_face) in grid.cells.iter().enumerate() {
            if of_face.area <= 0.0 {
                continue;
            }
            let face = &grid.faces[of_face.face];
            for corner in &face.outline_of(cell - face.first) {
                let polygons = &mut data.polygons;
                polygons.connectivity.push(data.points.len() as i32);
                data.points.push(single(corner));
            }
            let end = data.polygons.connectivity.len() as i32;
            data.polygons.offsets.push(end);
            owner.push(barrier.blocks[face.block] as i32);
            let is_upstream = face.normal.dot(&barrier.axes[0]) <= -UPSTREAM;
            upstream.push(i32::from(is_upstream));
            shown.push(cell);
        }
        let numbers = |name: String, value: &dyn Fn(usize) -> f64| Array {
            name,
            components: 1,
            values: Values::F64(shown.iter().map(|&cell| value(cell)).collect()),
        };
        data.cell_data = vec![
            numbers("Area".to_owned(), &|cell| grid.cells[cell].area),
            integers("BlockId", owner),
            integers("LooksUpstream", upstream),
        ];
        for (kind, loads) in [("Solid", &self.solid), ("Fluid", &self.fluid)] {
            if loads.is_empty() {
                continue;
            }
            let name = |what: &str| format!("{kind}{what}");
            let never = f64::NAN;
            data.cell_data.extend([
                numbers(name("LargestNormal"), &|cell| loads[cell].normal),
                numbers(name("LargestResultant"), &|cell| {
                    loads[cell].resultant.value
                }),
                numbers(name("LargestTime"), &|cell| {
                    loads[cell].resultant.time.unwrap_or(never)
                }),
                numbers(name("Impulse"), &|cell| loads[cell].impulse),
                numbers(name("LastNormal"), &|cell| loads[cell].now),
            ]);
        }
        data
    }
}

impl Envelope {
    /// Takes the forces (N) at a time (s), which act over another (s).
    fn take(&mut self, (normal, resultant): (f64, f64), time: f64, over: f64) {
        self.normal = self.normal.max(normal);
        self.resultant.update(resultant, time);
        self.impulse += normal * over;
        self.now = normal;
    }
}

impl Grid {
    fn normal(&self, cell: usize) -> Vec3 {
        self.faces[self.cells[cell].face].normal
    }
}

/// Places of the cells at which the pressure of the water is read, filled anew after each step.
#[derive(Clone, Debug, Default)]
pub(super) struct Probe {
    /// Cells that water may wet.
    cells: Vec<u32>,
    /// m.
    places: Vec<Vec3>,
    pressures: ContinuedPressure,
}

impl Probe {
    fn find(&mut self, grid: &Grid, barrier: &Barrier, (water, blocks): (&Water, &Blocks)) {
        let (_, middle) = face_lattice(&water.fluid);
        let clear = IN_FRONT * water.fluid.settings().mean_spacing();
        self.cells.clear();
        self.places.clear();
        for (cell, of_face) in (0..).zip(&grid.cells) {
            let (face, center) = (&grid.faces[of_face.face], of_face.center);
            // a slice is cut from prisms without ends
            let is_end = middle.is_some() && 0.5 < face.normal.y.abs();
            if of_face.area <= 0.0 || of_face.is_covered || is_end {
                continue;
            }
            let b = barrier.blocks[face.block];
            let place = center + face.normal * clear;
            let mut place = match blocks.is_fixed(b) {
                true => place,
                false => (blocks.pose(b) * nalgebra::Point3::from(place)).coords,
            };
            place.y = middle.unwrap_or(place.y);
            self.cells.push(cell);
            self.places.push(place);
        }
        self.pressures.find(&water.fluid, &self.places);
    }
}
