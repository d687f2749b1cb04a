//! Fluids with a yield stress, against closed forms.
//!
//! Flows along x are those of a film or of a channel of one period; a slope is gravity that leans.

use riprap_sph::boundary::wall_particles::{Slip, WallParticles};
use riprap_sph::scheme::{SMAGORINSKY, Viscosity};
use riprap_sph::state_equation::State;
use riprap_sph::{
    Dimensions, Fluid, Precision, Regularization, Rheology, Scheme, Settings, Start, Vec3,
};

const DENSITY: f64 = 1500.0;

/// A layer of fluid along x, periodic, on a floor and perhaps under a lid.
struct Layer {
    rows: usize,
    depth: f64,
    /// Period over spacing.
    columns: usize,
    /// Acceleration along x and z; m/s².
    gravity: [f64; 2],
    lid: Option<Vec3>,
    slip: Slip,
    viscosity: Viscosity,
    precision: Precision,
    sound_speed: f64,
}

impl Default for Layer {
    fn default() -> Self {
        Self {
            rows: 40,
            depth: 0.1,
            columns: 6,
            gravity: [0.0, 0.0],
            lid: None,
            slip: Slip::None,
            viscosity: Viscosity::None,
            precision: Precision::Single,
            sound_speed: 10.0,
        }
    }
}

struct Flow {
    fluid: Fluid,
    walls: Vec<WallParticles>,
    time: f64,
}

/// Smoothing length over spacing.
const RATIO: f64 = 2.0;

impl Layer {
    fn spacing(&self) -> f64 {
        self.depth / self.rows as f64
    }

    /// The layer with the given profile of velocity.
    fn flow(&self, profile: impl Fn(f64) -> f64) -> Flow {
        let dp = self.spacing();
        let period = dp * self.columns as f64;
        let mid = Vec3::new(0.0, 0.5, 0.0);
        let settings = Settings {
            particle_spacing: [dp, 1.0, dp],
            smoothing_length: RATIO * dp,
            reference_density: DENSITY,
            sound_speed: self.sound_speed,
            scheme: Scheme {
                viscosity: self.viscosity,
                precision: self.precision,
                ..Scheme::standard()
            },
            dimensions: Dimensions::Two { width: 1.0 },
            gravity: Vec3::new(self.gravity[0], 0.0, self.gravity[1]),
            time_step_factor: 0.5,
            domain: (
                Vec3::new(0.0, 0.0, -5.0 * dp),
                Vec3::new(period, 1.0, self.depth + 10.0 * dp),
            ),
            periodic: [true, false, false],
        };
        let state = State {
            equation: settings.scheme.state_equation,
            reference_density: DENSITY,
            sound_speed: self.sound_speed,
            negative: settings.scheme.negative_pressure,
        };
        let mut start = Start::default();
        let mut sets = [Vec::new(), Vec::new()];
        let rows = self.rows as i32;
        for k in -4..rows + 4 {
            for i in 0..self.columns {
                let x = mid + Vec3::new(i as f64 + 0.5, 0.0, f64::from(k) + 0.5) * dp;
                if k < 0 {
                    sets[0].push(x);
                } else if rows <= k {
                    sets[1].push(x);
                } else {
                    let head = state.hydrostatic_pressure(-self.gravity[1], self.depth - x.z);
                    start.pressures.push(head);
                    start.velocities.push(Vec3::new(profile(x.z), 0.0, 0.0));
                    start.positions.push(x);
                }
            }
        }
        let mut fluid = Fluid::new(start, settings).unwrap();
        fluid.refresh();
        let [floor, lid] = sets;
        let mut walls = vec![(floor, Vec3::zeros())];
        walls.extend(self.lid.map(|v| (lid, v)));
        let walls = walls
            .into_iter()
            .map(|(points, velocity)| {
                let mut set = WallParticles::new(&fluid, vec![dp * dp; points.len()], self.slip);
                // a lattice that fits the period looks the same wherever it has gone to
                set.place(|w| [points[w], velocity, Vec3::zeros()]);
                set
            })
            .collect();
        let mut flow = Flow {
            fluid,
            walls,
            time: 0.0,
        };
        flow.evaluate();
        flow
    }
}

impl Flow {
    fn evaluate(&mut self) {
        let Self { fluid, walls, .. } = self;
        fluid.refresh();
        walls.iter_mut().for_each(|w| w.find_wet(fluid));
        fluid.update_pressure().unwrap();
        walls.iter_mut().for_each(|w| w.extrapolate(fluid, 1.0));
        if fluid.varies_viscosity() {
            fluid.update_strain();
            walls.iter_mut().for_each(|w| w.add_strains(fluid));
            fluid.update_viscosity();
        }
        fluid.update_accelerations();
        walls.iter_mut().for_each(|w| {
            w.add_forces(fluid);
        });
    }

    fn step(&mut self) {
        let dt = self.fluid.step_limits().smallest();
        self.fluid.kick(0.5 * dt);
        self.fluid.drift(0.5 * dt);
        self.fluid.refresh();
        let Self { fluid, walls, .. } = self;
        walls.iter_mut().for_each(|w| w.find_wet(fluid));
        fluid.update_rates();
        walls.iter_mut().for_each(|w| w.add_rates(fluid));
        fluid.advance_density(dt);
        fluid.drift(0.5 * dt);
        self.evaluate();
        self.fluid.kick(0.5 * dt);
        self.time += dt;
    }

    /// Steps to a time; returns how many.
    fn run(&mut self, until: f64) -> usize {
        let mut steps = 0;
        while self.time < until {
            self.step();
            steps += 1;
        }
        steps
    }

    /// Mean of a quantity over rows of particles: height and value.
    fn rows(&self, spacing: f64, of: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
        let p = self.fluid.particles();
        let mut sums = vec![(0.0, 0.0, 0.0); 200];
        for (a, x) in p.position.iter().enumerate() {
            let row = (x.z / spacing).max(0.0) as usize;
            let sum = &mut sums[row.min(199)];
            *sum = (sum.0 + x.z, sum.1 + of(a), sum.2 + 1.0);
        }
        sums.retain(|sum| 0.0 < sum.2);
        sums.iter().map(|s| (s.0 / s.2, s.1 / s.2)).collect()
    }

    fn profile(&self, spacing: f64) -> Vec<(f64, f64)> {
        self.rows(spacing, |a| self.fluid.particles().velocity[a].x)
    }
}

/// `∫ u dz` of rows.
fn flux(profile: &[(f64, f64)], spacing: f64) -> f64 {
    profile.iter().map(|(_, u)| u * spacing).sum()
}

/// A film of thickness `depth` on a slope of 5 degrees.
fn slope(angle_deg: f64) -> [f64; 2] {
    let angle = angle_deg.to_radians();
    [9.81 * angle.sin(), -9.81 * angle.cos()]
}

fn bingham(regularization: Regularization) -> Rheology {
    Rheology::Bingham {
        dynamic_viscosity: 2.0,
        yield_stress: 60.0,
        regularization,
    }
}

#[test]
fn a_bingham_film_slides_as_a_plug_on_a_sheared_layer() {
    let gravity = slope(5.0);
    let pull = DENSITY * gravity[0];
    for (name, regularization, rows) in [
        ("bilinear", Regularization::Bilinear(100.0), 40),
        ("Papanastasiou", Regularization::Papanastasiou(1.5), 40),
    ] {
        let layer = Layer {
            rows,
            gravity,
            viscosity: Viscosity::Rheological {
                rheology: bingham(regularization),
            },
            ..Layer::default()
        };
        let (depth, dp) = (layer.depth, layer.spacing());
        let yield_height = depth - 60.0 / pull;
        let plug = pull * yield_height * yield_height / (2.0 * 2.0);
        let exact = |z: f64| {
            let below = (1.0 - z / yield_height).max(0.0);
            plug * (1.0 - below * below)
        };
        let expected = plug * (depth - yield_height / 3.0);
        let mut flow = layer.flow(exact);
        let clock = std::time::Instant::now();
        for until in [0.02, 0.1, 0.25, 0.5] {
            let steps = flow.run(until);
            let profile = flow.profile(dp);
            let yielded = flow.rows(dp, |a| f64::from(u8::from(flow.fluid.is_yielded(a))));
            let height = yielded.iter().filter(|(_, y)| 0.5 < *y).count() as f64 * dp;
            println!(
                "{name} t {until}: {steps} steps {:.1} s, plug {:.4} flux {:.4} yield height {:.4}",
                clock.elapsed().as_secs_f64(),
                profile.last().unwrap().1 / plug,
                flux(&profile, dp) / expected,
                height / yield_height
            );
        }
    }
}
