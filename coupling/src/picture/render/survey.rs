//! First pass over the whole run, for a common camera, color range and set of cut walls in all frames.

use super::body::{Body, Stage, stage};
use super::camera::{Camera, Lens, bounds};
use super::pov::Setting;
use super::recording::Recording;
use super::{RenderError, RenderOptions};
use crate::output::run_folder;
use crate::picture::color::ColorMap;
use nalgebra::Vector3;
use std::path::Path;

/// Sampled frames; more make no visible difference.
const FRAMES: usize = 16;
/// Sampled particles per frame.
const POINTS: usize = 6000;
/// Lines of sight for the selection of cut walls.
const RAYS: usize = 600;
/// Fraction of particles faster than the upper end of the color range, so that a few drops of spray do not
/// darken the rest.
const FASTEST: f64 = 0.002;

/// Quantities shared by all frames.
pub(crate) struct Survey {
    pub camera: Camera,
    pub stage: Stage,
    pub reference: Vec<Body>,
    pub size: f64,
    pub clear: f64,
    pub ground: f64,
    pub spacing: f64,
    pub speed_range: f64,
    /// Elevations of the water, but for a few drops; m.
    pub elevations: [f64; 2],
    pub colors: ColorMap,
    /// Report to the user.
    pub description: String,
}

impl Survey {
    /// Declarations for the frames.
    pub fn setting<'a>(&'a self, title: &'a str) -> Setting<'a> {
        let Self {
            camera,
            stage,
            reference,
            size,
            clear,
            ground,
            spacing,
            speed_range,
            colors,
            ..
        } = self;
        Setting {
            title,
            camera,
            stage,
            reference,
            size: *size,
            clear: *clear,
            ground: *ground,
            spacing: *spacing,
            speed_range: *speed_range,
            colors: *colors,
        }
    }
}

/// Samples the chosen frames, including the first and the last.
pub(crate) fn survey(
    run: &Recording,
    folder: &Path,
    numbers: &[usize],
    options: &RenderOptions,
) -> Result<Survey, RenderError> {
    let mut samples = Vec::new();
    let (mut speeds, mut heights) = (Vec::new(), Vec::new());
    let mut depth = None;
    let mut spacing = run.spacing;
    let looked_at = evenly(numbers, FRAMES);
    for &&number in &looked_at {
        let cloud = run.cloud(number)?;
        if spacing.is_none() {
            spacing = guessed_spacing(&cloud.points);
        }
        depth = depth.or_else(|| bounds(&cloud.points).map(|(low, high)| (high - low).z));
        heights.extend(evenly(&cloud.points, POINTS).into_iter().map(|p| p[2]));
        samples.extend(evenly(&cloud.points, POINTS).into_iter().copied());
        speeds.extend(cloud.speeds.unwrap_or_default());
        let time = run.frames().get(number).map_or(0.0, |f| f.time);
        let (bodies, _) = run.blocks_at(time)?;
        let corners = bodies.iter().flat_map(|b| &b.corners);
        samples.extend(corners.map(|p| [p.x as f32, p.y as f32, p.z as f32]));
    }
    let reference = run.blocks_at(f64::NEG_INFINITY)?.0;
    let aspect = f64::from(options.size.0) / f64::from(options.size.1);
    let rays: Vec<[f32; 3]> = evenly(&samples, RAYS).into_iter().copied().collect();
    let (camera, stage) =
        eye(run, folder, &samples, &rays, aspect)?.ok_or(RenderError::NothingToSee {
            frames: looked_at.len(),
            folder: folder.to_owned(),
        })?;

    let (low, high) = bounds(&samples).unwrap_or((camera.look_at, camera.look_at));
    // Along strips only the length of one counts: colors and lines depend on the picture.
    let size = match &camera.lens {
        Lens::Perspective { .. } => (high - low).norm(),
        Lens::Strips { width, .. } => *width,
    };
    let lake = depth.filter(|_| !stage.terrain.is_empty());
    let clear = clear_length(&camera, high - low, size, lake);
    let size = if 0.0 < size {
        size
    } else {
        (camera.look_at - camera.eye).norm()
    };
    let spacing = spacing.unwrap_or(0.01 * size);
    let terrain = stage.terrain.iter().map(|face| &face.corners);
    let drawn = stage.drawn.iter().chain(terrain).flatten().map(|p| p.z);
    let ground = drawn.fold(low.z - 0.5 * spacing, f64::min);
    let speed_range = upper_end(&mut speeds);
    let view = match &camera.lens {
        Lens::Perspective { .. } => "one view".to_owned(),
        Lens::Strips { panels, .. } => format!("{} strips, top to bottom", panels.len()),
    };
    let description = format!(
        "{view}; camera at {}; {} wall faces cut away; particle spacing {spacing:.4} m; colors 0 to {speed_range} m/s",
        place(camera.eye),
        stage.cut.len(),
    );
    Ok(Survey {
        camera,
        stage,
        reference,
        size,
        clear,
        ground,
        spacing,
        speed_range,
        elevations: most_of(&mut heights),
        colors: options.colors,
        description,
    })
}

/// Length of water that light passes; m. Strips are viewed through the slab, other scenes through a fraction of their
/// size, or through the slab if that is thinner: otherwise its water would look like a pane of glass.
fn clear_length(camera: &Camera, extent: Vector3<f64>, size: f64, lake: Option<f64>) -> f64 {
    match camera.panels().first() {
        Some(panel) if panel.shift.norm() > 0.0 => 0.9 * extent[1 - panel.axis],
        _ => {
            let thinnest = extent.xy().min().max(1e-3 * size);
            // the bed of a lake need not be visible, its waves must be
            let depth = lake.unwrap_or(size);
            (0.1 * size).min(0.9 * thinnest).min(0.5 * depth)
        }
    }
}

/// The scene's own camera, or the fitted one from which walls hide least.
fn eye(
    run: &Recording,
    folder: &Path,
    samples: &[[f32; 3]],
    rays: &[[f32; 3]],
    aspect: f64,
) -> Result<Option<(Camera, Stage)>, RenderError> {
    let cameras = match &run.scene.camera {
        Some(file) => {
            let camera = Camera::from_scene(file, aspect);
            let angle = file.field_of_view_deg;
            let apart = (camera.look_at - camera.eye).norm();
            if !(apart.is_finite() && 0.0 < apart && 0.0 < angle && angle < 180.0) {
                return Err(RenderError::BadCamera {
                    path: folder.join(run_folder::CASE),
                });
            }
            vec![camera]
        }
        None => Camera::fitted(samples, aspect),
    };
    let staged = cameras.into_iter().map(|camera| {
        let stage = stage(&run.fixed, &camera, rays);
        (camera, stage)
    });
    Ok(staged.min_by(|(_, a), (_, b)| a.hidden_share.total_cmp(&b.hidden_share)))
}

/// At most `n` items, evenly spread, first and last included.
fn evenly<T>(items: &[T], n: usize) -> Vec<&T> {
    if items.len() <= n {
        return items.iter().collect();
    }
    (0..n)
        .filter_map(|i| items.get(i * (items.len() - 1) / (n - 1)))
        .collect()
}

/// Particle spacing from the particles themselves: the median distance to the nearest neighbor of a
/// few; m.
fn guessed_spacing(points: &[[f32; 3]]) -> Option<f64> {
    let nearest = |p: &[f32; 3]| {
        let squares = points
            .iter()
            .map(|q| (0..3).map(|k| f64::from(p[k] - q[k]).powi(2)).sum::<f64>());
        squares
            .filter(|&d| 0.0 < d)
            .min_by(f64::total_cmp)
            .map(f64::sqrt)
    };
    let mut distances: Vec<f64> = evenly(points, 101)
        .into_iter()
        .filter_map(nearest)
        .collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied()
}

/// Range of all but a few heights; 0 to 1 without any; m.
fn most_of(heights: &mut [f32]) -> [f64; 2] {
    heights.sort_by(f32::total_cmp);
    let few = (FASTEST * heights.len() as f64) as usize;
    let last = heights.len().saturating_sub(1 + few);
    match (heights.get(few), heights.get(last)) {
        (Some(low), Some(high)) if low < high => [f64::from(*low), f64::from(*high)],
        _ => [0.0, 1.0],
    }
}

/// Round number exceeded by few speeds; m/s.
pub(crate) fn upper_end(speeds: &mut [f32]) -> f64 {
    speeds.sort_by(f32::total_cmp);
    let at = ((1.0 - FASTEST) * speeds.len() as f64) as usize;
    let fast = speeds
        .get(at.min(speeds.len().saturating_sub(1)))
        .copied()
        .unwrap_or(0.0);
    if fast <= 0.0 {
        return 1.0;
    }
    let decade = 10_f64.powf(f64::from(fast).log10().floor());
    let steps = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    // Rounded once more: 3 · 0.1 is not 0.3 and would be printed.
    let round = |x: f64| (x * 1e6).round() / 1e6;
    steps
        .map(|s| round(s * decade))
        .into_iter()
        .find(|&x| f64::from(fast) <= x)
        .unwrap_or(round(10.0 * decade))
}

fn place(v: Vector3<f64>) -> String {
    format!("({:.3}, {:.3}, {:.3}) m", v.x, v.y, v.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_upper_end_is_round_and_no_less() {
        for (fast, end) in [(0.23, 0.3), (1.0, 1.0), (3.1, 4.0), (9.4, 10.0), (0.0, 1.0)] {
            assert!((upper_end(&mut [fast]) - end).abs() < 1e-12, "{fast}");
        }
    }

    #[test]
    fn even_choices_have_both_ends() {
        let items: Vec<usize> = (0..100).collect();
        let chosen = evenly(&items, 7);
        assert_eq!((chosen.len(), chosen[0], chosen[6]), (7, &0, &99));
    }
}
