//! Blocks and walls as drawn: read from polygons, cut open toward the camera, cut into strips.

use super::camera::{Camera, Panel};
use crate::files::vtk::{PolyData, Values};
use nalgebra::{Matrix3, Vector3};
use riprap_dda::clipped_polygon;
use std::collections::BTreeMap;

/// Fraction of sampled lines of sight that a wall face may block before it is removed.
const HIDING_SHARE: f64 = 0.03;

/// Lines of sight end this fraction of their length before their point: a block at rest overlaps the floor slightly, and
/// the floor does not hide it.
const SHORT_OF_END: f64 = 2e-3;

/// Cosine of the sharpest crease of the ground that is drawn round; 60 degrees.
const ROUND: f64 = 0.5;

/// A block or wall.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Body {
    /// Its number in the run.
    pub id: i32,
    /// Corners, in the order of their first occurrence in the faces; m.
    pub corners: Vec<Vector3<f64>>,
    /// Corner numbers, counter-clockwise from outside.
    pub faces: Vec<Vec<usize>>,
    /// Whether it is the ground from a raster, which is never cut open.
    pub is_terrain: bool,
}

/// The bodies of a file, and the number of faces omitted because a corner is not finite.
pub(crate) fn bodies(data: &PolyData) -> (Vec<Body>, usize) {
    let ids = data
        .cell_data
        .iter()
        .find(|a| a.name == "BlockId")
        .map(|a| &a.values);
    let mut bodies: BTreeMap<i32, (Body, BTreeMap<i32, usize>)> = BTreeMap::new();
    let (mut start, mut skipped) = (0, 0);
    for (face, &end) in data.polygons.offsets.iter().enumerate() {
        let end = usize::try_from(end).unwrap_or(start);
        let polygon = data
            .polygons
            .connectivity
            .get(start..end)
            .unwrap_or_default();
        start = end.max(start);
        let id = match ids {
            Some(Values::I32(values)) => values.get(face).copied().unwrap_or_default(),
            _ => 0,
        };
        let corner = |&i: &i32| {
            let point = data.points.get(usize::try_from(i).ok()?)?;
            point
                .iter()
                .all(|x| x.is_finite())
                .then(|| Vector3::from(point.map(f64::from)))
        };
        let Some(corners) = polygon.iter().map(corner).collect::<Option<Vec<_>>>() else {
            skipped += 1;
            continue;
        };
        let (body, numbers) = bodies.entry(id).or_default();
        body.id = id;
        let numbered = polygon.iter().zip(corners).map(|(&i, corner)| {
            *numbers.entry(i).or_insert_with(|| {
                body.corners.push(corner);
                body.corners.len() - 1
            })
        });
        let numbered = numbered.collect();
        body.faces.push(numbered);
    }
    (
        bodies.into_values().map(|(body, _)| body).collect(),
        skipped,
    )
}

impl Body {
    fn polygon(&self, face: &[usize]) -> Vec<Vector3<f64>> {
        face.iter().map(|&i| self.corners[i]).collect()
    }

    /// The faces as polygons.
    pub fn polygons(&self) -> impl Iterator<Item = Vec<Vector3<f64>>> + '_ {
        self.faces.iter().map(|face| self.polygon(face))
    }

    /// The faces, with a normal at each corner: the mean over the faces there, by area, but for those beyond a sharp crease.
    fn rounded(&self) -> Vec<RoundFace> {
        let areas: Vec<_> = self.polygons().map(|p| area_vector(&p)).collect();
        let mut faces_at = vec![Vec::new(); self.corners.len()];
        for (face, corners) in self.faces.iter().enumerate() {
            for &corner in corners {
                faces_at[corner].push(face);
            }
        }
        let normal = |face: usize, corner: usize| {
            let own = areas[face];
            let near = faces_at[corner].iter().map(|&other| areas[other]);
            let alike = near.filter(|area| ROUND * own.norm() * area.norm() <= own.dot(area));
            alike.sum::<Vector3<f64>>().normalize()
        };
        (self.faces.iter().enumerate())
            .filter(|&(face, _)| 0.0 < areas[face].norm())
            .map(|(face, corners)| RoundFace {
                corners: self.polygon(corners),
                normals: corners.iter().map(|&c| normal(face, c)).collect(),
            })
            .collect()
    }

    /// Rotation and translation that move `reference`, the same body at another time, onto this one.
    /// `None` when the two have different corners or all corners are collinear.
    pub fn motion_from(&self, reference: &Self) -> Option<(Matrix3<f64>, Vector3<f64>)> {
        if self.corners.len() != reference.corners.len() {
            return None;
        }
        let points = &reference.corners;
        let a = 0;
        let farthest = |measure: &dyn Fn(&Vector3<f64>) -> f64| {
            (0..points.len()).max_by(|&i, &j| measure(&points[i]).total_cmp(&measure(&points[j])))
        };
        let b = farthest(&|p| (p - points[a]).norm())?;
        let along = (points[b] - points[a]).try_normalize(0.0)?;
        let c = farthest(&|p| (p - points[a]).cross(&along).norm())?;
        let frame = |p: &[Vector3<f64>]| {
            let e1 = (p[b] - p[a]).try_normalize(0.0)?;
            let e3 = e1.cross(&(p[c] - p[a])).try_normalize(0.0)?;
            Some(Matrix3::from_columns(&[e1, e3.cross(&e1), e3]))
        };
        let rotation = frame(&self.corners)? * frame(points)?.transpose();
        Some((rotation, self.corners[a] - rotation * points[a]))
    }
}

/// A face with a normal at each corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RoundFace {
    /// m.
    pub corners: Vec<Vector3<f64>>,
    /// Unit vectors.
    pub normals: Vec<Vector3<f64>>,
}

/// Fixed bodies cut open toward the camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Stage {
    /// Faces of walls that are drawn.
    pub drawn: Vec<Vec<Vector3<f64>>>,
    /// Faces of the terrain.
    pub terrain: Vec<RoundFace>,
    /// Faces that would hide the scene; only their outlines are drawn.
    pub cut: Vec<Vec<Vector3<f64>>>,
    /// Fraction of sampled lines of sight blocked by a wall.
    pub hidden_share: f64,
}

/// Selection of the drawn faces of fixed bodies.
///
/// 1. Faces that face away from the camera are omitted: in a closed body they are behind others, or they
///    are the inner sides of near walls.
/// 2. A face that blocks more than `HIDING_SHARE` of the lines of sight to `samples` (points of the
///    water and of the moving blocks over the whole run) is cut.
/// 3. Where the cut faces are most of the visible area of a body, its other faces (rim, ends)
///    are cut with them.
///
/// Terrain is drawn completely, since it casts shadows.
pub(crate) fn stage(fixed: &[Body], camera: &Camera, samples: &[[f32; 3]]) -> Stage {
    let rays: Vec<_> = samples
        .iter()
        .map(|p| Vector3::from(p.map(f64::from)))
        .map(|p| {
            let from = camera.ray_start(p);
            (from, p + SHORT_OF_END * (from - p))
        })
        .collect();
    let mut stage = Stage::default();
    let mut is_hidden = vec![false; rays.len()];
    for body in fixed {
        let (mut seen, mut cut) = (Vec::new(), Vec::new());
        for polygon in body.polygons().filter(|p| faces_eye(p, camera)) {
            let mut stopped = 0;
            for ((from, to), is_hidden) in rays.iter().zip(&mut is_hidden) {
                if crosses(&polygon, *from, *to) {
                    stopped += 1;
                    *is_hidden = true;
                }
            }
            if body.is_terrain {
                continue;
            }
            if HIDING_SHARE * rays.len() as f64 > f64::from(stopped) || stopped == 0 {
                seen.push(polygon);
            } else {
                cut.push(polygon);
            }
        }
        if body.is_terrain {
            stage.terrain.extend(body.rounded());
        }
        let area =
            |faces: &[Vec<Vector3<f64>>]| faces.iter().map(|f| area_vector(f).norm()).sum::<f64>();
        if area(&cut) <= area(&seen) {
            stage.drawn.append(&mut seen);
        }
        stage.cut.append(&mut cut);
    }
    let hidden = is_hidden.iter().filter(|&&h| h).count();
    stage.hidden_share = hidden as f64 / rays.len().max(1) as f64;
    stage
}

/// The ground from above, in squares.
pub(crate) struct GroundBelow<'a> {
    side: f64,
    /// Upward faces that reach into each square.
    squares: BTreeMap<[i64; 2], Vec<&'a [Vector3<f64>]>>,
}

/// The side from which the sun lights more of the terrain that the camera sees: 1 the viewer's right, -1 the left; 0 without
/// terrain.
pub(crate) fn sunny_side(terrain: &[RoundFace], camera: &Camera) -> f64 {
    let ahead = camera.axes().forward;
    let level = Vector3::new(ahead.x, ahead.y, 0.0).normalize();
    let right = level.cross(&Vector3::z());
    let seen = terrain.iter().map(|face| &face.corners);
    let areas: Vec<_> = (seen.filter(|face| faces_eye(face, camera)))
        .map(|face| area_vector(face))
        .collect();
    // as in scene.inc
    let lit = |side: f64| {
        let sun = -0.25 * level + 0.85 * side * right + 0.62 * Vector3::z();
        areas
            .iter()
            .map(|area| area.dot(&sun).max(0.0))
            .sum::<f64>()
    };
    match areas.is_empty() {
        true => 0.0,
        false if lit(-1.0) < lit(1.0) => 1.0,
        false => -1.0,
    }
}

impl<'a> GroundBelow<'a> {
    /// In squares of a side, m.
    pub fn new(terrain: &'a [RoundFace], side: f64) -> Self {
        let mut squares: BTreeMap<_, Vec<_>> = BTreeMap::new();
        let corners = terrain.iter().map(|face| face.corners.as_slice());
        for face in corners.filter(|face| 0.0 < area_vector(face).z) {
            let ends = |k: usize| {
                let along = || face.iter().map(move |p| p[k] / side);
                let (low, high) = (
                    along().fold(f64::MAX, f64::min),
                    along().fold(f64::MIN, f64::max),
                );
                low.floor() as i64..=high.floor() as i64
            };
            for (i, j) in ends(0).flat_map(|i| ends(1).map(move |j| (i, j))) {
                squares.entry([i, j]).or_default().push(face);
            }
        }
        Self { side, squares }
    }

    /// Whether a point is less than `reach` (m) above the ground, or below it.
    pub fn is_near(&self, point: &[f32; 3], reach: f64) -> bool {
        let x = Vector3::from(point.map(f64::from));
        let square = [x.x, x.y].map(|along| (along / self.side).floor() as i64);
        let faces = self.squares.get(&square).into_iter().flatten();
        let height = |face: &[Vector3<f64>]| {
            let (normal, first) = (area_vector(face), face[0]);
            let is_over = (0..face.len()).all(|i| {
                let (p, q) = (face[i], face[(i + 1) % face.len()]);
                (q - p).cross(&(x - p)).z >= 0.0
            });
            is_over.then(|| (x - first).dot(&normal) / normal.z)
        };
        faces
            .filter_map(|face| height(face))
            .any(|height| height < reach)
    }
}

/// Area times unit normal; m².
fn area_vector(polygon: &[Vector3<f64>]) -> Vector3<f64> {
    let Some(&first) = polygon.first() else {
        return Vector3::zeros();
    };
    let pairs = polygon.windows(2);
    0.5 * pairs
        .map(|w| (w[0] - first).cross(&(w[1] - first)))
        .sum::<Vector3<f64>>()
}

fn faces_eye(polygon: &[Vector3<f64>], camera: &Camera) -> bool {
    polygon
        .first()
        .is_some_and(|&p| area_vector(polygon).dot(&(camera.ray_start(p) - p)) > 0.0)
}

/// Whether the segment meets the convex polygon, short of its own end.
fn crosses(polygon: &[Vector3<f64>], from: Vector3<f64>, to: Vector3<f64>) -> bool {
    let normal = area_vector(polygon);
    let Some(&first) = polygon.first() else {
        return false;
    };
    let (a, b) = ((from - first).dot(&normal), (to - first).dot(&normal));
    if a * b >= 0.0 {
        return false;
    }
    let at = from + (to - from) * (a / (a - b));
    (0..polygon.len()).all(|i| {
        let (p, q) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        (q - p).cross(&(at - p)).dot(&normal) >= 0.0
    })
}

/// The part of a convex polygon that lies in a panel, where the panel is shown.
pub(crate) fn in_panel(polygon: &[Vector3<f64>], panel: &Panel) -> Vec<Vector3<f64>> {
    let from = clipped_polygon(polygon, |p| panel.from - p[panel.axis]);
    let both = clipped_polygon(&from, |p| p[panel.axis] - panel.to);
    both.iter().map(|p| p + panel.shift).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::vtk::{Array, Polygons};

    fn cuboid(min: [f64; 3], max: [f64; 3]) -> Body {
        let corner =
            |i: usize| Vector3::from_fn(|k, _| if i >> k & 1 == 1 { max[k] } else { min[k] });
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        Body {
            id: 0,
            corners: (0..8).map(corner).collect(),
            faces: faces.map(Vec::from).to_vec(),
            is_terrain: false,
        }
    }

    #[test]
    fn terrain_is_not_cut() {
        let samples = [[0.5_f32, 0.5, 0.5]];
        let near = Body {
            is_terrain: true,
            ..cuboid([-9.0, -0.1, -9.0], [9.0, 0.0, 9.0])
        };
        let camera = &Camera::fitted(&samples, 1.5)[0];
        let stage = stage(&[near], camera, &samples);
        assert!(stage.drawn.is_empty() && stage.cut.is_empty());
        assert_eq!(stage.terrain.len(), 6);
    }

    #[test]
    fn the_near_wall_is_cut_and_the_far_wall_and_floor_stay() {
        let samples: Vec<[f32; 3]> = (0..125)
            .map(|i| [i % 5, i / 5 % 5, i / 25].map(|m| 0.1 + 0.2 * m as f32))
            .collect();
        let near = cuboid([-0.1, -0.1, 0.0], [1.1, 0.0, 1.2]);
        let far = cuboid([-0.1, 1.0, 0.0], [1.1, 1.1, 1.2]);
        let floor = cuboid([0.0, 0.0, -0.1], [1.0, 1.0, 0.0]);
        let camera = &Camera::fitted(&samples, 1.5)[0];
        assert!(stage(&[near], camera, &samples).drawn.is_empty());
        for body in [far, floor] {
            let stage = stage(&[body], camera, &samples);
            assert!(stage.cut.is_empty());
            assert_eq!(stage.drawn.len(), 3);
        }
    }

    /// A roof of two faces at 90 degrees keeps its ridge, one at 20 degrees is drawn round.
    #[test]
    fn gentle_creases_are_round_and_sharp_ones_stay() {
        for (half_deg, is_round) in [(45.0_f64, false), (10.0, true)] {
            let drop = half_deg.to_radians().tan();
            let corners = [[-1.0, 0.0, -drop], [0.0, 0.0, 0.0], [1.0, 0.0, -drop]];
            let body = Body {
                corners: (corners.iter().chain(&corners).enumerate())
                    .map(|(k, &[x, y, z])| Vector3::new(x, y + if k < 3 { 0.0 } else { 1.0 }, z))
                    .collect(),
                faces: vec![vec![0, 1, 4, 3], vec![1, 2, 5, 4]],
                is_terrain: true,
                ..Body::default()
            };
            let ridge = body.rounded()[0].normals[1];
            assert_eq!(
                (ridge - Vector3::z()).norm() < 1e-12,
                is_round,
                "{half_deg}"
            );
        }
    }

    /// Seen from the south, a slope that falls to the east is lit from the right.
    #[test]
    fn the_sun_stands_where_the_slope_faces() {
        let samples = [[0.0_f32; 3], [4.0, 4.0, 2.0]];
        let camera = &Camera::fitted(&samples, 1.5)[0];
        for (west, east, side) in [(2.0, 0.0, 1.0), (0.0, 2.0, -1.0)] {
            let corners = [
                [0.0, 0.0, west],
                [4.0, 0.0, east],
                [4.0, 4.0, east],
                [0.0, 4.0, west],
            ];
            let slope = [RoundFace {
                corners: corners.map(Vector3::from).to_vec(),
                normals: Vec::new(),
            }];
            assert_eq!(sunny_side(&slope, camera), side);
        }
        assert_eq!(sunny_side(&[], camera), 0.0);
    }

    #[test]
    fn points_close_above_the_ground_are_known() {
        let slope = [
            [0.0, 0.0, 0.0],
            [4.0, 0.0, 2.0],
            [4.0, 4.0, 2.0],
            [0.0, 4.0, 0.0],
        ];
        let slope = [RoundFace {
            corners: slope.map(Vector3::from).to_vec(),
            normals: Vec::new(),
        }];
        let ground = GroundBelow::new(&slope, 0.7);
        let near = |p: [f32; 3]| ground.is_near(&p, 0.5);
        assert!(near([2.0, 1.0, 1.4]) && near([2.0, 1.0, 0.3]));
        assert!(!near([2.0, 1.0, 1.6]) && !near([5.0, 1.0, 1.0]));
    }

    #[test]
    fn a_motion_carries_every_corner() {
        let reference = cuboid([0.0; 3], [1.0, 2.0, 3.0]);
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -1.2, 2.0);
        let mut moved = reference.clone();
        for corner in &mut moved.corners {
            *corner = turn * *corner + Vector3::new(5.0, -3.0, 1.0);
        }
        let Some((rotation, shift)) = moved.motion_from(&reference) else {
            unreachable!("a cuboid spans space");
        };
        for (p, q) in reference.corners.iter().zip(&moved.corners) {
            assert!((rotation * p + shift - q).norm() < 1e-12);
        }
    }

    #[test]
    fn a_strip_keeps_its_share_of_a_face() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]];
        let square = square.map(|[x, y]| Vector3::new(x, y, 0.0));
        let panel = Panel {
            axis: 0,
            from: 1.0,
            to: 2.5,
            shift: Vector3::zeros(),
        };
        assert!((area_vector(&in_panel(&square, &panel)).norm() - 1.5).abs() < 1e-12);
    }

    #[test]
    fn a_face_with_nan_is_skipped_and_counted() {
        let data = PolyData {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f32::NAN; 3]],
            polygons: Polygons {
                connectivity: vec![0, 1, 2, 0, 1, 3],
                offsets: vec![3, 6],
            },
            cell_data: vec![Array {
                name: "BlockId".to_owned(),
                components: 1,
                values: Values::I32(vec![7, 7]),
            }],
            ..PolyData::default()
        };
        let (bodies, skipped) = bodies(&data);
        assert_eq!(
            (bodies.len(), bodies[0].id, bodies[0].faces.len(), skipped),
            (1, 7, 1, 1)
        );
    }
}
