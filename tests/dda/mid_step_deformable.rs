//! Deformable blocks by contact dynamics: spin, strain, rest, columns, impacts, and the limit of stiff rock.

use nalgebra::Matrix3;
use riprap_dda::{
    BlockDefinition, BlockError, Blocks, ContactDynamics, Deformability, DeformableModel, Elastic,
    Integrator, Material, Motion, Settings, StressLaw, Vec3,
};

use crate::setup::{
    G, Random, assert_below, assert_close, block, cuboid, down, floor, moving, on_slope,
    on_threads, rock,
};

const LAWS: [StressLaw; 2] = [StressLaw::SaintVenantKirchhoff, StressLaw::Corotational];

fn elastic(young_modulus: f64, viscosity: f64) -> Material {
    Material {
        elastic: Some(Elastic {
            young_modulus,
            poisson_ratio: 0.25,
            viscosity,
        }),
        ..rock()
    }
}

fn with_friction(friction: f64, material: Material) -> Material {
    Material {
        friction_angle: friction.atan(),
        ..material
    }
}

fn affine(from: [f64; 3], to: [f64; 3], law: StressLaw) -> BlockDefinition {
    let mut definition = block(cuboid(from, to), Motion::Free);
    definition.deformability = Some(Deformability {
        model: DeformableModel::Affine12(law),
        ..Deformability::default()
    });
    definition
}

fn exact() -> Integrator {
    Integrator::ContactDynamics(ContactDynamics {
        tolerance: 1e-12,
        n_iterations: 5000,
        ..ContactDynamics::default()
    })
}

fn blocks_by(
    integrator: Integrator,
    definitions: Vec<BlockDefinition>,
    material: Material,
    gravity: Vec3,
) -> Blocks {
    let settings = Settings {
        gravity,
        integrator,
        ..Settings::default()
    };
    Blocks::new(definitions, vec![material], settings).unwrap()
}

fn blocks(definitions: Vec<BlockDefinition>, material: Material, gravity: Vec3) -> Blocks {
    blocks_by(exact(), definitions, material, gravity)
}

fn run(blocks: &mut Blocks, n: u32, dt: f64) {
    blocks
        .advance(0.0, f64::from(n) * dt, n)
        .unwrap_or_else(|error| panic!("{error}"));
}

/// Frequencies of volume and shape of a cube of 1 m; rad/s.
fn frequencies(young_modulus: f64) -> [f64; 2] {
    [0.5, 1.25].map(|share| (12.0 * young_modulus / (share * 2500.0)).sqrt())
}

/// A box that tumbles freely keeps its momenta to round-off in 1e4 steps, and its energy within bounds, however stiff it is.
#[test]
fn a_free_block_keeps_its_spin() {
    let half = [0.5, 0.35, 0.2];
    for (young_modulus, law) in [
        (1e7, LAWS[0]),
        (1e7, LAWS[1]),
        (1e10, LAWS[0]),
        (1e13, LAWS[0]),
    ] {
        let mut definition = affine(half.map(|c| -c), half, law);
        definition.velocity = Vec3::new(1.0, -2.0, 3.0);
        definition.angular_velocity = Vec3::new(1.0, 5.0, 0.3);
        let mut blocks = blocks(vec![definition], elastic(young_modulus, 0.0), Vec3::zeros());
        let dt = 0.01;
        let (spin, start) = (blocks.spin_momentum(0), blocks.energies());
        let [mut off, mut energy, mut strain] = [0.0_f64; 3];
        for _ in 0..10_000 {
            run(&mut blocks, 1, dt);
            off = off.max((blocks.spin_momentum(0) - spin).norm() / spin.norm());
            let now = blocks.energies();
            energy = energy.max((now.balance() / start.balance() - 1.0).abs());
            strain = strain.max(now.strain / start.kinetic);
        }
        let velocity = (blocks.velocity(0) - Vec3::new(1.0, -2.0, 3.0)).norm();
        let [volume, _] = frequencies(young_modulus);
        println!(
            "E {young_modulus:e} {law:?}, w dt {:.2}: L {off:.1e}, v {velocity:.1e}, energy {energy:.1e}, strain {strain:.1e}",
            volume * dt
        );
    }
}

/// Free strain
#[test]
fn free_strain() {
    let law = LAWS[0];
    let young = 1e9;
    for (shape, omega) in [(0, frequencies(young)[0]), (1, frequencies(young)[1])] {
        for wdt in [0.2, 0.1, 0.05, 100.0] {
            let mut definition = affine([-0.5; 3], [0.5; 3], law);
            let p = 1e-7 * young;
            definition.deformability.as_mut().unwrap().initial_stress = if shape == 0 {
                [p, p, p, 0.0, 0.0, 0.0]
            } else {
                [p, -p, 0.0, 0.0, 0.0, 0.0]
            };
            let mut blocks = blocks(vec![definition], elastic(young, 0.0), Vec3::zeros());
            let dt = wdt / omega;
            let n = (1000.0 / wdt.min(1.0)) as u32;
            let e0 = blocks.energies().balance();
            // mean crossing
            let mut worst = 0.0_f64;
            let mut largest = 0.0_f64;
            let mut phase_cross = vec![];
            let mut last = 0.0;
            let mean = { 0.0 };
            let mut rate_last = 0.0;
            for k in 0..n {
                run(&mut blocks, 1, dt);
                let e = blocks.strain(0).unwrap()[0];
                let r = blocks.velocity_gradient(0)[(0, 0)];
                if rate_last > 0.0 && r <= 0.0 {
                    phase_cross.push(f64::from(k) + rate_last / (rate_last - r));
                }
                rate_last = r;
                last = e;
                let _ = (last, mean);
                largest = largest.max(e.abs());
                let s = blocks.energies();
                worst = worst.max((s.balance() - e0).abs());
            }
            let m = phase_cross.len();
            if m > 1 {
                let period = (phase_cross[m - 1] - phase_cross[0]) / (m as f64 - 1.0) * dt;
                println!(
                    "mode {shape} wdt {wdt}: w/w0-1 = {:.3e}",
                    std::f64::consts::TAU / period / omega - 1.0
                );
            }
            println!(
                "  largest {largest:.3e}, energy {worst:.2e} start {e0:.2e} strain e {:.3e}",
                1e-14 * young
            );
        }
    }
}

#[test]
fn rest() {
    for young in [1e7, 1e9, 1e12] {
        let definition = affine([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], LAWS[0]);
        let dt = 5e-3;
        let eta = young * 2e-3;
        let mut blocks = blocks(
            vec![floor(), definition],
            with_friction(0.0, elastic(young, eta)),
            down(),
        );
        run(&mut blocks, 2000, dt);
        let stress = blocks.stress(1).unwrap();
        println!(
            "E {young:e} stress {stress:?} expected {}, strain {:?}",
            -2500.0 * G / 2.0,
            blocks.strain(1).unwrap()
        );
        let weight = blocks.mass(1) * G;
        println!(
            "reaction {:.3e}, z {} v {:.2e} {:?} {:?}",
            -blocks.contact_force(0).force.z / weight - 1.0,
            blocks.centroid(1).z,
            blocks.velocity(1).norm(),
            blocks.contact_solution(),
            blocks.energies()
        );
    }
}
