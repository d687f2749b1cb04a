//! Water with or without walls of particles, and one way to step it.

use riprap_sph::boundary::wall_particles::{Slip, WallParticles};
use riprap_sph::{Boundary, Dimensions, Fluid, FluidError, Scheme, Settings, Stage, Start, Vec3};

pub const DENSITY: f64 = 1000.0;

/// Settings of a flow in the plane of x and z, of unit width, y at 0.5 everywhere.
pub struct Plane {
    pub spacing: f64,
    /// Smoothing length over spacing.
    pub ratio: f64,
    pub sound_speed: f64,
    pub scheme: Scheme,
    pub gravity: Vec3,
    pub time_step_factor: f64,
    /// Corners (x, z).
    pub domain: ([f64; 2], [f64; 2]),
    /// Along x and z.
    pub periodic: [bool; 2],
}

impl Plane {
    pub fn settings(&self) -> Settings {
        let ([x0, z0], [x1, z1]) = self.domain;
        Settings {
            particle_spacing: [self.spacing, 1.0, self.spacing],
            smoothing_length: self.ratio * self.spacing,
            reference_density: DENSITY,
            sound_speed: self.sound_speed,
            scheme: self.scheme,
            dimensions: Dimensions::Two { width: 1.0 },
            gravity: self.gravity,
            time_step_factor: self.time_step_factor,
            domain: (Vec3::new(x0, 0.0, z0), Vec3::new(x1, 1.0, z1)),
            periodic: [self.periodic[0], false, self.periodic[1]],
            symmetry: [[false; 2]; 3],
        }
    }
}

/// Lattice places in the plane with indices `i` and `k` in the given ranges.
pub fn lattice(
    spacing: f64,
    i: std::ops::Range<i32>,
    k: std::ops::Range<i32>,
) -> impl Iterator<Item = Vec3> {
    k.flat_map(move |k| i.clone().map(move |i| (i, k)))
        .map(move |(i, k)| {
            Vec3::new(
                (f64::from(i) + 0.5) * spacing,
                0.5,
                (f64::from(k) + 0.5) * spacing,
            )
        })
}

/// The start of particles at places, with velocity and pressure given there.
pub fn start(
    positions: Vec<Vec3>,
    velocity: impl Fn(&Vec3) -> Vec3,
    pressure: impl Fn(&Vec3) -> f64,
) -> Start {
    Start {
        velocities: positions.iter().map(velocity).collect(),
        pressures: positions.iter().map(pressure).collect(),
        positions,
    }
}

/// Place, velocity and acceleration of a wall point at a time.
type Motion = Box<dyn Fn(usize, f64) -> [Vec3; 3] + Send + Sync>;

/// Water and its walls, evaluated at `time`.
pub struct Water {
    pub fluid: Fluid,
    pub walls: WallParticles,
    pub time: f64,
    /// Force of the walls on the fluid at the last evaluation; N.
    pub wall_force: Vec3,
    motion: Motion,
    /// Whether walls are sorted, and their neighbors listed, at each placement.
    sorts_always: bool,
}

/// Walls of particles whose motion is known.
struct MovingWalls<'a> {
    sorts_always: bool,
    walls: &'a mut WallParticles,
    motion: &'a Motion,
    /// Force on the fluid; N.
    force: &'a mut Vec3,
    /// Start of the step; s.
    time: f64,
}

impl Boundary for MovingWalls<'_> {
    type Error = FluidError;

    fn place(&mut self, fluid: &mut Fluid, stage: Stage, dt: f64) {
        let time = match stage {
            Stage::Midpoint => self.time + 0.5 * dt,
            Stage::Predicted | Stage::End => self.time + dt,
        };
        if self.sorts_always {
            self.walls.sort_again(&[]);
        }
        self.walls.place(|w| (self.motion)(w, time));
        self.walls.find_wet(fluid);
    }

    fn find(&mut self, fluid: &mut Fluid) {
        self.walls.find_wet(fluid);
    }

    fn density_rates(&mut self, fluid: &mut Fluid) {
        self.walls.add_rates(fluid);
    }

    fn concentration(&mut self, fluid: &mut Fluid) {
        self.walls.add_concentrations(fluid);
    }

    fn continue_pressure(&mut self, fluid: &mut Fluid) {
        self.walls.extrapolate(fluid);
    }

    fn strain_rates(&mut self, fluid: &mut Fluid) {
        self.walls.add_strains(fluid);
    }

    fn forces(&mut self, fluid: &mut Fluid) {
        *self.force = self.walls.add_forces(fluid);
    }
}

impl Water {
    /// Without walls.
    pub fn free(start: Start, settings: Settings) -> Self {
        let nowhere = |_: usize, _: f64| [Vec3::zeros(); 3];
        Self::walled(start, settings, (Vec::new(), Slip::Free), nowhere)
    }

    /// Of a fluid that needs no walls.
    pub fn of(fluid: Fluid) -> Self {
        let mut water = Self {
            walls: WallParticles::new(&fluid, Vec::new(), Slip::Free),
            fluid,
            time: 0.0,
            wall_force: Vec3::zeros(),
            motion: Box::new(|_, _| [Vec3::zeros(); 3]),
            sorts_always: false,
        };
        water.evaluate(0.0);
        water
    }

    /// With wall points of given volumes.
    pub fn walled(
        start: Start,
        settings: Settings,
        (volumes, slip): (Vec<f64>, Slip),
        motion: impl Fn(usize, f64) -> [Vec3; 3] + Send + Sync + 'static,
    ) -> Self {
        let fluid = Fluid::new(start, settings).unwrap();
        let walls = WallParticles::new(&fluid, volumes, slip);
        let mut water = Self {
            fluid,
            walls,
            time: 0.0,
            wall_force: Vec3::zeros(),
            motion: Box::new(motion),
            sorts_always: false,
        };
        water.evaluate(0.0);
        water
    }

    /// With wall points that stay.
    pub fn between(
        start: Start,
        settings: Settings,
        (points, volume): (Vec<Vec3>, f64),
        slip: Slip,
    ) -> Self {
        let volumes = vec![volume; points.len()];
        let still = move |w: usize, _: f64| [points[w], Vec3::zeros(), Vec3::zeros()];
        Self::walled(start, settings, (volumes, slip), still)
    }

    /// The same with walls that are sorted at each placement.
    pub fn sorting_always(self) -> Self {
        Self {
            sorts_always: true,
            ..self
        }
    }

    /// Walls at the present time and the fluid that they hold.
    fn parts(&mut self) -> (&mut Fluid, MovingWalls<'_>) {
        let walls = MovingWalls {
            walls: &mut self.walls,
            motion: &self.motion,
            sorts_always: self.sorts_always,
            force: &mut self.wall_force,
            time: self.time,
        };
        (&mut self.fluid, walls)
    }

    /// Pressures and accelerations at a time, and rates of density where the stepping wants them then.
    pub fn evaluate(&mut self, time: f64) {
        self.time = time;
        let (fluid, mut walls) = self.parts();
        fluid.evaluate(&mut walls, 0.0).unwrap();
    }

    /// Rates of density at a time.
    pub fn update_rates(&mut self, time: f64) {
        self.fluid.refresh();
        self.walls.place(|w| (self.motion)(w, time));
        self.walls.find_wet(&self.fluid);
        self.fluid.update_rates();
        self.walls.add_rates(&mut self.fluid);
    }

    /// By the stepping of the scheme.
    pub fn step(&mut self, dt: f64) {
        let (fluid, mut walls) = self.parts();
        fluid.step(&mut walls, dt).unwrap();
        self.time += dt;
    }

    /// Steps of the solver's own choice up to `time`, the last one cut.
    pub fn advance_to(&mut self, time: f64) {
        while self.time < time * (1.0 - 1e-12) {
            let dt = self.fluid.step_limits().smallest();
            self.step(dt.min(time - self.time));
        }
    }

    /// A sum over particles of a function of place, velocity and mass.
    /// Change of the momentum in some of the longest steps, over `Σ m |v|`.
    pub fn change_of_momentum(&mut self, steps: u32) -> f64 {
        let before = self.fluid.momentum();
        let size = self.sum(|_, v, m| m * v.norm());
        for _ in 0..steps {
            let dt = self.fluid.step_limits().smallest();
            self.step(dt);
        }
        (self.fluid.momentum() - before).norm() / size
    }

    /// Kinetic energy after some steps of `dt` (s), over that before.
    pub fn growth(&mut self, steps: u32, dt: f64) -> f64 {
        let before = self.fluid.energies().kinetic;
        for _ in 0..steps {
            self.step(dt);
        }
        self.fluid.energies().kinetic / before
    }

    pub fn sum(&self, of: impl Fn(&Vec3, &Vec3, f64) -> f64) -> f64 {
        let p = self.fluid.particles();
        (0..p.len())
            .map(|a| of(&p.position[a], &p.velocity[a], p.mass[a]))
            .sum()
    }
}

/// Times at which a signal changes sign, by linear interpolation, one step after the other.
pub fn crossings(
    water: &mut Water,
    dt: f64,
    n_steps: usize,
    signal: impl Fn(&Water) -> f64,
) -> Vec<f64> {
    let mut found = Vec::new();
    let mut before = signal(water);
    for _ in 0..n_steps {
        let time = water.time;
        water.step(dt);
        let now = signal(water);
        if (before < 0.0) != (now < 0.0) {
            found.push(time + dt * before / (before - now));
        }
        before = now;
    }
    found
}

/// Numbers of any size, to be printed.
pub fn short(numbers: &[f64]) -> String {
    let each: Vec<String> = numbers.iter().map(|x| format!("{x:.2e}")).collect();
    format!("[{}]", each.join(", "))
}

/// Mean slope of `log error` over `log spacing`, and the slopes between neighbors, printed.
pub fn order(name: &str, spacings: &[f64], errors: &[f64]) -> f64 {
    let slopes: Vec<f64> = spacings
        .windows(2)
        .zip(errors.windows(2))
        .map(|(dp, e)| (e[0] / e[1]).ln() / (dp[0] / dp[1]).ln())
        .collect();
    let last = errors.len() - 1;
    let mean = (errors[0] / errors[last]).ln() / (spacings[0] / spacings[last]).ln();
    println!(
        "{name}: spacing {spacings:.4?}: errors {}, orders {slopes:.2?}, mean {mean:.2}",
        short(errors)
    );
    // an order is a number
    assert!(mean.is_finite(), "{name}");
    mean
}
