//! Scenes in a line or two.

use riprap_dda::{
    BlockDefinition, Blocks, ContactDynamics, Energies, Integrator, Isometry, Material, Motion,
    Polyhedron, Settings, Shape, Vec3,
};

pub const G: f64 = 9.81;

/// Frictional, elastic: each test changes what it is about.
pub fn rock() -> Material {
    Material {
        density: 2500.0,
        friction_angle: 0.5,
        residual_friction_angle: None,
        cohesion: 0.0,
        residual_cohesion: 0.0,
        tensile_strength: 0.0,
        restitution: 0.0,
        contact_stiffness: 1e8,
        joint_stiffness: None,
        shear_stiffness_ratio: 0.8,
        shear_damping_ratio: 0.2,
        rolling_friction: 0.0,
        twisting_friction: 0.0,
        elastic: None,
    }
}

pub fn block(shape: Polyhedron, motion: Motion) -> BlockDefinition {
    BlockDefinition {
        shape: Shape::Polyhedra(vec![shape]),
        material: 0,
        motion,
        velocity: Vec3::zeros(),
        angular_velocity: Vec3::zeros(),
        deformability: None,
    }
}

pub fn ball(center: Vec3, radius: f64) -> BlockDefinition {
    BlockDefinition {
        shape: Shape::Sphere { center, radius },
        ..block(cuboid([0.0; 3], [1.0; 3]), Motion::Free)
    }
}

pub fn moving(mut definition: BlockDefinition, velocity: [f64; 3]) -> BlockDefinition {
    definition.velocity = velocity.into();
    definition
}

pub fn cuboid(from: [f64; 3], to: [f64; 3]) -> Polyhedron {
    Polyhedron::cuboid(from.into(), to.into()).unwrap()
}

/// A wide fixed slab with its top at z = 0.
pub fn floor() -> BlockDefinition {
    block(
        cuboid([-50.0, -50.0, -2.0], [50.0, 50.0, 0.0]),
        Motion::Fixed,
    )
}

pub fn blocks(definitions: Vec<BlockDefinition>, material: Material, gravity: Vec3) -> Blocks {
    blocks_by(
        Integrator::CentralDifference,
        definitions,
        material,
        gravity,
    )
}

pub fn blocks_by(
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

/// Springs, and contact dynamics to 1e-8 of what falls in a step.
pub fn both_ways() -> [Integrator; 2] {
    let exact = ContactDynamics {
        tolerance: 1e-8,
        n_iterations: 3000,
        ..ContactDynamics::default()
    };
    [
        Integrator::CentralDifference,
        Integrator::ContactDynamics(exact),
    ]
}

/// Runs on a number of threads.
pub fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(run)
}

/// Gravity on a plane that dips by `angle` towards +x, in the plane's own frame.
pub fn on_slope(angle: f64) -> Vec3 {
    Vec3::new(angle.sin(), 0.0, -angle.cos()) * G
}

pub fn down() -> Vec3 {
    on_slope(0.0)
}

/// Runs to `end`; each step is the critical one times `share`, at most `longest`.
pub fn run(blocks: &mut Blocks, end: f64, share: f64, longest: f64) -> u32 {
    let (mut time, mut n) = (0.0, 0);
    while time < end {
        let dt = (share * blocks.critical_time_step().dt)
            .min(longest)
            .min(end - time);
        blocks
            .advance(time, dt, 1)
            .unwrap_or_else(|error| panic!("{error}"));
        time += dt;
        n += 1;
        if end - time < 1e-12 {
            break;
        }
    }
    n
}

/// Runs to `end` in `n` equal steps.
pub fn run_steps(blocks: &mut Blocks, end: f64, n: u32) {
    blocks
        .advance(0.0, end, n)
        .unwrap_or_else(|error| panic!("{error}"));
}

pub fn ledger(energies: &Energies) -> f64 {
    energies.balance()
}

/// Reproducible numbers in [0, 1).
pub struct Random(riprap_dda::Random);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(riprap_dda::Random::new(seed))
    }

    pub fn next(&mut self) -> f64 {
        self.0.uniform()
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - Vec3::repeat(1.0)
    }

    /// Convex hull of random points on an ellipsoid, about the origin, of size about 1.
    pub fn hull(&mut self) -> Polyhedron {
        let n = 6 + (self.next() * 14.0) as usize;
        let axes = Vec3::new(0.4, 0.4, 0.4) + self.vector().abs() * 0.3;
        loop {
            let points: Vec<Vec3> = (0..n)
                .map(|_| self.vector().normalize().component_mul(&axes))
                .collect();
            if let Ok(hull) = Polyhedron::convex_hull(&points) {
                return hull;
            }
        }
    }

    pub fn placement(&mut self, spread: f64) -> Isometry {
        Isometry::new(self.vector() * spread, self.vector() * 2.0)
    }
}

pub fn assert_close(name: &str, found: f64, expected: f64, relative: f64) {
    let error = (found - expected).abs() / expected.abs();
    println!(
        "{name}: found {found:.9e}, expected {expected:.9e}, error {error:.2e} of {relative:.0e}"
    );
    assert!(
        error <= relative,
        "{name}: found {found}, expected {expected}, error {error:e} > {relative:e}"
    );
}

pub fn assert_below(name: &str, found: f64, limit: f64) {
    println!("{name}: {found:.3e} of {limit:.0e}");
    assert!(found <= limit, "{name}: {found:e} > {limit:e}");
}
