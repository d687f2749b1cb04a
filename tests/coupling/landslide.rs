//! Terrain from rasters and surveys, and rock cut out of it: against closed forms.

pub(crate) mod cloud;
mod rock;
mod rough;
mod terrain;
mod triangles;
mod water;

use crate::support;
use crate::support::scene::resolved_in;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use riprap::ground::Ground;
use riprap::observe::Observer as _;
use riprap::observe::gauges::Gauges;
use riprap::run;
use riprap::scene::error::Problem;
use riprap::scene::impulse_wave::SlideImpact;
use riprap::scene::resolve::Scene;
use riprap::scene::terrain::Terrain;
use riprap::scene::terrain::basin::room_below;
use riprap::table::Start;
use riprap_dda::{Shape, Vec3};

const G: f64 = 9.81;

/// A raster of a closed form: its south-western point, the distance of its points, and their numbers.
struct Raster {
    corner: [f64; 2],
    cell: f64,
    n: [usize; 2],
}

impl Raster {
    /// Writes it with its lower-left cell named by its center.
    fn write(&self, path: &Path, height: impl Fn(f64, f64) -> f64) {
        self.write_named(path, ("xllcenter", "yllcenter"), self.corner, height);
    }

    fn write_named(
        &self,
        path: &Path,
        (x, y): (&str, &str),
        named: [f64; 2],
        height: impl Fn(f64, f64) -> f64,
    ) {
        let mut text = format!(
            "ncols {}\nnrows {}\n{x} {:?}\n{y} {:?}\ncellsize {:?}\nNODATA_value -9999\n",
            self.n[0], self.n[1], named[0], named[1], self.cell
        );
        for j in (0..self.n[1]).rev() {
            for i in 0..self.n[0] {
                let at = |axis: usize, k: usize| self.corner[axis] + k as f64 * self.cell;
                let z = height(at(0, i), at(1, j));
                let z = if z.is_nan() { -9999.0 } else { z };
                write!(text, "{z:?} ").unwrap();
            }
            text.push('\n');
        }
        std::fs::write(path, text).unwrap();
    }
}

/// 400 m by 300 m, about the origin along y.
fn valley() -> Raster {
    Raster {
        corner: [0.0, -150.0],
        cell: 10.0,
        n: [41, 31],
    }
}

/// A slope of 40 degrees up along −x, with hummocks.
fn hummocky(x: f64, y: f64) -> f64 {
    300.0 - 40.0_f64.to_radians().tan() * x + 4.0 * (x / 23.0).sin() * (y / 31.0).cos()
}

fn scene(folder: &Path, terrain: &str, slides: &str, further: &str) -> Result<Scene, Vec<Problem>> {
    let text = format!(
        r#"(title: "a slope", domain: (min: (0, -150, -100), max: (400, 150, 400)),
            materials: [(name: "rock", density: 2500, friction_angle_deg: 20, contact_stiffness: 1e9)],
            terrain: {terrain}, slides: [{slides}],
            blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain)],
            time: (duration: 1), {further})"#
    );
    resolved_in(folder, &text)
}

fn terrain_of(folder: &Path, terrain: &str) -> Result<Terrain, Problem> {
    match scene(folder, terrain, "", "") {
        Ok(scene) => Ok(scene.terrain.unwrap()),
        Err(problems) => Err(problems.into_iter().next().unwrap()),
    }
}

/// Heights of the ground as blocks meet it.
fn ground(terrain: &Terrain) -> Ground {
    let surface = &terrain.surface;
    let corners = |t: &[u32; 3]| t.map(|v| surface.vertices()[v as usize]);
    Ground::over(surface.triangles().iter().map(corners).collect())
}

fn volume(scene: &Scene, name: &str) -> f64 {
    let blocks = scene.block_names.iter().zip(&scene.blocks);
    blocks
        .filter(|(block, _)| block.starts_with(name))
        .map(|(_, block)| block.shape.volume())
        .sum()
}

const L_SHAPE: &str =
    "Corners([(55, -83), (195, -83), (195, 12.5), (141, 12.5), (141, 71), (55, 71)])";

/// Of that; m².
const L_AREA: f64 = 140.0 * 154.0 - 54.0 * 58.5;

/// Every block as it is cut.
const WHOLE: &str = "minimum_volume: 0, convex_within: 0";

const JOINTS: &str = "joint_sets: [(dip_deg: 40, dip_direction_deg: 90, spacing: 17),
    (dip_deg: 75, dip_direction_deg: 270, spacing: 18, scatter_deg: 3, spacing_scatter: 0.2),
    (dip_deg: 88, dip_direction_deg: 10, spacing: 19, spacing_scatter: 0.2)], seed: 2";
