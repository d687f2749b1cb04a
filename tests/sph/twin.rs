//! Sums over neighbors against every pair there is.

use riprap_sph::boundary::wall_particles::{Slip, WallParticles};
use riprap_sph::kernel::{Kernel, PointKernel};
use riprap_sph::scheme::{DensityDiffusion, Shifting, Viscosity};
use riprap_sph::{
    Dimensions, Fluid, KernelChoice, Periodicity, Precision, Scheme, Settings, Start, Vec3,
};

use crate::support::Noise;

const H: f64 = 0.1;
const RADIUS: f64 = 2.0 * H;
const C0: f64 = 30.0;
const RHO: f64 = 1000.0;
const NU: f64 = 0.02;

/// Random particles and wall points in a box.
struct Crowd {
    /// Whether neighbors are listed before the particles move, and not where they have moved to.
    lists_first: bool,
    extent: Vec3,
    periodic: Periodicity,
    scheme: Scheme,
    dimensions: Dimensions,
}

/// Largest differences from the twin over the largest value there is.
#[derive(Debug, Default)]
struct Errors {
    acceleration: f64,
    rate: f64,
    wall_pressure: f64,
    reaction: f64,
    spread: f64,
}

impl Errors {
    fn largest(&self) -> f64 {
        let Self {
            acceleration,
            rate,
            wall_pressure,
            reaction,
            spread,
        } = *self;
        [rate, wall_pressure, reaction, spread]
            .into_iter()
            // a NaN is an error of any size
            .fold(acceleration, |a, b| if b <= a { a } else { b })
    }
}

/// The largest difference of two lists over the largest entry of the second.
fn relative(found: &[Vec3], expected: &[Vec3]) -> f64 {
    let largest = |v: &mut dyn Iterator<Item = f64>| v.fold(0.0, f64::max);
    assert_eq!(found.len(), expected.len());
    let difference = largest(&mut found.iter().zip(expected).map(|(a, b)| (a - b).norm()));
    let scale = largest(&mut expected.iter().map(|b| b.norm()));
    assert!(0.0 < scale, "nothing to compare");
    difference / scale
}

fn numbers(values: &[f64]) -> Vec<Vec3> {
    values.iter().map(|&x| Vec3::new(x, 0.0, 0.0)).collect()
}

impl Crowd {
    /// A lattice of 25 neighbors, in space and in the plane.
    fn spacing(&self) -> [f64; 3] {
        match self.dimensions {
            Dimensions::Three => [1.1 * H; 3],
            Dimensions::Two { width } => [0.7 * H, width, 0.7 * H],
        }
    }

    fn settings(&self) -> Settings {
        Settings {
            particle_spacing: self.spacing(),
            smoothing_length: H,
            reference_density: RHO,
            sound_speed: C0,
            scheme: self.scheme,
            dimensions: self.dimensions,
            gravity: Vec3::new(0.3, 0.0, -9.81),
            time_step_factor: 0.5,
            domain: (Vec3::zeros(), self.extent),
            periodic: self.periodic,
            symmetry: [[false; 2]; 3],
        }
    }

    fn places(&self, noise: &mut Noise, n: usize) -> Vec<Vec3> {
        (0..n)
            .map(|_| {
                let mut x = noise
                    .vector()
                    .zip_map(&self.extent, |s, l| 0.5 * (1.0 + s) * l);
                if let Dimensions::Two { .. } = self.dimensions {
                    x.y = 0.5 * self.extent.y;
                }
                x
            })
            .collect()
    }

    /// `x_a − x_b` of every pair of images closer than the support, with the index of b.
    fn near<'a>(
        &'a self,
        x: Vec3,
        others: &'a [Vec3],
    ) -> impl Iterator<Item = (usize, Vec3, f64)> + 'a {
        // two periods: a particle may have drifted out on one side and another on the other
        let reach = self.periodic.map(|p| if p { 2 } else { 0 });
        others.iter().enumerate().flat_map(move |(b, y)| {
            let images = (-reach[0]..=reach[0])
                .flat_map(move |i| (-reach[1]..=reach[1]).map(move |j| (i, j)))
                .flat_map(move |(i, j)| (-reach[2]..=reach[2]).map(move |k| [i, j, k]));
            images.filter_map(move |n| {
                let shift = Vec3::from(n.map(f64::from)).component_mul(&self.extent);
                let d = x - (y + shift);
                (d.norm() < RADIUS).then(|| (b, d, d.norm()))
            })
        })
    }

    /// Largest errors of all sums, after a drift of nearly the skin without a sort.
    fn errors(&self) -> Errors {
        let mut noise = Noise(7);
        // as many as fill the box
        let n = (self.extent.product() / self.spacing().iter().product::<f64>()) as usize;
        let positions = self.places(&mut noise, n);
        let flat = |mut v: Vec3| {
            if let Dimensions::Two { .. } = self.dimensions {
                v.y = 0.0;
            }
            v
        };
        let start = Start {
            velocities: (0..n).map(|_| flat(noise.vector())).collect(),
            pressures: (0..n).map(|_| 2e4 * (1.5 + noise.next())).collect(),
            positions,
        };
        let mut fluid = Fluid::new(start, self.settings()).unwrap();
        fluid.refresh();
        let n_walls = n / 6;
        let wall_places = self.places(&mut noise, n_walls);
        let wall_motion: Vec<[Vec3; 3]> = wall_places
            .iter()
            .map(|x| [*x, flat(noise.vector()), flat(noise.vector())])
            .collect();
        let volumes: Vec<f64> = (0..n_walls)
            .map(|_| fluid.particle_volume() * (1.0 + 0.5 * noise.next()))
            .collect();
        let mut walls = WallParticles::new(&fluid, volumes.clone(), Slip::None);
        // towards the middle, as far as without a sort
        let middle = (fluid.settings().domain.0 + fluid.settings().domain.1) * 0.5;
        let aside = 0.49 * fluid.skin();
        walls.place(|w| {
            let [x, v, a] = wall_motion[w];
            [x + flat((middle - x).normalize() * aside), v, a]
        });
        walls.find_wet(&fluid);

        if self.lists_first {
            fluid.update_rates();
            walls.add_rates(&mut fluid);
            walls.extrapolate(&fluid);
        }
        // the largest speed is known after a kick; then nearly as far as without a sort
        fluid.kick(0.0);
        fluid.drift(0.49 * fluid.skin() / fluid.max_speed());
        let ids = fluid.particles().id.clone();
        fluid.refresh();
        assert_eq!(ids, fluid.particles().id, "the drift is within the skin");
        assert!(0.0 < fluid.moved());

        walls.place(|w| wall_motion[w]);
        walls.find_wet(&fluid);
        assert!(!walls.sorted_at().is_empty(), "they have room left");
        fluid.update_pressure().unwrap();
        walls.extrapolate(&fluid);
        fluid.update_accelerations();
        let total = walls.add_forces(&mut fluid);
        let mut reactions = vec![Vec3::zeros(); n_walls];
        walls.visit_reactions(&fluid, |w, _, [pressure, viscous]| {
            reactions[w] = pressure + viscous
        });
        let sum: Vec3 = reactions.iter().sum();
        // action is reaction to the rounding of the pair sums; thousands of pairs
        let rounding = self.rounding() * reactions.iter().map(|f| f.norm()).sum::<f64>();
        assert!((sum + total).norm() < rounding, "{sum} {total}");

        let twin = Twin::new(self, &fluid, &wall_motion, &volumes);
        let acceleration = relative(&fluid.particles().acceleration, &twin.acceleration);
        let wall_pressure = relative(&numbers(walls.pressures()), &numbers(&twin.wall_pressure));
        let reaction = relative(&reactions, &twin.reaction);

        let dt = 1e-6;
        let mut shifted = fluid.clone();
        shifted.update_concentration();
        walls.add_concentrations(&mut shifted);
        shifted.shift(dt);
        let p = fluid.particles();
        let shifts: Vec<Vec3> = (0..n)
            .map(|a| {
                (shifted.particles().position[a] - p.position[a]) / (dt * p.velocity[a].norm())
            })
            .collect();
        let before = fluid.particles().density.clone();
        fluid.update_rates();
        walls.add_rates(&mut fluid);
        fluid.advance_density(dt);
        let rates: Vec<f64> = fluid
            .particles()
            .density
            .iter()
            .zip(&before)
            .map(|(after, before)| (after - before) / dt)
            .collect();
        // particles almost alone are put back to the reference density
        let crowded = |of: &[f64]| -> Vec<Vec3> {
            let few = |a: &usize| 8 < twin.n_found[*a];
            numbers(&(0..n).filter(few).map(|a| of[a]).collect::<Vec<f64>>())
        };
        assert!(
            n * 3 / 4 < crowded(&rates).len(),
            "{n} particles are too few"
        );
        let rate = relative(&crowded(&rates), &crowded(&twin.rate));

        Errors {
            acceleration,
            rate,
            wall_pressure,
            reaction,
            spread: relative(&shifts, &twin.shift),
        }
    }

    fn rounding(&self) -> f64 {
        match self.scheme.precision {
            Precision::Single => 1e-5,
            Precision::Double => 1e-12,
        }
    }
}

/// Reference sums, in plain loops over all pairs.
struct Twin {
    acceleration: Vec<Vec3>,
    rate: Vec<f64>,
    n_found: Vec<usize>,
    wall_pressure: Vec<f64>,
    reaction: Vec<Vec3>,
    shift: Vec<Vec3>,
}

impl Twin {
    fn new(crowd: &Crowd, fluid: &Fluid, walls: &[[Vec3; 3]], volumes: &[f64]) -> Self {
        let s = fluid.settings();
        let p = fluid.particles();
        let kernel = PointKernel::new(s.scheme.kernel, RADIUS, s.dimensions);
        let volume = |b: usize| p.mass[b] / p.density[b];
        let places: Vec<Vec3> = walls.iter().map(|w| w[0]).collect();
        let dims = s.dimensions.count();
        // force per volume of a: pressure of the pair and jump of velocity given
        let pair = |d: &Vec3, r: f64, joint: f64, jump: &Vec3| {
            let w = kernel.gradient_factor(r);
            let soft = r * r + 0.01 * H * H;
            let viscous = match s.scheme.viscosity {
                // the twin knows the viscosities of the boxes below; the others have tests of their own
                Viscosity::None
                | Viscosity::Published { .. }
                | Viscosity::Rheological { .. }
                | Viscosity::SubParticleScale { .. } => Vec3::zeros(),
                Viscosity::Artificial { alpha } => {
                    d * (RHO * alpha * C0 * H * w * jump.dot(d).min(0.0) / soft)
                }
                Viscosity::Laminar { .. } => {
                    d * (2.0 * (dims + 2.0) * RHO * NU * w * jump.dot(d) / soft)
                }
                Viscosity::Morris { .. } => jump * (2.0 * RHO * NU * w * r * r / soft),
            };
            viscous - d * (joint * w)
        };
        let face = |p_a: f64, p_b: f64| {
            let (a, b) = (RHO + p_a / (C0 * C0), RHO + p_b / (C0 * C0));
            2.0 * (b * p_a + a * p_b) / (a + b)
        };

        let (mut wall_pressure, mut seen) = (Vec::new(), Vec::new());
        for [x, v, a] in walls {
            let (mut weight, mut pressure, mut velocity) = (0.0, 0.0, Vec3::zeros());
            for (b, d, r) in crowd.near(*x, &p.position) {
                let w = volume(b) * kernel.value(r);
                let density = RHO + p.pressure[b] / (C0 * C0);
                weight += w;
                pressure += w * (p.pressure[b] + density * (s.gravity - a).dot(&d));
                velocity += p.velocity[b] * w;
            }
            let wet = 0.0 < weight;
            wall_pressure.push(if wet {
                (pressure / weight).max(0.0)
            } else {
                0.0
            });
            seen.push(if wet { v * 2.0 - velocity / weight } else { *v });
        }

        let n = p.len();
        let mut twin = Self {
            acceleration: vec![s.gravity; n],
            rate: vec![0.0; n],
            n_found: vec![0; n],
            reaction: vec![Vec3::zeros(); walls.len()],
            shift: vec![Vec3::zeros(); n],
            wall_pressure,
        };
        let hydrostatic = s.gravity * (-RHO / (C0 * C0));
        let gradients = twin_gradients(crowd, fluid, &kernel);
        for a in 0..n {
            let (mut spread, mut divergence) = (Vec3::zeros(), 0.0);
            let (mut flow, mut diffusion) = (0.0, 0.0);
            for (b, d, r) in crowd.near(p.position[a], &p.position) {
                let jump = p.velocity[a] - p.velocity[b];
                let joint = p.pressure[a] + p.pressure[b];
                twin.acceleration[a] += pair(&d, r, joint, &jump) * (volume(b) / p.density[a]);
                let w = volume(b) * kernel.gradient_factor(r);
                flow += p.density[a] * w * jump.dot(&d);
                let rise = p.density[b] - p.density[a];
                let part = -2.0 * r * r / (r * r + 0.01 * H * H);
                let (delta, psi) = match s.scheme.diffusion {
                    DensityDiffusion::None => (0.0, 0.0),
                    DensityDiffusion::MolteniColagrossi(delta) => (delta, part * rise),
                    DensityDiffusion::Fourtakas(delta) => {
                        (delta, part * (rise - hydrostatic.dot(&d)))
                    }
                    DensityDiffusion::Antuono(delta) => {
                        (delta, part * rise - (gradients[a] + gradients[b]).dot(&d))
                    }
                };
                diffusion += delta * H * C0 * w * psi;
                spread += d * w;
                divergence -= w * r * r;
                twin.n_found[a] += 1;
            }
            for (b, d, r) in crowd.near(p.position[a], &places) {
                let joint = face(p.pressure[a], twin.wall_pressure[b]);
                let force = pair(&d, r, joint, &(p.velocity[a] - seen[b]));
                twin.acceleration[a] += force * (volumes[b] / p.density[a]);
                twin.reaction[b] -= force * (volumes[b] * volume(a));
                let w = volumes[b] * kernel.gradient_factor(r);
                flow += p.density[a] * w * (p.velocity[a] - walls[b][1]).dot(&d);
                spread += d * w;
                divergence -= w * r * r;
                twin.n_found[a] += 1;
            }
            // crowded water
            let sound = (1.25 * dims / divergence.max(1.25 * dims)).powf(1.5);
            twin.rate[a] = sound * (sound * flow + diffusion);
            let none = if dims == 2.0 { 1.5 } else { 2.75 };
            let fade = ((divergence - none) / (dims - none)).clamp(0.0, 1.0);
            twin.shift[a] = spread * (-2.0 * H * fade);
        }
        twin
    }
}

/// Renormalised gradients of density.
fn twin_gradients(crowd: &Crowd, fluid: &Fluid, kernel: &PointKernel) -> Vec<Vec3> {
    let p = fluid.particles();
    p.position
        .iter()
        .enumerate()
        .map(|(a, x)| {
            let mut b_matrix = nalgebra::Matrix3::zeros();
            let mut sum = Vec3::zeros();
            for (b, d, r) in crowd.near(*x, &p.position) {
                let w = p.mass[b] / p.density[b] * kernel.gradient_factor(r);
                b_matrix -= d * d.transpose() * w;
                sum += d * (w * (p.density[b] - p.density[a]));
            }
            if let Dimensions::Two { .. } = crowd.dimensions {
                b_matrix[(1, 1)] = 1.0;
            }
            if 1e-2 < b_matrix.determinant() {
                b_matrix.try_inverse().unwrap() * sum
            } else {
                Vec3::zeros()
            }
        })
        .collect()
}

fn scheme(precision: Precision, viscosity: Viscosity, diffusion: DensityDiffusion) -> Scheme {
    Scheme {
        precision,
        viscosity,
        diffusion,
        shifting: Shifting::Fickian { coefficient: 2.0 },
        ..Scheme::artificial()
    }
}

const LAMINAR: Viscosity = Viscosity::Laminar {
    kinematic_viscosity: NU,
};
const MORRIS: Viscosity = Viscosity::Morris {
    kinematic_viscosity: NU,
};
const ARTIFICIAL: Viscosity = Viscosity::Artificial { alpha: 0.3 };

fn check(name: &str, crowd: &Crowd) {
    let errors = crowd.errors();
    println!("twin, {name}, {:?}: {errors:?}", crowd.scheme.precision);
    let limit = match crowd.scheme.precision {
        // 7 digits of each pair, some 30 pairs of either sign, and pressures of 2e4 Pa that a
        // difference of velocities does not know of; measured 1e-6
        Precision::Single => 1e-5,
        // 15 digits; the rate is a difference over 1e-6 s of a density of 1e3 that changes by
        // 1e-2, the shift one of positions of 1 by 1e-7
        Precision::Double => 1e-8,
    };
    assert!(errors.largest() < limit, "{name}: {errors:?}");
    // what is not found by differences
    let exact = errors
        .acceleration
        .max(errors.wall_pressure)
        .max(errors.reaction);
    assert!(
        crowd.scheme.precision == Precision::Single || exact < 1e-12,
        "{name}: {errors:?}"
    );
}

#[test]
fn sums_are_those_of_all_pairs_in_every_box() {
    let (wide, narrow) = (0.9, 1.06 * RADIUS);
    let boxes = [
        ("closed", [wide; 3], [false; 3]),
        ("x", [wide; 3], [true, false, false]),
        ("y", [wide; 3], [false, true, false]),
        ("z", [wide; 3], [false, false, true]),
        ("xyz", [wide; 3], [true; 3]),
        ("narrow x", [narrow, wide, wide], [true, false, false]),
        ("narrow y", [wide, narrow, wide], [false, true, false]),
        ("narrow z", [wide, wide, narrow], [true, false, true]),
        (
            "narrow y of 1.7",
            [wide, 1.7 * RADIUS, wide],
            [false, true, false],
        ),
        ("narrow xyz of 1.5", [1.5 * RADIUS; 3], [true; 3]),
    ];
    for (name, extent, periodic) in boxes {
        for precision in [Precision::Single, Precision::Double] {
            let diffusion = DensityDiffusion::Fourtakas(0.1);
            for lists_first in [false, true] {
                let crowd = Crowd {
                    lists_first,
                    extent: Vec3::from(extent),
                    periodic,
                    scheme: scheme(precision, LAMINAR, diffusion),
                    dimensions: Dimensions::Three,
                };
                check(name, &crowd);
            }
        }
    }
}

#[test]
fn sums_are_those_of_all_pairs_for_every_term() {
    let terms = [
        (ARTIFICIAL, DensityDiffusion::None, KernelChoice::WendlandC2),
        (
            MORRIS,
            DensityDiffusion::MolteniColagrossi(0.1),
            KernelChoice::WendlandC2,
        ),
        (
            Viscosity::None,
            DensityDiffusion::Antuono(0.1),
            KernelChoice::WendlandC2,
        ),
        (
            LAMINAR,
            DensityDiffusion::Fourtakas(0.1),
            KernelChoice::CubicSpline,
        ),
    ];
    let slice = Dimensions::Two { width: 1.0 };
    for (viscosity, diffusion, kernel) in terms {
        for (dimensions, extent, periodic) in [
            (Dimensions::Three, [0.9; 3], [true, false, true]),
            (slice, [1.5, 1.0, 1.5], [true, false, false]),
        ] {
            for precision in [Precision::Single, Precision::Double] {
                let crowd = Crowd {
                    lists_first: true,
                    extent: Vec3::from(extent),
                    periodic,
                    scheme: Scheme {
                        kernel,
                        ..scheme(precision, viscosity, diffusion)
                    },
                    dimensions,
                };
                check(&format!("{viscosity:?} {diffusion:?} {kernel:?}"), &crowd);
            }
        }
    }
}
