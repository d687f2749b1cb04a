//! Water: rest, depth, films, scale, subnormals, long runs, back in time.

use riprap_sph::{ParticleId, Vec3};

use crate::row::{Failure, Length, Row, Trial, sweep};
use crate::tank::{
    G, Tank, advance, busy, max_speed, n_particles, on_threads, pressure_error, surface, take,
    world,
};

pub const TRIALS: &[Trial] = &[
    Trial {
        id: "X08",
        subject: "zero gravity, water",
        run: nothing,
    },
    Trial {
        id: "X09",
        subject: "deep water",
        run: deep,
    },
    Trial {
        id: "X10",
        subject: "thin film",
        run: film,
    },
    Trial {
        id: "X12",
        subject: "subnormals, water",
        run: subnormals,
    },
    Trial {
        id: "X13",
        subject: "a million steps, still tank",
        run: still_tank,
    },
    Trial {
        id: "X20",
        subject: "creep at rest",
        run: creep,
    },
    Trial {
        id: "X21",
        subject: "time reversal",
        run: backward,
    },
    Trial {
        id: "depth",
        subject: "depth in spacings",
        run: depths,
    },
    Trial {
        id: "scale",
        subject: "scale from millimeters to ten meters",
        run: scale,
    },
];

fn nothing(length: Length) -> Result<Vec<Row>, Failure> {
    let steps = length.choose(20_000, 100_000);
    let mut tank = Tank::new(0.6, 0.3, 0.05);
    tank.gravity = (0.0, 0.0);
    tank.numerics = "sound_speed: 20.0".to_owned();
    let mut world = tank.world()?;
    let before = world.state_hash_of_places();
    take(&mut world, steps, 1.0)?;
    let moved = farthest(&before, &world.state_hash_of_places());
    let speed = max_speed(&world);
    Ok(vec![Row {
        pushed: "no gravity, nothing moves: water in an open box, f32 pairs".to_owned(),
        swept: format!("{steps} steps (asked 1e5)"),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "pressure is zero, so is every force".to_owned(),
        measured: format!("moved {moved:.1e} m, speed {speed:.1e} m/s"),
        missed: (moved > 0.0 || speed > 0.0).then(|| "something moves".to_owned()),
        ..Row::default()
    }])
}

/// Places by number of the particle.
trait Places {
    fn state_hash_of_places(&self) -> Vec<(ParticleId, Vec3)>;
}

impl Places for riprap::world::World {
    fn state_hash_of_places(&self) -> Vec<(ParticleId, Vec3)> {
        let Some(water) = &self.water else {
            return Vec::new();
        };
        let p = water.fluid.particles();
        let mut places: Vec<_> =
            p.id.iter()
                .copied()
                .zip(p.position.iter().copied())
                .collect();
        places.sort_by_key(|(id, _)| *id);
        places
    }
}

fn farthest(a: &[(ParticleId, Vec3)], b: &[(ParticleId, Vec3)]) -> f64 {
    a.iter()
        .zip(b)
        .map(|((_, a), (_, b))| (a - b).norm())
        .fold(0.0, f64::max)
}

/// Water of a depth (m) and rows of spacings; error of pressure, sinking of the surface in spacings.
fn rest(depth: f64, rows: f64, columns: f64, steps: u64) -> Result<(f64, f64, f64), Failure> {
    let spacing = depth / rows;
    let mut world = Tank::new(columns * spacing, depth, spacing).world()?;
    let before = surface(&world, 0.0, columns * spacing);
    take(&mut world, steps, 1.0)?;
    let sunk = (surface(&world, 0.0, columns * spacing) - before).abs() / spacing;
    let speed = max_speed(&world) / (G * depth).sqrt();
    Ok((pressure_error(&world, depth), sunk, speed))
}

fn deep(length: Length) -> Result<Vec<Row>, Failure> {
    let steps = length.choose(3_000, 20_000);
    let mut figures = Vec::new();
    let mut worst = (0.0_f64, 0.0_f64);
    let margin = sweep(&[1.0, 10.0, 100.0, 1e3, 1e4, 1e5], 0, |depth| {
        let (p, sunk, _) = rest(depth, 100.0, 12.0, steps).map_err(|e| e.to_string())?;
        figures.push(format!("{depth:.0} m: p {p:.1e}, surface {sunk:.2} dp"));
        worst = (worst.0.max(p), worst.1.max(sunk));
        if p > 0.01 || sunk > 0.2 {
            return Err(format!("p {p:.1e} rms, surface {sunk:.2} dp"));
        }
        Ok(())
    });
    let is_met = margin.last_good.is_some_and(|x| x >= 100.0);
    Ok(vec![Row {
        pushed: "depth of still water, 100 spacings deep, compressed start, f32 pairs".to_owned(),
        swept: format!("1 m to 100 km, {steps} steps"),
        holds: margin.holds("m"),
        past: margin.past(),
        theory: "rms p below 1 %, surface within 0.2 dp; a start without compression drops H/200; the same for every depth by Froude's law".to_owned(),
        measured: figures.join("; "),
        missed: (!is_met).then(|| margin.past.clone()),
        ..Row::default()
    }])
}

fn depths(length: Length) -> Result<Vec<Row>, Failure> {
    let mut figures = Vec::new();
    let steps = length.choose(3_000, 20_000);
    let rows: &[f64] = &[3.0, 4.0, 5.0, 10.0, 30.0, 100.0, 500.0, 1000.0];
    let margin = sweep(rows, 0, |rows| {
        let (p, sunk, speed) =
            rest(1.0, rows, 16.0, steps.min(600_000 / rows as u64)).map_err(|e| e.to_string())?;
        figures.push(format!(
            "{rows}: p {p:.1e}, surface {sunk:.2} dp, speed {speed:.1e} √(g H)"
        ));
        if p > f64::max(0.02, 0.5 / rows) || sunk > 0.3 || speed > 0.05 {
            return Err(format!(
                "p {p:.1e} rms, surface {sunk:.2} dp, speed {speed:.1e}"
            ));
        }
        Ok(())
    });
    let is_met = margin.last_good.is_some_and(|x| x >= 500.0);
    Ok(vec![Row {
        pushed: "depth of still water in spacings".to_owned(),
        swept: "3 to 1000 rows".to_owned(),
        holds: margin.holds("rows"),
        past: margin.past(),
        theory: "rest: p = ρ g (H − z) to 2 %, or the head of half a spacing where that is more, surface within 0.3 dp, speed below 5 % of √(g H)"
            .to_owned(),
        measured: figures.join("; "),
        missed: (!is_met).then(|| margin.past.clone()),
        ..Row::default()
    }])
}

fn film(_: Length) -> Result<Vec<Row>, Failure> {
    let dip = 20.0_f64.to_radians();
    let mut figures = Vec::new();
    let margin = sweep(&[3.0, 2.0, 1.0, 0.5], 0, |rows| {
        let spacing = 0.01;
        let mut tank = Tank::new(3.0, 0.1, spacing);
        tank.gravity = (G * dip.sin(), -G * dip.cos());
        tank.regions = Some(format!(
            "(name: \"sheet\", shape: Box(min: (0.2, 0, 0), max: (0.8, 0.1, {:?})))",
            rows * spacing
        ));
        tank.numerics = "expected_speed: 3.0".to_owned();
        let mut world = tank.world().map_err(|e| e.to_string())?;
        let n = n_particles(&world);
        let mean = |world: &riprap::world::World| {
            let Some(water) = &world.water else {
                return 0.0;
            };
            let v = &water.fluid.particles().velocity;
            v.iter().map(|v| v.x).sum::<f64>() / v.len() as f64
        };
        let mut highest = 0.0_f64;
        advance(&mut world, 0.6, |world| {
            highest = highest.max(surface(world, -1.0, 4.0) / spacing);
        })
        .map_err(|e| e.to_string())?;
        let expected = G * dip.sin() * world.time();
        let off = mean(&world) / expected - 1.0;
        figures.push(format!(
            "{rows} dp: {n} particles, {} lost, mean speed off by {off:.1e}, highest at {highest:.2} dp",
            n - n_particles(&world)
        ));
        if off.abs() > 0.05 || highest > rows.max(1.0) + 1.0 || n != n_particles(&world) {
            return Err(format!(
                "speed off by {off:.1e}, particles to {highest:.1} dp high"
            ));
        }
        Ok(())
    });
    // half a spacing is no particle, and said to be
    let is_met = margin.last_good.is_some_and(|rows| rows <= 1.0)
        && margin.past.contains("no particle fits");
    Ok(vec![Row {
        pushed: "thickness of a sheet of water that slides down a dry smooth bed of 20 degrees"
            .to_owned(),
        swept: "3 to 0.5 dp, 0.6 s".to_owned(),
        holds: margin
            .last_good
            .map_or("nothing".to_owned(), |x| format!("{x} dp")),
        past: margin.past(),
        theory: "v = g sin θ t without friction; nothing lifts off or is sucked".to_owned(),
        measured: figures.join("; "),
        missed: (!is_met).then(|| margin.past.clone()),
        ..Row::default()
    }])
}

fn subnormals(_: Length) -> Result<Vec<Row>, Failure> {
    let mut times = Vec::new();
    let (mut first, mut slowest) = (0.0, 0.0_f64);
    for speed in [
        1e-3, 1e-20, 1e-38, 1e-40, 1e-44, 1e-100, 1e-300, 1e-310, 1e-320,
    ] {
        let mut best = f64::INFINITY;
        for _ in 0..5 {
            let mut tank = Tank::new(1.0, 0.5, 0.02);
            tank.gravity = (0.0, 0.0);
            tank.numerics = "sound_speed: 20.0".to_owned();
            tank.regions = Some(format!(
                "(name: \"water\", shape: Box(min: (0, 0, 0), max: (1.0, 0.1, 0.5)), velocity: ({speed:e}, 0, {speed:e}))"
            ));
            let text = tank.text();
            let time = on_threads(1, || -> Result<f64, Failure> {
                let mut world = world(&text)?;
                take(&mut world, 5, 1.0)?;
                let begun = busy();
                take(&mut world, 40, 1.0)?;
                Ok(busy() - begun)
            })??;
            best = best.min(time);
        }
        if first == 0.0 {
            first = best;
        }
        slowest = slowest.max(best / first);
        times.push(format!("{speed:.0e}: {:.2}", best / first));
    }
    Ok(vec![Row {
        pushed: "speed of water down to subnormal numbers, f32 pairs, 1,250 particles".to_owned(),
        swept: "1e-3 to 1e-320 m/s".to_owned(),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "no step slower than twice that at 1e-3 m/s".to_owned(),
        measured: format!("time of a step over that at 1e-3 m/s: {}", times.join(", ")),
        missed: (slowest > 2.0).then(|| format!("{slowest:.1} times slower")),
        ..Row::default()
    }])
}

fn still_tank(length: Length) -> Result<Vec<Row>, Failure> {
    let steps = length.choose(200_000, 1_000_000);
    let mut world = Tank::new(0.6, 0.3, 0.05).world()?;
    let start = world.energy();
    // what could move: the potential energy over half the depth
    let scale = {
        let mass = world.water.as_ref().map_or(0.0, |w| w.fluid.mass());
        0.5 * mass * G * 0.3
    };
    let (mut most, mut kinetic) = (0.0_f64, Vec::new());
    for _ in 0..10 {
        take(&mut world, steps / 10, 1.0)?;
        let energy = world.energy();
        most = most.max((energy.residual - start.residual).abs() / scale);
        kinetic.push(energy.kinetic / scale);
    }
    let (early, late) = (
        kinetic[..5].iter().copied().fold(0.0, f64::max),
        kinetic[5..].iter().copied().fold(0.0, f64::max),
    );
    let mut why = Vec::new();
    if most > 1e-3 {
        why.push("energy".to_owned());
    }
    if late > 10.0 * early.max(1e-9) {
        why.push("motion grows".to_owned());
    }
    Ok(vec![Row {
        pushed: "a million steps: still tank, 12 × 6 spacings, f32 pairs".to_owned(),
        swept: format!("{steps} steps (asked 1e6), {:.0} s", world.time()),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "what nothing explains stays below 1e-3 of m g H/2, motion does not grow"
            .to_owned(),
        measured: format!(
            "residual {most:.1e} of m g H/2; kinetic energy {early:.1e} in the first half, {late:.1e} in the second"
        ),
        missed: (!why.is_empty()).then(|| why.join(", ")),
        ..Row::default()
    }])
}

fn creep(length: Length) -> Result<Vec<Row>, Failure> {
    let (columns, steps) = length.choose((50.0, 10_000), (100.0, 20_000));
    let spacing = 0.02;
    let depth = 0.5 * columns * spacing;
    let mut tank = Tank::new(columns * spacing, depth, spacing);
    let mut world = tank.world()?;
    tank.numerics = "density_diffusion: Off".to_owned();
    let mut undiffused = tank.world()?;
    let center = |world: &riprap::world::World| {
        let Some(water) = &world.water else {
            return Vec3::zeros();
        };
        let p = &water.fluid.particles().position;
        p.iter().sum::<Vec3>() / p.len() as f64
    };
    let n = n_particles(&world);
    let start = center(&world);
    let mut by_tenth = Vec::new();
    for _ in 0..10 {
        take(&mut world, steps / 10, 1.0)?;
        by_tenth.push((center(&world) - start) / spacing);
    }
    let all = by_tenth[9];
    let late = all - by_tenth[4];
    let begun = center(&undiffused);
    take(&mut undiffused, steps, 1.0)?;
    let without = (center(&undiffused) - begun).norm() / spacing;
    let heights: Vec<String> = by_tenth.iter().map(|x| format!("{:+.1e}", x.z)).collect();
    Ok(vec![Row {
        pushed: "creep of water at rest".to_owned(),
        swept: format!(
            "{n} particles in a plane, {steps} steps, {:.1} s (asked 100,000 particles and 1e5 steps: hours)",
            world.time()
        ),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "center of mass stays within 1e-3 dp".to_owned(),
        measured: format!(
            "sideways {:.1e} dp; up by tenths of the run, in dp: {}; second half {:+.1e}; without density diffusion {without:.1e} dp in all",
            all.x,
            heights.join(" "),
            late.z
        ),
        missed: (all.norm() > 1e-3)
            .then(|| format!("the center of mass moves by {:.1e} dp, lifted by the density diffusion at the surface", all.norm())),
        ..Row::default()
    }])
}

fn backward(_: Length) -> Result<Vec<Row>, Failure> {
    let mut figures = Vec::new();
    let margin = sweep(&[1e-4, 1e-3, 1e-2, 1e-1, 1.0], 3, |speed| {
        let back = crate::steps::there_and_back(speed, 200).map_err(|e| e.to_string())?;
        figures.push(format!(
            "{speed:.0e}: went {:.1e}, back to {:.1e} dp",
            back.0, back.1
        ));
        if back.1 > 1e-6 {
            return Err(format!("it comes back to {:.1e} dp", back.1));
        }
        Ok(())
    });
    let is_met = margin.last_good.is_some_and(|x| x >= 0.0099);
    Ok(vec![Row {
        pushed: "200 steps forth and back, inviscid, f64, periodic box, speed over the sound speed of 20 m/s".to_owned(),
        swept: "1e-4 to 1 m/s".to_owned(),
        holds: margin.holds("m/s"),
        past: margin.past(),
        theory: "returns to 1e-6 dp: kick-drift-kick is reversible but for the density, whose rate is that of the old one: (∇·v dt)² a step".to_owned(),
        measured: figures.join("; "),
        missed: (!is_met).then(|| margin.past.clone()),
        ..Row::default()
    }])
}

/// A dam break with everything scaled: height of the surface and the front over the spacing at a time of `n` √(H/g).
fn dam(spacing: f64) -> Result<Vec<f64>, Failure> {
    let mut tank = Tank::new(60.0 * spacing, 20.0 * spacing, spacing);
    tank.regions = Some(format!(
        "(name: \"water\", shape: Box(min: (0, 0, 0), max: ({:?}, 0.1, {:?})))",
        20.0 * spacing,
        20.0 * spacing
    ));
    let mut world = tank.world()?;
    let time = (20.0 * spacing / G).sqrt();
    advance(&mut world, 1.5 * time, |_| {})?;
    let mut found = vec![world.time() / time, world.clock().steps as f64];
    if let Some(water) = &world.water {
        let p = water.fluid.particles();
        let mut places: Vec<_> = p.id.iter().zip(&p.position).collect();
        places.sort_by_key(|(id, _)| **id);
        found.extend(
            places
                .iter()
                .flat_map(|(_, x)| [x.x / spacing, x.z / spacing]),
        );
    }
    Ok(found)
}

fn scale(_: Length) -> Result<Vec<Row>, Failure> {
    // powers of two scale without round-off but for time, √2 of them
    let reference = dam(0.01)?;
    let mut figures = Vec::new();
    let mut is_met = true;
    for spacing in [1e-3, 2.5e-3, 0.04, 0.16, 1.0, 10.0, 100.0] {
        let found = dam(spacing)?;
        let n = found.len().min(reference.len());
        let apart: Vec<f64> = found[2..n]
            .iter()
            .zip(&reference[2..n])
            .map(|(a, b)| (a - b).abs())
            .collect();
        let (worst, mean) = (
            apart.iter().copied().fold(0.0, f64::max),
            apart.iter().sum::<f64>() / apart.len().max(1) as f64,
        );
        is_met &= found.len() == reference.len() && found[1] == reference[1] && mean < 1e-3;
        figures.push(format!(
            "{spacing} m: {} steps, places apart by {mean:.0e} dp in the mean, {worst:.0e} at most",
            found[1]
        ));
    }
    Ok(vec![Row {
        pushed: "spacing with everything scaled: dam break of 400 particles to 1.5 √(H/g), against 10 mm".to_owned(),
        swept: "1 mm to 100 m".to_owned(),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "Froude's law: the same places in spacings, to round-off, which a splash makes grow; f32 pairs round at 1e-7".to_owned(),
        measured: format!("{} steps at 10 mm; {}", reference[1], figures.join("; ")),
        missed: (!is_met).then(|| "not similar to 1e-3 dp in the mean".to_owned()),
        ..Row::default()
    }])
}
