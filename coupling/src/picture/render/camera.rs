//! Camera of a scene, and layout of a long flume.
//!
//! A compact scene is shown in perspective, obliquely from above. A flume 170 m long and 5 m
//! deep would be a line of 28 pixels; it is cut into consecutive strips of equal length
//! instead, stacked from top to bottom like lines of text, at a common scale and undistorted.

use crate::scene::resolved::recording::Viewpoint;
use nalgebra::Vector3;

/// Elevation of a fitted camera; degrees.
const ELEVATION_DEG: f64 = 22.0;
/// Rotation of a fitted camera from the perpendicular to the long side; degrees.
const TURN_DEG: f64 = 28.0;
/// Horizontal angle of view of a fitted camera; degrees. Narrow enough that parallel lines look parallel.
const FIELD_OF_VIEW_DEG: f64 = 30.0;
/// Ratio of width to height below which a scene is a section, seen straight across.
const THIN: f64 = 0.2;
/// Elevation of the camera over a section: the edge of the floor just shows; degrees.
const SECTION_ELEVATION_DEG: f64 = 4.0;
/// Elevation of the camera over strips; degrees. Low, since a strip shows a section.
const STRIP_ELEVATION_DEG: f64 = 9.0;
/// Largest fraction of the picture filled by a fitted scene.
const FILL: f64 = 0.88;
/// Ratio of length to height and width above which a scene is cut into strips.
const LONG: f64 = 10.0;
/// Free fraction of a strip's height, for its label and as a margin.
const STRIP_GAP: f64 = 0.3;
/// Fraction of the picture above strips reserved for time and color bar.
const HEADING: f64 = 0.07;

/// A camera and its projection.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Position; m.
    pub eye: Vector3<f64>,
    /// Target point; m.
    pub look_at: Vector3<f64>,
    /// Projection.
    pub lens: Lens,
    /// Width over height of the picture.
    pub aspect: f64,
}

/// Projection of a camera.
#[derive(Clone, Debug, PartialEq)]
pub enum Lens {
    /// Perspective.
    Perspective {
        /// Horizontal angle of view; degrees.
        field_of_view_deg: f64,
    },
    /// Parallel rays, and the scene cut into strips.
    Strips {
        /// Width of the picture; m.
        width: f64,
        /// Top to bottom; at least one.
        panels: Vec<Panel>,
        /// Label of each panel.
        labels: Vec<String>,
        /// Height of a strip in the picture; m.
        tall: f64,
    },
}

/// A piece of the scene, and its position in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// Axis along which the scene is cut: 0 or 1.
    pub axis: usize,
    /// Start of the piece along the axis; m.
    pub from: f64,
    /// End of the piece; m.
    pub to: f64,
    /// Shift from its position in the scene to that in the picture; m.
    pub shift: Vector3<f64>,
}

impl Panel {
    /// The whole scene, without shift.
    pub const WHOLE: Self = Self {
        axis: 0,
        from: f64::NEG_INFINITY,
        to: f64::INFINITY,
        shift: Vector3::new(0.0, 0.0, 0.0),
    };

    /// Whether the piece contains the point.
    pub fn contains(&self, point: &[f32; 3]) -> bool {
        let x = f64::from(point[self.axis]);
        self.from <= x && x < self.to
    }
}

/// Camera axes in the world: rightward and upward in the picture, and into it; unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Rightward.
    pub right: Vector3<f64>,
    /// Upward.
    pub up: Vector3<f64>,
    /// From the camera into the picture.
    pub forward: Vector3<f64>,
}

impl Axes {
    /// Looking along `forward`, z up as far as possible.
    pub fn looking(forward: Vector3<f64>) -> Self {
        let forward = forward.normalize();
        // Vertically down, z does not define an upward direction: +y is up then, as on a map.
        let sky = if forward.z.abs() < 0.9999 {
            Vector3::z()
        } else {
            Vector3::y()
        };
        let right = forward.cross(&sky).normalize();
        Self {
            right,
            up: right.cross(&forward),
            forward,
        }
    }
}

impl Camera {
    /// The camera given by a scene.
    pub fn from_scene(camera: &Viewpoint, aspect: f64) -> Self {
        Self {
            eye: camera.position,
            look_at: camera.look_at,
            lens: Lens::Perspective {
                field_of_view_deg: camera.field_of_view_deg,
            },
            aspect,
        }
    }

    /// Two cameras with all of `points` in view, rotated toward either end of the scene; one for a long scene and for a
    /// thin one. The choice depends on the walls in the line of sight. Empty without points.
    pub fn fitted(points: &[[f32; 3]], aspect: f64) -> Vec<Self> {
        let Some((low, high)) = bounds(points) else {
            return Vec::new();
        };
        let extent = high - low;
        let long = usize::from(extent.x < extent.y);
        // Perpendicular to the long side, with the long axis to the right: from -y, or from +x.
        let square_deg = if long == 0 { -90.0 } else { 0.0 };
        if extent[long] > LONG * extent.z.max(extent[1 - long]) {
            return vec![strips(low, high, long, square_deg, aspect)];
        }
        if extent[1 - long] < THIN * extent.z {
            return vec![perspective(
                points,
                (square_deg, SECTION_ELEVATION_DEG),
                aspect,
            )];
        }
        [TURN_DEG, -TURN_DEG]
            .map(|turn| perspective(points, (square_deg + turn, ELEVATION_DEG), aspect))
            .to_vec()
    }

    /// Axes of the picture.
    pub fn axes(&self) -> Axes {
        Axes::looking(self.look_at - self.eye)
    }

    /// Panels of the picture.
    pub fn panels(&self) -> &[Panel] {
        match &self.lens {
            Lens::Perspective { .. } => &[Panel::WHOLE],
            Lens::Strips { panels, .. } => panels,
        }
    }

    /// Labels of the strips and their positions in the picture.
    pub fn strip_labels(&self) -> Vec<(String, (f64, f64))> {
        let Lens::Strips {
            width,
            panels,
            labels,
            tall,
        } = &self.lens
        else {
            return Vec::new();
        };
        let up = self.axes().up;
        let height =
            |panel: &Panel| (panel.shift.dot(&up) + 0.43 * tall) / (0.5 * width) * self.aspect;
        let places = panels.iter().map(|panel| (0.6, height(panel)));
        labels.iter().cloned().zip(places).collect()
    }

    /// Start of the line of sight that ends in `point`, before panels are shifted; m.
    pub fn ray_start(&self, point: Vector3<f64>) -> Vector3<f64> {
        match self.lens {
            Lens::Perspective { .. } => self.eye,
            Lens::Strips { width, .. } => point - self.axes().forward * (10.0 * width),
        }
    }

    /// Position of a (shifted) point in the picture: -1 to 1 from left to right and from bottom to
    /// top; `None` behind the camera.
    pub fn project(&self, point: Vector3<f64>) -> Option<(f64, f64)> {
        let axes = self.axes();
        let to_point = point - self.eye;
        let depth = to_point.dot(&axes.forward);
        let half_width = match self.lens {
            Lens::Perspective { field_of_view_deg } => {
                depth * (0.5 * field_of_view_deg.to_radians()).tan()
            }
            Lens::Strips { width, .. } => 0.5 * width,
        };
        (0.0 < depth).then(|| {
            let right = to_point.dot(&axes.right) / half_width;
            (right, to_point.dot(&axes.up) / half_width * self.aspect)
        })
    }
}

/// Direction from the scene to a camera.
fn direction(azimuth_deg: f64, elevation_deg: f64) -> Vector3<f64> {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    Vector3::new(
        elevation.cos() * azimuth.cos(),
        elevation.cos() * azimuth.sin(),
        elevation.sin(),
    )
}

/// The nearest camera in a direction with all points within `FILL` of the picture.
///
/// Four planes bound the view. Along the picture's x, with t = tan(angle/2), a point at (x, depth)
/// from the target is inside when |x - x_eye| <= t (depth + distance): the two extremes of
/// x ± t depth determine the camera's x and its distance. Likewise for y; the larger distance governs.
fn perspective(
    points: &[[f32; 3]],
    (azimuth_deg, elevation_deg): (f64, f64),
    aspect: f64,
) -> Camera {
    let axes = Axes::looking(-direction(azimuth_deg, elevation_deg));
    let tan_x = FILL * (0.5 * FIELD_OF_VIEW_DEG.to_radians()).tan();
    let fit = |axis: Vector3<f64>, tan: f64| {
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in points {
            let p = Vector3::from(p.map(f64::from));
            let (x, depth) = (p.dot(&axis), p.dot(&axes.forward));
            least = least.min(x + tan * depth);
            most = most.max(x - tan * depth);
        }
        // least = x_eye - tan d and most = x_eye + tan d, where d is the distance of the camera.
        (0.5 * (least + most), 0.5 * (most - least) / tan)
    };
    let (x, back_x) = fit(axes.right, tan_x);
    let (y, back_y) = fit(axes.up, tan_x / aspect);
    let back = back_x.max(back_y);
    let eye = axes.right * x + axes.up * y - axes.forward * back;
    // Any point ahead is a valid target; the scene's own depth keeps the numbers readable.
    let depth = points
        .iter()
        .map(|p| Vector3::from(p.map(f64::from)).dot(&axes.forward) + back)
        .sum::<f64>()
        / points.len() as f64;
    Camera {
        eye,
        look_at: eye + axes.forward * depth,
        lens: Lens::Perspective {
            field_of_view_deg: FIELD_OF_VIEW_DEG,
        },
        aspect,
    }
}

/// A long scene as strips, in the number that maximizes its scale.
fn strips(
    low: Vector3<f64>,
    high: Vector3<f64>,
    long: usize,
    azimuth_deg: f64,
    aspect: f64,
) -> Camera {
    let axes = Axes::looking(-direction(azimuth_deg, STRIP_ELEVATION_DEG));
    let extent = high - low;
    let depth = extent[1 - long];
    let tall = extent.z * axes.up.z.abs() + depth * axes.forward.z.abs();
    let pitch = tall * (1.0 + STRIP_GAP);
    // Width of a picture with n strips: that of a strip or that required by its height.
    let width_of = |n: usize| {
        (extent[long] / n as f64 / FILL).max(n as f64 * pitch / (FILL - HEADING) * aspect)
    };
    let count = (1..=24)
        .min_by(|&a, &b| width_of(a).total_cmp(&width_of(b)))
        .unwrap_or(1);
    let (length, width) = (extent[long] / count as f64, width_of(count));

    // Strips are behind one another, too far for shadows to reach the next one. Parallel
    // rays do not show the distance.
    let apart = axes.forward * (4.0 * width);
    let panels = (0..count).map(|i| {
        let from = low[long] + i as f64 * length;
        let down = (i as f64 - 0.5 * (count as f64 - 1.0)) * pitch + HEADING * width / aspect;
        let mut shift = apart * i as f64 - axes.up * down;
        shift[long] -= from + 0.5 * length - 0.5 * (low[long] + high[long]);
        // The outermost strips include points beyond the sampled bounds.
        let to = if i + 1 == count {
            f64::INFINITY
        } else {
            from + length
        };
        let from = if i == 0 { f64::NEG_INFINITY } else { from };
        Panel {
            axis: long,
            from,
            to,
            shift,
        }
    });
    let panels = panels.collect();
    let name = if long == 0 { "x" } else { "y" };
    let label = |i: usize| {
        let from = low[long] + i as f64 * length;
        format!("{name} = {from:.1} ... {:.1} m", from + length)
    };
    let look_at = 0.5 * (low + high);
    Camera {
        eye: look_at - axes.forward * (4.0 * width),
        look_at,
        lens: Lens::Strips {
            width,
            panels,
            labels: (0..count).map(label).collect(),
            tall,
        },
        aspect,
    }
}

/// Lower and upper corner.
pub(crate) fn bounds(points: &[[f32; 3]]) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let mut vectors = points.iter().map(|p| Vector3::from(p.map(f64::from)));
    let first = vectors.next()?;
    Some(vectors.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(size: [f32; 3]) -> Vec<[f32; 3]> {
        (0..8)
            .map(|i| std::array::from_fn(|k| if i >> k & 1 == 1 { size[k] } else { 0.0 }))
            .collect()
    }

    #[test]
    fn a_fitted_eye_sees_every_point_and_fills_one_direction() {
        for size in [[2.0, 1.0, 1.0], [1.0, 3.0, 0.5], [1.0, 1.0, 6.0]] {
            for camera in Camera::fitted(&corners(size), 16.0 / 9.0) {
                let seen: Vec<_> = corners(size)
                    .iter()
                    .filter_map(|p| camera.project(Vector3::from(p.map(f64::from))))
                    .collect();
                assert_eq!(seen.len(), 8);
                let reach = seen
                    .iter()
                    .map(|(u, v)| u.abs().max(v.abs()))
                    .fold(0.0, f64::max);
                assert!((reach - FILL).abs() < 1e-9, "{size:?}: {reach}");
            }
        }
    }

    #[test]
    fn plus_x_is_right_and_plus_z_is_up() {
        let camera = Viewpoint {
            position: Vector3::new(0.0, -5.0, 0.0),
            look_at: Vector3::zeros(),
            field_of_view_deg: 90.0,
        };
        let camera = Camera::from_scene(&camera, 2.0);
        let (u, v) = camera
            .project(Vector3::new(1.0, 0.0, 0.5))
            .unwrap_or((0.0, 0.0));
        // tan 45° · 5 m is the half width.
        assert!((u - 0.2).abs() < 1e-12 && (v - 0.2).abs() < 1e-12);
        assert_eq!(camera.project(Vector3::new(0.0, -6.0, 0.0)), None);
    }

    #[test]
    fn a_long_flume_is_cut_into_strips_that_miss_nothing_and_fit() {
        let flume = [170.0, 0.7, 5.0];
        let cameras = Camera::fitted(&corners(flume), 16.0 / 9.0);
        let [camera] = cameras.as_slice() else {
            unreachable!("one way to look at a flume");
        };
        let panels = camera.panels();
        assert!(2 < panels.len(), "{}", panels.len());
        for i in 0..=170 {
            let point = [i as f32, 0.3, 2.0];
            let on: Vec<_> = panels.iter().filter(|p| p.contains(&point)).collect();
            assert_eq!(on.len(), 1);
            let shown = Vector3::from(point.map(f64::from)) + on[0].shift;
            let (u, v) = camera.project(shown).unwrap_or((9.0, 9.0));
            assert!(u.abs() < 0.95 && v.abs() < 0.95, "{i}: {u} {v}");
        }
    }
}
