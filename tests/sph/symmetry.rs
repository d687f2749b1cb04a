//! Planes of symmetry: part of a symmetric flow against the whole of it.

use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::scheme::{SMAGORINSKY, Viscosity};
use riprap_sph::state_equation::State;
use riprap_sph::{
    Fluid, FluidError, NegativePressure, Precision, Rheology, Scheme, Settings, Start,
    StateEquation, Symmetry, Vec3,
};

use crate::support::{PeriodicBox, evaluate, noise3, published, step};
use crate::water::{DENSITY, Plane, Water, lattice, start};

const G: f64 = 9.81;

/// Place, velocity and density of every particle, by id.
fn by_id(fluid: &Fluid) -> Vec<(Vec3, Vec3, f64)> {
    let p = fluid.particles();
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_unstable_by_key(|&a| p.id[a]);
    let state = |a: usize| (p.position[a], p.velocity[a], p.density[a]);
    order.into_iter().map(state).collect()
}

/// Largest differences of place (m), velocity (m/s) and density (kg/m³).
fn differences(
    part: &[(Vec3, Vec3, f64)],
    whole: impl Iterator<Item = (Vec3, Vec3, f64)>,
) -> [f64; 3] {
    let mut largest = [0.0_f64; 3];
    for (a, b) in part.iter().zip(whole) {
        let found = [(a.0 - b.0).norm(), (a.1 - b.1).norm(), (a.2 - b.2).abs()];
        for (largest, found) in largest.iter_mut().zip(found) {
            // a NaN is a difference of any size
            *largest = if found <= *largest { *largest } else { found };
        }
    }
    largest
}

/// A field with mirror symmetry in the planes through 0 and 1/2 across every axis, from one of a corner.
fn mirrored(field: impl Fn(&Vec3) -> Vec3, x: &Vec3) -> Vec3 {
    let folded = x.map(|x| x.min(1.0 - x));
    let signs = x.map(|x| if x < 0.5 { 1.0 } else { -1.0 });
    field(&folded).component_mul(&signs)
}

/// An eighth of a periodic box with planes at all six sides, against the box; three planes meet at each corner.
fn eighth(name: &str, scheme: Scheme, n_steps: usize) -> [f64; 3] {
    let setup = PeriodicBox {
        n: [16; 3],
        ..PeriodicBox::default()
    };
    let dp = setup.spacing();
    let lattice = setup.fluid(
        |x| mirrored(|x| noise3(x) * (0.1 * dp), x),
        |x| mirrored(|x| noise3(&(x * 2.0)), x),
    );
    let at_start = by_id(&lattice);
    let chosen: Vec<usize> = (0..at_start.len())
        .filter(|&a| at_start[a].0.max() < 0.5)
        .collect();
    assert_eq!(chosen.len(), 512);
    let water = |chosen: &[usize], settings: Settings| {
        let begin = Start {
            positions: chosen.iter().map(|&a| at_start[a].0).collect(),
            velocities: chosen.iter().map(|&a| at_start[a].1).collect(),
            pressures: Vec::new(),
        };
        let mut fluid = Fluid::new(begin, settings).unwrap();
        evaluate(&mut fluid);
        fluid
    };
    let settings = Settings {
        scheme,
        ..lattice.settings().clone()
    };
    let everywhere: Vec<usize> = (0..at_start.len()).collect();
    let mut whole = water(&everywhere, settings.clone());
    let in_part = Settings {
        domain: (Vec3::zeros(), Vec3::repeat(0.5)),
        periodic: [false; 3],
        symmetry: [[true; 2]; 3],
        ..settings
    };
    let mut part = water(&chosen, in_part);
    let dt = 0.5 * whole.step_limits().smallest();
    for _ in 0..n_steps {
        step(&mut whole, dt);
        step(&mut part, dt);
    }
    assert_eq!(part.particles().len(), 512);
    let all = by_id(&whole);
    // a particle that passed a plane came back as its image: so does that of the whole
    let home = |(x, v, rho): (Vec3, Vec3, f64)| {
        let (mut x, mut v) = (x.map(|x| x - x.floor()), v);
        for axis in 0..3 {
            if 0.5 < x[axis] {
                (x[axis], v[axis]) = (1.0 - x[axis], -v[axis]);
            }
        }
        (x, v, rho)
    };
    let inside: Vec<_> = by_id(&part).into_iter().map(home).collect();
    let found = differences(&inside, chosen.iter().map(|&a| home(all[a])));
    println!(
        "symmetry: {name}, {n_steps} steps: place {:.1e} spacings, velocity {:.1e} m/s, density {:.1e} kg/m3",
        found[0] / dp,
        found[1],
        found[2]
    );
    // the same neighbors, and as many of them
    assert_eq!(8 * part.n_pairs(), whole.n_pairs(), "{name}");
    [found[0] / dp, found[1], found[2]]
}

fn double(scheme: Scheme) -> Scheme {
    Scheme {
        precision: Precision::Double,
        negative_pressure: NegativePressure::Kept,
        ..scheme
    }
}

#[test]
fn an_eighth_with_planes_at_all_sides_is_the_whole() {
    let water = Rheology::Newtonian {
        dynamic_viscosity: 2.0,
    };
    let with = |viscosity| Scheme {
        viscosity,
        ..double(Scheme::artificial())
    };
    for (name, scheme) in [
        ("standard", double(Scheme::artificial())),
        ("reference", double(Scheme::laminar(1e-3))),
        (
            "bulk",
            Scheme {
                bulk_viscosity: 0.2,
                ..double(Scheme::laminar(1e-3))
            },
        ),
        ("published", published(3.0)),
        (
            "rheological",
            with(Viscosity::Rheological { rheology: water }),
        ),
        (
            "sub-particle",
            with(Viscosity::SubParticleScale {
                kinematic_viscosity: 1e-3,
                smagorinsky: SMAGORINSKY,
            }),
        ),
    ] {
        let [place, velocity, density] = eighth(name, scheme, 40);
        // f64: round-off of sums in another order, grown by the disorder of 40 steps; measured 7e-13, 9e-13
        // and 8e-12
        assert!(
            place < 1e-11 && velocity < 1e-11 && density < 1e-10,
            "{name}"
        );
    }
    // the same in single precision, whose sums are good to seven digits; measured 7e-7 and 2e-6
    let [place, velocity, _] = eighth("standard, f32", Scheme::artificial(), 40);
    assert!(place < 1e-5 && velocity < 1e-4);
}

/// A column of water that falls apart to both sides, in a tank of wall points; the right half with a plane of
/// symmetry, or the whole.
struct Column {
    half: bool,
    scheme: Scheme,
}

impl Column {
    const DP: f64 = 0.02;
    /// Half the width of the column and of the tank, rows of the column and of the tank.
    const SIZE: [i32; 4] = [10, 25, 20, 40];

    fn water(&self, slip: Slip) -> Water {
        let (dp, [n, wide, rows, high]) = (Self::DP, Self::SIZE);
        let c0 = 10.0 * (G * f64::from(rows) * dp).sqrt();
        let left = |n: i32| if self.half { 0 } else { -n };
        let plane = Plane {
            spacing: dp,
            ratio: 2.0,
            sound_speed: c0,
            scheme: self.scheme,
            gravity: Vec3::new(0.0, 0.0, -G),
            time_step_factor: 0.5,
            domain: (
                [f64::from(left(wide)) * dp, 0.0],
                [f64::from(wide) * dp, f64::from(high) * dp],
            ),
            periodic: [false; 2],
        };
        let mut symmetry = Symmetry::default();
        symmetry[0][0] = self.half;
        let state = State {
            equation: StateEquation::Linear,
            reference_density: DENSITY,
            sound_speed: c0,
            negative: NegativePressure::Kept,
        };
        let begin = start(
            lattice(dp, left(n)..n, 0..rows).collect(),
            |_| Vec3::zeros(),
            |x| state.hydrostatic_pressure(G, f64::from(rows) * dp - x.z),
        );
        let edge = f64::from(wide) * dp;
        let walls = lattice(dp, left(wide + 4)..wide + 4, -4..high)
            .filter(|x| x.z < 0.0 || edge < x.x.abs())
            .collect();
        let settings = Settings {
            symmetry,
            ..plane.settings()
        };
        Water::between(begin, settings, (walls, dp * dp), slip)
    }

    /// Differences of half and whole after steps of the same size.
    fn differences(scheme: Scheme, slip: Slip, n_steps: usize) -> [f64; 3] {
        let [n, _, rows, _] = Self::SIZE;
        let mut half = Self { half: true, scheme }.water(slip);
        let mut whole = Self {
            half: false,
            scheme,
        }
        .water(slip);
        let dt = 0.5 * whole.fluid.step_limits().smallest();
        for _ in 0..n_steps {
            half.step(dt);
            whole.step(dt);
        }
        let all = by_id(&whole.fluid);
        assert_eq!(all.len(), (2 * n * rows) as usize, "nothing left");
        let right = (0..rows).flat_map(|k| (0..n).map(move |i| (k * 2 * n + n + i) as usize));
        let home = |(x, v, rho): (Vec3, Vec3, f64)| {
            // a particle may have passed the plane, and its image come the other way
            let sign = if x.x < 0.0 { -1.0 } else { 1.0 };
            let turned = |mut v: Vec3| {
                v.x *= sign;
                v
            };
            (turned(x), turned(v), rho)
        };
        let found = by_id(&half.fluid).into_iter().map(home).collect::<Vec<_>>();
        let front = found.iter().map(|(x, ..)| x.x).fold(0.0, f64::max);
        let result = differences(&found, right.map(|a| home(all[a])));
        println!(
            "symmetry: column, {slip:?}, {n_steps} steps, front at {:.2} of its width: place {:.1e} spacings, velocity \
             {:.1e} m/s, density {:.1e} kg/m3",
            front / (f64::from(n) * Self::DP),
            result[0] / Self::DP,
            result[1],
            result[2]
        );
        // it falls
        assert!(1.2 < front / (f64::from(n) * Self::DP), "{front}");
        [result[0] / Self::DP, result[1], result[2]]
    }
}

#[test]
fn half_a_column_falls_as_the_whole() {
    for slip in [Slip::Free, Slip::None] {
        let scheme = double(Scheme::artificial());
        let [place, velocity, density] = Column::differences(scheme, slip, 300);
        // f64: round-off, grown by 300 steps; measured 3e-14, 8e-15 and 2e-13
        assert!(
            place < 1e-11 && velocity < 1e-11 && density < 1e-10,
            "{slip:?}"
        );
    }
}

#[test]
fn still_water_feels_no_force_along_a_plane() {
    let (dp, rows) = (0.02, 20);
    let columns = 12;
    let c0 = 10.0 * (G * f64::from(rows) * dp).sqrt();
    let depth = f64::from(rows) * dp;
    let state = State {
        equation: StateEquation::Linear,
        reference_density: DENSITY,
        sound_speed: c0,
        negative: NegativePressure::Kept,
    };
    for scheme in [double(Scheme::artificial()), double(Scheme::laminar(1e-3))] {
        let plane = Plane {
            spacing: dp,
            ratio: 2.0,
            sound_speed: c0,
            scheme,
            gravity: Vec3::new(0.0, 0.0, -G),
            time_step_factor: 0.5,
            domain: ([0.0; 2], [f64::from(columns) * dp, 1.5 * depth]),
            periodic: [false; 2],
        };
        let settings = Settings {
            symmetry: [[true; 2], [false; 2], [false; 2]],
            ..plane.settings()
        };
        let begin = start(
            lattice(dp, 0..columns, 0..rows).collect(),
            |_| Vec3::zeros(),
            |x| state.hydrostatic_pressure(G, depth - x.z),
        );
        let floor = lattice(dp, 0..columns, -4..0).collect();
        let mut water = Water::between(begin, settings, (floor, dp * dp), Slip::Free);
        water.update_rates(0.0);
        water.evaluate(0.0);
        let p = water.fluid.particles();
        let mut by_row = vec![Vec::new(); rows as usize];
        for a in 0..p.len() {
            by_row[(p.position[a].z / dp) as usize].push(p.acceleration[a]);
        }
        let mut uneven = 0.0_f64;
        for row in &by_row {
            assert_eq!(row.len(), columns as usize);
            for a in row {
                uneven = uneven.max(a.x.abs()).max((a.z - row[0].z).abs());
            }
        }
        println!(
            "symmetry: still water, accelerations uneven by {:.1e} g",
            uneven / G
        );
        // f64; measured 1.2e-14
        assert!(uneven < 1e-12 * G, "{uneven}");
        // gauges on the planes read what those between them do
        let at = |x: f64, z: f64| water.fluid.sample(&Vec3::new(x, 0.5, z)).unwrap();
        let (end, middle) = (f64::from(columns) * dp, 6.0 * dp);
        for z in [0.1, 0.2, 0.35] {
            for x in [0.0, end] {
                let off = at(x, z).pressure - at(middle, z).pressure;
                assert!(off.abs() < 1e-9 * DENSITY * G * depth, "{x} {z}: {off}");
            }
        }
        let surface = |x: f64| water.fluid.surface_elevation(x, 0.5).unwrap();
        assert!((surface(0.0) - surface(middle)).abs() < 1e-9 * depth);
        assert!((surface(end) - surface(middle)).abs() < 1e-9 * depth);
    }
}

/// A drop that flies into a plane: half of two that meet.
fn drop(dt_factor: f64) -> (Fluid, f64) {
    let (dp, n, c0) = (0.02, 10, 20.0);
    let plane = Plane {
        spacing: dp,
        ratio: 2.0,
        sound_speed: c0,
        scheme: double(Scheme::artificial()),
        gravity: Vec3::zeros(),
        time_step_factor: 0.5,
        domain: ([0.0, -1.0], [2.0, 1.0]),
        periodic: [false; 2],
    };
    let settings = Settings {
        symmetry: [[true, false], [false; 2], [false; 2]],
        ..plane.settings()
    };
    let toward = |_: &Vec3| Vec3::new(-1.0, 0.0, 0.0);
    let begin = start(lattice(dp, 1..n + 1, -n..n).collect(), toward, |_| 0.0);
    let mut fluid = Fluid::new(begin, settings).unwrap();
    evaluate(&mut fluid);
    fluid.open_ledger();
    let dt = dt_factor * fluid.step_limits().smallest();
    (fluid, dt)
}

fn total(fluid: &Fluid) -> f64 {
    let e = fluid.energies();
    e.kinetic + e.potential + e.internal + e.viscous + e.bulk + e.diffusive + e.removed
}

#[test]
fn a_drop_meets_its_image_and_none_of_it_passes() {
    let (mut fluid, dt) = drop(0.5);
    let n = fluid.particles().len();
    let (energy, momentum) = (total(&fluid), fluid.momentum().x);
    let mut given = 0.0;
    let mut farthest = 0.0_f64;
    for _ in 0..400 {
        given += 0.5 * dt * fluid.plane_force().x;
        step(&mut fluid, dt);
        given += 0.5 * dt * fluid.plane_force().x;
        let lowest = fluid.particles().position.iter().map(|x| x.x);
        farthest = farthest.max(-lowest.fold(f64::INFINITY, f64::min));
    }
    assert_eq!(fluid.particles().len(), n);
    assert_eq!(fluid.removed().count, 0);
    // what passes is sent back with the next sort: before anything moved by half the skin
    assert!(farthest <= 0.5 * fluid.skin(), "{farthest}");
    let change = fluid.momentum().x - momentum;
    let unexplained = (change - given - fluid.reflected().x).abs() / momentum.abs();
    let unclosed = (total(&fluid) / energy - 1.0).abs();
    println!(
        "symmetry: drop, momentum {:.2} of what it had, unexplained {unexplained:.1e}; energy off by {unclosed:.1e}, \
         {:.1e} spacings past the plane at most",
        fluid.momentum().x / momentum,
        farthest / 0.02
    );
    // the plane stops it
    assert!(fluid.momentum().x.abs() < 0.9 * momentum.abs());
    // f64: sums of 200 particles over 400 steps, measured 8e-16; energy is that of the step, measured 3.6e-4
    assert!(unexplained < 1e-12, "{unexplained}");
    assert!(unclosed < 2e-3, "{unclosed}");
}

#[test]
fn a_particle_beyond_a_plane_is_sent_back() {
    let (fluid, _) = drop(0.5);
    let begin = Start {
        positions: vec![Vec3::new(-0.01, 0.5, 0.0), Vec3::new(0.5, 0.5, 0.0)],
        velocities: vec![Vec3::new(-3.0, 0.0, 1.0), Vec3::zeros()],
        pressures: Vec::new(),
    };
    let mut fluid = Fluid::new(begin, fluid.settings().clone()).unwrap();
    let energy = total(&fluid);
    assert_eq!(fluid.refresh(), 0);
    let p = fluid.particles();
    assert_eq!(p.position[0], Vec3::new(0.01, 0.5, 0.0));
    assert_eq!(p.velocity[0], Vec3::new(3.0, 0.0, 1.0));
    assert_eq!(fluid.reflected(), Vec3::new(6.0, 0.0, 0.0) * p.mass[0]);
    assert_eq!(total(&fluid), energy);
}

#[test]
fn any_number_of_threads_gives_the_same_bits_beside_planes() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let (mut fluid, dt) = drop(1.0);
            for _ in 0..60 {
                step(&mut fluid, dt);
            }
            let mut bits = vec![
                fluid.plane_force().x.to_bits(),
                fluid.reflected().x.to_bits(),
            ];
            fluid.visit_state(|x| bits.push(x.to_bits()));
            bits
        })
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn planes_without_a_mirror_image_are_refused() {
    let (fluid, _) = drop(0.5);
    let refused = |said: &str, change: &dyn Fn(&mut Settings)| {
        let mut settings = fluid.settings().clone();
        change(&mut settings);
        let error = Fluid::new(Start::default(), settings).unwrap_err();
        assert!(matches!(error, FluidError::Symmetry { .. }), "{error}");
        assert!(error.to_string().contains(said), "{error}");
    };
    refused("across axis 0: the domain repeats itself", &|s| {
        s.periodic[0] = true;
    });
    refused("across axis 0: gravity acts along it", &|s| {
        s.gravity.x = 1.0;
    });
    refused("across axis 1: nothing depends on y", &|s| {
        s.symmetry[1][1] = true;
    });
    refused("across axis 0: the two sides are nearer", &|s| {
        s.symmetry[0] = [true; 2];
        s.domain.1.x = 1.04 * s.support_radius();
    });
}
