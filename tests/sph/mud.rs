//! Fluids with a yield stress, against closed forms.
//!
//! Flows along x are those of a film or of a channel of one period; a slope is gravity that leans.

use riprap_sph::boundary::wall_particles::{Slip, WallParticles};
use riprap_sph::scheme::{SMAGORINSKY, Viscosity};
use riprap_sph::state_equation::State;
use riprap_sph::{
    Boundary, Dimensions, Fluid, FluidError, Precision, Regularization, Rheology, Scheme, Settings,
    Stage, Start, Vec3, ViscousStep,
};

pub const DENSITY: f64 = 1500.0;

/// A layer of fluid along x, periodic, on a floor and perhaps under a lid.
pub struct Layer {
    pub rows: usize,
    pub depth: f64,
    /// Period over spacing.
    pub columns: usize,
    /// Acceleration along x and z; m/s².
    pub gravity: [f64; 2],
    pub lid: Option<Vec3>,
    pub slip: Slip,
    pub viscosity: Viscosity,
    pub viscous_step: ViscousStep,
    pub precision: Precision,
    pub sound_speed: f64,
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
            viscous_step: ViscousStep::Explicit,
            precision: Precision::Single,
            sound_speed: 10.0,
        }
    }
}

pub struct Flow {
    pub fluid: Fluid,
    pub walls: Vec<WallParticles>,
    pub time: f64,
}

/// Smoothing length over spacing.
const RATIO: f64 = 2.0;

impl Layer {
    pub fn spacing(&self) -> f64 {
        self.depth / self.rows as f64
    }

    /// The layer with the given profile of velocity.
    pub fn flow(&self, profile: impl Fn(f64) -> f64) -> Flow {
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
                viscous_step: self.viscous_step,
                precision: self.precision,
                ..Scheme::artificial()
            },
            dimensions: Dimensions::Two { width: 1.0 },
            gravity: Vec3::new(self.gravity[0], 0.0, self.gravity[1]),
            time_step_factor: 0.5,
            domain: (
                Vec3::new(0.0, 0.0, -5.0 * dp),
                Vec3::new(period, 1.0, self.depth + 10.0 * dp),
            ),
            periodic: [true, false, false],
            symmetry: [[false; 2]; 3],
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

/// Floor and lid, at rest or sliding in their planes.
struct Plates<'a>(&'a mut [WallParticles]);

impl Boundary for Plates<'_> {
    type Error = FluidError;

    fn place(&mut self, fluid: &mut Fluid, _stage: Stage, _dt: f64) {
        self.0.iter_mut().for_each(|w| w.find_wet(fluid));
    }

    fn density_rates(&mut self, fluid: &mut Fluid) {
        self.0.iter_mut().for_each(|w| w.add_rates(fluid));
    }

    fn continue_pressure(&mut self, fluid: &mut Fluid) {
        self.0.iter_mut().for_each(|w| w.extrapolate(fluid));
    }

    fn strain_rates(&mut self, fluid: &mut Fluid) {
        self.0.iter_mut().for_each(|w| w.add_strains(fluid));
    }

    fn forces(&mut self, fluid: &mut Fluid) {
        self.0.iter_mut().for_each(|w| {
            w.add_forces(fluid);
        });
    }

    fn resistance(&mut self, fluid: &mut Fluid) {
        self.0.iter_mut().for_each(|w| w.add_resistance(fluid));
    }
}

impl Flow {
    fn evaluate(&mut self) {
        let mut plates = Plates(&mut self.walls);
        self.fluid.evaluate(&mut plates, 0.0).unwrap();
    }

    pub fn step(&mut self) {
        let dt = self.fluid.step_limits().smallest();
        let mut plates = Plates(&mut self.walls);
        self.fluid.step(&mut plates, dt).unwrap();
        self.time += dt;
    }

    /// Steps to a time; returns how many.
    pub fn run(&mut self, until: f64) -> usize {
        let mut steps = 0;
        while self.time < until {
            self.step();
            steps += 1;
        }
        steps
    }

    /// Mean of a quantity over rows of particles: height and value.
    pub fn rows(&self, spacing: f64, of: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
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

    pub fn profile(&self, spacing: f64) -> Vec<(f64, f64)> {
        self.rows(spacing, |a| self.fluid.particles().velocity[a].x)
    }
}

/// `∫ u dz` of rows.
pub fn flux(profile: &[(f64, f64)], spacing: f64) -> f64 {
    profile.iter().map(|(_, u)| u * spacing).sum()
}

/// A film of thickness `depth` on a slope of 5 degrees.
pub fn slope(angle_deg: f64) -> [f64; 2] {
    let angle = angle_deg.to_radians();
    [9.81 * angle.sin(), -9.81 * angle.cos()]
}

pub fn bingham(regularization: Regularization) -> Rheology {
    Rheology::Bingham {
        dynamic_viscosity: 2.0,
        yield_stress: 60.0,
        regularization,
    }
}

/// One thread: these flows are too small to share, and tests share the processor.
pub fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.unwrap().install(work)
}

/// Height at which a linear function through values at heights vanishes, least squares.
pub fn zero_of_line(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (z, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - z) * (p.1 - y)) / mean(&|p| (p.0 - z).powi(2));
    z - y / slope
}

#[test]
fn a_bingham_film_slides_as_a_plug_on_a_sheared_layer() {
    let gravity = slope(5.0);
    let pull = DENSITY * gravity[0];
    for (name, regularization) in [
        // 100 times the plastic viscosity
        ("bilinear", Regularization::Bilinear(200.0)),
        ("Papanastasiou", Regularization::Papanastasiou(2.0)),
    ] {
        let layer = Layer {
            gravity,
            viscosity: Viscosity::Rheological {
                rheology: bingham(regularization),
            },
            ..Layer::default()
        };
        let (depth, dp) = (layer.depth, layer.spacing());
        let yield_height = depth - 60.0 / pull;
        let plug = pull * yield_height * yield_height / (2.0 * 2.0);
        // 0.053216 m, 0.907998 m/s and 0.074693 m²/s
        assert!((yield_height - 0.053_216).abs() < 1e-6 && (plug - 0.907_998).abs() < 1e-4);
        let exact = |z: f64| {
            let below = (1.0 - z / yield_height).max(0.0);
            plug * (1.0 - below * below)
        };
        let expected = plug * (depth - yield_height / 3.0);
        // the sheared layer forgets in ρ z²/(2.5 μ) = 0.9 s what it was given
        let flow = alone(|| {
            let mut flow = layer.flow(exact);
            let steps = flow.run(0.4);
            println!("{name}: {steps} steps");
            flow
        });
        let profile = flow.profile(dp);
        let rates = flow.rows(dp, |a| flow.fluid.particles().shear_rate[a]);
        let sheared: Vec<_> = rates
            .into_iter()
            .filter(|(z, _)| (0.2..0.7).contains(&(z / yield_height)))
            .collect();
        let ratios = [
            profile.last().unwrap().1 / plug,
            flux(&profile, dp) / expected,
            zero_of_line(&sheared) / yield_height,
        ];
        println!("{name}: plug speed, flux, yield height over exact {ratios:.4?}");
        // the plug itself creeps: (H/z − 1)² μ/η_max adds 0.8 % to its speed
        assert!(ratios.iter().all(|r| (r - 1.0).abs() < 0.03), "{ratios:?}");
    }
}

#[test]
fn a_film_below_yield_only_creeps() {
    // thinner than τ/(ρ g sin θ) = 46.8 mm
    let gravity = slope(5.0);
    let largest = 200.0;
    let layer = Layer {
        rows: 16,
        depth: 0.04,
        gravity,
        viscosity: Viscosity::Rheological {
            rheology: bingham(Regularization::Bilinear(largest)),
        },
        ..Layer::default()
    };
    // ρ H²/(2.5 η) = 5 ms to come to rest
    let flow = alone(|| {
        let mut flow = layer.flow(|_| 0.0);
        flow.run(0.05);
        flow
    });
    let speed = flow.profile(layer.spacing()).last().unwrap().1;
    let creep = DENSITY * gravity[0] * layer.depth.powi(2) / (2.0 * largest);
    println!("creep: {:.4} of ρ g sin θ H²/(2 η_max)", speed / creep);
    assert!((1.0 / 1.2..1.2).contains(&(speed / creep)), "{speed}");
}

/// Channel between plates `width` apart under a body force: speed at a height, for `τ = K γ̇ⁿ + τ_y`.
///
/// ```text
/// u = (n/(n+1)) (G/K)^(1/n) (w^((n+1)/n) − (|y| − y₀)₊^((n+1)/n)),   w = L/2 − y₀,  y₀ = τ_y/G
/// ```
fn channel(z: f64, width: f64, [pull, consistency, exponent, yield_stress]: [f64; 4]) -> f64 {
    let plug = yield_stress / pull;
    let power = (exponent + 1.0) / exponent;
    let beyond = ((z - 0.5 * width).abs() - plug).max(0.0);
    let factor = (pull / consistency).powf(1.0 / exponent) / power;
    factor * ((0.5 * width - plug).powf(power) - beyond.powf(power))
}

#[test]
fn channels_of_yield_stress_fluids_have_the_plug_of_the_closed_form() {
    let width = 0.1;
    let pull = 2000.0;
    // half-width of the plug 0.025 m: a quarter of the channel
    let yield_stress = 50.0;
    for (name, consistency, exponent, bound) in [
        ("Bingham", 2.0, 1.0, 0.03),
        // measured 0.947 for the half-width, 0.8 spacings: the blur at the yield surface, where a fluid
        // that thins has its steepest viscosity, tilts the line that is extrapolated
        ("Herschel-Bulkley", 4.0, 0.7, 0.06),
    ] {
        let law = [pull, consistency, exponent, yield_stress];
        let layer = Layer {
            // 15 rows in each sheared layer, of which the kernel blurs the last four
            rows: 60,
            depth: width,
            gravity: [pull / DENSITY, 0.0],
            lid: Some(Vec3::zeros()),
            viscosity: Viscosity::Rheological {
                rheology: Rheology::HerschelBulkley {
                    consistency,
                    exponent,
                    yield_stress,
                    regularization: Regularization::Bilinear(200.0),
                },
            },
            ..Layer::default()
        };
        let dp = layer.spacing();
        let exact = |z: f64| channel(z, width, law);
        let flow = alone(|| {
            let mut flow = layer.flow(exact);
            flow.run(0.2);
            flow
        });
        let profile = flow.profile(dp);
        let rates = flow.rows(dp, |a| flow.fluid.particles().shear_rate[a].powf(exponent));
        // K γ̇ⁿ = G (|y| − y₀) in the sheared layer by the floor, y₀ + its thickness = L/2
        let sheared: Vec<_> = rates
            .into_iter()
            .filter(|(z, _)| (0.2..0.6).contains(&(z / (0.5 * width - yield_stress / pull))))
            .collect();
        let plug = 0.5 * width - zero_of_line(&sheared);
        let expected: f64 = profile.iter().map(|(z, _)| exact(*z) * dp).sum();
        let ratios = [
            profile[profile.len() / 2].1 / exact(0.5 * width),
            flux(&profile, dp) / expected,
            plug / (yield_stress / pull),
        ];
        println!(
            "{name} channel: plug speed, flux, half-width of the plug over exact {ratios:.4?}"
        );
        assert!(
            ratios[..2].iter().all(|r| (r - 1.0).abs() < 0.03),
            "{ratios:?}"
        );
        assert!((ratios[2] - 1.0).abs() < bound, "{ratios:?}");
    }
}

#[test]
fn bingham_couette_shears_evenly_and_starts_from_rest() {
    // the lid at 0.4 m/s over 0.02 m: 20/s everywhere, stress τ_y + μ γ̇ = 100 Pa
    let layer = Layer {
        rows: 20,
        depth: 0.02,
        lid: Some(Vec3::new(0.4, 0.0, 0.0)),
        viscosity: Viscosity::Rheological {
            rheology: bingham(Regularization::Bilinear(50.0)),
        },
        ..Layer::default()
    };
    let dp = layer.spacing();
    let flow = alone(|| {
        let mut flow = layer.flow(|_| 0.0);
        // ρ L²/(π² μ) = 30 ms
        flow.run(0.15);
        flow
    });
    let worst = flow
        .profile(dp)
        .iter()
        .map(|(z, u)| (u / (20.0 * z) - 1.0).abs().min((u - 20.0 * z).abs() / 0.4))
        .fold(0.0, f64::max);
    let stress = flow.rows(dp, |a| {
        let p = flow.fluid.particles();
        p.viscosity[a] * p.shear_rate[a]
    });
    let stress: Vec<f64> = stress.iter().map(|(_, s)| s / 100.0).collect();
    println!(
        "Couette: profile off by {worst:.4} of the lid's speed, stress over exact {stress:.3?}"
    );
    assert!(worst < 0.03, "{worst}");
    let middle = stress[stress.len() / 2];
    assert!((middle - 1.0).abs() < 0.03, "{middle}");
}

#[test]
fn a_newtonian_flow_law_is_morris() {
    let (nu, double) = (2e-3, Precision::Double);
    let run = |viscosity| {
        let layer = Layer {
            rows: 10,
            gravity: slope(5.0),
            viscosity,
            precision: double,
            ..Layer::default()
        };
        alone(|| {
            let mut flow = layer.flow(|z| 3.0 * z + (50.0 * z).sin());
            for _ in 0..100 {
                flow.step();
            }
            flow
        })
    };
    let law = Rheology::Newtonian {
        dynamic_viscosity: DENSITY * nu,
    };
    let flows = [
        Viscosity::Morris {
            kinematic_viscosity: nu,
        },
        Viscosity::Rheological { rheology: law },
        Viscosity::SubParticleScale {
            kinematic_viscosity: nu,
            smagorinsky: 0.0,
        },
    ]
    .map(run);
    for other in &flows[1..] {
        // sorts come as often as sums between them make worth while, and a law takes another sum
        let by_id = |fluid: &Fluid| -> Vec<Vec3> {
            let p = fluid.particles();
            let mut of: Vec<_> = p.id.iter().zip(&p.velocity).collect();
            of.sort_by_key(|(id, _)| **id);
            of.into_iter().map(|(_, v)| *v).collect()
        };
        let (a, b) = (by_id(&flows[0].fluid), by_id(&other.fluid));
        assert_eq!(a.len(), b.len());
        let worst = a
            .iter()
            .zip(&b)
            .map(|(a, b)| (a - b).norm())
            .fold(0.0, f64::max);
        println!("Newtonian law against Morris after 100 steps: {worst:.1e} m/s");
        // round-off, no more; measured 1.4e-15
        assert!(worst < 1e-12, "{worst}");
    }
}

#[test]
fn eddies_smaller_than_the_spacing_add_their_viscosity() {
    // even shear: ν + (C dp)² γ̇ everywhere, the walls included
    let layer = Layer {
        rows: 20,
        lid: Some(Vec3::new(5.0, 0.0, 0.0)),
        viscosity: Viscosity::SubParticleScale {
            kinematic_viscosity: 1e-6,
            smagorinsky: SMAGORINSKY,
        },
        ..Layer::default()
    };
    let flow = layer.flow(|z| 50.0 * z);
    let expected = DENSITY * (1e-6 + (SMAGORINSKY * layer.spacing()).powi(2) * 50.0);
    let viscosity = flow.rows(layer.spacing(), |a| {
        flow.fluid.apparent_viscosity(a) / expected
    });
    println!("sub-particle viscosity over exact: {viscosity:.4?}");
    let middle = viscosity[10].1;
    assert!((middle - 1.0).abs() < 1e-4, "{middle}");
    // walls continue the velocity by a mean and not by a line: the first row sees 0.903
    assert!(viscosity.iter().all(|(_, v)| (v - 1.0).abs() < 0.12));
}

#[test]
fn two_fluids_share_the_stress_of_a_couette_flow() {
    // layers of 1 and 4 Pa s in series: speeds of 0.8 and 0.2 of the lid's over the two halves
    let law = |dynamic_viscosity| Rheology::Newtonian { dynamic_viscosity };
    let layer = Layer {
        rows: 20,
        depth: 0.02,
        lid: Some(Vec3::new(0.1, 0.0, 0.0)),
        viscosity: Viscosity::Rheological { rheology: law(1.0) },
        ..Layer::default()
    };
    let flow = alone(|| {
        let mut flow = layer.flow(|_| 0.0);
        let particles = flow.fluid.particles();
        let mut kinds = vec![0; particles.len()];
        for (id, x) in particles.id.iter().zip(&particles.position) {
            kinds[id.index()] = u8::from(0.01 < x.z);
        }
        let laws = vec![law(1.0), law(4.0)];
        assert!(flow.fluid.set_rheologies(laws.clone(), &[2]).is_err());
        flow.fluid.set_rheologies(laws, &kinds).unwrap();
        flow.run(1.0);
        flow
    });
    let middle = flow
        .profile(layer.spacing())
        .windows(2)
        .find(|rows| 0.01 <= rows[1].0)
        .map_or(0.0, |rows| 0.5 * (rows[0].1 + rows[1].1));
    println!(
        "two layers: interface at {:.4} of the lid's speed",
        middle / 0.1
    );
    assert!((middle / 0.1 - 0.8).abs() < 0.03, "{middle}");
}

#[test]
fn coulomb_friction_along_a_wall_holds_and_lets_go() {
    // a slab stiffer than the slope can shear, tan 10° = 0.176
    let gravity = slope(10.0);
    let coefficient = |degrees: f64| degrees.to_radians().tan();
    for (degrees, slides) in [
        (20.0, 0.0),
        (5.0, gravity[0] + coefficient(5.0) * gravity[1]),
    ] {
        let layer = Layer {
            rows: 10,
            depth: 0.05,
            gravity,
            slip: Slip::Friction(coefficient(degrees)),
            viscosity: Viscosity::Rheological {
                rheology: Rheology::Newtonian {
                    dynamic_viscosity: 2000.0,
                },
            },
            ..Layer::default()
        };
        let flow = alone(|| {
            let mut flow = layer.flow(|_| 0.0);
            flow.run(0.1);
            flow
        });
        let speed = flow.profile(layer.spacing())[5].1;
        let expected = slides * flow.time;
        println!("friction {degrees}°: {speed:.4} m/s against {expected:.4}");
        let free = gravity[0] * flow.time;
        // what sticks creeps by ρ g sin θ H²/(2 η) = 2 mm/s
        assert!((speed - expected).abs() < 0.03 * free, "{speed} {expected}");
    }
}

#[test]
fn what_viscosity_takes_from_mud_is_in_the_ledger() {
    // a sheared layer between plates slows down; nothing pulls
    let layer = Layer {
        rows: 16,
        lid: Some(Vec3::zeros()),
        viscosity: Viscosity::Rheological {
            rheology: bingham(Regularization::Bilinear(50.0)),
        },
        ..Layer::default()
    };
    let flow = alone(|| {
        let mut flow = layer.flow(|z| 2.0 * (1.0 - (20.0 * z - 1.0).powi(2)));
        flow.fluid.open_ledger();
        flow
    });
    let mut flow = flow;
    let before = flow.fluid.energies();
    alone(|| flow.run(0.05));
    let after = flow.fluid.energies();
    let lost = before.kinetic + before.internal - after.kinetic - after.internal;
    let booked = after.viscous + after.diffusive;
    println!(
        "mud at rest: kinetic {:.3e} -> {:.3e} J, lost {lost:.6e}, booked {booked:.6e}",
        before.kinetic, after.kinetic
    );
    assert!(after.kinetic < 0.9 * before.kinetic);
    // measured 1e-6, the digits of the viscous accelerations
    assert!((booked / lost - 1.0).abs() < 1e-4, "{booked} {lost}");
}
