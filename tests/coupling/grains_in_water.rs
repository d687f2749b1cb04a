//! Grains in water whose forces are averages: momentum, energy, rest, slip, settling.

use std::f64::consts::PI;

use riprap::run::build;
use riprap::time_step::{BlockSteps, Cause, TimeStep};
use riprap::world::World;
use riprap_dda::{Motion, PrescribedMotion, Shape, Vec3};

use crate::support::scene::{FIXED, advance, basin, block, cuboid, errors, resolved, world};

/// Water and grains in a box.
struct Mixture {
    /// m.
    size: [f64; 3],
    periodic: &'static str,
    gravity: [f64; 3],
    /// Density (kg/m³) and viscosity (Pa s) of the water, and further fields.
    water: (f64, f64, String),
    /// Spacing (m) and corners of the water (m).
    spacing: f64,
    filled: [[f64; 3]; 2],
    /// Entries of `grains` and `blocks`.
    grains: String,
    blocks: Vec<String>,
    numerics: String,
}

impl Mixture {
    fn text(&self) -> String {
        let Self {
            size,
            periodic,
            gravity,
            water,
            spacing,
            filled,
            ..
        } = self;
        let triple = |[x, y, z]: [f64; 3]| format!("({x:?}, {y:?}, {z:?})");
        let margin = match periodic.is_empty() {
            true => 4.0 * spacing,
            false => 0.0,
        };
        format!(
            "(title: \"grains in water\", gravity: {},\n\
             domain: (min: {}, max: {}, periodic: [{periodic}]),\n\
             materials: [(name: \"m\", density: 2500.0, friction_angle_deg: 20.0, contact_stiffness: 1e4),\n\
                         (name: \"glass\", density: 2500.0, friction_angle_deg: 20.0, restitution: 0.3, contact_stiffness: 1e4),\n\
                         (name: \"light\", density: 250.0, friction_angle_deg: 20.0, contact_stiffness: 1e3),\n\
                         (name: \"shale\", density: 1500.0, friction_angle_deg: 20.0, contact_stiffness: 1e3)],\n\
             blocks: [{}], grains: [{}],\n\
             fluid: (density: {:?}, dynamic_viscosity: {:?}, {} resolution: Spacing({spacing:?}),\n\
                     regions: [(name: \"water\", shape: Box(min: {}, max: {}))]),\n\
             numerics: ({}), time: (duration: 10.0))",
            triple(*gravity),
            triple(match periodic.is_empty() {
                true => [-margin; 3],
                false => [0.0; 3],
            }),
            triple(size.map(|x| x + margin)),
            self.blocks.join("\n"),
            self.grains,
            water.0,
            water.1,
            water.2,
            triple(filled[0]),
            triple(filled[1]),
            self.numerics,
        )
    }

    fn world(&self) -> World {
        world(&self.text())
    }

    /// With the grains fixed where they are, each as `change` makes it.
    fn world_of_fixed(&self, change: impl Fn(&mut Shape)) -> World {
        let mut scene = resolved(&self.text()).unwrap();
        let grains = scene.fluid.as_ref().unwrap().averaged_blocks().to_vec();
        for block in grains {
            scene.blocks[block].motion = Motion::Fixed;
            change(&mut scene.blocks[block].shape);
        }
        build(&scene).unwrap()
    }
}

fn grains_in([min, max]: [[f64; 3]; 2], diameter: f64, pitch: f64, more: &str) -> String {
    format!(
        "(name: \"g\", material: \"glass\", region: Box(min: {min:?}, max: {max:?}), diameter: ({diameter:?}, {diameter:?}),\
         spacing: {pitch:?}, jitter: 0.0, in_water: Averaged, {more})"
    )
    .replace('[', "(")
    .replace(']', ")")
}

/// A cube of 0.5 m that repeats in all directions, full of both.
fn suspension(pitch: f64, more: &str) -> Mixture {
    let size = [0.5; 3];
    Mixture {
        size,
        periodic: "X, Y, Z",
        gravity: [0.0; 3],
        water: (1000.0, 1e-3, String::new()),
        spacing: 0.05,
        filled: [[0.0; 3], size],
        grains: grains_in([[0.0; 3], size], 0.04, pitch, more),
        blocks: Vec::new(),
        numerics: "viscosity: Off".into(),
    }
}

/// A tank with walls, this wide (spacings), filled to a height (spacings).
fn tank(spacing: f64, [width, height]: [f64; 2], grains: String) -> Mixture {
    let (width, height) = (width * spacing, height * spacing);
    Mixture {
        size: [width, width, 1.6 * height],
        periodic: "",
        gravity: [0.0, 0.0, -9.81],
        water: (1000.0, 1e-3, String::new()),
        spacing,
        filled: [[0.0; 3], [width, width, height]],
        grains,
        blocks: basin([width, width, 1.6 * height], 4.0 * spacing),
        numerics: String::new(),
    }
}

/// Blocks of the grains.
fn grains_of(world: &World) -> Vec<usize> {
    let grains = world.water.as_ref().unwrap().grains.as_ref().unwrap();
    grains.blocks().collect()
}

fn mean_velocity(world: &World) -> Vec3 {
    let grains = grains_of(world);
    let sum: Vec3 = grains.iter().map(|&b| world.blocks.velocity(b)).sum();
    sum / grains.len() as f64
}

fn water_velocity(world: &World) -> Vec3 {
    let particles = world.water.as_ref().unwrap().fluid.particles();
    let momentum: Vec3 = (particles.velocity.iter().zip(&particles.mass))
        .map(|(v, m)| v * *m)
        .sum();
    momentum / particles.mass.iter().sum::<f64>()
}

/// A step of a length (s).
fn step(world: &mut World, dt: f64) {
    let step = TimeStep {
        dt,
        cause: Cause::Sound,
        of_blocks: BlockSteps::Inside(1),
    };
    world.step(step).unwrap();
}

/// In a box that repeats, with nothing to push against, momentum stays whatever grains and water do to each other.
#[test]
fn exchange_conserves_momentum() {
    // away from the sides, where a grain that passes one would leave
    let mut mixture = suspension(0.055, "");
    let within = [[0.15; 3], [0.35; 3]];
    mixture.grains = grains_in(within, 0.04, 0.055, "velocity: (0.4, -0.3, 0.2), ");
    // pair sums of water of single precision lose some digits of it by themselves
    mixture.numerics += ", precision: Double";
    let mut world = mixture.world();
    let before = world.momentum();
    for _ in 0..50 {
        let step = world.next_step(10.0).unwrap();
        world.step(step).unwrap();
    }
    let slip = mean_velocity(&world) - water_velocity(&world);
    assert!(slip.norm() < 0.4, "they did not slow down: {slip}");
    let scale = before.norm();
    let change = (world.momentum() - before).norm() / scale;
    // sums of a thousand terms of double precision
    assert!(change < 1e-12, "{change:e}");
}

/// What grains and water lose in such a box is what drag, viscosity and diffusion take, but for an error of the step that falls with it.
#[test]
fn exchange_keeps_the_energy_account() {
    let unexplained = |factor: f64| {
        let mut mixture = suspension(0.055, "");
        let within = [[0.15; 3], [0.35; 3]];
        mixture.grains = grains_in(within, 0.04, 0.055, "velocity: (0.4, -0.3, 0.2), ");
        mixture.numerics += &format!(", precision: Double, time_step_factor: {factor}");
        let mut world = mixture.world();
        advance(&mut world, 0.3, 10.0, |_| ());
        let energy = world.energy();
        [energy.residual, energy.at_grains].map(|part| part / energy.lost())
    };
    let whole = unexplained(1.0);
    let fifth = unexplained(0.2);
    // measured 0.0085 and -0.003, 0.0016 and 0.0009: an error of first order in the step
    for (found, bound) in [(whole, 0.015), (fifth, 0.003)] {
        assert!(found.iter().all(|part| part.abs() < bound), "{found:?}");
    }
    assert!(3.0 * fifth[0].abs() < whole[0].abs(), "{whole:?} {fifth:?}");
}

/// A uniform slip relaxes as `e^{−t/τ}`, in steps far below `τ` and far above it, to the speed that momentum leaves.
#[test]
fn uniform_slip_relaxes_exactly() {
    // slow flow, whose drag is proportional to the slip: Re 0.03
    let viscosity = 1e3;
    let (diameter, pitch) = (0.04, 0.05);
    let porosity = 1.0 - PI / 6.0 * (0.04_f64 / 0.05).powi(3);
    let solid = 1.0 - porosity;
    let factor =
        10.0 * solid / (porosity * porosity) + porosity * porosity * (1.0 + 1.5 * solid.sqrt());
    let resistance = 3.0 * PI * viscosity * diameter * porosity * factor;
    let mass = 2500.0 * PI / 6.0 * f64::powi(diameter, 3);
    let water = 1000.0 * porosity / solid * PI / 6.0 * f64::powi(diameter, 3);
    let tau = 1.0 / (resistance * (1.0 / mass + 1.0 / water));
    for share in [0.1, 1.0, 10.0] {
        let mut mixture = suspension(pitch, "velocity: (1.0, 0.0, 0.0), ");
        mixture.water.1 = viscosity;
        mixture.water.2 = "grains: (added_mass: Off),".into();
        let mut world = mixture.world();
        let dt = share * tau;
        // the first kick has the length of a step of sound, which is not this one
        step(&mut world, dt);
        let slip = |world: &World| (mean_velocity(world) - water_velocity(world)).x;
        let start = slip(&world);
        step(&mut world, dt);
        let found = slip(&world) / start;
        // half of each kick is that of the step before: slips of steps are those of half steps, whose ratio is the same
        let expected = (-share).exp();
        // the porosity of averages over a lattice, and inertia at this Reynolds number
        assert!(
            (found - expected).abs() < 0.02 * expected.max(0.05),
            "{share}: {found} for {expected}"
        );
        // grains stay clear of the sides in so short a time
        for _ in 0..(40.0 / share).max(10.0) as usize {
            step(&mut world, dt);
        }
        let end = 2500.0 * solid / (2500.0 * solid + 1000.0 * porosity);
        // what momentum leaves, whatever the drag; the water's mass is that of its particles
        let momentum = world.momentum().x;
        let mass = momentum / end;
        assert!(slip(&world).abs() < 1e-6, "{share} {}", slip(&world));
        assert!((mean_velocity(&world).x / end - 1.0).abs() < 0.02, "{mass}");
    }
}

/// Water in a bed of fixed grains stands still, its pressure is its own weight, and each grain loses the weight of the water that it
/// displaces.
#[test]
fn a_fixed_bed_stands_in_still_water() {
    let spacing = 0.02;
    let width = 14.0 * spacing;
    let bed = grains_in([[0.0; 3], [width, width, 7.0 * spacing]], 0.02, 0.02, "");
    let mut world = tank(spacing, [14.0, 14.0], bed).world_of_fixed(|_| ());
    let depth = 14.0 * spacing;
    let volume = PI / 6.0 * 0.02_f64.powi(3);
    let low = Vec3::new(0.5 * width, 0.5 * width, 2.0 * spacing);
    let (mut fastest, mut force, mut pressure, mut n) = (0.0_f64, 0.0, 0.0, 0.0);
    // over some periods of the sound that the start makes
    advance(&mut world, 0.5, 10.0, |world| {
        let water = world.water.as_ref().unwrap();
        fastest = fastest.max(water.fluid.max_speed());
        let inside: Vec<f64> = (water.grains.as_ref().unwrap().forces())
            .filter(|(b, _)| {
                let x = world.blocks.centroid(*b);
                (x - Vec3::new(0.5 * width, 0.5 * width, 3.5 * spacing)).amax() < 3.0 * spacing
            })
            .map(|(_, on)| (on.pressure + on.drag).z)
            .collect();
        assert!(20 < inside.len());
        force += inside.iter().sum::<f64>() / inside.len() as f64;
        pressure += water.fluid.sample(&low).unwrap().pressure;
        n += 1.0;
    });
    // without grains the same tank has currents of 0.11 of it, by the arrangement of its particles
    let wave = (9.81 * depth).sqrt();
    assert!(fastest < 0.13 * wave, "{}", fastest / wave);
    // of the pressure in weakly compressible water that rings
    let force = force / n / (volume * 1000.0 * 9.81);
    let pressure = pressure / n / (1000.0 * 9.81 * (depth - 2.0 * spacing));
    assert!((force - 1.0).abs() < 0.03, "{force} {pressure}");
    assert!((pressure - 1.0).abs() < 0.03, "{force} {pressure}");
}

/// Through a fixed bed water flows at the speed at which drag carries the force that drives it.
#[test]
fn water_seeps_through_a_bed_by_its_drag() {
    for (drag, gradient) in [
        ("Ergun", 248.44),
        ("DiFelice", 243.17),
        ("Beetstra", 242.43),
    ] {
        // published formulas at a porosity of 0.4 give these gradients at 0.01 m/s; spheres of a lattice have 0.48 at least, so
        // they overlap: fixed ones may
        let diameter = 0.01;
        let solid = 0.6_f64;
        let pitch = diameter * (PI / 6.0 / solid).cbrt();
        let n = 10.0;
        let size = [n * pitch; 3];
        let mixture = Mixture {
            size,
            periodic: "X, Y, Z",
            gravity: [gradient / 1000.0, 0.0, 0.0],
            water: (1000.0, 1e-3, format!("grains: (drag: {drag}),")),
            spacing: n * pitch / 10.0,
            filled: [[0.0; 3], size],
            grains: grains_in([[0.0; 3], size], 0.9 * pitch, pitch, ""),
            blocks: Vec::new(),
            numerics: "sound_speed: 0.5".into(),
        };
        // grains as large as they are to be, which touch
        let mut world = mixture.world_of_fixed(|shape| {
            if let Shape::Sphere { radius, .. } = shape {
                *radius = 0.5 * diameter;
            }
        });
        advance(&mut world, 0.8, 10.0, |_| ());
        let superficial = 0.4 * water_velocity(&world).x;
        // of the averages over a lattice; the number is given to four digits
        assert!(
            (superficial / 0.01 - 1.0).abs() < 3e-3,
            "{drag} {superficial}"
        );
    }
}

/// A piston drives water up through a bed. Its grains weigh nothing any more once the water that passes them has the least speed that
/// fluidizes them.
#[test]
fn a_bed_lifts_at_its_least_fluidizing_speed() {
    let (diameter, solid) = (0.01, 0.58_f64);
    // of a lattice of spheres that overlap, as fixed ones may
    let pitch = diameter * (PI / 6.0 / solid).cbrt();
    let width = 10.0 * pitch;
    let [piston, bed, top, surface] = [4.0, 12.0, 26.0, 32.0].map(|rows| rows * pitch);
    let box_of = |from: f64, to: f64| [[0.0, 0.0, from], [width, width, to]];
    let [min, max] = box_of(0.0, piston);
    let mixture = Mixture {
        size: [width, width, 48.0 * pitch],
        periodic: "X, Y",
        gravity: [0.0, 0.0, -9.81],
        water: (1000.0, 1e-3, "grains: (drag: Ergun),".into()),
        spacing: pitch,
        filled: box_of(piston, surface),
        grains: grains_in(box_of(bed, top), 0.9 * pitch, pitch, ""),
        blocks: vec![block("piston", &cuboid(min, max), FIXED)],
        numerics: String::new(),
    };
    let mut scene = resolved(&mixture.text()).unwrap();
    for &grain in scene
        .fluid
        .as_ref()
        .unwrap()
        .averaged_blocks()
        .to_vec()
        .iter()
    {
        scene.blocks[grain].motion = Motion::Fixed;
        if let Shape::Sphere { radius, .. } = &mut scene.blocks[grain].shape {
            *radius = 0.5 * diameter;
        }
    }
    // Ergun (1952) with (1 - porosity) (density of grains - of water) g = 8534.7 Pa/m. Later on the water is off: what streams into a bed is
    // stretched along its way by one over the porosity, and a fifth of it is then missing
    let (expected, duration) = (0.076482, 0.35);
    let speed = |time: f64| expected * (0.6 + 0.4 * time / duration);
    let times: Vec<f64> = (0..=50).map(|k| f64::from(k) * 0.02 * duration).collect();
    let way = |&time: &f64| Vec3::z() * (0.5 * (speed(0.0) + speed(time)) * time);
    scene.blocks[0].motion = Motion::Prescribed(PrescribedMotion::Table {
        displacement: times.iter().map(way).collect(),
        time: times,
        turning: Vec::new(),
    });
    let mut world = build(&scene).unwrap();
    let weight = 2500.0 * 9.81 * PI / 6.0 * diameter.powi(3);
    let mut lifted = Vec::new();
    let is_inside = |z: f64| bed + 4.0 * pitch < z && z < top - 4.0 * pitch;
    advance(&mut world, duration, 10.0, |world| {
        let water = world.water.as_ref().unwrap();
        let particles = water.fluid.particles();
        let passing: Vec<f64> = (particles.position.iter().zip(&particles.velocity))
            .filter(|(x, _)| is_inside(x.z))
            .map(|(_, v)| v.z)
            .collect();
        let superficial = (1.0 - solid) * passing.iter().sum::<f64>() / passing.len() as f64;
        let grains = water.grains.as_ref().unwrap();
        let inside: Vec<f64> = (grains.forces())
            .filter(|(b, _)| is_inside(world.blocks.centroid(*b).z))
            .map(|(_, on)| (on.pressure + on.drag).z)
            .collect();
        assert!(500 < inside.len());
        let force = inside.iter().sum::<f64>() / inside.len() as f64;
        lifted.push((superficial, force / weight));
    });
    // a straight line through all after the start, whose sound averages out
    let late = &lifted[lifted.len() / 4..];
    let n = late.len() as f64;
    let (u, f) = late
        .iter()
        .fold((0.0, 0.0), |(u, f), at| (u + at.0 / n, f + at.1 / n));
    let slope = late.iter().map(|at| (at.0 - u) * (at.1 - f)).sum::<f64>()
        / late.iter().map(|at| (at.0 - u).powi(2)).sum::<f64>();
    let found = u + (1.0 - f) / slope;
    println!("fluidizes at {found:.6} m/s for {expected}");
    assert!((found / expected - 1.0).abs() < 0.05, "{found}");
}

/// A grain let go in water begins to fall, or to rise, with half of its volume of water to carry along.
#[test]
fn a_grain_starts_with_added_mass() {
    for (material, ratio) in [("glass", 2.5), ("shale", 1.5), ("light", 0.25)] {
        let spacing = 0.02;
        let grain = grains_in(
            [[0.19, 0.19, 0.19], [0.21, 0.21, 0.21]],
            0.02,
            0.02,
            "count: 1,",
        )
        .replace("glass", material);
        let mut mixture = tank(spacing, [20.0, 20.0], grain);
        mixture.water.2 = "grains: (added_mass: On),".into();
        let mut world = mixture.world();
        let block = grains_of(&world)[0];
        // drag is a hundredth of the weight at the end of this
        let until = 5e-3;
        advance(&mut world, until, 10.0, |_| ());
        let expected = 9.81 * (1.0 - ratio) / (ratio + 0.5);
        let found = world.blocks.velocity(block).z / world.time();
        // buoyancy of a pressure whose gradient the kernel sums over a lattice to 2 to 3 %, and drag of half a percent
        let error = (found - expected) * (ratio + 0.5) / 9.81;
        assert!(error.abs() < 0.04, "{material} {found} {expected}");
    }
}

/// A single grain sinks at the speed at which drag carries its submerged weight, though it drags water along.
#[test]
fn one_grain_sinks_at_its_terminal_speed() {
    for (drag, expected) in [("WenYu", 0.145946), ("DiFelice", 0.134104)] {
        let (spacing, d) = (2e-3, 1e-3);
        let at = [0.02, 0.02, 0.034];
        let region = [at.map(|x| x - 0.5 * d), at.map(|x| x + 0.5 * d)];
        let mut mixture = tank(spacing, [20.0, 20.0], grains_in(region, d, d, "count: 1,"));
        mixture.water.2 = format!("grains: (drag: {drag}, kernel_radius: 8),");
        let mut world = mixture.world();
        let block = grains_of(&world)[0];
        let (mut sum, mut n) = (0.0, 0.0);
        // it takes 0.06 s to that speed, and 0.2 s to the floor
        advance(&mut world, 0.15, 10.0, |world| {
            if 0.09 < world.time() {
                sum -= world.blocks.velocity(block).z;
                n += 1.0;
            }
        });
        let found = sum / n;
        // 2 % of the water that it drags along, and of the tank's own currents
        assert!((found / expected - 1.0).abs() < 0.03, "{drag} {found}");
    }
}

/// Grains that fill a part of a closed tank settle at the hindered speed of their law.
#[test]
fn a_block_of_grains_settles_at_the_hindered_speed() {
    let (spacing, d) = (1e-3, 1e-3);
    let size = [16e-3, 16e-3, 20e-3];
    // porosity of 0.8
    let pitch = d * (PI / 6.0 / 0.2_f64).cbrt();
    let mut mixture = tank(
        spacing,
        [16.0, 20.0],
        grains_in([[0.0; 3], size], d, pitch, ""),
    );
    mixture.water.2 = "grains: (drag: WenYu),".into();
    mixture.numerics = "sound_speed: 3.0".into();
    let mut world = mixture.world();
    let inside = |world: &World| {
        let speeds: Vec<f64> = (grains_of(world).into_iter())
            .filter(|&b| {
                let x = world.blocks.centroid(b);
                let middle = (x - Vec3::new(8e-3, 8e-3, 10e-3)).abs();
                middle.x < 4e-3 && middle.y < 4e-3 && middle.z < 3e-3
            })
            .map(|b| -world.blocks.velocity(b).z)
            .collect();
        speeds.iter().sum::<f64>() / speeds.len() as f64
    };
    let (mut sum, mut n) = (0.0, 0.0);
    advance(&mut world, 0.06, 10.0, |world| {
        if 0.03 < world.time() {
            sum += inside(world);
            n += 1.0;
        }
    });
    let found = sum / n;
    // Wen & Yu's law at this porosity; the number of grains is that of whole rows
    assert!((found / 0.074357 - 1.0).abs() < 0.05, "{found}");
}

/// Grains that fall into a tank raise its level by their volume; the energy account closes.
#[test]
fn grains_that_sink_raise_the_level() {
    let spacing = 0.03;
    let width = 16.0 * spacing;
    let depth = 10.0 * spacing;
    let region = [
        [0.06, 0.06, depth + 0.02],
        [width - 0.06, width - 0.06, depth + 0.2],
    ];
    let mut mixture = tank(
        spacing,
        [16.0, 10.0],
        grains_in(region, 0.04, 0.045, "count: 256,"),
    );
    mixture.size[2] = 0.7;
    mixture.blocks = basin(mixture.size, 4.0 * spacing);
    let mut world = mixture.world();
    advance(&mut world, 2.5, 10.0, |_| ());
    let grains = grains_of(&world);
    assert_eq!(grains.len(), 256);
    let water = world.water.as_ref().unwrap();
    let sunk = grains
        .iter()
        .filter(|&&b| world.blocks.centroid(b).z < depth);
    assert_eq!(sunk.count(), grains.len());
    // the level from the center of mass of the water, whatever its waves: with grains at rest in it `A L²/2 = ∫ z dV_water + Σ z_j V_j`
    let particles = water.fluid.particles();
    let of_water: f64 = (0..particles.len())
        .map(|a| particles.position[a].z * particles.mass[a] / particles.water_density(a))
        .sum();
    let volume = PI / 6.0 * 0.04_f64.powi(3);
    let of_grains: f64 = (grains.iter())
        .map(|&b| world.blocks.centroid(b).z * volume)
        .sum();
    let level = (2.0 * (of_water + of_grains)).sqrt() / width;
    let raised = 256.0 * volume / (width * width);
    assert!(
        (level - depth - raised).abs() < 0.25 * spacing,
        "{level} {raised}"
    );
    let energy = world.energy();
    let lost = energy.lost();
    assert!(0.5 * lost < energy.drag, "{energy:?}");
    // an impact at ten rows of depth, measured 0.10, most of it unexplained as grains hit water and floor
    assert!(
        (energy.residual + energy.at_grains).abs() < 0.13 * lost,
        "{energy:?}"
    );
}

/// A grain that has gone a period down a channel sees the walls that are there.
#[test]
fn a_grain_a_period_away_is_at_its_own_walls() {
    let size = [0.5, 0.5, 0.8];
    let force = |shift: f64| {
        let mixture = Mixture {
            size,
            periodic: "X, Y",
            gravity: [0.0, 0.0, -9.81],
            water: (1000.0, 1e-3, String::new()),
            spacing: 0.05,
            filled: [[0.0; 3], [0.5; 3]],
            grains: grains_in(
                [[0.2, 0.2, 0.0], [0.24, 0.24, 0.04]],
                0.04,
                0.04,
                "count: 1,",
            ),
            blocks: vec![block(
                "floor",
                &cuboid([-0.6, -0.6, -0.2], [1.1, 1.1, 0.0]),
                FIXED,
            )],
            numerics: String::new(),
        };
        let mut world = mixture.world_of_fixed(|shape| {
            if let Shape::Sphere { center, .. } = shape {
                center.x += shift;
            }
        });
        step(&mut world, 1e-4);
        let grains = world.water.as_ref().unwrap().grains.as_ref().unwrap();
        let forces: Vec<Vec3> = grains.forces().map(|(_, on)| on.total()).collect();
        forces[0]
    };
    let (here, there) = (force(0.0), force(0.5));
    assert!(here.norm() > 0.1, "{here}");
    // kernels in single precision
    assert!((here - there).norm() < 1e-5 * here.norm(), "{here} {there}");
}

/// Grains above the water move as if there were none, and the water as without them.
#[test]
fn grains_that_do_not_touch_water_change_nothing() {
    let spacing = 0.05;
    let region = [[0.1, 0.1, 0.9], [0.4, 0.4, 1.2]];
    let of = |in_water: &str| {
        let grains = grains_in(region, 0.04, 0.06, "").replace("Averaged", in_water);
        let mut mixture = tank(spacing, [10.0, 8.0], grains);
        mixture.size[2] = 1.4;
        mixture.blocks = basin(mixture.size, 4.0 * spacing);
        let mut world = mixture.world();
        for _ in 0..30 {
            let step = world.next_step(10.0).unwrap();
            world.step(step).unwrap();
        }
        world.state_hash()
    };
    assert_eq!(of("Averaged"), of("Resolved"));
}

/// The same bits after a stop, from the bytes of a checkpoint.
#[test]
fn a_stop_changes_nothing() {
    let mixture = tank(
        0.05,
        [8.0, 8.0],
        grains_in([[0.05; 3], [0.35, 0.35, 0.3]], 0.04, 0.05, ""),
    );
    let advance_by = |world: &mut World, n: usize| {
        for _ in 0..n {
            let step = world.next_step(10.0).unwrap();
            world.step(step).unwrap();
        }
    };
    let mut whole = mixture.world();
    advance_by(&mut whole, 20);
    let saved = whole.save(Vec::new()).unwrap();
    advance_by(&mut whole, 20);
    let mut stopped = mixture.world();
    assert!(stopped.read(&saved).unwrap().is_empty());
    advance_by(&mut stopped, 20);
    assert_eq!(stopped.state_hash(), whole.state_hash());
    assert_eq!(stopped.energy(), whole.energy());
}

/// What averages are not made for is told before the run, with what to change.
#[test]
fn what_averages_do_not_do_is_refused() {
    let grains = grains_in([[0.05; 3], [0.35, 0.35, 0.3]], 0.04, 0.05, "");
    let refused = |change: fn(String) -> String| {
        let text = change(tank(0.05, [8.0, 8.0], grains.clone()).text());
        errors(&text).join("\n")
    };
    for (change, place) in [
        (
            (|text| text.replace("numerics: (", "numerics: (stepping: PredictorCorrector, "))
                as fn(String) -> String,
            "numerics.stepping",
        ),
        (
            |text| text.replace("numerics: (", "numerics: (sleeping: (), "),
            "numerics.sleeping",
        ),
        (
            |text| text.replace("numerics:", "interface: (walls: Penalty), numerics:"),
            "interface.walls",
        ),
        (
            |text| text.replace("periodic: []", "symmetry: [YMin]"),
            "domain.symmetry",
        ),
        (
            |text| {
                text.replace("Averaged", "Auto")
                    .replace("Spacing(0.05)", "Count(512)")
            },
            "grains[0].in_water",
        ),
    ] {
        let found = refused(change);
        assert!(found.contains(place), "{place}: {found}");
    }
}
