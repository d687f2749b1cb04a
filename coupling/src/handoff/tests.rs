//! Columns of water that is known exactly: at rest, a solitary wave, linear waves.

use riprap_dda::Vec3;

use super::columns::{Raster, Water, columns};
use super::fitness::fitness;
use crate::world::ground::Ground;

/// Water on a lattice over a flat bed at z = 0.
struct Lattice {
    position: Vec<Vec3>,
    velocity: Vec<Vec3>,
    pressure: Vec<f64>,
    mass: Vec<f64>,
    spacing: f64,
}

const DENSITY: f64 = 1000.0;
const GRAVITY: f64 = 9.81;

impl Lattice {
    /// From 0 to `length` and `width` with a surface and a velocity.
    fn new(
        spacing: f64,
        [length, width]: [f64; 2],
        surface: impl Fn(f64) -> f64,
        velocity: impl Fn(f64, f64) -> Vec3,
    ) -> Self {
        let mut position = Vec::new();
        let mut pressure = Vec::new();
        let at = |k: usize| (k as f64 + 0.5) * spacing;
        let n = [length, width].map(|side| (side / spacing).round() as usize);
        for i in 0..n[0] {
            // the column's own height in whole particles, which are stretched
            let height = surface(at(i));
            let rows = (height / spacing).round().max(1.0) as usize;
            for j in 0..n[1] {
                let z = |k: usize| (k as f64 + 0.5) * height / rows as f64;
                position.extend((0..rows).map(|k| Vec3::new(at(i), at(j), z(k))));
                pressure.extend((0..rows).map(|k| DENSITY * GRAVITY * (height - z(k))));
            }
        }
        let velocity = position.iter().map(|x| velocity(x.x, x.z)).collect();
        let mass = vec![DENSITY * spacing.powi(3); position.len()];
        Self {
            position,
            velocity,
            pressure,
            mass,
            spacing,
        }
    }

    fn water(&self) -> Water<'_> {
        Water {
            position: &self.position,
            velocity: &self.velocity,
            pressure: &self.pressure,
            mass: &self.mass,
            volume: self.spacing.powi(3),
            spacing: self.spacing,
        }
    }
}

fn flat() -> Ground {
    let [a, b, c, d] =
        [(-1e3, -1e3), (1e3, -1e3), (1e3, 1e3), (-1e3, 1e3)].map(|(x, y)| Vec3::new(x, y, 0.0));
    Ground::over(vec![[a, b, c], [a, c, d]])
}

fn raster(side: f64, [length, width]: [f64; 2]) -> Raster {
    let n = [length, width].map(|l| (l / side).round() as usize);
    Raster {
        n,
        corner: [0.0; 2],
        side: [side; 2],
    }
}

#[test]
fn a_still_basin_is_still() {
    let size = [4.0, 2.0];
    let lattice = Lattice::new(0.1, size, |_| 1.0, |_, _| Vec3::zeros());
    let found = columns(raster(0.2, size), lattice.water(), &flat(), GRAVITY);
    for (cell, surface) in found.surface.iter().enumerate() {
        // whole particles a cell: uniform up to the walls
        assert!((surface - 1.0).abs() < 1e-12, "{cell}: {surface}");
        assert_eq!(found.velocity[cell], [0.0; 2]);
        assert!((found.stretch[cell] - 1.0).abs() < 1e-12);
        assert!((found.bed_pressure[cell] / (DENSITY * GRAVITY) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn volume_and_momentum_are_those_of_the_particles() {
    let size = [3.0, 2.0];
    // cells that are no multiple of the spacing, and particles beyond the raster
    let lattice = Lattice::new(
        0.07,
        size,
        |x| 0.5 + 0.2 * (3.0 * x).sin(),
        |x, z| Vec3::new(z, (9.0 * x).cos(), 1.0),
    );
    let mut raster = raster(0.19, [2.85, 1.9]);
    raster.corner = [0.08, 0.05];
    let found = columns(raster, lattice.water(), &flat(), GRAVITY);
    let n = lattice.position.len() as f64;
    let volume = n * lattice.spacing.powi(3);
    assert!((found.volume.iter().sum::<f64>() / volume - 1.0).abs() < 1e-12);
    for axis in 0..2 {
        let momentum: f64 = lattice
            .mass
            .iter()
            .zip(&lattice.velocity)
            .map(|(m, v)| m * v[axis])
            .sum();
        let sum: f64 = found.momentum.iter().map(|p| p[axis]).sum();
        let scale: f64 = lattice
            .mass
            .iter()
            .zip(&lattice.velocity)
            .map(|(m, v)| m * v[axis].abs())
            .sum();
        assert!((sum - momentum).abs() < 1e-12 * scale, "{sum} {momentum}");
    }
}

/// Rayleigh (1876): area 4 d √(H d/3) under η; discharge c η.
#[test]
fn a_solitary_wave_keeps_its_area_and_celerity() {
    let (d, h): (f64, f64) = (1.0, 0.3);
    let kappa = (3.0 * h / (4.0 * d * d * (d + h))).sqrt();
    let c = (GRAVITY * (d + h)).sqrt();
    let (length, middle) = (30.0, 15.0);
    let eta = |x: f64| h / (kappa * (x - middle)).cosh().powi(2);
    let (spacing, width) = (0.01, 0.04);
    let velocity = |x: f64, _: f64| Vec3::new(c * eta(x) / (d + eta(x)), 0.0, 0.0);
    let lattice = Lattice::new(spacing, [length, width], |x| d + eta(x), velocity);
    let raster = Raster {
        n: [300, 1],
        corner: [0.0; 2],
        side: [0.1, width],
    };
    let found = columns(raster, lattice.water(), &flat(), GRAVITY);
    let raised: f64 = found.surface.iter().map(|z| z - d).sum();
    let area = raised * raster.side[0];
    let exact = 4.0 * d * (h * d / 3.0).sqrt() * (1.0 + h / d).sqrt();
    assert!((area / exact - 1.0).abs() < 0.03, "{area} {exact}");
    let crest = found.surface.iter().copied().fold(0.0, f64::max) - d;
    // c = q/η in a wave of constant form, here of the whole wave
    let discharge: f64 = (found.velocity.iter().zip(&found.depth))
        .map(|(v, depth)| v[0] * depth)
        .sum();
    let celerity = discharge / raised;
    // the number of rows is whole: half a row is 1.7 % of the crest
    assert!((crest / h - 1.0).abs() < 0.02, "{crest}");
    assert!((celerity / c - 1.0).abs() < 0.01, "{celerity} {c}");
}

/// Columns carry tanh(kd)/(kd) of the kinetic energy of a linear wave.
#[test]
fn the_share_of_kinetic_energy_is_that_of_linear_waves() {
    for kd in [0.3, 1.0, 3.0] {
        let (d, a): (f64, f64) = (1.0, 1e-3);
        let k: f64 = kd / d;
        let omega = (GRAVITY * k * (k * d).tanh()).sqrt();
        let length = 2.0 * std::f64::consts::TAU / k;
        let spacing = length / (length / 0.04).round();
        let velocity = |x: f64, z: f64| {
            let scale = a * omega / (k * d).sinh();
            Vec3::new(
                scale * (k * z).cosh() * (k * x).sin(),
                0.0,
                -scale * (k * z).sinh() * (k * x).cos(),
            )
        };
        let size = [length, 4.0 * spacing];
        let lattice = Lattice::new(spacing, size, |_| d, velocity);
        let raster = Raster {
            n: [(length / spacing / 2.0).round() as usize, 2],
            corner: [0.0; 2],
            side: [length / (length / spacing / 2.0).round(), 2.0 * spacing],
        };
        let mut found = columns(raster, lattice.water(), &flat(), GRAVITY);
        // the surface is too low for particles to show
        for cell in 0..raster.n_cells() {
            found.surface[cell] += a * (k * raster.center(cell)[0]).sin();
        }
        let fit = fitness(&found, lattice.water(), d, GRAVITY);
        let exact = (k * d).tanh() / (k * d);
        assert!((fit.column_share / exact - 1.0).abs() < 0.02);
        assert!((fit.kd / kd - 1.0).abs() < 0.02);
        assert!((fit.quality - 1.0).abs() < 0.03);
    }
}
