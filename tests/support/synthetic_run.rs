//! Run folders made up from formulas: what `riprap run` leaves behind, without a run.

use riprap::vtk::{self, Array, Collection, PolyData, Polygons, Values};
use std::error::Error;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

pub type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A made-up experiment.
pub struct Experiment {
    /// Length, width and height of the water; m.
    pub water: [f64; 3],
    /// Distance of particles; m.
    pub spacing: f64,
    /// Height of the surface over rest, at x and t; m.
    pub surface: fn(f64, f64) -> f64,
    /// Corners of fixed boxes, and legs of a wedge whose right angle is at the origin.
    pub walls: Vec<[[f64; 3]; 2]>,
    pub wedge: [f64; 3],
    /// Edge and position of the block's center over time; m.
    pub block: f64,
    pub path: fn(f64) -> [f64; 3],
    pub times: Vec<f64>,
}

/// A tank a meter long: water sloshing over a slope, a block tumbling in.
pub fn tank(spacing: f64) -> Experiment {
    let (l, w, h, d) = (1.2, 0.6, 0.55, 0.03);
    Experiment {
        water: [l, w, 0.3],
        spacing,
        surface: |x, t| {
            let slosh = 0.07 * (PI * x / 1.2).cos() * (5.0 * t).cos();
            slosh + 0.02 * (9.0 * x - 7.0 * t).sin()
        },
        walls: vec![
            [[-d, -d, -d], [l + d, w + d, 0.0]],
            [[-d, -d, 0.0], [l + d, 0.0, h]],
            [[-d, w, 0.0], [l + d, w + d, h]],
            [[-d, 0.0, 0.0], [0.0, w, h]],
            [[l, 0.0, 0.0], [l + d, w, h]],
        ],
        wedge: [0.45, w, 0.45],
        block: 0.16,
        path: |t| [0.30 + 0.25 * t, 0.3, 0.42 - 0.22 * t],
        times: (0..5).map(|i| 0.2 * i as f64).collect(),
    }
}

/// A slab of a flume 170 m long: a bore runs from the slope at the left end.
pub fn flume(spacing: f64) -> Experiment {
    Experiment {
        water: [170.0, 0.7, 4.0],
        spacing,
        surface: |x, t| {
            let s = (x - 30.0 - 6.5 * t) / 6.0;
            0.9 / s.cosh().powi(2) - 0.25 * (-((x - 18.0 - 5.0 * t) / 5.0).powi(2)).exp()
        },
        walls: vec![[[0.0, 0.0, -0.5], [170.0, 0.7, 0.0]]],
        wedge: [12.0, 0.7, 6.0],
        block: 1.6,
        path: |t| [6.0 + 1.2 * t, 0.35, 3.9 - 0.6 * t],
        times: vec![0.0, 2.0, 4.0],
    }
}

/// Writes the folder. Of the first frame's points, `spoiled` are made NaN.
pub fn write(folder: &Path, experiment: &Experiment, camera: &str, spoiled: usize) -> Result<()> {
    fs::create_dir_all(folder)?;
    let Experiment { spacing, .. } = experiment;
    let case = format!(
        "(title: \"synthetic \\\"run\\\"\", domain: (min: (-9, -9, -9), max: (200, 9, 9)),\n\
         fluid: (dynamic_viscosity: 0.001, resolution: Spacing({spacing}), regions: []),\n\
         time: (duration: 1.0), {camera})\n"
    );
    fs::write(folder.join("case.ron"), case)?;
    fs::write(
        folder.join("summary.json"),
        format!("{{\"particle_spacing\": {spacing}}}"),
    )?;
    let (mut water, mut blocks) = (
        Collection::new(folder, "water"),
        Collection::new(folder, "blocks"),
    );
    for (i, &time) in experiment.times.iter().enumerate() {
        let mut cloud = particles(experiment, time);
        let bad = if i == 0 { spoiled } else { 0 };
        cloud
            .points
            .iter_mut()
            .take(bad)
            .for_each(|p| p[0] = f32::NAN);
        let name = format!("water_{i:05}.vtp");
        vtk::write(&folder.join(&name), &cloud)?;
        water.push(time, name)?;
        let name = format!("blocks_{i:05}.vtp");
        vtk::write(&folder.join(&name), &block(experiment, time))?;
        blocks.push(time, name)?;
    }
    vtk::write(&folder.join("fixed_blocks.vtp"), &fixed(experiment))?;
    Ok(())
}

/// Numbers between -0.5 and 0.5 that look random.
fn jitter(n: usize) -> f64 {
    (n as f64 * 12.9898).sin().mul_add(43_758.545, 0.0).fract() * 0.5
}

fn particles(experiment: &Experiment, time: f64) -> PolyData {
    let Experiment {
        water: [l, w, depth],
        spacing: s,
        surface,
        wedge,
        ..
    } = experiment;
    let cells = |x: f64| (x / s).round() as usize;
    let (mut points, mut velocity): (Vec<[f32; 3]>, Vec<f32>) = (Vec::new(), Vec::new());
    for n in 0..cells(*l) * cells(*w) {
        let [x, y] = [n % cells(*l), n / cells(*l)].map(|m| (m as f64 + 0.5) * s);
        // Columns are stretched to the surface, so that it has no steps.
        let height = depth + surface(x, time);
        let layers = cells(height);
        for k in 0..layers {
            let z = (k as f64 + 0.5) * height / layers as f64;
            if (x - s) / wedge[0] + z / wedge[2] < 1.0 {
                continue;
            }
            let shake = |i| 0.25 * s * jitter(97 * n + 3 * k + i);
            points.push([
                (x + shake(0)) as f32,
                (y + shake(1)) as f32,
                (z + shake(2)) as f32,
            ]);
            let rise = (surface(x, time + 1e-3) - surface(x, time)) / 1e-3;
            velocity.extend([0.4 * rise, 0.0, rise * z / depth].map(|v| v as f32));
        }
    }
    // Spray that no surface should be drawn around.
    for i in 0..12 {
        let at = i as f64 / 12.0;
        points.push([
            (l * (0.4 + 0.2 * at)) as f32,
            (w * at) as f32,
            (depth * (1.3 + 0.2 * jitter(i))) as f32,
        ]);
        velocity.extend([0.5, 0.0, 1.0]);
    }
    PolyData {
        points,
        point_data: vec![Array {
            name: "Velocity".into(),
            components: 3,
            values: Values::F32(velocity),
        }],
        time,
        ..PolyData::default()
    }
}

/// Collects polygons of several blocks.
#[derive(Default)]
struct Mesh {
    points: Vec<[f32; 3]>,
    polygons: Polygons,
    ids: Vec<i32>,
}

impl Mesh {
    fn add(&mut self, id: i32, corners: &[[f64; 3]], faces: &[&[i32]]) {
        let first = self.points.len() as i32;
        self.points
            .extend(corners.iter().map(|c| c.map(|x| x as f32)));
        for face in faces {
            self.polygons
                .connectivity
                .extend(face.iter().map(|i| first + i));
            self.polygons
                .offsets
                .push(self.polygons.connectivity.len() as i32);
            self.ids.push(id);
        }
    }

    fn finish(self, time: f64) -> PolyData {
        let ids = Array {
            name: "BlockId".into(),
            components: 1,
            values: Values::I32(self.ids),
        };
        PolyData {
            points: self.points,
            polygons: self.polygons,
            cell_data: vec![ids],
            time,
            ..PolyData::default()
        }
    }
}

const BOX: [&[i32]; 6] = [
    &[0, 4, 6, 2],
    &[1, 3, 7, 5],
    &[0, 1, 5, 4],
    &[2, 6, 7, 3],
    &[0, 2, 3, 1],
    &[4, 5, 7, 6],
];

fn corners(min: [f64; 3], max: [f64; 3]) -> Vec<[f64; 3]> {
    (0..8)
        .map(|i| std::array::from_fn(|k| if i >> k & 1 == 1 { max[k] } else { min[k] }))
        .collect()
}

fn block(experiment: &Experiment, time: f64) -> PolyData {
    let half = 0.5 * experiment.block;
    let center = (experiment.path)(time);
    // As wide as the flume allows, turned about y.
    let wide = half.min(0.45 * experiment.water[1]);
    let angle = 0.6 + 1.3 * time / (1.0 + time);
    let turned = corners([-half, -wide, -half], [half, wide, half])
        .into_iter()
        .map(|[x, y, z]| {
            let (s, c) = angle.sin_cos();
            [
                center[0] + c * x + s * z,
                center[1] + y,
                center[2] - s * x + c * z,
            ]
        });
    let mut mesh = Mesh::default();
    mesh.add(3, &turned.collect::<Vec<_>>(), &BOX);
    mesh.finish(time)
}

fn fixed(experiment: &Experiment) -> PolyData {
    let mut mesh = Mesh::default();
    for (id, [min, max]) in (10..).zip(&experiment.walls) {
        mesh.add(id, &corners(*min, *max), &BOX);
    }
    let [x, y, z] = experiment.wedge;
    let points = [
        [0.0; 3],
        [x, 0.0, 0.0],
        [0.0, 0.0, z],
        [0.0, y, 0.0],
        [x, y, 0.0],
        [0.0, y, z],
    ];
    mesh.add(
        9,
        &points,
        &[
            &[0, 1, 2],
            &[3, 5, 4],
            &[0, 3, 4, 1],
            &[1, 4, 5, 2],
            &[2, 5, 3, 0],
        ],
    );
    mesh.finish(0.0)
}
