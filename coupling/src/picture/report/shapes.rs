//! The solids of a report: walls and terrain as triangles inside of the domain, blocks as shapes with a pose per frame.

use std::collections::BTreeMap;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use riprap_dda::clipped_polygon;

use super::packed::{Frames, Range, deflated};
use crate::picture::render::RenderError;
use crate::picture::render::body::{Body, bodies};
use crate::picture::render::recording::{Recording, read};

/// Of coordinates and of parts of quaternions.
const BITS: u32 = 16;
/// Numbers of a pose: center, and quaternion.
pub(super) const POSE: usize = 7;

/// Triangles of several bodies.
#[derive(Default)]
pub(super) struct Mesh {
    /// m.
    corners: Vec<Vector3<f64>>,
    /// Body of each corner.
    body: Vec<u16>,
    triangles: Vec<[u32; 3]>,
}

/// A mesh as the page reads it.
pub(super) struct PackedMesh {
    pub n_corners: usize,
    pub n_triangles: usize,
    /// Of the coordinates; m.
    pub range: Range,
    /// x, y, z and body of each corner in 16 bits, then the corners of each triangle in 32, deflated.
    pub bytes: Vec<u8>,
}

impl Mesh {
    fn add(&mut self, polygon: &[Vector3<f64>], body: u16) {
        let first = self.corners.len() as u32;
        self.corners.extend_from_slice(polygon);
        self.body.extend(polygon.iter().map(|_| body));
        let fan = 1..(polygon.len() as u32).saturating_sub(1);
        self.triangles
            .extend(fan.map(|k| [first, first + k, first + k + 1]));
    }

    pub(super) fn packed(&self) -> PackedMesh {
        let all = || self.corners.iter().flat_map(|x| x.iter().copied());
        let lo = all().fold(f64::INFINITY, f64::min);
        let hi = all().fold(f64::NEG_INFINITY, f64::max);
        let range = match self.corners.is_empty() {
            true => Range {
                lo: 0.0,
                hi: 1.0,
                bits: BITS,
            },
            false => Range {
                lo: lo as f32,
                hi: (hi as f32).max(lo as f32 + f32::EPSILON),
                bits: BITS,
            },
        };
        let coordinates =
            (0..3).flat_map(|k| self.corners.iter().map(move |x| range.code(x[k] as f32)));
        let shorts = coordinates.chain(self.body.iter().copied());
        let mut raw: Vec<u8> = shorts.flat_map(u16::to_le_bytes).collect();
        raw.extend(
            self.triangles
                .iter()
                .flatten()
                .flat_map(|corner| corner.to_le_bytes()),
        );
        PackedMesh {
            n_corners: self.corners.len(),
            n_triangles: self.triangles.len(),
            range,
            bytes: deflated(&raw),
        }
    }
}

/// Walls (body 0) and terrain (body 1) inside of the domain; across a plane or a slab they keep their sides, which are what is seen.
pub(super) fn fixed(run: &Recording) -> Mesh {
    let (min, max) = run.scene.domain;
    let axes: &[usize] = if run.scene.is_thin {
        &[0, 2]
    } else {
        &[0, 1, 2]
    };
    let mut mesh = Mesh::default();
    for body in &run.fixed {
        for polygon in body.polygons() {
            let inside = axes.iter().fold(polygon, |polygon, &k| {
                let above = clipped_polygon(&polygon, |x| min[k] - x[k]);
                clipped_polygon(&above, |x| x[k] - max[k])
            });
            mesh.add(&inside, u16::from(body.is_terrain));
        }
    }
    mesh
}

/// Blocks that move.
pub(super) struct Moving {
    /// Number of each in the run.
    pub ids: Vec<i32>,
    /// About the middle of their corners, as they are at first.
    pub mesh: Mesh,
    /// s.
    pub times: Vec<f64>,
    pub poses: Frames,
    /// Of x, y and z of a center; m.
    pub ranges: [Range; 3],
}

/// Of the four parts of a quaternion.
const PART: Range = Range {
    lo: -1.0,
    hi: 1.0,
    bits: BITS,
};

/// Where a body is at one time.
#[derive(Clone, Copy)]
struct Pose {
    center: Vector3<f64>,
    attitude: UnitQuaternion<f64>,
}

fn middle(body: &Body) -> Vector3<f64> {
    body.corners.iter().sum::<Vector3<f64>>() / body.corners.len().max(1) as f64
}

/// Reads the blocks that move; `None` without.
pub(super) fn moving(run: &Recording) -> Result<Option<Moving>, RenderError> {
    let mut reference: BTreeMap<i32, Body> = BTreeMap::new();
    let mut frames: Vec<BTreeMap<i32, Pose>> = Vec::new();
    for file in &run.blocks {
        let (present, _) = bodies(&read(&file.path)?);
        let mut poses = BTreeMap::new();
        for body in present {
            let first = reference.entry(body.id).or_insert_with(|| body.clone());
            let Some((rotation, _)) = body.motion_from(first) else {
                continue;
            };
            let rotation = Rotation3::from_matrix_unchecked(rotation);
            let mut attitude = UnitQuaternion::from_rotation_matrix(&rotation);
            let before = frames.last().and_then(|last| last.get(&body.id));
            if before.is_some_and(|pose: &Pose| pose.attitude.coords.dot(&attitude.coords) < 0.0) {
                // the same attitude, on the side of the one before
                attitude = UnitQuaternion::new_unchecked(-attitude.into_inner());
            }
            let pose = Pose {
                center: middle(&body),
                attitude,
            };
            poses.insert(body.id, pose);
        }
        frames.push(poses);
    }
    if reference.is_empty() {
        return Ok(None);
    }
    let ids: Vec<i32> = reference.keys().copied().collect();
    let mut mesh = Mesh::default();
    for (number, body) in reference.values().enumerate() {
        let center = middle(body);
        for polygon in body.polygons() {
            let local: Vec<_> = polygon.iter().map(|x| x - center).collect();
            mesh.add(&local, number as u16);
        }
    }
    let ranges = [0, 1, 2].map(|k| {
        let all = || {
            frames
                .iter()
                .flat_map(|poses| poses.values().map(|pose| pose.center[k] as f32))
        };
        let (lo, hi) = (
            all().fold(f32::INFINITY, f32::min),
            all().fold(f32::NEG_INFINITY, f32::max),
        );
        Range {
            lo,
            hi: hi.max(lo + f32::EPSILON * lo.abs().max(1.0)),
            bits: BITS,
        }
    });
    let n_items = ids.len();
    let codes = frames.iter().map(|poses| {
        let mut codes = vec![PART.absent(); POSE * n_items];
        for (place, id) in ids.iter().enumerate() {
            let Some(pose) = poses.get(id) else { continue };
            for k in 0..3 {
                codes[k * n_items + place] = ranges[k].code(pose.center[k] as f32);
            }
            for (k, part) in pose.attitude.coords.iter().enumerate() {
                codes[(3 + k) * n_items + place] = PART.code(*part as f32);
            }
        }
        codes
    });
    Ok(Some(Moving {
        poses: Frames {
            n_items,
            codes: codes.collect(),
            speeds: Vec::new(),
        },
        ids,
        mesh,
        times: run.blocks.iter().map(|file| file.time).collect(),
        ranges,
    }))
}
