//! The step beyond its bound, per solver and coupled, and water back in time.

use riprap_dda::{
    Blocks, Deformability, DeformableModel, Elastic, Load, Material, Settings, StressLaw,
};
use riprap_sph::scheme::{DensityDiffusion, Viscosity};
use riprap_sph::{Dimensions, Fluid, NoBoundary, ParticleId, Precision, Scheme, Start, Vec3};

use crate::rock::{G, Random, cuboid, down, floor, free, placed, rock};
use crate::row::{Failure, Length, Row, Trial, sweep};
use crate::tank::{self, Tank, max_speed};
use riprap::time_step::{BlockSteps, Cause, TimeStep};

pub const TRIALS: &[Trial] = &[
    Trial {
        id: "X11",
        subject: "step over its bound: blocks",
        run: blocks,
    },
    Trial {
        id: "X11",
        subject: "step over its bound: water",
        run: water,
    },
    Trial {
        id: "X11",
        subject: "step over its bound: coupled",
        run: coupled,
    },
];

/// Water that nothing drives is not this fast; m/s.
const WILD: f64 = 8.0;
/// Shares of the bound that are tried first.
const SHARES: [f64; 12] = [0.5, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0];

/// Systems at rest, without losses, the whole bound.
fn systems() -> Result<Vec<(&'static str, Blocks)>, Failure> {
    let elastic = Material {
        restitution: 1.0,
        friction_angle: 1.5,
        elastic: Some(Elastic {
            young_modulus: 1e9,
            poisson_ratio: 0.25,
            viscosity: 0.0,
        }),
        shear_damping_ratio: 0.0,
        ..rock()
    };
    let settings = Settings {
        gravity: down(),
        time_step_factor: 1.0,
        ..Settings::default()
    };
    let still = Settings {
        gravity: Vec3::zeros(),
        ..settings
    };
    let sunk = 2500.0 * G / 1e8;
    // each sunk into the one below by the weight of what it carries
    let stack = |sizes: &[[f64; 2]]| -> Result<Vec<_>, Failure> {
        let mut definitions = vec![floor()?];
        let weight = |[side, height]: &[f64; 2]| 2500.0 * G * side * side * height;
        let mut top = 0.0;
        for (k, &[side, height]) in sizes.iter().enumerate() {
            let carried: f64 = sizes[k..].iter().map(weight).sum();
            let (h, bottom) = (0.5 * side, top - carried / 1e8);
            let shape = cuboid([-h, -h, bottom], [h, h, bottom + height])?;
            top = bottom + height;
            definitions.push(free(shape, [0.0; 3]));
        }
        Ok(definitions)
    };
    let mut ball = free(cuboid([0.0; 3], [1.0; 3])?, [0.0; 3]);
    ball.shape = riprap_dda::Shape::Sphere {
        center: Vec3::new(0.0, 0.0, 0.5 - sunk),
        radius: 0.5,
    };
    let mut strained = free(
        placed([1.0, 0.7, 0.4], Vec3::zeros(), Vec3::zeros())?,
        [0.0; 3],
    );
    strained.deformability = Some(Deformability {
        model: DeformableModel::Affine12(StressLaw::SaintVenantKirchhoff),
        ..Deformability::default()
    });
    let cube = free(cuboid([0.0, 0.0, -sunk], [1.0, 1.0, 1.0 - sunk])?, [0.0; 3]);
    let make = |definitions, settings| Blocks::new(definitions, vec![elastic], settings);
    Ok(vec![
        ("a cube on a floor", make(vec![floor()?, cube], settings)?),
        ("a ball on a floor", make(vec![floor()?, ball], settings)?),
        (
            "an elastic box in free flight",
            make(vec![strained], still)?,
        ),
        (
            "five cubes in a column",
            make(stack(&[[1.0, 1.0]; 5])?, settings)?,
        ),
        (
            "a pile of four boxes of other sizes",
            make(
                stack(&[[1.0, 0.3], [0.8, 0.4], [0.6, 0.5], [0.4, 0.6]])?,
                settings,
            )?,
        ),
        (
            "a plate on a cube",
            make(stack(&[[1.0, 1.0], [1.0, 0.05]])?, settings)?,
        ),
    ])
}

/// Does a disturbance of 1e-7 m/s grow a thousandfold in 3000 steps of a share of the bound?
fn grows(system: &Blocks, share: f64) -> f64 {
    let mut blocks = system.clone();
    let mut twin = system.clone();
    let mut random = Random::new(1);
    let push: Vec<Load> = (0..blocks.n_blocks())
        .map(|b| Load {
            force: random.vector() * (1e-9 * blocks.mass(b)),
            torque: blocks.inertia(b) * random.vector() * 1e-9,
        })
        .collect();
    blocks.apply_impulse(&push, 1.0);
    for b in 0..blocks.n_blocks() {
        let strain = nalgebra::Matrix3::from_fn(|_, _| random.next());
        blocks.apply_stretch(b, strain, 1e-9);
    }
    let dt = system.stability_limit() * share;
    // the distance of two runs, so that what is at rest needs no state of rest
    let apart = |a: &Blocks, b: &Blocks| -> f64 {
        (0..a.n_blocks())
            .map(|k| {
                let strain = match (a.strain(k), b.strain(k)) {
                    (Some(x), Some(y)) => x
                        .iter()
                        .zip(&y)
                        .map(|(x, y)| (x - y).abs())
                        .fold(0.0, f64::max),
                    _ => 0.0,
                };
                (a.velocity(k) - b.velocity(k)).norm()
                    + (a.angular_velocity(k) - b.angular_velocity(k)).norm()
                    + strain
            })
            .fold(0.0, f64::max)
    };
    let (mut early, mut late) = (0.0_f64, 0.0_f64);
    for k in 0..3000_u32 {
        let time = f64::from(k) * dt;
        if blocks.advance(time, dt, 1).is_err() || twin.advance(time, dt, 1).is_err() {
            return f64::INFINITY;
        }
        let found = apart(&blocks, &twin);
        if k < 20 {
            early = early.max(found);
        }
        late = late.max(found);
        if late > 1e4 * early && k > 20 {
            return late / early;
        }
    }
    late / early
}

fn blocks(_: Length) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for (name, system) in systems()? {
        let mut table = Vec::new();
        for share in [0.5, 0.9, 1.0, 1.1, 1.5] {
            table.push(format!("{share}: {:.0e}", grows(&system, share)));
        }
        let margin = sweep(&SHARES, 7, |share| {
            let growth = grows(&system, share);
            if growth > 1e3 {
                return Err(format!(
                    "a disturbance grows {growth:.0e} times in at most 3000 steps"
                ));
            }
            Ok(())
        });
        let limit = margin.last_good.unwrap_or(0.0);
        let bound = system.critical_time_step().dt / system.stability_limit();
        rows.push(Row {
            pushed: format!("step over the reported limit of stability, no losses: {name}"),
            swept: "0.5 to 10 times".to_owned(),
            holds: margin.holds("of the limit"),
            past: margin.past(),
            theory:
                "dt < 2/ω of the stiffest mode, by power iteration; steps are a share of a bound from the sums of each block, which is below it"
                    .to_owned(),
            measured: format!(
                "growth at shares {}; limit {limit:.3} of the reported (asked 0.9 to 1.1); the bound of the steps is {bound:.2} of it",
                table.join(", ")
            ),
            missed: off(limit),
            ..Row::default()
        });
    }
    Ok(rows)
}

/// A periodic box of lattice fluid in the cube of 1 m with 12 spacings along each side.
fn periodic(scheme: Scheme, speed: impl Fn(&Vec3) -> Vec3, jitter: f64) -> Result<Fluid, Failure> {
    let n = 12;
    let dp = 1.0 / f64::from(n);
    let mut random = Random::new(3);
    let mut start = Start::default();
    for k in 0..n * n * n {
        let place = Vec3::new(f64::from(k % n), f64::from(k / n % n), f64::from(k / n / n));
        let place = place.add_scalar(0.5) * dp;
        start.velocities.push(speed(&place));
        start
            .positions
            .push(place + random.vector() * (jitter * dp));
    }
    let settings = riprap_sph::Settings {
        particle_spacing: [dp; 3],
        smoothing_length: 1.3 * dp,
        reference_density: 1000.0,
        sound_speed: 20.0,
        scheme,
        dimensions: Dimensions::Three,
        gravity: Vec3::zeros(),
        time_step_factor: 1.0,
        domain: (Vec3::zeros(), Vec3::repeat(1.0)),
        periodic: [true; 3],
        symmetry: [[false; 2]; 3],
    };
    let mut fluid = Fluid::new(start, settings)?;
    fluid.evaluate(&mut NoBoundary, 0.0)?;
    Ok(fluid)
}

/// How far particles went in `n` steps, and how far from the start they are after as many back; spacings.
pub fn there_and_back(speed: f64, n: u32) -> Result<(f64, f64), Failure> {
    let scheme = Scheme {
        diffusion: DensityDiffusion::None,
        viscosity: Viscosity::None,
        precision: Precision::Double,
        ..Scheme::artificial()
    };
    let k = std::f64::consts::TAU;
    let flow = |x: &Vec3| Vec3::new((k * x.z).sin(), (k * x.x).cos(), (k * x.y).sin()) * speed;
    let mut fluid = periodic(scheme, flow, 0.01)?;
    let places = |fluid: &Fluid| {
        let p = fluid.particles();
        let mut places: Vec<_> =
            p.id.iter()
                .copied()
                .zip(p.position.iter().copied())
                .collect();
        places.sort_by_key(|(id, _)| *id);
        places
    };
    let before = places(&fluid);
    for _ in 0..n {
        fluid.step(&mut NoBoundary, 1e-3)?;
    }
    let there = places(&fluid);
    for _ in 0..n {
        fluid.step(&mut NoBoundary, -1e-3)?;
    }
    let back = places(&fluid);
    let farthest = |a: &[(ParticleId, Vec3)], b: &[(ParticleId, Vec3)]| {
        a.iter()
            .zip(b)
            .map(|((_, a), (_, b))| (a - b).map(|d| d - d.round()).norm())
            .fold(0.0, f64::max)
    };
    Ok((
        12.0 * farthest(&before, &there),
        12.0 * farthest(&before, &back),
    ))
}

fn water(length: Length) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    let steps = length.choose(300, 1500);
    for (name, scheme, theory) in [
        (
            "no losses",
            Scheme {
                diffusion: DensityDiffusion::None,
                viscosity: Viscosity::None,
                precision: Precision::Double,
                ..Scheme::artificial()
            },
            "1.75",
        ),
        (
            "diffusion 0.1",
            Scheme {
                viscosity: Viscosity::None,
                precision: Precision::Double,
                ..Scheme::artificial()
            },
            "1.54",
        ),
        (
            "bulk viscosity 0.1",
            Scheme {
                diffusion: DensityDiffusion::None,
                viscosity: Viscosity::None,
                bulk_viscosity: 0.1,
                precision: Precision::Double,
                ..Scheme::artificial()
            },
            "1.66",
        ),
        (
            "diffusion 0.1, bulk viscosity 0.2",
            Scheme {
                viscosity: Viscosity::None,
                bulk_viscosity: 0.2,
                precision: Precision::Double,
                ..Scheme::artificial()
            },
            "1.41",
        ),
        ("Standard", Scheme::artificial(), "1.54"),
    ] {
        let grows = |share: f64| -> f64 {
            let mut random = Random::new(9);
            let noise = std::cell::RefCell::new(&mut random);
            let flow = |_: &Vec3| noise.borrow_mut().vector() * 1e-6;
            let Ok(mut fluid) = periodic(scheme, flow, 0.0) else {
                return f64::NAN;
            };
            let energy = |fluid: &Fluid| fluid.energies().kinetic;
            let start = energy(&fluid);
            let dt = fluid.settings().sound_stability().unwrap_or(f64::NAN) * share;
            let mut most = 0.0_f64;
            for _ in 0..steps {
                if fluid.step(&mut NoBoundary, dt).is_err() {
                    return f64::INFINITY;
                }
                most = most.max(energy(&fluid) / start);
                if most > 1e6 {
                    break;
                }
            }
            most
        };
        let mut table = Vec::new();
        for share in [0.5, 0.9, 1.0, 1.1, 1.5] {
            table.push(format!("{share}: {:.0e}", grows(share)));
        }
        let margin = sweep(&SHARES, 6, |share| {
            let growth = grows(share);
            if growth > 1e3 || growth.is_nan() {
                return Err(format!(
                    "noise of 1e-6 m/s grows {growth:.0e} times in energy in at most {steps} steps"
                ));
            }
            Ok(())
        });
        let limit = margin.last_good.unwrap_or(0.0);
        rows.push(Row {
            pushed: format!("step over the reported limit of stability of sound: periodic lattice in space, {name}"),
            swept: "0.5 to 10 times".to_owned(),
            holds: margin.holds("of the limit"),
            past: margin.past(),
            theory: format!("the dispersion of the lattice allows {theory} h/c₀ and is reported; steps are a share of h/c₀, for walls and free surfaces"),
            measured: format!("growth of energy at shares {}; limit {limit:.3} of the reported (asked 0.9 to 1.1)", table.join(", ")),
            missed: off(limit),
            ..Row::default()
        });
    }
    rows.push(in_a_tank(
        "a still tank with walls and surface",
        String::new(),
        length,
    )?);
    Ok(rows)
}

fn coupled(length: Length) -> Result<Vec<Row>, Failure> {
    let floating = tank::cuboid("body", "material: \"light\"", [0.4, 0.35, 0.6, 0.55]);
    let mut rows = vec![in_a_tank("a block that floats", floating.clone(), length)?];
    let heavy = floating.replace("light", "heavy");
    rows.push(in_a_tank("a block that sinks and lies", heavy, length)?);
    Ok(rows)
}

/// Is the measured limit far from the reported one?
fn off(limit: f64) -> Option<String> {
    let is_close = (limit - 1.0).abs() <= 0.1;
    (!is_close).then(|| format!("the limit is {limit:.2} of the reported"))
}

/// The limit of a tank, with what is in it.
fn in_a_tank(name: &str, blocks: String, length: Length) -> Result<Row, Failure> {
    let steps = length.choose(1500, 6000);
    let mut tank = Tank::new(1.0, 0.5, 0.025);
    tank.blocks = blocks;
    tank.materials = "(name: \"light\", density: 300, friction_angle_deg: 20), (name: \"heavy\", density: 2600, friction_angle_deg: 20)".to_owned();
    let run = |share: f64| -> Result<f64, Failure> {
        let mut world = tank.world()?;
        let mut fastest = 0.0_f64;
        for _ in 0..steps / 50 {
            for _ in 0..50 {
                let limits = world.limits();
                let dt = share * world.stability().first().map_or(f64::NAN, |(_, dt)| *dt);
                world.step(TimeStep {
                    dt,
                    cause: Cause::Sound,
                    of_blocks: BlockSteps::Inside(((dt / limits.blocks).ceil() as u32).max(1)),
                })?;
                fastest = fastest.max(max_speed(&world));
            }
            if fastest > WILD {
                break;
            }
        }
        Ok(fastest)
    };
    let mut table = Vec::new();
    for share in [0.5, 0.9, 1.0, 1.1, 1.5] {
        let found = run(share).map_or("stops".to_owned(), |v| format!("{v:.2} m/s"));
        table.push(format!("{share}: {found}"));
    }
    let margin = sweep(
        &[0.5, 0.9, 1.0, 1.1, 1.3, 1.6, 2.0, 3.0],
        4,
        |share| match run(share) {
            Ok(fastest) if fastest < WILD => Ok(()),
            Ok(fastest) => Err(format!("water at {fastest:.1} m/s")),
            Err(error) => Err(error.to_string()),
        },
    );
    let limit = margin.last_good.unwrap_or(0.0);
    Ok(Row {
        pushed: format!(
            "step of water over the reported limit of stability, that of blocks within its bound: {name}"
        ),
        swept: format!("0.5 to 3 times, {steps} steps"),
        holds: margin.holds("of the limit"),
        past: margin.past(),
        theory: "the dispersion of the lattice; walls and surfaces take some of it".to_owned(),
        measured: format!(
            "fastest water at shares {}; limit {limit:.2} of the reported (asked 0.9 to 1.1)",
            table.join(", ")
        ),
        missed: off(limit),
        ..Row::default()
    })
}
