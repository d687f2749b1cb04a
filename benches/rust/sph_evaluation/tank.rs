//! The column of water with its walls: scene D of the comparison with other codes, walls of particles.

use riprap_sph::boundary::integral::Face;
use riprap_sph::boundary::sampling::{Region, UnionLattice, sample_union};
use riprap_sph::boundary::wall_particles::{Slip, WallParticles};
use riprap_sph::scheme::{DensityDiffusion, Viscosity};
use riprap_sph::{Dimensions, Fluid, FluidError, Precision, Scheme, Settings, Start, Vec3};

/// The column with its walls: a floor and four sides, open above.
pub struct Tank {
    pub fluid: Fluid,
    pub walls: WallParticles,
}

/// Water at rest at a spacing of `dp`, with a smoothing length of `ratio` times that.
pub fn tank(dp: f64, ratio: f64, precision: Precision) -> Result<Tank, FluidError> {
    let size = [1.6, 0.67, 0.6].map(|l: f64| (l / dp).round() * dp);
    let n = [0.4 / dp, size[1] / dp, 0.3 / dp].map(|n| n.round() as usize);
    let sound_speed = 20.0 * (9.81_f64 * 0.3).sqrt();
    let settings = Settings {
        particle_spacing: [dp; 3],
        smoothing_length: ratio * dp,
        reference_density: 1000.0,
        sound_speed,
        scheme: Scheme {
            diffusion: DensityDiffusion::Fourtakas(0.1),
            viscosity: Viscosity::Artificial { alpha: 0.1 },
            precision,
            ..Scheme::artificial()
        },
        dimensions: Dimensions::Three,
        gravity: Vec3::new(0.0, 0.0, -9.81),
        time_step_factor: 0.2,
        domain: (Vec3::zeros(), Vec3::from(size)),
        periodic: [false; 3],
        symmetry: [[false; 2]; 3],
    };
    let mut start = Start::default();
    for k in 0..n[2] {
        for j in 0..n[1] {
            for i in 0..n[0] {
                let x = Vec3::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5) * dp;
                start.pressures.push(9810.0 * (n[2] as f64 * dp - x.z));
                start.positions.push(x);
                start.velocities.push(Vec3::zeros());
            }
        }
    }
    let mut fluid = Fluid::new(start, settings)?;
    fluid.refresh();
    let samples = wall_samples(dp, 2.0 * ratio * dp, size);
    let mut walls = WallParticles::new(&fluid, vec![dp.powi(3); samples.len()], Slip::Free);
    walls.place(|w| [samples[w], Vec3::zeros(), Vec3::zeros()]);
    Ok(Tank { fluid, walls })
}

/// Points of five slabs round the tank.
fn wall_samples(dp: f64, support_radius: f64, [x, y, z]: [f64; 3]) -> Vec<Vec3> {
    let t = support_radius + dp;
    let slabs = [
        ([-t, -t, -t], [x + t, y + t, 0.0]),
        ([-t, -t, 0.0], [0.0, y + t, z]),
        ([x, -t, 0.0], [x + t, y + t, z]),
        ([0.0, -t, 0.0], [x, 0.0, z]),
        ([0.0, y, 0.0], [x, y + t, z]),
    ];
    let corners: Vec<Vec<(Vec3, [Vec3; 4])>> = slabs.iter().map(|(a, b)| cuboid(a, b)).collect();
    let faces: Vec<Vec<Face>> = corners
        .iter()
        .map(|faces| {
            faces
                .iter()
                .map(|(normal, vertices)| Face {
                    normal: *normal,
                    vertices,
                })
                .collect()
        })
        .collect();
    let parts: Vec<&[Face]> = faces.iter().map(Vec::as_slice).collect();
    let lattice = UnionLattice {
        anchor: Vec3::zeros(),
        particle_spacing: dp,
        support_radius,
        region: Region {
            min: Vec3::zeros(),
            max: Vec3::new(x, y, z),
        },
    };
    sample_union(&parts, &lattice)
        .iter()
        .map(|s| s.sample.position)
        .collect()
}

/// Faces of a box, counter-clockwise seen from outside.
fn cuboid(min: &[f64; 3], max: &[f64; 3]) -> Vec<(Vec3, [Vec3; 4])> {
    let (min, max) = (Vec3::from(*min), Vec3::from(*max));
    let middle = (min + max) * 0.5;
    let half = (max - min) * 0.5;
    (0..6)
        .map(|side| {
            let axis = side % 3;
            let sign = if side < 3 { 1.0 } else { -1.0 };
            let mut normal = Vec3::zeros();
            normal[axis] = sign;
            let corner = |u: f64, v: f64| {
                let mut x = middle;
                x[axis] += sign * half[axis];
                x[(axis + 1) % 3] += u * half[(axis + 1) % 3];
                x[(axis + 2) % 3] += sign * v * half[(axis + 2) % 3];
                x
            };
            let face = [
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ];
            (normal, face)
        })
        .collect()
}
