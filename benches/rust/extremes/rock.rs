//! Blocks in a line or two.

use riprap_dda::{
    BlockDefinition, Blocks, Isometry, Material, Motion, Polyhedron, Settings, Shape, StepError,
    Vec3,
};

use crate::row::Failure;

pub const G: f64 = 9.81;

/// Frictional, without rebound: each trial changes what it is about.
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

pub fn cuboid(from: [f64; 3], to: [f64; 3]) -> Result<Polyhedron, Failure> {
    Ok(Polyhedron::cuboid(from.into(), to.into())?)
}

/// A box about the origin, rotated and translated.
pub fn placed(sides: [f64; 3], shift: Vec3, turn: Vec3) -> Result<Polyhedron, Failure> {
    let half = sides.map(|x| 0.5 * x);
    let body = cuboid(half.map(|x| -x), half)?;
    Ok(body.transformed(&Isometry::new(shift, turn)))
}

pub fn body(shape: Polyhedron, motion: Motion) -> BlockDefinition {
    BlockDefinition {
        shape: Shape::Polyhedra(vec![shape]),
        material: 0,
        motion,
        velocity: Vec3::zeros(),
        angular_velocity: Vec3::zeros(),
        deformability: None,
    }
}

pub fn free(shape: Polyhedron, velocity: [f64; 3]) -> BlockDefinition {
    BlockDefinition {
        velocity: velocity.into(),
        ..body(shape, Motion::Free)
    }
}

/// A wide fixed slab with its top at z = 0.
pub fn floor() -> Result<BlockDefinition, Failure> {
    let slab = cuboid([-50.0, -50.0, -2.0], [50.0, 50.0, 0.0])?;
    Ok(body(slab, Motion::Fixed))
}

pub fn system(
    definitions: Vec<BlockDefinition>,
    material: Material,
    gravity: Vec3,
) -> Result<Blocks, Failure> {
    let settings = Settings {
        gravity,
        ..Settings::default()
    };
    Ok(Blocks::new(definitions, vec![material], settings)?)
}

/// Gravity on a plane that dips by `angle` towards +x, in the plane's own frame.
pub fn on_slope(angle: f64) -> Vec3 {
    Vec3::new(angle.sin(), 0.0, -angle.cos()) * G
}

pub fn down() -> Vec3 {
    on_slope(0.0)
}

/// Runs to `end` (s) by the solver's own steps, `longest` at most, `share` of each.
pub fn run(blocks: &mut Blocks, end: f64, share: f64, longest: f64) -> Result<u64, StepError> {
    let (mut time, mut n) = (0.0, 0);
    while time < end {
        let dt = (share * blocks.critical_time_step().dt).min(longest);
        blocks.advance(time, dt, 1)?;
        time += dt;
        n += 1;
    }
    Ok(n)
}

/// Takes steps of the solver's own choice, `longest` at most; the time they took.
pub fn take(blocks: &mut Blocks, n: u64, longest: f64) -> Result<f64, StepError> {
    let mut time = 0.0;
    for _ in 0..n {
        let dt = blocks.critical_time_step().dt.min(longest);
        blocks.advance(time, dt, 1)?;
        time += dt;
    }
    Ok(time)
}

/// Angular momentum of the free blocks about the origin; N m s.
pub fn angular_momentum(blocks: &Blocks) -> Vec3 {
    (0..blocks.n_blocks())
        .filter(|&b| blocks.is_free(b))
        .map(|b| {
            let momentum = blocks.velocity(b) * blocks.mass(b);
            blocks.spin_momentum(b) + blocks.centroid(b).cross(&momentum)
        })
        .sum()
}

/// Reproducible numbers.
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
}
