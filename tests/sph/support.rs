//! Boxes of fluid and one way to step them.

use riprap_sph::{
    Dimensions, Fluid, NegativePressure, NoBoundary, Scheme, Settings, Start, Stepping, Vec3,
};

/// A periodic box of lattice fluid, `n` spacings of 1 m/`n[0]` along each side.
pub struct PeriodicBox {
    pub n: [usize; 3],
    pub support_over_spacing: f64,
    pub sound_speed: f64,
    pub scheme: Scheme,
    pub dimensions: Dimensions,
    pub time_step_factor: f64,
}

/// The published scheme with pressures below zero kept, for closed boxes without a free surface, and by kick-drift-kick:
/// it is its sums that are looked at, and with these steps it runs backwards.
pub fn published(dynamic_viscosity: f64) -> Scheme {
    Scheme {
        negative_pressure: NegativePressure::Kept,
        stepping: Stepping::KickDriftKick,
        ..Scheme::mueller2003(dynamic_viscosity)
    }
}

impl Default for PeriodicBox {
    fn default() -> Self {
        Self {
            n: [12, 12, 12],
            support_over_spacing: 3.0,
            sound_speed: 20.0,
            scheme: published(0.0),
            dimensions: Dimensions::Three,
            time_step_factor: 0.5,
        }
    }
}

impl PeriodicBox {
    pub fn spacing(&self) -> f64 {
        1.0 / self.n[0] as f64
    }

    /// The fluid with positions moved by `shift` and velocities given by `velocity`.
    pub fn fluid(&self, shift: impl Fn(&Vec3) -> Vec3, velocity: impl Fn(&Vec3) -> Vec3) -> Fluid {
        let dp = self.spacing();
        let extent = Vec3::new(self.n[0] as f64, self.n[1] as f64, self.n[2] as f64) * dp;
        let mut lattice = Vec::new();
        for k in 0..self.n[2] {
            for j in 0..self.n[1] {
                for i in 0..self.n[0] {
                    lattice.push((Vec3::new(i as f64, j as f64, k as f64).add_scalar(0.5)) * dp);
                }
            }
        }
        let start = Start {
            velocities: lattice.iter().map(velocity).collect(),
            positions: lattice.iter().map(|x| x + shift(x)).collect(),
            pressures: Vec::new(),
        };
        let settings = Settings {
            particle_spacing: [dp; 3],
            smoothing_length: 0.5 * self.support_over_spacing * dp,
            reference_density: 1000.0,
            sound_speed: self.sound_speed,
            scheme: self.scheme,
            dimensions: self.dimensions,
            gravity: Vec3::zeros(),
            time_step_factor: self.time_step_factor,
            domain: (Vec3::zeros(), extent),
            periodic: [true; 3],
            symmetry: [[false; 2]; 3],
        };
        let mut fluid = Fluid::new(start, settings).unwrap();
        evaluate(&mut fluid);
        fluid
    }
}

/// Everything that follows from the present positions and densities.
pub fn evaluate(fluid: &mut Fluid) {
    fluid.evaluate(&mut NoBoundary, 0.0).unwrap();
}

/// A step of a fluid without walls, by the stepping of its scheme.
pub fn step(fluid: &mut Fluid, dt: f64) {
    fluid.step(&mut NoBoundary, dt).unwrap();
}

/// A reproducible number in −1..1 for a lattice place.
pub fn noise(x: &Vec3, salt: f64) -> f64 {
    let s = (x.x * 12.9898 + x.y * 78.233 + x.z * 37.719 + salt * 11.31).sin() * 43_758.545_3;
    2.0 * (s - s.floor()) - 1.0
}

pub fn noise3(x: &Vec3) -> Vec3 {
    Vec3::new(noise(x, 1.0), noise(x, 2.0), noise(x, 3.0))
}

/// Uniform numbers of −1 to 1 from a fixed seed.
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f64 {
        // a linear congruence by Knuth; its high bits are random enough to place points
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}
