//! Speed of the water: a dam break column between walls, before it falls and while it falls.
//!
//! `cargo bench -p riprap-sph --bench sph_evaluation -- [SPACING ...]`, SPACING in metres: 0.0116
//! (50,000 particles) when left out, 0.0074 (200,000), 0.0043 (a million).
//!
//! An evaluation is the density rates and the forces of all particles from fluid and walls at one
//! state. A step is kick-drift-kick, which needs as much. Pairs count each neighbour once per sum.

use std::time::Instant;

use riprap_sph::boundary::integral::Face;
use riprap_sph::boundary::sampling::{Region, UnionLattice, sample_union};
use riprap_sph::boundary::wall_particles::{Slip, WallParticles};
use riprap_sph::scheme::{DensityDiffusion, Viscosity};
use riprap_sph::{Dimensions, Fluid, FluidError, Precision, Scheme, Settings, Start, Vec3};

/// Steps timed while the column falls, after as many to warm up.
const STEPS: u32 = 10;
/// Evaluations timed; the fastest counts.
const ROUNDS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let spacings: Vec<f64> = std::env::args()
        .skip(1)
        .filter_map(|a| a.parse().ok())
        .collect();
    let spacings = if spacings.is_empty() {
        vec![0.0116]
    } else {
        spacings
    };
    print(&format!(
        "{:>9} {:>7} {:>6} {:>7} {:>8} {:>7} {:>9} {:>9} {:>9} {:>11} {:>11} {:>11} {:>9} {:>9}",
        "particles",
        "walls",
        "h/dp",
        "sums",
        "threads",
        "neighb.",
        "rates ns",
        "forces ns",
        "walls ns",
        "evals/s",
        "pairs/s",
        "p.steps/s",
        "s per s",
        "bytes/p."
    ));
    for dp in spacings {
        for (ratio, precision) in [
            (1.3, Precision::Single),
            (1.3, Precision::Double),
            (3.0_f64.sqrt(), Precision::Single),
        ] {
            let mut baseline = None;
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()?;
                let found = pool.install(|| measure(dp, ratio, precision))?;
                let scaling = found.evaluations / *baseline.get_or_insert(found.evaluations);
                print(&format!(
                    "{} {threads:>8} {} x {scaling:.2}",
                    found.head, found.row
                ));
            }
        }
    }
    Ok(())
}

#[expect(clippy::print_stdout, reason = "a benchmark prints")]
fn print(line: &str) {
    println!("{line}");
}

/// The column with its walls: a floor and four sides, open above.
struct Tank {
    fluid: Fluid,
    walls: WallParticles,
}

fn tank(dp: f64, ratio: f64, precision: Precision) -> Result<Tank, FluidError> {
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
            ..Scheme::standard()
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

/// Seconds of each part of an evaluation.
#[derive(Clone, Copy, Default)]
struct Parts {
    rates: f64,
    forces: f64,
    walls: f64,
}

impl Tank {
    fn rates(&mut self, parts: &mut Parts) {
        let start = Instant::now();
        self.fluid.update_rates();
        parts.rates += start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.walls.find_wet(&self.fluid);
        self.walls.add_rates(&mut self.fluid);
        parts.walls += start.elapsed().as_secs_f64();
    }

    fn forces(&mut self, parts: &mut Parts) -> Result<(), FluidError> {
        let start = Instant::now();
        self.fluid.update_pressure()?;
        parts.forces += start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.walls.find_wet(&self.fluid);
        self.walls.extrapolate(&self.fluid, 1.0);
        parts.walls += start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.fluid.update_accelerations();
        parts.forces += start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.walls.add_forces(&mut self.fluid);
        parts.walls += start.elapsed().as_secs_f64();
        Ok(())
    }

    fn step(&mut self, dt: f64) -> Result<(), FluidError> {
        let parts = &mut Parts::default();
        self.fluid.kick(0.5 * dt);
        self.fluid.drift(0.5 * dt);
        self.fluid.refresh();
        self.rates(parts);
        self.fluid.advance_density(dt);
        self.fluid.drift(0.5 * dt);
        self.fluid.refresh();
        self.forces(parts)?;
        self.fluid.kick(0.5 * dt);
        Ok(())
    }
}

/// What a line of the table holds.
struct Found {
    head: String,
    row: String,
    evaluations: f64,
}

fn measure(dp: f64, ratio: f64, precision: Precision) -> Result<Found, FluidError> {
    let before = resident_bytes();
    let mut tank = tank(dp, ratio, precision)?;
    let n = tank.fluid.particles().len() as f64;
    let mut best: Option<Parts> = None;
    let total = |parts: &Parts| parts.rates + parts.forces + parts.walls;
    for _ in 0..ROUNDS {
        let mut parts = Parts::default();
        tank.rates(&mut parts);
        tank.fluid.advance_density(0.0);
        tank.forces(&mut parts)?;
        if best.as_ref().is_none_or(|best| total(&parts) < total(best)) {
            best = Some(parts);
        }
    }
    let best = best.unwrap_or_default();
    let pairs = tank.fluid.n_pairs() as f64;
    let dt = tank.fluid.step_limits().smallest();
    for _ in 0..STEPS {
        tank.step(dt)?;
    }
    let start = Instant::now();
    for _ in 0..STEPS {
        tank.step(dt)?;
    }
    let step = start.elapsed().as_secs_f64() / f64::from(STEPS);
    let bytes = resident_bytes()
        .zip(before)
        .map_or(f64::NAN, |(a, b)| a - b);
    Ok(Found {
        head: format!(
            "{n:>9} {:>7} {ratio:>6.3} {:>7}",
            tank.walls.len(),
            match precision {
                Precision::Single => "f32",
                Precision::Double => "f64",
            }
        ),
        row: format!(
            "{:>7.1} {:>9.0} {:>9.0} {:>9.0} {:>11.3e} {:>11.3e} {:>11.3e} {:>9.0} {:>9.0}",
            pairs / n,
            1e9 * best.rates / n,
            1e9 * best.forces / n,
            1e9 * best.walls / n,
            n / total(&best),
            2.0 * pairs / total(&best),
            n / step,
            step / dt,
            bytes / n,
        ),
        evaluations: n / total(&best),
    })
}

/// Memory of this process, where the system says so; bytes.
fn resident_bytes() -> Option<f64> {
    let statm = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: f64 = statm.split_whitespace().nth(1)?.parse().ok()?;
    Some(pages * 4096.0)
}
